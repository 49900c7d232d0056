"""Statistics of the required separations over the motions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.questions.bootstrap import MIN_MOTIONS
from pounding_cli.questions.frames import build_swept_frame, list_swept_columns
from pounding_cli.questions.gap.separations import list_sweep_points
from pounding_cli.questions.gap.spec import GapSpec
from pounding_cli.questions.gap.tables import (
    COLUMNS_BY_TABLE,
    EXACT,
    GAP_CONFIDENCE,
    MOTION_RULES,
    is_length,
    list_share_columns,
    name_contact,
    name_percentile,
)
from pounding_cli.study import Plan
from pounding_cli.tables import Column, Table, build_table

if TYPE_CHECKING:
    import pandas as pd


def build_statistics_table(plan: Plan, name: str, spec: GapSpec, separations: pd.DataFrame) -> Table:
    """Return GAP_TABLE or LINE_TABLE: a row for every point, analysis, place and rule that says something there.

    separations : of every place, rule, analysis and motion
    """
    keys = ["point", "analysis", "row", "rule"]
    rows = compute_statistics(separations, keys, spec.percentiles, spec.contact)
    rule = rows.index.get_level_values("rule")
    exact_means = rows["mean"].where(rule == EXACT)
    rows["over_exact"] = rows["mean"] / exact_means.groupby(level=keys[:3], observed=True).transform("first")
    rows["motions"] = rows["motions"].where(rule.isin(MOTION_RULES), 0)
    statistics = list(rows.columns)
    names = [column.name for column in COLUMNS_BY_TABLE[name] if column.name not in (*keys, *statistics)]
    place_names = [column for column in names if column in separations]
    places = separations[["row", *place_names]].drop_duplicates("row")
    rows = rows.reset_index().merge(places, on="row", how="left")
    shares = list_share_columns(name, spec.percentiles, spec.contact)
    return build_point_table(plan, name, rows, ["analysis", *place_names, "rule", *statistics], shares)


def build_point_table(
    plan: Plan, name: str, rows: pd.DataFrame, names: Sequence[str], further: Sequence[Column] = ()
) -> Table:  # fmt: skip
    """Return a table of rows with the swept values of their points; widths are read in the study's unit of gaps.

    rows : with the number of the point of each
    names : of its columns
    further : columns that the table has in this study alone
    """
    import pandas as pd

    points = list_sweep_points(plan)
    swept = build_swept_frame(plan.axes, [points[number] for number in rows["point"]])
    texts = {name: object for name in ("analysis", "rule") if name in names}
    frame = pd.concat([swept, rows[list(names)].astype(texts)], axis=1)
    declared = [*COLUMNS_BY_TABLE[name], *further]
    unit = plan.study.unit("gap")
    units = {column.name: unit for column in declared if is_length(column)}
    return build_table(name, frame, [*declared, *list_swept_columns(plan.axes)], units)


def compute_statistics(
    separations: pd.DataFrame, keys: list[str], percentiles: Sequence[float], contact: Sequence[float]
) -> pd.DataFrame:
    """Return statistics over the motions, a row for every combination of `keys` of which some motion has a value.

    separations : `value` and `error` [m], a row a motion; NaN where there is none
    percentiles : shares of the motions [-]
    contact : probabilities of contact [-], for a gap by a lognormal fit with an interval of GAP_CONFIDENCE; NaN unless
        several motions have a value and all of these are above 0
    """
    import pandas as pd

    known = separations[separations["value"].notna()]
    known = known.assign(log=np.log(known["value"].where(known["value"] > 0)))
    groups = known.groupby(keys, observed=True)
    rows = pd.DataFrame(groups["value"].agg(motions="size", mean="mean", std="std"))
    rows["mean_plus_std"] = rows["mean"] + rows["std"]
    rows["largest"] = groups["value"].max()
    for share in percentiles:
        rows[name_percentile(share)] = groups["value"].quantile(share)
    is_fitted = (groups["log"].count() == rows["motions"]) & (rows["motions"] > 1)
    log_mean = groups["log"].mean().where(is_fitted)
    dispersion = groups["log"].std().where(is_fitted)
    rows["median"] = np.exp(log_mean)
    rows["dispersion"] = dispersion
    for share in contact:
        factors = {motions: find_fit_factors(motions, share) for motions in rows["motions"].unique()}
        for place, end in enumerate(("", "_low", "_high")):
            factor = rows["motions"].map({motions: each[place] for motions, each in factors.items()})
            rows[f"{name_contact(share)}{end}"] = np.exp(log_mean + factor.astype(float) * dispersion)
    rows["error"] = groups["error"].max()
    return rows


def find_fit_factors(motions: int, probability: float) -> tuple[float, float, float]:
    """Return by how many standard deviations of the logarithms a gap lies above their mean, and its interval.

    The interval is exact for a normal sample: sqrt(n) times the distance of the quantile from the mean, over the
    standard deviation, has Student's noncentral distribution. It is NaN for fewer motions than MIN_MOTIONS.
    """
    from scipy import special  # scipy.stats takes long to import

    z = -float(special.ndtri(probability))
    if motions < MIN_MOTIONS:
        return z, np.nan, np.nan
    root = np.sqrt(motions)
    tails = [(1 - GAP_CONFIDENCE) / 2, (1 + GAP_CONFIDENCE) / 2]
    low, high = special.nctdtrit(motions - 1, z * root, tails) / root
    return z, float(low), float(high)
