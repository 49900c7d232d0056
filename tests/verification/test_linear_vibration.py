"""Linear buildings without neighbours: closed forms and exact stepping, to 1e-9."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, oscillator, shake, shear_building, still
from tests.reference.closed_forms import oscillator_under_ramp
from tests.reference.exponential import march
from tests.reference.modes import modes

pytestmark = pytest.mark.usefixtures("exact_steps_and_series")

TIGHT = 1e-12


@pytest.mark.parametrize("xi", [0.0, 0.05, 0.5])
def test_free_vibration(xi):
    """State at the end and first peak. Fails if beta is halved, or alpha left out."""
    m, w, u0, v0, end = 3e5, 11.0, 0.02, 0.4, 1.3
    scene = Scene((oscillator(m, m * w**2, xi),), (), still(end), ELASTIC)
    found = solve(scene, TIGHT, initial=([[u0]], [[v0]]))
    u, v = oscillator_under_ramp(u0, v0, 0.0, 0.0, w, xi, end)
    assert found.final[0][0][0] == pytest.approx(u, abs=1e-11)
    assert found.final[0][1][0] == pytest.approx(v, abs=1e-10)
    damped = w * math.sqrt(1 - xi**2)
    top = math.atan2(v0, (xi * w * v0 + w**2 * u0) / damped) / damped  # u' = 0
    peak = oscillator_under_ramp(u0, v0, 0.0, 0.0, w, xi, top)[0]
    assert found.buildings[0].displacement_max[0] == pytest.approx(peak, rel=1e-9)
    assert found.buildings[0].shear[0] == pytest.approx(m * w**2 * peak, rel=1e-9)


def test_forced_vibration_under_straight_lines():
    """Closed form from one sample to the next. Fails if the acceleration is held between samples."""
    m, w, xi = 2e5, 9.0, 0.07
    motion = shake(1.0)
    found = solve(Scene((oscillator(m, m * w**2, xi),), (), motion, ELASTIC), TIGHT)
    u, v, a = 0.0, 0.0, motion.acceleration
    for now, after in pairwise(a):
        u, v = oscillator_under_ramp(u, v, now, (after - now) / motion.dt, w, xi, motion.dt)
    assert found.final[0][0][0] == pytest.approx(u, abs=1e-12)
    assert found.final[0][1][0] == pytest.approx(v, abs=1e-11)


def test_peaks_under_a_single_ramp():
    """Undamped under a_g = s t from rest: u = -s (t - sin(w t) / w) / w^2, total acceleration -w^2 u = s (t -
    sin(w t) / w).

    Fails if the floor's acceleration is taken relative to the ground.
    """
    m, w, s, end = 2e5, 8.0, 3.0, 0.5
    scene = Scene((oscillator(m, m * w**2),), (), Motion("ramp", end, np.array([0.0, s * end])), ELASTIC)
    found = solve(scene, TIGHT).buildings[0]
    peak = s * (end - math.sin(w * end) / w)
    assert found.acceleration[0] == pytest.approx(peak, rel=1e-9)
    assert -found.displacement_min[0] == pytest.approx(peak / w**2, rel=1e-9)
    assert found.displacement_max[0] == 0.0


def test_five_storeys_against_exact_stepping():
    """Fails if the couplings of two storeys are exchanged."""
    scene = Scene((shear_building(0.36, 5),), (), shake(2.0), ELASTIC)
    _, u, v = march(scene)
    found = solve(scene, TIGHT)
    assert found.final[0][0] == pytest.approx(u[-1], abs=1e-9 * np.abs(u).max())
    assert found.final[0][1] == pytest.approx(v[-1], abs=1e-9 * np.abs(v).max())
    drift = np.abs(np.diff(u, axis=1, prepend=0.0)).max(axis=0)
    assert (found.buildings[0].drift >= drift * (1 - 1e-9)).all()  # samples may miss the peak, never pass it
    assert found.buildings[0].drift == pytest.approx(drift, rel=0.02)


def test_a_mode_keeps_its_shape_and_period():
    """Undamped, thrown in its second mode, back after a period. Fails if the roof's mass is halved."""
    building = shear_building(0.5, 4, damping=0.0)
    found = modes(building)
    period, shape = found.periods[1], found.shapes[:, 1] / np.abs(found.shapes[:, 1]).max()
    motion = still(period, period / 32)
    end = solve(Scene((building,), (), motion, ELASTIC), TIGHT, initial=([0.01 * shape], [0 * shape])).final[0]
    assert end[0] == pytest.approx(0.01 * shape, abs=1e-11)
    assert end[1] == pytest.approx(0 * shape, abs=1e-9)


def test_a_tail_is_free_vibration():
    """Motion, then free vibration on still ground. Fails if the last slope goes on."""
    motion = shake(0.6)
    scene = Scene((shear_building(0.36),), (), motion, ELASTIC, tail=0.4)
    _, u, v = march(scene)
    end = solve(scene, TIGHT).final[0]
    assert end[0] == pytest.approx(u[-1], abs=1e-9 * np.abs(u).max())
    assert end[1] == pytest.approx(v[-1], abs=1e-9 * np.abs(v).max())
