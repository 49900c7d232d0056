"""Fragility from a cloud: one analysis a motion as it is, and a line through ln demand over ln intensity.

Jalayer, F., De Risi, R. and Manfredi, G. (2015). Bayesian Cloud Analysis: efficient structural fragility assessment
using linear regression. Bulletin of Earthquake Engineering 13, 1183-1203 (eqs 1 to 4, least squares).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli.fragility.curve import Curve, Outcome
from pounding_cli.fragility.likelihood import MOST_SPREAD, Fits

FEWEST = 3
"""Motions that a line and the scatter around it take."""


@dataclass(frozen=True)
class Cloud:
    """The line ln D = intercept + slope ln IM and the curve it gives.

    slope : [-]; intercept : ln of the demand at intensity 1; scatter : standard deviation of ln D (n - 2) [-]
    """

    curve: Curve
    slope: float = 0.0
    intercept: float = 0.0
    scatter: float = 0.0


def cloud(intensity: np.ndarray, demand: np.ndarray, limit: float, motion: np.ndarray | None = None) -> Cloud:
    """The curve of P(D > limit | IM): median exp((ln limit - intercept) / slope), spread scatter / slope.

    Parameters
    ----------
    intensity, demand : of each analysis, above 0, shape (n,)
    limit : of the demand, above 0
    motion : number of the motion of each; each its own unless given

    Raises
    ------
    ValueError : a value is not above 0
    """
    x, y = _logarithms(intensity, demand, limit)
    motions = len(x) if motion is None else int(np.unique(motion).size)
    lines = _Lines(x, y, np.ones((1, len(x))))
    fits = lines.fits(limit)
    slope, intercept, scatter = (float(each[0]) for each in (lines.slope, lines.intercept, lines.scatter))
    found, median, spread = Outcome(fits.outcome[0]), float(fits.median[0]), float(fits.spread[0])
    if not lines.told[0] or motions < FEWEST:
        return Cloud(Curve(Outcome.FEW, motions, None, None, (0.0, np.inf)))
    if found is Outcome.FLAT:
        return Cloud(Curve(found, motions, None, None, (0.0, np.inf)), slope, intercept, scatter)
    fitted = found is Outcome.FITTED
    curve = Curve(found, motions, median if fitted else None, spread if fitted else None, (median, median))
    return Cloud(curve, slope, intercept, scatter)


def cloud_draw(intensity: np.ndarray, demand: np.ndarray, limit: float, motion: np.ndarray, times: np.ndarray) -> Fits:
    """The fit of every draw; `times` : `resamples`, shape (draws, motions). Draws of too few motions have no trend."""
    x, y = _logarithms(intensity, demand, limit)
    return _Lines(x, y, times[:, motion].astype(float)).fits(limit)


def _logarithms(intensity: np.ndarray, demand: np.ndarray, limit: float) -> tuple[np.ndarray, np.ndarray]:
    x, y = np.asarray(intensity, dtype=float), np.asarray(demand, dtype=float)
    if not ((x > 0).all() and (y > 0).all() and limit > 0):
        raise ValueError("intensities, demands and the limit are above 0")
    return np.log(x), np.log(y)


class _Lines:
    """Least squares for many weightings of the same points, each shape (fits,).

    told : whether there are enough points at different intensities
    """

    def __init__(self, x: np.ndarray, y: np.ndarray, weights: np.ndarray) -> None:
        self.y, self.weights = y, weights
        total = weights.sum(axis=1)
        there = weights > 0
        span = np.where(there, x, -np.inf).max(axis=1, initial=-np.inf) - np.where(there, x, np.inf).min(
            axis=1, initial=np.inf
        )
        self.told = (there.sum(axis=1) >= FEWEST) & (span > 1e-12)
        some = np.where(self.told, total, 1.0)
        mean_x, mean_y = (weights @ x) / some, (weights @ y) / some
        dx, dy = x - mean_x[:, None], y - mean_y[:, None]
        squares = np.where(self.told, (weights * dx * dx).sum(axis=1), 1.0)
        self.slope = (weights * dx * dy).sum(axis=1) / squares
        self.intercept = mean_y - self.slope * mean_x
        left = (weights * (dy - self.slope[:, None] * dx) ** 2).sum(axis=1)
        self.scatter = np.sqrt(left / np.where(self.told, total - 2, 1.0))

    def fits(self, limit: float) -> Fits:
        """The curve of each."""
        rises = self.told & (self.slope > 1e-9)
        slope = np.where(rises, self.slope, 1.0)
        share = (self.weights * (self.y > np.log(limit))).sum(axis=1) / np.maximum(self.weights.sum(axis=1), 1e-300)
        with np.errstate(over="ignore"):
            median = np.exp((np.log(limit) - self.intercept) / slope)
        spread = self.scatter / slope
        outcome = np.full(len(slope), Outcome.FITTED, dtype=object)
        outcome[spread <= 1e-12] = Outcome.SEPARATED
        flat = ~rises | (spread > MOST_SPREAD)
        outcome[flat] = Outcome.FLAT
        median = np.where(flat, np.where(share < 0.5, np.inf, 0.0), median)
        return Fits(outcome, median, np.where(flat, np.inf, spread), share)
