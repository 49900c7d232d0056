"""The records of runs: those of a layout, with parameters of links, initial states, and what a run may do."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pounding_cli.laws.formula import WrittenLaw
from pounding_cli.laws.pounding import reduced_mass
from pounding_cli.methods import Method
from pounding_cli.model.scene import Scene
from pounding_cli.solver.layout import Layout, build_term_matrix
from pounding_cli.solver.records import FORMULA, MIN_STATE, RUN, SERIES, STATE, Data, Room, Watch
from pounding_cli.solver.segments import find_last_segment

SAFETY = 0.5
"""What a series may leave out of an acceleration, over the accuracy asked of the peaks [-]."""

MAX_TOLERANCE = 1e-4
"""Most that a series may leave out, relative to the acceleration [-]."""

MIN_TOLERANCE = 1e-16
"""Least that a series may leave out, relative to the acceleration [-]."""

SMOOTHER = 0.01
"""Error that a step by DOP853 may have, over what a series may leave out [-]."""

MIN_SMOOTH_TOLERANCE = 1e-13
"""Least error that a step by DOP853 is asked for [-]: less could not be told from rounding, and where less is asked the
steps become as much shorter as it would make them."""

ORDER_OF_DOP853 = 8
"""Power of the step by which its error falls."""

MIN_SCALE = 1e-3
"""Acceleration below which nothing is resolved, over the ground's peak [-]."""

MAX_STEPS = 20_000_000
"""Steps of a run after which it ends with a status that says so."""

MAX_EVENTS = 5_000_000
"""Events of a run after which it ends with a status that says so."""

NOTHING_KEPT = Watch(np.zeros(0), np.zeros((0, 0, 3)), np.zeros((0, 0, 2)), np.zeros((0, 3)), np.zeros((0, 0)))

Bounds = tuple[int, int]
"""Largest number of steps of a run, largest number of its events."""

InitialState = tuple[Sequence[np.ndarray], Sequence[np.ndarray]]
"""Floor displacements [m] and velocities [m/s] relative to the ground, one array (n,) a building; of one whose floors
twist (n,), or (2n,) with the rotations [rad] and their rates [rad/s] behind them."""


def build_records(
    scenes: Sequence[Scene],
    layout: Layout,
    accuracy: float,
    method: Method,
    initial: InitialState | None,
    times: np.ndarray | None,
    bounds: Bounds | Sequence[Bounds],
    least_steps: int = 1,
) -> Data:
    """Return the records of runs of one layout, a row a scene; parameters as of `solve.prepare_run`."""
    count = len(scenes)
    dofs = np.tile(layout.dofs, (count, 1))
    elements = np.tile(layout.elements, (count, 1))
    columns = np.tile(layout.columns, (count, 1))
    formulas = _put_links(elements[:, layout.of_links], scenes, layout.masses)
    if initial is not None:
        _put_initial(dofs, layout, *initial)
    runs = np.zeros(count, RUN)
    _put_sizes(runs, layout)
    _put_tolerances(runs, accuracy)
    runs["dt"] = [scene.motion.dt for scene in scenes]
    runs["rest"] = [find_last_segment(scene) for scene in scenes]
    runs["most_h"] = runs["dt"] / least_steps
    runs["least"] = [_find_least_acceleration(layout, *each) for each in zip(scenes, dofs, elements, strict=True)]
    runs["most_steps"], runs["most_events"] = np.transpose(bounds)
    runs["always_smooth"] = method.name == "dop853"
    needs_room = layout.has_smooth or method.name == "dop853" or method.takes_step
    return Data(
        dofs=dofs,
        elements=elements,
        terms=layout.terms,
        run=runs,
        series=np.zeros((count, _count_series(layout)), SERIES),
        columns=columns,
        room=_build_room(layout, formulas) if needs_room else None,
        watch=NOTHING_KEPT if times is None else _build_watch(layout, times),
    )


def _put_links(elements: np.ndarray, scenes: Sequence[Scene], masses: Sequence[tuple[float, float]]) -> np.ndarray:
    """Enter the parameters of the links of scenes into their elements; return the records of their formulas.

    Parameters
    ----------
    elements : of the links, shape (scenes, links)
    masses : at the two ends of every link [kg]

    Returns
    -------
    shape (scenes, formulas), one formula a scene at least
    """
    count = sum(isinstance(link.law, WrittenLaw) for link in scenes[0].links)
    formulas = np.zeros((len(scenes), max(count, 1)), FORMULA)
    p = elements["p"]
    offset = elements["offset"]
    for number, scene in enumerate(scenes):
        written = 0
        for place, (link, both) in enumerate(zip(scene.links, masses, strict=True)):
            law = link.law
            numbers = law.element_parameters(*both)
            p[number, place, : len(numbers)] = numbers
            offset[number, place] = law.offset
            if isinstance(law, WrittenLaw):
                elements["formula"][number, place] = written
                _put_formula(formulas[number, written], law, both)
                written += 1
    return formulas


def _put_formula(record: np.void, law: WrittenLaw, masses: tuple[float, float]) -> None:
    """Enter the operations of the formula of a link into its record.

    masses : at its two ends [kg]
    """
    formula = law.force(reduced_mass(*masses))
    record["count"] = len(formula.rows)
    record["result"] = formula.result
    record["operations"][: len(formula.rows)] = formula.rows


def _put_initial(
    dofs: np.ndarray, layout: Layout, displacements: Sequence[np.ndarray], velocities: Sequence[np.ndarray]
) -> None:
    """Enter the initial displacements and velocities of all buildings, as of `InitialState`."""
    for floors, turns, u, v in zip(layout.floors, layout.turns, displacements, velocities, strict=True):
        storeys = floors.stop - floors.start
        dofs["u0"][:, floors] = u[:storeys]
        dofs["w"][:, floors, 0] = v[:storeys]
        if len(u) > storeys:
            dofs["u0"][:, turns] = u[storeys:]
            dofs["w"][:, turns, 0] = v[storeys:]


def _put_sizes(runs: np.ndarray, layout: Layout) -> None:
    """Enter how many records there are of every kind, and what stands among them."""
    runs["n"] = layout.number
    runs["m"] = layout.elements.size
    runs["drags"] = layout.drags
    runs["lines"] = len(layout.lines)
    runs["columns"] = layout.columns.size if layout.struck or layout.sums else 0
    runs["has_lean"] = max(layout.feet) >= 0
    runs["has_sliders"] = _has_sliders(layout)


def _put_tolerances(runs: np.ndarray, accuracy: float) -> None:
    """Enter what steps by series and by DOP853 may leave out, for an accuracy asked of the peaks [-]."""
    tolerance = min(max(accuracy * SAFETY, MIN_TOLERANCE), MAX_TOLERANCE)
    smooth_tolerance = SMOOTHER * tolerance
    runs["tolerance"] = tolerance
    runs["max_order"] = find_max_order(tolerance)
    runs["smooth_tolerance"] = max(smooth_tolerance, MIN_SMOOTH_TOLERANCE)
    runs["smaller"] = min(1.0, smooth_tolerance / MIN_SMOOTH_TOLERANCE) ** (1.0 / ORDER_OF_DOP853)


def find_max_order(tolerance: float) -> int:
    """Return the highest order of a series worth computing before its step is cut.

    Measured over Figs 6 and 7, touching pairs, P-Delta and rows: 12 at 1e-4, 18 at 1e-12. Most steps end at a sample of
    the motion or at an event, so that it lies below the optimum of long steps, -ln(tolerance) / 2 + 1 (Jorba & Zou
    2005), where much is asked.

    Parameters
    ----------
    tolerance : what the series may leave out, relative to the acceleration [-]
    """
    return math.ceil(-0.35 * math.log(tolerance)) + 8


def _find_least_acceleration(layout: Layout, scene: Scene, dofs: np.ndarray, elements: np.ndarray) -> float:
    """Return the acceleration below which nothing is resolved [m/s2].

    It is a part of the ground's peak, or on still ground that of the start: the largest spring force per mass, or what
    would turn its largest velocity within a second.
    """
    if scene.motion.pga > 0:
        return MIN_SCALE * scene.motion.pga
    n = dofs.size
    below = np.concatenate(([0.0], dofs["u0"][:-1])) * dofs["below"]
    pulls = elements["p"][:n, 0] * np.abs(dofs["u0"] - below) * dofs["inv_mass"]
    largest = max(float(pulls.max()), float(np.abs(dofs["w"][:, 0]).max()))
    if layout.lines:
        lines = layout.of_lines
        rows = build_term_matrix(layout)[lines]
        pulls = np.abs(elements["p"][lines, 0] * (rows @ dofs["u0"])) @ np.abs(rows) * dofs["inv_mass"]
        largest = max(largest, float((pulls / dofs["unit"]).max()))
    return largest


def _has_sliders(layout: Layout) -> bool:
    """Return whether a base stands on sliders."""
    return bool(layout.elements["slides"].any())


def _count_series(layout: Layout) -> int:
    """Return how many elements may have a series of their force, one at least."""
    beside_storeys = layout.elements.size - layout.number
    storeys = layout.number if layout.has_smooth or _has_sliders(layout) else 0
    return max(beside_storeys + storeys, 1)


def _build_room(layout: Layout, formulas: np.ndarray) -> Room:
    """Return the room for steps by DOP853.

    formulas : of the links, shape (scenes, formulas)
    """
    n = layout.number
    history_variables = int(np.count_nonzero(layout.elements["state"]))
    states = np.zeros((len(formulas), 2 * n + history_variables), STATE)
    states["scale"] = MIN_STATE
    states["scale"][:, :n] *= layout.dofs["unit"]
    states["scale"][:, n : 2 * n] *= layout.dofs["unit"]
    return Room(states, formulas)


def _build_watch(layout: Layout, times: np.ndarray) -> Watch:
    """Return the room for what is kept at output times [s]."""
    count = times.size
    return Watch(
        times=times,
        dofs=np.zeros((count, layout.number, 3)),
        elements=np.zeros((count, layout.elements.size, 2)),
        energy=np.zeros((count, 3)),
        storeys=np.zeros((count, layout.number)),
    )
