"""A study at chosen points: one more axis, on which all keys that vary move together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.study import Study
from pounding_cli.study.axes import UNWRITTEN, SweepAxis
from pounding_cli.study.file import get
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
    given = values_at(factors, points)
    if and_written:
        written = [get(study.root, *member.key.split(".")) for member in members]
        given.append(tuple(UNWRITTEN if value is None else value for value in written))
    marks = [tuple(member.mark for member in members)] * len(given)
    axis = SweepAxis(tuple(member.key for member in members), given, marks, tuple(member.unit for member in members))
    try:
        return Study(study.path, study.text, study.root, (*study.swept, axis), study.reader, written=study)
    except InputError as error:
        raise _few(error, len(points)) from None


def values_at(factors: Sequence[Factor], points: np.ndarray) -> list[tuple[object, ...]]:
    """What stands in the study at points, a value for every key; points as in `at_points`."""
    return [
        tuple(member.value(u) for factor, u in zip(factors, row, strict=True) for member in factor.members)
        for row in points.tolist()
    ]


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
    first: dict[str, int] = {}
    places = np.array([first.setdefault(repr(values), len(first)) for values in values_at(factors, points)])
    _, kept = np.unique(places, return_index=True)
    return points[kept], places
