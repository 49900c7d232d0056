"""Find the places at which two neighbours meet, and those at which the links of a case end."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.model.building import Building
from pounding_cli.model.links import BASE, Link
from pounding_cli.model.meetings import Strike, deflection_of_columns, find_end_level, find_meetings, reach_of_slabs
from pounding_cli.model.twist import turns_at
from pounding_cli.model.wall import Wall
from pounding_cli.numbers import pluralize
from pounding_cli.study.schema.floor_places import FloorPair, FloorPlace
from pounding_cli.study.schema.links import NO_LINK, LinkSpec, list_links
from pounding_cli.study.schema.street_places import StreetSide
from pounding_cli.study.text.issues import Issues

# Where neighbours meet


class LinkEnds(NamedTuple):
    """Places of both ends of a link; fields as of `Link`.

    flexibility : deflection per level force of the columns that it ends on [m/N]
    """

    left_floor: int
    right_floor: int
    left_at: float = 1.0
    right_at: float = 1.0
    cosine: float = 1.0
    columns: float = 0.0
    flexibility: float = 0.0

    @property
    def places(self) -> tuple[int, int, float, float]:
        """Floors and heights of both ends, whatever the angle of the link."""
        return self[:4]


class Side(NamedTuple):
    """The building on one side of a link, as far as the link must know it.

    levels : elevations of its base and its floors [m]
    base_moves : whether a link may end at its base
    is_wall : whether it is a wall, which has no floors of its own
    columns : part of a storey's stiffness and yield shear in the columns that links may end on [-], 0 where it has
        none; None: not known
    column_stiffnesses : of these columns in every storey, 12 E I / L^3 [N/m]; empty where `columns` is None
    street : its plan along the street; None where its floors do not twist
    """

    name: str
    levels: tuple[float, ...]
    base_moves: bool
    is_wall: bool
    columns: float | None
    column_stiffnesses: tuple[float, ...]
    street: StreetSide | None = None

    @classmethod
    def of(cls, building: Building) -> Side:
        """Return the side of a building."""
        levels = (0.0, *building.elevation.tolist())
        stiffnesses: tuple[float, ...] = ()
        if building.columns is not None:
            stiffnesses = tuple((building.columns * building.stiffness).tolist())
        is_wall = isinstance(building, Wall)
        moves = building.has_floor(0)
        return cls(building.name, levels, moves, is_wall, building.columns, stiffnesses, StreetSide.of(building))

    @property
    def storeys(self) -> int:
        """Number of storeys."""
        return len(self.levels) - 1

    def level(self, floor: int, at: float) -> float:
        """Return the elevation of a link's end [m]; arguments as of `Link`."""
        return find_end_level(self.levels, floor, at)

    def deflection(self, floor: int, at: float) -> float:
        """Return the deflection per force of the columns that a link ends on [m/N]; arguments as of `Link`."""
        return deflection_of_columns(at) / self.column_stiffnesses[floor - 1]


@dataclass(frozen=True)
class Meeting:
    """The floors at which two neighbours meet, and blows on columns.

    left, right : the two sides
    floors : of both, from 1, that meet; 0 is a base
    strikes : where slabs strike columns of which the share of the storey is known
    reach : slabs no further apart than this in height meet [m]
    """

    left: Side
    right: Side
    floors: tuple[tuple[int, int], ...]
    strikes: tuple[LinkEnds, ...]
    reach: float

    @classmethod
    def of(cls, left: Building, right: Building) -> Meeting:
        """Return where two neighbours meet."""
        floors, strikes = find_meetings(left, right)
        sides = (Side.of(left), Side.of(right))
        known = [strike for strike in strikes if sides[strike.side].columns]  # neither unknown nor none
        ends = tuple(_find_ends_of_strike(sides[strike.side], strike) for strike in known)
        return cls(*sides, floors, ends, reach_of_slabs(left.slab, right.slab))

    def find_rise(self, link: Link | LinkEnds) -> float:
        """Return how much higher the right end of a link is than the left one [m]; 0 beside a wall."""
        if self.left.is_wall or self.right.is_wall:
            return 0.0
        left_level = self.left.level(link.left_floor, link.left_at)
        return self.right.level(link.right_floor, link.right_at) - left_level

    def find_street_place(self, link: Link) -> float:
        """Return the place of the left end of a link along the street [m], of its right end where the left building has
        no plan; NaN where neither has one, or the link is at a base."""
        if not self.has_turning_end(link):
            return math.nan
        if self.left.street is not None:
            return self.left.street.centre + link.left_arm
        if self.right.street is not None:
            return self.right.street.centre + link.right_arm
        return math.nan

    def has_turning_end(self, link: Link) -> bool:
        """Return whether an end of a link is at a floor that may turn."""
        left_turns = self.left.street is not None and turns_at(link.left_floor)
        right_turns = self.right.street is not None and turns_at(link.right_floor)
        return left_turns or right_turns

    def has_facing_ends(self, link: Link | LinkEnds) -> bool:
        """Return whether the ends of a link are as high as each other, within the slabs of both buildings."""
        return abs(self.find_rise(link)) <= self.reach


def _find_ends_of_strike(struck: Side, strike: Strike) -> LinkEnds:
    """Return the ends of the link between a slab and the columns that it strikes."""
    assert struck.columns is not None  # of these the share is known
    places = (strike.left_floor, strike.right_floor, strike.left_at, strike.right_at)
    flexibility = struck.deflection(strike.storey, strike.height)
    return LinkEnds(*places, columns=struck.columns, flexibility=flexibility)


# Where the links of a case stand

Floors = tuple[tuple[tuple[LinkEnds, ...], ...], ...]
"""Where links stand: of every pair of neighbours, of every link of the case."""


def find_floors(name: str, case: Any, meetings: Sequence[Meeting]) -> Floors:
    """Return where the links of a case stand between floors; those between slabs and columns that meet are not among
    them.

    Raises
    ------
    InputError : a link names a floor that does not meet one of the neighbour, or ends where it cannot
    """
    issues = Issues()
    links = list_links(name, case)
    floors: list[tuple[tuple[LinkEnds, ...], ...]] = []
    for number, meeting in enumerate(meetings, 1):
        members = [(link, path) for link, path in links if link.pair in (None, number)]
        if (meeting.left.is_wall or meeting.right.is_wall) and not meeting.floors:
            issues.add_written([issue for link, path in members for issue in _find_link_nowhere(link, path, meeting)])
            floors.append(((),) * len(links))
            continue
        listed = {}
        for link, path in members:
            pair_hint = ", or add `pair:` where it stands between some neighbours only"
            is_of_all = link.pair is None and len(meetings) > 1
            listed[path] = _find_listed_ends(link, path, meeting, issues, pair_hint if is_of_all else "")
        taken = {ends.places for of_link in listed.values() for ends in of_link}
        chosen = {path: _choose_ends(link, meeting, listed[path], taken) for link, path in members}
        floors.append(tuple(chosen.get(path, ()) for _, path in links))
    issues.check()
    return tuple(floors)


def _find_link_nowhere(link: LinkSpec, path: KeyPath, meeting: Meeting) -> list[Issue]:
    """Return the issue of a link that names a pair of a building and a wall that it does not reach."""
    if link.pair is None or link.link == NO_LINK:
        return []
    message = f"{meeting.left.name} and {meeting.right.name} meet at no floor: the link stands nowhere"
    return [Issue((*path, "pair"), message, "leave the link out, or make the wall as high as a floor")]


def find_linked_pairs(name: str, case: Any, pairs: int) -> set[int]:
    """Return the pairs of neighbours, from 0, of which a link of a case names both of its ends.

    pairs : number of all pairs
    """
    linked: set[int] = set()
    for link, _ in list_links(name, case):
        floors = link.floors if isinstance(link.floors, tuple) else ()
        if any(isinstance(floor, FloorPair) for floor in floors):
            linked |= {link.pair - 1} if link.pair is not None else {*range(pairs)}
    return linked


def _find_listed_ends(
    link: LinkSpec, path: KeyPath, meeting: Meeting, issues: Issues, pair_hint: str = ""
) -> tuple[LinkEnds, ...]:
    """Return where a link stands that lists its floors; of `except` nothing, but unknown floors are noted.

    pair_hint : what else to write where the neighbours lack a floor
    """
    is_list = isinstance(link.floors, tuple)
    right_floors = dict(meeting.floors)
    found: dict[LinkEnds, None] = {}
    for place, floor in enumerate(_listed_floors(link)):
        at = (*path, "floors", *(() if is_list else ("except",)), place)
        try:
            if isinstance(floor, FloorPair):
                ends = build_ends(link, floor, meeting, at)
                if any(_are_alike(ends, other) for other in found):
                    hint = "remove it; a stiffer link has a larger `stiffness`"
                    raise InputError([Issue(at, "the link stands there already", hint)])
                found[ends] = None
                continue
            if floor not in right_floors:
                message = f"{meeting.left.name} and {meeting.right.name} have no common floor {floor or BASE}"
                raise InputError([Issue(at, message, _hint_to_floors(floor, meeting))])
        except InputError as refused:
            issues.add_written(replace(issue, hint=issue.hint + pair_hint) for issue in refused.issues)
            continue
        if is_list:
            found[_incline(link, LinkEnds(floor, right_floors[floor]), meeting)] = None
    return tuple(found)


def _are_alike(ends: LinkEnds, other: LinkEnds) -> bool:
    """Return whether links end at the same places, within rounding."""
    is_near = math.isclose(ends.left_at, other.left_at) and math.isclose(ends.right_at, other.right_at)
    return is_near and ends[:2] == other[:2]


def _hint_to_floors(floor: int, meeting: Meeting) -> str:
    """Return what to write for a floor that meets none of the neighbour."""
    common = ", ".join(str(each or BASE) for each, _ in meeting.floors)
    is_there = floor <= meeting.left.storeys and (floor > 0 or meeting.left.base_moves)
    left_floor = floor if is_there else min(max(floor, 1), meeting.left.storeys)
    both_ends = f"both ends, e.g. `[[{left_floor or BASE}, {min(max(floor, 1), meeting.right.storeys)}]]`"
    if not common:
        return f"write {both_ends}"
    return f"write floors among {common}, or {both_ends}" if is_there else f"write floors among {common}"


def _listed_floors(link: LinkSpec) -> tuple[Any, ...]:
    """Return the floors that a link names, or leaves out by `except`."""
    if isinstance(link.floors, tuple):
        return link.floors
    return getattr(link.floors, "floors", ())


def _choose_ends(
    link: LinkSpec, meeting: Meeting, listed: tuple[LinkEnds, ...], taken: Collection[tuple[int, int, float, float]]
) -> tuple[LinkEnds, ...]:
    """Return where a link of a pair stands.

    listed : the ends that it lists itself
    taken : places of all ends that links of the pair list
    """
    if link.at is not None:
        return ()
    if isinstance(link.floors, tuple):
        return listed
    ends = [_incline(link, LinkEnds(*both), meeting) for both in meeting.floors]
    if link.floors == "rest":
        return tuple(each for each in ends if each.places not in taken)
    left_out = _listed_floors(link)
    return tuple(each for each in ends if each.left_floor not in left_out)


def _incline(link: LinkSpec, ends: LinkEnds, meeting: Meeting) -> LinkEnds:
    """Return the ends of a link with the cosine of its angle, from their heights and the distance along the row."""
    if link.distance is None:
        return ends
    return ends._replace(cosine=link.distance / math.hypot(link.distance, meeting.find_rise(ends)))


def build_ends(link: LinkSpec, pair: FloorPair, meeting: Meeting, path: KeyPath) -> LinkEnds:
    """Return where both ends of a link stand.  Raises InputError."""
    if meeting.left.is_wall or meeting.right.is_wall:
        hint = f"write the floor alone: `floors: [{(pair.right if meeting.left.is_wall else pair.left).floor}]`"
        raise InputError([Issue(path, "a wall has no floors of its own", hint)])
    if not pair.left.is_at_floor and not pair.right.is_at_floor:
        hint = "let one of them be at a floor, e.g. `[4, 2 + 1.2 m]`"
        raise InputError([Issue(path, "both ends of the link stand between floors", hint)])
    left_floor, left_at = _find_end(pair.left, meeting.left, path)
    right_floor, right_at = _find_end(pair.right, meeting.right, path)
    level_ends = _round_to_strike(LinkEnds(left_floor, right_floor, left_at, right_at), meeting)
    ends = _incline(link, level_ends, meeting)
    if not pair.left.is_at_floor:
        return _end_on_columns(ends, meeting.left, ends.left_floor, ends.left_at, path)
    if not pair.right.is_at_floor:
        return _end_on_columns(ends, meeting.right, ends.right_floor, ends.right_at, path)
    return ends


def _round_to_strike(ends: LinkEnds, meeting: Meeting) -> LinkEnds:
    """Return the ends of a link; where a slab strikes there, with the very heights of that blow.

    Heights from what the study writes differ from these by rounding, and one place must not count as two.
    """
    for strike in meeting.strikes:
        if _are_alike(ends, strike):
            return ends._replace(left_at=strike.left_at, right_at=strike.right_at)
    return ends


def _end_on_columns(ends: LinkEnds, side: Side, storey: int, at: float, path: KeyPath) -> LinkEnds:
    """Return the ends of a link with the columns on which one of them stands.

    side, storey, at : of these columns, with the height of the end in the storey [-]

    Raises
    ------
    InputError : the building has no columns, or their share of the storey is not known
    """
    if side.columns == 0.0:
        message = f"the link ends between floors of {side.name}, which has no columns (`columns: none`)"
        hint = f"let it end at a floor, e.g. {storey}, or write what part of the storey its columns have"
        raise InputError([Issue(path, message, hint)])
    if side.columns is None:
        message = f"the link ends on columns of {side.name} in storey {storey}, of which nothing is known"
        hint = f"write `columns:` in {side.name}, their part of the storey's stiffness, e.g. `columns: 20 %`"
        raise InputError([Issue(path, message, hint)])
    return ends._replace(columns=side.columns, flexibility=side.deflection(storey, at))


def _find_end(place: FloorPlace, side: Side, path: KeyPath) -> tuple[int, float]:
    """Return the floor at or above an end of a link, and where in the storey below it the end stands, as of `Link`.

    Raises InputError: the building has no such place.
    """
    has = f"{side.name} has {pluralize(side.storeys, 'floor')}"
    if place.is_at_floor:
        if place.floor > side.storeys or (place.floor == 0 and not side.base_moves):
            message = f"{has}, not {place.floor}" if place.floor else f"the base of {side.name} does not move"
            raise InputError([Issue(path, message, f"write a floor from 1 to {side.storeys}")])
        return place.floor, 1.0
    if place.floor >= side.storeys:
        raise InputError([Issue(path, f"{has}: '{place}' is above its roof", "write a place below the roof")])
    height = side.levels[place.floor + 1] - side.levels[place.floor]
    at = place.share or place.above / height
    if not at < 1.0:
        message = f"'{place}' is not below floor {place.floor + 1} of {side.name}: that storey is {height:g} m high"
        raise InputError([Issue(path, message, f"write {place.floor + 1} for the floor, or a place below it")])
    return place.floor + 1, at
