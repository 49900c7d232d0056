"""The drifts at rest, long after the motion: the residual drifts of a scene.

Two steps. The run goes on over still ground until its energy is too small to take any storey off its branch; and the
drift at rest is that of the equilibrium of these branches, without waiting for the vibration to end.

With the stiffness matrix K of the present branches and the displacements u* of their equilibrium, a scene still holds

    H = sum(m u'^2) / 2 + (u - u*)^T K (u - u*) / 2   and what its contacts store,

and on still ground nothing adds to it. So the deformation w^T u of an element is never further from w^T u* than
sqrt(2 H w^T K^-1 w), its *reach*. A contact that is open at rest only takes from H, whether it closes on the way or
not.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.laws import BEHAVIOURS
from pounding_cli.laws.formula import WRITTEN_BEHAVIOUR, WrittenLaw, carried_out
from pounding_cli.laws.joints import Maxwell
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.scene import Scene
from pounding_cli.solver import records
from pounding_cli.solver.assemble import NOTHING_KEPT, Layout, term_matrix
from pounding_cli.solver.events import TOUCH
from pounding_cli.solver.outcome import forces_now
from pounding_cli.solver.records import Data, Room

if TYPE_CHECKING:
    from pounding_cli.solver.solve import Prepared

STILL = 5e-4
"""Reach of a storey over its drift at rest [-] at which it counts as at rest although its branch may still end."""

LEAST_DRIFT = 0.02
"""Part of a storey's largest drift [-] that stands for its drift at rest where that is smaller."""

MAX_TAIL = 600.0
"""Time after the motion [s] within which a scene must come to rest."""

MAX_STEPS = 50_000
"""Steps, and events, in which it must."""

STEPS_A_PERIOD = 8
"""Segments of still ground in the longest period."""

LONGEST_STRETCH = 6.0
"""Longest periods after which a scene is looked at again at the latest: what is long at rest is rounding, which smooth
laws follow by short steps."""

UNDAMPED = 1e-6
"""Damping ratio [-] below which a mode counts as undamped."""

STUCK_WITHIN = 1e-6
"""Displacement [m] at which a spring in place of a slider that sticks would reach its friction."""

ROUNDING = 1e-13
"""Drift at rest over the largest displacement [-] below which it is rounding."""

NUDGE = 1e-6
"""Part of a deformation by which the slope of a curved force is found."""

NO_RESIDUAL_DRIFT = "no residual drift"
"""The flag of a scene without drifts at rest; its detail is one of these reasons."""

NEVER_AT_REST = "nothing damps the vibration after the motion"
NOT_AT_REST = f"not at rest {MAX_TAIL:g} s after the motion"
COLLAPSES_LATER = "a storey collapses in free vibration after the motion"
NOT_FOLLOWED = f"the free vibration after the motion takes more than {MAX_STEPS:,} steps"
NOT_SOLVED = "the free vibration after the motion could not be solved"


@dataclass(frozen=True)
class Rest:
    """The drifts at rest of the scenes of a run.

    drift : of every storey and base spring [m], NaN where there is none; shape (scenes, degrees of freedom)
    reasons : why there is none, "" where there is; one a scene
    max_closing : largest closing of every link until the scene is at rest, the motion included [m];
        shape (scenes, links)
    """

    drift: np.ndarray
    reasons: list[str]
    max_closing: np.ndarray


def find_rest(run: Prepared, is_done: np.ndarray) -> Rest:
    """Find the drifts at rest of those scenes of a run that came to the end of their motion (`is_done`)."""
    layout, n, links = run.layout, run.layout.number, run.data.elements[:, run.layout.of_links]
    offsets, peaks = links["offset"], run.data.elements["peak_v"][:, :n].copy()
    rest = Rest(np.full(peaks.shape, np.nan), [""] * len(run.scenes), links["peak_v"] + offsets)
    if not _has_memory(layout, run.scenes[0]):
        rest.drift[is_done] = 0.0
        return rest
    places = np.flatnonzero(is_done)
    data = _copy_scenes(run.data, places)
    data.run["resumes"] = 1
    data.run["steps"] = 0
    data.run["events"] = 0
    data.run["most_steps"] = MAX_STEPS
    data.run["most_events"] = MAX_STEPS
    period = _longest_period(layout)
    elapsed = 0.0
    while places.size:
        state = _State(layout, [run.scenes[place] for place in places.tolist()], data)
        is_at_rest = state.is_at_rest(peaks[places])
        reasons = _find_reasons(state, is_at_rest, elapsed)
        for row, place in enumerate(places.tolist()):
            rest.reasons[place] = reasons[row]
            if is_at_rest[row] and not reasons[row]:
                rest.drift[place] = state.drift[row, :n]
            closing = np.maximum(data.elements["peak_v"][row], state.drift[row])[layout.of_links]
            rest.max_closing[place] = closing + offsets[place]
        goes_on = np.array([not (done or reason) for done, reason in zip(is_at_rest, reasons, strict=True)], bool)
        places = places[goes_on]
        data = _copy_scenes(data, np.flatnonzero(goes_on))
        if places.size:
            elapsed += _go_on(run, data, places, period, min(period + 0.5 * elapsed, LONGEST_STRETCH * period))
    return rest


def _has_memory(layout: Layout, scene: Scene) -> bool:
    """Return whether anything may hold a scene away from where it was before the motion."""
    remembers = any(link.law.remembers or isinstance(link.law, WrittenLaw) for link in scene.links)
    yields = layout.elements["yields"] > 0
    if not scene.links:  # isolators hold a base away from the middle, but no storey above it
        yields = np.concatenate([yields[floors] for floors in layout.floors])
    return remembers or bool(yields.any())


def _always_takes_energy(law: LinkLaw) -> bool:
    """Return whether a link may take energy at any closing, by more than the dashpot of its branch."""
    return law.joins and (law.takes_energy or isinstance(law, WrittenLaw))


def _copy_scenes(data: Data, rows: np.ndarray) -> Data:
    """Copy the records of some scenes of a run, to go on without changing what the motion has left."""
    room = None if data.room is None else Room(data.room.states[rows], data.room.formulas[rows])
    return data._replace(
        dofs=data.dofs[rows], elements=data.elements[rows], run=data.run[rows], series=data.series[rows],
        columns=data.columns[rows], room=room, watch=NOTHING_KEPT,
    )  # fmt: skip


def _go_on(run: Prepared, data: Data, places: np.ndarray, period: float, length: float) -> float:
    """Let scenes vibrate freely for about `length` [s]; return for how long they did [s]."""
    dt = run.scenes[0].motion.dt if run.method.takes_step else period / STEPS_A_PERIOD
    longest_step = data.run["most_h"] / data.run["dt"]  # part of a segment
    data.run["dt"] = dt
    data.run["rest"] = dt
    data.run["most_h"] = longest_step * dt
    count = max(1, math.ceil(length / dt))
    run.integrate_records(data, places, [(np.zeros(count), np.zeros(count))] * places.size)
    return count * dt


def _find_reasons(state: _State, is_at_rest: np.ndarray, elapsed: float) -> list[str]:
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


@functools.lru_cache(maxsize=64)
def _shape_of(layout: Layout) -> np.ndarray:
    """Return `term_matrix` of a layout, made once."""
    return term_matrix(layout)


@functools.lru_cache(maxsize=64)
def _load_matrix(layout: Layout) -> np.ndarray:
    """Return the stiffness that P-Delta takes away [N/m], shape (n, n). The weight acts on the floors alone."""
    rows = np.eye(layout.number)
    for i in range(1, layout.number):
        rows[i, i - 1] = -layout.dofs["below"][i]
    return rows.T @ (layout.elements["load"][: layout.number, None] * rows)


def _stiffness_matrix(layout: Layout, k: np.ndarray) -> np.ndarray:
    """Return the stiffness matrices of elements of the stiffnesses k [N/m], shape (scenes, n, n). What does not move
    has 1 N/m on the diagonal and nothing beside it."""
    shape = _shape_of(layout)
    matrix = shape.T @ (k[:, :, None] * shape) - _load_matrix(layout)
    still = np.flatnonzero(layout.dofs["inv_mass"] == 0.0)
    matrix[:, still, :] = 0.0
    matrix[:, :, still] = 0.0
    matrix[:, still, still] = 1.0
    return matrix


@functools.lru_cache(maxsize=64)
def _modes(layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """Return the frequencies [rad/s] of the buildings with their initial stiffnesses, without links, and their shapes
    over the square roots of the masses, of what moves; shapes (modes,) and (n, modes)."""
    n = layout.number
    k = np.zeros((1, layout.elements.size))
    k[0, :n] = layout.elements["p"][:n, 0]
    slides = layout.elements["slides"] > 0
    k[0, slides] += layout.elements["p"][slides, 1] / STUCK_WITHIN
    root = np.sqrt(layout.dofs["inv_mass"])
    squares, shapes = np.linalg.eigh(_stiffness_matrix(layout, k)[0] * np.outer(root, root))
    moves = squares > 0.0
    return np.sqrt(squares[moves]), root[:, None] * shapes[:, moves]


def _longest_period(layout: Layout) -> float:
    """Return the longest period of the buildings with their initial stiffnesses [s]."""
    return 2.0 * math.pi / float(_modes(layout)[0].min(initial=math.inf))


class _State:
    """Scenes of one layout at a time after the motion, on their present branches.

    drift : deformation of every element at the equilibrium of these branches [m], shape (scenes, elements)
    reach : how far every element may ever get from there [m], inf where that is not bounded
    """

    def __init__(self, layout: Layout, scenes: Sequence[Scene], data: Data) -> None:
        self.layout = layout
        self.scenes = scenes
        self.data = data
        self.is_contact = np.zeros(data.elements.shape, bool)
        for row, scene in enumerate(scenes):
            self.is_contact[row, layout.of_links] = [not link.law.joins for link in scene.links]
        self.is_pressed = np.zeros_like(self.is_contact)
        self._put_lines()
        self._solve()
        would_press = self.is_contact & (self.drift > TOUCH) & (data.elements["closed"] > 0)
        if would_press.any():
            self.is_pressed = would_press
            self._solve()
        self._bound()

    def _put_lines(self) -> None:
        """Enter stiffness [N/m] and offset [N] of every element, straight lines in place of curved forces."""
        e, n = self.data.elements, self.layout.number
        self.k = np.where(e["acts"] > 0, e["k"], 0.0)
        self.f0 = np.where(e["acts"] > 0, e["f0"], 0.0)
        self.k[:, n : self.layout.of_links.start] = 0.0
        is_smooth = e["smooth"][:, :n] > 0
        self.is_curved = np.zeros_like(self.is_contact)
        self.is_curved[:, :n] = is_smooth
        self.k[:, :n] = np.where(is_smooth, e["p"][:, :n, 0], self.k[:, :n])
        self.f0[:, :n] = np.where(is_smooth, forces_now(e[:, :n]) - self.k[:, :n] * e["v1"][:, :n], self.f0[:, :n])
        self._put_held_sliders()
        relaxes = e["relaxation"] > 0.0
        self.k[relaxes] = 0.0
        curved = (e["acts"] > 0) & ((e["smooth"] > 0) | (e["cubic"] != 0.0))
        curved[:, :n] = False
        for row, place in np.argwhere(curved).tolist():
            self.k[row, place], self.f0[row, place] = self._line_at(row, place)
            self.is_curved[row, place] = self.k[row, place] != 0.0

    def _put_held_sliders(self) -> None:
        """Enter stiff springs for sliders that stick, which hold the base where it is up to their friction."""
        e = self.data.elements
        self.low, self.high = e["low"].copy(), e["high"].copy()
        holds = e["holds"] > 0
        friction, v = e["p"][holds, 1], e["v1"][holds]
        self.k[holds] += friction / STUCK_WITHIN
        self.f0[holds] = -friction / STUCK_WITHIN * v
        self.low[holds], self.high[holds] = v - STUCK_WITHIN, v + STUCK_WITHIN

    def _line_at(self, row: int, place: int) -> tuple[float, float]:
        """Return the tangent (stiffness [N/m], offset [N]) of a curved force at the present deformation, at rest."""
        element = self.data.elements.view(np.recarray)[row, place]
        v = float(element.v1)
        step = NUDGE * max(abs(v), NUDGE)
        above, below = self._force(element, row, v + step), self._force(element, row, v - step)
        k = (above - below) / (2.0 * step)
        return k, 0.5 * (above + below) - k * v

    def _force(self, element: Any, row: int, v: float) -> float:
        """Return the force of an element at the deformation v without a rate [N]."""
        force = float(element.k * v + element.cubic * v**3 + element.f0)
        if element.smooth and BEHAVIOURS[element.kind] is WRITTEN_BEHAVIOUR:
            assert self.data.room is not None  # of every scene with a formula
            return force + float(carried_out(self.data.room.formulas.view(np.recarray)[row, element.formula], v, 0.0))
        own = BEHAVIOURS[element.kind].force
        return force + float(own(element, v, 0.0)) if element.smooth and own is not None else force

    def _solve(self) -> None:
        """Find the equilibrium, with the contacts that are pressed and without the others."""
        shape = _shape_of(self.layout)
        acts = ~self.is_contact | self.is_pressed
        k, f0, offset = np.where(acts, self.k, 0.0), np.where(acts, self.f0, 0.0), self.data.elements["offset"]
        self.matrix = _stiffness_matrix(self.layout, k)
        pull = (k * offset - f0) @ shape
        pull[:, self.layout.dofs["inv_mass"] == 0.0] = 0.0
        self.is_stable = np.linalg.eigvalsh(self.matrix)[:, 0] > 0.0
        self.matrix[~self.is_stable] = np.eye(self.layout.number)
        self.displacement = np.linalg.solve(self.matrix, pull[..., None])[..., 0]
        self.drift = self.displacement @ shape.T - offset
        size = np.abs(self.displacement).max(axis=1, keepdims=True, initial=0.0)
        self.drift[np.abs(self.drift) <= ROUNDING * size] = 0.0

    def _bound(self) -> None:
        """Find how far the energy that is left takes every element."""
        shape, dofs = _shape_of(self.layout), self.data.dofs
        away = dofs["u0"] - self.displacement
        energy = 0.5 * (dofs["mass"] * dofs["w"][:, :, 0] ** 2).sum(axis=1)
        energy += 0.5 * np.einsum("si,sij,sj->s", away, self.matrix, away) + self._stored_beside()
        flexibility = np.einsum("en,snk,ek->se", shape, np.linalg.inv(self.matrix), shape)
        self.reach = np.sqrt(2.0 * np.maximum(energy[:, None] * flexibility, 0.0))
        self.reach[~self.is_stable] = math.inf

    def _stored_beside(self) -> np.ndarray:
        """Return the energy [J] in contacts that are open at rest and in Maxwell dampers, shape (scenes,)."""
        e, first = self.data.elements, self.layout.of_links.start
        stored = np.zeros(len(self.scenes))
        for row, place in np.argwhere((e["closed"] > 0) & ~self.is_pressed).tolist():
            if place < first:
                continue
            law, element = self.scenes[row].links[place - first].law, e[row, place]
            if isinstance(law, Maxwell):
                stored[row] += law.stored(0.0, float(element["h"][0]))
            elif not law.joins:
                force = float(element["k"] * element["v1"] + element["f0"])
                stored[row] += law.stored(float(element["v1"] + element["offset"]), force)
        return stored

    def is_at_rest(self, largest: np.ndarray) -> np.ndarray:
        """Return whether scenes are at rest but for a vibration that moves no drift at rest.

        largest : largest drift of every storey [m], shape (scenes, n)
        """
        e, n = self.data.elements, self.layout.number
        is_open = self.is_contact & ~self.is_pressed
        fits = np.where(is_open, self.drift <= TOUCH, ~self.is_contact | (self.drift > 0.0))
        stays = (self.drift - self.reach > self.low) & (self.drift + self.reach < self.high)
        stays &= np.isneginf(e["slow"]) & np.isposinf(e["fast"]) & ~self.is_curved
        stays &= np.abs(self.drift) + self.reach < e["collapse"]
        scale = np.maximum(np.abs(self.drift[:, :n]), LEAST_DRIFT * largest)
        is_still = (self.reach[:, :n] <= STILL * scale).all(axis=1)
        return self.is_stable & fits.all(axis=1) & ((is_open | stays).all(axis=1) | is_still)

    def is_undamped(self) -> np.ndarray:
        """Return whether a mode of the buildings has no damping, neither of theirs nor of links; shape (scenes,)."""
        layout, e, n = self.layout, self.data.elements, self.layout.number
        omega, modes = _modes(layout)
        takes = [[_always_takes_energy(link.law) for link in scene.links] for scene in self.scenes]
        c = np.zeros(e.shape)
        c[:, :n] = e["c"][:, :n]
        c[:, n : layout.of_links.start] = e["p"][:, n : layout.of_links.start, 1]
        c[:, layout.of_links] = np.where(self.is_contact[:, layout.of_links], 0.0, e["c"][:, layout.of_links])
        slides = np.flatnonzero(layout.elements["slides"])  # friction damps the base that it holds
        c[:, slides] = np.sqrt(layout.elements["p"][slides, 1] / STUCK_WITHIN * layout.dofs["mass"][slides])
        in_modes = (_shape_of(layout) @ modes) ** 2
        own = (layout.dofs["drag"] * layout.dofs["mass"]) @ modes**2
        ratios = (c @ in_modes + own) / (2.0 * omega)
        return (ratios < UNDAMPED).any(axis=1) & ~np.array(takes, bool).any(axis=1)
