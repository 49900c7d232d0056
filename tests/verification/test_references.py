"""The references against one another and against closed forms, so that they are worth checking against."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, oscillator, pair, shake, still
from tests.reference import closed_forms, events, exponential


def test_ramp_response_solves_its_equation():
    """u'' + 2 xi w u' + w^2 u + a + s t = 0 by differences. Fails if c0 loses its damping term."""
    args = (0.02, -0.3, 1.5, 4.0, 9.0, 0.07)
    assert closed_forms.oscillator_under_ramp(*args, 0.0) == pytest.approx((0.02, -0.3), rel=1e-14)
    t, h = 0.31, 1e-4
    (before, _), (u, v), (after, _) = (closed_forms.oscillator_under_ramp(*args, x) for x in (t - h, t, t + h))
    assert (after - before) / (2 * h) == pytest.approx(v, rel=1e-6)
    bend = (after - 2 * u + before) / h**2
    assert bend + 2 * 0.07 * 9 * v + 81 * u + 1.5 + 4 * t == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize("foundation", [None, FOUNDATION])
def test_events_against_the_exponential(foundation):
    """A connected elastic pair at its last sample. Fails if a dashpot is left out of either."""
    scene = pair("connector", 0.05, shake(0.6), foundation=foundation)
    _, u, v = exponential.march(scene)
    floors = [0, 1, 2, 3, 4, 5] if foundation is None else [0, 1, 2, 5, 6, 7]
    found = events.integrate(scene)
    assert found.displacement == pytest.approx(u[-1, floors], rel=1e-10, abs=1e-12)
    assert found.velocity == pytest.approx(v[-1, floors], rel=1e-10, abs=1e-11)


@pytest.mark.parametrize("cut", [False, True])
def test_events_against_the_closed_impact(cut):
    """Two all but free masses. Fails if the contact ends a step late."""
    s, xi, m1, m2, v0 = 2e9, 0.2154, 2e5, 3e5, 0.6
    impact = closed_forms.kelvin_voigt(s, xi, m1 * m2 / (m1 + m2), v0, cut)
    scene = Scene(
        (oscillator(m1, 1e-3), oscillator(m2, 1e-3)),
        (Link(0, 1, 1, Pounding(0.01, s, xi, cut)),), still(0.1), ELASTIC,
    )  # fmt: skip
    found = events.integrate(scene, ([[0.0], [0.0]], [[v0], [0.0]]))
    assert found.velocity[1] - found.velocity[0] == pytest.approx(impact.rebound * v0, rel=1e-9)
    assert found.peak_force[0] == pytest.approx(impact.peak_force, rel=1e-8)
    assert found.max_closing[0] - 0.01 == pytest.approx(impact.compression, rel=1e-8)
    assert found.contact_time[0] == pytest.approx(impact.time, rel=1e-8)
    assert found.impacts[0] == 1


def test_impact_numbers_of_the_law():
    """e = 0.5: peak force 0.816 v0 sqrt(s m'); tension cut e = 0.55. Fails if xi = e."""
    xi = math.log(2) / math.hypot(math.pi, math.log(2))
    impact = closed_forms.kelvin_voigt(1.0, xi, 1.0, 1.0)
    assert impact.rebound == pytest.approx(0.5, rel=1e-12)
    assert round(impact.peak_force, 3) == 0.816
    assert round(closed_forms.kelvin_voigt(1.0, xi, 1.0, 1.0, tension_cut=True).rebound, 2) == 0.55


@pytest.mark.parametrize(("kind", "gap"), [("pounding", 0.002), ("infill", 0.01)])
def test_events_keep_the_energy(kind, gap):
    """Work in = kinetic + springs + dashpots + storeys + links. Fails if a force acts on one floor only."""
    scene = pair(kind, gap, shake(0.5), INELASTIC, FOUNDATION)
    e = events.integrate(scene).energy
    out = sum(e[name] for name in ("kinetic", "springs", "damping", "storeys", "links"))
    # Foundation springs store energy; its dashpots are in `damping`.
    assert out == pytest.approx(e["input"], rel=1e-9)


def test_events_follow_the_bilinear_loop():
    """First two reversals of an undamped throw. Fails if the plastic drift is kept through a yield."""
    m, k, vy, a, v0 = 2e5, 2e7, 3e5, 0.4, 0.5
    expected = closed_forms.bilinear_throw(m, k, vy, a, v0)
    building = oscillator(m, k, 0.0, vy, a)
    found = events.integrate(Scene((building,), (), still(1.2), INELASTIC), ([[0.0]], [[v0]]))
    assert found.displacement_max[0] == pytest.approx(expected.first, rel=1e-9)
    assert found.displacement_min[0] == pytest.approx(expected.second, rel=1e-9)
    assert found.shear[0] == pytest.approx(expected.shear, rel=1e-9)


def test_events_converge():
    """Half the step moves no peak of a hard scene by 1e-9. Fails if events are taken at a step's end."""
    scene = pair("pounding", 0.0, shake(0.3), INELASTIC)
    coarse, fine = events.integrate(scene), events.integrate(scene, per_radian=0.125)
    assert coarse.shear == pytest.approx(fine.shear, rel=1e-9)
    assert coarse.peak_force == pytest.approx(fine.peak_force, rel=1e-9)
    assert np.array_equal(coarse.impacts, fine.impacts)
