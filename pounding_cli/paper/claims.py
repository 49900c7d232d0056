"""The paper's statements about Figs 6 and 7: the numbers that test them, each with its threshold.

A claim is a function of one Dataset that yields its numbers at all points of the sweep at once; its docstring is
printed. `verdicts.evaluate_claims` makes one DataFrame of all of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from pounding_cli.laws.joints import Connector
from pounding_cli.laws.pounding import Pounding
from pounding_cli.records import load_catalogue

HOLDS = "holds"
PARTLY = "holds partly"
FAILS = "does not hold"
UNTESTED = "not tested here"
"""Verdicts: all numbers of a claim meet their thresholds, some do, none does, none is known."""

AS_GIVEN = "as given"
"""The only point of a study without a sweep."""

IMPLIED = ("eureka", "olympia")
"""Motions whose stand-ins are built from Table 1's scale, so that they cannot test it."""

RATIOS = (("V_ratio", "elastic", "V/V0, elastic"), ("mu_ratio", "inelastic", "μ/μ0, inelastic"))
"""Quantities of Figs 6 and 7: the ratio to the building alone, its analysis, its name."""

MEAN_OF_STOREYS = "mean over the storeys"
LARGEST_STOREY = "largest storey"
"""The two readings of "the response" that a line of the figures over the storeys shows.

A verdict rests on the first; where the second gives another one, that stands beside it.
"""

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

    words : its meaning
    number : over the swept axes; NaN where the results have none
    threshold : in the unit of the number
    unit : "-" (ratio), "%", "cm" or "kN s"
    measure : MEAN_OF_STOREYS or LARGEST_STOREY where the claim has a number by each; "" of one that counts for both
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


@dataclass(frozen=True)
class Claim:
    """A statement of the paper.

    figure : that it is about, "fig6" or "fig7"; "" for both
    paper : its words
    find : results -> numbers that test it
    """

    figure: str
    paper: str
    find: Find

    @property
    def meaning(self) -> str:
        """The numbers that test it, in words."""
        return " ".join(str(self.find.__doc__).split())


CLAIMS: dict[str, Claim] = {}
"""Every claim by its name, in the order of the report."""


def claim(paper: str, figure: str = "") -> Callable[[Find], Find]:
    """Return a decorator of the function that yields the numbers of a claim.

    paper : the words of the paper
    figure : that they are about; both unless given
    """

    def register(find: Find) -> Find:
        CLAIMS[find.__name__.replace("_", "-")] = Claim(figure, paper, find)
        return find

    return register


def select_runs(data: xr.Dataset, name: str, case: str, analysis: str) -> xr.DataArray:
    """Return a variable in one case and analysis; NaN where the study lacks it."""
    return data[name].reindex(case=[case], analysis=[analysis]).isel(case=0, analysis=0, drop=True)


def iter_responses(data: xr.Dataset, *cases: str) -> Iterator[tuple[Any, ...]]:
    """Yield the lines of the figures, each with its mean over the motions in every case, over building and storey.

    The first is "V/V0, elastic", the second "μ/μ0, inelastic".
    """
    for ratio, analysis, label in RATIOS:
        yield label, *(select_runs(data, ratio, case, analysis).mean("record") for case in cases)


def iter_measures(line: xr.DataArray) -> Iterator[tuple[str, xr.DataArray]]:
    """Yield both readings of a line over the storeys, each with its name."""
    yield MEAN_OF_STOREYS, line.mean("storey")
    yield LARGEST_STOREY, line.max("storey")


def find_stiffest(data: xr.Dataset) -> xr.DataArray:
    """Return the number of the building with the shortest fundamental period, of several the first from the left."""
    return data["period"].argmin("building")


def select_stiffest(data: xr.Dataset, values: xr.DataArray) -> xr.DataArray:
    """Return the values of that building."""
    return values.isel(building=find_stiffest(data))


def is_softer(data: xr.Dataset, building: int) -> xr.DataArray:
    """Return whether a building has a longer period than the stiffest of the group."""
    periods = data["period"]
    return periods.isel(building=building) > SAME_PERIOD * periods.min("building")


def find_code_separation(data: xr.Dataset) -> xr.DataArray:
    """Return the largest separation by the code of two neighbours with different periods [m]."""
    periods = data["period"]
    longer = np.fmax(periods, periods.shift(building=-1))
    shorter = np.fmin(periods, periods.shift(building=-1))
    return data["separation"].where(longer > SAME_PERIOD * shorter).max("building")


def select_links(data: xr.Dataset, name: str, kind: str) -> xr.DataArray:
    """Return a variable of the links of one kind in the case `connected`, over its other dimensions; NaN at others."""
    is_kind = data["kind"].reindex(case=["connected"]).isel(case=0, drop=True) == kind
    return data[name].reindex(case=["connected"]).isel(case=0, drop=True).where(is_kind)


def list_run_dims(values: xr.DataArray) -> list[str]:
    """Return the dimensions of links and runs that values have."""
    return [dim for dim in ("link", "analysis", "record") if dim in values.dims]


@claim("There is practically no reduction in either story shears or ductility factors [by the infill].")
def infill_response(data: xr.Dataset) -> Iterator[Finding]:
    """V/V0 (elastic) and μ/μ0 (inelastic) of the stiffer building with the infill, over those of touching and of the
    gap."""
    for base in ("touching", "gap"):
        for label, infill, other in iter_responses(data, "infill", base):
            words = f"{label}: infill over {base}"
            threshold = Threshold(low=0.9)
            kept = select_stiffest(data, infill / other).mean("storey")
            yield Finding(f"{words}, {MEAN_OF_STOREYS}", kept, threshold, measure=MEAN_OF_STOREYS)
            largest = select_stiffest(data, infill).max("storey") / select_stiffest(data, other).max("storey")
            yield Finding(f"{words}, {LARGEST_STOREY}", largest, threshold, measure=LARGEST_STOREY)


@claim("There is more than 80% reduction to the accelerations [by the infill].")
def infill_accelerations(data: xr.Dataset) -> Iterator[Finding]:
    """The fall of the largest floor accelerations of the stiffer building with the infill, against touching."""
    for analysis in data["analysis"].values.tolist():
        infill, touching = (select_runs(data, "acceleration", case, analysis) for case in ("infill", "touching"))
        falls = 100 * (1 - select_stiffest(data, (infill / touching.where(touching > 0)).mean("record")))
        words = f"reduction of accelerations, infill against touching, {analysis}"
        threshold = Threshold(low=80, is_open=True)
        yield Finding(f"{words}, mean over the floors", falls.mean("floor"), threshold, "%")
        yield Finding(f"{words}, at the floor where they fall most", falls.max("floor"), threshold, "%")


@claim("There is a small increase in the responses [...] if a 1/10 to 1/100 of this average value is used instead.")
def softer_infill(data: xr.Dataset) -> Iterator[Finding]:
    """The increase of V/V0 and μ/μ0 of the stiffer building with a softer infill."""
    for case, share in (("infill_1_10", "1/10"), ("infill_1_100", "1/100")):
        for label, softer, infill in iter_responses(data, case, "infill"):
            words = f"increase of {label}, infill at {share} against 1/5"
            threshold = Threshold(0, 15, is_open=True)
            mean = 100 * (select_stiffest(data, softer / infill).mean("storey") - 1)
            yield Finding(f"{words}, {MEAN_OF_STOREYS}", mean, threshold, "%", MEAN_OF_STOREYS)
            largest = 100 * (
                select_stiffest(data, softer).max("storey") / select_stiffest(data, infill).max("storey") - 1
            )
            yield Finding(f"{words}, {LARGEST_STOREY}", largest, threshold, "%", LARGEST_STOREY)


@claim("Results indicate that the code specified separation is quite adequate.", "fig7")
def code_gap(data: xr.Dataset) -> Iterator[Finding]:
    """The mean ratios of every building with the gap of 7 cm."""
    for number, building in enumerate(data["building"].values.tolist()):
        for label, line in iter_responses(data, "gap"):
            for measure, value in iter_measures(line.isel(building=number)):
                words = f"{label}: {building} with the gap, {measure}"
                yield Finding(words, value, Threshold(high=1.1), measure=measure)


@claim("[...] a gap of 5cm (less than the UBC specification) for the 2-system.", "fig6")
def narrow_gap(data: xr.Dataset) -> Iterator[Finding]:
    """The separation by the code less the gap."""
    gap = data["gap"].reindex(case=["gap"]).isel(case=0).max("link")
    words = "separation by the code less the gap of the study"
    yield Finding(words, 100 * (find_code_separation(data) - gap), Threshold(low=0, is_open=True), "cm")


@claim("The UBC specified separation distance (equal to the sum of the design maximum displacements) is approximately "
       "7cm.")  # fmt: skip
def separation(data: xr.Dataset) -> Iterator[Finding]:
    """The separation by the code of a stiff and a soft building, which should round to 7 cm."""
    words = "separation by the code, sum of the design displacements at the roof"
    yield Finding(words, 100 * find_code_separation(data), Threshold(6.5, 7.5), "cm")


@claim("There is a substantial increase to the response of the stiffer building, especially for the inelastic case.")
def connection_stiffer(data: xr.Dataset) -> Iterator[Finding]:
    """The ratios of the stiffer building when connected, at the storey where they are largest; and how far μ/μ0
    (inelastic) lies above V/V0 (elastic)."""
    elastic, inelastic = (select_stiffest(data, line) for _, line in iter_responses(data, "connected"))
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
        if not softer.any():
            continue
        for label, line in iter_responses(data, "connected"):
            for measure, value in iter_measures(line.isel(building=number).where(softer)):
                words = f"{label}: {building} when connected, {measure}"
                yield Finding(words, value, Threshold(high=1, is_open=True), measure=measure)


@claim("The connection always penalizes one building and benefits the other.")
def connection_always(data: xr.Dataset) -> Iterator[Finding]:
    """The motions in which one building's ratio lies above 1 and another's below 1."""
    for ratio, analysis, label in RATIOS:
        for measure, values in iter_measures(select_runs(data, ratio, "connected", analysis)):
            both = (values.max("building") > 1) & (values.min("building") < 1)
            share = 100 * both.where((values == values).any("building")).mean("record")
            words = f"motions in which one building gains and another is relieved, {label}, {measure}"
            yield Finding(words, share, Threshold(low=100), "%", measure)


@claim("To avoid pounding at any level both the top and the middle floors were connected.")
def connection_levels(data: xr.Dataset) -> Iterator[Finding]:
    """The largest closing, in any run, of floors that could strike beside the connected ones."""
    closing = select_links(data, "max_closing", Pounding.name)
    gap = select_links(data, "gap", Pounding.name)
    most = 100 * closing / gap.where(gap > 0)
    words = "largest closing of the floors that are not connected, over the gap"
    yield Finding(words, most.max(list_run_dims(most)), Threshold(high=100), "%")


@claim("The corresponding impact elements are continuously active throughout the entire motion of the configuration, "
       "independent of the sign of [the closing].")  # fmt: skip
def connection_both_ways(data: xr.Dataset) -> Iterator[Finding]:
    """The time for which a connector acts, and its force summed over a motion: below 0 where it pulls more than it
    pushes."""
    share = 100 * select_links(data, "contact_time", Connector.name) / data["record_window"]
    impulse = select_links(data, "impulse", Connector.name) / 1e3
    words = "time for which a connector acts, over that of the motion, least"
    yield Finding(words, share.min(list_run_dims(share)), Threshold(low=99.9), "%")
    words = "force of a connector summed over a motion, pulling negative"
    least = impulse.min(list_run_dims(impulse))
    most = impulse.max(list_run_dims(impulse))
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
    first = "elcentro"
    names = data["motion"].values.tolist()
    for name in names:
        if first not in names or name == first or name not in load_catalogue():
            continue
        source = str(data["record_source"].sel(motion=name).values.flat[0])
        printed = load_catalogue()[name].scale
        if source == "stand-in" and name in IMPLIED:
            continue
        # Arias intensity goes with the square of the scale; that of the file is of the motion as used
        scale, arias = (
            data[variable].sel(motion=name) / data[variable].sel(motion=first)
            for variable in ("record_scale", "record_arias")
        )
        words = f"{name} ({source}): scale for equal Arias intensity over Table 1's {printed:.2f}"
        yield Finding(words, scale / np.sqrt(arias) / printed, Threshold(0.98, 1.02))
