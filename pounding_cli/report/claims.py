"""The paper's statements about Figs 6 and 7, judged: the numbers that test them, their thresholds, the verdicts.

A claim is a function of one Dataset that gives its numbers at all points of the sweep at once; its docstring is the
rule that is printed. `evaluated` makes one DataFrame of all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain, product
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.records import catalogue
from pounding_cli.report.document import Section
from pounding_cli.report.evidence import points_of, told
from pounding_cli.report.table import NOTHING, digits, from_rows
from pounding_cli.results.tables import Table
from pounding_cli.solver.response import DONE
from pounding_cli.workflows.sensitivity import Sensitivity, Series

if TYPE_CHECKING:
    from pounding_cli.results.results import Results
    from pounding_cli.study import Plan

HOLDS, PARTLY, FAILS, UNTESTED = "holds", "holds partly", "does not hold", "not tested here"

AS_GIVEN = "as given"
"""What stands for the only point of a study without a sweep."""
IMPLIED = ("eureka", "olympia")
"""Stand-ins of these motions are built from Table 1's scale, so they cannot test it."""

RATIOS = (("V_ratio", "elastic", "V/V0, elastic"), ("mu_ratio", "inelastic", "μ/μ0, inelastic"))
"""What Figs 6 and 7 plot: the ratio to the building alone, its analysis, its name."""


class Finding(NamedTuple):
    """One number that was found.

    number : over the swept axes; NaN where the results have none
    met : whether it meets its threshold
    unit : "-" (ratio), "%" or "cm"
    """

    words: str
    number: xr.DataArray
    met: xr.DataArray
    unit: str = "-"


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


def stiffer(data: xr.Dataset) -> xr.DataArray:
    """Number of the building with the shortest fundamental period."""
    return data["period"].argmin("building")


def stiff(data: xr.Dataset, values: xr.DataArray) -> xr.DataArray:
    """Values of that building."""
    return values.isel(building=stiffer(data))


@claim("There is practically no reduction in either story shears or ductility factors [by the infill].")
def infill_response(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where the infill keeps at least 90 % of V/V0 (elastic) and of μ/μ0 (inelastic) of the stiffer building,
    mean over the storeys, both against touching and against the gap."""
    for base in ("touching", "gap"):
        for label, infill, other in responses(data, "infill", base):
            kept = stiff(data, infill / other).mean("storey")
            yield Finding(f"{label}: infill over {base}, mean over the storeys", kept, kept >= 0.9)


@claim("There is more than 80% reduction to the accelerations [by the infill].")
def infill_accelerations(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where the largest floor accelerations of the stiffer building fall by more than 80 % against touching,
    both in the mean over the floors and at the floor where they fall most, in each analysis."""
    for analysis in data["analysis"].values.tolist():
        infill, touching = (at(data, "acceleration", case, analysis) for case in ("infill", "touching"))
        falls = 100 * (1 - stiff(data, (infill / touching.where(touching > 0)).mean("record")))
        words = f"reduction of accelerations, infill against touching, {analysis}"
        mean, most = falls.mean("floor"), falls.max("floor")
        yield Finding(f"{words}, mean over the floors", mean, mean > 80, "%")
        yield Finding(f"{words}, at the floor where they fall most", most, most > 80, "%")


@claim("There is a small increase in the responses [...] if a 1/10 to 1/100 of this average value is used instead.")
def softer_infill(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where V/V0 and μ/μ0 of the stiffer building grow, by at most 15 %, mean over the storeys."""
    for case, share in (("infill_1_10", "1/10"), ("infill_1_100", "1/100")):
        for label, softer, infill in responses(data, case, "infill"):
            increase = 100 * (stiff(data, softer / infill).mean("storey") - 1)
            words = f"increase of {label}, infill at {share} against 1/5, mean over the storeys"
            yield Finding(words, increase, (increase > 0) & (increase <= 15), "%")


@claim("Results indicate that the code specified separation is quite adequate.", "fig7")
def code_gap(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where, with the 7 cm gap, no storey of any building has a mean ratio above 1.10."""
    for number, building in enumerate(data["building"].values.tolist()):
        for label, line in responses(data, "gap"):
            most = line.isel(building=number).max("storey")
            words = f"{label}: largest mean over the storeys of {building}, with the gap"
            yield Finding(words, most, most <= 1.1)


@claim("[...] a gap of 5cm (less than the UBC specification) for the 2-system.", "fig6")
def narrow_gap(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where the gap is smaller than the separation by the code."""
    gap, code = data["gap"].reindex(case=["gap"]).isel(case=0).max("link"), data["separation"].max("building")
    more = 100 * (code - gap)
    yield Finding("separation by the code less the gap of the study", more, more > 0, "cm")


@claim("The UBC specified separation distance (equal to the sum of the design maximum displacements) is approximately "
       "7cm.")  # fmt: skip
def separation(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where the separation rounds to 7 cm (6.5 to 7.5 cm)."""
    words = "separation by the code, sum of the design displacements at the roof"
    widest = 100 * data["separation"].max("building")
    yield Finding(words, widest, (widest >= 6.5) & (widest <= 7.5), "cm")


@claim("There is a substantial increase to the response of the stiffer building, especially for the inelastic case.")
def connection_stiffer(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where the mean ratio reaches 1.20 at some storey, in both analyses, and μ/μ0 (inelastic) lies above V/V0
    (elastic) in the mean over the storeys."""
    means = []
    for label, line in responses(data, "connected"):
        most = stiff(data, line).max("storey")
        yield Finding(f"{label}: largest mean over the storeys", most, most >= 1.2)
        means.append(stiff(data, line).mean("storey"))
    elastic, inelastic = means
    words = "mean over the storeys of μ/μ0, inelastic, less that of V/V0, elastic"
    yield Finding(words, inelastic - elastic, inelastic > elastic)


@claim("At the same time [...] the response of the other connected system was found to reduce.")
def connection_other(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where the mean ratios of every other building lie below 1, mean over the storeys."""
    for number, building in enumerate(data["building"].values.tolist()):
        is_other = stiffer(data) != number
        for label, line in responses(data, "connected") if is_other.any() else ():
            mean = line.isel(building=number).where(is_other).mean("storey")
            yield Finding(f"{label}: mean over the storeys of {building}", mean, mean < 1)


@claim("The connection always penalizes one building and benefits the other.")
def connection_always(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where, in every single motion, one building's ratio lies above 1 and another's below 1, mean over the
    storeys."""
    for ratio, analysis, label in RATIOS:
        means = at(data, ratio, "connected", analysis).mean("storey")
        both = (means.max("building") > 1) & (means.min("building") < 1)
        share = 100 * both.where((means == means).any("building")).mean("record")
        words = f"motions in which one building gains and another is relieved, {label}"
        yield Finding(words, share, share == 100, "%")


@claim("The maximum compression v must never be greater than the initial gap for meaningful results.")
def connection_closing(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where no connector closes by more than the gap, in no run."""
    bridged = data["gap"].where((data["kind"] == "connector") & (data["gap"] > 0))
    most = (100 * data["max_closing"] / bridged).max(("case", "link", "analysis", "record"))
    yield Finding("largest closing of a connector over its gap", most, most <= 100, "%")


@claim("The scale [of Table 1] was computed by equating the Arias intensities of these motions to the Arias intensity "
       "of the El Centro record.")  # fmt: skip
def scales(data: xr.Dataset) -> Iterator[Finding]:
    """Holds where the scales for equal Arias intensity, over the analysed durations, are Table 1's within 2 %."""
    first, names = "elcentro", data["motion"].values.tolist()
    for name in (each for each in names if each in catalogue() and each != first and first in names):
        source, printed = str(data["record_source"].sel(motion=name).values.flat[0]), catalogue()[name].scale
        if not (source == "stand-in" and name in IMPLIED):
            # Arias intensity goes with the square of the scale; that of the file is of the motion as used
            scale, arias = (data[f"record_{what}"] for what in ("scale", "arias"))
            scale, arias = (each.sel(motion=name) / each.sel(motion=first) for each in (scale, arias))
            ratio = scale / np.sqrt(arias) / printed
            words = f"{name} ({source}): scale for equal Arias intensity over Table 1's {printed:.2f}"
            yield Finding(words, ratio, abs(ratio - 1) <= 0.02)


# judging

_OF_MOTIONS = ("record_scale", "record_arias", "record_source")


def _with_motions(scenes: xr.Dataset, motions: xr.Dataset) -> xr.Dataset:
    """Scenes, whose `record` numbers the motions of a point, and what is known of every motion over its name,
    `motion`."""
    of_motions = {name: motions[name].reset_coords(drop=True).rename(record="motion") for name in _OF_MOTIONS}
    return scenes.drop_vars(_OF_MOTIONS).assign(of_motions)


def evaluated(data: xr.Dataset, axes: Sequence[str], figure: str | None) -> pd.DataFrame:
    """Every number of the claims about a figure at every point of the swept axes: claim, finding, unit, point (its
    number, the last axis fastest), number, passed (1, 0, NaN where no number is finite), verdict of the claim there."""
    whole, parts = xr.DataArray(np.zeros([data.sizes[axis] for axis in axes]), dims=axes), list[pd.DataFrame]()

    def at_points(values: xr.DataArray) -> np.ndarray:
        return values.reset_coords(drop=True).broadcast_like(whole).transpose(*axes).values.astype(float).ravel()

    for key, (about, _, find) in CLAIMS.items() if figure and "impacts" in data else ():
        for finding in find(data) if about in ("", figure) else ():
            number, met = at_points(finding.number), at_points(finding.met)
            numbers = {"point": np.arange(number.size), "number": number, "passed": met}
            parts.append(pd.DataFrame(numbers).assign(claim=key, finding=finding.words, unit=finding.unit))
    if not parts:
        return pd.DataFrame(columns=["point", "number", "passed", "claim", "finding", "unit", "verdict"])
    found = pd.concat(parts, ignore_index=True)
    found["passed"] = found["passed"].where(np.isfinite(found["number"]))
    passed = found.groupby(["claim", "point"])["passed"]  # its extremes leave out what is not known
    known, all_met, some_met = passed.transform("count") > 0, passed.transform("min"), passed.transform("max")
    found["verdict"] = np.select([~known, all_met == 1, some_met == 1], [UNTESTED, HOLDS, PARTLY], FAILS)
    return found


def judged(results: Results) -> pd.DataFrame:
    """One row a number found at a point of the sweep: where, claim, verdict, finding, number, unit, passed; of the
    claims about the figure that the study names, `claims: fig6` or `claims: fig7`."""
    data, axes = results.data, [names[0] for names in results.swept]
    found, where = evaluated(_with_motions(data, data), axes, results.resolved.get("claims")), list[str]()
    for point in product(*(points_of(results, keys) for keys in results.swept)):
        where.append(told(results, dict(zip(results.axes, chain(*point), strict=True))) or AS_GIVEN)
    found = found.assign(
        where=[where[point] for point in found["point"]],
        passed=[{1.0: True, 0.0: False}.get(passed, "") for passed in found["passed"]],
    )
    return found[["where", "claim", "verdict", "finding", "number", "unit", "passed"]]


def at_samples(plan: Plan, data: xr.Dataset, question: Sensitivity) -> Iterator[Series]:
    """Whether every claim holds (1 or 0), and whether at least a part of it does, at every sample of `pound
    sensitivity`; NaN of a sample with a scene that failed, and where nothing tests the claim."""
    axes = [axis.names[0] for axis in plan.axes]  # the samples are the last one
    data = data.drop_vars(axes[-1]).isel({axes[-1]: xr.DataArray(question.keys[2], dims=axes[-1])})
    scenes = data
    if question.drawn is not None:
        drawn = xr.DataArray(question.drawn, dims=(axes[-1], "record"))
        scenes = data.drop_vars("record").isel(record=drawn)
    alone_failed: Any = np.isfinite(scenes["drift"]) & ~np.isfinite(scenes["drift0"])
    failed = (scenes["status"] != DONE) | alone_failed.any(("building", "storey"))
    is_void = failed.any(("case", "analysis", "record")).transpose(*axes).values
    found = evaluated(_with_motions(scenes, data), axes, plan.study.model.claims)
    for key, mine in found.groupby("claim", sort=False):
        said = mine.drop_duplicates("point")["verdict"].to_numpy().reshape(is_void.shape)
        said = np.where(is_void, UNTESTED, said)
        for name, held in ((f"claim {key}", [HOLDS]), (f"claim {key}, at least in part", [HOLDS, PARTLY])):
            if held == [HOLDS] or (said == PARTLY).any():
                number = np.where(said == UNTESTED, np.nan, np.isin(said, held))
                yield from (Series(point, "", "", name, "", number[point]) for point in np.ndindex(number.shape[:-1]))


# what is shown of them


def claim_sections(results: Results, here: str) -> list[Section]:
    """The section of a report; none where the study names no figure.

    here : the point of the sweep whose numbers are shown, in words
    """
    every, rows = judged(results), []
    if every.empty:
        return []
    for key, mine in every[every["where"] == (here or AS_GIVEN)].groupby("claim", sort=False):
        _, paper, find = CLAIMS[str(key)]
        rows.append([f"{key}\n“{paper}” {' '.join(str(find.__doc__).split())}", mine["verdict"].iloc[0], ""])
        met = mine["passed"].map({True: "met", False: "missed", "": NOTHING})
        rows += map(list, zip(mine["finding"], met, claim_texts(mine), strict=True))
    heads = ("claim, and its numbers", "verdict", "found")
    tables = [from_rows("The paper’s claims, and the numbers found", heads, rows)]
    said = "A claim holds if every number meets its threshold, holds partly if some do, does not hold if none does."
    numbers = Table("claims", every, caption="Every number at every point")
    return [Section("The paper’s claims", [said], tables), Section("Numbers of the claims", (), [numbers], folded=True)]


def verdicts(results: Results) -> dict[str, str]:
    """Claim -> verdict, where nothing is swept and the study names a figure."""
    return {} if results.axes else {row["claim"]: row["verdict"] for row in judged(results).to_dict("records")}


def claim_texts(frame: pd.DataFrame) -> list[str]:
    """Return the numbers of claims as people read them."""
    numbers = zip(frame["number"], frame["unit"], strict=True)
    return [f"{digits(number, 3)} {unit}".removesuffix(" -") for number, unit in numbers]
