"""One building, or the links of one case, from the keys of a study: for scenes put together without a study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.study.data import at_keys, tree_of
from pounding_cli.study.facing import COLUMNS, facing
from pounding_cli.study.link_laws import Group
from pounding_cli.study.links import Links
from pounding_cli.study.motion_reader import MotionReader
from pounding_cli.study.problems import Problems
from pounding_cli.study.resolve import Resolver, places
from pounding_cli.study.units import Quantity

_FILE = Path("scene")
"""Stands for the file that a study would be; errors name keys in its place."""


def building_of(name: str, keys: Mapping[str, Any]) -> Building:
    """The building that the keys of a study's building describe.

    Raises
    ------
    InputError : with every problem found, each at its key
    """
    with _resolver({"buildings": {name: dict(keys)}}, f"buildings.{name}.") as resolver:
        building = resolver.type((), name)
        _refuse(resolver)
        assert building is not None
        return building


def links_between(
    buildings: Sequence[Building], case: Mapping[str, Any], impact: Mapping[str, Any]
) -> tuple[Link, ...]:
    """The links that the keys of a study's case put between neighbours, left to right.

    Raises
    ------
    InputError : with every problem found, each at its key; neighbours without a floor at one elevation
    """
    common, strikes = zip(*(facing(left, right) for left, right in pairwise(buildings)), strict=True)
    for (left, right), floors, struck in zip(pairwise(buildings), common, strikes, strict=True):
        if not floors and not struck:
            hint = f"let the storey heights agree somewhere; {COLUMNS}"
            raise InputError(Problem(f"{left.name} and {right.name} have no floor at one elevation", hint))
    with _resolver({"cases": {"case": dict(case)}, "impact": dict(impact)}, "cases.case.") as resolver:
        spec, element = resolver.entry((), "cases", "case"), resolver.section((), "impact")
        _refuse(resolver)
        names = [building.name for building in buildings]
        group = Group(buildings, dict(zip(names, buildings, strict=True)), common, element, names, {}, strikes)
        problems = Problems(str(_FILE))
        links = Links().of(spec, group, resolver.root_at(()), ("cases", "case"), problems)
        problems.refuse()
        return links


def by_place(buildings: Sequence[Building]) -> tuple[Building, ...]:
    """The buildings, renamed where two have one name: soft-1, soft-2."""
    labels = places(tuple(building.name for building in buildings))
    return tuple(replace(each, name=label) for each, label in zip(buildings, labels, strict=True))


def quantity(form: Quantity, value: Any, key: str) -> float:
    """A number in SI units from a number or a text with a unit.  Raises InputError, at `key`."""
    try:
        return float(form.read(value))
    except PydanticCustomError as refused:
        said = refused.context or {}
        raise InputError(Problem(said.get("message", str(refused)), said.get("hint", ""), key)) from None


@contextmanager
def _resolver(data: Mapping[str, Any], inside: str) -> Iterator[Resolver]:
    """What resolves `data`; problems name their key below `inside`, without it."""
    root = tree_of(data, _FILE)
    try:
        with at_keys(root, _FILE):
            yield Resolver(root, (), str(_FILE), MotionReader(Path()))
    except InputError as refused:
        raise InputError([_told_once(replace(p, file=p.file.removeprefix(inside))) for p in refused.problems]) from None


def _told_once(problem: Problem) -> Problem:
    """A problem whose message need not begin with the key that its place names."""
    return replace(problem, message=problem.message.removeprefix(f"{problem.file.split('.')[-1]}: "))


def _refuse(resolver: Resolver) -> None:
    if resolver.met:
        raise InputError(list(resolver.met))
