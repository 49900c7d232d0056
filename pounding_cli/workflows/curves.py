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

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
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
_LOG_ROOT_2PI = 0.5 * np.log(2.0 * np.pi)


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


@dataclass(frozen=True)
class Curve:
    """A lognormal fragility curve, P(passed | x) = Phi(ln(x / median) / spread), or why there is none.

    outcome : outcome of the fit
    motions : motions it rests on
    median, spread : median [unit of the intensity] and logarithmic standard deviation [-]; None unless fitted
    between : the intensities that hold the median, (0, inf) where neither end is known; of a fit the median twice
    """

    outcome: Outcome
    motions: int
    median: float | None
    spread: float | None
    between: tuple[float, float]


@dataclass(frozen=True)
class Fits:
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
        flat = np.isinf(self.spread)
        likely[flat] = self.share[flat, None]
        return likely


# Brackets of capacities


@dataclass(frozen=True)
class Brackets:
    """Intervals that hold capacities.

    motion : number of the motion each belongs to, from 0, shape (n,)
    low : the motion holds there [unit of the intensity], 0 where no such intensity is known, shape (n,)
    high : it passes there, inf where it is not known to; equal to `low` where the capacity is known, shape (n,)
    motions : how many motions there are, those without an observation included
    """

    motion: np.ndarray
    low: np.ndarray
    high: np.ndarray
    motions: int

    @classmethod
    def of(cls, motion: np.ndarray, low: np.ndarray, high: np.ndarray, motions: int) -> Brackets:
        """Without those that tell nothing, (0, inf)."""
        told = (low > 0) | (high < np.inf)
        return cls(motion[told], low[told], high[told], motions)

    @property
    def ends(self) -> np.ndarray:
        """The different intensities observed, rising."""
        ends = np.unique(np.concatenate([self.low, self.high]))
        return ends[(ends > 0) & (ends < np.inf)]


def fit(brackets: Brackets) -> Curve:
    """The curve of maximum likelihood, or why there is none."""
    fits = _fitted(brackets, np.ones((1, brackets.low.size)))
    found = Outcome(fits.outcome[0])
    one_intensity = found is Outcome.SEPARATED and brackets.ends.size < 2
    if brackets.motions < 2 or not brackets.low.size or one_intensity:
        found = Outcome.FEW
    if found is Outcome.FITTED:
        median = float(fits.median[0])
        return Curve(found, brackets.motions, median, float(fits.spread[0]), (median, median))
    return Curve(found, brackets.motions, None, None, _between(brackets, found))


def draw(brackets: Brackets, times: np.ndarray) -> Fits:
    """The fit of every draw; `times` : `resamples` of as many motions as `brackets` has."""
    # observations alike are one of more weight: of stripes there are few different ones
    ends, which = np.unique(np.stack([brackets.low, brackets.high]), axis=1, return_inverse=True)
    alike = np.zeros((brackets.low.size, ends.shape[1]))
    alike[np.arange(brackets.low.size), which.ravel()] = 1.0
    different = Brackets(np.zeros(ends.shape[1], int), ends[0], ends[1], brackets.motions)
    return _fitted(different, times[:, brackets.motion] @ alike)


def _fitted(brackets: Brackets, weights: np.ndarray) -> Fits:
    """Fits of the same observations with different weights, shape (fits, n), all at once."""
    low, high = brackets.low, brackets.high
    there = weights > 0
    last_held = np.where(there, low, 0.0).max(axis=1, initial=0.0)
    first_passed = np.where(there, high, np.inf).min(axis=1, initial=np.inf)
    outcome = np.full(len(weights), Outcome.FITTED, dtype=object)
    median, spread = np.zeros(len(weights)), np.zeros(len(weights))
    apart = last_held <= first_passed
    outcome[apart] = Outcome.SEPARATED
    both = apart & (last_held > 0) & (first_passed < np.inf)
    median[both] = np.sqrt(last_held[both] * first_passed[both])
    for rows, what, value in ((last_held == 0, Outcome.ALWAYS, 0.0), (first_passed == np.inf, Outcome.NEVER, np.inf)):
        outcome[rows], median[rows] = what, value
    share = np.where(high < np.inf, weights, 0.0).sum(axis=1) / np.maximum(weights.sum(axis=1), 1e-300)
    rest = ~apart & _rises(brackets, weights, share)
    if rest.any():
        median[rest], spread[rest] = _newton(brackets, weights[rest])
    flat = ~apart & ~(rest & (spread <= MOST_SPREAD))
    outcome[flat], spread[flat] = Outcome.FLAT, np.inf
    median[flat] = np.where(share[flat] < 0.5, np.inf, 0.0)
    return Fits(outcome, median, spread, share)


def _between(brackets: Brackets, outcome: Outcome) -> tuple[float, float]:
    if outcome is Outcome.FLAT:
        return 0.0, float("inf")
    low, high = brackets.low, brackets.high
    last_held, first_passed = float(low.max(initial=0.0)), float(high.min(initial=np.inf))
    if 0 < last_held == first_passed < np.inf:  # some hold and some pass there: the median may lie on either side
        last_held = float(low[low < last_held].max(initial=0.0))
        first_passed = float(high[high > first_passed].min(initial=np.inf))
    return last_held, first_passed


def _rises(brackets: Brackets, weights: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Whether the likelihood has its maximum at b > 0: whether it grows with b from its maximum along b = 0.

    Along b = 0 an interval closed at both ends has no likelihood at all, so any of those is enough.
    """
    low, high = brackets.low, brackets.high
    closed = (low > 0) & (high < np.inf)
    x = np.log(np.where(low > 0, low, np.where(high < np.inf, high, 1.0)))
    # d log L / db at b = 0 is, but for a positive factor, the sum of (passed - share) ln x
    slope = (weights * ((high < np.inf) - share[:, None]) * x).sum(axis=1)
    scale = (weights * np.abs(x)).sum(axis=1)
    return (weights[:, closed] > 0).any(axis=1) | (slope > 1e-12 * scale)


def _newton(brackets: Brackets, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Median and spread where the maximum is known to exist, of every row of weights."""
    ends = np.log(brackets.ends)
    centre, width = ends.mean(), max(float(np.ptp(ends)), 1e-3)
    with np.errstate(divide="ignore"):
        low, high = (np.log(brackets.low) - centre) / width, (np.log(brackets.high) - centre) / width
    a, b = np.zeros(len(weights)), np.full(len(weights), 4.0)
    value, gradient, hessian = _likelihood(a, b, low, high, weights)
    going = np.arange(len(weights))
    for _ in range(_MOST_STEPS):
        if not going.size:
            break
        step = -np.linalg.solve(hessian[going], gradient[going][..., None])[..., 0]
        decrement = (gradient[going] * step).sum(axis=1)
        size = np.ones(going.size)
        while True:  # halve until b stays positive and the likelihood does not fall
            at, bt = a[going] + size * step[:, 0], b[going] + size * step[:, 1]
            allowed = bt > 0.05 * b[going]
            trial = _likelihood(at, np.where(allowed, bt, b[going]), low, high, weights[going])
            enough = allowed & (trial[0] >= value[going] + 1e-4 * size * decrement - 1e-13 * np.abs(value[going]))
            if (enough | (size < 1e-12)).all():
                break
            size = np.where(enough, size, 0.5 * size)
        a[going], b[going] = np.where(enough, at, a[going]), np.where(enough, bt, b[going])
        value[going], gradient[going], hessian[going] = _likelihood(a[going], b[going], low, high, weights[going])
        going = going[enough & (decrement > 1e-22 * weights[going].sum(axis=1))]
    with np.errstate(over="ignore"):  # what is as flat as that is not kept
        return np.exp(centre - width * a / b), width / b


def _likelihood(
    a: np.ndarray, b: np.ndarray, low: np.ndarray, high: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Logarithm of the likelihood, shape (fits,), its gradient, (fits, 2), and its second derivatives, (fits, 2, 2)."""
    exact = low == high
    x, y = np.where(np.isinf(low), 0.0, low), np.where(np.isinf(high), 0.0, high)
    lower, upper = a[:, None] + b[:, None] * low, a[:, None] + b[:, None] * high
    # in the upper tail the difference of two probabilities near 1 is that of their complements
    flip = lower > 0
    bottom, top = np.where(flip, -upper, lower), np.where(flip, -lower, upper)
    log_top, log_bottom = log_ndtr(top), log_ndtr(bottom)
    ratio = np.where(exact, -1.0, log_bottom - log_top)
    inside = log_top + np.log(-np.expm1(ratio))

    def edge(u: np.ndarray) -> np.ndarray:  # the density there over the probability between the edges
        return np.where(np.isinf(u), 0.0, np.exp(-0.5 * np.where(np.isinf(u), 0.0, u) ** 2 - _LOG_ROOT_2PI - inside))

    r, s = edge(upper), edge(lower)
    u, v = np.where(np.isinf(upper), 0.0, upper), np.where(np.isinf(lower), 0.0, lower)
    d_a, d_b = r - s, r * y - s * x
    bend_a, bend_b, bend_ab = v * s - u * r, v * s * x * x - u * r * y * y, v * s * x - u * r * y
    value = np.where(exact, np.log(b)[:, None] - 0.5 * v**2 - _LOG_ROOT_2PI, inside)
    one = np.ones_like(v)
    d_a, d_b = np.where(exact, -v, d_a), np.where(exact, one / b[:, None] - v * x, d_b)
    h_aa = np.where(exact, -one, bend_a - d_a**2)
    h_ab = np.where(exact, -x * one, bend_ab - (r - s) * (r * y - s * x))
    h_bb = np.where(exact, -x * x - one / b[:, None] ** 2, bend_b - (r * y - s * x) ** 2)
    gradient = np.stack([(weights * d_a).sum(axis=1), (weights * d_b).sum(axis=1)], axis=-1)
    rows = [[(weights * h).sum(axis=1) for h in line] for line in ((h_aa, h_ab), (h_ab, h_bb))]
    return (weights * value).sum(axis=1), gradient, np.stack([np.stack(line, axis=-1) for line in rows], axis=-2)


# Clouds


def fit_cloud(intensity: np.ndarray, demand: np.ndarray, motion: np.ndarray) -> Curve:
    """The curve of P(demand > 1 | intensity): median exp(-intercept / slope), spread scatter / slope of the line
    ln demand = intercept + slope ln intensity.

    intensity, demand, motion : of each analysis, both above 0, and the number of its motion, shape (n,)
    """
    motions = int(np.unique(motion).size)
    if motions < FEWEST or np.ptp(np.log(intensity)) <= 1e-12:
        return Curve(Outcome.FEW, motions, None, None, (0.0, np.inf))
    fits = _lines(intensity, demand, np.ones((1, intensity.size)))
    found, median, spread = Outcome(fits.outcome[0]), float(fits.median[0]), float(fits.spread[0])
    if found is Outcome.FLAT:
        return Curve(found, motions, None, None, (0.0, np.inf))
    fitted = found is Outcome.FITTED
    return Curve(found, motions, median if fitted else None, spread if fitted else None, (median, median))


def draw_cloud(intensity: np.ndarray, demand: np.ndarray, motion: np.ndarray, times: np.ndarray) -> Fits:
    """The fit of every draw; `times` : `resamples`. Draws of too few motions have no trend."""
    return _lines(intensity, demand, times[:, motion].astype(float))


def _lines(intensity: np.ndarray, demand: np.ndarray, weights: np.ndarray) -> Fits:
    """Curves from lines of least squares, for many weights of the same points, shape (fits, n)."""
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
    scatter = np.sqrt(left / np.where(told, total - 2, 1.0))
    rises = told & (slope > 1e-9)
    rise = np.where(rises, slope, 1.0)
    share = (weights * (y > 0)).sum(axis=1) / np.maximum(total, 1e-300)
    with np.errstate(over="ignore"):
        median = np.exp((slope * mean_x - mean_y) / rise)
    spread = scatter / rise
    flat = ~rises | (spread > MOST_SPREAD)
    outcome = np.full(len(weights), Outcome.FITTED, dtype=object)
    outcome[spread <= 1e-12] = Outcome.SEPARATED
    outcome[flat] = Outcome.FLAT
    median = np.where(flat, np.where(share < 0.5, np.inf, 0.0), median)
    return Fits(outcome, median, np.where(flat, np.inf, spread), share)


# Bands


@dataclass(frozen=True)
class Bands:
    """What the draws say of a curve; ends are 0 or inf where the draws leave them open.

    median, spread : low and high end
    low, high : of the probability [-], shape (intensities,)
    unfitted : draws without a fit; they count with what a fit would tend to
    """

    median: tuple[float, float]
    spread: tuple[float, float]
    low: np.ndarray
    high: np.ndarray
    unfitted: int


def resamples(motions: int, draws: int = DRAWS, seed: int = _SEED) -> np.ndarray:
    """How often each motion is taken in each draw, shape (draws, motions); the same for the same arguments.

    Curves of the same motions that are drawn alike can be compared draw by draw.
    """
    generator = np.random.Generator(np.random.PCG64(seed))
    return generator.multinomial(motions, np.full(motions, 1.0 / motions), size=draws)


def bands(fits: Fits, intensity: np.ndarray, confidence: float = CONFIDENCE) -> Bands:
    """Percentile bands of median, spread and probability.

    fits : of all draws; intensity : where the probability is wanted, above 0, shape (intensities,)
    """
    low, high = _interval(fits.probability(np.asarray(intensity, dtype=float)), confidence)
    median, spread = _interval(fits.median, confidence), _interval(fits.spread, confidence)
    return Bands(median, spread, low, high, int((fits.outcome != Outcome.FITTED).sum()))


def median_ratio(first: Fits, second: Fits, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Band of the median of `second` over that of `first` [-], both of the same draws.

    A draw whose ratio has no value, both medians beyond the same end, is taken as 1.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = second.median / first.median
    return _interval(np.where(np.isnan(ratio), 1.0, ratio), confidence)


def _interval(values: np.ndarray, confidence: float) -> tuple:
    """Both ends of the middle part of the draws; infinite values are values like any other."""
    ends = 0.5 - confidence / 2, 0.5 + confidence / 2
    low, high = np.quantile(values, ends, axis=0, method="inverted_cdf")
    return low, high
