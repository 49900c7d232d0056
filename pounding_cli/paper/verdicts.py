"""Judge the claims of the paper by the results of a study, and tell what was found."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import chain, product
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.numbers import NOTHING, format_number, pluralize
from pounding_cli.paper.claims import AS_GIVEN, CLAIMS, FAILS, HOLDS, LARGEST_STOREY, MEAN_OF_STOREYS, PARTLY, UNTESTED
from pounding_cli.report.document import Section
from pounding_cli.report.evidence import find_nominal, format_point, list_points
from pounding_cli.solver.response import DONE
from pounding_cli.tables import Column, Row, Table, build_table

if TYPE_CHECKING:
    from pounding_cli.questions.sensitivity.question import Sensitivity, Series
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Plan

CLAIM_COLUMNS = (
    Column("where", "point of the sweep", label="point of the sweep"),
    Column("claim", "name of the claim"),
    Column("verdict", f"verdict on the claim by the {MEAN_OF_STOREYS}"),
    Column("verdict_largest", f"verdict on the claim by the {LARGEST_STOREY}", label=f"verdict, {LARGEST_STOREY}"),
    Column("finding", "meaning of the number"),
    Column("measure", f"{MEAN_OF_STOREYS}, {LARGEST_STOREY}, or nothing where the number counts for both verdicts"),
    Column("number", "number found, in the unit of the row", digits=3),
    Column("unit", "unit of the number and the threshold"),
    Column("threshold", "range in which the number agrees with the paper"),
    Column("passed", "whether the number meets its threshold; nothing where it is not known"),
)
"""The table `claims`: a row a number at a point of the sweep."""

MOTION_VARIABLES = ("record_scale", "record_arias", "record_source")
"""Variables of the motions that the claims need."""


def _add_motions(scenes: xr.Dataset, motions: xr.Dataset) -> xr.Dataset:
    """Return scenes with the variables of every motion over its name, `motion`.

    scenes : `record` numbers the motions of a point
    motions : `record` is the name of a motion
    """
    of_motions = {name: motions[name].reset_coords(drop=True).rename(record="motion") for name in MOTION_VARIABLES}
    return scenes.drop_vars(MOTION_VARIABLES).assign(of_motions)


def evaluate_claims(data: xr.Dataset, axes: Sequence[str], figure: str | None) -> pd.DataFrame:
    """Return every number of the claims about a figure at every point of the swept axes.

    Columns are those of CLAIM_COLUMNS without `where`, and `point`, its number, the last axis fastest; `passed` is 1, 0
    or NaN where no number is finite.
    """
    whole = xr.DataArray(np.zeros([data.sizes[axis] for axis in axes]), dims=axes)

    def list_points(values: xr.DataArray) -> np.ndarray:
        return values.reset_coords(drop=True).broadcast_like(whole).transpose(*axes).values.astype(float).ravel()

    parts: list[pd.DataFrame] = []
    for key, each in CLAIMS.items():
        if not figure or "impacts" not in data or each.figure not in ("", figure):
            continue
        for finding in each.find(data):
            number = list_points(finding.number)
            passed = list_points(finding.threshold.contains(finding.number))
            part = pd.DataFrame({"point": np.arange(number.size), "number": number, "passed": passed})
            part["claim"] = key
            part["finding"] = finding.words
            part["measure"] = finding.measure
            part["unit"] = finding.unit
            part["threshold"] = finding.threshold_text
            parts.append(part)
    if not parts:
        return pd.DataFrame(columns=["point", *(column.name for column in CLAIM_COLUMNS if column.name != "where")])
    numbers = pd.concat(parts, ignore_index=True)
    numbers["passed"] = numbers["passed"].where(np.isfinite(numbers["number"]))
    numbers["verdict"] = find_verdicts(numbers, MEAN_OF_STOREYS)
    numbers["verdict_largest"] = find_verdicts(numbers, LARGEST_STOREY)
    return numbers


def find_verdicts(numbers: pd.DataFrame, measure: str) -> np.ndarray:
    """Return the verdict by one measure on the claim of every row, shape (rows,).

    numbers : columns claim, point, measure and passed of `evaluate_claims`
    measure : MEAN_OF_STOREYS or LARGEST_STOREY; numbers by the other one do not count
    """
    counted = numbers["passed"].where(numbers["measure"].isin(["", measure]))
    passed = counted.groupby([numbers["claim"], numbers["point"]])  # its extremes leave out NaN
    is_known = passed.transform("count") > 0
    all_met = passed.transform("min") == 1
    some_met = passed.transform("max") == 1
    return np.select([~is_known, all_met, some_met], [UNTESTED, HOLDS, PARTLY], FAILS)


def judge_claims(results: ResultTables) -> pd.DataFrame:
    """Return every number of the claims about the figure that the study names, at every point of the sweep.

    Columns are those of CLAIM_COLUMNS; `passed` is true, false or missing. There are no rows where the study names no
    figure (`claims: fig6` or `claims: fig7`).
    """
    axes = [names[0] for names in results.swept]
    numbers = evaluate_claims(_add_motions(results.data, results.data), axes, results.study_data.get("claims"))
    places = []
    for point in product(*(list_points(results, keys) for keys in results.swept)):
        swept = dict(zip(results.axes, chain(*point), strict=True))
        places.append(format_point(results, swept) or AS_GIVEN)
    numbers["where"] = [places[point] for point in numbers["point"]]
    numbers["passed"] = numbers["passed"].astype("float").astype("boolean")
    return numbers[[column.name for column in CLAIM_COLUMNS]]


def list_verdicts(results: ResultTables) -> dict[str, str]:
    """Return the verdict on every claim where nothing is swept and the study names a figure."""
    if results.axes:
        return {}
    numbers = judge_claims(results)
    return {str(row["claim"]): format_verdict(row) for row in numbers.to_dict("records")}


def at_samples(plan: Plan, data: xr.Dataset, question: Sensitivity) -> Iterator[Series]:
    """Yield whether every claim holds (1 or 0) at every sample of `pound sensitivity`, and whether a part of it does.

    By the mean over the storeys and by the largest storey; NaN of a sample with a scene that failed, and where nothing
    tests the claim.
    """
    from pounding_cli.questions.sensitivity.question import Series as Sampled  # here: with SciPy, which few pages need

    axes = [axis.names[0] for axis in plan.axes]  # the samples are the last one
    data = data.drop_vars(axes[-1]).isel({axes[-1]: xr.DataArray(question.point_of_sample, dims=axes[-1])})
    scenes = data
    if question.motions_of_samples is not None:
        drawn = xr.DataArray(question.motions_of_samples, dims=(axes[-1], "record"))
        scenes = data.drop_vars("record").isel(record=drawn)
    alone_failed: Any = np.isfinite(scenes["drift"]) & ~np.isfinite(scenes["drift0"])
    failed = (scenes["status"] != DONE) | alone_failed.any(("building", "storey"))
    is_void = failed.any(("case", "analysis", "record")).transpose(*axes).values
    numbers = evaluate_claims(_add_motions(scenes, data), axes, plan.study.spec.claims)
    for key, of_claim in numbers.groupby("claim", sort=False):
        columns = {f"claim {key}": "verdict"}
        if (of_claim["measure"] != "").any():
            columns[f"claim {key}, {LARGEST_STOREY}"] = "verdict_largest"
        for name, column in columns.items():
            verdicts = of_claim.drop_duplicates("point")[column].to_numpy().reshape(is_void.shape)
            verdicts = np.where(is_void, UNTESTED, verdicts)
            for words, held in ((name, [HOLDS]), (f"{name}, at least in part", [HOLDS, PARTLY])):
                if held == [HOLDS] or (verdicts == PARTLY).any():
                    number = np.where(verdicts == UNTESTED, np.nan, np.isin(verdicts, held))
                    for point in np.ndindex(number.shape[:-1]):
                        yield Sampled(point, "", "", words, "", number[point])


def format_finding(row: Row) -> str:
    """Return the number of a row of the claims with its unit."""
    number = row["number"]
    return f"{format_number(number, 3)} {row['unit']}".removesuffix(" -") if math.isfinite(number) else NOTHING


def format_verdict(row: Row) -> str:
    """Return the verdict of a row of the claims, with that by the largest storey where it is another one."""
    if row["verdict"] == row["verdict_largest"]:
        return str(row["verdict"])
    return f"{row['verdict']} ({LARGEST_STOREY}: {row['verdict_largest']})"


def format_passed(row: Row) -> str:
    """Return whether the number of a row of the claims meets its threshold."""
    if pd.isna(row["passed"]):
        return NOTHING
    return "met" if row["passed"] else "missed"


def list_claim_sections(results: ResultTables) -> list[Section]:
    """Return the sections of a report, with the numbers at the point of the sweep that its figures show.

    There are none where the study names no figure, or the file is not of `pound run`.
    """
    if results.workflow != "run":
        return []
    numbers = judge_claims(results)
    if numbers.empty:
        return []
    here = numbers[numbers["where"] == (find_nominal(results).label or AS_GIVEN)]
    rule = (
        "A claim holds if every number meets its threshold, holds partly if some do, does not hold if none does. The "
        f"verdict is that by the {MEAN_OF_STOREYS}; in brackets that by the {LARGEST_STOREY}, where it is another one."
    )
    sentences = [summarize_verdicts(here, results.study_data["claims"]), rule]
    every = build_table("claims", numbers, _show_on_page(CLAIM_COLUMNS), caption="Every number at every point")
    return [
        Section("The paper’s claims", sentences, [build_claims_table(here)]),
        Section("Numbers of the claims", (), [every], folded=True),
    ]


def _show_on_page(columns: Sequence[Column]) -> list[Column]:
    """Return the columns with cells for `passed`, whose values may be missing."""
    return [Column("passed", label="threshold met", write=format_passed) if c.name == "passed" else c for c in columns]


def summarize_verdicts(numbers: pd.DataFrame, figure: str) -> str:
    """Return how many claims about a figure hold, in a sentence.

    numbers : of one point of the sweep, as `judge_claims` has them
    figure : "fig6" or "fig7"
    """
    verdicts = numbers.drop_duplicates("claim")["verdict"]
    counts = Counter(verdicts)
    words = {HOLDS: ("holds", "hold"), PARTLY: ("holds partly", "hold partly"), FAILS: ("does not hold", "do not hold"),
             UNTESTED: ("is not tested", "are not tested")}  # fmt: skip
    parts = [f"{counts[each]} {one if counts[each] == 1 else many}" for each, (one, many) in words.items()]
    known = [part for part, each in zip(parts, words, strict=True) if counts[each]]
    of_all = f"Of {pluralize(len(verdicts), 'claim')} about Fig. {figure.removeprefix('fig')}"
    return f"{of_all}, {', '.join(known)} (by the {MEAN_OF_STOREYS})."


def build_claims_table(numbers: pd.DataFrame) -> Table:
    """Return the claims with their numbers: a row with the words of the claim, then a row a number.

    numbers : of one point of the sweep, as `judge_claims` has them
    """
    rows: list[dict[Any, Any]] = []
    for key, of_claim in numbers.groupby("claim", sort=False):
        each = CLAIMS[str(key)]
        findings = of_claim.to_dict("records")
        heading = f"{key}\n“{each.paper}” {each.meaning}"
        rows.append({**findings[0], "finding": heading, "is_claim": True})
        rows += [{**finding, "is_claim": False} for finding in findings]
    columns = (
        Column("finding", "the claim, and its numbers", label="claim, and its numbers"),
        Column("verdict", "of the claim; of a number whether it meets its threshold", write=_format_outcome),
        Column("number", "number found", label="found", write=_format_number_found),
        Column("threshold", write=_format_threshold),
    )
    return Table("", pd.DataFrame(rows), columns, "The paper’s claims, and the numbers found")


def _format_outcome(row: Row) -> str:
    return format_verdict(row) if row["is_claim"] else format_passed(row)


def _format_number_found(row: Row) -> str:
    return "" if row["is_claim"] else format_finding(row)


def _format_threshold(row: Row) -> str:
    return "" if row["is_claim"] else str(row["threshold"])
