"""The methods by name, and `solve`: one scene in, one response out, whatever the method."""

from __future__ import annotations

import dataclasses
import gc
import time
from collections.abc import Sequence

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.kernels import kept, layout
from pounding_cli.model.condense import condensed
from pounding_cli.model.effects import effects_of
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import central_difference, taylor
from pounding_cli.solve.arrays import at_rest, empty_ledger, no_peaks, pack, unpack
from pounding_cli.solve.choice import AUTO, cheapest_method
from pounding_cli.solve.energy import AT_REST, balance, held
from pounding_cli.solve.exponential import EXPONENTIAL
from pounding_cli.solve.flags import flags_of
from pounding_cli.solve.generalized_alpha import GENERALIZED_ALPHA, HHT_ALPHA
from pounding_cli.solve.ground import segments_of
from pounding_cli.solve.linear import central_difference_limit
from pounding_cli.solve.method import NO_ROOT, UNSTABLE, Method, step_taken
from pounding_cli.solve.newmark import NEWMARK
from pounding_cli.solve.response import Response
from pounding_cli.solve.runge_kutta import RUNGE_KUTTA, RUNGE_KUTTA_EVENTS

TAYLOR = Method(
    "taylor",
    "Taylor with events",
    0,
    "accuracy",
    "chooses its steps itself",
    "Jorba, A. & Zou, M. (2005). A software package for the numerical integration of ODEs by means of high-order "
    "Taylor methods. Exp. Math. 14(1).",
    taylor.integrate,
    keeps_ledger=True,
    located=True,
)
WITH_EVERYTHING = dataclasses.replace(TAYLOR, integrate=taylor.integrate_everything)
CENTRAL_DIFFERENCE = Method(
    "central-difference",
    "central difference",
    2,
    "time step",
    "time step below 2 / the largest circular frequency, all links closed; less with damping",
    "Newmark, N. M. (1959), with beta = 0; Bathe, K. J. (1996). Finite Element Procedures, section 9.2.1.",
    central_difference.integrate,
    largest_step=central_difference_limit,
)

METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        TAYLOR,
        RUNGE_KUTTA_EVENTS,
        RUNGE_KUTTA,
        CENTRAL_DIFFERENCE,
        NEWMARK,
        HHT_ALPHA,
        GENERALIZED_ALPHA,
        EXPONENTIAL,
    )
}
"""The family; what each states about itself: `method.Method`."""

OUTCOMES = {
    layout.DONE: ("done", ""),
    layout.EVENT_BOUND: ("event bound reached", "the floors chatter: check the links' stiffness and damping"),
    layout.STEP_BOUND: (
        "step bound reached",
        "a part of the scene is far stiffer than the rest: check stiffnesses and masses",
    ),
    layout.NOT_FINITE: ("not finite", "the numbers left the range of doubles: check masses and stiffnesses"),
    UNSTABLE: ("unstable step", ""),
    NO_ROOT: (
        "no root",
        "a contact force that jumps left Newton's equation without a root however short the step: take a method with "
        "events, such as taylor",
    ),
    layout.STALLED: (
        "stalled",
        "events follow one another without time going on: check for links that jump in force",
    ),
}
"""Kernel outcome to the words a user reads and what to do about it."""

LEDGER_BOUND = 1e-8
"""Energy residual over the input that is always allowed; a run asked for less accuracy may leave as much open as
that."""

OPEN_LEDGER = (
    "energy does not close",
    "the series lost more than the accuracy asked: ask for a finer accuracy, or soften what is extremely stiff",
)

MOST_STEPS = 20_000_000
MOST_EVENTS = 5_000_000

_compiled: set = set()


def is_compiled() -> bool:
    """Whether some kernel has run in this process, so that the next call does not compile."""
    return bool(_compiled)


def solve(
    scene: Scene,
    accuracy: float = 1e-6,
    method: str = AUTO,
    initial: tuple[Sequence[np.ndarray], Sequence[np.ndarray]] | None = None,
    bounds: tuple[int, int] = (MOST_STEPS, MOST_EVENTS),
    *,
    all_effects: bool = False,
    watch: bool = False,
) -> Response:
    """The response of a scene.

    Parameters
    ----------
    scene : in SI units
    accuracy : wanted relative error of the peaks [-]; for methods whose setting is a time step, that step [s]
    method : a key of METHODS, or "auto" for the cheapest that keeps the accuracy
    initial : floor displacements [m] and velocities [m/s] relative to the ground, one array (n,) a building; None is
        rest
    bounds : most steps, most events
    all_effects : simulate everything there is, whether or not it can matter here
    watch : keep the displacements at the end of every segment too (`Response.samples`)

    Raises
    ------
    InputError : unknown method, a setting that is not above zero, or a scene that the method does not run
    """
    chosen = chosen_method(method, accuracy)
    condensing: tuple[str, ...] = ()
    if all_effects and chosen is TAYLOR:
        chosen = WITH_EVERYTHING
    elif not all_effects and not chosen.takes_step:
        scene, condensing = condensed(scene, accuracy)
    if reason := chosen.refusal(scene):
        hint = "write `method: taylor`, which runs every scene"
        raise InputError(Problem(f"method {method} does not run this scene: {reason}", hint))
    arrays = pack(scene)
    if method == AUTO and not all_effects and cheapest_method(scene, arrays) == EXPONENTIAL.name:
        chosen = EXPONENTIAL
        condensing += ("event location: nothing in the scene can change its stiffness, so it is stepped exactly",)
    if chosen is TAYLOR and taylor.solved_in_islands(scene, arrays):
        condensing += ("the rest of the row, while a few touch or yield: what does not touch takes steps of its own",)
    state, peaks = at_rest(arrays), no_peaks(arrays, segments_of(scene) if watch else 0)
    if initial is not None:
        for span, u, v in zip(arrays.floors, *initial, strict=True):
            state.u[span], state.v[span] = u, v
            peaks.displacement_max[span], peaks.displacement_min[span] = u, u
    ledger, before = empty_ledger(arrays), AT_REST if initial is None else held(scene, arrays, state)
    limit = chosen.largest_step(arrays)
    status, steps, events, orders, seconds = UNSTABLE, 0, 0, 0, 0.0
    if not chosen.takes_step or step_taken(scene, accuracy) <= limit:
        _compile(chosen, scene, accuracy)
        begin = time.perf_counter()
        status, steps, events, orders, _ = chosen.integrate(scene, arrays, state, peaks, ledger, accuracy, bounds)
        seconds = time.perf_counter() - begin
    if status == layout.DONE and not np.isfinite(np.concatenate([peak.ravel() for peak in peaks[1:]])).all():
        status = layout.NOT_FINITE
    energy = balance(scene, arrays, before, state, ledger) if chosen.keeps_ledger else {}
    outcome, advice = OUTCOMES[status]
    if status == layout.DONE and abs(energy.get("residual", 0.0)) > max(accuracy, LEDGER_BOUND):
        outcome, advice = OPEN_LEDGER
    if outcome != "done":  # no number of a run that failed is ever shown
        for numbers in (*peaks[1:-1], state.u, state.v, state.phi):
            numbers.fill(np.nan)
    buildings, links = unpack(scene, arrays, state, peaks)
    if status == UNSTABLE:
        advice = f"the motion would grow without bound: take a time step below {limit:.2g} s, or method: taylor"
    note = chosen.note(steps, events)
    effects = effects_of(scene)
    return Response(
        buildings, links, outcome, advice, chosen.name, accuracy, steps, events, seconds, orders=orders,
        energy=energy,
        flags=flags_of(scene, links) + ((note,) if note else ()),
        effects=effects.kept, dropped=effects.dropped + condensing,
        final=tuple((state.u[span].copy(), state.v[span].copy()) for span in arrays.floors),
        samples=tuple(peaks.samples[:, span].copy() for span in arrays.floors if watch),
    )  # fmt: skip


def _compile(chosen: Method, scene: Scene, setting: float) -> None:
    """Compile or load the kernel for such a scene on two samples of silence, so that `seconds` counts solving alone."""
    sort = (chosen, effects_of(scene).yielding)
    if sort in _compiled:
        return
    still = Motion("still", scene.motion.dt, np.zeros(2))
    silent = dataclasses.replace(scene, motion=still, tail=0.0)
    arrays = pack(silent)
    bounds = MOST_STEPS, MOST_EVENTS
    step = scene.motion.dt if chosen.takes_step else setting

    def once() -> None:
        chosen.integrate(silent, arrays, at_rest(arrays), no_peaks(arrays), empty_ledger(arrays), step, bounds)

    collecting = gc.isenabled()
    gc.disable()  # a compiler makes a million objects that all stay: looking through them takes a sixth of its time
    try:
        kept.loaded(once)
    finally:
        if collecting:
            gc.enable()
    _compiled.add(sort)


def chosen_method(name: str, setting: float) -> Method:
    """The method of that name, its setting checked; "auto" is the one that runs every scene.

    Raises
    ------
    InputError : no such method, or a setting that is not above zero
    """
    if name == AUTO:
        name = TAYLOR.name
    if name not in METHODS:
        raise InputError(Problem(f"there is no method {name}", f"write one of {', '.join((AUTO, *METHODS))}"))
    if not (np.isfinite(setting) and setting > 0):
        what = METHODS[name].setting
        raise InputError(Problem(f"{what} is {setting:g}; it must be above zero", f"write e.g. `{what}: 1e-4`"))
    return METHODS[name]
