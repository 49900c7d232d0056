"""Which test guards what, by source file: tables that the site shows below docs/guards.md."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import groupby

from .markers import SOURCE, Place
from .runner import Mutant


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
