"""Ranges on the axes of a sweep, and what a study may leave out or say in a word."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.study import expand
from pounding_cli.study.system_study import load_system

SWEEP = "analyses: [elastic]\nsweep: %s\n"


@pytest.mark.parametrize(
    ("values", "wanted", "shown"),
    [
        ("{from: 0.2 s, to: 1.5 s, count: 14}", np.arange(2, 16) / 10, "0.3 s"),
        ("{from: 200 ms, to: 1.4 s, step: 0.3 s}", [0.2, 0.5, 0.8, 1.1, 1.4], "500 ms"),
        ("{from: 1.4 s, to: 0.2 s, step: -0.3 s}", [1.4, 1.1, 0.8, 0.5, 0.2], "1.1 s"),
        ("{from: 0.2 s, to: 3.2 s, count: 5, spacing: log}", [0.2, 0.4, 0.8, 1.6, 3.2], "0.4 s"),
        ("{from: 0.2, to: 0.4, count: 3, spacing: linear}", [0.2, 0.3, 0.4], "0.3 s"),
    ],
)
def test_range(study, values, wanted, shown):
    (axis,) = study(("analyses: [elastic]\n", SWEEP % f"{{buildings.soft.period: {values}}}")).axes
    assert [value for (value,) in axis.values] == pytest.approx(list(wanted), rel=1e-15)
    assert "ms" in shown or axis.values[1][0] == float(shown.removesuffix(" s"))  # 0.3, not 0.30000000000000004
    assert axis.shown(1) == (shown,)


def test_range_of_storeys_and_of_a_zipped_key(study):
    axes = "[{buildings.soft.storeys: {from: 2, to: 6, step: 2}, cases.gap.gap: {from: 0 cm, to: 4 cm, count: 3}}]"
    plan = expand(study(("analyses: [elastic]\n", SWEEP % axes)))
    assert plan.axes[0].values == ((2.0, 0.0), (4.0, 0.02), (6.0, 0.04))
    assert [plan.scenes[plan.rows[2 * n].scene].buildings[1].storeys for n in range(3)] == [2, 4, 6]


def test_range_of_a_connector_study(tmp_path):
    path = tmp_path / "connector.yaml"
    path.write_text("title: x\nfirst: {period: 0.5 s}\nsweep:\n  damping: {from: 2 %, to: 6 %, step: 2 %}\n")
    assert [point.values["damping"] for point in load_system(path, "connector").points] == [0.02, 0.04, 0.06]


def test_a_motion_of_ones_own_is_whole_unless_said_otherwise(study, tmp_path):
    (tmp_path / "m.txt").write_text("\n".join(f"{i * 0.01:.2f} {0.1 * (-1) ** i}" for i in range(1200)) + "\n")
    read = study(("[elcentro, taft]", "[elcentro, m.txt]"), ("  duration: 5 s\n", ""))
    assert [round(use.window, 9) for use in expand(read).motions] == [10.0, 11.99]
    assert read.resolved()["records"]["duration"] == "auto"


@pytest.mark.parametrize("floors", ["2", "[2]"])
def test_one_floor_needs_no_list(study, floors):
    read = study(("gap: {link: pounding, gap: 5 cm}", f"gap: {{link: pounding, gap: 5 cm, floors: {floors}}}"))
    assert [(link.left_floor, link.right_floor) for link in read.resolver.links((), "gap")] == [(2, 2)]
    assert read.resolved()["cases"]["gap"]["floors"] == [2]


def test_floors_can_be_swept_one_by_one(study):
    changed = ("gap: {link: pounding, gap: 5 cm}", "gap: {link: pounding, gap: 5 cm, floors: 1}")
    plan = expand(study(changed, ("analyses: [elastic]\n", SWEEP % "{cases.gap.floors: [1, 3, all]}")))
    assert [[link.left_floor for link in row.links] for row in plan.rows][::2] == [[1], [3], [1, 2, 3]]
    assert [text for place in range(3) for text in plan.axes[0].shown(place)] == ["1", "3", "all"]


def test_a_case_without_links_is_a_case(study):
    read = study(("  gap: {link: pounding, gap: 5 cm}", "  con: {link: none}\n  gap: {link: pounding, gap: 5 cm}"))
    plan = expand(read)
    assert {row.case: len(row.links) for row in plan.rows} == {"con": 0, "gap": 3}


STRENGTH = ("period: 0.36 s, mass: 200 t", "period: 0.36 s, mass: 200 t, yield: %s")
WEIGHT = 3 * 200e3 * 9.80665


@pytest.mark.parametrize(
    ("design", "shares"),
    [
        ("{base_shear: 0.10 W}", [1, 5 / 6, 3 / 6]),
        ("{base_shear: 10 %, distribution: uniform}", [1, 2 / 3, 1 / 3]),
        ("{base_shear: 0.1, distribution: parabolic}", [1, 13 / 14, 9 / 14]),
        ("{base_shear: 0.1, distribution: asce7}", [1, 5 / 6, 3 / 6]),  # T below 0.5 s
        ("{base_shear: 0.1, distribution: ubc}", [1, 5 / 6, 3 / 6]),  # T below 0.7 s: no force at the top
        ("{base_shear: 0.05 W, overstrength: 2}", [1, 5 / 6, 3 / 6]),
    ],
)
def test_yield_shears_from_a_base_shear(study, design, shares):
    read = study((STRENGTH[0], STRENGTH[1] % design), ("like: stiff, period: 0.60 s", "storeys: 3, period: 0.60 s"))
    building = read.building((), 0)
    assert building.yield_shear == pytest.approx(0.1 * WEIGHT * np.array(shares), rel=1e-12)
    assert building.base_shear_ratio == pytest.approx(0.1, rel=1e-12)
    assert np.isnan(read.separations(())[0])  # no code designed this building


def test_distributions_of_long_periods(study):
    """k of ASCE 7 at T = 1.5 s is 1.5; the UBC puts 0.07 T V at the roof."""
    text = "stiff: {storeys: 3, period: 1.5 s, yield: {base_shear: 0.1, distribution: %s}}"
    shears = {}
    for name in ("asce7", "ubc"):
        read = study(("stiff: {storeys: 3, period: 0.36 s, mass: 200 t}", text % name), ("like: stiff", "storeys: 3"))
        shears[name] = read.building((), 0).yield_shear / (0.1 * WEIGHT)
    heights = np.array([1, 2, 3]) ** 1.5
    assert shears["asce7"][2] == pytest.approx(heights[2] / heights.sum(), rel=1e-12)
    assert shears["ubc"][2] == pytest.approx(0.07 * 1.5 + (1 - 0.07 * 1.5) / 2, rel=1e-12)


def test_overstrength_of_a_code_leaves_its_separation(study):
    plain, strong = study(), study((STRENGTH[0], STRENGTH[1] % "{overstrength: 2.5}"))
    assert strong.building((), 0).yield_shear == pytest.approx(2.5 * plain.building((), 0).yield_shear, rel=1e-15)
    assert strong.separations(())[0] == plain.separations(())[0]


def test_a_building_gives_way_to_the_strength_it_inherits(study):
    """`base_shear` of a parent ends where the child names a code, and the other way round."""
    read = study(
        (STRENGTH[0], STRENGTH[1] % "{base_shear: 0.1, distribution: uniform}"),
        ("like: stiff, period: 0.60 s", "like: stiff, period: 0.60 s, yield: {Rw: 8}"),
    )
    assert read.resolved()["buildings"]["soft"]["yield"]["code"] == "UBC-1991"
    assert "code" not in read.resolved()["buildings"]["stiff"]["yield"]
