"""Cells of plain text files: one grammar of numbers for motions, hazard curves, storeys, pushover curves and streets.

A file is lines, a line is cells, and a `Grammar` says how they are written: what parts them, the decimal sign, the sign
between thousands. Every cell has a line and a column, and one that is not a number is refused there, with what settles
it. Nothing here reads a meaning out of words.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.reading import read_bytes, shorten_path

MAX_FILE_BYTES = 20_000_000
"""Size of a text file [bytes]."""

MAX_LINE_LENGTH = 1_000_000
"""Characters of a line."""

BLANKS = " "
"""The separator of cells that any number of blanks or tabs part."""

SEPARATORS = (";", "\t", ",", BLANKS)
"""What may part cells. Where nothing is declared the first of these on a row counts, as the others may stand within its
cells."""

SEPARATOR_WORDS = {";": "semicolons", "\t": "tabs", ",": "commas", BLANKS: "blanks"}

_CONTROL = bytes(set(range(32)) - set(b"\t\n\v\f\r"))
_BINARY = (
    (b"PK\x03\x04", "a zip archive or an Excel workbook"), (b"\x1f\x8b", "a gzip archive"), (b"%PDF", "a PDF document"),
    (b"\x89HDF", "an HDF5 file"), (b"MATLAB 5.0 MAT", "a MATLAB file"), (b"\x93NUMPY", "a NumPy array"),
    (b"\xd0\xcf\x11\xe0", "an Excel workbook"),
)  # fmt: skip
# How files that hold no text begin.
_PLAIN_SIGNS = str.maketrans({"\u2212": "-", "\u00a0": " ", "\u202f": " ", "\u2019": "'", "\u200b": "", "\ufeff": ""})
# A minus, blanks and apostrophes between thousands, and signs without a width, as other programs write them.
_EXPONENT = r"(?:[EeDd][-+]?\d+)?"
_FORTRAN = re.compile(
    r"\(?\s*(?:(\d{1,3})X\s*,\s*)?(\d{0,3})\s*[FEDGI]\s*([1-9]\d?)(?:\.(\d{1,2}))?\s*\)?\Z", re.IGNORECASE
)
MAX_NUMBER_LENGTH = 60
"""Characters of a number."""

_TOUCHING = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+)(?:[EeDd][-+]?\d+)?(?:[-+](?:\d+\.\d*|\.\d+)(?:[EeDd][-+]?\d+)?)+\Z")
_WITH_UNIT = re.compile(r"([-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+))\s*(?:g|[Gg]al|[mc]?m(?:/s\^?2)?|m?s|%)\Z")
_WITH_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?P<sign>[,.' \u00a0\u202f])\d{3}(?:(?P=sign)\d{3})*(?:[.,]\d*)?\Z")


class CurableError(InputError):
    """The refusal of a file that another declaration cures.

    cure : keys of a declaration, and their values
    """

    def __init__(self, problem: Issue, cure: Mapping[str, Any]) -> None:
        super().__init__(problem)
        self.cure = cure


class Fault(NamedTuple):
    """What is wrong with a cell, what settles it, and the keys of a declaration that do; {} for none."""

    message: str
    hint: str
    cure: Mapping[str, Any] = MappingProxyType({})


class Row(NamedTuple):
    """The cells of a line, without blanks around them.

    line : its number, from 1
    """

    line: int
    cells: list[str]


@dataclass(frozen=True)
class TextFile:
    """A text file as its lines.

    encoding : "UTF-16" or "Latin-1" where the file is that; "" for UTF-8
    """

    path: Path
    lines: list[str]
    encoding: str = ""

    def refuse(self, message: str, hint: str, line: int = 0, column: int = 1) -> InputError:
        """Return the refusal at a place of this file; line, column : from 1; line 0 is the whole file."""
        line = min(line, len(self.lines))
        return InputError(
            Issue((), message, hint, file=shorten_path(self.path), line=line, column=column if line else 0)
        )

    def refuse_curable(
        self, message: str, hint: str, cure: Mapping[str, Any], line: int, column: int = 1
    ) -> CurableError:
        """Return the refusal at a place of this file that keys of a declaration cure."""
        return CurableError(Issue((), message, hint, file=shorten_path(self.path), line=line, column=column), cure)


@dataclass(frozen=True)
class Grammar:
    """How the cells of a file are written.

    separator : one of `SEPARATORS`
    decimal : "." or ","
    thousands : sign between groups of three digits; "" for none
    widths : characters of each cell in the fixed columns of a Fortran format; () where a separator parts them
    has_points : every cell must have its decimal sign, as Fortran counts decimals from the right of one without
    indent : characters before the first of the fixed columns
    """

    separator: str = BLANKS
    decimal: str = "."
    thousands: str = ""
    widths: tuple[int, ...] = ()
    has_points: bool = False
    indent: int = 0

    def split(self, line: str) -> list[str]:
        """Return the cells of a line; quotes hold a cell together, and a separator at the end begins no other."""
        if self.widths:
            return self._split_columns(line)
        if self.separator == BLANKS:
            return line.split()
        if '"' in line:
            cells = [cell.strip() for cell in next(csv.reader([line], delimiter=self.separator, skipinitialspace=True))]
        else:
            cells = [cell.strip() for cell in line.split(self.separator)]
        return cells[:-1] if len(cells) > 1 and not cells[-1] else cells

    def split_row(self, line: str) -> list[str]:
        """Return the cells of a line below headings: as `split`, with the empty ones at its end."""
        return self.split(line if self.separator == BLANKS else line + self.separator)

    def _split_columns(self, line: str) -> list[str]:
        """Return the cells of fixed columns; empty ones at the end of a line are none."""
        cells = []
        begin = self.indent
        for width in self.widths:
            cells.append(line[begin : begin + width].strip())
            begin += width
        while cells and not cells[-1]:
            cells.pop()
        return cells

    def find_column(self, line: str, place: int) -> int:
        """Return the column, from 1, at which the cell of a place, from 0, begins on a line."""
        if self.widths:
            begin = self.indent + sum(self.widths[:place])
            return begin + 1 + len(line[begin:]) - len(line[begin:].lstrip())
        if self.separator == BLANKS:
            return [match.start() + 1 for match in re.finditer(r"\S+", line)][place]
        starts = [0]
        is_quoted = False
        for offset, sign in enumerate(line):
            is_quoted ^= sign == '"'
            if sign == self.separator and not is_quoted:
                starts.append(offset + 1)
        begin = starts[min(place, len(starts) - 1)]
        return begin + 1 + len(line[begin:]) - len(line[begin:].lstrip())

    @cached_property
    def _pattern(self) -> re.Pattern[str]:
        digits = r"\d+"
        if self.thousands:
            digits = rf"(?:[1-9]\d{{0,2}}(?:{re.escape(self.thousands)}\d{{3}})+|\d+)"
        decimal = re.escape(self.decimal)
        return re.compile(rf"[-+]?(?:{digits}(?:{decimal}\d*)?|{decimal}\d+){_EXPONENT}\Z", re.ASCII)

    def parse(self, cell: str) -> float | None:
        """Return the finite number of a cell, 1.0D-03 too; None where it is none.  Zero has no sign."""
        if (
            len(cell) > MAX_NUMBER_LENGTH
            or not self._pattern.match(cell)
            or (self.has_points and self.decimal not in cell)
        ):
            return None
        plain = cell.replace(self.thousands, "") if self.thousands else cell
        value = float(plain.replace(self.decimal, ".").replace("D", "E").replace("d", "e")) + 0.0
        return value if math.isfinite(value) else None

    def is_row_of_numbers(self, line: str) -> bool:
        """Return whether a line holds numbers in this grammar, and nothing else."""
        cells = self.split(line)
        return bool(cells) and all(self.parse(cell) is not None for cell in cells)

    def read_numbers(self, text: TextFile, rows: Sequence[Row]) -> np.ndarray:
        """Return the numbers of all cells, row by row, shape (n,).

        Raises
        ------
        InputError : a cell is no number, at its line and column
        """
        cells = [cell for row in rows for cell in row.cells]
        is_simple = not self.thousands and not self.has_points
        if is_simple and not re.search(rf"[^\d{self.decimal}EeDd+\-\n]", "\n".join(cells), re.ASCII):
            plain = [cell.replace(self.decimal, ".").replace("D", "E").replace("d", "e") for cell in cells]
            try:
                values = np.array(plain, dtype=float) + 0.0  # zero has no sign
            except ValueError:
                values = np.array([math.nan])  # found out below
            if np.isfinite(values).all():
                return values
        numbers = []
        has_decimals = False
        for row in rows:
            for place, cell in enumerate(row.cells):
                value = self.parse(cell)
                if value is None:
                    is_other = has_decimals and self._needs_other_sign(cell)
                    refuse = self._refuse_other_sign if is_other else self.refuse_cell
                    raise refuse(text, row, place)
                has_decimals = has_decimals or self.decimal in cell
                numbers.append(value)
        return np.array(numbers)

    def _needs_other_sign(self, cell: str) -> bool:
        """Return whether a cell is a number with the other decimal sign, and with nothing else."""
        return self.describe_fault(cell).cure.keys() == {"decimal"}

    def _has_decimals(self, cell: str) -> bool:
        """Return whether a cell is a number with the decimal sign."""
        return self.decimal in cell and self.parse(cell) is not None

    def _refuse_other_sign(self, text: TextFile, row: Row, place: int) -> InputError:
        """Return the refusal of a cell whose decimal sign is not that of other cells."""
        message = f"'{row.cells[place][:40]}' has another decimal sign than other cells"
        column = self.find_column(text.lines[row.line - 1], place)
        return text.refuse(message, "a file has one decimal sign: export its columns alike", row.line, column)

    def refuse_cell(self, text: TextFile, row: Row, place: int) -> InputError:
        """Return the refusal of a cell that is no number; place : of it in its row, from 0."""
        line = text.lines[row.line - 1]
        fault = self.describe_fault(row.cells[place])
        if self._needs_other_sign(row.cells[place]) and any(map(self._has_decimals, row.cells)):
            return self._refuse_other_sign(text, row, place)
        column = self.find_column(line, place)
        if touches(row.cells[place]) and (form := guess_fortran(line)):
            hint = f"write `format: {form}` for the columns in which they are printed"
            return text.refuse_curable(fault.message, hint, {"format": form}, row.line, column)
        if fault.cure:
            return text.refuse_curable(fault.message, fault.hint, fault.cure, row.line, column)
        return text.refuse(fault.message, fault.hint, row.line, column)

    def describe_fault(self, cell: str) -> Fault:
        """Return what is wrong with a cell that is no number."""
        shown = f"'{cell[:40]}' is not a number"
        if len(cell) > MAX_NUMBER_LENGTH and not touches(cell):
            return Fault(f"a cell of {len(cell)} characters is not a number", "write plain numbers, one a cell")
        if not cell:
            return Fault("a cell is empty", "write the number that belongs there; a record is cut before a gap")
        if len(cell) > 1 and set(cell) == {"*"}:
            return Fault(f"'{cell[:40]}' is a number too wide for its field", "its value is lost: get the file again")
        if cell.lower().lstrip("+-") in ("nan", "inf", "infinity", "na", "n/a", "null", ""):
            hint = "write the number that belongs there; a record is cut before a gap"
            return Fault(f"'{cell[:40]}' is not a finite number", hint)
        if touches(cell):
            hint = "declare the columns that they are printed in, `format: 8F9.6`"
            return Fault(f"in '{cell[:40]}' numbers touch", hint)
        if self.has_points and cell.isdigit():
            hint = "write `format: 8I9` and a unit such as `1e-6 g` where the decimal point is left out"
            return Fault(f"'{cell[:40]}' has no decimal point", hint)
        if cures := self._find_cures(cell):
            ways = [f"`{_write_keys(cure)}` if it is {value:.10g}" for value, cure in cures.items()]
            return Fault(shown, f"write {', or '.join(ways)}", next(iter(cures.values())))
        if _WITH_UNIT.match(cell):
            hint = "write numbers alone, and their unit beside `file:`"
            return Fault(f"'{cell[:40]}' has a unit in its cell", hint)
        return Fault(shown, "write plain numbers, one a cell")

    def _find_cures(self, cell: str) -> dict[float, Mapping[str, Any]]:
        """Return the signs that make a number of a cell, by the number; those of thousands come first."""
        found: dict[float, Mapping[str, Any]] = {}
        thousands = _WITH_THOUSANDS.match(cell)
        other = "," if self.decimal == "." else "."
        signs: list[Mapping[str, Any]] = [{"decimal": other}]
        if thousands is not None and not self.thousands:
            sign = thousands["sign"]
            signs = [{"thousands": sign}, {"decimal": other, "thousands": sign}, *signs]
        for each in signs:
            if each.get("decimal", self.decimal) == each.get("thousands"):
                continue
            value = replace(self, **each).parse(cell)
            if value is not None:  # a cell that holds its separator stands in quotes
                quoted = {"separator": self.separator} if self.separator in each.values() else {}
                found.setdefault(value, {**each, **quoted})
        return found


def touches(cell: str) -> bool:
    """Return whether a cell is several numbers without a blank between them, as in full columns of a Fortran format."""
    if len(cell) > 10 * MAX_NUMBER_LENGTH:
        return False
    has_points = cell.count(".") > 1 and not set(cell) - set("0123456789.+-") and not _WITH_THOUSANDS.match(cell)
    return has_points or _TOUCHING.match(cell) is not None


def _write_keys(signs: Mapping[str, str]) -> str:
    """Return keys of a declaration with their signs in quotes."""
    return ", ".join(f'{key}: "{sign}"' for key, sign in signs.items())


def choose_separator(line: str, decimal: str = ".") -> str:
    """Return what parts the cells of a line where nothing is declared: the first of `SEPARATORS` that stands on it."""
    return next(sign for sign in SEPARATORS if sign == BLANKS or (sign in line and sign != decimal))


def hint_options(fault: Fault) -> str:
    """Return what settles a fault by options of a command, `--decimal ','`; "" where no sign does."""
    return re.sub(r'(\w+): "(.)",?', r"--\1 '\2'", fault.hint).replace("write", "give", 1) if fault.cure else ""


def choose_table_separator(lines: Sequence[str]) -> str:
    """Return what parts the cells of a table of words and numbers: the one of `SEPARATORS` on the most lines."""
    return max(SEPARATORS[:-1], key=lambda sign: sum(sign in line for line in lines))


def parse_fortran(written: str, decimal: str = ".") -> Grammar:
    """Return the grammar of a Fortran format of a line, such as `8F9.6`, `(8F10.5)`, `5E15.7`, `10I8` or `10X,8F9.6`.

    Raises
    ------
    ValueError : it is none
    """
    match = _FORTRAN.match(written.strip())
    count = int(match[2] or 1) if match else 0
    if match is None or count == 0:
        raise ValueError(written)
    return Grammar(BLANKS, decimal, "", (int(match[3]),) * count, int(match[4] or 0) > 0, int(match[1] or 0))


def guess_fortran(line: str) -> str:
    """Return the Fortran format, 8F9.6, of a line of numbers with even decimal points; "" for none."""
    points = [offset for offset, sign in enumerate(line) if sign == "."]
    distances = {second - first for first, second in pairwise(points)}
    if len(distances) != 1:
        return ""
    width = distances.pop()
    decimals = re.match(r"\d+(?:[EeDd][-+]?\d+)?", line[points[0] + 1 :])
    if decimals is None or points[0] + 1 + len(decimals[0]) > width:
        return ""
    return f"{len(points)}F{width}.{len(decimals[0])}"


def load_text(path: Path, what: str) -> TextFile:
    """Return a file as lines.

    what : it is, for messages: "motion file"

    Raises
    ------
    InputError : a file that is missing, empty, too large or not text
    """
    raw = read_bytes(path, MAX_FILE_BYTES, what)
    encoding = ""
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        encoding = "UTF-16"
        raw = raw.decode("utf-16", "replace").encode()
    raw = raw.rstrip(b"\x1a")  # the end of a file of DOS
    if len(raw.translate(None, _CONTROL)) < len(raw):
        kind = next((name for sign, name in _BINARY if raw.startswith(sign)), "")
        hint = f"export it as text, in UTF-8; give a {what} that holds numbers in lines"
        raise InputError(Issue((), f"not a text file{f', but {kind}' if kind else ''}", hint, file=shorten_path(path)))
    try:
        decoded = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        encoding = "Latin-1"  # names of places in old files; every number is ASCII
        decoded = raw.decode("latin-1")
    lines = re.split(r"\r*\n|\r", decoded.translate(_PLAIN_SIGNS))
    while lines and not lines[-1].strip():
        lines.pop()
    text = TextFile(path, lines, encoding)
    if not lines:
        raise text.refuse("the file is empty", f"give a {what} that holds numbers")
    for number, line in enumerate(lines, 1):
        if len(line) > MAX_LINE_LENGTH:
            raise text.refuse(f"a line of {len(line)} characters", f"a line has at most {MAX_LINE_LENGTH}", number)
    return text
