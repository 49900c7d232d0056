"""Intervals by the bootstrap over the motions (Efron, B. and Tibshirani, R. (1993). An Introduction to the Bootstrap.
Chapman & Hall, ch. 13)."""

from __future__ import annotations

from typing import Any

import numpy as np

MIN_MOTIONS = 5
"""Motions from which an interval is given: fewer do not show how much numbers vary from motion to motion."""

DRAWS = 300
"""Draws of the bootstraps of `pound gap`, over motions and over neighbours."""

_SEED = 20260101


def draw_motions(motions: int, draws: int) -> np.ndarray:
    """Return how often every draw takes each motion, shape (1 + draws, motions).

    The first row takes each motion once, the others are drawn with replacement. The same arguments give the same draws,
    so that curves of the same motions can be compared draw by draw.
    """
    generator = np.random.Generator(np.random.PCG64(_SEED))
    counts = generator.multinomial(motions, np.full(motions, 1.0 / motions), size=draws)
    return np.vstack([np.ones(motions), counts])


def build_estimate(name: str, values: np.ndarray, confidence: float, motions: float) -> dict[str, Any]:
    """Return a number and both ends of its interval, as columns `name`, `name_low` and `name_high`.

    values : of the motions as they are first, then of their draws
    """
    low, high = compute_interval(values[1:], confidence, motions)
    return {name: values[0], f"{name}_low": low, f"{name}_high": high}


def compute_interval(values: np.ndarray, confidence: float, motions: float) -> tuple[Any, Any]:
    """Return both ends of the middle part of the draws; NaN for fewer motions than `MIN_MOTIONS`.

    values : of the draws, over the first axis; infinite ones are values like any other
    confidence : that part [-]
    """
    if motions < MIN_MOTIONS:
        nothing = np.full(np.shape(values)[1:], np.nan)[()]
        return nothing, nothing
    ends = (0.5 - confidence / 2, 0.5 + confidence / 2)
    low, high = np.quantile(values, ends, axis=0, method="inverted_cdf")
    return low, high
