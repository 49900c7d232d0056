"""Decide which buildings of a row twist; simplify what does not.

Floors twist where their lines or their links are eccentric, and pass it on through links. Elsewhere every rotation is
zero at all times: there plans are dropped, and the parts of one link at mirrored places become one link again, so that
such a scene is the one of floors that do not twist, with the same digest."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import replace

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
    """Return the links of a row; where no floor twists, parts of one link at several places as one link."""
    if all(link.whole_law is None for link in links):
        return tuple(links)
    twists = find_twisting(tuple(buildings), tuple(links))
    merged: dict[Link, None] = {}
    for link in links:
        if link.whole_law is not None and not (twists[link.left] or twists[link.left + 1]):
            link = replace(link, law=link.whole_law, whole_law=None, left_y=0.0, right_y=0.0)
        merged[link] = None
    return tuple(merged)


@functools.lru_cache(maxsize=256)  # scenes of a study share buildings and links
def find_twisting(buildings: tuple[Building, ...], links: tuple[Link, ...]) -> tuple[bool, ...]:
    """Return of every building of a row whether its floors twist; links that can exert no force pass nothing on."""
    links = tuple(link for link in links if link.law.can_act)
    twists = [False] * len(buildings)
    for part in find_parts(buildings, links):
        members = range(part.first, part.end)
        has_eccentric = any(is_eccentric(buildings[place]) for place in members)
        own_links = [links[number] for number in part.link_numbers]
        if has_eccentric or find_eccentric_link(buildings, own_links) is not None:
            for place in members:
                twists[place] = buildings[place].plan is not None
    return tuple(twists)


def is_eccentric(building: Building) -> bool:
    """Return whether a building that stands alone needs its plan: its floors twist, or its lines yield one by one."""
    plan = building.plan
    return plan is not None and (plan.twists_always or plan.is_eccentric or not plan.yields_as_one)


def find_eccentric_link(buildings: Sequence[Building], links: Sequence[Link]) -> Link | None:
    """Return the first link that turns the floors that it joins; None where each is at the centres of mass, or is part
    of a link that has a part like it on the other side."""
    places = [find_arms(buildings, link) for link in links]
    for number, (link, arms) in enumerate(zip(links, places, strict=True)):
        if not any(arms):
            continue
        if link.whole_law is None:
            return link
        others = [
            other_arms
            for other, other_arms in zip(links, places, strict=True)
            if other.ends == link.ends and other.whole_law == link.whole_law and other.law == link.law
        ]
        if not any(_are_mirrored(buildings, links[number].left, arms, other_arms) for other_arms in others):
            return link
    return None


def find_arms(buildings: Sequence[Building], link: Link) -> tuple[float, float]:
    """Return the distances of the ends of a link from the centres of mass of floors that may twist [m], 0 of others."""
    has_plans = (buildings[place].plan is not None for place in (link.left, link.left + 1))
    left_y, right_y = (
        y if has_plan else 0.0 for y, has_plan in zip((link.left_y, link.right_y), has_plans, strict=True)
    )
    return left_y, right_y


def _are_mirrored(
    buildings: Sequence[Building], left: int, arms: tuple[float, float], other_arms: tuple[float, float]
) -> bool:
    """Return whether two links of the same pair of buildings mirror each other; `left` : of the pair."""
    plans = (buildings[left].plan, buildings[left + 1].plan)
    tolerance = SAME_PLACE * max(plan.high - plan.low for plan in plans if plan is not None)
    return all(abs(one + other) <= tolerance for one, other in zip(arms, other_arms, strict=True))
