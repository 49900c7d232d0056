"""`pound sensitivity`: the question, its samples, and their statistics (SALib).

Tables: indices of every key, distributions of the outputs, probabilities of statements, and the samples themselves.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd

from pounding_cli.numbers import Unit
from pounding_cli.questions.expressions import (
    Values,
    build_key_frame,
    depends_on_contact,
    evaluate_expression,
    find_distinct_points,
    find_struck_buildings,
    parse_all,
    study_at_points,
)
from pounding_cli.questions.frames import NUMBER, build_swept_frame, list_swept_columns
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.questions.sensitivity.spec import SensitivitySpec
from pounding_cli.questions.sensitivity.tables import (
    INDEX_COLUMNS,
    INDICES,
    OUTPUT_COLUMNS,
    OUTPUTS,
    PERCENTILES,
    PROBABILITIES,
    PROBABILITY_COLUMNS,
    SAMPLE_COLUMNS,
    SAMPLES,
)
from pounding_cli.results.arrays import ResultArrays
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.archetypes import KEY as ARCHETYPE
from pounding_cli.study.archetypes import list_seen
from pounding_cli.study.axes import sweep_maps
from pounding_cli.study.expression import Expression, Statement, parse_expression, parse_statement
from pounding_cli.study.vary import MOTION, MotionInput, choose_option, read_uncertain
from pounding_cli.tables import Column, Table, build_table

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.batch.solve import Solver
    from pounding_cli.study.file import Map

FOUND = "found"
CONSTANT = "the output does not change"
"""Outcomes; another one says how many samples have no value."""

END_SHARE = 0.2
"""Lowest and highest part of a key's distribution that a tornado compares [-]."""

BASE_SAMPLES = {"sobol": 256, "morris": 32}
"""Base samples unless the study says how many."""

MAX_POINTS = 200_000

_MIN_LEVELS = 4

_OF_METHOD = {
    "sobol": ["first", "first_low", "first_high", "total", "total_low", "total_high", "mean", "at_low", "at_low_error",
              "at_high", "at_high_error"],
    "morris": ["mu_star", "mu_star_low", "mu_star_high", "mu", "sigma"],
}  # fmt: skip
"""Columns of the indices of each method."""


class Series(NamedTuple):
    """An output, or whether a statement holds, over all samples.

    point : place on every other swept axis, from 0
    case, analysis : where it is; "" where it rests on all of them
    name : of the output
    unit : SI
    values : NaN where a sample has none, shape (samples,)
    on_contact : whether they depend on the contact stiffness, since floors strike
    """

    point: tuple[int, ...]
    case: str
    analysis: str
    name: str
    unit: str
    values: np.ndarray
    on_contact: bool = False


Judge = Callable[["Plan", "xr.Dataset", "Sensitivity"], "Iterable[Series]"]
"""judge(plan, dataset, question) -> what else may hold: 1, 0, or NaN of a sample where it is not known."""


class Sensitivity(StudyQuestion):
    """The question which uncertain keys are most influential, and how uncertain the outputs are.

    Raises InputError: no key that varies, no output, or one that is not understood.

    judge : decides whether the claims of a figure hold
    inputs : keys that vary, and the choice of motions
    outputs : expressions whose indices are computed
    statements : comparisons whose probabilities are computed
    motions : names of the motions
    motion_sets : motions that a sample may rest on, by number, shape (options, motions of a sample); None: all of them
    """

    name = "sensitivity"
    spec: SensitivitySpec

    def __init__(self, study: Study, judge: Judge | None = None) -> None:
        super().__init__(study)
        spec = self.spec
        problems = self.problems
        root = study.tree
        self.judge = judge
        self.motions = tuple(study.motion_uses(study.first_point))
        inputs = read_uncertain(root, problems, len(self.motions))
        self.inputs = tuple(inputs)
        self.motion_sets: np.ndarray | None = None
        if len(inputs) < 2 and not problems.found:
            hint = "write two keys or more, e.g. `uncertain: {impact.restitution: {uniform: {from: 0.4, to: 0.65}}}`"
            swept = _list_swept_neighbours(root)
            if swept:
                hint += f"; nothing of {' and '.join(swept)} is varied, as `archetype` is swept there"
            problems.at(root, ("uncertain",), "fewer than two keys are uncertain", hint, key=True)
        for each in inputs:
            if isinstance(each, MotionInput):
                if each.motion_count < 2:
                    hint = "name more under `records:`"
                    problems.add(each.mark, "the study has one motion: there is nothing to choose", hint)
                self.motion_sets = each.draw_sets(spec.seed)
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
        if points > MAX_POINTS:
            message = f"{self.samples} samples make {points} points"
            self.add_problem(("samples",), message, f"keep it to {MAX_POINTS}: write fewer")
        problems.check()

    # The samples

    @property
    def samples(self) -> int:
        """Number of base samples."""
        return self.spec.samples or BASE_SAMPLES[self.spec.method]

    @property
    def levels(self) -> int:
        """Number of levels of the method of Morris: even, and at least the options of the longest choice."""
        count = max(_MIN_LEVELS, *(each.option_count for each in self.inputs))
        return count + count % 2

    @property
    def problem(self) -> dict[str, Any]:
        """The unit cube as SALib describes it."""
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
    def independent_samples(self) -> np.ndarray:
        """The numbers of the samples that are independent of each other.

        Of Sobol's method those of his matrices A and B, shape (2 x base samples,); of Morris's the first sample of
        every trajectory, shape (base samples,).
        """
        block = len(self.cube) // self.samples
        begins = np.arange(self.samples) * block
        return np.concatenate([begins, begins + block - 1]) if self.spec.method == "sobol" else begins

    @cached_property
    def _distinct_points(self) -> tuple[np.ndarray, np.ndarray]:
        """The samples at which keys of the study differ, shape (points, inputs), and the point of every sample."""
        return find_distinct_points(self.inputs, self.cube)

    @property
    def point_of_sample(self) -> np.ndarray:
        """The number of the point on the last axis of the plan of every sample, shape (samples,)."""
        return self._distinct_points[1]

    @cached_property
    def motions_of_samples(self) -> np.ndarray | None:
        """The motions that every sample rests on, by number, shape (samples, motions of a sample); None: all."""
        if self.motion_sets is None:
            return None
        place = next(place for place, each in enumerate(self.inputs) if isinstance(each, MotionInput))
        return self.motion_sets[choose_option(self.cube[:, place], len(self.motion_sets))]

    @cached_property
    def plan(self) -> Plan:
        """The time histories of all samples.  Raises InputError: the study is not sound at a sample."""
        points, point_of_sample = self._distinct_points
        sampled = study_at_points(self.study, self.inputs, points)
        row_filter = None
        if self.motions_of_samples is not None:
            pairs = np.broadcast(point_of_sample[:, None], self.motions_of_samples)
            needed = {(point, self.motions[number]) for point, number in pairs}
            row_filter = lambda point, _case, _analysis, name: (point[-1], name) in needed  # noqa: E731
        return dataclasses.replace(make_plan(sampled, row_filter=row_filter), harder=True)

    def answer(self, solver: Solver) -> Answer:
        """Return indices, distributions of outputs, probabilities of statements and claims, and the samples."""
        plan = self.plan
        arrays = solver.solve_arrays(plan)
        outputs = list(_iter_series(plan, arrays, self, self.outputs))
        statements = list(_iter_series(plan, arrays, self, self.statements))
        claims: list[Series] = []
        if self.judge is not None and self.spec.claims:
            claims = list(self.judge(plan, arrays.to_dataset(), self))
        every = [*outputs, *statements, *claims]
        indices = [compute_indices(self, one.values) for one in every]
        swept = list_swept_columns(plan.axes[:-1])
        tables = [build_table(INDICES, _build_index_frame(plan, self, every, indices), [*swept, *INDEX_COLUMNS])]
        if outputs and self.spec.method == "sobol":
            distributions = pd.DataFrame([describe_distribution(self, one.values) for one in outputs])
            frame = _build_places(plan, outputs).join(distributions)
            tables.append(build_table(OUTPUTS, frame, [*swept, *OUTPUT_COLUMNS]))
        if statements or claims:
            frame = _build_probability_frame(plan, self, [*statements, *claims], indices[len(outputs) :])
            tables.append(build_table(PROBABILITIES, frame, [*swept, *PROBABILITY_COLUMNS]))
        if outputs or statements:
            tables.append(_build_sample_table(plan, self, [*outputs, *statements]))
        return Answer(plan, arrays, tables)


def _list_swept_neighbours(root: Map) -> list[str]:
    """Return the buildings that are only seen of which nothing is varied, as the study sweeps what they are."""
    swept = {key for holder in sweep_maps(root) for key in holder}
    return [
        seen.name
        for seen in list_seen(root)
        if any(key.startswith(f"buildings.{seen.name}.{ARCHETYPE}") for key in swept)
    ]


def _iter_series(
    plan: Plan, arrays: ResultArrays, question: Sensitivity, asked: Sequence[Expression | Statement]
) -> Iterator[Series]:
    """Yield expressions, or whether statements hold, at all samples: by point, case, analysis and expression."""
    values = _values_of_samples(arrays, question, {part.name for one in asked for part in one.quantities})
    samples_axis = len(plan.axes) - 1
    series: list[tuple[Expression | Statement, Expression, np.ndarray, str]] = []
    for one in asked:
        expression = one.expression if isinstance(one, Statement) else one
        of_samples = evaluate_expression(expression, values, question.spec.over_motions)
        of_samples = np.moveaxis(of_samples, samples_axis, -1)
        if isinstance(one, Statement):
            series.append((one, expression, one.holds(of_samples), ""))
        else:
            series.append((one, expression, of_samples, one.unit))
    points = range(plan.shape[samples_axis])
    struck = {
        (case, analysis): find_struck_buildings(plan, arrays, case, analysis, points)
        for case, analysis in np.ndindex(len(plan.cases), len(plan.analyses))
    }
    for *point, case, analysis in np.ndindex(*plan.shape[:samples_axis], len(plan.cases), len(plan.analyses)):
        for one, expression, of_samples, unit in series:
            yield Series(
                tuple(point),
                plan.cases[case],
                plan.analyses[analysis],
                str(one),
                unit,
                of_samples[(*point, case, analysis)],
                depends_on_contact(expression, struck[case, analysis]),
            )


def _values_of_samples(arrays: ResultArrays, question: Sensitivity, names: set[str]) -> Values:
    """Return variables at all samples, shape (other swept axes, samples, case, analysis, motions of a sample, ...)."""
    samples_axis = len(question.plan.axes) - 1
    motions_axis = samples_axis + 3  # behind case and analysis
    values = {}
    for name in names | {"status", "drift", "mu", "acceleration", "max_closing", "peak_force"}:
        if name not in arrays:  # no case has a link
            continue
        of_points = arrays[name].values
        of_samples = of_points.take(question.point_of_sample, axis=samples_axis)
        if question.motions_of_samples is not None:
            shape = [1] * of_samples.ndim
            shape[samples_axis], shape[motions_axis] = question.motions_of_samples.shape
            of_samples = np.take_along_axis(of_samples, question.motions_of_samples.reshape(shape), axis=motions_axis)
        values[name] = of_samples
    return values


# Numbers of one output; y : of every sample, NaN where it has none, shape (samples,)


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


def _find_most_influential(method: str, indices: pd.DataFrame) -> dict[str, Any]:
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


# The tables


def _build_places(plan: Plan, series: Sequence[Series]) -> pd.DataFrame:
    """Return where outputs stand: the swept values, case, analysis, output, its unit, whether it depends on contact."""
    return build_swept_frame(
        plan.axes[:-1],
        [each.point for each in series],
        case=[each.case for each in series],
        analysis=[each.analysis for each in series],
        output=[each.name for each in series],
        unit=[each.unit for each in series],
        on_contact=[int(each.on_contact) for each in series],
    )


def _build_index_frame(
    plan: Plan, question: Sensitivity, series: Sequence[Series], indices: Sequence[pd.DataFrame]
) -> pd.DataFrame:
    """Return a row for every output and key."""
    places = _build_places(plan, series)
    rows = places.loc[np.repeat(places.index, len(question.inputs))].reset_index(drop=True)
    columns = ["key", "outcome", "failed", "samples", *_OF_METHOD[question.spec.method]]
    return rows.join(pd.concat(indices, ignore_index=True).reindex(columns=columns))


def _build_probability_frame(
    plan: Plan, question: Sensitivity, statements: Sequence[Series], indices: Sequence[pd.DataFrame]
) -> pd.DataFrame:
    """Return a row for every statement.

    indices : of each statement
    """
    numbers = pd.DataFrame(
        [
            compute_probability(question, one.values) | _find_most_influential(question.spec.method, of_one)
            for one, of_one in zip(statements, indices, strict=True)
        ]
    )
    places = _build_places(plan, statements).drop(columns="unit").rename(columns={"output": "statement"})
    return places.join(numbers)


def _build_sample_table(plan: Plan, question: Sensitivity, series: Sequence[Series]) -> Table:
    """Return all samples in the order of the method with their outputs; a block for each point, case and analysis."""
    count = len(question.cube)
    keys, columns = build_key_frame(question.inputs, question.cube)
    keys.insert(0, "sample", range(1, count + 1))
    keys.insert(1, "independent", np.isin(np.arange(count), question.independent_samples).astype(int))
    if question.motions_of_samples is not None:
        keys[MOTION] = [_name_motions(question.motions, numbers) for numbers in question.motions_of_samples]
        columns.append(Column(MOTION, "ground motions"))
    blocks: dict[tuple, pd.DataFrame] = {}
    places = _build_places(plan, series).drop(columns=["output", "unit", "on_contact"])
    for number, each in enumerate(series):
        place = each[:3]
        if place not in blocks:
            blocks[place] = places.loc[[number] * count].reset_index(drop=True).join(keys)
        name = f"output {each.name}"
        blocks[place][name] = each.values
        unit = Unit(each.unit, 1.0, each.unit) if each.unit else NUMBER
        columns.append(Column(name, "output", unit))
    frame = pd.concat(blocks.values(), ignore_index=True)
    return build_table(SAMPLES, frame, [*list_swept_columns(plan.axes[:-1]), *SAMPLE_COLUMNS, *columns])


def _name_motions(names: Sequence[str], numbers: np.ndarray) -> str:
    """Return the motions of a sample in words: "elcentro + 2 taft"."""
    counts = Counter(names[number] for number in numbers)
    return " + ".join(name if count == 1 else f"{count} {name}" for name, count in counts.items())
