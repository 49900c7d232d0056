"""What is a change and what is not: numbers are moved by known amounts, just inside and just outside the error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.store import open_results, write_results
from pounding_cli.store.compare import compare
from tests.helpers.plans import Axis, FakeStudy, known, small_plan
from tests.helpers.sealing import edited


@pytest.fixture
def made(tmp_path):
    """A results file of a small plan; `change` takes each linked scene's response."""

    def make(name, change=lambda response: response, error=1e-7, plan=None, method="taylor", accuracy=1e-6):
        plan = plan or small_plan()
        solved = {}
        for digest, scene in plan.scenes.items():
            response = replace(known(scene, accuracy, method), error_estimate=error)
            solved[digest] = change(response) if scene.links else response
        path = tmp_path / f"{name}.h5"
        write_results(path, plan, solved)
        return open_results(path)

    return make


def moved(field, by, place=0):
    """Changes a building's array of peaks at its first level by the relative amount `by`."""

    def change(response):
        buildings = list(response.buildings)
        values = getattr(buildings[place], field).copy()
        values[0] *= 1 + by
        buildings[place] = replace(buildings[place], **{field: values})
        return replace(response, buildings=tuple(buildings))

    return change


def test_a_file_is_the_same_as_itself(made):
    results = made("a")
    found = compare(results, results)
    assert found.same
    assert found.same_numbers
    assert (found.lines, found.keys, found.software, found.removed, found.added) == ((), (), (), (), ())
    assert found.compared > 200
    assert found.unestimated == 0


@pytest.mark.parametrize(("field", "column"), [("shear", "V"), ("drift", "drift"), ("ductility", "mu")])
@pytest.mark.parametrize(("share", "changed"), [(0.9, False), (1.1, True)])
def test_estimated_peaks_change_beyond_both_errors(made, field, column, share, changed):
    """Errors of 1e-7 and 3e-7: up to 4e-7 of the number is no change."""
    found = compare(made("a", error=1e-7), made("b", moved(field, share * 4e-7), error=3e-7))
    assert found.same_numbers is not changed
    assert set(found.changes["column"]) == ({column} if changed else set())
    if changed:
        assert len(found.changes) == 2 * 2 * 2  # one storey in every case, analysis and record
        assert found.changes["difference"][0] == pytest.approx(1.1 * 4e-7, rel=1e-6)
        assert found.changes["carried"][0] == pytest.approx(4e-7)
        assert found.changes["place"][0].endswith("stiff, 1")


@pytest.mark.parametrize(("share", "changed"), [(0.9, False), (1.1, True)])
def test_what_is_not_estimated_has_the_accuracy_asked(made, share, changed):
    """Accelerations: 1e-6 asked of both files, relative to the scene's largest, three times the first floor's."""
    found = compare(made("a"), made("b", moved("acceleration", share * 3 * 2e-6)))
    assert found.same_numbers is not changed
    assert set(found.changes["column"]) == ({"acceleration"} if changed else set())


def test_without_an_estimate_the_accuracy_asked_stands_in(made):
    first = made("a", error=np.nan)
    assert compare(first, made("b", moved("shear", 1.9e-6), error=np.nan)).same_numbers
    found = compare(first, made("c", moved("shear", 2.1e-6), error=np.nan))
    assert not found.same_numbers
    assert found.unestimated == 8


def test_a_fixed_step_without_an_estimate_is_compared_to_rounding(made):
    first = made("a", error=np.nan, method="newmark", accuracy=np.nan)
    assert compare(first, made("b", error=np.nan, method="newmark", accuracy=np.nan)).same_numbers
    assert not compare(first, made("c", moved("shear", 1e-11), np.nan, method="newmark", accuracy=np.nan)).same_numbers


def test_a_row_solved_in_groups_is_compared_to_the_accuracy_asked(made):
    both = {"error": np.nan, "method": "exponential, taylor"}
    assert compare(made("a", **both), made("b", moved("shear", 1e-6), **both)).same_numbers
    assert not compare(made("a", **both), made("b", moved("shear", 3e-6), **both)).same_numbers


def test_numbers_near_zero_are_judged_by_the_largest_of_their_kind(made):
    """A residual drift of 1e-9 of the largest drift is no change, though it was exactly zero."""

    def lasting(share):
        def change(response):
            stiff = response.buildings[0]
            values = np.array([share * stiff.drift.max(), 0.0, 0.0])
            return replace(response, buildings=(replace(stiff, residual_drift=values), *response.buildings[1:]))

        return change

    first = made("a")
    assert compare(first, made("b", lasting(1e-9))).same_numbers
    found = compare(first, made("c", lasting(1e-5)))
    assert set(found.changes["column"]) == {"residual_drift"}


def test_one_impact_more_is_a_change(made):
    def change(response):
        return replace(response, links=replace(response.links, impacts=response.links.impacts + 1))

    found = compare(made("a", error=0.5), made("b", change, error=0.5))  # whatever the error: it is a count
    assert set(found.changes["column"]) == {"impacts"}
    assert len(found.changes) == 2 * 2 * 2 * 2


def test_a_number_that_vanished_is_a_change(made):
    found = compare(made("a"), made("b", moved("shear", np.nan)))
    assert set(found.changes["column"]) == {"V"}
    assert np.isinf(found.changes["difference"]).all()


def test_scenes_come_and_go_by_name(made):
    more = small_plan(cases=(("touching", 0.0), ("wide", 0.5)))
    found = compare(made("a"), made("b", plan=more))
    assert found.removed == (
        "gap, elastic, weak", "gap, elastic, strong", "gap, inelastic, weak", "gap, inelastic, strong",
    )  # fmt: skip
    assert found.added == tuple(place.replace("gap", "wide") for place in found.removed)
    assert not len(found.changes)
    assert not found.same


def test_points_of_a_sweep_are_matched_by_value(made):
    def plan(*ratios):
        return small_plan(axes=(Axis(("impact.damping_ratio",), tuple((r,) for r in ratios)),))

    found = compare(made("a", plan=plan(0.1, 0.2)), made("b", moved("shear", 1e-3), plan=plan(0.2, 0.3)))
    assert len(found.removed) == len(found.added) == 8
    assert all(place.startswith("0.1, ") for place in found.removed)
    assert all(place.startswith("0.3, ") for place in found.added)
    assert {place.split(", ")[0] for place in found.changes["place"]} == {"0.2"}


def test_a_scene_that_failed_is_told(made):
    def change(response):
        return replace(response, status="stalled") if response.links.impacts.size else response

    found = compare(made("a"), made("b", change))
    assert ("touching, elastic, weak", "done", "stalled") in found.outcomes
    assert not found.same_numbers


def test_words_and_versions_make_no_difference_keys_do(made, tmp_path):
    def facts(gap, derived):
        return {"gap": gap, "separation": [derived], "buildings": {"stiff": {"derived": {"period": derived}}}}

    first = made("a", plan=small_plan(study=FakeStudy(text="gap: 5 cm\n", facts=facts(0.05, 1.0))))
    other = small_plan(study=FakeStudy(text="gap: 50 mm\n", facts=facts(0.05, 2.0)))
    made("b", plan=other)
    with edited(tmp_path / "b.h5") as file:
        file["software"].attrs["numpy"] = "1.0"
    found = compare(first, open_results(tmp_path / "b.h5"))
    assert found.lines == ("-gap: 5 cm", "+gap: 50 mm")
    assert [name for name, *_ in found.software] == ["numpy"]
    assert found.same
    third = small_plan(study=FakeStudy(text="gap: 6 cm\n", facts=facts(0.06, 1.0)))
    found = compare(first, made("c", plan=third))
    assert found.keys == (("gap", 0.05, 0.06),)
    assert found.same_numbers
    assert not found.same
