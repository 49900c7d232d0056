"""Intervals by the bootstrap over the motions (Efron, B. and Tibshirani, R. (1993). An Introduction to the Bootstrap.
Chapman & Hall, ch. 13)."""

from __future__ import annotations

from typing import Any

import numpy as np

FEWEST_TOLD = 5
"""Motions from which an interval is told: fewer do not tell how much numbers vary from motion to motion."""

_SEED = 20260101


def draws_of(motions: int, draws: int) -> np.ndarray:
    """How often each motion is taken, shape (1 + draws, motions): once in the first row, as drawn with replacement in
    the others; the same for the same arguments, so that curves of the same motions can be compared draw by draw."""
    generator = np.random.Generator(np.random.PCG64(_SEED))
    drawn = generator.multinomial(motions, np.full(motions, 1.0 / motions), size=draws)
    return np.vstack([np.ones(motions), drawn])


def interval(values: np.ndarray, confidence: float, motions: float) -> tuple:
    """Both ends of the middle part of the draws; infinite values are values like any other. NaN for fewer motions than
    `FEWEST_TOLD`."""
    if motions < FEWEST_TOLD:
        return (np.full(np.shape(values)[1:], np.nan)[()],) * 2
    ends = 0.5 - confidence / 2, 0.5 + confidence / 2
    low, high = np.quantile(values, ends, axis=0, method="inverted_cdf")
    return low, high


def with_interval(name: str, values: np.ndarray, confidence: float, motions: float, end: str = "") -> dict[str, Any]:
    """Columns of a number and of both ends of its interval.

    values : of the motions as they are first, then of their draws
    end : of the names of the columns
    """
    low, high = interval(values[1:], confidence, motions)
    return {f"{name}{end}": values[0], f"{name}_low{end}": low, f"{name}_high{end}": high}
