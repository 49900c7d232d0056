"""Judge the gaps of codes: how many motions close them, how likely contact is, and how often a year."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.questions.bootstrap import MIN_MOTIONS
from pounding_cli.questions.gap.separations import list_sweep_points
from pounding_cli.questions.gap.statistics import build_point_table
from pounding_cli.questions.gap.tables import CODES_COLUMNS, CODES_TABLE, EXACT, GAP_CONFIDENCE, MOTION_RULES
from pounding_cli.study import Plan
from pounding_cli.tables import Table

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.questions.gap.rate import RateBasis


@dataclass(frozen=True, eq=False)
class PairClosings:
    """The largest closing of two neighbours over all their floors, of every motion whose run did not fail.

    largest : closings [m], shape (motions,)
    with_error : the largest of the closings and their numerical errors [m], shape (motions,)
    """

    largest: np.ndarray
    with_error: np.ndarray


def build_codes_table(plan: Plan, separations: pd.DataFrame, basis: RateBasis | None) -> Table:
    """Return CODES_TABLE: a row for every point, analysis, pair of neighbours and rule of a code.

    The gap of a rule is the largest that it requires at any floor of the pair: that of a joint of one width.

    separations : of every place, rule, analysis and motion
    basis : of annual rates; None without a hazard curve
    """
    import pandas as pd

    keys = ["point", "analysis", "number"]
    points = list_sweep_points(plan)
    closings = _find_closings(separations)
    of_codes = separations[~separations["rule"].isin(MOTION_RULES) & separations["value"].notna()]
    gaps = of_codes.groupby([*keys, "rule"], observed=True)["value"].max().reset_index()
    rates: dict[tuple[Any, ...], dict[str, Any]] = {}
    rows = []
    for point, analysis, number, rule, gap in gaps.itertuples(index=False):
        pair = closings.get((point, analysis, number))
        if pair is None:
            continue
        left, right = plan.buildings[number : number + 2]
        row: dict[str, Any] = {"point": point, "analysis": analysis, "left": left, "right": right, "rule": rule}
        row |= {"gap": gap, "motions": pair.largest.size, "closed": int((pair.with_error > gap).sum())}
        probabilities = estimate_contact(pair.largest, gap)
        row |= dict(zip(("probability", "probability_low", "probability_high"), probabilities, strict=True))
        if basis is not None:
            place = (basis.drop_intensity(points[point]), analysis, number, gap)
            if place not in rates:  # once for all intensities
                rates[place] = basis.estimate_rate(*place)
            row |= rates[place]
        rows.append(row)
    names = [column.name for column in CODES_COLUMNS]
    numbers = [column.name for column in CODES_COLUMNS if column.unit.si and column.digits]
    frame = pd.DataFrame(rows, columns=["point", *names])
    frame = frame.astype({"point": int, "motions": int, "closed": int} | dict.fromkeys(numbers, float))
    return build_point_table(plan, CODES_TABLE, frame, names)


def _find_closings(separations: pd.DataFrame) -> dict[tuple[Any, ...], PairClosings]:
    """Return the closings of every point, analysis and pair of neighbours; a pair all of whose runs failed is not
    there."""
    exact = separations[separations["rule"] == EXACT]
    exact = exact.assign(with_error=exact["value"] + exact["error"].fillna(0.0))
    keys = ["point", "analysis", "number"]
    by_motion = exact.groupby([*keys, "motion"], observed=True)
    largest = by_motion[["value", "with_error"]].max()
    largest = largest[by_motion["value"].count() == by_motion.size()]  # without runs that failed
    return {
        place: PairClosings(rows["value"].to_numpy(), rows["with_error"].to_numpy())
        for place, rows in largest.groupby(keys, observed=True)
    }


def estimate_contact(closings: np.ndarray, gap: float) -> tuple[float, float, float]:
    """Return the probability of contact at a gap [-] by a lognormal fit to closings, and its interval.

    The interval is exact for a lognormal sample, as that of `find_fit_factors`: sqrt(n) times the distance of the gap
    from the mean of the logarithms, over their standard deviation, has Student's noncentral distribution. NaN of the
    interval for fewer motions than MIN_MOTIONS, of all where there is no fit.

    closings : of the motions [m], shape (motions,)
    """
    from scipy import special  # scipy.stats takes long to import

    nothing = (np.nan, np.nan, np.nan)
    if closings.size < 2 or gap <= 0 or (closings <= 0).any():
        return nothing
    logs = np.log(closings)
    spread = logs.std(ddof=1)
    if spread == 0:
        return nothing
    distance = (np.log(gap) - logs.mean()) / spread
    probability = float(special.ndtr(-distance))
    if closings.size < MIN_MOTIONS:
        return probability, np.nan, np.nan
    root = np.sqrt(closings.size)
    tails = np.array([(1 - GAP_CONFIDENCE) / 2, (1 + GAP_CONFIDENCE) / 2])
    low, high = special.ndtr(-special.nctdtrinc(closings.size - 1, tails, root * distance) / root)
    return probability, float(low), float(high)
