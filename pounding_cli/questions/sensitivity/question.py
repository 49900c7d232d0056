"""The question of `pound sensitivity` asked of one study: which uncertain keys matter most?"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd

from pounding_cli.questions.chosen_points import find_distinct_points, study_at_points
from pounding_cli.questions.expression_words import depends_on_contact, find_struck_buildings
from pounding_cli.questions.expressions import (
    Values,
    collect_values,
    compare_values,
    evaluate_expression,
    name_variables,
    parse_all,
)
from pounding_cli.questions.frames import list_swept_columns
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.questions.sensitivity.answer import (
    build_index_frame,
    build_places,
    build_probability_frame,
    build_sample_table,
)
from pounding_cli.questions.sensitivity.indices import compute_indices, describe_distribution
from pounding_cli.questions.sensitivity.spec import SensitivitySpec
from pounding_cli.questions.sensitivity.tables import (
    INDEX_COLUMNS,
    INDICES,
    OUTPUT_COLUMNS,
    OUTPUTS,
    PROBABILITIES,
    PROBABILITY_COLUMNS,
)
from pounding_cli.questions.statements import iter_evaluated, read_statements
from pounding_cli.results.arrays import ResultArrays
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.expressions.comparison import Comparison, parse_comparison
from pounding_cli.study.expressions.expression import Expression, parse_expression
from pounding_cli.study.expressions.statements import iter_comparisons
from pounding_cli.study.schema.archetypes import KEY as ARCHETYPE
from pounding_cli.study.schema.archetypes import list_seen
from pounding_cli.study.vary.axes import sweep_maps
from pounding_cli.study.vary.inputs import MotionInput, choose_option
from pounding_cli.study.vary.uncertain import read_uncertain
from pounding_cli.tables import build_table

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.study.text.file import Map

BASE_SAMPLES = {"sobol": 256, "morris": 32}
"""Base samples unless the study says how many."""

MAX_SAMPLES = 200_000

_MIN_LEVELS = 4


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


class Sensitivity(StudyQuestion):
    """The question which uncertain keys are most influential, and how uncertain the outputs are.

    Raises InputError: no key that varies, no output, or one that is not understood.

    inputs : keys that vary, and the choice of motions
    outputs : expressions whose indices are computed
    probabilities : comparisons whose probabilities are computed
    statements : of the study, whose probabilities are computed too
    motions : names of the motions
    motion_sets : motions that a sample may rest on, by number, shape (options, motions of a sample); None: all of them
    """

    name = "sensitivity"
    spec: SensitivitySpec

    def __init__(self, study: Study) -> None:
        super().__init__(study)
        spec = self.spec
        problems = self.problems
        root = study.tree
        self.motions = tuple(study.motion_uses(study.first_point))
        inputs = read_uncertain(root, problems, len(self.motions))
        self.inputs = tuple(inputs)
        self.motion_sets: np.ndarray | None = None
        if len(inputs) < 2 and not problems.found:
            hint = "write two keys or more, e.g. `uncertain: {impact.restitution: {uniform: {from: 0.4, to: 0.65}}}`"
            swept = _list_swept_neighbours(root)
            if swept:
                hint += f"; nothing of {' and '.join(swept)} is varied, as `archetype` is swept there"
            problems.add_at(root, ("uncertain",), "fewer than two keys are uncertain", hint, key=True)
        for each in inputs:
            if isinstance(each, MotionInput):
                if each.motion_count < 2:
                    hint = "name more under `records:`"
                    problems.add(each.mark, "the study has one motion: there is nothing to choose", hint)
                self.motion_sets = each.draw_sets(spec.seed)
        self.refuse_histories("samples")
        if spec.statements and not study.spec.statements:
            hint = "write `statements:` at the top of the study, a list of `{says: ..., holds: ...}`"
            self.add_problem(("statements",), "the study has no statements", hint, key=True)
        self.statements = read_statements(self) if spec.statements else []
        if not (spec.outputs or spec.probabilities or spec.statements):
            hint = "write e.g. `sensitivity: {outputs: [largest mu]}`"
            self.add_problem((), "`sensitivity:` lacks 'outputs'", hint, key=True)
        self.outputs = parse_all(parse_expression, self, "outputs", spec.outputs)
        self.probabilities = parse_all(parse_comparison, self, "probabilities", spec.probabilities)
        points = self.samples * (len(inputs) + (2 if spec.method == "sobol" else 1))
        if points > MAX_SAMPLES:
            message = f"{self.samples} samples make {points} points"
            self.add_problem(("samples",), message, f"keep it to {MAX_SAMPLES}: write fewer")
        problems.check()

    def check_changes(self) -> None:
        """Raise InputError where a changed value has no effect, since its key is drawn from a distribution."""
        drawn = {member.key for each in self.inputs for member in each.members}
        for change in self.study.changes:
            if change.key in drawn:
                message = "has no effect: under `uncertain:` the key is drawn from a distribution"
                hint = f"change that, `uncertain.{change.key}=...`, or leave it out"
                self.problems.add(change.mark, message, hint)
        self.problems.check()

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
        """Return indices, distributions of outputs, probabilities of statements, and the samples."""
        plan = self.plan
        arrays = solver.solve_arrays(plan)
        outputs = list(_iter_series(plan, arrays, self, self.outputs))
        compared = list(_iter_series(plan, arrays, self, self.probabilities))
        of_study = list(_iter_statements(plan, arrays, self))
        every = [*outputs, *compared, *of_study]
        indices = [compute_indices(self, one.values) for one in every]
        swept = list_swept_columns(plan.axes[:-1])
        tables = [build_table(INDICES, build_index_frame(plan, self, every, indices), [*swept, *INDEX_COLUMNS])]
        if outputs and self.spec.method == "sobol":
            distributions = pd.DataFrame([describe_distribution(self, one.values) for one in outputs])
            frame = build_places(plan, outputs).join(distributions)
            tables.append(build_table(OUTPUTS, frame, [*swept, *OUTPUT_COLUMNS]))
        if compared or of_study:
            frame = build_probability_frame(plan, self, [*compared, *of_study], indices[len(outputs) :])
            tables.append(build_table(PROBABILITIES, frame, [*swept, *PROBABILITY_COLUMNS]))
        if outputs or compared:
            tables.append(build_sample_table(plan, self, [*outputs, *compared]))
        return Answer(plan, arrays, tables)


def _list_swept_neighbours(root: Map) -> list[str]:
    """Return the buildings that are only seen of which nothing is varied, as the study sweeps what they are."""
    swept_keys = {key for holder in sweep_maps(root) for key in holder}
    return [
        seen.name
        for seen in list_seen(root)
        if any(key.startswith(f"buildings.{seen.name}.{ARCHETYPE}") for key in swept_keys)
    ]


def _iter_series(
    plan: Plan, arrays: ResultArrays, question: Sensitivity, asked: Sequence[Expression | Comparison]
) -> Iterator[Series]:
    """Yield expressions, or whether statements hold, at all samples: by point, case, analysis and expression."""
    values = _values_of_samples(arrays, question, {part.name for one in asked for part in one.quantities})
    samples_axis = len(plan.axes) - 1
    shape = values["status"].shape[:-1]
    series: list[tuple[Expression | Comparison, np.ndarray, str]] = []
    for one in asked:
        over_motions = question.spec.over_motions
        if isinstance(one, Comparison):
            of_samples, unit = compare_values(one, values, over_motions).held, ""
        else:
            of_samples, unit = evaluate_expression(one, values, over_motions), one.unit
        series.append((one, np.moveaxis(np.broadcast_to(of_samples, shape), samples_axis, -1), unit))
    points = range(plan.shape[samples_axis])
    struck = {
        (case, analysis): find_struck_buildings(plan, arrays, case, analysis, points)
        for case, analysis in np.ndindex(len(plan.cases), len(plan.analyses))
    }
    for *point, case, analysis in np.ndindex(*plan.shape[:samples_axis], len(plan.cases), len(plan.analyses)):
        for one, of_samples, unit in series:
            yield Series(
                tuple(point),
                plan.cases[case],
                plan.analyses[analysis],
                str(one),
                unit,
                of_samples[(*point, case, analysis)],
                depends_on_contact(one.quantities, struck[case, analysis]),
            )


def _iter_statements(plan: Plan, arrays: ResultArrays, question: Sensitivity) -> Iterator[Series]:
    """Yield whether each statement of the study holds at all samples, and whether a part of it does.

    A sample where a comparison is not known has neither.
    """
    samples_axis = len(plan.axes) - 1
    quantities = [part for _, each in iter_comparisons(question.statements) for part in each.quantities]
    values = _values_of_samples(arrays, question, name_variables(quantities) | {"kind", "gap"})
    shape = values["status"].shape[: samples_axis + 1]
    is_held: dict[str, list[np.ndarray]] = {}
    for tested in iter_evaluated(question.statements, values):
        held = tested.held
        of_points = held.reshape(*held.shape[: samples_axis + 1], -1).min(axis=-1)  # NaN stays NaN
        is_held.setdefault(tested.statement.name, []).append(np.broadcast_to(of_points, shape))
    for name, held_by_comparison in is_held.items():
        stacked = np.moveaxis(np.stack(held_by_comparison), samples_axis + 1, -1)
        is_known = ~np.isnan(stacked).any(axis=0)
        whole, part = (np.where(is_known, each, np.nan) for each in (stacked.min(axis=0), stacked.max(axis=0)))
        for words, of_samples in ((name, whole), (f"{name}, at least in part", part)):
            if words == name or not np.array_equal(whole, part, equal_nan=True):
                for point in np.ndindex(of_samples.shape[:-1]):
                    yield Series(point, "", "", words, "", of_samples[point])


def _values_of_samples(arrays: ResultArrays, question: Sensitivity, names: set[str]) -> Values:
    """Return variables at all samples, shape (other swept axes, samples, case, analysis, motions of a sample, ...)."""
    axes = tuple(axis.names[0] for axis in question.plan.axes)
    samples_axis = len(axes) - 1
    motions_axis = samples_axis + 3  # behind case and analysis
    values = collect_values(arrays, axes, names)
    for name, of_points in values.items():
        of_samples = of_points
        if of_points.shape[samples_axis] > 1:
            of_samples = np.take(of_points, question.point_of_sample, axis=samples_axis)
        if question.motions_of_samples is not None and of_points.shape[motions_axis] > 1:
            shape = [1] * of_samples.ndim
            shape[samples_axis], shape[motions_axis] = question.motions_of_samples.shape
            of_samples = np.take_along_axis(of_samples, question.motions_of_samples.reshape(shape), axis=motions_axis)
        values[name] = of_samples
    return values
