"""The laws of storeys and links branch by branch: forces, and what ends each branch."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import brentq

from pounding_cli import Scene
from tests.reference.assembly import Coordinates, coordinates, reduced_mass
from tests.reference.pens import WenPen, pen_of

ACTING = ("on", "beyond", "gaining", "parting", "yielding", "unloading", "returning", "up", "down", "pressed")
"""Branches of a link whose force acts."""
JOINED = ("connector", "damper", "viscous", "maxwell", "friction")
"""Links that act at all times."""
HERTZ = ("hertz", "hertz-damp", "jankowski")
PRESSED = 0.03
"""Compression [m] up to which `fastest` holds for a Hertz contact."""


@functools.cache
def hertz_damping(restitution: float) -> float:
    """zeta of ln((1 + zeta) / (1 - e zeta)) = zeta (1 + e) [-], 0 < e < 1; zeta lies below 1 / e."""
    e = restitution
    return float(
        brentq(lambda z: math.log((1 + z) / (1 - e * z)) - z * (1 + e), 1e-3 * (1 - e), (1 - 1e-15) / e, xtol=1e-16)
    )


def hertz_factor(law) -> float:
    """zeta [-] of a law: as above, or by a formula as published."""
    e, formula = law.restitution, str(law.damping_formula)
    if formula == "muthukumar":
        return 3 * (1 - e**2) / 4
    return 8 * (1 - e) / (5 * e) if formula == "ye" else hertz_damping(e)


@functools.cache
def jankowski_damping(restitution: float, formula: str = "exact") -> float:
    """xi [-] that gives e: with s = v^1.25 the approach is that of a damped oscillator of ratio b = sqrt(0.8) xi as
    far as it turns; e is what its spring then holds; 0 < e < 1, b below one. Or by his formula."""
    if formula == "jankowski":
        e = restitution
        return 4.5 * math.sqrt(5) * (1 - e**2) / (e * (e * (9 * math.pi - 16) + 16))

    def left(b: float) -> float:
        damped = math.sqrt(1 - b * b)
        turning = brentq(
            lambda t: damped * math.cos(damped * t) - b * math.sin(damped * t), 1e-12, math.pi / damped / 2
        )
        return math.exp(-b * turning) * math.sin(damped * turning) / damped

    return float(brentq(lambda b: left(b) - restitution, 1e-9, 0.999, xtol=1e-15)) / math.sqrt(0.8)


def bilinear_lines(law) -> tuple[float, float, float]:
    """K1, K2 [N/m] and the yield closing dy [m] of a bilinear contact; its largest blow loses 1 - e^2 of its energy."""
    effective = law.hertz_stiffness * math.sqrt(law.penetration)
    lost = effective * law.penetration**2 * (1 - law.restitution**2) / (1 + law.restitution**2)
    limit = law.yield_share * law.penetration
    k1 = effective + lost / (limit * law.penetration)
    return k1, (effective * law.penetration - k1 * limit) / (law.penetration - limit), limit


def forces_of_infill(link) -> tuple[float, float]:
    """Forces of an infill at its thickness, before and behind the jump of the printed law [N]."""
    before = link.stiffness * link.gap + (link.impact_stiffness - link.stiffness) * link.gap / 3
    return before, link.impact_stiffness * link.gap if str(link.law) == "printed" else before


def thickness_of(link) -> tuple[float, float]:
    """Closings [m] at which an infill is pressed to its thickness, and beyond it; columns have bent by then."""
    give = getattr(link, "flexibility", 0.0)
    before, behind = forces_of_infill(link)
    return link.gap + give * before, link.gap + give * behind


def infill_in_series(link, v, rate, branch: str, root: float):
    """Force [N] of an infill in series with columns: the one that presses the material by what the columns leave of v,
    sought by bisection and the like; its dashpot by the tangent of both; root : of the dashpot, 2 xi sqrt(m')."""
    give, p = link.flexibility, (link.impact_stiffness - link.stiffness) / (3 * link.gap**2)
    _, behind = forces_of_infill(link)
    if branch == "pressed":
        return (v - link.gap) / give + root * math.sqrt(1 / give) * rate
    if branch == "beyond":
        k = link.impact_stiffness / (1 + give * link.impact_stiffness)
        return behind + k * (v - link.gap - give * behind) + root * math.sqrt(k) * rate

    def pressed(closing: float) -> float:
        if closing == 0.0:
            return 0.0
        ends = sorted((0.0, 1.0001 * closing))
        return brentq(lambda x: x + give * (p * x**3 + link.stiffness * x) - closing, *ends, xtol=1e-22, rtol=1e-15)

    x = np.vectorize(pressed, otypes=[float])(v)
    slope = 3 * p * x**2 + link.stiffness
    return p * x**3 + link.stiffness * x + root * np.sqrt(slope / (1 + give * slope)) * rate


@dataclass
class Branches:
    """Which branch every storey and link is on; what `Laws` needs besides q and q'.

    storey : of all that resists 0 elastic, +1 or -1 yielding that way; plastic : plastic drift [m] where elastic
    link : "open", "on", "cut" (closed, but its law would pull), "beyond" (infill compressed past its gap), "pressed"
        (infill on columns at the jump of the printed law), "gaining" (Hertz contact whose approach speed is the largest
        so far), "parting" (of floors that approach no longer);
        "yielding", "unloading", "returning" of a bilinear contact; "up" and "down" of a friction damper that slips, and
        of a viscous one, as the floors close and part
    speed : largest approach speed of the present contact [m/s] by link, where it no longer grows; of a bilinear
        contact the closing at which it last turned [m] and its force there [N], as a pair; slip of a
        friction damper [m]
    """

    storey: np.ndarray
    plastic: np.ndarray
    link: list[str]
    speed: dict[int, Any] = field(default_factory=dict)


class Laws:
    """Forces of a scene on given branches."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.c: Coordinates = coordinates(scene)
        self.elastic = str(scene.analysis) == "elastic"
        self.reduced = [reduced_mass(scene, e) for e in range(len(scene.links))]
        self.pens = [None if self.elastic else pen_of(law) for law in self.c.laws]
        self.pushed: Any = None  # impulse of every link so far [N s]
        self.smooth = [j for j, pen in enumerate(self.pens) if isinstance(pen, WenPen)]
        self.offset = np.array([e.gap if e.kind in ("pounding", "bilinear", *HERTZ) else 0.0 for e in scene.links])

    def begin(self) -> Branches:
        """At rest: nothing has yielded, only connectors act."""
        storeys = self.c.stiffness.size
        links = ["up" if e.kind == "viscous" else "on" if e.kind in JOINED else "open" for e in self.scene.links]
        slips = {e: 0.0 for e, link in enumerate(self.scene.links) if link.kind == "friction"}
        return Branches(np.zeros(storeys, int), np.zeros(storeys), links, slips)

    def shears(self, drift: np.ndarray, b: Branches) -> np.ndarray:
        """Shears [N] a k D + (1 - a) k (D - Dp), D - Dp = +-Dy while yielding; (resisting, times)."""
        slope, still = self.storey_lines(b)
        shears = slope[:, None] * drift + still[:, None]
        if self.smooth:
            shears[self.smooth] += self.smooth_shears()
        return shears

    def tell(self, impulses: np.ndarray, z: np.ndarray) -> None:
        """What forces depend on besides q and q': impulses of the links so far [N s], z of the smooth storeys."""
        self.pushed = impulses
        for j, now in zip(self.smooth, z, strict=True):
            self.pens[j].z = now

    def smooth_shears(self) -> np.ndarray:
        """What z adds to the shear of every smooth storey [N]."""
        return np.array([self.pens[j].top * self.pens[j].z for j in self.smooth])

    def storey_lines(self, b: Branches) -> tuple[np.ndarray, np.ndarray]:
        """Slope [N/m] and value at zero drift [N] of every storey's current branch."""
        k, a = self.c.stiffness, self.c.hardening
        if self.elastic:
            return k, np.zeros_like(k)
        reach = np.where(np.isfinite(self.c.yield_drift), self.c.yield_drift, 0.0)
        still = (1 - a) * k * np.where(b.storey == 0, -b.plastic, b.storey * reach)
        slope = np.where(b.storey == 0, k, a * k)
        for j, pen in enumerate(self.pens):
            if pen is not None:
                slope[j], still[j] = pen.line
        return slope, still

    def link_law(
        self, e: int, v: np.ndarray, rate: np.ndarray, branch: str, speed: dict[int, Any] | None = None
    ) -> np.ndarray:
        """Force [N] of link e on a branch at v (gap subtracted for pounding) and v'; eqs (6), (9), (10), and Hertz:
        k v^1.5 (1 + zeta v' / v0)."""
        link = self.scene.links[e].law
        if link.name in HERTZ:
            spring = link.hertz_stiffness * np.maximum(v, 0.0) ** 1.5
            if link.name == "hertz":
                return spring
            if link.name == "jankowski":
                xi = jankowski_damping(link.restitution, str(link.damping_formula))
                c = 2 * xi * np.sqrt(link.hertz_stiffness * np.sqrt(np.maximum(v, 0.0)) * self.reduced[e])
                return spring + c * rate if branch == "on" else spring
            zeta = hertz_factor(link)
            return spring * (1 + zeta * (1.0 if branch == "gaining" else rate / (speed or {})[e]))
        if link.name == "damper":
            return link.damping_coefficient * rate + 0.0 * v
        if link.name == "viscous":
            side = 1.0 if branch == "up" else -1.0
            return side * link.force_at_1_m_s * np.maximum(side * rate, 0.0) ** link.exponent
        if link.name == "maxwell":  # what the dashpot has given is the impulse over c
            return link.stiffness * (v - self.pushed[e] / link.damping_coefficient)
        if link.name == "friction":
            if branch == "on":
                return link.stiffness * (v - (speed or {})[e])
            return (1.0 if branch == "up" else -1.0) * link.slip_force + 0.0 * v
        if link.name == "bilinear":
            k1, k2, limit = bilinear_lines(link)
            if branch == "unloading":
                turned, there = (speed or {})[e]
                return there + k1 * (v - turned)
            return k1 * v if branch == "on" else k2 * v + (k1 - k2) * limit * (branch == "yielding")
        xi, m = link.damping_ratio, self.reduced[e]
        if link.name != "infill":
            return link.stiffness * v + 2 * xi * np.sqrt(link.stiffness * m) * rate
        p = (link.impact_stiffness - link.stiffness) / (3 * link.gap**2)
        if getattr(link, "flexibility", 0.0):
            return infill_in_series(link, v, rate, branch, 2 * xi * math.sqrt(m))
        if branch == "beyond":
            force = link.impact_stiffness * v
            if str(link.law) == "continuous":
                force = p * link.gap**3 + link.stiffness * link.gap + link.impact_stiffness * (v - link.gap)
            return force + 2 * xi * np.sqrt(link.impact_stiffness * m) * rate
        slope = 3 * p * v**2 + link.stiffness
        return p * v**3 + link.stiffness * v + 2 * xi * np.sqrt(slope * m) * rate

    def side(self, e: int, v: float, branch: str) -> str:
        """Branch of the law at compression v > 0 of a closed link."""
        link = self.scene.links[e].law
        if link.name != "infill":
            return "on"
        reaches, passes = thickness_of(link)
        return "beyond" if v > passes else "pressed" if v > reaches else "on"

    def link_forces(self, v: np.ndarray, rate: np.ndarray, b: Branches) -> np.ndarray:
        """Forces of all links [N], shape of v."""
        force = np.zeros_like(v)
        for e, branch in enumerate(b.link):
            if branch in ACTING:
                force[e] = self.link_law(e, v[e], rate[e], branch, b.speed)
        return force

    def linear(self, b: Branches) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[int]]:
        """K, C, f of the force -K q - C q' - f of the current branches, and the links that are not in it."""
        c = self.c
        slope, still = self.storey_lines(b)
        k = c.springs + c.drift.T @ (slope[:, None] * c.drift)
        damping, f, curved = c.damping.copy(), c.drift.T @ still, []
        for e, link in enumerate(each.law for each in self.scene.links):
            if b.link[e] not in ACTING:
                continue
            if link.name in (*HERTZ, "viscous", "maxwell") or (link.name == "infill" and b.link[e] == "on"):
                curved.append(e)
                continue
            # Two values of a straight line give the line.
            zero = float(self.link_law(e, 0.0, 0.0, b.link[e], b.speed))
            spring = float(self.link_law(e, 1.0, 0.0, b.link[e], b.speed)) - zero
            dashpot = float(self.link_law(e, 0.0, 1.0, b.link[e], b.speed)) - zero
            pair = np.outer(c.closing[e], c.closing[e])
            k, damping = k + spring * pair, damping + dashpot * pair
            f = f + c.closing[e] * (zero - spring * self.offset[e])
        return k, damping, f, curved

    def fastest(self, b: Branches) -> float:
        """A bound on the highest circular frequency of the current branches [rad/s]."""
        c = self.c
        k = c.springs + c.drift.T @ (c.stiffness[:, None] * c.drift)
        for e, branch in enumerate(b.link):
            if branch != "open":
                link = self.scene.links[e].law
                if link.name in HERTZ:
                    s = 1.5 * link.hertz_stiffness * PRESSED**0.5
                elif link.name == "bilinear":
                    s = bilinear_lines(link)[0]
                elif link.name in ("damper", "viscous"):
                    s = 0.0
                else:
                    s = max(link.stiffness, link.impact_stiffness) if link.name == "infill" else link.stiffness
                k = k + s * np.outer(c.closing[e], c.closing[e])
        root = 1 / np.sqrt(c.mass)
        return float(np.sqrt(np.linalg.eigvalsh(k * np.outer(root, root))[-1]))

    def guards(
        self, q: np.ndarray, rate: np.ndarray, b: Branches, acceleration: Callable[[], np.ndarray]
    ) -> list[tuple[tuple, np.ndarray]]:
        """What ends the branches: (change, g), due when g rises through zero; q, q' and what `acceleration` gives, q'',
        of shape (N, times)."""
        c, out = self.c, []
        drift, drift_rate = c.drift @ q, c.drift @ rate
        if not self.elastic:
            for j in np.flatnonzero(np.isfinite(c.yield_drift)):
                if (pen := self.pens[j]) is not None:
                    out += [(("storey", j, end), value) for end, value in pen.ends(drift[j], drift_rate[j])]
                elif b.storey[j] == 0:
                    reach = drift[j] - b.plastic[j]
                    out += [(("storey", j, 1), reach - c.yield_drift[j])]
                    out += [(("storey", j, -1), -reach - c.yield_drift[j])]
                else:
                    out += [(("storey", j, 0), -b.storey[j] * drift_rate[j])]
        v, v_rate = c.closing @ q - self.offset[:, None], c.closing @ rate
        for e, link in enumerate(each.law for each in self.scene.links):
            branch = b.link[e]
            if link.name in JOINED:
                out += self.slip_guards(e, v[e], v_rate[e], b)
                continue
            damped = link.name == "hertz-damp"
            if branch == "open":
                out += [(("link", e, "gaining" if damped else "on"), v[e])]
                continue
            out += [(("link", e, "open"), -v[e])]
            if damped:
                out += self.hertz_guards(e, v_rate[e], b, acceleration)
            if link.name == "jankowski":
                approach = branch == "on"
                out += [(("link", e, "parting" if approach else "on"), -v_rate[e] if approach else v_rate[e])]
            if link.name == "bilinear":
                out += self.bilinear_guards(e, v[e], v_rate[e], b)
            if link.name in (*HERTZ, "bilinear"):
                continue
            infill = link.name == "infill"
            if infill:
                reaches, passes = thickness_of(link)
                jumps = passes > reaches
                if branch == "on":
                    out += [(("link", e, "pressed" if jumps else "beyond"), v[e] - reaches)]
                if branch == "pressed":
                    out += [(("link", e, "beyond"), v[e] - passes), (("link", e, "on"), reaches - v[e])]
                if branch == "beyond":
                    out += [(("link", e, "pressed" if jumps else "on"), passes - v[e])]
            if link.tension_cut and link.damping_ratio > 0:
                if branch == "cut":
                    reaches, passes = thickness_of(link) if infill else (math.inf, math.inf)
                    past, pressed = v[e] > passes, v[e] > reaches
                    on = self.link_law(e, np.minimum(v[e], reaches), v_rate[e], "on")
                    law = np.where(pressed, self.link_law(e, v[e], v_rate[e], "pressed"), on)
                    law = np.where(past, self.link_law(e, v[e], v_rate[e], "beyond"), law)
                    out += [(("link", e, "press"), law)]
                else:
                    out += [(("link", e, "cut"), -self.link_law(e, v[e], v_rate[e], branch))]
        return out

    def hertz_guards(self, e: int, v_rate: np.ndarray, b: Branches, acceleration) -> list[tuple[tuple, np.ndarray]]:
        """v0 is reached where v'' falls below zero, and grows again where v' exceeds it; below v' = -v0 / zeta the
        contact would pull."""
        if b.link[e] == "gaining":
            return [(("link", e, "on"), -(self.c.closing[e] @ acceleration()))]
        pulls = -v_rate - b.speed[e] / hertz_factor(self.scene.links[e].law)
        if b.link[e] == "cut":
            return [(("link", e, "press"), -pulls)]
        return [(("link", e, "gaining"), v_rate - b.speed[e]), (("link", e, "cut"), pulls)]

    def slip_guards(self, e: int, v: np.ndarray, v_rate: np.ndarray, b: Branches) -> list[tuple[tuple, np.ndarray]]:
        """A friction damper slips beyond its force and sticks again where it turns back; a viscous one turns."""
        link, branch = self.scene.links[e].law, b.link[e]
        if branch == "up":
            return [(("link", e, "down" if link.name == "viscous" else "on"), -v_rate)]
        if branch == "down":
            return [(("link", e, "up" if link.name == "viscous" else "on"), v_rate)]
        if link.name != "friction":
            return []
        reach, limit = v - b.speed[e], link.slip_force / link.stiffness
        return [(("link", e, "up"), reach - limit), (("link", e, "down"), -reach - limit)]

    def bilinear_guards(self, e: int, v: np.ndarray, v_rate: np.ndarray, b: Branches) -> list[tuple[tuple, np.ndarray]]:
        """Up to the lines K1 v, K2 v + (K1 - K2) dy and K2 v, and back at turning points."""
        branch, (k1, k2, limit) = b.link[e], bilinear_lines(self.scene.links[e].law)
        if branch == "on":
            return [(("link", e, "yielding"), v - limit)]
        if branch == "unloading":
            force = self.link_law(e, v, v_rate, branch, b.speed)
            return [
                (("link", e, "yielding"), (force - k2 * v - (k1 - k2) * limit) / k1),
                (("link", e, "returning"), (k2 * v - force) / k1),
            ]
        return [(("link", e, "unloading"), -v_rate if branch == "yielding" else v_rate)]

    def apply(self, change: tuple, q: np.ndarray, rate: np.ndarray, b: Branches, acceleration) -> Branches:
        """The branches after a change, at q, q' and what `acceleration` gives, q''."""
        what, i, to = change
        new = Branches(b.storey.copy(), b.plastic.copy(), list(b.link), dict(b.speed))
        if what == "link" and self.scene.links[i].kind == "hertz-damp" and to != "press":
            speed = self.c.closing[i] @ rate
            if to == "gaining" and speed > 0 and self.c.closing[i] @ acceleration() <= 0:
                to = "on"
            if "gaining" in (to, b.link[i]) or b.link[i] == "open":
                new.speed[i] = float(speed)
        if to == "unloading":
            turned = float(self.c.closing[i] @ q - self.offset[i])
            new.speed[i] = turned, float(self.link_law(i, turned, 0.0, b.link[i], b.speed))
        if what == "link" and self.scene.links[i].kind == "friction" and to == "on":
            slips = self.scene.links[i].law.slip_force / self.scene.links[i].law.stiffness
            new.speed[i] = float(self.c.closing[i] @ q) - (slips if b.link[i] == "up" else -slips)
        if what == "storey" and (pen := self.pens[i]) is not None:
            pen.change(to, float(self.c.drift[i] @ q))
        elif what == "storey":
            if to == 0:
                new.plastic[i] = self.c.drift[i] @ q - b.storey[i] * self.c.yield_drift[i]
            new.storey[i] = to
        elif to == "press":
            new.link[i] = self.side(i, float(self.c.closing[i] @ q), "cut")
        else:
            new.link[i] = to
        return new
