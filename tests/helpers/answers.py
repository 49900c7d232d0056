"""What tests of the answers share: a run that is stopped twice and resumed, and a question that is refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from pounding_cli.batch import Outcome
from pounding_cli.errors import InputError
from pounding_cli.store import Results
from pounding_cli.study import load_study

Solved = Callable[..., tuple[Outcome, Results]]
"""solved(folder, solve=...) runs the study there."""


def the_same_when_stopped(
    folder: Path,
    solved: Solved,
    known: Callable,
    tables: Callable[[Results], Sequence[pd.DataFrame]],
    at: Sequence[int],
) -> tuple[Outcome, Outcome, Outcome]:
    """Stops a run by Ctrl-C at some scenes, resumes it, and compares its tables and checksums with those of a run at
    once; the outcomes of the run at once, of the last part, and of one run more, which has nothing to do.

    at : which scenes, counted over all parts
    """
    for name in ("once", "twice"):
        (folder / name).mkdir()
    first, once = solved(folder / "once")
    count = 0

    def stops(scene, **more):
        nonlocal count
        count += 1
        if count in at:
            raise KeyboardInterrupt
        return known(scene)

    for _ in at:
        with pytest.raises(KeyboardInterrupt):
            solved(folder / "twice", solve=stops)
    last, twice = solved(folder / "twice", solve=stops)
    assert last.reused > 0
    for one, other in zip(tables(once), tables(twice), strict=True):
        assert one.equals(other)
    assert once.attrs["content"] == twice.attrs["content"]
    again, _ = solved(folder / "twice", solve=stops)
    assert (again.done, again.reused) == (0, last.done + last.reused)
    return first, last, again


def is_refused(path: Path, expand: Callable[[Any], Any], line: int, column: int, said: str, hint: str) -> None:
    """The one problem of a question, at its place, with what to write instead."""
    with pytest.raises(InputError) as error:
        expand(load_study(path))
    (problem,) = error.value.problems
    assert said in problem.message
    assert hint in problem.hint
    assert (problem.line, problem.column) == (line, column)
    assert problem.file.endswith(path.name)
