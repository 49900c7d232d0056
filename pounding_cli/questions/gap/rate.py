"""The gap for an annual rate of contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.questions.bootstrap import build_estimate, draw_motions
from pounding_cli.questions.frames import build_swept_frame, list_swept_columns
from pounding_cli.questions.gap.separations import list_points
from pounding_cli.questions.gap.tables import CONFIDENCE, EXACT, GAP_RATE_COLUMNS, RATE_TABLE, is_length
from pounding_cli.questions.hazard import MIN_GAP, Hazard, find_gaps, poisson_probability
from pounding_cli.study import Plan
from pounding_cli.tables import Table, build_table

if TYPE_CHECKING:
    import pandas as pd

DRAWS = 300
"""Draws of the bootstrap over the motions."""


def build_rate_table(
    plan: Plan,
    intensity_axis: int | None,
    intensities: np.ndarray,
    hazard: Hazard,
    rate: float,
    separations: pd.DataFrame,
) -> Table:
    """Return RATE_TABLE: a row for every point of the axes beside the intensity, analysis and pair.

    intensity_axis : number of the axis that varies the intensity; None of one intensity
    intensities : along this axis, or the one [SI]
    hazard : how often a year an intensity is exceeded
    rate : annual rate of contact that is allowed [1/year]
    separations : of every place, rule, analysis and motion; NaN of a run that failed
    """
    import pandas as pd

    other_keys = [name for number, axis in enumerate(plan.axes) if number != intensity_axis for name in axis.names]
    keys = [*other_keys, "analysis", "number"]
    rows = []
    for values, group in _find_largest(plan, intensity_axis, intensities, separations).groupby(
        keys, observed=True, sort=False
    ):
        row: dict[str, Any] = dict(zip(keys, values, strict=True))
        row["left"], row["right"] = plan.buildings[row["number"] : row["number"] + 2]
        row["rate"] = rate
        row["probability"] = poisson_probability(rate)
        gap_by_motion = group.pivot_table("value", "intensity", "motion", dropna=False)
        rows.append(row | _find_gap(hazard, rate, gap_by_motion.dropna(axis=1)))  # motions without a failed run
    frame = pd.DataFrame(rows).reindex(columns=[*other_keys, *(column.name for column in GAP_RATE_COLUMNS)])
    unit = plan.study.unit("gap")
    units = {column.name: unit for column in GAP_RATE_COLUMNS if is_length(column)}
    return build_table(RATE_TABLE, frame, [*GAP_RATE_COLUMNS, *list_swept_columns(plan.axes)], units)


def _find_largest(
    plan: Plan, intensity_axis: int | None, intensities: np.ndarray, separations: pd.DataFrame
) -> pd.DataFrame:  # fmt: skip
    """Return the exact separation of every pair, the largest over its floors, with swept values and intensity."""
    exact = separations[separations["rule"] == EXACT]
    keys = ["point", "analysis", "number", "motion"]
    largest = exact.groupby(keys, observed=True)["value"].agg(lambda values: values.max(skipna=False)).reset_index()
    points = list_points(plan)
    places = [0 if intensity_axis is None else point[intensity_axis] for point in points]
    return largest.join(build_swept_frame(plan.axes, points, intensity=intensities[places].tolist()), on="point")


def _find_gap(hazard: Hazard, rate: float, gap_by_motion: pd.DataFrame) -> dict[str, Any]:
    """Return the gap for a rate of contact with its interval, and what it rests on.

    gap_by_motion : required gaps [m], a row an intensity, a column a motion
    """
    motions = gap_by_motion.shape[1]
    counts = {"motions": motions, "intensities": len(gap_by_motion)}
    if motions < 2:
        return counts
    log_intensities = np.log(gap_by_motion.index.to_numpy())
    log_gaps = np.log(gap_by_motion.clip(lower=MIN_GAP).to_numpy())
    gaps = find_gaps(hazard, rate, log_intensities, log_gaps, draw_motions(motions, DRAWS))
    return counts | build_estimate("gap", gaps, CONFIDENCE, motions)
