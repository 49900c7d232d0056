"""A file of an instrument's format: what its header says, its values, and what is declared beside it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from pounding_cli.cells import Grammar, Row, TextFile
from pounding_cli.errors import InputError
from pounding_cli.numbers import pluralize
from pounding_cli.records.declaration import Declaration
from pounding_cli.records.samples import MAX_TIME_STEP, MIN_TIME_STEP

_GRAMMAR = Grammar()
_FORMAT = re.compile(r"(?i)\(\s*(\d{0,2})\s*[IFEDG]\s*([1-9]\d?)")


@dataclass(frozen=True)
class InstrumentFile:
    """A text file whose header is searched, and what is declared beside it."""

    text: TextFile
    declared: Declaration

    @property
    def lines(self) -> list[str]:
        """The lines of the file."""
        return self.text.lines

    @property
    def first(self) -> int:
        """Index of the first line that is not blank."""
        return next(index for index, line in enumerate(self.lines) if line.strip())

    def refuse(self, message: str, hint: str, line: int = 0) -> InputError:
        """Return the refusal at a line of the file, from 1; 0: the whole file."""
        return self.text.refuse(message, hint, line)

    def refuse_damaged(self, message: str, line: int) -> InputError:
        """Return the refusal of a file that is not as its format says."""
        hint = "the file is cut short or damaged: download it again, or correct its header; "
        return self.refuse(message, f"{hint}`format: plain` reads its rows as you declare them", line)

    def refuse_quantity(self, quantity: str, line: int) -> InputError:
        """Return the refusal of a velocity, a displacement, a spectrum."""
        hint = "give the acceleration record (.AT2, .acc, HNx)"
        return self.refuse(f"the file holds {quantity}, not acceleration", hint, line)

    def line(self, index: int) -> str:
        """Return a line, empty behind the end of the file."""
        return self.lines[index] if index < len(self.lines) else ""

    def words(self, index: int) -> str:
        """Return a line with one blank between its words: patterns with several optional blanks need time by their
        power."""
        return " ".join(self.line(index)[:1000].split())

    def search(self, pattern: str, lines: range) -> tuple[re.Match[str] | None, int]:
        """Return the first match of a pattern in the words of lines of these indices, and its line, from 1; None, 0."""
        matches = ((re.search(pattern, self.words(index), re.IGNORECASE), index + 1) for index in lines)
        return next(((match, line) for match, line in matches if match), (None, 0))

    def find(self, pattern: str, lines: range, what: str) -> tuple[re.Match[str], int]:
        """Return what `search` does.

        what : the match, in words

        Raises
        ------
        InputError : there is none
        """
        match, line = self.search(pattern, lines)
        if match is None:
            raise self.refuse_damaged(f"the header does not say {what}", min(lines) + 1)
        return match, line

    def step(self, written: str | float, line: int) -> float:
        """Return a time step [s] as written.  Raises InputError: it is none, or another is declared."""
        step = written if isinstance(written, float) else _GRAMMAR.parse(written) or math.nan
        if not MIN_TIME_STEP <= step <= MAX_TIME_STEP:
            hint = f"give a time step from {MIN_TIME_STEP:g} to {MAX_TIME_STEP:g} s, e.g. 0.01"
            raise self.refuse(f"the time step is {written}", hint, line)
        given = self.declared.dt
        if given is not None and not abs(given - step) <= 1e-3 * step:
            message = f"dt is given as {given:g} s, but the file says {step:g} s"
            raise self.refuse(message, "leave dt out, or correct it", line)
        return step

    def check_count(self, written: str, found: int, line: int, what: str = "NPTS") -> None:
        """Refuse a file whose header says another number of values than follow."""
        if _GRAMMAR.parse(written) != found:
            follow = pluralize(found, "value follows", "values follow")
            raise self.refuse_damaged(f"the header says {what} = {written}, but {follow}", line)

    def rows(self, start: int) -> list[Row]:
        """Return the lines from index `start` on as rows, without blank ones.  Raises InputError: there are none."""
        numbered = enumerate(self.lines[start:], start + 1)
        rows = [Row(line, cells) for line, words in numbered if (cells := words.split())]
        if not rows:
            raise self.refuse("no numbers after the header", "give a file that holds a ground motion", start)
        return rows

    def values(self, start: int) -> tuple[np.ndarray, int]:
        """Return all numbers from index `start` on, row by row, and the line, from 1, where they begin."""
        rows = self.rows(start)
        return self.read_numbers(rows), rows[0].line

    def read_numbers(self, rows: list[Row]) -> np.ndarray:
        """Return the numbers of rows.  Raises InputError: a cell is none."""
        return _GRAMMAR.read_numbers(self.text, rows)

    def read_fixed_width(self, start: int, count: int, form: str, last: bool = False) -> tuple[list[float], int]:
        """Return `count` numbers from index `start` on, and the index of the line after them.

        So many stand on a line, in columns of so many characters, as a Fortran format such as (8F10.5) says; it is that
        of most files.

        last : refuse a file in which more numbers follow

        Raises
        ------
        InputError : the lines end before
        """
        field_format = _FORMAT.search(form)
        per_line, width = (int(field_format[1] or 1) or 1, int(field_format[2])) if field_format else (8, 10)
        values = list[float]()
        index = start
        while len(values) < count:
            expected_count = min(per_line, count - len(values))
            line = self.line(index).rstrip()
            cells = line.split()
            if len(cells) != expected_count or None in map(_GRAMMAR.parse, cells):
                cells = [line[offset : offset + width].strip() for offset in range(0, expected_count * width, width)]
            row = [value for value in map(_GRAMMAR.parse, cells) if value is not None]
            if len(row) < expected_count:
                message = f"{pluralize(len(row), 'number')} on this line, where {expected_count} should stand"
                raise self.refuse_damaged(f"{message}: the header says {pluralize(count, 'value')}", index + 1)
            values += row
            index += 1
        if last and is_numeric(self.line(index)):
            raise self.refuse_damaged(f"more than the {count} values that the header says follow", index + 1)
        return values, index


def is_numeric(line: str) -> bool:
    """Return whether a line holds numbers parted by blanks, and nothing else."""
    return _GRAMMAR.is_row_of_numbers(line)


def parse_number(word: str) -> float | None:
    """Return the finite number of a word; None where it is none."""
    return _GRAMMAR.parse(word)
