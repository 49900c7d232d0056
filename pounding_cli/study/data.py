"""A study as Python data: the words and units of the file, in a dict."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError, Issue
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.study.construct.buildings import build_building
from pounding_cli.study.construct.complete_links import (
    build_laws,
    check_links,
    complete_links,
    evaluate_multiples,
    list_multiples,
)
from pounding_cli.study.construct.group import Group, check_meetings, unique_names
from pounding_cli.study.construct.link_names import Names, check_impact_names, check_link_names
from pounding_cli.study.construct.link_places import find_floors, find_linked_pairs
from pounding_cli.study.construct.links import build_links
from pounding_cli.study.construct.written import read_spec
from pounding_cli.study.load import build_study
from pounding_cli.study.schema.quantity import Quantity
from pounding_cli.study.schema.study import StudySpec
from pounding_cli.study.study import Study
from pounding_cli.study.text.file import Items, Map, Mark, Problems, canonical, dump_yaml
from pounding_cli.study.vary.changes import Change
from pounding_cli.texts import to_file_name


def study_of(
    data: Mapping[str, Any], model: type[StudySpec] = StudySpec, changes: Sequence[Change] = ()
) -> Study:  # fmt: skip
    """A validated study from a dict with the keys of a study file; numbers are SI, texts carry units ("5 cm").

    Its path is the title, or `study`, as a file in the current folder: record files are sought there, and results are
    named after it. Its text is the same study as YAML.

    model : of the study, with the sections of questions (`add_sections`)
    changes : values in place of those of the dict

    Raises
    ------
    InputError : with every problem found, each at its key (`cases.gap.gap`)
    """
    root = tree_of(data)
    title = str(root.get("title") or "study")
    path = Path(to_file_name(title).replace(" ", "-").lower() + ".yaml")
    return build_study(path, dump_yaml(root, flow=False) + "\n", root, model, changes)


def list_changes(values: Mapping[str, Any]) -> tuple[Change, ...]:
    """Return the changes that new values of dotted keys make; numbers are SI, texts carry units.

    Raises
    ------
    InputError : what is no value of a study
    """
    changes = []
    for key, value in values.items():
        node = _node(value, key)
        changes.append(Change(key, node, dump_yaml(node), (key, 0)))
    return tuple(changes)


def tree_of(data: Mapping[str, Any]) -> Map:
    """The tree of a dict; places in it are its keys.  Raises InputError for what is no value of a study."""
    found = _node(data, "")
    assert isinstance(found, Map)
    return found


def _node(value: Any, place: str) -> Any:
    mark: Mark = (place, 0)
    if isinstance(value, Mapping):
        keys = {canonical(str(key)): f"{place}.{key}".lstrip(".") for key in value}
        below = {name: _node(item, keys[name]) for name, item in zip(keys, value.values(), strict=True)}
        return Map(below, mark, {name: ((at, 0), (at, 0)) for name, at in keys.items()})
    if isinstance(value, np.ndarray | np.generic):
        return _node(value.tolist(), place)
    if isinstance(value, list | tuple):
        places = [f"{place}.{number}" for number in range(len(value))]
        items = [_node(item, at) for item, at in zip(value, places, strict=True)]
        return Items(items, mark, [(at, 0) for at in places])
    if isinstance(value, Path):
        return str(value)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    hint = "write numbers (SI), texts such as '5 cm', lists and dicts"
    raise InputError(Issue((), f"{type(value).__name__} is not a value of a study", hint, file=place))


def building_of(name: str, keys: Mapping[str, Any]) -> Building:
    """Return the building that the keys of a study's building describe.

    Raises
    ------
    InputError : with every problem found, each at its key
    """
    tree = _build_tree(buildings=_build_tree(**{name: _node(keys, "")}))
    with _placed_in(tree):
        return build_building(name, read_spec(tree, ("buildings", name)))


def links_between(
    buildings: Sequence[Building], case: Mapping[str, Any], impact: Mapping[str, Any]
) -> tuple[Link, ...]:
    """Return the links that the keys of a study's case put between neighbours, left to right.

    Raises
    ------
    InputError : with every problem found, each at its key; neighbours without a floor at one elevation
    """
    name = "case"
    tree = _build_tree(cases=_build_tree(case=_node(case, "")), impact=_node(impact, "impact"))
    types = {building.name: building for building in buildings}
    with _placed_in(tree):
        group = Group(tuple(buildings), types)
        names = Names((), tuple(types), len(buildings) - 1)
        element = read_spec(tree, ("impact",))
        check_impact_names(tree, names)
        spec = read_spec(tree, ("cases", name))
        check_link_names(tree, name, names)
        links = check_links(name, spec, complete_links(name, spec, element), names)
        stiffnesses = evaluate_multiples(list_multiples(links, element), group)
        check_meetings(group, find_linked_pairs(name, spec, names.pairs))
        floors = find_floors(name, spec, group.meetings)
        laws = build_laws(links, element, {}, stiffnesses, floors)
        return build_links(links, laws, floors, group.meetings)


@contextmanager
def _placed_in(tree: Map) -> Iterator[None]:
    """Turn InputError into InputError, each issue at its key."""
    try:
        yield
    except InputError as refused:
        problems = Problems("")
        for issue in refused.issues:
            problems.add_issue(tree, issue)
        problems.check()


def _build_tree(**nodes: Any) -> Map:
    """A mapping around the keys of a user, without a place of its own."""
    mark = ("", 0)
    return Map(nodes, mark, dict.fromkeys(nodes, (mark, mark)))


def by_place(buildings: Sequence[Building]) -> tuple[Building, ...]:
    """The buildings, renamed where two have one name: soft-1, soft-2."""
    labels = unique_names([building.name for building in buildings])
    return tuple(replace(each, name=label) for each, label in zip(buildings, labels, strict=True))


def quantity(form: Quantity, value: Any, key: str) -> float:
    """A number in SI units from a number or a text with a unit.  Raises InputError, at `key`."""
    try:
        return float(form.read(value))
    except PydanticCustomError as refused:
        context = refused.context or {}
        raise InputError(Issue((), context.get("message", str(refused)), context.get("hint", ""), file=key)) from None
