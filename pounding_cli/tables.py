"""Tables: numbers in SI and texts, which become cells only where a table is shown."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pounding_cli.numbers import NOTHING, Unit, format_number
from pounding_cli.text_tables import TextTable
from pounding_cli.texts import escape_formulas

if TYPE_CHECKING:
    import pandas as pd

PAGE_ROWS = 400
"""Rows of a table that a page shows."""

TERMINAL_ROWS = 40
"""Rows of a table that a terminal prints."""

INFINITE = "∞"
"""Stands for an upper end that an interval does not have."""

Row = Mapping[Any, Any]
"""A row of a table: column -> number [SI] or text."""

FormatRow = Callable[[Row], str]


@dataclass(frozen=True)
class Column:
    """A column: its meaning, and the way from its numbers to cells.

    name : of the column in the frame
    text : its meaning
    unit : that people read it in; `unit.si` is "1" for a pure number, "" for a text
    label : its heading; its name unless given
    digits : significant digits of a cell; 0 for a count
    low, high : columns with the ends of its interval; "" without one
    error : column with its standard error; "" without one
    otherwise : cell of a row without a number; `NOTHING` unless given
    write : the whole cell of a row, in place of the number
    below : second line of a cell, such as where a maximum occurs
    optional : whether a terminal that is too narrow leaves the column out
    is_right : whether cells that `write` makes are numbers, which are aligned to the right
    is_given : whether the numbers are those of the study, which are shown as it writes them: 5, not 5.000
    """

    name: str
    text: str = ""
    unit: Unit = field(default_factory=Unit)
    label: str = ""
    digits: int = 4
    low: str = ""
    high: str = ""
    error: str = ""
    otherwise: FormatRow | None = None
    write: FormatRow | None = None
    below: FormatRow | None = None
    optional: bool = False
    is_right: bool = False
    is_given: bool = False

    @property
    def head(self) -> str:
        """The label with its unit."""
        return self.unit.label(self.label or self.name)

    def cell(self, row: Row) -> str:
        """Return the cell of a row: text, number with its interval or error, or why there is no number."""
        first = self.write(row) if self.write else self._format_value(row)
        second = self.below(row) if self.below else ""
        return f"{first}\n{second}" if second else first

    def format(self, value: float) -> str:
        """Return one number of the column [SI] in its unit, without the name of the unit."""
        if self.digits == 0 and math.isfinite(value):
            return f"{value / self.unit.factor:.0f}"
        if self.is_given and math.isfinite(value):
            number = self.unit.number(value)
            short = f"{number:.{self.digits}g}"
            if float(short) == number and "e" not in short:
                return short.replace("-", "−")
        return format_number(value / self.unit.factor, self.digits)

    def format_with_unit(self, row: Row) -> str:
        """Return the cell of a row with the name of the unit, for a sentence."""
        value = row[self.name]
        is_number = not isinstance(value, str) and math.isfinite(value)
        return f"{self._format_value(row)} {self.unit.name}".rstrip() if is_number else self._format_value(row)

    def _format_value(self, row: Row) -> str:
        value = row[self.name]
        if value is None or isinstance(value, str):
            return value or ""
        if type(value).__name__ in ("bool", "bool_"):
            return "yes" if value else "no"
        if not math.isfinite(value):
            return self.otherwise(row) if self.otherwise else NOTHING
        if isinstance(value, int) and self.unit.factor == 1:
            return str(value)
        text = self.format(value)
        if self.low and math.isfinite(row[self.low]):
            return f"{text} ({self.format(row[self.low])} to {self._format_end(row[self.high])})"
        if self.error and row[self.error] > 0:
            return f"{text} ± {format_number(row[self.error] / self.unit.factor, 2)}"
        return text

    def _format_end(self, value: float) -> str:
        """Return the upper end of an interval, which may be infinite."""
        return INFINITE if value == math.inf else self.format(value)


@dataclass(frozen=True, eq=False)
class Table:
    """A table.

    name : of the table in a results file; "" for one that is shown and not kept
    frame : numbers in SI units, and texts
    columns : those that are shown, in their order; the frame may have more, which cells are made from
    caption : above the table
    """

    name: str
    frame: pd.DataFrame
    columns: Sequence[Column]
    caption: str = ""

    def column(self, name: str) -> Column:
        """Return a column by its name.  Raises KeyError: there is none."""
        for column in self.columns:
            if column.name == name:
                return column
        raise KeyError(name)

    def has(self, name: str) -> bool:
        """Return whether the table has a column."""
        return any(column.name == name for column in self.columns)

    def view(
        self,
        *wanted: str | Column,
        frame: pd.DataFrame | None = None,
        caption: str = "",
        varying: Iterable[str] = (),
        name: str = "",
    ) -> Table:
        """Return another view of the table.

        wanted : its columns, by name or as they are to be shown
        frame : rows in place of all rows
        varying : columns before these that are shown where they differ from row to row
        name : of the view, which is written to a file of its own then
        """
        frame = self.frame if frame is None else frame
        before = [each for each in varying if each in frame and len(frame[each].unique()) > 1]
        columns = [self.column(each) if isinstance(each, str) else each for each in (*before, *wanted)]
        return Table(name, frame, columns, caption or self.caption)

    def with_columns(self, **changes: Mapping[str, Any]) -> Table:
        """Return the table with other properties of some columns: `with_columns(mean={"label": "average"})`."""
        columns = [replace(each, **changes[each.name]) if each.name in changes else each for each in self.columns]
        return replace(self, columns=columns)

    def cells(self, max_rows: int | None = None) -> list[list[str]]:
        """Return the first rows as texts in the units of the columns."""
        frame = self.frame if max_rows is None else self.frame.head(max_rows)
        rows = frame.to_dict("records")
        return [[column.cell(row) for column in self.columns] for row in rows]

    def heads(self) -> list[str]:
        """Return the headings of the columns, with their units."""
        return [column.head for column in self.columns]

    def are_right_aligned(self) -> list[bool]:
        """Return for every column but the first whether it has numbers without a second line or sentences."""
        return [bool(place) and self._is_numeric(column) for place, column in enumerate(self.columns)]

    def _is_numeric(self, column: Column) -> bool:
        if column.is_right:
            return True
        if column.write or column.below or column.name not in self.frame:
            return False
        values = self.frame[column.name]
        if values.dtype.kind not in "iuf":
            return False
        if column.otherwise is None:
            return True
        without = self.frame[~(abs(values) < math.inf)].head(TERMINAL_ROWS).to_dict("records")
        return not any(" " in column.otherwise(row) for row in without)

    def to_text_table(self, max_rows: int = TERMINAL_ROWS) -> TextTable:
        """Return the first rows as texts for a terminal."""
        rows = tuple(tuple(row) for row in self.cells(max_rows))
        return TextTable(
            self.caption,
            tuple(self.heads()),
            tuple(self.are_right_aligned()),
            rows,
            len(self.frame) - len(rows),
            tuple(column.optional for column in self.columns),
        )

    def to_text(self, width: int | None = None, max_rows: int = TERMINAL_ROWS) -> str:
        """Return the table as lines of a terminal of so many characters."""
        return self.to_text_table(max_rows).lay_out(width)

    def to_csv(self, folder: Path) -> Path:
        """Write all rows with all digits in SI to a file of the table's name; return the file."""
        path = folder / f"{self.name}.csv"
        names = [column.name for column in self.columns if column.name in self.frame]
        escape_formulas(self.frame[names]).to_csv(path, index=False)
        return path


def table_of_texts(caption: str, heads: Sequence[str], rows: Sequence[Sequence[Any]], name: str = "") -> Table:
    """Return a table of rows under some headings, shown as they are; headings may be alike."""
    import pandas as pd

    frame = pd.DataFrame([list(row) for row in rows], columns=[f"column {place}" for place in range(len(heads))])
    columns = [Column(f"column {place}", label=head) for place, head in enumerate(heads)]
    return Table(name, frame, columns, caption)


def build_table(
    name: str,
    frame: pd.DataFrame,
    declared: Sequence[Column],
    units: Mapping[str, Unit] | None = None,
    caption: str = "",
) -> Table:
    """Return a table of a frame whose columns are declared.

    declared : columns in any order, at least those of the frame
    units : column -> the unit that people read it in, where a study decides it

    Raises KeyError: a column of the frame is not declared.
    """
    known = {column.name: column for column in declared}
    units = units or {}
    columns = [replace(known[str(key)], unit=units.get(str(key), known[str(key)].unit)) for key in frame.columns]
    return Table(name, frame, columns, caption or name.replace("_", " ").capitalize())
