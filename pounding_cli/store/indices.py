"""Sensitivity indices of a number by every key: Sobol's and those of Morris (SALib), with their intervals."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from pounding_cli.study.sensitivity import Question
from pounding_cli.study.vary import choice_of

FOUND = "found"
CONSTANT = "the output does not change"
"""Outcomes; another one says how many scenes failed."""

SHARE = 0.2
"""Lowest and highest part of a key's distribution that a tornado compares [-]."""

_DRAWN = 2_000_000
"""Numbers of a bootstrap that are drawn together; another number makes other draws."""

_AT_ONCE = 200_000
"""Numbers of a bootstrap that are looked at together, about: estimators hold several times as many."""


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

    count, keys = question.samples, len(question.factors)
    blocks = ((y - y.mean()) / y.std()).reshape(count, keys + 2)
    a, b = blocks[:, 0], blocks[:, -1]
    blocks_of = draws(question, count)
    found = []
    tails = 50 * (1 - question.spec.confidence)
    for factor in range(keys):
        ab = blocks[:, factor + 1]
        numbers: dict[str, float] = {}
        for name, estimate in (("first", sobol.first_order), ("total", sobol.total_order)):
            numbers[name] = float(_estimates(estimate, a, ab, b, np.arange(count)))
            drawn = np.concatenate([_estimates(estimate, a, ab, b, some) for some in blocks_of()])
            numbers[f"{name}_low"], numbers[f"{name}_high"] = np.nanpercentile(drawn, [tails, 100 - tails]).tolist()
        found.append(numbers)
    return found


def _estimates(estimate: Any, a: np.ndarray, ab: np.ndarray, b: np.ndarray, draw: np.ndarray) -> np.ndarray:
    with np.errstate(invalid="ignore", divide="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a draw in which the output does not change
        return estimate(a[draw], ab[draw], b[draw])


def draws(question: Question, count: int) -> Callable[[], Iterator[np.ndarray]]:
    """Yields the numbers of the base samples of all draws, shape (count, some draws); the same ones each time."""
    step = max(1, _DRAWN // count)

    def blocks() -> Iterator[np.ndarray]:
        random = np.random.default_rng(question.spec.seed)
        for begin in range(0, question.spec.draws, step):
            drawn = random.integers(count, size=(count, min(step, question.spec.draws - begin)))
            parts = max(1, min(drawn.shape[1] // 2, drawn.size // _AT_ONCE))  # numpy adds a single column up otherwise
            yield from map(np.ascontiguousarray, np.array_split(drawn, parts, axis=1))

    return blocks


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
