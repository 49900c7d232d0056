"""Bilinear storeys: skeleton, unloading and loop area from energy balances."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, INELASTIC, oscillator, still
from tests.reference.closed_forms import bilinear_throw

M, K, VY, A, V0 = 2e5, 2e7, 3e5, 0.4, 0.5


def test_throw_of_an_undamped_storey():
    """Both reversals and the skeleton's shear. Fails if unloading is softened or the width is not 2 Vy."""
    expected = bilinear_throw(M, K, VY, A, V0)
    # The friction block (1 - a) Vy times the way it slid is the same loss.
    slid = (expected.first - VY / K) + (expected.first - 2 * VY / K - expected.second)
    assert expected.loop == pytest.approx((1 - A) * VY * slid, rel=1e-12)
    scene = Scene((oscillator(M, K, 0.0, VY, A),), (), still(0.8), INELASTIC)
    response = solve(scene, 1e-12, initial=([[0.0]], [[V0]]))
    found = response.buildings[0]
    assert response.energy["hysteresis"] == pytest.approx(expected.loop, rel=1e-9)
    assert expected.second < -2 * VY / K / 2  # it yields the other way too
    assert found.displacement_max[0] == pytest.approx(expected.first, rel=1e-9)
    assert found.displacement_min[0] == pytest.approx(expected.second, rel=1e-9)
    assert found.shear[0] == pytest.approx(expected.shear, rel=1e-9)
    assert found.ductility[0] == pytest.approx(expected.first / (VY / K), rel=1e-9)


def test_elastic_analysis_never_yields_but_counts_the_same_ductility():
    """mu = drift / yield drift in elastic runs too. Fails if the elastic run is given the yield shear."""
    scene = Scene((oscillator(M, K, 0.0, VY, A),), (), still(0.8), ELASTIC)
    found = solve(scene, 1e-12, initial=([[0.0]], [[V0]])).buildings[0]
    peak = V0 * np.sqrt(M / K)
    assert found.shear[0] == pytest.approx(K * peak, rel=1e-9)
    assert found.ductility[0] == pytest.approx(K * peak / VY, rel=1e-9)


def test_perfectly_plastic_residual():
    """Hardening 0: drift from the work done, then an elastic swing of Vy. Fails if hardening cannot be 0."""
    scene = Scene((oscillator(M, K, 0.0, VY, 0.0),), (), still(2.0), INELASTIC)
    found = solve(scene, 1e-12, initial=([[0.0]], [[V0]]))
    dy = VY / K
    first = dy + (M * V0**2 / 2 - VY * dy / 2) / VY
    b = found.buildings[0]
    assert b.displacement_max[0] == pytest.approx(first, rel=1e-9)
    assert b.shear[0] == pytest.approx(VY, rel=1e-12)
    # Afterwards it swings elastically, just reaching -Vy, about the plastic drift first - dy.
    assert found.final[0][0][0] - (first - dy) == pytest.approx(0.0, abs=dy * (1 + 1e-9))
    swing = (found.final[0][0][0] - (first - dy)) ** 2 * K + found.final[0][1][0] ** 2 * M
    assert swing == pytest.approx(K * dy**2, rel=1e-8)
