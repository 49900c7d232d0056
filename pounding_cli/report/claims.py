"""The paper's statements about Figs 6 and 7, judged: the numbers that test them, their thresholds, the verdicts.

A claim is a function that gives its numbers at all points of the sweep at once; `judged` makes one DataFrame of them.
Its docstring is the rule that is printed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.report.document import Section
from pounding_cli.report.table import NOTHING, digits, from_rows
from pounding_cli.results.tables import Table
from pounding_cli.solver.response import DONE
from pounding_cli.texts import cells, write_markdown
from pounding_cli.workflows.sensitivity import Sensitivity, Series

if TYPE_CHECKING:
    from pounding_cli.results.results import Results
    from pounding_cli.study import Plan

HOLDS, PARTLY, FAILS, UNTESTED = "holds", "holds partly", "does not hold", "not tested here"

TABLE1 = {"elcentro": 1.00, "taft": 1.75, "eureka": 1.33, "olympia": 1.25, "parkfield": 0.82}
"""Scales of the paper's Table 1 [-]."""
IMPLIED = ("eureka", "olympia")
"""Stand-ins of these motions are built from Table 1's scale, so they cannot test it."""

RESPONSES = (("V_ratio", "elastic", "V/V0, elastic"), ("mu_ratio", "inelastic", "μ/μ0, inelastic"))
"""What Figs 6 and 7 plot: the ratio, its analysis, its name."""

_OF_MOTIONS = ["record_scale", "record_arias", "record_source"]
_OF_SCENES = ["V_ratio", "mu_ratio", "acceleration", "impacts", "max_closing", "kind", "gap", "period", "separation"]


@dataclass(frozen=True)
class Numbers:
    """What claims rest on: variables of a results file, each over some swept axes, case, analysis, record and place.

    data : of the scenes; `record` numbers the motions of a point
    motions : scale, Arias intensity and source of every motion by name
    axes : the swept axes
    """

    data: xr.Dataset
    motions: xr.Dataset
    axes: tuple[str, ...]

    def of(self, name: str, case: str, analysis: str) -> xr.DataArray:
        """A variable in one case and analysis; NaN where the study lacks it."""
        return self.data[name].reindex(case=[case], analysis=[analysis]).isel(case=0, analysis=0, drop=True)

    def mean(self, ratio: str, case: str, analysis: str) -> xr.DataArray:
        """A line of the figures, of every building: mean over the motions of a ratio to the building alone."""
        return self.of(ratio, case, analysis).mean("record")

    def quotient(self, ratio: str, case: str, base: str, analysis: str) -> xr.DataArray:
        """The stiffer building's line of one case over that of another."""
        return (self.mean(ratio, case, analysis) / self.mean(ratio, base, analysis)).isel(building=self.stiffer)

    @cached_property
    def stiffer(self) -> xr.DataArray:
        """Number of the building with the shortest fundamental period."""
        return self.data["period"].argmin("building")

    @property
    def buildings(self) -> Iterator[tuple[int, str]]:
        """Numbers and names of all buildings."""
        return enumerate(self.data["building"].values.tolist())


class Finding(NamedTuple):
    """One number that was found.

    number : over swept axes; NaN where the results have none
    met : whether it meets its threshold
    unit : "-" (ratio), "%" or "cm"
    """

    words: str
    number: xr.DataArray
    met: xr.DataArray
    unit: str = "-"


Find = Callable[[Numbers], Iterator[Finding]]

CLAIMS: dict[str, tuple[str, str, Find]] = {}
"""By name in the order of the report: the figure that a statement is about ("" for both), the paper's words, its
numbers."""


def claim(paper: str, figure: str = "") -> Callable[[Find], Find]:
    """A decorator: the function gives the numbers that test what the paper says of a figure, of both unless given."""

    def noted(find: Find) -> Find:
        CLAIMS[find.__name__.replace("_", "-")] = (figure, paper, find)
        return find

    return noted


@claim("There is practically no reduction in either story shears or ductility factors [by the infill].")
def infill_response(of: Numbers) -> Iterator[Finding]:
    """Holds where the infill keeps at least 90 % of V/V0 (elastic) and of μ/μ0 (inelastic) of the stiffer building,
    mean over the storeys, both against touching and against the gap."""
    for base in ("touching", "gap"):
        for ratio, analysis, label in RESPONSES:
            kept = of.quotient(ratio, "infill", base, analysis).mean("storey")
            yield Finding(f"{label}: infill over {base}, mean over the storeys", kept, kept >= 0.9)


@claim("There is more than 80% reduction to the accelerations [by the infill].")
def infill_accelerations(of: Numbers) -> Iterator[Finding]:
    """Holds where the largest floor accelerations of the stiffer building fall by more than 80 % against touching,
    both in the mean over the floors and at the floor where they fall most, in each analysis."""

    for analysis in of.data["analysis"].values.tolist():
        infill, touching = (of.of("acceleration", case, analysis) for case in ("infill", "touching"))
        falls = 100 * (1 - (infill / touching.where(touching > 0)).mean("record").isel(building=of.stiffer))
        words = f"reduction of accelerations, infill against touching, {analysis}"
        mean, most = falls.mean("floor"), falls.max("floor")
        yield Finding(f"{words}, mean over the floors", mean, mean > 80, "%")
        yield Finding(f"{words}, at the floor where they fall most", most, most > 80, "%")


@claim("There is a small increase in the responses [...] if a 1/10 to 1/100 of this average value is used instead.")
def softer_infill(of: Numbers) -> Iterator[Finding]:
    """Holds where V/V0 and μ/μ0 of the stiffer building grow, by at most 15 %, mean over the storeys."""
    for case, share in (("infill_1_10", "1/10"), ("infill_1_100", "1/100")):
        for ratio, analysis, label in RESPONSES:
            increase = 100 * (of.quotient(ratio, case, "infill", analysis).mean("storey") - 1)
            words = f"increase of {label}, infill at {share} against 1/5, mean over the storeys"
            yield Finding(words, increase, (increase > 0) & (increase <= 15), "%")


@claim("Results indicate that the code specified separation is quite adequate.", "fig7")
def code_gap(of: Numbers) -> Iterator[Finding]:
    """Holds where, with the 7 cm gap, no storey of any building has a mean ratio above 1.10."""
    for number, building in of.buildings:
        for ratio, analysis, label in RESPONSES:
            most = of.mean(ratio, "gap", analysis).isel(building=number).max("storey")
            words = f"{label}: largest mean over the storeys of {building}, with the gap"
            yield Finding(words, most, most <= 1.1)


@claim("[...] a gap of 5cm (less than the UBC specification) for the 2-system.", "fig6")
def narrow_gap(of: Numbers) -> Iterator[Finding]:
    """Holds where the gap is smaller than the separation by the code."""
    gap, code = of.data["gap"].reindex(case=["gap"]).isel(case=0).max("link"), of.data["separation"].max("building")
    more = 100 * (code - gap)
    yield Finding("separation by the code less the gap of the study", more, more > 0, "cm")


@claim("The UBC specified separation distance (equal to the sum of the design maximum displacements) is approximately "
       "7cm.")  # fmt: skip
def separation(of: Numbers) -> Iterator[Finding]:
    """Holds where the separation rounds to 7 cm (6.5 to 7.5 cm)."""
    words = "separation by the code, sum of the design displacements at the roof"
    widest = 100 * of.data["separation"].max("building")
    yield Finding(words, widest, (widest >= 6.5) & (widest <= 7.5), "cm")


@claim("There is a substantial increase to the response of the stiffer building, especially for the inelastic case.")
def connection_stiffer(of: Numbers) -> Iterator[Finding]:
    """Holds where the mean ratio reaches 1.20 at some storey, in both analyses, and μ/μ0 (inelastic) lies above V/V0
    (elastic) in the mean over the storeys."""
    lines = [of.mean(ratio, "connected", how).isel(building=of.stiffer) for ratio, how, _ in RESPONSES]
    for (*_, label), line in zip(RESPONSES, lines, strict=True):
        most = line.max("storey")
        yield Finding(f"{label}: largest mean over the storeys", most, most >= 1.2)
    elastic, inelastic = (line.mean("storey") for line in lines)
    words = "mean over the storeys of μ/μ0, inelastic, less that of V/V0, elastic"
    yield Finding(words, inelastic - elastic, inelastic > elastic)


@claim("At the same time [...] the response of the other connected system was found to reduce.")
def connection_other(of: Numbers) -> Iterator[Finding]:
    """Holds where the mean ratios of every other building lie below 1, mean over the storeys."""
    for number, building in of.buildings:
        for ratio, analysis, label in RESPONSES if (of.stiffer != number).any() else ():
            line = of.mean(ratio, "connected", analysis).isel(building=number).where(of.stiffer != number)
            mean = line.mean("storey")
            yield Finding(f"{label}: mean over the storeys of {building}", mean, mean < 1)


@claim("The connection always penalizes one building and benefits the other.")
def connection_always(of: Numbers) -> Iterator[Finding]:
    """Holds where, in every single motion, one building's ratio lies above 1 and another's below 1, mean over the
    storeys."""
    for ratio, analysis, label in RESPONSES:
        means = of.of(ratio, "connected", analysis).mean("storey")
        both = (means.max("building") > 1) & (means.min("building") < 1)
        share = 100 * both.where((means == means).any("building")).mean("record")
        words = f"motions in which one building gains and another is relieved, {label}"
        yield Finding(words, share, share == 100, "%")


@claim("The maximum compression v must never be greater than the initial gap for meaningful results.")
def connection_closing(of: Numbers) -> Iterator[Finding]:
    """Holds where no connector closes by more than the gap, in no run."""
    bridged = of.data["gap"].where((of.data["kind"] == "connector") & (of.data["gap"] > 0))
    most = (100 * of.data["max_closing"] / bridged).max(("case", "link", "analysis", "record"))
    yield Finding("largest closing of a connector over its gap", most, most <= 100, "%")


@claim("The scale [of Table 1] was computed by equating the Arias intensities of these motions to the Arias intensity "
       "of the El Centro record.")  # fmt: skip
def scales(of: Numbers) -> Iterator[Finding]:
    """Holds where the scales for equal Arias intensity, over the analysed durations, are Table 1's within 2 %."""
    motions = {name: of.motions.sel(record=name, drop=True) for name in of.motions["record"].values.tolist()}
    for name in (each for each in motions if each in TABLE1 and each != "elcentro" and "elcentro" in motions):
        source = str(motions[name]["record_source"].values.flat[0])
        if not (source == "stand-in" and name in IMPLIED):
            # Arias intensity goes with the square of the scale; that of the file is of the motion as used
            scale, arias = (motions[name][each] / motions["elcentro"][each] for each in _OF_MOTIONS[:2])
            ratio = scale / np.sqrt(arias) / TABLE1[name]
            words = f"{name} ({source}): scale for equal Arias intensity over Table 1's {TABLE1[name]:.2f}"
            yield Finding(words, ratio, abs(ratio - 1) <= 0.02)


# judging


def evaluated(of: Numbers, figure: str | None) -> Iterator[tuple[str, list[tuple[Finding, np.ndarray, np.ndarray]]]]:
    """Of every claim about a figure the findings with their numbers at every point, and whether each meets its
    threshold: 1, 0, or NaN where there is no number; shape (axes...) each."""
    whole = xr.DataArray(np.zeros([of.data.sizes[axis] for axis in of.axes]), dims=of.axes)

    def at_points(values: xr.DataArray) -> xr.DataArray:
        return values.reset_coords(drop=True).broadcast_like(whole).transpose(*of.axes).astype(float)

    for key, (about, _, find) in CLAIMS.items() if figure and "impacts" in of.data else ():
        found = []
        for finding in find(of) if about in ("", figure) else ():
            number = at_points(finding.number)
            found.append((finding, number.values, at_points(finding.met).where(np.isfinite(number)).values))
        if found:
            yield key, found


def verdict(passed: Sequence[np.ndarray]) -> np.ndarray:
    """Holds where every threshold is met, does not hold where none is, holds partly in between."""
    met, known = np.array(passed) == 1, np.isfinite(passed)
    return np.select([~known.any(0), (met | ~known).all(0), met.any(0)], [UNTESTED, HOLDS, PARTLY], FAILS)


def judged(results: Results) -> pd.DataFrame:
    """One row a number found at a point of the sweep: where, claim, verdict, finding, number, unit, passed; of the
    claims about the figure that the study names, `claims: fig6` or `claims: fig7`."""
    data, axes = results.data, tuple(names[0] for names in results.swept)
    of = Numbers(data[[name for name in _OF_SCENES if name in data]], data[_OF_MOTIONS].reset_coords(_OF_MOTIONS), axes)
    where = []
    for at in np.ndindex(*(data.sizes[axis] for axis in axes)):
        point = [(key, results.axes[key][n]) for keys, n in zip(results.swept, at, strict=True) for key in keys]
        where.append(", ".join(f"{key} = {results.value_label(key, value)}" for key, value in point) or "as given")
    parts = [pd.DataFrame(columns=["where", "claim", "verdict", "finding", "number", "unit", "passed"])]
    for key, found in evaluated(of, results.resolved.get("claims")):
        said = verdict([passed for *_, passed in found]).ravel()
        for finding, number, passed in found:
            met = [{1.0: True, 0.0: False}.get(each, "") for each in passed.ravel().tolist()]
            columns = [where, key, said, finding.words, number.ravel(), finding.unit, met]
            parts.append(pd.DataFrame(dict(zip(parts[0].columns, columns, strict=True))))
    return pd.concat(parts[1:] or parts)


def at_samples(plan: Plan, data: xr.Dataset, question: Sensitivity) -> Iterator[Series]:
    """Whether every claim holds (1 or 0), and whether at least a part of it does, at every sample of `pound
    sensitivity`; NaN of a sample with a scene that failed, and where nothing tests the claim."""
    axes = tuple(axis.names[0] for axis in plan.axes)  # the samples are the last one
    at = {axes[-1]: xr.DataArray(question.keys[2], dims=axes[-1])}
    data = data.reset_coords(_OF_MOTIONS).drop_vars(axes[-1]).isel(at)
    scenes = data[[name for name in (*_OF_SCENES, "status", "drift", "drift0") if name in data]]
    if question.drawn is not None:
        drawn = xr.DataArray(question.drawn, dims=(axes[-1], "record"))
        scenes = scenes.drop_vars("record").isel(record=drawn)
    alone_failed = ((scenes["drift"] == scenes["drift"]) & (scenes["drift0"] != scenes["drift0"])).any(
        ("building", "storey")
    )
    failed = ((scenes["status"] != DONE) | alone_failed).any(("case", "analysis", "record")).transpose(*axes)
    for key, found in evaluated(Numbers(scenes, data[_OF_MOTIONS], axes), plan.study.model.claims):
        said = np.where(failed, UNTESTED, verdict([passed for *_, passed in found]))
        for name, held in ((f"claim {key}", (HOLDS,)), (f"claim {key}, at least in part", (HOLDS, PARTLY))):
            if held == (HOLDS,) or (said == PARTLY).any():
                number = np.where(said == UNTESTED, np.nan, np.isin(said, held))
                yield from (Series(point, "", "", name, "", number[point]) for point in np.ndindex(number.shape[:-1]))


# what is shown of them


def _text(number: float, unit: str) -> str:
    return f"{digits(number, 3)} {unit}".removesuffix(" -")


def claim_sections(results: Results, here: str) -> list[Section]:
    """The section of a report; none where the study names no figure.

    here : the point of the sweep whose numbers are shown, in words
    """
    every, rows = judged(results), []
    if every.empty:
        return []
    for key, mine in every[every["where"] == (here or "as given")].groupby("claim", sort=False):
        _, paper, find = CLAIMS[str(key)]
        rows.append([f"{key}\n“{paper}” {' '.join(str(find.__doc__).split())}", mine["verdict"].iloc[0], ""])
        for row in mine.to_dict("records"):
            met = {True: "met", False: "missed"}.get(row["passed"], NOTHING)
            rows.append([row["finding"], met, _text(row["number"], row["unit"])])
    heads = ("claim, and its numbers", "verdict", "found")
    tables = [from_rows("The paper’s claims, and the numbers found", heads, rows)]
    said = "A claim holds if every number meets its threshold, holds partly if some do, does not hold if none does."
    numbers = Table("claims", every, caption="Every number at every point")
    return [Section("The paper’s claims", [said], tables), Section("Numbers of the claims", (), [numbers], folded=True)]


def compare_claims(results: Mapping[str, Results], folder: Path) -> list[Path]:
    """Write `comparison.md` and `comparison.csv`: the claims in several results, at every point of their sweeps."""
    found = {name: judged(each) for name, each in results.items()}
    frame = pd.concat(f.assign(where=f"{n}: " + f["where"] if results[n].axes else n) for n, f in found.items())
    folder.mkdir(parents=True, exist_ok=True)
    cells(frame).to_csv(folder / "comparison.csv", index=False)
    lines = [f"# Claims compared: {', '.join(results)}", ""]
    if frame.empty:
        lines.append("No results here name a figure of the paper (`claims: fig6` or `fig7`).")
    else:
        numbers = pd.Series(map(_text, frame["number"], frame["unit"]), frame.index)
        numbers = numbers.mask(frame["passed"].eq(False).to_numpy(), "**" + numbers + "**")
        lines += [*_lines(_wide(frame, "claim", "where", frame["verdict"])), ""]
        lines += ["Numbers found; those that miss their threshold are bold.", ""]
        lines += _lines(_wide(frame, "finding", "where", numbers).rename_axis("number found"))
    return [write_markdown(folder / "comparison.md", lines), folder / "comparison.csv"]


def verdicts(results: Results) -> dict[str, str]:
    """Claim -> verdict, where nothing is swept and the study names a figure."""
    return {} if results.axes else {row["claim"]: row["verdict"] for row in judged(results).to_dict("records")}


def _wide(frame: pd.DataFrame, down: str, across: str, values: pd.Series) -> pd.DataFrame:
    """Values by two columns, in the order of the frame; NOTHING where there is none."""
    return frame.assign(shown=values.to_numpy()).pivot_table("shown", down, across, "first", sort=False).fillna(NOTHING)


def _lines(frame: pd.DataFrame) -> list[str]:
    """A table in Markdown."""
    rows = [[frame.index.name, *frame.columns], ["---"] * (1 + frame.shape[1]), *frame.reset_index().to_numpy()]
    return ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows]
