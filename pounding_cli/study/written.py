"""The units a study is written in: of a swept key, and of the quantities that screens and tables show."""

from __future__ import annotations

import functools
import types
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin, get_type_hints

from pydantic import BaseModel

from pounding_cli.numbers import Unit
from pounding_cli.study.problems import Tree
from pounding_cli.study.source import Node
from pounding_cli.study.units import GRAVITY, Quantity, TextForm, factor_of, written_unit


def unit_of(model: type[BaseModel], path: Sequence[str], values: Sequence[Node]) -> Unit:
    """The unit of a swept key: the first one written among its values, SI where all are bare numbers.

    model : the schema of the study; path : the key, step by step; values : the nodes of the axis
    """
    found = quantity_of(model, path)
    if found is None:
        return Unit()
    for node in values:
        name = written_unit(node.value) if isinstance(node.value, str) else ""
        if name and (factor := factor_of(name, found.si)) is not None:
            return Unit(name, factor, found.si)
    return Unit(found.si, 1.0, found.si)


class Place(NamedTuple):
    """Where a study writes a quantity: at or below these sections, under any of `keys` (none: anywhere there).

    usual : its unit where the study does not write the quantity
    """

    sections: tuple[tuple[str, ...], ...]
    keys: tuple[str, ...]
    usual: Unit


PLACES = {
    "gap": Place((("cases",),), ("gap",), Unit("cm", 0.01, "m")),
    "link stiffness": Place((("cases",), ("impact",)), ("stiffness",), Unit("MN/m", 1e6, "N/m")),
    "acceleration": Place((("records", "scale"),), ("pga", "sa", "target"), Unit("g", GRAVITY, "m/s2")),
    "time step": Place((("time_step",),), (), Unit("s", 1.0, "s")),
}
"""The quantities that screens and tables show in the unit of the study."""


def unit_in(root: Node | Tree, quantity: str) -> Unit:
    """The unit a study writes a quantity of PLACES in: the first one found, SI where there are bare numbers only."""
    place, bare = PLACES[quantity], False
    for section in place.sections:
        for node in _scalars(root.get(*section), place.keys, not place.keys):
            name = written_unit(node.value) if isinstance(node.value, str) else ""
            if name and (factor := factor_of(name, place.usual.si)) is not None:
                return Unit(name, factor, place.usual.si)
            bare = bare or isinstance(node.value, int | float)
    return Unit(place.usual.si, 1.0, place.usual.si) if bare else place.usual


def _scalars(node: Node | None, keys: Sequence[str], inside: bool) -> Iterator[Node]:
    """The scalars at or below `node` that stand under one of `keys`; all of them where `inside`."""
    if node is None:
        return
    if node.is_mapping:
        for key, below in node.value.items():
            yield from _scalars(below, keys, inside or key in keys)
    elif node.is_list:
        for below in node.value:
            yield from _scalars(below, keys, inside)
    elif inside:
        yield node


def quantity_of(model: type[BaseModel], path: Sequence[str]) -> Quantity | None:
    """The quantity that may stand at a key, or None."""
    level: list[Any] = [model]
    for step in path:
        level = [below for kind in level for below in _below(kind, step)]
    return next((kind for kind in level if isinstance(kind, Quantity)), None)


def _below(kind: Any, step: str) -> Iterator[Any]:
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        hints = _hints(kind)
        for name, field in kind.model_fields.items():
            if (field.alias or name) == step:
                yield from _leaves(hints[name])
    elif get_origin(kind) is tuple and step.isdigit():
        yield from _leaves(get_args(kind)[0])
    elif get_origin(kind) is dict:
        yield from _leaves(get_args(kind)[1])


@functools.cache
def _hints(kind: type[BaseModel]) -> dict[str, Any]:
    """The types of the fields of a model: to find them takes a millisecond."""
    return get_type_hints(kind, include_extras=True)


def _leaves(kind: Any) -> Iterator[Any]:
    """What a type comes to: models, tuples, dicts and quantities."""
    origin, parts = get_origin(kind), get_args(kind)
    if origin is Annotated:
        extra = next((part for part in parts[1:] if isinstance(part, Quantity | TextForm)), None)
        if extra is None:
            yield from _leaves(parts[0])
        elif isinstance(extra, Quantity):
            yield extra
        elif extra.quantity is not None:
            yield extra.quantity
    elif origin in (Union, types.UnionType):
        for part in parts:
            yield from _leaves(part)
    else:
        yield kind
