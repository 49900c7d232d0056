"""Resolve a study: its buildings, links and motions at the points of the sweep."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import numpy as np

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.twist import merge_links
from pounding_cli.study.construct.buildings import build_building, find_code_displacements
from pounding_cli.study.construct.complete_links import (
    CompleteLink,
    build_laws,
    check_links,
    complete_links,
    evaluate_multiples,
    list_multiples,
)
from pounding_cli.study.construct.group import Group, build_group, check_group_names, check_meetings
from pounding_cli.study.construct.link_names import (
    Names,
    check_contact_law,
    check_impact_names,
    check_link_names,
    find_names,
)
from pounding_cli.study.construct.link_places import find_floors, find_linked_pairs
from pounding_cli.study.construct.links import build_links
from pounding_cli.study.construct.motions import MotionReader, Suite, read_suite
from pounding_cli.study.construct.own_laws import build_own_laws
from pounding_cli.study.construct.swept import Point, Swept, build_constant, build_object_array, sweep_map
from pounding_cli.study.construct.written import read_spec
from pounding_cli.study.schema.like import inherits_key
from pounding_cli.study.schema.quantity import quote
from pounding_cli.study.text.file import Map, get, with_value
from pounding_cli.study.text.issues import Issues
from pounding_cli.study.vary.axes import UNWRITTEN, Axis

T = TypeVar("T")
Specs = Mapping[KeyPath, Any]


@dataclass(frozen=True, eq=False)
class StudyParts:
    """The parts of a study at the points of its sweep.

    building_specs, types : validated keys of the building types by name, and the buildings
    group : the buildings in their places
    impact : the validated impact element
    complete_links : by case what is written of its links
    link_laws : by case the laws of these links, None of no link
    links : by case what stands between the buildings
    records, suite : the validated section, and the motions
    tail : free vibration after the motion [s]
    """

    building_specs: Mapping[str, Swept[Any]]
    types: Mapping[str, Swept[Building]]
    group: Swept[Group]
    impact: Swept[Any]
    complete_links: Mapping[str, Swept[tuple[CompleteLink, ...]]]
    link_laws: Mapping[str, Swept[tuple[LinkLaw | None, ...]]]
    links: Mapping[str, Swept[tuple[Link, ...]]]
    records: Swept[Any]
    suite: Swept[Suite]
    tail: Swept[float]

    def displacements(self, name: str) -> Swept[dict[str, np.ndarray]]:
        """Return the displacements of a building type that codes expect, by rule [m], shape (storeys,)."""
        return sweep_map(find_code_displacements, self.building_specs[name], self.types[name])


def tree_at(tree: Map, axes: Sequence[Axis], point: Point) -> Map:
    """Return the file at a point of the sweep; AS_WRITTEN on an axis stands for what the file itself has."""
    for axis, place in zip(axes, point, strict=True):
        for column in range(len(axis.names)) if place >= 0 else ():
            with suppress(InputError):  # which `resolve` notes
                tree = _set_columns(tree, axis, place, [column])
    return tree


def _set_columns(tree: Map, axis: Axis, place: int, columns: Sequence[int]) -> Map:
    """Return the file with some of the keys of an axis at one of their values.

    Raises
    ------
    InputError : another axis has put a value there that has no keys
    """
    values = axis.written_values[place]
    for column in columns:
        if values[column] is UNWRITTEN:
            continue
        try:
            tree = with_value(tree, axis.paths[column], values[column], axis.marks[place][column])
        except KeyError:
            raise InputError([_refuse_key_below(tree, axis.paths[column])]) from None
    return tree


def _refuse_key_below(tree: Map, path: Sequence[str]) -> Issue:
    """Return what is wrong with a swept key below a swept value that has no keys."""
    parent = list(path[:-1])
    while parent and get(tree, *parent) is None:
        parent.pop()
    value = get(tree, *parent)
    key = ".".join(path)
    message = f"the sweep varies '{key}', but '{'.'.join(parent)}' is {quote(value)} here, which has no keys"
    return Issue(tuple(parent), message, f"sweep one of the two, or write `{'.'.join(parent)}` as mappings")


def changes_part(key: str, path: tuple[str, ...], tree: Map) -> bool:
    """Return whether a swept key changes a part of the study, a section or one of its entries."""
    section, *below = key.split(".")
    if section != path[0]:
        return False
    if len(path) == 1 or not below:
        return True
    if section == "buildings":
        return inherits_key(tree["buildings"], path[1], below)
    return below[0] == path[1]


def sweep_part(
    tree: Map, axes: Sequence[Axis], path: tuple[str, ...], read: Callable[[Map], T], issues: Issues
) -> Swept[T]:
    """Return what is read from a part of the file at every point of the axes that change it.

    Points at which the keys that change it have the same values share one result.

    path : of the part
    read : of the whole file at a point; may raise InputError, which is noted
    """
    columns = {
        number: [column for column, key in enumerate(axis.names) if changes_part(key, path, tree)]
        for number, axis in enumerate(axes)
    }
    columns = {number: each for number, each in columns.items() if each}
    numbers = tuple(columns)
    shape = tuple(len(axes[number]) for number in numbers)
    texts = {number: _format_rows(axes[number], columns[number]) for number in numbers}
    known: dict[tuple[str, ...], tuple[Any, tuple[Any, ...]]] = {}
    results: list[Any] = []
    for index in np.ndindex(shape):
        key = tuple([texts[number][place] for number, place in zip(numbers, index, strict=True)])
        if key not in known:
            there = tree
            try:
                for number, place in zip(numbers, index, strict=True):
                    there = _set_columns(there, axes[number], place, columns[number])
                known[key] = read(there), ()
            except InputError as refused:
                known[key] = None, refused.issues
        result, found = known[key]
        issues.add(numbers, index, found)
        results.append(result)
    return Swept(numbers, build_object_array(results, shape))


def _format_rows(axis: Axis, columns: Sequence[int]) -> list[str]:
    """Return the values of some keys of an axis at every point of it as text, which tells them apart."""
    return [repr([values[column] for column in columns]) for values in axis.written_values]


def resolve(specs: Specs, tree: Map, axes: Sequence[Axis], reader: MotionReader, issues: Issues) -> StudyParts:
    """Return the parts of a study at the points of its sweep; what is wrong is noted.

    specs : validated sections as written (`read_specs`)
    """
    return _Resolver(specs, tree, axes, issues).resolve(reader)


class _Resolver:
    """Resolves one study."""

    def __init__(self, specs: Specs, tree: Map, axes: Sequence[Axis], issues: Issues) -> None:
        self.specs = specs
        self.tree = tree
        self.axes = axes
        self.issues = issues

    def sweep_spec(self, *path: str) -> Swept[Any]:
        """Return a validated part of the study: as written, or validated at the points of the axes that change it."""
        if not any(changes_part(key, path, self.tree) for axis in self.axes for key in axis.names):
            return build_constant(self.specs.get(path))
        return self.sweep_part(path, partial(read_spec, path=path))

    def sweep_part(self, path: tuple[str, ...], read: Callable[[Map], T]) -> Swept[T]:
        """Return `sweep_part` of the study; what is wrong is noted."""
        return sweep_part(self.tree, self.axes, path, read, self.issues)

    def map(self, build: Callable[..., T], *parts: Swept[Any]) -> Swept[T]:
        """Return `sweep_map`; what is wrong is noted."""
        return sweep_map(build, *parts, issues=self.issues)

    def entries(self, section: str) -> list[str]:
        """Return the names of the entries of a section."""
        return [str(path[1]) for path in self.specs if len(path) == 2 and path[0] == section]

    def resolve(self, reader: MotionReader) -> StudyParts:
        """Return all parts."""
        records = self.sweep_spec("records")
        suite = self.map(partial(read_suite, reader=reader), records)
        building_specs = {name: self.sweep_spec("buildings", name) for name in self.entries("buildings")}
        types = {name: self.map(partial(build_building, name), spec) for name, spec in building_specs.items()}
        group = self.build_group(types)
        names = find_names(self.tree, self.specs)
        impact = self.sweep_spec("impact")
        has_known_names = self.sweep_part(("impact",), partial(check_impact_names, names=names))
        impact_of_known_names = self.map(_take_first, impact, has_known_names)
        own_laws = self.build_own_laws()
        checked_impact = self.map(check_contact_law, impact_of_known_names, own_laws)
        cases = {name: self.sweep_spec("cases", name) for name in self.entries("cases")}
        group = self.check_meetings(group, cases, names)
        meetings = self.map(lambda group: group.meetings, group).merge_equal()
        has_plans = any(
            spec is not None and spec.plan is not None
            for each in building_specs.values()
            for _, spec in each.iter_values()
        )
        complete = {}
        link_laws = {}
        links = {}
        for name, case in cases.items():  # the steps are described in complete_links.py
            has_known_names = self.sweep_part(("cases", name), partial(check_link_names, case=name, names=names))
            floors = self.map(partial(find_floors, name), case, meetings)
            complete[name] = self.map(partial(complete_links, name), case, impact)
            with_sound_keys = self.map(partial(check_links, name, names=names), case, complete[name])
            checked = self.map(_take_first, with_sound_keys, has_known_names, impact_of_known_names)
            multiples = self.map(list_multiples, checked, checked_impact).merge_equal()
            stiffnesses = self.map(evaluate_multiples, multiples, group).merge_equal()
            link_laws[name] = self.map(build_laws, checked, checked_impact, own_laws, stiffnesses, floors)
            parted = self.map(build_links, checked, link_laws[name], floors, meetings)
            links[name] = self.map(_merge_links, group, parted) if has_plans else parted
        tail = self.sweep_spec("tail")
        return StudyParts(building_specs, types, group, impact, complete, link_laws, links, records, suite, tail)

    def build_group(self, types: Mapping[str, Swept[Building]]) -> Swept[Group]:
        """Return the buildings in their places."""
        names = build_constant(self.specs.get(("group",)))
        defined = list(types)
        if not types:
            return build_constant(None)  # type: ignore[arg-type]
        sound = self.map(lambda names: check_group_names(names, defined), names)

        def build(names: Sequence[str], *buildings: Building) -> Group:
            return build_group(names, dict(zip(types, buildings, strict=True)))

        return self.map(build, sound, *types.values())

    def check_meetings(self, group: Swept[Group], cases: Mapping[str, Swept[Any]], names: Names) -> Swept[Group]:
        """Return the group; neighbours that cannot strike each other, and that no case links, are noted.

        Of a faulty case it is not known which neighbours it links.
        """
        if not all(case.is_sound for case in cases.values()):
            return group
        linked = [self.map(partial(find_linked_pairs, name, pairs=names.pairs), case) for name, case in cases.items()]
        return self.map(lambda group, *pairs: check_meetings(group, set[int]().union(*pairs)), group, *linked)

    def build_own_laws(self) -> Swept[Any]:
        """Return the laws of the study's own."""
        names = self.entries("laws")
        if any(self.specs["laws", name] is None for name in names):
            return build_constant(None)

        def read(tree: Map) -> Any:
            specs = {name: read_spec(tree, ("laws", name)) for name in names}
            return build_own_laws(specs, tree)

        return self.sweep_part(("laws",), read)


def _merge_links(group: Group, links: tuple[Link, ...]) -> tuple[Link, ...]:
    """Return the links of a case, parts of one link as one where no floor twists."""
    return merge_links(group.buildings, links)


def _take_first(part: T, *_others: Any) -> T:
    """Return a part unchanged; None stands where it or one of the others is faulty (`sweep_map`)."""
    return part
