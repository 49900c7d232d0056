"""The paper's statements about Figs 6 and 7, judged: the numbers that test them, their thresholds, the verdicts.

A claim is a function of one Dataset that gives its numbers at all points of the sweep at once, each with its
threshold; its docstring is printed. `evaluated` makes one DataFrame of all of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import chain, product
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.laws.joints import Connector
from pounding_cli.laws.pounding import Pounding
from pounding_cli.numbers import NOTHING, format_number
from pounding_cli.records import load_catalogue
from pounding_cli.report.document import Section
from pounding_cli.report.evidence import find_nominal, format_point, list_points
from pounding_cli.solver.response import DONE
from pounding_cli.tables import Column, Table, table_of_texts

if TYPE_CHECKING:
    from pounding_cli.questions.sensitivity.indices import Sensitivity, Series
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Plan

HOLDS, PARTLY, FAILS, UNTESTED = "holds", "holds partly", "does not hold", "not tested here"

AS_GIVEN = "as given"
"""What stands for the only point of a study without a sweep."""
IMPLIED = ("eureka", "olympia")
"""Stand-ins of these motions are built from Table 1's scale, so they cannot test it."""

RATIOS = (("V_ratio", "elastic", "V/V0, elastic"), ("mu_ratio", "inelastic", "μ/μ0, inelastic"))
"""What Figs 6 and 7 plot: the ratio to the building alone, its analysis, its name."""

MEAN, LARGEST = "mean over the storeys", "largest storey"
"""The two readings of "the response" that a line of the figures over the storeys shows. A verdict rests on the first;
where the second gives another one, that stands beside it."""

SAME_PERIOD = 1.0 + 1e-9
"""A period within this factor of the shortest is as short [-]."""


class Threshold(NamedTuple):
    """The range in which a number agrees with the paper.

    low, high : its ends
    is_open : whether a number at an end lies outside
    """

    low: float = -math.inf
    high: float = math.inf
    is_open: bool = False

    def __str__(self) -> str:
        words = ("above", "below") if self.is_open else ("at least", "at most")
        ends = zip(words, (self.low, self.high), strict=True)
        return " and ".join(f"{word} {end:g}" for word, end in ends if math.isfinite(end))

    def contains(self, numbers: xr.DataArray) -> xr.DataArray:
        """Return whether numbers lie in the range."""
        if self.is_open:
            return (numbers > self.low) & (numbers < self.high)
        return (numbers >= self.low) & (numbers <= self.high)


class Finding(NamedTuple):
    """One number that tests a claim.

    number : over the swept axes; NaN where the results have none
    threshold : in the unit of the number
    unit : "-" (ratio), "%", "cm" or "kN s"
    measure : MEAN or LARGEST where the claim has a number by each; "" of one that counts for both
    """

    words: str
    number: xr.DataArray
    threshold: Threshold
    unit: str = "-"
    measure: str = ""

    @property
    def threshold_text(self) -> str:
        """The threshold with its unit."""
        return f"{self.threshold} {self.unit}".removesuffix(" -")


Find = Callable[[xr.Dataset], Iterator[Finding]]

CLAIMS: dict[str, tuple[str, str, Find]] = {}
"""By name in the order of the report: the figure that a statement is about ("" for both), the paper's words, its
numbers."""


def claim(paper: str, figure: str = "") -> Callable[[Find], Find]:
    """A decorator: the function gives the numbers that test what the paper says of a figure, of both unless given."""

    def noted(find: Find) -> Find:
        CLAIMS[find.__name__.replace("_", "-")] = (figure, paper, find)
        return find

    return noted


def at(data: xr.Dataset, name: str, case: str, analysis: str) -> xr.DataArray:
    """A variable in one case and analysis; NaN where the study lacks it."""
    return data[name].reindex(case=[case], analysis=[analysis]).isel(case=0, analysis=0, drop=True)


def responses(data: xr.Dataset, *cases: str) -> Iterator[tuple[Any, ...]]:
    """The lines of the figures: "V/V0, elastic" and "μ/μ0, inelastic", each with its mean over the motions in every
    case, over building and storey."""
    for ratio, analysis, label in RATIOS:
        yield label, *(at(data, ratio, case, analysis).mean("record") for case in cases)


def iter_measures(line: xr.DataArray) -> Iterator[tuple[str, xr.DataArray]]:
    """Yield both readings of a line over the storeys, each with its name."""
    yield MEAN, line.mean("storey")
    yield LARGEST, line.max("storey")


def stiffer(data: xr.Dataset) -> xr.DataArray:
    """Number of the building with the shortest fundamental period, of several the first from the left."""
    return data["period"].argmin("building")


def stiff(data: xr.Dataset, values: xr.DataArray) -> xr.DataArray:
    """Values of that building."""
    return values.isel(building=stiffer(data))


def is_softer(data: xr.Dataset, building: int) -> xr.DataArray:
    """Return whether a building has a longer period than the stiffest of the group."""
    periods = data["period"]
    return periods.isel(building=building) > SAME_PERIOD * periods.min("building")


def code_separation(data: xr.Dataset) -> xr.DataArray:
    """Return the largest separation by the code of two neighbours with different periods [m]."""
    periods = data["period"]
    longer = np.fmax(periods, periods.shift(building=-1))
    shorter = np.fmin(periods, periods.shift(building=-1))
    return data["separation"].where(longer > SAME_PERIOD * shorter).max("building")


def find_links(data: xr.Dataset, name: str, kind: str) -> xr.DataArray:
    """Return a variable of the links of one kind in the case `connected`, over its other dimensions; NaN at others."""
    is_kind = data["kind"].reindex(case=["connected"]).isel(case=0, drop=True) == kind
    return data[name].reindex(case=["connected"]).isel(case=0, drop=True).where(is_kind)


def over_runs(values: xr.DataArray) -> list[str]:
    """Return the dimensions of links and runs that values have."""
    return [dim for dim in ("link", "analysis", "record") if dim in values.dims]


@claim("There is practically no reduction in either story shears or ductility factors [by the infill].")
def infill_response(data: xr.Dataset) -> Iterator[Finding]:
    """V/V0 (elastic) and μ/μ0 (inelastic) of the stiffer building with the infill, over those of touching and of the
    gap."""
    for base in ("touching", "gap"):
        for label, infill, other in responses(data, "infill", base):
            words, threshold = f"{label}: infill over {base}", Threshold(low=0.9)
            kept = stiff(data, infill / other).mean("storey")
            yield Finding(f"{words}, {MEAN}", kept, threshold, measure=MEAN)
            largest = stiff(data, infill).max("storey") / stiff(data, other).max("storey")
            yield Finding(f"{words}, {LARGEST}", largest, threshold, measure=LARGEST)


@claim("There is more than 80% reduction to the accelerations [by the infill].")
def infill_accelerations(data: xr.Dataset) -> Iterator[Finding]:
    """The fall of the largest floor accelerations of the stiffer building with the infill, against touching."""
    for analysis in data["analysis"].values.tolist():
        infill, touching = (at(data, "acceleration", case, analysis) for case in ("infill", "touching"))
        falls = 100 * (1 - stiff(data, (infill / touching.where(touching > 0)).mean("record")))
        words = f"reduction of accelerations, infill against touching, {analysis}"
        threshold = Threshold(low=80, is_open=True)
        yield Finding(f"{words}, mean over the floors", falls.mean("floor"), threshold, "%")
        yield Finding(f"{words}, at the floor where they fall most", falls.max("floor"), threshold, "%")


@claim("There is a small increase in the responses [...] if a 1/10 to 1/100 of this average value is used instead.")
def softer_infill(data: xr.Dataset) -> Iterator[Finding]:
    """The increase of V/V0 and μ/μ0 of the stiffer building with a softer infill."""
    for case, share in (("infill_1_10", "1/10"), ("infill_1_100", "1/100")):
        for label, softer, infill in responses(data, case, "infill"):
            words, threshold = f"increase of {label}, infill at {share} against 1/5", Threshold(0, 15, is_open=True)
            mean = 100 * (stiff(data, softer / infill).mean("storey") - 1)
            yield Finding(f"{words}, {MEAN}", mean, threshold, "%", MEAN)
            largest = 100 * (stiff(data, softer).max("storey") / stiff(data, infill).max("storey") - 1)
            yield Finding(f"{words}, {LARGEST}", largest, threshold, "%", LARGEST)


@claim("Results indicate that the code specified separation is quite adequate.", "fig7")
def code_gap(data: xr.Dataset) -> Iterator[Finding]:
    """The mean ratios of every building with the gap of 7 cm."""
    for number, building in enumerate(data["building"].values.tolist()):
        for label, line in responses(data, "gap"):
            for measure, value in iter_measures(line.isel(building=number)):
                words = f"{label}: {building} with the gap, {measure}"
                yield Finding(words, value, Threshold(high=1.1), measure=measure)


@claim("[...] a gap of 5cm (less than the UBC specification) for the 2-system.", "fig6")
def narrow_gap(data: xr.Dataset) -> Iterator[Finding]:
    """The separation by the code less the gap."""
    gap = data["gap"].reindex(case=["gap"]).isel(case=0).max("link")
    words = "separation by the code less the gap of the study"
    yield Finding(words, 100 * (code_separation(data) - gap), Threshold(low=0, is_open=True), "cm")


@claim("The UBC specified separation distance (equal to the sum of the design maximum displacements) is approximately "
       "7cm.")  # fmt: skip
def separation(data: xr.Dataset) -> Iterator[Finding]:
    """The separation by the code of a stiff and a soft building, which should round to 7 cm."""
    words = "separation by the code, sum of the design displacements at the roof"
    yield Finding(words, 100 * code_separation(data), Threshold(6.5, 7.5), "cm")


@claim("There is a substantial increase to the response of the stiffer building, especially for the inelastic case.")
def connection_stiffer(data: xr.Dataset) -> Iterator[Finding]:
    """The ratios of the stiffer building when connected, at the storey where they are largest; and how far μ/μ0
    (inelastic) lies above V/V0 (elastic)."""
    elastic, inelastic = (stiff(data, line) for _, line in responses(data, "connected"))
    for (_, _, label), line in zip(RATIOS, (elastic, inelastic), strict=True):
        yield Finding(f"{label}: largest storey when connected", line.max("storey"), Threshold(low=1.2))
    measures = zip(iter_measures(elastic), iter_measures(inelastic), strict=True)
    for (measure, shear), (_, ductility) in measures:
        words = f"μ/μ0, inelastic, less V/V0, elastic, {measure}"
        yield Finding(words, ductility - shear, Threshold(low=0, is_open=True), measure=measure)


@claim("At the same time [...] the response of the other connected system was found to reduce.")
def connection_other(data: xr.Dataset) -> Iterator[Finding]:
    """The ratios of every softer building when connected."""
    for number, building in enumerate(data["building"].values.tolist()):
        softer = is_softer(data, number)
        for label, line in responses(data, "connected") if softer.any() else ():
            for measure, value in iter_measures(line.isel(building=number).where(softer)):
                words = f"{label}: {building} when connected, {measure}"
                yield Finding(words, value, Threshold(high=1, is_open=True), measure=measure)


@claim("The connection always penalizes one building and benefits the other.")
def connection_always(data: xr.Dataset) -> Iterator[Finding]:
    """The motions in which one building's ratio lies above 1 and another's below 1."""
    for ratio, analysis, label in RATIOS:
        for measure, values in iter_measures(at(data, ratio, "connected", analysis)):
            both = (values.max("building") > 1) & (values.min("building") < 1)
            share = 100 * both.where((values == values).any("building")).mean("record")
            words = f"motions in which one building gains and another is relieved, {label}, {measure}"
            yield Finding(words, share, Threshold(low=100), "%", measure)


@claim("To avoid pounding at any level both the top and the middle floors were connected.")
def connection_levels(data: xr.Dataset) -> Iterator[Finding]:
    """The largest closing, in any run, of floors that could strike beside the connected ones."""
    closing, gap = find_links(data, "max_closing", Pounding.name), find_links(data, "gap", Pounding.name)
    most = 100 * closing / gap.where(gap > 0)
    words = "largest closing of the floors that are not connected, over the gap"
    yield Finding(words, most.max(over_runs(most)), Threshold(high=100), "%")


@claim("The corresponding impact elements are continuously active throughout the entire motion of the configuration, "
       "independent of the sign of [the closing].")  # fmt: skip
def connection_both_ways(data: xr.Dataset) -> Iterator[Finding]:
    """The time for which a connector acts, and its force summed over a motion: below 0 where it pulls more than it
    pushes."""
    share = 100 * find_links(data, "contact_time", Connector.name) / data["record_window"]
    impulse = find_links(data, "impulse", Connector.name) / 1e3
    words = "time for which a connector acts, over that of the motion, least"
    yield Finding(words, share.min(over_runs(share)), Threshold(low=99.9), "%")
    words = "force of a connector summed over a motion, pulling negative"
    least, most = impulse.min(over_runs(impulse)), impulse.max(over_runs(impulse))
    yield Finding(f"{words}, smallest", least, Threshold(high=0, is_open=True), "kN s")
    yield Finding(f"{words}, largest", most, Threshold(low=0, is_open=True), "kN s")


@claim("The maximum compression v must never be greater than the initial gap for meaningful results.")
def connection_closing(data: xr.Dataset) -> Iterator[Finding]:
    """The largest closing of a connector, in any run."""
    bridged = data["gap"].where((data["kind"] == Connector.name) & (data["gap"] > 0))
    most = (100 * data["max_closing"] / bridged).max(("case", "link", "analysis", "record"))
    yield Finding("largest closing of a connector over its gap", most, Threshold(high=100), "%")


@claim("The scale [of Table 1] was computed by equating the Arias intensities of these motions to the Arias intensity "
       "of the El Centro record.")  # fmt: skip
def scales(data: xr.Dataset) -> Iterator[Finding]:
    """The scales for equal Arias intensity over the analysed durations, over those of Table 1."""
    first, names = "elcentro", data["motion"].values.tolist()
    for name in (each for each in names if each in load_catalogue() and each != first and first in names):
        source, printed = str(data["record_source"].sel(motion=name).values.flat[0]), load_catalogue()[name].scale
        if not (source == "stand-in" and name in IMPLIED):
            # Arias intensity goes with the square of the scale; that of the file is of the motion as used
            scale, arias = (data[f"record_{what}"] for what in ("scale", "arias"))
            scale, arias = (each.sel(motion=name) / each.sel(motion=first) for each in (scale, arias))
            ratio = scale / np.sqrt(arias) / printed
            words = f"{name} ({source}): scale for equal Arias intensity over Table 1's {printed:.2f}"
            yield Finding(words, ratio, Threshold(0.98, 1.02))


# judging

COLUMNS = ["claim", "verdict", "verdict_largest", "finding", "measure", "number", "unit", "threshold", "passed"]
"""What is known of every number: the verdicts of its claim by the mean over the storeys and by the largest storey; the
number in words; MEAN, LARGEST or ""; its threshold in words; whether it meets that."""

_OF_MOTIONS = ("record_scale", "record_arias", "record_source")


def _with_motions(scenes: xr.Dataset, motions: xr.Dataset) -> xr.Dataset:
    """Scenes, whose `record` numbers the motions of a point, and what is known of every motion over its name,
    `motion`."""
    of_motions = {name: motions[name].reset_coords(drop=True).rename(record="motion") for name in _OF_MOTIONS}
    return scenes.drop_vars(_OF_MOTIONS).assign(of_motions)


def evaluated(data: xr.Dataset, axes: Sequence[str], figure: str | None) -> pd.DataFrame:
    """Every number of the claims about a figure at every point of the swept axes: COLUMNS and `point`, its number, the
    last axis fastest; `passed` is 1, 0, or NaN where no number is finite."""
    whole, parts = xr.DataArray(np.zeros([data.sizes[axis] for axis in axes]), dims=axes), list[pd.DataFrame]()

    def at_points(values: xr.DataArray) -> np.ndarray:
        return values.reset_coords(drop=True).broadcast_like(whole).transpose(*axes).values.astype(float).ravel()

    for key, (about, _, find) in CLAIMS.items() if figure and "impacts" in data else ():
        for finding in find(data) if about in ("", figure) else ():
            number = at_points(finding.number)
            passed = at_points(finding.threshold.contains(finding.number))
            part = pd.DataFrame({"point": np.arange(number.size), "number": number, "passed": passed})
            part["claim"] = key
            part["finding"] = finding.words
            part["measure"] = finding.measure
            part["unit"] = finding.unit
            part["threshold"] = finding.threshold_text
            parts.append(part)
    if not parts:
        return pd.DataFrame(columns=["point", *COLUMNS])
    found = pd.concat(parts, ignore_index=True)
    found["passed"] = found["passed"].where(np.isfinite(found["number"]))
    found["verdict"] = find_verdicts(found, MEAN)
    found["verdict_largest"] = find_verdicts(found, LARGEST)
    return found


def find_verdicts(numbers: pd.DataFrame, measure: str) -> np.ndarray:
    """Return the verdict by one measure on the claim of every row, shape (rows,).

    numbers : columns claim, point, measure and passed of `evaluated`
    measure : MEAN or LARGEST; numbers by the other one do not count
    """
    counted = numbers["passed"].where(numbers["measure"].isin(["", measure]))
    passed = counted.groupby([numbers["claim"], numbers["point"]])  # its extremes leave out what is not known
    is_known = passed.transform("count") > 0
    all_met = passed.transform("min") == 1
    some_met = passed.transform("max") == 1
    return np.select([~is_known, all_met, some_met], [UNTESTED, HOLDS, PARTLY], FAILS)


def format_verdicts(numbers: pd.DataFrame) -> list[str]:
    """Return the verdict of every row in words, with that by the largest storey where it is another one."""
    both = zip(numbers["verdict"], numbers["verdict_largest"], strict=True)
    return [mean if mean == largest else f"{mean} ({LARGEST}: {largest})" for mean, largest in both]


def judged(results: ResultTables) -> pd.DataFrame:
    """One row a number found at a point of the sweep: `where` and COLUMNS; of the claims about the figure that the
    study names, `claims: fig6` or `claims: fig7`."""
    data, axes = results.data, [names[0] for names in results.swept]
    found, where = evaluated(_with_motions(data, data), axes, results.resolved.get("claims")), list[str]()
    for point in product(*(list_points(results, keys) for keys in results.swept)):
        where.append(format_point(results, dict(zip(results.axes, chain(*point), strict=True))) or AS_GIVEN)
    found = found.assign(
        where=[where[point] for point in found["point"]],
        passed=[{1.0: True, 0.0: False}.get(passed, "") for passed in found["passed"]],
    )
    return found[["where", *COLUMNS]]


def at_samples(plan: Plan, data: xr.Dataset, question: Sensitivity) -> Iterator[Series]:
    """Whether every claim holds (1 or 0), and whether at least a part of it does, by the mean over the storeys and by
    the largest storey, at every sample of `pound sensitivity`; NaN of a sample with a scene that failed, and where
    nothing tests the claim."""
    from pounding_cli.questions.sensitivity.indices import (
        Series as Sampled,  # with SciPy; `pound report` does not need it
    )

    axes = [axis.names[0] for axis in plan.axes]  # the samples are the last one
    data = data.drop_vars(axes[-1]).isel({axes[-1]: xr.DataArray(question.point_of_sample, dims=axes[-1])})
    scenes = data
    if question.drawn is not None:
        drawn = xr.DataArray(question.drawn, dims=(axes[-1], "record"))
        scenes = data.drop_vars("record").isel(record=drawn)
    alone_failed: Any = np.isfinite(scenes["drift"]) & ~np.isfinite(scenes["drift0"])
    failed = (scenes["status"] != DONE) | alone_failed.any(("building", "storey"))
    is_void = failed.any(("case", "analysis", "record")).transpose(*axes).values
    found = evaluated(_with_motions(scenes, data), axes, plan.study.spec.claims)
    for key, mine in found.groupby("claim", sort=False):
        columns = {f"claim {key}": "verdict"}
        if (mine["measure"] != "").any():
            columns[f"claim {key}, {LARGEST}"] = "verdict_largest"
        for name, column in columns.items():
            said = mine.drop_duplicates("point")[column].to_numpy().reshape(is_void.shape)
            said = np.where(is_void, UNTESTED, said)
            for words, held in ((name, [HOLDS]), (f"{name}, at least in part", [HOLDS, PARTLY])):
                if held == [HOLDS] or (said == PARTLY).any():
                    number = np.where(said == UNTESTED, np.nan, np.isin(said, held))
                    for point in np.ndindex(number.shape[:-1]):
                        yield Sampled(point, "", "", words, "", number[point])


# what is shown of them


def list_claim_sections(results: ResultTables) -> list[Section]:
    """Return the sections of a report, with the numbers at the point of the sweep that its figures show; none where the
    study names no figure."""
    if results.workflow != "run":
        return []
    here = find_nominal(results).label
    every, rows = judged(results), []
    if every.empty:
        return []
    for key, mine in every[every["where"] == (here or AS_GIVEN)].groupby("claim", sort=False):
        _, paper, find = CLAIMS[str(key)]
        verdict = format_verdicts(mine.head(1))[0]
        rows.append([f"{key}\n“{paper}” {' '.join(str(find.__doc__).split())}", verdict, "", ""])
        met = mine["passed"].map({True: "met", False: "missed", "": NOTHING})
        rows += map(list, zip(mine["finding"], met, claim_texts(mine), mine["threshold"], strict=True))
    heads = ("claim, and its numbers", "verdict", "found", "threshold")
    tables = [table_of_texts("The paper’s claims, and the numbers found", heads, rows)]
    said = (
        "A claim holds if every number meets its threshold, holds partly if some do, does not hold if none does. The "
        f"verdict is that by the {MEAN}; in brackets that by the {LARGEST}, where it is another one."
    )
    numbers = Table("claims", every, [Column(str(name)) for name in every], "Every number at every point")
    return [Section("The paper’s claims", [said], tables), Section("Numbers of the claims", (), [numbers], folded=True)]


def verdicts(results: ResultTables) -> dict[str, str]:
    """Claim -> verdict, where nothing is swept and the study names a figure."""
    if results.axes:
        return {}
    found = judged(results)
    return dict(zip(found["claim"], format_verdicts(found), strict=True))


def claim_texts(frame: pd.DataFrame) -> list[str]:
    """Return the numbers of claims as people read them."""
    numbers = zip(frame["number"], frame["unit"], strict=True)
    return [f"{format_number(number, 3)} {unit}".removesuffix(" -") for number, unit in numbers]
