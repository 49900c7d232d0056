"""A study at chosen points: one more axis, on which all keys that vary move together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.study.axes import UNWRITTEN, SweepAxis
from pounding_cli.study.file import Mark, get
from pounding_cli.study.study import Study
from pounding_cli.study.vary import Factor

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
        found = [get(study.root, *member.key.split(".")) for member in members]
        written = tuple(UNWRITTEN if value is None else value for value in found)
    given = _Given(factors, points, written)
    marks = _Same(tuple(member.mark for member in members), len(given))
    axis = SweepAxis(tuple(member.key for member in members), given, marks, tuple(member.unit for member in members))
    try:
        return Study(study.path, study.text, study.root, axis, study.reader, written=study)
    except InputError as error:
        raise _few(error, len(points)) from None


class _Same(Sequence[tuple[Mark, ...]]):
    """One thing, so many times."""

    def __init__(self, each: tuple[Mark, ...], count: int) -> None:
        self._each, self._count = each, count

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, place: Any) -> Any:
        return self._each


class _Given(Sequence[tuple[Any, ...]]):
    """What stands in the study at every point, made when it is looked at: held as numbers, which workers share; objects
    would be copied into each of them."""

    def __init__(self, factors: Sequence[Factor], points: np.ndarray, written: tuple[Any, ...] | None = None) -> None:
        self._factors, self._points, self._written = factors, points, written
        self._last: tuple[int, tuple[Any, ...]] = (-1, ())  # every section of the study asks for its key in turn

    def __len__(self) -> int:
        return len(self._points) + (self._written is not None)

    def __getitem__(self, place: Any) -> Any:
        place = range(len(self))[place]
        if self._written is not None and place == len(self._points):
            return self._written
        if place != self._last[0]:
            row = zip(self._factors, self._points[place].tolist(), strict=True)
            self._last = place, tuple(member.value(u) for factor, u in row for member in factor.members)
        return self._last[1]


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
            repr(member.value(u)) for factor, u in zip(factors, row, strict=True) for member in factor.members
        )
        if values not in first:
            first[values] = len(kept)
            kept.append(number)
        places[number] = first[values]
    return points[kept], places
