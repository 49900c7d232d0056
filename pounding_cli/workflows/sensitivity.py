"""`pound sensitivity`: indices of every key (SALib), distributions of outputs, probabilities, and the samples."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd

from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.expression import Expression, Statement
from pounding_cli.study.vary import MOTION, choice_of
from pounding_cli.workflows.expressions import Get, getter, values_of
from pounding_cli.workflows.sampled import at_points
from pounding_cli.workflows.sensitivity_question import Question, question_of
from pounding_cli.workflows.workflow import Columns, Found, Table, Workflow, swept, tabled

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.batch.solve import Solver

INDICES, OUTPUTS, PROBABILITIES, SAMPLES = (
    "sensitivity", "sensitivity_outputs", "sensitivity_probabilities", "sensitivity_samples",
)  # fmt: skip
"""Names of the tables."""

FOUND = "found"
CONSTANT = "the output does not change"
"""Outcomes; another one says how many scenes failed."""

PERCENTILES = (5, 50, 95)

SHARE = 0.2
"""Lowest and highest part of a key's distribution that a tornado compares [-]."""

_COLUMNS: Columns = {
    "case": ("", "case of the study; empty: all of them"),
    "analysis": ("", "elastic or inelastic storeys; empty: both"),
    "output": ("", "number looked at"),
    "statement": ("", "what holds"),
    "unit": ("", "SI unit of the output"),
    "key": ("", "key that varies, the first of those that move together"),
    "outcome": ("", "outcome, or why there is no index"),
    "failed": ("1", "samples without a number"),
    "samples": ("1", "samples that the row rests on; of outputs and probabilities those that are independent"),
    "first": ("1", "first-order index: part of the variance that this key explains by itself"),
    "total": ("1", "total index: part of the variance that disappears if this key is known, including interactions"),
    "mu_star": ("", "mean size of the elementary effects: change of the output over the whole range of the key"),
    "mu": ("", "mean of the elementary effects, with their signs"),
    "sigma": ("", "standard deviation of the elementary effects: large where the key acts with others or not in "
              "proportion"),
    "mean": ("", "mean of the output"),
    "deviation": ("", "standard deviation of the output"),
    **{f"percentile_{share}": ("", f"percentile {share} of the output") for share in PERCENTILES},
    "at_low": ("", "mean of the output where the key is in the lowest fifth of its distribution; of a choice, at the "
               "option where it is least"),
    "at_high": ("", "mean of the output where the key is in the highest fifth of its distribution; of a choice, at the "
                "option where it is most"),
    "probability": ("1", "part of these samples in which it holds; its interval is that of Clopper and Pearson"),
    "decided_by": ("", "key that decides most whether it holds; empty: none"),
    "share": ("1", "its total index or mean elementary effect"),
    "sample": ("1", "number of the sample"),
    "independent": ("1", "1 where independent"),
}  # fmt: skip


class Series(NamedTuple):
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
        points, place = question.distinct
        sampled = at_points(study, question.keys, points)
        if question.drawn is None:
            plan = expand(sampled)
        else:
            wanted = {(at, question.motions[n]) for at, n in np.broadcast(place[:, None], question.drawn)}
            plan = expand(sampled, asks=lambda point, _case, _analysis, name: (point[-1], name) in wanted)
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
        each = [indices(question, each.values) for each in (*outputs, *holds, *claims)]
        where = _where(plan, [*outputs, *holds, *claims])
        rows = where.loc[np.repeat(where.index, len(question.factors))].reset_index(drop=True)
        tables = [tabled(INDICES, rows.join(pd.concat(each, ignore_index=True)), _COLUMNS, plan.axes)]
        if outputs and question.spec.method == "sobol":
            numbers = pd.DataFrame([distribution(question, each.values) for each in outputs])
            tables.append(tabled(OUTPUTS, _where(plan, outputs).join(numbers), _COLUMNS, plan.axes))
        if said := [*holds, *claims]:
            numbers = pd.DataFrame([probability(question, each.values) for each in said])
            decided = pd.DataFrame([_decided(question, each) for each in each[len(outputs) :]])
            frame = _where(plan, said).drop(columns="unit").rename(columns={"output": "statement"})
            tables.append(tabled(PROBABILITIES, frame.join([numbers, decided]), _COLUMNS, plan.axes))
        if outputs or holds:
            tables.append(_samples(plan, question, [*outputs, *holds]))
        return Found(plan, data, tables)


ASKED = Sensitivity()


# What is looked at


def _series(plan: Plan, get: Get, question: Question, asked: Sequence[Expression | Statement]) -> Iterator[Series]:
    """Expressions, or whether statements hold, at all samples: by point, case, analysis and what is asked."""
    others = tuple(len(axis.values) for axis in plan.axes[:-1])
    each = [
        one.holds(_of_samples(one.expression, get, question, len(others))) if isinstance(one, Statement)
        else _of_samples(one, get, question, len(others)) for one in asked
    ]  # fmt: skip
    for *point, case, analysis in np.ndindex(*others, len(plan.cases), len(plan.analyses)) if each else ():
        for one, found in zip(asked, each, strict=True):
            unit = "" if isinstance(one, Statement) else one.unit
            values = found[(*point, case, analysis)]
            yield Series(tuple(point), plan.cases[case], plan.analyses[analysis], str(one), unit, values)


def _of_samples(output: Expression, get: Get, question: Question, others: int) -> np.ndarray:
    """An expression at every sample, shape (points of other axes ..., cases, analyses, samples).

    others : how many axes are swept beside that of the samples
    """

    def some(name: str) -> np.ndarray:
        values = get(name).take(question.distinct[1], axis=others)
        if question.drawn is None:
            return values
        shape = [1] * values.ndim
        shape[others], shape[others + 3] = question.drawn.shape  # samples and motions
        return np.take_along_axis(values, question.drawn.reshape(shape), axis=others + 3)

    return np.moveaxis(values_of(output, some, question.spec.over_motions), others, -1)


# Numbers of one output; y : of every sample, NaN where it gave none, shape (samples,)


def indices(question: Question, y: np.ndarray) -> pd.DataFrame:
    """Sensitivity indices of an output by every key, Sobol's or those of Morris, with their intervals; a row a key."""
    failed, is_sobol = int(np.isnan(y).sum()), question.spec.method == "sobol"
    found = pd.DataFrame({"key": [factor.key for factor in question.factors], "outcome": FOUND, "failed": failed,
                          "samples": y.size})  # fmt: skip
    if failed or np.ptp(y) <= 1e-12 * np.abs(y).max(initial=0.0):
        names = _SOBOL if is_sobol else _MORRIS
        outcome = f"refused: {failed} of {y.size} samples gave no number" if failed else CONSTANT
        return found.assign(outcome=outcome, **dict.fromkeys(names, np.nan))
    return found.join(_sobol(question, y).join(_ends(question, y)) if is_sobol else _morris(question, y))


_SOBOL = (
    "first", "first_low", "first_high", "total", "total_low", "total_high",
    "mean", "at_low", "at_low_error", "at_high", "at_high_error",
)  # fmt: skip
_MORRIS = ("mu_star", "mu_star_low", "mu_star_high", "mu", "sigma")
"""What is found by each method."""


def _sobol(question: Question, y: np.ndarray) -> pd.DataFrame:
    """First-order and total indices with their percentile intervals, drawn base sample by base sample."""
    from SALib.analyze import sobol

    spec, tails = question.spec, 50 * (1 - question.spec.confidence)
    with np.errstate(invalid="ignore", divide="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a draw in which the output does not change
        found = sobol.analyze(
            question.problem, y, calc_second_order=False, num_resamples=spec.draws, conf_level=spec.confidence,
            keep_resamples=True, seed=spec.seed,
        )  # fmt: skip
    columns: dict[str, np.ndarray] = {}
    for name, key in (("first", "S1"), ("total", "ST")):
        low, high = np.nanpercentile(found[f"{key}_conf_all"], [tails, 100 - tails], axis=0)
        columns |= {name: np.asarray(found[key]), f"{name}_low": low, f"{name}_high": high}
    return pd.DataFrame(columns)


def _morris(question: Question, y: np.ndarray) -> pd.DataFrame:
    from SALib.analyze import morris

    spec = question.spec
    found = morris.analyze(
        question.problem, question.grid, y, num_resamples=spec.draws, conf_level=spec.confidence,
        num_levels=question.levels, seed=spec.seed,
    )  # fmt: skip
    mean, width = (np.asarray(found[name], float) for name in ("mu_star", "mu_star_conf"))
    ends = {"mu_star": mean, "mu_star_low": mean - width, "mu_star_high": mean + width}
    return pd.DataFrame(ends | {name: np.asarray(found[name], float) for name in ("mu", "sigma")})


def _ends(question: Question, y: np.ndarray) -> pd.DataFrame:
    """Means of the output at both ends of every key, of a choice at the options where it is least and most, each with
    its standard error; none of sets of motions, which have no ends."""
    y, cube, rows = y[question.independent], question.cube[question.independent], []
    for factor, options in enumerate(question.options):
        row, u = {"mean": y.mean()}, cube[:, factor]
        rows.append(row)
        if factor == question.motion and not question.takes_one:
            continue
        groups = [y[u < SHARE], y[u >= 1 - SHARE]]
        if options:
            chosen = choice_of(u, options)
            groups = sorted((y[chosen == number] for number in np.unique(chosen)), key=np.mean)
        for name, here in (("at_low", groups[0]), ("at_high", groups[-1])):
            row[name] = here.mean() if here.size else np.nan
            row[f"{name}_error"] = here.std(ddof=1) / np.sqrt(here.size) if here.size > 1 else np.nan
    return pd.DataFrame(rows).reindex(columns=list(_SOBOL[6:]))


def _decided(question: Question, found: pd.DataFrame) -> dict[str, Any]:
    """The key that decides most, and its total index or mean elementary effect with the interval.

    found : `indices`
    """
    name = "total" if question.spec.method == "sobol" else "mu_star"
    most = int(np.argmax(found[name].fillna(0.0)))
    key, share, low, high = found[["key", name, f"{name}_low", f"{name}_high"]].iloc[most]
    if not share > 0:
        key, share, low, high = "", np.nan, np.nan, np.nan
    return {"decided_by": key, "share": share, "share_low": low, "share_high": high}


def distribution(question: Question, y: np.ndarray) -> dict[str, float]:
    """Mean, standard deviation and percentiles of an output, with bootstrap intervals, over the independent samples."""
    some, spec = y[question.independent], question.spec
    names = ("mean", "deviation", *(f"percentile_{share}" for share in PERCENTILES))
    random, tails = np.random.default_rng(spec.seed), 50 * (1 - spec.confidence)
    drawn = _statistics(some[random.integers(some.size, size=(some.size, spec.draws))])
    low, high = np.percentile(drawn, [tails, 100 - tails], axis=1)
    numbers: dict[str, float] = {"failed": int(np.isnan(y).sum()), "samples": some.size}
    for name, *ends in zip(names, _statistics(some), low, high, strict=True):
        known = ends if not numbers["failed"] else [np.nan] * 3
        numbers |= {name + end: value for end, value in zip(("", "_low", "_high"), known, strict=True)}
    return numbers


def _statistics(y: np.ndarray) -> np.ndarray:
    """Mean, standard deviation, percentiles; samples first."""
    return np.stack([y.mean(axis=0), y.std(axis=0, ddof=1), *np.percentile(y, PERCENTILES, axis=0)])


def probability(question: Question, holds: np.ndarray) -> dict[str, float]:
    """How likely something holds (1, 0, NaN where it is not known) over the independent samples, with the exact
    interval of Clopper and Pearson; NaN where it is known of none."""
    from scipy.stats import binomtest

    known = holds[question.independent]
    known = known[np.isfinite(known)]
    low, high, share = np.nan, np.nan, np.nan
    if known.size:
        share = float(known.mean())
        low, high = binomtest(int(known.sum()), known.size).proportion_ci(question.spec.confidence, method="exact")
    return {"failed": int(np.isnan(holds).sum()), "samples": known.size,
            "probability": share, "probability_low": low, "probability_high": high}  # fmt: skip


# The tables


def _where(plan: Plan, series: Sequence[Series]) -> pd.DataFrame:
    """Where numbers stand: the swept values, case, analysis, output and its unit."""
    names = ("case", "analysis", "name", "unit")
    texts = pd.DataFrame([[getattr(each, name) for name in names] for each in series], columns=list(names))
    return swept(plan.axes[:-1], [each.point for each in series]).join(texts.rename(columns={"name": "output"}))


def _samples(plan: Plan, question: Question, series: Sequence[Series]) -> Table:
    """All samples in the order of the method with their outputs; a block for each point, case and analysis."""
    count, meant, units = len(question.cube), dict(_COLUMNS), {}
    keys = pd.DataFrame({"sample": np.arange(1, count + 1), "independent": 0})
    keys.loc[question.independent, "independent"] = 1
    for number, factor in enumerate(question.factors):
        if factor.key == MOTION:
            keys[MOTION], meant[MOTION] = question.motion_labels, ("", "ground motions")
            continue
        for member in factor.members:
            values, text = member.number(question.cube[:, number]), f"varies: {member.key}"
            if member.options:
                keys[member.key], meant[member.key] = [member.labels[int(n)] for n in values], ("", text)
            else:
                keys[member.key], meant[member.key] = values, (member.unit.si or "1", text)
                units[member.key] = member.unit
    blocks: dict[tuple, pd.DataFrame] = {}
    for each in series:
        place, column = (each.point, each.case, each.analysis), f"output {each.name}"
        if place not in blocks:
            where = _where(plan, [each])[[*(key for axis in plan.axes[:-1] for key in axis.names), "case", "analysis"]]
            blocks[place] = where.loc[[0] * count].reset_index(drop=True).join(keys)
        blocks[place][column] = each.values
        meant[column] = each.unit or "1", "output"
    return tabled(SAMPLES, pd.concat(blocks.values(), ignore_index=True), meant, plan.axes[:-1], units)
