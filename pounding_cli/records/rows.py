"""The rows of numbers of a motion file, and a header of numbers over them: `8 0.02`, a count and a time step."""

from __future__ import annotations

import re
from itertools import islice
from typing import NamedTuple

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.numbers import pluralize
from pounding_cli.records.headings import is_name_of_time, says_step_or_count
from pounding_cli.records.text import NumberRow, TextFile, is_numeric, parse_number, split_words
from pounding_cli.records.units import find_quantity

MIN_HEADER_STEP = 1e-4
"""Least number that may be a time step in a header of numbers [s]."""

MAX_HEADER_STEP = 0.5
"""Largest number that may be a time step in a header of numbers [s]."""

MAX_HEADER_LINES = 400
"""Lines over the numbers that are looked at."""

MAX_NUMBERS_OVER_WORDS = 5
"""Lines of numbers over words that may belong to a header: a date, coordinates."""

GIVE_STEP = "give dt (--dt 0.01, or dt: 0.01 s beside the file in a study), or put '# dt: 0.01 s' on top"
"""What to do about a file that does not state its time step."""

MAX_LINES_OF_COMMAS = 2000
"""Lines of numbers that are looked at for decimal commas."""

_OF_NUMBERS = re.compile(r"\s*[\"']?[-+]?[\d.,][-+\d.,;eEdD\s\"']*\Z")
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[EeDd][-+]?\d+)?\Z")
_TWO_WHOLES = re.compile(r"[-+]?\d+,[-+]?\d+(?:[EeDd][-+]?\d+)?\Z")
_MISSING = (
    "nan",
    "na",
    "null",
    "none",
    "nil",
    "inf",
    "infinity",
    "missing",
    "void",
    "gap",
    "error",
)
"""Words in place of a number."""
_CLOCK = re.compile(r"\s*[\"']?(?:\d{4}-\d\d-\d\d|\d{1,2}:\d\d:\d\d)")
"""The begin of a line with a date or an hour of the day."""
_WHOLE = re.compile(r"\+?\d{1,9}\.?\Z")


class NumberHeader(NamedTuple):
    """Lines of numbers over the samples.

    rows : how many lines
    size : number of samples that they say; None where they say none
    step : time step [s], likewise
    line : the first of them (from 1)
    """

    rows: int = 0
    size: int | None = None
    step: float | None = None
    line: int = 0


def find_rows(text: TextFile) -> tuple[int, list[NumberRow]]:
    """Return the index of the first line of numbers below all words, and the rows of numbers.

    A count and a time step that stand above words, as in a header, are rows too where they fit what follows.
    """
    first = _find_numbers(text.lines, 0)
    if first is None:
        raise _refuse_without_numbers(text)
    plain_rows = text.read_plain_rows(first)
    if plain_rows:
        return first, plain_rows
    lines_of_words = (index for index in range(first, len(text.lines)) if _is_of_words(text.lines[index]))
    words = next(lines_of_words, None)
    below = _find_numbers(text.lines, words) if words is not None else None
    if words is not None and below is not None:
        return _find_rows_below_words(text, first, words, below)
    return first, text.read_rows(first)


def _refuse_without_numbers(text: TextFile) -> InputError:
    """Return the refusal of a file without a line of numbers."""
    clock = next((index for index, line in enumerate(text.lines) if _CLOCK.match(line)), None)
    if clock is not None:
        message = "the times are dates or hours of the day, not seconds"
        hint = "write seconds from the first sample on, or one column of values and give dt (--dt 0.01, or dt: 0.01 s)"
        return text.refuse(message, hint, clock + 1)
    hint = "docs/records.md has the formats: at2, cosmos, csmip, smc, knet, esm, geonet, asa, and plain columns"
    return text.refuse("no line of numbers found", hint, 1)


def _find_rows_below_words(
    text: TextFile,
    first: int,
    words: int,
    below: int,
) -> tuple[int, list[NumberRow]]:
    """Return the rows below words that stand among the numbers, as `find_rows`.

    first, words, below : indices of the first line of numbers, of the words, and of the numbers below them
    """
    header = text.read_rows(first, words)
    if len(header) > MAX_NUMBERS_OVER_WORDS:
        return first, text.read_rows(first)  # raises: words among the samples
    rows = text.read_rows(below)
    says_count = _count_and_step(header[0]) is not None or _says_size(header[0], rows)
    if says_count and len(header) <= 2:
        return below, header + rows
    is_header = all(len(row.values) != len(rows[0].values) or _is_date(row) for row in header)
    is_other_quantity = find_quantity(text.lines[words]) in ("velocity", "displacement")
    if not is_header or len(rows) <= len(header) or is_other_quantity:
        quote = text.lines[words].strip()[:40]
        message = f"numbers stand over these words ('{quote}') and below them: which are the samples?"
        hint = "take out the lines that are no samples, or begin them with #"
        raise text.refuse(message, hint, words + 1)
    return below, rows


def _is_date(row: NumberRow) -> bool:
    """Return whether a row is a date or a code, 20200101010203, no sample."""
    return all(re.fullmatch(r"\d{8,}", word) for word in row.words)


def _says_size(row: NumberRow, rows: list[NumberRow]) -> bool:
    """Return whether a row begins with the number of samples in other rows."""
    return bool(_WHOLE.match(row.words[0])) and int(row.values[0]) in _sizes(rows)


def _is_of_words(line: str) -> bool:
    """Return whether a line is one of words, and no comment."""
    return bool(line.strip()) and line.lstrip()[0] not in "#%!\x1a" and not is_numeric(line)


def _find_numbers(lines: list[str], start: int) -> int | None:
    """Return the index of the next line of numbers; None where there is none."""
    for index in range(start, len(lines)):
        if lines[index].lstrip()[:1] not in ("#", "%", "!") and is_numeric(lines[index]):
            return index
    return None


def refuse_a_row_among_headings(text: TextFile, start: int, width: int) -> None:
    """Refuse a line right above the rows that would be one of them but for a word that is no number."""
    above = next((index for index in range(start - 1, -1, -1) if text.lines[index].strip()), None)
    if above is None or text.lines[above].lstrip()[:1] in tuple("#%!"):
        return
    words = split_words(text.lines[above])
    numbers = [word for word in words if parse_number(word) is not None]
    others = [word for word in words if parse_number(word) is None]
    begins_as_number = any(re.match(r"[-+]?\d*\.\d", word) for word in others)
    has_one_odd_word = len(numbers) == width - 1 > 0 or (width == 1 and begins_as_number)
    if len(words) != width or not has_one_odd_word:
        return
    odd = others[0]
    is_name = odd.strip(":=").isalpha() and odd.lower() not in _MISSING
    is_key = is_name and odd == words[0]
    is_title = is_name and all(map(_WHOLE.match, numbers)) and len(numbers) > 0  # 2010 Maule
    if is_key or is_title or is_name_of_time(odd) or says_step_or_count(text.lines[above]):
        return  # dt 0.02; 50 sps; or time,0: the headings of a pandas series without a name
    hint = "write plain numbers; fill or cut gaps in the record"
    column = text.lines[above].find(odd) + 1
    raise text.refuse(f"'{odd[:40]}' is not a finite number", hint, above + 1, column)


def find_number_header(text: TextFile, rows: list[NumberRow]) -> NumberHeader:
    """Return the header of numbers over the samples: a count, a time step, or both, in one line or in two.

    Raises
    ------
    InputError : the first line is unlike the others and says neither, or another count than follows
    """
    if len(rows) < 3:
        return _find_header_of_one_row(text, rows)
    first, second, third = (len(row.values) for row in rows[:3])
    line = rows[0].line_index + 1
    if first == second == 1:
        return _find_header_in_a_column(text, rows, third)
    pair = _count_and_step(rows[0])
    body = rows[1:]
    sizes = _sizes(body)
    if pair is not None:
        count, step = pair
        falls = first == second and rows[0].values[0] > rows[1].values[0] and _rises(body)
        if first == second and count not in sizes and not falls:
            return NumberHeader()
        if count not in sizes:
            size = sizes[0] if second == 1 or falls else sizes[-1]
            raise _refuse_count(text, rows[0], count, size)
        return NumberHeader(1, count, step, line)
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
        message = (
            f"'{quote}' is a line of numbers unlike those below it: a header that says neither count nor time step"
        )
        raise text.refuse(message, f"take the line out, and {GIVE_STEP}", line)
    return NumberHeader()


def find_number_header_in_comments(text: TextFile, start: int, rows: list[NumberRow]) -> NumberHeader:
    """Return a count and a time step that stand in a comment, `# 8 0.02`, where as many samples follow."""
    for index in range(max(0, start - MAX_HEADER_LINES), start):
        words = split_words(text.lines[index].lstrip("#%! "))
        values = [parse_number(word) for word in words]
        if len(words) == 2 and None not in values:
            pair = _count_and_step(NumberRow(index, words, [value or 0.0 for value in values]))
            if pair and pair[0] in _sizes(rows):
                return NumberHeader(0, *pair, index + 1)
    return NumberHeader()


def _find_header_of_one_row(text: TextFile, rows: list[NumberRow]) -> NumberHeader:
    """Return the header of numbers of a file with one row or two."""
    if len(rows) != 2:
        return NumberHeader()
    first, second = rows
    pair = _count_and_step(first)
    if pair is None or len(second.values) == 2:
        return NumberHeader()
    count, step = pair
    if count != len(second.values):
        raise _refuse_count(text, first, count, len(second.values))
    return NumberHeader(1, count, step, first.line_index + 1)


def _find_header_in_a_column(text: TextFile, rows: list[NumberRow], third: int) -> NumberHeader:
    """Return the header of numbers in the first one or two lines of one number each."""
    line = rows[0].line_index + 1
    first = rows[0]
    second = rows[1]
    for count, step in ((first, second), (second, first)):
        is_count = _WHOLE.match(count.words[0]) and int(count.values[0]) in _sizes(rows[2:])
        if is_count and _is_step(step):
            return NumberHeader(2, int(count.values[0]), step.values[0], line)
    word = first.words[0]
    number = first.values[0]
    others = [row for row in rows[1:] if row.values]
    is_whole = bool(_WHOLE.match(word)) and number >= 2
    if is_whole and int(number) == len(others) and third == 1:
        return NumberHeader(1, int(number), None, line)
    if third != 1:
        message = f"'{word}, {second.words[0]}' are lines of numbers unlike those below: a header"
        raise text.refuse(message, f"take them out, and {GIVE_STEP}", line)
    shortest = min((len(row.words[0].lstrip("-+")) for row in others), default=0)
    if text.dt is not None and number == text.dt and len(word) < shortest:
        message = f"the first line, {word}, is the time step, or looks like it: it is no sample like those below"
        raise text.refuse(message, "take that line out, and leave dt: it is given", line)
    if not is_whole:
        return NumberHeader()
    fractions = [row for row in others if not _WHOLE.match(row.words[0].lstrip("-+"))]
    largest = max(abs(row.values[0]) for row in others)
    is_near_count = abs(number - len(others)) <= 2
    if len(fractions) > 0.5 * len(others) and (is_near_count or number > 20 * largest):
        raise _refuse_count(text, first, int(number), len(others))
    return NumberHeader()


def _refuse_count(text: TextFile, row: NumberRow, count: int, size: int) -> InputError:
    """Return the refusal of a header of numbers that says another count than the number of samples."""
    quote = " ".join(row.words)[:60]
    actual_count = pluralize(size, "value follows", "values follow")
    message = f"'{quote}' over the values is a header that says {pluralize(count, 'value')}, but {actual_count}"
    hint = "correct that line, or take it out and give dt: 0.01 s beside the file (--dt 0.01)"
    return text.refuse(message, hint, row.line_index + 1)


def _count_and_step(row: NumberRow) -> tuple[int, float] | None:
    """Return the count and the time step [s] of a line such as `8 0.02`; None where it is none."""
    if len(row.values) != 2:
        return None
    for count, step in ((0, 1), (1, 0)):
        is_count = _WHOLE.match(row.words[count]) and row.values[count] >= 2
        if is_count and _is_step(row, step):
            return int(row.values[count]), row.values[step]
    return None


def _is_step(row: NumberRow, place: int = 0) -> bool:
    """Return whether a number of a row may be a time step."""
    is_in_range = MIN_HEADER_STEP <= row.values[place] <= MAX_HEADER_STEP
    return is_in_range and not _WHOLE.match(row.words[place])


def _sizes(rows: list[NumberRow]) -> list[int]:
    """Return the numbers that a count may be: of the rows, of the pairs in them, of the values."""
    value_count = sum(len(row.values) for row in rows)
    sizes = [len(rows)]
    if value_count % 2 == 0 and len(rows[0].values) > 1:
        sizes.append(value_count // 2)
    sizes.append(value_count)
    return list(dict.fromkeys(sizes))


def _rises(rows: list[NumberRow]) -> bool:
    """Return whether the first numbers of several rows rise."""
    times = [row.values[0] for row in rows]
    return len(times) > 1 and bool((np.diff(times) > 0).all())


def replace_decimal_commas(text: TextFile) -> list[str]:
    """Return the lines with decimal points where the file writes decimal commas, as its lines of numbers show.

    Raises
    ------
    InputError : commas both part the columns and are the decimal sign
    """
    if not any("," in line for line in text.lines):
        return text.lines
    number_lines = (index for index, line in enumerate(text.lines) if _OF_NUMBERS.match(line))
    lines = list(islice(number_lines, MAX_LINES_OF_COMMAS))
    sample = [text.lines[index].replace('"', " ").replace("'", " ") for index in lines]
    rows = [[word for word in re.split(r"[;\s]+", line.strip()) if word] for line in sample]
    words = [word for row in rows for word in row]
    if any(word.endswith(",") for word in words) or not any("," in word for word in words):
        return text.lines
    is_plain = all(_DECIMAL_COMMA.match(word) or parse_number(word) is not None for word in words)
    is_one_column = max(map(len, rows)) < 2
    if any("." in word for word in words) and (is_one_column or not is_plain):
        return text.lines
    rows_with_several = (place for place, row in enumerate(rows) if any(word.count(",") > 1 for word in row))
    several = next(rows_with_several, None)
    if several is not None:
        if re.search(r"(?:^|,)[-+]?0\d", ",".join(rows[several])):
            message = "commas both part the columns and are the decimal sign"
            hint = "write decimal points, or semicolons between the columns"
            raise text.refuse(message, hint, lines[several] + 1)
        return text.lines
    if not any(map(_DECIMAL_COMMA.match, words)):
        return text.lines
    if is_one_column and not _is_one_column_with_commas(text, words, lines[0]):
        return text.lines
    return [re.sub(r"(?<=\d),(?=\d)", ".", line) if _OF_NUMBERS.match(line) else line for line in text.lines]


def _is_one_column_with_commas(text: TextFile, words: list[str], first: int) -> bool:
    """Return whether words such as `12,500` are one number each, not two columns of whole numbers.

    Raises
    ------
    InputError : they may be both
    """
    if not all(_TWO_WHOLES.match(word) or parse_number(word) is not None for word in words):
        return False  # a word that is no number is refused at its place
    pairs = [word.split(",") for word in words]
    if any(len(pair) == 1 for pair in pairs):
        return True
    wholes = np.array([float(whole) for whole, _ in pairs])
    is_counting = wholes.size > 2 and np.ptp(np.diff(wholes)) == 0 and wholes[1] > wholes[0]
    has_signs = any(re.match(r"[-+]", part) for _, part in pairs)
    if is_counting and not has_signs:
        hint = "write decimal points, or semicolons between the columns"
        message = "the commas may part two columns, or be the decimal sign"
        raise text.refuse(message, hint, first + 1)
    return not is_counting and not has_signs
