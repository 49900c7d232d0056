"""Numbers of one output over all samples: its sensitivity indices and statistics, the probability of a statement."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.questions.frames import FOUND
from pounding_cli.questions.sensitivity.tables import PERCENTILES

if TYPE_CHECKING:
    from pounding_cli.questions.sensitivity.question import Sensitivity

CONSTANT = "the output does not change"
"""Outcome beside FOUND; another one says how many samples have no value."""

END_SHARE = 0.2
"""Lowest and highest part of a key's distribution that a tornado compares [-]."""


def compute_indices(question: Sensitivity, y: np.ndarray) -> pd.DataFrame:
    """Return the sensitivity indices of an output by the method of the study, with their intervals; a row a key."""
    failed = int(np.isnan(y).sum())
    is_constant = np.ptp(y) <= 1e-12 * np.abs(y).max(initial=0.0)
    outcome = FOUND
    if failed:
        outcome = f"{failed} of {y.size} samples have no value"
    elif is_constant:
        outcome = CONSTANT
    keys = [each.key for each in question.inputs]
    frame = pd.DataFrame({"key": keys, "outcome": outcome, "failed": failed, "samples": y.size})
    if outcome != FOUND:
        return frame
    if question.spec.method == "morris":
        return frame.join(_compute_morris(question, y))
    return frame.join([_compute_sobol(question, y), _compute_ends(question, y)])


def _compute_sobol(question: Sensitivity, y: np.ndarray) -> pd.DataFrame:
    """Return first-order and total indices with their percentile intervals, drawn base sample by base sample."""
    from SALib.analyze import sobol

    spec = question.spec
    tails = 50 * (1 - spec.confidence)
    with np.errstate(invalid="ignore", divide="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a draw in which the output does not change
        indices = sobol.analyze(
            question.problem, y, calc_second_order=False, num_resamples=spec.draws, conf_level=spec.confidence,
            keep_resamples=True, seed=spec.seed,
        )  # fmt: skip
    columns: dict[str, np.ndarray] = {}
    for name, key in (("first", "S1"), ("total", "ST")):
        low, high = np.nanpercentile(indices[f"{key}_conf_all"], [tails, 100 - tails], axis=0)
        columns |= {name: np.asarray(indices[key]), f"{name}_low": low, f"{name}_high": high}
    return pd.DataFrame(columns)


def _compute_morris(question: Sensitivity, y: np.ndarray) -> pd.DataFrame:
    """Return the elementary effects: their mean size with its interval, their mean, their standard deviation."""
    from SALib.analyze import morris

    spec = question.spec
    effects = morris.analyze(
        question.problem, question.grid, y, num_resamples=spec.draws, conf_level=spec.confidence,
        num_levels=question.levels, seed=spec.seed,
    )  # fmt: skip
    mean = np.asarray(effects["mu_star"], float)
    width = np.asarray(effects["mu_star_conf"], float)
    return pd.DataFrame(
        {
            "mu_star": mean,
            "mu_star_low": mean - width,
            "mu_star_high": mean + width,
            "mu": np.asarray(effects["mu"], float),
            "sigma": np.asarray(effects["sigma"], float),
        }
    )


def _compute_ends(question: Sensitivity, y: np.ndarray) -> pd.DataFrame:
    """Return the means of the output at both ends of every key, each with its standard error.

    Of a choice they are those at the options where the output is least and most; sets of motions have no ends.
    """
    y = y[question.independent_samples]
    cube = question.cube[question.independent_samples]
    rows = []
    for each, u in zip(question.inputs, cube.T, strict=True):
        row = {"mean": y.mean()}
        ends = each.split_at_ends(u, y, END_SHARE)
        if ends is not None:
            for name, values in zip(("at_low", "at_high"), ends, strict=True):
                row[name] = values.mean() if values.size else np.nan
                row[f"{name}_error"] = values.std(ddof=1) / np.sqrt(values.size) if values.size > 1 else np.nan
        rows.append(row)
    return pd.DataFrame(rows)


def find_most_influential(method: str, indices: pd.DataFrame) -> dict[str, Any]:
    """Return the most influential key, and its total index or mean elementary effect with the interval.

    indices : of `compute_indices`
    """
    name = "total" if method == "sobol" else "mu_star"
    if name not in indices or not (indices[name] > 0).any():
        return {"most_influential": "", "influence": np.nan, "influence_low": np.nan, "influence_high": np.nan}
    row = indices.iloc[int(np.argmax(indices[name]))]
    return {
        "most_influential": row["key"],
        "influence": row[name],
        "influence_low": row[f"{name}_low"],
        "influence_high": row[f"{name}_high"],
    }


def describe_distribution(question: Sensitivity, y: np.ndarray) -> dict[str, float]:
    """Return mean, standard deviation and percentiles of an output with bootstrap intervals, over independent samples.

    They are NaN where some sample has no value.
    """
    spec = question.spec
    independent = y[question.independent_samples]
    names = ("mean", "deviation", *(f"percentile_{share}" for share in PERCENTILES))
    random = np.random.default_rng(spec.seed)
    tails = 50 * (1 - spec.confidence)
    draws = _compute_statistics(independent[random.integers(independent.size, size=(independent.size, spec.draws))])
    numbers = np.array([_compute_statistics(independent), *np.percentile(draws, [tails, 100 - tails], axis=1)])
    failed = int(np.isnan(y).sum())
    if failed:
        numbers[:] = np.nan
    row: dict[str, float] = {"failed": failed, "samples": independent.size}
    for name, (value, low, high) in zip(names, numbers.T.tolist(), strict=True):
        row |= {name: value, f"{name}_low": low, f"{name}_high": high}
    return row


def _compute_statistics(y: np.ndarray) -> np.ndarray:
    """Return mean, standard deviation and percentiles; samples first."""
    return np.stack([y.mean(axis=0), y.std(axis=0, ddof=1), *np.percentile(y, PERCENTILES, axis=0)])


def compute_probability(question: Sensitivity, holds: np.ndarray) -> dict[str, Any]:
    """Return the probability of a statement over the independent samples, with the interval of Clopper and Pearson.

    It is NaN where of no sample it is known whether the statement holds.

    holds : 1 or 0, NaN where it is not known, shape (samples,)
    """
    from scipy.stats import binomtest

    known = holds[question.independent_samples]
    known = known[np.isfinite(known)]
    share = np.nan
    low = np.nan
    high = np.nan
    if known.size:
        share = float(known.mean())
        low, high = binomtest(int(known.sum()), known.size).proportion_ci(question.spec.confidence, method="exact")
    return {
        "failed": int(np.isnan(holds).sum()),
        "samples": known.size,
        "probability": share,
        "probability_low": low,
        "probability_high": high,
    }
