"""A validated study as plain data, and the units it is written in."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import BaseModel

from pounding_cli.numbers import Unit
from pounding_cli.study.axes import unit_of
from pounding_cli.study.file import get
from pounding_cli.study.models import Case
from pounding_cli.study.quantity import Measured, Quantity, Storey, written_unit
from pounding_cli.units import GRAVITY


def shown(value: Any) -> Any:
    """A value of a validated model as plain data: SI numbers, multiples of stiffnesses as text."""
    if isinstance(value, Storey):
        return str(value)
    if isinstance(value, Measured):
        return value.text
    if isinstance(value, BaseModel):
        found = {info.alias or name: shown(getattr(value, name)) for name, info in type(value).model_fields.items()}
        # What one law alone takes is left out where it stands at its default.
        return {key: each for key, each in found.items() if each is not None} if isinstance(value, Case) else found
    if isinstance(value, dict):
        return {str(key): shown(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [shown(item) for item in value]
    return value


PLACES: dict[str, tuple[tuple[tuple[str, ...], ...], tuple[str, ...], Unit]] = {
    "gap": ((("cases",),), ("gap",), Unit("cm", 0.01, "m")),
    "link stiffness": ((("cases",), ("impact",)), ("stiffness",), Unit("MN/m", 1e6, "N/m")),
    "acceleration": ((("records", "scale"),), ("pga", "sa", "target"), Unit("g", GRAVITY, "m/s2")),
    "time step": ((("time_step",),), (), Unit("s", 1.0, "s")),
}
"""The quantities that screens and tables show in the unit of the study: the sections at or below which it writes them,
the keys there (none: any), and the unit where it does not write them."""


def unit_in(root: Any, quantity: str) -> Unit:
    """The unit a study writes a quantity of PLACES in: the first one found, SI where there are bare numbers only."""
    sections, keys, usual = PLACES[quantity]
    found = [value for section in sections for value in _scalars(get(root, *section), keys, not keys)]
    unit = unit_of(found, Quantity(quantity, usual.si, ""))
    is_written = any(written_unit(value) == unit.name or isinstance(value, int | float) for value in found)
    return unit if is_written else usual


def _scalars(node: Any, keys: Sequence[str], inside: bool) -> Iterator[Any]:
    """The scalars at or below `node` that stand under one of `keys`; all of them where `inside`."""
    if isinstance(node, dict):
        for key, below in node.items():
            yield from _scalars(below, keys, inside or key in keys)
    elif isinstance(node, list):
        for below in node:
            yield from _scalars(below, keys, inside)
    elif inside and node is not None:
        yield node
