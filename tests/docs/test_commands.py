"""Every command block and every Python block of the documentation is run."""

from __future__ import annotations

import os

import pytest
from pages import PAGES, ROOT, blocks, environment, loose_commands, run_block, stand_in

HOW_TO = (
    "change",
    "columns",
    "compare",
    "fragility",
    "isolation",
    "optimise",
    "other-programs",
    "rate",
    "retrofit",
    "screen",
    "seen-neighbour",
    "sensitivity",
    "sweep",
    "twist",
)
"""How-to pages that take long."""

LONG = {"docs/reproduction.md", "docs/page.md", *(f"docs/how-to/{name}.md" for name in HOW_TO)}
ELSEWHERE = {"docs/architecture.md", "docs/from-file-to-scene.md", "docs/extending.md"}
"""Pages whose Python has a test of its own, or is a sketch of types."""


def named(page) -> str:
    return str(page.relative_to(ROOT))


def runnable(page) -> list:
    words = ("sh", "console") if named(page) in ELSEWHERE else ("sh", "console", "python")
    return [block for block in blocks(page) if block.word in words and not block.reason]


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """A reader's folder, own home, none of this machine's settings."""
    stand_in(tmp_path)
    (tmp_path / "home").mkdir()
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    for name, value in environment(tmp_path).items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr("pounding_cli.report.style.USUAL", ("png",))  # one of two is enough to see that it works
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("page", [page for page in PAGES if runnable(page)], ids=named)
def test_blocks_run(page, reader):
    if named(page) in LONG and "POUND_NIGHTLY" not in os.environ:
        pytest.skip("takes longer than five seconds: make reference runs it every night")
    names = {"__name__": "__main__"}
    for block in runnable(page):
        try:
            run_block(block, reader, names)
        except Exception as error:
            raise AssertionError(f"{named(page)}:{block.line}: {error}") from error
        os.chdir(reader)


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_no_command_hides_outside_a_block_that_is_run(page):
    assert loose_commands(page) == []


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_blocks_name_their_language(page):
    assert [block.line for block in blocks(page) if not block.word] == []


def test_few_blocks_are_not_run_and_each_says_why():
    found = [block for page in PAGES for block in blocks(page) if block.word in ("sh", "console")]
    kept = [block for block in found if block.reason]
    assert all(len(block.reason) > 10 for block in kept)
    assert len(kept) < len(found) / 3
