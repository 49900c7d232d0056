"""Any scene by Dormand-Prince 8(5,3) from one event to the next: slow, and independent of the solver.

Every storey yield and unload, every opening and closing of a link and every sample of the ground motion ends
a step; peaks are sought on the dense output.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

from pounding_cli import Scene
from tests.reference.assembly import ground, start
from tests.reference.branches import ACTING, Laws

PLACES = np.linspace(0.0, 1.0, 5)
"""Where in a step events are looked for."""
FINE = np.linspace(0.0, 1.0, 97)
"""Where in a step peaks are looked for."""
FINEST = 1e-17
"""Below this [m, m/s, N] a guard past zero is rounding, not an event."""


@dataclass
class Result:
    """Peaks and end of a run over all storeys, floors and links; names as in `solve.response`.

    line_shear, line_drift : of all frame lines: building by building, line by line, storey by storey; those of a
        building whose floors do not twist are its storeys
    edge_drift : of all storeys at the low edge of floors that twist, then at the high edge
    twist : largest |rotation| of all floors that twist
    turns, turn_rate : rotations and their rates at the end
    """

    shear: np.ndarray
    drift: np.ndarray
    acceleration: np.ndarray
    displacement_max: np.ndarray
    displacement_min: np.ndarray
    peak_force: np.ndarray
    max_closing: np.ndarray
    impulse: np.ndarray
    contact_time: np.ndarray
    impacts: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    energy: dict[str, float]
    columns: np.ndarray
    line_shear: np.ndarray
    line_drift: np.ndarray
    edge_drift: np.ndarray
    twist: np.ndarray
    turns: np.ndarray
    turn_rate: np.ndarray
    changes: list[tuple[float, tuple]] = field(default_factory=list)


class _Run:
    def __init__(self, scene: Scene, initial, rtol: float, per_radian: float) -> None:
        self.scene, self.laws, self.rtol, self.per_radian = scene, Laws(scene), rtol, per_radian
        self.c = self.laws.c
        self.n, self.links = self.c.mass.size, len(scene.links)
        self.floors = np.concatenate(self.c.floors)
        self.turns = np.concatenate(self.c.turns)
        q, rate = start(scene, self.c, initial)
        # q, q', impulse of every link, z of every smooth storey, work of ground, dashpots, storeys, links
        self.y = np.concatenate((q, rate, np.zeros(self.links + len(self.laws.smooth) + 4)))
        self.b = self.laws.begin()
        self.peak: np.ndarray | None = None
        self.contact_time, self.impacts = np.zeros(self.links), np.zeros(self.links, int)
        self.changes: list[tuple[float, tuple]] = []

    def split(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return y[: self.n], y[self.n : 2 * self.n]

    def impulses(self, y: np.ndarray) -> np.ndarray:
        """Of every link so far [N s]."""
        return y[2 * self.n : 2 * self.n + self.links]

    def tell(self, y: np.ndarray) -> None:
        """Tell the laws what they need of a state beside q and q'."""
        self.laws.tell(self.impulses(y), y[2 * self.n + self.links : -4])

    def freeze(self) -> None:
        """Constant matrices of the current branches."""
        self.k, self.damping, self.f, self.curved = self.laws.linear(self.b)
        self.longest = self.per_radian / self.laws.fastest(self.b)

    def acceleration(self, q, rate, a_g):
        c, laws = self.c, self.laws
        tall = q.ndim == 2
        f = self.f[:, None] if tall else self.f
        force = -self.k @ q - self.damping @ rate - f
        force = force - (np.outer(c.loaded, a_g) if tall else c.loaded * a_g)
        for e in self.curved:
            pair = c.closing[e]
            law = laws.link_law(e, pair @ q - laws.offset[e], pair @ rate, self.b.link[e], self.b.speed)
            force -= np.outer(pair, law) if tall else pair * law
        if laws.smooth:
            force -= c.drift[laws.smooth].T @ laws.smooth_shears()
        return force / (c.mass[:, None] if tall else c.mass)

    def slope(self, t: float, y: np.ndarray) -> np.ndarray:
        q, rate = self.split(y)
        c, a_g = self.c, self.ground(t)
        self.tell(y)
        out = np.empty_like(y)
        out[: self.n], out[self.n : 2 * self.n] = rate, self.acceleration(q, rate, a_g)
        closing_rate = c.closing @ rate
        forces = self.laws.link_forces(c.closing @ q - self.laws.offset, closing_rate, self.b)
        shears = self.storey_slope * (c.drift @ q) + self.storey_still
        if smooth := self.laws.smooth:
            shears[smooth] += self.laws.smooth_shears()
            drift_rate = c.drift @ rate
            out[2 * self.n + self.links : -4] = [self.laws.pens[j].slope(drift_rate[j]) for j in smooth]
        out[2 * self.n : 2 * self.n + self.links] = forces
        out[-4:] = (
            -a_g * (c.loaded @ rate),
            rate @ (c.damping @ rate),
            shears @ (c.drift @ rate),
            forces @ closing_rate,
        )
        return out

    def quantities(self, t: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Everything whose largest value is wanted, (quantities, times)."""
        q, rate = y[: self.n], y[self.n : 2 * self.n]
        c, a_g = self.c, self.ground(t)
        self.tell(y)
        drift, closing = c.drift @ q, c.closing @ q
        force = self.laws.link_forces(closing - self.laws.offset[:, None], c.closing @ rate, self.b)
        total = self.acceleration(q, rate, a_g)[self.floors] + a_g
        u = q[self.floors]
        resisting = self.laws.shears(drift, self.b)
        shear = c.storey @ resisting
        struck = np.abs(self.columns(shear, force)).reshape(-1, shear.shape[1])
        closing = closing / c.cosine[:, None]
        values = [np.abs(shear), np.abs(c.travel @ q), np.abs(total), u, -u, np.abs(force), closing, struck]
        if self.turns.size:
            values += [np.abs(resisting), np.abs(drift), np.abs(c.edges @ q), np.abs(q[self.turns])]
        return np.vstack(values)

    def columns(self, shear: np.ndarray, force: np.ndarray) -> list[np.ndarray]:
        """Shear below and above the end of every link on columns whose share of the storey is given: cuts through a
        beam clamped at both ends, with the reactions b^2 (3a + b) / L^3 and a^2 (3b + a) / L^3 to a unit force [N]."""
        level = force * self.c.cosine[:, None]
        struck = [(e, *_columns(self.scene, link)) for e, link in enumerate(self.scene.links) if link.columns]
        found = []
        for e, building, storey, side, a in struck:
            before = sum(b.storeys for b in self.scene.buildings[:building])
            length = self.scene.buildings[building].height[storey - 1]
            for nudge in (-1e-9, 1e-9):
                cut = self.scene.links[e].columns * shear[before + storey - 1]
                for other, *place, at in struck:
                    if place == [building, storey, side]:
                        b = length - at
                        below, above = b**2 * (3 * at + b) / length**3, at**2 * (3 * b + at) / length**3
                        cut = cut + side * level[other] * (below if at > a + nudge * length else -above)
                found.append(cut)
        return found

    def gather(self, begin: float, t0: float, t1: float, y: np.ndarray, dense) -> None:
        """Raise the peaks by what happens between t0 and t1 after `begin`; `y` holds the states at both ends."""
        ends = self.quantities(begin + np.array([t0, t1]), y)
        if self.peak is None:
            self.peak = ends[:, 0].copy()
        if not (ends.max(axis=1) > self.peak - 0.02 * np.abs(self.peak)).any():
            return
        t = t0 + FINE * (t1 - t0)
        values = self.quantities(begin + t, dense(t))
        values[:, [0, -1]] = ends
        # The top of the parabola through the three values around the largest, kept between them.
        at, rows = np.clip(values.argmax(axis=1), 1, t.size - 2), np.arange(values.shape[0])
        left, middle, right = (values[rows, at + i] for i in (-1, 0, 1))
        bend = left - 2 * middle + right
        top = np.clip((left - right) / np.where(bend < 0, 2 * bend, np.inf), -1, 1)
        best = middle + top * (right - left) / 2 + top**2 * bend / 2
        self.peak = np.maximum(self.peak, np.maximum(best, ends.max(axis=1)))

    def due(self, begin: float, t: np.ndarray, y: np.ndarray, dense) -> tuple[float, tuple] | None:
        """The first change between t[0] and t[-1] after `begin`, with its time."""
        first = None
        for number, (change, g) in enumerate(self.guards(begin + t, y)):
            if not g.max() > FINEST:
                continue
            if g[0] > 0:  # past zero by rounding: two changes at one instant, or one at the end of the last step
                if g[1] <= g[0]:
                    continue
                crossing = t[0]
            else:
                i = int(np.argmax((g[:-1] <= 0) & (g[1:] > 0)))
                crossing = t[i]
                if g[i] < 0:
                    crossing = self.crossing(number, begin, t[i], t[i + 1], dense)
            if first is None or crossing < first[0]:
                first = (crossing, change)
        return first

    def crossing(self, number: int, begin: float, left: float, right: float, dense) -> float:
        """When a guard that the states at both ends show rising through zero does so; the dense output may round
        otherwise, and then it is at that end."""

        def value(t: float) -> float:
            return self.guard(number, begin, t, dense)

        if value(left) >= 0:
            return left
        return brentq(value, left, right, xtol=1e-16) if value(right) > 0 else right

    def guards(self, t: np.ndarray, y: np.ndarray) -> list[tuple[tuple, np.ndarray]]:
        q, rate = y[: self.n], y[self.n : 2 * self.n]
        self.tell(y)
        return self.laws.guards(q, rate, self.b, lambda: self.acceleration(q, rate, self.ground(t)))

    def guard(self, number: int, begin: float, t: float, dense) -> float:
        at = np.array([t])
        return float(self.guards(begin + at, dense(at))[number][1][0])

    def ground(self, t):
        """Acceleration of the ground [m/s2]."""
        return self.a0 + self.a1 * (t - self.t0)

    def piece(self, t: float, end: float) -> float:
        """Integrate to `end` or to the next change; returns the time reached."""
        self.freeze()
        self.storey_slope, self.storey_still = self.laws.storey_lines(self.b)
        # Time counts from here: a force with v^(1/4) begins with steps far below the spacing of numbers near t.
        begin, end = t, end - t
        method = DOP853(
            lambda s, y: self.slope(begin + s, y), 0.0, self.y, end, rtol=self.rtol, atol=1e-16, max_step=self.longest,
            first_step=min(self.longest, end),
        )  # fmt: skip
        while method.status == "running":
            message = method.step()
            assert method.status != "failed", message
            dense = method.dense_output()
            times = method.t_old + PLACES * (method.t - method.t_old)
            y = dense(times)
            y[:, 0], y[:, -1] = self.y, method.y
            event = self.due(begin, times, y, dense)
            stop = method.t if event is None else event[0]
            if event is not None:
                y = dense(np.array([method.t_old, stop]))
            ends = np.column_stack((self.y, y[:, -1]))
            self.gather(begin, method.t_old, stop, ends, dense)
            acting = [e for e, branch in enumerate(self.b.link) if branch in ACTING]
            self.contact_time[acting] += stop - method.t_old
            self.y = ends[:, -1].copy()
            if event is not None:
                self.change(begin + stop, event[1])
                return begin + stop
        return begin + end

    def change(self, t: float, change: tuple) -> None:
        self.changes.append((t, change))
        assert len(self.changes) < 20_000, "events without end"
        what, e, to = change
        if what == "link" and to in ("on", "gaining") and self.b.link[e] == "open":
            self.impacts[e] += 1
        q, rate = self.split(self.y)
        self.tell(self.y)
        self.b = self.laws.apply(change, q, rate, self.b, lambda: self.acceleration(q, rate, self.ground(t)))

    def result(self) -> Result:
        c, floors = self.c, self.floors
        q, rate = self.split(self.y)
        assert self.peak is not None
        s, n, m = c.travel.shape[0], floors.size, self.links
        struck = 2 * sum(bool(link.columns) for link in self.scene.links)
        free = np.isfinite(c.mass)
        lines = c.stiffness.size if self.turns.size else 0
        sizes = [s, s, n, n, n, m, m, struck, lines, lines, c.edges.shape[0]]
        parts = np.split(self.peak, np.cumsum(sizes))
        work = dict(zip(("input", "damping", "storeys", "links"), self.y[-4:], strict=True))
        return Result(
            parts[0], parts[1], parts[2], parts[3], -parts[4], parts[5], parts[6],
            self.y[2 * self.n : 2 * self.n + m].copy(), self.contact_time, self.impacts,
            q[floors], rate[floors], work | {"kinetic": float(c.mass[free] @ rate[free] ** 2 / 2), "springs": float(q @
            c.springs @ q / 2)}, *parts[7:], q[self.turns], rate[self.turns], self.changes,
        )  # fmt: skip


def _columns(scene: Scene, link) -> tuple[int, int, int, float]:
    """Building and storey of the columns that a link ends on, the way that its force pushes them (1: to the right), and
    the height of the blow above the floor below [m]."""
    if link.right_at < 1.0:
        place, storey, side, at = link.left + 1, link.right_floor, 1, link.right_at
    else:
        place, storey, side, at = link.left, link.left_floor, -1, link.left_at
    return place, storey, side, at * float(scene.buildings[place].height[storey - 1])


def integrate(scene: Scene, initial=None, rtol: float = 1e-11, per_radian: float = 0.25) -> Result:
    """Run a scene; `per_radian`: longest step times highest frequency [rad], bounds the dense output."""
    run = _Run(scene, initial, rtol, per_radian)
    for t0, t1, acceleration, slope in ground(scene):
        run.t0, run.a0, run.a1 = t0, acceleration, slope
        t = t0
        while t1 - t > 1e-14 * max(1.0, t1):
            t = run.piece(t, t1)
    return run.result()
