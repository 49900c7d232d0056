"""One building, or the links of one case, from the keys of a study: for scenes put together without a study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.study import build, schema
from pounding_cli.study.data import tree_of
from pounding_cli.study.file import Map, Problems
from pounding_cli.study.laws import Impact
from pounding_cli.study.links import Links, check_contact
from pounding_cli.study.models import Building as BuildingSpec
from pounding_cli.study.models import Case
from pounding_cli.study.old_links import refuse_old
from pounding_cli.study.quantity import Quantity
from pounding_cli.study.spell import inherited, links_of


def building_of(name: str, keys: Mapping[str, Any]) -> Building:
    """The building that the keys of a study's building describe.

    Raises
    ------
    InputError : with every problem found, each at its key
    """
    with _told_below(f"buildings.{name}.") as problems:
        root = tree_of({"buildings": {name: dict(keys)}})
        root["buildings"] = inherited(root["buildings"], problems)
        problems.check()
        spec = _valid(BuildingSpec, root["buildings"][name], root, ("buildings", name), problems)
        try:
            return build.building(name, spec)
        except (ValueError, FloatingPointError) as error:
            problems.at(root, ("buildings", name), str(error), "check its masses, heights, period and stiffness")
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
    names = [building.name for building in buildings]
    group = build.Group.of_buildings(tuple(buildings), dict(zip(names, buildings, strict=True)), names)
    with _told_below("cases.case.") as problems:
        build.check_meetings(group, {}, Map({}, ("", 0)), problems)
        problems.check()
        root = tree_of({"cases": {"case": dict(case)}, "impact": dict(impact)})
        refuse_old(root, problems)
        problems.check()
        root["cases"]["case"] = links_of(root["cases"]["case"], root["impact"])
        element = _valid(Impact, root["impact"], root, ("impact",), problems)
        spec = _valid(Case, root["cases"]["case"], root, ("cases", "case"), problems)
        check_contact(element.law, {}, root, problems)

        def note(path: tuple[str | int, ...], message: str, hint: str) -> None:
            problems.at(root, path, message, hint)

        links = Links().of(spec, group, element, {}, ("cases", "case"), note)
        problems.check()
        return tuple(links or ())


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


def _valid(kind: Any, value: Any, root: Map, path: tuple[str, ...], problems: Problems) -> Any:
    try:
        return TypeAdapter(kind).validate_python(value)
    except ValidationError as error:
        problems.validation(root, error, path, schema.Study)
        problems.check()


@contextmanager
def _told_below(inside: str) -> Iterator[Problems]:
    """Problems that name their key below `inside`, without it."""
    try:
        yield Problems("")
    except InputError as refused:
        found = [replace(problem, file=problem.file.removeprefix(inside)) for problem in refused.problems]
        raise InputError([_told_once(problem) for problem in found]) from None


def _told_once(problem: Problem) -> Problem:
    """A problem whose message need not begin with the key that its place names."""
    return replace(problem, message=problem.message.removeprefix(f"{problem.file.split('.')[-1]}: "))
