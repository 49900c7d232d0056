"""The drifts at rest, long after the motion: the residual drifts of a scene.

Two steps. The run goes on over still ground until its energy is too small to take any storey off its branch; and the
drift at rest is that of the equilibrium of these branches (`rest_state`), without waiting for the vibration to end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.laws.formula import WrittenLaw
from pounding_cli.model.scene import Scene
from pounding_cli.solver import records
from pounding_cli.solver.assemble import NOTHING_KEPT
from pounding_cli.solver.layout import Layout
from pounding_cli.solver.outcome import to_closings
from pounding_cli.solver.records import Data, Room
from pounding_cli.solver.rest_state import RestState, find_longest_period

if TYPE_CHECKING:
    from pounding_cli.solver.solve import SceneRun

MAX_TAIL = 600.0
"""Time after the motion [s] within which a scene must come to rest."""

MAX_STEPS = 50_000
"""Steps, and events, in which it must."""

STEPS_A_PERIOD = 8
"""Segments of still ground in the longest period."""

LONGEST_STRETCH = 6.0
"""Longest periods after which a scene is looked at again at the latest: what is long at rest is rounding, which smooth
laws follow by short steps."""

NO_RESIDUAL_DRIFT = "no residual drift"
"""The flag of a scene without drifts at rest; its detail is one of these reasons."""

# reasons why a scene has no drifts at rest
NEVER_AT_REST = "nothing damps the vibration after the motion"
NOT_AT_REST = f"not at rest {MAX_TAIL:g} s after the motion"
COLLAPSES_LATER = "a storey collapses in free vibration after the motion"
NOT_FOLLOWED = f"the free vibration after the motion takes more than {MAX_STEPS:,} steps"
NOT_SOLVED = "the free vibration after the motion could not be solved"


@dataclass(frozen=True)
class Rest:
    """The drifts at rest of the scenes of a run.

    drift : of every storey, base spring and frame line [m], of a twist [rad], NaN where there is none; shape (scenes,
        elements before the links)
    reasons : why there is none, "" where there is or where none is asked for; one a scene
    max_closing : largest closing of every link in the motion, and until the scene is at rest where that is asked [m];
        shape (scenes, links)
    """

    drift: np.ndarray
    reasons: list[str]
    max_closing: np.ndarray


def find_rest(run: SceneRun, is_done: np.ndarray) -> Rest:
    """Find the drifts at rest of those scenes of a run that came to the end of their motion.

    They are 0 without any cost where nothing holds a storey away from where it was; else they are found where they are
    asked for.

    is_done : whether a scene came to the end of its motion, shape (scenes,)
    """
    layout = run.layout
    links = run.data.elements[:, run.layout.of_links]
    first_link = layout.of_links.start
    offsets = links["offset"]
    peaks = run.data.elements["peak_v"][:, :first_link].copy()
    rest = Rest(np.full(peaks.shape, np.nan), [""] * len(run.scenes), to_closings(layout, links["peak_v"], offsets))
    is_asked = np.array([scene.residual_drift for scene in run.scenes], bool) & is_done
    if not _has_memory(layout, run.scenes[0]):
        rest.drift[is_done] = 0.0
        return rest
    places = np.flatnonzero(is_asked)
    if not places.size:
        return rest
    data = _copy_scenes(run.data, places)
    data.run["resumes"] = 1
    data.run["steps"] = 0
    data.run["events"] = 0
    data.run["most_steps"] = MAX_STEPS
    data.run["most_events"] = MAX_STEPS
    period = find_longest_period(layout)
    elapsed = 0.0
    while places.size:
        state = RestState(layout, [run.scenes[place] for place in places.tolist()], data)
        is_at_rest = state.is_at_rest(peaks[places])
        reasons = _find_reasons(state, is_at_rest, elapsed)
        for row, place in enumerate(places.tolist()):
            rest.reasons[place] = reasons[row]
            if is_at_rest[row] and not reasons[row]:
                rest.drift[place] = state.drift[row, :first_link]
            closing = np.maximum(data.elements["peak_v"][row], state.drift[row])[layout.of_links]
            rest.max_closing[place] = to_closings(layout, closing, offsets[place])
        goes_on = np.array([not (done or reason) for done, reason in zip(is_at_rest, reasons, strict=True)], bool)
        places = places[goes_on]
        data = _copy_scenes(data, np.flatnonzero(goes_on))
        if places.size:
            elapsed += _go_on(run, data, places, period, min(period + 0.5 * elapsed, LONGEST_STRETCH * period))
    return rest


def _has_memory(layout: Layout, scene: Scene) -> bool:
    """Return whether anything may hold a scene away from where it was before the motion."""
    remembers = any(link.law.path_dependent or isinstance(link.law, WrittenLaw) for link in scene.links)
    yields = layout.elements["yields"] > 0
    if not scene.links:  # isolators hold a base away from the middle, but no storey above it
        yields = np.concatenate([yields[span] for span in (*layout.floors, layout.of_lines)])
    return remembers or bool(yields.any())


def _copy_scenes(data: Data, rows: np.ndarray) -> Data:
    """Copy the records of some scenes of a run, to go on without changing what the motion has left."""
    room = None if data.room is None else Room(data.room.states[rows], data.room.formulas[rows])
    return data._replace(
        dofs=data.dofs[rows], elements=data.elements[rows], run=data.run[rows], series=data.series[rows],
        columns=data.columns[rows], room=room, watch=NOTHING_KEPT,
    )  # fmt: skip


def _go_on(run: SceneRun, data: Data, places: np.ndarray, period: float, length: float) -> float:
    """Let scenes vibrate freely for about `length` [s]; return for how long they did [s]."""
    dt = run.scenes[0].motion.dt if run.method.takes_step else period / STEPS_A_PERIOD
    longest_step = data.run["most_h"] / data.run["dt"]  # part of a segment
    data.run["dt"] = dt
    data.run["rest"] = dt
    data.run["most_h"] = longest_step * dt
    count = max(1, math.ceil(length / dt))
    run.integrate_records(data, places, [(np.zeros(count), np.zeros(count))] * places.size)
    return count * dt


def _find_reasons(state: RestState, is_at_rest: np.ndarray, elapsed: float) -> list[str]:
    """Return why scenes have no drifts at rest, "" where they have or may have them yet."""
    reasons = []
    is_undamped = state.is_undamped()
    for row, status in enumerate(state.data.run["status"].tolist()):
        reason = ""
        if status == records.COLLAPSED:
            reason = COLLAPSES_LATER
        elif status in (records.STEP_BOUND, records.EVENT_BOUND):
            reason = "" if is_at_rest[row] else NOT_FOLLOWED
        elif status != records.DONE:
            reason = NOT_SOLVED
        elif is_undamped[row] and not (is_at_rest[row] and not state.drift[row].any()):
            reason = NEVER_AT_REST
        elif not is_at_rest[row] and elapsed >= MAX_TAIL:
            reason = NOT_AT_REST
        reasons.append(reason)
    return reasons
