"""Read a plain file of numbers in rows, as it is declared: nothing is found out from its words.

The lines above the first row of numbers are not read. Below it every line is a row of the same number of cells in one
grammar, or the file is refused at that line.
"""

from __future__ import annotations

import numpy as np

from pounding_cli.cells import SEPARATOR_WORDS, TextFile, guess_fortran
from pounding_cli.numbers import pluralize
from pounding_cli.records.declaration import KEPT, Declaration
from pounding_cli.records.number_rows import NumberRows, read_number_rows
from pounding_cli.records.samples import MAX_TIME_STEP, MIN_TIME_STEP, Samples
from pounding_cli.records.times import find_step

MIN_ROW_BY_ROW = 5
"""Values on a line from which they are read row by row where no column is declared; fewer may be as many channels."""

MIN_COUNTED = 8
"""Values of which the last one may be their number or peak."""

MAX_FIRST_SAMPLE = 3.0
"""First value over the largest other one [-], above which it is no sample."""


def read_plain(text: TextFile, declared: Declaration) -> Samples:
    """Return the samples of a plain file whose unit, and time or dt, are declared.

    Raises
    ------
    InputError : at its line and column, what is not as declared, and the key that settles it
    """
    rows = read_number_rows(text, declared)
    first = rows.rows[0].line
    column = _find_column(text, rows, declared)
    dt = declared.dt or 0.0
    if declared.time is not None:
        _check_column(text, rows, declared.time, "time")
        _refuse_pairs(text, rows, declared.time)
        dt = find_step(text, rows, declared)
    if not MIN_TIME_STEP <= dt <= MAX_TIME_STEP:
        hint = f"a motion has time steps from {MIN_TIME_STEP:g} to {MAX_TIME_STEP:g} s"
        raise text.refuse(f"the time step is {dt:g} s", hint, first)
    values = rows.numbers if column is None else rows.take_column(column)
    _refuse_first_value(text, rows, values, declared)
    _refuse_last_value(text, rows, declared)
    words = "row by row" if column is None else f"of column {column}"
    if column is not None and rows.width == 1:
        words = "one a line"
    heading = _find_heading(text, rows, column)
    lines = rows.list_lines(column)
    return Samples(dt, values, declared.unit or "", first, words, rows.unread, heading, lines=lines, below=rows.below)


def _find_column(text: TextFile, rows: NumberRows, declared: Declaration) -> int | None:
    """Return the column of the acceleration, from 1; None: values follow row by row.

    Raises
    ------
    InputError : there is no such column, or several and none is declared
    """
    first = rows.rows[0].line
    if declared.column is not None:
        _check_column(text, rows, declared.column, "column")
        if declared.column == declared.time:
            message = f"column {declared.column} holds both the times and the acceleration"
            raise text.refuse(message, f"write another `column:`, from 1 to {rows.width}", first)
        return declared.column
    if declared.time is None:
        return _find_column_without_times(text, rows)
    others = [column for column in range(1, rows.width + 1) if column != declared.time]
    if len(others) == 1:
        return others[0]
    if not others:
        message = "the rows have 1 column, and it cannot hold both times and acceleration"
        raise text.refuse(message, "write `dt:`, the time step, in place of `time:`", first)
    message = f"the rows have {pluralize(rows.width, 'column')}, and nothing says which holds the acceleration"
    hint = f"write `column:`, from 1 to {rows.width}"
    if rows.width > MIN_ROW_BY_ROW:
        raise text.refuse(message, f"{hint}; where the samples go on row by row, `dt:` and `format: 10X,8F9.6`", first)
    raise text.refuse_curable(message, hint, {"column": others[0]}, first)


def _find_column_without_times(text: TextFile, rows: NumberRows) -> int | None:
    """Return 1 for one column, and None for values row by row.

    Raises
    ------
    InputError : a column rises as times or numbers of cards do; few columns, which may be channels
    """
    if rows.width == 1:
        return 1
    first = rows.rows[0].line
    whole = rows.numbers.size // rows.width
    table = rows.numbers[: whole * rows.width].reshape(whole, rows.width)
    rising = [place for place in range(rows.width) if whole > 2 and _rises_evenly(table[:, place])]
    form = guess_fortran(text.lines[first - 1])
    if rising:
        message = f"column {rising[0] + 1} rises evenly, as times and numbers of rows do"
        if rows.width == 2:
            column = 2 - rising[0]
            hint = f"write `column: {column}`, or `time: {rising[0] + 1}` in place of `dt:`"
            raise text.refuse_curable(message, hint, {"column": column}, first)
        if rising[0] == rows.width - 1 and form:
            hint = f"if it numbers the cards, write `format: {form}` for the cells before it"
            raise text.refuse_curable(message, hint, {"format": form}, first)
        hint = "write `column:` for one series beside others; for values row by row take it out, or skip its signs by "
        raise text.refuse(message, f"{hint}X in a format of Fortran, `format: 10X,8F9.6`", first)
    if rows.width < MIN_ROW_BY_ROW and not rows.grammar.widths:
        message = f"the rows have {rows.width} columns, and nothing says which holds the acceleration"
        hint = f"write `column:`, from 1 to {rows.width}"
        hint += f"; `format: {form}` for values row by row" if form else ""
        raise text.refuse_curable(message, hint, {"column": 1}, first)
    return None


def _rises_evenly(numbers: np.ndarray) -> bool:
    """Return whether numbers rise by the same step."""
    steps = np.diff(numbers)
    return bool(steps[0] > 0 and np.allclose(steps, steps[0], rtol=1e-3, atol=0.0))


def _check_column(text: TextFile, rows: NumberRows, column: int, key: str) -> None:
    """Refuse a column that the rows do not have."""
    if not 1 <= column <= rows.width:
        parted = "" if rows.grammar.widths else f", parted by {SEPARATOR_WORDS[rows.grammar.separator]}"
        message = f"`{key}: {column}`, and the rows have {pluralize(rows.width, 'column')}{parted}"
        hint = f"write one from 1 to {rows.width}, or `separator:` and `decimal:` for what their signs mean"
        raise text.refuse(message, hint, rows.rows[0].line)


def _refuse_pairs(text: TextFile, rows: NumberRows, time: int) -> None:
    """Refuse rows on which times and values take turns: 0.00 0.1 0.02 -0.3."""
    if time != 1 or rows.width < 4 or rows.width % 2 or len(rows.rows) < 2:
        return
    steps = np.diff(rows.numbers[::2])
    if steps.min() > 0 and np.allclose(steps, steps.mean(), rtol=0.02, atol=0.0):
        message = f"{rows.width // 2} pairs of time and value stand on a line"
        raise text.refuse(message, "write each pair on a line of its own", rows.rows[0].line)


def _refuse_first_value(text: TextFile, rows: NumberRows, values: np.ndarray, declared: Declaration) -> None:
    """Refuse values of which the first is far beyond all others, as a number that belongs to the heading is.

    Raises
    ------
    InputError : with the number of lines above the samples
    """
    if declared.skip is not None or declared.baseline == KEPT or values.size < 4:
        return
    others = float(np.abs(values[1:]).max())
    if others > 0 and abs(values[0]) > MAX_FIRST_SAMPLE * others:
        line = rows.rows[0].line
        message = f"the first value, {values[0]:g}, is {abs(values[0]) / others:.3g} times the largest other"
        hint = f"write `skip: {line}` if it is no sample, `skip: {line - 1}` if it is one"
        hint += f"; a scale factor belongs to the unit, `unit: {abs(values[0]):g} {declared.unit}`"
        raise text.refuse(message, hint, line)


def _refuse_last_value(text: TextFile, rows: NumberRows, declared: Declaration) -> None:
    """Refuse values one a line of which the last is their count, or their peak once more.

    Raises
    ------
    CurableError : with the number of rows above it
    """
    numbers = rows.numbers
    if declared.rows is not None or declared.baseline == KEPT or rows.width > 1 or numbers.size < MIN_COUNTED:
        return
    peak = float(np.abs(numbers[:-1]).max())
    above = numbers.size - 1
    if numbers[-1] == above or abs(numbers[-1]) == peak > 0:
        what = "number" if numbers[-1] == above else "peak"
        message = f"the last value, {numbers[-1]:g}, is the {what} of the {above} above it"
        hint = f"write `rows: {above}` if it is, `rows: {numbers.size}` if it is a sample"
        raise text.refuse_curable(message, hint, {"rows": above}, rows.rows[-1].line)


def _find_heading(text: TextFile, rows: NumberRows, column: int | None) -> str:
    """Return the cell above a column, where the line above the numbers has as many cells; "" for none."""
    first = rows.rows[0].line - 1
    if column is None or first == 0:
        return ""
    cells = rows.grammar.split(text.lines[first - 1])
    return cells[column - 1] if len(cells) == rows.width else ""
