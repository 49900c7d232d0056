"""Required separations of every motion, exact and by rules, and distances to property lines."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.model.building import Building
from pounding_cli.model.links import LinkPlace
from pounding_cli.model.meetings import FLOOR_TOLERANCE
from pounding_cli.model.separation import (
    CODE_RULES,
    UBC,
    CodePlace,
    absolute_sum,
    cross_correlation,
    double_difference,
    first_mode_damping,
    root_of_squares,
)
from pounding_cli.model.twist import needs_plan, turns_at
from pounding_cli.model.wall import Wall
from pounding_cli.questions.gap.edges import EdgeMovements
from pounding_cli.questions.gap.spec import GapSpec
from pounding_cli.questions.gap.tables import EXACT, FACING_KEYS, HIGH_END, LOW_END, MOTION_RULES
from pounding_cli.results.arrays import ResultArrays
from pounding_cli.results.responses import max_storeys
from pounding_cli.study import Plan
from pounding_cli.study.construct.buildings import find_code_displacements
from pounding_cli.study.construct.swept import Point, Swept
from pounding_cli.study.schema.street_places import EDGE_TOLERANCE, StreetSide, find_shared_edge

if TYPE_CHECKING:
    import pandas as pd

CodeDisplacements = Mapping[str, Swept[dict[str, np.ndarray]]]
"""Displacements that codes expect [m], by building type and rule."""

CodeEdges = Callable[[Point, int, float], dict[str, np.ndarray] | None]
"""code_edges(index, building, arm) -> displacements that codes expect at an arm of the floors of a building, by rule
[m], of shape (storeys,); None where they do not twist."""

RowPlace = dict[str, Any]
"""Columns that say where something is required; `point` of the sweep by number."""

Requirements = dict[str, tuple[Any, Any]]
"""By rule separations and their numerical errors [m], shape (analyses, motions), or one number of a rule that does not
depend on the motions; NaN where it says nothing."""


@dataclass(frozen=True)
class PointState:
    """The group at one point of the sweep, as far as separations need it.

    index : of the point
    number : of the point, from 0
    buildings : of the group, walls too
    code_displacements : by rule, shape (buildings, 1 + floors) [m]; 0 of a wall
    displacements : peaks of the base and of all floors, shape (analyses, motions, buildings, 1 + floors) [m]; 0 of a
        wall
    closings : largest of all links, shape (analyses, motions, links) [m]
    error : relative numerical error of the time histories, shape (analyses, motions) [-]
    edges : how far floors that twist move beside their centres of mass
    code_edges : how far codes expect them to move there
    """

    index: Point
    number: int
    buildings: list[Any]
    code_displacements: dict[str, np.ndarray]
    displacements: np.ndarray
    closings: np.ndarray
    error: np.ndarray
    edges: EdgeMovements
    code_edges: CodeEdges

    def find_code_displacement(self, rule: str, building: int, floor: int, height: float, arm: float) -> float:
        """Return the displacement that the rule of a code expects of a place of a floor, or of the columns below it
        [m]; arguments as of `find_peak`."""
        displacements = self.code_displacements[rule]
        at_edge = self.code_edges(self.index, building, arm)
        if at_edge is not None and rule in at_edge:
            displacements = displacements.copy()
            displacements[building, 1 : 1 + at_edge[rule].size] = np.abs(at_edge[rule])
        return float(_interpolate(displacements, building, floor, height))

    def find_peak(self, building: int, floor: int, height: float, arm: float) -> np.ndarray:
        """Return the largest displacement of a place of a floor, or of the columns below it, shape (analyses, motions)
        [m].

        building : its place in the group, from 0
        height : in the storey, from 0 at its foot to 1 at its floor
        arm : from the centre of mass [m]
        """
        displacements = self.displacements
        movements = self.edges.find(self.index, building, arm)
        if movements is not None:
            displacements = displacements.copy()
            for level, to_left in movements.to_left.items():
                displacements[..., building, level] = np.maximum(to_left, movements.to_right[level])
        return _interpolate(displacements, building, floor, height)


def list_sweep_points(plan: Plan) -> list[Point]:
    """Return the points of the sweep of a plan, in the order of their numbers."""
    return list(np.ndindex(*plan.shape[:-3]))


# Between floors


def build_separations(plan: Plan, spec: GapSpec, arrays: ResultArrays, edges: EdgeMovements) -> pd.DataFrame:
    """Return the required separations of floors, and of slabs and columns, that face each other.

    Columns are those of `_build_frame` with `place`, the number among `plan.links`, and `number`, that of the left
    building. Where floors twist, they are of every place along the street.
    """
    return _build_frame(plan, _iter_separations(plan, spec, arrays, edges))


def _iter_separations(
    plan: Plan, spec: GapSpec, arrays: ResultArrays, edges: EdgeMovements
) -> Iterator[tuple[RowPlace, Requirements]]:
    """Yield every two places of floors that face each other with the rules that say something there."""
    for state in _iter_points(plan, arrays, edges):
        for place, link_place in enumerate(plan.links.places):
            if plan.links.kind[(*state.index, 0, place)]:
                yield _require_separation(plan, spec, state, place, link_place)


def _iter_points(plan: Plan, arrays: ResultArrays, edges: EdgeMovements) -> Iterator[PointState]:
    """Yield the state of the group at every point of the sweep."""
    closings = _read_by_point(plan, arrays, "max_closing")
    errors = _read_by_point(plan, arrays, "error_estimate")
    sways = _read_by_point(plan, arrays, "sway")
    displacements = np.concatenate([sways[..., None], _read_by_point(plan, arrays, "displacement")], axis=-1)
    code_displacements = _find_code_displacements(plan)
    code_edges = _find_code_edges(plan)
    for number, index in enumerate(list_sweep_points(plan)):
        buildings = [plan.study.building(index, place) for place in range(len(plan.buildings))]
        is_wall = [isinstance(building, Wall) for building in buildings]
        by_code = _read_code_displacements(plan, index, code_displacements)
        peaks = displacements[number].copy()
        for values in (peaks, *by_code.values()):
            values[..., is_wall, :] = 0.0
        yield PointState(
            index=index,
            number=number,
            buildings=buildings,
            code_displacements=by_code,
            displacements=peaks,
            closings=closings[number],
            error=errors[number],
            edges=edges,
            code_edges=code_edges,
        )


def _require_separation(
    plan: Plan, spec: GapSpec, state: PointState, place: int, link_place: LinkPlace
) -> tuple[RowPlace, Requirements]:  # fmt: skip
    """Return where two floors face each other, and what they require there by every rule.

    place : number of the link among `plan.links`
    """
    left, floor, right_floor = link_place[:3]
    left_building, right_building = state.buildings[left : left + 2]
    left_at = plan.links.left_at[(*state.index, 0, place)]
    right_at = plan.links.right_at[(*state.index, 0, place)]
    ends = ((left, floor, left_at), (left + 1, right_floor, right_at))
    left_arm = plan.links.left_arm[(*state.index, 0, place)]
    right_arm = plan.links.right_arm[(*state.index, 0, place)]
    left_peak = state.find_peak(*ends[0], left_arm)
    right_peak = state.find_peak(*ends[1], right_arm)
    rules: Requirements = {}
    largest_closing = np.nanmax(state.closings, axis=-1, initial=0.0)
    rules[EXACT] = (state.closings[..., place], state.error * largest_closing)
    error = state.error * absolute_sum(left_peak, right_peak)  # a relative change of both moves no rule by more
    correlation = _correlate(left_building, right_building)
    rules["ABS"] = (absolute_sum(left_peak, right_peak), error)
    rules["SRSS"] = (root_of_squares(left_peak, right_peak), error)
    rules["DDC"] = (double_difference(left_peak, right_peak, correlation), error)
    is_left_slab = left_at == 1.0 and not isinstance(left_building, Wall)
    height = left_building.level(floor) if is_left_slab else right_building.level(right_floor)
    same_floors = _have_same_floors(left_building, right_building)
    for rule, settings in spec.select_rules():
        if floor > 0 or rule.at_base:  # the others do not tell how far a base moves
            left_moved = state.find_code_displacement(rule.name, *ends[0], left_arm)
            right_moved = state.find_code_displacement(rule.name, *ends[1], right_arm)
            code_place = CodePlace(
                left_moved,
                right_moved,
                height,
                left_building.elevation[-1],
                right_building.elevation[-1],
                same_floors,
            )
            rules[rule.name] = (rule.separation(code_place, **settings), 0.0)
    facing = (*plan.buildings[left : left + 2], floor, right_floor, link_place.struck_sides)
    where: RowPlace = {"point": state.number, "place": place, "number": left}
    where |= dict(zip(FACING_KEYS, facing, strict=True))
    where["height"] = height
    if has_ends(plan):
        where |= find_street_columns(plan, state.index, place)
    return where, rules


def has_ends(plan: Plan) -> bool:
    """Return whether floors twist somewhere, so that what they require depends on the place along the street."""
    types = [plan.study.parts.types[name] for name in plan.study.spec.group]
    return any(needs_plan(building) for each in types for _, building in each.iter_values())


def find_street_columns(plan: Plan, index: Point, place: int) -> RowPlace:
    """Return where two floors face each other along the street, as columns of tables; nowhere if neither twists.

    place : number of the link among `plan.links`
    """
    links = plan.links
    left = links.places[place].left
    floors = (links.places[place].left_floor, links.places[place].right_floor)
    pair = [plan.study.building(index, number) for number in (left, left + 1)]
    if not any(needs_plan(building) and turns_at(floor) for building, floor in zip(pair, floors, strict=True)):
        return {"end": "", "street": np.nan}
    sides = [StreetSide.of(building) for building in pair]
    link = (*index, 0, place)
    streets = [
        side.centre + float(arms[link])
        for side, arms in zip(sides, (links.left_arm, links.right_arm), strict=True)
        if side is not None
    ]
    low, high = find_shared_edge(*sides)
    for name, end in ((LOW_END, low), (HIGH_END, high)):
        if all(abs(street - end) <= EDGE_TOLERANCE * (high - low) for street in streets):
            return {"end": name, "street": end}
    texts = dict.fromkeys(f"{street:.4g} m" for street in streets)
    return {"end": " | ".join(texts), "street": streets[0]}


def _interpolate(displacements: np.ndarray, building: int, floor: int, height: float) -> np.ndarray:
    """Return the displacement of a floor, or of columns at a part of the storey below it [m].

    displacements : shape (..., buildings, 1 + floors), of the base first
    height : in the storey, from 0 at its foot to 1 at its floor
    """
    above = displacements[..., building, floor]
    if height == 1.0:
        return above
    below = displacements[..., building, max(floor - 1, 0)]
    part = height * height * (3.0 - 2.0 * height)
    return part * above + (1.0 - part) * below


def _correlate(left: Building, right: Building) -> float:
    """Return the correlation of the first modes of two buildings [-]; NaN where one has no damping."""
    left_damping = first_mode_damping(left)
    right_damping = first_mode_damping(right)
    if min(left_damping, right_damping) <= 0:
        return np.nan
    return cross_correlation(float(left.periods[0]), float(right.periods[0]), left_damping, right_damping)


def _have_same_floors(left: Building, right: Building) -> bool:
    """Return whether the floors of two neighbours have the same elevations, up to the lower roof."""
    count = min(left.storeys, right.storeys)
    return bool((np.abs(left.elevation[:count] - right.elevation[:count]) <= FLOOR_TOLERANCE).all())


# To property lines


def build_distances(plan: Plan, spec: GapSpec, arrays: ResultArrays, edges: EdgeMovements) -> pd.DataFrame:
    """Return how far every floor moves to both of its sides, and what codes ask of the distance to a line.

    Of floors that twist it is that of both ends of a side.
    """
    return _build_frame(plan, _iter_distances(plan, spec, arrays, edges))


def _iter_distances(
    plan: Plan, spec: GapSpec, arrays: ResultArrays, edges: EdgeMovements
) -> Iterator[tuple[RowPlace, Requirements]]:
    """Yield every floor and side with the rules that say something there."""
    relative_errors = _read_by_point(plan, arrays, "error_estimate")
    peaks = np.nanmax(_read_by_point(plan, arrays, "displacement"), axis=-1, initial=0.0)
    to_left = -_read_by_point(plan, arrays, "displacement_min")
    to_right = _read_by_point(plan, arrays, "displacement_max")
    code_displacements = _find_code_displacements(plan)
    code_edges = _find_code_edges(plan)
    for point, index in enumerate(list_sweep_points(plan)):
        by_code = _read_code_displacements(plan, index, code_displacements)
        for number, name in enumerate(plan.buildings):
            building = plan.study.building(index, number)
            if isinstance(building, Wall):
                continue
            for floor in range(1, building.storeys + 1):
                height = building.level(floor)
                sides = {"left": to_left, "right": to_right}
                at_centre = {side: moved[point, :, :, number, floor - 1] for side, moved in sides.items()}
                for ends, moved_by_side in _list_ends(plan, edges, index, number, floor, at_centre):
                    displacements = {rule: values[number, floor] for rule, values in by_code.items()}
                    if ends.get("end"):
                        assert building.plan is not None
                        at_edge = code_edges(index, number, ends["street"] - building.plan.street) or {}
                        displacements |= {rule: abs(values[floor - 1]) for rule, values in at_edge.items()}
                    of_codes: Requirements = {
                        rule.name: (rule.line(displacements[rule.name], height), 0.0)
                        for rule, _ in spec.select_rules()
                        if rule.line is not None
                    }
                    for side, moved in moved_by_side.items():
                        error = relative_errors[point] * np.fmax(peaks[point, :, :, number], moved)
                        where: RowPlace = {"point": point, "building": name, "side": side}
                        where |= {"floor": floor, "height": height}
                        yield where | ends, {EXACT: (moved, error), **of_codes}


def _list_ends(
    plan: Plan, edges: EdgeMovements, index: Point, number: int, floor: int, at_centre: Mapping[str, np.ndarray]
) -> list[tuple[RowPlace, Mapping[str, np.ndarray]]]:
    """Return the ends of a side of a floor, as columns of tables, with the movement to both sides there [m]; the
    movement of its centre where it does not twist.

    number : of the building
    """
    plan_of_floors = plan.study.building(index, number).plan
    nowhere: RowPlace = {"end": "", "street": np.nan} if has_ends(plan) else {}
    if plan_of_floors is None:
        return [(nowhere, at_centre)]
    ends: list[tuple[RowPlace, Mapping[str, np.ndarray]]] = []
    for end, arm in ((LOW_END, plan_of_floors.low), (HIGH_END, plan_of_floors.high)):
        movements = edges.find(index, number, arm)
        if movements is None:
            return [(nowhere, at_centre)]
        moved = {"left": movements.to_left[floor], "right": movements.to_right[floor]}
        ends.append(({"end": end, "street": plan_of_floors.street + arm}, moved))
    return ends


# Both


def _read_by_point(plan: Plan, arrays: ResultArrays, name: str) -> np.ndarray:
    """Return a variable in the one case, shape (points, analyses, motions, ...)."""
    values = arrays[name].values
    return values.reshape(-1, *values.shape[len(plan.axes) + 1 :])


def _find_code_displacements(plan: Plan) -> CodeDisplacements:
    """Return the displacements of all building types that codes expect."""
    parts = plan.study.parts
    return {name: parts.displacements(name) for name in plan.study.spec.group}


def _find_code_edges(plan: Plan) -> CodeEdges:
    """Return a function of point, building and arm that finds what codes expect there of floors that twist."""
    specs = plan.study.parts.building_specs

    @functools.cache
    def find(index: Point, place: int, arm: float) -> dict[str, np.ndarray] | None:
        building = plan.study.building(index, place)
        if isinstance(building, Wall) or not needs_plan(building):
            return None
        return find_code_displacements(specs[plan.study.spec.group[place]].value_at(index), building, arm)

    return find


def _read_code_displacements(plan: Plan, index: Point, displacements: CodeDisplacements) -> dict[str, np.ndarray]:
    """Return the displacements that codes expect at a point [m], by rule, shape (buildings, 1 + floors).

    They are 0 of the base, and NaN where a building lacks what the rule needs.
    """
    shape = (len(plan.buildings), 1 + max_storeys(plan))
    by_rule = {rule.name: np.full(shape, np.nan) for rule in CODE_RULES}
    for place, name in enumerate(plan.study.spec.group):
        for rule, floors in displacements[name].value_at(index).items():
            by_rule[rule][place, 0] = 0.0
            by_rule[rule][place, 1 : 1 + len(floors)] = floors
    return by_rule


def find_ubc_edition(plan: Plan) -> str:
    """Return the edition of the UBC that sets the yield shears; "UBC" where there are several."""
    specs = (plan.study.spec.buildings[name].yield_ for name in plan.study.spec.group)
    editions = {getattr(spec, "code", UBC) for spec in specs}
    return editions.pop() if len(editions) == 1 else UBC


def _build_frame(plan: Plan, requirements: Iterable[tuple[RowPlace, Requirements]]) -> pd.DataFrame:
    """Return `value` and `error` [m] of every place (`row`, with its columns), rule, analysis and motion."""
    import pandas as pd

    places: list[RowPlace] = []
    rules: list[str] = []
    columns: dict[str, list[np.ndarray]] = {name: [] for name in ("row", "analysis", "motion", "value", "error")}
    for row, (where, values_by_rule) in enumerate(requirements):
        places.append(where)
        for rule, (value, error) in values_by_rule.items():
            shape = (len(plan.analyses), len(plan.records) if rule in MOTION_RULES else 1)
            analysis, motion = np.indices(shape).reshape(2, -1)
            rules += [rule] * analysis.size
            columns["row"].append(np.full(analysis.size, row))
            columns["analysis"].append(analysis)
            columns["motion"].append(motion)
            columns["value"].append(np.broadcast_to(value, shape).ravel())
            columns["error"].append(np.broadcast_to(error, shape).ravel())
    frame = pd.DataFrame({name: np.concatenate(parts) for name, parts in columns.items()})
    names = {UBC: find_ubc_edition(plan)}
    rule_order = [*MOTION_RULES, *(rule.name for rule in CODE_RULES)]
    frame["rule"] = pd.Categorical(rules, rule_order).rename_categories(names)
    frame["analysis"] = pd.Categorical(np.array(plan.analyses, object)[frame["analysis"]], plan.analyses)
    return frame.join(pd.DataFrame(places), on="row")
