"""Limits of fragility: comparisons of one quantity, `mu in soft storey 1 > 4`, or events, `contact`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError
from pounding_cli.model.archetypes import DAMAGE_STATES
from pounding_cli.study.expressions.comparison import SIGN, parse_comparison
from pounding_cli.study.expressions.expression import (
    MAX_LENGTH,
    OVER_HEIGHT,
    PHRASE,
    REDUCTIONS,
    SHEAR_DEMAND,
    Expression,
    Places,
    Scope,
    TableQuantity,
    parse_places,
)
from pounding_cli.study.schema.quantity import ACCELERATION, LENGTH, Quantity
from pounding_cli.study.text.file import nearest

CONTACT = "contact"
COLLAPSE = "collapse"
DAMAGE_LIMITS = {f"{state} damage": state for state in DAMAGE_STATES}
"""Limits of buildings that are only seen: the drift at which a damage state of their type begins."""

EDGE_DRIFT = "edge_drift"
TWIST = "twist"
EVENTS = (CONTACT, COLLAPSE, *DAMAGE_LIMITS)
"""Limits without a value."""

OF_HEIGHT = {OVER_HEIGHT[name]: name for name in ("drift", EDGE_DRIFT)}
"""Quantity that is a part of the storey's height -> the same as a length."""

_RANGES = {
    "mu": Quantity("ductility", "", "mu > 4", 0.0, 1e6, open_low=True),
    "drift": LENGTH.replace(name="drift", example="drift > 6 cm"),
    "drift_ratio": Quantity("drift ratio", "", "drift > 2 %", 0.0, 1.0, open_low=True, open_high=True),
    EDGE_DRIFT: LENGTH.replace(name="edge drift", example="edge_drift > 6 cm"),
    "edge_drift_ratio": Quantity("edge drift ratio", "", "edge_drift > 2 %", 0.0, 1.0, open_low=True, open_high=True),
    TWIST: Quantity("twist", "rad", "twist > 0.01 rad", 0.0, 1.0, open_low=True),
    "acceleration": ACCELERATION.replace(example="acceleration > 1 g"),
    SHEAR_DEMAND: Quantity("shear demand", "", "shear_demand > 1", 0.0, 1e6, open_low=True),
}
"""Quantities that may be limited, with the range of the limit."""

LIMITS = (*_RANGES, *EVENTS)

LIMITS_OF_PAIRS = (CONTACT, SHEAR_DEMAND)
"""Limits that a building alone cannot pass."""

_EVENT = re.compile(rf"(?P<event>{'|'.join(EVENTS)})\b\s*(?P<rest>.*)")
_FIRST_NAME = re.compile(rf"(?:(?:{'|'.join(REDUCTIONS)})\s+)*(?P<name>[^\W\d]\w*)")


def limit_hint(buildings: Sequence[str]) -> str:
    """Return how a limit is written, with the buildings of the study."""
    return (
        f"write e.g. `mu > 4`, `mu in {buildings[0]} storey 1 > 4`, `drift > 2 %`, `edge_drift > 2 %`, "
        f"`acceleration > 1 g`, `shear_demand > 1`, `contact` or `collapse in {buildings[-1]}`"
    )


@dataclass(frozen=True)
class Limit:
    """One limit.

    text : as people read it
    quantity : one of LIMITS
    value : [-], [m] or [m/s2]; 0 of contact, where a gap that closes passes the limit, and of collapse
    of_height : the value is a part of the storey's height
    building : the place in the group of the only one it concerns, from 0; None for each of them
    level : its only storey or floor, from 1 at the ground; 0 for any of them
    line : the only frame line of that building it concerns, from 1; 0 for the storeys
    """

    text: str
    quantity: str
    value: float = 0.0
    of_height: bool = False
    building: int | None = None
    level: int = 0
    line: int = 0

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Target:
    """The limit of a curve, and the building that it concerns.

    building : its place in the group; of contact that of the left one of a pair
    is_damage : whether the limit is the drift at which a damage state begins
    """

    limit: Limit
    building: int
    is_damage: bool = False

    def label(self, names: tuple[str, ...]) -> str:
        """Return the name of the building, or of the pair."""
        if self.limit.quantity == CONTACT:
            return f"{names[self.building]}|{names[self.building + 1]}"
        return names[self.building]


def parse_limit(text: str, scope: Scope) -> Limit:
    """Return a limit of fragility: an event, or a comparison that one quantity lies above a value.

    Raises
    ------
    InputError : what is wrong, and what to write
    """
    text = " ".join(text[: MAX_LENGTH + 1].split())
    event = _EVENT.match(text)
    if event is not None:
        return _parse_event(text, event, scope)
    wrong = f"'{text[:60]}' is not a limit"
    hint = limit_hint(scope.buildings)
    first = _FIRST_NAME.match(text)
    name = first["name"] if first else text.partition(">")[0].strip()
    if name not in _RANGES:
        raise InputError(wrong, f"{nearest(name, LIMITS)}; {hint}")
    if not SIGN.search(text):
        raise InputError(f"{wrong}: {name} takes `>` and a value", hint)
    comparison = parse_comparison(text, replace(scope, of_limits=True))
    expression, value = comparison.parts[:2]
    if len(comparison.parts) > 2 or not (isinstance(expression, Expression) and isinstance(value, float)):
        raise InputError(f"{wrong}: it compares more than one quantity with one number", hint)
    if comparison.signs != (">",):
        raise InputError(f"{wrong}: {name} takes `>` and a value", hint)
    part = expression.quantities[0]
    if not expression.is_plain or part != TableQuantity(
        part.name, building=part.building, level=part.level, line=part.line
    ):
        raise InputError(f"{wrong}: it takes the largest of one quantity, without arithmetic", hint)
    quantity = part.name.removeprefix("line_")
    try:
        _RANGES[quantity].read(value)
    except PydanticCustomError as error:
        message = (error.context or {})["message"]
        raise InputError(f"'{text}': {message}", _RANGES[quantity].usage) from None
    length = OF_HEIGHT.get(quantity, quantity)
    return Limit(text, length, value, length != quantity, part.building, part.level, part.line)


def _parse_event(text: str, event: re.Match[str], scope: Scope) -> Limit:
    """Return a limit without a value, `collapse in soft`.  Raises InputError."""
    name, rest = event["event"], event["rest"]
    hint = limit_hint(scope.buildings)
    if SIGN.search(rest):
        raise InputError(f"'{text[:60]}' is not a limit: {name} takes no value", hint)
    if not rest:
        return Limit(text, name)
    phrase = re.match(PHRASE.format(places=scope.place_pattern), f"{name.split()[-1]} {rest}")
    if phrase is None or phrase["in"] is None:
        raise InputError(f"'{text[:60]}' is not a limit", hint)
    if name == CONTACT:
        raise InputError(f"'{text}': {name} concerns two buildings, not one of them", f"write `{name}`")
    try:
        places = parse_places(phrase, name, scope)
    except InputError as error:
        raise error.about(text) from None
    if places != Places(places.building) or phrase.end() < len(phrase.string):
        message = f"'{text}': {name} concerns a building, not one of its storeys"
        raise InputError(message, f"write `{name}` or `{name} in {scope.buildings[-1]}`")
    return Limit(text, name, building=places.building)
