"""The same elastic scene in heyoka: a Taylor integrator of its own, with its own event location, for pounding links.

Contact is a switch per link, thrown by a terminal event where the closing crosses zero; storeys' peaks are read at
events where the drift rate is zero. Nothing but the scene's data is shared with `pounding_cli`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import heyoka as hy
import numpy as np

from pounding_cli import Scene

START = 1e-4
"""Time [s] from which events are looked for; well before anything can part again."""


@dataclass(frozen=True, eq=False)
class Elastic:
    """Largest |shear| [N] and |drift| [m] of every storey, number of contacts of every link, final displacements [m]
    and velocities [m/s] of all floors, buildings left to right; seconds on the core spent integrating, without
    compilation."""

    shear: np.ndarray
    drift: np.ndarray
    contacts: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    seconds: float


class ElasticScene:
    """An elastic scene of fixed-base buildings, compiled once; `run` may be called again and again.

    `tolerance` : heyoka's own, 0 for the rounding unit; `peaks` : look for the storeys' peaks (in Python, so slow)
    """

    def __init__(self, scene: Scene, tolerance: float = 0.0, peaks: bool = True) -> None:
        assert scene.analysis == "elastic"
        self.scene = scene
        first, self.storeys = [], 0
        for building in scene.buildings:
            assert building.foundation is None
            first.append(self.storeys)
            self.storeys += building.storeys
        self.u = [hy.make_vars(f"u{i}") for i in range(self.storeys)]
        self.v = [hy.make_vars(f"v{i}") for i in range(self.storeys)]
        self.drifts, self.rates = self._drifts(self.u), self._drifts(self.v)
        self.ends = [(first[e.left] + e.left_floor - 1, first[e.left + 1] + e.right_floor - 1) for e in scene.links]
        self.contacts = np.zeros(len(scene.links), int)
        self.peak = np.zeros(self.storeys)
        stops = [
            hy.t_event(self.u[left] - self.u[right] - link.gap, callback=self._switch(e))
            for e, (link, (left, right)) in enumerate(zip(scene.links, self.ends, strict=True))
        ]
        turns = [hy.nt_event(rate, self._peak(i)) for i, rate in enumerate(self.rates)] if peaks else []
        count = 2 * self.storeys
        options = {"tol": tolerance} if tolerance else {}
        self.integrator = hy.taylor_adaptive(
            self._equations(),
            np.zeros(count),
            pars=np.zeros(3 + len(stops)),
            t_events=stops,
            nt_events=turns,
            **options,
        )

    def _drifts(self, of: list) -> list:
        found, place = [], 0
        for building in self.scene.buildings:
            found += [of[place + j] - (of[place + j - 1] if j else 0.0) for j in range(building.storeys)]
            place += building.storeys
        return found

    def _equations(self) -> list:
        """Eqs (2), (5), (6), (7) with m' = m1 m2 / (m1 + m2); parameters: a_g, its slope, a time, one switch a link."""
        ground = hy.par[0] + hy.par[1] * (hy.time - hy.par[2])
        force = [0.0 * u for u in self.u]
        mass, place = [], 0
        for building in self.scene.buildings:
            k = building.stiffness.tolist()
            for j in range(building.storeys):
                i = place + j
                shear = k[j] * (self.drifts[i] + building.beta * self.rates[i])
                force[i] = force[i] - shear - building.alpha * float(building.mass[j]) * self.v[i]
                if j:
                    force[i - 1] = force[i - 1] + shear
            mass += building.mass.tolist()
            place += building.storeys
        for e, (link, (left, right)) in enumerate(zip(self.scene.links, self.ends, strict=True)):
            assert link.kind == "pounding"
            assert not link.law.tension_cut
            reduced = mass[left] * mass[right] / (mass[left] + mass[right])
            dashpot = 2 * link.law.damping_ratio * math.sqrt(link.law.stiffness * reduced)
            closing = self.u[left] - self.u[right] - link.gap
            push = hy.par[3 + e] * (link.law.stiffness * closing + dashpot * (self.v[left] - self.v[right]))
            force[left], force[right] = force[left] - push, force[right] + push
        accelerations = [f / m - ground for f, m in zip(force, mass, strict=True)]
        return [*zip(self.u, self.v, strict=True), *zip(self.v, accelerations, strict=True)]

    def _switch(self, e: int) -> Callable:
        def callback(integrator, sign: int) -> bool:
            integrator.pars[3 + e] = 1.0 if sign > 0 else 0.0
            self.contacts[e] += sign > 0
            return True

        return callback

    def _peak(self, i: int) -> Callable:
        def callback(integrator, t: float, sign: int) -> None:
            integrator.update_d_output(t)
            self._raise(integrator.d_output, [i])

        return callback

    def _raise(self, state: np.ndarray, which) -> None:
        place = 0
        for building in self.scene.buildings:
            for j in range(building.storeys):
                i = place + j
                if i in which:
                    drift = state[i] - (state[i - 1] if j else 0.0)
                    self.peak[i] = max(self.peak[i], abs(drift))
            place += building.storeys

    def _start(self) -> None:
        """Integrate the first `START` without events and take it from there: at rest, touching, closing is zero and no
        event can be located. Links press at once where the closing of the unlinked buildings grows."""
        a = self.scene.motion.acceleration
        free = hy.taylor_adaptive(self._equations(), np.zeros(2 * self.storeys), pars=np.zeros(3 + len(self.ends)))
        gaps = np.array([link.gap for link in self.scene.links])
        pressing = np.zeros(len(gaps))
        for _ in range(2):  # first to see which links press, then with those
            free.time = 0.0
            free.state[:] = 0.0
            free.pars[:] = [a[0], (a[1] - a[0]) / self.scene.motion.dt, 0.0, *pressing]
            free.propagate_until(START)
            closing = np.array([free.state[left] - free.state[right] for left, right in self.ends])
            pressing = ((closing > 0) & (gaps == 0)).astype(float)
        ta = self.integrator
        ta.time = START
        ta.state[:] = free.state
        ta.pars[3:] = pressing
        ta.reset_cooldowns()
        self.contacts[:] = pressing
        self.peak[:] = 0.0

    def run(self) -> Elastic:
        """Integrate the whole motion, sample by sample."""
        motion, ta = self.scene.motion, self.integrator
        self._start()
        a = motion.acceleration
        begin = time.process_time()
        for j in range(a.size - 1):
            ta.pars[0], ta.pars[1], ta.pars[2] = a[j], (a[j + 1] - a[j]) / motion.dt, j * motion.dt
            ta.propagate_until((j + 1) * motion.dt)
        seconds = time.process_time() - begin
        self._raise(ta.state, range(self.storeys))
        n = self.storeys
        stiffness = np.concatenate([b.stiffness for b in self.scene.buildings])
        state = ta.state.copy()
        return Elastic(stiffness * self.peak, self.peak.copy(), self.contacts.copy(), state[:n], state[n:], seconds)
