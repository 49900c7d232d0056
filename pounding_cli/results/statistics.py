"""Statistics over the motions of ratios to the building alone, and what their means are worth."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from pounding_cli.variables import RATIOS


def statistics(found: Mapping[str, xr.Variable], alone_errors: np.ndarray) -> dict[str, xr.Variable]:
    """The variables of `variables.STATISTICS`.

    Mean, standard deviation (n - 1; NaN for one motion), smallest, largest and number of the motions that have a
    ratio; error and sensitivity of the mean over the motions that were assessed, NaN where none was.

    alone_errors : relative errors of the buildings alone [-], shape (points..., cases, analyses, motions, buildings)
    """
    # a ratio is at most as wrong as both of its peaks together, and a mean as the mean of these, whatever their signs
    errors = (found["error_estimate"].values[..., None] + alone_errors)[..., None]
    sensitivities = found["sensitivity"].values[..., None, None]
    kept: dict[str, xr.Variable] = {}
    for name in RATIOS:
        variable = found[name]
        dims, values = [dim for dim in variable.dims if dim != "record"], variable.values
        each = _over_motions(values) | {
            "mean_error": _mean(np.abs(values) * errors),
            "mean_sensitivity": _mean(np.abs(values) * sensitivities, np.abs(values)),
        }
        kept |= {f"{name}_{word}": xr.Variable(dims, array, fastpath=True) for word, array in each.items()}
    return kept


def _over_motions(values: np.ndarray) -> dict[str, np.ndarray]:
    """Statistics over the third axis from the end, of what is finite."""
    used = np.isfinite(values)
    count, mean = used.sum(axis=-3), _mean(values)
    away = np.where(used, values - np.expand_dims(mean, -3), 0.0)
    none = count == 0
    return {
        "mean": mean,
        "std": np.sqrt(_over((away**2).sum(axis=-3), count - 1)),
        "min": np.where(none, np.nan, np.where(used, values, np.inf).min(axis=-3)),
        "max": np.where(none, np.nan, np.where(used, values, -np.inf).max(axis=-3)),
        "count": count,
    }


def _mean(values: np.ndarray, weights: np.ndarray | float = 1.0) -> np.ndarray:
    """Sum over that of the weights, over the third axis from the end, of what is finite; NaN where nothing is."""
    used = np.isfinite(values)
    return _over(np.where(used, values, 0.0).sum(axis=-3), np.where(used, weights, 0.0).sum(axis=-3))


def _over(total: np.ndarray, count: np.ndarray) -> np.ndarray:
    return np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)
