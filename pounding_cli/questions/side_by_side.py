"""Several results files on one page: the tables of their answers, and their statements side by side."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from pounding_cli.numbers import NOTHING
from pounding_cli.questions.statements import FAILS, STATEMENTS, format_value, list_verdicts
from pounding_cli.report.document import Report
from pounding_cli.report.evidence import format_point
from pounding_cli.tables import Row, Table
from pounding_cli.texts import escape_formulas, write_markdown

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables


def write_comparison(results: Mapping[str, ResultTables], reports: Sequence[Report], folder: Path) -> list[Path]:
    """Write `comparison.md`, and `comparison.csv` where some study has statements; return the files.

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
    statements = collect_statements(results)
    files = [folder / "comparison.md"]
    if len(statements):
        lines += compare_statements(statements)
        files.append(folder / "comparison.csv")
        escape_formulas(statements).to_csv(files[-1], index=False)
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


def collect_statements(results: Mapping[str, ResultTables]) -> pd.DataFrame:
    """Return the numbers of the statements of every file, with their places in the column `where`; empty where no study
    has statements."""
    frames = []
    for name, each in results.items():
        if STATEMENTS not in each.answers:
            continue
        frame = each.answer(STATEMENTS).frame
        keys = [key for key in each.axes if key in frame]
        places = [
            format_point(each, {key: row[key] for key in keys if row[key] not in ("", None) and row[key] == row[key]})
            for row in frame.to_dict("records")
        ]
        frame = frame.drop(columns=keys)
        frame.insert(0, "where", [f"{name}: {place}" if place else name for place in places])
        frames.append(frame)
    return pd.concat(frames) if frames else pd.DataFrame()


def compare_statements(statements: pd.DataFrame) -> Iterator[str]:
    """Yield the verdicts on statements and their numbers, those that miss their bound in bold."""
    yield from ("", "## Statements", "")
    verdicts = [
        {"statement": verdict.name, "where": where, "cell": str(verdict)}
        for where, rows in statements.groupby("where", sort=False)
        for verdict in list_verdicts(rows)
    ]
    yield from _compare_side_by_side(pd.DataFrame(verdicts), "statement", "statement")
    yield from ("", "Numbers found; those that miss their bound are bold.", "")
    numbers = statements.assign(cell=[_emphasize_missed(row) for row in statements.to_dict("records")])
    places = numbers[["case", "analysis"]].apply(lambda row: ", ".join(filter(None, row)), axis=1)
    numbers["comparison"] = [
        f"{name}: {text}{f' ({place})' if place else ''}"
        for name, text, place in zip(numbers["statement"], numbers["comparison"], places, strict=True)
    ]
    yield from _compare_side_by_side(numbers, "comparison", "number found")


def _emphasize_missed(row: Row) -> str:
    """Return the number of a row, bold where it misses its bound."""
    text = format_value(row["number"], row["unit"], row["written_unit"])
    return f"**{text}**" if row["outcome"] == FAILS else text


def _compare_side_by_side(frame: pd.DataFrame, down: str, heading: str) -> list[str]:
    """Return the cells of a frame as a table in Markdown with a row a value of a column and a column a place."""
    places = list(dict.fromkeys(frame["where"]))
    cells: dict[str, dict[str, str]] = {}
    for row in frame.to_dict("records"):
        cells.setdefault(row[down], {}).setdefault(row["where"], row["cell"])
    rows = [[name, *(by_place.get(place, NOTHING) for place in places)] for name, by_place in cells.items()]
    return format_markdown_table([heading, *places], rows)


def format_markdown_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a table of texts as lines of Markdown; lines of a cell by `<br>`."""
    every = [heads, ["---"] * len(heads), *rows]
    texts = [[cell.replace("|", "\\|").replace("\n", "<br>") for cell in row] for row in every]
    return [f"| {' | '.join(row)} |" for row in texts]
