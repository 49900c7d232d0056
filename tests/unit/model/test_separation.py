"""Rules for the separation of neighbours, against values worked out by hand or published."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.model.building import Building
from pounding_cli.model.separation import (
    absolute_sum,
    asce7_displacement,
    cross_correlation,
    double_difference,
    en1998_displacement,
    en1998_separation,
    first_mode_damping,
    gb50011_width,
    root_of_squares,
)


@pytest.mark.parametrize(("left", "right", "rho"), [(0.36, 0.60, 0.0350), (0.9, 1.0, 0.4730), (0.5, 0.5, 1.0)])
def test_correlation_of_two_oscillators(left, right, rho):
    assert cross_correlation(left, right) == pytest.approx(rho, abs=5e-5)


@pytest.mark.parametrize(("periods", "damping"), [((0.36, 0.6), (0.02, 0.10)), ((1.0, 0.9), (0.08, 0.03))])
def test_correlation_is_that_under_white_noise(periods, damping):
    """The integral over the frequencies of both transfer functions. Fails if the two damping ratios change places."""
    w = np.linspace(0.0, 2000.0, 4_000_001)
    one, other = (
        1 / ((2 * np.pi / period) ** 2 - w**2 + 2j * ratio * 2 * np.pi / period * w)
        for period, ratio in zip(periods, damping, strict=True)
    )
    across = (one * other.conj()).real.sum()
    alone = np.sqrt((abs(one) ** 2).sum() * (abs(other) ** 2).sum())
    assert cross_correlation(*periods, *damping) == pytest.approx(across / alone, rel=1e-4)


def test_correlation_does_not_depend_on_which_is_left():
    assert cross_correlation(0.36, 0.6, 0.02, 0.05) == pytest.approx(cross_correlation(0.6, 0.36, 0.05, 0.02))


def test_rules_of_peaks():
    assert absolute_sum(-3.0, 4.0) == 7
    assert root_of_squares(-3.0, 4.0) == 5
    assert double_difference(3.0, 4.0, [0.0, 0.5, 1.0]) == pytest.approx([5.0, np.sqrt(13.0), 1.0])


def test_displacements_of_codes():
    """ASCE/SEI 7-16, eq. 12.12-1; EN 1998-1:2004, eq. 4.23 and 4.4.2.7(2) and (3)."""
    assert asce7_displacement(0.02, 5.5, 1.25) == pytest.approx(0.088)
    assert en1998_displacement(-0.02, 3.9) == pytest.approx(0.078)
    assert en1998_separation(0.03, 0.04, [False, True]) == pytest.approx([0.05, 0.035])


@pytest.mark.parametrize(
    ("height", "intensity", "structure", "width"),
    [
        (15, 9, "frame", 0.1),
        (20, 6, "frame", 0.12),
        (23, 7, "frame", 0.14),
        (30, 8, "frame", 0.20),
        (30, 9, "frame", 0.26),
        (16, 8, "frame", 0.12),
        (45, 8, "frame-wall", 0.21),
        (45, 8, "wall", 0.15),
        (30, 8, "wall", 0.1),
    ],
)
def test_joints_of_gb50011(height, intensity, structure, width):
    assert gb50011_width(height, intensity, structure) == pytest.approx(width)


def test_damping_of_the_first_mode():
    one = np.ones(1)
    building = Building("one", 1e5 * one, 3 * one, 4e6 * one, 1e9 * one, 0 * one, alpha=0.5, beta=0.01)
    omega = np.sqrt(40.0)
    assert first_mode_damping(building) == pytest.approx(0.5 * (0.5 / omega + 0.01 * omega))
