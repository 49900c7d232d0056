"""`solve`: one scene in, one response out, whatever the method."""

from __future__ import annotations

import dataclasses
import functools
import gc
import time
from collections.abc import Sequence
from dataclasses import dataclass
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
from pounding_cli.solve.arrays import Arrays, Begun, at_rest, drift_of, ended, pack
from pounding_cli.solve.choice import cheapest_method
from pounding_cli.solve.energy import AT_REST, Held, balance, held
from pounding_cli.solve.flags import collapse_flag, flags_of
from pounding_cli.solve.ground import segments_of
from pounding_cli.solve.method import NO_ROOT, UNSTABLE, Integrator, integrator_of, refusal_of, step_taken
from pounding_cli.solve.response import COLLAPSED, DONE, Response
from pounding_cli.solve.response import OUTCOMES as ENDS
from pounding_cli.solve.unpack import Unpacked, unpack

OUTCOMES = {
    layout.DONE: (DONE, ""),
    layout.COLLAPSED: (COLLAPSED, ""),
    layout.EVENT_BOUND: (
        "event bound reached",
        "the floors strike each other too often: check the stiffness and damping of the links",
    ),
    layout.STEP_BOUND: (
        "step bound reached",
        "a part of the scene is far stiffer than the rest: check stiffnesses and masses",
    ),
    layout.NOT_FINITE: ("not finite", "the numbers exceed the range of double precision: check masses and stiffnesses"),
    UNSTABLE: ("unstable step", ""),
    NO_ROOT: (
        "no root",
        "Newton's method found no root at any step, because a contact force jumps: use a method with events, such as "
        "taylor",
    ),
    layout.STALLED: (
        "stalled",
        "events repeat without advancing in time: check for links whose force jumps",
    ),
}
"""Kernel outcome to the words a user reads and what to do about it."""

LEDGER_BOUND = 1e-8
"""Energy residual over the input that is always allowed; a run asked for less accuracy may leave as much open as
that."""

OPEN_LEDGER = (
    "energy does not close",
    "the error of the series exceeds the accuracy asked: set a finer accuracy, or reduce extreme stiffnesses",
)

MAX_STEPS = 20_000_000
MAX_EVENTS = 5_000_000

_compiled: set = set()


def is_compiled() -> bool:
    """Whether some kernel has run in this process, so that the next call does not compile."""
    return bool(_compiled)


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

    Raises
    ------
    InputError : unknown method, a setting that it does not take or that is not above zero, or a scene that it does not
        run
    """
    prepared = prepare(
        scene, accuracy, method, initial, bounds, time_step=time_step, all_effects=all_effects, watch=watch,
        ledger=ledger,
    )  # fmt: skip
    prepared.integrate()
    return prepared.response()


@dataclass(eq=False)
class Prepared:
    """A scene laid out for its run; `integrate`, and then `response` or `responses`, once each.

    scene, arrays : without what cannot matter
    begun : what the run fills
    before : energy held at the start
    limit : the longest stable time step [s]
    condensing : what is left out, in words
    found : (status, steps, events, orders, seconds) of the run
    reached : time at its end [s]
    """

    scene: Scene
    arrays: Arrays
    method: Method
    code: Integrator
    setting: float
    accuracy: float
    bounds: tuple[int, int]
    watch: bool
    begun: Begun
    before: Held
    limit: float
    condensing: tuple[str, ...]
    found: tuple[int, int, int, int, float] = (UNSTABLE, 0, 0, 0, 0.0)
    reached: float = nan

    def integrate(self) -> None:
        """Run it, unless the time step is too long to be stable."""
        scene, takes_step = self.scene, self.method.takes_step
        if takes_step and step_taken(scene, self.setting) > self.limit:
            return
        _compile(self.code, scene, self.arrays, scene.motion.dt if takes_step else self.setting)
        begin = time.perf_counter()
        status, steps, events, orders, self.reached = self.code.integrate(
            scene, self.arrays, *self.begun[:3], self.setting, self.bounds
        )
        self.found = status, steps, events, orders, time.perf_counter() - begin

    @property
    def is_done(self) -> bool:
        """Whether its run went to the end of the motion, or to a collapse."""
        return self.found[0] in (layout.DONE, layout.COLLAPSED)

    @property
    def keeps_ledger(self) -> bool:
        """Whether its ledger says anything."""
        return self.method.keeps_ledger and self.code.keeps_ledger

    def response(self) -> Response:
        """What came of it."""
        return responses([self])[0]

    def collapse(self) -> tuple[float, int, int]:
        """When the run ended [s], the building and the storey that has drifted furthest of what it stands."""
        parts = [self.begun.peaks.drift[span] / self.arrays.slots.collapse[span] for span in self.arrays.floors]
        building = int(np.argmax([part.max() for part in parts]))
        return self.reached, building, int(np.argmax(parts[building])) + 1

    @property
    def layout(self) -> tuple[object, ...]:
        """The same for runs whose numbers can be read together: of the same buildings, with as many links."""
        arrays = self.arrays
        return id(arrays.slots.mass), arrays.links.size, arrays.links.number, arrays.columns, self.keeps_ledger


def responses(runs: Sequence[Prepared]) -> list[Response]:
    """What came of runs, in their order; those that are laid out alike are read as rows of the same arrays, since a
    row's numbers cost as little as the smallest step of Python."""
    if len(runs) == 1:
        return _responses(runs)
    alike: dict[tuple[object, ...], list[int]] = {}
    for place, run in enumerate(runs):
        alike.setdefault(run.layout, []).append(place)
    found: dict[int, Response] = {}
    for places in alike.values():
        found |= zip(places, _responses([runs[place] for place in places]), strict=True)
    return [found[place] for place in range(len(runs))]


def _responses(runs: Sequence[Prepared]) -> list[Response]:
    """Of runs that are laid out alike."""
    arrays, scenes = runs[0].arrays, [run.scene for run in runs]
    state, peaks, ledger, finite = ended(arrays, [run.begun for run in runs])
    drift = drift_of(arrays, state.u)
    books: list[dict[str, float]] = [{} for _ in runs]
    if runs[0].keeps_ledger:
        with np.errstate(over="ignore", invalid="ignore"):  # a run that failed may have ended at any numbers
            every = [run.arrays for run in runs]
            books = balance(scenes, every, [run.before for run in runs], state, drift, peaks, ledger)
    ends = [_end(run, is_finite, book) for run, is_finite, book in zip(runs, finite.tolist(), books, strict=True)]
    for row, (outcome, _) in enumerate(ends):
        if outcome not in ENDS:  # no number of a run that failed is ever shown
            for numbers in (*(each for each in peaks[1:-1] if each is not peaks.samples), state.u, state.v, drift):
                numbers[row].fill(np.nan)
            runs[row].begun.peaks.samples.fill(np.nan)
    unpacked = unpack(scenes, arrays, drift, peaks)
    final = list(zip(*(zip(state.u[:, span], state.v[:, span], strict=True) for span in arrays.floors), strict=True))
    return [_response(*each) for each in zip(runs, ends, books, unpacked, final, strict=True)]


def _end(run: Prepared, is_finite: bool, energy: dict[str, float]) -> tuple[str, str]:
    """How a run ended, in words, and what to do about it."""
    status = run.found[0]
    if status == UNSTABLE:
        advice = f"the solution would grow without bound: use a time step below {run.limit:.2g} s, or method: taylor"
        return OUTCOMES[status][0], advice
    if status == layout.DONE and not (is_finite and np.isfinite(run.begun.peaks.samples).all()):
        status = layout.NOT_FINITE
    end = OUTCOMES[status]
    if end[0] in ENDS and abs(energy.get("residual", 0.0)) > max(run.accuracy, LEDGER_BOUND):
        return OPEN_LEDGER
    return end


def _response(
    run: Prepared,
    end: tuple[str, str],
    energy: dict[str, float],
    unpacked: Unpacked,
    final: tuple[tuple[np.ndarray, np.ndarray], ...],
) -> Response:
    """From what was read of a run."""
    scene, (buildings, links, columns) = run.scene, unpacked
    _, steps, events, orders, seconds = run.found
    note = run.code.note(steps, events)
    effects = effects_of(scene)
    where = run.collapse() if end[0] == COLLAPSED else (nan, -1, 0)
    takes_step, samples = run.method.takes_step, run.begun.peaks.samples
    return Response(
        buildings, links, *end, run.method.name, nan if takes_step else run.accuracy, steps, events,
        seconds, orders=orders, time_step=run.setting if takes_step else nan, energy=energy,
        flags=collapse_flag(scene, *where) + flags_of(scene, links) + ((note,) if note else ()),
        effects=effects.kept, dropped=effects.dropped + run.condensing, final=final,
        samples=tuple(samples[:, span].copy() for span in run.arrays.floors) if run.watch else (),
        collapse_time=where[0], collapse_building=where[1], collapse_storey=where[2], columns=columns,
    )  # fmt: skip


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
) -> Prepared:
    """A scene laid out for its run; parameters and errors as of `solve`."""
    chosen, setting = chosen_method(method, accuracy, time_step)
    buildings, links, analysis = tuple(scene.buildings), tuple(scene.links), scene.analysis
    runs = _what_runs(
        buildings, links, analysis, scene.motion.dt, chosen, accuracy, method == AUTO, all_effects, ledger
    )
    arrays = runs.arrays
    if runs.buildings != buildings:
        scene = dataclasses.replace(scene, buildings=runs.buildings)
    begun = at_rest(arrays, segments_of(scene) if watch else 0)
    if initial is not None:
        state, peaks, *_ = begun
        for span, u, v in zip(arrays.floors, *initial, strict=True):
            state.u[span], state.v[span] = u, v
            peaks.displacement_max[span], peaks.displacement_min[span] = u, u
    before = AT_REST
    if initial is not None:
        rows = ended(arrays, [begun]).state
        kinetic, stored, in_links = held([scene], [arrays], rows, drift_of(arrays, rows.u))
        before = float(kinetic[0]), float(stored[0]), float(in_links[0])
    return Prepared(
        scene, arrays, runs.method, runs.code, setting, accuracy, bounds, watch, begun, before, runs.limit,
        runs.condensing,
    )  # fmt: skip


class _Runs(NamedTuple):
    """What runs of a scene: its buildings without what cannot matter, its arrays, method and code, what is left out in
    words, and the longest stable time step [s]."""

    buildings: tuple[Building, ...]
    arrays: Arrays
    method: Method
    code: Integrator
    condensing: tuple[str, ...]
    limit: float


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
) -> _Runs:
    """What runs of scenes with motions of this time step [s].

    free : whether a cheaper method may take the place of the chosen one
    ledger : as in `solve`

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
    return _Runs(scene.buildings, arrays, chosen, code, condensing, code.largest_step(arrays))


@functools.lru_cache(maxsize=16)
def _still(dt: float) -> Motion:
    """Two samples of still ground."""
    return Motion("still", dt, np.zeros(2))


def _compile(code: Integrator, scene: Scene, arrays: Arrays, setting: float) -> None:
    """Compile or load the kernel for such a scene on two samples of silence, so that `seconds` counts solving alone."""
    sort = code.integrate, arrays.yields, taylor.takes_programs(arrays)
    if sort in _compiled:
        return
    silent = dataclasses.replace(scene, motion=_still(scene.motion.dt), tail=0.0)
    bounds = MAX_STEPS, MAX_EVENTS

    def once() -> None:
        code.integrate(silent, arrays, *at_rest(arrays)[:3], setting, bounds)

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
