"""Values that depend on some axes of a sweep, and functions of such values."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.study.text.issues import Issues

T = TypeVar("T", covariant=True)
R = TypeVar("R")

Point = tuple[int, ...]
"""A point of the sweep: the place of its value on every axis, from 0; AS_WRITTEN for what the file itself has."""

AS_WRITTEN = -1


@dataclass(frozen=True, eq=False)
class Swept(Generic[T]):
    """A value at every point of the axes that it depends on.

    Parameters
    ----------
    axes : numbers of these axes, rising
    values : one value for each of their points, shape (length of each of these axes...); None where something is wrong
    """

    axes: tuple[int, ...]
    values: np.ndarray

    def value_at(self, point: Point) -> T:
        """Return the value at a point of the whole sweep."""
        value: T = self.values[tuple([point[axis] for axis in self.axes])]
        return value

    @property
    def is_sound(self) -> bool:
        """True if nothing is wrong with it at any point."""
        return all(value is not None for value in self.values.flat)

    def spread(self, axes: Iterable[int]) -> np.ndarray:
        """Return the values over other axes: all on which it depends, and each of the others one long."""
        sizes = dict(zip(self.axes, self.values.shape, strict=True))
        return self.values.reshape([sizes.get(axis, 1) for axis in axes])

    def iter_values(self) -> Iterator[tuple[Point, T]]:
        """Yield every different value once, with the first point of its axes at which it stands."""
        seen: set[int] = set()
        for index, value in zip(np.ndindex(self.values.shape), self.values.flat, strict=True):
            if id(value) not in seen:
                seen.add(id(value))
                yield index, value

    def merge_equal(self) -> Swept[T]:
        """Return the same values on the axes along which they differ; equal values become one object.

        The values must be hashable.
        """
        first: dict[Any, Any] = {}
        merged = [first.setdefault(value, value) for value in self.values.flat]
        values = build_object_array(merged, self.values.shape)
        identities = np.array([id(value) for value in merged]).reshape(values.shape)
        axes = list(self.axes)
        for place in reversed(range(len(axes))):
            if (identities == identities.take([0], axis=place)).all():
                values = values.take(0, axis=place) if values.ndim > 1 else build_object_array([values[0]], ())
                identities = identities.take(0, axis=place)
                del axes[place]
        return Swept(tuple(axes), values)


def build_object_array(values: Sequence[Any], shape: tuple[int, ...]) -> np.ndarray:
    """Return an array of objects; shape : whose product is the number of the values."""
    flat = np.empty(len(values), object)
    for number, value in enumerate(values):
        flat[number] = value
    return flat.reshape(shape)


def build_constant(value: R) -> Swept[R]:
    """Return a value that depends on no axis."""
    return Swept((), build_object_array([value], ()))


def sweep_map(build: Callable[..., R], *parts: Swept[Any], issues: Issues | None = None) -> Swept[R]:
    """Return `build(*values)` at every point of the axes that one of the parts depends on.

    Points at which all parts have the same objects (the same, not equal ones: see `merge_equal`) share one result.
    Where a part is None, as something is wrong with it, the result is None.

    Parameters
    ----------
    build : of the values of all parts at a point; may raise InputError, which is noted with the point
    issues : where to note these; raised unless given
    """
    axes = tuple(sorted({axis for part in parts for axis in part.axes}))
    views = np.broadcast_arrays(*(part.spread(axes) for part in parts))
    shape = views[0].shape
    built: dict[tuple[int, ...], tuple[R | None, tuple[Any, ...]]] = {}
    results: list[R | None] = []
    for index, values in zip(np.ndindex(shape), zip(*(view.flat for view in views), strict=True), strict=True):
        key = tuple(map(id, values))
        if key not in built:
            built[key] = _build(build, values, raises=issues is None)
        result, found = built[key]
        if found and issues is not None:
            issues.add(axes, index, found)
        results.append(result)
    return Swept(axes, build_object_array(results, shape))


def _build(build: Callable[..., R], values: tuple[Any, ...], raises: bool) -> tuple[R | None, tuple[Any, ...]]:
    """Return a result and what is wrong with it."""
    if any(value is None for value in values):
        return None, ()
    try:
        return build(*values), ()
    except InputError as refused:
        if raises:
            raise
        return None, refused.issues
