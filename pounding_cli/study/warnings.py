"""Warn about implausible values, numbers without a unit and links that do nothing (`quantity.py` has the ranges)."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any, get_args, get_origin

import numpy as np
from pydantic import BaseModel

from pounding_cli.errors import Problem
from pounding_cli.laws.joints import MAX_STABLE_STEP_AT_REST, Viscous
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.building import Building
from pounding_cli.model.twist import is_eccentric
from pounding_cli.model.wall import Wall
from pounding_cli.numbers import join_limited, pluralize
from pounding_cli.study.archetype_words import warn_storeys_outside
from pounding_cli.study.axes import UNWRITTEN, Axis, sweep_maps
from pounding_cli.study.building_spec import BuildingSpec, StiffnessAtSpec
from pounding_cli.study.buildings import build_building
from pounding_cli.study.file import Map, Mark, Problems, get, locate
from pounding_cli.study.floor_places import FloorPair
from pounding_cli.study.group import Group, find_ignored_blows
from pounding_cli.study.issues import Issues, KeyPath
from pounding_cli.study.like import resolve_all_likes, resolve_like
from pounding_cli.study.link_places import build_ends
from pounding_cli.study.link_specs import ImpactSpec
from pounding_cli.study.links import CompleteLink
from pounding_cli.study.motions import MotionUse, Suite
from pounding_cli.study.plan_spec import PlanSpec
from pounding_cli.study.quantity import (
    FORCES,
    NUMBER,
    PLAUSIBLE_RANGES,
    ParsedText,
    PlausibleRange,
    Quantity,
    lacks_unit,
)
from pounding_cli.study.records_spec import RecordsSpec
from pounding_cli.study.resolve import Resolved, changes_part, resolve, tree_at
from pounding_cli.study.schema import StudySpec
from pounding_cli.study.suite_rules import find_suite_issues
from pounding_cli.study.swept import Point
from pounding_cli.study.words import fields_of, leaf_types
from pounding_cli.study.written import read_specs
from pounding_cli.units import GRAVITY

if TYPE_CHECKING:
    from pounding_cli.study.study import Study
    from pounding_cli.study.vary import UncertainInput

MAX_CORNERS = 256
"""Combinations of the ends of several axes at which values are compared with each other."""

MAX_OPTIONS = 50
"""Options of an uncertain choice that are looked at."""

MAX_IN_G = 3.0
"""Largest number without a unit that may have been meant in g: recorded peaks reach 3 g."""

MIN_IN_CM = 0.1
"""Smallest number without a unit that may have been a gap in cm: of gaps in m hardly one is as wide."""

AS_MEANT = "the study runs as it is"
_NUMBER_AND_UNIT = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*\Z")


def find_warnings(study: Study) -> tuple[Problem, ...]:
    """Return what is allowed in a study but should be known, in the order of its lines.

    Looked at are the first point of the sweep, the points where one axis moves away from it, the ends of uncertain and
    searched keys, and the points where every axis is at an end. A key is warned of once, at its worst value.
    """
    warner = _Warner(study.spec, study.file, needs_units=not study.from_data, is_swept_pga=_sweeps_pga(study.tree))
    of_sweep = _View(study.tree, study.axes, study.resolved)
    for point in _points_along_axes(study.axes):
        warner.look_at(of_sweep, point)
    of_ends = _resolve_uncertain_ends(study)
    if of_ends is not None:
        for place in range(len(of_ends.axes[0])):
            warner.look_at(of_ends, (place,))
    warner.look_at_corners(of_sweep)
    notes = Problems(study.file)
    for _, suite in study.resolved.suite.iter_values():
        for issue in suite.doubts:
            notes.add_issue(study.tree, issue)
    notes.extend(warner.doubts.iter_merged())
    warn_held_period(study, notes)
    warn_storeys_outside(study, notes)
    warn_codes_without_twist(study, notes)
    if study.spec.impact.dashpot == "printed":
        message = "eq. (7) as printed has the unit 1/s, not kg/s: its dashpot depends on the unit of mass"
        hint = "leave it out for the dashpot that gives the coefficient of restitution"
        notes.at(study.tree, ("impact", "dashpot"), message, hint)
    return tuple(sorted(notes.found, key=lambda note: (note.file, note.line, note.column)))


# Where in the sweep


@dataclass(frozen=True, eq=False)
class _View:
    """A study at the points of some axes."""

    tree: Map
    axes: Sequence[Axis]
    resolved: Resolved


def _resolve_uncertain_ends(study: Study) -> _View | None:
    """Return the study at the first point of its sweep with one axis, on which one uncertain or searched key after the
    other takes the ends of its range or its options; None without such keys.

    None also of a study that is not sound at one of them: who draws such a sample is told then.
    """
    inputs: list[UncertainInput] = []
    problems = Problems(study.file)
    if study.tree.get("uncertain") is not None or get(study.tree, "optimise", "over") is not None:
        from pounding_cli.study import vary  # here: few studies have distributions

        if study.tree.get("uncertain") is not None:
            inputs += vary.read_uncertain(study.tree, problems)
        if isinstance(get(study.tree, "optimise", "over"), Map):
            inputs += vary.read_searched(study.tree, problems)
    if problems.found or not any(each.members for each in inputs):
        return None
    axes = (_build_axis_of_ends(inputs),)
    tree = tree_at(study.tree, study.axes, study.first_point)
    issues = Issues()
    resolved = resolve(read_specs(tree, issues, type(study.spec)), tree, axes, study.reader, issues)
    return None if len(issues) else _View(tree, axes, resolved)


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
    """Yield the points where every axis is at an end of its values, at most MAX_CORNERS.

    What is compared with each other grows or falls with each value, so that the worst combinations stand there.
    """
    ends: list[tuple[int, ...]] = []
    for axis in axes:
        sizes = [next((value for value in values if not isinstance(value, str)), 0.0) for values in axis.values]
        order = sorted(range(len(sizes)), key=sizes.__getitem__)
        has_room = len(axis) > 1 and 2 ** len(ends) < MAX_CORNERS
        ends.append((order[0], order[-1]) if has_room else (0,))
    if len(axes) > 1:
        yield from product(*ends)


# Warnings of one key


@dataclass(frozen=True)
class Doubt:
    """A warning of one value.

    is_bare : whether the value has no unit
    excess : power of ten by which it is beyond what is plausible; 0 where it is plausible
    """

    problem: Problem
    is_bare: bool
    excess: float


@dataclass
class Doubts:
    """Collects warnings of values by the keys that they are of.

    needs_units : whether a number should have its unit, as in a file; in Python data numbers are SI
    """

    file: str
    needs_units: bool = True
    by_key: dict[KeyPath, list[Doubt]] = field(default_factory=dict)
    _keys: dict[Mark, KeyPath] = field(default_factory=dict)

    def add(
        self,
        root: Any,
        path: KeyPath,
        key: KeyPath,
        message: str,
        hint: str,
        is_bare: bool = False,
        excess: float = 0.0,
    ) -> None:
        """Note a warning of the value at `path`, one of those of `key`.

        A value that several buildings or cases take from one place of the file counts for the first of them.
        """
        mark = locate(root, path)
        if get(root, *path) is not None:
            key = self._keys.setdefault(mark, key)
        noted = Problems(self.file)
        noted.add(mark, message, hint)
        (problem,) = noted.found
        doubts = self.by_key.setdefault(key, [])
        if problem not in [doubt.problem for doubt in doubts]:
            doubts.append(Doubt(problem, is_bare, excess))

    def iter_merged(self) -> Iterator[Problem]:
        """Yield one warning a key: that of its worst value, which counts the others."""
        for doubts in self.by_key.values():
            worst = max(doubts, key=lambda doubt: (doubt.is_bare, doubt.excess))
            others = len(doubts) - 1
            more = f"; and {others} more like it" if others else ""
            yield replace(worst.problem, message=worst.problem.message + more)


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
        resolved = view.resolved
        tree = _LazyTree(view, point)
        group = resolved.group.at(point)
        for name, types in resolved.types.items():
            spec = resolved.building_specs[name].at(point)
            building = types.at(point)
            if self._is_new(name, spec, building):
                warn_building(spec, building, tree, name, self.doubts)
        if self._is_new("group", group.meetings):
            self._warn_ignored_blows(group, tree)
        impact = resolved.impact.at(point)
        for name, links in resolved.complete_links.items():
            laws = resolved.link_laws[name].at(point)
            if self._is_new(name, links.at(point), laws, group):
                warn_case(links.at(point), laws, impact, group, tree, self.doubts)
        records = resolved.records.at(point)
        suite = resolved.suite.at(point)
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


@dataclass(frozen=True)
class Comparison:
    """The plausible range of values of a key, beside something else.

    fits : plausible range of value * share
    share : reciprocal of what they are compared with [1/SI unit of the value]
    name : of the value, in words
    than : what they are compared with, in words
    """

    fits: PlausibleRange
    share: float
    name: str
    than: str

    def ratio_in_words(self, value: float) -> str:
        """Return the ratio in words, e.g. `0.2 times that of the stiffest storey`."""
        return f"{value * self.share:.2g} {self.than}"


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
        _warn_plan(spec.plan, building, root, (*path, "plan"), doubts)


def _warn_yield_shear(building: Building, root: Any, at: KeyPath, doubts: Doubts, lines: int = 1) -> None:
    """Note a yield shear of the lowest storey that is implausible beside the weight.

    at : of the yield shear, or of that of the first of its frame lines
    lines : number of these
    """
    fits = PLAUSIBLE_RANGES["base yield shear over weight"]
    compared = Comparison(fits, 1 / building.weight, "yield shear", "of the building's weight")
    shear = float(building.yield_shear[0])
    if fits.holds(shear * compared.share):
        return
    share = compared.ratio_in_words(shear)
    message = f"the lowest storey yields at {format_value(shear, FORCES)}, {share}: {fits.reason}"
    text = _text_at(root, at)
    is_bare = doubts.needs_units and _is_bare(text, FORCE_OF_STOREY)
    hint = "check the yield shears of its lines"
    if lines == 1:
        hint = _hint(text, shear, fits, compared.share, "N" if is_bare else "")
    doubts.add(root, at, at[:-1], message, hint, is_bare, excess=fits.excess(shear * compared.share))


FORCE_OF_STOREY = Quantity("force", "N", "900 kN")


def _warn_period(spec: BuildingSpec, building: Building, root: Any, path: KeyPath, doubts: Doubts) -> None:
    """Note a period that is implausible for so many storeys."""
    storeys = building.storeys
    at: KeyPath = (*path, "period")
    period = float(building.periods[0]) if spec.period is None else spec.period
    if spec.stiffness is not None:
        at = (*path, "stiffness", "period" if isinstance(spec.stiffness, StiffnessAtSpec) else 0)
    elif spec.period is None:
        at = (*path, "plan", "lines", 0, "stiffness", 0)
    compared = [(PLAUSIBLE_RANGES["period of a storey"], 1 / storeys)] if storeys > 1 else []
    compared.append((PLAUSIBLE_RANGES["period"], 1.0))
    for fits, share in compared:
        if fits.holds(period * share):
            continue
        message = f"a period of {_format_rounded(period)} s for {pluralize(storeys, 'storey')}: {fits.reason}"
        hint = _hint(_text_at(root, at), period, fits, share) if at[-1] == "period" else "check its unit"
        key = at if at[-1] == "period" else at[:-1]
        doubts.add(root, at, key, message, hint, excess=fits.excess(period * share))
        return


def _warn_base(building: Building, root: Any, path: KeyPath, doubts: Doubts) -> None:
    """Note a base so soft that the building would float on it."""
    base = building.foundation
    if base is None or not base.sways:
        return
    fits = PLAUSIBLE_RANGES["period on a moving base"]
    weight = building.weight + base.mass * GRAVITY
    if base.isolation is None:
        at: KeyPath = (*path, "foundation", "sway_stiffness")
        period = 2 * np.pi * float(np.sqrt(weight / GRAVITY / base.sway_stiffness))
    else:
        at = (*path, "foundation", "isolation")
        reach = base.isolation.capacity if np.isfinite(base.isolation.capacity) else 0.1
        period, _ = base.isolation.effective(weight, reach)
    if not fits.holds(period):
        message = f"{building.name} has a period of {_format_rounded(period)} s on its base: {fits.reason}"
        text = _text_at(root, at)
        is_bare = doubts.needs_units and base.isolation is None and bool(re.fullmatch(rf"\s*{NUMBER}\s*", text))
        hint = f"did you mean {text} kN/m? otherwise write `{text} N/m`" if is_bare else "check its stiffness"
        doubts.add(root, at, at, message, hint, is_bare, excess=fits.excess(period))


RATIOS_OF_TWIST = (0.7, 3.0)
"""Frequency of the twist over that along the row [-] beyond which it is warned of: frames at all edges give 1 to 1.5, a
core alone in the middle 0.7, walls at all edges 2."""

RADII_OF_GYRATION = (0.2, 0.8)
"""Radius of gyration of a floor over its width [-] beyond which it is warned of: a narrow strip along the street has
0.29, a floor that is twice as deep as wide 0.65."""

MAX_ECCENTRICITY = 0.35
"""Eccentricity over the width [-] above which it is warned of: a core at one end, frames at the other give a third."""


def _warn_plan(spec: PlanSpec, building: Building, root: Any, path: KeyPath, doubts: Doubts) -> None:
    """Note a plan that hardly any building has: eccentricity, rotary inertia, resistance to the twist."""
    plan = building.plan
    assert plan is not None
    lines_key = "lines" if spec.lines is not None else "eccentricity"
    largest = float(np.abs(plan.eccentricity).max()) / spec.width
    if largest > MAX_ECCENTRICITY:
        at: KeyPath = (*path, lines_key)
        message = f"the centre of stiffness stands {100 * largest:.3g} % of the width from the centre of mass: "
        message += "a core at one end with frames at the other gives a third"
        hint = f"check the places and the stiffness of the lines; otherwise leave it, {AS_MEANT}"
        doubts.add(root, at, at, message, hint, excess=largest)
    radius = np.sqrt(plan.inertia / building.mass) / spec.width
    low, high = RADII_OF_GYRATION
    wrong = np.flatnonzero((radius < low) | (radius > high))
    if spec.inertia is not None and wrong.size:
        storey = int(wrong[0])
        at = (*path, "inertia", storey) if isinstance(spec.inertia, tuple) else (*path, "inertia")
        usual = float(building.mass[storey]) * spec.width**2 / np.array([9.0, 4.0])
        message = f"floor {storey + 1} turns as if its mass stood {radius[storey] * spec.width:.3g} m from its centre"
        message += f", on a plan {spec.width:g} m wide"
        units = units_of_size("kg m2")
        hint = f"write an inertia near {' to '.join(format_value(float(each), units) for each in usual)}; "
        hint += f"otherwise leave it, {AS_MEANT}"
        doubts.add(root, at, (*path, "inertia"), message, hint, excess=abs(float(np.log10(radius[storey]))))
    ratio = plan.frequency_ratio(building.mass)
    low, high = RATIOS_OF_TWIST
    if not low <= ratio <= high:
        keys = ("frequency_ratio", "torsional_stiffness", "lines")
        key = next(each for each in keys if each in spec.model_fields_set)
        at = (*path, key)
        message = f"{building.name} turns {ratio:.3g} times as fast as it moves along the row, each by itself: "
        message += "frames at the edges give 1 to 1.5, a core in the middle 0.7, walls at all edges 2"
        hint = f"check the places of lines, the torsional stiffness and the inertia; otherwise leave it, {AS_MEANT}"
        doubts.add(root, at, at, message, hint, excess=abs(float(np.log10(ratio))))


def warn_case(
    links: Sequence[CompleteLink],
    laws: Sequence[LinkLaw | None],
    impact: ImpactSpec,
    group: Group,
    root: Any,
    doubts: Doubts,
) -> None:
    """Note what is implausible about the links of a case: gaps, links that do nothing, contacts that floors pass."""
    for link, law in zip(links, laws, strict=True):
        compared = _compare_link(law, group) if law is not None else {}
        stiffness = link.values.get("stiffness")
        if stiffness is not None and "stiffness" in compared:
            at = link.paths["stiffness"]
            _warn_compared(group.stiffness(stiffness), root, at, compared["stiffness"], doubts)
        quantities = _quantities(type(link.spec))
        for key, path in link.paths.items():
            quantity = quantities[key][1]
            value = link.values[key]
            if key != "stiffness" and quantity is not None and isinstance(value, float):
                _warn_value(key, quantity, value, root, path, path, doubts, compared.get(key))
        if law is not None and _takes_impact_stiffness(law, link):
            contact = _compare_contact(group)
            _warn_compared(group.stiffness(impact.stiffness), root, ("impact", "stiffness"), contact, doubts)
        if isinstance(law, Viscous):
            _warn_stiff_damper(law, group, root, link.path, doubts)
        if law is not None:
            _warn_unequal_heights(link, law, group, root, doubts)
            _warn_link_nowhere(link, law, group, root, doubts)


MIN_COSINE = 0.3
"""Cosine of the angle of a link below which it is warned about: it carries a tenth of what a level one does."""


def _warn_unequal_heights(link: CompleteLink, law: LinkLaw, group: Group, root: Any, doubts: Doubts) -> None:
    """Note links whose ends differ in height: joints that act level or are steep, contacts where nothing strikes."""
    floors = link.spec.floors if isinstance(link.spec.floors, tuple) else ()
    for place, floor in enumerate(floors):
        path: KeyPath = (*link.path, "floors", place)
        for number, meeting in enumerate(group.meetings, 1):
            if not isinstance(floor, FloorPair) or link.spec.pair not in (None, number):
                continue
            ends = build_ends(link.spec, floor, meeting, path)
            rise = abs(meeting.find_rise(ends))
            left_end = f"floor {floor.left} of {meeting.left.name}"
            which = f"the {law.name} from {left_end} to floor {floor.right} of {meeting.right.name}"
            heights = f"its ends differ by {rise:.3g} m in height"
            if law.joins and link.spec.distance is None and rise > meeting.reach:
                message = f"{which} acts level, though {heights}"
                hint = "write how far its ends are apart along the row, which gives its angle, e.g. `distance: 2 m`"
            elif not law.joins and rise > meeting.reach:
                message = f"{which} acts across the gap, though {heights}: these floors do not face each other"
                hint = "write `at: columns` or no floors for where slabs face columns"
            elif ends.cosine < MIN_COSINE:
                angle = np.degrees(np.arccos(ends.cosine))
                share = 100 * ends.cosine**2
                message = f"{which} is inclined {angle:.3g} degrees: "
                message += f"along the row it has {share:.2g} % of the stiffness and damping of a level link"
                hint = "choose floors nearer in height, or a longer `distance`"
            else:
                continue
            hint += f"; otherwise leave it, {AS_MEANT}"
            doubts.add(root, path, (*link.path, "floors"), message, hint, excess=rise)


def _warn_link_nowhere(link: CompleteLink, law: LinkLaw, group: Group, root: Any, doubts: Doubts) -> None:
    """Note a link that stands nowhere: no floors, or no slabs and columns, face each other in its pairs."""
    if isinstance(link.spec.floors, tuple):
        return  # the floors that it names are checked one by one
    meetings = [meeting for number, meeting in enumerate(group.meetings, 1) if link.spec.pair in (None, number)]
    at_columns = link.spec.at is not None
    has_floors = any(meeting.floors for meeting in meetings)
    has_strikes = any(meeting.strikes for meeting in meetings)
    if (has_floors and not at_columns) or (has_strikes and (at_columns or not law.joins)):
        return
    pairs = join_limited(f"{meeting.left.name} and {meeting.right.name}" for meeting in meetings)
    no_floors = f"no floors of {pairs} face each other"
    no_strikes = f"no slab faces columns of known share between {pairs}"
    if at_columns:
        reason = no_strikes
        hint = "write `columns:` in the building whose columns it ends on"
    elif law.joins:
        reason = no_floors
        hint = "write both of its ends, e.g. `floors: [[2, 2]]`"
    else:
        reason = f"{no_floors}, and {no_strikes}"
        hint = "write `columns:` in the building whose columns are struck"
    message = f"the {law.name} stands nowhere: {reason}"
    doubts.add(root, (*link.path, "link"), (*link.path, "link"), message, f"{hint}; otherwise leave it, {AS_MEANT}")


MAX_STEPS_PER_SECOND = 20_000
"""Steps for a second of the motion from which a viscous damper near rest is warned about: some tenths of a second."""


def _warn_stiff_damper(law: Viscous, group: Group, root: Any, path: KeyPath, doubts: Doubts) -> None:
    """Note a viscous damper whose slope at rest takes more steps than is usual."""
    lightest = min(float(building.mass.min()) for building in _frames(group))
    slope = law.force_at_1_m_s * law.straight_below ** (law.exponent - 1.0)
    steps = slope / (MAX_STABLE_STEP_AT_REST * lightest)
    if steps <= MAX_STEPS_PER_SECOND:
        return
    dashpot = f"near rest the viscous damper is a dashpot of {slope:.2g} N s/m, beside a floor of {lightest:.3g} kg"
    cost = f"it takes up to {steps:.1g} steps for each second in which the floors hardly move"
    hint = f"write `straight_below: 1 mm/s` for fewer, or an `exponent` nearer 1; otherwise leave it, {AS_MEANT}"
    at: KeyPath = (*path, "exponent")
    doubts.add(root, at, at, f"{dashpot}: {cost}", hint, excess=float(np.log10(steps / MAX_STEPS_PER_SECOND)))


def _takes_impact_stiffness(law: LinkLaw, link: CompleteLink) -> bool:
    """Return whether a link strikes with the stiffness that `impact` has."""
    takes = law.parameters()
    if "impact_stiffness" in takes:
        return True
    return "stiffness" in takes and not law.stiffness_default and "stiffness" not in link.values


def _compare_contact(group: Group) -> Comparison:
    """Return what the spring of a contact is compared with."""
    than = "times that of the stiffest storey"
    return Comparison(
        PLAUSIBLE_RANGES["contact stiffness"], 1 / _stiffest_storey(group), "stiffness of the contact", than
    )


def _compare_link(law: LinkLaw, group: Group) -> dict[str, Comparison]:
    """Return what the parameters of a link are compared with: stiffnesses with a storey's, forces with weights."""
    stiffest = _stiffest_storey(group)
    weight = GRAVITY * max(float(each.mass.max()) for each in _frames(group))
    parameters = law.parameters()
    found = {}
    if "stiffness" in parameters:
        found["stiffness"] = _compare_contact(group)
        if law.stiffness_default:
            than = "times that of the stiffest storey"
            found["stiffness"] = Comparison(
                PLAUSIBLE_RANGES["link stiffness"], 1 / stiffest, "stiffness of the link", than
            )
    if "hertz_stiffness" in parameters:
        share = law.max_slopes[0] / law.hertz_stiffness / stiffest  # type: ignore[attr-defined]
        than = "times as stiff at 1 cm of penetration as the stiffest storey"
        fits = PLAUSIBLE_RANGES["stiffness of a Hertz contact"]
        found["hertz_stiffness"] = Comparison(fits, share, "hertz_stiffness", than)
    force = PLAUSIBLE_RANGES["force of a damper"]
    for key in ("damping_coefficient", "force_at_1_m_s"):
        if key in parameters:
            than = "times the weight of the heaviest floor at 1 m/s"
            found[key] = Comparison(replace(force, units=DAMPER_UNITS[key]), 1 / weight, key, than)
    if "slip_force" in parameters:
        found["slip_force"] = Comparison(force, 1 / weight, "slip_force", "times the weight of the heaviest floor")
    return found


DAMPER_UNITS: dict[str, Mapping[str, float]] = {
    "damping_coefficient": {"kN s/m": 1e3, "MN s/m": 1e6, "N s/m": 1.0},
    "force_at_1_m_s": FORCES,
}
"""Units in which people write the parameters of dampers."""


def _frames(group: Group) -> Sequence[Building]:
    """Return the buildings of a group that are no walls; all where there are walls only."""
    return [each for each in group.buildings if not isinstance(each, Wall)] or group.buildings


def _stiffest_storey(group: Group) -> float:
    """Return the stiffness of the stiffest storey of a group [N/m]."""
    return max(float(each.stiffness.max()) for each in _frames(group))


def _warn_compared(value: float, root: Any, path: KeyPath, compared: Comparison, doubts: Doubts) -> None:
    """Note a stiffness of a link that has no unit, or is implausible beside a storey's."""
    text = _text_at(root, path)
    is_bare = doubts.needs_units and _is_bare(text, BARE_STIFFNESS)
    fits = compared.fits
    ratio = value * compared.share
    if fits.holds(ratio) and not is_bare:
        return
    size = f"{format_value(value, fits.units)}, {compared.ratio_in_words(value)}"
    reason = "" if fits.holds(ratio) else f": {fits.reason}"
    message = f"the {compared.name} is {size}{reason}"
    hint = f"write e.g. `20 x stiffest storey`; otherwise leave it, {AS_MEANT}"
    if is_bare:
        message = f"{path[-1]}: {text} has no unit: it is {size}{reason}"
        wide = replace(fits, low=PLAUSIBLE_RANGES["link stiffness"].low)
        hint = _hint_for_bare(text, value, wide, compared.share, "N/m", "stiffest storey")
    doubts.add(root, path, path, message, hint, is_bare, fits.excess(ratio))


BARE_STIFFNESS = Quantity("stiffness", "N/m", "200 kN/mm")


def warn_motions(spec: RecordsSpec, suite: Suite, is_swept_pga: bool, root: Any, doubts: Doubts) -> None:
    """Note accelerations without a unit, and peaks of the ground that are implausible, asked for or as used."""
    warn_values(spec, root, ("records",), doubts)
    at: KeyPath = ("records", "scale", "pga")
    asked = getattr(spec.scale, "pga", None)
    fits = PLAUSIBLE_RANGES["peak asked for"]
    if asked is not None and not is_swept_pga:
        if at not in doubts.by_key and not fits.holds(asked):
            message = f"{fits.name} is {format_value(asked, fits.units)}: {fits.reason}"
            doubts.add(root, at, at, message, _hint(_text_at(root, at), asked, fits), excess=fits.excess(asked))
        return
    if not any(key[:2] == at[:2] for key in doubts.by_key):  # else the peaks are what follows from that value
        _warn_peaks(list(suite.uses.values()), root, doubts)


def _warn_peaks(uses: Sequence[MotionUse], root: Any, doubts: Doubts) -> None:
    """Note peaks of the ground that are implausible as used, or above 2 g both in the file and as used."""
    fits = PLAUSIBLE_RANGES["peak of a motion"]
    unlikely = [use for use in uses if not fits.holds(use.pga) or use.pga / max(use.scale, 1.0) > 2 * GRAVITY]
    if unlikely:
        hint = f"check `unit:` of its file and `scale:`; otherwise leave it, {AS_MEANT}"
        peaks = join_limited(f"{use.name} ({use.pga / GRAVITY:.3g} g)" for use in unlikely)
        at: KeyPath = ("records", "scale" if any(use.scale != 1 for use in unlikely) else "use")
        excess = max(fits.excess(use.pga) for use in unlikely)
        doubts.add(root, at, at, f"unlikely peaks: {peaks}: {fits.reason}", hint, excess=excess)


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


def warn_codes_without_twist(study: Study, notes: Problems) -> None:
    """Note that the displacements of codes, with which `gap:` compares, leave out the twist of the floors."""
    if study.tree.get("gap") is None:
        return
    names = []
    for name in dict.fromkeys(study.spec.group):
        building = study.resolved.types[name].at(study.first_point)
        has_displacements = bool(study.resolved.displacements(name).at(study.first_point))
        if has_displacements and is_eccentric(building):
            names.append(name)
    if names:
        message = f"the displacements that codes expect of {join_limited(names)} leave out the twist of the floors"
        hint = "the gap that the motions require has it; "
        hint += "a code that asks for the displacement of the edge takes a larger one than is told of it here"
        notes.at(study.tree, ("gap",), message, hint, key=True)


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


# Values and their ranges


def warn_values(
    spec: BaseModel,
    root: Any,
    path: KeyPath,
    doubts: Doubts,
    compared: Mapping[str, Comparison] | None = None,
    skip: Sequence[str] = (),
) -> None:
    """Note values that a validated mapping, or one below it, gives and that are implausible or have no unit.

    compared : what the values of some of its keys are compared with
    skip : keys that are not looked at
    """
    for key, (name, quantity) in _quantities(type(spec)).items():
        value = getattr(spec, name)
        at = (*path, key)
        written = get(root, *at)
        if name not in spec.model_fields_set or written is None or key in skip:
            continue
        for below, each in _scalars_of(value, written):
            here = (*at, *below)
            if isinstance(each, BaseModel):
                warn_values(each, root, here, doubts)
            elif quantity is not None and isinstance(each, float):
                _warn_value(key, quantity, each, root, here, at, doubts, (compared or {}).get(key))


def _scalars_of(value: Any, written: Any) -> list[tuple[KeyPath, Any]]:
    """Return the values of a key, each with its place below it: those of a list, of a mapping, or the one."""
    if isinstance(value, tuple):
        return [((n,) if isinstance(written, list) else (), each) for n, each in enumerate(value)]
    if isinstance(value, dict) and isinstance(written, dict):
        return [((word,), each) for word, each in zip(written, value.values(), strict=False)]
    return [((), value)]


@functools.cache
def _quantities(model: type[BaseModel]) -> dict[str, tuple[str, Quantity | None]]:
    """Return of every key of a mapping its attribute, and the quantity that it takes."""
    names = {info.alias or name: name for name, info in model.model_fields.items()}
    found = {}
    for key, (hint, _) in fields_of(model).items():
        kinds = list(leaf_types(hint))
        kinds += [one for kind in kinds if get_origin(kind) in (tuple, dict) for one in leaf_types(get_args(kind)[-1])]
        kinds += [one for kind in kinds if get_origin(kind) is tuple for one in leaf_types(get_args(kind)[0])]
        quantities = (kind.quantity if isinstance(kind, ParsedText) else kind for kind in kinds)
        found[key] = names[key], next((each for each in quantities if isinstance(each, Quantity)), None)
    return found


def _warn_value(
    key: str,
    quantity: Quantity,
    value: float,
    root: Any,
    path: KeyPath,
    of: KeyPath,
    doubts: Doubts,
    compared: Comparison | None = None,
) -> None:
    """Note a value that is implausible or has no unit, with what may have been meant.

    of : the key that it is a value of
    compared : what it is compared with, in place of the plausible range of the quantity
    """
    text = _text_at(root, path)
    is_bare = _is_bare(text, quantity)
    if is_bare and quantity.si == "m/s2" and 0 < value <= MAX_IN_G:
        message = f"{key}: {text} has no unit: it is {value:.4g} m/s2 = {value / GRAVITY:.3f} g"
        doubts.add(root, path, of, message, f"write `{text} g`, or `{text} m/s2` if that is meant", is_bare=True)
        return
    if is_bare and quantity.name == "gap" and MIN_IN_CM <= value <= 1.0 and doubts.needs_units:
        message = f"{key}: {text} has no unit: it is {value:.4g} m = {100 * value:.4g} cm"
        doubts.add(root, path, of, message, f"write `{text} cm`, or `{text} m` if that is meant", is_bare=True)
        return
    fits = quantity.usual if compared is None else compared.fits
    share = 1.0 if compared is None else compared.share
    is_plausible = fits is None or fits.holds(value * share)
    is_bare = is_bare and doubts.needs_units and customary_unit(quantity.si) != ""
    if is_plausible and not is_bare:
        return
    units = units_of_size(quantity.si) if fits is None else fits.units
    size = format_value(value, units)
    if compared is not None:
        size += f", {compared.ratio_in_words(value)}"
    reason = "" if is_plausible or fits is None else f": {fits.reason}"
    if is_bare:
        message = f"{key}: {text} has no unit: it is {size}{reason}"
        hint = _hint_for_bare(text, value, fits, share, quantity.si)
    else:
        assert fits is not None  # it is not plausible
        message = f"{fits.name if compared is None else compared.name} is {size}{reason}"
        hint = _hint(text, value, fits, share)
    doubts.add(root, path, of, message, hint, is_bare, 0.0 if fits is None else fits.excess(value * share))


def customary_unit(si: str) -> str:
    """Return the unit in which people write a quantity of SI unit `si`; "" where that is the SI unit itself.

    Forces, stiffnesses, dashpots and inertias are written in kN and t; masses, lengths, times and moduli have ranges
    that tell the unit.
    """
    if si == "N/m2":
        return ""
    if si.startswith("N"):
        return f"k{si}"
    return si.replace("kg", "t", 1) if si.startswith("kg ") else ""


def units_of_size(si: str) -> dict[str, float]:
    """Return the units in which people write a quantity of SI unit `si`, with their factors to it."""
    if si.startswith("N"):
        return {f"{prefix}{si}": factor for prefix, factor in (("k", 1e3), ("M", 1e6), ("G", 1e9), ("", 1.0))}
    return {customary_unit(si): 1e3, si: 1.0}


def _is_bare(text: str, quantity: Quantity) -> bool:
    """Return whether a text is a number without the unit that it should have."""
    return text != "" and lacks_unit(text, quantity)


def format_value(value: float, units: Mapping[str, float]) -> str:
    """Return a value in the unit a person would use: the largest that it is at least one of, seconds from 0.01 s on."""
    sizes = sorted(units.items(), key=lambda unit: unit[1])
    fitting = [unit for unit in sizes if value >= unit[1] * (0.01 if unit[0] == "s" else 1 - 1e-12)]
    unit, factor = (fitting or sizes[:1])[-1]
    return f"{_format_rounded(value / factor)} {unit}"


def _find_plausible_texts(text: str, value: float, fits: PlausibleRange, share: float) -> list[str]:
    """Return the number of a text in the other units in which it would be plausible, the likeliest first."""
    parted = _NUMBER_AND_UNIT.match(text)
    written = parted[1] if parted else "0"
    number = float(written)
    return [
        f"{written} {unit}"
        for unit, factor in fits.units.items()
        if number > 0 and not np.isclose(number * factor, value) and fits.holds(number * factor * share)
    ]


def _hint(text: str, value: float, fits: PlausibleRange, share: float = 1.0, si: str = "") -> str:
    """Return the same number in another unit, else with its decimal point elsewhere, `share` of which is plausible.

    si : the unit in which a number without one was read
    """
    meant = _find_plausible_texts(text, value, fits, share)
    meant += [format_value(value * f, fits.units) for f in (0.1, 10.0, 0.01, 100.0) if fits.holds(value * f * share)]
    otherwise = f"otherwise write `{text} {si}`" if si else f"otherwise leave it, {AS_MEANT}"
    return f"did you mean {meant[0]}? {otherwise}" if meant else f"leave it if meant, {AS_MEANT}"


def _hint_for_bare(
    text: str, value: float, fits: PlausibleRange | None, share: float, si: str, multiple: str = ""
) -> str:
    """Return the units in which a number without one would be plausible.

    fits : plausible range of value * share; None where none is known
    multiple : what the number may be a multiple of, in place of a unit
    """
    if fits is None:
        return f"write `{text} {customary_unit(si)}`, or `{text} {si}` if that is meant"
    meant = [each for each in _find_plausible_texts(text, value, fits, share) if not each.endswith("MN/mm")]
    number = _NUMBER_AND_UNIT.match(text)
    if multiple and number and fits.holds(float(number[1])):
        meant.insert(0, f"{text} x {multiple}")
    units = " or ".join(f"`{each}`" for each in meant)
    if units:
        return f"write {units}, or `{text} {si}` if that is meant"
    return f"write its unit, `{text} {si}` if that is meant"


def _text_at(root: Any, path: KeyPath) -> str:
    """Return what the file has at a path, as text; "" where it has nothing."""
    value = get(root, *path)
    return "" if value is None else str(value)


def _format_rounded(value: float) -> str:
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"
