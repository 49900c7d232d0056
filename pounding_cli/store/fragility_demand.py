"""Demand over limit of every scene of `pound fragility`, read from the tables of its results file."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pounding_cli.store.answers import Read
from pounding_cli.study.fragility_rounds import (
    Layout,
    by_level,
    demand_of_collapse,
    over_demand,
    over_gap,
    over_limit,
    struck_columns,
)
from pounding_cli.study.limits import COLLAPSE, CONTACT, SHEAR_DEMAND, Target
from pounding_cli.variables import ALONE

if TYPE_CHECKING:
    from pounding_cli.model.links import LinkPlace
    from pounding_cli.study import Plan
    from pounding_cli.study.fragility import Question


class Demand(NamedTuple):
    """Demand over limit, and whether a collapse ended the scene; shapes (motions, levels)."""

    demand: np.ndarray
    ended: np.ndarray


class Demands:
    """Demand over limit, read from the tables of the file."""

    def __init__(self, plan: Plan, read: Read, question: Question, layout: Layout) -> None:
        self.plan, self.read, self.question, self.layout = plan, read, question, layout
        self._read: dict[str, np.ndarray] = {}

    def of(self, target: Target, point: int, case: int, analysis: int) -> tuple[Demand, Demand | None]:
        """With pounding and alone; None alone: contact and shear demand, which take a neighbour."""
        limit, building, place = target.limit, target.building, (point, case, analysis)
        links = self.layout.links(point, case)
        storeys = [self._levels(name)[point, case, analysis] for name in ("collapsed", "collapsed0")]
        fell = (storeys[0] > 0).any(axis=-1)
        if limit.quantity == CONTACT:
            mine = [number for number, link in enumerate(links) if link.left == building]
            gaps = np.array([links[number].gap for number in mine])
            return Demand(over_gap(self._of_links("max_closing", place, mine), gaps), fell), None
        own_building = self.plan.study.building(self.layout.points[point], building)
        if limit.quantity == SHEAR_DEMAND:
            mine = struck_columns(target, links, own_building.yield_shear)
            demand = over_demand(limit, self._of_links("shear_demand", place, mine))
            return Demand(np.where(fell, demand_of_collapse(limit, fell), demand), fell), None
        height = own_building.height
        both: list[Demand] = []
        quantity = "drift" if limit.quantity == COLLAPSE else limit.quantity
        for name, storey in zip((quantity, ALONE[quantity]), storeys, strict=True):
            peaks = self._levels(name)[point, case, analysis, ..., building, : len(height)]
            demand = 0.0 * peaks[..., 0] if limit.quantity == COLLAPSE else over_limit(limit, peaks, height)
            own = storey[..., building] > 0
            ended = own if both else fell
            # fault: demand-over-a-collapse
            both.append(Demand(np.where(ended, demand_of_collapse(limit, own), demand), ended))
        return both[0], both[1]

    def _of_links(self, name: str, place: tuple[int, int, int], numbers: list[int]) -> np.ndarray:
        """A variable of some links of a point, case and analysis, shape (motions, levels, links)."""
        if not numbers:  # the file need not have the variable
            return np.zeros((*self.layout.linked.shape[3:], 0))
        links = self.layout.links(*place[:2])
        return self._levels(name)[place][..., [self._numbers[links[number].place] for number in numbers]]

    def _levels(self, name: str) -> np.ndarray:
        if name not in self._read:
            axis, axes = self.question.axis, self.plan.axes
            self._read[name] = by_level(self.read(name), len(axes), axis, self.layout.order)
        return self._read[name]

    @cached_property
    def _numbers(self) -> dict[LinkPlace, int]:
        """Where links stand along the dimension `link` of the file."""
        places = {link.place for links in self.plan.rows.sets.layouts for link in links}
        return {place: number for number, place in enumerate(sorted(places))}
