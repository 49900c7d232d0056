"""The rules of codes against numbers by hand from their clauses, and the correlation of two oscillators."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.model.separation import (
    CODE_RULES,
    NBC202_WIDTH,
    cross_correlation,
    e030_displacement,
    e030_minimum,
    ntc_separation,
    tbdy2018_separation,
)

UNKNOWN = math.nan


@pytest.mark.parametrize(
    ("left", "right", "acceleration", "edition", "gap"),
    [
        (0.0, 0.0, 0.25, 2018, 0.075),  # 15 m / 100 x 2 x 0.25
        (0.0, 0.0, 0.25, 2008, 0.075),  # 15 m / 100 x 0.25 / 0.5
        (0.05, 0.04, 0.25, 2018, 0.09),  # the sum of the displacements
        (UNKNOWN, 0.05, 0.25, 2018, 0.0875),  # 15 m / 100 x 0.25 and 5 cm
        (UNKNOWN, 0.05, 0.25, 2008, 0.125),  # 15 m / 100 x 0.5 and 5 cm
        (0.05, UNKNOWN, 0.25, 2018, 0.11),  # 5 cm and 24 m / 100 x 0.25
        (UNKNOWN, UNKNOWN, 0.25, 2018, 0.0975),
        (0.02, 0.02, 0.8, 2018, 0.15),  # no more than 1 / 100 of the height
    ],
)
def test_ntc(left, right, acceleration, edition, gap):
    """At 15 m, the roof of the left building; the right one has 24 m. Fails if the editions share their estimate, or if
    the height of the neighbour is taken."""
    assert ntc_separation(left, right, 15.0, 15.0, 24.0, acceleration, edition) == pytest.approx(gap, rel=1e-12)


@pytest.mark.parametrize(
    ("level", "least"), [(3.0, 0.03), (6.0, 0.03), (6.1, 0.04), (9.0, 0.04), (12.0, 0.05), (15.0, 0.06), (30.0, 0.11)]
)
def test_tbdy(level, least):
    """R / I = 8 and 4; 3 and 4 cm of both. Fails if alpha is that of the other case, or a step of 3 m is missed."""
    assert tbdy2018_separation(0.001, 0.001, level, True) == pytest.approx(least, rel=1e-12)
    assert tbdy2018_separation(8 * 0.03, 8 * 0.04, level, True) == pytest.approx(max(least, 0.25 * 8 * 0.05), rel=1e-12)
    assert tbdy2018_separation(8 * 0.03, 8 * 0.04, level, False) == pytest.approx(0.5 * 8 * 0.05, rel=1e-12)
    assert math.isnan(tbdy2018_separation(UNKNOWN, 0.1, level, True))


def test_the_others():
    assert e030_displacement(-0.01, 8.0) == pytest.approx(0.06, rel=1e-12)
    assert e030_displacement(0.01, 8.0, True) == pytest.approx(0.068, rel=1e-12)
    assert [e030_minimum(level) for level in (3.0, 5.0, 15.0)] == pytest.approx([0.03, 0.03, 0.09], rel=1e-12)
    assert 0.04 <= NBC202_WIDTH <= 0.05


def test_every_rule_is_cited_and_named_once():
    names = [rule.name for rule in CODE_RULES]
    assert len(set(names)) == len(names)
    assert all(rule.clause and (rule.source or rule.name == "UBC") for rule in CODE_RULES)


PRINTED_CORRELATIONS = [
    (1.3685937, 1.3004468, 0.79280),
    (1.3685937, 0.43155484, 0.005705),
    (1.3004468, 0.43155484, 0.006383),
]
"""Periods of two modes [s], damped by 5 %, and their correlation: R. W. Clough & J. Penzien, Dynamics of Structures,
example E26-8, as example A87 of the verification manual of SOLVIA prints it; periods by the frame of the example."""


@pytest.mark.parametrize(("left", "right", "printed"), PRINTED_CORRELATIONS)
def test_correlation_of_modes_is_the_printed_one(left, right, printed):
    assert cross_correlation(left, right) == pytest.approx(printed, rel=1e-4)


@pytest.mark.parametrize(
    ("left", "right", "dampings"), [(0.5, 0.4, (0.05, 0.05)), (0.4, 0.5, (0.05, 0.05)), (1.0, 0.9, (0.02, 0.1))]
)
def test_correlation_under_white_noise(left, right, dampings):
    """Against the spectra of both displacements, integrated over frequency."""
    one, other = (2 * math.pi / period for period in (left, right))
    w = np.concatenate([np.linspace(0.0, 60.0, 600_001), np.linspace(60.0, 5000.0, 500_001)[1:]])
    h, k = (1 / (f**2 - w**2 + 2j * d * f * w) for f, d in zip((one, other), dampings, strict=True))
    products = (np.trapezoid((a * b.conj()).real, w) for a, b in ((h, k), (h, h), (k, k)))
    cross, first, second = products
    assert cross_correlation(left, right, *dampings) == pytest.approx(cross / math.sqrt(first * second), rel=1e-5)
