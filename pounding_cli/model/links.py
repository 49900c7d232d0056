"""Links between two neighbouring floors (paper, eqs 5-10), and their places in a scene."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

from pounding_cli.laws.apart import Apart
from pounding_cli.laws.law import LinkLaw

BASE = "base"
"""Word of labels for the floor of a link that ends at the bases of both buildings."""

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
    cosine : of the angle between the link and the horizontal, 0 to 1: the link deforms by the closing times it, and
        its force times it acts on the floors; 1 for a level link [-]
    left_y, right_y : places of its ends across the row, from the centres of mass of floors that twist [m]
    whole_law : law of the link of which this is a part, at one of several places (`model.twist`); None of a whole link

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
    cosine: float = 1.0
    left_y: float = 0.0
    right_y: float = 0.0
    whole_law: LinkLaw | None = None

    def __post_init__(self) -> None:
        if self.left < 0:
            raise ValueError(f"link: left is {self.left}; places in the group count from 0")
        if self.left_floor < 0 or self.right_floor < 0:
            raise ValueError(f"link: floors {self.left_floor} and {self.right_floor}; floors count from 1, 0 is a base")
        for height in (self.left_at, self.right_at):
            if not 0.0 < height <= 1.0:
                raise ValueError(f"link: it ends at {height:g} of a storey height; give a part above 0, 1 at the floor")
        ends = ((self.left_floor, self.left_at), (self.right_floor, self.right_at))
        if any(floor == 0 and height < 1.0 for floor, height in ends):
            raise ValueError("link: it ends below a base; give the storey above it by its floor")
        has_one_end_on_columns = (self.left_at < 1.0) != (self.right_at < 1.0)
        if not 0.0 <= self.columns <= 1.0 or (self.columns > 0.0 and not has_one_end_on_columns):
            raise ValueError(f"link: columns is {self.columns:g}; give a part of 1 where one end stands between floors")
        if not 0.0 < self.cosine <= 1.0:
            raise ValueError(
                f"link: cosine is {self.cosine:g}; give a number above 0 and at most 1, 1 for a level link"
            )
        if self.cosine < 1.0 and not self.law.joins:
            raise ValueError(f"link: {self.kind} acts across a gap, which is level; leave cosine out")

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        """The hash, computed once: what scenes share is looked up by their links."""
        ends = (self.left_floor, self.left_at, self.right_floor, self.right_at)
        places = (self.left_y, self.right_y)
        return hash((self.left, ends, self.law, self.columns, self.cosine, places))

    @classmethod
    @lru_cache(maxsize=1024)  # the same at every gap of a sweep
    def apart(cls, left: int, left_floor: int, right_floor: int, left_at: float = 1.0, right_at: float = 1.0) -> Link:
        """Return the link of two floors with nothing between them; a run records their largest closing."""
        return cls(left, left_floor, right_floor, Apart(), left_at, right_at)

    @property
    def ends(self) -> tuple[LinkEnd, LinkEnd]:
        """(building, floor, where below it) of both ends."""
        left = (self.left, self.left_floor, self.left_at)
        right = (self.left + 1, self.right_floor, self.right_at)
        return left, right

    @property
    def place(self) -> LinkPlace:
        """Its place, without a name."""
        on_columns = (self.left_at < 1.0, self.right_at < 1.0)
        return LinkPlace(self.left, self.left_floor, self.right_floor, "", *on_columns)

    @property
    def kind(self) -> str:
        """The name of its law."""
        return self.law.name

    @property
    def gap(self) -> float:
        """Initial distance of the floors [m]; NaN where nothing stands between them."""
        return self.law.gap

    @property
    def share(self) -> float:
        """Part of a whole link that this is [-]; 1 of a whole one."""
        if self.whole_law is None:
            return 1.0
        names = self.law.scaled_parameters
        if names:
            return float(getattr(self.law, names[0]) / getattr(self.whole_law, names[0]))
        whole_slope = sum(self.whole_law.max_slopes)
        return sum(self.law.max_slopes) / whole_slope if whole_slope else 1.0  # a constant force has no slope

    @property
    def inclination(self) -> float:
        """Angle between the link and the horizontal [rad]."""
        return math.acos(self.cosine)

    @cached_property
    def identity(self) -> str:
        """All that the link does, in a line: two links with one line act alike."""
        parts = [str(self.left), str(self.left_floor), str(self.right_floor), self.law.identity]
        if not self.left_at == self.right_at == 1.0:
            parts += [repr(self.left_at), repr(self.right_at)]
        if self.columns:
            parts.append(f"columns {self.columns!r}")
        if self.cosine < 1.0:
            parts.append(f"cosine {self.cosine!r}")
        if self.left_y or self.right_y:
            parts.append(f"y {self.left_y!r} {self.right_y!r}")
        return " ".join(parts)


class LinkPlace(NamedTuple):
    """Place of a link among the links of a scene.

    left : left building of the pair, from 0
    left_floor, right_floor : floors that it joins, from 1; 0 is a base
    name : what tells it from other links between the same floors, "" where nothing has to
    left_on_columns, right_on_columns : on which sides it ends below the floor, on the columns of the storey
    """

    left: int
    left_floor: int
    right_floor: int
    name: str = ""
    left_on_columns: bool = False
    right_on_columns: bool = False

    @property
    def is_on_columns(self) -> bool:
        """True where an end stands between floors, on columns."""
        return self.left_on_columns or self.right_on_columns

    @property
    def struck_storey(self) -> tuple[int, int]:
        """Building from 0 and storey from 1 of the columns that a link `is_on_columns` ends on.

        Those of the left building where both ends stand on columns.
        """
        if self.left_on_columns:
            return self.left, self.left_floor
        return self.left + 1, self.right_floor

    @property
    def struck_sides(self) -> str:
        """The sides on which it ends on columns: "left", "right", "left and right", or ""."""
        sides = ["left"] * self.left_on_columns + ["right"] * self.right_on_columns
        return " and ".join(sides)


def link_places(links: Sequence[Link]) -> tuple[LinkPlace, ...]:
    """Return the place of each link of a scene, with a name among those that join the same floors.

    The name is empty where it is the only one. Of several the first that strikes has no name (without one, the first),
    so that it stands in the same row of tables as the pounding of another case; the others are named for their law:
    `connector`, `connector 2`. A link that ends between floors is named for the columns it ends on, those of the
    storey below the floor of that side: `right columns`.
    """
    law_names = _names_by_law(links)
    heights_by_place: dict[LinkPlace, list[tuple[float, float]]] = {}
    places = []
    for link, law_name in zip(links, law_names, strict=True):
        place = link.place
        parts = [law_name]
        if place.is_on_columns:
            heights = heights_by_place.setdefault(place, [])
            if (link.left_at, link.right_at) not in heights:
                heights.append((link.left_at, link.right_at))
            number = 1 + heights.index((link.left_at, link.right_at))
            columns = f"{place.struck_sides} columns"
            parts.insert(0, columns if number == 1 else f"{columns} {number}")
        places.append(place._replace(name=", ".join(filter(None, parts))))
    return tuple(places)


def _names_by_law(links: Sequence[Link]) -> list[str]:
    """Return a name for each link that stands beside another between the same ends, "" for the rest.

    Parts of one link at several places share the name of its law, and are numbered: `place 1`, `connector place 2`.
    """
    wholes_by_ends: dict[tuple[LinkEnd, LinkEnd], dict[Any, list[int]]] = {}
    for number, link in enumerate(links):
        whole = number if link.whole_law is None else link.whole_law
        wholes_by_ends.setdefault(link.ends, {}).setdefault(whole, []).append(number)
    names = [""] * len(links)
    for wholes in wholes_by_ends.values():
        groups = list(wholes.values())
        striking = [numbers for numbers in groups if links[numbers[0]].law.subtracts_gap]
        unnamed = striking[0] if striking else groups[0]
        count: Counter[str] = Counter()
        for numbers in groups:
            name = ""
            if numbers is not unnamed:
                kind = links[numbers[0]].kind
                count[kind] += 1
                name = kind if count[kind] == 1 else f"{kind} {count[kind]}"
            for place, number in enumerate(numbers, 1):
                part = "" if links[number].whole_law is None else f"place {place}"
                names[number] = " ".join(filter(None, (name, part)))
    return names


def link_label(buildings: Sequence[str], place: LinkPlace) -> str:
    """Return the label of a link in tables: `stiff|soft floor 3`, `stiff|soft floor 3, connector`."""
    pair = f"{buildings[place.left]}|{buildings[place.left + 1]}"
    if place.left_floor == place.right_floor == 0:
        floors = BASE
    elif place.left_floor == place.right_floor:
        floors = f"floor {place.left_floor}"
    else:
        floors = f"floor {place.left_floor}|{place.right_floor}"
    name = f", {place.name}" if place.name else ""
    return f"{pair} {floors}{name}"
