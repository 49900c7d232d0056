"""Fragility from a cloud: one analysis a motion as it is, and a line through ln demand over ln intensity.

Jalayer, F., De Risi, R. and Manfredi, G. (2015). Bayesian Cloud Analysis: efficient structural fragility assessment
using linear regression. Bulletin of Earthquake Engineering 13, 1183-1203 (eqs 1 to 4, least squares).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli.fragility.curve import Curve, Outcome

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


def cloud(intensity: np.ndarray, demand: np.ndarray, limit: float, weights: np.ndarray | None = None) -> Cloud:
    """The curve of P(D > limit | IM): median exp((ln limit - intercept) / slope), spread scatter / slope.

    Parameters
    ----------
    intensity, demand : one a motion, shape (n,); intensities and demands above 0
    limit : of the demand, above 0
    weights : how often each motion is taken; once unless given

    Raises
    ------
    ValueError : a value is not above 0
    """
    x, y = np.asarray(intensity, dtype=float), np.asarray(demand, dtype=float)
    if not ((x > 0).all() and (y > 0).all() and limit > 0):
        raise ValueError("intensities, demands and the limit are above 0")
    w = np.ones(len(x)) if weights is None else np.asarray(weights, dtype=float)
    taken = w > 0
    motions, total = int(taken.sum()), float(w.sum())
    x, y, w = np.log(x[taken]), np.log(y[taken]), w[taken]
    if motions < FEWEST or float(np.ptp(x)) <= 1e-12:
        return Cloud(Curve(Outcome.FEW, motions, None, None, (0.0, np.inf)))
    dx, dy = x - np.average(x, weights=w), y - np.average(y, weights=w)
    slope = float((w * dx * dy).sum() / (w * dx * dx).sum())
    intercept = float(np.average(y, weights=w) - slope * np.average(x, weights=w))
    scatter = float(np.sqrt((w * (dy - slope * dx) ** 2).sum() / (total - 2)))
    if slope <= 1e-9:
        return Cloud(Curve(Outcome.FLAT, motions, None, None, (0.0, np.inf)), slope, intercept, scatter)
    median = float(np.exp((np.log(limit) - intercept) / slope))
    if scatter <= 1e-12:
        return Cloud(Curve(Outcome.SEPARATED, motions, None, None, (median, median)), slope, intercept, scatter)
    return Cloud(Curve(Outcome.FITTED, motions, median, scatter / slope, (median, median)), slope, intercept, scatter)
