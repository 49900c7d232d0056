"""The claims at every point of a sweep, or in several results files, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pandas as pd

from pounding_cli.report.claims import judge
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.tables import markdown
from pounding_cli.report.verdicts import Judgement

WIDEST = 6
"""Points or files beyond which they become the rows of the tables."""

Column = tuple[str, list[Judgement]]
"""What one column of the tables is about, and the judgements there."""


def judge_points(evidences: Sequence[Evidence]) -> list[Column]:
    """The judgements at every point of the sweep, headed by the point."""
    return [(evidence.label or "as given", judge(evidence)) for evidence in evidences]


def frame(columns: Sequence[Column], name: str = "where") -> pd.DataFrame:
    """One row a finding: where, claim, verdict, finding, number, unit, passed."""
    return pd.DataFrame(
        [
            {
                name: where,
                "claim": judgement.claim.key,
                "verdict": str(judgement.verdict),
                "finding": finding.words,
                "number": finding.number,
                "unit": finding.unit,
                "passed": "" if finding.passed is None else finding.passed,
            }
            for where, judgements in columns
            for judgement in judgements
            for finding in judgement.findings
        ],
        columns=[name, "claim", "verdict", "finding", "number", "unit", "passed"],
    )


def page(title: str, columns: Sequence[Column]) -> list[str]:
    """Markdown lines: the verdicts in one table, then the numbers of every claim."""
    keys = list(dict.fromkeys(judgement.claim.key for _, judgements in columns for judgement in judgements))
    by_key = [{judgement.claim.key: judgement for judgement in judgements} for _, judgements in columns]
    heads = [where for where, _ in columns]
    lines = [f"# {title}", ""]
    if not keys:
        return [*lines, "No results here name a figure of the paper (`claims: fig6` or `fig7`).", ""]
    verdicts = [[f"[{key}](#{key})", *(_verdict(column.get(key)) for column in by_key)] for key in keys]
    lines += ["## Verdicts", "", *_table("claim", heads, verdicts), *_changes(keys, heads, by_key)]
    for key in keys:
        judged = [column.get(key) for column in by_key]
        claim = next(judgement.claim for judgement in judged if judgement)
        lines += [f"## {key}", "", f"> {claim.paper}", "", claim.rule, ""]
        lines += ["Numbers found; those that miss their threshold are bold.", ""]
        rows = [[words, *cells] for words, cells in _numbers(judged).items()]
        if len(heads) > WIDEST:  # sentences at the head of a column would be as unwieldy as many columns
            lines += [*(f"{number}. {row[0]}" for number, row in enumerate(rows, start=1)), ""]
            rows = [[f"({number})", *row[1:]] for number, row in enumerate(rows, start=1)]
        verdict = ["verdict", *(_verdict(judgement) for judgement in judged)]
        lines += _table("number found", heads, [verdict, *rows])
    return lines


def _changes(keys: Sequence[str], heads: Sequence[str], by_key: Sequence[Mapping[str, Judgement]]) -> list[str]:
    """Which verdicts are not the same everywhere: the most frequent one, and where it is another."""
    lines = []
    for key in keys:
        verdicts = {head: _verdict(column[key]) for head, column in zip(heads, by_key, strict=True) if key in column}
        most = max(verdicts.values(), key=list(verdicts.values()).count)
        others = [f"*{verdict}* at {head}" for head, verdict in verdicts.items() if verdict != most]
        if others:
            lines.append(f"- {key}: *{most}*, but {'; '.join(others)}")
    if not lines:
        return ["Every verdict is the same everywhere.", ""]
    return ["Verdicts that change; every other is the same everywhere:", "", *lines, ""]


def _table(corner: str, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A table with `heads` at its columns, turned on its side where they are many."""
    if len(heads) <= WIDEST:
        return markdown([corner, *heads], rows)
    return markdown(["", *(row[0] for row in rows)], zip(heads, *(row[1:] for row in rows), strict=True))


def _verdict(judgement: Judgement | None) -> str:
    return str(judgement.verdict) if judgement else "–"


def _numbers(judged: Sequence[Judgement | None]) -> Mapping[str, list[str]]:
    """The numbers of one claim by finding, one cell a column; those that miss their threshold are bold."""
    words = dict.fromkeys(finding.words for judgement in judged if judgement for finding in judgement.findings)
    rows: dict[str, list[str]] = {text: [] for text in words}
    for judgement in judged:
        here = {finding.words: finding for finding in judgement.findings} if judgement else {}
        for text, cells in rows.items():
            finding = here.get(text)
            number = finding.text if finding else "–"
            cells.append(f"**{number}**" if finding and finding.passed is False else number)
    return rows
