"""Find what decides about a pair of neighbours: the unknown quantity that moves the closing most.

The buildings that the neighbours may be are a Latin hypercube. Of every uncertain quantity they fall into thirds: those
with a low, a middling and a high value. Where the logarithm of the closing differs from third to third more than it
does by chance, the quantity explains a part of its variance: epsilon squared, the correlation ratio less what as many
random groups would explain (Kelley, T. L. (1935). An unbiased correlation ratio measure. Proceedings of the National
Academy of Sciences 21(9), 554-559). What differs between the motions, building by building, is the part of the motion.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

OF_MOTIONS = "motion"
"""Name of the part of the motions."""

THIRDS = 3
MIN_BUILDINGS = 6
"""Number of buildings from which thirds say something."""


def find_variance_shares(log_closings: np.ndarray, scores: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Return the share of the variance of the closings that the motions and each quantity explain, the largest first.

    Shares need not sum up to 1: quantities act together too. Those that explain no more than chance have 0.

    log_closings : shape (levels, neighbours, motions); NaN of runs that failed
    scores : values of every uncertain quantity, in any scale, shape (neighbours,)
    """
    centred = log_closings - np.nanmean(log_closings, axis=(1, 2), keepdims=True)
    by_building = np.nanmean(centred, axis=(0, 2))
    within = float(np.nanmean(np.nanvar(centred, axis=2)))
    between = float(np.nanmean(np.nanvar(np.nanmean(centred, axis=2), axis=1)))
    total = within + between
    if not total > 0:
        return {}
    shares = {OF_MOTIONS: within / total}
    known = np.isfinite(by_building)
    if known.sum() >= MIN_BUILDINGS:
        for name, values in scores.items():
            explained = _explain_variance(by_building[known], values[known])
            shares[name] = explained * between / total
    return dict(sorted(shares.items(), key=lambda item: -item[1]))


def find_decision(shares: Mapping[str, float]) -> tuple[str, float]:
    """Return what of the buildings explains most of the variance, and its share; "" where nothing explains more than
    chance.

    shares : of `find_shares`
    """
    of_buildings = {name: share for name, share in shares.items() if name != OF_MOTIONS and share > 0}
    if not of_buildings:
        return "", np.nan
    name = max(of_buildings, key=lambda each: of_buildings[each])
    return name, of_buildings[name]


def _explain_variance(values: np.ndarray, scores: np.ndarray) -> float:
    """Return the part of the variance of some values that thirds of their scores explain, epsilon squared."""
    thirds = np.array_split(values[np.argsort(scores, kind="stable")], THIRDS)
    total = float(((values - values.mean()) ** 2).sum())
    if total == 0:
        return 0.0
    inside = sum(float(((third - third.mean()) ** 2).sum()) for third in thirds)
    mean_inside = inside / (values.size - THIRDS)
    return max((total - inside - (THIRDS - 1) * mean_inside) / total, 0.0)
