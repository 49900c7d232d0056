"""The tables of docs/published.md are what becomes of the statements of its studies, and a study that is broken has
another table."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pandas as pd
import pytest
import yaml
from pages import ROOT, hook

import pounding_cli
from pounding_cli.errors import InputError
from pounding_cli.questions.statements import FAILS, HOLDS, PARTLY, UNKNOWN, list_verdicts

PUBLISHED = hook("published")
SOON = ("eccentric-blow", "sliding-block", "moat-wall")
"""Studies that every run of the tests looks at; `make reference` and `make docs` run the others too."""

BREAKS = yaml.safe_load((Path(__file__).parent / "published_breaks.yaml").read_text(encoding="utf-8"))
"""Study -> texts of its file with others in their place, each of which changes some rows of its table."""


BY_LAW = "continuously active throughout the entire motion"
"""Words of the statement of Figs 6 and 7 that the law of a connector makes true in every study."""


def skip_what_is_not_here(name: str) -> None:
    """Skip a study whose motions are not installed, or that only the nightly tests run."""
    if name not in SOON and "POUND_NIGHTLY" not in os.environ:
        pytest.skip("make reference runs it every night")
    if missing := PUBLISHED.find_missing_sources(name):
        pytest.skip(f"needs a motion of {', '.join(missing)}")


def read_table(name: str) -> str:
    """Return the table of a study on the page."""
    return PUBLISHED.split_page(PUBLISHED.PAGE.read_text(encoding="utf-8"), name)[1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["sliding-blok"], "there is no study sliding-blok; there are "),
        (["sliding-block", "--with", "2 %"], "--with takes OLD=>NEW, one study and no --renew"),
        (["sliding-block", "--with", "2 %=>3 %", "--renew"], "--with takes OLD=>NEW, one study and no --renew"),
    ],
)
def test_a_call_that_is_not_understood_is_told_so(monkeypatch, capsys, arguments, message):
    monkeypatch.setattr("sys.argv", ["published.py", *arguments])
    with pytest.raises(SystemExit):
        PUBLISHED.main()
    assert message in " ".join(capsys.readouterr().err.split())


def test_every_study_has_a_table_on_the_page():
    assert {path.stem for path in PUBLISHED.STUDIES.glob("*.yaml")} <= set(PUBLISHED.NAMES)
    for name in PUBLISHED.NAMES:
        assert read_table(name).startswith(f"{PUBLISHED.HEAD}\n| "), name


def test_the_overview_is_that_of_the_tables():
    """Fails if a row, a heading or a difference changes and the overview does not."""
    text = PUBLISHED.PAGE.read_text(encoding="utf-8")
    assert PUBLISHED.put_overview(text) == text


def test_the_readme_counts_the_kinds():
    """As the overview of the page has them."""
    text = PUBLISHED.PAGE.read_text(encoding="utf-8")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    said = " ".join(re.search(r"\*\*Published results come out\.\*\*(.+?)\n\n", readme, re.DOTALL)[1].split())
    for kind, names in PUBLISHED.find_kinds(text).items():
        rows = [row for name in names for row in PUBLISHED.split_rows(read_table(name))]
        numbers = sum(map(PUBLISHED.is_number, rows))
        counted = re.search(rf"{re.escape(kind[0].lower() + kind[1:])} \((\d+) studies, (\d+) numbers\)", said)
        assert counted is not None, kind
        assert (int(counted[1]), int(counted[2])) == (len(names), numbers), kind


def test_the_hook_has_no_number_of_a_result():
    """Nor a verdict: what the page says of a study comes from its run."""
    text = Path(PUBLISHED.__file__).read_text(encoding="utf-8")
    assert "holds" not in re.sub(r'""".*?"""', "", text, flags=re.DOTALL).replace("HOLDS", "")
    assert not re.findall(r"(?<![\w.])\d+\.\d{2,}", text)


@pytest.mark.parametrize("name", PUBLISHED.NAMES)
def test_its_table_is_that_of_the_page(name, tmp_path):
    """Fails if a number or a verdict of the page is another one than the study gives."""
    skip_what_is_not_here(name)
    assert PUBLISHED.format_rows(PUBLISHED.find_verdicts(PUBLISHED.solve_study(name, tmp_path))) == read_table(name)


def test_every_study_can_be_broken():
    assert set(BREAKS) == set(PUBLISHED.NAMES)


@pytest.mark.parametrize("name", PUBLISHED.NAMES)
def test_a_study_that_is_broken_has_another_table(name, tmp_path):
    """Every row changes under some break: the verdict of one that holds, the number of one that does not."""
    skip_what_is_not_here(name)
    before = PUBLISHED.split_rows(read_table(name))
    unchanged = {number for number, row in enumerate(before) if BY_LAW not in row.what}
    for number, (old, new) in enumerate(BREAKS[name]):
        folder = tmp_path / str(number)
        folder.mkdir()
        results = PUBLISHED.solve_study(name, folder, ((old, new),))
        after = PUBLISHED.split_rows(PUBLISHED.format_rows(PUBLISHED.find_verdicts(results)))
        assert [row.what for row in after] == [row.what for row in before]
        for place, (was, row) in enumerate(zip(before, after, strict=True)):
            if row.verdict != was.verdict if was.verdict.startswith(HOLDS) else row != was:
                unchanged.discard(place)
    assert [before[place].what for place in unchanged] == []


# The rows, from planted statements


def plant(**changes: object) -> pd.DataFrame:
    """Return the row of a number that agrees, changed."""
    row = {
        "statement": "1", "says": "roof", "source": "", "reading": "", "comparison": "u = 32.9 cm", "case": "",
        "analysis": "", "number": 0.3287, "unit": "m", "written_unit": "cm", "bound": "<= 33 cm", "printed": 0.329,
        "margin": 0.001, "error": 1e-9, "sensitivity": 1e-6, "met": 1, "motions": 1, "outcome": HOLDS, "turns": "",
    }  # fmt: skip
    return pd.DataFrame([row | changes])


@pytest.mark.parametrize(
    ("frame", "cells"),
    [
        (plant(), ("roof", "32.9 cm", "32.9 cm", "-0.09 %", "holds")),
        (plant(number=0.35, outcome=FAILS), ("roof", "32.9 cm", "35.0 cm", "+6.38 %", "does not hold")),
        (plant(reading="with 2 %"), ("roof (with 2 %)", "32.9 cm", "32.9 cm", "-0.09 %", "holds")),
        (
            pd.concat([plant(number=0.30, outcome=FAILS), plant(number=0.34, outcome=FAILS)]),
            ("roof", "32.9 cm", "30.0 cm to 34.0 cm", "in the range", "does not hold"),
        ),
        (
            pd.concat([plant(number=0.34, outcome=FAILS), plant(number=0.33)]),
            ("roof", "32.9 cm", "33.0 cm to 34.0 cm", "+0.30 %", "holds partly (1 of 2)"),
        ),
        (
            plant(printed=float("nan"), comparison="displacement < 33 cm", bound="< 33.00 cm"),
            ("roof", "in words", "32.87 cm; to be < 33.00 cm", "", "holds"),
        ),
        (plant(comparison="x = 0.7", printed=0.7, number=0.65, unit="", written_unit="", outcome=FAILS),
         ("roof", "0.7", "0.7", "-7.14 %", "does not hold")),
    ],
)  # fmt: skip
def test_the_cells_of_a_row(frame, cells):
    (row,) = PUBLISHED.split_rows(PUBLISHED.format_rows(list_verdicts(frame)))
    assert tuple(row) == cells


@pytest.mark.parametrize(
    ("differences", "printed", "verdicts", "counts"),
    [
        (["+0.00 %", "-0.10 %", "+0.39 %", "-4.90 %", "+20.00 %"], "1", [HOLDS] * 5, "5 2 1 1 1 – – – –"),
        (["in the range", ""], "1", [FAILS, UNKNOWN], "2 – – – – 1 – – –"),
        (["", "", ""], "in words", [HOLDS, f"{PARTLY} (1 of 2)", FAILS], "– – – – – – 1 1 1"),
    ],
)
def test_the_counts_of_the_overview(differences, printed, verdicts, counts):
    pairs = zip(differences, verdicts, strict=True)
    rows = [PUBLISHED.Cells("x", printed, "1", difference, verdict) for difference, verdict in pairs]
    assert PUBLISHED.count_rows(rows) == counts.split()


def test_a_study_says_where_its_motions_come_from(monkeypatch, tmp_path):
    monkeypatch.setitem(PUBLISHED.PACKAGED, "motion.csv", "no_such_package/motion.csv")
    monkeypatch.setitem(PUBLISHED.CHECKED_OUT, "other.txt", "motions/folder/other.txt")
    study = tmp_path / "needs.yaml"
    study.write_text("records: {use: [{file: motion.csv}, {file: other.txt}, {file: here.txt}, elcentro]}\n")
    (tmp_path / "here.txt").write_text("")
    monkeypatch.setattr(PUBLISHED, "FOLDERS", (tmp_path,))
    monkeypatch.setenv("POUND_CHECKOUTS", str(tmp_path))
    checkout = "a checkout of github.com/naseefo/mhps in the folder POUND_CHECKOUTS"
    assert PUBLISHED.find_missing_sources("needs") == ["`pip install no_such_package`", checkout]
    (tmp_path / "motions" / "folder").mkdir(parents=True)
    (tmp_path / "motions" / "folder" / "other.txt").write_text("")
    assert PUBLISHED.find_missing_sources("needs") == ["`pip install no_such_package`"]


@pytest.mark.parametrize("name", sorted(path.stem for path in PUBLISHED.STUDIES.glob("*.yaml")))
def test_its_study_is_sound(name):
    if name == "two-towers" and "POUND_NIGHTLY" not in os.environ:
        pytest.skip("reads 47 motions: make reference does every night")
    problems: list[str] = []
    try:
        pounding_cli.load_study(PUBLISHED.find_study(name))
    except InputError as error:
        problems = [str(each) for each in error.issues]
    missing = PUBLISHED.list_motions(PUBLISHED.find_study(name))
    assert len(problems) == len(missing), problems
    assert all(any(motion in each for motion in missing) for each in problems)
