"""Ends of links as a study writes them: at a floor, `5`, or in the storey above one, `2 + 1.2 m`, `2 + 40 %`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from pydantic_core import PydanticCustomError

from pounding_cli.study.schema.quantity import LENGTH, LONGEST, NUMBER_PATTERN, Quantity, ValueParser, quote, refuse

MAX_FLOOR = 100
"""Highest floor that a link may name."""

GROUND_WORDS = ("base", "ground")
"""Words for floor 0: a base that moves, and the ground below the first storey."""

_ABOVE = LENGTH.replace(name="height above the floor", example="1.2 m", high=100.0)
_SHARE = Quantity("part of the storey height", "", "40 %", 0.0, 1.0, open_low=True, open_high=True, percent=True)
_PLACE = re.compile(rf"\s*([0-9]{{1,9}}|{'|'.join(GROUND_WORDS)})\s*(?:\+\s*(\S.*?))?\s*\Z")
_USAGE = "write a floor, e.g. 5, or a floor and the height above it: `2 + 1.2 m`, `2 + 40 %`"


@dataclass(frozen=True)
class FloorPlace:
    """A floor, or a place in the storey above it.

    floor : from 1; 0 is the base, or the ground
    above : height above the floor [m], 0 where it is given as `share`, and at the floor
    share : the same as part of the storey height [-], 0 where it is given as `above`, and at the floor
    """

    floor: int
    above: float = 0.0
    share: float = 0.0

    @property
    def is_at_floor(self) -> bool:
        """True at a floor, False between two floors."""
        return self.above == self.share == 0.0

    def __str__(self) -> str:
        if self.above:
            return f"{self.floor} + {self.above:g} m"
        if self.share:
            return f"{self.floor} + {100 * self.share:g} %"
        return str(self.floor)


@dataclass(frozen=True)
class FloorPair:
    """Places of both ends of a link, in the left and in the right building."""

    left: FloorPlace
    right: FloorPlace

    def __str__(self) -> str:
        return f"[{self.left}, {self.right}]"


def parse_floor_place(value: Any) -> FloorPlace:
    """Return a floor, or a place in the storey above it.  Raises PydanticCustomError."""
    if isinstance(value, FloorPlace):
        return value
    is_number = isinstance(value, int) and not isinstance(value, bool)
    match = _PLACE.match(str(value)) if is_number or (isinstance(value, str) and len(value) <= LONGEST) else None
    if match is None:
        raise refuse(f"{quote(value)} is no place of a link", _USAGE)
    floor = 0 if match[1] in GROUND_WORDS else int(match[1])
    if floor > MAX_FLOOR:
        raise refuse(f"floor {floor} is not allowed", f"write a floor, at most {MAX_FLOOR}")
    height = match[2]
    if height is None:
        return FloorPlace(floor)
    if re.fullmatch(NUMBER_PATTERN, height):
        raise refuse(f"{quote(value)}: the height above the floor has no unit", f"write e.g. `{value} m`, `{value} %`")
    quantity = _SHARE if height.endswith("%") else _ABOVE
    try:
        number = quantity.read(height)
    except PydanticCustomError as error:
        message = (error.context or {}).get("message", "")
        raise refuse(f"{quote(value)}: {message}", _USAGE) from None
    return FloorPlace(floor, share=number) if quantity is _SHARE else FloorPlace(floor, above=number)


class FloorPairParser(ValueParser):
    """Read `[4, 5]`, a place in the left building and one in the right building."""

    form = "[left, right]"
    examples = ([4, 5], [4, "2 + 1.2 m"])

    def read(self, value: Any) -> FloorPair:
        """Return both ends.  Raises PydanticCustomError."""
        if isinstance(value, FloorPair):
            return value
        if not isinstance(value, list | tuple) or len(value) != 2:
            hint = "write the floor of the left building and that of the right one, e.g. `[4, 5]`, `[4, 2 + 1.2 m]`"
            raise refuse("a link has two ends", hint)
        left, right = value
        return FloorPair(parse_floor_place(left), parse_floor_place(right))

    def schema(self) -> dict[str, Any]:
        place = {"anyOf": [{"type": "integer", "minimum": 0, "maximum": MAX_FLOOR}, {"type": "string"}]}
        return {"type": "array", "items": place, "minItems": 2, "maxItems": 2, "examples": [*self.examples]}
