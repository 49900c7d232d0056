"""Tables that frame programs export, as an Excel workbook or CSV files: found by names that differ by version."""

from __future__ import annotations

import csv
import hashlib
import io
import itertools
import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.imports.units import NO_UNITS, SYSTEM_HINT, find_factor, is_unit
from pounding_cli.numbers import join_limited
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


def normalize_name(text: str) -> str:
    """Return the letters and digits of a name in lower case: `Stiff X` and `StiffX` are one."""
    return re.sub(r"[^a-z0-9]+", "", text.lower())


@dataclass
class ProgramColumn:
    """A column of a table.

    name : as its heading says
    place : its number, from 0
    unit : as the table writes it; "" where it writes none
    """

    name: str
    place: int
    unit: str


@dataclass
class ProgramTable:
    """A table as a program exports it: a title, headings, in many of them a row of units, and rows.

    title : of its first row, or the name of its sheet or file
    path : of its file
    sheet : of a workbook; "" for a CSV file
    load_rows : returns all rows of the sheet or file
    system : factors to SI of columns without a unit, by SI unit; empty: they are refused
    decimals : how the numbers of its file are written
    """

    title: str
    path: Path
    sheet: str
    first_rows: tuple[ProgramRow, ...]
    load_rows: Callable[[], Iterable[ProgramRow]]
    system: dict[str, float]
    decimals: Decimals = field(default_factory=lambda: Decimals("", False))

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
        """Its columns that have a heading."""
        _, (_, headings), units_row = self._head
        columns = []
        for place, heading in enumerate(headings):
            name = format_cell(heading)
            if not name:
                continue
            unit = format_cell(units_row[1][place]) if units_row and place < len(units_row[1]) else ""
            bracketed = re.fullmatch(r"(.*?)\s*[\[(]([^\])]*)[\])]\s*", name)
            if bracketed is not None:
                name = bracketed[1]
                unit = unit or bracketed[2]
            columns.append(ProgramColumn(name, place, unit))
        return tuple(columns)

    @cached_property
    def rows(self) -> tuple[ProgramRow, ...]:
        """Its rows of values that are not empty.  Raises InputError: too many."""
        skipped = self._head[0]
        rows: list[ProgramRow] = []
        filled = (row for row in self.load_rows() if count_filled(row))
        for place, row in enumerate(filled):
            if place >= skipped:
                rows.append(row)
            if len(rows) > MAX_ROWS:
                raise self.refuse(f"has more than {MAX_ROWS} rows", "export the tables of storeys alone")
        return tuple(rows)

    @property
    def words(self) -> str:
        """The table in words: its sheet, or its file."""
        return f"sheet '{self.sheet}'" if self.sheet else f"'{self.title}'"

    def find_column(self, names: Sequence[str]) -> ProgramColumn | None:
        """Return the first column of one of these names, by letters and digits alone; None where there is none."""
        for name in names:
            for column in self.columns:
                if normalize_name(column.name) == normalize_name(name):
                    return column
        return None

    def get_column(self, names: Sequence[str], meaning: str) -> ProgramColumn:
        """Return the column of one of these names.

        Raises
        ------
        InputError : there is none, with the columns that are there
        """
        column = self.find_column(names)
        if column is None:
            there = join_limited([escape_controls(each.name) for each in self.columns], 300)
            message = f"{self.words} has no column '{names[0]}' ({meaning}); it has {there}"
            headings = ", ".join(dict.fromkeys(names))
            hint = f"export it with one of the headings {headings}; a unit stands in brackets or in the row below"
            raise InputError(Problem(message, hint, shorten_path(self.path), self._head[1][0], 1))
        alike = [each for each in self.columns if normalize_name(each.name) == normalize_name(column.name)]
        if len(alike) > 1:
            message = f"{self.words} has {len(alike)} columns '{escape_controls(column.name)}' ({meaning})"
            hint = "leave the one that counts, or give the others another heading"
            place = alike[1].place + 1
            raise InputError(Problem(message, hint, shorten_path(self.path), self._head[1][0], place))
        return column

    def read_text(self, row: ProgramRow, column: ProgramColumn) -> str:
        """Return a cell as text; "" where it is empty."""
        return format_cell(row[1][column.place]) if column.place < len(row[1]) else ""

    def read_number(self, row: ProgramRow, column: ProgramColumn) -> float:
        """Return a cell as a number in the unit of the table.

        Raises
        ------
        InputError : it is empty, or not a finite number
        """
        text = self.read_text(row, column)
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if math.isfinite(number):
            return number
        if not text:
            raise self.refuse("is empty", "export the table with its results, or write the number", row, column)
        hint = "write a plain number with a decimal point"
        raise self.refuse(f"'{escape_controls(text[:60])}' is not a number", hint, row, column)

    def read_quantity(self, row: ProgramRow, column: ProgramColumn, si: str) -> float:
        """Return a cell in SI.

        si : SI unit of what it measures

        Raises
        ------
        InputError : it is not a number, or its unit is missing or another
        """
        return self.read_number(row, column) * self.find_factor_of(column, si)

    def find_factor_of(self, column: ProgramColumn, si: str) -> float:
        """Return one unit of a column in SI.  Raises InputError: its unit is missing or of another quantity."""
        if column.unit.strip().lower() in NO_UNITS:
            if si in self.system:
                return self.system[si]
            message = f"column '{column.name}' of {self.words} has no unit"
            hint = f"write it below the heading or behind it, `{column.name} [{si}]`, or {SYSTEM_HINT}"
            raise InputError(Problem(message, hint, shorten_path(self.path), self._head[1][0], column.place + 1))
        factor = find_factor(column.unit, si)
        if factor is None:
            quantity = QUANTITY_OF_UNIT[si]
            message = (
                f"column '{column.name}' of {self.words}: '{escape_controls(column.unit)}' is not a unit of {quantity}"
            )
            units_row = self._head[2] or self._head[1]
            hint = f"write a unit of {quantity} there, e.g. {si}"
            if si == "kg" and find_factor(column.unit, "N") is not None:
                hint += "; a weight is a mass times g: divide it by 9.81 m/s²"
            raise InputError(Problem(message, hint, shorten_path(self.path), units_row[0], column.place + 1))
        return factor

    def refuse(
        self, message: str, hint: str, row: ProgramRow | None = None, column: ProgramColumn | None = None
    ) -> InputError:
        """Return the refusal of a row or cell, which names sheet, row and column."""
        if row is None or column is None:
            line = row[0] if row else 0
            return InputError(Problem(f"{self.words} {message}", hint, shorten_path(self.path), line, 1 if line else 0))
        place = f"{self.words}, row {row[0]}, column '{escape_controls(column.name)}'"
        return InputError(Problem(f"{place}: {message}", hint, shorten_path(self.path), row[0], column.place + 1))

    def describe_column(self, column: ProgramColumn) -> str:
        """Return table, column and unit in words."""
        unit = f" [{column.unit}]" if column.unit.strip().lower() not in NO_UNITS else ""
        return f"'{self.title}', column {column.name}{unit}"


@dataclass(frozen=True)
class Decimals:
    """How the numbers of a CSV file are written.

    example : a number with a decimal comma; "" where decimal signs are points
    is_ambiguous : True where the sign of every number may part thousands: three digits follow each one
    """

    example: str
    is_ambiguous: bool


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
        wanted = [normalize_name(name) for name in names]
        for name in wanted:
            found = []
            for table in self.tables:
                titles = {normalize_name(table.title), normalize_name(table.sheet)}
                is_cut = len(table.sheet) == 31 and name.startswith(normalize_name(table.sheet))
                if name in titles or is_cut:
                    found.append(table)
            if found:
                return self._take_only(found)
        return None

    def find_table_with(self, *columns: Sequence[str]) -> ProgramTable | None:
        """Return the table that has a column of each of these lists of names; None where there is none.

        Raises
        ------
        InputError : there are several
        """
        found = [table for table in self.tables if all(table.find_column(names) for names in columns)]
        return self._take_only(found) if found else None

    def _take_only(self, found: Sequence[ProgramTable]) -> ProgramTable:
        """Return the only one of some tables.  Raises InputError: there are several."""
        if len(found) == 1:
            return found[0]
        names = [escape_controls(table.sheet or table.path.name) for table in found]
        message = f"{len(found)} tables could be meant: {join_limited(names, 300)}"
        raise InputError(Problem(message, "leave one of them in the file or folder", shorten_path(self.path)))

    def list_decimals(self) -> list[Decimals]:
        """Return how the numbers of its files are written, each way once."""
        return list(dict.fromkeys(table.decimals for table in self.tables))

    def list_titles(self) -> str:
        """Return the titles of its tables in words."""
        return join_limited([escape_controls(table.title) for table in self.tables], 300) or "no table"

    def list_digests(self) -> list[tuple[str, str]]:
        """Return the name and the SHA-256 of each of its files."""
        paths = dict.fromkeys(table.path for table in self.tables)
        return [(path.name, hashlib.sha256(path.read_bytes()).hexdigest()) for path in paths]


def read_tables(path: Path, system: dict[str, float] | None = None) -> TableFile:
    """Return the tables of a workbook, a CSV file, or a folder of CSV files.

    system : factors to SI of columns without a unit, by SI unit

    Raises
    ------
    InputError : there is no such file, it cannot be read, or it holds no table
    """
    units = system or {}
    if path.is_dir():
        files = sorted(each for each in path.iterdir() if each.suffix.lower() == ".csv")
        tables = [table for each in files for table in _iter_csv_tables(each, units)]
        if not tables:
            hint = "export the tables as CSV into it, one file a table, or name a workbook"
            raise InputError(Problem("the folder holds no CSV file with a table", hint, shorten_path(path)))
        return TableFile(path, tuple(tables))
    content = read_bytes(path, MAX_FILE_SIZE, "file of tables, .xlsx or .csv,")
    if content.startswith(b"PK\x03\x04"):
        tables = list(_iter_sheets(path, content, units))
    elif content.startswith(b"\xd0\xcf\x11\xe0"):
        message = "this is a workbook of an old version of Excel, or one with a password"
        raise InputError(Problem(message, "save it as .xlsx without a password", shorten_path(path)))
    else:
        tables = list(_iter_csv_tables(path, units))
    if not tables:
        raise InputError(Problem("the file holds no table", "export it with headings and rows", shorten_path(path)))
    return TableFile(path, tuple(tables))


def _iter_sheets(path: Path, content: bytes, system: dict[str, float]) -> Iterator[ProgramTable]:
    """Yield the tables of a workbook, a sheet each.

    Raises
    ------
    InputError : openpyxl is not installed, or cannot read the workbook
    """
    try:
        import openpyxl
    except ImportError:
        message = "a workbook needs the package openpyxl, which is not installed"
        raise InputError(Problem(message, "pip install openpyxl, or export CSV files", shorten_path(path))) from None
    import warnings
    import zipfile

    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            size = sum(each.file_size for each in archive.infolist())
        if size > MAX_UNPACKED_SIZE:
            message = f"the workbook unpacks to {size / 1e6:.0f} MB"
            raise InputError(Problem(message, "export the tables of storeys alone", shorten_path(path)))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of styles and extensions, which hold no numbers
            book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
            sheets = [(sheet, tuple(_iter_first_rows(_iter_sheet_rows(sheet)))) for sheet in book.worksheets]
    except InputError:
        raise
    except Exception as error:  # a damaged workbook may fail anywhere in openpyxl
        message = f"the workbook cannot be read: {escape_controls(str(error))[:200] or type(error).__name__}"
        raise InputError(Problem(message, "save it anew as .xlsx, or export CSV files", shorten_path(path))) from None
    for sheet, first_rows in sheets:
        if first_rows:
            title = _find_title(first_rows, sheet.title)
            yield ProgramTable(title, path, sheet.title, first_rows, _sheet_loader(sheet), system)


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


def _iter_csv_tables(path: Path, system: dict[str, float]) -> Iterator[ProgramTable]:
    """Yield the table of a CSV file; none where it is empty.

    Raises
    ------
    InputError : it is not text
    """
    content = read_bytes(path, MAX_FILE_SIZE, "CSV file")
    try:
        text = content.decode("utf-16" if content[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("cp1252", errors="replace")
    if "\0" in text:
        raise InputError(Problem("this is not a text file", "name a CSV file or an .xlsx workbook", shorten_path(path)))
    rows, decimals = _split_csv(text)
    first_rows = tuple(_iter_first_rows(rows))
    if first_rows:
        yield ProgramTable(_find_title(first_rows, path.stem), path, "", first_rows, lambda: rows, system, decimals)


def _split_csv(text: str) -> tuple[list[ProgramRow], Decimals]:
    """Return the rows of a CSV file, whose columns are parted by commas, semicolons or tabs, and how it writes numbers.

    Where they are parted by semicolons or tabs and no cell has a decimal point, commas in numbers are decimal signs.
    """
    delimiter = max(",;\t", key=lambda sign: text[:5000].count(sign))
    for sign in ";\t":  # with decimal commas a line may have more commas than semicolons
        if text[:5000].count(sign) >= max(text[:5000].count("\n"), 1):
            delimiter = sign
    lines = text.splitlines()
    rows = [(reader_line, tuple(cells)) for reader_line, cells in _iter_csv_lines(lines, delimiter)]
    is_decimal_comma = delimiter != "," and not any(
        re.fullmatch(r"\s*-?\d*\.\d+(e[-+]?\d+)?\s*", cell, re.IGNORECASE) for _, cells in rows for cell in cells
    )
    sign = "," if is_decimal_comma else r"\."
    numbers = [cell.strip() for _, cells in rows for cell in cells if re.fullmatch(rf"\s*[-+]?\d+{sign}\d+\s*", cell)]
    is_ambiguous = bool(numbers) and all(re.fullmatch(rf"[-+]?[1-9]\d{{0,2}}{sign}\d{{3}}", each) for each in numbers)
    if not is_decimal_comma:
        return rows, Decimals("", is_ambiguous and delimiter != ",")
    example = numbers[0] if numbers else ""
    replaced = [(number, tuple(map(_replace_decimal_comma, cells))) for number, cells in rows]
    return replaced, Decimals(example, is_ambiguous)


def _iter_csv_lines(lines: Sequence[str], delimiter: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the cells of every line with its number; lines that begin with # are left out."""
    reader = csv.reader(("" if line.startswith("#") else line for line in lines), delimiter=delimiter)
    try:
        for cells in reader:
            yield reader.line_num, cells
    except csv.Error:  # a quotation mark that does not end: plain cells
        for number, line in enumerate(lines, 1):
            yield number, line.split(delimiter)


def _replace_decimal_comma(cell: str) -> str:
    """Return a number with a decimal point in place of its comma; other texts as they are."""
    is_number = re.fullmatch(r"\s*[-+]?\d+,\d+([eE][-+]?\d+)?\s*", cell)
    return cell.replace(",", ".") if is_number else cell
