"""A study at chosen points: one more axis, on which all keys that vary move together."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import overload

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.study.load import Study, validated
from pounding_cli.study.source import UNWRITTEN, Node
from pounding_cli.study.sweep import SweepAxis
from pounding_cli.study.varied import Factor

MOST_TOLD = 3
"""Problems of samples that are told one by one."""


def at_points(study: Study, factors: Sequence[Factor], points: np.ndarray, and_written: bool = False) -> Study:
    """The study with an axis, its last, of some points.

    factors : the keys that vary
    points : u of every factor, between 0 and 1, shape (points, factors); no two come to the same values
    and_written : whether one more point, the last, stands for the study as it is written

    Raises
    ------
    InputError : the study is not sound at one of them
    """
    members = [member for factor in factors for member in factor.members]
    written = None
    if and_written:
        paths = ([int(step) if step.isdigit() else step for step in member.key.split(".")] for member in members)
        written = tuple(study.resolver.root.get(*path) or UNWRITTEN for path in paths)
    axis = SweepAxis(
        tuple(member.key for member in members), _Nodes(factors, points, written), tuple(m.unit for m in members)
    )
    try:
        found = validated(study.path, study.text, study.resolver.root, axis, study.resolver.reader)
    except InputError as error:
        raise _few(error, len(points)) from None
    return dataclasses.replace(found, warnings=study.warnings, from_data=study.from_data, written=study)


class _Nodes(Sequence[tuple[Node, ...]]):
    """What stands in the study at every point, made when it is looked at: held as numbers, which workers share; objects
    would be copied into each of them."""

    def __init__(self, factors: Sequence[Factor], points: np.ndarray, written: tuple[Node, ...] | None = None) -> None:
        self._factors, self._points, self._written = factors, points, written
        self._last: tuple[int, tuple[Node, ...]] = (-1, ())  # every section of the study asks for its key in turn

    def __len__(self) -> int:
        return len(self._points) + (self._written is not None)

    @overload
    def __getitem__(self, place: int) -> tuple[Node, ...]: ...

    @overload
    def __getitem__(self, place: slice) -> list[tuple[Node, ...]]: ...

    def __getitem__(self, place: int | slice) -> tuple[Node, ...] | list[tuple[Node, ...]]:
        if isinstance(place, slice):
            return [self[number] for number in range(*place.indices(len(self)))]
        last, nodes = self._last
        place = range(len(self))[place]
        if self._written is not None and place == len(self._points):
            return self._written
        if place != last:
            row = zip(self._factors, self._points[place].tolist(), strict=True)
            nodes = tuple(member.node(u) for factor, u in row for member in factor.members)
            self._last = place, nodes
        return nodes


def _few(error: InputError, points: int) -> InputError:
    """The first problems of many samples, which are mostly one."""
    told = error.problems[:MOST_TOLD]
    if len(told) == len(error.problems):
        return error
    first = told[0]
    hint = "narrow the ranges so that every sample is sound"
    more = Problem(f"and more problems like these at {points} samples", hint, first.file, first.line, first.column)
    return InputError([*told, more])


def distinct(factors: Sequence[Factor], points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The points that differ in what stands in the study, in the order in which they come first, shape (n, factors);
    and of every point its place among them, shape (points,)."""
    first: dict[tuple[str, ...], int] = {}
    kept: list[int] = []
    places = np.empty(len(points), dtype=int)
    for number, row in enumerate(points.tolist()):
        values = tuple(
            repr(member.node(u).plain()) for factor, u in zip(factors, row, strict=True) for member in factor.members
        )
        if values not in first:
            first[values] = len(kept)
            kept.append(number)
        places[number] = first[values]
    return points[kept], places
