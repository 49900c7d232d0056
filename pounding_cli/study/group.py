"""The buildings of a study in their places, and where neighbours meet."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

from pounding_cli.model.building import Building
from pounding_cli.model.links import BASE, Link
from pounding_cli.model.meetings import Strike, deflection_of_columns, find_meetings, reach_of_slabs
from pounding_cli.model.wall import Wall
from pounding_cli.numbers import join_limited, pluralize
from pounding_cli.study.file import nearest
from pounding_cli.study.issues import Issue, IssuesFound
from pounding_cli.study.quantity import StoreyMultiple

MAX_IN_GROUP = 20

COLUMNS = (
    "or write `columns:`, what part of a storey's stiffness and yield shear the columns have that the other's slab "
    "strikes, e.g. `columns: 20 %`"
)
"""What to write where slabs strike columns."""


class LinkEnds(NamedTuple):
    """Where both ends of a link stand; fields as of `Link`.

    flexibility : deflection per level force of the columns that it ends on [m/N]
    """

    left_floor: int
    right_floor: int
    left_at: float = 1.0
    right_at: float = 1.0
    cosine: float = 1.0
    columns: float = 0.0
    flexibility: float = 0.0


class Side(NamedTuple):
    """What a link must know of the building on one of its sides.

    levels : elevations of its base and its floors [m]
    base_moves : whether a link may end at its base
    is_wall : whether it is a wall, which has no floors of its own
    columns : part of a storey's stiffness and yield shear in the columns that links may end on [-], 0 where it has
        none; None: not known
    column_stiffnesses : of these columns in every storey, 12 E I / L^3 [N/m]; empty where `columns` is None
    """

    name: str
    levels: tuple[float, ...]
    base_moves: bool
    is_wall: bool
    columns: float | None
    column_stiffnesses: tuple[float, ...]

    @classmethod
    def of(cls, building: Building) -> Side:
        """Return the side of a building."""
        levels = (0.0, *building.elevation.tolist())
        stiffnesses: tuple[float, ...] = ()
        if building.columns is not None:
            stiffnesses = tuple((building.columns * building.stiffness).tolist())
        is_wall = isinstance(building, Wall)
        return cls(building.name, levels, building.has_floor(0), is_wall, building.columns, stiffnesses)

    @property
    def storeys(self) -> int:
        """Number of storeys."""
        return len(self.levels) - 1

    def level(self, floor: int, at: float) -> float:
        """Return the elevation of a link's end [m]; arguments as of `Link`."""
        if floor == 0:
            return self.levels[0]
        return at * self.levels[floor] + (1.0 - at) * self.levels[floor - 1]

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

    def has_facing_ends(self, link: Link | LinkEnds) -> bool:
        """Return whether the ends of a link are as high as each other, within the slabs of both buildings."""
        return abs(self.find_rise(link)) <= self.reach


def _find_ends_of_strike(struck: Side, strike: Strike) -> LinkEnds:
    """Return the ends of the link between a slab and the columns that it strikes."""
    assert struck.columns is not None  # of these the share is known
    places = (strike.left_floor, strike.right_floor, strike.left_at, strike.right_at)
    flexibility = struck.deflection(strike.storey, strike.height)
    return LinkEnds(*places, columns=struck.columns, flexibility=flexibility)


@dataclass(frozen=True, eq=False)
class Group:
    """The buildings in their places.

    buildings : left to right, by the names of their places
    types : building types by name
    """

    buildings: tuple[Building, ...]
    types: Mapping[str, Building]

    @cached_property
    def meetings(self) -> tuple[Meeting, ...]:
        """The meeting of every two neighbours, left to right."""
        return tuple(Meeting.of(*pair) for pair in pairwise(self.buildings))

    def stiffness(self, given: float | StoreyMultiple) -> float:
        """Return a stiffness, or a multiple of that of a storey, in N/m.  Raises KeyError: no such building."""
        if not isinstance(given, StoreyMultiple):
            return given
        named = self.buildings if given.building is None else (self.types[given.building],)
        frames = [building for building in named if not isinstance(building, Wall)] or named
        storeys = [building.stiffness.tolist() for building in frames]
        if given.which == "stiffest":
            return given.factor * max(map(max, storeys))
        return given.factor * max(sum(stiffness) / len(stiffness) for stiffness in storeys)


def build_group(names: Sequence[str], types: Mapping[str, Building]) -> Group:
    """Return the buildings in their places; a wall without a height of its own is as high as they are.

    names : of the types, left to right
    """
    placed = [
        types[name] if types[name].name == label else replace(types[name], name=label)
        for name, label in zip(names, unique_names(names), strict=True)
    ]
    roof = max((float(each.elevation[-1]) for each in placed if not isinstance(each, Wall)), default=0.0)
    placed = [each.raise_to(roof) if isinstance(each, Wall) else each for each in placed]
    return Group(tuple(placed), types)


def unique_names(names: Sequence[str]) -> tuple[str, ...]:
    """Return names by place: a type that stands more than once is told apart by a number (soft-1, soft-2)."""
    return tuple(
        f"{name}-{list(names[: place + 1]).count(name)}" if list(names).count(name) > 1 else name
        for place, name in enumerate(names)
    )


def check_group_names(names: Sequence[str], defined: Sequence[str]) -> Sequence[str]:
    """Return the names of a group.  Raises IssuesFound: too few or many, or one that is not defined."""
    labels = unique_names(names)
    if not 2 <= len(names) <= MAX_IN_GROUP:
        example = ", ".join((*defined, *defined)[:2])
        hint = f"name 2 to {MAX_IN_GROUP}, e.g. `group: [{example}]`; each alone is computed anyway"
        message = f"the group has {pluralize(len(names), 'building')}: pounding takes two"
        raise IssuesFound([Issue(("group",), message, hint)])
    issues = []
    for place, (name, label) in enumerate(zip(names, labels, strict=True)):
        if name not in defined:
            issues.append(Issue(("group", place), f"no building '{name}' is defined", nearest(name, defined)))
        if labels.index(label) != place:
            message = f"two places of the group are called '{label}'"
            issues.append(Issue(("group", place), message, "give the building another name"))
    if issues:
        raise IssuesFound(issues)
    return names


def check_meetings(group: Group, linked_pairs: Collection[int] = ()) -> Group:
    """Return the group unchanged.

    linked_pairs : pairs from 0 whose floors a link of a case names, wherever they are

    Raises
    ------
    IssuesFound : two neighbours cannot strike each other, and no link joins them
    """
    issues = []
    for place, meeting in enumerate(group.meetings):
        if not meeting.floors and not meeting.strikes and place not in linked_pairs:
            pair = group.buildings[place : place + 2]
            levels = (join_limited(f"{elevation:g}" for elevation in each.elevation) for each in pair)
            names = f"{meeting.left.name} and {meeting.right.name}"
            message = f"{names} have no floor at one elevation: {' against '.join(levels)} m"
            hint = f"let the storey heights agree somewhere; {COLUMNS}; or name both ends of links, `floors: [[2, 3]]`"
            issues.append(Issue(("group", place + 1), message, hint))
    if issues:
        raise IssuesFound(issues)
    return group


def find_ignored_blows(group: Group) -> list[Issue]:
    """Return a warning for every pair of neighbours whose slabs strike columns of which nothing is known."""
    issues = []
    for place, pair in enumerate(pairwise(group.buildings)):
        floors, strikes = find_meetings(*pair)
        unknown = [strike for strike in strikes if pair[strike.side].columns is None]
        if unknown:
            slabs = join_limited(f"floor {strike.slab} of {pair[1 - strike.side].name}" for strike in unknown)
            struck = " and ".join(sorted({pair[strike.side].name for strike in unknown}))
            where = f"meet at {pluralize(len(floors), 'floor')} only" if floors else "meet at no floor"
            message = f"{pair[0].name} and {pair[1].name} {where}: blows on columns are left out of {slabs}"
            hint = f"give both the same `height:`, a `slab:` thick enough to meet, {COLUMNS} in {struck}"
            hint += "; `columns: none` where walls stand there"
            issues.append(Issue(("group", place + 1), message, hint))
    return issues


def format_meetings(group: Sequence[Building]) -> list[str]:
    """Return every meeting of neighbours, a line each from the ground up.

    These are slabs that meet, slabs that strike columns, and blows that are left out. Floors that all meet those of
    their number share a line.
    """
    lines = []
    for left, right in pairwise(group):
        pair, (floors, strikes) = f"{left.name}|{right.name}  ", find_meetings(left, right)
        if isinstance(left, Wall) or isinstance(right, Wall):
            named = ", ".join(f"floor {floor}" if floor else BASE for floor, _ in floors)
            lines.append(f"{pair}the wall meets {named}")
            continue
        if not strikes and len(floors) > 1 and all(i == j for i, j in floors):
            first, last = floors[0][0], floors[-1][0]
            heights = f"{left.level(first):g} to {left.level(last):g} m"
            lines.append(f"{pair}{heights}: floors {first} to {last} meet those of the same number")
            continue
        found = [(left.level(i), f"floor {i} meets floor {j}") for i, j in floors]
        for strike in strikes:
            columns, slab = (left, right)[strike.side], (right, left)[strike.side]
            said = f"floor {strike.slab} of {slab.name} strikes columns of {columns.name} in storey {strike.storey}"
            said += f", at {100 * strike.height:.3g} % of its height"
            if columns.columns is None:
                said = f"left out: {said}; write `columns:` in {columns.name}"
            elif columns.columns == 0.0:
                said = f"floor {strike.slab} of {slab.name} meets storey {strike.storey} of {columns.name}, "
                said += "which has no columns to strike"
            else:
                said += f", {100 * columns.columns:.3g} % of the storey"
            found.append((slab.level(strike.slab), said))
        lines += [f"{pair}{height:g} m: {said}" for height, said in sorted(found)]
    return lines
