"""From a scene to the records of its run.

What scenes of the same buildings, links and analysis share is laid out once (`Layout`); their runs get copies of it and
their motions (`solve.SceneRun`)."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.laws import BEHAVIOURS
from pounding_cli.laws.formula import WrittenLaw
from pounding_cli.laws.joints import Maxwell
from pounding_cli.laws.law import JOINED, PARAMETERS, Behaviour, LinkLaw
from pounding_cli.laws.pounding import reduced_mass
from pounding_cli.laws.slider import Slider
from pounding_cli.laws.storey import StoreyLaw
from pounding_cli.methods import Method
from pounding_cli.model.building import Building
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import LinkEnd
from pounding_cli.model.plan import FloorPlan, find_square_radii
from pounding_cli.model.scene import Scene
from pounding_cli.model.wall import Wall
from pounding_cli.records.motion import Motion
from pounding_cli.solver.records import COLUMN, DOF, ELEMENT, FORMULA, RUN, SERIES, STATE, TERM, Data, Room, Watch

SAFETY = 0.5
"""What a series may leave out of an acceleration, over the accuracy asked of the peaks [-]."""

COARSEST = 1e-4
FINEST = 1e-16
"""Most and least that a series may leave out, relative to the acceleration [-]."""

SMOOTHER = 0.01
FINEST_SMOOTH = 1e-13
"""Error that a step by DOP853 may have, over what a series may leave out, and its least [-]: less could not be told
from rounding, and where less is asked the steps become as much shorter as it would make them."""

ORDER_OF_DOP853 = 8
"""Power of the step by which its error falls."""

LEAST_STATE = 1e-6
"""Size of a displacement [m], velocity [m/s] or history variable below which DOP853 resolves nothing."""

LEAST_SCALE = 1e-3
"""Acceleration below which nothing is resolved, over the ground's peak [-]."""

MOST_STEPS = 20_000_000
MOST_EVENTS = 5_000_000
"""Bounds of a run, after which it ends with a status that says so."""

NOTHING_KEPT = Watch(np.zeros(0), np.zeros((0, 0, 3)), np.zeros((0, 0, 2)), np.zeros((0, 3)), np.zeros((0, 0)))

WHOLE = 1e-9
"""Part of a time step of the motion [-] by which a tail may miss whole time steps and still have them."""

Weights = dict[int, float]
"""Weight of every degree of freedom in the deformation of an element."""


def find_max_order(tolerance: float) -> int:
    """Highest order worth computing before a step is cut, measured over Figs 6 and 7, touching pairs, P-Delta and rows:
    12 at 1e-4, 18 at 1e-12. Most steps end at a sample of the motion or at an event, so that it lies below the
    optimum of long steps, -ln(tol) / 2 + 1 (Jorba & Zou 2005), where much is asked."""
    return math.ceil(-0.35 * math.log(tolerance)) + 8


class Tie(NamedTuple):
    """Of a link what scenes have in common whose laws have other parameters; fields as of `Link`.

    arms : of both ends from the centres of mass [m]
    """

    ends: tuple[LinkEnd, LinkEnd]
    columns: float
    cosine: float
    arms: tuple[float, float]
    law: type[LinkLaw]


class Line(NamedTuple):
    """A storey of a frame line of a building whose floors twist.

    element : its fields
    weights : of the degrees of freedom in its drift
    storey : from 0
    number : of the line, those across the row behind those along it
    """

    element: dict[str, Any]
    weights: Weights
    storey: int
    number: int


class Columns(NamedTuple):
    """Columns whose shear is asked for because a link ends on them.

    link : its number
    building, storey : of the columns, from 0 and from 1
    at : height of its end in the storey [-]
    share : part of the storey that the columns have [-]
    cosine : part of the link's force that is level [-]
    on_left : whether they are those on the building's left
    """

    link: int
    building: int
    storey: int
    at: float
    share: float
    cosine: float
    on_left: bool


@dataclass(frozen=True, eq=False)
class Layout:
    """What all runs of the same buildings and links share but for the parameters of links: records at rest, and where
    everything stands.

    masses : what moves with the two ends of every link [kg]
    cosines : of the angles of the links, shape (links,): a link deforms by the closing of its ends times it [-]
    floors : degrees of freedom of the floors of every building
    bases, feet : those of a base that sways, and that rocks; -1 where none does
    turns : degrees of freedom of the rotations of the floors of every building, none where they do not twist
    drags : dashpots to the ground of buildings on foundations; their elements stand behind those of the storeys
    lines : building, storey from 0 and number of every frame line; their elements stand behind these dashpots
    sums : buildings from 0 whose floors twist; their storey shears, sums over lines, stand behind those of `struck` in
        `columns`
    struck : columns that links end on; two shears each stand in `columns`, below and above that end
    """

    buildings: tuple[Building, ...]
    dofs: np.ndarray
    elements: np.ndarray
    terms: np.ndarray
    columns: np.ndarray
    masses: tuple[tuple[float, float], ...]
    cosines: np.ndarray
    floors: tuple[slice, ...]
    bases: tuple[int, ...]
    feet: tuple[int, ...]
    turns: tuple[slice, ...]
    drags: int
    lines: tuple[tuple[int, int, int], ...]
    sums: tuple[int, ...]
    struck: tuple[Columns, ...]
    has_smooth: bool

    @property
    def number(self) -> int:
        """Degrees of freedom."""
        return self.dofs.size

    @property
    def most_lines(self) -> int:
        """Most frame lines of a building; 0 where no floors twist."""
        return 1 + max((number for _, _, number in self.lines), default=-1)

    @property
    def of_links(self) -> slice:
        """Where the elements of the links stand."""
        return slice(self.of_lines.stop, self.elements.size)

    @property
    def of_lines(self) -> slice:
        """Slice of the elements of the frame lines."""
        first = self.number + self.drags
        return slice(first, first + len(self.lines))


def _build_element(behaviour: Behaviour, p: Sequence[float] = (), **more: float) -> dict[str, Any]:
    """The fields of an element with these parameters."""
    return {
        "kind": BEHAVIOURS.index(behaviour),
        "p": (*p, *[0.0] * (PARAMETERS - len(p))),
        "collapse": math.inf,
        **more,
    }


def _build_storey(k: float, c: float, law: StoreyLaw | None = None) -> dict[str, Any]:
    """The element of a storey or under a base, with a dashpot c [N s/m]; with a spring k [N/m] where it cannot
    yield."""
    if law is None:
        return _build_element(JOINED, (k, c), c=c, drifts=1)
    slides = int(isinstance(law, Slider))
    return _build_element(law.behaviour, law.element_parameters(), c=c, yields=1, slides=slides, drifts=1)


class _Building:
    """The degrees of freedom of a building, the first of them at `first`: its base if it sways, floors from the ground
    up, its rocking; the elements below each; and the dashpots to the ground with their weights."""

    def __init__(self, b: Building, first: int, yields: bool, collapses: bool) -> None:
        self.dofs = list[dict[str, Any]]()
        self.storeys = list[dict[str, Any]]()
        self.drags = list[tuple[dict[str, Any], Weights]]()
        self.lines = list[Line]()
        self.building = b
        f = b.foundation
        self.base = self.foot = -1
        if f is not None and f.sways:
            self.base = first
            self._add(f.mass, _build_storey(*b.base_spring, b.isolators))
        start = first + len(self.dofs)
        self.floors = slice(start, start + b.storeys)
        self.turns = slice(start, start)
        if isinstance(b, Wall) and not b.moves:
            self._add(math.inf, _build_storey(0.0, 0.0))
            return
        if f is not None and f.rocks:
            self.foot = self.floors.stop
        self._first_turn = self.floors.stop + int(self.foot >= 0)
        rocks = self.foot >= 0
        for j, law in enumerate(b.laws):
            mass = float(b.mass[j])
            height = float(b.height[j])
            limit = float(b.collapse_drift[j]) if collapses else math.inf
            load = 0.0 if b.gravity_load is None else float(b.gravity_load[j]) / height
            storey = _build_storey(law.stiffness, b.beta * law.stiffness, law if yields and law.can_yield else None)
            if b.plan is not None:  # its lines resist
                storey = _build_storey(0.0, 0.0)
                limit = math.inf
                storey |= {"twists": self._twists(j), "mate": self._first_turn + j}
            self._add(
                mass, storey | {"collapse": limit, "load": load}, drag=b.alpha if f is None else 0.0,
                below=1.0 if j or self.base >= 0 else 0.0, lean=-height if rocks else 0.0, foot=max(self.foot, 0),
            )  # fmt: skip
            if f is not None and b.alpha > 0:
                ends = {start + j: 1.0, self.base: -1.0, self.foot: -float(b.elevation[j])}
                self.drags.append((_build_element(JOINED, (0.0, b.alpha * mass)), _drop_fixed(ends)))
        if f is not None and rocks:
            self._add(f.inertia, _build_storey(f.rocking_stiffness, f.rocking_damping), loaded=0.0)
        if b.plan is not None:
            self._add_turns(b.plan)
            self._add_lines(b.plan, yields, collapses)

    def _twists(self, storey: int) -> int:
        """Return 1 for a storey from 0 whose floors twist, 2 for the highest one."""
        return 2 if storey + 1 == self.building.storeys else 1

    def _add_turns(self, plan: FloorPlan) -> None:
        """The rotations of the floors; lines across the row that cannot yield stand between them, and P-Delta acts on
        them by the radii of gyration of what stands above."""
        b = self.building
        self.turns = slice(self._first_turn, self._first_turn + b.storeys)
        square_radius = find_square_radii(plan.inertia, b.mass)
        for j, stiffness in enumerate(plan.torsional_stiffness.tolist()):
            load = 0.0
            if b.gravity_load is not None:
                load = float(b.gravity_load[j] * square_radius[j] / b.height[j])
            storey = _build_storey(stiffness, b.beta * stiffness)
            storey |= {"load": load, "twists": self._twists(j), "mate": self.floors.start + j}
            self._add(
                float(plan.inertia[j]), storey, drag=b.alpha, below=1.0 if j else 0.0, loaded=0.0, felt=0.0,
                unit=float(np.sqrt(b.mass[j] / plan.inertia[j])),
            )  # fmt: skip

    def _add_lines(self, plan: FloorPlan, yields: bool, collapses: bool) -> None:
        """The storeys of the frame lines: v = (u_j - arm theta_j) - (u_j-1 - arm theta_j-1), across the row
        x (theta_j - theta_j-1)."""
        b = self.building
        for number, line in enumerate(plan.all_lines):
            is_along = number < len(plan.lines)
            for j, law in enumerate(b.laws_of_line(line)):
                below = self.floors.start + j - 1 if j else self.base
                turn = self.turns.start + j
                turn_below = self.turns.start + j - 1 if j else -1
                lever = -line.arm if is_along else line.arm
                weights = {turn: lever, turn_below: -lever}
                if is_along:
                    weights |= {self.floors.start + j: 1.0, below: -1.0, self.foot: -float(b.height[j])}
                yielding = law if yields and law.can_yield else None
                element = _build_storey(law.stiffness, b.beta * law.stiffness, yielding)
                limit = float(b.collapse_drift[j]) if collapses and is_along else math.inf
                element |= {"collapse": limit, "storey": self.floors.start + j, "mate": turn}
                element |= {"along": float(is_along), "lever": lever}
                self.lines.append(Line(element, _drop_fixed(weights), j, number))

    def _add(self, mass: float, storey: dict[str, Any], **more: float) -> None:
        """A degree of freedom and the element below it; a mass of inf does not move."""
        own = mass if mass < math.inf else 1.0
        self.dofs.append({"mass": own, "inv_mass": 1.0 / mass, "loaded": 1.0, "felt": 1.0, "unit": 1.0, **more})
        self.storeys.append(storey)

    def end(self, floor: int, at: float, arm: float = 0.0) -> Weights:
        """The motion of where a link ends: a floor, or columns clamped in the floors above and below, `at` of the
        height of the storey below the floor. The floors lean with a base that rocks.

        arm : from the centres of mass of floors that twist [m]
        """
        first = self.floors.start
        shape = at * at * (3.0 - 2.0 * at)
        if isinstance(self.building, Wall):
            return {first: 1.0}
        if floor == 0:
            return {self.base: 1.0}
        below = first + floor - 2 if floor > 1 else self.base
        lean = float(self.building.height[floor - 1]) * (at - shape)
        weights = {first + floor - 1: shape, below: 1.0 - shape, self.foot: lean}
        if self.building.plan is not None and arm:
            turn = self.turns.start + floor - 1
            weights |= {turn: -arm * shape}
            if floor > 1:
                weights |= {turn - 1: -arm * (1.0 - shape)}
        return _drop_fixed(weights)


def _drop_fixed(weights: Weights) -> Weights:
    """Without degrees of freedom that are not there (-1) or have no weight."""
    return {dof: weight for dof, weight in weights.items() if dof >= 0 and weight}


def _scale_weights(weights: Weights, factor: float) -> Weights:
    """Return weights times a factor."""
    return {dof: factor * weight for dof, weight in weights.items()}


def _find_columns(number: int, tie: Tie) -> Columns:
    """Return the columns that a link ends on, of which one end stands between floors; number : of the link."""
    left, right = tie.ends
    on_left = left[2] == 1.0  # the link comes from the left, to the columns on the left of the right building
    building, storey, at = right if on_left else left
    return Columns(number, building, storey, at, tie.columns, tie.cosine, on_left)


def _fill_records(dtype: np.dtype, rows: Sequence[Mapping[str, Any]], least: int = 0) -> np.ndarray:
    """Records with these fields, zero where nothing is said."""
    records = np.zeros(max(len(rows), least), dtype)
    for record, row in zip(records, rows, strict=False):
        for name, value in row.items():
            record[name] = value
    return records


def _enter_ends(element: np.void, weights: Weights, terms: list[tuple[float, int]]) -> None:
    """Enter the degrees of freedom of an element: two plain ends where there are, all else as terms."""
    ends = [next((i for i, w in weights.items() if w == sign), -1) for sign in (1.0, -1.0)]
    left, right = (0, 0) if -1 in ends else ends  # no plain ends: all weights are terms
    element["left"] = left
    element["right"] = right
    element["hold"] = 1.0
    element["first"] = len(terms)
    terms += [(w, i) for i, w in weights.items() if left == right or i not in (left, right)]
    element["last"] = len(terms)


def _build_column_shears(
    struck: Sequence[Columns], made: Sequence[_Building], first_line: int, terms: list[tuple[float, int]]
) -> list[dict[str, Any]]:
    """The shears below and above the end of every link on columns: what the columns have of the storey's shear, and of
    the level forces of all links on them the reaction of a clamped beam at that end; between two links, that of both
    sides.

    first_line : element of the first line of all buildings, whose links stand behind these
    """
    shears = []
    first_link = first_line + sum(len(each.lines) for each in made)
    for own in struck:
        for above in (False, True):
            first = len(terms)
            for other in struck:
                if (other.building, other.storey, other.on_left) != (own.building, own.storey, own.on_left):
                    continue
                to_above = other.at * other.at * (3.0 - 2.0 * other.at)
                higher = other.at > own.at if above else other.at >= own.at
                weight = other.cosine * (1.0 - to_above if higher else -to_above)
                terms.append((weight if own.on_left else -weight, first_link + other.link))
            lines = _list_lines_of_storey(made, own.building, own.storey - 1, first_line)
            terms += [(own.share, line) for line in lines]
            storey = made[own.building].floors.start + own.storey - 1
            shears.append({"share": own.share, "storey": storey, "first": first, "last": len(terms)})
    return shears


def _build_storey_shears(
    number: int, made: Sequence[_Building], first_line: int, terms: list[tuple[float, int]]
) -> list[dict[str, Any]]:
    """The shears of the storeys of a building whose floors twist, from the ground up: the sums of its lines along the
    row; and the places of its edges, whose drifts are looked at with them.

    number : of the building; first_line : element of the first line of all buildings
    """
    building = made[number]
    plan = building.building.plan
    assert plan is not None
    shears = []
    for j in range(building.building.storeys):
        first = len(terms)
        terms += [(1.0, line) for line in _list_lines_of_storey(made, number, j, first_line)]
        shear = {"share": 1.0, "storey": building.floors.start + j, "first": first, "last": len(terms)}
        shears.append(shear | {"is_sum": 1, "low": -plan.low, "high": -plan.high})
    return shears


def _list_lines_of_storey(made: Sequence[_Building], number: int, storey: int, first_line: int) -> list[int]:
    """Return the elements of the lines along the row of a storey from 0 of a building, none where floors do not twist.

    number : of the building; first_line : element of the first line of all buildings
    """
    building = made[number]
    begin = first_line + sum(len(each.lines) for each in made[:number])
    return [
        begin + place
        for place, line in enumerate(building.lines)
        if line.storey == storey and line.element["along"] > 0.0
    ]


def build_layout(scene: Scene) -> Layout:
    """Lay out the buildings and links of a scene."""
    effects = effects_of(scene)
    links = scene.links
    ties = tuple(
        Tie(
            ends=link.ends,
            columns=link.columns,
            cosine=link.cosine,
            arms=(link.left_arm, link.right_arm),
            law=type(link.law),
        )
        for link in links
    )
    return _build_layout(scene.buildings, ties, effects.yielding, effects.collapse)


def _build_link(behaviour: Behaviour) -> dict[str, Any]:
    """The element of a link."""
    return _build_element(behaviour, eased=behaviour.force is not None and not behaviour.begins_by_series)


def _find_ends(made: Sequence[_Building], tie: Tie, inv_mass: np.ndarray) -> tuple[Weights, tuple[float, float]]:
    """Return the weights of a link in its deformation, and the masses that its force moves at both ends [kg]; inf where
    the ground stops it.

    inv_mass : of all degrees of freedom [1/kg]
    """
    left, right = (
        _scale_weights(made[number].end(floor, at, arm), tie.cosine)
        for (number, floor, at), arm in zip(tie.ends, tie.arms, strict=True)
    )
    left_mass, right_mass = (_find_moved_mass(end, inv_mass) for end in (left, right))
    return left | {dof: -weight for dof, weight in right.items()}, (left_mass, right_mass)


def _find_moved_mass(end: Weights, inv_mass: np.ndarray) -> float:
    """Return the mass that a force on the end of a link moves [kg], inf where that does not move."""
    moved = sum(weight * weight * float(inv_mass[dof]) for dof, weight in end.items())
    return 1.0 / moved if moved else math.inf


@functools.lru_cache(maxsize=64)  # the same for every motion, gap and restitution
def _build_layout(buildings: tuple[Building, ...], ties: tuple[Tie, ...], yields: bool, collapses: bool) -> Layout:
    made = list[_Building]()
    for building in buildings:
        made.append(_Building(building, sum(len(each.dofs) for each in made), yields, collapses))
    dofs = _fill_records(DOF, [dof for each in made for dof in each.dofs])
    storeys = [each for b in made for each in b.storeys]
    drags = [each for b in made for each in b.drags]
    lines = [(line.element, line.weights) for b in made for line in b.lines]
    n = dofs.size
    tied = [_find_ends(made, tie, dofs["inv_mass"]) for tie in ties]
    links = [(_build_link(tie.law.behaviour), weights) for tie, (weights, _) in zip(ties, tied, strict=True)]
    beside = [*drags, *lines, *links]
    elements = _fill_records(ELEMENT, [*storeys, *(element for element, _ in beside)])
    terms = list[tuple[float, int]]()
    for i, element in enumerate(elements[:n]):
        element["left"] = i
        element["right"] = max(i - 1, 0)
        element["hold"] = dofs[i]["below"]
        element["first"] = len(terms)
        terms += [(dofs[i]["lean"], dofs[i]["foot"])] if dofs[i]["lean"] else []
        element["last"] = len(terms)
    for element, (_, weights) in zip(elements[n:], beside, strict=True):
        _enter_ends(element, weights, terms)
    struck = tuple(_find_columns(number, tie) for number, tie in enumerate(ties) if tie.columns > 0.0)
    sums = tuple(number for number, building in enumerate(buildings) if building.plan is not None)
    first_line = n + len(drags)
    shears = _build_column_shears(struck, made, first_line, terms)
    for number in sums:
        shears += _build_storey_shears(number, made, first_line, terms)
    columns = _fill_records(COLUMN, shears, 1)
    table = np.zeros(max(len(terms), 1), TERM)
    table["weight"][: len(terms)] = [w for w, _ in terms]
    table["dof"][: len(terms)] = [i for _, i in terms]
    behaviours = [BEHAVIOURS[kind] for kind in elements["kind"].tolist()]
    _number_states(elements, behaviours, n)
    return Layout(
        buildings=buildings,
        dofs=dofs,
        elements=elements,
        terms=table,
        columns=columns,
        masses=tuple(masses for _, masses in tied),
        cosines=np.array([tie.cosine for tie in ties]),
        floors=tuple(each.floors for each in made),
        bases=tuple(each.base for each in made),
        feet=tuple(each.foot for each in made),
        turns=tuple(each.turns for each in made),
        drags=len(drags),
        lines=tuple((number, line.storey, line.number) for number, b in enumerate(made) for line in b.lines),
        sums=sums,
        struck=struck,
        has_smooth=any(each.force is not None for each in behaviours),
    )


def _number_states(elements: np.ndarray, behaviours: Sequence[Behaviour], n: int) -> None:
    """Enter where elements of storeys stand among the series, and history variables among what DOP853 integrates.

    n : degrees of freedom
    """
    in_rows = np.flatnonzero([each.force is not None or each is Slider.behaviour for each in behaviours[:n]])
    elements["row"][in_rows] = elements.size - n + np.arange(in_rows.size)
    changing = [
        number for number, each in enumerate(behaviours) if each.history_rate is not None or each is Maxwell.behaviour
    ]
    elements["state"][changing] = 2 * n + np.arange(len(changing))


def _put_links(elements: np.ndarray, scenes: Sequence[Scene], masses: Sequence[tuple[float, float]]) -> np.ndarray:
    """Enter the parameters of the links of scenes, with the masses at their ends, into their elements, shape (scenes,
    links); the records of their formulas, one a scene at least."""
    count = sum(isinstance(link.law, WrittenLaw) for link in scenes[0].links)
    formulas = np.zeros((len(scenes), max(count, 1)), FORMULA)
    p = elements["p"]
    offset = elements["offset"]
    for number, scene in enumerate(scenes):
        written = 0
        for place, (link, both) in enumerate(zip(scene.links, masses, strict=True)):
            law = link.law
            numbers = law.element_parameters(*both)
            p[number, place, : len(numbers)] = numbers
            offset[number, place] = law.offset
            if isinstance(law, WrittenLaw):
                formula = law.force(reduced_mass(*both))
                record = formulas[number, written]
                elements["formula"][number, place] = written
                written = written + 1
                record["count"] = len(formula.rows)
                record["result"] = formula.result
                record["operations"][: len(formula.rows)] = formula.rows
    return formulas


def build_term_matrix(layout: Layout) -> np.ndarray:
    """Rows that give the deformation of every element from the displacements, shape (elements, degrees of freedom)."""
    matrix = np.zeros((layout.elements.size, layout.number))
    for row, element in zip(matrix, layout.elements, strict=True):
        row[element["left"]] += 1.0
        row[element["right"]] -= element["hold"]
        for x in range(element["first"], element["last"]):
            row[layout.terms["dof"][x]] += layout.terms["weight"][x]
    return matrix


Segments = tuple[np.ndarray, np.ndarray]
"""Acceleration at the start of every segment of a motion [m/s2], and its slope [m/s3]."""


def build_segments(scene: Scene) -> Segments:
    """(acceleration at each segment's start [m/s2], its slope [m/s3]); a tail is still ground. Scenes of one motion
    share the arrays; nothing writes to them."""
    return _split_motion(scene.motion, _count_tail_segments(scene))


def _count_tail_segments(scene: Scene) -> int:
    """Return the number of segments of a scene's tail; the last may be shorter than a time step of its motion."""
    return math.ceil(scene.tail / scene.motion.dt - WHOLE)


def find_last_segment(scene: Scene) -> float:
    """Return the length of a scene's last segment [s]: a tail ends where it is asked to."""
    dt = scene.motion.dt
    count = _count_tail_segments(scene)
    if count == 0 or abs(scene.tail - count * dt) <= WHOLE * dt:
        return dt
    return scene.tail - (count - 1) * dt


def find_run_time(scene: Scene) -> float:
    """Return the time that a run of a scene covers, its motion and its tail [s]."""
    dt = scene.motion.dt
    return (build_segments(scene)[0].size - 1) * dt + find_last_segment(scene)


@functools.lru_cache(maxsize=16)
def _split_motion(motion: Motion, still: int) -> tuple[np.ndarray, np.ndarray]:
    tail = np.zeros(still)
    slopes = np.diff(motion.acceleration) / motion.dt
    return np.concatenate((motion.acceleration[:-1], tail)), np.concatenate((slopes, tail))


def join_segments(each: Sequence[Segments]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the segments of scenes one after the other, and of every scene where its own end, shape (scenes,)."""
    grounds, slopes = zip(*each, strict=True)
    return np.concatenate(grounds), np.concatenate(slopes), np.cumsum([ground.size for ground in grounds])


def build_records(
    scenes: Sequence[Scene],
    layout: Layout,
    accuracy: float,
    method: Method,
    initial: tuple[Sequence[np.ndarray], Sequence[np.ndarray]] | None,
    times: np.ndarray | None,
    bounds: tuple[int, int],
    least_steps: int = 1,
) -> Data:
    """The records of runs of one layout, a row a scene; parameters as of `solve.prepare`."""
    n = layout.number
    m = layout.elements.size
    count = len(scenes)
    dofs, elements, columns = (np.tile(each, (count, 1)) for each in (layout.dofs, layout.elements, layout.columns))
    formulas = _put_links(elements[:, layout.of_links], scenes, layout.masses)
    if initial is not None:
        _put_initial(dofs, layout, *initial)
    tolerance = min(max(accuracy * SAFETY, FINEST), COARSEST)
    r = np.zeros(count, RUN)
    always_smooth = method.name == "dop853"
    r["n"] = n
    r["m"] = m
    r["drags"] = layout.drags
    r["lines"] = len(layout.lines)
    r["columns"] = layout.columns.size if layout.struck or layout.sums else 0
    r["dt"] = [scene.motion.dt for scene in scenes]
    r["tolerance"] = tolerance
    r["least"] = [_find_least_acceleration(layout, *each) for each in zip(scenes, dofs, elements, strict=True)]
    r["most_h"] = r["dt"] / least_steps
    r["rest"] = [find_last_segment(scene) for scene in scenes]
    smooth_tolerance = SMOOTHER * tolerance
    r["smooth_tolerance"] = max(smooth_tolerance, FINEST_SMOOTH)
    r["smaller"] = min(1.0, smooth_tolerance / FINEST_SMOOTH) ** (1.0 / ORDER_OF_DOP853)
    r["max_order"] = find_max_order(tolerance)
    r["has_lean"] = max(layout.feet) >= 0
    r["most_steps"], r["most_events"] = bounds
    r["always_smooth"] = always_smooth
    room = None
    if layout.has_smooth or always_smooth or method.takes_step:
        changing = int(np.count_nonzero(layout.elements["state"]))
        room = Room(np.zeros((count, 2 * n + changing), STATE), formulas)
        room.states["scale"] = LEAST_STATE
        room.states["scale"][:, :n] *= layout.dofs["unit"]
        room.states["scale"][:, n : 2 * n] *= layout.dofs["unit"]
    has_sliders = bool(layout.elements["slides"].any())
    r["has_sliders"] = has_sliders
    series = np.zeros((count, max(m - n + n * (layout.has_smooth or has_sliders), 1)), SERIES)
    watch = NOTHING_KEPT
    if times is not None:
        t = times.size
        watch = Watch(times, np.zeros((t, n, 3)), np.zeros((t, m, 2)), np.zeros((t, 3)), np.zeros((t, n)))
    return Data(dofs, elements, layout.terms, r, series, columns, room, watch)


def _put_initial(
    dofs: np.ndarray, layout: Layout, displacements: Sequence[np.ndarray], velocities: Sequence[np.ndarray]
) -> None:
    """Enter the initial displacements and velocities of the floors of every building, shapes (floors,); with their
    rotations behind them, shapes (2 floors,)."""
    for floors, turns, u, v in zip(layout.floors, layout.turns, displacements, velocities, strict=True):
        storeys = floors.stop - floors.start
        dofs["u0"][:, floors] = u[:storeys]
        dofs["w"][:, floors, 0] = v[:storeys]
        if len(u) > storeys:
            dofs["u0"][:, turns] = u[storeys:]
            dofs["w"][:, turns, 0] = v[storeys:]


def _find_least_acceleration(layout: Layout, scene: Scene, dofs: np.ndarray, elements: np.ndarray) -> float:
    """Acceleration [m/s2] below which nothing is resolved: a part of the ground's peak, or on still ground that of the
    start: the largest spring force per mass, or what would turn its largest velocity within a second."""
    if scene.motion.pga > 0:
        return LEAST_SCALE * scene.motion.pga
    n = dofs.size
    below = np.concatenate(([0.0], dofs["u0"][:-1])) * dofs["below"]
    pulls = elements["p"][:n, 0] * np.abs(dofs["u0"] - below) * dofs["inv_mass"]
    largest = max(float(pulls.max()), float(np.abs(dofs["w"][:, 0]).max()))
    if layout.lines:
        lines = layout.of_lines
        rows = build_term_matrix(layout)[lines]
        pulls = np.abs(elements["p"][lines, 0] * (rows @ dofs["u0"])) @ np.abs(rows) * dofs["inv_mass"]
        largest = max(largest, float((pulls / dofs["unit"]).max()))
    return largest
