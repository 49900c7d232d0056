"""Floors that meet no floor of the neighbour are named, those with nothing beside them are not."""

from __future__ import annotations

import pytest

from pounding_cli.study import load_study
from pounding_cli.study.facing import left_out

HEAD = "records: {use: [elcentro], duration: 5 s}\ncases: {touching: {link: pounding, gap: 0 cm}}\n"
SEVEN = "A: {storeys: 7, period: 0.6 s, height: 3 m}"


def warnings(folder, buildings: str, group: str = "[A, B]", more: str = ""):
    path = folder / "pair.yaml"
    path.write_text(f"{HEAD}buildings: {{{buildings}}}\ngroup: {group}\n{more}")
    return load_study(path).warnings


def test_seven_storeys_of_3_m_beside_seven_of_3_5_m(tmp_path):
    (warning,) = warnings(tmp_path, f"{SEVEN}, B: {{like: A, height: 3.5 m}}")
    assert warning.message == (
        "A and B meet at 1 floor only (7 with 6): floors 1 to 6 of A and floors 1 to 5 of B meet no floor and are "
        "simulated as never touching"
    )
    assert "give both the same `height:`" in warning.hint
    assert (warning.line, warning.column) == (4, 12)


def test_floors_above_the_lower_roof_have_nothing_beside_them(tmp_path):
    assert warnings(tmp_path, f"{SEVEN}, B: {{like: A, storeys: 5}}") == ()
    assert warnings(tmp_path, f"{SEVEN}, B: {{like: A, storeys: 5}}", "[B, A]") == ()


def test_only_the_floors_that_meet_nothing_are_named(tmp_path):
    heights = "[3 m, 1.5 m, 4.5 m, 3 m]"  # floors at 3, 4.5, 9, 12 m beside 3, 6, 9, ... m
    (warning,) = warnings(tmp_path, f"{SEVEN}, B: {{storeys: 4, period: 0.4 s, height: {heights}}}")[-1:]
    assert "meet at 3 floors only (1, 3, 4): floor 2 of A and floor 2 of B meet no floor and are" in (
        warning.message.replace("3 with 3", "3").replace("4 with 4", "4")
    )


def test_every_pair_is_told_on_its_own(tmp_path):
    found = warnings(tmp_path, f"{SEVEN}, B: {{like: A, height: 3.5 m}}, C: {{like: A}}", "[C, A, B, A]")
    assert [(warning.message[:9], warning.column) for warning in found] == [("A-1 and B", 15), ("B and A-2", 18)]


def test_a_height_of_the_sweep_is_looked_at_too(tmp_path):
    sweep = "sweep: {buildings.B.height: [3 m, 3.5 m]}\n"
    (warning,) = warnings(tmp_path, f"{SEVEN}, B: {{like: A}}", more=sweep)
    assert "A and B meet at 1 floor only" in warning.message


@pytest.mark.parametrize(
    ("left", "right", "expected"), [(3.0, 3.0, ([], [])), (3.0, 4.0, ([1, 2, 3, 5, 6], [1, 2, 4]))]
)
def test_floors_that_are_left_out_by_hand(left, right, expected):
    import numpy as np

    from pounding_cli.model.building import Building

    def of(height: float, storeys: int) -> Building:
        ones = np.ones(storeys)
        return Building("x", ones, height * ones, ones, ones, 0.05 * ones, 0.0, 0.0)

    assert left_out(of(left, 6), of(right, 5)) == expected
