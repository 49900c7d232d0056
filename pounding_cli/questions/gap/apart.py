"""The study of `pound gap`: nothing stands between the buildings, whose closings are the required separations."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.laws.apart import Apart
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.meetings import find_meetings
from pounding_cli.model.twist import merge_links
from pounding_cli.study import Study
from pounding_cli.study.construct.group import Group
from pounding_cli.study.schema.street_places import EDGE_TOLERANCE, LinkArms, StreetSide, find_shared_edge
from pounding_cli.study.text.file import Map
from pounding_cli.study.vary.axes import Axis

LINK_SECTIONS = ("cases", "impact", "laws")
"""Sections that say what stands between the buildings."""

IGNORED_SECTIONS = (*LINK_SECTIONS, "sweep", "keep", "report", "statements", "uncertain")
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


class StreetPlace(NamedTuple):
    """The place of a link of the study between floors that twist.

    number : of the left building of the pair, from 0
    left, right : places of its ends along the street [m]; NaN of a building without a plan
    """

    number: int
    left: float
    right: float


def find_street_places(study: Study) -> tuple[StreetPlace, ...]:
    """Return where the links of all cases stand between floors that twist, each place once."""
    if not study.has_plans:
        return ()
    places: dict[StreetPlace, None] = {}
    for index in np.ndindex(*(len(axis) for axis in study.axes)):
        buildings = study.group(index).buildings
        for case in study.spec.cases:
            for link in study.links(index, case):
                if link.left_arm or link.right_arm:
                    left, right = buildings[link.left : link.left + 2]
                    ends = _find_street_end(left, link.left_arm), _find_street_end(right, link.right_arm)
                    places[StreetPlace(link.left, *ends)] = None
    return tuple(places)


def _find_street_end(building: Building, arm: float) -> float:
    """Return the place along the street of an end of a link [m]; NaN where the building has no plan."""
    return math.nan if building.plan is None else building.plan.street + arm


def link_all_facing(group: Group, street_places: Collection[StreetPlace] = ()) -> tuple[Link, ...]:
    """Return links without force between all floors, and all slabs and columns, that face each other.

    Between floors that twist they stand at both ends of the edge that the neighbours share, where floors come closest,
    and where links of the study stand.
    """
    links: list[Link] = []
    for left, pair in enumerate(pairwise(group.buildings)):
        floors, strikes = find_meetings(*pair)  # slabs beside columns too, whether or not their share is known
        facing = [Link.apart(left, *both) for both in floors]
        facing += [Link.apart(left, each.left_floor, each.right_floor, each.left_at, each.right_at) for each in strikes]
        if all(building.plan is None for building in pair):
            links += facing
            continue
        arms = _list_arms(pair, [place for place in street_places if place.number == left])
        links += [
            replace(link, left_arm=each.left_arm, right_arm=each.right_arm, whole_law=link.law)
            for link in facing
            for each in arms
        ]
    return merge_links(group.buildings, links)


def _list_arms(pair: tuple[Building, Building], street_places: Sequence[StreetPlace]) -> list[LinkArms]:
    """Return where the closing of two neighbours is looked at, along the street; nowhere if they share no edge.

    street_places : of links between them
    """
    sides = (StreetSide.of(pair[0]), StreetSide.of(pair[1]))
    low, high = find_shared_edge(*sides)
    if low >= high:
        return []
    inside = [place[1:] for place in street_places if _is_inside(place, sides)]
    ends = sorted({(low, low), (high, high), *inside}, key=lambda both: np.nanmean(both))
    arms: list[LinkArms] = []
    slack = EDGE_TOLERANCE * (high - low)
    for both in ends:
        left_arm, right_arm = (
            0.0 if side is None else street - side.centre for street, side in zip(both, sides, strict=True)
        )
        added = LinkArms(left_arm, right_arm, 1.0)
        if not any(np.allclose(added, other, rtol=0.0, atol=slack) for other in arms):
            arms.append(added)
    return arms


def _is_inside(place: StreetPlace, sides: Sequence[StreetSide | None]) -> bool:
    """Return whether both ends of a link stand on the floors of both sides."""
    return all(side is None or side.holds(end) for end, side in zip(place[1:], sides, strict=True))
