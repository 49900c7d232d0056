"""Find what is allowed in a study but should be known, at every point of it.

Checks are generators of issues: of a point (`iter_checks`), or of the study as a whole (`iter_checks_of_study`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

from pounding_cli.errors import Issue
from pounding_cli.study.check.archetype_words import check_storeys
from pounding_cli.study.check.buildings import check_building
from pounding_cli.study.check.doubts import Doubts
from pounding_cli.study.check.floor_plan import check_accidental, check_shift
from pounding_cli.study.check.links import check_case
from pounding_cli.study.check.motions import check_motions
from pounding_cli.study.check.suite_rules import check_suite
from pounding_cli.study.check.varied_mass import check_held_period
from pounding_cli.study.check.view import View
from pounding_cli.study.construct.group import find_ignored_blows
from pounding_cli.study.construct.resolve import resolve, tree_at
from pounding_cli.study.construct.swept import Point
from pounding_cli.study.construct.written import read_specs
from pounding_cli.study.schema.archetypes import KEY
from pounding_cli.study.schema.like import resolve_all_likes
from pounding_cli.study.study import Study
from pounding_cli.study.text.file import Map, Problems, get, place_issue
from pounding_cli.study.text.issues import Issues
from pounding_cli.study.vary.axes import UNWRITTEN, Axis
from pounding_cli.study.vary.inputs import UncertainInput
from pounding_cli.study.vary.uncertain import list_seen_inputs, read_searched, read_uncertain

MAX_CHECKED_CORNERS = 256
"""Combinations of the ends of several axes at which values are compared with each other."""

MAX_OPTIONS = 50
"""Options of an uncertain choice that are looked at."""


def find_warnings(study: Study) -> tuple[Issue, ...]:
    """Return what is allowed in a study but should be known and it does not accept, in the order of its lines.

    Looked at are the first point of the sweep, the points where one axis moves away from it, the ends of uncertain and
    searched keys, and the points where every axis is at an end. A key is warned of once, at its worst value.
    """
    doubts = Doubts(study.file)
    visited = _Visited()
    of_sweep = View(study.tree, study.axes, study.parts, needs_units=not study.from_data)
    for point in _points_along_axes(study.axes):
        visited.look_at(of_sweep.at(point), doubts)
    of_ends = _resolve_uncertain_ends(study)
    if of_ends is not None:
        for place in range(len(of_ends.axes[0])):
            visited.look_at(of_ends.at((place,)), doubts)
    together = Doubts(study.file)
    for point in _corners(study.axes):
        view = of_sweep.at(point)
        of_corner = doubts.start_anew()
        visited.look_at(view, of_corner)
        of_corner.add_where(view.where)
        together.extend(of_corner)
    doubts.extend(together, only_new=True)
    found = [place_issue(tree, study.file, issue) for tree, issues in iter_checks_of_study(study) for issue in issues]
    found += doubts.iter_merged()
    told = dict.fromkeys(each for each in found if each.code not in study.spec.accept)
    return tuple(sorted(told, key=lambda issue: (issue.file, issue.line, issue.column)))


class _Visited:
    """What was looked at, so that no check looks at the same parts of a study again."""

    def __init__(self) -> None:
        self.keys: set[tuple[Any, ...]] = set()
        self.parts: list[tuple[Any, ...]] = []  # keeps them, so that no other object takes the identity of one

    def look_at(self, view: View, doubts: Doubts) -> None:
        """Note what is doubtful at a point and was not looked at before."""
        for name, parts, issues in iter_checks(view):
            key = (name, *map(id, parts))
            if key not in self.keys:
                self.keys.add(key)
                self.parts.append(parts)
                found = list(issues)
                if found:
                    doubts.add(view.written.tree, found)


def iter_checks(view: View) -> Iterator[tuple[str, tuple[Any, ...], Iterator[Issue]]]:
    """Yield every check of a point: its name, the parts of the study that it looks at, and the issues that it finds."""
    for name in view.parts.types:
        yield f"building {name}", (view.building_spec(name), view.building(name)), check_building(view, name)
    yield "blows on columns", (view.group.meetings,), find_ignored_blows(view.group)
    for name in view.parts.complete_links:
        yield f"case {name}", (view.links_of(name), view.laws_of(name), view.group), check_case(view, name)
    yield "motions", (view.records, view.suite), check_motions(view)
    yield "rules of a code", (view.records, view.suite, view.group), check_suite(view)


def iter_checks_of_study(study: Study) -> Iterator[tuple[Map, Iterator[Issue]]]:
    """Yield every check of a study as a whole: the file in which its issues stand, and the issues."""
    for _, suite in study.parts.suite.iter_values():
        yield study.tree, iter(suite.doubts)
    yield study.tree, check_held_period(study)
    for tree in _iter_archetype_trees(study):
        yield resolve_all_likes(tree), check_storeys(tree)
    yield study.tree, check_accidental(study)
    yield study.tree, check_shift(study)
    yield study.tree, _check_printed_dashpot(study)


def _check_printed_dashpot(study: Study) -> Iterator[Issue]:
    """Yield a dashpot as the paper prints it."""
    if study.spec.impact.dashpot == "printed":
        message = "eq. (7) as printed has the unit 1/s, not kg/s: its dashpot depends on the unit of mass"
        hint = "leave it out for the dashpot that gives the coefficient of restitution"
        yield Issue(("impact", "dashpot"), message, hint, code="printed-dashpot")


def _iter_archetype_trees(study: Study) -> Iterator[Map]:
    """Yield the study at the first point of its sweep, and along the axes that change buildings that are only seen."""
    axes = [axis for axis in study.axes if any(f".{KEY}" in name for name in axis.names)]
    for point in _points_along_axes(axes):
        yield tree_at(study.units_from, axes, point)


# Where in the sweep


def _resolve_uncertain_ends(study: Study) -> View | None:
    """Return the study at the first point of its sweep with one axis, on which one uncertain or searched key after the
    other takes the ends of its range or its options; None without such keys.

    None also of a study that is not sound at one of them: who draws such a sample is told then.
    """
    inputs: list[UncertainInput] = []
    problems = Problems(study.file)
    if study.tree.get("uncertain") is not None or get(study.tree, "optimise", "over") is not None:
        if study.tree.get("uncertain") is not None:
            unwritten = {(each.key, each.mark) for each in list_seen_inputs(study.tree)}
            uncertain = read_uncertain(study.tree, problems)
            inputs += [each for each in uncertain if (each.key, each.mark) not in unwritten]
        if isinstance(get(study.tree, "optimise", "over"), Map):
            inputs += read_searched(study.tree, problems)
    if problems.found or not any(each.members for each in inputs):
        return None
    axes = (_build_axis_of_ends(inputs),)
    tree = tree_at(study.tree, study.axes, study.first_point)
    issues = Issues()
    parts = resolve(read_specs(tree, issues, type(study.spec)), tree, axes, study.reader, issues)
    return None if len(issues) else View(tree, axes, parts, needs_units=not study.from_data)


def _build_axis_of_ends(inputs: Sequence[UncertainInput]) -> Axis:
    """Return an axis on which one key after the other takes the ends of its range, or its options."""
    members = [member for each in inputs for member in each.members]
    names = tuple(member.key for member in members)
    marks = tuple(member.mark for member in members)
    units = tuple(member.unit for member in members)
    rows = []
    for each in inputs:
        quantiles = each.end_quantiles()[:MAX_OPTIONS]
        columns = [member.values(quantiles) for member in each.members]
        for values in zip(*columns, strict=True):
            moved = dict(zip((member.key for member in each.members), values, strict=True))
            rows.append(tuple(moved.get(name, UNWRITTEN) for name in names))
    return Axis(names, rows, [marks] * len(rows), units)


def _points_along_axes(axes: Sequence[Axis]) -> Iterator[Point]:
    """Yield the first point of a sweep, and those that differ from it in one axis."""
    first = (0,) * len(axes)
    yield first
    for place, axis in enumerate(axes):
        for index in range(1, len(axis)):
            yield (*first[:place], index, *first[place + 1 :])


def _corners(axes: Sequence[Axis]) -> Iterator[Point]:
    """Yield the points where every axis is at an end of its values, at most MAX_CHECKED_CORNERS.

    What is compared with each other grows or falls with each value, so that the worst combinations stand there.
    """
    ends: list[tuple[int, ...]] = []
    for axis in axes:
        sizes = [next((value for value in values if not isinstance(value, str)), 0.0) for values in axis.values]
        order = sorted(range(len(sizes)), key=sizes.__getitem__)
        has_room = len(axis) > 1 and 2 ** len(ends) < MAX_CHECKED_CORNERS
        ends.append((order[0], order[-1]) if has_room else (0,))
    if len(axes) > 1:
        yield from product(*ends)
