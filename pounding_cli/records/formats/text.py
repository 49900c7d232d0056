"""A motion file as text: its lines, its header, how it is refused, and the numbers on its lines."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted
from pounding_cli.reading import read_bytes

_TOUCHING = re.compile(r"(?<=[\d.])(?=[-+])")
_HEADER = re.compile(r"([A-Za-z0-9 ]+)[:=](.*)\Z")
_NUMERIC = re.compile(r"[0-9eEdD+\-.,;\s*]*\Z")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?\Z")
_PLAIN = re.compile(r"[-+.0-9Ee \t]+")
_NOT_FINITE = re.compile(r"[-+]?(?:nan|inf(?:inity)?|\*+)\Z", re.IGNORECASE)
_FORTRAN = re.compile(r"\(\s*(\d*)\s*[IFEDG]\s*(\d+)", re.IGNORECASE)
_CONTROL = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a"))
MOST_BYTES = 20_000_000
"""Size of a motion file [bytes]."""
LONGEST_LINE = 5000
"""Characters of a line that holds words: header lines are searched for what they say."""
SHORTEST, LONGEST = 1e-6, 10.0
"""Time steps [s] outside are no ground motion's."""


@dataclass(frozen=True)
class Asked:
    """What the user says of a file: time step [s], channel and column (from 1)."""

    dt: float | None = None
    channel: int | None = None
    column: int | None = None


@dataclass(frozen=True)
class Samples:
    """What a format finds in a file.

    dt : time step [s]; values : the samples, in `unit`; line : where they begin (from 1)
    unit : as the file or its format states it, None where neither does; unit_line : the line that does, or 0
    heading : what stands over the values, or speaks of their unit, where no unit can be read from it, else ""
    """

    dt: float
    values: list[float]
    line: int
    unit: str | None = None
    unit_line: int = 0
    heading: str = ""


@dataclass
class Text:
    """The file as lines, and its `# key: value` header."""

    path: Path
    lines: list[str]
    header: dict[str, str] = field(default_factory=dict)

    def refuse(self, message: str, hint: str, line: int = 0, column: int = 1) -> InputError:
        """The error that says so at a place of this file."""
        line = min(line, len(self.lines))
        return InputError(Problem(message, hint, str(self.path), line, column if line else 0))

    def first(self) -> int:
        """Index of the first line that is not blank."""
        return next(index for index, line in enumerate(self.lines) if line.strip())

    def step(self, written: str | float, line: int) -> float:
        """A time step [s] as written; refused where it is none."""
        try:
            step = float(written)
        except ValueError:
            step = math.nan
        if not SHORTEST <= step <= LONGEST:
            hint = f"give a time step from {SHORTEST:g} to {LONGEST:g} s, e.g. 0.01"
            raise self.refuse(f"the time step is {written}", hint, line)
        return step

    def same_step(self, given: float | None, found: float, line: int) -> float:
        """The time step found, refused where another was given."""
        if given is not None and not abs(given - found) <= 1e-3 * found:
            raise self.refuse(
                f"dt is given as {given:g} s, but the file says {found:g} s", "leave dt out, or correct it", line
            )
        return found

    def count(self, written: str, found: int, line: int, what: str = "NPTS") -> None:
        """Refuse a file whose header says another number of values than follow."""
        if int(written) != found:
            raise self.refuse(
                f"the header says {what} = {int(written)}, but {counted(found, 'value follows', 'values follow')}",
                "the file is cut short or damaged: download it again, or correct the header",
                line,
            )

    def wrong_quantity(self, quantity: str, line: int) -> InputError:
        """The refusal of a velocity, a displacement, a spectrum."""
        return self.refuse(
            f"the file holds {quantity}, not acceleration",
            "give the acceleration record (.AT2, .acc, HNx)",
            line,
        )

    def channel(self, asked: Asked, labels: list[str], line: int) -> int:
        """Index of the channel asked for; refused where there are several and none was named."""
        listed = "; ".join(f"{place}: {label}" for place, label in enumerate(labels, 1))
        if asked.channel is None:
            if len(labels) == 1:
                return 0
            raise self.refuse(
                f"the file holds {len(labels)} channels of acceleration: {listed}",
                "select one: channel: 1 beside the file in a study, or --channel 1",
                line,
            )
        if not 1 <= asked.channel <= len(labels):
            raise self.refuse(f"there is no channel {asked.channel} in the file", f"write one of {listed}", line)
        return asked.channel - 1

    def row(self, index: int) -> list[float]:
        """The numbers on one line, wherever they stand; nan, inf and all else is refused at its column."""
        line = self.lines[index]
        if _PLAIN.fullmatch(line) and (plain := _plain_numbers(line)) is not None:
            return plain
        values: list[float] = []
        for token in tokens(line):
            if number(token) is not None:
                values.append(number(token) or 0.0)
                continue
            # Fortran's fixed columns may touch: -.12E-01-.34E-01.
            parts = [] if _NOT_FINITE.match(token) else _touching(token)
            found = [number(part) for part in parts]
            if not found or any(value is None for value in found):
                raise self._no_number(token, index, line.find(token))
            values += [value for value in found if value is not None]
        return values

    def rows(self, start: int, end: int | None = None) -> list[tuple[int, list[float]]]:
        """Every line of numbers from `start` on, with its index; comments and blank lines are passed over."""
        found = []
        for index in range(start, len(self.lines) if end is None else end):
            line = self.lines[index].strip()
            if line and line[0] not in "#%!\x1a":
                found.append((index, self.row(index)))
        if not found:
            raise self.refuse("no numbers after the header", "give a file that holds a ground motion", start)
        return found

    def fixed(self, start: int, count: int, per_line: int, width: int) -> tuple[list[float], int]:
        """As `fixed_block`, and raises `InputError` where more numbers follow than `count`."""
        values, index = self.fixed_block(start, count, per_line, width)
        if index < len(self.lines) and numbers_only(self.lines[index]):
            raise self.refuse(
                f"more than the {count} values that the header says follow",
                "the file is damaged: download it again, or correct the header",
                index + 1,
            )
        return values, index

    def fixed_block(
        self, start: int, count: int, per_line: int, width: int, blank_as_zero: bool = False
    ) -> tuple[list[float], int]:
        """`count` numbers in Fortran's fixed columns from line `start` on, and the index of the line after them.

        Raises `InputError` where the lines end before.
        """
        values: list[float] = []
        index = start
        while len(values) < count:
            wanted = min(per_line, count - len(values))
            line = self.lines[index] if index < len(self.lines) else ""
            if not line.strip() and not (blank_as_zero and index < len(self.lines)):
                raise self.refuse(
                    f"the header says {counted(count, 'value')}, but {counted(len(values), 'follows', 'follow')}",
                    "the file is cut short or damaged: download it again, or correct the header",
                    min(start, len(self.lines)),
                )
            values += self._columns(index, wanted, width, blank_as_zero)
            index += 1
        return values, index

    def _columns(self, index: int, wanted: int, width: int, blank_as_zero: bool) -> list[float]:
        line = self.lines[index].rstrip()
        free = [number(token) for token in line.split()]
        if len(free) == wanted and all(value is not None for value in free):
            return [value for value in free if value is not None]
        values = []
        for place in range(wanted):
            token = line[place * width : (place + 1) * width].strip()
            value = 0.0 if blank_as_zero and not token else number(token)
            if value is None:
                if not token:
                    raise self.refuse(
                        f"{counted(place, 'value')} on this line, where {wanted} should stand",
                        "the file is cut short or damaged: download it again",
                        index + 1,
                    )
                raise self._no_number(token, index, place * width)
            values.append(value)
        return values

    def _no_number(self, token: str, index: int, place: int) -> InputError:
        shown = token if len(token) <= 40 else f"{token[:40]}..."
        if _NOT_FINITE.match(token) or _NUMBER.match(token):
            what, hint = "is not a finite number", "fill or cut the gap in the record before reading it"
        else:
            what, hint = "is not a number", "write plain numbers only"
        return self.refuse(f"'{shown}' {what}", hint, index + 1, max(place, 0) + 1)


def number(token: str) -> float | None:
    """A finite number as text files write it (1.0D-03 too), else None."""
    if not _NUMBER.match(token):
        return None
    value = float(token.replace("D", "E").replace("d", "e"))
    return value if math.isfinite(value) else None


def _plain_numbers(line: str) -> list[float] | None:
    """The numbers of a line of `_PLAIN` characters, at once; None where one is none, or too large. There is no negative
    zero: a motion has the digest that it has in a file without that sign."""
    try:
        values = [float(word) or 0.0 for word in line.split()]
    except ValueError:
        return None
    return values if all(map(math.isfinite, values)) else None


def numbers_only(line: str) -> bool:
    """Whether a line holds numbers and nothing else."""
    found = line.split()
    return bool(found) and all(number(token) is not None for token in found)


def one_blank(line: str) -> str:
    """A line with one blank between its words: patterns with several optional blanks need time by their power."""
    return " ".join(line.split())


def tokens(line: str) -> list[str]:
    """The words of a line, however they are separated."""
    return line.replace(",", " ").replace(";", " ").split()


def fortran(written: str) -> tuple[int, int] | None:
    """Numbers a line and width of each, from a Fortran format such as (8F10.5)."""
    found = _FORTRAN.search(written)
    if not found or not 1 <= int(found[2]) <= 40 or not 1 <= int(found[1] or 1) <= 100:
        return None
    return int(found[1] or 1), int(found[2])


def load(path: Path) -> Text:
    """The file's lines and header.  Raises `InputError` for a file that is missing, empty or not text."""
    try:
        raw = read_bytes(path, MOST_BYTES, "motion file")
    except FileNotFoundError:
        raise InputError(Problem("no such file", "give the path of a motion", str(path))) from None
    except OSError as error:
        raise InputError(
            Problem(f"cannot be read: {error.strerror}", "give a file that can be read", str(path))
        ) from None
    except InputError:
        raise
    except ValueError:  # a NUL in the path
        raise InputError(Problem("no such file", "give the path of a motion", repr(str(path)))) from None
    if raw[:4] == b"PK\x03\x04":
        raise InputError(Problem("a zip archive, not a motion", "unpack it, and name the file inside", str(path)))
    if len(raw.translate(None, _CONTROL)) < len(raw):
        raise InputError(
            Problem("not a text file", "give a text file in one of the formats of docs/records.md", str(path))
        )
    try:
        written = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        written = raw.decode("latin-1")  # names of places in old files; every number is ASCII
    text = Text(path, re.split(r"\r\n|\r|\n", written))
    if not any(line.strip() for line in text.lines):
        raise text.refuse("the file is empty", "give a file that holds a ground motion")
    for number, line in enumerate(text.lines, 1):
        if len(line) > LONGEST_LINE and not _NUMERIC.match(line):
            raise text.refuse(f"a line of {len(line)} characters", "no header of a motion file is that long", number)
    for line in text.lines:
        words = line.strip()
        if words and words[0] not in "#%!":
            break
        found = _HEADER.match(words[1:].strip())
        if found:
            text.header[found[1].strip().lower()] = found[2].strip()
    return text


def _touching(token: str) -> list[str]:
    """A token cut before every sign that begins a number, not an exponent."""
    return _TOUCHING.split(token)
