"""`pound sensitivity`: what a study asks, checked; indices (SALib), distributions, probabilities, and the samples."""

from __future__ import annotations

import dataclasses
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.questions.expressions import (
    evaluate_expression,
    find_distinct_points,
    key_columns,
    parse_all,
    study_at_points,
)
from pounding_cli.questions.frames import swept, tabled
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.questions.sensitivity.spec import SensitivitySpec
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.expression import Expression, Statement, parse_expression, parse_statement
from pounding_cli.study.vary import MOTION, MotionInput, choose_option, read_uncertain
from pounding_cli.tables import Table

if TYPE_CHECKING:
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

BASE_SAMPLES = {"sobol": 256, "morris": 32}
"""Base samples unless the study says how many."""

MOST_POINTS = 200_000

_LEAST_LEVELS = 4

_OF_METHOD = {
    "sobol": ["first", "first_low", "first_high", "total", "total_low", "total_high", "mean", "at_low", "at_low_error",
              "at_high", "at_high_error"],
    "morris": ["mu_star", "mu_star_low", "mu_star_high", "mu", "sigma"],
}  # fmt: skip
"""Columns of the indices of each method."""


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


Judge = Callable[["Plan", "xr.Dataset", "Sensitivity"], "Iterable[Series]"]
"""judge(plan, dataset, question) -> what else may hold: 1, 0, or NaN of a sample where it is not known."""


class Sensitivity(StudyQuestion):
    """Which of the uncertain keys matter most, and how uncertain the outputs are.

    Raises InputError: no key that varies, no output, or one that is not understood.

    judge : says whether the claims of the paper hold
    inputs : what varies, the choice of motions among it
    outputs : the numbers looked at
    statements : what may hold of such numbers, and how likely
    motions : names of the motions
    sets : the motions that a sample may rest on, by number, shape (options, motions of a sample); None: all of them
    """

    name = "sensitivity"
    spec: SensitivitySpec

    def __init__(self, study: Study, judge: Judge | None = None) -> None:
        super().__init__(study)
        spec, problems, root = self.spec, self.problems, study.tree
        self.judge = judge
        self.motions = tuple(study.motion_uses(study.first_point))
        inputs = read_uncertain(root, problems, len(self.motions)) if root.get("uncertain") is not None else []
        self.inputs = tuple(inputs)
        self.sets: np.ndarray | None = None
        if len(inputs) < 2 and not problems.found:
            hint = "write two keys or more, e.g. `uncertain: {impact.restitution: {uniform: {from: 0.4, to: 0.65}}}`"
            problems.at(root, ("uncertain",), "fewer than two keys are uncertain", hint, key=True)
        for each in inputs:
            if isinstance(each, MotionInput):
                if each.motion_count < 2:
                    hint = "name more under `records:`"
                    problems.add(each.mark, "the study has one motion: there is nothing to choose", hint)
                self.sets = each.draw_sets(spec.seed)
        self.refuse_histories("samples")
        if spec.claims and study.spec.claims is None:
            hint = "write `claims: fig6` or `claims: fig7` at the top of the study: the figure that it reproduces"
            self.add_problem(("claims",), "the study names no figure whose claims could be judged", hint, key=True)
        if not (spec.outputs or spec.probabilities or spec.claims):
            hint = "write e.g. `sensitivity: {outputs: [largest mu]}`"
            self.add_problem((), "`sensitivity:` lacks 'outputs'", hint, key=True)
        self.outputs = parse_all(parse_expression, self, "outputs", spec.outputs)
        self.statements = parse_all(parse_statement, self, "probabilities", spec.probabilities)
        points = self.samples * (len(inputs) + (2 if spec.method == "sobol" else 1))
        if points > MOST_POINTS:
            what = f"{self.samples} samples make {points} points"
            self.add_problem(("samples",), what, f"keep it to {MOST_POINTS}: write fewer")
        problems.check()

    # The samples

    @property
    def samples(self) -> int:
        """Base samples."""
        return self.spec.samples or BASE_SAMPLES[self.spec.method]

    @property
    def levels(self) -> int:
        """Levels of the method of Morris: even, and as many as the longest choice has options."""
        most = max(_LEAST_LEVELS, *(each.option_count for each in self.inputs))
        return most + most % 2

    @property
    def problem(self) -> dict[str, Any]:
        """The unit cube, as SALib has it."""
        names = [each.key for each in self.inputs]
        return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}

    @cached_property
    def grid(self) -> np.ndarray:
        """The samples as SALib draws them, shape (samples, inputs)."""
        from SALib.sample import morris, sobol  # a second to import

        seed = self.spec.seed
        if self.spec.method == "morris":
            return morris.sample(self.problem, self.samples, num_levels=self.levels, seed=seed)
        return sobol.sample(self.problem, self.samples, calc_second_order=False, seed=seed)

    @cached_property
    def cube(self) -> np.ndarray:
        """The samples in the unit cube, shape (samples, inputs).

        Levels of Morris run from 0 to 1, where many distributions have no value: each stands for the middle of an equal
        share of the probability.
        """
        if self.spec.method != "morris":
            return self.grid
        return (np.rint(self.grid * (self.levels - 1)) + 0.5) / self.levels

    @property
    def independent(self) -> np.ndarray:
        """Numbers of the samples of Sobol that are independent of each other, his matrices A and B, shape (2 x base
        samples,); of Morris the first of every trajectory."""
        block = len(self.cube) // self.samples
        begins = np.arange(self.samples) * block
        return np.concatenate([begins, begins + block - 1]) if self.spec.method == "sobol" else begins

    @cached_property
    def _distinct_points(self) -> tuple[np.ndarray, np.ndarray]:
        """The samples at which keys of the study differ, shape (points, inputs); of every sample its point."""
        return find_distinct_points(self.inputs, self.cube)

    @property
    def point_of_sample(self) -> np.ndarray:
        """The number of the point on the last axis of the plan of every sample, shape (samples,)."""
        return self._distinct_points[1]

    @cached_property
    def drawn(self) -> np.ndarray | None:
        """The motions that every sample rests on, by number, shape (samples, motions of a sample); None: all."""
        if self.sets is None:
            return None
        number = next(n for n, each in enumerate(self.inputs) if isinstance(each, MotionInput))
        return self.sets[choose_option(self.cube[:, number], len(self.sets))]

    @cached_property
    def plan(self) -> Plan:
        """The scenes of all samples.  Raises InputError: a sample at which the study is not sound."""
        points, point_of_sample = self._distinct_points
        sampled = study_at_points(self.study, self.inputs, points)
        row_filter = None
        if self.drawn is not None:
            pairs = np.broadcast(point_of_sample[:, None], self.drawn)
            needed = {(point, self.motions[number]) for point, number in pairs}
            row_filter = lambda point, _case, _analysis, name: (point[-1], name) in needed  # noqa: E731
        return dataclasses.replace(make_plan(sampled, row_filter=row_filter), workflow="sensitivity", harder=True)

    def answer(self, solver: Solver) -> Answer:
        """Indices of every key, distributions of the outputs, probabilities of statements and of what `judge` says, the
        samples."""
        plan, method = self.plan, self.spec.method
        contents = solver.solve_arrays(plan)
        data = contents.dataset()
        outputs = list(_series(plan, data, self, self.outputs))
        holds = list(_series(plan, data, self, self.statements))
        claims = list(self.judge(plan, data, self)) if self.judge and self.spec.claims else []
        every = [*outputs, *holds, *claims]
        each = [indices(self, one.values) for one in every]
        where = _where(plan, every)
        rows = where.loc[np.repeat(where.index, len(self.inputs))].reset_index(drop=True)
        found = pd.concat(each, ignore_index=True)
        columns = ["key", "outcome", "failed", "samples", *_OF_METHOD[method]]
        tables = [tabled(INDICES, rows.join(found.reindex(columns=columns)), plan.axes)]
        if outputs and method == "sobol":
            numbers = pd.DataFrame([distribution(self, one.values) for one in outputs])
            tables.append(tabled(OUTPUTS, _where(plan, outputs).join(numbers), plan.axes))
        if said := [*holds, *claims]:
            parts = zip(said, each[len(outputs) :], strict=True)
            numbers = pd.DataFrame([probability(self, one.values) | _decided(method, part) for one, part in parts])
            frame = _where(plan, said).drop(columns="unit").rename(columns={"output": "statement"})
            tables.append(tabled(PROBABILITIES, frame.join(numbers), plan.axes))
        if outputs or holds:
            tables.append(_samples(plan, self, [*outputs, *holds]))
        return Answer(plan, contents, tables)


def _series(
    plan: Plan, data: xr.Dataset, question: Sensitivity, asked: Sequence[Expression | Statement]
) -> Iterator[Series]:
    """Expressions, or whether statements hold, at all samples: by point, case, analysis and what is asked."""
    *others, samples = (axis.names[0] for axis in plan.axes)
    wanted = {part.name for one in asked for part in one.quantities}
    wanted |= {"status", "drift", "mu", "acceleration", "max_closing"}
    data = data[[name for name in data if name in wanted]].drop_vars([samples, "record"])
    data = data.isel({samples: xr.DataArray(question.point_of_sample, dims=samples)})
    if question.drawn is not None:
        data = data.isel(record=xr.DataArray(question.drawn, dims=(samples, "record")))
    data = data.transpose(*others, samples, "case", "analysis", "record", ...)
    found = []
    for one in asked:
        expression = one.expression if isinstance(one, Statement) else one
        values = np.moveaxis(evaluate_expression(expression, data, question.spec.over_motions), len(others), -1)
        found.append((one.holds(values), "") if isinstance(one, Statement) else (values, one.unit))
    for *point, case, analysis in np.ndindex(*plan.shape[: len(others)], len(plan.cases), len(plan.analyses)):
        for one, (values, unit) in zip(asked, found, strict=True):
            here = values[(*point, case, analysis)]
            yield Series(tuple(point), plan.cases[case], plan.analyses[analysis], str(one), unit, here)


# Numbers of one output; y : of every sample, NaN where it gave none, shape (samples,)


def indices(question: Sensitivity, y: np.ndarray) -> pd.DataFrame:
    """Sensitivity indices of an output by every key, Sobol's or those of Morris, with their intervals; a row a key."""
    failed, is_constant = int(np.isnan(y).sum()), np.ptp(y) <= 1e-12 * np.abs(y).max(initial=0.0)
    outcome = f"refused: {failed} of {y.size} samples gave no number" if failed else CONSTANT if is_constant else FOUND
    keys = [each.key for each in question.inputs]
    found = pd.DataFrame({"key": keys, "outcome": outcome, "failed": failed, "samples": y.size})
    if outcome != FOUND:
        return found
    if question.spec.method == "morris":
        return found.join(_morris(question, y))
    return found.join([_sobol(question, y), _ends(question, y)])


def _sobol(question: Sensitivity, y: np.ndarray) -> pd.DataFrame:
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


def _morris(question: Sensitivity, y: np.ndarray) -> pd.DataFrame:
    from SALib.analyze import morris

    spec = question.spec
    found = morris.analyze(
        question.problem, question.grid, y, num_resamples=spec.draws, conf_level=spec.confidence,
        num_levels=question.levels, seed=spec.seed,
    )  # fmt: skip
    mean, width, mu, sigma = (np.asarray(found[name], float) for name in ("mu_star", "mu_star_conf", "mu", "sigma"))
    ends = {"mu_star": mean, "mu_star_low": mean - width, "mu_star_high": mean + width}
    return pd.DataFrame(ends | {"mu": mu, "sigma": sigma})


def _ends(question: Sensitivity, y: np.ndarray) -> pd.DataFrame:
    """Means of the output at both ends of every key, of a choice at the options where it is least and most, each with
    its standard error; none of sets of motions, which have no ends."""
    y = y[question.independent]
    cube = question.cube[question.independent]
    rows = []
    for each, u in zip(question.inputs, cube.T, strict=True):
        row = {"mean": y.mean()}
        ends = each.split_at_ends(u, y, SHARE)
        if ends is not None:
            for name, values in zip(("at_low", "at_high"), ends, strict=True):
                row[name] = values.mean() if values.size else np.nan
                row[f"{name}_error"] = values.std(ddof=1) / np.sqrt(values.size) if values.size > 1 else np.nan
        rows.append(row)
    return pd.DataFrame(rows)


def _decided(method: str, found: pd.DataFrame) -> dict[str, Any]:
    """The key that decides most, and its total index or mean elementary effect with the interval.

    found : `indices`
    """
    name = "total" if method == "sobol" else "mu_star"
    if name not in found or not (found[name] > 0).any():
        return {"decided_by": "", "share": np.nan, "share_low": np.nan, "share_high": np.nan}
    most = found.iloc[int(np.argmax(found[name]))]
    return {"decided_by": most["key"], "share": most[name], "share_low": most[f"{name}_low"],
            "share_high": most[f"{name}_high"]}  # fmt: skip


def distribution(question: Sensitivity, y: np.ndarray) -> dict[str, float]:
    """Mean, standard deviation and percentiles of an output, with bootstrap intervals, over the independent samples;
    NaN where some sample gave no number."""
    some, spec = y[question.independent], question.spec
    names = ("mean", "deviation", *(f"percentile_{share}" for share in PERCENTILES))
    random, tails = np.random.default_rng(spec.seed), 50 * (1 - spec.confidence)
    drawn = _statistics(some[random.integers(some.size, size=(some.size, spec.draws))])
    numbers = np.array([_statistics(some), *np.percentile(drawn, [tails, 100 - tails], axis=1)])
    failed = int(np.isnan(y).sum())
    if failed:
        numbers[:] = np.nan
    each = zip(names, numbers.T.tolist(), strict=True)
    rows = {name + end: value for name, ends in each for end, value in zip(("", "_low", "_high"), ends, strict=True)}
    return {"failed": failed, "samples": some.size, **rows}


def _statistics(y: np.ndarray) -> np.ndarray:
    """Mean, standard deviation, percentiles; samples first."""
    return np.stack([y.mean(axis=0), y.std(axis=0, ddof=1), *np.percentile(y, PERCENTILES, axis=0)])


def probability(question: Sensitivity, holds: np.ndarray) -> dict[str, Any]:
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
    texts = pd.DataFrame([each[1:5] for each in series], columns=["case", "analysis", "output", "unit"])
    return swept(plan.axes[:-1], [each.point for each in series]).join(texts)


def _samples(plan: Plan, question: Sensitivity, series: Sequence[Series]) -> Table:
    """All samples in the order of the method with their outputs; a block for each point, case and analysis."""
    count = len(question.cube)
    keys, meant, units = key_columns(question.inputs, question.cube)
    keys.insert(0, "sample", range(1, count + 1))
    keys.insert(1, "independent", np.isin(np.arange(count), question.independent).astype(int))
    if question.drawn is not None:
        counts = [Counter(question.motions[number] for number in numbers) for numbers in question.drawn]
        said = [" + ".join(name if n == 1 else f"{n} {name}" for name, n in each.items()) for each in counts]
        keys[MOTION], meant[MOTION] = said, ("", "ground motions")
    blocks, where = dict[tuple, pd.DataFrame](), _where(plan, series).drop(columns=["output", "unit"])
    for number, each in enumerate(series):
        block = blocks.setdefault(each[:3], where.loc[[number] * count].reset_index(drop=True).join(keys))
        block[f"output {each.name}"] = each.values
        meant[f"output {each.name}"] = each.unit or "1", "output"
    return tabled(SAMPLES, pd.concat(blocks.values(), ignore_index=True), plan.axes[:-1], units, more=meant)
