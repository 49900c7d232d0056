"""What limits the numbers of a study: warnings about its input, and unknown values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pounding_cli.errors import Problem
from pounding_cli.report.evidence import Tables
from pounding_cli.report.web.story import Grid
from pounding_cli.store.bracket import Spread, advice, depends, spreads


@dataclass(frozen=True)
class Bracket:
    """How far results depend on one bracketed key: the table, what it is over, and the conclusion."""

    key: str
    middle: str
    grid: Grid
    conclusion: Sequence[str]


@dataclass(frozen=True)
class Limits:
    """Warnings about the study, brackets, and what is said where the impact stiffness has none; "" for nothing."""

    warnings: Sequence[Problem]
    brackets: Sequence[Bracket]
    advice: str

    def __bool__(self) -> bool:
        return bool(self.warnings or self.brackets or self.advice)


def limits(results: Tables) -> Limits:
    """Read from a results file; tables made by hand have no limits that are known."""
    path: Path | None = getattr(results, "path", None)
    if path is None:
        return Limits((), (), "")
    found = spreads(path)
    keys = dict.fromkeys(spread.key for spread in found)
    brackets = [_bracket([spread for spread in found if spread.key == key]) for key in keys]
    return Limits(getattr(results, "warnings", ()), brackets, advice(path))


def _bracket(mine: Sequence[Spread]) -> Bracket:
    first, last = mine[0].ends
    rows = [[spread.quantity, str(spread.ends[0]), str(spread.ends[1])] for spread in mine]
    grid = Grid(("result", f"at {first.value}", f"at {last.value}"), rows, (1, 2))
    return Bracket(mine[0].key, mine[0].middle, grid, depends(mine))
