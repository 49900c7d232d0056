"""What a results file says of points and cases, whatever the scenes did: sizes, links, buildings, motions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.model.links import APART, LinkPlace, ends_on_columns
from pounding_cli.variables import BUILDINGS, LINKS, OF_COLUMNS, PLACE, RECORDS, Variable

if TYPE_CHECKING:
    from pounding_cli.store.parts import PartStore
    from pounding_cli.study import Plan

"""Place of the left building, its floor, the floor of the right building."""

_POINTS = 1 << 15
"""Points and cases whose links are looked at together."""

Data = dict[str, tuple[tuple[str, ...], np.ndarray]]
"""Variable -> (dimensions, array)."""


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
    sets = plan.rows.sets.alike(np.unique(plan.rows.links))
    links = tuple(sorted({link.place for some, _, _ in sets for link in some}))
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


def facts(plan: Plan, shape: Shape) -> Iterator[Data]:
    """The variables of links, of buildings and of motions; the latter two without the axes that leave them alone."""
    yield from _links(plan, shape)
    yield _buildings(plan, shape)
    yield _records(plan, shape)


def _links(plan: Plan, shape: Shape) -> Iterator[Data]:
    """One variable after another, each filled some points at a time: with a million points each takes 40 MB."""
    places = {place: number for number, place in enumerate(shape.links)}
    numbers = plan.rows.links  # the same for every analysis and record
    for variable in LINKS:
        if variable.name in shape.left_out:
            continue
        array = empty(variable, shape.of((*shape.axes, *variable.dims)))
        for begin in range(0, len(numbers) if array.size else 0, _POINTS):
            some = array.reshape(-1, len(shape.links))[begin : begin + _POINTS]
            for links, points, gaps in plan.rows.sets.alike(numbers[begin : begin + _POINTS]):
                for number, link in enumerate(links):
                    if variable.name != "gap":
                        some[points, places[link.place]] = getattr(link, variable.name)
                    elif link.kind != APART:
                        some[points, places[link.place]] = gaps[:, number]
        yield {variable.name: ((*shape.axes, *variable.dims), array)}


def _buildings(plan: Plan, shape: Shape) -> Data:
    kept = _named(shape, plan.study.touching("buildings"))
    arrays = {v.name: empty(v, shape.of((*kept, *v.dims))) for v in BUILDINGS}
    for place in range(len(plan.buildings)):
        own = _named(shape, plan.study.touching("buildings", place))
        for at, point in _points(shape, own):
            building = plan.study.building(point, place)
            indices = dict(zip(own, at, strict=True))
            everywhere = tuple(indices.get(axis, slice(None)) for axis in kept)
            for name in ("mass", "height", "stiffness", "yield_shear"):
                arrays[name][(*everywhere, place, slice(building.storeys))] = getattr(building, name)
            arrays["period"][(*everywhere, place)] = building.periods[0]
            arrays["base_shear_ratio"][(*everywhere, place)] = building.base_shear_ratio
            arrays["slab"][(*everywhere, place)] = building.slab
    for at, point in _points(shape, kept):
        arrays["separation"][at] = plan.study.separations(point)
    return _without_constant_axes(kept, arrays, BUILDINGS)


def _records(plan: Plan, shape: Shape) -> Data:
    kept = _named(shape, plan.study.touching("records"))
    arrays = {v.name: empty(v, shape.of((*kept, *v.dims))) for v in RECORDS}
    for at, point in _points(shape, kept):
        motions = plan.study.motions(point)
        for number, name in enumerate(plan.records):
            for variable in RECORDS:
                value = getattr(motions[name].use, variable.name.removeprefix("record_"))
                arrays[variable.name][(*at, number)] = value
    return _without_constant_axes(kept, arrays, RECORDS)


def _named(shape: Shape, chosen: tuple[bool, ...]) -> tuple[str, ...]:
    return tuple(axis for axis, is_chosen in zip(shape.axes, chosen, strict=True) if is_chosen)


def _points(shape: Shape, kept: tuple[str, ...]) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Every combination along the kept axes, and a point of the sweep that has it."""
    number = {axis: place for place, axis in enumerate(kept)}
    for at in np.ndindex(shape.of(kept)):
        yield at, tuple(at[number[axis]] if axis in number else 0 for axis in shape.axes)


def _without_constant_axes(
    axes: tuple[str, ...], arrays: dict[str, np.ndarray], variables: tuple[Variable, ...]
) -> Data:
    """The variables without the swept axes that change none: a sweep of the gap leaves one building."""
    kept = list(axes)
    cut = {v.name: arrays[v.name] for v in variables}
    for axis in reversed(axes):
        number = kept.index(axis)
        first = {name: array.take([0], axis=number) for name, array in cut.items()}
        if all(_same(np.broadcast_to(first[name], cut[name].shape), cut[name]) for name in cut):
            cut = {name: array.take(0, axis=number) for name, array in cut.items()}
            kept.remove(axis)
    return {v.name: ((*kept, *v.dims), cut[v.name]) for v in variables}


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    return np.array_equal(one, other, equal_nan=one.dtype != object)
