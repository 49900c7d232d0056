"""The report's page, `summary.md`: motions, key numbers, claims, figures, and everything that was flagged."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import pandas as pd

from pounding_cli.numbers import Unit, counted
from pounding_cli.report.answer_page import AnswerPage
from pounding_cli.report.evidence import Evidence, motion_sentence, names
from pounding_cli.report.tables import markdown
from pounding_cli.report.verdicts import Judgement
from pounding_cli.store import flag_groups_of
from pounding_cli.store.flagged import failed_scenes


def summary(
    evidence: Evidence,
    judgements: Sequence[Judgement],
    figures: Sequence[str],
    scene: pd.DataFrame,
    swept: bool,
    scaled: str = "",
    own: AnswerPage | None = None,
) -> list[str]:
    """Markdown lines of the page.

    evidence : the point of the sweep that is drawn
    figures : file names of the PNG figures, as they stand beside the page
    scene : the scenes of all points
    scaled : how the motions meet their target spectrum, in words; "" where there is none
    own : what the workflow says in place of the key numbers
    """
    lines = [f"# {evidence.title}", ""]
    if swept:
        everywhere = "; the claims at every point stand in [claims-sensitivity.md](claims-sensitivity.md)"
        lines += [
            f"Figures and numbers on this page are those at {evidence.label}{everywhere if judgements else ''}.",
            "",
        ]
    cases = scene["case"].nunique()
    if len(evidence.cases) < cases:
        lines += [f"Figures and numbers on this page are those of {len(evidence.cases)} of the {cases} cases.", ""]
    if own is not None:
        lines += own.markdown(figures)
        figures = ()
    lines += motions(evidence)
    if scaled:
        lines += [scaled, ""]
    if own is None:
        lines += key_numbers(evidence)
    lines += claims(judgements)
    lines += flagged(scene, evidence.units)
    if figures:
        lines += ["## Figures", ""]
        for figure in figures:
            lines += [f"![{figure.removesuffix('.png')}]({figure})", ""]
    lines += ["## Tables", "", "Every table as CSV, in SI units, stands in [tables/](tables/).", ""]
    return lines


def motions(evidence: Evidence) -> list[str]:
    """The motions used, real or stand-in, with what they measure as used."""
    unit = evidence.unit("acceleration")
    rows = [
        [
            row["record"],
            row["source"],
            *(_number(value) for value in (row["scale"], row["window"], unit.number(row["pga"]), row["arias"])),
        ]
        for _, row in evidence.records.iterrows()
    ]
    head = ["motion", "source", "scale", "duration [s]", f"peak as used [{unit.name}]", "Arias intensity as used [m/s]"]
    return ["## Motions", "", motion_sentence(evidence.records), "", *markdown(head, rows)]


def _number(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.4g}"


def key_numbers(evidence: Evidence) -> list[str]:
    """Per building and case: the largest mean ratios with their storey; per case the links' forces."""
    lines = [
        "## Key numbers",
        "",
        "Means over the motions of the ratios to the building alone; in brackets the storey or floor of the "
        "largest. Link forces are the largest over the floors, mean over the motions.",
        "",
    ]
    for building in evidence.group:
        header = ["case"]
        for analysis in evidence.analyses:
            header += [f"V/V0, {analysis}", f"μ/μ0, {analysis}", f"acceleration, {analysis}"]
        rows = []
        for case in evidence.cases:
            cells = [evidence.marked(case)]
            for analysis in evidence.analyses:
                for ratio in ("V_ratio", "mu_ratio", "acceleration_ratio"):
                    cells.append(_largest(evidence.means(case, analysis, building, ratio)))
            rows.append(cells)
        lines += [f"### {building} (T = {evidence.periods[building]:.2f} s)", "", *markdown(header, rows)]
    if evidence.link["peak_force"].notna().any():
        lines += ["### Links", "", *_links(evidence)]
    if evidence.footnote:
        lines += [evidence.footnote, ""]
    return lines


def _largest(means: pd.Series) -> str:
    return f"{means.max():.2f} ({means.idxmax()})" if len(means) else "–"


def _links(evidence: Evidence) -> list[str]:
    rows = []
    for case in names(evidence.link["case"]):
        cells = [evidence.marked(case)]
        for analysis in evidence.analyses:
            here = evidence.link[(evidence.link["case"] == case) & (evidence.link["analysis"] == analysis)]
            by_motion = here.groupby("record").agg({"peak_force": "max", "impacts": "sum", "max_closing": "max"})
            mean = by_motion.mean()
            cells += [
                f"{mean['peak_force'] / 1e6:.2f}",
                f"{mean['impacts']:.0f}",
                f"{100 * mean['max_closing']:.1f}",
            ]
        rows.append(cells)
    header = ["case"]
    for analysis in evidence.analyses:
        header += [f"force [MN], {analysis}", f"contacts, {analysis}", f"largest closing [cm], {analysis}"]
    return markdown(header, rows)


def claims(judgements: Sequence[Judgement]) -> list[str]:
    """The claims table: the paper's words, the verdict, the numbers and the threshold; nothing without claims."""
    if not judgements:
        return []
    lines = [
        "## The paper's claims",
        "",
        "A claim *holds* where every number meets its threshold, *holds partly* where some do, *does not "
        "hold* where none does; numbers that miss theirs are bold, those after “beside” carry no threshold.",
        "",
    ]
    rows = [
        [f"“{judgement.claim.paper}”", f"**{judgement.verdict}**", _findings(judgement), judgement.claim.rule]
        for judgement in judgements
    ]
    return [*lines, *markdown(["the paper", "verdict", "found", "how it is judged"], rows)]


def _findings(judgement: Judgement) -> str:
    lines = []
    for finding in judgement.findings:
        number = f"**{finding.text}**" if finding.passed is False else finding.text
        beside = "beside: " if finding.passed is None else ""
        lines.append(f"{beside}{finding.words}: {number}")
    return "\n".join(lines)


def flagged(scene: pd.DataFrame, units: Mapping[str, Unit]) -> list[str]:
    """Failed scenes, and every flag with the runs it stands in."""
    lines = ["## Flagged", ""]
    total = len(scene)
    failed = failed_scenes(scene)
    found = flag_groups_of(scene, units)
    if failed.empty and not found:
        every = f"all {total} runs were done and none raised a flag" if total > 1 else "the run was done without a flag"
        return [*lines, f"Nothing: {every}.", ""]
    if len(failed):
        lines += [f"{len(failed)} of {counted(total, 'run')} failed, left out of every mean.", ""]
        columns = [*scene.columns[: list(scene.columns).index("status")], "status", "advice"]
        lines += markdown(columns, failed[columns].to_numpy().tolist())
    for group in found:
        lines.append(f"- {'**not meaningful**: ' if group.meaningless else ''}{group}")
    return [*lines, ""] if found else lines
