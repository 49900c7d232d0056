"""Plain columns: time and acceleration, one column of a table, values row by row, or several pairs on a line.

Blanks, tabs, commas or semicolons part them, with a comma as decimal sign where the file shows it.  Above them may stand
headings with units (`t [s]; a [cm/s2]`), lines that state time step, count and unit in words, and a line of numbers with
the count and the time step (`8 0.02`).  A file is read only where time step, column and unit are established: by what it
says, or by what the user says of it; else it is refused with what to say.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.numbers import counted
from pounding_cli.records.headings import Header, Heading, read_header
from pounding_cli.records.text import Samples, Text, is_numeric, number, tokens
from pounding_cli.records.units import ACCELERATION_WORD, BRACKETS, acceleration_unit, named_quantity, speaks_of_a_number

COLUMNS = ("two-column", "column", "table")
"""The plain formats, by what stands on a line: time and acceleration, values row by row, several columns."""

MIN_STEP, MAX_STEP = 1e-4, 0.5
"""Numbers [s] that may be a time step in a header of numbers."""
MAX_UNEVENNESS = 0.02
"""Part of a step by which a sample may stand off its even place: times are printed with few digits."""
MAX_HEADER_LINES = 400

_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[EeDd][-+]?\d+)?\Z")
_WHOLE = re.compile(r"\+?\d{1,9}\.?\Z")
_ROW_BY_ROW = "for values printed row by row say format: column and dt"
_GIVE_STEP = "give dt (--dt 0.01, or dt: 0.01 s beside the file in a study), or put '# dt: 0.01 s' on top"
GIVE_UNIT = (
    "write the right unit: `unit: m/s2` beside the file in a study, `--unit m/s2` on the command line, "
    "or `# unit: m/s2` on top of the file"
)
"""What to do about a file that does not state its unit."""


@dataclass(frozen=True)
class Row:
    """A line of numbers: its index in the file, its words and their values."""

    index: int
    words: list[str]
    values: list[float]


class NumberHeader(NamedTuple):
    """Lines of numbers over the samples: how many, the count and the time step [s] that they say (None: none)."""

    rows: int = 0
    count: int | None = None
    step: float | None = None
    line: int = 0


def read_columns(text: Text, format: str | None) -> tuple[str, Samples]:
    """Return the format of plain columns and their samples.

    Raises
    ------
    InputError : several columns and none selected, no time step, a unit that is not stated, uneven or falling times, a
        count other than the header's, lines of different lengths
    """
    text.lines = replace_decimal_commas(text)
    start, rows = _find_rows(text)
    numbers = _find_number_header(text, rows)
    body = rows[numbers.rows :]
    if not body:
        raise text.refuse("no numbers after the header", "give a file that holds a ground motion", start)
    width = len(body[0].values)
    _refuse_a_row_among_headings(text, start, width)
    above = [(index + 1, text.lines[index]) for index in range(max(0, start - MAX_HEADER_LINES), start)]
    above = [(line, words) for line, words in above if not is_numeric(words)]
    columns = _Columns(text, body, read_header(above, width), numbers, format)
    return columns.read()


class _Columns:
    """Rows of numbers and what the lines over them say, on their way to the samples of a motion."""

    def __init__(self, text: Text, rows: list[Row], header: Header, numbers: NumberHeader, format: str | None) -> None:
        self.text, self.rows, self.header, self.format = text, rows, header, format
        self.width = len(rows[0].values)
        self.start = rows[0].index
        self.counts = list(header.counts)
        if numbers.count is not None:
            self.counts.append((numbers.count, numbers.line))
        self.step_line = 0
        self.step = self._find_stated_step(numbers)

    def read(self) -> tuple[str, Samples]:
        if self.width == 1 and self.format != "table" or self.format == "column":
            self._check_width(1 if self.format is None else 0)
            return "column", self._read_row_by_row()
        if pairs := self._find_pairs():
            return "two-column", pairs
        if self.format == "two-column":
            self._check_width(2)
        if self.format is None and self.text.column is None and self._is_row_by_row():
            return "column", self._read_row_by_row()
        is_wrapped = all(len(row.values) == self.width for row in self.rows[:-1]) and len(self.rows[-1].values) < self.width
        if is_wrapped and len(self.rows) > 1 and self.format is None and self.text.column is None and not self.header.headings:
            raise self._refuse_to_choose(list(range(self.width)), [Heading()] * self.width)
        self._check_width(self.width)
        samples = self._read_table()
        is_pair = self.width == 2 and self.format is None and self.text.column is None
        return (self.format or ("two-column" if is_pair else "table")), samples

    # Values row by row

    def _is_row_by_row(self) -> bool:
        """Return whether a header counts the values, not the rows."""
        total = sum(len(row.values) for row in self.rows)
        return total != len(self.rows) and any(count == total for count, _ in self.counts) and not self._has_even_times()

    def _read_row_by_row(self) -> Samples:
        values = [value for row in self.rows for value in row.values]
        step = self._need_step("one column of values, and no time step" if self.width == 1 else "no time step")
        self._check_counts(len(values))
        heading = Heading()
        return self._samples(step, values, heading)

    # Several pairs of time and acceleration on a line

    def _find_pairs(self) -> Samples | None:
        """Return the samples of lines that hold several pairs of time and acceleration; None of other lines."""
        if self.width < 4 or self.width % 2 or self.format == "table":
            return None
        flat = np.array([value for row in self.rows for value in row.values])
        if flat.size % 2 or flat.size < 6 or any(len(row.values) > self.width or len(row.values) % 2 for row in self.rows):
            return None
        times, values = flat[::2], flat[1::2]
        if not (np.diff(times) > 0).all() or (np.diff(values) > 0).all():
            return None
        if self.text.column is not None:
            pairs = self.width // 2
            message = f"every line holds {pairs} pairs of time and acceleration, so that column {self.text.column} is a part of the samples"
            raise self.text.refuse(message, "leave 'column' out: the pairs are read one after the other", self.start + 1)
        self._check_counts(times.size)
        lines = [row.index for row in self.rows for _ in range(len(row.values) // 2)]
        words = [word for row in self.rows for word in row.words[::2]]
        step = self._find_even_step(times, lines, words, 1.0)
        return self._samples(step, list(values), Heading())

    # One column of several

    def _read_table(self) -> Samples:
        headings = self.header.headings or [Heading()] * self.width
        known = bool(self.header.headings)
        time = next((place for place, heading in enumerate(headings) if known and heading.is_time), None)
        numbering = [place for place, heading in enumerate(headings) if known and place != time and heading.is_sample_number]
        if time is None and not numbering and self._has_sample_numbers(0):
            numbering = [0]
        elif time is None and not numbering and self._is_time_by_its_values():
            time = 0
        place = self._find_column(headings, time, numbering)
        values = [row.values[place] for row in self.rows]
        self._check_counts(len(values))
        heading = headings[place]
        if heading.is_other_quantity:
            raise self.text.wrong_quantity(heading.quantity, heading.lines[-1])
        if time is None:
            said = headings[0].text or "1, 2, 3, ..."
            why = f"column 1 is a sample number ({said[:40]}), and no time step is stated" if numbering else "no column of times, and no time step"
            return self._samples(self._need_step(why, self.start + 1), values, heading)
        times = np.array([row.values[time] for row in self.rows])
        scale = 1e-3 if headings[time].is_in_milliseconds else 1.0
        words = [row.words[time] if len(row.words) == self.width else "0.0" for row in self.rows]
        step = self._find_even_step(times, [row.index for row in self.rows], words, scale)
        return self._samples(step, values, heading)

    def _find_column(self, headings: list[Heading], time: int | None, numbering: list[int]) -> int:
        """Return the place of the acceleration: the one selected, or the only one that it can be."""
        others = [place for place in range(self.width) if place != time and place not in numbering]
        asked = self.text.column
        if asked is not None:
            if not 1 <= asked <= self.width:
                raise self.text.refuse(f"there is no column {asked} among {self.width}", f"write 1 to {self.width}: column: 2", self.start + 1)
            if asked - 1 not in others:
                what = "the time" if asked - 1 == time else "a sample number"
                raise self.text.refuse(f"column {asked} is {what}", f"write the acceleration's column, e.g. {self._example(others)}", self.start + 1)
            return asked - 1
        named = [place for place in others if headings[place].quantity == "acceleration"]
        candidates = named or [place for place in others if not headings[place].is_other_quantity]
        if len(candidates) == 1 and self.format != "table":
            return candidates[0]
        if not candidates and others:
            heading = headings[others[0]]
            raise self.text.wrong_quantity(heading.quantity, heading.lines[-1])
        raise self._refuse_to_choose(candidates, headings)

    def _refuse_to_choose(self, candidates: list[int], headings: list[Heading]) -> InputError:
        """Return the refusal of several columns of which none is selected."""
        names = [f"{place + 1}: {headings[place].text[:30]}" for place in candidates if headings[place].text]
        listed = f" ({'; '.join(names)})" if names else ""
        what = f"{self.width} values on a line, and no column is selected{listed}"
        return self.text.refuse(what, f"select one: {self._example(candidates)}; {_ROW_BY_ROW}", self.start + 1)

    def _example(self, places: list[int]) -> str:
        column = places[0] + 1 if places else 2
        return f"column: {column} beside the file in a study, or --column {column}"

    def _has_sample_numbers(self, place: int) -> bool:
        """Return whether a column without a heading counts the samples: whole numbers, each one more than the last."""
        words = [row.words[place] if place < len(row.words) else "" for row in self.rows]
        values = np.array([row.values[place] for row in self.rows])
        return values.size > 1 and all(re.fullmatch(r"\d+(?:\.0*)?", word) for word in words) and (np.diff(values) == 1).all()

    def _is_time_by_its_values(self) -> bool:
        """Return whether the first column rises as times do; refused where it does so with steps of its own."""
        times = np.array([row.values[0] for row in self.rows])
        gaps = np.diff(times)
        if gaps.size == 0 or self._has_even_times():
            return True
        is_rising = np.count_nonzero(gaps > 0) >= 0.6 * gaps.size
        return bool(is_rising)

    def _has_even_times(self) -> bool:
        times = np.array([row.values[0] for row in self.rows])
        if times.size < 2 or not (np.diff(times) > 0).all():
            return False
        step = (times[-1] - times[0]) / (times.size - 1)
        return bool(np.abs(times - times[0] - step * np.arange(times.size)).max() <= 0.25 * step)

    def _check_width(self, width: int) -> None:
        """Refuse rows of different lengths; 0: any length."""
        odd = next((row for row in self.rows if width and len(row.values) != width), None)
        if odd is not None:
            message = f"{counted(len(odd.values), 'value')} on this line, where every other has {width}"
            raise self.text.refuse(message, f"write as many values on every line; {_ROW_BY_ROW}", odd.index + 1)

    # Time step and count

    def _find_stated_step(self, numbers: NumberHeader) -> float | None:
        """Return the time step [s] that the header or the user says; None where nobody does.

        Raises `InputError` where lines of the header differ, or the user says another one.
        """
        stated = [(step.seconds, step.line) for step in self.header.steps if step.seconds > 0]
        if numbers.step is not None:
            stated.append((numbers.step, numbers.line))
        given = self.text.dt
        if not stated:
            return None if given is None else self.text.step(float(given), 0)
        seconds, line = stated[0]
        if given is not None:
            seconds, line = next(((s, at) for s, at in stated if abs(s - given) <= 1e-3 * s), (seconds, line))
        else:
            other = next((each for each in stated if abs(each[0] - seconds) > 1e-3 * seconds), None)
            if other is not None:
                message = f"line {line} says a time step of {seconds:g} s, this line one of {other[0]:g} s"
                raise self.text.refuse(message, "give the right one: dt: 0.01 s beside the file, or --dt 0.01", other[1])
        self.step_line = line
        self.text.step(seconds, line)
        return seconds if given is None else float(given)

    def _need_step(self, why: str, line: int = 1) -> float:
        if self.step is not None:
            return self.step
        unreadable = next((step for step in self.header.steps if step.seconds <= 0), None)
        if unreadable is not None:
            raise self.text.refuse(f"no time step can be read from '{unreadable.quote}'", _GIVE_STEP, unreadable.line)
        raise self.text.refuse(why, _GIVE_STEP, line)

    def _find_even_step(self, written: np.ndarray, lines: list[int], words: list[str], scale: float) -> float:
        """Return the time step [s] of evenly rising times; refused where they are uneven or the header says another.

        written : the times as the file has them, one of which is `scale` [s]; lines : their indices in the file
        """
        if written.size < 2:
            raise self.text.refuse("only one sample found", "a motion needs at least two samples", lines[0] + 1)
        digits = (0.0 if re.search(r"[EeDd]", word) else 10.0 ** -len(word.partition(".")[2]) for word in words[:1000])
        digit, times, gaps = scale * min(digits), scale * written, scale * np.diff(written)
        step = float(f"{(times[-1] - times[0]) / gaps.size:.9g}")
        allowed = max(MAX_UNEVENNESS * step, min(1.02 * digit, 0.25 * step))
        steps = [step] if self.step is None else [self.step, step]  # the one stated is exact, where times are rounded
        even = [one for one in steps if np.abs(times - times[0] - one * np.arange(times.size)).max() <= allowed]
        if not even:
            usual = float(np.median(gaps))
            worst = int(np.argmax(np.abs(gaps - usual)))
            message = f"uneven times: a step of {gaps[worst]:.6g} s here, of {usual:.6g} s elsewhere"
            raise self.text.refuse(message, f"resample the record to even steps; {_ROW_BY_ROW}", lines[worst + 1] + 1)
        if self.step is not None and even[0] != self.step and abs(self.step - step) > 1e-3 * step:
            if self.text.dt is not None:
                raise self.text.refuse(f"dt is given as {self.step:g} s, but the file says {step:g} s", "leave dt out, or correct it", lines[0] + 1)
            message = f"line {self.step_line} says a time step of {self.step:g} s, but the times rise by {step:g} s"
            raise self.text.refuse(message, f"give the right one: dt: {step:g} s beside the file (--dt {step:g}), and correct that line", self.step_line)
        self.text.step(step, lines[0] + 1)
        return even[0]

    def _check_counts(self, found: int) -> None:
        for count, line in self.counts:
            if count != found:
                follow = counted(found, "value follows", "values follow")
                hint = "correct that line or take it out, or complete the file"
                raise self.text.refuse(f"the header says {counted(count, 'value')} (samples = {count}), but {follow}", hint, line)

    # The unit

    def _samples(self, step: float, values: list[float], heading: Heading) -> Samples:
        begin = self.start + 1
        stated = sorted([*heading.units, *self.header.unit_statements], key=lambda each: each[1])
        factors = {unit: acceleration_unit(unit) or 0.0 for unit, _ in stated}
        first = stated[0] if stated else ("", 0)
        other = next((each for each in stated if abs(factors[each[0]] / factors[first[0]] - 1.0) > 1e-4), None)
        if other is not None and self.text.unit is None:
            message = f"the file says {first[0]} in line {first[1]} ({self._quote(first[1])}), but {other[0]} in this line ({self._quote(other[1])})"
            raise self.text.refuse(message, f"say which unit the values are in: unit: {first[0]} beside the file, or --unit {first[0]}", other[1])
        if stated:
            given = acceleration_unit(self.text.unit or "")
            agreed = next((each for each in stated if given and abs(factors[each[0]] / given - 1.0) > 1e-4), first)
            return Samples(step, values, begin, *agreed)
        if heading.is_other_quantity:
            return Samples(step, values, begin, heading.text, heading.lines[-1])
        keyed = self.text.header.get("unit") or self.text.header.get("units")
        if keyed and keyed[0]:
            return Samples(step, values, begin, *keyed)
        unclear, line = self._find_unclear(heading)
        return Samples(step, values, begin, None, 0, unclear, line)

    def _find_unclear(self, heading: Heading) -> tuple[str, int]:
        """Return what the lines over the numbers say about the unit, where none can be read from it, and the line."""
        words = BRACKETS.findall(heading.text) or ([heading.text] if heading.text else [])
        plain = re.sub(rf"(?i){ACCELERATION_WORD}|\b(?:ground|base|input|ag?|xg|x|y|z|values?)\b|[\s\W_]", "", " ".join(words))
        if plain:
            return f"'{heading.text[:60]}' names no unit of acceleration that is known", heading.lines[-1]
        for line, text in self.header.words.items():
            other = named_quantity(text)
            if other in ("velocity", "displacement") and not speaks_of_a_number(text) and BRACKETS.search(text):
                raise self.text.wrong_quantity(other, line)
            if speaks_of_a_number(text):
                return f"'{text[:60]}' speaks of one number, not of the values", line
        for line, text in self.header.words.items():
            bracket = BRACKETS.search(text)
            if re.search(rf"(?i)(?<![a-z])units?(?![a-z])|{ACCELERATION_WORD}", text) and (bracket or re.search(r"(?i)units?\W", text)):
                return f"'{text[:60]}' names no unit of acceleration that is known", line
        return "", 0

    def _quote(self, line: int) -> str:
        return f"'{self.text.lines[line - 1].strip()[:60]}'"


# The rows


def _find_rows(text: Text) -> tuple[int, list[Row]]:
    """Return the index of the first line of numbers below all words, and the rows of numbers.

    A count and a time step that stand above words, as in a header, are rows too where they fit what follows.
    """
    first = _find_numbers(text.lines, 0)
    if first is None:
        hint = "docs/records.md has the formats: at2, cosmos, csmip, smc, knet, esm, geonet, asa, and plain columns"
        raise text.refuse("no line of numbers found", hint, 1)
    words = next((index for index in range(first, len(text.lines)) if _is_of_words(text.lines[index])), None)
    below = _find_numbers(text.lines, words) if words is not None else None
    if below is not None and below > first:
        header = _rows_of(text, first, words)
        if len(header) <= 2 and len(rows := header + _rows_of(text, below)) > 2:
            pair = _count_and_step(header[0]) or (int(header[0].values[0]) if _WHOLE.match(header[0].words[0]) else 0, 0.0)
            if pair[0] in _sizes(rows[len(header) :]):
                return below, rows
    return first, _rows_of(text, first)


def _rows_of(text: Text, start: int, end: int | None = None) -> list[Row]:
    part = text.rows(start, end)
    return [Row(index, tokens(text.lines[index]), values) for index, values in part.items()]


def _is_of_words(line: str) -> bool:
    return bool(line.strip()) and line.lstrip()[0] not in "#%!\x1a" and not is_numeric(line)


def _find_numbers(lines: list[str], start: int) -> int | None:
    """Return the index of the next line of numbers."""
    return next((at for at in range(start, len(lines)) if lines[at].lstrip()[:1] not in ("#", "%", "!") and is_numeric(lines[at])), None)


def _refuse_a_row_among_headings(text: Text, start: int, width: int) -> None:
    """Refuse a line right above the rows that would be one of them but for a word that is no number."""
    above = next((index for index in range(start - 1, -1, -1) if text.lines[index].strip()), None)
    if above is None or text.lines[above].lstrip()[:1] in tuple("#%!"):
        return
    words = tokens(text.lines[above])
    numbers = [word for word in words if number(word) is not None]
    begins = [word for word in words if re.match(r"[-+]?\d*\.\d", word) and number(word) is None]
    if len(words) == width and (len(numbers) == width - 1 > 0 or (width == 1 and begins)):
        odd = next(word for word in words if number(word) is None)
        hint = "write plain numbers; fill or cut gaps in the record"
        raise text.refuse(f"'{odd[:40]}' is not a finite number", hint, above + 1, text.lines[above].find(odd) + 1)


def _find_number_header(text: Text, rows: list[Row]) -> NumberHeader:
    """Return the header of numbers over the samples: a count, a time step, or both, in one line or in two.

    Raises `InputError` where the first line is unlike the others and says neither, or another count than follows.
    """
    if len(rows) < 3:
        return _find_header_of_one_row(text, rows)
    first, second, third = (len(row.values) for row in rows[:3])
    line = rows[0].index + 1
    if first == second == 1:
        return _find_header_in_a_column(text, rows, third)
    pair = _count_and_step(rows[0])
    body = rows[1:]
    sizes = _sizes(body)
    if pair is not None:
        count, step = pair
        falls = first == second and rows[0].values[0] > rows[1].values[0] and _rises(body)
        if first != second or count in sizes or falls:
            if count not in sizes:
                raise _refuse_count(text, rows[0], count, sizes[0] if second == 1 or falls else sizes[-1])
            return NumberHeader(1, count, step, line)
        return NumberHeader()
    is_last_row_short = all(len(row.values) == first for row in rows[:-1])
    if first == second or is_last_row_short:
        return NumberHeader()
    if first == 1 and _WHOLE.match(rows[0].words[0]):
        count = int(rows[0].values[0])
        if count in sizes:
            return NumberHeader(1, count, None, line)
        raise _refuse_count(text, rows[0], count, sizes[0])
    quote = " ".join(rows[0].words)[:60]
    if second == third or first > second:
        message = f"'{quote}' is a line of numbers unlike those below it: a header that says neither count nor time step"
        raise text.refuse(message, f"take the line out, and {_GIVE_STEP}", line)
    return NumberHeader()


def _find_header_of_one_row(text: Text, rows: list[Row]) -> NumberHeader:
    """Return the header of numbers of a file with one row or two."""
    if len(rows) == 2 and len(rows[0].values) == 2 != len(rows[1].values) and (pair := _count_and_step(rows[0])):
        if pair[0] != len(rows[1].values):
            raise _refuse_count(text, rows[0], pair[0], len(rows[1].values))
        return NumberHeader(1, *pair, rows[0].index + 1)
    return NumberHeader()


def _find_header_in_a_column(text: Text, rows: list[Row], third: int) -> NumberHeader:
    """Return the header of numbers in the first one or two lines of one number each."""
    line, one, two = rows[0].index + 1, rows[0], rows[1]
    for count, step in ((one, two), (two, one)):
        if _WHOLE.match(count.words[0]) and _is_step(step) and int(count.values[0]) in _sizes(rows[2:]):
            return NumberHeader(2, int(count.values[0]), step.values[0], line)
    is_whole = bool(_WHOLE.match(one.words[0])) and one.values[0] >= 2
    others = [row for row in rows[1:] if row.values]
    if is_whole and int(one.values[0]) == len(others) and third == 1:
        return NumberHeader(1, int(one.values[0]), None, line)
    if third != 1:
        quote = f"{one.words[0]}, {two.words[0]}"
        raise text.refuse(f"'{quote}' are lines of numbers unlike those below: a header", f"take them out, and {_GIVE_STEP}", line)
    fractions = [row for row in others if not _WHOLE.match(row.words[0].lstrip("-+"))]
    largest = max(abs(row.values[0]) for row in others)
    is_near = abs(one.values[0] - len(others)) <= 2
    if is_whole and len(fractions) > 0.5 * len(others) and (is_near or one.values[0] > 20 * largest):
        raise _refuse_count(text, one, int(one.values[0]), len(others))
    return NumberHeader()


def _refuse_count(text: Text, row: Row, count: int, found: int) -> Exception:
    quote = " ".join(row.words)[:60]
    message = f"'{quote}' over the values is a header that says {counted(count, 'value')}, but {counted(found, 'value follows', 'values follow')}"
    return text.refuse(message, "correct that line, or take it out and give dt: 0.01 s beside the file (--dt 0.01)", row.index + 1)


def _count_and_step(row: Row) -> tuple[int, float] | None:
    """Return the count and the time step [s] of a line such as `8 0.02`; None where it is none."""
    if len(row.values) != 2:
        return None
    for count, step in ((0, 1), (1, 0)):
        is_step = MIN_STEP <= row.values[step] <= MAX_STEP and not _WHOLE.match(row.words[step])
        if _WHOLE.match(row.words[count]) and is_step and row.values[count] >= 2:
            return int(row.values[count]), row.values[step]
    return None


def _is_step(row: Row) -> bool:
    return MIN_STEP <= row.values[0] <= MAX_STEP and not _WHOLE.match(row.words[0])


def _sizes(rows: list[Row]) -> list[int]:
    """Return what a count may speak of: the rows, the pairs in them, the values."""
    total = sum(len(row.values) for row in rows)
    return list(dict.fromkeys((len(rows), *((total // 2,) if total % 2 == 0 and len(rows[0].values) > 1 else ()), total)))


def _rises(rows: list[Row]) -> bool:
    times = [row.values[0] for row in rows]
    return len(times) > 1 and bool((np.diff(times) > 0).all())


def replace_decimal_commas(text: Text) -> list[str]:
    """Return the lines with decimal points where the file writes decimal commas, as its lines of numbers show.

    Raises `InputError` where commas both part the columns and are the decimal sign.
    """
    lines = [index for index, line in enumerate(text.lines) if re.match(r"\s*[\"']?[-+]?[\d.,][-+\d.,;eEdD\s\"']*\Z", line)]
    sample = [text.lines[index].replace('"', " ").replace("'", " ") for index in lines[:2000]]
    rows = [[word for word in re.split(r"[;\s]+", line.strip()) if word] for line in sample]
    words = [word for row in rows for word in row]
    if any("." in word or word.endswith(",") for word in words) or not any("," in word for word in words):
        return text.lines
    several = next((place for place, row in enumerate(rows) if any(word.count(",") > 1 for word in row)), None)
    if several is not None:
        if re.search(r"(?:^|,)[-+]?0\d", ",".join(rows[several])):
            hint = "write decimal points, or semicolons between the columns"
            raise text.refuse("commas both part the columns and are the decimal sign", hint, lines[several] + 1)
        return text.lines
    if not any(map(_DECIMAL_COMMA.match, words)):
        return text.lines
    if max(map(len, rows)) < 2 and not _is_one_column_with_commas(words):
        return text.lines
    chosen = set(lines)
    return [re.sub(r"(?<=\d),(?=\d)", ".", line) if index in chosen else line for index, line in enumerate(text.lines)]


def _is_one_column_with_commas(words: list[str]) -> bool:
    """Return whether words such as `12,500` are one number each, not two columns of whole numbers."""
    pairs = [word.split(",") for word in words]
    if any(len(pair) == 1 for pair in pairs):
        return True
    wholes = np.array([float(whole) for whole, _ in pairs])
    is_counting = wholes.size > 2 and np.ptp(np.diff(wholes)) == 0 and wholes[1] > wholes[0]
    return not is_counting and not any(re.match(r"[-+]", part) for _, part in pairs)
