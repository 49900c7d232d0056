"""Plain columns: time and acceleration, one column of a table, values row by row, or several pairs on a line.

Blanks, tabs, commas or semicolons part them, with a comma as decimal sign where the file shows it.  Above them may
stand headings with units (`t [s]; a [cm/s2]`), lines that state time step, count and unit in words, and a line of
numbers with the count and the time step (`8 0.02`).  A file is read only where time step, column and unit are
established, by what it says or by what the user says of it; else it is refused with what to say.
"""

from __future__ import annotations

import re

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.numbers import pluralize
from pounding_cli.records.headings import Header, Heading, find_spectrum_title, read_header
from pounding_cli.records.rows import (
    GIVE_STEP,
    MAX_HEADER_LINES,
    NumberHeader,
    find_number_header,
    find_number_header_in_comments,
    find_rows,
    refuse_a_row_among_headings,
    replace_decimal_commas,
)
from pounding_cli.records.text import MotionWarning, NumberRow, Samples, TextFile, is_numeric
from pounding_cli.records.units import (
    ACCELERATION_WORD,
    BRACKETS,
    find_acceleration_unit,
    find_quantity,
    identify_unit,
    is_about_one_number,
)

COLUMN_FORMATS = ("two-column", "column", "table")
"""The plain formats, by what stands on a line: time and acceleration, values row by row, several columns."""

MAX_UNEVENNESS = 0.02
"""Part of a step by which a sample may stand off its even place: times are printed with few digits."""

_ROW_BY_ROW = "for values printed row by row say format: column and dt"
GIVE_UNIT = (
    "write the right unit: `unit: m/s2` beside the file in a study, `--unit m/s2` on the command line, "
    "or `# unit: m/s2` on top of the file"
)
"""What to do about a file that does not state its unit."""


def read_columns(text: TextFile, format: str | None) -> tuple[str, Samples]:
    """Return the format of plain columns and their samples.

    Raises
    ------
    InputError : several columns and none selected, no time step, a unit that is not stated, uneven or falling times, a
        count other than the header's, lines of different lengths
    """
    text.lines = replace_decimal_commas(text)
    start, rows = find_rows(text)
    numbers = find_number_header(text, rows)
    body = rows[numbers.rows :]
    if numbers.rows == 0:
        numbers = find_number_header_in_comments(text, start, body)
    if not body:
        raise text.refuse("no numbers after the header", "give a file that holds a ground motion", start)
    width = len(body[0].values)
    refuse_a_row_among_headings(text, start, width)
    first_header_line = max(0, start - MAX_HEADER_LINES)
    header_lines = enumerate(text.lines[first_header_line:start], first_header_line + 1)
    header_words = [(line, words) for line, words in header_lines if not is_numeric(words)]
    columns = _Columns(text, body, read_header(header_words, width), numbers, format)
    return columns.read()


class _Columns:
    """Rows of numbers and what the lines over them say, on their way to the samples of a motion."""

    def __init__(
        self,
        text: TextFile,
        rows: list[NumberRow],
        header: Header,
        numbers: NumberHeader,
        format: str | None,
    ) -> None:
        self.text = text
        self.rows = rows
        self.header = header
        self.format = format
        self.width = len(rows[0].values)
        self.start = rows[0].line_index
        self.counts = list(header.counts)
        if numbers.size is not None:
            self.counts.append((numbers.size, numbers.line))
        self.step_line = 0
        self.contradicted: tuple[float, int] | None = None
        self.doubt: MotionWarning | None = None
        self.step = self._find_stated_step(numbers)

    def read(self) -> tuple[str, Samples]:
        """Return the format and the samples, as `read_columns`."""
        if (self.width == 1 and self.format != "table") or self.format == "column":
            self._check_width(1 if self.format is None else 0)
            self._refuse_times_as_values()
            return "column", self._read_row_by_row()
        if pairs := self._find_pairs():
            return "two-column", pairs
        if self.format == "two-column":
            self._check_width(2)
        is_undescribed = self.format is None and self.text.column is None
        if is_undescribed and self._is_row_by_row():
            return "column", self._read_row_by_row()
        if is_undescribed and self._is_wrapped() and not self.header.headings:
            raise self._refuse_to_choose(list(range(self.width)), [Heading()] * self.width)
        self._check_width(self.width)
        samples = self._read_table()
        detected_format = "two-column" if self.width == 2 and is_undescribed else "table"
        return self.format or detected_format, samples

    def _is_wrapped(self) -> bool:
        """Return whether only the last of several rows is shorter, as of values printed row by row."""
        if len(self.rows) < 2:
            return False
        is_even = all(len(row.values) == self.width for row in self.rows[:-1])
        return is_even and len(self.rows[-1].values) < self.width

    # Values row by row

    def _refuse_times_as_values(self) -> None:
        """Refuse to read columns of times, or pairs, as values row by row."""
        is_table = self.width > 1 and len(self.rows) > 3 and self._has_even_times()
        if is_table or self._pairs_of_lines() is not None:
            message = "the first numbers of the lines rise as times do: they are no accelerations printed row by row"
            hint = "leave 'format' out, or write format: table and a column"
            raise self.text.refuse(message, hint, self.start + 1)

    def _is_row_by_row(self) -> bool:
        """Return whether a header counts the values, not the rows."""
        total = sum(len(row.values) for row in self.rows)
        is_counted = total != len(self.rows) and any(count == total for count, _ in self.counts)
        return is_counted and (len(self.rows) < 3 or not self._has_even_times())

    def _read_row_by_row(self) -> Samples:
        """Return all values, row by row."""
        values = [value for row in self.rows for value in row.values]
        why = "one column of values, and no time step" if self.width == 1 else "no time step"
        step = self._need_step(why)
        self._check_counts(len(values))
        return self._build_samples(step, values, Heading())

    # Several pairs of time and acceleration on a line

    def _find_pairs(self) -> Samples | None:
        """Return the samples of lines that hold several pairs of time and acceleration; None of other lines."""
        flat = self._pairs_of_lines()
        if flat is None:
            return None
        times = flat[::2]
        values = flat[1::2]
        if self.text.column is not None:
            message = (
                f"every line holds {self.width // 2} pairs of time and acceleration, "
                f"so that column {self.text.column} is a part of the samples"
            )
            hint = "leave 'column' and 'format' out: the pairs are read one after the other"
            raise self.text.refuse(message, hint, self.start + 1)
        self._check_counts(times.size)
        lines = [row.line_index for row in self.rows for _ in range(len(row.values) // 2)]
        words = [word for row in self.rows for word in row.words[::2]]
        step = self._find_even_step(times, lines, words, 1.0)
        return self._build_samples(step, list(values), Heading())

    def _pairs_of_lines(self) -> np.ndarray | None:
        """Return time, acceleration, time, ... of lines that hold several pairs; None of other lines."""
        if self.width < 4 or self.width % 2:
            return None
        if any(len(row.values) > self.width or len(row.values) % 2 for row in self.rows):
            return None
        flat = np.array([value for row in self.rows for value in row.values])
        times_rise = (np.diff(flat[::2]) > 0).all()
        values_rise = (np.diff(flat[1::2]) > 0).all()
        return flat if flat.size >= 6 and times_rise and not values_rise else None

    # One column of several

    def _read_table(self) -> Samples:
        """Return the samples of one column, with the time step of the column of times if there is one."""
        headings = self.header.headings or [Heading()] * self.width
        spectral = next((heading for heading in headings if heading.is_of_a_spectrum), None)
        if spectral is not None:
            quantity = f"a spectrum ({spectral.text[:40]})"
            raise self.text.refuse_quantity(quantity, spectral.lines[-1])
        time, numbering = self._find_time_and_numbering()
        place = self._find_column(headings, time, numbering)
        values = [row.values[place] for row in self.rows]
        self._check_counts(len(values))
        heading = _find_heading_of_unit(headings, place)
        if heading.is_other_quantity:
            raise self.text.refuse_quantity(heading.quantity, heading.lines[-1])
        if time is None:
            why = "no column of times, and no time step"
            if numbering:
                column = numbering[0]
                first_numbers = ", ".join(row.words[column] for row in self.rows[:3]) + ", ..."
                quote = (headings[column].text or first_numbers)[:40]
                why = f"column {column + 1} is a sample number ({quote}), and no time step is stated"
            return self._build_samples(self._need_step(why, self.start + 1), values, heading)
        times = np.array([row.values[time] for row in self.rows])
        title = find_spectrum_title(self.header)
        is_named_time = bool(self.header.headings) and headings[time].is_time
        if title is not None and not is_named_time and self.step is None:
            raise self.text.refuse_quantity(f"a spectrum ({title[0][:40]})", title[1])
        lines = [row.line_index for row in self.rows]
        words = [row.words[time] if len(row.words) == self.width else "0.0" for row in self.rows]
        step = self._find_even_step(times, lines, words, headings[time].time_unit)
        return self._build_samples(step, values, heading)

    def _find_time_and_numbering(self) -> tuple[int | None, list[int]]:
        """Return the place of the column of times, None without one, and those of columns of sample numbers.

        Headings say so; without any, the values of the first column do.
        """
        headings = self.header.headings
        time = next((place for place, heading in enumerate(headings) if heading.is_time), None)
        numbering = [place for place, heading in enumerate(headings) if place != time and heading.is_sample_number]
        if time is None and not numbering:
            if self._has_sample_numbers(0):
                return None, [0]
            if self._is_time_by_its_values():
                return 0, []
        return time, numbering

    def _find_column(self, headings: list[Heading], time: int | None, numbering: list[int]) -> int:
        """Return the place of the acceleration: the one selected, or the only one that it can be."""
        others = [place for place in range(self.width) if place != time and place not in numbering]
        selected = self.text.column
        if selected is not None:
            if not 1 <= selected <= self.width:
                message = f"there is no column {selected} among {self.width}"
                hint = f"write 1 to {self.width}: column: 2"
                raise self.text.refuse(message, hint, self.start + 1)
            if selected - 1 not in others:
                content = "the time" if selected - 1 == time else "a sample number"
                hint = f"write the acceleration's column, e.g. {self._example(others)}"
                raise self.text.refuse(f"column {selected} is {content}", hint, self.start + 1)
            return selected - 1
        if not self.header.headings and len(others) > 1:
            raise self._refuse_to_choose(others, headings)
        possible = [place for place in others if not headings[place].is_other_quantity]
        candidates = possible
        if any(headings[place].quantity == "acceleration" for place in possible):
            candidates = [
                place
                for place in possible
                if headings[place].quantity == "acceleration" or headings[place].is_component
            ]
        if len(candidates) == 1 and self.format != "table":
            return candidates[0]
        if not candidates and others:
            heading = headings[others[0]]
            raise self.text.refuse_quantity(heading.quantity, heading.lines[-1])
        raise self._refuse_to_choose(candidates, headings)

    def _refuse_to_choose(self, candidates: list[int], headings: list[Heading]) -> InputError:
        """Return the refusal of several columns of which none is selected."""
        texts = {place + 1: headings[place].text[:30] for place in candidates}
        names = "; ".join(f"{column}: {text}" for column, text in texts.items() if text)
        columns = f" ({names})" if names else ""
        message = f"{self.width} values on a line, and no column is selected{columns}"
        hint = f"select one: {self._example(candidates)}; {_ROW_BY_ROW}"
        return self.text.refuse(message, hint, self.start + 1)

    def _example(self, places: list[int]) -> str:
        """Return how to select the first of these columns."""
        column = places[0] + 1 if places else 2
        return f"column: {column} beside the file in a study, or --column {column}"

    def _has_sample_numbers(self, place: int) -> bool:
        """Return whether a column without a heading counts the samples: whole numbers that rise evenly."""
        words = [row.words[place] for row in self.rows]
        gaps = np.diff([row.values[place] for row in self.rows])
        if not gaps.size or not all(re.fullmatch(r"\d+(?:\.0*)?", word) for word in words):
            return False
        return bool(gaps[0] >= 1 and (gaps == gaps[0]).all())

    def _is_time_by_its_values(self) -> bool:
        """Return whether the first column rises as times do, evenly or at most of its lines."""
        times = np.array([row.values[0] for row in self.rows])
        gaps = np.diff(times)
        if gaps.size == 0 or self._has_even_times():
            return True
        return bool(np.count_nonzero(gaps > 0) >= 0.6 * gaps.size)

    def _has_even_times(self) -> bool:
        """Return whether the first column rises in about even steps."""
        times = np.array([row.values[0] for row in self.rows])
        if times.size < 2 or not (np.diff(times) > 0).all():
            return False
        step = (times[-1] - times[0]) / (times.size - 1)
        return bool(np.abs(times - times[0] - step * np.arange(times.size)).max() <= 0.25 * step)

    def _check_width(self, width: int) -> None:
        """Refuse rows of different lengths; 0: any length."""
        odd = next((row for row in self.rows if width and len(row.values) != width), None)
        if odd is not None:
            count = pluralize(len(odd.values), "value")
            message = f"{count} on this line, where every other has {width}"
            hint = f"write as many values on every line; {_ROW_BY_ROW}"
            raise self.text.refuse(message, hint, odd.line_index + 1)

    # Time step and count

    def _find_stated_step(self, numbers: NumberHeader) -> float | None:
        """Return the time step [s] that the user or the header states; None where neither does.

        Where the user states another than the header, `contradicted` has the header's, for times to settle.

        Raises
        ------
        InputError : lines of the header differ, and the user states no time step
        """
        stated = [(step.seconds, step.line) for step in self.header.steps if step.seconds > 0]
        if numbers.step is not None:
            stated.append((numbers.step, numbers.line))
        users_step = self.text.dt
        if users_step is not None:
            if not any(abs(seconds - users_step) <= 1e-3 * seconds for seconds, _ in stated):
                self.contradicted = next(iter(stated), None)
            return self.text.step(float(users_step), 0)
        if not stated:
            return None
        seconds, line = stated[0]
        other = next((each for each in stated if abs(each[0] - seconds) > 1e-3 * seconds), None)
        if other is not None:
            other_seconds, other_line = other
            message = f"line {line} says a time step of {seconds:g} s, this line one of {other_seconds:g} s"
            hint = "give the right one: dt: 0.01 s beside the file, or --dt 0.01"
            raise self.text.refuse(message, hint, other_line)
        self.step_line = line
        return self.text.step(seconds, line)

    def _need_step(self, why: str, line: int = 1) -> float:
        """Return the time step [s] that is stated.

        Raises
        ------
        InputError : there is none (with `why` and the line), or the user's is another than the header's
        """
        if self.contradicted is not None:
            self.text.step(*self.contradicted)  # raises: the user says another one
        if self.step is not None:
            return self.step
        unreadable = next((step for step in self.header.steps if step.seconds <= 0), None)
        if unreadable is not None:
            message = f"no time step can be read from '{unreadable.quote}'"
            raise self.text.refuse(message, GIVE_STEP, unreadable.line)
        raise self.text.refuse(why, GIVE_STEP, line)

    def _find_even_step(
        self,
        written: np.ndarray,
        lines: list[int],
        words: list[str],
        scale: float,
    ) -> float:
        """Return the time step [s] of times: the one stated where they are its times, rounded; else their own.

        Where the header says another than the times have, the times count, with a warning.

        Parameters
        ----------
        written : the times as the file has them, one of which is `scale` [s]
        lines, words : their lines (indices in the file) and what is written there

        Raises
        ------
        InputError : fewer than two times, uneven times, another step than the user's
        """
        if written.size < 2:
            raise self.text.refuse("only one sample found", "a motion needs at least two samples", lines[0] + 1)
        last_digits = (
            0.0 if re.search(r"[EeDd]", word) else 10.0 ** -len(word.partition(".")[2]) for word in words[:1000]
        )
        rounding = 1.02 * scale * min(last_digits)
        times = scale * written
        gaps = np.diff(times)
        if self.step is not None and (gaps >= 0).all():
            allowed = max(MAX_UNEVENNESS * self.step, rounding)
            if _find_largest_deviation(times, self.step) <= allowed:
                return self.step
        step = float(f"{(times[-1] - times[0]) / gaps.size:.9g}")
        allowed = max(MAX_UNEVENNESS * step, min(rounding, 0.25 * step))
        if _find_largest_deviation(times, step) > allowed:
            usual_gap = float(np.median(gaps))
            worst = int(np.argmax(np.abs(gaps - usual_gap)))
            message = f"uneven times: a step of {gaps[worst]:.6g} s here, of {usual_gap:.6g} s elsewhere"
            hint = f"resample the record to even steps; {_ROW_BY_ROW}"
            raise self.text.refuse(message, hint, lines[worst + 1] + 1)
        self.text.step(step, lines[0] + 1)
        if self.step is not None and self.text.dt is None and abs(self.step - step) > 1e-3 * step:
            message = (
                f"line {self.step_line} says a time step of {self.step:g} s, "
                f"but the times rise by {step:g} s, which is used"
            )
            hint = f"write `dt: {step:g} s` beside the file (--dt {step:g}) if the times are right; correct them if not"
            self.doubt = MotionWarning(message, hint)
        return step

    def _check_counts(self, size: int) -> None:
        """Refuse a file whose header says another number of samples than `size`."""
        for count, line in self.counts:
            if count != size:
                header_count = f"{pluralize(count, 'value')} (samples = {count})"
                actual_count = pluralize(size, "value follows", "values follow")
                message = f"the header says {header_count}, but {actual_count}"
                hint = "correct that line or take it out, or complete the file"
                raise self.text.refuse(message, hint, line)

    # The unit

    def _build_samples(self, step: float, values: list[float], heading: Heading) -> Samples:
        """Return samples with the unit that their heading or the header states.

        Raises
        ------
        InputError : the file states several units, and the user none
        """
        begin = self.start + 1
        statements = sorted([*heading.units, *self.header.unit_statements], key=lambda each: each[1])
        if statements:
            unit, line = self._choose_unit(statements)
            return Samples(step, values, begin, unit, line, doubt=self.doubt)
        if heading.is_other_quantity or heading.quantity == "counts":
            line = heading.lines[-1]
            return Samples(step, values, begin, heading.quantity, line, doubt=self.doubt)
        other_unit = self._find_other_unit()
        if other_unit is not None:
            return Samples(step, values, begin, *other_unit, doubt=self.doubt)
        unclear, line = self._find_unclear(heading)
        return Samples(step, values, begin, None, 0, unclear, line, self.doubt)

    def _choose_unit(self, statements: list[tuple[str, int]]) -> tuple[str, int]:
        """Return the unit that the file states, and its line; of several the first that is not the user's.

        statements : units of acceleration with their lines, at least one

        Raises
        ------
        InputError : there are several, and the user gives none
        """
        first_unit, first_line = statements[0]
        first_factor = find_acceleration_unit(first_unit) or 0.0
        other = next(
            (each for each in statements if _differs(each[0], first_factor)),
            None,
        )
        if other is not None and self.text.unit is None:
            other_unit, other_line = other
            message = (
                f"the file says {first_unit} in line {first_line} ({self._quote(first_line)}), "
                f"but {other_unit} in this line ({self._quote(other_line)})"
            )
            hint = f"say which unit the values are in: unit: {first_unit} beside the file, or --unit {first_unit}"
            raise self.text.refuse(message, hint, other_line)
        users_factor = find_acceleration_unit(self.text.unit or "")
        if users_factor is None:
            return first_unit, first_line
        others = (each for each in statements if _differs(each[0], users_factor))
        return next(others, (first_unit, first_line))

    def _find_other_unit(self) -> tuple[str, int] | None:
        """Return another unit that the file states, and its line; None where it states none."""
        for line, words in self.header.words.items():
            series = re.match(r"TIMESERIES\b.*,\s*([^,]+)\Z", words)  # SLIST of IRIS and ObsPy
            if series and identify_unit(series[1])[0]:
                return series[1], line
        header = self.text.header
        statement, line = header.get("unit") or header.get("units") or ("", 0)
        first_words = re.split(r"[;,]\s", statement)[0].strip()
        unit = first_words if identify_unit(first_words)[0] else statement
        return (unit, line) if unit else None

    def _find_unclear(self, heading: Heading) -> tuple[str, int]:
        """Return why no unit can be read from the lines over the numbers, and the line; "" where none says one."""
        bracketed = BRACKETS.findall(heading.text)
        words = " ".join(bracketed) if bracketed else heading.text
        usual_words = rf"(?i){ACCELERATION_WORD}|\b(?:ground|base|input|ag?|xg|x|y|z|values?)\b"
        if re.sub(rf"{usual_words}|[\s\W_]", "", words):
            return f"'{heading.text[:60]}' names no unit of acceleration that is known", heading.lines[-1]
        for line, text in self.header.words.items():
            quantity = find_quantity(text)
            names_unit = BRACKETS.search(text) or re.search(r"(?i)\b(?:in|en)\s+[cm]?m\b", text)
            if is_about_one_number(text):
                message = f"'{text[:60]}' speaks of one number or of a factor, not of the unit of all values"
                return message, line
            if quantity in ("velocity", "displacement") and names_unit:
                raise self.text.refuse_quantity(quantity, line)
        for line, text in self.header.words.items():
            is_about_unit = re.search(rf"(?i)(?<![a-z])units?(?![a-z])|{ACCELERATION_WORD}", text)
            names_unit = BRACKETS.search(text) or re.search(r"(?i)units?\W", text)
            if is_about_unit and names_unit:
                return f"'{text[:60]}' names no unit of acceleration that is known", line
        return "", 0

    def _quote(self, line: int) -> str:
        """Return the begin of a line (from 1), in quotes."""
        return f"'{self.text.lines[line - 1].strip()[:60]}'"


def _differs(unit: str, factor: float) -> bool:
    """Return whether one of a unit of acceleration is another number of m/s2 than `factor`."""
    return abs((find_acceleration_unit(unit) or 0.0) / factor - 1.0) > 1e-4


def _find_largest_deviation(times: np.ndarray, step: float) -> float:
    """Return the largest distance [s] of times from those that begin with the first and have this step."""
    return float(np.abs(times - times[0] - step * np.arange(times.size)).max())


def _find_heading_of_unit(headings: list[Heading], place: int) -> Heading:
    """Return the heading that has the unit of a column: its own, or that of the last of several components.

    `t, NS, EW, UD (gal)` states one unit for three components.
    """
    heading = headings[place]
    last = headings[-1]
    is_shared = heading.is_component and last.is_component and not BRACKETS.search(heading.text)
    return last if is_shared and BRACKETS.search(last.text) else heading
