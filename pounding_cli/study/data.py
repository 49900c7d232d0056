"""A study as Python data: the words and units of the file, in a dict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.study import build, schema
from pounding_cli.study.file import Items, Map, Mark, Problems, canonical, dumped, get
from pounding_cli.study.laws import Impact
from pounding_cli.study.links import check_contact
from pounding_cli.study.links import links_of as scene_links
from pounding_cli.study.models import Building as BuildingSpec
from pounding_cli.study.models import Case
from pounding_cli.study.quantity import Quantity
from pounding_cli.study.spell import inherited, links_of, refuse_old
from pounding_cli.study.study import Study
from pounding_cli.texts import to_file_name


def study_of(data: Mapping[str, Any]) -> Study:
    """A validated study from a dict with the keys of a study file; numbers are SI, texts carry units ("5 cm").

    Its path is the title, or `study`, as a file in the current folder: record files are sought there, and results are
    named after it. Its text is the same study as YAML.

    Raises
    ------
    InputError : with every problem found, each at its key (`cases.gap.gap`)
    """
    root = tree_of(data)
    title = str(root.get("title") or "study")
    path = Path(to_file_name(title).replace(" ", "-").lower() + ".yaml")
    return Study(path, dumped(root, flow=False) + "\n", root)


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
    raise InputError(Problem(f"{type(value).__name__} is not a value of a study", hint, place))


def building_of(name: str, keys: Mapping[str, Any]) -> Building:
    """The building that the keys of a study's building describe.

    Raises
    ------
    InputError : with every problem found, each at its key
    """
    problems, path = Problems(""), ("buildings", name)
    root = _tree(buildings=_tree(**{name: _node(keys, "")}))
    root["buildings"] = inherited(root["buildings"], problems)
    problems.check()
    spec = _valid(BuildingSpec, root, path, problems)
    try:
        return build.building(name, spec)
    except (ValueError, ArithmeticError) as error:
        problems.at(root, path, str(error), "check its masses, heights, period and stiffness")
        problems.check()
        raise


def links_between(
    buildings: Sequence[Building], case: Mapping[str, Any], impact: Mapping[str, Any]
) -> tuple[Link, ...]:
    """The links that the keys of a study's case put between neighbours, left to right.

    Raises
    ------
    InputError : with every problem found, each at its key; neighbours without a floor at one elevation
    """
    problems, path = Problems(""), ("cases", "case")
    group = build.Group.of_buildings(tuple(buildings), {building.name: building for building in buildings})
    root = _tree(cases=_tree(case=_node(case, "")), impact=_node(impact, "impact"))
    build.check_meetings(group, root, problems)
    refuse_old(root, problems)
    problems.check()
    root["cases"]["case"] = links_of(root["cases"]["case"], root["impact"])
    element = _valid(Impact, root, ("impact",), problems)
    spec = _valid(Case, root, path, problems)
    check_contact(element.law, {}, root, problems)
    links = scene_links(spec, group, element, {}, path, root, problems)
    problems.check()
    return tuple(links or ())


def _tree(**nodes: Any) -> Map:
    """A mapping around the keys of a user, without a place of its own."""
    mark = ("", 0)
    return Map(nodes, mark, dict.fromkeys(nodes, (mark, mark)))


def by_place(buildings: Sequence[Building]) -> tuple[Building, ...]:
    """The buildings, renamed where two have one name: soft-1, soft-2."""
    labels = build.places([building.name for building in buildings])
    return tuple(replace(each, name=label) for each, label in zip(buildings, labels, strict=True))


def quantity(form: Quantity, value: Any, key: str) -> float:
    """A number in SI units from a number or a text with a unit.  Raises InputError, at `key`."""
    try:
        return float(form.read(value))
    except PydanticCustomError as refused:
        said = refused.context or {}
        raise InputError(Problem(said.get("message", str(refused)), said.get("hint", ""), key)) from None


def _valid(kind: Any, root: Map, path: tuple[str, ...], problems: Problems) -> Any:
    try:
        return TypeAdapter(kind).validate_python(get(root, *path))
    except ValidationError as error:
        problems.validation(root, error, path, schema.Study)
        problems.check()
