"""Dampers between floors: a closed form, the event-located reference, every method, and a study."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.laws.damper import Damper
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, INELASTIC, gather, links, oscillator, shake, shear_building, still
from tests.reference import events

C = 2e6


def dampers(c: float = C, floors=(1, 2, 3)) -> tuple[Link, ...]:
    return tuple(Link(0, j, j, Damper(0.05, c)) for j in floors)


def test_two_free_masses():
    """They lose their relative speed as exp(-c t / m'), and the damper its energy. Fails with a spring in the force."""
    m1, m2, speed, t = 2e5, 3e5, 0.3, 0.2
    reduced = m1 * m2 / (m1 + m2)
    scene = Scene((oscillator(m1, 1e-9), oscillator(m2, 1e-9)), dampers(floors=(1,)), still(t), ELASTIC)
    found = solve(scene, 1e-12, initial=([[0.0], [0.0]], [[speed], [0.0]]))
    left = math.exp(-C * t / reduced)
    assert found.final[0][1][0] - found.final[1][1][0] == pytest.approx(speed * left, rel=1e-11)
    assert found.links.peak_force[0] == pytest.approx(C * speed, rel=1e-12)
    assert found.links.impulse[0] == pytest.approx(reduced * speed * (1 - left), rel=1e-11)
    assert found.links.max_closing[0] == pytest.approx(speed * reduced / C * (1 - left), rel=1e-11)
    assert found.energy["links"] == pytest.approx(reduced * speed**2 / 2 * (1 - left**2), rel=1e-11)


@pytest.mark.parametrize(("pounds", "analysis"), [(False, INELASTIC), (True, ELASTIC), (True, INELASTIC)])
def test_against_the_reference(pounds, analysis):
    """Dormand-Prince 8 from event to event, with and without pounding at the same floors."""
    two = shear_building(0.36), shear_building(0.60)
    joined = (*dampers(floors=(2, 3)), *(links("pounding", 0.004) if pounds else ()))
    scene = Scene(two, joined, shake(1.0, 6.0), analysis)
    expected, found = events.integrate(scene), solve(scene, 1e-12)
    for name in ("shear", "drift", "acceleration", "displacement_max", "displacement_min"):
        assert gather(found, name) == pytest.approx(getattr(expected, name), rel=1e-7, abs=1e-13), name
    for name in ("peak_force", "max_closing", "impulse"):
        value = getattr(expected, name)
        assert getattr(found.links, name) == pytest.approx(value, rel=1e-7, abs=1e-8 * np.abs(value).max()), name
    assert found.links.impacts.tolist() == expected.impacts.tolist()
    assert (expected.impacts.sum() > 0) == pounds
    assert abs(found.energy["residual"]) < 1e-10


@pytest.mark.parametrize("c", [1.0, 1e5, 1e8])
@pytest.mark.parametrize("method", ["exponential", "rk4-events", "newmark"])
def test_methods_agree(method, c):
    """A linear scene: exact steps run it too. Fails if a link without a spring has no matrix."""
    scene = Scene((shear_building(0.36), shear_building(0.60)), dampers(c), shake(0.6), ELASTIC)
    exact = solve(scene, 1e-11, "taylor")
    told = {} if method == "exponential" else {"time_step": 5e-5}
    found = solve(scene, 1e-9, method, **told)
    assert found.status == "done"
    assert gather(found, "drift") == pytest.approx(gather(exact, "drift"), rel=1e-3 if method == "newmark" else 1e-8)
    assert found.links.peak_force == pytest.approx(exact.links.peak_force, rel=1e-2 if method == "newmark" else 1e-7)


def test_a_damper_that_closes_more_than_the_gap_is_flagged():
    """Unless its floors may strike. Fails if the blow that is left out is not told."""
    two, motion = (shear_building(0.36), shear_building(0.60)), shake(0.6)
    tight = tuple(Link(0, j, j, Damper(1e-5, 1e5)) for j in (1, 2, 3))
    assert any("damper closes more than the gap" in flag for flag in solve(Scene(two, tight, motion, ELASTIC)).flags)
    strikes = (*tight, *links("pounding", 0.05))
    assert not solve(Scene(two, strikes, motion, ELASTIC)).flags
