"""Movements along the row of floors that twist, at their edges and where they face a neighbour.

Results hold the movement of the centres of mass. That of another place is the largest closing between a building that
stands alone and a wall that moves as the ground does, so it is exact."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pounding_cli.laws.apart import Apart
from pounding_cli.model.links import Link
from pounding_cli.model.meetings import find_meetings
from pounding_cli.model.twist import needs_plan
from pounding_cli.model.wall import Wall
from pounding_cli.results.arrays import ResultArrays
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.construct.group import Group
from pounding_cli.study.construct.swept import Point, Swept, sweep_map
from pounding_cli.study.text.file import Items, Map

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver

PLACE_TOLERANCE = 1e-9
"""Distance of two places of a floor that are one [m]."""

Movement = dict[int, np.ndarray]
"""By floor, 0 the base, the largest movement to one side [m], shape (analyses, motions)."""


class Movements(NamedTuple):
    """Movements of the floors of a building at one arm.

    to_left, to_right : to both sides
    """

    to_left: Movement
    to_right: Movement


@dataclass(frozen=True, eq=False)
class EdgePlan:
    """The time histories of a building type whose floors twist, between two walls that it never touches.

    places : of its places in the group, from 0
    """

    places: tuple[int, ...]
    plan: Plan

    @property
    def numbers(self) -> np.ndarray:
        """Numbers of the time histories between the walls among those of the plan."""
        return np.unique(self.plan.numbers[..., 0])

    def read_movements(self, arrays: ResultArrays, index: Point, arm: float) -> Movements:
        """Return how far its floors move at a point of the sweep.

        arrays : of its time histories
        arm : from their centres of mass [m]
        """
        closings = arrays["max_closing"].values[(*index, 0)]
        links = self.plan.links
        movements = Movements({}, {})
        for number, place in enumerate(links.places):
            at = (*index, 0, number)
            if not links.kind[at]:
                continue
            link_arm = links.right_arm[at] if place.left == 0 else links.left_arm[at]
            if abs(link_arm - arm) <= PLACE_TOLERANCE:
                side = movements.to_left if place.left == 0 else movements.to_right
                floor = place.right_floor if place.left == 0 else place.left_floor
                side[floor] = closings[..., number]
        return movements


def build_edge_plans(study: Study, links: Swept[tuple[Link, ...]]) -> list[EdgePlan]:
    """Return the plans of all building types whose floors twist by themselves, at some point of the sweep.

    study : with nothing between its buildings
    links : between its neighbours, without force
    """
    plans = []
    for name in dict.fromkeys(study.spec.group):
        places = tuple(place for place, other in enumerate(study.spec.group) if other == name)
        if any(needs_plan(building) for _, building in study.parts.types[name].iter_values()):
            between_walls = _put_between_walls(study, name)
            link = partial(_link_to_walls, places=places)
            of_walls = {Apart.name: sweep_map(link, between_walls.parts.group, links)}
            parts = dataclasses.replace(between_walls.parts, links=of_walls)
            plans.append(EdgePlan(places, make_plan(between_walls, parts)))
    return plans


def _put_between_walls(study: Study, name: str) -> Study:
    """Return the study of one of its building types alone, between two walls that move as the ground does."""
    root = study.tree
    mark = root.mark
    buildings = root["buildings"]
    wall = "wall"
    while wall in buildings:
        wall += "_"
    spec = Map({"wall": "fixed"}, mark, {"wall": (mark, mark)})
    tree = Map(root, mark, root.marks)
    tree["buildings"] = Map({**buildings, wall: spec}, buildings.mark, {**buildings.marks, wall: (mark, mark)})
    tree["group"] = Items([wall, name, wall], mark, [mark] * 3)
    return study.with_axes(study.axes, tree)


def _link_to_walls(group: Group, links: Sequence[Link], places: Sequence[int]) -> tuple[Link, ...]:
    """Return links without force between the floors of a building and the walls on both of its sides: at its edges, and
    where it faces its neighbours in the row.

    links, places : of the row, and of this building in it
    """
    building = group.buildings[1]
    arms = {link.left_arm for link in links if link.left in places}
    arms |= {link.right_arm for link in links if link.left + 1 in places}
    if building.plan is not None:
        arms |= {building.plan.low, building.plan.high}
    to_walls: list[Link] = []
    for left in (0, 1):
        floors, _ = find_meetings(*group.buildings[left : left + 2])
        for both in floors:
            for arm in sorted(arms):
                link = Link.apart(left, *both)
                left_arm, right_arm = (arm, 0.0) if left else (0.0, arm)
                to_walls.append(replace(link, whole_law=link.law, left_arm=left_arm, right_arm=right_arm))
    return tuple(to_walls)


class EdgeMovements:
    """Movements of floors that twist, beside their centres of mass.

    plans, arrays : of the building types whose floors twist
    study : with nothing between its buildings
    """

    def __init__(self, study: Study, plans: Sequence[EdgePlan], solver: Solver) -> None:
        self.study = study
        self._solved = [(plan, solver.solve_arrays(plan.plan, plan.numbers)) for plan in plans]
        self._known: dict[tuple[Point, int, float], Movements | None] = {}

    def find(self, index: Point, building: int, arm: float) -> Movements | None:
        """Return how far the floors of a building move; None where they do not twist.

        index : of the point of the sweep
        building : its place in the group, from 0
        arm : from their centres of mass [m]
        """
        key = (index, building, arm)
        if key not in self._known:
            self._known[key] = self._read(index, building, arm)
        return self._known[key]

    def _read(self, index: Point, place: int, arm: float) -> Movements | None:
        building = self.study.building(index, place)
        if isinstance(building, Wall) or not needs_plan(building):
            return None
        for plan, arrays in self._solved:
            if place in plan.places:
                return plan.read_movements(arrays, index, arm)
        return None
