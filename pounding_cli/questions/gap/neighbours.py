"""Gaps beside a neighbour that is only seen: how likely they are enough over what it may be and over the motions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.questions.bootstrap import DRAWS, build_estimate, draw_motions
from pounding_cli.questions.gap.cases import build_gap_frame
from pounding_cli.questions.gap.separations import list_sweep_points
from pounding_cli.questions.gap.statistics import build_point_table
from pounding_cli.questions.gap.tables import (
    EXACT,
    GAP_CONFIDENCE,
    NEIGHBOUR_CASES_COLUMNS,
    NEIGHBOUR_CASES_TABLE,
    NEIGHBOUR_COLUMNS,
    NEIGHBOUR_SHARES,
    NEIGHBOURS_TABLE,
    name_enough,
)
from pounding_cli.study import Plan, Study
from pounding_cli.tables import Column, Table

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.questions.gap.rate import RateBasis


def select_median(separations: pd.DataFrame, buildings: int) -> pd.DataFrame:
    """Return the separations of the median neighbours.

    separations : of every place, rule, analysis and motion of a plan whose last axis is that of neighbours
    buildings : points of this axis, the median ones first
    """
    return separations[separations["point"] % buildings == 0]


def drop_axis(table: Table, names: tuple[str, ...]) -> Table:
    """Return a table without the keys of an axis."""
    frame = table.frame.drop(columns=list(names), errors="ignore")
    return replace(table, frame=frame, columns=[column for column in table.columns if column.name not in names])


@dataclass(frozen=True, eq=False)
class Closings:
    """The largest closings of two neighbours over all their floors.

    values : [m], NaN of a run that failed, shape (neighbours, motions)
    draws : how often every draw takes each neighbour and motion, shape (1 + draws, neighbours, motions)
    """

    values: np.ndarray
    draws: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray) -> Closings:
        """Return closings with the draws of a bootstrap over neighbours and over motions."""
        neighbours, motions = values.shape
        of_neighbours = draw_motions(neighbours, DRAWS)
        of_motions = draw_motions(motions, DRAWS)
        of_motions[1:] = of_motions[:0:-1]  # drawn apart from the neighbours where there are as many
        return cls(values, of_neighbours[:, :, None] * of_motions[:, None, :])

    def describe(self) -> dict[str, Any]:
        """Return the columns that count neighbours, motions and failed runs."""
        neighbours, motions = self.values.shape
        return {"neighbours": neighbours, "motions": motions, "failed": int(np.isnan(self.values).sum())}

    def find_gaps(self) -> dict[str, Any]:
        """Return the gaps that are enough with NEIGHBOUR_SHARES, with their intervals [m]."""
        gaps: dict[str, Any] = {}
        for share in NEIGHBOUR_SHARES:
            gaps |= self._find_gap(share)
        return gaps

    def _find_gap(self, share: float) -> dict[str, Any]:
        """Return the gap that is enough with a probability, with its interval [m]."""
        known = ~np.isnan(self.values)
        values = self.values[known]
        order = np.argsort(values)
        weights = self.draws[:, known][:, order].cumsum(axis=1)
        with np.errstate(invalid="ignore"):
            place = (weights >= share * weights[:, -1:] - 1e-9).argmax(axis=1)
        gaps = values[order][place]
        return build_estimate(name_enough(share), gaps, GAP_CONFIDENCE, self.values.shape[1])

    def find_probability(self, fits: np.ndarray) -> dict[str, Any]:
        """Return the probability that a gap is enough, with its interval [-].

        fits : whether it is, shape (neighbours, motions)
        """
        known = ~np.isnan(self.values)
        total = (self.draws * known).sum(axis=(1, 2))
        enough = (self.draws * (known & fits)).sum(axis=(1, 2))
        probability = enough / np.maximum(total, 1e-300)
        return build_estimate("enough", probability, GAP_CONFIDENCE, self.values.shape[1])

    def split_spread(self) -> dict[str, float]:
        """Return the spread over the motions, over the neighbours and over both (law of total variance)."""
        nothing = dict.fromkeys(("spread_motions", "spread_neighbours", "spread"), np.nan)
        whole = self.values[~np.isnan(self.values).any(axis=1)]
        if len(whole) < 2 or not (whole > 0).all():
            return nothing
        logs = np.log(whole)
        within = float(logs.var(axis=1).mean())
        between = float(logs.mean(axis=1).var())
        return {"spread_motions": within**0.5, "spread_neighbours": between**0.5, "spread": (within + between) ** 0.5}


def build_neighbour_tables(
    study: Study, plan: Plan, separations: pd.DataFrame, basis: RateBasis | None
) -> list[Table]:  # fmt: skip
    """Return NEIGHBOURS_TABLE and NEIGHBOUR_CASES_TABLE: over the neighbours and the motions, by pair and analysis.

    plan : whose last axis is that of neighbours, the median ones first
    separations : of every place, rule, analysis and motion
    basis : of annual rates; None without a hazard curve
    """
    drawn = _select_drawn(separations, len(plan.axes[-1]))
    points = list_sweep_points(plan)
    gaps = build_gap_frame(study, plan)
    rows = []
    case_rows = []
    pair: Any
    for pair, of_pair in drawn.groupby(["first", "analysis", "number"], observed=True):
        point, analysis, number = pair
        by_run = of_pair.pivot_table("value", "neighbour", "motion", _largest_known, dropna=False)
        closings = Closings.of(by_run.to_numpy(float))
        if np.isnan(closings.values).all():
            continue
        left, right = plan.buildings[number : number + 2]
        where = {"point": point, "analysis": analysis, "left": left, "right": right} | closings.describe()
        rows.append(where | closings.split_spread() | closings.find_gaps())
        for judged in _judge_cases(closings, of_pair, gaps):
            rate = {}
            if basis is not None:
                rate = basis.estimate_rate(basis.drop_intensity(points[point]), analysis, number, judged["gap"])
            case_rows.append(where | judged | rate)
    found = ((NEIGHBOURS_TABLE, NEIGHBOUR_COLUMNS, rows), (NEIGHBOUR_CASES_TABLE, NEIGHBOUR_CASES_COLUMNS, case_rows))
    return [_build_table(plan, *each) for each in found]


def _judge_cases(closings: Closings, of_pair: pd.DataFrame, gaps: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """Yield how likely each set of gaps of a case is enough between two neighbours.

    of_pair : what the motions require of the pair beside all drawn neighbours
    gaps : of all cases (`build_gap_frame`)
    """
    beside = of_pair.merge(gaps, left_on=["first", "place"], right_on=["point", "place"], suffixes=("", "_gap"))
    for (given, case), of_case in beside.groupby(["given", "case"], sort=False):
        fits = of_case["value"] + of_case["error"].fillna(0.0) <= of_case["gap"]
        by_run = of_case.assign(fits=fits).pivot_table("fits", "neighbour", "motion", "all")
        judged = closings.find_probability(by_run.to_numpy(bool))
        yield {"given": given, "case": case, "gap": float(of_case["gap"].min())} | judged


def _build_table(plan: Plan, name: str, columns: Sequence[Column], rows: Sequence[dict[str, Any]]) -> Table:
    """Return a table of rows, without the axis of neighbours."""
    import pandas as pd

    names = [column.name for column in columns]
    frame = pd.DataFrame(rows, columns=["point", "given", *names])
    frame = frame.sort_values(["point", "given"], kind="stable", ignore_index=True)
    return drop_axis(build_point_table(plan, name, frame, names), plan.axes[-1].names)


def _largest_known(values: pd.Series) -> float:
    """Return the largest closing over the floors; NaN of a run that failed."""
    return float(values.max(skipna=False))


def _select_drawn(separations: pd.DataFrame, buildings: int) -> pd.DataFrame:
    """Return what the motions require beside all neighbours but the median ones.

    Columns beside those of separations: `neighbour` by number, and `first`, the point with the median neighbours.
    """
    exact = separations[separations["rule"] == EXACT]
    neighbour = exact["point"] % buildings
    return exact.assign(neighbour=neighbour, first=exact["point"] - neighbour)[neighbour > 0]
