"""Fragility curves by maximum likelihood: every observation is an interval that holds a motion's capacity.

The capacity of a motion is the intensity at which it first passes the limit. A motion that holds at 0.3 g and passes at
0.4 g has a capacity between them. One that passes at 0.3 g, and nothing else is known, has it in (0, 0.3 g); one that
holds there, in (0.3 g, inf). So one likelihood serves stripes, where it is the binomial one (Baker, J. W. (2015).
Efficient analytical fragility function fitting using dynamic structural analysis. Earthquake Spectra 31(1), 579-599,
eq. 11), and incremental dynamic analysis, motions that never passed the limit included.

With P(capacity < x) = Phi(a + b ln x) the logarithm of the likelihood is concave in a and b (Burridge, J. (1981). A
note on maximum likelihood estimation for regression models using grouped data. J. R. Stat. Soc. B 43(1), 41-45):
Newton's method finds its one maximum. Where it has none at a finite b > 0, the data tell why.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import log_ndtr, ndtr

from pounding_cli.fragility.curve import Curve, Outcome

MOST_SPREAD = 10.0
"""A curve with a larger logarithmic spread is told from no trend by chance alone [-]; buildings have 0.2 to 1."""

_MOST_STEPS = 200
_LOG_ROOT_2PI = 0.5 * np.log(2.0 * np.pi)


@dataclass(frozen=True)
class Brackets:
    """Intervals that hold capacities.

    motion : number of the motion each belongs to, from 0, shape (n,)
    low : the motion holds there [unit of the intensity], 0 where no such intensity is known, shape (n,)
    high : it passes there, inf where it is not known to; equal to `low` where the capacity is known, shape (n,)
    count : observations alike, shape (n,)
    motions : how many motions there are, those without an observation included
    """

    motion: np.ndarray
    low: np.ndarray
    high: np.ndarray
    count: np.ndarray
    motions: int

    @classmethod
    def of(cls, motion: np.ndarray, low: np.ndarray, high: np.ndarray, motions: int) -> Brackets:
        """One observation each; those that tell nothing, (0, inf), are left out.  Raises ValueError for low > high."""
        low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
        if not ((low >= 0) & (high > 0) & (low <= high)).all():
            raise ValueError("a bracket runs from 0 or more up to its high end")
        told = (low > 0) | (high < np.inf)
        return cls(np.asarray(motion, dtype=int)[told], low[told], high[told], np.ones(int(told.sum())), motions)

    def weights(self, times: np.ndarray) -> np.ndarray:
        """Weights of the observations where motion number m is taken times[..., m] times, shape (..., n)."""
        return times[..., self.motion] * self.count


def of_counts(intensity: np.ndarray, motions: np.ndarray, passed: np.ndarray) -> Brackets:
    """Stripes of which only counts are known: at each intensity, how many motions there were and how many passed.

    Which motion passed is not known, so such brackets cannot be resampled by motion.

    Raises
    ------
    ValueError : an intensity is not above 0, or more passed than there were
    """
    x, n, k = (np.asarray(each, dtype=float) for each in (intensity, motions, passed))
    if not ((x > 0) & (k >= 0) & (k <= n)).all():
        raise ValueError("intensities are above 0, and no more motions pass than there are")
    low = np.concatenate([np.zeros_like(x), x])
    high = np.concatenate([x, np.full_like(x, np.inf)])
    count = np.concatenate([k, n - k])
    some = count > 0
    return Brackets(np.zeros(int(some.sum()), dtype=int), low[some], high[some], count[some], int(n.max(initial=0)))


def fit(brackets: Brackets) -> Curve:
    """The curve of maximum likelihood, or why there is none."""
    fits = fit_many(brackets, brackets.count[None, :])
    found = Outcome(fits.outcome[0])
    one_intensity = found is Outcome.SEPARATED and _ends(brackets).size < 2
    if brackets.motions < 2 or not brackets.count.size or one_intensity:
        found = Outcome.FEW
    if found is Outcome.FITTED:
        median = float(fits.median[0])
        return Curve(found, brackets.motions, median, float(fits.spread[0]), (median, median))
    return Curve(found, brackets.motions, None, None, _between(brackets, found))


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


def fit_many(brackets: Brackets, weights: np.ndarray) -> Fits:
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


def _ends(brackets: Brackets) -> np.ndarray:
    """The different intensities observed."""
    ends = np.unique(np.concatenate([brackets.low, brackets.high]))
    return ends[(ends > 0) & (ends < np.inf)]


def _between(brackets: Brackets, outcome: Outcome) -> tuple[float, float]:
    if outcome is Outcome.FLAT:
        return 0.0, float("inf")
    last_held = float(brackets.low.max(initial=0.0))
    first_passed = float(brackets.high.min(initial=np.inf))
    if 0 < last_held == first_passed < np.inf:  # some hold and some pass there: the median may lie on either side
        low, high = brackets.low, brackets.high
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
    passed = high < np.inf
    # d log L / db at b = 0 is, but for a positive factor, the sum of (passed - share) ln x.
    slope = (weights * (passed - share[:, None]) * x).sum(axis=1)
    scale = (weights * np.abs(x)).sum(axis=1)
    return (weights[:, closed] > 0).any(axis=1) | (slope > 1e-12 * scale)


def _newton(brackets: Brackets, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Median and spread where the maximum is known to exist, of every row of weights."""
    ends = np.log(_ends(brackets))
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
    # In the upper tail the difference of two probabilities near 1 is that of their complements.
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
