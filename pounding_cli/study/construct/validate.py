"""Validate the tree of a study at every point of its sweep; what is wrong is told once, at its line and column."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from pounding_cli.errors import Issue
from pounding_cli.study.construct import keep
from pounding_cli.study.construct.group import unique_names
from pounding_cli.study.construct.motions import MotionReader
from pounding_cli.study.construct.resolve import StudyParts, resolve, tree_at
from pounding_cli.study.construct.swept import AS_WRITTEN, Point
from pounding_cli.study.construct.written import build_study_spec, read_specs
from pounding_cli.study.schema.like import resolve_all_likes
from pounding_cli.study.schema.study import StudySpec
from pounding_cli.study.text.file import Map, Problems, nearest
from pounding_cli.study.text.issues import Issues, drop_idle_axes
from pounding_cli.study.vary.axes import Axis
from pounding_cli.study.vary.uncertain import read_uncertain

MAX_AT_POINTS = 20
"""Problems of single points of the sweep that are told."""


def validate_tree(
    tree: Map,
    axes: tuple[Axis, ...],
    reader: MotionReader,
    file: str,
    model: type[StudySpec],
    problems: Problems | None = None,
) -> tuple[StudySpec, StudyParts]:
    """Return a study as written, validated, and its parts at the points of the sweep.  Raises InputError.

    problems : found before; the names under `report` and `keep` are looked at as well
    """
    issues = Issues()
    specs = read_specs(tree, issues, model)
    parts = resolve(specs, tree, axes, reader, issues)
    spec = build_study_spec(specs, issues, model)
    if problems is not None:
        _note_names_of_report(specs, tree, axes, parts, issues)
        if tree.get("uncertain") is not None:  # buildings that are only seen have nothing that may be wrong
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
    at_points: dict[Issue, None] = {}
    is_faulty = False
    for (issue, numbers), points in issues.points.items():
        for deciding in drop_idle_axes(numbers, points, sizes):
            if issue.is_placed:
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
) -> tuple[Issue, bool]:
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
