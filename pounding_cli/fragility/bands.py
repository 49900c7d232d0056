"""Bootstrap bands of fragility curves: motions are drawn again and again, and every draw is fitted.

Efron, B. and Tibshirani, R. (1993). An Introduction to the Bootstrap. Chapman & Hall, percentile intervals (ch. 13).
The motion is what is drawn, with all its observations: they are not independent of each other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli.fragility.curve import Outcome
from pounding_cli.fragility.likelihood import Brackets, Fits, fit_many

DRAWS = 1000
"""Draws of a bootstrap by default."""

CONFIDENCE = 0.9
"""Part of the draws that lies in a band by default [-]."""

_SEED = 20260101


@dataclass(frozen=True)
class Bands:
    """What the draws say of a curve; ends are 0 or inf where the draws leave them open.

    median, spread : low and high end
    low, high : of the probability [-], shape (intensities,)
    unfitted : draws without a fit; they count with what a fit would tend to
    draws : in all
    """

    median: tuple[float, float]
    spread: tuple[float, float]
    low: np.ndarray
    high: np.ndarray
    unfitted: int
    draws: int


def resamples(motions: int, draws: int = DRAWS, seed: int = _SEED) -> np.ndarray:
    """How often each motion is taken in each draw, shape (draws, motions); the same for the same arguments.

    Curves of the same motions that are drawn alike can be compared draw by draw.
    """
    generator = np.random.Generator(np.random.PCG64(seed))
    return generator.multinomial(motions, np.full(motions, 1.0 / motions), size=draws)


def draw(brackets: Brackets, times: np.ndarray) -> Fits:
    """The fit of every draw; `times` : `resamples` of as many motions as `brackets` has."""
    # observations alike are one of more weight: of stripes there are few different ones
    ends, which = np.unique(np.stack([brackets.low, brackets.high]), axis=1, return_inverse=True)
    alike = np.zeros((brackets.count.size, ends.shape[1]))
    alike[np.arange(brackets.count.size), which.ravel()] = 1.0
    different = Brackets(np.zeros(ends.shape[1], int), ends[0], ends[1], np.ones(ends.shape[1]), brackets.motions)
    return fit_many(different, brackets.weights(times) @ alike)


def bands(fits: Fits, intensity: np.ndarray, confidence: float = CONFIDENCE) -> Bands:
    """Percentile bands of median, spread and probability.

    fits : of all draws; intensity : where the probability is wanted, above 0, shape (intensities,)
    """
    ends = _ends(confidence)
    low, high = _quantiles(fits.probability(np.asarray(intensity, dtype=float)), ends)
    unfitted = int((fits.outcome != Outcome.FITTED).sum())
    median, spread = _pair(_quantiles(fits.median, ends)), _pair(_quantiles(fits.spread, ends))
    return Bands(median, spread, low, high, unfitted, len(fits.median))


def median_ratio(first: Fits, second: Fits, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Band of the median of `second` over that of `first` [-], both of the same draws.

    A draw whose ratio has no value, both medians beyond the same end, is taken as 1.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = second.median / first.median
    return _pair(_quantiles(np.where(np.isnan(ratio), 1.0, ratio), _ends(confidence)))


def _ends(confidence: float) -> tuple[float, float]:
    return 0.5 - confidence / 2, 0.5 + confidence / 2


def _quantiles(values: np.ndarray, ends: tuple[float, float]) -> np.ndarray:
    """Quantiles over the draws; infinite values are values like any other."""
    return np.quantile(values, ends, axis=0, method="inverted_cdf")


def _pair(values: np.ndarray) -> tuple[float, float]:
    return float(values[0]), float(values[1])
