"""Decide which buildings of a row twist; simplify what does not.

Floors twist where their lines or their links are eccentric, and pass it on through links. Elsewhere every rotation is
zero at all times: there plans are dropped, and the parts of one link at mirrored places become one link again, so that
such a scene is the one of floors that do not twist, with the same digest."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.parts import find_parts

SAME_PLACE = 1e-12
"""Distance over the width of a floor [-] below which two places across the row are one."""


def drop_plans(buildings: Sequence[Building], links: Sequence[Link]) -> tuple[Building, ...]:
    """Return the buildings of a row, without plans where no floor twists."""
    if all(building.plan is None for building in buildings):
        return tuple(buildings)
    twists = find_twisting(tuple(buildings), tuple(links))
    return tuple(
        building if is_twisting or building.plan is None else without_plan(building)
        for building, is_twisting in zip(buildings, twists, strict=True)
    )


@functools.lru_cache(maxsize=1024)  # scenes of a study share buildings
def without_plan(building: Building) -> Building:
    """Return a building whose floors do not twist."""
    return replace(building, plan=None)


def merge_links(buildings: Sequence[Building], links: Sequence[Link]) -> tuple[Link, ...]:
    """Return the links of a row; where neither end turns, parts of one link at several places as one link."""
    if all(link.whole_law is None for link in links):
        return tuple(links)
    twists = find_twisting(tuple(buildings), tuple(links))
    merged: dict[Link, None] = {}
    for link in links:
        left_turns = twists[link.left] and turns_at(link.left_floor)
        right_turns = twists[link.left + 1] and turns_at(link.right_floor)
        if link.whole_law is not None and not left_turns and not right_turns:
            link = replace(link, law=link.whole_law, whole_law=None, left_arm=0.0, right_arm=0.0)
        merged[link] = None
    return tuple(merged)


@functools.lru_cache(maxsize=256)  # scenes of a study share buildings and links
def find_twisting(buildings: tuple[Building, ...], links: tuple[Link, ...]) -> tuple[bool, ...]:
    """Return of every building of a row whether its floors twist; links that can exert no force pass nothing on."""
    links = tuple(link for link in links if link.law.can_act)
    twists = [False] * len(buildings)
    for part in find_parts(buildings, links):
        members = range(part.first, part.end)
        has_eccentric = any(needs_plan(buildings[place]) for place in members)
        own_links = [links[number] for number in part.link_numbers]
        if has_eccentric or find_eccentric_link(buildings, own_links) is not None:
            for place in members:
                twists[place] = buildings[place].plan is not None
    return tuple(twists)


def find_twist_reasons(buildings: Sequence[Building], links: Sequence[Link]) -> tuple[str, ...]:
    """Return of every building of a row why its floors twist, in words; "" where they do not."""
    twists = find_twisting(tuple(buildings), tuple(links))
    reasons = []
    for place, building in enumerate(buildings):
        if not twists[place]:
            reasons.append("")
            continue
        own_reason = describe_eccentricity(building)
        reasons.append(own_reason or _describe_links_that_turn(buildings, links, place))
    return tuple(reasons)


def describe_eccentricity(building: Building) -> str:
    """Return why a building that stands alone needs its plan, in words; "" where it does not."""
    plan = building.plan
    if plan is None or not needs_plan(building):
        return ""
    width = plan.high - plan.low
    largest = float(np.abs(plan.eccentricity).max())
    if plan.is_eccentric and largest > SAME_PLACE * width:
        up_to = "by" if np.ptp(plan.eccentricity) <= SAME_PLACE * width else "by up to"
        share = f" ({100 * largest / width:.3g} % of the width)" if width > 0.0 else ""
        return f"its lines are eccentric {up_to} {largest:.3g} m{share}"
    if plan.is_eccentric:
        return "its lines are not alike on both sides of its centre of mass"
    if not plan.yields_as_one:
        return "its lines yield at different drifts"
    return "`twist: always` lets it turn, though nothing is eccentric"


def _describe_links_that_turn(buildings: Sequence[Building], links: Sequence[Link], place: int) -> str:
    """Return why links turn a building that is not eccentric itself, in words.

    place : of the building in the row
    """
    off_centre = []
    turning = []
    for pair, other in ((place - 1, place - 1), (place, place + 1)):
        joined = [link for link in links if link.left == pair]
        if not joined:
            continue
        end = 1 if pair < place else 0  # of the link, at this building
        arms = [_find_turning_arms(buildings, link)[end] for link in joined]
        name = buildings[other].name
        mean = float(np.average(arms, weights=[link.share for link in joined]))
        if abs(mean) > 1e-9 * max(map(abs, arms), default=0.0):
            off_centre.append(f"its links to {name} act {abs(mean):.3g} m off its centre of mass")
        elif any(arms):
            turning.append(name)
    if off_centre:
        return " and ".join(off_centre)
    if not turning:
        return "its neighbours twist"  # links at its centre alone, which pass no moment on
    they = "its neighbour" if len(turning) == 1 else "its neighbours"
    return f"{they} {' and '.join(turning)} may turn it at both ends of the edge that they share"


def needs_plan(building: Building) -> bool:
    """Return whether a building that stands alone needs its plan: its floors twist, or its lines yield one by one."""
    plan = building.plan
    return plan is not None and (plan.twists_always or plan.is_eccentric or not plan.yields_as_one)


def find_eccentric_link(buildings: Sequence[Building], links: Sequence[Link]) -> Link | None:
    """Return the first link that turns the floors that it joins; None where each is at the centres of mass, or is part
    of a link that has a part like it on the other side."""
    arms_by_link = [_find_turning_arms(buildings, link) for link in links]
    for link, arms in zip(links, arms_by_link, strict=True):
        if not any(arms):
            continue
        if link.whole_law is None:
            return link
        others = [
            other_arms
            for other, other_arms in zip(links, arms_by_link, strict=True)
            if other.ends == link.ends and other.whole_law == link.whole_law and other.law == link.law
        ]
        if not any(_are_mirrored(buildings, link.left, arms, other_arms) for other_arms in others):
            return link
    return None


def _find_turning_arms(buildings: Sequence[Building], link: Link) -> tuple[float, float]:
    """Return the arms of both ends of a link at floors that may twist [m], 0 at others."""
    may_turn_left = buildings[link.left].plan is not None and turns_at(link.left_floor)
    may_turn_right = buildings[link.left + 1].plan is not None and turns_at(link.right_floor)
    return (link.left_arm if may_turn_left else 0.0, link.right_arm if may_turn_right else 0.0)


def turns_at(floor: int) -> bool:
    """Return whether a floor of a building that twists turns: a base sways and rocks, but does not turn."""
    return floor > 0


def _are_mirrored(
    buildings: Sequence[Building], left: int, arms: tuple[float, float], other_arms: tuple[float, float]
) -> bool:
    """Return whether two links of the same pair of buildings mirror each other; `left` : of the pair."""
    plans = (buildings[left].plan, buildings[left + 1].plan)
    tolerance = SAME_PLACE * max(plan.high - plan.low for plan in plans if plan is not None)
    return all(abs(one + other) <= tolerance for one, other in zip(arms, other_arms, strict=True))
