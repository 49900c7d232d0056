"""Fragility curves: the probability that a limit is passed, over an intensity, as a lognormal distribution, from
brackets of capacities or from a cloud of demands, with bootstrap bands.

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

Bands are percentile intervals of a bootstrap (Efron, B. and Tibshirani, R. (1993). An Introduction to the Bootstrap.
Chapman & Hall, ch. 13). The motion is what is drawn, with all its observations: they are not independent of each other.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import log_ndtr, ndtr

DRAWS = 1000
"""Draws of a bootstrap by default."""

CONFIDENCE = 0.9
"""Part of the draws that lies in a band by default [-]."""

MOST_SPREAD = 10.0
"""A curve with a larger logarithmic spread is told from no trend by chance alone [-]; buildings have 0.2 to 1."""

FEWEST = 3
"""Motions that a line through a cloud and the scatter around it take."""

_SEED = 20260101
_MOST_STEPS = 200


class Outcome(StrEnum):
    """What came of a fit; only `FITTED` has a median and a spread."""

    FITTED = "fitted"
    NEVER = "never passed"
    ALWAYS = "always passed"
    SEPARATED = "no overlap"
    FLAT = "no trend"
    FEW = "too few"
    UNDECIDED = "undecided"

    @property
    def meaning(self) -> str:
        """The outcome in a sentence."""
        return _MEANINGS[self]


_MEANINGS = {
    Outcome.FITTED: "a median and a spread were found",
    Outcome.NEVER: "no motion passes the limit at any solved intensity: the median lies above them",
    Outcome.ALWAYS: "every motion passes the limit at every solved intensity: the median lies below them",
    Outcome.SEPARATED: "below one intensity all hold, above it all pass: the spread is too small to be seen",
    Outcome.FLAT: "the limit is not passed more often at higher intensities: no rising curve fits",
    Outcome.FEW: "too few motions or intensities to tell the median from the spread",
    Outcome.UNDECIDED: "in half of the motions or more a collapse ended the scenes before the limit was passed: "
    "there is no curve",
}


class Curve(NamedTuple):
    """A lognormal fragility curve, P(passed | x) = Phi(ln(x / median) / spread), or why there is none.

    median, spread : [unit of the intensity], logarithmic standard deviation [-]; NaN unless fitted
    low, high : the intensities that hold the median, 0 and inf where an end is not known; of a fit the median twice
    """

    outcome: Outcome
    low: float
    high: float
    median: float = np.nan
    spread: float = np.nan


class Fits(NamedTuple):
    """Many fits. Where there is none, median and spread are what they tend to: median inf or 0 where no motion or every
    motion passes, spread 0 where the observations do not overlap, inf where there is no trend.

    outcome : of `Outcome`, `FEW` never among them, shape (fits,)
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


# Brackets of capacities: `low`, at which motions hold, 0 where no such intensity is known; `high`, at which they pass,
# inf where they are not known to; [unit of the intensity], shape (n,). One of both is known.


def fit(low: np.ndarray, high: np.ndarray, motions: int) -> Curve:
    """The curve of maximum likelihood, or why there is none; `motions` : how many the brackets belong to."""
    fits = fit_brackets(low, high, np.ones((1, low.size)))
    found, ends = Outcome(fits.outcome[0]), _ends(low, high)
    if motions < 2 or not low.size or (found is Outcome.SEPARATED and ends.size < 2):
        found = Outcome.FEW
    if found is Outcome.FITTED:
        median = float(fits.median[0])
        return Curve(found, median, median, median, float(fits.spread[0]))
    if found is Outcome.FLAT:
        return Curve(found, 0.0, np.inf)
    last_held, first_passed = low.max(initial=0.0), high.min(initial=np.inf)
    if 0 < last_held == first_passed < np.inf:  # some hold and some pass there: the median may lie on either side
        last_held = low[low < last_held].max(initial=0.0)
        first_passed = high[high > first_passed].min(initial=np.inf)
    return Curve(found, float(last_held), float(first_passed))


def of_counts(intensity: ArrayLike, motions: ArrayLike, passed: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """The brackets of counts: at each intensity so many motions of which so many pass; shape (intensities,) each."""
    x, passed = np.asarray(intensity, float), np.asarray(passed)
    held = np.asarray(motions) - passed
    low = np.concatenate([np.repeat(x, held), np.zeros(passed.sum())])
    return low, np.concatenate([np.full(held.sum(), np.inf), np.repeat(x, passed)])


def fit_brackets(low: np.ndarray, high: np.ndarray, weights: np.ndarray) -> Fits:
    """Fits of the same brackets with different weights, shape (fits, n), all at once."""
    # observations alike are one of more weight: of stripes there are few different ones
    (low, high), which = np.unique(np.stack([low, high]), axis=1, return_inverse=True)
    weights = weights @ np.eye(low.size)[which.ravel()]
    there = weights > 0
    last_held = np.where(there, low, 0.0).max(axis=1, initial=0.0)
    first_passed = np.where(there, high, np.inf).min(axis=1, initial=np.inf)
    apart, share = last_held <= first_passed, _share(weights, high < np.inf)
    with np.errstate(invalid="ignore"):
        median = np.sqrt(last_held * first_passed)
    ends = [first_passed == np.inf, last_held == 0]
    outcome = np.select([*ends, apart], [Outcome.NEVER, Outcome.ALWAYS, Outcome.SEPARATED], Outcome.FITTED)
    median = np.select(ends, [np.inf, 0.0], median)
    spread = np.zeros(len(weights))
    rest = ~apart & _rises(low, high, weights, share)
    if rest.any():
        median[rest], spread[rest] = _newton(low, high, weights[rest])
    return _flattened(Fits(outcome, median, spread, share), ~apart & ~(rest & (spread <= MOST_SPREAD)))


def _ends(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The different intensities observed, rising."""
    ends = np.unique(np.concatenate([low, high]))
    return ends[(ends > 0) & (ends < np.inf)]


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


def _newton(low: np.ndarray, high: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Median and spread where the maximum is known to exist, of every row of weights."""
    ends = np.log(_ends(low, high))
    centre, width = ends.mean(), max(float(np.ptp(ends)), 1e-3)
    with np.errstate(divide="ignore"):
        low, high = (np.log(low) - centre) / width, (np.log(high) - centre) / width
    at = np.tile([0.0, 4.0], (len(weights), 1))  # a and b
    value, gradient, hessian = _likelihood(at, low, high, weights)
    going = np.arange(len(weights))
    for _ in range(_MOST_STEPS):
        if not going.size:
            break
        step = -np.linalg.solve(hessian[going], gradient[going][..., None])[..., 0]
        decrement = (gradient[going] * step).sum(axis=1)
        size = np.ones(going.size)
        while True:  # halve until b stays positive and the likelihood does not fall
            trial = at[going] + size[:, None] * step
            allowed = trial[:, 1] > 0.05 * at[going, 1]
            trial[~allowed] = at[going][~allowed]
            risen = _likelihood(trial, low, high, weights[going])[0]
            enough = allowed & (risen >= value[going] + 1e-4 * size * decrement - 1e-13 * np.abs(value[going]))
            if (enough | (size < 1e-12)).all():
                break
            size = np.where(enough, size, 0.5 * size)
        at[going] = np.where(enough[:, None], trial, at[going])
        value[going], gradient[going], hessian[going] = _likelihood(at[going], low, high, weights[going])
        going = going[enough & (decrement > 1e-22 * weights[going].sum(axis=1))]
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
    gradient = [d_a, d_b]
    hessian = [
        v * s - u * r - d_a**2, v * s * x - u * r * y - d_a * d_b,
        v * s * x - u * r * y - d_a * d_b, v * s * x * x - u * r * y * y - d_b**2,
    ]  # fmt: skip
    value, *sums = ((weights * each).sum(axis=1) for each in (inside, *gradient, *hessian))
    return value, np.stack(sums[:2], axis=-1), np.stack(sums[2:], axis=-1).reshape(-1, 2, 2)


# Clouds: the intensity and the demand of every analysis, both above 0, shape (n,)


def fit_cloud(intensity: np.ndarray, demand: np.ndarray, motions: int) -> Curve:
    """The curve of P(demand > 1 | intensity): median exp(-intercept / slope), spread scatter / slope of the line
    ln demand = intercept + slope ln intensity; `motions` : how many the analyses belong to."""
    nothing = Curve(Outcome.FEW, 0.0, np.inf)
    if motions < FEWEST or np.ptp(np.log(intensity)) <= 1e-12:
        return nothing
    fits = fit_lines(intensity, demand, np.ones((1, intensity.size)))
    found, median, spread = Outcome(fits.outcome[0]), float(fits.median[0]), float(fits.spread[0])
    if found is Outcome.FLAT:
        return nothing._replace(outcome=found)
    return Curve(found, median, median, *((median, spread) if found is Outcome.FITTED else ()))


def fit_lines(intensity: np.ndarray, demand: np.ndarray, weights: np.ndarray) -> Fits:
    """Curves from lines of least squares, for many weights of the same points, shape (fits, n); of too few points
    without a trend."""
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


# Bands


class Bands(NamedTuple):
    """Ends of the probability that a limit is passed [-], shape (intensities,)."""

    low: np.ndarray
    high: np.ndarray


def resamples(motions: int, draws: int = DRAWS, seed: int = _SEED) -> np.ndarray:
    """How often each motion is taken in each draw, shape (draws, motions); the same for the same arguments.

    Curves of the same motions that are drawn alike can be compared draw by draw.
    """
    generator = np.random.Generator(np.random.PCG64(seed))
    return generator.multinomial(motions, np.full(motions, 1.0 / motions), size=draws)


def bands(fits: Fits, intensity: np.ndarray, confidence: float = CONFIDENCE) -> Bands:
    """Percentile bands of the probability.

    fits : of all draws; intensity : where the probability is wanted, above 0, shape (intensities,)
    """
    return Bands(*interval(fits.probability(np.asarray(intensity, dtype=float)), confidence))


def interval(values: np.ndarray, confidence: float) -> tuple:
    """Both ends of the middle part of the draws; infinite values are values like any other."""
    ends = 0.5 - confidence / 2, 0.5 + confidence / 2
    low, high = np.quantile(values, ends, axis=0, method="inverted_cdf")
    return low, high
