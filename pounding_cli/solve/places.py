"""Where a scene's degrees of freedom and points stand in the row of slots (`kernels.layout`), and what moves points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from pounding_cli.kernels.layout import Points, Shears, Springs
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.solve.blank import LANES

Terms = list[tuple[int, float]]
"""(slot of a degree of freedom, weight), ..."""

Struck = tuple[int, int, float]
"""Where a link stands between floors: building, floor, and height in the storey below it (`Link`)."""


@dataclass
class Places:
    """By building: its first slot (and, one more, the number of slots), the slots of its floors, that of a base that
    sways and that of its rocking (-1: none). `points`: terms by slot; `struck`: the slots of points that links need;
    `shears`: by link those of the shears below and above its blow (`column_shears`)."""

    begins: list[int] = field(default_factory=lambda: [0])
    floors: list[slice] = field(default_factory=list)
    bases: list[int] = field(default_factory=list)
    rocks: list[int] = field(default_factory=list)
    points: dict[int, Terms] = field(default_factory=dict)
    struck: dict[Struck, int] = field(default_factory=dict)
    shears: dict[int, tuple[int, int]] = field(default_factory=dict)

    def floor(self, building: int, floor: int) -> int:
        """The slot of a floor, from 1; of floor 0 that of a base that sways, -1 on the ground."""
        span = self.floors[building]
        return span.start + (floor - 1) * span.step if floor > 0 else self.bases[building]


def struck_between_floors(links: Sequence[Link]) -> tuple[Struck, ...]:
    """The places between floors at which links stand."""
    ends = [end for link in links if link.left_at != 1.0 or link.right_at != 1.0 for end in link.ends]
    return tuple(dict.fromkeys([end for end in ends if end[2] != 1.0]))


@dataclass(frozen=True)
class Columns:
    """Columns whose shear is asked for because link number `link` strikes them: building, storey from 1, whether they
    are those on the building's left side, height of the blow in the storey [-], part of the storey that they have
    [-]."""

    link: int
    building: int
    storey: int
    on_left: bool
    at: float
    share: float


def struck_columns(links: Sequence[Link]) -> tuple[Columns, ...]:
    """The columns that links strike, where their share of the storey is given."""
    found = []
    for number, link in enumerate(links):
        if link.columns > 0.0:
            (building, storey, at), on_left = (link.ends[1], True) if link.left_at == 1.0 else (link.ends[0], False)
            found.append(Columns(number, building, storey, on_left, at, link.columns))
    return tuple(found)


def places_of(buildings: Sequence[Building], struck: Sequence[Struck], columns: Sequence[Columns] = ()) -> Places:
    """Slots for all buildings, rocking and base of each before its floors, for points that links need, and for the
    shears of columns."""
    places = Places()
    for b, building in enumerate(buildings):
        foundation = building.foundation
        sways, rocks = foundation is not None and foundation.sways, foundation is not None and foundation.rocks
        place = places.begins[-1]
        places.rocks.append(place if rocks else -1)
        places.bases.append(place + rocks if sways else -1)
        place += rocks + sways
        step = 2 if rocks else 1
        places.floors.append(slice(place + step - 1, place + step * building.storeys, step))
        place += step * building.storeys
        if rocks:
            for floor in range(1, building.storeys + 1):
                places.points[places.floor(b, floor) - 1] = _lower_end(places, building, b, floor)
        for end in struck:
            if end[0] == b:
                places.points[place] = _between_floors(places, building, *end)
                places.struck[end] = place
                place += 1
        for each in columns:
            if each.building == b:
                places.shears[each.link] = place, place + 1
                place += 2
        places.begins.append(place)
    return places


def _lower_end(places: Places, building: Building, b: int, floor: int) -> Terms:
    """Of the lower end of a storey that leans with its base: what the floor below does, and what the lean adds."""
    below = places.floor(b, floor - 1)
    lean = float(building.height[floor - 1] / building.elevation[-1])
    return ([(below, 1.0)] if below >= 0 else []) + [(places.rocks[b], lean)]


def _between_floors(places: Places, building: Building, b: int, floor: int, at: float) -> Terms:
    """Of a place on the columns below a floor, `at` of their height: clamped in both floors, which lean with the
    base."""
    share = at * at * (3.0 - 2.0 * at)
    terms = [(places.floor(b, floor), share)]
    below = places.floor(b, floor - 1)
    if below >= 0:
        terms.append((below, 1.0 - share))
    if places.rocks[b] >= 0:
        lean = float(building.height[floor - 1] / building.elevation[-1])
        terms.append((places.rocks[b], lean * (at - share)))
    return terms


def springs_of(buildings: Sequence[Building], places: Places) -> Springs:
    """Dashpots of mass-proportional damping between the floors of founded buildings and their base, which sways or
    rocks; P-Delta of storeys that lean with their base."""
    given: list[tuple[float, float, Terms]] = []
    for b, building in enumerate(buildings):
        if building.foundation is None:
            continue
        for j in range(building.storeys):
            floor, below = places.floor(b, j + 1), places.floor(b, j)
            if building.alpha > 0.0:
                terms = [(floor, 1.0)]
                if places.bases[b] >= 0:
                    terms.append((places.bases[b], -1.0))
                if places.rocks[b] >= 0:
                    terms.append((places.rocks[b], -float(building.elevation[j] / building.elevation[-1])))
                given.append((0.0, building.alpha * float(building.mass[j]), terms))
            if building.gravity_load is not None and places.rocks[b] >= 0:
                lean = [(floor, 1.0), (below, -1.0)] if below >= 0 else [(floor, 1.0)]
                given.append((-float(building.gravity_load[j] / building.height[j]), 0.0, lean))
    number, size = len(given), _padded(len(given))
    stiffness, dashpot = np.zeros((2, size))
    stiffness[:number], dashpot[:number] = [k for k, _, _ in given], [c for _, c, _ in given]
    freedom, weight = _in_lanes([terms for _, _, terms in given])
    return Springs(number, size, len(freedom), int(np.any(stiffness)), stiffness, dashpot, freedom, weight)


def points_of(places: Places, mass: np.ndarray) -> Points:
    """The points; `mass` is that of the slots [kg]. A force on a point moves 1 / sum(weight^2 / mass)."""
    terms = list(places.points.values())
    number, size = len(terms), _padded(len(terms))
    freedom, weight = _in_lanes(terms)
    slot, moved, handed = np.zeros(size, np.int64), np.zeros(size), np.zeros(weight.shape)
    slot[:number] = list(places.points)
    if number:
        compliance = weight[:, :number] / mass[freedom[:, :number]]
        moved[:number] = 1.0 / np.sum(weight[:, :number] * compliance, axis=0)
        handed[:, :number] = compliance * moved[:number]
    return Points(number, size, len(freedom), slot, moved, freedom, weight, handed, shears_of(places, ()))


def shears_of(places: Places, columns: Sequence[Columns]) -> Shears:
    """The shears below and above every blow: what the columns have of the storey's shear, and of the forces of all
    blows on them the reaction of a clamped beam at that end; between two blows, that of both sides."""
    slots, storeys, shares, first, links, weights = [], [], [], [0], [], []
    for own in columns:
        for above in (False, True):
            slots.append(places.shears[own.link][above])
            storeys.append(places.floor(own.building, own.storey))
            shares.append(own.share)
            for other in columns:
                if (other.building, other.storey, other.on_left) != (own.building, own.storey, own.on_left):
                    continue
                to_above = other.at * other.at * (3.0 - 2.0 * other.at)
                higher = other.at > own.at if above else other.at >= own.at
                weight = 1.0 - to_above if higher else -to_above
                links.append(other.link)
                weights.append(weight if own.on_left else -weight)
            first.append(len(links))
    whole = (np.array(each, np.int64) for each in (slots, storeys, first, links))
    slot, storey, begin, link = whole
    return Shears(len(slots), slot, storey, np.array(shares), begin, link, np.array(weights))


def listed(table: Points | Springs) -> list[Terms]:
    """The terms of every point or spring."""
    pairs = zip(table.freedom.T.tolist(), table.weight.T.tolist(), strict=True)
    each = [[(slot, part) for slot, part in zip(*pair, strict=True) if part != 0.0] for pair in pairs]
    return each[: table.number]


def _padded(count: int) -> int:
    return -(-count // LANES) * LANES


def _in_lanes(terms: Sequence[Terms]) -> tuple[np.ndarray, np.ndarray]:
    """(freedoms, weights) by term and by owner, shape (most terms, owners with padding)."""
    most, size = max(map(len, terms), default=0), _padded(len(terms))
    freedom, weight = np.zeros((most, size), np.int64), np.zeros((most, size))
    for owner, own in enumerate(terms):
        for term, pair in enumerate(own):
            freedom[term, owner], weight[term, owner] = pair
    return freedom, weight
