"""Tables that frame programs export, as an Excel workbook or CSV files, and tables of one's own.

Those of ETABS and SAP2000 are known by their titles and headings. In any other table the heading of a column is the
name of what it holds, or its column is declared. Cells of text files are those of `cells`.
"""

from __future__ import annotations

import hashlib
import io
import itertools
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from pounding_cli.cells import BLANKS, Grammar, hint_options, load_text
from pounding_cli.errors import InputError, Issue
from pounding_cli.imports.declared import GRAVITIES, ColumnSource, TableDeclaration
from pounding_cli.imports.headings import is_named, list_headings, normalize_name
from pounding_cli.imports.units import NO_UNITS, SYSTEM_HINT, find_factor, is_same_unit, is_unit
from pounding_cli.numbers import join_limited, pluralize
from pounding_cli.reading import read_bytes, shorten_path
from pounding_cli.texts import escape_controls

MAX_FILE_SIZE = 100_000_000
"""Bytes of a workbook or a CSV file."""

MAX_UNPACKED_SIZE = 1_000_000_000
"""Bytes of what a workbook holds when it is unpacked."""

MAX_ROWS = 200_000
"""Rows of a table."""

_PEEKED_ROWS = 8
"""Rows that show titles, headings and units of a table."""

QUANTITY_OF_UNIT = {"m": "length", "kg": "mass", "N": "force", "N/m": "stiffness", "s": "time"}
"""SI unit -> what it measures."""

ProgramRow = tuple[int, tuple[Any, ...]]
"""Number of a row in its file, from 1, and its cells."""


@dataclass(frozen=True)
class ProgramColumn:
    """A column of a table.

    name : as its heading says
    place : its number, from 0
    unit : as the table writes it; "" where it writes none
    factor : by which its numbers are multiplied (`ColumnSource`)
    """

    name: str
    place: int
    unit: str
    factor: float = 1.0


@dataclass
class ProgramTable:
    """A table as a program exports it: a title, headings, in many of them a row of units, and rows.

    title : of its first row, or the name of its sheet or file
    path : of its file
    sheet : of a workbook; "" for a text file
    load_rows : returns all rows of the sheet or file
    grammar : how numbers in cells of text are written
    declared : of it
    """

    title: str
    path: Path
    sheet: str
    first_rows: tuple[ProgramRow, ...]
    load_rows: Callable[[], Iterable[ProgramRow]]
    grammar: Grammar
    declared: TableDeclaration

    @cached_property
    def headings(self) -> Mapping[str, tuple[str, ...]]:
        """The headings that its columns have, by quantity."""
        return list_headings((self.title, self.sheet), self.declared.direction)

    @property
    def sources(self) -> Mapping[str, ColumnSource]:
        """The columns that are declared; tables of programs are known."""
        return {} if self.is_of_program else self.declared.sources

    @property
    def is_of_program(self) -> bool:
        """Whether it is a table of ETABS or SAP2000."""
        return "mode" in self.headings

    @cached_property
    def _head(self) -> tuple[int, ProgramRow, ProgramRow | None]:
        """Number of rows above the first values, the row of headings, and the row of units."""
        titles = list(itertools.takewhile(lambda row: count_filled(row) == 1, self.first_rows))
        heading_place = len(titles) if len(titles) < len(self.first_rows) else 0
        headings = self.first_rows[heading_place]
        below = self.first_rows[heading_place + 1 : heading_place + 2]
        if below and _is_row_of_units(headings, below[0]):
            return heading_place + 2, headings, below[0]
        return heading_place + 1, headings, None

    @cached_property
    def columns(self) -> tuple[ProgramColumn, ...]:
        """Its columns that have a heading; none where the row of headings holds numbers."""
        headings = self._head[1][1]
        if any(self._parse(heading) is not None for heading in headings):
            return ()
        return tuple(self._build_column(place) for place, heading in enumerate(headings) if format_cell(heading))

    def _build_column(self, place: int) -> ProgramColumn:
        """Return the column at a place, from 0; one without a heading is named by its number."""
        _, (_, headings), units_row = self._head
        name = format_cell(headings[place]) or str(place + 1)
        unit = format_cell(units_row[1][place]) if units_row and place < len(units_row[1]) else ""
        bracketed = re.fullmatch(r"(.*?)\s*[\[(]([^\])]*)[\])]\s*", name)
        if bracketed is not None:
            name = bracketed[1]
            unit = unit or bracketed[2]
        return ProgramColumn(name, place, unit)

    @cached_property
    def rows(self) -> tuple[ProgramRow, ...]:
        """Its rows of values that are not empty.

        Raises
        ------
        InputError : too many, or in a text file one with more or fewer cells than headings
        """
        skipped = self._head[0]
        rows: list[ProgramRow] = []
        filled = (row for row in self.load_rows() if count_filled(row))
        for place, row in enumerate(filled):
            if place >= skipped:
                self._check_width(row)
                rows.append(row)
            if len(rows) > MAX_ROWS:
                raise self.refuse(f"has more than {MAX_ROWS} rows", "export the tables of storeys alone")
        return tuple(rows)

    def _check_width(self, row: ProgramRow) -> None:
        """Raise InputError where a row of a text file has not one cell for each heading."""
        width = len(self._head[1][1])
        beyond = [place for place, cell in enumerate(row[1]) if place >= width and format_cell(cell)]
        if self.sheet or (len(row[1]) >= width and not beyond):
            return
        message = f"{self.words}, row {row[0]}: {pluralize(len(row[1]), 'cell')} below {pluralize(width, 'heading')}"
        hint = (
            "write one cell for each heading, and quotes around one with a comma; --separator and --decimal say what "
            "the signs mean"
        )
        raise InputError(
            Issue((), message, hint, file=shorten_path(self.path), line=row[0], column=beyond[0] + 1 if beyond else 1)
        )

    @property
    def may_have_thousands(self) -> bool:
        """Whether commas part no cells of a text, no sign is declared, and three digits follow every point."""
        if self.sheet or self.grammar.separator == "," or self.declared.decimal or self.declared.thousands:
            return False
        cells = [cell for _, row in self.load_rows() for cell in row if re.fullmatch(r"[-+]?\d+\.\d+", cell)]
        return bool(cells) and all(re.fullmatch(r"[-+]?[1-9]\d{0,2}\.\d{3}", cell) for cell in cells)

    @property
    def words(self) -> str:
        """The table in words: its sheet, or its file."""
        return f"sheet '{self.sheet}'" if self.sheet else f"'{self.title}'"

    def find_column(self, quantity: str) -> ProgramColumn | None:
        """Return the column of a quantity, as declared or by its heading; None where there is none."""
        source = self.sources.get(quantity)
        if source is not None and (declared := self._find_source(source)) is not None:
            return declared
        for name in self.headings.get(quantity, ()):
            for column in self.columns:
                if normalize_name(column.name) == normalize_name(name):
                    return column
        return None

    def _find_source(self, source: ColumnSource) -> ProgramColumn | None:
        """Return the column that is declared; None where the table does not have it."""
        places = [each.place for each in self.columns if normalize_name(each.name) == normalize_name(source.heading)]
        if source.place >= 0:
            places = [source.place] if self.columns and source.place < len(self._head[1][1]) else []
        if not places:
            return None
        source.is_used = True
        column = self._build_column(places[0])
        return replace(column, unit=self._agree_on_unit(column, source), factor=source.factor)

    def _agree_on_unit(self, column: ProgramColumn, source: ColumnSource) -> str:
        """Return the unit of a column that is declared.  Raises InputError: the table names another."""
        has_none = column.unit.strip().lower() in NO_UNITS
        if not source.unit or has_none or is_same_unit(source.unit, column.unit):
            return source.unit or column.unit
        message = f"column '{column.name}' of {self.words} is in {column.unit}, and '{source.written}' says otherwise"
        raise InputError(Issue((), message, "leave the unit out, or correct the table", file=shorten_path(self.path)))

    def get_column(self, quantity: str, meaning: str) -> ProgramColumn:
        """Return the column of a quantity.

        Raises
        ------
        InputError : there is none, with the columns that are there; or several are named so
        """
        column = self.find_column(quantity)
        line = self._head[1][0]
        headings = self.headings.get(quantity, (quantity,))
        if column is None:
            there = join_limited([f"{each.place + 1} '{escape_controls(each.name)}'" for each in self.columns], 300)
            message = f"{self.words} has no column '{headings[0]}' ({meaning}); it has {there or 'no headings'}"
            hint = f"export it with one of the headings {', '.join(headings)}"
            if not self.is_of_program:
                hint = f"name the heading {headings[0]}, or declare its column: --column '{quantity}=HEADING', or {{}}"
                hint = hint.format(f"its number, '{quantity}=2'")
            raise InputError(Issue((), message, hint, file=shorten_path(self.path), line=line, column=1))
        alike = [each for each in self.columns if normalize_name(each.name) == normalize_name(column.name)]
        is_by_number = quantity in self.sources and self.sources[quantity].place >= 0
        if len(alike) > 1 and not is_by_number:
            message = f"{self.words} has {len(alike)} columns '{escape_controls(column.name)}' ({meaning})"
            hint = "leave the one that counts, or give the others another heading"
            raise InputError(
                Issue((), message, hint, file=shorten_path(self.path), line=line, column=alike[1].place + 1)
            )
        return column

    def read_text(self, row: ProgramRow, column: ProgramColumn) -> str:
        """Return a cell as text; "" where it is empty."""
        return format_cell(row[1][column.place]) if column.place < len(row[1]) else ""

    def _parse(self, cell: Any) -> float | None:
        """Return the finite number of a cell; None where it is none."""
        if isinstance(cell, int | float) and not isinstance(cell, bool):
            return float(cell) if math.isfinite(cell) else None
        return self.grammar.parse(format_cell(cell))

    def find_number(self, row: ProgramRow, column: ProgramColumn) -> float | None:
        """Return a cell as a number in the unit of the table; None where it is none."""
        return self._parse(row[1][column.place]) if column.place < len(row[1]) else None

    def read_number(self, row: ProgramRow, column: ProgramColumn) -> float:
        """Return a cell as a number in the unit of the table.

        Raises
        ------
        InputError : it is empty, or not a finite number
        """
        number = self.find_number(row, column)
        if number is not None:
            return number
        text = self.read_text(row, column)
        if not text:
            raise self.refuse("is empty", "export the table with its results, or write the number", row, column)
        fault = replace(self.grammar, separator=BLANKS).describe_fault(text)  # in quotes a cell may have any sign
        plain = "write a plain number with a decimal point; its unit stands behind the heading, or below it"
        hint = hint_options(fault) or plain
        raise self.refuse(escape_controls(fault.message), escape_controls(hint), row, column)

    def read_quantity(self, row: ProgramRow, column: ProgramColumn, si: str) -> float:
        """Return a cell in SI.

        si : SI unit of what it measures

        Raises
        ------
        InputError : it is not a number, or its unit is missing or another
        """
        return self.read_number(row, column) * self.find_factor_of(column, si) * column.factor

    def find_factor_of(self, column: ProgramColumn, si: str) -> float:
        """Return one unit of a column in SI; of weights that are divided by g, the unit of force.

        Raises
        ------
        InputError : its unit is missing or of another quantity
        """
        line = self._head[1][0]
        is_weight = si == "kg" and column.factor != 1.0
        if column.unit.strip().lower() in NO_UNITS:
            if si in self.declared.system and not is_weight:
                return self.declared.system[si]
            message = f"column '{column.name}' of {self.words} has no unit"
            example = "kN" if is_weight else si
            hint = f"write it below the heading or behind it, `{column.name} [{example}]`, or {SYSTEM_HINT}"
            raise InputError(Issue((), message, hint, file=shorten_path(self.path), line=line, column=column.place + 1))
        factor = find_factor(column.unit, si)
        force = find_factor(column.unit, "N") if si == "kg" else None
        if factor is None and force is not None and GRAVITIES[0] <= 1.0 / column.factor <= GRAVITIES[1]:
            return force
        if factor is None:
            quantity = QUANTITY_OF_UNIT[si]
            message = (
                f"column '{column.name}' of {self.words}: '{escape_controls(column.unit)}' is not a unit of {quantity}"
            )
            units_row = self._head[2] or self._head[1]
            hint = f"write a unit of {quantity} there, e.g. {si}"
            if force is not None:
                hint += f"; a weight is a mass times g, in m/s²: --column 'mass={column.name}/9.81'"
            raise InputError(
                Issue((), message, hint, file=shorten_path(self.path), line=units_row[0], column=column.place + 1)
            )
        return factor

    def refuse(
        self, message: str, hint: str, row: ProgramRow | None = None, column: ProgramColumn | None = None
    ) -> InputError:
        """Return the refusal of a row or cell, which names sheet, row and column."""
        if row is None or column is None:
            line = row[0] if row else 0
            return InputError(
                Issue(
                    (),
                    f"{self.words} {message}",
                    hint,
                    file=shorten_path(self.path),
                    line=line,
                    column=1 if line else 0,
                )
            )
        place = f"{self.words}, row {row[0]}, column '{escape_controls(column.name)}'"
        return InputError(
            Issue((), f"{place}: {message}", hint, file=shorten_path(self.path), line=row[0], column=column.place + 1)
        )

    def describe_column(self, column: ProgramColumn) -> str:
        """Return table, column and unit in words."""
        unit = f" [{column.unit}]" if column.unit.strip().lower() not in NO_UNITS else ""
        times = "" if column.factor == 1.0 else f" x {column.factor:.6g}"
        return f"'{self.title}', column {column.name}{unit}{times}"

    def list_unread_titles(self) -> list[str]:
        """Return the cells of the rows above the headings."""
        above = itertools.takewhile(lambda row: row[0] < self._head[1][0], self.first_rows)
        return [format_cell(cell) for row in above for cell in row[1] if format_cell(cell)]


def _is_row_of_units(headings: ProgramRow, row: ProgramRow) -> bool:
    """Return whether the row below the headings holds units: no number, and a unit or nothing in its first column."""
    cells = [format_cell(cell) for cell in row[1]]
    if any(re.match(r"[-+]?[.,]?\d", cell) for cell in cells):
        return False
    first = next(place for place, heading in enumerate(headings[1]) if format_cell(heading))
    if first >= len(cells) or not cells[first]:
        return True
    return any(cell and is_unit(cell) for cell in cells)


def count_filled(row: ProgramRow) -> int:
    """Return how many cells of a row are not empty."""
    return sum(bool(format_cell(cell)) for cell in row[1])


def format_cell(cell: Any) -> str:
    """Return a cell as text: whole numbers without decimals, empty cells as ""."""
    if cell is None:
        return ""
    if isinstance(cell, float) and cell.is_integer() and abs(cell) < 1e15:
        return str(int(cell))
    return str(cell).strip()


@dataclass
class TableFile:
    """The tables of a workbook, a CSV file or a folder of CSV files.

    path : as the command names it
    tables : in the order of the sheets or of the names of the files
    """

    path: Path
    tables: tuple[ProgramTable, ...]

    def find_table(self, names: Sequence[str]) -> ProgramTable | None:
        """Return the table of the first of these names that there is; None where there is none.

        A sheet holds at most 31 characters of a name.

        Raises
        ------
        InputError : several tables have the name
        """
        for name in names:
            found = [table for table in self.tables if is_named(table.title, name) or is_named(table.sheet, name)]
            if found:
                return self._take_only(found)
        return None

    def find_table_with(self, *quantities: str) -> ProgramTable | None:
        """Return the table that has a column of each of these quantities; None where there is none.

        Raises
        ------
        InputError : there are several
        """
        found = [table for table in self.tables if all(table.find_column(each) for each in quantities)]
        return self._take_only(found) if found else None

    def _take_only(self, found: Sequence[ProgramTable]) -> ProgramTable:
        """Return the only one of some tables.  Raises InputError: there are several."""
        if len(found) == 1:
            return found[0]
        names = [escape_controls(table.sheet or table.path.name) for table in found]
        message = f"{len(found)} tables could be meant: {join_limited(names, 300)}"
        raise InputError(Issue((), message, "leave one of them in the file or folder", file=shorten_path(self.path)))

    def list_titles(self) -> str:
        """Return the titles of its tables in words."""
        return join_limited([escape_controls(table.title) for table in self.tables], 300) or "no table"

    def list_digests(self) -> list[tuple[str, str]]:
        """Return the name and the SHA-256 of each of its files."""
        paths = dict.fromkeys(table.path for table in self.tables)
        return [(path.name, hashlib.sha256(path.read_bytes()).hexdigest()) for path in paths]


def read_tables(path: Path, declared: TableDeclaration) -> TableFile:
    """Return the tables of a workbook, a CSV file, or a folder of CSV files.

    Raises
    ------
    InputError : there is no such file, it cannot be read, or it holds no table
    """
    if path.is_dir():
        files = sorted(each for each in path.iterdir() if each.suffix.lower() == ".csv")
        tables = [table for each in files for table in _iter_text_tables(each, declared)]
        if not tables:
            hint = "export the tables as CSV into it, one file a table, or name a workbook"
            raise InputError(Issue((), "the folder holds no CSV file with a table", hint, file=shorten_path(path)))
        return TableFile(path, tuple(tables))
    content = read_bytes(path, MAX_FILE_SIZE, "file of tables, .xlsx or .csv,")
    if content.startswith(b"PK\x03\x04"):
        tables = list(_iter_sheets(path, content, declared))
    elif content.startswith(b"\xd0\xcf\x11\xe0"):
        message = "this is a workbook of an old version of Excel, or one with a password"
        raise InputError(Issue((), message, "save it as .xlsx without a password", file=shorten_path(path)))
    else:
        tables = list(_iter_text_tables(path, declared))
    if not tables:
        raise InputError(
            Issue((), "the file holds no table", "export it with headings and rows", file=shorten_path(path))
        )
    return TableFile(path, tuple(tables))


def _iter_sheets(path: Path, content: bytes, declared: TableDeclaration) -> Iterator[ProgramTable]:
    """Yield the tables of a workbook, a sheet each.

    Raises
    ------
    InputError : openpyxl is not installed, or cannot read the workbook
    """
    try:
        import openpyxl
    except ImportError:
        message = "a workbook needs the package openpyxl, which is not installed"
        raise InputError(
            Issue((), message, "pip install openpyxl, or export CSV files", file=shorten_path(path))
        ) from None
    import warnings
    import zipfile

    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            size = sum(each.file_size for each in archive.infolist())
        if size > MAX_UNPACKED_SIZE:
            message = f"the workbook unpacks to {size / 1e6:.0f} MB"
            raise InputError(Issue((), message, "export the tables of storeys alone", file=shorten_path(path)))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of styles and extensions, which hold no numbers
            book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
            sheets = [(sheet, tuple(_iter_first_rows(_iter_sheet_rows(sheet)))) for sheet in book.worksheets]
    except InputError:
        raise
    except Exception as error:  # a damaged workbook may fail anywhere in openpyxl
        message = f"the workbook cannot be read: {escape_controls(str(error))[:200] or type(error).__name__}"
        raise InputError(
            Issue((), message, "save it anew as .xlsx, or export CSV files", file=shorten_path(path))
        ) from None
    for sheet, first_rows in sheets:
        if first_rows:
            title = _find_title(first_rows, sheet.title)
            loader = _sheet_loader(sheet)
            yield ProgramTable(title, path, sheet.title, first_rows, loader, declared.build_grammar(), declared)


def _sheet_loader(sheet: Any) -> Callable[[], Iterable[ProgramRow]]:
    """Return the function that loads the rows of a sheet."""
    return lambda: _iter_sheet_rows(sheet)


def _iter_sheet_rows(sheet: Any) -> Iterator[ProgramRow]:
    """Yield the rows of a sheet with their numbers."""
    return enumerate(sheet.iter_rows(values_only=True), 1)


def _iter_first_rows(rows: Iterable[ProgramRow]) -> Iterator[ProgramRow]:
    """Yield the first rows that are not empty."""
    found = 0
    for row in rows:
        if count_filled(row):
            yield row
            found += 1
        if found == _PEEKED_ROWS or row[0] > 100:
            return


def _find_title(first_rows: Sequence[ProgramRow], name: str) -> str:
    """Return the title of a table: that of a row above its headings, or the name of its sheet or file."""
    rows = list(itertools.takewhile(lambda row: count_filled(row) == 1, first_rows))
    titles = [next(filter(None, map(format_cell, row[1]))) for row in rows]
    marked = [title for title in titles if re.match(r"table\s*:", title, re.IGNORECASE)]
    if len(rows) == len(first_rows) or (len(titles) != 1 and not marked):
        return name
    title = (marked or titles)[0]
    return re.sub(r"^table\s*:\s*", "", title, flags=re.IGNORECASE).strip() or name


def _iter_text_tables(path: Path, declared: TableDeclaration) -> Iterator[ProgramTable]:
    """Yield the table of a text file; none where its lines are blank or begin with #.

    Raises
    ------
    InputError : it is not text
    """
    text = load_text(path, "table")
    grammar = declared.build_grammar(text)
    lines = [(number, line) for number, line in enumerate(text.lines, 1) if line.strip() and not line.startswith("#")]
    rows = [(number, tuple(grammar.split_row(line))) for number, line in lines]
    first_rows = tuple(_iter_first_rows(rows))
    if first_rows:
        title = _find_title(first_rows, path.stem)
        yield ProgramTable(title, path, "", first_rows, lambda: rows, grammar, declared)
