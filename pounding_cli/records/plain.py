"""Read a plain file of numbers in rows, as it is declared: nothing is found out from its words.

The lines above the first row of numbers are not read. Below it every line is a row of the same number of cells in one
grammar, or the file is refused at that line.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pounding_cli.cells import (
    SEPARATOR_WORDS,
    Grammar,
    Row,
    TextFile,
    choose_separator,
    guess_fortran,
    parse_fortran,
    touches,
)
from pounding_cli.errors import InputError
from pounding_cli.numbers import pluralize
from pounding_cli.records.declaration import SEPARATOR_NAMES, Declaration
from pounding_cli.records.samples import MAX_TIME_STEP, MIN_TIME_STEP, Samples, UnreadLine

MAX_UNEVENNESS = 0.01
"""Part of the time step by which times may miss even ones, as those that are printed with few digits do [-]."""

MAX_CELLS = 100_000
"""Cells of a row."""


@dataclass(frozen=True)
class NumberRows:
    """The rows of numbers of a file.

    grammar : of their cells
    rows : all of one number of cells, but for the last one where values are read row by row
    numbers : of all cells, row by row, shape (n,)
    unread : lines above and below with words
    """

    grammar: Grammar
    rows: Sequence[Row]
    numbers: np.ndarray
    unread: tuple[UnreadLine, ...]

    @property
    def width(self) -> int:
        """Number of cells of a row."""
        return len(self.rows[0].cells)

    def take_column(self, column: int) -> np.ndarray:
        """Return the numbers of a column, from 1, shape (rows,)."""
        return self.numbers[column - 1 :: self.width]


def read_plain(text: TextFile, declared: Declaration) -> Samples:
    """Return the samples of a plain file whose unit, and time or dt, are declared.

    Raises
    ------
    InputError : at its line and column, what is not as declared, and the key that settles it
    """
    rows_of_numbers = read_number_rows(text, declared)
    first = rows_of_numbers.rows[0].line
    column = _find_column(text, rows_of_numbers, declared)
    if declared.time is None:
        dt = declared.dt or 0.0
    else:
        _check_column(text, rows_of_numbers, declared.time, "time")
        dt = _find_step(text, rows_of_numbers, declared)
    if not MIN_TIME_STEP <= dt <= MAX_TIME_STEP:
        hint = f"a motion has time steps from {MIN_TIME_STEP:g} to {MAX_TIME_STEP:g} s"
        raise text.refuse(f"the time step is {dt:g} s", hint, first)
    values = rows_of_numbers.numbers if column is None else rows_of_numbers.take_column(column)
    words = f"of column {column}" if column is not None else "row by row"
    if column is not None and rows_of_numbers.width == 1:
        words = "one a line"
    heading = _find_heading(text, rows_of_numbers, column)
    return Samples(dt, values, declared.unit or "", first, words, rows_of_numbers.unread, heading)


def read_number_rows(text: TextFile, declared: Declaration) -> NumberRows:
    """Return the rows of numbers of a file.

    Raises
    ------
    InputError : no row of numbers, or a line below the first one that is not such a row
    """
    first = find_first_row(text, declared)
    grammar = _choose_grammar(text, declared, first)
    end = len(text.lines) if declared.rows is None else first + declared.rows
    if end > len(text.lines):
        message = f"{pluralize(len(text.lines) - first, 'row follows', 'rows follow')}, and rows is {declared.rows}"
        raise text.refuse(message, f"write `rows: {len(text.lines) - first}` at most", first + 1)
    rows = [Row(index + 1, grammar.split(text.lines[index])) for index in range(first, end)]
    _check_widths(text, rows, declared)
    numbers = grammar.read_numbers(text, rows)
    _refuse_row_above(text, grammar, first, len(rows[0].cells), declared)
    _check_first_values(text, rows, numbers, declared)
    unread = [*range(first), *range(end, len(text.lines))]
    lines = tuple(UnreadLine(index + 1, text.lines[index].strip()) for index in unread if text.lines[index].strip())
    return NumberRows(grammar, rows, numbers, lines + _list_margins(text, rows, grammar))


def find_first_row(text: TextFile, declared: Declaration) -> int:
    """Return the index of the first row of numbers.  Raises InputError: there is none."""
    if declared.skip is not None:
        if declared.skip >= len(text.lines):
            message = f"the file has {pluralize(len(text.lines), 'line')}, and skip is {declared.skip}"
            raise text.refuse(message, f"write `skip: {len(text.lines) - 1}` at most")
        below = range(declared.skip, len(text.lines))
        return next(index for index in below if text.lines[index].strip())
    for index, line in enumerate(text.lines):
        if line.strip() and _build_grammar(declared, line).is_row_of_numbers(line):
            return index
    raise _refuse_no_row(text, declared)


def _build_grammar(declared: Declaration, line: str) -> Grammar:
    """Return the grammar as declared; the separator is that of a line where none is."""
    decimal = declared.decimal or "."
    thousands = declared.thousands or ""
    if declared.format is not None:
        return parse_fortran(declared.format, decimal)
    if declared.separator is not None:
        return Grammar(SEPARATOR_NAMES[declared.separator], decimal, thousands)
    separator = choose_separator(line, decimal)
    if separator == thousands:
        separator = choose_separator(line.replace(thousands, ""), decimal)
    return Grammar(separator, decimal, thousands)


def _choose_grammar(text: TextFile, declared: Declaration, first: int) -> Grammar:
    """Return the grammar of all rows.

    Raises
    ------
    CurableError : commas part the cells, or are decimal signs, and neither the times nor a key says which
    """
    grammar = _build_grammar(declared, text.lines[first])
    is_told = declared.separator is not None or declared.decimal is not None or declared.time is not None
    if grammar.separator == "," and not is_told:
        hint = """write `separator: ","` if they part values, `decimal: ","` if they are decimal signs"""
        column = text.lines[first].find(",") + 1
        message = "nothing says whether the commas part values"
        is_decimal = _build_grammar(replace(declared, decimal=","), text.lines[first]).is_row_of_numbers(
            text.lines[first]
        )
        cure = {"decimal": ","} if is_decimal else {"separator": ","}
        raise text.refuse_curable(message, hint, cure, first + 1, column)
    return grammar


def _refuse_no_row(text: TextFile, declared: Declaration) -> InputError:
    """Return the refusal of a file without a row of numbers, at the line that is most like one."""
    others = {"decimal": replace(declared, decimal=","), "thousands": replace(declared, thousands=",")}
    for key, other in others.items():
        for index, line in enumerate(text.lines):
            if line.strip() and _build_grammar(other, line).is_row_of_numbers(line):
                message = f"'{line.strip()[:40]}' is no row of numbers with a decimal point"
                hint = f'write `{key}: ","`, or declare what parts its cells'
                return text.refuse_curable(message, hint, {key: ","}, index + 1)
    numeric = [index for index, line in enumerate(text.lines) if _DIGITS_ALONE.match(line)]
    begins = [index for index, line in enumerate(text.lines) if _NUMBER_FIRST.match(line.strip())]
    for index in [*numeric[:1], *begins[:1]]:
        line = text.lines[index]
        grammar = _build_grammar(declared, line)
        cells = grammar.split(line)
        faulty = next((place for place, cell in enumerate(cells) if grammar.parse(cell) is None), None)
        if faulty is not None:
            return grammar.refuse_cell(text, Row(index + 1, cells), faulty)
    return text.refuse("no line holds numbers", "give a file that holds a ground motion as text", 1)


def _check_widths(text: TextFile, rows: Sequence[Row], declared: Declaration) -> None:
    """Refuse the first row with another number of cells; the last one may be shorter where values follow row by row.

    Raises
    ------
    InputError : and the keys that leave the odd lines out
    """
    width = len(rows[0].cells)
    if width > MAX_CELLS:
        raise text.refuse(f"{width} values on a line", f"write at most {MAX_CELLS} on a line", rows[0].line)
    is_row_by_row = declared.time is None and declared.column is None
    for place, row in enumerate(rows):
        count = len(row.cells)
        is_short_end = is_row_by_row and 0 < count < width and _NUMBER_FIRST.match(row.cells[0]) is not None
        if count == width or (is_short_end and place == len(rows) - 1):
            continue
        is_short_end = is_short_end and not any(map(_DIGITS_ALONE.match, text.lines[row.line : row.line + 1]))
        kept = place + is_short_end
        until = f"`rows: {kept}` reads the {pluralize(kept, 'row')} above"
        words = " ".join(text.lines[row.line - 1].split())[:40]
        begin = rows[place].line - 1
        if count == 0:
            message = "a blank line stands among the numbers"
            hint = f"{until}, if another series follows; else take the blank line out"
        elif not _DIGITS_ALONE.match(words):
            message = f"'{words}' stands below the numbers"
            hint = f"{until}; `skip:` begins below"
        else:
            message = f"{pluralize(count, 'cell')} on this line, where the first row, line {rows[0].line}, has {width}"
            hint = f"{until}; `separator:` or `decimal:` declares what its signs mean"
            if place <= 2 and declared.skip is None and not is_short_end:
                hint = f"`skip: {begin}` begins at this line, if those above belong to the heading"
                raise text.refuse_curable(message, hint, {"skip": begin}, row.line)
        if kept < 2:
            hint = "correct it, or write `skip:`, the number of lines above the numbers"
            raise text.refuse(message, hint, row.line)
        raise text.refuse_curable(message, hint, {"rows": kept}, row.line)


def _refuse_row_above(text: TextFile, grammar: Grammar, first: int, width: int, declared: Declaration) -> None:
    """Refuse a file in which a line above the first row looks like a row with a cell that is no number.

    That is one of digits and signs alone, or the line right above with as many cells, of which the first has a number.

    Raises
    ------
    CurableError : with the cell, and the key that passes over the line
    """
    if declared.skip is not None:
        return
    above = [index for index in range(first) if text.lines[index].strip()]
    for index in above:
        line = text.lines[index]
        cells = grammar.split(line)
        is_right_above = index == above[-1] and len(cells) == width and bool(_NUMBER_FIRST.match(cells[0]))
        if not (is_right_above or _DIGITS_ALONE.match(line)):
            continue
        place = next((place for place, cell in enumerate(cells) if grammar.parse(cell) is None), 0)
        fault = grammar.describe_fault(cells[place])
        column = grammar.find_column(line, place)
        if declared.format is None and any(map(touches, cells)) and (form := guess_fortran(line)):
            hint = f"write `format: {form}` if the cells are printed in columns without blanks"
            raise text.refuse_curable(fault.message, hint, {"format": form}, index + 1, column)
        hint = f"`skip: {first}` begins at line {first + 1}, if this one belongs to the heading"
        if "*" in line:
            hint += "; a factor that stands there belongs to the unit, e.g. `unit: 100 gal`"
        cure = fault.cure or {"skip": first}
        raise text.refuse_curable(fault.message, f"{fault.hint}; {hint}", cure, index + 1, column)


_NUMBER_FIRST = re.compile(r"[-+]?[.,]?\d")
_DIGITS_ALONE = re.compile(r"(?=[^\d]*\d)[\d\s.,;+\-*'EeDd]*\Z")


def _check_first_values(text: TextFile, rows: Sequence[Row], numbers: np.ndarray, declared: Declaration) -> None:
    """Refuse values row by row of which the first is their count or step, or a column counts rows or times.

    Raises
    ------
    CurableError : with the key that settles it
    """
    if declared.time is not None or declared.column is not None:
        return
    width = len(rows[0].cells)
    line = rows[0].line
    if width == 1 and declared.skip is None and numbers.size > 2:
        is_count = numbers[0] == numbers.size - 1 and numbers[0] > 2
        if is_count or (numbers[0] == declared.dt and numbers[1] != 0):
            what = "the number of values below it" if is_count else "the time step"
            hint = f"write `skip: {line}` if it is, `skip: {line - 1}` if it is a sample"
            message = f"the first value, {rows[0].cells[0]}, is {what}"
            raise text.refuse_curable(message, hint, {"skip": line}, line)
    whole = numbers.size // width
    if width == 1 or whole < 3:
        return
    table = numbers[: whole * width].reshape(whole, width)
    for place in range(width):
        steps = np.diff(table[:, place])
        if not (steps[0] > 0 and np.allclose(steps, steps[0], rtol=1e-3, atol=0.0)):
            continue
        message = f"column {place + 1} rises evenly, as times and row numbers do"
        form = guess_fortran(text.lines[line - 1])
        if place == width - 1 and form:
            hint = f"if it numbers the cards, write `format: {form}` for the cells before it"
            raise text.refuse_curable(message, hint, {"format": form}, line)
        other = 2 if place == 0 else 1
        hint = f"write `time: {place + 1}, column: {other}` in place of `dt:` if it holds times, `column:` if not"
        raise text.refuse_curable(message, hint, {"time": place + 1, "column": other, "dt": None}, line)


def _list_margins(text: TextFile, rows: Sequence[Row], grammar: Grammar) -> tuple[UnreadLine, ...]:
    """Return what stands behind the fixed columns of the first row, as a line that was not read."""
    width = sum(grammar.widths)
    margin = text.lines[rows[0].line - 1][width:].strip() if width else ""
    return (UnreadLine(rows[0].line, f"{margin} (behind column {width} of line {rows[0].line})"),) if margin else ()


def _find_column(text: TextFile, rows: NumberRows, declared: Declaration) -> int | None:
    """Return the column of the acceleration, from 1; None: values follow row by row.

    Raises
    ------
    InputError : there is no such column, or several beside the times and none is declared
    """
    if declared.column is not None:
        _check_column(text, rows, declared.column, "column")
        if declared.column == declared.time:
            message = f"column {declared.column} holds both the times and the acceleration"
            raise text.refuse(message, f"write another `column:`, from 1 to {rows.width}", rows.rows[0].line)
        return declared.column
    if declared.time is None:
        return 1 if rows.width == 1 else None
    others = [column for column in range(1, rows.width + 1) if column != declared.time]
    if len(others) == 1:
        return others[0]
    if not others:
        message = "the rows have 1 column, and it cannot hold both times and acceleration"
        raise text.refuse(message, "write `dt:`, the time step, in place of `time:`", rows.rows[0].line)
    message = f"the rows have {pluralize(rows.width, 'column')}, and nothing says which holds the acceleration"
    hint = f"write `column:`, one of {', '.join(map(str, others))}"
    raise text.refuse_curable(message, hint, {"column": others[0]}, rows.rows[0].line)


def _check_column(text: TextFile, rows: NumberRows, column: int, key: str) -> None:
    """Refuse a column that the rows do not have."""
    if not 1 <= column <= rows.width:
        parted = "" if rows.grammar.widths else f", parted by {SEPARATOR_WORDS[rows.grammar.separator]}"
        message = f"`{key}: {column}`, and the rows have {pluralize(rows.width, 'column')}{parted}"
        hint = f"write one from 1 to {rows.width}, or `separator:` and `decimal:` for what their signs mean"
        raise text.refuse(message, hint, rows.rows[0].line)


def _find_step(text: TextFile, rows: NumberRows, declared: Declaration) -> float:
    """Return the time step [s] of the column of times.

    Raises
    ------
    InputError : they do not rise evenly; where they are merely rounded, with the `dt` that settles it
    """
    column = declared.time or 1
    times = rows.take_column(column)
    if times.size < 2:
        raise text.refuse("only one row of numbers", "a motion needs two samples at least", rows.rows[0].line)
    steps = np.diff(times)
    mean = float(times[-1] - times[0]) / (times.size - 1)
    misses = np.abs(times - (times[0] + mean * np.arange(times.size)))
    if mean > 0 and misses.max() <= MAX_UNEVENNESS * mean:
        return _round_step(mean, float(misses.max()), times.size)
    fit = _find_rounded_step(rows, times, column)
    if fit is not None:
        last_digit, step = fit
        message = f"the times are uneven, as they are rounded to {last_digit:g} s; steps of {step:.6g} s fit them"
        value_column = declared.column or next(each for each in (1, 2) if each != column)
        hint = f"write `dt: {step:.7g} s, column: {value_column}` in place of `time: {column}`"
        cure = {"dt": float(f"{step:.7g}"), "column": value_column, "time": None}
        raise text.refuse_curable(message, hint, cure, rows.rows[0].line)
    usual = float(np.median(steps))
    if usual <= 0:
        message = f"column {column} does not rise, so that it holds no times"
        hint = "write the column of the times, from 1, or `dt:`; `decimal:` and `separator:` say what commas mean"
        raise text.refuse(message, hint, rows.rows[0].line)
    odd = int(np.argmax(np.abs(steps - usual))) + 1
    line = rows.rows[odd].line
    message = f"the times are uneven: {times[odd]:g} s follows {times[odd - 1]:g} s, elsewhere {usual:g} s apart"
    if odd == 1 and declared.skip is None:
        hint = f"write `skip: {line - 1}` if the rows begin here; else resample the motion evenly"
        raise text.refuse_curable(message, hint, {"skip": line - 1}, line)
    hint = f"write `rows: {odd}` to read the rows above, or resample the motion evenly"
    if odd < 3:
        raise text.refuse(message, hint, line)
    raise text.refuse_curable(message, hint, {"rows": odd}, line)


def _round_step(mean: float, miss: float, count: int) -> float:
    """Return a time step [s] with as few digits as the printed times allow: 0.02 for 0.0199999."""
    for digits in range(1, 10):
        rounded = float(f"{mean:.{digits}g}")
        if abs(rounded - mean) * (count - 1) <= miss + 1e-9 * mean * count:
            return rounded
    return mean


def _find_rounded_step(rows: NumberRows, times: np.ndarray, column: int) -> tuple[float, float] | None:
    """Return the last digit [s] to which even times are rounded, and their step [s]; None where they are uneven."""
    decimals = max(len(row.cells[column - 1].partition(rows.grammar.decimal)[2]) for row in rows.rows)
    last_digit = 10.0**-decimals
    reach = float(times[-1] - times[0])
    if reach <= 0:
        return None
    least = (times.size - 1) / (reach + last_digit)
    most = (times.size - 1) / max(reach - last_digit, 0.5 * reach)
    for step in _iter_steps(least, most):
        grid = times[0] + step * np.arange(times.size)
        if np.ptp(grid - times) < 0.999 * last_digit:
            return last_digit, step
    return None


def _iter_steps(least: float, most: float) -> Iterator[float]:
    """Yield time steps [s] for rates between two [Hz]: whole rates, then the one between."""
    middle = 0.5 * (least + most)
    whole = range(int(np.ceil(least)), min(int(most), int(least) + 20) + 1)
    yield from (1.0 / rate for rate in sorted(whole, key=lambda rate: abs(rate - middle)) if rate > 0)
    yield 1.0 / middle


def _find_heading(text: TextFile, rows: NumberRows, column: int | None) -> str:
    """Return the cell above a column, where the line above the numbers has as many cells; "" for none."""
    first = rows.rows[0].line - 1
    if column is None or first == 0:
        return ""
    cells = rows.grammar.split(text.lines[first - 1])
    return cells[column - 1] if len(cells) == rows.width else ""
