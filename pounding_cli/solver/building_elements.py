"""The degrees of freedom and elements of one building: what moves, the element below each, dashpots and frame lines.

Records stand here as plain data, a mapping from field to value; `layout` numbers them and makes arrays of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.laws import BEHAVIOURS
from pounding_cli.laws.law import JOINED, PARAMETERS, Behaviour
from pounding_cli.laws.slider import Slider
from pounding_cli.laws.storey import StoreyLaw
from pounding_cli.model.building import Building
from pounding_cli.model.plan import FloorPlan, find_square_radii
from pounding_cli.model.wall import Wall

Fields = dict[str, Any]
"""Fields of a record, by name."""

Weights = dict[int, float]
"""Weight of every degree of freedom in the deformation of an element."""


class LineStorey(NamedTuple):
    """A storey of a frame line of a building whose floors twist.

    element : its fields
    weights : of the degrees of freedom in its drift
    storey : from 0
    number : of the line, those across the row behind those along it
    """

    element: Fields
    weights: Weights
    storey: int
    number: int


def build_element(behaviour: Behaviour, p: Sequence[float] = (), **more: float) -> Fields:
    """Return the fields of an element with the parameters `p` of its law, and `more` of them."""
    return {
        "kind": BEHAVIOURS.index(behaviour),
        "p": (*p, *[0.0] * (PARAMETERS - len(p))),
        "collapse": math.inf,
        **more,
    }


def _build_spring(k: float, c: float) -> Fields:
    """Return the element of a storey or under a base that cannot yield: a spring [N/m] and a dashpot [N s/m]."""
    return build_element(JOINED, (k, c), c=c, drifts=1)


def _build_yielding(law: StoreyLaw, c: float) -> Fields:
    """Return the element of a storey or of isolators that may yield or slide, with a dashpot [N s/m]."""
    slides = int(isinstance(law, Slider))
    return build_element(law.behaviour, law.element_parameters(), c=c, yields=1, slides=slides, drifts=1)


def _drop_absent(weights: Weights) -> Weights:
    """Return the weights without degrees of freedom that are not there (-1) or have no weight."""
    return {dof: weight for dof, weight in weights.items() if dof >= 0 and weight}


class BuildingElements:
    """Degrees of freedom of a building, the element below each of them, and what stands beside these.

    The degrees of freedom are, in this order, the base if it sways, the floors from the ground up, the base if it
    rocks, and the rotations of the floors if they twist.

    Attributes
    ----------
    dofs, storeys : fields of every degree of freedom, and of the element below it
    drags : dashpots to the ground of floors over a foundation, each with its weights
    lines : storeys of its frame lines
    base, foot : degrees of freedom of a base that sways, and that rocks; -1 where none does
    floors, turns : degrees of freedom of the floors, and of their rotations
    """

    def __init__(self, building: Building, first: int, yields: bool, collapses: bool) -> None:
        """Lay out a building.

        Parameters
        ----------
        first : number of its first degree of freedom
        yields, collapses : whether yielding and collapse are simulated
        """
        self.building = building
        self.dofs = list[Fields]()
        self.storeys = list[Fields]()
        self.drags = list[tuple[Fields, Weights]]()
        self.lines = list[LineStorey]()
        self.base = -1
        self.foot = -1
        self._yields = yields
        self._collapses = collapses
        foundation = building.foundation
        if foundation is not None and foundation.sways:
            self.base = first
            self._add_base(foundation.mass)
        start = first + len(self.dofs)
        self.floors = slice(start, start + building.storeys)
        self.turns = slice(start, start)
        if isinstance(building, Wall) and not building.moves:
            self._add(math.inf, _build_spring(0.0, 0.0))
            return
        if foundation is not None and foundation.rocks:
            self.foot = self.floors.stop
        first_turn = self.floors.stop + int(self.foot >= 0)
        if building.plan is not None:
            self.turns = slice(first_turn, first_turn + building.storeys)
        for storey, law in enumerate(building.laws):
            self._add_floor(storey, law)
        if foundation is not None and foundation.rocks:
            rocking = _build_spring(foundation.rocking_stiffness, foundation.rocking_damping)
            self._add(foundation.inertia, rocking, loaded=0.0)
        if building.plan is not None:
            self._add_turns(building.plan)
            self._add_lines(building.plan)

    def _add_base(self, mass: float) -> None:
        """Add a base that sways, of a mass [kg], on its spring and dashpot or its isolators."""
        k, c = self.building.base_spring
        isolators = self.building.isolators
        self._add(mass, _build_spring(k, c) if isolators is None else _build_yielding(isolators, c))

    def _add_floor(self, storey: int, law: StoreyLaw) -> None:
        """Add a floor and the storey below it, counted from 0; with its dashpot to the ground over a foundation."""
        building = self.building
        has_foundation = building.foundation is not None
        mass = float(building.mass[storey])
        height = float(building.height[storey])
        element = self._build_storey(storey, law)
        element["load"] = 0.0 if building.gravity_load is None else float(building.gravity_load[storey]) / height
        self._add(
            mass,
            element,
            drag=0.0 if has_foundation else building.alpha,
            below=1.0 if storey or self.base >= 0 else 0.0,
            lean=-height if self.foot >= 0 else 0.0,
            foot=max(self.foot, 0),
        )
        if has_foundation and building.alpha > 0:
            floor = self.floors.start + storey
            weights = {floor: 1.0, self.base: -1.0, self.foot: -float(building.elevation[storey])}
            drag = build_element(JOINED, (0.0, building.alpha * mass))
            self.drags.append((drag, _drop_absent(weights)))

    def _build_storey(self, storey: int, law: StoreyLaw) -> Fields:
        """Return the element of a storey, counted from 0; where floors twist its lines resist in its place."""
        building = self.building
        if building.plan is not None:
            spring = _build_spring(0.0, 0.0)
            return spring | {"twists": self._count_twists(storey), "mate": self.turns.start + storey}
        element = self._build_resisting(law)
        if self._collapses:
            element["collapse"] = float(building.collapse_drift[storey])
        return element

    def _build_resisting(self, law: StoreyLaw) -> Fields:
        """Return the element of a storey or of a line of it, which may yield where that is simulated."""
        c = self.building.beta * law.stiffness
        if self._yields and law.can_yield:
            return _build_yielding(law, c)
        return _build_spring(law.stiffness, c)

    def _count_twists(self, storey: int) -> int:
        """Return the field `twists` of a storey from 0 whose floors twist: 1, and 2 for the highest one."""
        return 2 if storey + 1 == self.building.storeys else 1

    def _add_turns(self, plan: FloorPlan) -> None:
        """Add the rotations of the floors.

        Lines across the row that cannot yield stand between them, and P-Delta acts on them by the radii of gyration of
        what stands above.
        """
        building = self.building
        square_radius = find_square_radii(plan.inertia, building.mass)
        for storey, stiffness in enumerate(plan.torsional_stiffness.tolist()):
            load = 0.0
            if building.gravity_load is not None:
                load = float(building.gravity_load[storey] * square_radius[storey] / building.height[storey])
            element = _build_spring(stiffness, building.beta * stiffness)
            element |= {"load": load, "twists": self._count_twists(storey), "mate": self.floors.start + storey}
            self._add(
                float(plan.inertia[storey]),
                element,
                drag=building.alpha,
                below=1.0 if storey else 0.0,
                loaded=0.0,
                felt=0.0,
                unit=float(np.sqrt(building.mass[storey] / plan.inertia[storey])),
            )

    def _add_lines(self, plan: FloorPlan) -> None:
        """Add the storeys of the frame lines.

        A line along the row deforms by v = (u_j - arm theta_j) - (u_j-1 - arm theta_j-1), one across it by
        v = arm (theta_j - theta_j-1).
        """
        building = self.building
        for number, line in enumerate(plan.all_lines):
            is_along = number < len(plan.lines)
            lever = -line.arm if is_along else line.arm
            for storey, law in enumerate(building.laws_of_line(line)):
                floor = self.floors.start + storey
                turn = self.turns.start + storey
                weights = {turn: lever, turn - 1 if storey else -1: -lever}
                if is_along:
                    below = floor - 1 if storey else self.base
                    weights |= {floor: 1.0, below: -1.0, self.foot: -float(building.height[storey])}
                element = self._build_resisting(law)
                if self._collapses and is_along:
                    element["collapse"] = float(building.collapse_drift[storey])
                element |= {"storey": floor, "mate": turn, "along": float(is_along), "lever": lever}
                self.lines.append(LineStorey(element, _drop_absent(weights), storey, number))

    def _add(self, mass: float, storey: Fields, **more: float) -> None:
        """Add a degree of freedom and the element below it; a mass of inf does not move."""
        dof = {
            "mass": mass if mass < math.inf else 1.0,
            "inv_mass": 1.0 / mass,
            "loaded": 1.0,
            "felt": 1.0,
            "unit": 1.0,
        }
        self.dofs.append({**dof, **more})
        self.storeys.append(storey)

    def find_end(self, floor: int, height: float, arm: float = 0.0) -> Weights:
        """Return the motion of the end of a link as weights of the degrees of freedom.

        It ends on a floor, or on columns clamped in the floors above and below. The floors lean with a base that
        rocks.

        Parameters
        ----------
        floor : that it ends on, or above its columns; 0 for the base
        height : of the end in the storey below this floor, 1 at the floor [-]
        arm : from the centres of mass of floors that twist [m]
        """
        if isinstance(self.building, Wall):
            return {self.floors.start: 1.0}
        if floor == 0:
            return {self.base: 1.0}
        here = self.floors.start + floor - 1
        below = here - 1 if floor > 1 else self.base
        shape = height * height * (3.0 - 2.0 * height)  # of the clamped columns
        lean = float(self.building.height[floor - 1]) * (height - shape)
        weights = {here: shape, below: 1.0 - shape, self.foot: lean}
        if self.building.plan is not None and arm:
            turn = self.turns.start + floor - 1
            weights |= {turn: -arm * shape}
            if floor > 1:
                weights |= {turn - 1: -arm * (1.0 - shape)}
        return _drop_absent(weights)
