"""Peaks and bands of Fig. 5 against brute force and the numbers the figure shows."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.connector.findings import find
from pounding_cli.connector.oscillators import Oscillators, response_ratios


@pytest.mark.parametrize(
    ("damping", "peak1", "at1", "peak2", "at2"),
    [(0.05, 3.98, 0.70, 4.09, 0.72), (0.10, 2.24, 0.68, 2.40, 0.74)],
)
def test_peaks_of_figure_5(damping, peak1, at1, peak2, at2):
    found = find(Oscillators.from_ratios(0.6, 0.2, damping))
    assert (found.peak1, found.peak2) == pytest.approx((peak1, peak2), abs=0.006)
    assert (found.at1, found.at2) == pytest.approx((at1, at2), abs=0.006)


def test_both_ratios_exceed_one_in_two_bands():
    found = find(Oscillators.from_ratios(0.6, 0.2, 0.05))
    assert found.both_above == pytest.approx(np.array([[0.652, 0.772], [1.086, 1.163]]), abs=6e-4)


def test_against_brute_force():
    pair = Oscillators.from_ratios(1.3, 0.7, 0.08, mass_ratio=2.5, connector_damping=0.1)
    found = find(pair, 0.2, 3.0)
    grid = np.linspace(0.2, 3.0, 1_000_001)
    s1, s2 = (np.abs(r) for r in response_ratios(pair, grid))
    assert found.peak1 == pytest.approx(s1.max(), rel=1e-10)
    assert found.peak2 == pytest.approx(s2.max(), rel=1e-10)
    inside = np.zeros(grid.size, dtype=bool)
    for low, high in found.both_above:
        inside |= (grid > low) & (grid < high)
    assert inside.sum() == pytest.approx(((s1 > 1) & (s2 > 1)).sum(), abs=4)
    assert len(found.both_above) >= 1


def test_no_connector_has_no_band():
    found = find(Oscillators.from_ratios(0.6, 0.0, 0.05))
    assert found.both_above.shape == (0, 2)
    assert (found.peak1, found.peak2) == pytest.approx((1.0, 1.0), abs=1e-12)
