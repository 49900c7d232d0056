"""What stands between two neighbouring floors, and its law (paper, eqs 5-10)."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import Pounding

APART = "apart"
"""What tables call the kind of a link that is nothing but a place where the closing of two floors is found."""

BASE = "base"
"""What stands in place of a floor where a link ends at the base of a building."""

LinkEnd = tuple[int, int, float]
"""A building, its floor from 1, and where in the storey below that floor a link ends (`Link`)."""


@dataclass(frozen=True)
class Link:
    """One link between floor `left_floor` of building `left` and `right_floor` of the building to its right.

    Parameters
    ----------
    left : place of the left building in the group, from 0; the right building is left + 1
    left_floor, right_floor : floors, from 1; 0 is the base of a building; beside a wall both are that of the building
    left_at, right_at : where between that floor and the one below it the link ends, as part of the storey height: 1 at
        the floor, as floors that face each other do; below it on the columns of the storey, clamped in both floors [-]
    law : its law with its parameters: `Pounding`, `Infill`, `Connector`, ...
    columns : part of the storey's stiffness and yield shear in the columns that it ends on, 0 to 1; 0 where their shear
        is not asked for

    Raises
    ------
    ValueError : a value is outside its range
    """

    left: int
    left_floor: int
    right_floor: int
    law: LinkLaw
    left_at: float = 1.0
    right_at: float = 1.0
    columns: float = 0.0

    def __post_init__(self) -> None:
        if self.left < 0:
            raise ValueError(f"link: left is {self.left}; places in the group count from 0")
        if self.left_floor < 0 or self.right_floor < 0:
            raise ValueError(f"link: floors {self.left_floor} and {self.right_floor}; floors count from 1, 0 is a base")
        for at in (self.left_at, self.right_at):
            if not 0.0 < at <= 1.0:
                raise ValueError(f"link: it ends at {at:g} of a storey height; give a part above 0, 1 at the floor")
        if not 0.0 <= self.columns <= 1.0 or (self.columns > 0.0 and (self.left_at < 1.0) == (self.right_at < 1.0)):
            raise ValueError(f"link: columns is {self.columns:g}; give a part of 1 where one end stands between floors")
        if self.columns > 0.0 and not self.law.subtracts_gap:
            raise ValueError(f"link: columns is given for {self.kind}, which strikes nothing; leave it out")

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        """Kept: what scenes share is looked up by their links."""
        return hash((self.left, self.left_floor, self.right_floor, self.law, self.left_at, self.right_at, self.columns))

    @classmethod
    @lru_cache(maxsize=1024)  # asked for again at every gap of a sweep
    def apart(cls, left: int, left_floor: int, right_floor: int, left_at: float = 1.0, right_at: float = 1.0) -> Link:
        """Nothing between two floors: no force whatever they do; a run finds their largest closing all the same."""
        return cls(left, left_floor, right_floor, Pounding(math.inf, 1.0, 0.0), left_at, right_at)

    @property
    def ends(self) -> tuple[LinkEnd, LinkEnd]:
        """(building, floor, where below it) of both ends."""
        return (self.left, self.left_floor, self.left_at), (self.left + 1, self.right_floor, self.right_at)

    @property
    def kind(self) -> str:
        """The name of its law; APART where nothing stands between the floors."""
        return APART if self.law.gap == math.inf else self.law.name

    @property
    def gap(self) -> float:
        """Initial distance of the floors [m]."""
        return self.law.gap

    @property
    def identity(self) -> str:
        """Everything about the link, in a line: two links with one line act alike."""
        between = "" if self.left_at == self.right_at == 1.0 else f" {self.left_at!r} {self.right_at!r}"
        between += f" columns {self.columns!r}" if self.columns else ""
        return f"{self.left} {self.left_floor} {self.right_floor} {self.law.identity}{between}"


LinkPlace = tuple[int, int, int, str]
"""Left building from 0, its floor, the right one's floor, and the name of `link_places`."""


def link_places(links: Sequence[Link]) -> tuple[LinkPlace, ...]:
    """Where each link of a scene stands, and its name among those that join the same floors.

    The name is empty where it is the only one. Of several the first that strikes has no name (without one, the first),
    so that it stands in the same row of tables as the pounding of another case; the others are named for their law:
    `connector`, `connector 2`. A link that ends between floors is named for the columns it ends on, those of the
    storey below the floor of that side: `right columns`.
    """
    joined: dict[tuple[LinkEnd, LinkEnd], list[int]] = {}
    for number, link in enumerate(links):
        joined.setdefault(link.ends, []).append(number)
    names = [""] * len(links)
    for several in joined.values() if len(joined) < len(links) else ():
        strike = (number for number in several if links[number].law.subtracts_gap)
        plain = next(strike, several[0])
        count: Counter[str] = Counter()
        for number in several:
            if number != plain:
                kind = links[number].kind
                count[kind] += 1
                names[number] = kind if count[kind] == 1 else f"{kind} {count[kind]}"
    heights: dict[tuple[int, int, int, str], list[tuple[float, float]]] = {}
    for number, link in enumerate(links):
        if (at := (link.left_at, link.right_at)) != (1.0, 1.0):
            sides = [side for side, end in zip(("left", "right"), at, strict=True) if end != 1.0]
            between = f"{' and '.join(sides)} columns"
            known = heights.setdefault((link.left, link.left_floor, link.right_floor, between), [])
            if at not in known:
                known.append(at)
            between += f" {known.index(at) + 1}" if known.index(at) else ""
            names[number] = f"{between}, {names[number]}" if names[number] else between
    return tuple((link.left, link.left_floor, link.right_floor, name) for link, name in zip(links, names, strict=True))


def ends_on_columns(place: LinkPlace) -> bool:
    """Whether a link stands between floors, on columns."""
    return place[3].startswith(("left columns", "right columns", "left and right columns"))


def columns_struck(place: LinkPlace) -> tuple[int, int]:
    """Building from 0 and storey from 1 of the columns that a link `ends_on_columns`."""
    left, left_floor, right_floor, name = place
    return (left + 1, right_floor) if name.startswith("right") else (left, left_floor)


def link_label(buildings: Sequence[str], place: LinkPlace) -> str:
    """A link as tables call it: `stiff|soft floor 3`, `stiff|soft floor 3, connector`."""
    left, left_floor, right_floor, name = place
    floors = f"floor {left_floor}" if left_floor == right_floor else f"floor {left_floor}|{right_floor}"
    where = floors if left_floor or right_floor else BASE
    return f"{buildings[left]}|{buildings[left + 1]} {where}" + (f", {name}" if name else "")
