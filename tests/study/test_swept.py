"""Values that depend on axes of a sweep, and what a study with a sweep resolves to."""

from __future__ import annotations

import copy
import dataclasses

import numpy as np
import pytest
import yaml

import pounding_cli as pound
from pounding_cli.errors import InputError, Issue
from pounding_cli.study.construct import resolve as resolving
from pounding_cli.study.construct.swept import Swept, build_constant, build_object_array, sweep_map
from pounding_cli.study.text.issues import Issues

STUDY = yaml.safe_load("""
title: Two frames
records: {use: [elcentro], duration: 0.2 s}
buildings:
  stiff: {storeys: 2, period: 0.36 s, mass: 200 t}
  soft: {like: stiff, period: 0.60 s}
group: [stiff, soft]
cases: {a: {link: pounding, gap: 5 cm}}
analyses: [elastic]
estimate: none
""")


def load(changes: str = "", **sections) -> pound.Study:
    """STUDY with other sections, and with a YAML mapping over it."""
    return pound.load_study(copy.deepcopy(STUDY) | sections | (yaml.safe_load(changes) or {}))


def refusals(changes: str) -> list[str]:
    with pytest.raises(pound.InputError) as refused:
        load(changes)
    return [problem.message for problem in refused.value.issues]


def swept(values, *axes: int) -> Swept:
    array = np.asarray(values, object)
    return Swept(axes, build_object_array(list(array.flat), array.shape))


# Values on axes


def test_a_mapped_value_depends_on_the_axes_of_its_parts():
    total = sweep_map(lambda a, b, c: a + b + c, swept([1, 2], 0), swept([10, 20, 30], 2), build_constant(100))
    assert total.axes == (0, 2)
    assert total.value_at((1, 99, 2)) == 132
    assert total.value_at((0, 7, 0)) == 111


def test_points_whose_parts_are_the_same_objects_share_one_result():
    calls = []
    one, other = ["x"], ["x"]
    built = sweep_map(lambda part, _: calls.append(part) or [part], swept_objects([one, one, other]), swept([1, 1], 1))
    assert len(calls) == 2  # equal, but another object
    assert built.value_at((0, 0)) is built.value_at((1, 1))
    assert built.value_at((0, 0)) is not built.value_at((2, 0))


def swept_objects(values) -> Swept:
    return Swept((0,), build_object_array(values, (len(values),)))


def test_what_has_no_part_is_none_and_not_built():
    doubled = sweep_map(lambda value: 2 * value, swept([1, None, 3], 0))
    assert [doubled.value_at((place,)) for place in range(3)] == [2, None, 6]
    assert not doubled.is_sound


def test_issues_of_one_point_are_noted_there_and_raised_where_nobody_notes_them():
    def refuse(value):
        if value == 2:
            raise InputError([Issue(("gap",), "too wide")])
        return value

    issues = Issues()
    result = sweep_map(refuse, swept([1, 2], 3), issues=issues)
    assert result.value_at((0, 0, 0, 1)) is None
    assert {key: list(points) for key, points in issues.points.items()} == {(Issue(("gap",), "too wide"), (3,)): [(1,)]}
    with pytest.raises(InputError):
        sweep_map(refuse, swept([1, 2], 3))


def test_equal_values_become_one_object_without_the_axes_along_which_nothing_changes():
    values = np.empty((2, 3), object)
    for place in np.ndindex(values.shape):
        values[place] = ("link", place[1] // 2)
    merged = Swept((0, 4), values).merge_equal()
    assert merged.axes == (4,)
    assert merged.values.tolist() == [("link", 0), ("link", 0), ("link", 1)]
    assert merged.values[0] is merged.values[1]
    assert swept([7, 7], 1).merge_equal().axes == ()


# Where issues are told


def test_an_issue_at_all_values_of_an_axis_is_told_without_it():
    said = refusals("""
    cases: {a: {link: hertz}}
    sweep: {cases.a.gap: [1 cm, 2 cm]}
    """)
    assert said == ["'hertz_stiffness' is missing"]


def test_an_issue_of_a_combination_names_both_values():
    said = refusals("""
    cases: {a: {links: [{link: pounding, floors: [1]}, {link: infill, floors: rest}], gap: 1 cm}}
    sweep: {buildings.stiff.height: [3 m, 4 m], buildings.soft.height: [3 m, 5 m]}
    """)
    assert len(said) == 3
    both = "(where buildings.stiff.height = 4 m, buildings.soft.height = 5 m)"
    assert any(message.endswith(both) for message in said)


def test_an_issue_of_a_swept_value_is_told_at_it_without_a_point(tmp_path):
    data = STUDY | {"sweep": {"cases.a.gap": ["1 cm", "-2 cm"], "buildings.soft.period": ["0.5 s", "0.6 s"]}}
    path = tmp_path / "study.yaml"
    path.write_text(yaml.safe_dump(data, sort_keys=False, default_flow_style=False), encoding="utf-8")
    with pytest.raises(pound.InputError) as refused:
        pound.load_study(path)
    (problem,) = refused.value.issues
    assert path.read_text(encoding="utf-8").splitlines()[problem.line - 1].strip() == "- -2 cm"
    assert "where" not in problem.message


# Studies that are faulty at swept values


def test_an_unknown_law_at_every_swept_value_is_refused():
    said = refusals("""
    cases: {a: {link: hertz, hertz_stiffness: 5e9 N/m^1.5, gap: 5 cm}}
    sweep: {cases.a.link: [rubber]}
    """)
    assert said == ["link: 'rubber' is not known"]


def test_a_law_that_is_a_number_is_refused():
    assert refusals("cases: {a: {links: [{link: 5.0, law: printed}], gap: 5 cm}}") == ["'5.0' is not known"]


@pytest.mark.parametrize("values", ["[table1, 1.0]", "[table1]"])
def test_a_swept_key_below_a_swept_value_without_keys_is_refused(values):
    said = refusals(f"sweep: {{records.scale: {values}, records.scale.pga: [0.2 g, 0.3 g]}}")
    assert said
    assert all("the sweep varies 'records.scale.pga', but 'records.scale' is" in message for message in said)


def test_names_in_a_faulty_case_are_looked_at_too():
    said = refusals("""
    cases: {a: {gap: 5 cm, links: [
      {link: infill, gapp: 1 cm}, {link: foam, floors: [1]},
      {link: pounding, stiffness: 5 x mean storey of stif, pair: 2}]}}
    """)
    assert set(said) == {
        "unknown key 'gapp'",
        "'foam' is not known",
        "no building 'stif' is defined",
        "2, but the group has 1 pair of neighbours",
    }


def test_names_under_a_faulty_impact_are_looked_at_too():
    said = refusals("impact: {law: foam, stiffness: 5 x mean storey of stif, restitution: 2}")
    assert set(said) == {
        "'foam' is not a law of contact",
        "no building 'stif' is defined",
        "the coefficient of restitution is 2; it must be above 0 and at most 1",
    }


def test_a_misspelled_key_is_one_problem():
    """Fails if the key that it stands for is told to be missing besides."""
    (said,) = refusals("cases: {a: {link: hertz, gap: 5 cm, hertz_stifness: 5e9 N/m^1.5}}")
    assert said == "unknown key 'hertz_stifness'"


def test_a_word_of_another_law_under_impact_is_refused_in_words():
    said = refusals("""
    impact: {law: jankowski, hertz_stiffness: 5e9 N/m^1.5, damping_formula: jankowski}
    cases: {a: {link: hertz-damp, gap: 5 cm}}
    """)
    assert said == ["damping_formula: 'jankowski' is not known to link: hertz-damp"]


def test_a_period_without_a_finite_stiffness_is_refused():
    (said,) = refusals("buildings: {stiff: {storeys: 2, period: 1e-300 s}, soft: {storeys: 2, period: 0.5 s}}")
    assert said == "a period of 1e-300 s takes storeys of a stiffness above 1e308 N/m"


# Links


def count_builds(monkeypatch, changes: str) -> int:
    calls = []
    build = resolving.build_links
    monkeypatch.setattr(resolving, "build_links", lambda *parts: calls.append(parts) or build(*parts))
    load(changes)
    return len(calls)


def test_links_are_built_once_where_the_stiffest_storey_stays(monkeypatch):
    softer = "sweep: {buildings.soft.period: [0.5 s, 0.6 s, 0.7 s]}"
    stiffer = "sweep: {buildings.stiff.period: [0.3 s, 0.35 s, 0.4 s]}"
    assert count_builds(monkeypatch, softer) == 1
    monkeypatch.undo()
    assert count_builds(monkeypatch, stiffer) == 3


def test_a_key_beside_links_that_no_law_takes_is_refused():
    said = refusals("cases: {a: {gap: 5 cm, slip_force: 100 kN, links: [pounding, {link: infill}]}}")
    assert said == ["'slip_force' beside `links:` does not apply to them, or does not say which it is of"]


def test_contact_keys_of_impact_reach_pounding_of_that_law_alone():
    found = load("""
    impact: {law: hertz, hertz_stiffness: 5e9 N/m^1.5}
    cases: {a: {gap: 5 cm, links: [{link: pounding, floors: [1]}, {link: connector, floors: rest}]}}
    """)
    pounding, connector = found.parts.complete_links["a"].value_at(())
    assert pounding.law == "hertz"
    assert pounding.values["hertz_stiffness"] == 5e9
    assert pounding.paths["hertz_stiffness"] == ("impact", "hertz_stiffness")
    assert {*connector.values} == {"gap"}
    assert [link.law.name for link in found.links((), "a")] == ["hertz", "connector"]
    of_another = load("impact: {hertz_stiffness: 5e9 N/m^1.5}").parts.complete_links["a"].value_at(())
    assert {*of_another[0].values} == {"gap"}


def test_a_damping_ratio_of_a_link_sets_the_restitution_of_impact_aside():
    found = load("""
    impact: {restitution: 0.4}
    cases: {a: {link: pounding, gap: 5 cm, damping_ratio: 5 %}, b: {link: pounding, gap: 5 cm}}
    """)
    (ratio,) = found.parts.link_laws["a"].value_at(())
    assert "restitution" not in found.parts.complete_links["a"].value_at(())[0].values
    (restitution,) = found.parts.link_laws["b"].value_at(())
    assert ratio.damping_ratio == 0.05
    assert restitution.damping_ratio == pytest.approx(-np.log(0.4) / np.hypot(np.pi, np.log(0.4)))


def test_a_gap_that_only_the_sweep_gives_is_taken():
    found = load("{cases: {a: {link: pounding}}, sweep: {cases.a.gap: [1 cm, 2 cm]}}")
    assert [found.links((place,), "a")[0].gap for place in range(2)] == [0.01, 0.02]


# The study


def test_a_study_is_frozen_and_keeps_what_it_is_with_other_axes():
    found = load("""
    cases: {a: {link: pounding, gap: 40 cm}}
    buildings: {stiff: {storeys: 2, period: 0.36 s, mass: 2 t}, soft: {storeys: 2, period: 0.6 s}}
    sweep: {buildings.soft.period: [0.5 s, 0.6 s]}
    """)
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.title = "another"
    alone = found.with_axes(())
    assert alone.axes == ()
    assert alone.title == "Two frames"
    assert found.warnings
    assert alone.warnings == found.warnings
    assert alone.unit("gap") == found.unit("gap")
    assert len(found.axes) == 1  # as before


def test_motions_of_a_swept_scale_are_kept_as_digests():
    found = load("sweep: {records.scale: [1.0, 1.5, 2.0]}")
    uses = [found.motion_uses((place,))["elcentro"] for place in range(3)]
    assert len({use.digest for use in uses}) == 3
    for _, suite in found.parts.suite.iter_values():
        for use in suite.uses.values():
            assert not any(isinstance(value, np.ndarray | pound.Motion) for value in vars(use).values())
    for place, use in enumerate(uses):
        motion = found.motion((place,), "elcentro")
        assert motion.digest == use.digest
        assert motion.pga == pytest.approx(use.pga)
