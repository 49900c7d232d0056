"""Sensitivity indices of a number by every key: Sobol's and those of Morris (SALib), with their intervals."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence

import numpy as np

from pounding_cli.results.tables import Filled, column
from pounding_cli.study.vary import choice_of
from pounding_cli.workflows.sensitivity_question import Question

FOUND = "found"
CONSTANT = "the output does not change"
"""Outcomes; another one says how many scenes failed."""

SHARE = 0.2
"""Lowest and highest part of a key's distribution that a tornado compares [-]."""


def independent_samples(question: Question) -> np.ndarray:
    """The samples of Sobol that are independent of each other, his matrices A and B, shape (2 x base samples,); of
    Morris the first of every trajectory."""
    keys = len(question.factors)
    block = keys + (2 if question.spec.method == "sobol" else 1)
    begins = np.arange(question.samples) * block
    return np.concatenate([begins, begins + block - 1]) if question.spec.method == "sobol" else begins


def indices(question: Question, y: np.ndarray) -> tuple[str, list[dict[str, float]]]:
    """Outcome, and the numbers of every factor by column; empty where there are none.

    y : of every sample, shape (samples,)
    """
    nothing: list[dict[str, float]] = [{} for _ in question.factors]
    if failed := int(np.isnan(y).sum()):
        return f"refused: {failed} of {y.size} samples gave no number", nothing
    if np.ptp(y) <= 1e-12 * np.abs(y).max(initial=0.0):
        return CONSTANT, nothing
    if question.spec.method == "morris":
        return FOUND, _morris(question, y)
    return FOUND, [a | b for a, b in zip(_sobol(question, y), _ends(question, y), strict=True)]


def _sobol(question: Question, y: np.ndarray) -> list[dict[str, float]]:
    """First-order and total indices with their percentile intervals, drawn base sample by base sample."""
    from SALib.analyze import sobol

    spec, tails = question.spec, 50 * (1 - question.spec.confidence)
    with np.errstate(invalid="ignore", divide="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a draw in which the output does not change
        found = sobol.analyze(
            question.problem, y, calc_second_order=False, num_resamples=spec.draws, conf_level=spec.confidence,
            keep_resamples=True, seed=spec.seed,
        )  # fmt: skip
    numbers: list[dict[str, float]] = [{} for _ in question.factors]
    for name, key in (("first", "S1"), ("total", "ST")):
        low, high = np.nanpercentile(found[f"{key}_conf_all"], [tails, 100 - tails], axis=0)
        for factor, each in enumerate(numbers):
            each |= {
                name: float(found[key][factor]),
                f"{name}_low": float(low[factor]),
                f"{name}_high": float(high[factor]),
            }
    return numbers


def _morris(question: Question, y: np.ndarray) -> list[dict[str, float]]:
    from SALib.analyze import morris

    found = morris.analyze(
        question.problem, question.grid, y, num_resamples=question.spec.draws, conf_level=question.spec.confidence,
        num_levels=question.levels, seed=question.spec.seed,
    )  # fmt: skip
    return [
        {
            "mu_star": float(found["mu_star"][factor]),
            "mu_star_low": float(found["mu_star"][factor] - found["mu_star_conf"][factor]),
            "mu_star_high": float(found["mu_star"][factor] + found["mu_star_conf"][factor]),
            "mu": float(found["mu"][factor]),
            "sigma": float(found["sigma"][factor]),
        }
        for factor in range(len(question.factors))
    ]


def _ends(question: Question, y: np.ndarray) -> Iterator[dict[str, float]]:
    """Means of the output at both ends of every key, of a choice at the options where it is least and most, each with
    its standard error."""
    some = independent_samples(question)
    y, cube = y[some], question.cube[some]
    for factor, options in enumerate(question.options):
        u = cube[:, factor]
        numbers = {"mean": float(y.mean())}
        if factor == question.motion and not question.takes_one:  # sets of motions have no ends
            yield numbers
            continue
        if options:
            option = choice_of(u, options)
            groups = [y[option == number] for number in range(options)]
            groups = sorted((group for group in groups if group.size), key=lambda group: float(group.mean()))
        else:
            groups = [y[u < SHARE], y[u >= 1 - SHARE]]
        for name, here in (("at_low", groups[0]), ("at_high", groups[-1])):
            numbers[name] = float(here.mean()) if here.size else np.nan
            numbers[f"{name}_error"] = float(here.std(ddof=1) / np.sqrt(here.size)) if here.size > 1 else np.nan
        yield numbers


def decides(question: Question, y: np.ndarray) -> tuple[str, float, float, float]:
    """The key that decides a number most, and its total index or mean elementary effect with the interval; "" where
    none can be named."""
    outcome, numbers = indices(question, y)
    name = "total" if question.spec.method == "sobol" else "mu_star"
    if outcome == FOUND:
        most = max(range(len(numbers)), key=lambda factor: numbers[factor][name])
        found = numbers[most]
        if found[name] > 0:
            return question.factors[most].key, found[name], found[f"{name}_low"], found[f"{name}_high"]
    return "", np.nan, np.nan, np.nan


def decided_columns(question: Question, numbers: Sequence[np.ndarray], what: str) -> list[Filled]:
    """The columns that say which key decides each number most."""
    keys, *shares = zip(*(decides(question, y) for y in numbers), strict=True) if numbers else ((),) * 4
    measure = "total index" if question.spec.method == "sobol" else "mean elementary effect"
    interval = f"end of its {question.spec.confidence:.4g} bootstrap interval"
    columns = [column("decided_by", np.array(keys, object), f"key that decides {what} most; empty: none")]
    for name, text, values in zip(
        ("share", "share_low", "share_high"), (f"its {measure}", f"low {interval}", f"high {interval}"), shares,
        strict=True,
    ):  # fmt: skip
        columns.append(column(name, np.array(values, float), text, "1"))
    return columns


def probability(holds: np.ndarray, confidence: float) -> tuple[float, float, float]:
    """How likely something holds of independent samples (1, 0, NaN where it is not known), with the exact interval of
    Clopper and Pearson; NaN where it is known of none."""
    known = holds[np.isfinite(holds)]
    if not known.size:
        return np.nan, np.nan, np.nan
    from scipy.stats import binomtest

    low, high = binomtest(int(known.sum()), known.size).proportion_ci(confidence, method="exact")
    return float(known.mean()), float(low), float(high)
