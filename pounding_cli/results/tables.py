"""A table: rows in SI units, with the units that people read and the meaning of every column."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.numbers import Unit

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.study.plan import Axis


@dataclass(frozen=True, eq=False)
class Column:
    """A column of a table that is being made.

    name : of the column
    data : numbers in SI units, or texts; shape (rows,)
    text : what it means
    unit : SI unit, "1" for a pure number, "" for a text
    shown : unit that people read it in; SI unless given
    """

    name: str
    data: np.ndarray
    text: str
    unit: str = ""
    shown: Unit | None = None


@dataclass(frozen=True, eq=False)
class Table:
    """A table.

    name : of the table
    frame : its columns, in SI units
    meanings : of every column, unit (SI; "1" for a pure number, "" for a text) and meaning
    units : of some columns, the unit that people read them in
    """

    name: str
    frame: pd.DataFrame
    meanings: dict[str, tuple[str, str]] = field(default_factory=dict)
    units: dict[str, Unit] = field(default_factory=dict)

    @classmethod
    def of(cls, name: str, columns: Sequence[Column]) -> Table:
        """A table of columns of one length."""
        import pandas as pd

        frame = pd.DataFrame({column.name: column.data for column in columns})
        meanings = {column.name: (column.unit, column.text) for column in columns}
        return cls(name, frame, meanings, {column.name: column.shown for column in columns if column.shown is not None})


def place_columns(axes: Sequence[Axis], places: Sequence[tuple[int, ...]]) -> list[Column]:
    """The columns that say at which point of the sweep a row stands, one for each swept key.

    axes : of the sweep
    places : of every row its index on every axis
    """
    columns = []
    for number, axis in enumerate(axes):
        points = axis.values
        for key, name in enumerate(axis.names):
            values = [points[place[number]][key] for place in places]
            is_text = any(isinstance(value, str) for value in values)
            found = np.array([str(v) for v in values], dtype=object) if is_text else np.array(values, float)
            unit = axis.unit(key)
            columns.append(Column(name, found, f"swept: {name}", "" if is_text else unit.si, unit))
    return columns
