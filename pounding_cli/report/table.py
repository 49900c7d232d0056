"""The tables of a report: a frame in SI, and how people read it in a terminal, on a page and in a notebook."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from pounding_cli.numbers import Unit
from pounding_cli.texts import cells
from pounding_cli.variables import COORDINATES, VARIABLES

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

PAGE_ROWS = 400
"""Rows of a table that a page carries in full."""
TERMINAL_ROWS = 40
"""Rows of a table that a terminal prints."""
NOTHING = "–"
"""Stands where there is no number."""

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_NUMBER = re.compile(r"[-−+]?\d|[–-]?$")


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


@dataclass(frozen=True)
class Column:
    """How one column is shown.

    label : its name on pages and in figures
    unit : unit shown; "–" for a pure number, "" for text and counts
    factor : what the SI number is multiplied by
    text : meaning, in words
    """

    label: str
    unit: str = ""
    factor: float = 1.0
    text: str = ""

    @property
    def head(self) -> str:
        """The label with its unit."""
        return self.label if self.unit in ("", "–") else f"{self.label} [{self.unit}]"

    def texts(self, values: pd.Series) -> list[str]:
        """The values as people read them."""
        if pd.api.types.is_bool_dtype(values):
            return ["yes" if value else "no" for value in values]
        if not pd.api.types.is_numeric_dtype(values):
            return ["" if value is None or value != value else str(value) for value in values]
        numbers = self.factor * values.to_numpy(float)
        whole = self.unit == "" and all(not math.isfinite(x) or x == round(x) for x in numbers)
        return [f"{x:.0f}" if whole and math.isfinite(x) else digits(x) for x in numbers]


@dataclass(frozen=True, eq=False)
class Table:
    """A table.

    caption : what it is
    frame : numbers in SI, and texts; further lines of a text say where its number stands
    columns : how columns are shown; of those left out what is known of the column of that name (`column_of`)
    name : its CSV file is called so; "" where it has none
    """

    caption: str
    frame: pd.DataFrame
    columns: Mapping[str, Column] = field(default_factory=dict)
    name: str = ""

    def shown(self, most: int | None = None) -> pd.DataFrame:
        """The first `most` rows as texts in the units of the columns, under heads with units."""
        frame = self.frame if most is None else self.frame.head(most)
        how = {name: self.columns.get(name) or column_of(str(name)) for name in frame.columns}
        texts = [how[name].texts(frame[name]) for name in frame.columns]
        return pd.DataFrame(dict(enumerate(texts))).set_axis([each.head for each in how.values()], axis=1)

    def to_csv(self, folder: Path) -> Path:
        """Write all rows with all digits in SI; returns the file."""
        path = folder / f"{self.name}.csv"
        cells(self.frame).to_csv(path, index=False)
        return path

    def to_html(self, most: int = PAGE_ROWS) -> str:
        """An HTML table of the first `most` rows."""
        from markupsafe import escape

        shown = self.shown(most)
        kind = [' class="n"' if each else "" for each in _right_aligned(shown)]
        meant = [(self.columns.get(name) or column_of(str(name))).text for name in self.frame.columns]
        heads = [
            f'<th scope="col"{how} title="{escape(text or head)}">{escape(head)}</th>'
            for how, head, text in zip(kind, shown.columns, meant, strict=True)
        ]
        rows = []
        for first, *others in shown.itertuples(index=False, name=None):
            texts = [f"<td{how}>{_lines(text)}</td>" for how, text in zip(kind[1:], others, strict=True)]
            rows.append(f'<tr><th scope="row">{_lines(first)}</th>{"".join(texts)}</tr>')
        return "\n".join([
            f'<table class="grid"><caption class="quiet">{escape(self.caption)}</caption>',
            f"<thead><tr>{''.join(heads)}</tr></thead>",
            "<tbody>", *rows, "</tbody></table>",
        ])  # fmt: skip

    def to_text(self, width: int | None = None, most: int = TERMINAL_ROWS) -> str:
        """The first `most` rows for a terminal of so many characters; of its own width unless given."""
        import io

        from rich import box
        from rich.console import Console
        from rich.table import Table as Printed

        shown = self.shown(most)
        printed = Printed(box=box.SIMPLE_HEAD, pad_edge=False, title=self.caption or None, title_justify="left")
        for place, (head, right) in enumerate(zip(shown.columns, _right_aligned(shown), strict=True)):
            printed.add_column(head, justify="right" if right else "left", no_wrap=place == 0)
        for row in shown.itertuples(index=False, name=None):
            printed.add_row(*row)
        drawn = io.StringIO()
        Console(file=drawn, width=width, markup=False).print(printed)  # [cm] is a unit
        return drawn.getvalue()


def from_rows(caption: str, heads: Sequence[str], rows: Sequence[Sequence[Any]], name: str = "") -> Table:
    """A table of texts and numbers that are shown as they are; heads may be alike."""
    frame = pd.DataFrame([list(row) for row in rows], columns=range(len(heads)))
    return Table(caption, frame, {number: Column(head) for number, head in enumerate(heads)}, name)  # type: ignore[misc]


def answer_table(results: Results, name: str) -> Table:
    """A table that a workflow added to a results file."""
    answer, columns = results.answer(name), {}
    for column, (unit, text) in answer.meanings.items():
        shown = answer.units.get(column, Unit("" if unit == "1" else unit))
        columns[column] = Column(column, shown.name, 1 / shown.factor, text)
    return Table(name.replace("_", " ").capitalize(), answer.frame, columns, name)


def _right_aligned(shown: pd.DataFrame) -> list[bool]:
    """Of every column but the first whether it holds numbers, most of them without a second line."""
    found = [False]
    for place in range(1, shown.shape[1]):
        texts = shown.iloc[:, place]
        numbers = sum(bool(_NUMBER.match(text)) for text in texts)
        found.append(2 * numbers > len(texts) and not any("\n" in text for text in texts))
    return found


def _lines(text: str) -> str:
    from markupsafe import escape

    first, _, where = text.partition("\n")
    return f'{escape(first)}<span class="where">{escape(where)}</span>' if where else str(escape(first))


# what is known of the columns of a results file

_UNITS = {"N": ("kN", 1e-3), "m": ("mm", 1e3), "J": ("kJ", 1e-3), "N s": ("kN s", 1e-3), "m/s2": ("m/s²", 1.0),
          "N/m": ("MN/m", 1e-6), "kg": ("t", 1e-3), "1": ("–", 1.0)}  # fmt: skip
_COUNTS = ("impacts", "steps", "events", "orders", "storey", "floor", "place", "records_used")
_LARGE = ("height", "window", "period", "pga", "arias")
"""Columns whose SI unit is already the one they are read in."""
_ASIDE = {"seconds": ("ms", 1e3), "contact_time": ("ms", 1e3), "error_estimate": ("–", 1.0), "sensitivity": ("–", 1.0),
          "drift_ratio": ("%", 100.0)}  # fmt: skip
_LABELS = {v.name.removeprefix("record_"): v.label for v in VARIABLES.values() if v.label}
_LABELS |= {"right_floor": "floor right"}
_STATISTICS = ("mean", "std", "min", "max", "error", "sensitivity")


def column_of(key: str, units: Mapping[str, Unit] | None = None) -> Column:
    """What is known of a column; of one that is not, its own name.

    units : column -> the unit the study writes it in (`Results.units`); it comes before the usual one
    """
    if units and key in units:
        written = units[key]
        return replace(column_of(key), unit=written.name.replace("m/s2", "m/s²"), factor=1 / written.factor)
    base, _, statistic = key.rpartition("_")
    if statistic in _STATISTICS and base in VARIABLES:
        of = column_of(base)
        unit, factor = ("–", 1.0) if statistic in ("error", "sensitivity") else (of.unit, of.factor)
        return Column(f"{of.label} {statistic}", unit, factor, _meaning(key) or of.text)
    label = key if "." in key else _LABELS.get(key, key.replace("_", " "))  # a swept key stays as it is written
    variable = VARIABLES.get(key) or VARIABLES.get(f"record_{key}")
    unit = variable.unit if variable else ""
    if key in _ASIDE:
        return Column(label, *_ASIDE[key], _meaning(key))
    if key in _COUNTS or not unit:
        return Column(label, text=_meaning(key))
    shown, factor = (unit.replace("m/s2", "m/s²"), 1.0) if key in _LARGE else _UNITS.get(unit, (unit, 1.0))
    return Column(label, shown, factor, _meaning(key))


def _meaning(key: str) -> str:
    variable = VARIABLES.get(key) or VARIABLES.get(f"record_{key}")
    if variable is None:
        return COORDINATES.get(key, ("", ""))[1]
    return variable.brief or variable.text


def columns_of(frame: pd.DataFrame, units: Mapping[str, Unit]) -> dict[str, Column]:
    """What is known of every column of a frame."""
    return {str(name): column_of(str(name), units) for name in frame.columns}
