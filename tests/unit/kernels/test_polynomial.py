"""First crossings and largest values of polynomials against numpy's roots."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from pounding_cli.kernels.polynomial import NEVER, first_crossing, highest
from pounding_cli.kernels.simd import pointer


@njit
def crossing(c, end):
    return first_crossing(pointer(c), c.size - 1, end)


@njit
def peak(c, end, best, absolute):
    return highest(pointer(c), c.size - 1, end, best, absolute)


def true_crossing(c: np.ndarray, end: float) -> float:
    roots = np.roots(c[::-1])
    real = np.sort(roots[np.abs(roots.imag) < 1e-12 * (1 + np.abs(roots))].real)
    return next((r for r in real if 0 < r <= end), NEVER)


coefficients = st.lists(st.floats(-3, 3).map(lambda x: round(x, 3)), min_size=2, max_size=9)


@settings(max_examples=400, deadline=None)
@given(coefficients, st.sampled_from([0.1, 0.5, 1.0]))
def test_first_crossing_is_the_first_root(tail, end):
    """Fails if the march passes a root, or Newton leaves its bracket."""
    c = np.array([1.0, *tail])
    found, true = crossing(c, end), true_crossing(c, end)
    if true == NEVER:
        grid = np.polyval(c[::-1], np.linspace(0, end, 2001)).min()
        assert found == NEVER or grid < 1e-5  # a tangency may count as one
    else:
        scale = np.abs(np.polyval(np.polyder(c[::-1]), true)) + 1e-3
        assert found == pytest.approx(true, abs=1e-9 / scale**2)


def test_two_roots_close_together_are_not_stepped_over():
    c = np.polynomial.polynomial.polyfromroots([0.3, 0.3001])
    assert crossing(c, 1.0) == pytest.approx(0.3, abs=1e-12)


@pytest.mark.parametrize("multiplicity", [3, 5, 7])
@pytest.mark.parametrize("root", [0.3, 0.5, 0.77])
def test_a_root_of_several_in_one_is_found(root, multiplicity):
    """Steps that never pass a root become too short there. Fails if the search then says "never", or that it has
    arrived: it would be off by up to a fifth of a step."""
    c = np.polynomial.polynomial.polyfromroots([root] * multiplicity) * -1.0
    for more in ([1.0], [1.0, 0.3, 0.2]):
        found = crossing(np.polynomial.polynomial.polymul(c, more), 1.0)
        # Within what the digits of the polynomial tell: 1e-16 is the value, its root the distance.
        assert found == pytest.approx(root, abs=2 * 1e-16 ** (1 / multiplicity))


@pytest.mark.parametrize(
    ("c", "expected"),
    [
        ([0.0, 0.0, 0.0], NEVER),  # identically zero: nothing happens
        ([0.0, -1.0, 5.0], 0.0),  # the first derivative decides: at once
        ([0.0, 0.0, -1e-3, 9.0], 0.0),  # the second, if the first is zero
        ([0.0, 1.0, -2.0], 0.5),  # leaves zero upward and comes back
        ([0.0, 0.0, 1.0, -4.0], 0.25),
    ],
)
def test_a_start_at_zero_is_decided_by_the_first_derivative_that_is_not(c, expected):
    assert crossing(np.array(c), 1.0) == pytest.approx(expected, abs=1e-14)


@settings(max_examples=300, deadline=None)
@given(coefficients, st.booleans(), st.sampled_from([0.2, 1.0]))
def test_highest_is_the_largest_value_inside(tail, absolute, end):
    """Fails if a turning point between the ends is missed."""
    c = np.array([0.5, *tail])
    measure = np.abs if absolute else (lambda x: x)
    ends = measure(np.polyval(c[::-1], np.array([0.0, end]))).max()
    turns = np.roots(np.polyder(c[::-1])) if np.any(c[1:]) else np.array([])
    inside = [t.real for t in turns if abs(t.imag) < 1e-9 and 0 < t.real < end]
    true = max([ends, *measure(np.polyval(c[::-1], np.array(inside)))])
    assert peak(c, end, ends, absolute) == pytest.approx(true, abs=1e-6)


def test_two_turning_points_between_slopes_of_one_sign():
    """10 s (s - 1/2) (s - 1) rises at both ends and is highest between. Fails if end slopes alone decide."""
    c = np.array([0.0, 5.0, -15.0, 10.0])
    assert peak(c, 1.0, 0.0, False) == pytest.approx(10 * np.sqrt(3) / 36, abs=1e-12)


@pytest.mark.parametrize(
    ("c", "end", "top"),
    [
        ([0.5, 0.0, 0.125, -1.0], 1.0, 0.5 + 0.125**3 * 4 / 27),  # s^2 (1 - 8 s) / 8 turns at 1/12
        ([0.0, 1.0, -1.0], 1.0, 0.25),  # turns where two pieces meet
        ([0.0, 1.0, -1.0], 0.8, 0.25),  # and between
    ],
)
def test_peaks_beside_places_without_slope(c, end, top):
    """Fails if a slope of exactly zero at the end of a piece hides a turn."""
    assert peak(np.array(c), end, c[0], False) == pytest.approx(top, abs=1e-12)
