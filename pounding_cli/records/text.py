"""A motion file as text: its lines and header, the numbers on them, and how it is refused."""

from __future__ import annotations

import codecs
import itertools
import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import pluralize
from pounding_cli.reading import read_bytes, shorten_path

MAX_FILE_BYTES = 20_000_000
"""Size of a motion file [bytes]."""
MAX_LINE_LENGTH = 5000
"""Characters of a line that holds words: header lines are searched for what they say."""
MIN_TIME_STEP, MAX_TIME_STEP = 1e-6, 10.0
"""Time steps [s] outside are no ground motion's."""

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?\Z", re.ASCII)
_TOUCHING = re.compile(r"(?<=[\d.])(?=[-+])")
_ONE = r"(?:\d+\.\d*|\.\d+)(?:[EeDd][-+]?\d+)?"
_TOUCHING_NUMBERS = re.compile(rf"[-+]?{_ONE}(?:[-+]{_ONE})+\Z", re.ASCII)
_QUOTED_COMMA = re.compile(r"\"\s*([-+]?\d+),(\d+(?:[Ee][-+]?\d+)?)\s*\"")
_NOT_PLAIN = re.compile(r"[^\dEe+\-.,;\s\"']", re.ASCII)
# A sign that a block of plain numbers does not have; touching numbers and all else that is none fail as they are read.
_COMMENT_LINES = re.compile(r"^[ \t]*[#%!].*$", re.MULTILINE)
_END = re.compile(
    r"[\W_]*(?:end|eof|eod|fin|fine|fim|ende|einde|kraj|koniec|конец|终了|結束|结束|終了|以上)(?![^\W_])(?:[\W_]+[^\W\d_]+){0,5}[\W_]*\Z"
    r"|\s*[\])}/]+\s*;?\s*\Z",
    re.IGNORECASE,
)
# END, EOF, *** End of data ***, ];
_HEADER = re.compile(r"[#%!\s]*([A-Za-z][A-Za-z ]{,30})[:=](.*)\Z")
_NUMERIC = re.compile(r"[0-9eEdD+\-.,;\s*]*\Z")
_CONTROL = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a"))
_BINARY = (
    (rb"PK\x03\x04", "a zip archive or an Excel workbook"), (rb"\x1f\x8b", "a gzip archive"),
    (rb"%PDF", "a PDF document"),
    (rb"\x89HDF", "an HDF5 file"), (rb"MATLAB 5\.0 MAT", "a MATLAB file"), (rb"\x93NUMPY", "a NumPy array"),
    (rb"\d{6}[DRQM][ \d]", "a miniSEED file"), (rb"(?s).{304}(?:[\x06\x07]\0\0\0|\0\0\0[\x06\x07])", "a SAC file"),
    (rb"\xd0\xcf\x11\xe0", "an Excel workbook"),
)  # fmt: skip
# How files that hold no text begin.
_OTHER_ALPHABETS = ("cp1251", "koi8_r", "cp866", "cp932", "gb18030", "iso8859_7", "cp1254")
_FOREIGN_ACCELERATION = re.compile("ускорен|加速度|ガル|επιτ[αά]χ|ivme", re.IGNORECASE)


class NumberRow(NamedTuple):
    """A line of numbers: its index in the file, its words and their values."""

    line_index: int
    words: list[str]
    values: list[float]


class MotionWarning(NamedTuple):
    """A warning about a motion that is read all the same, and what to do about it."""

    message: str
    hint: str


class Samples(NamedTuple):
    """The content of a file: time step [s], samples, and the line where they begin (from 1).

    unit, unit_line : as the file or its format states it, and the line that does
    unclear, unclear_line : what the file says of the unit in place of it: "'furlongs' names no unit", and where
    doubt : a warning about how the file was read; None for none
    """

    dt: float
    values: list[float]
    line: int
    unit: str | None = None
    unit_line: int = 0
    unclear: str = ""
    unclear_line: int = 0
    doubt: MotionWarning | None = None


@dataclass
class TextFile:
    """The file as lines, and its header: of every line `key: value` over the numbers its value and place (from 1).

    encoding : "UTF-16" where the file is that, else ""
    dt, channel, column, unit : what the user says of it: time step [s], channel and column (from 1), unit
    """

    path: Path
    lines: list[str]
    header: dict[str, tuple[str, int]] = field(default_factory=dict)
    encoding: str = ""
    dt: float | None = None
    channel: int | None = None
    column: int | None = None
    unit: str | None = None

    def refuse(self, message: str, hint: str, line: int = 0, column: int = 1) -> InputError:
        """The error that says so at a place of this file."""
        line = min(line, len(self.lines))
        return InputError(Problem(message, hint, shorten_path(self.path), line, column if line else 0))

    def refuse_damaged(self, message: str, line: int) -> InputError:
        """The refusal of a file of a network that is not as they write it."""
        return self.refuse(message, "the file is cut short or damaged: download it again, or correct its header", line)

    def refuse_quantity(self, quantity: str, line: int) -> InputError:
        """The refusal of a velocity, a displacement, a spectrum."""
        hint = "give the acceleration record (.AT2, .acc, HNx)"
        return self.refuse(f"the file holds {quantity}, not acceleration", hint, line)

    @property
    def first(self) -> int:
        """Index of the first line that is not blank."""
        return next(index for index, line in enumerate(self.lines) if line.strip())

    def line(self, index: int) -> str:
        """A line, empty behind the end of the file."""
        return self.lines[index] if index < len(self.lines) else ""

    def words(self, index: int) -> str:
        """A line with one blank between its words: patterns with several optional blanks need time by their power."""
        return " ".join(self.line(index).split())

    def search(self, pattern: str, lines: range) -> tuple[re.Match[str] | None, int]:
        """The first match of a pattern in the words of lines of these indices, and its line (from 1); None, 0."""
        matches = ((re.search(pattern, self.words(index), re.IGNORECASE), index + 1) for index in lines)
        return next(((match, line) for match, line in matches if match), (None, 0))

    def find(self, pattern: str, lines: range, what: str) -> tuple[re.Match[str], int]:
        """As `search`; what : the match, in words.  Raises `InputError` where there is none."""
        match, line = self.search(pattern, lines)
        if match is None:
            raise self.refuse_damaged(f"the header does not say {what}", min(lines) + 1)
        return match, line

    def step(self, written: str | float, line: int) -> float:
        """A time step [s] as written; refused where it is none, or the user gives another."""
        step = float(written) if isinstance(written, float) or parse_number(written) is not None else math.nan
        if not MIN_TIME_STEP <= step <= MAX_TIME_STEP:
            hint = f"give a time step from {MIN_TIME_STEP:g} to {MAX_TIME_STEP:g} s, e.g. 0.01"
            raise self.refuse(f"the time step is {written}", hint, line)
        if self.dt is not None and not abs(self.dt - step) <= 1e-3 * step:
            message = f"dt is given as {self.dt:g} s, but the file says {step:g} s"
            raise self.refuse(message, "leave dt out, or correct it", line)
        return step

    def check_count(self, written: str, found: int, line: int, what: str = "NPTS") -> None:
        """Refuse a file whose header says another number of values than follow."""
        if parse_number(written) != found:
            follow = pluralize(found, "value follows", "values follow")
            raise self.refuse_damaged(f"the header says {what} = {written}, but {follow}", line)

    def rows(self, start: int, end: int | None = None) -> dict[int, list[float]]:
        """The numbers of every line from index `start` on, to before `end`, by its index; comments and blank lines are
        passed over, and nan, inf and all else is refused at its column."""
        return {row.line_index: row.values for row in self.read_rows(start, end)}

    def read_rows(self, start: int, end: int | None = None) -> list[NumberRow]:
        """Return index, words and numbers of every line, as `rows`; words that end the file are passed over too."""
        if rows := self.read_plain_rows(start, end):
            return rows
        rows_read = list[NumberRow]()
        for index, line in enumerate(self.lines[start:end], start):
            if not line.strip() or line.lstrip()[0] in "#%!\x1a":
                continue
            if rows_read and end is None and self._is_end(index):
                break
            words = split_numbers(line)
            values = list[float]()
            for word in words:
                value = parse_number(word)
                if value is None:
                    raise self._refuse_word(word, words, index)
                values.append(value)
            rows_read.append(NumberRow(index, words, values))
        if not rows_read:
            raise self.refuse("no numbers after the header", "give a file that holds a ground motion", start)
        return rows_read

    def _refuse_word(self, word: str, words: list[str], index: int) -> InputError:
        """Return the refusal of a word among the numbers; words : all of its line, of this index."""
        if len(word) > 3 and word.isalpha() and not any(parse_number(each) is not None for each in words):
            message = f"'{' '.join(words)[:40]}' stands among the numbers"
            hint = "cut off what follows if it is another quantity or channel; begin the line with # if it is not"
            return self.refuse(message, hint, index + 1)
        column = self.lines[index].find(word) + 1
        hint = "write plain numbers; fill or cut gaps in the record"
        return self.refuse(f"'{word[:40]}' is not a finite number", hint, index + 1, column)

    def read_plain_rows(self, start: int, end: int | None = None) -> list[NumberRow] | None:
        """Return what `read_rows` does of lines with nothing but plain numbers, all at once; None of others."""
        block = "\n".join(self.lines[start:end])
        if _NOT_PLAIN.search(block):
            block = _COMMENT_LINES.sub("", block)
            if _NOT_PLAIN.search(block):
                return None
        split = [line.split() for line in _part_with_blanks(block).split("\n")]
        try:
            values = np.array([word for words in split for word in words], dtype=float) + 0.0  # zero has no sign
        except ValueError:
            return None
        if not np.isfinite(values).all():
            return None
        numbers = values.tolist()
        ends = list(itertools.accumulate(map(len, split)))
        return [
            NumberRow(start + place, words, numbers[last - len(words) : last])
            for place, (words, last) in enumerate(zip(split, ends, strict=True))
            if words
        ]

    def _is_end(self, index: int) -> bool:
        """Return whether a line has words that end a file, END OF DATA, and no number follows."""
        if not _END.match(self.lines[index]):
            return False
        return not any(sign.isdigit() for line in self.lines[index:] for sign in line)

    def values(self, start: int) -> tuple[list[float], int]:
        """All numbers from index `start` on, row by row, and the line (from 1) where they begin."""
        rows = self.rows(start)
        return [value for row in rows.values() for value in row], next(iter(rows)) + 1

    def read_fixed_width(self, start: int, count: int, form: str, last: bool = False) -> tuple[list[float], int]:
        """`count` numbers from index `start` on, and the index of the line after them: so many a line, in columns of so
        many characters, as a Fortran format such as (8F10.5) says; it is that of most files.

        Refused where the lines end before, or, with `last`, more numbers follow.
        """
        field_format = re.search(r"(?i)\(\s*(\d{0,2})\s*[IFEDG]\s*([1-9]\d?)", form)
        per_line, width = (int(field_format[1] or 1) or 1, int(field_format[2])) if field_format else (8, 10)
        values = list[float]()
        index = start
        while len(values) < count:
            expected_count = min(per_line, count - len(values))
            line = self.line(index).rstrip()
            cells = line.split()
            if len(cells) != expected_count or None in map(parse_number, cells):
                cells = [line[offset : offset + width].strip() for offset in range(0, expected_count * width, width)]
            row = [value for value in map(parse_number, cells) if value is not None]
            if len(row) < expected_count:
                message = f"{pluralize(len(row), 'number')} on this line, where {expected_count} should stand"
                raise self.refuse_damaged(f"{message}: the header says {pluralize(count, 'value')}", index + 1)
            values += row
            index += 1
        following = self.line(index).split()
        if last and following and None not in map(parse_number, following):
            raise self.refuse_damaged(f"more than the {count} values that the header says follow", index + 1)
        return values, index


def parse_number(token: str) -> float | None:
    """A finite number as text files write it (1.0D-03 too), else None; zero has no sign, as the digest shows it."""
    if not _NUMBER.match(token):
        return None
    value = float(token.replace("D", "E").replace("d", "e")) + 0.0
    return value if math.isfinite(value) else None


def split_words(line: str) -> list[str]:
    """The words of a line, however they are separated, without quotes."""
    return _part_with_blanks(line).split()


def _part_with_blanks(text: str) -> str:
    """Return a text with blanks for what parts or quotes its words."""
    return text.replace(",", " ").replace(";", " ").replace('"', " ").replace("'", " ")


def load_text(path: Path, what: str = "motion file") -> TextFile:
    """The file's lines and header.  Raises `InputError` for a file that is missing, empty or not text."""
    raw = read_bytes(path, MAX_FILE_BYTES, what)
    encoding = _find_utf16(raw)
    if encoding:
        raw = raw.decode(encoding, "replace").encode("utf-8")
    if len(raw.translate(None, _CONTROL)) < len(raw):
        kind = next((name for sign, name in _BINARY if re.match(sign, raw)), "")
        hint = "export the acceleration as text, in one of the formats of docs/records.md" if kind else ""
        hint = hint or "unpack an archive; give a text file in one of the formats of docs/records.md"
        if what != "motion file":
            hint = f"export the {what} as text, e.g. as CSV"
        raise InputError(Problem(f"not a text file{f', but {kind}' if kind else ''}", hint, shorten_path(path)))
    decoded = _decode(raw).replace("\u2212", "-")
    lines = re.split(r"\r\n|\r|\n", _QUOTED_COMMA.sub(r'"\1.\2"', decoded) if '"' in decoded else decoded)
    text = TextFile(path, lines)
    text.encoding = "UTF-16" if encoding else ""
    if not any(line.strip() for line in lines):
        raise text.refuse("the file is empty", f"give a {what} that holds numbers")
    top = True
    for place, line in enumerate(text.lines, 1):
        if len(line) > MAX_LINE_LENGTH and not _NUMERIC.match(line):
            raise text.refuse(f"a line of {len(line)} characters", "no header is that long", place)
        top = top and not is_numeric(line)
        if top and (key_match := _HEADER.match(line)):
            text.header[key_match[1].strip().lower()] = key_match[2].strip(), place
    return text


def is_numeric(line: str) -> bool:
    """Return whether a line holds numbers only: a heading that begins with digits is none."""
    if not line.lstrip()[:1] or line.lstrip()[0] not in _FIRST_OF_NUMBERS:
        return False
    if not _OTHER_SIGN.search(line):
        return any(sign.isdigit() for sign in line)
    words = split_words(line[:MAX_LINE_LENGTH])  # what is longer is found out with its values
    words = words[:-1] if len(line) > MAX_LINE_LENGTH else words
    return bool(words) and all(
        parse_number(word) is not None or word.lower() in _NO_NUMBERS or _TOUCHING_NUMBERS.match(word) for word in words
    )


_NO_NUMBERS = ("nan", "inf", "-inf", "+inf")
_OTHER_SIGN = re.compile(r"[^\d\s.,;+\-\"']", re.ASCII)
_FIRST_OF_NUMBERS = "0123456789+-.\"',;nNiI"


def split_numbers(line: str) -> list[str]:
    """The words of a line of numbers; Fortran's fixed columns may touch: -.12E-01-.34E-01. A date stays one word."""
    words = split_words(line)
    if not _TOUCHING.search(line):
        return words
    return [part for word in words for part in (_TOUCHING.split(word) if _TOUCHING_NUMBERS.match(word) else (word,))]


def _find_utf16(raw: bytes) -> str:
    """Return the codec of a file in UTF-16, with or without its mark; "" of any other."""
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) and not raw.startswith(codecs.BOM_UTF32_LE):
        return "utf-16"
    head = raw[: min(len(raw), 4000) // 2 * 2]
    for codec, zeros, letters in (("utf-16-le", head[1::2], head[::2]), ("utf-16-be", head[::2], head[1::2])):
        if len(zeros) > 2 and zeros.count(0) > 0.6 * len(zeros) and letters.count(0) == 0:
            return codec
    return ""


def _decode(raw: bytes) -> str:
    """Return the text of a file: UTF-8, or the alphabet in which an old file speaks of acceleration, or Latin-1."""
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        head = raw[:5000]
        for alphabet in _OTHER_ALPHABETS:
            if _FOREIGN_ACCELERATION.search(head.decode(alphabet, "ignore")):
                return raw.decode(alphabet, "replace")
        return raw.decode("latin-1")  # names of places in old files; every number is ASCII
