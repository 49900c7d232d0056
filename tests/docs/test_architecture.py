"""docs/architecture.md and from-file-to-scene.md name what the code has, and how often it builds parts of a study."""

from __future__ import annotations

import re
import sys
from collections import Counter
from pathlib import Path

import pytest

import pounding_cli.study
from pounding_cli.study import load_study_file, make_plan

ROOT = Path(__file__).parents[2]
STUDY = Path(pounding_cli.study.__file__).parent
SOURCE = "\n".join(path.read_text(encoding="utf-8") for path in sorted(STUDY.rglob("*.py")))
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
WALK = (ROOT / "docs" / "from-file-to-scene.md").read_text(encoding="utf-8")
SWEEPS = [
    "",
    "sweep: {impact.stiffness: [5 x stiffest storey, 20 x stiffest storey, 100 x stiffest storey]}",
    "sweep: {buildings.soft.period: [0.5 s, 0.6 s, 0.7 s]}",
]
"""Of every column of the table."""


def read_section(heading: str) -> str:
    """Return what stands below a heading of the page, up to the next one."""
    return re.split(rf"^#+ {heading}$", WALK, flags=re.MULTILINE)[1].split("\n#")[0]


def trace_calls(path: Path) -> list[str]:
    """Return the functions of `study/` that are called while a study is loaded, planned and a scene of it is built."""
    called = []

    def note(frame, event, _):
        if event == "call" and frame.f_code.co_filename.startswith(str(STUDY)):
            called.append(frame.f_code.co_qualname)

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        make_plan(load_study_file(path)).scene(0)
    finally:
        sys.setprofile(before)
    return called


@pytest.fixture(params=range(len(SWEEPS)))
def traced(request, tmp_path) -> tuple[int, list[str]]:
    """A column of the table, and the calls of its study."""
    path = tmp_path / "study.yaml"
    text = (ROOT / "configs" / "fig6.yaml").read_text(encoding="utf-8")
    path.write_text(f"{text}\n{SWEEPS[request.param]}\n", encoding="utf-8")
    return request.param, trace_calls(path)


def test_the_table_has_the_numbers_of_calls(traced):
    """Fails if a part is built again at points of the sweep that do not change it."""
    column, called = traced
    rows = re.findall(r"^\| [^|]+ \| (`[^|]+`) \| (\d+) \| (\d+) \| (\d+) \|$", read_section("The calls"), re.MULTILINE)
    page = {name: int(counts[column]) for names, *counts in rows for name in re.findall(r"`(\w+)`", names)}
    assert len(page) > 10
    counted = Counter(called)
    assert {name: counted[name] for name in page} == page


def test_the_walk_has_the_calls_in_their_order(traced):
    """All but those of Python data, and of whichever part an axis changes first."""
    _, called = traced
    called = [name.split(".")[-1] for name in called]
    section = read_section("The calls").split("\n\n|")[0]
    names = dict.fromkeys(re.findall(r"`(\w+)`", section))
    functions = [name for name in names if re.search(rf"(?<!property\n    )\bdef {name}\(", SOURCE)]
    walk = [name for name in functions if name not in ("group", "tree_of", "sweep_part")]  # the first is a section here
    assert len(walk) > 20
    assert set(walk) <= set(called)
    assert sorted(walk, key=called.index) == walk


def test_functions_and_files_of_the_page_exist():
    words = set(re.findall(r"\w+", SOURCE))
    rooms = PAGE.split("### `study/`")[1].split("\n### ")[0]
    section = rooms + WALK
    named = re.findall(r"`(?:\w+\.)?(_?[a-z]+_\w+)(?:\([^`]*\))?`", section)
    assert len(named) > 30
    assert set(named) <= words | {path.stem for path in STUDY.parent.rglob("*.py")}
    files = re.findall(r"`(\w+\.py)`", section)
    assert {file for file in files if file != "points.py"} <= {path.name for path in STUDY.rglob("*.py")}
    table = rooms
    for room, row in re.findall(r"^\| `(\w+)/` \| (.+) \|$", table, re.MULTILINE):
        here = {path.name for path in (STUDY / room).glob("*.py")} - {"__init__.py"}
        listed = set(re.findall(r"`(\w+\.py)`", row.replace("`schema/quantity.py`", "")))
        assert listed == here
    listed = set(re.findall(r"`(\w+\.py)`", table))
    assert listed == {path.name for path in STUDY.rglob("*.py")} - {"__init__.py"}
