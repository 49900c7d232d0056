"""The paper's statements about Figs 6 and 7, judged: the numbers that test them, their thresholds, the verdicts."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from pounding_cli.report.document import Section
from pounding_cli.report.evidence import Evidence, points
from pounding_cli.report.table import NOTHING, digits, from_rows
from pounding_cli.study.claim_names import CLAIMS as FIGURES
from pounding_cli.texts import cells, write_markdown

if TYPE_CHECKING:
    from pounding_cli.results.results import Results


class Verdict(StrEnum):
    """What the findings say about a statement."""

    HOLDS = "holds"
    PARTLY = "holds partly"
    FAILS = "does not hold"
    UNTESTED = "not tested here"


@dataclass(frozen=True)
class Finding:
    """One number found, in words, and whether it meets its threshold.

    number : NaN where the results have none
    unit : "-" (ratio), "%" or "cm", the unit of `number`
    passed : None where the number is for information only, or could not be found
    """

    words: str
    number: float
    unit: str = "-"
    passed: bool | None = None

    @property
    def text(self) -> str:
        """The number with its unit; a dash where there is none."""
        return f"{digits(self.number, 3)} {self.unit}".removesuffix(" -")


def found(words: str, number: float, test: Callable[[float], bool], unit: str = "-") -> Finding:
    """A finding that counts for the verdict, unless its number is NaN."""
    number = float(number)
    return Finding(words, number, unit, None if math.isnan(number) else bool(test(number)))


@dataclass(frozen=True)
class Claim:
    """One statement of the paper.

    key : short name, in tables
    paper : the paper's words
    rule : the thresholds, in words
    find : the numbers at one point of the sweep
    """

    key: str
    paper: str
    rule: str
    find: Callable[[Evidence], Sequence[Finding]]


def verdict(findings: Sequence[Finding]) -> Verdict:
    """Holds where every threshold is met, does not hold where none is, holds partly in between."""
    passed = [finding.passed for finding in findings if finding.passed is not None]
    if not passed:
        return Verdict.UNTESTED
    return Verdict.HOLDS if all(passed) else Verdict.PARTLY if any(passed) else Verdict.FAILS


NO_REDUCTION = 0.90
"""A response is "practically" not reduced while it keeps at least this share of the other one [-]."""
BIG_REDUCTION = 80.0
"""The paper's reduction of the accelerations [%]."""
SMALL_INCREASE = 15.0
"""Up to here an increase is small [%]."""
ADEQUATE = 1.10
"""A gap is adequate while no storey's mean ratio exceeds this [-]."""
SUBSTANTIAL = 1.20
"""An increase is substantial from here, at the storey where it is largest [-]."""

TABLE1 = {"elcentro": 1.00, "taft": 1.75, "eureka": 1.33, "olympia": 1.25, "parkfield": 0.82}
"""Scales of the paper's Table 1 [-]."""
IMPLIED = ("eureka", "olympia")
"""Stand-ins of these motions are built from Table 1's scale, so they cannot test it."""

RESPONSES = (("V_ratio", "elastic", "V/V0, elastic"), ("mu_ratio", "inelastic", "μ/μ0, inelastic"))
"""What Figs 6 and 7 plot: the ratio, its analysis, its name."""


def _quotient(evidence: Evidence, case: str, base: str, ratio: str, analysis: str, building: str) -> pd.Series:
    """One case's line in the figure over another's, per storey."""
    mine = evidence.means(evidence.case_of(case), analysis, building, ratio)
    return (mine / evidence.means(evidence.case_of(base), analysis, building, ratio)).dropna()


def infill_response(evidence: Evidence) -> list[Finding]:
    """Line of the infill over the lines of touching and of the gap, for the stiffer building."""
    findings = []
    for base in ("touching", "gap"):
        for ratio, analysis, label in RESPONSES:
            quotient = _quotient(evidence, "infill", base, ratio, analysis, evidence.stiffer)
            words = f"{label}: infill over {base}, mean over the storeys"
            findings.append(found(words, quotient.mean(), lambda number: number >= NO_REDUCTION))
            if base == "touching":
                findings.append(Finding(f"{label}: infill over {base}, lowest at any storey", quotient.min()))
    return findings


def infill_acceleration(evidence: Evidence) -> list[Finding]:
    """Reduction of the floor accelerations of the stiffer building, infill against touching."""
    findings = []
    infill, touching, gap = (evidence.case_of(role) for role in ("infill", "touching", "gap"))
    for analysis in evidence.analyses:
        reduction = 100 * (1 - evidence.against(infill, touching, analysis, evidence.stiffer))
        for name, number in (
            ("mean over the floors", reduction.mean()),
            ("at the floor where they fall most", reduction.max()),
        ):
            words = f"reduction of accelerations, infill against touching, {analysis}, {name}"
            findings.append(found(words, number, lambda number: number > BIG_REDUCTION, "%"))
        beside_gap = 100 * (1 - evidence.against(infill, gap, analysis, evidence.stiffer))
        words = f"the same against the gap, {analysis}, mean over the floors"
        findings.append(Finding(words, beside_gap.mean(), "%"))
    return findings


def softer_infill(evidence: Evidence) -> list[Finding]:
    """Change of the responses when the infill is softened to 1/10 and 1/100 of the mean storey stiffness."""
    findings = []
    for case, share in (("infill_1_10", "1/10"), ("infill_1_100", "1/100")):
        for ratio, analysis, label in RESPONSES:
            quotient = _quotient(evidence, case, "infill", ratio, analysis, evidence.stiffer)
            words = f"increase of {label}, infill at {share} against 1/5, mean over the storeys"
            increase = 100 * (quotient.mean() - 1)
            findings.append(found(words, increase, lambda number: 0 < number <= SMALL_INCREASE, "%"))
    return findings


def _gap_responses(evidence: Evidence, counts: bool) -> list[Finding]:
    gap = evidence.case_of("gap")
    findings = []
    for building in (evidence.stiffer, *evidence.others):
        for ratio, analysis, label in RESPONSES:
            number = evidence.means(gap, analysis, building, ratio).max()
            words = f"{label}: largest mean over the storeys of {building}, with the gap"
            counted = found(words, number, lambda number: number <= ADEQUATE)
            findings.append(counted if counts else Finding(words, number))
    return findings


def code_gap(evidence: Evidence) -> list[Finding]:
    """Responses of every building with the code's separation as the gap."""
    return [*_gap_responses(evidence, counts=True), _scenes_with_impacts(evidence)]


def _scenes_with_impacts(evidence: Evidence) -> Finding:
    links = evidence.link[evidence.link["case"] == evidence.case_of("gap")]
    struck = links.groupby(["analysis", "record"])["impacts"].sum() > 0
    return Finding("runs with the gap in which the buildings still collide", 100 * struck.mean(), "%")


def _gap_width(evidence: Evidence) -> float:
    """Width of the gap case [cm]; NaN where there is none."""
    widths = evidence.link[evidence.link["case"] == evidence.case_of("gap")]["gap"]
    return 100 * float(widths.max()) if len(widths) else math.nan


def _separation(evidence: Evidence) -> float:
    """The code's separation at the roof [cm], the largest over the neighbours; NaN where no code was used."""
    return 100 * float(evidence.buildings["separation"].max())


def separation(evidence: Evidence) -> list[Finding]:
    """The code's separation of the study's buildings."""
    words = "separation by the code, sum of the design displacements at the roof"
    return [found(words, _separation(evidence), lambda number: 6.5 <= number <= 7.5, "cm")]


def narrow_gap(evidence: Evidence) -> list[Finding]:
    """The gap of the 2-system group against the code's separation, and what it does."""
    difference = _separation(evidence) - _gap_width(evidence)
    words = "separation by the code less the gap of the study"
    return [
        found(words, difference, lambda number: number > 0, "cm"),
        *_gap_responses(evidence, counts=False),
        _scenes_with_impacts(evidence),
    ]


def connected_stiffer(evidence: Evidence) -> list[Finding]:
    """The stiffer building when connected: how much it gains, and in which analysis more."""
    case = evidence.case_of("connected")
    lines = {label: evidence.means(case, how, evidence.stiffer, ratio) for ratio, how, label in RESPONSES}
    findings = [
        found(f"{label}: largest mean over the storeys", line.max(), lambda number: number >= SUBSTANTIAL)
        for label, line in lines.items()
    ]
    elastic, inelastic = (line.mean() for line in lines.values())
    words = "mean over the storeys of μ/μ0, inelastic, less that of V/V0, elastic"
    return [*findings, found(words, inelastic - elastic, lambda number: number > 0)]


def connected_others(evidence: Evidence) -> list[Finding]:
    """The other buildings when the group is connected."""
    case = evidence.case_of("connected")
    return [
        found(
            f"{label}: mean over the storeys of {building}",
            evidence.means(case, analysis, building, ratio).mean(),
            lambda number: number < 1,
        )
        for building in evidence.others
        for ratio, analysis, label in RESPONSES
    ]


def connected_always(evidence: Evidence) -> list[Finding]:
    """In how many motions the connection raises one building (mean over its storeys) and lowers another."""
    findings = []
    rows = evidence.storey[evidence.storey["case"] == evidence.case_of("connected")]
    for ratio, analysis, label in RESPONSES:
        here = rows[rows["analysis"] == analysis].dropna(subset=[ratio])
        means = here.pivot_table(index="record", columns="building", values=ratio, aggfunc="mean")
        share = 100 * ((means.max(axis=1) > 1) & (means.min(axis=1) < 1)).mean()
        words = f"motions in which one building gains and another is relieved, {label}"
        findings.append(found(words, share, lambda number: number == 100, "%"))
    return findings


def connected_closing(evidence: Evidence) -> list[Finding]:
    """Largest closing of the connectors over the gap they bridge."""
    links = evidence.link[(evidence.link["kind"] == "connector") & (evidence.link["gap"] > 0)]
    share = 100 * (links["max_closing"] / links["gap"])
    within = share.groupby([links["analysis"], links["record"]]).max() <= 100
    return [
        found("largest closing of a connector over its gap", share.max(), lambda number: number <= 100, "%"),
        Finding("runs in which every connector keeps within its gap", 100 * within.mean(), "%"),
    ]


def scales(evidence: Evidence) -> list[Finding]:
    """The scale that gives every motion El Centro's Arias intensity, over Table 1's."""
    used = evidence.records.drop_duplicates("record").set_index("record").to_dict("index")
    if "elcentro" not in used:
        return [Finding("El Centro is not among the motions", math.nan)]
    reference = used["elcentro"]
    findings = []
    for record, row in used.items():
        if record not in TABLE1 or record == "elcentro":
            continue
        # Arias intensity goes with the square of the scale; `arias` is that of the motion as used.
        factor = row["scale"] / reference["scale"] * math.sqrt(reference["arias"] / row["arias"])
        words = f"{record} ({row['source']}): scale for equal Arias intensity over Table 1's {TABLE1[record]:.2f}"
        number = factor / TABLE1[record]
        if row["source"] == "stand-in" and record in IMPLIED:
            findings.append(Finding(f"{words} (no test: this stand-in is built from that scale)", number))
        else:
            findings.append(found(words, number, lambda number: abs(number - 1) <= 0.02))
        if abs(row["scale"] / factor - 1) > 0.005:
            findings.append(Finding(f"{record}: scale as used over Table 1's", row["scale"] / TABLE1[record]))
    return findings


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "infill-response",
        "There is practically no reduction in either story shears or ductility factors [by the infill].",
        "Holds where the infill keeps at least 90 % of V/V0 (elastic) and of μ/μ0 (inelastic) of the stiffer "
        "building, mean over the storeys, both against touching and against the gap.",
        infill_response,
    ),
    Claim(
        "infill-accelerations",
        "There is more than 80% reduction to the accelerations [by the infill].",
        "Holds where the largest floor accelerations of the stiffer building fall by more than 80 % against "
        "touching, both in the mean over the floors and at the floor where they fall most, in each analysis.",
        infill_acceleration,
    ),
    Claim(
        "softer-infill",
        "There is a small increase in the responses [...] if a 1/10 to 1/100 of this average value is used instead.",
        "Holds where V/V0 and μ/μ0 of the stiffer building grow, by at most 15 %, mean over the storeys.",
        softer_infill,
    ),
    Claim(
        "code-gap",
        "Results indicate that the code specified separation is quite adequate.",
        "Holds where, with the 7 cm gap, no storey of any building has a mean ratio above 1.10.",
        code_gap,
    ),
    Claim(
        "narrow-gap",
        "[...] a gap of 5cm (less than the UBC specification) for the 2-system.",
        "Holds where the gap is smaller than the separation by the code; the responses are for information.",
        narrow_gap,
    ),
    Claim(
        "separation",
        "The UBC specified separation distance (equal to the sum of the design maximum displacements) is "
        "approximately 7cm.",
        "Holds where the separation rounds to 7 cm (6.5 to 7.5 cm).",
        separation,
    ),
    Claim(
        "connection-stiffer",
        "There is a substantial increase to the response of the stiffer building, especially for the inelastic case.",
        "Holds where the mean ratio reaches 1.20 at some storey, in both analyses, and μ/μ0 (inelastic) lies "
        "above V/V0 (elastic) in the mean over the storeys.",
        connected_stiffer,
    ),
    Claim(
        "connection-other",
        "At the same time [...] the response of the other connected system was found to reduce.",
        "Holds where the mean ratios of every other building lie below 1, mean over the storeys.",
        connected_others,
    ),
    Claim(
        "connection-always",
        "The connection always penalizes one building and benefits the other.",
        "Holds where, in every single motion, one building's ratio lies above 1 and another's below 1, mean "
        "over the storeys.",
        connected_always,
    ),
    Claim(
        "connection-closing",
        "The maximum compression v must never be greater than the initial gap for meaningful results.",
        "Holds where no connector closes by more than the gap, in no run.",
        connected_closing,
    ),
    Claim(
        "scales",
        "The scale [of Table 1] was computed by equating the Arias intensities of these motions to the Arias "
        "intensity of the El Centro record.",
        "Holds where the scales for equal Arias intensity, over the analysed durations, are Table 1's within 2 %.",
        scales,
    ),
)
"""Every statement about Figs 6 and 7, in the order of the report."""


# judging


def judged(evidences: Mapping[str, Evidence]) -> pd.DataFrame:
    """One row a number found: where, claim, verdict, finding, number, unit, passed; of the claims about the figure that
    the study names, `claims: fig6` or `claims: fig7`.

    evidences : by what stands in the column `where`
    """
    rows = []
    for where, evidence in evidences.items():
        for claim in CLAIMS:
            if evidence.resolved.get("claims") in FIGURES[claim.key]:
                findings = claim.find(evidence)
                for each in findings:
                    passed = "" if each.passed is None else each.passed
                    rows.append((where, claim.key, str(verdict(findings)), each.words, each.number, each.unit, passed))
    return pd.DataFrame(rows, columns=["where", "claim", "verdict", "finding", "number", "unit", "passed"])


def _named(evidences: Sequence[Evidence]) -> dict[str, Evidence]:
    return {evidence.label or "as given": evidence for evidence in evidences}


def claim_sections(evidences: Sequence[Evidence], shown: Evidence) -> list[Section]:
    """The section of a report; none where the study names no figure."""
    frame = judged(_named([shown]))
    if frame.empty:
        return []
    said = "A claim holds if every number meets its threshold, holds partly if some do, does not hold if none does."
    rows = []
    for claim in (claim for claim in CLAIMS if claim.key in set(frame["claim"])):
        mine = frame[frame["claim"] == claim.key]
        rows.append([f"{claim.key}\n“{claim.paper}” {claim.rule}", mine["verdict"].iloc[0], ""])
        for row in mine.to_dict("records"):
            met = {True: "met", False: "missed"}.get(row["passed"], "for information")
            rows.append([row["finding"], met, Finding("", row["number"], row["unit"]).text])
    tables = [
        from_rows("The paper’s claims, and the numbers found", ("claim, and its numbers", "verdict", "found"), rows)
    ]
    if len(evidences) > 1:
        everywhere = judged(_named(evidences)).drop_duplicates(["where", "claim"])
        rows = [[where, *of["verdict"]] for where, of in everywhere.groupby("where", sort=False)]
        heads = ["point", *dict.fromkeys(everywhere["claim"])]
        tables.append(from_rows("Verdicts at every point of the sweep", heads, rows))
    return [Section("The paper’s claims", [said], tables)]


def claims_beside(results: Results, folder: Path) -> list[Path]:
    """Write the claims at every point of the sweep as CSV, and of a sweep as Markdown; returns the files."""
    frame = judged(_named(points(results)))
    files = [folder / "tables" / "claims.csv"]
    cells(frame).to_csv(files[0], index=False)
    if len(set(frame["where"])) > 1:
        title = f"Claims over the sweep: {results.title}"
        files.append(write_markdown(folder / "claims-sensitivity.md", claims_page(title, frame)))
    return files


def compare_claims(results: Mapping[str, Results], folder: Path) -> list[Path]:
    """Write `comparison.md` and `comparison.csv`: the claims in several results, at every point of their sweeps."""
    named = {
        f"{name}: {evidence.label}" if evidence.label else name: evidence
        for name, each in results.items()
        for evidence in points(each)
    }
    frame = judged(named)
    folder.mkdir(parents=True, exist_ok=True)
    cells(frame).to_csv(folder / "comparison.csv", index=False)
    page = claims_page(f"Claims compared: {', '.join(results)}", frame)
    return [write_markdown(folder / "comparison.md", page), folder / "comparison.csv"]


def verdicts(results: Results) -> dict[str, str]:
    """Claim -> verdict, where nothing is swept and the study names a figure."""
    evidences = points(results) if not results.axes else []
    return {row["claim"]: row["verdict"] for row in judged(_named(evidences)).to_dict("records")}


def claims_page(title: str, frame: pd.DataFrame) -> list[str]:
    """Markdown lines: the verdicts in one table, the numbers in another; those that miss their threshold are bold."""
    if frame.empty:
        return [f"# {title}", "", "No results here name a figure of the paper (`claims: fig6` or `fig7`).", ""]
    heads = list(dict.fromkeys(frame["where"]))
    lines = [f"# {title}", "", *_line("claim", heads), "|" + " --- |" * (len(heads) + 1)]
    by = {(row["where"], row["claim"]): row["verdict"] for row in frame.to_dict("records")}
    for key in dict.fromkeys(frame["claim"]):
        lines += _line(key, [by.get((head, key), NOTHING) for head in heads])
    lines += ["", "Numbers found; those that miss their threshold are bold.", ""]
    lines += [*_line("number found", heads), "|" + " --- |" * (len(heads) + 1)]
    for words, rows in frame.groupby("finding", sort=False):
        here = {}
        for row in rows.to_dict("records"):
            text = Finding("", row["number"], row["unit"]).text
            here[row["where"]] = f"**{text}**" if row["passed"] is False else text
        lines += _line(str(words), [here.get(head, NOTHING) for head in heads])
    return lines


def _line(first: str, others: Sequence[str]) -> list[str]:
    return ["| " + " | ".join(text.replace("|", "\\|") for text in (first, *others)) + " |"]
