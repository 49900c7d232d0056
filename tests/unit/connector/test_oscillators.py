"""The closed form of Fig. 4 against a numerical eigensolver, a linear solver and its own identities."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pounding_cli.connector.oscillators import Oscillators, coupled_frequencies, eq7_dashpot, response_ratios

positive = st.floats(0.02, 50.0)
connector = st.floats(1e-3, 1e3)


@given(p=positive, mass_ratio=positive, k=connector)
def test_lowest_frequency_lies_between_and_highest_above_both(p, mass_ratio, k):
    pair = Oscillators.from_ratios(p, k, 0.05, mass_ratio)
    low, high = coupled_frequencies(pair)
    slack = 1e-13
    assert min(1.0, p) * (1 - slack) <= low <= max(1.0, p) * (1 + slack)
    assert high > max(1.0, p) * (1 - slack)


@given(p=st.floats(0.1, 10.0).filter(lambda p: abs(p - 1) > 0.05), k=st.floats(0.01, 10.0))
def test_lowest_frequency_lies_strictly_between(p, k):
    low, high = coupled_frequencies(Oscillators.from_ratios(p, k, 0.05))
    assert min(1.0, p) < low < max(1.0, p) < high


@given(p=positive, mass_ratio=positive, k=connector)
def test_coupled_frequencies_against_lapack(p, mass_ratio, k):
    pair = Oscillators.from_ratios(p, k, 0.0, mass_ratio)
    root = np.sqrt(pair.m1 * pair.m2)
    matrix = np.array([[(pair.k1 + k) / pair.m1, -k / root], [-k / root, (pair.k2 + k) / pair.m2]])
    squares = np.linalg.eigvalsh(matrix)
    low, high = coupled_frequencies(pair)
    assert high**2 == pytest.approx(squares[1], rel=1e-12)
    assert low**2 == pytest.approx(squares[0], rel=1e-12, abs=1e-13 * squares[1])


@given(
    p=positive,
    mass_ratio=positive,
    k=st.floats(0.0, 1e3),
    zeta=st.floats(0.001, 0.9),
    xi=st.floats(0.0, 2.0),
    ratio=st.floats(0.01, 10.0),
)
def test_mass_weighted_ratios_sum_to_the_total_mass(p, mass_ratio, k, zeta, xi, ratio):
    pair = Oscillators.from_ratios(p, k, zeta, mass_ratio, xi)
    r1, r2 = response_ratios(pair, np.array([ratio]))
    total = pair.m1 + pair.m2
    # 1e-12 of the terms that are added: near an anti-resonance the two ratios are large and opposite.
    size = pair.m1 * abs(r1[0]) + pair.m2 * abs(r2[0])
    assert abs(pair.m1 * r1[0] + pair.m2 * r2[0] - total) <= 1e-12 * max(total, size)
    assert max(abs(r1[0]), abs(r2[0])) >= 1 - 1e-12


def test_ratios_against_a_linear_solver():
    pair = Oscillators(m1=3.0, m2=5.0, k1=700.0, k2=400.0, zeta1=0.04, zeta2=0.11, stiffness=90.0, dashpot=2.5)
    omega = np.array([3.0, 9.0, 15.0, 31.0])
    r1, r2 = response_ratios(pair, omega)
    for i, w in enumerate(omega):
        c1, c2 = 2 * 0.04 * np.sqrt(700.0 * 3.0), 2 * 0.11 * np.sqrt(400.0 * 5.0)
        alone = np.diag([700.0 - 3.0 * w**2 + 1j * w * c1, 400.0 - 5.0 * w**2 + 1j * w * c2])
        link = (90.0 + 2.5j * w) * np.array([[1.0, -1.0], [-1.0, 1.0]])
        force = -np.array([3.0, 5.0])
        expected = np.linalg.solve(alone + link, force) / np.linalg.solve(alone, force)
        assert [r1[i], r2[i]] == pytest.approx(expected, rel=1e-12)


def test_no_connector_changes_nothing():
    r1, r2 = response_ratios(Oscillators.from_ratios(0.6, 0.0, 0.05), np.linspace(0.1, 2, 50))
    assert np.abs(r1 - 1).max() < 1e-14
    assert np.abs(r2 - 1).max() < 1e-14


def test_signed_ratios_move_oppositely_without_damping():
    """The paper's sentence is right for signed ratios of undamped systems: R1 + R2 = 2 when m1 = m2."""
    pair = Oscillators.from_ratios(0.6, 0.2, 0.0)
    r1, r2 = response_ratios(pair, np.linspace(0.1, 0.6, 400))
    assert np.abs(r1.imag).max() == 0.0
    assert (np.diff(r1.real) * np.diff(r2.real) < 0).all()


def test_dashpot_of_eq7():
    assert eq7_dashpot(8.0, 0.25, 4.0, 4.0) == pytest.approx(2 * 0.25 * np.sqrt(8.0 * 2.0))


@pytest.mark.parametrize("key", ["m1", "k2"])
def test_refuses_what_is_not_positive(key):
    values = {"m1": 1.0, "m2": 1.0, "k1": 1.0, "k2": 1.0, "zeta1": 0.0, "zeta2": 0.0, "stiffness": 0.0}
    with pytest.raises(ValueError, match=key):
        Oscillators(**{**values, key: 0.0})
    with pytest.raises(ValueError, match="zeta1"):
        Oscillators(**{**values, "zeta1": float("nan")})
