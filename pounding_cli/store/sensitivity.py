"""The tables of `pound sensitivity`: indices of every key, the distribution of every output, and the samples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.store.answers import Column, Read, Table, place_columns
from pounding_cli.store.indices import draws, independent_samples, indices
from pounding_cli.store.quantities import Get, values_of
from pounding_cli.study.expression import LINK, Expression
from pounding_cli.study.sensitivity import Question
from pounding_cli.study.vary import MOTION

if TYPE_CHECKING:
    from pounding_cli.study import Plan

INDICES, OUTPUTS, SAMPLES = "sensitivity", "sensitivity_outputs", "sensitivity_samples"
"""Names of the tables."""

PERCENTILES = (5, 50, 95)

MEANINGS = {
    "first": "first-order index: part of the variance that this key explains by itself",
    "total": "total index: part of the variance that disappears if this key is known, including interactions",
    "mu_star": "mean size of the elementary effects: change of the output over the whole range of the key",
    "mu": "mean of the elementary effects, with their signs",
    "sigma": "standard deviation of the elementary effects: large where the key acts with others or not in proportion",
    "mean": "mean of the output",
    "at_low": "mean of the output where the key is in the lowest fifth of its distribution; of a choice, at the option "
    "where it is least",
    "at_high": "mean of the output where the key is in the highest fifth of its distribution; of a choice, at the "
    "option where it is most",
}


@dataclass(frozen=True, eq=False)
class Series:
    """A number looked at, over all samples.

    point : number on every other swept axis, from 0
    case, analysis : where it is; "" where it rests on all of them
    name : of the output
    unit : SI
    values : NaN where a sample gave none, shape (samples,)
    """

    point: tuple[int, ...]
    case: str
    analysis: str
    name: str
    unit: str
    values: np.ndarray


def sensitivity_tables(plan: Plan, read: Read, question: Question, more: Sequence[Series] = ()) -> list[Table]:
    """The tables of a plan of `pound sensitivity`.

    more : numbers that are looked at beside the outputs of the study
    """
    outputs = list(_outputs(plan, read, question))
    tables = [Table(INDICES, [_index_columns(plan, question, [*outputs, *more])])]
    if not outputs:
        return tables
    if question.spec.method == "sobol":
        tables.append(Table(OUTPUTS, [_output_columns(plan, question, outputs)]))
    return [*tables, Table(SAMPLES, _samples(plan, question, outputs))]


def _outputs(plan: Plan, read: Read, question: Question) -> Iterator[Series]:
    """The outputs of all samples, by point, case, analysis and output."""
    if not question.outputs:
        return
    others = tuple(len(axis.values) for axis in plan.axes[:-1])
    kept: dict[str, np.ndarray] = {}

    def get(name: str) -> np.ndarray:
        if name not in kept:
            try:
                kept[name] = read(name).astype(float)
            except KeyError:  # no case has a link
                assert name in LINK
                points = tuple(len(axis.values) for axis in plan.axes)
                kept[name] = np.zeros((*points, len(plan.cases), len(plan.analyses), len(plan.records), 0))
        return kept[name]

    found = np.stack([_of_samples(output, get, question, len(others)) for output in question.outputs], axis=3)
    for place in np.ndindex(found.shape[:4]):
        point, case, analysis, number = place
        output = question.outputs[number]
        at = tuple(int(n) for n in np.unravel_index(point, others)) if others else ()
        yield Series(at, plan.cases[case], plan.analyses[analysis], str(output), output.unit, found[place])


def _of_samples(output: Expression, get: Get, question: Question, others: int) -> np.ndarray:
    """An output of every sample, shape (other points, cases, analyses, samples)."""
    if question.drawn is None or question.takes_one:
        whole = values_of(output, get, None if question.takes_one else question.spec.over_motions)
        whole = whole.reshape(-1, *whole.shape[others:])  # other points, points, cases, analyses, ...
        taken = whole[:, question.place]
        if question.takes_one:
            taken = np.take_along_axis(taken, question.motion_set[None, :, None, None, None], axis=-1)[..., 0]
        return np.moveaxis(taken, 1, -1)
    parts = []
    for number in np.unique(question.motion_set):
        motions = question.drawn[number]
        places = question.place[question.motion_set == number]

        def some(name: str, places: np.ndarray = places, motions: np.ndarray = motions) -> np.ndarray:
            axis = -2 if name in LINK else -3
            return get(name).take(places, axis=others).take(motions, axis=axis)

        whole = values_of(output, some, question.spec.over_motions)
        parts.append(whole.reshape(-1, *whole.shape[others:]))
    back = np.argsort(np.argsort(question.motion_set, kind="stable"), kind="stable")
    return np.moveaxis(np.concatenate(parts, axis=1)[:, back], 1, -1)


def where_columns(plan: Plan, series: Sequence[Series]) -> list[Column]:
    """The columns that say where a row stands."""
    return [
        *place_columns(plan.axes[:-1], [each.point for each in series]),
        Column("case", texts([each.case for each in series]), "case of the study; empty: all of them"),
        Column("analysis", texts([each.analysis for each in series]), "elastic or inelastic storeys; empty: both"),
        Column("output", texts([each.name for each in series]), "number looked at"),
        Column("unit", texts([each.unit for each in series]), "SI unit of the output"),
    ]


def _index_columns(plan: Plan, question: Question, series: Sequence[Series]) -> list[Column]:
    names = (
        [f"{name}{end}" for name in ("first", "total") for end in ("", "_low", "_high")]
        + ["mean"]
        + [f"{name}{end}" for name in ("at_low", "at_high") for end in ("", "_error")]
        if question.spec.method == "sobol"
        else ["mu_star", "mu_star_low", "mu_star_high", "mu", "sigma"]
    )
    found = [(each, *indices(question, each.values)) for each in series]
    rows = [
        (each, outcome, factor.key, numbers[number])
        for each, outcome, numbers in found
        for number, factor in enumerate(question.factors)
    ]
    confidence = f"{question.spec.confidence:.4g} bootstrap interval"
    failed = [int(np.isnan(each.values).sum()) for each, *_ in rows]
    columns = [
        *where_columns(plan, [each for each, *_ in rows]),
        Column("key", texts([key for *_, key, _ in rows]), "key that varies, the first of those that move together"),
        Column("outcome", texts([outcome for _, outcome, *_ in rows]), "outcome, or why there is no index"),
        Column("failed", np.array(failed), "samples without a number", "1"),
        Column("samples", np.full(len(rows), len(question.cube)), "samples of the index", "1"),
    ]
    for name in names:
        stem = name.removesuffix("_error")
        stem = stem if stem in MEANINGS else stem.removesuffix("_low").removesuffix("_high")
        meaning = MEANINGS[stem]
        if name.endswith("_error"):
            meaning = f"standard error: {meaning}"
        elif name != stem:
            meaning = f"{'low' if name.endswith('_low') else 'high'} end of the {confidence}: {meaning}"
        data = np.array([numbers.get(name, np.nan) for *_, numbers in rows])
        columns.append(Column(name, data, meaning, "1" if stem in ("first", "total") else ""))
    return columns


def _output_columns(plan: Plan, question: Question, series: Sequence[Series]) -> list[Column]:
    """Mean, standard deviation and percentiles of every output, with intervals, over the independent samples."""
    spec, some = question.spec, independent_samples(question)
    tails = 50 * (1 - spec.confidence)
    names = ("mean", "deviation", *(f"percentile_{share}" for share in PERCENTILES))
    rows = []
    for each in series:
        y = each.values[some]
        if np.isnan(each.values).any():
            rows.append(dict.fromkeys((f"{name}{end}" for name in names for end in ("", "_low", "_high")), np.nan))
            continue
        numbers = dict(zip(names, _statistics(y).tolist(), strict=True))
        drawn = np.concatenate([_statistics(y[draw]) for draw in draws(question, y.size)()], axis=1)
        low, high = np.percentile(drawn, [tails, 100 - tails], axis=1)
        numbers |= {f"{name}_low": value for name, value in zip(names, low.tolist(), strict=True)}
        numbers |= {f"{name}_high": value for name, value in zip(names, high.tolist(), strict=True)}
        rows.append(numbers)
    columns = where_columns(plan, series)
    failed = [int(np.isnan(each.values).sum()) for each in series]
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


def sample_columns(plan: Plan, question: Question, point: tuple[int, ...]) -> list[Column]:
    """All samples in the order of the method: number, whether independent, the values of the keys.

    point : on the other swept axes
    """
    count = len(question.cube)
    independent = np.isin(np.arange(count), independent_samples(question)).astype(int)
    columns = [
        *place_columns(plan.axes[:-1], [point] * count),
        Column("sample", np.arange(1, count + 1), "number of the sample", "1"),
        Column("independent", independent, "1 where independent", "1"),
    ]
    for number, factor in enumerate(question.factors):
        if factor.key == MOTION:
            labels = [question.motion_label(n) for n in question.motion_set]
            columns.append(Column(MOTION, texts(labels), "ground motions"))
            continue
        for member in factor.members:
            u = question.cube[:, number]
            if member.options:
                labels = [member.labels[int(n)] for n in member.number(u)]
                columns.append(Column(member.key, texts(labels), f"varies: {member.key}"))
            else:
                unit = member.unit
                columns.append(Column(member.key, member.number(u), f"varies: {member.key}", unit.si or "1", unit))
    return columns


def _samples(plan: Plan, question: Question, series: Sequence[Series]) -> Iterator[list[Column]]:
    """All samples with their outputs; a block for each point, case and analysis."""
    blocks: dict[tuple, list[Series]] = {}
    for each in series:
        blocks.setdefault((each.point, each.case, each.analysis), []).append(each)
    for (point, case, analysis), mine in blocks.items():
        count, keys = len(question.cube), sample_columns(plan, question, point)
        swept = sum(len(axis.names) for axis in plan.axes[:-1])
        yield [
            *keys[:swept],
            Column("case", texts([case] * count), "case of the study"),
            Column("analysis", texts([analysis] * count), "elastic or inelastic storeys"),
            *keys[swept:],
            *(Column(f"output {each.name}", each.values, "output", each.unit or "1") for each in mine),
        ]


def texts(values: Sequence[str]) -> np.ndarray:
    """A column of texts."""
    return np.array(values, dtype=object)
