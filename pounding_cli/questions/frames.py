"""Frames of answers: the swept values at some points, and the columns that say where a row stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from pounding_cli.numbers import Unit
from pounding_cli.tables import Column
from pounding_cli.variables import COORDINATE_VARIABLES

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.study.vary.axes import Axis

PURE_NUMBER = Unit("", 1.0, "1")
"""Unit of a pure number."""

FOUND = "found"
"""Outcome of a search, or of the indices of an output, that has an answer."""

STATE_COLUMN = "state"
"""Column that tells buildings with pounding from the same building alone."""

ALONE = "alone"
WITH_POUNDING = "with pounding"
"""Values of STATE_COLUMN."""

PLACE_COLUMNS = (
    *(Column(name, text, Unit("", 1.0, si)) for name, (si, text) in COORDINATE_VARIABLES.items()),
    Column(STATE_COLUMN, f"`{ALONE}`, of the building by itself under the same motions, or `{WITH_POUNDING}`"),
)
"""Columns that say where the numbers of a row stand."""


def build_swept_frame(axes: Sequence[Axis], points: Sequence[Sequence[int]], **further: Sequence[Any]) -> pd.DataFrame:
    """Return the swept values at some points, a row a point and a column a key.

    points : of every row its index on every axis
    further : columns that say where something stands
    """
    import pandas as pd

    columns = {
        name: [axis.values[point[number]][key] for point in points]
        for number, axis in enumerate(axes)
        for key, name in enumerate(axis.names)
    }
    return pd.DataFrame(columns | further, index=range(len(points)))


def list_swept_columns(axes: Sequence[Axis]) -> list[Column]:
    """Return the columns of the swept keys, in the units of the study."""
    columns = []
    for axis in axes:
        for number, name in enumerate(axis.names):
            is_text = any(isinstance(values[number], str) for values in axis.values)
            unit = axis.units[number]
            unit = Unit(unit.name, unit.factor, "") if is_text else unit
            columns.append(Column(name, f"swept: {name}", unit, is_given=True))
    return columns


def list_estimate_columns(column: Column, interval: str = "interval") -> tuple[Column, Column, Column]:
    """Return a column with an interval, and the columns of both ends: `name`, `name_low`, `name_high`."""
    low = f"{column.name}_low"
    high = f"{column.name}_high"
    return (
        replace(column, low=low, high=high),
        _build_end(column, low, f"lower end of its {interval}", "low"),
        _build_end(column, high, f"upper end of its {interval}", "high"),
    )


def _build_end(column: Column, name: str, text: str, end: str) -> Column:
    """Return the column of one end of an interval, whose heading tells it from that of the number."""
    return replace(column, name=name, text=f"{column.text}: {text}", label=column.label and f"{column.label}, {end}")
