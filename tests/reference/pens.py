"""Storeys as drawing pens: the line that a pen is on, what ends it, and what it does then. Written from the papers,
with nothing of the solver."""

from __future__ import annotations

import numpy as np


class ImkPen:
    """Ibarra, Medina & Krawinkler (2005): peak-oriented, pinched where `kappa` is given, with deterioration.

    k, vy, a : initial stiffness [N/m], yield shear [N], hardening
    ductility, post, residual : capping drift over yield drift, post-capping slope over k, residual over yield shear
    capacities : of strength, capping, unloading and reloading, over vy^2 / k
    kappa : (kappa_F, kappa_D)
    """

    def __init__(self, k, vy, a, ductility, post, residual=0.0, capacities=(np.inf,) * 4, exponent=1.0, kappa=None):
        self.k, self.kappa, self.exponent = k, kappa, exponent
        self.capacity = [c * vy * vy / k for c in capacities]
        self.fall, self.least = post * k, residual * vy
        self.floor = (a + 0.05 * (1 - a)) * k
        top = vy + a * k * (ductility - 1) * vy / k
        self.yields, self.slope = {1: vy, -1: vy}, {1: a * k, -1: a * k}
        self.zero_shear = {1: top + self.fall * ductility * vy / k, -1: top + self.fall * ductility * vy / k}
        self.target = {1: vy / k, -1: vy / k}
        self.ku, self.line, self.mode, self.side = k, (k, 0.0), "elastic", 0
        self.turned = 0.0
        self.held: tuple = ()
        self.last = self.work = self.spent = 0.0

    # The backbone of a side, drifts and shears positive

    def capping(self, side: int) -> float:
        """Drift at which hardening and post-capping line meet."""
        vy, slope = self.yields[side], self.slope[side]
        return (self.zero_shear[side] - (vy - slope * vy / self.k)) / (slope + self.fall)

    def piece(self, side: int, x: float) -> str:
        if x < self.capping(side):
            return "hardening"
        return "capping" if x < (self.zero_shear[side] - self.least) / self.fall else "residual"

    def line_of(self, side: int, piece: str) -> tuple[float, float]:
        if piece == "hardening":
            slope = self.slope[side]
            return slope, side * (self.yields[side] - slope * self.yields[side] / self.k)
        return (-self.fall, side * self.zero_shear[side]) if piece == "capping" else (0.0, side * self.least)

    def shear_at(self, side: int, x: float) -> float:
        slope, still = self.line_of(side, self.piece(side, x))
        return slope * x + side * still

    # What ends a line, and what happens then

    def ends(self, d, r):
        """(what, value that rises through zero), ... at drifts d [m] and rates r [m/s], arrays."""
        s = self.side
        if self.mode == "elastic":
            return [(("yield", 1), d - self.target[1]), (("yield", -1), -d - self.target[-1])]
        if self.mode == "unloading":
            slope, still = self.line
            return [("resume", s * d - self.turned), ("cross", -s * (d + still / slope))]
        out = [("turn", -s * r)]
        if self.mode == "pinched":
            out += [("break", s * d - self.breaks)]
        if self.mode == "reloading":
            out += [("arrive", s * d - self.target[s])]
        if self.mode == "hardening":
            out += [("cap", s * d - self.capping(s))]
        if self.mode == "capping":
            out += [("level", s * d - (self.zero_shear[s] - self.least) / self.fall)]
        return out

    def force(self, d: float) -> float:
        return self.line[0] * d + self.line[1]

    def count(self, d: float) -> None:
        """Work since the last change."""
        self.work += 0.5 * (self.force(d) + self.force(self.last)) * (d - self.last)
        self.last = d

    def loss(self, mode: int, energy: float, spent: float) -> float:
        left = self.capacity[mode] - spent
        if not np.isfinite(left) or energy <= 0:
            return 0.0
        return 1.0 if left <= energy else (energy / left) ** self.exponent

    def change(self, what, d: float) -> None:
        self.count(d)
        if isinstance(what, tuple):
            self.side = what[1]
            self.go(self.piece(self.side, self.side * d))
        elif what == "turn":
            self.turn(d)
        elif what == "resume":
            self.mode, self.line = self.held
        elif what == "cross":
            self.begin(-self.side, d)
        elif what == "break":
            x, s = self.side * d, self.side
            slope = (self.shear_at(s, self.target[s]) - s * self.force(d)) / (self.target[s] - x)
            self.mode, self.line = "reloading", (slope, self.force(d) - slope * d)
        else:
            x = self.target[self.side] if what == "arrive" else self.side * d * (1 + 1e-12)
            self.go(self.piece(self.side, x))

    def go(self, piece: str) -> None:
        self.mode, self.line = piece, self.line_of(self.side, piece)

    def turn(self, d: float) -> None:
        force = self.force(d)
        energy = max(self.work - force**2 / (2 * self.ku), 0.0)
        beta = self.loss(2, energy, self.spent + energy)
        self.held, self.turned = (self.mode, self.line), self.side * d
        if np.isfinite(self.capacity[2]):
            self.ku = max(self.ku * (1 - beta), self.floor)
            if self.mode in ("pinched", "reloading"):
                self.ku = max(self.ku, self.line[0])
        if self.mode in ("hardening", "capping", "residual"):
            self.target[self.side] = self.side * d
        self.mode, self.line = "unloading", (self.ku, force - self.ku * d)

    def begin(self, side: int, d: float) -> None:
        energy = max(self.work, 0.0)
        self.spent += energy
        self.work, self.side = 0.0, side
        strength, capping, _, reloading = (self.loss(mode, energy, self.spent) for mode in range(4))
        before = self.yields[side]
        self.yields[side] = max(before * (1 - strength), self.least)
        self.slope[side] *= self.yields[side] / before if before > 0 else 1.0
        vy = self.yields[side]
        self.zero_shear[side] = max(self.zero_shear[side] * (1 - capping), vy + self.fall * vy / self.k)
        if self.spent < self.capacity[3]:
            self.target[side] *= 1 + reloading
        x = side * d
        if np.isfinite(self.capacity[2]):
            self.target[side] = max(self.target[side], self.nearest(side, max(x, 0.0) if self.kappa else x))
        target, shear = self.target[side], self.shear_at(side, self.target[side])
        slope = shear / (target - x)
        self.mode = "reloading"
        if self.kappa:
            slope *= self.kappa[0]
            self.breaks = max((1 - self.kappa[1]) * max(target - shear / self.ku, 0.0), x)
            self.mode = "pinched"
        self.line = slope, -slope * d

    def nearest(self, side: int, x: float) -> float:
        """Where a line with the unloading stiffness from zero shear at x meets the backbone."""
        for piece in ("hardening", "capping", "residual"):
            slope, still = self.line_of(side, piece)
            meets = (side * still + self.ku * x) / (self.ku - slope)
            if piece == "residual" or self.piece(side, meets) == piece:
                return meets
        raise AssertionError


class WenPen:
    """Bouc (1967) and Wen (1976): z, from -1 to 1, is integrated beside the motion; a line a k under it.

    z : where it is now, a number or an array over times
    way, sign : of the drift and of z, held from one change to the next
    """

    def __init__(self, k: float, vy: float, a: float, n: float, gamma: float) -> None:
        self.line, self.top, self.yields = (a * k, 0.0), (1 - a) * vy, vy / k
        self.n, self.beta, self.gamma = n, 1 - gamma, gamma
        self.way, self.sign, self.z = 1, 1, 0.0

    def slope(self, r):
        """z' [1/s] at the rate r [m/s] of the drift."""
        part = np.abs(self.z) ** self.n * (self.beta * self.way * self.sign + self.gamma)
        return r / self.yields * (1 - part)

    def ends(self, d, r):
        out = [("turn", -self.way * r)]
        return [*out, ("sign", -self.sign * self.z)] if self.way != self.sign else out

    def change(self, what: str, d: float) -> None:
        if what == "turn":
            self.way = -self.way
        else:
            self.sign = -self.sign


def pen_of(law) -> ImkPen | WenPen | None:
    """The pen of a storey's law; None of a bilinear one."""
    if law.name == "bouc-wen" and np.isfinite(law.yield_shear):
        return WenPen(law.stiffness, law.yield_shear, law.hardening, law.wen_exponent, law.wen_gamma)
    if law.name == "peak-oriented" and np.isfinite(law.yield_shear):
        return ImkPen(law.stiffness, law.yield_shear, law.hardening, 1e6, 1.0)
    if not law.name.startswith("imk"):
        return None
    capacities = [getattr(law, f"{name}_capacity") for name in ("strength", "capping", "unloading", "reloading")]
    kappa = (law.pinching_force, law.pinching_drift) if law.name == "imk-pinching" else None
    return ImkPen(
        law.stiffness, law.yield_shear, law.hardening, law.capping_ductility, law.post_capping_slope,
        law.residual_strength, capacities, law.deterioration_exponent, kappa,
    )  # fmt: skip
