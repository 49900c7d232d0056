"""Sway and rocking: the rigid limit, the coupled modes, pounding on soft ground."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.model.foundation import Foundation
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, gather, pair, shake, shear_building, still
from tests.reference.exponential import march
from tests.reference.modes import matrices, modes

pytestmark = pytest.mark.usefixtures("exact_steps_and_series")


@pytest.mark.parametrize(
    "foundation",
    [
        FOUNDATION,
        Foundation(2e5, 1e9, 1e7, rocks=False),
        Foundation(inertia=1e7, rocking_stiffness=1e11, rocking_damping=1e8, sways=False),
    ],
)
def test_shaken_building_against_exact_stepping(foundation):
    """Sway, rocking and both. Fails if damping acts on u, or the base misses the storey's damping."""
    scene = Scene((shear_building(0.36, 4, foundation),), (), shake(1.5), ELASTIC)
    _, u, v = march(scene)
    found = solve(scene, 1e-12)
    assert found.final[0][0] == pytest.approx(u[-1, :4], abs=1e-9 * np.abs(u).max())
    assert found.final[0][1] == pytest.approx(v[-1, :4], abs=1e-9 * np.abs(v).max())
    base = np.abs(u).max(axis=0)[4:]
    peaks = [found.buildings[0].sway] * foundation.sways + [found.buildings[0].rocking] * foundation.rocks
    assert peaks == pytest.approx(base, rel=0.02)  # samples may miss the peak, never pass it
    assert (np.array(peaks) >= base * (1 - 1e-9)).all()


def test_rigid_limit_is_the_fixed_base():
    """Ever stiffer springs: the difference goes as 1 / stiffness. Fails if a rigid base still moves."""
    motion, differences = shake(0.6), []
    fixed = solve(pair("pounding", 0.005, motion, INELASTIC), 1e-11)
    for factor in (1e2, 1e3):
        stiff = Foundation(2e5, 1e9 * factor, 0.0, 1e7, 1e11 * factor, 0.0)
        found = solve(pair("pounding", 0.005, motion, INELASTIC, stiff), 1e-11)
        differences.append(np.abs(gather(found, "shear") / gather(fixed, "shear") - 1).max())
    assert differences[1] < 0.2 * differences[0] < 0.02
    locked = Foundation(sways=False, rocks=False)
    found = solve(pair("pounding", 0.005, motion, INELASTIC, locked), 1e-11)
    assert gather(found, "shear") == pytest.approx(gather(fixed, "shear"), rel=1e-9)
    assert gather(found, "acceleration") == pytest.approx(gather(fixed, "acceleration"), rel=1e-8)


@pytest.mark.parametrize("end", [0.37, 1.9])
def test_free_vibration_is_the_sum_of_the_coupled_modes(end):
    """Undamped, floors thrown, base at rest: q(t) = sum x_i (x_i M q0 cos(w_i t) + x_i M q0' sin(w_i t) /
    w_i), w_i by scipy.

    Fails if the floors' shears reach the rocking with the wrong lever.
    """
    plain = shear_building(0.36, 3, damping=0.0)
    free = replace(FOUNDATION, sway_damping=0.0, rocking_damping=0.0)
    building = replace(plain, foundation=free)
    found, mass = modes(building), matrices(building).mass
    u0, v0 = np.array([0.01, -0.004, 0.002]), np.array([0.1, 0.3, -0.2])
    w, x = 2 * np.pi / found.periods, found.shapes
    shares, speeds = (x.T @ mass @ np.append(z, [0.0, 0.0]) for z in (u0, v0))
    expected = x @ (shares * np.cos(w * end) + speeds * np.sin(w * end) / w)
    rates = x @ (speeds * np.cos(w * end) - shares * w * np.sin(w * end))
    scene = Scene((building,), (), still(end, end / 50), ELASTIC)
    u, v = solve(scene, 1e-12, initial=([u0], [v0])).final[0]
    assert u == pytest.approx(expected[:3], abs=1e-9 * np.abs(expected[:3]).max())
    assert v == pytest.approx(rates[:3], abs=1e-9 * np.abs(rates[:3]).max())
