"""Study files written for one test: `study` loads a text, `refused` checks what is said of a wrong one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from pounding_cli.errors import InputError, Problem
from pounding_cli.study import Study, load_study

BASE = """\
title: Test
records:
  use: [elcentro, taft]
  duration: 5 s
  scale: 1.0
buildings:
  stiff: {storeys: 3, period: 0.36 s, mass: 200 t}
  soft: {like: stiff, period: 0.60 s}
group: [stiff, soft]
impact: {stiffness: 20 x stiffest storey, restitution: 0.5}
cases:
  gap: {link: pounding, gap: 5 cm}
analyses: [elastic]
"""


@pytest.fixture
def study(tmp_path: Path) -> Callable[..., Study]:
    """Loads BASE, or another text, with replacements `(old, new)` made in it."""

    def load(*changes: tuple[str, str], text: str = BASE) -> Study:
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new, 1)
        path = tmp_path / "study.yaml"
        path.write_text(text, encoding="utf-8")
        return load_study(path)

    return load


@pytest.fixture
def refused(study: Callable[..., Study]) -> Callable[..., list[Problem]]:
    """Loads a text that is refused; where it holds the mark §, one problem must stand right there.

    `message` and `hint` must both be in that problem.  Returns all problems.
    """

    def check(
        *changes: tuple[str, str], message: str = "", hint: str = "", alone: bool = True, text: str = BASE
    ) -> list[Problem]:
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new, 1)
        before = text.split("§")[0]
        line, column = before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1
        with pytest.raises(InputError) as caught:
            study(text=text.replace("§", ""))
        problems = list(caught.value.problems)
        if "§" in text:
            there = [p for p in problems if (p.line, p.column) == (line, column)]
            assert there, f"nothing at {line}:{column}:\n{caught.value}"
            assert any(message in p.message and hint in p.hint for p in there), str(caught.value)
            assert all(p.file.endswith("study.yaml") for p in there)
            assert not alone or len(problems) == 1, str(caught.value)
        return problems

    return check
