"""Seismic hazard: the annual rate at which an intensity is exceeded, and from it the annual rate of a limit.

Between the points of a hazard curve the logarithm of the rate is a straight line over the logarithm of the intensity,
so every piece is a power law, lambda(x) = k0 x^-k. Where the probability that a limit is passed is
P(x) = Phi(c + b ln x), its annual rate over a piece from x1 to x2,

    integral of P(x) |d lambda(x)|  =  P(x1) lambda(x1) - P(x2) lambda(x2)
                                       + k0 exp(k c / b + k^2 / 2 b^2) (Phi(u2) - Phi(u1)),    u = c + b ln x + k / b,

is exact. Over one power law this is k0 theta^-k exp(k^2 beta^2 / 2), with the median theta and the logarithmic spread
beta (Cornell, C. A., Jalayer, F., Hamburger, R. O. and Foutch, D. A. (2002). Probabilistic basis for 2000 SAC Federal
Emergency Management Agency steel moment frame guidelines. Journal of Structural Engineering 128(4), 526-533)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import log_ndtr, ndtr

YEARS = 50.0
"""Years of the probability that is told beside a rate."""


@dataclass(frozen=True)
class Hazard:
    """How often an intensity is exceeded, as power laws k0 x^-k.

    Below the first edge nothing is known, and nothing is counted; above the last point of a table its last power law
    goes on.

    edges : intensities between which each holds, rising from 0 or the first point of a table to inf, shape (n + 1,)
    k0, k : of each, shape (n,)
    last : the last intensity that a table has; inf of a power law
    """

    edges: np.ndarray
    k0: np.ndarray
    k: np.ndarray
    last: float = np.inf

    @classmethod
    def power_law(cls, k0: float, k: float) -> Hazard:
        """k0 x^-k at all intensities."""
        return cls(np.array([0.0, np.inf]), np.array([k0]), np.array([k]))

    @classmethod
    def table(cls, intensity: np.ndarray, rate: np.ndarray) -> Hazard:
        """Through points: intensities, rising, and annual rates, falling, shape (n,), at least two, all above 0."""
        x, y = np.log(intensity), np.log(rate)
        k = -np.diff(y) / np.diff(x)
        return cls(np.append(intensity[:-1], np.inf), np.exp(y[:-1] + k * x[:-1]), k, float(intensity[-1]))

    def rate(self, intensity: np.ndarray) -> np.ndarray:
        """Annual rate at which intensities are exceeded [1/year]; of those below the first that of the first."""
        x = np.maximum(intensity, self.edges[0])
        piece = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, self.k.size - 1)
        with np.errstate(divide="ignore"):
            return self.k0[piece] * x ** -self.k[piece]

    def contributions(self, edges: np.ndarray, intercept: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Annual rate of a limit by intensity [1/year], shape (m,).

        edges : intensities, rising, shape (m + 1,)
        intercept, slope : c and b of the probability Phi(c + b ln x) between them, shape (m,)
        """
        cuts = np.unique(np.clip(np.concatenate([edges, self.edges]), edges[0], edges[-1]))
        cuts = cuts[cuts >= self.edges[0]]
        if cuts.size < 2:
            return np.zeros(edges.size - 1)
        part = np.clip(np.searchsorted(edges, cuts[:-1], side="right") - 1, 0, edges.size - 2)
        piece = np.clip(np.searchsorted(self.edges, cuts[:-1], side="right") - 1, 0, self.k.size - 1)
        rates = _piece(cuts[:-1], cuts[1:], self.k0[piece], self.k[piece], intercept[part], slope[part])
        return np.bincount(part, rates, edges.size - 1)

    def of_lognormal(self, median: float, spread: float) -> float:
        """Annual rate at which a limit with a lognormal fragility curve is passed [1/year]; with a spread of 0 that at
        which the median is exceeded."""
        if not spread > 0:
            return float(self.rate(np.array(median)))
        slope = np.array([1.0 / spread])
        whole = np.array([self.edges[0], np.inf])
        return float(self.contributions(whole, -slope * np.log(median), slope).sum())


def _piece(
    low: np.ndarray, high: np.ndarray, k0: np.ndarray, k: np.ndarray, intercept: np.ndarray, slope: np.ndarray
) -> np.ndarray:
    """The integral of the module's first lines, of many pieces at once."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        ends = [np.where(slope == 0, intercept, intercept + slope * np.log(x)) for x in (low, high)]
        first, second = (np.where(np.isinf(x) | (x == 0), 0.0, ndtr(z) * k0 * x**-k)
                         for x, z in zip((low, high), ends, strict=True))  # fmt: skip
        shift = k / slope
        size = np.log(k0) + intercept * shift + 0.5 * shift**2
        between = _difference(ends[0] + shift, ends[1] + shift, size)
    return first - second + np.where(slope == 0, 0.0, between)


def _difference(u1: np.ndarray, u2: np.ndarray, size: np.ndarray) -> np.ndarray:
    """exp(size) (Phi(u2) - Phi(u1)); in the upper tail by the complements, whose logarithms are exact."""
    flip = np.maximum(u1, u2) > 0
    flip &= np.minimum(u1, u2) > -np.inf
    a, b = np.where(flip, -u2, u1), np.where(flip, -u1, u2)
    return np.exp(size + log_ndtr(b)) - np.exp(size + log_ndtr(a))


def probability(rate: float, years: float = YEARS) -> float:
    """Probability [-] that what comes at an annual rate [1/year] comes within so many years (Poisson process)."""
    return float(-np.expm1(-rate * years))
