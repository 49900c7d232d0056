"""Which buildings or pairs of buildings a limit concerns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.model.links import LinkPlace, link_places
from pounding_cli.questions.expressions import find_scope, find_twist_problem
from pounding_cli.questions.question import StudyQuestion
from pounding_cli.study import Study
from pounding_cli.study.construct.group import unique_names
from pounding_cli.study.construct.swept import Point
from pounding_cli.study.expressions.expression import SHEAR_DEMAND, TableQuantity
from pounding_cli.study.expressions.limits import (
    COLLAPSE,
    CONTACT,
    DAMAGE_LIMITS,
    EDGE_DRIFT,
    TWIST,
    Limit,
    Target,
    parse_limit,
)
from pounding_cli.study.schema.archetypes import list_seen

_HINTS = {
    COLLAPSE: "write `p_delta: true` of a building that yields, or the drift: `collapse: 10 %`",
    SHEAR_DEMAND: "write `columns:` in a building that yields; `pound check` lists what links load columns",
}
"""Hint of a limit that no storey can pass."""


def find_targets(question: StudyQuestion, texts: Sequence[str]) -> list[Target]:
    """Return the buildings, or pairs, that limits concern; add what is wrong with these to the question's problems.

    texts : the limits as the study writes them
    """
    scope = find_scope(question.study)
    targets: list[Target] = []
    for number, text in enumerate(texts):
        try:
            limit = parse_limit(text, scope)
        except InputError as error:
            question.add_issues(error.below("limits", number).issues)
            continue
        for target in _find_targets_of_limit(question, limit, number):
            if target in targets:
                message = f"the limit '{limit}' occurs twice"
                question.add_problem(("limits", number), message, "remove one of the two")
            targets.append(target)
    return targets


def _find_targets_of_limit(question: StudyQuestion, limit: Limit, number: int) -> list[Target]:
    """Return the buildings, or pairs, that a limit concerns.

    A wall stands in a row only where a limit on its movement names it.

    number : of the limit in the section
    """
    study = question.study
    path = ("limits", number)
    names = unique_names(study.spec.group)
    if limit.quantity == CONTACT:
        return [Target(limit, left) for left in range(len(names) - 1)]
    places = [place for place in range(len(names)) if not question.is_wall(place)]
    if limit.building is not None:
        places = [limit.building]
    if limit.quantity in DAMAGE_LIMITS:
        return _find_damage_targets(question, limit, number, places)
    if limit.building is not None and question.lacks(limit.building, limit.quantity):
        buildings = [name for place, name in enumerate(names) if not question.is_wall(place)]
        message = f"'{limit}': {names[limit.building]} is a wall, which has no {limit.quantity}"
        question.add_problem(path, message, f"name one of the buildings: {', '.join(buildings)}")
        return []
    if limit.line or limit.quantity in (EDGE_DRIFT, TWIST):
        places = _find_twisting_places(question, limit, number, places)
    storeys = {place: study.building(study.first_point, place).storeys for place in places}
    targets = [Target(limit, place) for place in places if storeys[place] >= limit.level]
    if places and not targets:
        highest = max(storeys.values())
        question.add_problem(path, f"'{limit}': the highest is {highest}", f"write a number from 1 to {highest}")
        return []
    if limit.quantity in _CAN_PASS:
        targets = _keep_able(study, targets, _CAN_PASS[limit.quantity])
        if not targets:
            question.add_problem(path, f"'{limit}': no storey there can pass it", _HINTS[limit.quantity])
    return targets


def _find_damage_targets(
    question: StudyQuestion, limit: Limit, number: int, places: Sequence[int]
) -> list[Target]:  # fmt: skip
    """Return the buildings that are only seen among some, each with the drift at which its damage state begins.

    number : of the limit in the section
    places : of the buildings in the group
    """
    study = question.study
    names = unique_names(study.spec.group)
    seen_by_name = {seen.name: seen for seen in list_seen(study.tree)}
    targets = []
    for place in places:
        seen = seen_by_name.get(study.spec.group[place])
        if seen is None:
            continue
        swept = [
            key for axis in study.axes for key in axis.names if key in (f"{seen.prefix}type", f"{seen.prefix}design")
        ]
        if swept:
            message = f"'{limit}': the drift of {seen.name} is not one number, as '{swept[0]}' is swept"
            question.add_problem(("limits", number), message, f"write a drift, e.g. `drift in {names[place]} > 2 %`")
            return []
        drift = seen.archetype.drift_limits[DAMAGE_LIMITS[limit.quantity]]
        targets.append(Target(replace(limit, quantity="drift", value=drift, of_height=True), place, is_damage=True))
    if not targets:
        known = [name for name, of_type in zip(names, study.spec.group, strict=True) if of_type in seen_by_name]
        hint = f"name one that is: {', '.join(known)}" if known else "write a drift, e.g. `drift > 2 %`"
        question.add_problem(
            ("limits", number), f"'{limit}': damage states are those of buildings with `archetype`", hint
        )
    return targets


def _find_twisting_places(question: StudyQuestion, limit: Limit, number: int, places: Sequence[int]) -> list[int]:
    """Return the places in the group of buildings whose floors may twist, as a limit wants it; add what is wrong with
    it to the question's problems.

    number : of the limit in the section
    places : of all buildings that it concerns
    """
    study = question.study
    names = unique_names(study.spec.group)
    lines = [study.building(study.first_point, place).lines for place in range(len(names))]
    name = f"line_{limit.quantity}" if limit.line else limit.quantity
    problem = find_twist_problem(TableQuantity(name, building=limit.building, line=limit.line), lines, names)
    if problem is not None:
        message, hint = problem
        question.add_problem(("limits", number), f"'{limit}': {message}", hint)
        return []
    needs_plan = limit.line or limit.quantity == TWIST
    return [place for place in places if lines[place] or not needs_plan]


def _keep_able(
    study: Study, targets: Sequence[Target], can_pass: Callable[[Study, Target, Point], bool]
) -> list[Target]:
    """Return the targets that can pass their limit at some point of the sweep."""
    points = list(np.ndindex(*(len(axis.values) for axis in study.axes)))
    return [target for target in targets if any(can_pass(study, target, point) for point in points)]


def _can_collapse(study: Study, target: Target, point: Point) -> bool:
    return bool(np.isfinite(study.building(point, target.building).collapse_drift).any())


def _can_be_struck(study: Study, target: Target, point: Point) -> bool:
    """Return whether a slab strikes columns of the building in any case."""
    yield_shear = study.building(point, target.building).yield_shear
    links = (place for case in study.spec.cases for place in link_places(study.links(point, case) or ()))
    return any(takes_blow(target, place, yield_shear) for place in links)


_CAN_PASS = {COLLAPSE: _can_collapse, SHEAR_DEMAND: _can_be_struck}
"""Limits that not every building can pass."""


def takes_blow(target: Target, place: LinkPlace, yield_shear: np.ndarray) -> bool:
    """Return whether a link strikes columns of the target's building, of its only storey if the limit names one.

    Columns of storeys that cannot yield do not count: nothing says what they can carry.

    yield_shear : of the building's storeys [N], shape (storeys,)
    """
    if not place.is_on_columns:
        return False
    building, storey = place.struck_storey
    is_meant = building == target.building and target.limit.level in (0, storey)
    return bool(is_meant and yield_shear[storey - 1] < np.inf)
