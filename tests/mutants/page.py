"""docs/guards.md: which test guards what, by source file; the tables are written between two marks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import groupby
from pathlib import Path

from .markers import SOURCE, Place, markers
from .runner import ROOT, Mutant

PAGE = ROOT / "docs" / "guards.md"
BEGIN, END = "<!-- mutants: begin (python -m tests.mutants --write) -->", "<!-- mutants: end -->"


def tables(mutants: Iterable[Mutant], places: Mapping[str, Place]) -> str:
    """Markdown: for each source file its markers, what is wrong, and the test that sees it."""

    def file_of(mutant: Mutant) -> str:
        return places[mutant.marker].file

    parts = []
    for file, found in groupby(sorted(mutants, key=file_of), file_of):
        parts.append(f"### `{file.removeprefix(SOURCE + '/')}`\n\n| marker | fault | seen by |\n|---|---|---|")
        for mutant in found:
            path, _, test = mutant.test.removeprefix("tests/").partition("::")
            words = test.replace("_", " ").removeprefix("test ")
            parts[-1] += f"\n| `{mutant.marker}` | {mutant.fault} | `{path}` {words} |"
    return "\n\n".join(parts)


def write(mutants: Iterable[Mutant], places: Mapping[str, Place] | None = None, page: Path = PAGE) -> None:
    """Replace what stands between the marks.

    Raises
    ------
    ValueError : a mark is missing
    """
    text = page.read_text(encoding="utf-8")
    before, mark, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not mark or not end:
        raise ValueError(f"{page} lacks the marks {BEGIN} and {END}")
    shown = tables(mutants, dict(markers(ROOT)) if places is None else places)
    page.write_text(f"{before}{BEGIN}\n{shown}\n{END}{after}", encoding="utf-8")
