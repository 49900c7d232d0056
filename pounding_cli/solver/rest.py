"""The drifts at rest, long after the motion: the residual drifts of a scene.

Two steps. The run goes on over still ground until its energy is too small to take any storey off its branch; and the
drift at rest is that of the equilibrium of these branches (`rest_state`), without waiting for the vibration to end.
Where a branch may always end, the run goes on until the vibration is small and the equilibrium settles (`Settling`).
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

SAFETY = 2.0
"""Error of a drift at rest over what follows from how it settles [-]: that depends on where in a swing it is looked at.
"""

LEAST_ERROR = 1e-10
"""Part of the largest drift [-] by which a drift at rest may be off, whatever the accuracy asked."""

# reasons why a scene has no drifts at rest, which its flag gives
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
    error : how far the vibration that was left may move a drift at rest, over the largest drift of the storey or line
        [-]; shape (scenes,)
    """

    drift: np.ndarray
    reasons: list[str]
    max_closing: np.ndarray
    error: np.ndarray


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
    count = len(run.scenes)
    closings = to_closings(layout, links["peak_v"], offsets)
    rest = Rest(np.full(peaks.shape, np.nan), [""] * count, closings, np.zeros(count))
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
    settling = Settling(layout, peaks, max(run.accuracy, LEAST_ERROR), LONGEST_STRETCH * period)
    elapsed = 0.0
    while places.size:
        state = RestState(layout, [run.scenes[place] for place in places.tolist()], data)
        is_at_rest, is_sure = state.is_at_rest(peaks[places])
        errors = np.zeros(places.size)
        if not (is_sure | ~is_at_rest).all() and not run.method.takes_step:
            errors = np.where(is_sure, 0.0, settling.find_errors(state, places))
        settling.remember(state, places)
        reasons = _find_reasons(state, is_at_rest, elapsed)
        is_over = is_at_rest & settling.is_over(places, is_at_rest, errors, elapsed)
        is_over |= is_at_rest & (data.run["status"] != records.DONE)
        for row, place in enumerate(places.tolist()):
            if reasons[row] and not np.isnan(rest.drift[place]).any():
                continue  # it was at rest before, and only did not settle
            rest.reasons[place] = reasons[row]
            if is_at_rest[row] and not reasons[row]:
                rest.drift[place] = state.drift[row, :first_link]
                rest.error[place] = errors[row]
            closing = np.maximum(data.elements["peak_v"][row], state.drift[row])[layout.of_links]
            rest.max_closing[place] = to_closings(layout, closing, offsets[place])
        goes_on = np.array([not (done or reason) for done, reason in zip(is_over, reasons, strict=True)], bool)
        places = places[goes_on]
        data = _copy_scenes(data, np.flatnonzero(goes_on))
        if places.size:
            elapsed += _go_on(run, data, places, period, min(period + 0.5 * elapsed, LONGEST_STRETCH * period))
    return rest


class Settling:
    """How the drifts at rest of scenes settle from one look to the next, where their vibration is only small.

    The equilibrium of the present branches moves in step with the amplitude of what is left, or less: so there follows
    from its change between two looks how far it still moves.

    wanted : error of a drift at rest over the largest drift that is small enough [-]
    grace : time that drifts have to settle in any case [s]
    first_rest : when scenes first were at rest [s], inf before; shape (scenes,)
    """

    def __init__(self, layout: Layout, peaks: np.ndarray, wanted: float, grace: float) -> None:
        """Begin with scenes at the end of their motion.

        peaks : largest drift of every storey and line [m], shape (scenes, elements before the links)
        """
        self.wanted = wanted
        self.grace = grace
        is_storey = layout.elements["drifts"][: peaks.shape[1]] > 0
        self.per_drift = np.where(is_storey, 1.0 / np.where(peaks > 0.0, peaks, math.inf), 0.0)
        self.drift = np.full_like(peaks, math.nan)
        self.drift_before = self.drift
        self.amplitude = np.full((len(peaks), 1), math.nan)
        self.first_rest = np.full(len(peaks), math.inf)

    def remember(self, state: RestState, places: np.ndarray) -> None:
        """Remember the equilibrium of the scenes at `places`, and the amplitude of what is left."""
        self.drift_before = self.drift.copy()
        self.drift[places] = state.drift[:, : self.drift.shape[1]]
        self.amplitude[places] = np.sqrt(state.twice_energy)

    def find_errors(self, state: RestState, places: np.ndarray) -> np.ndarray:
        """Return the errors [-] of the drifts at rest of the scenes at `places` since the last look, shape (places,).

        They are no more than how far the storeys still swing, all that is known at the first look.
        """
        count = self.drift.shape[1]
        before = self.drift[places]
        left = np.sqrt(state.twice_energy) / self.amplitude[places]
        moved = np.fmax(np.abs(state.drift[:, :count] - before), left * np.abs(before - self.drift_before[places]))
        still_moves = SAFETY * moved * left / np.where(left < 1.0, 1.0 - left, 0.0)
        return (np.fmin(still_moves, state.reach[:, :count]) * self.per_drift[places]).max(axis=1, initial=0.0)

    def is_over(self, places: np.ndarray, is_at_rest: np.ndarray, errors: np.ndarray, elapsed: float) -> np.ndarray:
        """Return whether scenes at rest have settled, or had as long for that as they took to come to rest.

        Parameters
        ----------
        places : of the scenes
        errors : of their drifts at rest [-]
        elapsed : time after the motion [s]
        """
        first_rest = np.where(is_at_rest, np.fmin(self.first_rest[places], elapsed), self.first_rest[places])
        self.first_rest[places] = first_rest
        return (errors <= self.wanted) | (elapsed >= np.fmin(2.0 * first_rest + self.grace, MAX_TAIL))


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
