"""`tools/reading.py` on a tiny package whose faults are known."""

from __future__ import annotations

import pytest

from tools import reading

WIDE = "total = " + " + ".join(["number"] * 11)
"""104 characters of code."""

STUDY = f'''\
"""What a study says."""

MAX_POINTS = 3
"""Whether this is counted: no, it stands below a constant."""


class Found:
    """Of all answers, this one."""

    def told(self, number: int) -> int:
        """Return a number."""
        first, second = number, 2  # two things at once
        first, second = second, first
        {WIDE}  # a comment behind a wide line
        text = """one # no comment
{"x" * 101}"""
        return total + first + second + len(text)


def feed() -> None:
    """Whether it is hungry."""
'''
MODEL = '"""A building."""\n\n\nclass Building:\n    pass\n\n\nMAX_POINTS: int = 4\n_local, found = 1, 2\n# a comment\n'
ROOT = "from .study import MAX_POINTS\n\n\nasync def _named():\n    # nothing\n    return MAX_POINTS\n"


@pytest.fixture
def package(tmp_path):
    files = {"study/study.py": STUDY, "study/empty.py": "", "model/building.py": MODEL, "__init__.py": ROOT}
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return tmp_path


def test_faults_are_counted_by_room(package):
    rooms = reading.measure_package(package).rooms
    assert list(rooms) == ["(root)", "model", "study"]
    assert rooms["study"] == reading.Counts(
        files=2, lines=21, code_lines=10, characters=409, wide_lines=2, tuple_assignments=1,
        docstrings=4, openings=3, bare_names=2,
    )  # fmt: skip
    assert rooms["model"] == reading.Counts(
        files=1, lines=10, code_lines=4, characters=58, tuple_assignments=1, docstrings=1
    )
    assert rooms["(root)"] == reading.Counts(files=1, lines=6, code_lines=3, characters=65, bare_names=1)


def test_names_are_listed_with_their_places(package, capsys):
    assert reading.main([str(package), "--names"]) == 0
    said = capsys.readouterr().out
    for line in ("_named: __init__.py:4", "Found: study/study.py:7", "told: study/study.py:10"):
        assert f"\n  {line}\n" in said
    assert "\n  MAX_POINTS\n    model/building.py\n    study/study.py\n" in said
    assert "Building" not in said
    assert "feed" not in said
    assert max(map(len, said.splitlines())) <= 80


def test_the_table_has_rates(package, capsys):
    reading.main([str(package)])
    said = capsys.readouterr().out
    (study,) = [line.split() for line in said.splitlines() if line.startswith("study")]
    assert study == ["study", "2", "21", "40.9", "20.0", "100.0", "4", "3", "2"]
    assert "more than one module: 1" in said


def test_a_folder_that_is_not_there(tmp_path, capsys):
    assert reading.main([str(tmp_path / "packge")]) == 2
    assert "there is no folder" in capsys.readouterr().err
