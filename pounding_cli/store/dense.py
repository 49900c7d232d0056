"""What a results file says of points and cases, whatever the scenes did: sizes, links, buildings, motions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.model.links import APART, LinkPlace, ends_on_columns
from pounding_cli.store.packed import Slabs
from pounding_cli.variables import BUILDINGS, LINKS, OF_COLUMNS, PLACE, RECORDS, Variable

if TYPE_CHECKING:
    from pounding_cli.store.parts import PartStore
    from pounding_cli.study import Plan

Data = dict[str, tuple[tuple[str, ...], Slabs]]
"""Variable -> (dimensions, array)."""

Pieces = dict[str, list[np.ndarray]]
"""Variable -> arrays that stand side by side behind the swept axes; of size 1 along one that leaves them alone."""


@dataclass(frozen=True)
class Shape:
    """The dimensions of a study.

    axes : dimension name of every swept axis
    sizes : size of every dimension
    links : the link dimension, place by place
    """

    axes: tuple[str, ...]
    sizes: dict[str, int]
    links: tuple[LinkPlace, ...]

    def of(self, dims: tuple[str, ...]) -> tuple[int, ...]:
        """The sizes of some dimensions."""
        return tuple(self.sizes[dim] for dim in dims)

    @cached_property
    def left_out(self) -> tuple[str, ...]:
        """Variables that say nothing in this study."""
        return () if any(map(ends_on_columns, self.links)) else OF_COLUMNS

    @property
    def rows(self) -> tuple[int, ...]:
        """The sizes along the rows: swept axes, case, analysis, record."""
        return self.of((*self.axes, *PLACE))


def shape_of(plan: Plan, responses: PartStore) -> Shape:
    """The dimensions of a plan whose scenes are all in `responses`."""
    axes = tuple(axis.names[0] for axis in plan.axes)
    links = tuple(sorted({link.place for some in plan.rows.sets.layouts for link in some}))
    sizes = {name: len(axis.values) for name, axis in zip(axes, plan.axes, strict=True)}
    sizes |= {"case": len(plan.cases), "analysis": len(plan.analyses), "record": len(plan.records)}
    storeys = responses.storeys(plan.scenes)
    sizes |= {"building": len(plan.buildings), "storey": storeys, "floor": storeys, "link": len(links)}
    return Shape(axes, sizes, links)


def empty(variable: Variable, shape: tuple[int, ...]) -> np.ndarray:
    """An array of a variable with nothing in it."""
    if variable.kind == "s":
        return np.full(shape, "", dtype=object)
    return np.zeros(shape, np.int64) if variable.kind == "i" else np.full(shape, np.nan)


def facts(plan: Plan, shape: Shape) -> Data:
    """The variables of links, of buildings and of motions; the latter two without the axes that leave them alone."""
    return _links(plan, shape) | _buildings(plan, shape) | _records(plan, shape)


def _links(plan: Plan, shape: Shape) -> Data:
    numbers = plan.rows.links.reshape(shape.of((*shape.axes, "case")))  # the same for every analysis and record
    places = {place: number for number, place in enumerate(shape.links)}

    def made(variable: Variable, at: tuple[slice, ...]) -> np.ndarray:
        some = numbers[at[:-1]]
        array = empty(variable, (some.size, len(places)))
        for links, points, gaps in plan.rows.sets.alike(some.ravel()):
            for number, link in enumerate(links):
                if variable.name != "gap":
                    array[points, places[link.place]] = getattr(link, variable.name)
                elif link.kind != APART:
                    array[points, places[link.place]] = gaps[:, number]
        return array.reshape(*some.shape, len(places))[..., at[-1]]

    found = {}
    for variable in LINKS:
        if variable.name not in shape.left_out:
            dims = (*shape.axes, *variable.dims)
            found[variable.name] = dims, Slabs(shape.of(dims), empty(variable, (0,)).dtype, partial(made, variable))
    return found


def _buildings(plan: Plan, shape: Shape) -> Data:
    kept = _named(shape, plan.study.touching("buildings"))
    arrays: Pieces = {variable.name: [] for variable in BUILDINGS}
    for place in range(len(plan.buildings)):
        own = _named(shape, plan.study.touching("buildings", place))
        sizes = [shape.sizes[axis] if axis in own else 1 for axis in kept]
        mine = {v.name: empty(v, (*sizes, 1, *shape.of(v.dims[1:]))) for v in BUILDINGS if v.name != "separation"}
        for at, point in _points(shape, own):
            building = plan.study.building(point, place)
            indices = dict(zip(own, at, strict=True))
            there = (*(indices.get(axis, 0) for axis in kept), 0)
            for name in ("mass", "height", "stiffness", "yield_shear"):
                mine[name][there][: building.storeys] = getattr(building, name)
            mine["period"][there] = building.periods[0]
            mine["base_shear_ratio"][there] = building.base_shear_ratio
            mine["slab"][there] = building.slab
        for name, array in mine.items():
            arrays[name].append(array)
    separation = np.empty(shape.of((*kept, "building")))
    for at, point in _points(shape, kept):
        separation[at] = plan.study.separations(point)
    arrays["separation"].append(separation)
    return _without_constant_axes(kept, arrays, BUILDINGS, shape)


def _records(plan: Plan, shape: Shape) -> Data:
    kept = _named(shape, plan.study.touching("records"))
    arrays = {v.name: empty(v, shape.of((*kept, *v.dims))) for v in RECORDS}
    for at, point in _points(shape, kept):
        motions = plan.study.motions(point)
        for number, name in enumerate(plan.records):
            for variable in RECORDS:
                value = getattr(motions[name].use, variable.name.removeprefix("record_"))
                arrays[variable.name][(*at, number)] = value
    return _without_constant_axes(kept, {name: [array] for name, array in arrays.items()}, RECORDS, shape)


def _named(shape: Shape, chosen: tuple[bool, ...]) -> tuple[str, ...]:
    return tuple(axis for axis, is_chosen in zip(shape.axes, chosen, strict=True) if is_chosen)


def _points(shape: Shape, kept: tuple[str, ...]) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Every combination along the kept axes, and a point of the sweep that has it."""
    number = {axis: place for place, axis in enumerate(kept)}
    for at in np.ndindex(shape.of(kept)):
        yield at, tuple(at[number[axis]] if axis in number else 0 for axis in shape.axes)


def _without_constant_axes(
    axes: tuple[str, ...], arrays: Pieces, variables: tuple[Variable, ...], shape: Shape
) -> Data:
    """The variables without the swept axes that change none: a sweep of the gap leaves one building."""
    kept = list(axes)
    for axis in reversed(axes):
        number = kept.index(axis)
        first = {name: [piece.take([0], axis=number) for piece in pieces] for name, pieces in arrays.items()}
        both = ((one, piece) for name, pieces in arrays.items() for one, piece in zip(first[name], pieces, strict=True))
        if all(_same(np.broadcast_to(one, piece.shape), piece) for one, piece in both):
            arrays = {name: [piece.take(0, axis=number) for piece in pieces] for name, pieces in arrays.items()}
            kept.remove(axis)
    found = {}
    for variable in variables:
        dims, pieces = (*kept, *variable.dims), arrays[variable.name]
        found[variable.name] = dims, Slabs(shape.of(dims), pieces[0].dtype, partial(_joined, pieces, len(kept)))
    return found


def _joined(pieces: list[np.ndarray], axes: int, at: tuple[slice, ...]) -> np.ndarray:
    """A slab of an array whose pieces stand side by side behind its first axes, along which a piece may be constant."""
    swept, rest = at[:axes], at[axes:]
    sizes = tuple(each.stop - each.start for each in swept)
    there = []
    for piece in pieces:
        constant = (slice(None) if size == 1 else each for each, size in zip(swept, piece.shape, strict=False))
        there.append(np.broadcast_to(piece[tuple(constant)], (*sizes, *piece.shape[axes:])))
    return np.concatenate(there, axis=axes)[(*map(slice, sizes), *rest)]


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    return np.array_equal(one, other, equal_nan=one.dtype != object)
