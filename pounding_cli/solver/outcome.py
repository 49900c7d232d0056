"""Outcomes of runs of one layout: how they ended, the peaks of their scenes, and the storey that collapsed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.model.wall import Wall
from pounding_cli.solver import records
from pounding_cli.solver.layout import Layout
from pounding_cli.solver.records import Data
from pounding_cli.solver.response import COLLAPSED, DONE, OUTCOMES, peaks_type

Outcome = tuple[str, str]
"""How a run ended, in words, and what to do about it."""

ENDS: tuple[Outcome, ...] = (
    (DONE, ""),
    (COLLAPSED, ""),
    ("step bound reached", "a part of the scene is far stiffer than the rest: check stiffnesses and masses"),
    ("event bound reached", "the floors strike too often: check the stiffness and damping of the links"),
    ("stalled", "events repeat without advancing in time: check for links whose force jumps, or use another method"),
    ("not finite", "the numbers exceed the range of double precision: check masses and stiffnesses"),
    ("no root", "Newton's method found no root, because a force jumps: use a method with events, e.g. taylor"),
    ("unstable step", "the solution would grow without bound: use a shorter time step, or taylor"),
)
"""What the user reads of every status of a kernel (`records.DONE`...)."""

LEAST_RESIDUAL = 1e-8
"""Energy residual over the input that is always allowed; a run asked for less accuracy may leave as much open as
that."""

OPEN_BALANCE: Outcome = (
    "energy does not close",
    "the error of the series exceeds the accuracy asked: set a finer accuracy, or reduce extreme stiffnesses",
)


def find_outcomes(data: Data, accuracy: float, residuals: np.ndarray) -> list[Outcome]:
    """Return how runs ended: none is done with numbers that are not finite, or an energy balance that does not close.

    residuals : of the energy balances [-], shape (runs,)
    """
    sums = [data.dofs[name].sum(axis=1) for name in ("u_max", "u_min", "a_max", "u0")]
    sums += [data.elements[name].sum(axis=1) for name in ("peak_v", "peak_f", "impulse", "time")]
    are_finite = np.isfinite(np.array(sums)).all(axis=0)
    are_closed = np.abs(residuals) <= max(accuracy, LEAST_RESIDUAL)
    ends = list[Outcome]()
    for status, is_finite, is_closed in zip(data.run["status"].tolist(), are_finite, are_closed, strict=True):
        end = ENDS[status]
        if end[0] in OUTCOMES and not is_finite:
            end = ENDS[records.NOT_FINITE]
        elif end[0] in OUTCOMES and not is_closed:
            end = OPEN_BALANCE
        ends.append(end)
    return ends


def build_peaks(layout: Layout, data: Data, scenes: Sequence[Scene], drift_at_rest: np.ndarray) -> np.ndarray:
    """Return the peaks of scenes, records of `peaks_type`, shape (scenes,).

    drift_at_rest : as of `rest.Rest`
    """
    storeys = [building.storeys for building in layout.buildings]
    links = len(scenes[0].links)
    peaks = np.full(len(scenes), np.nan, peaks_type(len(storeys), max(storeys), links, layout.most_lines))
    for number in range(len(layout.buildings)):
        _put_bases(peaks, number, layout, data)
        _put_storeys(peaks, number, layout, data, drift_at_rest)
    _put_lines(peaks, layout, data, drift_at_rest)
    _put_sums(peaks, layout, data)
    _put_links(peaks, layout, data, scenes)
    _put_columns(peaks, layout, data)
    peaks["collapse_storey"] = 0.0
    return peaks


def _put_bases(peaks: np.ndarray, number: int, layout: Layout, data: Data) -> None:
    """Enter the peaks of the base of a building."""
    building = layout.buildings[number]
    reach = np.maximum(data.dofs["u_max"], -data.dofs["u_min"])
    for name, place in (("sway", layout.bases[number]), ("rocking", layout.feet[number])):
        peaks[name][:, number] = reach[:, place] if place >= 0 else 0.0
    if building.foundation is not None and building.foundation.isolation is not None:
        peaks["isolator_displacement"][:, number] = peaks["sway"][:, number]


def _put_storeys(peaks: np.ndarray, number: int, layout: Layout, data: Data, drift_at_rest: np.ndarray) -> None:
    """Enter the peaks of the storeys of a building.

    A wall does not yield, and one that moves as the ground does has none.
    """
    building = layout.buildings[number]
    if isinstance(building, Wall) and not building.moves:
        return
    span = layout.floors[number]
    storeys = data.elements[:, span]
    floors = data.dofs[:, span]
    drift = storeys["peak_v"]
    values = {
        "shear": np.where(storeys["yields"] > 0, storeys["peak_f"], building.stiffness * drift),
        "drift": drift,
        "ductility": np.nan if isinstance(building, Wall) else drift / building.yield_drift,
        "acceleration": floors["a_max"],
        "displacement_max": floors["u_max"],
        "displacement_min": floors["u_min"],
        "residual_drift": drift_at_rest[:, span],
    }
    for name, of_storeys in values.items():
        peaks[name][:, number, : building.storeys] = of_storeys


def _put_lines(peaks: np.ndarray, layout: Layout, data: Data, drift_at_rest: np.ndarray) -> None:
    """Enter the peaks of frame lines, and the ductilities of their storeys.

    The ductility of a storey is that of its line along the row with the largest: the line whose demand governs.
    """
    for number in layout.sums:
        peaks["ductility"][:, number, : layout.buildings[number].storeys] = 0.0
    first = layout.of_lines.start
    for place, (number, storey, line_number) in enumerate(layout.lines):
        plan = layout.buildings[number].plan
        assert plan is not None
        line = plan.all_lines[line_number]
        element = data.elements[:, first + place]
        drift = element["peak_v"]
        ductility = drift / (line.yield_shear[storey] / line.stiffness[storey])
        shear = np.where(element["yields"] > 0, element["peak_f"], line.stiffness[storey] * drift)
        peaks["line_shear"][:, number, storey, line_number] = shear
        peaks["line_drift"][:, number, storey, line_number] = drift
        peaks["line_ductility"][:, number, storey, line_number] = ductility
        peaks["line_residual_drift"][:, number, storey, line_number] = drift_at_rest[:, first + place]
        if line_number < len(plan.lines):
            governing = peaks["ductility"][:, number, storey]
            peaks["ductility"][:, number, storey] = np.maximum(governing, ductility)


def _put_sums(peaks: np.ndarray, layout: Layout, data: Data) -> None:
    """Enter the shears of storeys that are sums over lines, the drifts of their edges, and the rotations of floors."""
    first = 2 * len(layout.struck)
    for number in layout.sums:
        storeys = layout.buildings[number].storeys
        sums = data.columns[:, first : first + storeys]
        turns = data.dofs[:, layout.turns[number]]
        peaks["shear"][:, number, :storeys] = sums["peak"]
        peaks["edge_drift_low"][:, number, :storeys] = sums["peak_low"]
        peaks["edge_drift_high"][:, number, :storeys] = sums["peak_high"]
        peaks["twist"][:, number, :storeys] = np.maximum(turns["u_max"], -turns["u_min"])
        first += storeys


def _put_links(peaks: np.ndarray, layout: Layout, data: Data, scenes: Sequence[Scene]) -> None:
    """Enter the peaks of links."""
    links = data.elements[:, layout.of_links]
    can_act = [[link.law.can_act for link in scene.links] for scene in scenes]
    peaks["impacts"] = links["hits"]
    peaks["peak_force"] = links["peak_f"]
    peaks["impulse"] = links["impulse"]
    peaks["max_closing"] = to_closings(layout, links["peak_v"], links["offset"])
    peaks["contact_time"] = np.where(can_act, links["time"], 0.0)


def _put_columns(peaks: np.ndarray, layout: Layout, data: Data) -> None:
    """Enter the peaks of struck columns, and their demand where the storey can yield."""
    for place, struck in enumerate(layout.struck):
        below = data.columns["peak"][:, 2 * place]
        above = data.columns["peak"][:, 2 * place + 1]
        strength = struck.share * layout.buildings[struck.building].yield_shear[struck.storey - 1]
        peaks["shear_below"][:, struck.link] = below
        peaks["shear_above"][:, struck.link] = above
        if np.isfinite(strength):
            peaks["demand"][:, struck.link] = np.maximum(below, above) / strength


def to_closings(layout: Layout, deformation: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Return the closings u_left - u_right of the ends of links [m].

    deformation, offset : of their elements [m], shape (..., links)
    """
    return (deformation + offset) / layout.cosines


def find_collapse(layout: Layout, elements: np.ndarray) -> tuple[int, int]:
    """Return building from 0 and storey from 1 of the storey that has drifted furthest over its collapse drift.

    Where floors twist the drift is that of one of its lines.
    """
    shares = elements["peak_v"] / elements["collapse"]
    by_building = [shares[floors].copy() for floors in layout.floors]
    for (number, storey, _), share in zip(layout.lines, shares[layout.of_lines].tolist(), strict=True):
        by_building[number][storey] = max(by_building[number][storey], share)
    building = int(np.argmax([storeys.max() for storeys in by_building]))
    return building, int(np.argmax(by_building[building])) + 1


def put_collapse(peaks: np.void, layout: Layout, building: int, storey: int, time: float) -> None:
    """Enter into the peaks of a scene that a storey of a building collapsed, which ended all of it.

    building, storey, time : place from 0, storey from 1, and time [s]
    """
    peaks["collapse_storey"][building] = storey
    ends = [not isinstance(each, Wall) or each.moves for each in layout.buildings]
    peaks["collapse_time"][ends] = time
