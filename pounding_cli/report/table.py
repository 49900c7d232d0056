"""Tables as people read them in a terminal, on a page and in a notebook."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from pounding_cli.numbers import Unit
from pounding_cli.report.summary import TextTable
from pounding_cli.results import tables
from pounding_cli.results.tables import Column, Table
from pounding_cli.texts import escape_formulas

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

PAGE_ROWS = 400
"""Rows of a table that a page carries in full."""
TERMINAL_ROWS = 40
"""Rows of a table that a terminal prints."""
NOTHING = "–"
"""Stands where there is no number."""

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_NUMBER = re.compile(r"[-−+]?\d[\d.]*(×10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?( ±.*| \(.*\)| [^\s\d]\S{0,6})?$|[–-]?$")
"""A number with its error, interval or unit, or none."""


def digits(value: float, count: int = 4) -> str:
    """A number with `count` digits as text: 1.234, 12.34, 3.100×10⁻⁹; a dash for none."""
    if not math.isfinite(value):
        return NOTHING
    if value == 0:
        return "0"
    mantissa, power = f"{value:.{count - 1}e}".split("e")
    size = int(power)
    if -3 <= size < 6:
        return f"{value:.{max(count - 1 - size, 0)}f}".replace("-", "−")
    return f"{mantissa}×10{str(size).translate(_RAISED)}".replace("-", "−")


def interval(row: Mapping[Any, Any], name: str, end: str = "", factor: float = 1.0, unit: str = "") -> str:
    """A number of a row with the interval that stands in `name`_low and `name`_high: "1.23 (1.10 to 1.35) cm".

    end : of all three names; factor : SI of one of the unit shown
    """
    value, low, high = (row[f"{name}{which}{end}"] / factor for which in ("", "_low", "_high"))
    if not math.isfinite(value):
        return NOTHING
    said = digits(value, 3) + (f" ({digits(low, 3)} to {digits(high, 3)})" if math.isfinite(low) else "")
    return f"{said} {unit}".rstrip()


def texts(column: Column, values: pd.Series) -> list[str]:
    """The values of a column as people read them."""
    if pd.api.types.is_bool_dtype(values):
        return ["yes" if value else "no" for value in values]
    if not pd.api.types.is_numeric_dtype(values):
        return ["" if value is None or value != value else str(value) for value in values]
    numbers = values.to_numpy(float) / column.unit.factor
    whole = column.unit.name == "" and all(not math.isfinite(x) or x == round(x) for x in numbers)
    return [f"{x:.0f}" if whole and math.isfinite(x) else digits(x) for x in numbers]


def columns_in(table: Table) -> list[Column]:
    """How its columns are shown, in their order."""
    return [table.columns.get(name) or column_of(str(name)) for name in table.frame.columns]


def shown(table: Table, most: int | None = None) -> pd.DataFrame:
    """The first `most` rows as texts in the units of the columns, under heads with units."""
    frame, columns = table.frame if most is None else table.frame.head(most), columns_in(table)
    found = [texts(column, frame[name]) for column, name in zip(columns, frame.columns, strict=True)]
    return pd.DataFrame(dict(enumerate(found))).set_axis([column.head for column in columns], axis=1)


def to_csv(table: Table, folder: Path) -> Path:
    """Write all rows with all digits in SI; returns the file."""
    path = folder / f"{table.name}.csv"
    escape_formulas(table.frame).to_csv(path, index=False)
    return path


def to_text_table(table: Table, most: int = TERMINAL_ROWS) -> TextTable:
    """Return the first `most` rows as texts for a terminal."""
    found = shown(table, most)
    rows = tuple(found.itertuples(index=False, name=None))
    more = len(table.frame) - len(rows)
    return TextTable(table.caption, tuple(map(str, found.columns)), tuple(right_aligned(found)), rows, more)


def from_rows(caption: str, heads: Sequence[str], rows: Sequence[Sequence[Any]], name: str = "") -> Table:
    """A table of texts and numbers that are shown as they are; heads may be alike."""
    frame = pd.DataFrame([list(row) for row in rows], columns=range(len(heads)))
    columns: dict[Any, Column] = {number: Column(label=head) for number, head in enumerate(heads)}
    return Table(name, frame, columns, caption)


def from_records(caption: str, rows: Sequence[Mapping[Any, Any]]) -> Table:
    """The same of rows by heads."""
    return from_rows(caption, list(rows[0]) if rows else [], [list(row.values()) for row in rows])


def from_answer(
    results: ResultTables, caption: str, frame: pd.DataFrame, names: Sequence[str], some: Sequence[str],
    told: Callable[[Mapping[Any, Any]], dict[str, str]],
) -> Table:  # fmt: skip
    """The same of the rows of an answer: some columns, swept keys in the units of the study, of `some` those that are
    not the same in all rows, and by heading what is `told` of a row."""
    rows, keys = list[Mapping[str, str]](), [key for key in results.axes if key in frame]
    several = [name for name in some if len(frame[name].unique()) > 1]
    for row in frame.to_dict("records"):
        place = {name: str(row[name]) for name in names}
        place |= {results.units[key].label(key): results.value_label(key, row[key]) for key in keys}
        rows.append(place | {name: str(row[name]) for name in several} | told(row))
    return from_records(caption, rows)


def right_aligned(found: pd.DataFrame) -> list[bool]:
    """Of every column but the first whether it holds numbers, most of them without a second line."""
    aligned = [False]
    for place in range(1, found.shape[1]):
        column = found.iloc[:, place]
        numbers = sum(bool(_NUMBER.match(text)) for text in column)
        aligned.append(2 * numbers > len(column) and not any("\n" in text for text in column))
    return aligned


_UNITS = {"N": Unit("kN", 1e3), "m": Unit("mm", 1e-3), "J": Unit("kJ", 1e3), "N s": Unit("kN s", 1e3),
          "N/m": Unit("MN/m", 1e6), "kg": Unit("t", 1e3)}  # fmt: skip
"""SI unit -> the one that pages show."""
_OF_COLUMNS = {"seconds": Unit("ms", 1e-3), "contact_time": Unit("ms", 1e-3), "drift_ratio": Unit("%", 0.01),
               "height": Unit("m"), "window": Unit("s"), "period": Unit("s"), "arias": Unit("m/s")}  # fmt: skip
"""Columns that are shown in another unit than those of their kind."""


def column_of(name: str, units: Mapping[str, Unit] | None = None) -> Column:
    """What a column of a results file means, in the unit that pages show.

    units : column -> the unit the study writes it in (`Results.units`); it comes before the usual one
    """
    known = tables.column_of(name)
    unit = (units or {}).get(name) or _OF_COLUMNS.get(name) or _UNITS.get(known.unit.name, known.unit)
    return replace(known, unit=replace(unit, name=unit.name.replace("m/s2", "m/s²"), si=known.unit.si or unit.si))


def find_unit(results: ResultTables, table: str, name: str) -> Unit:
    """Return the unit that people read a column of a table of a results file in: that of the study, or kN and mm."""
    if table not in results.answers:
        return column_of(name, results.units).unit
    unit = results.column(table, name).unit
    is_si = unit.factor == 1 and unit.name == unit.si
    usual = _OF_COLUMNS.get(name) or _UNITS.get(unit.si)
    return replace(usual, si=unit.si) if is_si and usual else unit


def columns_of(frame: pd.DataFrame, units: Mapping[str, Unit]) -> dict[str, Column]:
    """What is known of every column of a frame."""
    return {str(name): column_of(str(name), units) for name in frame.columns}
