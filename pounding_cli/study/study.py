"""A validated study: its buildings, links and motions at any point of the sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from pounding_cli import records
from pounding_cli.errors import Problem
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.numbers import Unit
from pounding_cli.reading import shorten_path
from pounding_cli.records.motion import Motion
from pounding_cli.study import keep, warnings
from pounding_cli.study.axes import Axis, read_axes, with_middles
from pounding_cli.study.both_sides import with_both_sides
from pounding_cli.study.buildings import find_separation
from pounding_cli.study.changes import Change, apply_changes
from pounding_cli.study.display import describe_study, find_unit
from pounding_cli.study.file import Map, Problems, nearest, read_study, refuse_other_kinds
from pounding_cli.study.group import Group, unique_names
from pounding_cli.study.issues import Issue, Issues, IssuesFound, drop_idle_axes
from pounding_cli.study.like import resolve_all_likes
from pounding_cli.study.motions import MotionReader, MotionUse, Suite, read_suite
from pounding_cli.study.records_spec import SpectrumSpec
from pounding_cli.study.resolve import StudyParts, changes_part, resolve, tree_at
from pounding_cli.study.schema import StudySpec, find_section_names
from pounding_cli.study.swept import AS_WRITTEN, Point, Swept, sweep_map
from pounding_cli.study.written import build_study_spec, note_unknown_names, read_specs

RESIDUAL_DRIFT = "residual_drift"
"""The key and the quantity of the drifts at rest."""

MAX_AT_POINTS = 20
"""Problems of single points of the sweep that are told."""


@dataclass(frozen=True, eq=False)
class Study:
    """A validated study: its buildings, links and motions at any point of the sweep.

    path : the file
    text : the file as written
    title : its title or its name
    tree : what the file holds, with the middle of every unknown value where its key stands
    axes : the axes of the sweep
    spec : the study as written, validated
    parts : its parts at the points of the sweep
    units_from : the file at the first point of the sweep, whose units people read
    warnings : what is allowed but should be known
    from_data : whether it is Python data; no file holds it
    reader : of its motions
    changes : values that it has in place of those of the file
    """

    path: Path
    text: str
    title: str
    tree: Map
    axes: tuple[Axis, ...]
    spec: StudySpec
    parts: StudyParts
    units_from: Map
    warnings: tuple[Problem, ...]
    from_data: bool
    reader: MotionReader
    changes: tuple[Change, ...] = ()

    @property
    def file(self) -> str:
        """The name of the file in messages."""
        return shorten_path(self.path)

    def section(self, name: str) -> Any:
        """Return the validated section of a question by its name."""
        return getattr(self.spec, name)

    @property
    def first_point(self) -> Point:
        """The first point of the sweep."""
        return (0,) * len(self.axes)

    @property
    def wants_residual_drift(self) -> bool:
        """True if the drifts at rest are asked for, by their key or by a question that names them."""
        return bool(self.spec.residual_drift) or any(
            _names_residual_drift(self.tree.get(name)) for name in find_section_names(type(self.spec))
        )

    @property
    def has_plans(self) -> bool:
        """True if a building of the group has a plan at some point of the sweep."""
        return any(
            spec.plan is not None
            for name in self.spec.group
            for _, spec in self.parts.building_specs[name].iter_values()
        )

    def with_axes(self, axes: Sequence[Axis], tree: Map | None = None) -> Study:
        """Return the study with other axes; title, units and warnings stay.

        tree : in place of what the file holds

        Raises
        ------
        InputError : the study is not sound at a point of them
        """
        tree = self.tree if tree is None else tree
        spec, parts = _resolve_tree(tree, tuple(axes), self.reader, self.file, type(self.spec))
        return replace(self, tree=tree, axes=tuple(axes), spec=spec, parts=parts)

    def with_tree(self, tree: Map) -> Study:
        """Return the study that another file in its place would hold; title, text, units and warnings stay.

        tree : what that file holds

        Raises
        ------
        InputError : it is not sound
        """
        problems = Problems(self.file)
        tree = with_middles(with_both_sides(tree, problems), problems)
        axes = read_axes(tree, problems)
        problems.check()
        return self.with_axes(axes, tree)

    def tree_at(self, point: Point) -> Map:
        """Return the file at a point of the sweep."""
        return tree_at(self.tree, self.axes, point)

    def group(self, point: Point) -> Group:
        """Return the buildings in their places at a point of the sweep."""
        return self.parts.group.value_at(point)

    def building(self, point: Point, place: int) -> Building:
        """Return the building type at a place of the group, from 0, at a point of the sweep."""
        return self.parts.types[self.spec.group[place]].value_at(point)

    def links(self, point: Point, case: str) -> tuple[Link, ...]:
        """Return the links of a case at a point of the sweep."""
        return self.parts.links[case].value_at(point)

    def motion_uses(self, point: Point) -> Mapping[str, MotionUse]:
        """Return the motions by name as they are used at a point of the sweep, without their samples."""
        return self.parts.suite.value_at(point).uses

    @cached_property
    def written_suite(self) -> Suite:
        """The motions with the values that the study writes for swept keys; where these are no sound choice, those of
        the first point."""
        if self.axes_changing("records"):
            try:
                return read_suite(self.spec.records, self.reader)
            except IssuesFound:
                pass
        return self.parts.suite.value_at(self.first_point)

    def list_taken_files(self) -> list[tuple[str, ...]]:
        """Return, of every plain file of motions, the lines that say what was taken of it."""
        return list(dict.fromkeys(lines for _, suite in self.parts.suite.iter_values() for lines in suite.taken))

    def motion(self, point: Point, name: str) -> Motion:
        """Return a motion as it is used at a point of the sweep, cut and scaled."""
        return self.reader.used_motion(self.motion_uses(point)[name])

    def motions(self, point: Point) -> dict[str, Motion]:
        """Return all motions by name as they are used at a point of the sweep."""
        return {name: self.reader.used_motion(use) for name, use in self.motion_uses(point).items()}

    def axes_changing(self, *path: str) -> tuple[int, ...]:
        """Return the numbers of the axes that change a section of the file, or an entry of one."""
        return tuple(
            number
            for number, axis in enumerate(self.axes)
            if any(changes_part(key, path, self.tree) for key in axis.names)
        )

    def assumed_heights(self) -> tuple[str, ...]:
        """Return the buildings of the group, by place, whose storey heights the study leaves to their default."""
        specs = [self.parts.building_specs[name].value_at(self.first_point) for name in self.spec.group]
        return tuple(
            place
            for place, spec in zip(unique_names(self.spec.group), specs, strict=True)
            if not spec.wall and "height" not in spec.model_fields_set
        )

    def unit(self, quantity: str) -> Unit:
        """Return the unit the study writes a quantity in, to show it to people; one of DISPLAY_UNITS, e.g. gap."""
        return find_unit(self.units_from, quantity)

    def to_plain_data(self) -> dict[str, Any]:
        """Return the study as plain data: every default filled in, SI numbers, the sweep set aside."""
        return describe_study(self)

    def spectrum_match(self) -> records.SpectrumMatch | None:
        """Return the motions against the target spectrum that the study writes; None without one."""
        suite = self.written_suite
        scale = self.spec.records.scale
        if suite.target is None or not isinstance(scale, SpectrumSpec):
            return None
        motions = {name: self.reader.used_motion(use) for name, use in suite.uses.items()}
        return records.SpectrumMatch.of(motions, suite.target, scale.spectrum == "each", scale.at_least)

    def separations(self) -> Swept[np.ndarray]:
        """Return the code's separation of every building from the next one to the right [m], shape (buildings,).

        NaN for the last, and where the yield shears of a neighbour were not set by a code.
        """
        displacements = [self.parts.displacements(name) for name in self.spec.group]

        def separate(*allowed: Mapping[str, np.ndarray]) -> np.ndarray:
            return np.array([*(find_separation(left, right) for left, right in pairwise(allowed)), np.nan])

        return sweep_map(separate, *displacements)


def load_study_file(
    path: str | Path, model: type[StudySpec] = StudySpec, changes: Sequence[Change] = ()
) -> Study:  # fmt: skip
    """Read and validate a study file.

    model : of the study, with the sections of questions (`add_sections`)
    changes : values in place of those of the file

    Raises
    ------
    InputError : with every problem found in it, each with file, line, column, message and hint
    """
    path = Path(path)
    return build_study(path, *read_study(path), model, changes)


def build_study(
    path: Path,
    text: str,
    tree: Map,
    model: type[StudySpec],
    changes: Sequence[Change] = (),
    reader: MotionReader | None = None,
) -> Study:
    """Return a validated study.

    text : as written
    tree : what it holds
    changes : values in place of those there
    reader : of the motions, where several studies of one folder have the same ones

    Raises
    ------
    InputError : as `load_study_file`
    """
    file = shorten_path(path)
    refuse_other_kinds(tree, file)
    if changes:
        text, tree = apply_changes(text, tree, changes, file, model)
    reader = MotionReader(path.resolve().parent) if reader is None else reader
    problems = Problems(file)
    tree = with_middles(with_both_sides(tree, problems), problems)
    axes = read_axes(tree, problems)
    from_data = isinstance(tree.mark[0], str)
    spec, parts = _resolve_tree(tree, axes, reader, file, model, problems)
    first = tree_at(tree, axes, (0,) * len(axes))
    title = spec.title or shorten_path(path.stem)
    study = Study(
        path, text, title, tree, axes, spec, parts, first, (), from_data, reader, tuple(changes)
    )  # fmt: skip
    return replace(study, warnings=warnings.find_warnings(study))


def _resolve_tree(
    tree: Map,
    axes: tuple[Axis, ...],
    reader: MotionReader,
    file: str,
    model: type[StudySpec],
    problems: Problems | None = None,
) -> tuple[StudySpec, StudyParts]:
    """Return a study as written, validated, and its parts at the points of the sweep.  Raises InputError.

    problems : found before; the names that a study may have wrong are looked at as well
    """
    issues = Issues()
    specs = read_specs(tree, issues, model)
    parts = resolve(specs, tree, axes, reader, issues)
    spec = build_study_spec(specs, issues, model)
    if problems is not None:
        note_unknown_names(tree, specs, issues)
        _note_names_of_report(specs, tree, axes, parts, issues)
        if tree.get("uncertain") is not None:  # buildings that are only seen have nothing that may be wrong
            from pounding_cli.study.vary import read_uncertain  # here: few studies have distributions

            read_uncertain(tree, problems)
    problems = Problems(file) if problems is None else problems
    place_issues(issues, tree, axes, problems)
    problems.check()
    assert spec is not None  # else something was noted
    return spec, parts


def place_issues(issues: Issues, tree: Map, axes: Sequence[Axis], problems: Problems) -> None:
    """Note issues at their lines and columns, with the values of the sweep at which they arise.

    Where the study as written is faulty, only what is wrong with swept values themselves is told beside that.
    """
    sizes = [len(axis) for axis in axes]
    trees: dict[Point, Map] = {}
    at_points: dict[Problem, None] = {}
    is_faulty = False
    for (issue, numbers), points in issues.points.items():
        for deciding in drop_idle_axes(numbers, points, sizes):
            if isinstance(issue, Problem):
                problems.extend([issue])
                continue
            point = _choose_point(deciding, numbers, len(axes))
            if point not in trees:
                trees = {point: resolve_all_likes(tree_at(tree, axes, point))}
            problem, is_of_point = _place_issue(issue, deciding, trees[point], axes, problems.file)
            if is_of_point:
                at_points[problem] = None
            else:
                problems.extend([problem])
                is_faulty = True
    if not is_faulty and not problems.found:
        kept = sorted(at_points, key=lambda problem: (problem.line, problem.column, problem.message))
        problems.extend(kept[:MAX_AT_POINTS])


def _choose_point(deciding: Mapping[int, int], numbers: tuple[int, ...], count: int) -> Point:
    """Return the point of the sweep at which the file is looked at for the place of an issue.

    deciding : places on the axes that decide about the issue
    numbers : of the axes that the part depends on; of the others, `count` in all, the file itself stands
    """
    return tuple(deciding.get(number, 0 if number in numbers else AS_WRITTEN) for number in range(count))


def _place_issue(
    issue: Issue, deciding: Mapping[int, int], tree: Map, axes: Sequence[Axis], file: str
) -> tuple[Problem, bool]:
    """Return an issue with its place, and whether it arises at a point of the sweep but stands elsewhere.

    deciding : places on the axes that decide about the issue
    tree : the file at the point
    """
    placed = Problems(file)
    placed.add_issue(tree, issue)
    (problem,) = placed.found
    marks = {mark[0] for number, place in deciding.items() for mark in axes[number].marks[place]}
    if not deciding or marks & {problem.line, problem.file}:
        return problem, False
    where = ", ".join(axes[number].format_point(place) for number, place in sorted(deciding.items()))
    return replace(problem, message=f"{problem.message} (where {where})"), True


def _note_names_of_report(
    specs: Mapping[Any, Any], tree: Map, axes: Sequence[Axis], parts: StudyParts, issues: Issues
) -> None:
    """Note the cases and buildings under `report` and `keep` that the study does not have."""
    report = specs.get(("report",))
    group = specs.get(("group",))
    cases = [path[1] for path in specs if path[0] == "cases"]
    for place, case in enumerate((report and report.plot) or ()):
        if cases and case not in cases:
            issues.add_written([Issue(("report", "plot", place), f"plot: no case '{case}'", nearest(case, cases))])
    if report is not None and report.building is not None and group is not None:
        names = dict.fromkeys((*unique_names(group), *group))
        if report.building not in names:
            message = f"no building '{report.building}' in the group"
            issues.add_written([Issue(("report", "building"), message, nearest(report.building, names))])
    if cases:
        suite = next((suite for _, suite in parts.suite.iter_values() if suite is not None), None)
        motions = list(suite.uses) if suite is not None else []
        issues.add_written(keep.find_keep_issues(specs, cases, motions, tree, axes))


def _names_residual_drift(node: Any) -> bool:
    """Return whether a text anywhere in a part of a file names residual drifts."""
    if isinstance(node, Mapping):
        return any(map(_names_residual_drift, (*node.keys(), *node.values())))
    if isinstance(node, list):
        return any(map(_names_residual_drift, node))
    return isinstance(node, str) and RESIDUAL_DRIFT in node
