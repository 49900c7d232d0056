"""`solve`: one scene in, one response out, whatever the method."""

from __future__ import annotations

import dataclasses
import functools
import gc
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import isfinite, nan
from typing import NamedTuple

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.kernels import kept, layout
from pounding_cli.methods import AUTO, METHODS, Method
from pounding_cli.model.building import Building
from pounding_cli.model.condense import condensed
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import taylor
from pounding_cli.solve.arrays import (
    NO_SAMPLES,
    Arrays,
    at_rest,
    begun_in_turn,
    drift_of,
    ended,
    memory_at_rest,
    pack,
    peaks_in,
    watched,
)
from pounding_cli.solve.choice import cheapest_method
from pounding_cli.solve.energy import AT_REST, Held, held
from pounding_cli.solve.ground import segments_of
from pounding_cli.solve.method import UNSTABLE, Integrator, integrator_of, refusal_of, step_taken
from pounding_cli.solve.read import read
from pounding_cli.solve.response import Response

MAX_STEPS = 20_000_000
MAX_EVENTS = 5_000_000

_compiled: set = set()


def solve(
    scene: Scene,
    accuracy: float = 1e-6,
    method: str = AUTO,
    initial: tuple[Sequence[np.ndarray], Sequence[np.ndarray]] | None = None,
    bounds: tuple[int, int] = (MAX_STEPS, MAX_EVENTS),
    *,
    time_step: float | None = None,
    all_effects: bool = False,
    watch: bool = False,
    ledger: bool = True,
    tangent: bool = False,
) -> Response:
    """The response of a scene.

    Parameters
    ----------
    scene : in SI units
    accuracy : wanted relative error of the peaks [-]; a method that takes a time step has no use for it
    method : a key of METHODS, or "auto" for the cheapest that keeps the accuracy
    initial : floor displacements [m] and velocities [m/s] relative to the ground, one array (n,) a building; None is
        rest
    bounds : most steps, most events
    time_step : of a method that takes one (`methods.METHODS`) [s]
    all_effects : simulate everything there is, whether or not it can matter here
    watch : keep the displacements at the end of every segment too (`Response.samples`)
    ledger : keep the energy ledger; without it a run takes a sixth less time, and nothing tells whether it lost energy,
        which is for runs that others are judged by (`assess`). Methods that keep it at no cost do so all the same
    tangent : carry the tangent of the motion along where it is known (`Response.moved`), a fifth more time

    Raises
    ------
    InputError : unknown method, a setting that it does not take or that is not above zero, or a scene that it does not
        run
    """
    prepared = prepare(
        scene, accuracy, method, initial, bounds, time_step=time_step, all_effects=all_effects, watch=watch,
        ledger=ledger, tangent=tangent,
    )  # fmt: skip
    prepared.integrate()
    return prepared.response()


@dataclass(eq=False)
class Prepared:
    """A scene laid out for its run; `integrate`, and then `response` or `read.read`, once each.

    scene : without what cannot matter
    what : what runs of it
    memory : what the run fills (`arrays.Begun`): before it the start, after it the end
    before : energy held at the start
    samples : of a run that is watched, as in `layout.Peaks`
    found : (status, steps, events, orders, seconds) of the run
    reached : time at its end [s]
    """

    scene: Scene
    what: WhatRuns
    setting: float
    accuracy: float
    bounds: tuple[int, int]
    watch: bool
    memory: np.ndarray
    before: Held
    samples: np.ndarray = field(default_factory=lambda: NO_SAMPLES)
    found: tuple[int, int, int, int, float] = (UNSTABLE, 0, 0, 0, 0.0)
    reached: float = nan

    def integrate(self) -> None:
        """Run it, unless the time step is too long to be stable."""
        scene, what, takes_step = self.scene, self.what, self.what.method.takes_step
        if takes_step and step_taken(scene, self.setting) > what.limit:
            return
        state, peaks, ledger, memory = begun_in_turn(what.arrays, self.memory)
        if self.watch:
            peaks = watched(peaks, segments_of(scene))
            self.samples = peaks.samples
        begin = time.perf_counter()
        status, steps, events, orders, self.reached = what.code.integrate(
            scene, what.arrays, state, peaks, ledger, self.setting, self.bounds
        )
        self.found = status, steps, events, orders, time.perf_counter() - begin
        self.memory = memory.copy()

    @property
    def is_done(self) -> bool:
        """Whether its run went to the end of the motion, or to a collapse."""
        return self.found[0] in (layout.DONE, layout.COLLAPSED)

    @property
    def carries_tangent(self) -> bool:
        """Whether it tells how far its motion moves it."""
        return self.what.code is taylor.WITH_TANGENT

    @property
    def keeps_ledger(self) -> bool:
        """Whether its ledger says anything."""
        return self.what.method.keeps_ledger and self.what.code.keeps_ledger

    def response(self) -> Response:
        """What came of it."""
        return read([self])[0].response()

    def collapse(self) -> tuple[float, int, int]:
        """When the run ended [s], the building and the storey that has drifted furthest of what it stands."""
        arrays = self.what.arrays
        drift = peaks_in(arrays, self.memory).drift
        parts = [drift[span] / arrays.slots.collapse[span] for span in arrays.floors]
        building = int(np.argmax([part.max() for part in parts]))
        return self.reached, building, int(np.argmax(parts[building])) + 1


def prepare(
    scene: Scene,
    accuracy: float = 1e-6,
    method: str = AUTO,
    initial: tuple[Sequence[np.ndarray], Sequence[np.ndarray]] | None = None,
    bounds: tuple[int, int] = (MAX_STEPS, MAX_EVENTS),
    *,
    time_step: float | None = None,
    all_effects: bool = False,
    watch: bool = False,
    ledger: bool = True,
    tangent: bool = False,
) -> Prepared:
    """A scene laid out for its run; parameters and errors as of `solve`."""
    chosen, setting = chosen_method(method, accuracy, time_step)
    what = _what_runs(
        scene.buildings,
        scene.links,
        scene.analysis,
        scene.motion.dt,
        chosen,
        accuracy,
        method == AUTO,
        all_effects,
        ledger,
        tangent,
    )
    if what.buildings is not scene.buildings and what.buildings != scene.buildings:
        scene = dataclasses.replace(scene, buildings=what.buildings)
    memory, before = what.at_rest, AT_REST
    if initial is not None:
        state, peaks, _, memory = at_rest(what.arrays)
        for span, u, v in zip(what.arrays.floors, *initial, strict=True):
            state.u[span], state.v[span] = u, v
            peaks.displacement_max[span], peaks.displacement_min[span] = u, u
        rows = ended(what.arrays, [memory]).state
        kinetic, stored, in_links = held([scene], [what.arrays], rows, drift_of(what.arrays, rows.u))
        before = float(kinetic[0]), float(stored[0]), float(in_links[0])
    return Prepared(scene, what, setting, accuracy, bounds, watch, memory, before)


class WhatRuns(NamedTuple):
    """What runs of a scene, whatever its motion.

    buildings, arrays : without what cannot matter
    limit : the longest stable time step [s]
    at_rest : the memory of a run before its first step
    effects, dropped : as of `Response`
    may_be_flagged : whether a law has something to say of a closing
    layout : the same for runs whose numbers can be read together: of the same buildings and analysis, with as many
        links
    """

    buildings: tuple[Building, ...]
    arrays: Arrays
    method: Method
    code: Integrator
    limit: float
    at_rest: np.ndarray
    effects: tuple[str, ...]
    dropped: tuple[str, ...]
    may_be_flagged: bool
    layout: tuple[object, ...]


@functools.lru_cache(maxsize=64)  # the same for every motion
def _what_runs(
    buildings: tuple[Building, ...],
    links: tuple[Link, ...],
    analysis: Analysis,
    dt: float,
    chosen: Method,
    accuracy: float,
    free: bool,
    all_effects: bool,
    ledger: bool,
    tangent: bool,
) -> WhatRuns:
    """What runs of scenes with motions of this time step [s].

    free : whether a cheaper method may take the place of the chosen one
    ledger, tangent : as in `solve`

    Raises
    ------
    InputError : a scene that the method does not run
    """
    scene = Scene(buildings, links, _still(dt), analysis)
    code = integrator_of(chosen)
    condensing: tuple[str, ...] = ()
    if all_effects and code is taylor.TAYLOR:
        code = taylor.ALL_EFFECTS
    elif not all_effects and not chosen.takes_step:
        scene, condensing = condensed(scene, accuracy)
    if reason := refusal_of(chosen, scene):
        hint = "write `method: taylor`, which runs every scene"
        raise InputError(Problem(f"method {chosen.name} does not run this scene: {reason}", hint))
    arrays = pack(scene)
    if free and not all_effects and (cheapest := METHODS[cheapest_method(scene, arrays)]) is not chosen:
        chosen, code = cheapest, integrator_of(cheapest)
        condensing += ("event location: nothing in the scene can change its stiffness, so it is stepped exactly",)
    if code is taylor.TAYLOR and taylor.solved_in_islands(arrays):
        condensing += ("the rest of the row, while a few touch or yield: what does not touch takes steps of its own",)
    if code is taylor.TAYLOR and not ledger:
        code = taylor.WITHOUT_LEDGER
    elif code is taylor.TAYLOR and tangent and taylor.carries_tangent(arrays):
        code = taylor.WITH_TANGENT
    _compile(code, scene, arrays, dt if chosen.takes_step else accuracy)
    effects = effects_of(scene)
    layout_of_run = id(arrays.laws), arrays.links.size, arrays.links.number, arrays.columns, id(code)
    return WhatRuns(
        scene.buildings, arrays, chosen, code, code.largest_step(arrays), memory_at_rest(arrays), effects.kept,
        effects.dropped + condensing, any([link.law.beyond_gap for link in links]), layout_of_run,
    )  # fmt: skip


@functools.lru_cache(maxsize=16)
def _still(dt: float) -> Motion:
    """Two samples of still ground."""
    return Motion("still", dt, np.zeros(2))


def _compile(code: Integrator, scene: Scene, arrays: Arrays, setting: float) -> None:
    """Compile or load the kernel for such a scene, which has two samples of silence: `seconds` counts solving alone."""
    sort = code.integrate, arrays.yields, taylor.takes_programs(arrays)
    if sort in _compiled:
        return
    bounds = MAX_STEPS, MAX_EVENTS

    def once() -> None:
        code.integrate(scene, arrays, *at_rest(arrays)[:3], setting, bounds)

    collecting = gc.isenabled()
    gc.disable()  # a compiler makes a million objects that all stay: looking through them takes a sixth of its time
    try:
        kept.loaded(once)
    finally:
        if collecting:
            gc.enable()
    _compiled.add(sort)


def chosen_method(name: str, accuracy: float, time_step: float | None = None) -> tuple[Method, float]:
    """The method of that name and its setting, checked; "auto" is the one that runs every scene.

    Raises
    ------
    InputError : no such method, a setting that it does not take, or one that is not above zero
    """
    if name != AUTO and name not in METHODS:
        raise InputError(Problem(f"there is no method {name}", f"write one of {', '.join((AUTO, *METHODS))}"))
    method = METHODS["taylor" if name == AUTO else name]
    if method.takes_step and time_step is None:
        hint = "give it one, e.g. `time_step=1e-4` [s]; fixed steps do not use an accuracy"
        raise InputError(Problem(f"method {name} takes a time step", hint))
    if time_step is not None and not method.takes_step:
        raise InputError(
            Problem(f"method {name} does not use a time step", "leave it out; `accuracy` controls the cost")
        )
    setting = accuracy if time_step is None else time_step
    if not (isfinite(setting) and setting > 0):
        what = method.setting
        hint = f"write e.g. `{what.key}: {what.example}`"
        raise InputError(Problem(f"{what.title} is {setting:g}; it must be above zero", hint))
    return method, setting
