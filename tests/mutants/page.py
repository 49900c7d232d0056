"""The table of faults in docs/verification.md, written between two marks."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from .runner import ROOT, Mutant

PAGE = ROOT / "docs" / "verification.md"
BEGIN, END = "<!-- mutants: begin (python -m tests.mutants --write) -->", "<!-- mutants: end -->"


def table(mutants: Iterable[Mutant]) -> str:
    """Markdown rows: what is wrong, where, and the test that sees it."""
    rows = ["| fault | in | seen by |", "|---|---|---|"]
    for mutant in mutants:
        file = mutant.file.removeprefix("pounding_cli/")
        path, _, test = mutant.test.removeprefix("tests/").partition("::")
        rows.append(f"| {mutant.fault} | `{file}` | `{path}` {test.replace('_', ' ').removeprefix('test ')} |")
    return "\n".join(rows)


def write(mutants: Iterable[Mutant], page: Path = PAGE) -> None:
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
    page.write_text(f"{before}{BEGIN}\n{table(mutants)}\n{END}{after}", encoding="utf-8")
