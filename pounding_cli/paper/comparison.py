"""Several results files on one page: the tables of their answers under each other, and their claims."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from pounding_cli.numbers import NOTHING
from pounding_cli.paper.verdicts import format_finding, format_verdict, judge_claims
from pounding_cli.report.document import Report
from pounding_cli.tables import Row, Table
from pounding_cli.texts import escape_formulas, write_markdown

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables


def write_comparison(results: Mapping[str, ResultTables], reports: Sequence[Report], folder: Path) -> list[Path]:
    """Write `comparison.md`, and `comparison.csv` where some study names a figure of the paper; return the files.

    Parameters
    ----------
    results : by the name that each has on the page
    reports : of these, in their order
    folder : made where it is not there
    """
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f"# Compared: {', '.join(results)}", ""]
    answers = {name: report.answer.sentences for name, report in zip(results, reports, strict=True)}
    for name, each in results.items():
        lines.append(f"- {name}: {each.title}, `pound {each.workflow}`")
        lines += [f"    - {sentence}" for sentence in answers[name]]
    for question in dict.fromkeys(each.workflow for each in results.values()):
        tables_by_file = {
            name: report.answer.tables
            for (name, each), report in zip(results.items(), reports, strict=True)
            if each.workflow == question
        }
        for tables in zip_longest(*tables_by_file.values()):
            lines += _compare_tables(dict(zip(tables_by_file, tables, strict=True)))
    claims = _collect_claims(results)
    files = [folder / "comparison.md"]
    if len(claims):
        lines += _compare_claims(claims)
        files.append(folder / "comparison.csv")
        escape_formulas(claims).to_csv(files[-1], index=False)
    write_markdown(files[0], lines)
    return files


def _compare_tables(tables: Mapping[str, Table | None]) -> Iterator[str]:
    """Yield the rows of one table of every file that has it as lines of Markdown, the name of the file first."""
    rows: list[dict[str, str]] = []
    for name, table in tables.items():
        if table is None:
            continue
        heads = _number_alike(table.heads())
        rows += [{"file": name, **dict(zip(heads, cells, strict=True))} for cells in table.cells()]
    if not rows:
        return
    captions = dict.fromkeys(table.caption for table in tables.values() if table is not None)
    yield from ("", f"## {'; '.join(filter(None, captions)) or 'Answers'}", "")
    heads = list(dict.fromkeys(head for row in rows for head in row))
    yield from format_markdown_table(heads, [[row.get(head, NOTHING) for head in heads] for row in rows])


def _number_alike(heads: Iterable[str]) -> list[str]:
    """Return headings with a number behind those that stand there already."""
    numbered: list[str] = []
    counts: dict[str, int] = {}
    for head in heads:
        counts[head] = counts.get(head, 0) + 1
        numbered.append(f"{head} ({counts[head]})" if counts[head] > 1 else head)
    return numbered


def _collect_claims(results: Mapping[str, ResultTables]) -> pd.DataFrame:
    """Return the numbers of the paper's claims at every point of every file; empty where no study names a figure."""
    frames = []
    for name, each in results.items():
        if each.workflow == "run":
            numbers = judge_claims(each)
            frames.append(numbers.assign(where=f"{name}: " + numbers["where"] if each.axes else name))
    return pd.concat(frames) if frames else pd.DataFrame()


def _compare_claims(claims: pd.DataFrame) -> Iterator[str]:
    """Yield the verdicts on the claims and their numbers, those that miss their threshold in bold."""
    yield from ("", "## The paper’s claims", "")
    yield from _compare_side_by_side(claims, "claim", "claim", format_verdict)
    yield from ("", "Numbers found; those that miss their threshold are bold.", "")
    yield from _compare_side_by_side(claims, "finding", "number found", _emphasize_missed)


def _emphasize_missed(row: Row) -> str:
    """Return the number of a row, bold where it misses its threshold."""
    text = format_finding(row)
    is_missed: bool = not pd.isna(row["passed"]) and not row["passed"]
    return f"**{text}**" if is_missed else text


def _compare_side_by_side(
    claims: pd.DataFrame, down: str, heading: str, format_cell: Callable[[Row], str]
) -> list[str]:
    """Return a table in Markdown with a row a value of a column and a column a place, in the order of the frame."""
    places = list(dict.fromkeys(claims["where"]))
    cells: dict[str, dict[str, str]] = {}
    for row in claims.to_dict("records"):
        cells.setdefault(row[down], {}).setdefault(row["where"], format_cell(row))
    rows = [[name, *(by_place.get(place, NOTHING) for place in places)] for name, by_place in cells.items()]
    return format_markdown_table([heading, *places], rows)


def format_markdown_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a table of texts as lines of Markdown; lines of a cell by `<br>`."""
    every = [heads, ["---"] * len(heads), *rows]
    texts = [[cell.replace("|", "\\|").replace("\n", "<br>") for cell in row] for row in every]
    return [f"| {' | '.join(row)} |" for row in texts]
