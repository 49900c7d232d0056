"""Every table of a results file as CSV, and tables in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from pounding_cli.report.evidence import TABLES, Tables
from pounding_cli.texts import cells


def write_csv(results: Tables, folder: Path, names: Sequence[str] = TABLES) -> list[Path]:
    """Write tables, those of the workflow and of all tables the buildings, as `<table>.csv`; numbers with all their
    digits (SI)."""
    folder.mkdir(parents=True, exist_ok=True)
    frames = {name: getattr(results, name)() for name in names}
    if names is TABLES:
        frames |= {"buildings": results.buildings}
        frames |= {} if (struck := results.struck()).empty else {"struck": struck}
    frames |= {name: results.answer(name).frame for name in results.answers}
    files = []
    for name, frame in frames.items():
        path = folder / f"{name}.csv"
        cells(frame).to_csv(path, index=False)
        files.append(path)
    return files


def markdown(header: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """A Markdown table, as lines with an empty one after it."""
    lines = [_line(header), "|" + " --- |" * len(header)]
    return [*lines, *(_line(row) for row in rows), ""]


def _line(cells: Sequence[object]) -> str:
    return "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", "<br>") for cell in cells) + " |"
