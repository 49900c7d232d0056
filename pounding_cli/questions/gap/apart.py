"""The study of `pound gap`: nothing stands between the buildings, whose closings are the required separations."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from pounding_cli.laws.apart import Apart
from pounding_cli.model.links import Link
from pounding_cli.model.meetings import find_meetings
from pounding_cli.study import Study
from pounding_cli.study.axes import Axis
from pounding_cli.study.file import Map
from pounding_cli.study.group import Group

LINK_SECTIONS = ("cases", "impact", "laws")
"""Sections that say what stands between the buildings."""

IGNORED_SECTIONS = (*LINK_SECTIONS, "sweep", "keep", "report", "claims", "uncertain")
"""Sections without a meaning where the buildings stand alone."""


class BuildingKeys(NamedTuple):
    """The keys of an axis that change buildings or motions.

    places : of these keys among those of the axis
    values : different values of these keys, as written
    by_point : values of these keys at every point of the axis
    """

    places: list[int]
    values: list[tuple[str, ...]]
    by_point: list[tuple[str, ...]]


def find_building_keys(axis: Axis) -> BuildingKeys:
    """Return the keys of an axis that change more than what stands between the buildings."""
    places = [place for place, path in enumerate(axis.paths) if path[0] not in LINK_SECTIONS]
    by_point = [tuple(str(values[place]) for place in places) for values in axis.written_values]
    return BuildingKeys(places, list(dict.fromkeys(by_point)), by_point)


def build_apart_study(study: Study) -> Study:
    """Return the study with one case, in which nothing stands between the buildings, and without the axes of links."""
    root = study.tree
    mark = root.mark
    tree = Map({name: node for name, node in root.items() if name not in IGNORED_SECTIONS}, mark, root.marks)
    case = Map({"link": "none"}, mark, {"link": (mark, mark)})
    tree["cases"] = Map({Apart.name: case}, mark, {Apart.name: (mark, mark)})
    axes = [_keep_building_keys(axis) for axis in study.axes if find_building_keys(axis).places]
    return study.with_axes(axes, tree)


def _keep_building_keys(axis: Axis) -> Axis:
    """Return an axis with its keys that change buildings or motions, every point once."""
    keys = find_building_keys(axis)
    points = [keys.by_point.index(values) for values in keys.values]

    def keep(rows: Sequence[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
        return [tuple(rows[point][place] for place in keys.places) for point in points]

    names = tuple(axis.names[place] for place in keys.places)
    units = tuple(axis.units[place] for place in keys.places)
    return Axis(names, keep(axis.written_values), keep(axis.marks), units)


def link_all_facing(group: Group) -> tuple[Link, ...]:
    """Return a link without force between all floors, and all slabs and columns, that face each other."""
    links: list[Link] = []
    for left, pair in enumerate(pairwise(group.buildings)):
        floors, strikes = find_meetings(*pair)  # slabs beside columns too, whether or not their share is known
        links += [Link.apart(left, *both) for both in floors]
        links += [Link.apart(left, each.left_floor, each.right_floor, each.left_at, each.right_at) for each in strikes]
    return tuple(links)
