"""A study at chosen points: one more axis, on which all keys that vary move together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.study.study import Study
from pounding_cli.study.text.file import get
from pounding_cli.study.vary.axes import UNWRITTEN, Axis
from pounding_cli.study.vary.inputs import UncertainInput
from pounding_cli.tables import Column

if TYPE_CHECKING:
    import pandas as pd


def study_at_points(
    study: Study, inputs: Sequence[UncertainInput], points: np.ndarray, and_written: bool = False
) -> Study:
    """Return the study with one more axis, its last, of some points.

    inputs : what varies
    points : u of every input, between 0 and 1, shape (points, inputs); no two come to the same values
    and_written : one more point, the last, stands for the study as it is written

    Raises
    ------
    InputError : the study is not sound at one of them
    """
    members = [member for each in inputs for member in each.members]
    rows = key_values_at(inputs, points)
    if and_written:
        values_of_study = [get(study.tree, *member.key.split(".")) for member in members]
        rows.append(tuple(UNWRITTEN if value is None else value for value in values_of_study))
    names = tuple(member.key for member in members)
    marks = tuple(member.mark for member in members)
    units = tuple(member.unit for member in members)
    axis = Axis(names, rows, [marks] * len(rows), units)
    return study.with_axes((*study.axes, axis))


def key_values_at(inputs: Sequence[UncertainInput], points: np.ndarray) -> list[tuple[object, ...]]:
    """Return the values at points as the study writes them, one for every key; points as in `study_at_points`."""
    columns = [member.values(u) for each, u in zip(inputs, points.T, strict=True) for member in each.members]
    return list(zip(*columns, strict=True)) or [()] * len(points)


def build_key_frame(inputs: Sequence[UncertainInput], points: np.ndarray) -> tuple[pd.DataFrame, list[Column]]:
    """Return the values of every key at points, a column a key, and the columns in the units that people read them in.

    points : as in `study_at_points`
    """
    import pandas as pd

    values: dict[str, Any] = {}
    columns = []
    for each, u in zip(inputs, points.T, strict=True):
        for member in each.members:
            values[member.key] = member.to_column(u)
            unit = replace(member.unit, si=member.column_unit) if member.column_unit else Unit()
            columns.append(Column(member.key, f"varies: {member.key}", unit))
    return pd.DataFrame(values), columns


def find_distinct_points(inputs: Sequence[UncertainInput], points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points that differ in the values of keys, in the order in which they come first, shape (n, inputs);
    and of every point its place among them, shape (points,)."""
    first: dict[str, int] = {}
    places = np.array([first.setdefault(repr(values), len(first)) for values in key_values_at(inputs, points)])
    _, first_points = np.unique(places, return_index=True)
    return points[first_points], places
