"""`pound compare`: what it says and how it ends."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.helpers.two_buildings import STUDY, fails, known

SOLVE = known


def stronger(scene, accuracy=1e-6, method="taylor", **_):
    """As `known`, but one shear of linked buildings is 1 % larger."""
    response = known(scene, accuracy, method)
    if scene.links:
        response.buildings[0].shear[0] *= 1.01
    return replace(response, error_estimate=1e-8)


@pytest.fixture
def before(folder, pound):
    pound("run", "two.yaml", "-o", "a.h5", "-q")
    return folder


def test_the_same_is_said_and_ends_with_0(before, pound):
    code, out, err = pound("compare", "a.h5", "a.h5")
    assert (code, err) == (0, "")
    assert out.startswith(
        "Study: the same.\nVersions: the same.\nScenes: 0 removed, 0 added, 0 with another outcome.\n"
    )
    assert "Numbers: 0 of " in out


def test_one_scene_that_ends_otherwise(folder, pound):
    one = STUDY.replace("{file: weak.txt}, ", "").replace("[elastic, inelastic]", "[elastic]")
    (folder / "two.yaml").write_text(one)
    pound("run", "two.yaml", "-o", "a.h5", "-q")
    pound("run", "two.yaml", "-o", "b.h5", "-q", solve=fails)
    out = pound("compare", "a.h5", "b.h5")[1]
    assert "Scenes: 0 removed, 0 added, 1 with another outcome.\n" in out


def test_a_changed_number_is_shown_with_place_and_error(before, pound):
    pound("run", "two.yaml", "-o", "b.h5", "-q", solve=stronger)
    code, out, _ = pound("compare", "a.h5", "b.h5", "--numbers")
    assert code == 1
    assert "Study: the same." in out
    assert "storey V: 8 differ, most:" in out
    assert " N, by 9.9e-03; carried " in out
    _, every, _ = pound("compare", "a.h5", "b.h5", "--all")
    assert every.count(", by 9.9e-03; carried ") == 8


def test_another_study_ends_with_1_unless_only_numbers_count(before, pound):
    (before / "two.yaml").write_text(STUDY.replace("Two small buildings", "Two others"))
    pound("run", "two.yaml", "-o", "b.h5", "-q")
    code, out, _ = pound("compare", "a.h5", "b.h5")
    assert code == 1
    assert "-title: Two small buildings\n  +title: Two others\n  title: Two small buildings -> Two others\n" in out
    assert pound("compare", "a.h5", "b.h5", "--numbers")[0] == 0


def test_what_is_no_results_file_is_refused(before, pound):
    code, out, err = pound("compare", "a.h5", "two.yaml")
    assert (code, out) == (2, "")
    assert "two.yaml: cannot be read as HDF5" in err
