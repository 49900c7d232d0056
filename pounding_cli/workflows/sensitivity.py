"""The tables of `pound sensitivity`: indices of every key, the distribution of every output, and the samples."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.results.tables import Column, Table, place_columns
from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.expression import LINK, Expression, Statement
from pounding_cli.study.vary import MOTION
from pounding_cli.workflows.expressions import Get, getter, values_of
from pounding_cli.workflows.indices import decided_columns, independent_samples, indices, probability
from pounding_cli.workflows.sampled import at_points
from pounding_cli.workflows.sensitivity_question import Question, question_of
from pounding_cli.workflows.workflow import Found, Workflow

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.batch.solve import Solver

INDICES, OUTPUTS, PROBABILITIES, SAMPLES = (
    "sensitivity", "sensitivity_outputs", "sensitivity_probabilities", "sensitivity_samples",
)  # fmt: skip
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


Judge = Callable[["Plan", "xr.Dataset", "Question"], "Iterable[Series]"]
"""judge(plan, dataset, question) -> what else may hold: 1, 0, or NaN of a sample where it is not known."""


class Sensitivity(Workflow):
    """Which of the uncertain keys matter most, and how uncertain the outputs are."""

    name = "sensitivity"

    def __init__(self, judge: Judge | None = None) -> None:
        self.judge = judge

    def check(self, study: Study) -> Question:
        """What a study asks.  Raises InputError, see `question_of`."""
        return question_of(study)

    def plan(self, study: Study) -> Plan:
        """The scenes of all samples.  Raises InputError: a sample at which the study is not sound."""
        question = question_of(study)
        sampled = at_points(study, question.keys, question.points)
        if question.takes_one:
            wanted = set(zip(question.place.tolist(), (question.motions[n] for n in question.motion_set), strict=True))
            plan = expand(sampled, asks=lambda point, _case, _analysis, name: (point[-1], name) in wanted)
        else:
            plan = expand(sampled)
        return dataclasses.replace(plan, workflow="sensitivity", harder=True)

    def run(self, study: Study, solver: Solver) -> Found:
        """Indices of every key, distributions of the outputs, probabilities of statements and of what `judge` says, the
        samples."""
        question, plan = question_of(study), self.plan(study)
        data = solver.dataset(plan)
        get = getter(plan, data)
        outputs = list(_series(plan, get, question, question.outputs))
        holds = list(_series(plan, get, question, question.statements))
        claims = list(self.judge(plan, data, question)) if self.judge and question.spec.claims else []
        found = [Table.of(INDICES, _index_columns(plan, question, [*outputs, *holds, *claims]))]
        if outputs and question.spec.method == "sobol":
            found.append(Table.of(OUTPUTS, _output_columns(plan, question, outputs)))
        if holds or claims:
            found.append(Table.of(PROBABILITIES, _probability_columns(plan, question, [*holds, *claims])))
        if outputs or holds:
            found.append(Table.of(SAMPLES, stacked(_samples(plan, question, [*outputs, *holds]))))
        return Found(plan, data, found)


ASKED = Sensitivity()


def _series(plan: Plan, get: Get, question: Question, asked: Sequence[Expression | Statement]) -> Iterator[Series]:
    """Expressions, or whether statements hold, at all samples: by point, case, analysis and what is asked."""
    others = tuple(len(axis.values) for axis in plan.axes[:-1])
    each = []
    for one in asked:
        if isinstance(one, Statement):
            each.append(one.holds(_of_samples(one.expression, get, question, len(others))))
        else:
            each.append(_of_samples(one, get, question, len(others)))
    for at in np.ndindex(each[0].shape[:3]) if each else ():
        number, case, analysis = at
        point = tuple(int(n) for n in np.unravel_index(number, others)) if others else ()
        for one, found in zip(asked, each, strict=True):
            unit = "" if isinstance(one, Statement) else one.unit
            yield Series(point, plan.cases[case], plan.analyses[analysis], str(one), unit, found[at])


def _of_samples(output: Expression, get: Get, question: Question, others: int) -> np.ndarray:
    """An expression at every sample, shape (other points, cases, analyses, samples).

    others : how many axes are swept beside that of the samples
    """
    found = None
    for number in np.unique(question.motion_set):
        mine = question.motion_set == number
        motions = slice(None) if question.drawn is None else question.drawn[number]

        def some(name: str, places: np.ndarray = question.place[mine], motions: Any = motions) -> np.ndarray:
            taken = get(name).take(places, axis=others)
            return taken[..., motions, :] if name in LINK else taken[..., motions, :, :]

        values = values_of(output, some, question.spec.over_motions)
        values = np.moveaxis(values.reshape(-1, *values.shape[others:]), 1, -1)
        if found is None:
            found = np.empty((*values.shape[:-1], mine.size))
        found[..., mine] = values
    assert found is not None  # there is a sample
    return found


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
        random = np.random.default_rng(spec.seed)
        drawn = _statistics(y[random.integers(y.size, size=(y.size, spec.draws))])
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


def _probability_columns(plan: Plan, question: Question, series: Sequence[Series]) -> list[Column]:
    """How likely every statement holds, over the independent samples, and which key decides that."""
    some, confidence = independent_samples(question), question.spec.confidence
    shares = np.array([probability(each.values[some], confidence) for each in series])
    known = [int(np.isfinite(each.values[some]).sum()) for each in series]
    failed = [int(np.isnan(each.values).sum()) for each in series]
    interval = f"end of its {confidence:.4g} interval (Clopper-Pearson)"
    return [
        *where_columns(plan, series)[:-2],
        Column("statement", texts([each.name for each in series]), "what holds"),
        Column("failed", np.array(failed), "samples without a number", "1"),
        Column("samples", np.array(known), "independent samples with a number", "1"),
        Column("probability", shares[:, 0], "part of these samples in which it holds", "1"),
        Column("probability_low", shares[:, 1], f"low {interval}", "1"),
        Column("probability_high", shares[:, 2], f"high {interval}", "1"),
        *decided_columns(question, [each.values for each in series], "whether it holds"),
    ]


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


def stacked(blocks: Iterable[Sequence[Column]]) -> list[Column]:
    """Columns of tables one below the other."""
    each = [list(block) for block in blocks]
    return [
        dataclasses.replace(first, data=np.concatenate([block[number].data for block in each]))
        for number, first in enumerate(each[0])
    ]


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
