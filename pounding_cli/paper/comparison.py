"""Several results files on one page: the tables of their answers under each other, and their claims."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from pounding_cli.paper.claims import claim_texts, format_verdicts, judged
from pounding_cli.report.document import Report
from pounding_cli.report.table import NOTHING, shown
from pounding_cli.results.tables import Table
from pounding_cli.texts import escape_formulas, write_markdown

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables


def write_comparison(results: Mapping[str, ResultTables], reports: Sequence[Report], folder: Path) -> list[Path]:
    """Write `comparison.md`, and `comparison.csv` where some study names a figure of the paper; returns the files.

    Parameters
    ----------
    results : by the name that each has on the page
    reports : of these, in their order
    folder : made where it is not there
    """
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f"# Compared: {', '.join(results)}", ""]
    for name, each in results.items():
        lines.append(f"- {name}: {each.title}, `pound {each.workflow}`")
    for workflow in dict.fromkeys(each.workflow for each in results.values()):
        answers = {
            name: report.answer.tables
            for (name, each), report in zip(results.items(), reports, strict=True)
            if each.workflow == workflow
        }
        for tables in zip_longest(*answers.values()):
            lines += _compared_tables(dict(zip(answers, tables, strict=True)))
    claims = _claims(results)
    files = [folder / "comparison.md"]
    if len(claims):
        lines += _compared_claims(claims)
        files.append(folder / "comparison.csv")
        escape_formulas(claims).to_csv(files[-1], index=False)
    write_markdown(files[0], lines)
    return files


def _compared_tables(tables: Mapping[str, Table | None]) -> Iterator[str]:
    """Yield the rows of one table of every file that has it as lines of Markdown, the name of the file first."""
    frames = []
    for name, table in tables.items():
        if table is not None and len(table.frame):
            frame = shown(table)
            frame.columns = _distinct(frame.columns)
            frame.insert(0, "file", name)
            frames.append(frame)
    if frames:
        captions = dict.fromkeys(table.caption for table in tables.values() if table is not None)
        yield from ("", f"## {'; '.join(filter(None, captions)) or 'Answers'}", "")
        yield from markdown_table(pd.concat(frames).fillna(NOTHING))


def _distinct(heads: Iterable[str]) -> list[str]:
    """Return headings with a number behind those that stand there already."""
    found = list[str]()
    for head in heads:
        count = sum(other == head or other.startswith(f"{head} (") for other in found)
        found.append(f"{head} ({count + 1})" if head in found else head)
    return found


def _claims(results: Mapping[str, ResultTables]) -> pd.DataFrame:
    """Return the numbers of the paper's claims at every point of every file; empty where no study names a figure."""
    frames = {name: judged(each) for name, each in results.items() if each.workflow == "run"}
    named = [
        frame.assign(where=f"{name}: " + frame["where"] if results[name].axes else name)
        for name, frame in frames.items()
    ]
    return pd.concat(named) if named else pd.DataFrame()


def _compared_claims(claims: pd.DataFrame) -> Iterator[str]:
    """Yield the verdicts on the claims and their numbers, those that miss their threshold in bold."""
    numbers = claim_texts(claims)
    bold = [f"**{text}**" if met is False else text for text, met in zip(numbers, claims["passed"], strict=True)]
    yield from ("", "## The paper’s claims", "")
    yield from markdown_table(_side_by_side(claims, "claim", "claim", format_verdicts(claims)))
    yield from ("", "Numbers found; those that miss their threshold are bold.", "")
    yield from markdown_table(_side_by_side(claims, "finding", "number found", bold))


def _side_by_side(frame: pd.DataFrame, down: str, head: str, values: list[str]) -> pd.DataFrame:
    """Return values by a column and by where they stand, in the order of the frame."""
    wide = frame.assign(shown=values).pivot_table("shown", down, "where", "first", sort=False).fillna(NOTHING)
    return wide.reset_index().rename(columns={down: head})


def markdown_table(frame: pd.DataFrame) -> list[str]:
    """Return a table of texts as lines of Markdown; lines of a cell by `<br>`."""
    rows = [list(map(str, frame.columns)), ["---"] * frame.shape[1], *frame.astype(str).to_numpy().tolist()]
    texts = [[cell.replace("|", "\\|").replace("\n", "<br>") for cell in row] for row in rows]
    return [f"| {' | '.join(row)} |" for row in texts]
