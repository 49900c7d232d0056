"""Limits in words: `mu > 4`, `drift > 2 %`, `acceleration > 1 g in soft floor 5`, `shear_demand > 1`, `contact`,
`collapse`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from pydantic_core import PydanticCustomError

from pounding_cli.study.file import nearest
from pounding_cli.study.quantity import ACCELERATION, LENGTH, Quantity, refuse, written_unit

CONTACT, COLLAPSE, SHEAR_DEMAND = "contact", "collapse", "shear_demand"
DRIFT_RATIO = "drift_ratio"
LIMITS = ("mu", "drift", DRIFT_RATIO, "acceleration", SHEAR_DEMAND, CONTACT, COLLAPSE)
"""What may be limited."""

TAKES_NEIGHBOUR = (CONTACT, SHEAR_DEMAND)
"""Limits that a building alone cannot pass."""

FORM = "write e.g. `mu > 4`, `drift > 2 %`, `acceleration > 1 g`, `shear_demand > 1`, `contact` or `collapse`"

_QUANTITIES = {
    "mu": Quantity("ductility", "", "mu > 4", 0.0, 1e6, open_low=True),
    SHEAR_DEMAND: Quantity("shear demand", "", "shear_demand > 1", 0.0, 1e6, open_low=True),
    "acceleration": ACCELERATION.but(example="acceleration > 1 g"),
    "drift": LENGTH.but(name="drift", example="drift > 6 cm"),
    DRIFT_RATIO: Quantity("drift ratio", "", "drift_ratio > 2 %", 0.0, 1.0, open_low=True, open_high=True),
}
_MEANT = {
    "ductility": "mu", "idr": DRIFT_RATIO, "drift ratio": DRIFT_RATIO, "acc": "acceleration", "pfa": "acceleration",
    "impact": CONTACT, "impacts": CONTACT, "pounding": CONTACT, "collapsed": COLLAPSE,
    "shear": SHEAR_DEMAND, "shear demand": SHEAR_DEMAND,
}  # fmt: skip
_FORM = re.compile(r"(?P<quantity>[^<>=]*?)\s*(?:(?P<sign>[<>=]+)\s*(?P<value>.*?))?\s*\Z", re.DOTALL)
_WHERE = re.compile(r"(?P<what>.*)\s+in\s+(?P<where>\S.*)\Z")  # the last `in`: one before it may be inches
_LEVEL = re.compile(r"(?:(?P<building>.*?)\s+)?(?P<level>storey|floor)\s+(?P<number>[0-9]{1,3})\Z")
_LONGEST = 200


@dataclass(frozen=True)
class Limit:
    """One limit.

    text : as people read it
    quantity : one of LIMITS
    value : [-], [m] or [m/s2]; 0 of contact, where a gap that closes passes the limit, and of collapse
    of_height : the value is a part of the storey's height
    building : the only one it concerns, "" for each of them
    level : its only storey or floor, from 1 at the ground; 0 for any of them
    """

    text: str
    quantity: str
    value: float = 0.0
    of_height: bool = False
    building: str = ""
    level: int = 0

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Target:
    """What a curve is about: a limit and the building it concerns, by place, or the left one of a pair (contact)."""

    limit: Limit
    building: int

    def label(self, names: tuple[str, ...]) -> str:
        """The building, or the pair."""
        if self.limit.quantity == CONTACT:
            return f"{names[self.building]}|{names[self.building + 1]}"
        return names[self.building]


def read_limit(value: Any) -> Limit:
    """A limit as the file says it.  Raises PydanticCustomError saying what to write."""
    if not isinstance(value, str):
        shown = "a mapping" if isinstance(value, dict) else "a list" if isinstance(value, list) else str(value)[:60]
        raise refuse(f"{shown} is not a limit", FORM)
    text = " ".join(value.split())
    if len(text) > _LONGEST:
        raise refuse(f"{len(text)} characters are not a limit", FORM)
    parted = _WHERE.match(text)
    where = parted["where"] if parted else ""
    found = _FORM.match(parted["what"] if parted else text)
    assert found is not None  # it matches any text
    quantity = found["quantity"]
    if quantity not in LIMITS:
        meant = _MEANT.get(quantity.lower())
        hint = f"did you mean '{meant}'? known: {', '.join(LIMITS)}" if meant else nearest(quantity, LIMITS)
        if not quantity:
            raise refuse(f"'{text}' is not a limit", FORM)
        raise refuse(f"'{text}': no limit of '{quantity}' is known", hint)
    building, level = _read_where(where, quantity, text) if where else ("", 0)
    if quantity == CONTACT:
        if found["sign"] or where:
            what = "takes no value" if found["sign"] else "concerns the gap between two buildings, not one of them"
            raise refuse(f"'{text}': contact {what}", "write `contact`: a gap that closes passes it")
        return Limit(text, quantity)
    if quantity == COLLAPSE:
        if found["sign"] or level:
            what = "takes no value" if found["sign"] else "concerns a building, not one of its storeys"
            hint = "write `collapse`, or `collapse in BUILDING`; `collapse: 10 %` of a building sets the drift"
            raise refuse(f"'{text}': collapse {what}", hint)
        return Limit(text, quantity, building=building)
    if found["sign"] != ">":
        said = f"has {found['sign']} where > belongs" if found["sign"] else "lacks its value"
        raise refuse(f"'{text}' {said}", f"write e.g. `{_QUANTITIES[quantity].example}`")
    return _with_value(text, quantity, found["value"], building, level)


def _with_value(text: str, quantity: str, written: str, building: str, level: int) -> Limit:
    unit = written_unit(written)
    of_height = quantity == DRIFT_RATIO or (quantity == "drift" and unit in ("%", "percent", "pct"))
    if quantity not in ("mu", SHEAR_DEMAND, DRIFT_RATIO) and not unit:
        example = "`drift > 2 %` (of the storey height) or `drift > 6 cm`" if quantity == "drift" else ""
        example = example or f"`{_QUANTITIES[quantity].example}`"
        raise refuse(f"'{text}': the limit has no unit", f"write e.g. {example}")
    kind = _QUANTITIES[DRIFT_RATIO if of_height else quantity]
    try:
        value = float(kind.read(written))
        return Limit(text, "drift" if of_height else quantity, value, of_height, building, level)
    except PydanticCustomError as error:
        context: dict[str, Any] = error.context or {}
        hint = f"write e.g. `{_QUANTITIES[quantity].example}`"
        raise refuse(f"'{text}': {context.get('message', error)}", hint) from None


def _read_where(where: str, quantity: str, text: str) -> tuple[str, int]:
    """Building and level of what follows `in`."""
    found = _LEVEL.match(where)
    if found is None:
        return where, 0
    own = "floor" if quantity == "acceleration" else "storey"
    if found["level"] != own:
        raise refuse(f"'{text}': {quantity} belongs to a {own}", f"write `{own} {found['number']}`")
    if int(found["number"]) < 1:
        raise refuse(f"'{text}': there is no {own} 0", f"the lowest is `{own} 1`")
    return found["building"] or "", int(found["number"])
