"""Slabs with a thickness, and slabs that strike columns, from the study file to the links of a scene."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.model.building import Building
from pounding_cli.model.meetings import Strike, column_flexibility, meetings
from pounding_cli.study import expand, load_study

HEAD = "records: {use: [elcentro], duration: 5 s}\n"
CASES = "cases: {touching: {link: pounding, gap: 1 cm}}\n"
LOW = "A: {storeys: 2, period: 0.3 s, height: 3 m"
HIGH = "B: {storeys: 2, period: 0.5 s, height: [4 m, 3.5 m]"


def study(folder, buildings: str, cases: str = CASES, more: str = ""):
    path = folder / "pair.yaml"
    path.write_text(f"{HEAD}{cases}buildings: {{{buildings}}}\ngroup: [A, B]\n{more}")
    return load_study(path)


def links(found):
    plan = expand(found)
    return plan.scenes[plan.rows[0].scene].links


def refused(folder, buildings: str, cases: str = CASES):
    with pytest.raises(InputError) as error:
        study(folder, buildings, cases)
    return error.value.problems


def of(heights, slab: float = 0.0, columns: float | None = None) -> Building:
    ones = np.ones(len(heights))
    return Building("x", ones, np.array(heights), 1e8 * ones, ones, 0 * ones, 0, 0, slab=slab, columns=columns)


def test_who_meets_whom_by_hand():
    """Fails if a slab takes the wrong storey, or one above the roof finds columns."""
    floors, strikes = meetings(of([3.0, 3.0, 3.0, 3.0]), of([4.0, 5.0]))
    assert floors == ((3, 2),)
    assert strikes == (Strike(1, 1, 1.0, 0.75), Strike(2, 1, pytest.approx(1 / 3), 1.0), Strike(2, 2, 1.0, 0.4))


@pytest.mark.parametrize(("slabs", "meet"), [((0.0, 0.0), False), ((0.2, 0.0), False), ((0.2, 0.2), True)])
def test_slabs_whose_heights_overlap_meet(slabs, meet):
    """15 cm apart. Fails if thickness is taken whole from the elevation, or of one slab alone."""
    floors, strikes = meetings(of([3.0], slabs[0]), of([3.15], slabs[1]))
    assert bool(floors) == meet
    assert bool(strikes) != meet


def test_a_slab_meets_the_nearest_one_alone():
    """Fails if one slab that overlaps two others has two links, or strikes columns too."""
    floors, strikes = meetings(of([3.0, 3.0], 1.0), of([2.6, 0.9, 2.5], 0.8))
    assert floors == ((1, 1), (2, 3))
    assert strikes == ()


def test_flexibility_of_the_columns_is_that_of_a_clamped_beam():
    """Against the beam's stiffness matrix, condensed. Fails if the share or a power is wrong."""
    length, at, share, k = 3.5, 0.3, 0.2, 1e8
    inertia = share * k * length**3 / 12

    def beam(part):
        return inertia * np.array([[12 / part**3, -6 / part**2], [-6 / part**2, 4 / part]])

    below, above = beam(at * length), beam((1 - at) * length)
    above[0, 1] = above[1, 0] = -above[0, 1]
    by_matrix = np.linalg.inv(below + above)[0, 0]
    assert column_flexibility(of([3.0, length], columns=share), 2, at) == pytest.approx(by_matrix, rel=1e-12)


def test_links_of_slabs_and_columns(tmp_path):
    """Contact and columns in series, the dashpot's damping ratio kept. Fails if the columns' flexibility is left out,
    or that of the wrong building is taken."""
    found = study(tmp_path, f"{LOW}}}, {HIGH}, columns: 20 %}}")
    assert "floor 1 of B" in found.warnings[0].message
    one, two = links(found)
    assert [(link.left_floor, link.right_floor, link.right_at) for link in (one, two)] == [(1, 1, 0.75), (2, 2, 4 / 7)]
    plan = expand(found)
    a, b = plan.scenes[plan.rows[0].scene].buildings
    s = 20 * max(a.stiffness.max(), b.stiffness.max())
    for link in (one, two):
        x, k = link.right_at, 0.2 * b.stiffness[link.right_floor - 1]
        assert 1 / link.law.stiffness == pytest.approx(1 / s + 4 * (x * (1 - x)) ** 3 / k, rel=1e-12)
        assert (link.columns, link.left_at) == (0.2, 1.0)


def test_columns_of_both_buildings(tmp_path):
    found = study(tmp_path, f"{LOW}, columns: 10 %}}, {HIGH}, columns: 20 %}}")
    assert found.warnings == ()
    assert [(link.left_floor, link.left_at, link.columns) for link in links(found)] == [
        (1, 1.0, 0.2), (2, pytest.approx(1 / 3), 0.1), (2, 1.0, 0.2),
    ]  # fmt: skip


def test_what_stays_as_it_was(tmp_path):
    """Scenes without these keys keep their digests. Fails if slab or columns move a building's digest."""
    plain = study(tmp_path, f"{LOW}}}, B: {{like: A, period: 0.5 s}}")
    thick = study(tmp_path, f"{LOW}, slab: 20 cm, columns: 0.2}}, B: {{like: A, period: 0.5 s}}")
    assert list(expand(plain).scenes) == list(expand(thick).scenes)


@pytest.mark.parametrize(
    ("case", "wanted"),
    [
        ("{link: none, at_columns: {link: pounding, gap: 4 cm}}", [0.04, 0.04]),
        ("{link: pounding, gap: 1 cm, at_columns: none}", []),
        ("{link: infill, gap: 1 cm, at_columns: pounding}", [0.01, 0.01]),
        ("{link: infill, gap: 1 cm, floors: []}", []),
        ("{link: pounding, gap: 1 cm, at_columns: {gap: 3 cm}}", [0.03, 0.03]),
        ("{gap: 1 cm, pairs: [{link: pounding, at_columns: {gap: 2 cm}}]}", [0.02, 0.02]),
    ],
)
def test_at_columns(tmp_path, case, wanted):
    cases = f"cases: {{one: {case}}}\n".replace("floors: []", "by_floor: {}, at_columns: none")
    found = study(tmp_path, f"{LOW}}}, {HIGH}, columns: 20 %}}", cases)
    assert [link.gap for link in links(found)] == wanted


@pytest.mark.parametrize(
    ("case", "message", "hint"),
    [
        ("{link: infill, gap: 1 cm}", "infill between a slab and columns is not modelled", "at_columns: none"),
        ("{link: [pounding, damper], gap: 1 cm, damping_coefficient: 1 MN s/m}", "several links", "at_columns: pound"),
        ("{link: pounding, gap: 1 cm, at_columns: hertz}", "hertz between a slab and columns", "at_columns: pounding"),
        ("{link: none, at_columns: pounding}", "'gap' is missing", "gap: 5 cm"),
        ("{link: pounding, gap: 1 cm, at_columns: punding}", "'punding' is not known", "did you mean 'pounding'"),
    ],
)
def test_links_that_columns_do_not_take(tmp_path, case, message, hint):
    (problem,) = refused(tmp_path, f"{LOW}}}, {HIGH}, columns: 20 %}}", f"cases: {{one: {case}}}\n")
    assert message in problem.message
    assert hint in problem.hint
    assert problem.line == 2
    assert problem.column > 1


def test_columns_do_not_take_a_law_of_contact(tmp_path):
    """Fails if blows against columns are left out in silence where the impact element has another law."""
    pair, impact = f"{LOW}}}, {HIGH}, columns: 20 %}}", "impact: {law: hertz, hertz_stiffness: 1e9 N/m^1.5}\n"
    (problem,) = refused(tmp_path, pair, CASES + impact)
    assert "the law hertz between a slab and columns is not modelled" in problem.message
    assert (problem.line, problem.column) == (3, 15)
    assert links(study(tmp_path, pair, CASES.replace("1 cm", "1 cm, at_columns: none") + impact)) == ()


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("slab: 3 m", "a slab of 3 m is not thinner than a storey of 3 m"),
        ("slab: -1 cm", "slab"),
        ("slab: 2 t", "slab"),
        ("columns: 0", "columns"),
        ("columns: 120 %", "columns"),
        ("columns: all", "columns"),
    ],
)
def test_bad_values(tmp_path, keys, message):
    (problem,) = refused(tmp_path, f"{LOW}, {keys}}}, B: {{like: A}}")[:1]
    assert message in problem.message
    assert (problem.line, problem.column > 1) == (3, True)


def test_no_floor_meets_and_nothing_is_known_of_the_columns(tmp_path):
    (problem,) = refused(tmp_path, f"{LOW}}}, {HIGH}}}")
    assert "have no floor at one elevation" in problem.message
    assert "columns: 20 %" in problem.hint


def test_what_is_left_out_is_said(tmp_path):
    """One roof meets, other slabs would strike columns. Fails if the meeting floors are run in silence."""
    (warning,) = study(tmp_path, f"{LOW}}}, B: {{storeys: 2, period: 0.5 s, height: [4 m, 2 m]}}").warnings
    assert "meet at 1 floor only (2): floor 1 of A and floor 1 of B meet no floor" in warning.message
    assert "columns: 20 %` in B and A" in warning.hint


def test_an_elevation_in_a_sweep(tmp_path):
    """Heights that are swept change who meets whom. Fails if links of one point are taken at another."""
    more = "sweep: {buildings.B.height: [3 m, 3.5 m]}\n"
    plan = expand(study(tmp_path, f"{LOW}}}, B: {{like: A, columns: 20 %}}", more=more))
    each = [[link.right_at for link in plan.scenes[row.scene].links] for row in plan.rows if row.analysis == "elastic"]
    assert each == [[1.0, 1.0], [pytest.approx(6 / 7), pytest.approx(5 / 7)]]
