"""Rows of parts that nothing links, and walls that are struck from both sides."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pounding_cli as pound
from tests.adapter import FLOORS, LINKS, Scene, solve
from tests.physics.cases import mirrored, shake
from tests.reference.events import integrate

FIXED = {"wall": "fixed"}
SOIL = {"wall": {"height": 7.0, "mass": 6e4, "stiffness": 2e8, "damping": 1e5}}
STIFF = {"storeys": 3, "period": 0.3, "mass": 2e5}
SOFT = {"storeys": 2, "period": 0.5, "mass": 2e5}
WEAK = {"storeys": 2, "period": 0.9, "mass": 2e5, "p_delta": True, "hardening": 0.0, "yield": {"base_shear": "0.03 W"}}
SWAYING = {**SOFT, "foundation": {"mass": 2e5, "sway_stiffness": 4e8, "sway_damping": 1e6, "inertia": 1e7,
                                  "rocking_stiffness": 2e10, "rocking_damping": 1e8}}  # fmt: skip
ISOLATED = {**STIFF, "foundation": {"mass": 2e5, "isolation": {"radius": 3.1, "friction": 0.06}}}
WEN = {**SOFT, "storey_law": "bouc-wen"}
POUNDING = {"link": "pounding", "gap": 0.003, "stiffness": 2e9}
MOTION = shake(3.0, 6.0)


def scene(buildings: list[dict[str, Any]], case: dict[str, Any], **more: Any) -> Scene:
    return Scene(buildings, MOTION, 0.02, case, **more)


def links_of_pairs(**link_by_pair: dict[str, Any] | str) -> dict[str, Any]:
    """Return a case with the link of each pair, counted from 1: p1, p2, ..."""
    links = []
    for name, link in link_by_pair.items():
        keys = {"link": link} if isinstance(link, str) else dict(link)
        links.append({**keys, "pair": int(name[1:])})
    return {"links": links}


VISCOUS = {"link": "viscous", "gap": 0.01, "force_at_1_m_s": 1e6, "exponent": 1.0}
CONNECTOR = {"link": "connector", "gap": 0.01, "stiffness": 1e8}
HERTZ = {"link": "hertz-damp", "gap": 0.003, "hertz_stiffness": 1e10}
ROWS: dict[str, tuple[list[dict[str, Any]], dict[str, Any], list[tuple[slice, dict[str, Any]]]]] = {
    "a pair and a building": (
        [STIFF, SOFT, STIFF],
        links_of_pairs(p1=POUNDING),
        [(slice(0, 2), POUNDING), (slice(2, 3), {})],
    ),
    "a fixed wall between": (
        [STIFF, SOFT, FIXED, WEN],
        POUNDING,
        [(slice(0, 3), POUNDING), (slice(2, 4), POUNDING)],
    ),
    "two pairs of other laws": (
        [STIFF, SOFT, SWAYING, STIFF],
        links_of_pairs(p1=HERTZ, p3=VISCOUS),
        [(slice(0, 2), HERTZ), (slice(2, 4), VISCOUS)],
    ),
    "a moat and a neighbour": (
        [FIXED, ISOLATED, FIXED, SOFT],
        links_of_pairs(p1=POUNDING, p2=POUNDING),
        [(slice(0, 3), POUNDING), (slice(3, 4), {})],
    ),
    "a wall on the soil couples": (
        [STIFF, SOIL, SOFT, FIXED, SWAYING],
        links_of_pairs(p1=POUNDING, p2=POUNDING, p3=CONNECTOR, p4=CONNECTOR),
        [(slice(0, 4), links_of_pairs(p1=POUNDING, p2=POUNDING, p3=CONNECTOR)), (slice(3, 5), CONNECTOR)],
    ),
}


@pytest.mark.parametrize("analysis", ["elastic", "inelastic"])
@pytest.mark.parametrize("name", ROWS)
def test_parts_have_the_numbers_of_each_by_itself(name: str, analysis: str) -> None:
    """To the last digit, peaks and histories alike; energies are sums, and the balance closes."""
    buildings, case, parts = ROWS[name]
    whole = scene(buildings, case, analysis=analysis).built
    row = pound.solve(whole)
    history = pound.history(whole, every=0.01)
    assert row.status == "done"
    assert abs(row.energy["residual"]) < 1e-8
    first_link = 0
    energy = 0.0
    steps = 0
    for places, of_part in parts:
        alone = scene(buildings[places], of_part, analysis=analysis).built
        part = pound.solve(alone)
        count = len(alone.links)
        for building, expected in zip(row.buildings[places], part.buildings, strict=True):
            for field in (*FLOORS, "sway", "rocking"):
                assert np.array_equal(getattr(building, field), getattr(expected, field), equal_nan=True), field
        for field in LINKS:
            found = getattr(row.links, field)[first_link : first_link + count]
            assert np.array_equal(found, getattr(part.links, field)), field
        kept = pound.history(alone, every=0.01)
        assert np.array_equal(kept.time, history.time)
        levels = kept.drift.shape[2]
        assert np.array_equal(kept.drift, history.drift[:, places, :levels], equal_nan=True)
        assert np.array_equal(kept.link_force, history.link_force[:, first_link : first_link + count])
        first_link += count
        energy += part.energy["input"]
        steps += part.steps
    assert first_link == len(whole.links)
    assert row.energy["input"] == pytest.approx(energy, rel=1e-14)
    assert row.steps == steps
    total = sum(values[-1] for kind, values in history.energy.items() if kind != "input")
    assert total == pytest.approx(history.energy_input[-1], rel=1e-6)


def test_links_that_act_at_a_wall_on_the_soil_keep_a_row_whole() -> None:
    """Its neighbours change each other's numbers, as they do not across one that moves with the ground."""
    case = links_of_pairs(p1=POUNDING, p2=POUNDING)
    three, two = [STIFF, SOIL, SOFT], [STIFF, SOIL]
    row, pair = pound.solve(scene(three, case).built), pound.solve(scene(two, POUNDING).built)
    assert (row.links.impacts > 0).all()
    assert not np.allclose(row.buildings[0].shear, pair.buildings[0].shear, rtol=1e-3)


def test_a_wall_struck_from_both_sides_mirrored() -> None:
    case = {**POUNDING, "restitution": 0.6}
    row = Scene([STIFF, SOIL, SOFT], shake(3.0), 0.02, case)
    one, other = solve(row, 1e-11), solve(mirrored(row), 1e-11)
    assert (one.impacts > 0).all()
    assert np.allclose(one.shear[:3], other.shear[3:], rtol=1e-8)
    assert np.allclose(one.shear[3:4], other.shear[2:3], rtol=1e-8)
    assert np.allclose(one.peak_force, np.concatenate((other.peak_force[2:], other.peak_force[:2])), rtol=1e-7)
    assert abs(one.energy["residual"]) < 1e-10


def test_a_wall_struck_from_both_sides_by_another_method() -> None:
    """Dormand-Prince with matrices, laws and events of its own."""
    case = {**POUNDING, "restitution": 0.6}
    row = Scene([{**SOFT, "storeys": 1}, SOIL, {**SOFT, "storeys": 1, "period": 0.25}], shake(1.2, 8.0), 0.02, case)
    run, expected = solve(row, 1e-11), integrate(row.built)
    assert (run.impacts > 0).all()
    assert list(run.impacts) == list(expected.impacts)
    assert np.allclose(run.shear, expected.shear, rtol=1e-7)
    assert np.allclose(run.peak_force, expected.peak_force, rtol=1e-7)


def test_one_part_collapses() -> None:
    """The scene has collapsed, at the place and time of that part; the others go on to the end of the motion."""
    strong = 3 * MOTION
    row = Scene([STIFF, STIFF, WEAK], strong, 0.02, links_of_pairs(p1=POUNDING), analysis="inelastic")
    weak = Scene([WEAK], strong, 0.02, analysis="inelastic")
    pair = Scene([STIFF, STIFF], strong, 0.02, POUNDING, analysis="inelastic")
    run, alone, beside = (solve(each) for each in (row, weak, pair))
    assert run.status == alone.status == "collapsed"
    assert run.time == alone.time
    assert (run.place, alone.place) == ((2, alone.place[1]), (0, alone.place[1]))
    assert np.array_equal(run.drift, np.concatenate((beside.drift, alone.drift)))
    (flag,) = (flag for flag in run.flags if flag.startswith("a storey collapsed"))
    assert flag.startswith("a storey collapsed: b2 storey")


def test_a_part_that_fails_leaves_the_scene_without_numbers() -> None:
    row = scene([STIFF, SOFT, STIFF], links_of_pairs(p1=POUNDING)).built
    failed = pound.solve(row, bounds=(10, 100))
    assert failed.status == "step bound reached"
    assert np.isnan(failed.peaks["shear"]).all()
