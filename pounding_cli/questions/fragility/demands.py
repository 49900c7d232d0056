"""Demands over limits of the time histories of a curve."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pounding_cli.questions.fragility.targets import takes_blow
from pounding_cli.questions.frames import ALONE
from pounding_cli.results.dataset import find_contacts
from pounding_cli.study import Plan
from pounding_cli.study.construct.swept import Point
from pounding_cli.study.expressions.expression import SHEAR_DEMAND
from pounding_cli.study.expressions.limits import COLLAPSE, CONTACT, EDGE_DRIFT, TWIST, Target

if TYPE_CHECKING:
    from pounding_cli.results.responses import Responses

UNDECIDED = float("-inf")
"""Demand over limit of a time history that a collapse ended before the limit was passed: the whole motion might have
passed it or not."""

_PEAKS = {"mu": "building.ductility", "drift": "building.drift", "acceleration": "building.acceleration"}
"""Quantity of a limit -> the values of time histories that it is compared with."""

_LINE_PEAKS = {"mu": "line.line_ductility", "drift": "line.line_drift"}
"""The same of a frame line."""


class CurvePlace(NamedTuple):
    """The place of a curve with pounding and of that of the building alone.

    number : of the point of the sweep, the intensity set aside
    point : its index on every axis, 0 on the intensity's
    case, analysis : numbers
    histories : by state (POUNDING, and ALONE where the building alone can pass the limit) the time histories of all
        motions and intensities by number, shape (motions, levels); intensities rise
    factor : on the value of the limit, of one of the buildings that a neighbour may be [-]
    """

    number: int
    point: Point
    case: int
    analysis: int
    target: Target
    histories: dict[str, np.ndarray]
    factor: float = 1.0


def find_demands(plan: Plan, solved: Responses, place: CurvePlace, state: str) -> np.ndarray:
    """Return demand over limit [-], shape (motions, levels).

    It is above 1 where the limit is passed, inf where a collapse ended the time history of the building after that,
    UNDECIDED where one did before, NaN where the time history failed or was not asked for.

    Passed are limits that were passed before a time history ended, the collapse itself, and limits on the drift or the
    ductility of the storey that collapsed, of its edges and of its lines along the row: its drift has no bound.
    """
    limit = place.target.limit
    histories = place.histories[state]
    building = 0 if state == ALONE else place.target.building  # the only one of its scene
    demand = _compare_peaks(plan, solved, place, histories, building)
    fallen_storey = np.nan_to_num(solved.values["building.collapse_storey"][histories, building]).astype(int)
    is_building = fallen_storey > 0
    is_ended = ~np.isnan(solved.values["building.collapse_time"][histories, building])
    if limit.quantity == CONTACT:  # of the pair, whose left building may be a wall that belongs to other parts too
        is_ended |= ~np.isnan(solved.values["building.collapse_time"][histories, building + 1])
    is_target = is_building
    if limit.level and limit.quantity != COLLAPSE:
        is_target = is_building & (fallen_storey == limit.level)
    along = _count_lines_along(plan, place)
    if limit.quantity not in ("mu", "drift", EDGE_DRIFT, COLLAPSE) or limit.line > along:
        is_target = np.zeros_like(is_building)
    is_passed = (demand > 1) | is_target
    demand = np.where(is_ended, np.where(is_passed, np.inf, UNDECIDED), demand)
    return np.where(solved.has_result[histories], demand, np.nan)


def _count_lines_along(plan: Plan, place: CurvePlace) -> int:
    """Return the number of frame lines along the row of the target's building, which stand before those across it."""
    of_floors = plan.study.building(place.point, place.target.building).plan
    return 0 if of_floors is None else len(of_floors.lines)


def _compare_peaks(
    plan: Plan, solved: Responses, place: CurvePlace, histories: np.ndarray, building_place: int
) -> np.ndarray:
    """Return demand over limit by the largest values of time histories, whatever ended them; 0 of collapse.

    building_place : of the target's building in these time histories
    """
    limit = place.target.limit
    building = plan.study.building(place.point, place.target.building)
    if limit.quantity in (*_PEAKS, EDGE_DRIFT, TWIST):
        peaks = _find_peaks(plan, solved, place, histories, building_place)[..., : building.storeys]
        value = place.factor * limit.value
        parts = peaks / (value * building.height if limit.of_height else value)
        return parts[..., limit.level - 1] if limit.level else np.fmax.reduce(parts, axis=-1)
    if limit.quantity == COLLAPSE:
        return np.zeros(histories.shape)
    parts = _compare_links(plan, solved, place, histories)
    return np.fmax.reduce(parts, axis=-1) if parts.shape[-1] else np.zeros(histories.shape)


def _find_peaks(
    plan: Plan, solved: Responses, place: CurvePlace, histories: np.ndarray, building_place: int
) -> np.ndarray:
    """Return the largest values of every storey or floor that a limit is compared with, shape (motions, levels,
    storeys). Where floors do not twist, lines along the row and edges have the drift of their storey.

    building_place : of the target's building in these time histories
    """
    limit = place.target.limit
    at = (histories, building_place)
    if limit.line:
        of_lines = solved.values[_LINE_PEAKS[limit.quantity]][at][..., limit.line - 1]
        untwisted = solved.values[_PEAKS[limit.quantity]][at] * (limit.line <= _count_lines_along(plan, place))
        return np.where(np.isnan(of_lines), untwisted, of_lines)
    if limit.quantity == EDGE_DRIFT:
        edges = np.fmax(solved.values["building.edge_drift_low"][at], solved.values["building.edge_drift_high"][at])
        return np.where(np.isnan(edges), solved.values["building.drift"][at], edges)
    if limit.quantity == TWIST:
        twist = solved.values["building.twist"][at]
        return np.where(np.isnan(twist), 0.0 * solved.values["building.drift"][at], twist)
    return np.asarray(solved.values[_PEAKS[limit.quantity]][at])


def _compare_links(plan: Plan, solved: Responses, place: CurvePlace, histories: np.ndarray) -> np.ndarray:
    """Return demand over limit of every link that the limit concerns, shape (motions, levels, links)."""
    limit = place.target.limit
    links = plan.links
    where = (*place.point, place.case)
    is_there = links.kind[where] != ""
    if limit.quantity == CONTACT:
        is_of_pair = [each.left == place.target.building for each in links.places]
        chosen = np.flatnonzero(_keep_across_gap(plan, where, is_there & is_of_pair))
        gap = links.gap[where][chosen]
        closing = solved.values["link.max_closing"][histories][..., chosen]
        with np.errstate(divide="ignore", invalid="ignore"):  # floors in touch
            return np.where(closing == 0, 0.0, closing / gap)
    assert limit.quantity == SHEAR_DEMAND
    yield_shear = plan.study.building(place.point, place.target.building).yield_shear
    strikes = [takes_blow(place.target, each, yield_shear) for each in links.places]
    chosen = np.flatnonzero(is_there & strikes)
    return solved.values["columns.demand"][histories][..., chosen] / limit.value


def _keep_across_gap(plan: Plan, where: tuple[int, ...], is_meant: np.ndarray) -> np.ndarray:
    """Return which links of a pair of neighbours tell whether its floors touch.

    A joint between floors that do not face each other closes without a gap between its ends. It tells nothing, unless
    the pair has no other link.

    where : point and case; is_meant : the links of the pair, shape (links,)
    """
    links = plan.links
    crosses = is_meant & ((links.facing[where] == 1.0) | find_contacts(plan, links.kind[where]))
    return crosses if crosses.any() else is_meant
