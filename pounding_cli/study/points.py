"""Sweeps of the closed form and of the wall: the points of a study and the tree of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

from pydantic import BaseModel

from pounding_cli.numbers import Unit
from pounding_cli.study.problems import Problems, keys_at, nearest
from pounding_cli.study.ranges import axis_values
from pounding_cli.study.source import Node
from pounding_cli.study.written import unit_of

MOST_POINTS = 10_000
MOST_AXES = 20
_FIXED = ("title", "sweep")


@dataclass(frozen=True)
class PointAxis:
    """One axis: its keys, and for every point the node each takes; keys that move together share an axis.

    units : the unit each key is written in
    """

    names: tuple[str, ...]
    nodes: tuple[tuple[Node, ...], ...]
    units: tuple[Unit, ...]


def read_point_axes(root: Node, model: type[BaseModel], problems: Problems) -> tuple[PointAxis, ...]:
    """The axes under `sweep:`: each key of a mapping is one; the keys of a list's entry move together."""
    sweep = root.get("sweep")
    if sweep is None or sweep.value is None:
        return ()
    if sweep.is_mapping:
        entries = [(sweep, (name,)) for name in sweep.value]
    elif sweep.is_list and all(node.is_mapping and node.value for node in sweep.value):
        entries = [(node, tuple(node.value)) for node in sweep.value]
    else:
        problems.add(
            sweep.mark,
            "'sweep' is not a mapping of keys to lists",
            "write `sweep: {mesh.size: [0.5 m, 0.25 m]}`",
        )
        return ()
    if len(entries) > MOST_AXES:
        problems.add(sweep.mark, f"the sweep has {len(entries)} axes", f"keep it to {MOST_AXES}")
        return ()
    axes: list[PointAxis] = []
    names_seen: set[str] = set()
    for holder, names in entries:
        columns: list[list[Node]] = []
        for name in names:
            known = _is_axis(name, holder, root, model, problems)
            values = axis_values(name, holder.value[name], model, problems) if known else None
            if name in names_seen:
                problems.add((holder.keys or {})[name], f"'{name}' is an axis twice", "remove one of the two")
            elif known and values is not None:
                columns.append(values)
            names_seen.add(name)
        if len(columns) < len(names):
            continue
        if len({len(column) for column in columns}) > 1:
            problems.add(holder.mark, "keys that move together need as many values each", "give as many values of each")
            continue
        units = tuple(unit_of(model, name.split("."), column) for name, column in zip(names, columns, strict=True))
        axes.append(PointAxis(names, tuple(zip(*columns, strict=True)), units))
    count = 1
    for axis in axes:
        count *= len(axis.nodes)
    if count > MOST_POINTS:
        problems.add(sweep.mark, f"the sweep has {count} points", f"keep it to {MOST_POINTS}")
    return tuple(axes)


def points_of(root: Node, axes: tuple[PointAxis, ...]) -> list[tuple[tuple[int, ...], Node]]:
    """Every point's indices and the study's tree with its values put in, the last axis fastest."""
    found = []
    for index in product(*(range(len(axis.nodes)) for axis in axes)):
        tree = root
        for axis, place in zip(axes, index, strict=True):
            for name, node in zip(axis.names, axis.nodes[place], strict=True):
                tree = tree.replaced(name.split("."), node)
        found.append((index, tree))
    return found


def point_label(axes: tuple[PointAxis, ...], values: Mapping[str, float | str]) -> str:
    """The swept values of a point in the units of the study: "mesh.size = 5 cm"; empty where nothing is swept."""
    units = {name: unit for axis in axes for name, unit in zip(axis.names, axis.units, strict=True)}
    return ", ".join(f"{name} = {units[name].text(value)}" for name, value in values.items())


def _is_axis(name: str, holder: Node, root: Node, model: type[BaseModel], problems: Problems) -> bool:
    mark = (holder.keys or {})[name]
    path = name.split(".")
    if path[0] in _FIXED:
        problems.add(mark, f"'{name}' cannot be an axis", "run one study for each value")
        return False
    for place, step in enumerate(path):
        known = keys_at(model, path[:place], root)
        if step not in known:
            problems.add(mark, f"sweep axis '{name}': no key '{step}'", nearest(step, known))
            return False
    below = keys_at(model, path, root)
    if len(below) > 0 and set(below) != set(keys_at(model, path[:-1], root)):
        problems.add(mark, f"sweep axis '{name}' is a whole section", f"name one value in it, e.g. `{name}.{below[0]}`")
        return False
    return True
