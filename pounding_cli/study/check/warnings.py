"""Warn about implausible values, numbers without a unit and links that do nothing, at every point of a study."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.model.building import Building
from pounding_cli.numbers import join_limited, pluralize
from pounding_cli.study.check.archetype_words import warn_storeys_outside
from pounding_cli.study.check.doubts import (
    AS_MEANT,
    Doubt,
    Doubts,
    RelativeRange,
    find_text,
    format_rounded,
    format_value,
    lacks_its_unit,
    suggest_value,
    warn_values,
)
from pounding_cli.study.check.floor_plan import warn_missing_accidental, warn_plan, warn_shift_without_effect
from pounding_cli.study.check.links import warn_case
from pounding_cli.study.check.suite_rules import find_suite_issues
from pounding_cli.study.construct.buildings import build_building
from pounding_cli.study.construct.group import Group, find_ignored_blows
from pounding_cli.study.construct.motions import MotionUse, Suite
from pounding_cli.study.construct.resolve import StudyParts, changes_part, resolve, tree_at
from pounding_cli.study.construct.swept import Point
from pounding_cli.study.construct.written import read_specs
from pounding_cli.study.schema.archetypes import KEY
from pounding_cli.study.schema.building import BuildingSpec, StiffnessAtSpec
from pounding_cli.study.schema.like import resolve_all_likes, resolve_like
from pounding_cli.study.schema.quantity import FORCE_FACTORS, NUMBER_PATTERN, PLAUSIBLE_RANGES, Quantity
from pounding_cli.study.schema.records import RecordsSpec
from pounding_cli.study.schema.study import StudySpec
from pounding_cli.study.study import Study
from pounding_cli.study.text.file import Map, Mark, Problems, get
from pounding_cli.study.text.issues import Issues
from pounding_cli.study.vary.axes import UNWRITTEN, Axis, sweep_maps
from pounding_cli.study.vary.inputs import UncertainInput
from pounding_cli.study.vary.uncertain import list_seen_inputs, read_searched, read_uncertain
from pounding_cli.units import GRAVITY

MAX_CHECKED_CORNERS = 256
"""Combinations of the ends of several axes at which values are compared with each other."""

MAX_OPTIONS = 50
"""Options of an uncertain choice that are looked at."""


def find_warnings(study: Study) -> tuple[Issue, ...]:
    """Return what is allowed in a study but should be known, in the order of its lines.

    Looked at are the first point of the sweep, the points where one axis moves away from it, the ends of uncertain and
    searched keys, and the points where every axis is at an end. A key is warned of once, at its worst value.
    """
    warner = _Warner(study.spec, study.file, needs_units=not study.from_data, is_swept_pga=_sweeps_pga(study.tree))
    of_sweep = _View(study.tree, study.axes, study.parts)
    for point in _points_along_axes(study.axes):
        warner.look_at(of_sweep, point)
    of_ends = _resolve_uncertain_ends(study)
    if of_ends is not None:
        for place in range(len(of_ends.axes[0])):
            warner.look_at(of_ends, (place,))
    warner.look_at_corners(of_sweep)
    notes = Problems(study.file)
    for _, suite in study.parts.suite.iter_values():
        for issue in suite.doubts:
            notes.add_issue(study.tree, issue)
    notes.extend(warner.doubts.iter_merged())
    warn_held_period(study, notes)
    for tree in _iter_archetype_trees(study):
        warn_storeys_outside(tree, notes)
    warn_missing_accidental(study, notes)
    warn_shift_without_effect(study, notes)
    if study.spec.impact.dashpot == "printed":
        message = "eq. (7) as printed has the unit 1/s, not kg/s: its dashpot depends on the unit of mass"
        hint = "leave it out for the dashpot that gives the coefficient of restitution"
        notes.add_at(study.tree, ("impact", "dashpot"), message, hint)
    return tuple(sorted(notes.found, key=lambda note: (note.file, note.line, note.column)))


def _iter_archetype_trees(study: Study) -> Iterator[Map]:
    """Yield the study at the first point of its sweep, and along the axes that change buildings that are only seen."""
    axes = [axis for axis in study.axes if any(f".{KEY}" in name for name in axis.names)]
    for point in _points_along_axes(axes):
        yield tree_at(study.units_from, axes, point)


# Where in the sweep


@dataclass(frozen=True, eq=False)
class _View:
    """A study at the points of some axes."""

    tree: Map
    axes: Sequence[Axis]
    parts: StudyParts


def _resolve_uncertain_ends(study: Study) -> _View | None:
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
    return None if len(issues) else _View(tree, axes, parts)


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


# Warnings of one key


class _Warner:
    """Looks at a study point by point; what nothing has changed of since is not looked at again."""

    def __init__(self, spec: StudySpec, file: str, needs_units: bool, is_swept_pga: bool) -> None:
        self.spec = spec
        self.is_swept_pga = is_swept_pga
        self.doubts = Doubts(file, needs_units)
        self.seen: list[tuple[Any, ...]] = []  # keeps what was looked at, so that no other object takes its identity
        self.keys: set[tuple[Any, ...]] = set()

    def look_at(self, view: _View, point: Point) -> None:
        """Note what is doubtful at a point."""
        parts = view.parts
        tree = _LazyTree(view, point)
        group = parts.group.value_at(point)
        for name, types in parts.types.items():
            spec = parts.building_specs[name].value_at(point)
            building = types.value_at(point)
            if self._is_new(name, spec, building):
                warn_building(spec, building, tree, name, self.doubts)
        if self._is_new("group", group.meetings):
            self._warn_ignored_blows(group, tree)
        impact = parts.impact.value_at(point)
        for name, links in parts.complete_links.items():
            laws = parts.link_laws[name].value_at(point)
            if self._is_new(name, links.value_at(point), laws, group):
                warn_case(links.value_at(point), laws, impact, group, tree, self.doubts)
        records = parts.records.value_at(point)
        suite = parts.suite.value_at(point)
        if self._is_new("motions", records, suite):
            warn_motions(records, suite, self.is_swept_pga, tree, self.doubts)
        if self._is_new("rules of a code", records, suite, group):
            for issue in find_suite_issues(records, suite, group):
                self.doubts.add(
                    tree, issue.path, issue.path, issue.message, f"{issue.hint}; otherwise leave it, {AS_MEANT}"
                )

    def look_at_corners(self, view: _View) -> None:
        """Note what several values make doubtful together, of keys that no value makes so by itself."""
        alone = self.doubts
        together = dict[KeyPath, list[Doubt]]()
        for point in _corners(view.axes):
            self.doubts = Doubts(alone.file, alone.needs_units, _keys=dict(alone._keys))
            self.look_at(view, point)
            where = ", ".join(axis.format_point(index) for axis, index in zip(view.axes, point, strict=True))
            for key, doubts in self.doubts.by_key.items():
                for doubt in doubts if key not in alone.by_key else ():
                    message = f"{doubt.problem.message} (where {where})"
                    problem = replace(doubt.problem, message=message)
                    together.setdefault(key, []).append(replace(doubt, problem=problem))
        alone.by_key |= together
        self.doubts = alone

    def _is_new(self, name: str, *parts: Any) -> bool:
        """Return whether parts of the study were not yet looked at together."""
        key = (name, *map(id, parts))
        is_new = key not in self.keys
        if is_new:
            self.keys.add(key)
            self.seen.append(parts)
        return is_new

    def _warn_ignored_blows(self, group: Group, tree: Any) -> None:
        """Note the floors whose blows on columns are left out."""
        for issue in find_ignored_blows(group):
            notes = Problems(self.doubts.file)
            notes.add_issue(tree(), issue)
            for problem in notes.found:
                key: KeyPath = ("group", problem.line, problem.column)
                doubts = self.doubts.by_key.setdefault(key, [])
                if problem not in [doubt.problem for doubt in doubts]:
                    doubts.append(Doubt(problem, False, 0.0))


class _LazyTree:
    """The file at a point with every `like:` resolved, made when it is first asked for: most points need none."""

    def __init__(self, view: _View, point: Point) -> None:
        self.view = view
        self.point = point

    @cached_property
    def tree(self) -> Map:
        """The file."""
        return resolve_all_likes(tree_at(self.view.tree, self.view.axes, self.point))

    def __call__(self) -> Map:
        return self.tree


def _sweeps_pga(tree: Map) -> bool:
    """Return whether the peak that motions are scaled to is swept."""
    return any("records.scale.pga" in holder for holder in sweep_maps(tree))


# Buildings, links and motions


def warn_building(spec: BuildingSpec, building: Building, root: Any, name: str, doubts: Doubts) -> None:
    """Note what is implausible about a building type: masses, heights, period, damping, yield shears, isolators."""
    path: KeyPath = ("buildings", name)
    warn_values(spec, root, path, doubts)
    if spec.wall is not None:
        return
    _warn_period(spec, building, root, path, doubts)
    lines = () if spec.plan is None else spec.plan.lines or ()
    if isinstance(spec.yield_shear, tuple):
        _warn_yield_shear(building, root, (*path, "yield_shear", 0), doubts)
    elif lines and all(isinstance(line.yield_shear, tuple) for line in lines):
        _warn_yield_shear(building, root, (*path, "plan", "lines", 0, "yield_shear", 0), doubts, len(lines))
    _warn_base(building, root, path, doubts)
    if spec.plan is not None:
        warn_plan(spec.plan, building, root, (*path, "plan"), doubts)


def _warn_yield_shear(building: Building, root: Any, key_path: KeyPath, doubts: Doubts, lines: int = 1) -> None:
    """Note a yield shear of the lowest storey that is implausible beside the weight.

    key_path : of the yield shear, or of that of the first of its frame lines
    lines : number of these
    """
    fits = PLAUSIBLE_RANGES["base yield shear over weight"]
    compared = RelativeRange(fits, 1 / building.weight, "yield shear", "of the building's weight")
    shear = float(building.yield_shear[0])
    if fits.holds(shear * compared.share):
        return
    share = compared.ratio_in_words(shear)
    message = f"the lowest storey yields at {format_value(shear, FORCE_FACTORS)}, {share}: {fits.reason}"
    text = find_text(root, key_path)
    is_bare = doubts.needs_units and lacks_its_unit(text, FORCE_OF_STOREY)
    hint = "check the yield shears of its lines"
    if lines == 1:
        hint = suggest_value(text, shear, fits, compared.share, "N" if is_bare else "")
    doubts.add(root, key_path, key_path[:-1], message, hint, is_bare, excess=fits.excess(shear * compared.share))


FORCE_OF_STOREY = Quantity("force", "N", "900 kN")


def _warn_period(spec: BuildingSpec, building: Building, root: Any, path: KeyPath, doubts: Doubts) -> None:
    """Note a period that is implausible for so many storeys."""
    storeys = building.storeys
    key_path: KeyPath = (*path, "period")
    period = float(building.periods[0]) if spec.period is None else spec.period
    if spec.stiffness is not None:
        key_path = (*path, "stiffness", "period" if isinstance(spec.stiffness, StiffnessAtSpec) else 0)
    elif spec.period is None:
        key_path = (*path, "plan", "lines", 0, "stiffness", 0)
    compared = [(PLAUSIBLE_RANGES["period of a storey"], 1 / storeys)] if storeys > 1 else []
    compared.append((PLAUSIBLE_RANGES["period"], 1.0))
    for fits, share in compared:
        if fits.holds(period * share):
            continue
        message = f"a period of {format_rounded(period)} s for {pluralize(storeys, 'storey')}: {fits.reason}"
        hint = (
            suggest_value(find_text(root, key_path), period, fits, share)
            if key_path[-1] == "period"
            else "check its unit"
        )
        key = key_path if key_path[-1] == "period" else key_path[:-1]
        doubts.add(root, key_path, key, message, hint, excess=fits.excess(period * share))
        return


def _warn_base(building: Building, root: Any, path: KeyPath, doubts: Doubts) -> None:
    """Note a base so soft that the building would float on it."""
    base = building.foundation
    if base is None or not base.sways:
        return
    fits = PLAUSIBLE_RANGES["period on a moving base"]
    weight = building.weight + base.mass * GRAVITY
    if base.isolation is None:
        key_path: KeyPath = (*path, "foundation", "sway_stiffness")
        period = 2 * np.pi * float(np.sqrt(weight / GRAVITY / base.sway_stiffness))
    else:
        key_path = (*path, "foundation", "isolation")
        reach = base.isolation.capacity if np.isfinite(base.isolation.capacity) else 0.1
        period, _ = base.isolation.effective(weight, reach)
    if not fits.holds(period):
        message = f"{building.name} has a period of {format_rounded(period)} s on its base: {fits.reason}"
        text = find_text(root, key_path)
        is_bare = doubts.needs_units and base.isolation is None and bool(re.fullmatch(rf"\s*{NUMBER_PATTERN}\s*", text))
        hint = f"did you mean {text} kN/m? otherwise write `{text} N/m`" if is_bare else "check its stiffness"
        doubts.add(root, key_path, key_path, message, hint, is_bare, excess=fits.excess(period))


def warn_motions(spec: RecordsSpec, suite: Suite, is_swept_pga: bool, root: Any, doubts: Doubts) -> None:
    """Note accelerations without a unit, and peaks of the ground that are implausible, asked for or as used."""
    warn_values(spec, root, ("records",), doubts)
    key_path: KeyPath = ("records", "scale", "pga")
    asked = getattr(spec.scale, "pga", None)
    fits = PLAUSIBLE_RANGES["peak asked for"]
    if asked is not None and not is_swept_pga:
        if key_path not in doubts.by_key and not fits.holds(asked):
            message = f"{fits.name} is {format_value(asked, fits.units)}: {fits.reason}"
            doubts.add(
                root,
                key_path,
                key_path,
                message,
                suggest_value(find_text(root, key_path), asked, fits),
                excess=fits.excess(asked),
            )
        return
    if not any(key[:2] == key_path[:2] for key in doubts.by_key):  # else the peaks are what follows from that value
        _warn_peaks(list(suite.uses.values()), root, doubts)


def _warn_peaks(uses: Sequence[MotionUse], root: Any, doubts: Doubts) -> None:
    """Note peaks of the ground that are implausible as used, or above 2 g both in the file and as used."""
    fits = PLAUSIBLE_RANGES["peak of a motion"]
    unlikely = [use for use in uses if not fits.holds(use.pga) or use.pga / max(use.scale, 1.0) > 2 * GRAVITY]
    if unlikely:
        hint = f"check `unit:` of its file and `scale:`; otherwise leave it, {AS_MEANT}"
        peaks = join_limited(f"{use.name} ({use.pga / GRAVITY:.3g} g)" for use in unlikely)
        key_path: KeyPath = ("records", "scale" if any(use.scale != 1 for use in unlikely) else "use")
        excess = max(fits.excess(use.pga) for use in unlikely)
        doubts.add(root, key_path, key_path, f"unlikely peaks: {peaks}: {fits.reason}", hint, excess=excess)


# A mass that varies


def warn_held_period(study: Study, notes: Problems) -> None:
    """Note every mass that varies in a building with a `period`: its stiffness follows the mass."""
    spec = study.spec
    for key, mark, beside in _varied_masses(study.tree):
        names = [
            name
            for name in dict.fromkeys(spec.group)
            if changes_part(key, ("buildings", name), study.tree)
            and spec.buildings[name].period is not None
            and f"buildings.{name}.period" not in beside
        ]
        if not names:
            continue
        has_code_strength = "inelastic" in spec.analyses and spec.buildings[names[0]].yield_shear is None
        held = f"the period of {names[0]} is" if len(names) == 1 else f"the periods of {join_limited(names)} are"
        message = f"where the mass varies, {held} held: the stiffness follows the mass"
        if has_code_strength:
            message += ", and the yield shears follow the weight"
        hint = _hint_to_hold(study, names[0], has_code_strength)
        likewise = f" (of {names[0]}; likewise in the others)" if len(names) > 1 else ""
        notes.add(mark, message, f"{hint}{likewise}; otherwise leave it, {AS_MEANT}")


MASS_KEYS = frozenset({"mass"})
"""Keys of a building that change its floor masses."""


def _varied_masses(root: Map) -> Iterator[tuple[str, Mark, frozenset[str]]]:
    """Yield the keys of masses that vary, where each stands, and the keys that move with it."""
    for section in (("sweep",), ("uncertain",), ("optimise", "over")):
        node = get(root, *section)
        for holder in node if isinstance(node, list) else [node]:
            for key in holder if isinstance(holder, Map) else ():
                section_of_key, _, rest = key.partition(".")
                if section_of_key == "buildings" and set(rest.split(".")[1:2]) & MASS_KEYS:
                    beside = frozenset(holder) if isinstance(node, list) else frozenset[str]()
                    yield key, holder.marks[key][0], beside


def _hint_to_hold(study: Study, name: str, has_code_strength: bool) -> str:
    """Return what to write to hold the stiffness of a building, and its yield shears."""
    tree = resolve_like(study.tree["buildings"], name)
    default = BuildingSpec.model_fields["mass"].default
    mass = get(tree, "mass")
    building = build_building(name, study.spec.buildings[name])
    period = get(tree, "period")
    if period is None:  # of a building that is only seen
        period = f"{building.periods[0]:.4g} s"
    hint = (
        f"to hold the stiffness, write `stiffness: {{period: {period}, mass: {default if mass is None else mass}}}` "
        "in place of `period`"
    )
    if has_code_strength:
        shears = ", ".join(f"{shear / 1e3:.5g} kN" for shear in building.yield_shear.tolist())
        hint += f"; to hold the yield shears too, `yield_shear: [{shears}]` in place of `yield`"
    return hint
