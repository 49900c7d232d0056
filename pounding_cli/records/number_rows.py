"""The rows of numbers of a plain file: where they begin, how their cells are written, and what does not belong there.

Nothing is found out from words. Where the rows are not as declared, the refusal has the keys that cure it, but none
that would cut the numbers short.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.cells import (
    BLANKS,
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
from pounding_cli.records.samples import UnreadLine

MAX_CELLS = 100_000
"""Cells of a row."""

HEADER_ROWS = 3
"""Rows at the top that may hold a count or a time step in place of samples."""

MAX_HEADER_NUMBERS = 4
"""Numbers on a line of a heading."""

LEAST_COUNT = 8
"""Smallest number of values that a file states above them."""

_NUMBER_FIRST = re.compile(r"[-+]?[.,]?\d")
_DIGITS_ALONE = re.compile(r"(?=[^\d]*\d)[\d\s.,;+\-*'EeDd]*\Z")
_FACTOR = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[Ee][-+]?\d+)?)\s*\*\s*\Z")


@dataclass(frozen=True)
class NumberRows:
    """The rows of numbers of a file.

    grammar : of their cells
    rows : all of one number of cells, but for the last one where values are read row by row
    numbers : of all cells, row by row, shape (n,)
    unread : lines with words above, and what stands behind the columns of a Fortran format
    below : number of lines below that are not read
    """

    grammar: Grammar
    rows: Sequence[Row]
    numbers: np.ndarray
    unread: tuple[UnreadLine, ...]
    below: int

    @property
    def width(self) -> int:
        """Number of cells of a row."""
        return len(self.rows[0].cells)

    def take_column(self, column: int) -> np.ndarray:
        """Return the numbers of a column, from 1, shape (rows,)."""
        return self.numbers[column - 1 :: self.width]

    def list_lines(self, column: int | None) -> np.ndarray:
        """Return the line of every number of a column, or of every number, from 1."""
        lines = np.array([row.line for row in self.rows])
        return lines if column is not None else np.repeat(lines, [len(row.cells) for row in self.rows])


class _Run(NamedTuple):
    """Lines on end with as many numbers each: index of the first, their number, and that of their cells."""

    start: int
    length: int
    width: int


def read_number_rows(text: TextFile, declared: Declaration) -> NumberRows:
    """Return the rows of numbers of a file.

    Raises
    ------
    InputError : no row of numbers, or a line below the first one that is not such a row
    """
    first = find_first_row(text, declared)
    grammar = _choose_grammar(text, declared, first)
    indices = _list_row_indices(text, first)
    if declared.rows is not None and declared.rows > len(indices):
        message = f"{pluralize(len(indices), 'row follows', 'rows follow')}, and rows is {declared.rows}"
        raise text.refuse(message, f"write `rows: {len(indices)}` at most", first + 1)
    indices = indices[: declared.rows]
    rows = [Row(index + 1, _split_row(grammar, text.lines[index])) for index in indices]
    if not grammar.widths:
        _refuse_touching(text, grammar, rows)
    _check_widths(text, grammar, rows, declared)
    numbers = grammar.read_numbers(text, rows)
    _refuse_row_above(text, grammar, first, len(rows[0].cells), declared)
    _refuse_header_numbers(text, rows, numbers, declared)
    _refuse_points_of_thousands(text, rows, declared)
    unread = tuple(UnreadLine(place, line.strip()) for place, line in enumerate(text.lines[:first], 1) if line.strip())
    below = sum(bool(line.strip()) for line in text.lines[indices[-1] + 1 :])
    return NumberRows(grammar, rows, numbers, unread + _list_margins(text, rows, grammar), below)


# Where the rows begin, and how they are written


def find_first_row(text: TextFile, declared: Declaration) -> int:
    """Return the index of the first row of numbers.  Raises InputError: there is none."""
    if declared.skip is not None:
        if declared.skip >= len(text.lines):
            message = f"the file has {pluralize(len(text.lines), 'line')}, and skip is {declared.skip}"
            raise text.refuse(message, f"write `skip: {len(text.lines) - 1}` at most")
        below = range(declared.skip, len(text.lines))
        return next(index for index in below if text.lines[index].strip())
    for index, line in enumerate(text.lines):
        if _is_row_of_numbers(_build_grammar(declared, line), line):
            return index
    raise _refuse_no_row(text, declared)


def _list_row_indices(text: TextFile, first: int) -> list[int]:
    """Return the indices of the lines from the first row on; the blank ones between rows of double spacing are none."""
    filled = [index for index in range(first, len(text.lines)) if text.lines[index].strip()]
    is_double_spaced = len(filled) > 2 and filled == list(range(first, filled[-1] + 1, 2))
    return filled if is_double_spaced else list(range(first, len(text.lines)))


def _split_row(grammar: Grammar, line: str) -> list[str]:
    """Return the cells of a row without empty ones at its ends, which separators there leave."""
    cells = grammar.split(line)
    while cells and not cells[-1]:
        cells.pop()
    begin = next((place for place, cell in enumerate(cells) if cell), 0)
    return cells[begin:]


def _is_row_of_numbers(grammar: Grammar, line: str) -> bool:
    """Return whether a line holds numbers in a grammar, and nothing else."""
    cells = _split_row(grammar, line)
    return bool(cells) and all(grammar.parse(cell) is not None for cell in cells)


def _build_grammar(declared: Declaration, line: str) -> Grammar:
    """Return the grammar as declared; the separator is that of a line where none is."""
    decimal = declared.decimal or "."
    thousands = declared.thousands or ""
    if declared.is_fortran():
        return parse_fortran(declared.format or "", decimal)
    if declared.separator is not None:
        return Grammar(SEPARATOR_NAMES[declared.separator], decimal, thousands)
    separator = choose_separator(line, decimal)
    if separator == thousands:
        separator = choose_separator(line.replace(thousands, ""), decimal)
    if separator == "\t" and [cell for cell in Grammar("\t").split(line) if cell] == line.split():
        separator = BLANKS  # tabs, or tabs and blanks, between cells without blanks
    return Grammar(separator, decimal, thousands)


def _choose_grammar(text: TextFile, declared: Declaration, first: int) -> Grammar:
    """Return the grammar of all rows.

    Raises
    ------
    InputError : commas part the cells, or are decimal signs, and neither the times nor a key says which
    """
    line = text.lines[first]
    grammar = _build_grammar(declared, line)
    signs = grammar.decimal, grammar.thousands
    column = line.find(",") + 1
    if grammar.separator in signs and '"' not in line and not grammar.widths:
        message = f"'{grammar.separator}' is declared to part the cells, and within them too"
        raise text.refuse(message, "such cells need quotes; export the file with semicolons or tabs", first + 1)
    if grammar.separator != "," or declared.separator is not None:
        return grammar
    cells = grammar.split(line)
    if any(re.match(r"-?0\d", cell) for cell in cells) and all(re.fullmatch(r"-?\d+", cell) for cell in cells):
        message = "commas both part the cells and are decimal signs"
        if len(cells) > 2 or declared.time is not None:
            raise text.refuse(message, "export the file with semicolons or tabs, or with decimal points", first + 1)
    if declared.decimal is None and declared.time is None:
        hint = """write `separator: ","` if they part values, `decimal: ","` if they are decimal signs"""
        is_decimal = _is_row_of_numbers(_build_grammar(replace(declared, decimal=","), line), line)
        cure = {"decimal": ","} if is_decimal else {"separator": ","}
        message = "nothing says whether the commas part values"
        if not is_decimal and "." not in line:
            raise text.refuse(message, hint, first + 1, column)
        raise text.refuse_curable(message, hint, cure, first + 1, column)
    return grammar


def _refuse_no_row(text: TextFile, declared: Declaration) -> InputError:
    """Return the refusal of a file without a row of numbers, at the line that is most like one."""
    cures: list[Mapping[str, Any]] = [
        {"decimal": ","},
        {"thousands": ","},
        {"decimal": ",", "separator": ","},
        {"thousands": ",", "separator": ","},
        {"decimal": ",", "thousands": "."},
    ]
    for cure in cures:
        for index, line in enumerate(text.lines):
            is_in_quotes = "separator" not in cure or '"' in line
            if is_in_quotes and _is_row_of_numbers(_build_grammar(replace(declared, **cure), line), line):
                message = f"'{line.strip()[:40]}' is no row of numbers with a decimal point"
                keys = ", ".join(f'{key}: "{sign}"' for key, sign in cure.items())
                return text.refuse_curable(message, f"write `{keys}`", cure, index + 1)
    numeric = [index for index, line in enumerate(text.lines) if _DIGITS_ALONE.match(line)]
    begins = [index for index, line in enumerate(text.lines) if _NUMBER_FIRST.match(line.strip())]
    for index in [*numeric[:1], *begins[:1]]:
        grammar = _build_grammar(declared, text.lines[index])
        cells = grammar.split(text.lines[index])
        faulty = next((place for place, cell in enumerate(cells) if grammar.parse(cell) is None), None)
        if faulty is not None:
            return grammar.refuse_cell(text, Row(index + 1, cells), faulty)
    index = max(range(len(text.lines)), key=lambda index: sum(map(str.isdigit, text.lines[index])))
    hint = "take brackets, names and commas out, so that lines hold numbers alone"
    shown = " ".join(text.lines[index].split())[:40]
    return text.refuse(f"no line holds numbers alone; line {index + 1} has '{shown}'", hint, index + 1)


# What does not belong among the rows


def _refuse_touching(text: TextFile, grammar: Grammar, rows: Sequence[Row]) -> None:
    """Refuse cells in which numbers touch, or that were too wide for their field, as in full columns of Fortran.

    Raises
    ------
    InputError : with the format, where the decimal points show it
    """
    for row in rows:
        is_of_numbers = any(map(_NUMBER_FIRST.match, row.cells))
        for place, cell in enumerate(row.cells):
            if is_of_numbers and (touches(cell) or (len(cell) > 1 and set(cell) == {"*"})):
                raise grammar.refuse_cell(text, row, place)


def _check_widths(text: TextFile, grammar: Grammar, rows: Sequence[Row], declared: Declaration) -> None:
    """Refuse the first row with another number of cells; the last one may be shorter where values follow row by row.

    Raises
    ------
    InputError : with the keys that leave lines above or below out, where no numbers are lost by them
    """
    width = len(rows[0].cells)
    if width > MAX_CELLS:
        raise text.refuse(f"{width} values on a line", f"write at most {MAX_CELLS} on a line", rows[0].line)
    is_row_by_row = declared.time is None and declared.column is None
    for place, row in enumerate(rows):
        count = len(row.cells)
        is_short_end = is_row_by_row and 0 < count < width and _NUMBER_FIRST.match(row.cells[0]) is not None
        has_numbers = count > 0 and (_NUMBER_FIRST.match(row.cells[0]) or any(map(_NUMBER_FIRST.match, row.cells)))
        if has_numbers and (count == width or (is_short_end and place == len(rows) - 1)):
            continue
        if is_short_end and not any(map(_DIGITS_ALONE.match, text.lines[row.line : row.line + 1])):
            place += 1  # the short end of a series, with words or a blank line below
        raise _refuse_odd_row(text, grammar, rows, row, place, declared)


def _refuse_odd_row(
    text: TextFile, grammar: Grammar, rows: Sequence[Row], row: Row, kept: int, declared: Declaration
) -> InputError:
    """Return the refusal of a row that is not like those above.

    kept : rows above it, and itself where it is the short end of a series
    """
    width = len(rows[0].cells)
    words = " ".join(text.lines[row.line - 1].split())[:40]
    message = f"{pluralize(len(row.cells), 'cell')} on this line, where the first row, line {rows[0].line}, has {width}"
    if not words:
        message = "a blank line stands among the numbers"
    elif not _NUMBER_FIRST.match(words):
        message = f"'{words}' stands below the numbers"
    if grammar.separator == BLANKS and len(Grammar("\t").split(text.lines[row.line - 1])) == width > 1:
        hint = """write `separator: tab, thousands: " "` if blanks part thousands"""
        return text.refuse_curable(message, hint, {"separator": "tab", "thousands": " "}, row.line)
    runs = _list_runs(text, grammar, rows[0].line - 1)
    longest = max(runs, key=lambda run: run.length * run.width)
    is_header = kept <= HEADER_ROWS and width <= MAX_HEADER_NUMBERS and longest.width != width
    begins_below = longest.start >= row.line - 1 and longest.length * longest.width > kept * width
    if is_header and begins_below and declared.skip is None:
        hint = f"`skip: {longest.start}` begins at line {longest.start + 1}, with the most numbers on end"
        if width == 1:
            hint += "; a scale factor above them belongs to the unit, `unit: 2.5 g`"
        return text.refuse_curable(message, hint, {"skip": longest.start}, row.line)
    series = [run for run in runs if run.start >= rows[kept - 1].line and run.length > 1]
    is_end = not series or abs(series[0].length - kept) <= 1
    if series and declared.time is not None:
        place = min(declared.time, width) - 1
        above = grammar.parse(rows[kept - 1].cells[place]) or 0.0
        is_end = is_end and (grammar.parse(_split_row(grammar, text.lines[series[0].start])[place]) or 0.0) < above
    is_words = not words or not _NUMBER_FIRST.match(words) or row.line <= rows[kept - 1].line
    if kept >= 2 and is_end and is_words:
        hint = f"`rows: {kept}` reads the {pluralize(kept, 'row')} above"
        hint += f", and nothing of the series that follows on line {series[0].start + 1}" if series else ""
        return text.refuse_curable(message, hint, {"rows": kept}, row.line)
    hint = "correct this line; `separator:` and `decimal:` say what its signs mean"
    if is_words:
        hint = f"take this line out if the numbers go on below it; `rows: {kept}` reads the rows above alone"
    return text.refuse(message, hint, row.line)


def _list_runs(text: TextFile, grammar: Grammar, first: int) -> list[_Run]:
    """Return the lines of numbers on end, from an index on, that have as many cells; the last one may be shorter."""
    lines = text.lines[first:]
    widths = [len(_split_row(grammar, line)) if _is_row_of_numbers(grammar, line) else 0 for line in lines]
    runs: list[_Run] = []
    start = first
    for width, group in groupby(widths):
        length = len(list(group))
        before = runs[-1] if runs else None
        if before and length == 1 and 0 < width < before.width and before.start + before.length == start:
            runs[-1] = before._replace(length=before.length + 1)
        elif width:
            runs.append(_Run(start, length, width))
        start += length
    return runs


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
        if not grammar.widths and any(map(touches, cells)) and (form := guess_fortran(line)):
            hint = f"write `format: {form}` if the cells are printed in columns without blanks"
            raise text.refuse_curable(fault.message, hint, {"format": form}, index + 1, column)
        hint = f"`skip: {first}` begins at line {first + 1}, if this one belongs to the heading"
        cure: Mapping[str, Any] = fault.cure or {"skip": first}
        if not fault.cure and len(line.split()) > MAX_HEADER_NUMBERS:
            hint = f"take the numbers of the heading out of this line; {hint}"
            raise text.refuse(fault.message, hint, index + 1, column)
        if factor := _FACTOR.match(line):
            unit = f"{float(factor[1]):g} {declared.unit}"
            hint = f"a factor belongs to the unit: `unit: {unit}`, and {hint}"
            cure = {"unit": unit, "skip": first}
        else:
            hint = f"{fault.hint}; {hint}"
        raise text.refuse_curable(fault.message, hint, cure, index + 1, column)


def _refuse_header_numbers(text: TextFile, rows: Sequence[Row], numbers: np.ndarray, declared: Declaration) -> None:
    """Refuse values of which the first are their count or their time step.

    Raises
    ------
    CurableError : with the number of lines above the samples; `skip:` says that they are samples
    """
    if declared.time is not None or declared.skip is not None or len(rows) < HEADER_ROWS:
        return
    width = len(rows[0].cells)
    found = ""
    count = None
    end = 0
    steps = np.diff(numbers[: (numbers.size // width) * width].reshape(-1, width)[:, :2], axis=0)
    has_times = width > 1 and (steps > 0).all(axis=0).any()
    for place in range(min(HEADER_ROWS, len(rows) - 1)):
        left = {numbers.size - (place + 1) * width, len(rows) - place - 1}
        if declared.column is None and width > 1:
            left |= {numbers.size - 1, numbers.size - 2}
        said = ""
        for value in numbers[place * width : place * width + min(width, 2)]:
            is_whole = value >= LEAST_COUNT and float(value).is_integer()
            if is_whole and min(abs(value - each) for each in left) <= 2:
                said = f"{value:g}, the number of values below"
                count = float(value)
            elif value == declared.dt and not has_times and numbers.any():
                said = f"{value:g}, the time step"
        if not said:
            break
        found = found or said
        end = place + 1
    is_numbered = width > 1 and numbers[:width].tolist() == list(range(1, width + 1))
    if is_numbered and declared.column is not None:
        found, end = "the numbers of the columns", 1
    if not found:
        return
    lines = rows[end - 1].line
    if count is not None and width == 1 and end <= numbers.size - count <= HEADER_ROWS + 1:
        lines = rows[numbers.size - int(count) - 1].line  # a number of another kind may stand between
    message = f"the first rows hold {found}"
    hint = f"write `skip: {lines}` if so, `skip: {rows[0].line - 1}` if they are samples"
    following = numbers.size - (lines - rows[0].line + 1) * width
    if count is not None and count not in (following, len(rows) - end, numbers.size - 2):
        raise text.refuse(message, f"{pluralize(following, 'value follows', 'values follow')}: {hint}", rows[0].line)
    raise text.refuse_curable(message, hint, {"skip": lines}, rows[0].line)


def _refuse_points_of_thousands(text: TextFile, rows: Sequence[Row], declared: Declaration) -> None:
    """Refuse a column of whole numbers below 1000 and numbers with exactly three decimals: -980, -1.408, 2.096.

    Raises
    ------
    CurableError : with the key that says that the points part thousands
    """
    if declared.decimal is not None or declared.thousands is not None or declared.is_fortran():
        return
    whole, grouped = re.compile(r"[-+]?\d{1,3}\Z"), re.compile(r"[-+]?[1-9]\d{0,2}(?:\.\d{3})+\Z")
    for place in range(min(len(rows[0].cells), 12)):
        cells = [row.cells[place] for row in rows if place < len(row.cells)]
        first = next((row for row in rows if place < len(row.cells) and grouped.match(row.cells[place])), None)
        if first is None or not any(map(whole.match, cells)):
            continue
        if all(whole.match(cell) or grouped.match(cell) for cell in cells):
            cell = first.cells[place]
            message = f"'{cell}' stands in a column of whole numbers: its point may part thousands"
            hint = 'write `thousands: "."` if it does, `decimal: "."` if it is a decimal point'
            cure = {"thousands": ".", "decimal": ","}
            raise text.refuse_curable(message, hint, cure, first.line)


def _list_margins(text: TextFile, rows: Sequence[Row], grammar: Grammar) -> tuple[UnreadLine, ...]:
    """Return what stands behind the fixed columns of the first row, as a line that was not read.

    Raises
    ------
    InputError : numbers with decimals stand there
    """
    width = grammar.indent + sum(grammar.widths)
    if not grammar.widths:
        return ()
    for row in rows:
        margin = text.lines[row.line - 1][width:].strip()
        if re.search(r"\d[.,]\d|[.,]\d", margin):
            message = f"'{margin[:40]}' stands behind the columns of the format"
            raise text.refuse(message, "write the format of all numbers of a line, e.g. 8F9.6", row.line, width + 1)
    margin = text.lines[rows[0].line - 1][width:].strip()
    return (UnreadLine(rows[0].line, f"{margin} (behind column {width} of line {rows[0].line})"),) if margin else ()
