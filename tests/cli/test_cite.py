"""`pound cite`: of studies and of results files, the same references."""

from __future__ import annotations

import re

from test_run import folder, known, pound  # noqa: F401  (fixtures)


def test_a_study_and_its_results_cite_the_same(folder, pound):  # noqa: F811
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    code, of_study, err = pound("cite", "two.yaml")
    assert (code, err) == (0, "")
    assert pound("cite", "r.h5")[1] == of_study
    assert of_study.startswith("Two small buildings\n\nThe pounding_cli authors (2026).")
    assert "\nUniform Building Code" not in of_study
    assert "Uniform Building Code, 1991 edition. Whittier, California.\n    for the yield shears of stiff" in of_study
    assert "\nMotions\n  weak (user): a file of your own" in of_study


def test_bibtex_has_the_same_entries(folder, pound):  # noqa: F811
    _, text, _ = pound("cite", "two.yaml")
    code, entries, _ = pound("cite", "two.yaml", "--format", "bibtex")
    assert code == 0
    assert len(re.findall(r"^@", entries, flags=re.MULTILINE)) == text.count("\n    for ")
    assert "@article{anagnostopoulos1988,\n  author = {Anagnostopoulos, S. A.},\n" in entries


def test_the_other_systems(folder, pound):  # noqa: F811
    pound("init", "two", "-t", "connector")  # exists: refused, so another name
    pound("init", "spring", "-t", "connector")
    pound("connector", "spring.yaml", "-o", "s.h5", "--no-figures", "-q")
    _, of_study, _ = pound("cite", "spring.yaml")
    assert "Figs 4 and 5" in of_study
    assert "Motions" not in of_study
    assert pound("cite", "s.h5")[1] == of_study
    pound("init", "front", "-t", "wall")
    assert "scikit-fem" in pound("cite", "front.yaml")[1]


def test_what_is_neither_is_refused(folder, pound):  # noqa: F811
    code, out, err = pound("cite", "nothing.h5")
    assert (code, out) == (2, "")
    assert "there is no such results file" in err
