"""`pound cite`: of studies and of results files, the same references."""

from __future__ import annotations

import re

import pytest

from tests.helpers.two_buildings import STUDY, known

SOLVE = known


def test_a_study_and_its_results_cite_the_same(folder, pound):
    pound("run", "two.yaml", "-o", "r.h5", "-q", solve=None)
    code, of_study, err = pound("cite", "two.yaml")
    assert (code, err) == (0, "")
    assert pound("cite", "r.h5")[1] == of_study
    assert of_study.startswith("Two small buildings\n\npounding_cli contributors (2026).")
    assert "\nUniform Building Code" not in of_study
    assert "Uniform Building Code, 1991 edition. Whittier, California.\n    for the yield shears of stiff" in of_study
    assert "\nMotions\n  weak (user, unit g assumed): your own file" in of_study


@pytest.mark.parametrize(
    ("options", "series", "exact"),
    [
        ([], False, True),
        (["--all-effects"], True, False),
    ],  # nothing pounds here; or all is solved by series all the same
)
def test_a_results_file_cites_the_methods_it_was_made_by(folder, pound, options, series, exact):
    study = STUDY.replace("gap: 0 cm", "gap: 60 cm").replace("gap: 1 cm", "gap: 50 cm")
    (folder / "two.yaml").write_text(study.replace("[elastic, inelastic]", "[elastic]"))
    pound("run", "two.yaml", "-o", "r.h5", "-q", *options, solve=None)
    cited = pound("cite", "r.h5")[1]
    assert ("for the method of solution, Taylor" in cited) is series
    assert ("for the method of solution, exponential" in cited) is exact


def test_bibtex_has_the_same_entries(folder, pound):
    _, text, _ = pound("cite", "two.yaml")
    code, entries, _ = pound("cite", "two.yaml", "--format", "bibtex")
    assert code == 0
    assert len(re.findall(r"^@", entries, flags=re.MULTILINE)) == text.count("\n    for ")
    assert "@article{anagnostopoulos1988,\n  author = {Anagnostopoulos, S. A.},\n" in entries


def test_the_other_systems(folder, pound):
    pound("init", "two", "-t", "connector")  # exists: refused, so another name
    pound("init", "spring", "-t", "connector")
    pound("connector", "spring.yaml", "-o", "s.h5", "-q")
    _, of_study, _ = pound("cite", "spring.yaml")
    assert "Figs 4 and 5" in of_study
    assert "Motions" not in of_study
    assert pound("cite", "s.h5")[1] == of_study
    pound("init", "front", "-t", "wall")
    assert "scikit-fem" in pound("cite", "front.yaml")[1]


def test_what_is_neither_is_refused(folder, pound):
    code, out, err = pound("cite", "nothing.h5")
    assert (code, out) == (2, "")
    assert "there is no such results file" in err
