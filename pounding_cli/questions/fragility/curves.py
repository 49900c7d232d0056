"""Fragility curves: the probability that a limit is passed, over an intensity, as a lognormal distribution, from
brackets of capacities or from a cloud of demands; many at once, for a bootstrap.

The capacity of a motion is the intensity at which it first passes the limit. A motion that holds at 0.3 g and passes at
0.4 g has a capacity between them. One that passes at 0.3 g, and nothing else is known, has it in (0, 0.3 g); one that
holds there, in (0.3 g, inf). So one likelihood serves stripes, where it is the binomial one (Baker, J. W. (2015).
Efficient analytical fragility function fitting using dynamic structural analysis. Earthquake Spectra 31(1), 579-599,
eq. 11), and incremental dynamic analysis, motions that never passed the limit included.

With P(capacity < x) = Phi(a + b ln x) the logarithm of the likelihood is concave in a and b (Burridge, J. (1981). A
note on maximum likelihood estimation for regression models using grouped data. J. R. Stat. Soc. B 43(1), 41-45):
Newton's method finds its one maximum. Where it has none at a finite b > 0, the data tell why.

A cloud has one analysis a motion as it is, and a line through ln demand over ln intensity (Jalayer, F., De Risi, R. and
Manfredi, G. (2015). Bayesian Cloud Analysis: efficient structural fragility assessment using linear regression.
Bulletin of Earthquake Engineering 13, 1183-1203, eqs 1 to 4, least squares).

Intervals are percentiles of a bootstrap (Efron, B. and Tibshirani, R. (1993). An Introduction to the Bootstrap.
Chapman & Hall, ch. 13). The motion is what is drawn, with all its observations: they are not independent of each other.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Any, NamedTuple

import numpy as np
from scipy.special import log_ndtr, ndtr

from pounding_cli.questions.bootstrap import with_interval
from pounding_cli.questions.fragility.spec import FragilitySpec

MOST_SPREAD = 10.0
"""A curve with a larger logarithmic spread is told from no trend by chance alone [-]; buildings have 0.2 to 1."""

FEWEST = 3
"""Motions that a line through a cloud and the scatter around it take."""

_MOST_STEPS = 100


class Outcome(StrEnum):
    """What came of a fit; only `FITTED` has a median and a spread."""

    FITTED = "fitted"
    NEVER = "never passed"
    ALWAYS = "always passed"
    SEPARATED = "no overlap"
    FLAT = "no trend"
    FEW = "too few"
    UNDECIDED = "undecided"


class Fits(NamedTuple):
    """Fits of lognormal curves, P(passed | x) = Phi(ln(x / median) / spread). Where there is none, median and spread
    are what they tend to: median inf or 0 where no motion or every motion passes, spread 0 where the observations do
    not overlap, inf where there is no trend.

    outcome : of `Outcome`, `FEW` and `UNDECIDED` never among them, shape (fits,)
    median : [unit of the intensity], shape (fits,)
    spread : logarithmic standard deviation [-], shape (fits,)
    share : part of the observations that pass [-], shape (fits,)
    """

    outcome: np.ndarray
    median: np.ndarray
    spread: np.ndarray
    share: np.ndarray

    def probability(self, intensity: np.ndarray) -> np.ndarray:
        """The probability that the limit is passed [-], shape (fits, intensities); without a trend, the share."""
        with np.errstate(divide="ignore", invalid="ignore"):
            score = (np.log(intensity) - np.log(self.median)[:, None]) / self.spread[:, None]
        likely = ndtr(np.where(np.isnan(score), 0.0, score))
        return np.where(np.isinf(self.spread)[:, None], self.share[:, None], likely)


# Brackets of capacities


def fit_brackets(low: np.ndarray, high: np.ndarray, weights: np.ndarray) -> Fits:
    """Curves of maximum likelihood of the same brackets with different weights.

    low : intensities at which motions hold, 0 where none is known, shape (n,)
    high : at which they pass, inf where they are not known to, shape (n,); one of both is known
    weights : shape (fits, n)
    """
    # observations alike are one of more weight: of stripes there are few different ones
    (low, high), which = np.unique(np.stack([low, high]), axis=1, return_inverse=True)
    weights = weights @ np.eye(low.size)[which.ravel()]
    there = weights > 0
    last_held = np.where(there, low, 0.0).max(axis=1, initial=0.0)
    first_passed = np.where(there, high, np.inf).min(axis=1, initial=np.inf)
    overlaps, share = last_held > first_passed, _share(weights, high < np.inf)
    ends = [first_passed == np.inf, last_held == 0]
    with np.errstate(invalid="ignore"):
        median = np.select(ends, [np.inf, 0.0], np.sqrt(last_held * first_passed))
    outcome = np.select([*ends, ~overlaps], [Outcome.NEVER, Outcome.ALWAYS, Outcome.SEPARATED], Outcome.FITTED)
    spread, rises = np.zeros(len(weights)), overlaps & _rises(low, high, weights, share)
    if rises.any():
        median[rises], spread[rises] = _maximum(low, high, weights[rises])
    return _flattened(Fits(outcome, median, spread, share), overlaps & ~(rises & (spread <= MOST_SPREAD)))


def _share(weights: np.ndarray, passed: np.ndarray) -> np.ndarray:
    """Part of the observations that pass, of every row of weights."""
    return (weights * passed).sum(axis=1) / np.maximum(weights.sum(axis=1), 1e-300)


def _flattened(fits: Fits, flat: np.ndarray) -> Fits:
    """The fits, some of them without a trend."""
    outcome = np.where(flat, Outcome.FLAT, fits.outcome)
    median = np.where(flat, np.where(fits.share < 0.5, np.inf, 0.0), fits.median)
    return Fits(outcome, median, np.where(flat, np.inf, fits.spread), fits.share)


def _rises(low: np.ndarray, high: np.ndarray, weights: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Whether the likelihood has its maximum at b > 0: whether it grows with b from its maximum along b = 0.

    Along b = 0 an interval closed at both ends has no likelihood at all, so any of those is enough.
    """
    closed = (low > 0) & (high < np.inf)
    x = np.log(np.where(low > 0, low, high))
    # d log L / db at b = 0 is, but for a positive factor, the sum of (passed - share) ln x
    slope = (weights * ((high < np.inf) - share[:, None]) * x).sum(axis=1)
    return (weights[:, closed] > 0).any(axis=1) | (slope > 1e-12 * (weights * np.abs(x)).sum(axis=1))


def _maximum(low: np.ndarray, high: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Median and spread of the maximum of the likelihood, which is known to exist, of every row of weights."""
    with np.errstate(divide="ignore"):
        low, high = np.log(low), np.log(high)
    ends = np.unique(np.concatenate([low, high]))
    ends = ends[np.isfinite(ends)]
    centre, width = ends.mean(), max(float(np.ptp(ends)), 1e-3)
    low, high = (low - centre) / width, (high - centre) / width
    at = np.tile([0.0, 4.0], (len(weights), 1))  # a and b
    for _ in range(_MOST_STEPS):
        value, gradient, hessian = _likelihood(at, low, high, weights)
        step = -np.linalg.solve(hessian, gradient[..., None])[..., 0]
        size, trial = np.ones(len(at)), at + step
        for _ in range(40):  # halve until b stays positive and the likelihood does not fall
            beyond = trial[:, 1] <= 0.05 * at[:, 1]
            risen = _likelihood(np.where(beyond[:, None], at, trial), low, high, weights)[0]
            is_worse = beyond | (risen < value - 1e-13 * np.abs(value))
            if not is_worse.any():
                break
            size = np.where(is_worse, 0.5 * size, size)
            trial = at + size[:, None] * step
        at = np.where(is_worse[:, None], at, trial)
        if ((gradient * step).sum(axis=1) <= 1e-20 * weights.sum(axis=1)).all():
            break
    with np.errstate(over="ignore"):  # what is as flat as that is not kept
        return np.exp(centre - width * at[:, 0] / at[:, 1]), width / at[:, 1]


def _likelihood(
    at: np.ndarray, low: np.ndarray, high: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Logarithm of the likelihood at (a, b), shape (fits,), its gradient, (fits, 2), and its second derivatives,
    (fits, 2, 2).

    low, high : ln of the ends
    """
    lower, upper = (at[:, :1] + at[:, 1:] * ends for ends in (low, high))
    # in the upper tail the difference of two probabilities near 1 is that of their complements
    flip = lower > 0
    log_top, log_bottom = log_ndtr(np.where(flip, -lower, upper)), log_ndtr(np.where(flip, -upper, lower))
    inside = log_top + np.log(-np.expm1(log_bottom - log_top))
    # of both ends: the density there over the probability between them, and the score and ln x where they are finite
    r, s = (np.exp(-0.5 * score**2 - 0.5 * np.log(2.0 * np.pi) - inside) for score in (upper, lower))
    u, v, x, y = (np.where(np.isinf(each), 0.0, each) for each in (upper, lower, low, high))
    d_a, d_b = r - s, r * y - s * x
    d_aa, d_ab, d_bb = v * s - u * r - d_a**2, v * s * x - u * r * y - d_a * d_b, v * s * x**2 - u * r * y**2 - d_b**2
    value, a, b, aa, ab, bb = ((weights * each).sum(axis=1) for each in (inside, d_a, d_b, d_aa, d_ab, d_bb))
    return value, np.stack([a, b], axis=-1), np.stack([aa, ab, ab, bb], axis=-1).reshape(-1, 2, 2)


# Clouds


def fit_lines(intensity: np.ndarray, demand: np.ndarray, weights: np.ndarray) -> Fits:
    """Curves of P(demand > 1 | intensity) from lines of least squares, ln demand = intercept + slope ln intensity:
    median exp(-intercept / slope), spread scatter / slope; of too few points without a trend.

    intensity, demand : both above 0, shape (n,)
    weights : shape (fits, n)
    """
    x, y = np.log(intensity), np.log(demand)
    total, there = weights.sum(axis=1), weights > 0
    highest = np.where(there, x, -np.inf).max(axis=1, initial=-np.inf)
    lowest = np.where(there, x, np.inf).min(axis=1, initial=np.inf)
    told = (there.sum(axis=1) >= FEWEST) & (highest - lowest > 1e-12)
    some = np.where(told, total, 1.0)
    mean_x, mean_y = (weights @ x) / some, (weights @ y) / some
    dx, dy = x - mean_x[:, None], y - mean_y[:, None]
    slope = (weights * dx * dy).sum(axis=1) / np.where(told, (weights * dx * dx).sum(axis=1), 1.0)
    left = (weights * (dy - slope[:, None] * dx) ** 2).sum(axis=1)
    rises = told & (slope > 1e-9)
    rise = np.where(rises, slope, 1.0)
    spread = np.sqrt(left / np.where(told, total - 2, 1.0)) / rise
    with np.errstate(over="ignore"):
        median = np.exp((slope * mean_x - mean_y) / rise)
    outcome = np.where(spread <= 1e-12, Outcome.SEPARATED, Outcome.FITTED)
    return _flattened(Fits(outcome, median, spread, _share(weights, y > 0)), ~rises | (spread > MOST_SPREAD))


# What the motions say; intensities `x` and demands over limit have the shape (motions, levels)

UNDECIDED = float("-inf")
"""Demand over limit of a scene that a collapse ended before the limit was passed: the whole motion might have passed
it or not."""


class Brackets(NamedTuple):
    """What every motion says, each of shape (motions,).

    held : highest intensity below the first pass at which it holds; 0: none
    passed : that of the first pass; inf: none
    is_open : whether a collapse leaves open if it passes above all at which it holds
    undecided : its scenes that a collapse ended before the limit was passed
    """

    held: np.ndarray
    passed: np.ndarray
    is_open: np.ndarray
    undecided: np.ndarray


def brackets(x: np.ndarray, demand: np.ndarray) -> Brackets:
    """What motions say by their demands: above 1 where the limit is passed, UNDECIDED or NaN."""
    passed = np.where(demand > 1, x, np.inf).min(axis=1)
    holds, lost = (demand <= 1) & (demand != UNDECIDED), demand == UNDECIDED
    held = np.where(holds & (x < passed[:, None]), x, 0.0).max(axis=1)
    is_open = (np.where(lost, x, 0.0).max(axis=1) > held) & (passed == np.inf)
    return Brackets(held, passed, is_open, lost.sum(axis=1))


def curve_of(
    x: np.ndarray, demand: np.ndarray, there: np.ndarray, times: np.ndarray, spec: FragilitySpec
) -> tuple[dict[str, Any], Fits]:
    """The columns of one curve, and its fits: of the curve first, then of its draws.

    there : whether a scene was asked for; times : `draws_of` the motions
    """
    method, said, motions = spec.method, brackets(x, demand), len(x)
    is_open, lost, drawn = said.is_open, demand == UNDECIDED, motions
    if method == "cloud":  # intensities and demands
        one, other, is_told = x, demand, np.isfinite(demand) & (demand > 0)
    else:  # both ends of brackets, of `ida` one a motion and of `stripes` one for every scene
        one, other = np.where((demand <= 1) & ~lost, x, 0.0), np.where(demand > 1, x, np.inf)
        if method == "ida":
            one, other = said.held, said.passed
        is_told = (one > 0) | (other < np.inf)
    one, other, motion = one[is_told], other[is_told], np.nonzero(is_told)[0]
    if method == "cloud":
        fits, told = fit_lines(one, other, times[:, motion]), np.unique(motion).size
        is_few = told < FEWEST or 2 * told <= motions or float(np.ptp(np.log(one))) <= 1e-12
        is_open = lost.any(axis=1) & ~np.isin(np.arange(motions), motion)
        lost = ~np.isnan(demand) & ~is_told
        if 2 * told > motions > 2 * is_open.sum():
            drawn = told
    else:
        fits, ends = fit_brackets(one, other, times[:, motion]), np.unique(np.concatenate([one, other]))
        is_few = motions < 2 or not one.size
        is_few = is_few or (fits.outcome[0] == Outcome.SEPARATED and ((ends > 0) & (ends < np.inf)).sum() < 2)
    outcome = Outcome.FEW if is_few else Outcome(fits.outcome[0])
    low, high = 0.0, np.inf
    if 2 * is_open.sum() >= motions:  # between these half of them pass, whatever the undecided ones would do
        outcome = Outcome.UNDECIDED
        if method != "cloud":
            low, high = np.sort(said.held)[(motions - 1) // 2], np.sort(said.passed)[motions // 2]
    elif outcome is Outcome.FITTED or (method == "cloud" and outcome is Outcome.SEPARATED):
        low = high = fits.median[0]
    elif outcome is not Outcome.FLAT and method != "cloud":  # where some hold and some pass, it may lie on either side
        low = one[one < other.min(initial=np.inf)].max(initial=0.0)
        high = other[other > one.max(initial=0.0)].min(initial=np.inf)
    row: dict[str, Any] = {
        "outcome": str(outcome),
        "low": low,
        "high": high,
        "motions": drawn,
        "scenes": there.sum(),
        "failed": (there & np.isnan(demand)).sum(),
        "undecided": lost.sum(),
        "undecided_motions": is_open.sum(),
    }
    if outcome is Outcome.FITTED:
        for name in ("median", "spread"):
            row |= with_interval(name, getattr(fits, name), spec.confidence, drawn)
        row["unfitted"] = (fits.outcome[1:] != Outcome.FITTED).sum()
    return row, fits
