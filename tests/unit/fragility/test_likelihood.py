"""Maximum likelihood of fragility curves: published values, independent optimisers, and data without a maximum."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize
from scipy.stats import CensoredData, binom, lognorm, norm

from pounding_cli.fragility import Brackets, Outcome, fit, of_counts

BAKER = (0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0)


def test_the_published_example_of_stripes():
    """Baker (2015): 40 motions at eight intensities."""
    curve = fit(of_counts(BAKER, [40] * 8, [0, 0, 0, 4, 6, 13, 12, 16]))
    assert (curve.outcome, curve.motions) == (Outcome.FITTED, 40)
    assert curve.median == pytest.approx(1.0761, abs=5e-5)
    assert curve.spread == pytest.approx(0.4292, abs=5e-5)
    assert curve.probability(curve.median) == pytest.approx(0.5)
    assert curve.probability(curve.median * np.exp(curve.spread)) == pytest.approx(norm.cdf(1.0))


def test_known_capacities_have_the_closed_form():
    capacity = np.array([0.3, 0.5, 0.4, 0.9, 0.6])
    curve = fit(Brackets.of(np.arange(5), capacity, capacity, 5))
    assert curve.median == pytest.approx(np.exp(np.log(capacity).mean()), rel=1e-9)
    assert curve.spread == pytest.approx(np.log(capacity).std(), rel=1e-9)


def test_motions_that_never_passed_are_counted():
    """Capacities up to 0.6, and three motions that still hold there (by another optimiser)."""
    capacity, held = np.array([0.3, 0.5, 0.4, 0.55]), np.full(3, 0.6)
    low, high = np.concatenate([capacity, held]), np.concatenate([capacity, np.full(3, np.inf)])
    curve = fit(Brackets.of(np.arange(7), low, high, 7))

    def misfit(p):
        median, spread = np.exp(p)
        score = np.log(low / median) / spread
        return -norm.logpdf(score[:4]).sum() + 4 * p[1] - norm.logsf(score[4:]).sum()

    found = np.exp(minimize(misfit, np.log([0.5, 0.4]), method="Nelder-Mead", options={"xatol": 1e-9}).x)
    assert (curve.median, curve.spread) == pytest.approx(tuple(found), rel=1e-4)
    alone = fit(Brackets.of(np.arange(4), capacity, capacity, 4))
    assert curve.median > 1.1 * alone.median  # left out, they would make the building look weaker


@pytest.mark.parametrize("seed", range(4))
def test_capacities_censored_at_intensities_of_their_own(seed):
    """Brackets, known capacities, and motions known to hold up to some intensity only: scipy's maximum."""
    random = np.random.default_rng(seed)
    capacity, top = np.exp(random.normal(-1.0, 0.5, 40)), np.exp(random.normal(-0.8, 0.4, 40))
    lost, bracketed = top < capacity, random.random(40) < 0.5
    low = np.where(lost, top, np.where(bracketed, 0.8 * capacity, capacity))
    high = np.where(lost, np.inf, np.where(bracketed, 1.1 * capacity, capacity))
    assert 5 < lost.sum() < 25
    curve = fit(Brackets.of(np.arange(40), low, high, 40))
    both = bracketed & ~lost
    data = CensoredData(
        uncensored=capacity[~bracketed & ~lost], interval=np.stack([low, high], axis=1)[both], right=top[lost]
    )
    spread, _, median = lognorm.fit(data, floc=0)
    assert (curve.median, curve.spread) == pytest.approx((median, spread), rel=2e-4)


@pytest.mark.parametrize(
    ("correlation", "by_ida", "by_stripes"), [(0.0, (0.97, 1.03), (0.97, 1.03)), (0.9, (1.05, 1.15), (1.4, 1.7))]
)
def test_what_a_collapse_of_the_neighbour_does_to_the_median(correlation, by_ida, by_stripes):
    """A true median of 0.5; above a capacity of the neighbour, median 0.6, all is undecided. Without correlation both
    methods are right; with 0.9 the medians are too high by what docs/how-to/fragility.md says."""
    levels, n = np.arange(0.05, 1.5, 0.05), 4000
    normal = np.random.default_rng(1).multivariate_normal([0, 0], [[1, correlation], [correlation, 1]], size=n)
    own, neighbour = 0.5 * np.exp(0.4 * normal[:, 0]), 0.6 * np.exp(0.4 * normal[:, 1])
    decided, passed = levels < neighbour[:, None], levels >= own[:, None]
    held = np.where(decided & ~passed, levels, 0.0).max(axis=1)
    first = np.where(decided & passed, levels, np.inf).min(axis=1)
    assert np.mean(np.isinf(first)) == pytest.approx(0.4 if correlation == 0 else 0.2, abs=0.05)
    assert by_ida[0] < fit(Brackets.of(np.arange(n), held, first, n)).median / 0.5 < by_ida[1]
    stripes = fit(of_counts(levels, decided.sum(axis=0), (decided & passed).sum(axis=0)))
    assert by_stripes[0] < stripes.median / 0.5 < by_stripes[1]


def test_a_narrow_bracket_is_a_known_capacity():
    capacity = np.exp(np.random.default_rng(3).normal(-1.0, 0.4, 44))
    known = fit(Brackets.of(np.arange(44), capacity, capacity, 44))
    bracket = fit(Brackets.of(np.arange(44), capacity * 0.9995, capacity * 1.0005, 44))
    assert (bracket.median, bracket.spread) == pytest.approx((known.median, known.spread), rel=1e-5)


@pytest.mark.filterwarnings("error")
def test_a_motion_fifty_deviations_away_does_not_lose_its_digits():
    """The difference of two probabilities that both round to one."""
    capacity = np.append(np.linspace(0.1, 0.11, 3000), 10.0)
    known = fit(Brackets.of(np.arange(3001), capacity, capacity, 3001))
    bracket = fit(Brackets.of(np.arange(3001), capacity * 0.9999, capacity * 1.0001, 3001))
    assert (bracket.median, bracket.spread) == pytest.approx((known.median, known.spread), rel=1e-5)


@pytest.mark.parametrize(
    ("counts", "outcome", "between"),
    [
        ([0, 0, 0], Outcome.NEVER, (0.3, np.inf)),
        ([9, 9, 9], Outcome.ALWAYS, (0.0, 0.1)),
        ([0, 9, 9], Outcome.SEPARATED, (0.1, 0.2)),
        ([0, 4, 9], Outcome.SEPARATED, (0.1, 0.3)),
        ([9, 5, 0], Outcome.FLAT, (0.0, np.inf)),
        ([4, 4, 4], Outcome.FLAT, (0.0, np.inf)),
    ],
)
def test_counts_without_a_maximum_are_named(counts, outcome, between):
    curve = fit(of_counts([0.1, 0.2, 0.3], [9] * 3, counts))
    assert (curve.outcome, curve.between) == (outcome, pytest.approx(between))
    assert curve.median is None
    assert curve.spread is None
    with pytest.raises(ValueError, match="there is no curve"):
        curve.probability(0.2)


def test_one_motion_or_one_intensity_is_too_few():
    assert fit(Brackets.of([0], [0.3], [0.4], 1)).outcome is Outcome.FEW
    one = fit(of_counts([0.3], [9], [4]))
    assert (one.outcome, one.between) == (Outcome.FEW, (0.0, np.inf))
    assert fit(Brackets.of([], [], [], 0)).outcome is Outcome.FEW


@settings(max_examples=150, deadline=None)
@example([(4.0, 50, 0.71875), (6.0, 57, 0.890625), (1.25, 15, 0.6875), (0.03125, 55, 0.8125)])  # median 1e-400
@given(
    st.lists(
        st.tuples(st.floats(0.01, 10.0), st.integers(1, 60), st.floats(0, 1)),
        min_size=1, max_size=8, unique_by=lambda s: round(s[0], 3),
    )
)  # fmt: skip
@pytest.mark.filterwarnings("error")
def test_any_counts_are_fitted_or_named(stripes):
    """No warning, no NaN; a fit is at least as likely as what another optimiser finds."""
    x = np.array([s[0] for s in stripes])
    n = np.array([s[1] for s in stripes])
    k = np.round(n * np.array([s[2] for s in stripes])).astype(int)
    curve = fit(of_counts(x, n, k))
    if curve.outcome is not Outcome.FITTED:
        assert curve.median is None
        assert curve.between[0] <= curve.between[1]
        return
    assert 0 < curve.spread <= 10
    assert 0 < curve.median < np.inf

    def likelihood(line):
        return binom.logpmf(k, n, norm.cdf(line[0] + line[1] * np.log(x))).sum()

    own = likelihood((-np.log(curve.median) / curve.spread, 1 / curve.spread))
    with np.errstate(all="ignore"):
        other = minimize(lambda line: -likelihood(line) if line[1] > 0 else np.inf, (0.0, 1.0), method="Nelder-Mead")
    assert own >= -other.fun - 1e-6


@pytest.mark.parametrize("what", [([0.5], [0.4]), ([-0.1], [0.4]), ([0.0], [0.0])])
def test_a_bracket_that_is_none_is_refused(what):
    with pytest.raises(ValueError, match="bracket"):
        Brackets.of([0], *what, 1)
    with pytest.raises(ValueError, match="no more motions pass"):
        of_counts([0.1], [3], [4])
