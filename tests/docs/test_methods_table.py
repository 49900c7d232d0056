"""docs/accuracy.md: its table of methods and their sources are what the methods state about themselves."""

from __future__ import annotations

from pathlib import Path

import pytest

from pounding_cli import methods

PAGE = Path("docs/accuracy.md")


@pytest.mark.parametrize(("mark", "lines"), [("methods", methods.table), ("sources", methods.citations)])
def test_the_page_shows_what_the_methods_state(mark, lines):
    """`python -m pounding_cli.methods` prints both."""
    inside = PAGE.read_text(encoding="utf-8").partition(f"<!-- {mark}: begin")[2].partition(f"<!-- {mark}: end")[0]
    assert [line for line in inside.splitlines() if line.startswith(("|", "- "))] == lines()
