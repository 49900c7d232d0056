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

from pounding_cli.questions.bootstrap import build_estimate
from pounding_cli.questions.fragility.demands import UNDECIDED
from pounding_cli.questions.fragility.spec import FragilitySpec

MAX_SPREAD = 10.0
"""Logarithmic spread above which a curve differs from no trend by chance alone [-]; buildings have 0.2 to 1."""

MIN_CLOUD_MOTIONS = 3
"""Motions that a line through a cloud and the scatter around it take."""

_MAX_STEPS = 100
_MAX_HALVINGS = 40


class FitOutcome(StrEnum):
    """The outcome of a fit; only `FITTED` has a median and a spread."""

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
        """Return the probability that the limit is passed [-], shape (fits, intensities); the share without a trend."""
        with np.errstate(divide="ignore", invalid="ignore"):
            score = (np.log(intensity) - np.log(self.median)[:, None]) / self.spread[:, None]
        likely = ndtr(np.where(np.isnan(score), 0.0, score))
        return np.where(np.isinf(self.spread)[:, None], self.share[:, None], likely)


# Brackets of capacities


def fit_brackets(low: np.ndarray, high: np.ndarray, weights: np.ndarray) -> Fits:
    """Return the curves of maximum likelihood of the same brackets with different weights.

    low : intensities at which motions hold, 0 where none is known, shape (n,)
    high : at which they pass, inf where they are not known to, shape (n,); one of both is known
    weights : shape (fits, n)
    """
    # observations alike are one of more weight: of stripes there are few different ones
    (low, high), group = np.unique(np.stack([low, high]), axis=1, return_inverse=True)
    weights = weights @ np.eye(low.size)[group.ravel()]
    is_there = weights > 0
    last_held = np.where(is_there, low, 0.0).max(axis=1, initial=0.0)
    first_passed = np.where(is_there, high, np.inf).min(axis=1, initial=np.inf)
    overlaps = last_held > first_passed
    share = _share(weights, high < np.inf)
    ends = [first_passed == np.inf, last_held == 0]
    with np.errstate(invalid="ignore"):
        median = np.select(ends, [np.inf, 0.0], np.sqrt(last_held * first_passed))
    outcome = np.select(
        [*ends, ~overlaps], [FitOutcome.NEVER, FitOutcome.ALWAYS, FitOutcome.SEPARATED], FitOutcome.FITTED
    )
    spread = np.zeros(len(weights))
    has_trend = overlaps & _has_maximum(low, high, weights, share)
    if has_trend.any():
        median[has_trend], spread[has_trend] = _maximize(low, high, weights[has_trend])
    is_flat = overlaps & ~(has_trend & (spread <= MAX_SPREAD))
    return _flatten(Fits(outcome, median, spread, share), is_flat)


def _share(weights: np.ndarray, passed: np.ndarray) -> np.ndarray:
    """Return the part of the observations that pass, of every row of weights."""
    return (weights * passed).sum(axis=1) / np.maximum(weights.sum(axis=1), 1e-300)


def _flatten(fits: Fits, is_flat: np.ndarray) -> Fits:
    """Return the fits, some of them without a trend."""
    outcome = np.where(is_flat, FitOutcome.FLAT, fits.outcome)
    median = np.where(is_flat, np.where(fits.share < 0.5, np.inf, 0.0), fits.median)
    return Fits(outcome, median, np.where(is_flat, np.inf, fits.spread), fits.share)


def _has_maximum(low: np.ndarray, high: np.ndarray, weights: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Return whether the likelihood has its maximum at b > 0: whether it grows with b from its maximum along b = 0.

    Along b = 0 an interval closed at both ends has no likelihood at all, so any of those is enough.
    """
    closed = (low > 0) & (high < np.inf)
    x = np.log(np.where(low > 0, low, high))
    # d log L / db at b = 0 is, but for a positive factor, the sum of (passed - share) ln x
    slope = (weights * ((high < np.inf) - share[:, None]) * x).sum(axis=1)
    return (weights[:, closed] > 0).any(axis=1) | (slope > 1e-12 * (weights * np.abs(x)).sum(axis=1))


def _maximize(low: np.ndarray, high: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return median and spread of the maximum of the likelihood, of every row of weights; there must be one."""
    with np.errstate(divide="ignore"):
        log_low = np.log(low)
        log_high = np.log(high)
    ends = np.unique(np.concatenate([log_low, log_high]))
    ends = ends[np.isfinite(ends)]
    centre = ends.mean()
    width = max(float(np.ptp(ends)), 1e-3)
    log_low = (log_low - centre) / width
    log_high = (log_high - centre) / width
    place = np.tile([0.0, 4.0], (len(weights), 1))  # a and b
    for _ in range(_MAX_STEPS):
        value, gradient, hessian = _likelihood(place, log_low, log_high, weights)
        step = -np.linalg.solve(hessian, gradient[..., None])[..., 0]
        size = np.ones(len(place))
        trial = place + step
        for _ in range(_MAX_HALVINGS):  # until b stays positive and the likelihood does not fall
            is_beyond = trial[:, 1] <= 0.05 * place[:, 1]
            trial_value = _likelihood(np.where(is_beyond[:, None], place, trial), log_low, log_high, weights)[0]
            is_worse = is_beyond | (trial_value < value - 1e-13 * np.abs(value))
            if not is_worse.any():
                break
            size = np.where(is_worse, 0.5 * size, size)
            trial = place + size[:, None] * step
        place = np.where(is_worse[:, None], place, trial)
        if ((gradient * step).sum(axis=1) <= 1e-20 * weights.sum(axis=1)).all():
            break
    with np.errstate(over="ignore"):  # a curve as flat as that counts as one without a trend
        return np.exp(centre - width * place[:, 0] / place[:, 1]), width / place[:, 1]


def _likelihood(
    place: np.ndarray, low: np.ndarray, high: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the logarithm of the likelihood, shape (fits,), its gradient, (fits, 2), and its second derivatives,
    (fits, 2, 2).

    place : a and b, shape (fits, 2)
    low, high : ln of the ends
    """
    lower = place[:, :1] + place[:, 1:] * low
    upper = place[:, :1] + place[:, 1:] * high
    # in the upper tail the difference of two probabilities near 1 is that of their complements
    flip = lower > 0
    log_top = log_ndtr(np.where(flip, -lower, upper))
    log_bottom = log_ndtr(np.where(flip, -upper, lower))
    inside = log_top + np.log(-np.expm1(log_bottom - log_top))
    # of both ends: the density there over the probability between them, and the score and ln x where they are finite
    r = _density_ratio(upper, inside)
    s = _density_ratio(lower, inside)
    u = _zero_if_infinite(upper)
    v = _zero_if_infinite(lower)
    x = _zero_if_infinite(low)
    y = _zero_if_infinite(high)
    d_a = r - s
    d_b = r * y - s * x
    d_aa = v * s - u * r - d_a**2
    d_ab = v * s * x - u * r * y - d_a * d_b
    d_bb = v * s * x**2 - u * r * y**2 - d_b**2
    value, a, b, aa, ab, bb = ((weights * each).sum(axis=1) for each in (inside, d_a, d_b, d_aa, d_ab, d_bb))
    return value, np.stack([a, b], axis=-1), np.stack([aa, ab, ab, bb], axis=-1).reshape(-1, 2, 2)


def _density_ratio(score: np.ndarray, log_probability: np.ndarray) -> np.ndarray:
    """Return the density of the normal distribution at a score over a probability."""
    return np.exp(-0.5 * score**2 - 0.5 * np.log(2.0 * np.pi) - log_probability)


def _zero_if_infinite(values: np.ndarray) -> np.ndarray:
    return np.where(np.isinf(values), 0.0, values)


# Clouds


def fit_lines(intensity: np.ndarray, demand: np.ndarray, weights: np.ndarray) -> Fits:
    """Return the curves of P(demand > 1 | intensity) from lines of least squares.

    With ln demand = intercept + slope ln intensity the median is exp(-intercept / slope), the spread scatter / slope.
    Too few points have no trend.

    intensity, demand : both above 0, shape (n,)
    weights : shape (fits, n)
    """
    x = np.log(intensity)
    y = np.log(demand)
    total = weights.sum(axis=1)
    is_there = weights > 0
    highest = np.where(is_there, x, -np.inf).max(axis=1, initial=-np.inf)
    lowest = np.where(is_there, x, np.inf).min(axis=1, initial=np.inf)
    has_line = (is_there.sum(axis=1) >= MIN_CLOUD_MOTIONS) & (highest - lowest > 1e-12)
    count = np.where(has_line, total, 1.0)
    mean_x = (weights @ x) / count
    mean_y = (weights @ y) / count
    dx = x - mean_x[:, None]
    dy = y - mean_y[:, None]
    slope = (weights * dx * dy).sum(axis=1) / np.where(has_line, (weights * dx * dx).sum(axis=1), 1.0)
    residual = (weights * (dy - slope[:, None] * dx) ** 2).sum(axis=1)
    rises = has_line & (slope > 1e-9)
    rise = np.where(rises, slope, 1.0)
    spread = np.sqrt(residual / np.where(has_line, total - 2, 1.0)) / rise
    with np.errstate(over="ignore"):
        median = np.exp((slope * mean_x - mean_y) / rise)
    outcome = np.where(spread <= 1e-12, FitOutcome.SEPARATED, FitOutcome.FITTED)
    return _flatten(Fits(outcome, median, spread, _share(weights, y > 0)), ~rises | (spread > MAX_SPREAD))


# Demands of the motions; intensities `x` and demands over limit have the shape (motions, levels)


class Brackets(NamedTuple):
    """The bracket of the capacity of every motion, each of shape (motions,).

    held : highest intensity below the first pass at which it holds; 0: none
    passed : that of the first pass; inf: none
    is_open : whether a collapse leaves open if it passes above all at which it holds
    undecided : number of its time histories that a collapse ended before the limit was passed
    """

    held: np.ndarray
    passed: np.ndarray
    is_open: np.ndarray
    undecided: np.ndarray


def find_brackets(x: np.ndarray, demand: np.ndarray) -> Brackets:
    """Return the brackets of motions by their demands: above 1 where the limit is passed, UNDECIDED or NaN."""
    passed = np.where(demand > 1, x, np.inf).min(axis=1)
    is_undecided = demand == UNDECIDED
    holds = (demand <= 1) & ~is_undecided
    held = np.where(holds & (x < passed[:, None]), x, 0.0).max(axis=1)
    is_open = (np.where(is_undecided, x, 0.0).max(axis=1) > held) & (passed == np.inf)
    return Brackets(held, passed, is_open, is_undecided.sum(axis=1))


class FragilityCurve(NamedTuple):
    """One curve.

    columns : of its row in the table of curves
    fits : of the curve first, then of its draws
    motions : behind the curve
    """

    columns: dict[str, Any]
    fits: Fits
    motions: int

    @property
    def is_fitted(self) -> bool:
        """True where it has a median and a spread."""
        return self.columns["outcome"] == FitOutcome.FITTED


def fit_curve(
    x: np.ndarray, demand: np.ndarray, is_asked: np.ndarray, draws: np.ndarray, spec: FragilitySpec
) -> FragilityCurve:
    """Return the curve of motions by their demands.

    Over the buildings that a neighbour may be there is a row for every building and motion, building by building; a
    draw of the motions takes them beside all of these.

    is_asked : whether a time history was asked for, shape (rows, levels)
    draws : `draw_motions`, shape (1 + draws, motions)
    """
    motions_behind = draws.shape[1]
    draws = np.tile(draws, (1, len(x) // motions_behind))
    if spec.method == "cloud":
        return _fit_cloud(x, demand, is_asked, draws, spec, motions_behind)
    motions = len(x)
    brackets = find_brackets(x, demand)
    is_undecided = demand == UNDECIDED
    if spec.method == "ida":  # one bracket a motion
        low = brackets.held
        high = brackets.passed
    else:  # one a time history
        low = np.where((demand <= 1) & ~is_undecided, x, 0.0)
        high = np.where(demand > 1, x, np.inf)
    is_known = (low > 0) | (high < np.inf)
    low = low[is_known]
    high = high[is_known]
    fits = fit_brackets(low, high, draws[:, np.nonzero(is_known)[0]])
    outcome = FitOutcome(fits.outcome[0])
    ends = np.unique(np.concatenate([low, high]))
    is_one_end = ((ends > 0) & (ends < np.inf)).sum() < 2
    if motions < 2 or not low.size or (outcome is FitOutcome.SEPARATED and is_one_end):
        outcome = FitOutcome.FEW
    bounds = (0.0, np.inf)
    if 2 * brackets.is_open.sum() >= motions:
        outcome = FitOutcome.UNDECIDED
        bounds = _bound_median(brackets)
    elif outcome is FitOutcome.FITTED:
        bounds = (fits.median[0], fits.median[0])
    elif outcome is not FitOutcome.FLAT:  # where some hold and some pass, the median may lie on either side
        bounds = (
            low[low < high.min(initial=np.inf)].max(initial=0.0),
            high[high > low.max(initial=0.0)].min(initial=np.inf),
        )
    counts = _count_histories(demand, is_asked, is_undecided, brackets.is_open)
    return _build_curve(outcome, bounds, motions_behind, counts, fits, spec.confidence)


def _fit_cloud(
    x: np.ndarray, demand: np.ndarray, is_asked: np.ndarray, draws: np.ndarray, spec: FragilitySpec, motions_behind: int
) -> FragilityCurve:
    """Return the curve of a line through a cloud; arguments as those of `fit_curve`, with a draw of every row."""
    motions = len(x)
    is_known = np.isfinite(demand) & (demand > 0)
    motion = np.nonzero(is_known)[0]
    intensity = x[is_known]
    fits = fit_lines(intensity, demand[is_known], draws[:, motion])
    known_motions = np.unique(motion).size
    is_open = (demand == UNDECIDED).any(axis=1) & ~np.isin(np.arange(motions), motion)
    outcome = FitOutcome(fits.outcome[0])
    if known_motions < MIN_CLOUD_MOTIONS or 2 * known_motions <= motions or float(np.ptp(np.log(intensity))) <= 1e-12:
        outcome = FitOutcome.FEW
    is_decided = 2 * is_open.sum() < motions
    bounds = (0.0, np.inf)
    if not is_decided:
        outcome = FitOutcome.UNDECIDED
    elif outcome in (FitOutcome.FITTED, FitOutcome.SEPARATED):
        bounds = (fits.median[0], fits.median[0])
    behind = known_motions if 2 * known_motions > motions and is_decided else motions
    counts = _count_histories(demand, is_asked, ~np.isnan(demand) & ~is_known, is_open)
    return _build_curve(outcome, bounds, min(behind, motions_behind), counts, fits, spec.confidence)


def _bound_median(brackets: Brackets) -> tuple[float, float]:
    """Return the intensities between which half of the motions pass, whatever the undecided ones would do."""
    motions = len(brackets.held)
    return np.sort(brackets.held)[(motions - 1) // 2], np.sort(brackets.passed)[motions // 2]


def _count_histories(
    demand: np.ndarray, is_asked: np.ndarray, is_undecided: np.ndarray, is_open: np.ndarray
) -> dict[str, int]:
    """Return the columns that count time histories and undecided motions."""
    return {
        "histories": int(is_asked.sum()),
        "failed": int((is_asked & np.isnan(demand)).sum()),
        "undecided": int(is_undecided.sum()),
        "undecided_motions": int(is_open.sum()),
    }


def _build_curve(
    outcome: FitOutcome,
    bounds: tuple[float, float],
    motions: int,
    counts: dict[str, int],
    fits: Fits,
    confidence: float,
) -> FragilityCurve:
    """Return a curve with the columns of its row."""
    columns: dict[str, Any] = {"outcome": str(outcome), "low": bounds[0], "high": bounds[1], "motions": motions}
    columns |= counts
    if outcome is FitOutcome.FITTED:
        columns |= build_estimate("median", fits.median, confidence, motions)
        columns |= build_estimate("spread", fits.spread, confidence, motions)
        columns["unfitted"] = int((fits.outcome[1:] != FitOutcome.FITTED).sum())
    return FragilityCurve(columns, fits, motions)
