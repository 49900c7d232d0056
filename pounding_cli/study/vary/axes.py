"""The axes of a sweep: dotted keys with their values, lists or ranges; keys of one list entry move together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pydantic import BaseModel

from pounding_cli.numbers import Unit
from pounding_cli.study.schema import study as schema
from pounding_cli.study.schema.lookup import quantity_at, value_at
from pounding_cli.study.schema.quantity import Quantity, format_location, quote
from pounding_cli.study.text.file import Items, Map, Mark, Problems, get, with_value
from pounding_cli.study.vary.dotted_keys import can_vary
from pounding_cli.study.vary.ranges import (
    MAX_AXIS_VALUES,
    RANGE_KEYS,
    WrittenValues,
    canonical_value,
    range_example,
    read_range,
    refuse_unknown,
    unit_of,
)

MAX_POINTS = 2_000_000
"""Largest number of points of a sweep."""

MAX_AXES = 20
"""Largest number of axes of a sweep."""
_BRACKET_KEYS = ("values", "middle")


class _Unwritten:
    """A value that the file does not write."""

    def __str__(self) -> str:
        return "default"


UNWRITTEN = _Unwritten()
"""Value at a point of an axis of a key that the file leaves to its default."""


@dataclass(frozen=True, eq=False)
class Axis:
    """One dimension of a sweep.

    names : dotted keys as in the file, more than one when they move together
    written_values : the values of the keys at every point as the file writes them
    marks : where these stand
    units : the unit in which each key is written; SI where none is given
    model : model of the file
    """

    names: tuple[str, ...]
    written_values: Sequence[tuple[Any, ...]]
    marks: Sequence[tuple[Mark, ...]]
    units: tuple[Unit, ...]
    model: type[BaseModel] = schema.StudySpec

    def __len__(self) -> int:
        return len(self.written_values)

    @property
    def paths(self) -> list[list[str]]:
        """The keys, step by step."""
        return [name.split(".") for name in self.names]

    def format_point(self, place: int) -> str:
        """Return the values at a point in words."""
        values = self.written_values[place]
        return ", ".join(f"{name} = {value}" for name, value in zip(self.names, values, strict=True))

    def find_places(self, asked: Mapping[str, str]) -> list[int]:
        """Return the places on the axis at which some of its keys have values.

        asked : values as people write them, by key
        """
        at = list(range(len(self)))
        for key, text in asked.items():
            number = self.names.index(key)
            wanted = {" ".join(text.split()), value_at(self.model, tuple(self.paths[number]), text)}
            at = [
                place
                for place in at
                if " ".join(str(self.written_values[place][number]).split()) in wanted
                or self.values[place][number] in wanted
            ]
        return at

    @cached_property
    def values(self) -> tuple[tuple[float | str, ...], ...]:
        """One tuple per point, as long as names: SI numbers, or the file's text for what is no number."""
        paths = [tuple(path) for path in self.paths]
        return tuple(
            tuple(value_at(self.model, path, value) for path, value in zip(paths, row, strict=True))
            for row in self.written_values
        )

    def display_values(self, place: int) -> tuple[str, ...]:
        """Return the values at a point in the units of the study, e.g. ("0.7 g",)."""
        return tuple(unit.text(value) for unit, value in zip(self.units, self.values[place], strict=True))


def sweep_maps(root: Any) -> list[Map]:
    """Return the mappings of keys to values under `sweep:`."""
    sweep = get(root, "sweep")
    nodes = sweep if isinstance(sweep, Items) else [sweep]
    return [node for node in nodes if isinstance(node, Map)]


def read_axes(root: Map, problems: Problems, model: type[BaseModel] = schema.StudySpec) -> tuple[Axis, ...]:
    """Return the axes under `sweep:`, one for each key of a mapping.  Note what is wrong."""
    sweep = root.get("sweep")
    if sweep is None:
        return ()
    _, mark = root.marks.get("sweep", (root.mark, root.mark))
    if not _is_sweep(sweep):
        hint = "write `sweep: {impact.restitution: [0.4, 0.5]}`, or a list of such mappings"
        message = f"sweep: {quote(sweep)} is neither a mapping of keys to values nor a list of such"
        problems.add(mark, message, hint)
        return ()
    if isinstance(sweep, Map):
        entries = [(sweep, [name]) for name in sweep]
    else:
        entries = [(holder, list(holder)) for holder in sweep]
    if len(entries) > MAX_AXES:
        problems.add(mark, f"the sweep has {len(entries)} axes", f"keep it to {MAX_AXES}")
        return ()
    first_marks: dict[str, Mark] = {}
    axes = []
    for holder, names in entries:
        axis = _read_axis(holder, names, root, problems, model, first_marks)
        if axis is not None:
            _refuse_equal_points(axis, problems)
            axes.append(axis)
    point_count = math.prod(len(axis) for axis in axes)
    if point_count > MAX_POINTS:
        hint = f"keep it to {MAX_POINTS}: make axes shorter, or let keys move together in a list entry"
        problems.add(mark, f"the sweep has {point_count} points", hint)
        return ()
    return tuple(axes)


def _is_sweep(sweep: Any) -> bool:
    """Return whether a value is a mapping, or a list of mappings that hold something."""
    if isinstance(sweep, Items):
        return all(isinstance(node, Map) and len(node) > 0 for node in sweep)
    return isinstance(sweep, Map)


def _read_axis(
    holder: Map,
    names: Sequence[str],
    root: Map,
    problems: Problems,
    model: type[BaseModel],
    first_marks: dict[str, Mark],
) -> Axis | None:
    """Return the axis of some keys that move together; None where something is wrong, which is noted.

    holder : mapping in which the keys stand
    first_marks : where each key of the axes before stands; those of this axis are added
    """
    columns = []
    for name in names:
        mark = holder.marks[name][0]
        values = None
        if can_vary(name, mark, root, problems, model=model):
            values = read_axis_values(name, holder, problems, model)
        if name in first_marks:
            first = format_location(first_marks[name])
            problems.add(mark, f"'{name}' is an axis twice; first {first}", "remove one of the two")
        elif values is not None:
            columns.append(values)
        first_marks.setdefault(name, mark)
    if len(columns) < len(names):
        return None
    if len({len(column.values) for column in columns}) > 1:
        lengths = [f"{name} has {len(column.values)}" for name, column in zip(names, columns, strict=True)]
        message = f"keys that move together need as many values each: {', '.join(lengths)}"
        problems.add(holder.mark, message, "give as many values of each")
        return None
    written_values = list(zip(*(column.values for column in columns), strict=True))
    marks = list(zip(*(column.marks for column in columns), strict=True))
    return Axis(tuple(names), written_values, marks, tuple(column.unit for column in columns), model)


def _refuse_equal_points(axis: Axis, problems: Problems) -> None:
    """Note the points of an axis that occurred before."""
    first_places: dict[tuple[float | str, ...], int] = {}
    for place, values in enumerate(axis.values):
        first = first_places.setdefault(values, place)
        if first != place:
            message = f"{axis.format_point(first)} and {axis.format_point(place)} are the same point of this axis"
            problems.add(axis.marks[place][0], message, "remove one of the two")


def read_axis_values(
    name: str, holder: Map, problems: Problems, model: type[BaseModel] = schema.StudySpec
) -> WrittenValues | None:
    """Return the values of a swept key; None where something is wrong, which is noted."""
    node = holder[name]
    mark = holder.marks[name][1]
    quantity = quantity_at(model, tuple(name.split(".")))
    if isinstance(node, Map) and not node.keys().isdisjoint(RANGE_KEYS):
        return read_range(name, node, quantity or Quantity("number", "", "5"), problems)
    if isinstance(node, Map) and "values" in node:
        refuse_unknown(node, _BRACKET_KEYS, f"the axis '{name}'", problems)
        mark = node.marks["values"][1]
        node = node["values"]
    if not isinstance(node, Items) or not 0 < len(node) <= MAX_AXIS_VALUES:
        example = range_example(quantity, ", count: 5")
        hint = f"write `{name}: [first, second]`, at most {MAX_AXIS_VALUES} values, or a range: `{name}: {example}`"
        message = f"the axis '{name}' has no list of values, or too long a one: {quote(node)}"
        problems.add(mark, message, hint)
        return None
    return WrittenValues(node, node.marks, unit_of(node, quantity))


def with_middles(root: Map, problems: Problems) -> Map:
    """Return the tree with the middle of every unknown value, `{values: [...], middle: ...}`, where its key stands:
    figures and the answer show it."""
    for holder in sweep_maps(root):
        for name, node in holder.items():
            if not isinstance(node, Map) or "middle" not in node:
                continue
            mark = node.marks["middle"][1]
            if not _is_middle(name, node, root):
                message = (
                    f"'{name}': {quote(node['middle'])} is not the middle of an odd number of values, "
                    "or not what the study has there"
                )
                hint = f"write low, middle and high, e.g. `{name}: {{values: [low, middle, high], middle: middle}}`"
                problems.add(mark, message, hint)
            elif can_vary(name, holder.marks[name][0], root, Problems("")):  # else the axis says what is wrong
                root = with_value(root, name.split("."), node["middle"], mark)
    return root


def _is_middle(name: str, node: Map, root: Map) -> bool:
    """Return whether the middle of an unknown value is that of an odd number of values, and what the study has."""
    values: Any = node.get("values")
    if not isinstance(values, Items) or len(values) < 3 or len(values) % 2 == 0:
        return False
    path = name.split(".")
    quantity = quantity_at(schema.StudySpec, tuple(path))
    middle = canonical_value(node["middle"], quantity)
    value_of_study = get(root, *path)
    is_middle = canonical_value(values[len(values) // 2], quantity) == middle
    return is_middle and (value_of_study is None or canonical_value(value_of_study, quantity) == middle)
