"""Fragility from a cloud: data made from a known line, and clouds that have none."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.fragility import Outcome, cloud, cloud_draw


def made(motions, slope=1.2, intercept=2.0, scatter=0.3, seed=1):
    generator = np.random.default_rng(seed)
    x = generator.uniform(-2, 0, motions)
    return np.exp(x), np.exp(intercept + slope * x + generator.normal(0, scatter, motions))


def test_a_large_cloud_gives_the_line_it_was_made_from():
    found = cloud(*made(40_000), limit=4.0)
    assert (found.slope, found.intercept, found.scatter) == pytest.approx((1.2, 2.0, 0.3), rel=0.01)
    assert found.curve.median == pytest.approx(np.exp((np.log(4) - 2.0) / 1.2), rel=0.01)
    assert found.curve.spread == pytest.approx(0.3 / 1.2, rel=0.01)


def test_three_motions_by_hand():
    """ln IM 0, 1, 2 and ln D 0, 1, 3: slope 1.5, intercept -1/6, scatter sqrt(1/6)."""
    found = cloud(np.exp([0.0, 1.0, 2.0]), np.exp([0.0, 1.0, 3.0]), limit=np.exp(1.0))
    assert (found.slope, found.intercept, found.scatter) == pytest.approx((1.5, -1 / 6, np.sqrt(1 / 6)))
    assert found.curve.median == pytest.approx(np.exp((1 + 1 / 6) / 1.5))


def test_a_motion_drawn_twice_counts_twice():
    x, y = made(6)
    times = np.array([[1, 2, 0], [0, 1, 2], [3, 0, 0]])
    motion = np.array([0, 0, 1, 1, 2, 2])
    drawn = cloud_draw(x, y, 4.0, motion, times)
    for number in range(2):
        taken = np.repeat(np.arange(6), times[number][motion])
        curve = cloud(x[taken], y[taken], 4.0).curve
        assert (drawn.median[number], drawn.spread[number]) == pytest.approx((curve.median, curve.spread))
    assert drawn.outcome[2] == Outcome.FLAT  # one motion, two points


def test_clouds_without_a_curve_are_named():
    x, y = made(10)
    assert cloud(x[:2], y[:2], 4.0).curve.outcome is Outcome.FEW
    assert cloud(np.full(10, 0.3), y, 4.0).curve.outcome is Outcome.FEW
    assert cloud(x, 1 / x, 4.0).curve.outcome is Outcome.FLAT
    assert cloud(x, 2 * x, 4.0).curve.outcome is Outcome.SEPARATED
    assert cloud(x, y, 4.0, motion=np.arange(10) // 5).curve.outcome is Outcome.FEW
    with pytest.raises(ValueError, match="above 0"):
        cloud(x, y * 0, 4.0)
