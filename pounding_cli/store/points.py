"""Points of a model of its own in a results file: their variables over the sweep, their table, one point read back."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import islice
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.store.answers import Column, Read, Table, place_columns
from pounding_cli.store.blocks import Block
from pounding_cli.store.codec import decode, parse
from pounding_cli.store.dense import Shape, empty
from pounding_cli.store.files import opened
from pounding_cli.store.parts import PartStore
from pounding_cli.store.structure import strings
from pounding_cli.variables import POINTS, Variable
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    from pounding_cli.solver.response import PointResponse
    from pounding_cli.store.results import Results
    from pounding_cli.study import Plan

_SHOWN = {
    "N": Unit("kN", 1e3, "N"), "N s": Unit("kN s", 1e3, "N s"), "N m": Unit("kN m", 1e3, "N m"),
    "N/m2": Unit("N/mm²", 1e6, "N/m2"), "s": Unit("ms", 1e-3, "s"),
}  # fmt: skip
"""SI unit -> the unit that the numbers of a point are read in."""

_AT_ONCE = 16
"""Points in memory while they are written."""


def variables_of(workflow: str) -> dict[str, Variable]:
    """Every variable of the points of a workflow, by name."""
    return {v.name: v for v in (*WORKFLOWS[workflow].part("variables"), *POINTS)}


def is_coordinate(variable: Variable) -> bool:
    """Whether a variable is the same at all points, and stands along a dimension of its own name."""
    return variable.dims == (variable.name,)


def shape_of_points(plan: Plan, responses: PartStore) -> Shape:
    """The dimensions of a plan of points that are all in `responses`, those of the largest point."""
    axes = tuple(axis.names[0] for axis in plan.axes)
    shapes = [parse(line).shapes for line in responses.lines(plan.scenes)[0]]
    sizes = dict.fromkeys((dim for v in variables_of(plan.workflow).values() for dim in v.dims), 0)
    for variable in variables_of(plan.workflow).values():
        for place, dim in enumerate(variable.dims):
            sizes[dim] = max(sizes[dim], *(found[variable.name][place] for found in shapes if found), 0)
    sizes |= {name: len(axis.values) for name, axis in zip(axes, plan.axes, strict=True)}
    return Shape(axes, sizes, ())


def coordinates(plan: Plan, responses: PartStore, shape: Shape) -> Iterator[tuple[str, np.ndarray, str, str]]:
    """(dimension, values, unit, meaning) of every dimension of the points: a variable, or the places from 0."""
    variables = variables_of(plan.workflow)
    done = next((digest for digest in plan.scenes if responses.header(digest).is_done), None)
    values = {} if done is None else cast("PointResponse", responses[done]).values
    for dim in dict.fromkeys(dim for variable in variables.values() for dim in variable.dims):
        if dim in variables:
            yield dim, values.get(dim, np.zeros(0)), variables[dim].unit, variables[dim].text
        else:
            yield dim, np.arange(shape.sizes[dim]), "1", f"{dim}, from 0"


def point_blocks(plan: Plan, responses: PartStore, shape: Shape) -> Iterator[Block]:
    """Every variable: the arrays point by point, those of smaller points padded; then what is one number a point."""
    variables = [v for v in variables_of(plan.workflow).values() if not is_coordinate(v)]
    single = {v.name: empty(v, (len(plan.rows),)) for v in variables if not v.dims}
    arrays = [v for v in variables if v.dims]
    for begin in range(0, len(plan.rows), _AT_ONCE):
        some = plan.rows[begin : begin + _AT_ONCE]
        for number, (row, (line, numbers)) in enumerate(
            zip(some, responses.take([row.scene for row in some]), strict=True), start=begin
        ):
            response = decode(line, numbers)
            values = _facts(row.scene, response) | response.values
            for name, column in single.items():
                column[number] = values.get(name, column[number])
            yield Block(row.point, {v.name: _padded(v, values.get(v.name), shape) for v in arrays})
    whole = shape.of(shape.axes)
    yield Block((), {name: column.reshape(whole) for name, column in single.items()})


def _facts(scene: str, response: PointResponse) -> dict[str, Any]:
    return {
        "status": response.status, "advice": response.advice, "flags": "\n".join(response.flags),
        "seconds": response.seconds, "scene": scene,
    }  # fmt: skip


def _padded(variable: Variable, values: np.ndarray | None, shape: Shape) -> np.ndarray:
    whole = empty(variable, shape.of(variable.dims))
    if values is not None:
        whole[tuple(map(slice, values.shape))] = values
    return whole


def point_tables(plan: Plan, read: Read, _responses: object) -> list[Table]:
    """One table, named like the workflow: of every point of the sweep what is one number."""
    columns = place_columns(plan.axes, [row.point for row in plan.rows])
    for variable in variables_of(plan.workflow).values():
        if not variable.dims and variable.name not in ("scene", "advice"):
            data = np.atleast_1d(read(variable.name)).ravel()
            data = np.array([text.decode() for text in data], object) if variable.kind == "s" else data
            shown = None if variable.name == "seconds" else _SHOWN.get(variable.unit)
            columns.append(Column(variable.name, data, variable.text, variable.unit, shown))
    return [Table(plan.workflow, [columns])]


class Point(NamedTuple):
    """A point of the sweep: its index on every axis, in words, and its variables with their facts.

    values : numbers and arrays, as long as they are at this point; of a point that failed NaN and no arrays
    """

    place: tuple[int, ...]
    label: str
    values: dict[str, Any]


def read_points(results: Results, most: int | None = None) -> Iterator[Point]:
    """The points of a results file in their order, the first `most` unless None.  Raises `InputError` as `opened`."""
    nothing = {v.name: math.nan for v in variables_of(results.workflow).values() if not v.dims}
    with opened(results.path) as file:
        group, scenes = file["solutions"], np.atleast_1d(strings(file["scene"]))
        lines, words = strings(group["line"]), group["words"][:]
        starts = np.cumsum([0, *(parse(lines[word]).size for word in words)])
        numbers = {digest.decode(): number for number, digest in enumerate(group["digest"][:])}
        for place in islice(np.ndindex(file["scene"].shape), most):
            scene = str(scenes[place or (0,)])
            number = numbers[scene]
            found = decode(lines[words[number]], group["numbers"][starts[number] : starts[number + 1]])
            values = {name: value if value.ndim else float(value) for name, value in found.values.items()}
            yield Point(place, results.point_label(place), nothing | _facts(scene, found) | values)
