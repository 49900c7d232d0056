"""The gap for an annual rate of contact, and the rate of a gap."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.questions.bootstrap import DRAWS, build_estimate, draw_motions
from pounding_cli.questions.frames import build_swept_frame, list_swept_columns
from pounding_cli.questions.gap.separations import list_sweep_points
from pounding_cli.questions.gap.tables import EXACT, GAP_CONFIDENCE, GAP_RATE_COLUMNS, RATE_TABLE, is_length
from pounding_cli.questions.hazard import MIN_GAP, Hazard, compute_contact_rates, find_gaps, poisson_probability
from pounding_cli.study import Plan
from pounding_cli.study.construct.swept import Point
from pounding_cli.tables import Table, build_table

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class RateBasis:
    """The motions and the hazard curve that annual rates of contact follow from.

    hazard : how often a year an intensity is exceeded
    intensity_axis : number of the axis that varies the intensity; None of one intensity
    closings : largest of a pair over its floors [m], a row an intensity, a column a motion without a failed run, or a
        motion beside one of the buildings that a neighbour may be; by point of the other axes, analysis and number of
        the pair
    """

    hazard: Hazard
    intensity_axis: int | None
    closings: Mapping[tuple[Point, str, int], pd.DataFrame]

    def drop_intensity(self, point: Point) -> Point:
        """Return a point of the plan without its place on the axis of the intensity."""
        return tuple(place for axis, place in enumerate(point) if axis != self.intensity_axis)

    def estimate_rate(self, other: Point, analysis: str, number: int, gap: float) -> dict[str, Any]:
        """Return the annual rate of contact of a pair at a gap [m] with its interval, as columns `rate`, `rate_low` and
        `rate_high`; nothing of fewer than 2 motions.

        other : point of the axes beside the intensity (`drop_intensity`)
        number : of the pair
        """
        closings = self.closings[other, analysis, number]
        motions = _count_motions(closings)
        if motions < 2 or gap <= 0:
            return {}
        draws = _draw_columns(closings)
        log_gaps = np.full(len(draws), np.log(gap))
        rates = compute_contact_rates(self.hazard, log_gaps, *_take_logarithms(closings), draws)
        return build_estimate("rate", rates, GAP_CONFIDENCE, motions)

    def take_logarithms(self, other: Point, analysis: str, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the logarithms of intensities, shape (levels,), and of the closings of a pair, shape
        (levels, columns); arguments as of `estimate_rate`."""
        return _take_logarithms(self.closings[other, analysis, number])


def build_rate_basis(
    plan: Plan,
    intensity_axis: int | None,
    intensities: np.ndarray,
    hazard: Hazard,
    separations: pd.DataFrame,
    buildings: int = 1,
) -> RateBasis:
    """Return what annual rates follow from.

    Over what neighbours may be that are only seen, rates are of both the motions and these buildings.

    intensities : along the axis of the intensity, or the one [SI]
    separations : of every place, rule, analysis and motion; NaN of a run that failed
    buildings : points of the last axis of the plan, where it is that of neighbours, the median ones first; 1 of others
    """
    exact = separations[separations["rule"] == EXACT]
    neighbour = exact["point"] % buildings
    exact = exact.assign(neighbour=neighbour, point=exact["point"] - neighbour)
    if buildings > 1:
        exact = exact[neighbour > 0]
    keys = ["point", "analysis", "number", "neighbour", "motion"]
    largest = exact.groupby(keys, observed=True)["value"].agg(lambda values: values.max(skipna=False)).reset_index()
    basis = RateBasis(hazard, intensity_axis, {})
    points = list_sweep_points(plan)
    places = np.array([0 if intensity_axis is None else point[intensity_axis] for point in points])
    others = [basis.drop_intensity(point) for point in points]
    largest["other"] = [others[point] for point in largest["point"]]
    largest["intensity"] = np.asarray(intensities)[places[largest["point"]]]
    closings: dict[Any, pd.DataFrame] = {
        place: rows.pivot_table("value", "intensity", ["neighbour", "motion"], dropna=False).dropna(axis=1)
        for place, rows in largest.groupby(["other", "analysis", "number"], observed=True, sort=False)
    }
    return replace(basis, closings=closings)


def build_rate_table(plan: Plan, basis: RateBasis, rate: float) -> Table:
    """Return RATE_TABLE: a row for every point of the axes beside the intensity, analysis and pair.

    rate : annual rate of contact that is allowed [1/year]
    """
    import pandas as pd

    other_axes = [axis for number, axis in enumerate(plan.axes) if number != basis.intensity_axis]
    rows = []
    for (_, analysis, number), closings in basis.closings.items():
        left, right = plan.buildings[number : number + 2]
        row = {"analysis": analysis, "left": left, "right": right, "rate": rate}
        row["probability"] = poisson_probability(rate)
        rows.append(row | _find_gap(basis.hazard, rate, closings))
    swept = build_swept_frame(other_axes, [other for other, _, _ in basis.closings])
    columns = [column.name for column in GAP_RATE_COLUMNS]
    frame = pd.concat([swept, pd.DataFrame(rows, columns=columns)], axis=1)
    unit = plan.study.unit("gap")
    units = {column.name: unit for column in GAP_RATE_COLUMNS if is_length(column)}
    return build_table(RATE_TABLE, frame, [*GAP_RATE_COLUMNS, *list_swept_columns(plan.axes)], units)


def _find_gap(hazard: Hazard, rate: float, closings: pd.DataFrame) -> dict[str, Any]:
    """Return the gap for a rate of contact with its interval, and what it rests on.

    closings : [m], a row an intensity, a column a motion
    """
    motions = _count_motions(closings)
    counts = {"motions": motions, "intensities": len(closings)}
    if motions < 2:
        return counts
    gaps = find_gaps(hazard, rate, *_take_logarithms(closings), _draw_columns(closings))
    return counts | build_estimate("gap", gaps, GAP_CONFIDENCE, motions)


def _count_motions(closings: pd.DataFrame) -> int:
    """Return the number of motions of closings."""
    return int(closings.columns.get_level_values("motion").nunique())


def _draw_columns(closings: pd.DataFrame) -> np.ndarray:
    """Return how often every draw of the motions takes each column of closings, shape (1 + draws, columns)."""
    motion = closings.columns.get_level_values("motion")
    return draw_motions(motion.nunique(), DRAWS)[:, motion.factorize()[0]]


def _take_logarithms(closings: pd.DataFrame) -> tuple[np.ndarray, np.ndarray]:
    """Return the logarithms of intensities and of closings; a closing below MIN_GAP counts as that."""
    return np.log(closings.index.to_numpy()), np.log(closings.clip(lower=MIN_GAP).to_numpy())
