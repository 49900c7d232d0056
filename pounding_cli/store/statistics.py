"""Ratios to the building alone and their statistics over the records; nothing divides by zero."""

from __future__ import annotations

import numpy as np


def ratio(value: np.ndarray, alone: np.ndarray) -> np.ndarray:
    """value / alone [-], NaN where `alone` is zero or NaN; same shape."""
    return np.divide(value, alone, out=np.full(np.shape(value), np.nan), where=alone > 0)


def over_records(values: np.ndarray, axis: int) -> dict[str, np.ndarray]:
    """Mean, deviation (n - 1; NaN for one record), smallest, largest, number along `axis`; NaN left out."""
    used = np.isfinite(values)
    count = used.sum(axis=axis)
    mean = _over(np.where(used, values, 0.0).sum(axis=axis), count)
    away = np.where(used, values - np.expand_dims(mean, axis), 0.0)
    none = count == 0
    return {
        "mean": mean,
        "std": np.sqrt(_over((away**2).sum(axis=axis), count - 1)),
        "min": np.where(none, np.nan, np.where(used, values, np.inf).min(axis=axis)),
        "max": np.where(none, np.nan, np.where(used, values, -np.inf).max(axis=axis)),
        "count": count,
    }


def trust_of_means(
    values: np.ndarray, errors: np.ndarray, sensitivities: np.ndarray, axis: int
) -> dict[str, np.ndarray]:
    """What the means along `axis` are worth; records that were not assessed are left out, NaN where none was.

    Parameters
    ----------
    values : ratios
    errors : their relative numerical errors [-]; the mean's is at most the mean of their sizes, whatever their signs
    sensitivities : relative change of a ratio over that of the motion [-], weighted by the ratios
    """
    found = {}
    for name, share in (("error", errors), ("sensitivity", sensitivities)):
        known = np.isfinite(values) & np.isfinite(share)
        weight = np.where(known, np.abs(values), 0.0)
        total = (weight * np.where(known, share, 0.0)).sum(axis=axis)
        over = known.sum(axis=axis) if name == "error" else weight.sum(axis=axis)
        found[name] = _over(total, over)
    return found


def _over(total: np.ndarray, count: np.ndarray) -> np.ndarray:
    return np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)
