"""The tables of `pound sensitivity`: indices of every key, the distribution of every output, and the samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.store.answers import Column, Read, Table, place_columns
from pounding_cli.store.quantities import values_of
from pounding_cli.study.expression import LINK
from pounding_cli.study.sensitivity import Question, question_of
from pounding_cli.study.varied import MOTION, choice_of

if TYPE_CHECKING:
    from pounding_cli.study import Plan

INDICES, OUTPUTS, SAMPLES = "sensitivity", "sensitivity_outputs", "sensitivity_samples"
"""Names of the tables."""

FOUND = "found"
CONSTANT = "the output does not change"
"""Outcomes; another one says how many scenes failed."""

SHARE = 0.2
"""Lowest and highest part of a key's distribution that a tornado compares [-]."""

PERCENTILES = (5, 50, 95)

_AT_ONCE = 2_000_000
"""Numbers of a bootstrap that are looked at together."""

MEANINGS = {
    "first": "first-order index: part of the variance that this key explains by itself",
    "total": "total index: part of the variance that goes when this key is known, interactions included",
    "mu_star": "mean size of the elementary effects: change of the output over the whole range of the key",
    "mu": "mean of the elementary effects, with their signs",
    "sigma": "standard deviation of the elementary effects: large where the key acts with others or not in proportion",
    "mean": "mean of the output",
    "at_low": "mean of the output where the key is in the lowest fifth of its distribution; of a choice, at the option "
    "where it is least",
    "at_high": "mean of the output where the key is in the highest fifth of its distribution; of a choice, at the "
    "option where it is most",
}


def sensitivity_tables(plan: Plan, read: Read) -> list[Table]:
    """The tables of a plan of `pound sensitivity`."""
    question = question_of(plan.study)
    found = _Outputs(plan, read, question)
    rows = list(_rows(question, found))
    tables = [Table(INDICES, [_index_columns(plan, question, found, rows)])]
    if question.spec.method == "sobol":
        tables.append(Table(OUTPUTS, [_output_columns(plan, question, found)]))
    return [*tables, Table(SAMPLES, _samples(plan, question, found))]


class _Outputs:
    """The outputs of all samples.

    values : shape (other points, cases, analyses, outputs, samples)
    """

    def __init__(self, plan: Plan, read: Read, question: Question) -> None:
        self.plan, self.question = plan, question
        self.others = tuple(len(axis.values) for axis in plan.axes[:-1])
        self._read, self._kept = read, dict[str, np.ndarray]()
        record = question.record
        parts = []
        for output in question.outputs:
            whole = values_of(output, self._get, question.spec.over_motions if record is None else None)
            whole = whole.reshape(-1, *whole.shape[len(self.others) :])  # other points, points, cases, analyses, ...
            taken = whole[:, question.place]
            if record is not None:
                taken = np.take_along_axis(taken, record[None, :, None, None, None], axis=-1)[..., 0]
            parts.append(np.moveaxis(taken, 1, -1))
        self._kept.clear()
        self.values = np.stack(parts, axis=3)

    def _get(self, name: str) -> np.ndarray:
        if name not in self._kept:
            try:
                self._kept[name] = self._read(name).astype(float)
            except KeyError:  # no case has a link
                assert name in LINK
                points = tuple(len(axis.values) for axis in self.plan.axes)
                shape = (*points, len(self.plan.cases), len(self.plan.analyses), len(self.plan.records), 0)
                self._kept[name] = np.zeros(shape)
        return self._kept[name]

    @cached_property
    def places(self) -> list[tuple[int, int, int, int]]:
        """Other point, case, analysis, output; numbers from 0."""
        return list(np.ndindex(*self.values.shape[:4]))

    @property
    def independent(self) -> np.ndarray:
        """The samples of Sobol that are independent of each other: his matrices A and B, shape (2 x base samples,)."""
        block = len(self.question.factors) + 2
        begins = np.arange(self.question.samples) * block
        return np.concatenate([begins, begins + block - 1])


@dataclass(frozen=True, eq=False)
class _Row:
    """A key's part in one output; `numbers` by column."""

    place: tuple[int, int, int, int]
    factor: int
    outcome: str
    failed: int
    numbers: dict[str, float]


def _rows(question: Question, found: _Outputs) -> Iterator[_Row]:
    analyse = _sobol if question.spec.method == "sobol" else _morris
    for place in found.places:
        y = found.values[place]
        failed = int(np.isnan(y).sum())
        outcome = FOUND if not failed else f"refused: {failed} of {y.size} samples gave no number"
        if not failed and np.ptp(y) <= 1e-12 * np.abs(y).max(initial=0.0):
            outcome = CONSTANT
        numbers: list[dict[str, float]] = [{} for _ in question.factors]
        if outcome == FOUND:
            numbers = analyse(question, y)
            if question.spec.method == "sobol":
                for factor, ends in enumerate(_ends(question, found, y)):
                    numbers[factor] |= ends
        for factor in range(len(question.factors)):
            yield _Row(place, factor, outcome, failed, numbers[factor])


def _sobol(question: Question, y: np.ndarray) -> list[dict[str, float]]:
    """First-order and total indices with their percentile intervals, drawn base sample by base sample."""
    from SALib.analyze import sobol

    count, keys = question.samples, len(question.factors)
    blocks = ((y - y.mean()) / y.std()).reshape(count, keys + 2)
    a, b = blocks[:, 0], blocks[:, -1]
    draws = _draws(question, count)
    found = []
    tails = 50 * (1 - question.spec.confidence)
    for factor in range(keys):
        ab = blocks[:, factor + 1]
        numbers: dict[str, float] = {}
        for name, estimate in (("first", sobol.first_order), ("total", sobol.total_order)):
            numbers[name] = float(estimate(a, ab, b))
            drawn = np.concatenate([_estimates(estimate, a, ab, b, some) for some in draws()])
            numbers[f"{name}_low"], numbers[f"{name}_high"] = np.nanpercentile(drawn, [tails, 100 - tails]).tolist()
        found.append(numbers)
    return found


def _estimates(estimate: Any, a: np.ndarray, ab: np.ndarray, b: np.ndarray, draw: np.ndarray) -> np.ndarray:
    with np.errstate(invalid="ignore", divide="ignore"):  # a draw in which the output does not change
        return estimate(a[draw], ab[draw], b[draw])


def _draws(question: Question, count: int) -> Callable[[], Iterator[np.ndarray]]:
    """Yields the numbers of the base samples of all draws, shape (count, some draws); the same ones each time."""
    step = max(1, _AT_ONCE // count)

    def blocks() -> Iterator[np.ndarray]:
        random = np.random.default_rng(question.spec.seed)
        for begin in range(0, question.spec.draws, step):
            yield random.integers(count, size=(count, min(step, question.spec.draws - begin)))

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


def _ends(question: Question, found: _Outputs, y: np.ndarray) -> Iterator[dict[str, float]]:
    """Means of the output at both ends of every key, of a choice at the options where it is least and most, each with
    its standard error."""
    y, cube = y[found.independent], question.cube[found.independent]
    for factor, options in enumerate(question.options):
        u = cube[:, factor]
        if options:
            option = choice_of(u, options)
            groups = [y[option == number] for number in range(options)]
            groups = sorted((group for group in groups if group.size), key=lambda group: float(group.mean()))
        else:
            groups = [y[u < SHARE], y[u >= 1 - SHARE]]
        numbers = {"mean": float(y.mean())}
        for name, here in (("at_low", groups[0]), ("at_high", groups[-1])):
            numbers[name] = float(here.mean()) if here.size else np.nan
            numbers[f"{name}_error"] = float(here.std(ddof=1) / np.sqrt(here.size)) if here.size > 1 else np.nan
        yield numbers


def _where(plan: Plan, found: _Outputs, places: list[tuple[int, int, int, int]]) -> list[Column]:
    """The columns that say where a row stands."""
    points = list(np.ndindex(*found.others))
    outputs = found.question.outputs
    return [
        *place_columns(plan.axes[:-1], [points[place[0]] for place in places]),
        Column("case", _text([plan.cases[place[1]] for place in places]), "case of the study"),
        Column("analysis", _text([plan.analyses[place[2]] for place in places]), "elastic or inelastic storeys"),
        Column("output", _text([str(outputs[place[3]]) for place in places]), "number looked at"),
        Column("unit", _text([outputs[place[3]].unit for place in places]), "SI unit of the output"),
    ]


def _index_columns(plan: Plan, question: Question, found: _Outputs, rows: list[_Row]) -> list[Column]:
    names = (
        [f"{name}{end}" for name in ("first", "total") for end in ("", "_low", "_high")]
        + ["mean"]
        + [f"{name}{end}" for name in ("at_low", "at_high") for end in ("", "_error")]
        if question.spec.method == "sobol"
        else ["mu_star", "mu_star_low", "mu_star_high", "mu", "sigma"]
    )
    confidence = f"{question.spec.confidence:.4g} bootstrap interval"
    columns = [
        *_where(plan, found, [row.place for row in rows]),
        Column("key", _text([question.factors[row.factor].key for row in rows]), "key that varies"),
        Column("outcome", _text([row.outcome for row in rows]), "found, or why there is no index"),
        Column("failed", np.array([row.failed for row in rows]), "samples without a number", "1"),
        Column("samples", np.full(len(rows), found.values.shape[-1]), "samples that the index rests on", "1"),
    ]
    for name in names:
        stem = name.removesuffix("_error")
        stem = stem if stem in MEANINGS else stem.removesuffix("_low").removesuffix("_high")
        meaning = MEANINGS[stem]
        if name.endswith("_error"):
            meaning = f"standard error: {meaning}"
        elif name != stem:
            meaning = f"{'low' if name.endswith('_low') else 'high'} end of the {confidence}: {meaning}"
        pure = stem in ("first", "total")
        columns.append(
            Column(name, np.array([row.numbers.get(name, np.nan) for row in rows]), meaning, "1" if pure else "")
        )
    return columns


def _output_columns(plan: Plan, question: Question, found: _Outputs) -> list[Column]:
    """Mean, standard deviation and percentiles of every output, with intervals, over the independent samples."""
    spec, some = question.spec, found.independent
    tails = 50 * (1 - spec.confidence)
    names = ("mean", "deviation", *(f"percentile_{share}" for share in PERCENTILES))
    rows = []
    for place in found.places:
        y = found.values[place][some]
        if np.isnan(found.values[place]).any():
            rows.append(dict.fromkeys((f"{name}{end}" for name in names for end in ("", "_low", "_high")), np.nan))
            continue
        numbers = dict(zip(names, _statistics(y).tolist(), strict=True))
        drawn = np.concatenate([_statistics(y[draw]) for draw in _draws(question, y.size)()], axis=1)
        low, high = np.percentile(drawn, [tails, 100 - tails], axis=1)
        numbers |= {f"{name}_low": value for name, value in zip(names, low.tolist(), strict=True)}
        numbers |= {f"{name}_high": value for name, value in zip(names, high.tolist(), strict=True)}
        rows.append(numbers)
    columns = _where(plan, found, found.places)
    failed = [int(np.isnan(found.values[place]).sum()) for place in found.places]
    columns.append(Column("failed", np.array(failed), "samples without a number", "1"))
    columns.append(Column("samples", np.full(len(rows), some.size), "independent samples", "1"))
    for name in names:
        for end in ("", "_low", "_high"):
            words = name.replace("deviation", "standard deviation").replace("_", " ")
            interval = f"{end[1:]} end of the {spec.confidence:.4g} bootstrap interval: " if end else ""
            data = np.array([row[f"{name}{end}"] for row in rows])
            columns.append(Column(f"{name}{end}", data, f"{interval}{words} of the output"))
    return columns


def _statistics(y: np.ndarray) -> np.ndarray:
    """Mean, standard deviation, percentiles; samples first."""
    return np.stack([y.mean(axis=0), y.std(axis=0, ddof=1), *np.percentile(y, PERCENTILES, axis=0)])


def _samples(plan: Plan, question: Question, found: _Outputs) -> Iterator[list[Column]]:
    """All samples with their outputs, in the order of the method; a block for each point, case and analysis."""
    count = len(question.cube)
    points = list(np.ndindex(*found.others))
    for other, case, analysis in np.ndindex(*found.values.shape[:3]):
        columns = [
            *place_columns(plan.axes[:-1], [points[other]] * count),
            Column("case", _text([plan.cases[case]] * count), "case of the study"),
            Column("analysis", _text([plan.analyses[analysis]] * count), "elastic or inelastic storeys"),
            Column("sample", np.arange(1, count + 1), "number of the sample", "1"),
            Column("independent", np.isin(np.arange(count), found.independent).astype(int), "1 where independent", "1"),
        ]
        for number, factor in enumerate(question.factors):
            u = question.cube[:, number]
            if factor.key == MOTION:
                assert question.record is not None
                columns.append(Column(MOTION, _text([question.motions[n] for n in question.record]), "ground motion"))
            elif factor.options:
                labels = _text([factor.labels[int(n)] for n in factor.number(u)])
                columns.append(Column(factor.key, labels, f"varies: {factor.key}"))
            else:
                unit = factor.unit
                columns.append(Column(factor.key, factor.number(u), f"varies: {factor.key}", unit.si or "1", unit))
        for number, output in enumerate(question.outputs):
            values = found.values[other, case, analysis, number]
            columns.append(Column(f"output {output}", values, "output", output.unit or "1"))
        yield columns


def _text(values: list[str]) -> np.ndarray:
    return np.array(values, dtype=object)
