"""Kelvin-Voigt impact of two all but free masses: eqs (5) to (7) in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.laws.dashpot import DashpotLaw, damping_ratio
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, oscillator, still
from tests.reference.closed_forms import kelvin_voigt

M1, M2, S, V0, GAP = 2e5, 3e5, 2e9, 0.6, 0.01
REDUCED = M1 * M2 / (M1 + M2)


def collide(xi, tension_cut=False, **law):
    link = Link(0, 1, 1, Pounding(GAP, S, xi, tension_cut, **law))
    scene = Scene((oscillator(M1, 1e-3), oscillator(M2, 1e-3)), (link,), still(0.12), ELASTIC)
    return solve(scene, 1e-12, initial=([[0.0], [0.0]], [[V0], [0.0]]))


def check(found, impact):
    links, (left, right) = found.links, [v[0] for _, v in found.final]
    assert right - left == pytest.approx(impact.rebound * V0, rel=1e-9)
    assert M1 * left + M2 * right == pytest.approx(M1 * V0, rel=1e-9)
    assert links.peak_force[0] == pytest.approx(impact.peak_force, rel=1e-9)
    assert links.max_closing[0] - GAP == pytest.approx(impact.compression, rel=1e-9)
    assert links.contact_time[0] == pytest.approx(impact.time, rel=1e-9)
    assert links.impulse[0] == pytest.approx(REDUCED * V0 * (1 + impact.rebound), rel=1e-9)
    assert links.impacts[0] == 1


@pytest.mark.parametrize("e", [0.3, 0.5, 0.8])
def test_printed_law(e):
    """Rebound, force, compression, duration, impulse. Fails if the dashpot lacks its 2, or m' is m1."""
    found, xi = collide(damping_ratio(e)), damping_ratio(e)
    impact = kelvin_voigt(S, xi, REDUCED, V0)
    assert impact.rebound == pytest.approx(e, rel=1e-12)
    check(found, impact)


def test_half_restitution_in_the_field_s_number():
    """Peak force 0.816 v0 sqrt(s m') at e = 0.5. Fails if the peak leaves the dashpot out (0.70)."""
    peak = collide(damping_ratio(0.5)).links.peak_force[0]
    assert round(peak / (V0 * math.sqrt(S * REDUCED)), 3) == 0.816


@pytest.mark.parametrize("e", [0.5, 0.8])
def test_tension_cut(e):
    """The force ends, not the compression: e = 0.5 rebounds at 0.55. Fails if the cut waits for v = 0."""
    impact = kelvin_voigt(S, damping_ratio(e), REDUCED, V0, tension_cut=True)
    check(collide(damping_ratio(e), tension_cut=True), impact)


def test_undamped_impact_loses_nothing():
    """e = 1: the peak is v0 sqrt(s m') and the masses part as they met. Fails if any damping is left."""
    found = collide(0.0)
    left, right = (v[0] for _, v in found.final)
    assert right - left == pytest.approx(V0, rel=1e-10)
    assert found.links.peak_force[0] == pytest.approx(V0 * math.sqrt(S * REDUCED), rel=1e-9)
    assert found.links.contact_time[0] == pytest.approx(math.pi * math.sqrt(REDUCED / S), rel=1e-9)


def test_dashpot_as_eq_7_is_printed():
    """2 xi sqrt(s (m1 + m2) / (m1 m2)): damping ratio xi / m'. Fails if both laws are the same."""
    xi = damping_ratio(0.5)
    check(collide(xi, dashpot=DashpotLaw.PRINTED), kelvin_voigt(S, xi / REDUCED, REDUCED, V0))


def test_a_blow_within_one_step_of_the_motion():
    """A slow swing reaches the gap half-way between two samples, 0.2 s apart, and would be back before the second.

    Fails if contact is looked for at the ends of steps."""
    swing, omega, xi, stiff = 0.05, 2 * math.pi, damping_ratio(0.5), 1e6 * S
    link = Link(0, 1, 1, Pounding(0.9 * swing, stiff, xi))
    scene = Scene((oscillator(M1, M1 * omega**2), oscillator(M2, 1e-3)), (link,), still(0.6, dt=0.2), ELASTIC)
    found = solve(scene, 1e-9, initial=([[-swing], [0.0]], [[0.0], [0.0]]))
    impact = kelvin_voigt(stiff, xi, REDUCED, swing * omega * math.sqrt(1 - 0.9**2))
    assert found.links.impacts[0] == 1
    assert found.links.peak_force[0] == pytest.approx(impact.peak_force, rel=1e-3)


def test_a_gap_that_never_closes_never_presses():
    """Fails if the gap is ignored."""
    scene = Scene(
        (oscillator(M1, M1 * 400.0), oscillator(M2, M2 * 400.0)),
        (Link(0, 1, 1, Pounding(0.0301, S, 0.2)),), still(1.0), ELASTIC,
    )  # fmt: skip
    found = solve(scene, 1e-12, initial=([[0.0], [0.0]], [[V0], [0.0]]))
    assert found.links.max_closing[0] == pytest.approx(0.03, rel=1e-10)
    assert (found.links.impacts[0], found.links.peak_force[0], found.links.contact_time[0]) == (0, 0.0, 0.0)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize("tension_cut", [False, True])
@pytest.mark.parametrize("push", [1.0, -1.0])
def test_floors_in_touch_press_from_the_start_or_not_at_all(push, tension_cut, accuracy):
    """Fifth floors of undamped buildings at rest close by a (P_left - P_right) t^12 / 12! to begin with, P the product
    of stiffness over mass of the storeys below: lost in the last digits of their displacements for milliseconds. Fails
    if contact begins where a double first tells it."""
    tower = lambda k: Building("tower", 5 * [2e5], 5 * [3.0], 5 * [k], 5 * [math.inf], 5 * [0.0], 0.0, 0.0)  # noqa: E731
    stiff, soft = tower(8e8), tower(2e8)
    link = Link(0, 5, 5, Pounding(0.0, S, 0.2, tension_cut))
    motion = Motion("push", 1e-3, np.full(21, push))
    found = solve(Scene((stiff, soft), (link,), motion, ELASTIC), accuracy).links
    assert found.contact_time[0] == pytest.approx(0.02 if push > 0 else 0.0, rel=1e-12)
    assert found.peak_force[0] > 0 or push < 0
