"""Tables as a page shows them: so many columns that none needs to be scrolled sideways."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from pounding_cli.tables import PAGE_ROWS, Column, Table

PAGE_WIDTH = 72.0
"""Room for a table on a page of 1400 pixels, in heights of its letters (em)."""

MAX_TEXT_WIDTH = 8.0
"""Width to which a column of texts may be wrapped [em]."""

MAX_SHARED = 8
"""Columns with one value in all rows that are told in a line above a table."""

_CHARACTER = 0.64
"""Width of a digit or a letter [em]."""

_HEAD_CHARACTER = 0.7
"""Width of a letter of a heading [em]."""

_PADDING = 0.8
"""Space between two columns [em]."""

BREAK = re.compile(r"(?<=[._/|])(?=[^\W\d])")
"""Places in a name at which a line may end: behind the points of a key and the underscores of a name."""


@dataclass(frozen=True)
class PageTable:
    """A table cut to the width of a page.

    table : with the columns that have room
    cells : its first rows as texts
    shared : "name value" of every column that has one value in all rows, and is left out for that
    left_out : headings of further columns without room
    parts : the columns without room of a table that has no file, as tables with the first columns of each row
    """

    table: Table
    cells: list[list[str]]
    shared: Sequence[str] = ()
    left_out: Sequence[str] = ()
    parts: Sequence[PageTable] = ()

    @property
    def more_rows(self) -> int:
        """The number of rows that are not evidence."""
        return len(self.table.frame) - len(self.cells)


def fit_table(table: Table, width: float = PAGE_WIDTH) -> PageTable:
    """Return a table cut to a width [em].

    Where there is no room for all columns, those with one value in all rows are told in a line, and of the others the
    optional ones are left out first, the last ones first; a table without a file is divided instead.
    """
    columns = list(table.columns)
    cells = dict(zip(map(id, columns), _columns_of_cells(table), strict=True))
    widths = {id(column): _min_width(column, cells[id(column)]) for column in columns}

    def is_too_wide(some: Sequence[Column]) -> bool:
        return sum(widths[id(column)] for column in some) > width

    shared: list[str] = []
    further: list[Column] = []
    if is_too_wide(columns) and len(table.frame) > 1:
        for column in columns[1:]:
            if len(shared) < MAX_SHARED and _is_shared(table, column, cells[id(column)]):
                shared.append(f"{column.head} {cells[id(column)][0]}")
                columns.remove(column)
    while is_too_wide(columns) and len(columns) > 2:
        optional = [place for place, column in enumerate(columns) if column.optional and place]
        dropped = columns.pop(optional[-1] if optional and table.name else -1)
        further.append(dropped)
    further.sort(key=table.columns.index)
    rows = [list(row) for row in zip(*(cells[id(column)] for column in columns), strict=True)]
    cut = Table(table.name, table.frame, columns, table.caption)
    if table.name or not further:
        return PageTable(cut, rows, shared, [column.head for column in further])
    rest = Table("", table.frame, [*columns[: _count_leading_texts(cut)], *further], table.caption)
    if len(rest.columns) >= len(table.columns):  # no part is narrower
        return PageTable(table, table.cells(PAGE_ROWS))
    return PageTable(cut, rows, shared, parts=[fit_table(rest, width)])


def _columns_of_cells(table: Table) -> list[list[str]]:
    """Return the cells of the first rows, column by column."""
    rows = table.cells(PAGE_ROWS)
    return [[row[place] for row in rows] for place in range(len(table.columns))]


def _is_shared(table: Table, column: Column, cells: Sequence[str]) -> bool:
    """Return whether all rows of a table have one short cell in a column, also those that a page leaves out."""
    if len(set(cells)) != 1 or "\n" in cells[0] or not 0 < len(cells[0]) <= 40:
        return False
    return column.name not in table.frame or table.frame[column.name].nunique(dropna=False) == 1


def _count_leading_texts(table: Table) -> int:
    """Return how many columns at the left say which row it is."""
    are_numbers = table.are_right_aligned()
    return max(1, are_numbers.index(True) if True in are_numbers else len(are_numbers) // 2)


def _min_width(column: Column, cells: Sequence[str]) -> float:
    """Return the width that a column needs [em], with headings and texts wrapped between words."""
    words = [word for word in column.head.split() for word in BREAK.split(word)]
    width = _HEAD_CHARACTER * max(map(len, words), default=0)
    lines = {line for cell in cells for line in cell.split("\n")}
    is_number = all(re.fullmatch(r"[−\d.×⁻⁰¹²³⁴⁵⁶⁷⁸⁹–]*", line) for line in lines)
    longest = max(map(len, lines), default=0)
    if not is_number:
        tokens = [token for line in lines for word in line.split() for token in BREAK.split(word)]
        longest_token = max(map(len, tokens), default=0)
        longest = max(longest_token, min(longest, int(MAX_TEXT_WIDTH / _CHARACTER)))
    return max(width, _CHARACTER * longest) + _PADDING
