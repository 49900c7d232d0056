"""Rows of four buildings and more, solved island by island, against the same rows solved as one and against the
event-located reference.

Where samples are 50 ms apart most of a row is joined beforehand; 5 ms apart, islands that were begun apart come to
touch and are solved again."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.solve.taylor import ALWAYS_ONE_ISLAND
from tests.helpers.scenes import ELASTIC, INELASTIC, gather, links, shake, shear_building
from tests.reference import events

PERIODS = (0.36, 0.60, 0.30, 0.60, 0.45, 0.36)
BUILDING = ("shear", "drift", "acceleration", "displacement_max", "displacement_min")
LINK = ("peak_force", "max_closing", "impulse", "contact_time")


def row(gap: float, analysis, count: int = 6, dt: float = 0.05, duration: float = 3.0, kind: str = "pounding") -> Scene:
    buildings = tuple(shear_building(period, 4) for period in PERIODS[:count])
    joined = tuple(link for left in range(count - 1) for link in links(kind, gap, (1, 2, 3, 4), left))
    return Scene(buildings, joined, shake(duration, 5.0, dt=dt), analysis)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("dt", [0.005, 0.05])
@pytest.mark.parametrize(
    ("kind", "gap"), [("pounding", 0.0), ("pounding", 0.003), ("pounding", 0.02), ("infill", 0.04)]
)
def test_islands_equal_the_row(kind, gap, dt, analysis):
    """Every peak and count. Fails if neighbours that meet are left apart, or if an island that is solved again does not
    begin where it began."""
    scene = row(gap, analysis, dt=dt, kind=kind)
    apart, whole = solve(scene, 1e-10, watch=True), solve(scene, 1e-12, all_effects=True, watch=True)
    assert apart.status == whole.status == "done"
    assert any(sentence.startswith("the rest of the row") for sentence in apart.dropped)
    assert not any(sentence.startswith("the rest of the row") for sentence in whole.dropped)
    assert apart.steps != whole.steps
    assert apart.links.impacts.tolist() == whole.links.impacts.tolist()
    assert whole.links.impacts.sum() > 5
    assert apart.events >= whole.events  # storeys of two buildings that yield at one instant count once in a row
    for name in BUILDING:
        assert gather(apart, name) == pytest.approx(gather(whole, name), rel=1e-7), name
    for name in LINK:
        found, expected = getattr(apart.links, name), getattr(whole.links, name)
        assert found == pytest.approx(expected, rel=1e-7, abs=1e-8 * np.abs(expected).max()), name
    for joule in ("input", "damping", "hysteresis", "links"):
        assert apart.energy[joule] == pytest.approx(whole.energy[joule], abs=1e-8 * whole.energy["input"]), joule
    assert abs(apart.energy["residual"]) < 1e-9
    for found, expected in zip(apart.samples, whole.samples, strict=True):
        assert found == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
def test_a_row_against_the_reference(analysis):
    """Dormand-Prince 8 from event to event. Fails with any of the above."""
    scene = row(0.003, analysis, count=ALWAYS_ONE_ISLAND + 1, dt=0.005, duration=0.8)
    expected, found = events.integrate(scene), solve(scene, 1e-12)
    assert found.links.impacts.tolist() == expected.impacts.tolist()
    assert expected.impacts.sum() > 10
    for name in BUILDING:
        assert gather(found, name) == pytest.approx(getattr(expected, name), rel=1e-8, abs=1e-12), name
    for name in LINK:
        assert getattr(found.links, name) == pytest.approx(getattr(expected, name), rel=1e-8, abs=1e-12), name


def test_a_mirrored_row_moves_alike():
    """Under the mirrored motion. Fails if what happens depends on the order in which islands are solved."""
    scene = row(0.02, INELASTIC, count=5, dt=0.005)
    turned = Scene(
        scene.buildings[::-1],
        tuple(link for left in range(4) for link in links("pounding", 0.02, (1, 2, 3, 4), left)),
        type(scene.motion)("mirrored", scene.motion.dt, -scene.motion.acceleration),
        INELASTIC,
    )
    one, other = solve(scene, 1e-11), solve(turned, 1e-11)
    assert one.links.impacts.reshape(4, 4).sum(1).tolist() == other.links.impacts.reshape(4, 4).sum(1)[::-1].tolist()
    for a, b in zip(one.buildings, other.buildings[::-1], strict=True):
        assert a.drift == pytest.approx(b.drift, rel=1e-8)
        assert a.displacement_max == pytest.approx(-b.displacement_min, rel=1e-8)


def test_what_stands_apart_takes_its_own_steps_two_by_two():
    """Buildings too far apart to meet take the steps that every two of them take alone, but for those on which two come
    closer than ever before. Fails if an event anywhere ends the step of all, or if each goes its own way."""
    short, long = (row(0.5, INELASTIC, count=count, dt=0.005) for count in (4, 6))
    few, many = solve(short, 1e-6), solve(long, 1e-6)
    twos = (long.buildings[0:2], long.buildings[2:4], long.buildings[4:6])
    alone = [solve(Scene(two, (), long.motion, INELASTIC), 1e-6, method="taylor").steps for two in twos]
    assert many.links.impacts.sum() == 0
    assert sum(alone[:2]) <= few.steps < 1.2 * sum(alone[:2])
    assert sum(alone) <= many.steps < 1.2 * sum(alone)
