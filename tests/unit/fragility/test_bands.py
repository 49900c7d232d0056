"""Bootstrap bands: how often they hold the truth, what degenerate draws become, and that draws are repeatable."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.fragility import Brackets, Outcome, bands, draw, fit, median_ratio, resamples


def capacities(seed, motions=44, median=0.5, spread=0.4):
    return np.exp(np.random.default_rng(seed).normal(np.log(median), spread, motions))


def known(capacity):
    return Brackets.of(np.arange(len(capacity)), capacity, capacity, len(capacity))


def test_the_band_of_the_median_has_the_width_of_theory():
    """The standard error of ln median is spread / sqrt(n), of the spread about spread / sqrt(2 n)."""
    found = bands(draw(known(capacities(1)), resamples(44, 2000)), np.array([0.5]))
    curve = fit(known(capacities(1)))
    half = 1.645 * curve.spread / np.sqrt(44)
    assert np.log(found.median) == pytest.approx(np.log(curve.median) + np.array([-half, half]), abs=0.15 * half)
    assert found.spread[0] < curve.spread < found.spread[1]
    assert found.spread[1] - found.spread[0] == pytest.approx(2 * 1.645 * curve.spread / np.sqrt(88), rel=0.25)
    assert found.low[0] < curve.probability(0.5) < found.high[0]


def test_the_band_holds_the_truth_as_often_as_it_says():
    held = [bands(draw(known(capacities(seed)), resamples(44, 400)), np.array([0.5])).median for seed in range(200)]
    share = np.mean([low <= 0.5 <= high for low, high in held])
    assert 0.82 < share < 0.95  # 0.9 wanted; percentile intervals of 44 are a little short


def test_draws_are_repeatable_and_each_of_the_same_size():
    times = resamples(20, 50)
    assert (times.sum(axis=1) == 20).all()
    assert (times == resamples(20, 50)).all()
    assert (times != resamples(20, 50, seed=1)).any()


@pytest.mark.filterwarnings("error")
def test_draws_without_a_fit_count():
    """Two of twenty motions pass. A draw without the first, 0.95^20 of all, has no fit: none passes, or those that do
    pass above all that hold. Where none passes the median has no upper end."""
    low = np.where(np.arange(20) < 2, [0.2, 0.28] * 10, 0.3)
    brackets = Brackets.of(np.arange(20), low, np.where(np.arange(20) < 2, low + 0.02, np.inf), 20)
    found = bands(draw(brackets, resamples(20)), np.array([0.25, 0.5]))
    assert found.unfitted / found.draws == pytest.approx(0.95**20, abs=0.05)
    assert found.median[1] == np.inf
    assert np.isfinite(found.low).all()
    assert np.isfinite(found.high).all()
    assert found.low[1] == 0.0


def test_pairing_by_motion_sharpens_the_ratio():
    alone = capacities(1)
    beside = alone * 0.9 * np.exp(np.random.default_rng(2).normal(0, 0.05, 44))
    low, high = median_ratio(*(draw(known(each), resamples(44)) for each in (alone, beside)))
    assert low < 0.9 < high
    assert high - low < 0.04  # unpaired it would be +- 0.13
    assert fit(known(beside)).median / fit(known(alone)).median == pytest.approx(0.9, abs=0.02)


def test_a_draw_without_a_trend_has_the_share_of_all():
    """A draw of the second motion alone, which passes at two low intensities and holds at a high one."""
    brackets = Brackets.of(np.array([0, 0, 1, 1, 1]), [0.1, 0.0, 0.0, 0.0, 0.2], [np.inf, 0.2, 0.1, 0.12, np.inf], 2)
    fits = draw(brackets, np.array([[0, 2], [2, 0]]))
    assert list(fits.outcome) == [Outcome.FLAT, Outcome.SEPARATED]
    assert fits.probability(np.array([0.05, 0.15, 0.5]))[0] == pytest.approx(2 / 3)
    assert fits.probability(np.array([0.05, 0.5]))[1].tolist() == [0.0, 1.0]
