"""Values to both sides of zero, `accidental: +-5 %`: an unknown value of the sweep, written where its key stands.

The tree is changed before anything reads it, so that axes, tables and sentences know unknown values only.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic_core import PydanticCustomError

from pounding_cli.study.schema.floor_plan import ACCIDENTAL
from pounding_cli.study.schema.quantity import BOTH_SIGNS, format_location
from pounding_cli.study.text.file import Items, Map, Mark, Problems, get, with_value
from pounding_cli.study.vary.axes import sweep_maps


def with_both_sides(root: Map, problems: Problems) -> Map:
    """Return the tree with an unknown value of the sweep, `{values: [-5 %, 0 %, 5 %], middle: 0 %}`, for every
    accidental eccentricity to both sides of a building, `+-5 %`. Note keys that the sweep has too."""
    for name, written, mark in list(_iter_both_sides(root)):
        path = ("buildings", name, "plan", "accidental")
        key = ".".join(path)
        holder = next((each for each in sweep_maps(root) if key in each), None)
        if holder is not None:
            at = format_location(holder.marks[key][0])
            message = f"accidental: '{get(root, *path)}' is an axis of the sweep, which also has '{key}' {at}"
            problems.add(mark, message, "remove one of the two")
        zero = "0 %" if written.endswith("%") else 0
        root = with_value(root, path, zero, mark)
        if holder is None:
            root = _add_unknown(root, key, [f"-{written}", zero, written], mark)
    return root


def _iter_both_sides(root: Map) -> Iterator[tuple[str, str, Mark]]:
    """Yield the name of every building with an accidental eccentricity to both sides, its size as written and its
    place."""
    buildings = get(root, "buildings")
    for name in buildings if isinstance(buildings, Map) else ():
        plan = get(buildings, name, "plan")
        value = get(plan, "accidental")
        match = BOTH_SIGNS.match(value) if isinstance(value, str) else None
        if match is None:
            continue
        try:
            is_size = ACCIDENTAL.read(match[1]) > 0.0
        except PydanticCustomError:
            continue  # it is refused where it stands
        if is_size:
            yield name, match[1], plan.marks["accidental"][1]


def _add_unknown(root: Map, key: str, values: list[Any], mark: Mark) -> Map:
    """Return the tree with an unknown value in its sweep, whose middle is the second of three values."""
    marks = {"values": (mark, mark), "middle": (mark, mark)}
    unknown = Map({"values": Items(values, mark, [mark] * len(values)), "middle": values[1]}, mark, marks)
    sweep = root.get("sweep")
    entry = Map({key: unknown}, mark, {key: (mark, mark)})
    if isinstance(sweep, Items):
        added: Any = Items([*sweep, entry], sweep.mark, [*sweep.marks, mark])
    elif isinstance(sweep, Map):
        added = Map({**sweep, **entry}, sweep.mark, {**sweep.marks, **entry.marks})
    elif sweep is None:
        added = entry
    else:
        return root  # which is refused
    _, sweep_mark = root.marks.get("sweep", (mark, mark))
    return Map({**root, "sweep": added}, root.mark, {**root.marks, "sweep": (sweep_mark, sweep_mark)})
