"""Stiffnesses from periods and Rayleigh factors, against eigenvalues found another way."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from pounding_cli.model.stiffness import frequencies, rayleigh_factors, stiffness_for_period


def dense(stiffness):
    above = np.append(stiffness[1:], 0.0)
    return np.diag(stiffness + above) - np.diag(above[:-1], 1) - np.diag(above[:-1], -1)


def test_uniform_building_has_the_sine_frequencies():
    """w_i = 2 sqrt(k/m) sin((2i - 1) pi / (4n + 2)) ; fails if the roof hangs on a storey above."""
    n, k, m = 7, 3e8, 2e5
    i = np.arange(1, n + 1)
    expected = 2 * math.sqrt(k / m) * np.sin((2 * i - 1) * np.pi / (4 * n + 2))
    assert frequencies(np.full(n, m), np.full(n, k)) == pytest.approx(expected, rel=1e-12)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(1e4, 1e7), min_size=1, max_size=12), st.floats(0.05, 5.0), st.floats(0.1, 3.0))
def test_the_period_asked_for_is_the_period_found(mass, period, taper):
    """Fails if the scale is not squared, or the taper runs from the top down."""
    k = stiffness_for_period(mass, period, taper)
    lowest = eigh(dense(k), np.diag(mass), eigvals_only=True)[0]
    assert 2 * math.pi / math.sqrt(lowest) == pytest.approx(period, rel=1e-9)
    if len(mass) > 1:
        assert k[-1] / k[0] == pytest.approx(taper, rel=1e-12)
        assert np.diff(k) == pytest.approx(np.full(len(mass) - 1, np.diff(k)[0]), rel=1e-6, abs=1e-9 * k[0])


@pytest.mark.parametrize("n", [1, 2, 5])
def test_rayleigh_damping_of_the_first_two_modes(n):
    """x^T C x = 2 xi w x^T M x in both modes; with one storey half from each. Fails if beta is doubled."""
    mass, k = np.linspace(1.0, 2.0, n) * 1e5, np.linspace(3.0, 1.0, n) * 1e8
    alpha, beta = rayleigh_factors(mass, k, 0.05)
    squares, shapes = eigh(dense(k), np.diag(mass))
    damping = shapes.T @ (alpha * np.diag(mass) + beta * dense(k)) @ shapes
    for i in range(min(n, 2)):
        assert damping[i, i] == pytest.approx(2 * 0.05 * math.sqrt(squares[i]), rel=1e-12)
    if n == 1:
        assert alpha == pytest.approx(beta * squares[0], rel=1e-12)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: stiffness_for_period([1.0, -1.0], 0.5, 1.0), "mass"),
        (lambda: stiffness_for_period([1.0], 0.0, 1.0), "period"),
        (lambda: stiffness_for_period([1.0, 1.0], 0.5, 0.0), "taper"),
        (lambda: stiffness_for_period([], 0.5, 1.0), "one value per storey"),
        (lambda: rayleigh_factors([1.0], [1.0], 1.0), "damping"),
        (lambda: rayleigh_factors([1.0], [1.0], math.nan), "damping"),
        (lambda: frequencies([1.0, 1.0], [1.0]), "one of each per storey"),
        (lambda: frequencies([1.0], [math.inf]), "stiffness"),
    ],
)
def test_impossible_input_is_refused_by_name(call, word):
    with pytest.raises(ValueError, match=word):
        call()
