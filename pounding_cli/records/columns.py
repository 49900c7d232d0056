"""Plain columns: time and acceleration, one column of a table, or values with a time step beside them.

They are separated by blanks, tabs, commas or semicolons, with a comma as decimal sign where the file shows it. Above
them may stand headings with units (`t [s]; a [cm/s2]`), comments behind `#`, `%` or `!`, and lines `# dt:`, `# unit:`.
"""

from __future__ import annotations

import re
from itertools import chain, islice

import numpy as np

from pounding_cli.numbers import counted
from pounding_cli.records.text import Asked, Samples, Text, number, tokens
from pounding_cli.records.units import BRACKETS, acceleration_unit, unit_in

FORMATS = ("two-column", "column", "table")

_Above = list[tuple[int, str]]
# Lines over the numbers (from 1) with their words, the nearest first.

_TOP, _ROWS_OF_HEADINGS = 60, 3
# Lines over the numbers searched for units and a time step, and those that may hold headings: names and units stand in
# one line or in two.
_UNEVEN = 0.02
# Times are printed with few digits: a sample may stand off its even place by this part of a step, or by the last digit
# printed where that is less than a quarter of a step.
_HEADING = re.compile(r"[^\s(\[]+(?:\s*[(\[][^()\[\]]*[)\]])?")
_TIME = re.compile(r"(?:t|time|s|sec)(?![a-z])", re.IGNORECASE)
_MILLISECONDS = re.compile(r"(?<![a-z])(?:ms|msecs?|milliseconds)(?![a-z])", re.IGNORECASE)
_UNITS = re.compile(r"\bunits?\b", re.IGNORECASE)
_ACCELERATION = re.compile(r"\bacc(?:el[a-z]*|n)?\b", re.IGNORECASE)
_ONLY_ACCELERATION = re.compile(r"(?:(?:ground|base|input)\s+)?(?:acc[a-z]*|ag?)\.?|", re.IGNORECASE)
_PEAK = re.compile(
    r"\b(?:peaks?|max[a-z]*|pga)\b|\bacc[a-z]*\.?\s*(?:[(\[][^()\[\]]*[)\]]\s*)?[:=]\s*[-+.\d]", re.IGNORECASE
)
_SECONDS = re.compile(r"(?<=[\d.\s])s(?:ec)?\Z", re.IGNORECASE)
_STEPS = ("dt", "time step", "delta t", "sampling interval")
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[EeDd][-+]?\d+)?\Z")
_ROW_BY_ROW = "for values printed row by row say format 'column' and dt"


def read_columns(text: Text, asked: Asked, format: str | None) -> tuple[str, Samples]:
    """The format, by the first line of numbers unless given, and the samples.

    Raises
    ------
    InputError : several columns and none selected, no time step, uneven or falling times, lines of different lengths
    """
    text.lines = _with_points(text.lines)
    start = _first_row(text)
    width = len(tokens(text.lines[start]))
    top = range(start, max(0, start - _TOP), -1)
    above = [(line, words) for line in top if (words := text.lines[line - 1].strip().lstrip("#%! "))]
    if format is None and asked.column is None and width > 2:
        hint = f"select one: column: 2 beside the file in a study, or --column 2; {_ROW_BY_ROW}"
        raise text.refuse(f"{width} values on a line, and no column is selected", hint, start + 1)
    kind = format or ("table" if asked.column is not None else ("column", "two-column")[width - 1])
    if kind == "column":
        return kind, _column(text, asked, start, above)
    if kind == "table" and asked.column is None:
        raise text.refuse("format 'table' needs a column", "select one: column: 2, or --column 2", 1)
    return kind, _table(text, asked, start, above, kind)


def _column(text: Text, asked: Asked, start: int, above: _Above) -> Samples:
    """Values row by row; the time step comes from `dt` or from the header."""
    stated = [text.header[key] for key in _STEPS if key in text.header]
    if not stated and asked.dt is None:
        hint = "give dt (--dt 0.01, or dt: 0.01 s beside the file in a study), or put '# dt: 0.01 s' on top"
        raise text.refuse("one column of values, and no time step", hint, 1)
    written, line = stated[0] if stated else (f"{asked.dt}", 0)
    step = text.step(_SECONDS.sub("", written).strip(), line, asked.dt)
    values, begin = text.values(start)
    if "samples" in text.header:
        said, line = text.header["samples"]
        text.count(said, len(values), line, "samples")
    return Samples(step, values, begin, *_unit(text, above, 1, 0))


def _table(text: Text, asked: Asked, start: int, above: _Above, kind: str) -> Samples:
    """One column of several; the first is the time, unless the time step is given and it does not rise."""
    rows = text.rows(start)
    columns = 2 if kind == "two-column" else len(next(iter(rows.values())))
    place = 1 if kind == "two-column" else (asked.column or 0) - 1
    if not 0 <= place < columns:
        raise text.refuse(f"there is no column {place + 1} among {columns}", f"write 1 to {columns}", start + 1)
    odd = next((index for index, row in rows.items() if len(row) != columns), None)
    if odd is not None:
        message = f"{counted(len(rows[odd]), 'value')} on this line, where every other has {columns}"
        raise text.refuse(message, f"write as many values on every line; {_ROW_BY_ROW}", odd + 1)
    values, times = [row[place] for row in rows.values()], np.array([row[0] for row in rows.values()])
    unit = _unit(text, above, columns, place)
    if asked.dt is not None and kind == "table" and (place == 0 or (np.diff(times) <= 0).any()):
        return Samples(text.step(float(asked.dt), 0), values, start + 1, *unit)
    if place == 0:
        hint = "write the acceleration's column, or give dt"
        raise text.refuse("column 1 is the time, unless dt is given", hint, start + 1)
    heads = [_cells(words, columns)[0] for _, words in above[:_ROWS_OF_HEADINGS]]
    scale = 1e-3 if any(map(_MILLISECONDS.search, heads)) else 1.0
    lines = list(rows)
    digit = min(_last_digit(tokens(text.lines[index])[0]) for index in lines[:1000])
    return Samples(_even_step(text, times * scale, lines, asked.dt, digit * scale), values, start + 1, *unit)


def _first_row(text: Text) -> int:
    """Index of the first line that opens with a number; words and comments before are the header."""
    for index, line in enumerate(text.lines):
        found = tokens(line)
        if found and (number(found[0]) is not None or found[0].lower() in ("nan", "inf", "-inf")):
            return index
    hint = "docs/records.md has the formats: at2, cosmos, csmip, smc, knet, esm, and plain columns"
    raise text.refuse("no line of numbers found", hint, 1)


def _with_points(lines: list[str]) -> list[str]:
    """The lines with decimal points where the file writes decimal commas: by its first lines of numbers."""
    sample = islice((line for line in lines if re.match(r"\s*[-+]?[\d.,]", line)), 20)
    rows = [[word for word in re.split(r"[;\s]+", line.strip()) if word] for line in sample]
    words = list(chain(*rows))
    pointed = any("." in word or word.endswith(",") for word in words)
    if pointed or max(map(len, rows), default=0) < 2 or not any(map(_DECIMAL_COMMA.match, words)):
        return lines
    return [line if line.lstrip()[:1] in ("#", "%", "!") else re.sub(r"(?<=\d),(?=\d)", ".", line) for line in lines]


def _cells(line: str, width: int) -> list[str]:
    """A header line as one text a column; empty texts where it is none of headings."""
    for separator in (";", "\t", ","):
        parts = [part.strip() for part in line.split(separator)]
        if len(parts) == width > 1:
            return parts
    found = _HEADING.findall(line)
    if len(found) == width:
        return found
    return [line] if width == 1 and BRACKETS.search(line) else [""] * width


def _unit(text: Text, above: _Above, width: int, place: int) -> tuple[str | None, int, str]:
    """What the file states as the unit of a column, the line that does, and a heading from which none can be read."""
    if "unit" in text.header:
        return *text.header["unit"], ""
    rows = [(line, _cells(words, width)[place]) for line, words in above[:_ROWS_OF_HEADINGS]]
    headings = [(line, words) for line, words in rows if words]
    found = chain(
        ((line, unit_in(words)) for line, words in headings),
        ((line, _unit_in_text(words)) for line, words in above),
    )
    line, unit = next(((line, unit) for line, unit in found if unit), (0, None))
    if unit is not None:
        return unit, line, ""
    spoken = (words for _, words in above if _ACCELERATION.search(words) and BRACKETS.search(words))
    named = headings[0][1] if headings and _TIME.match(above[0][1]) else ""
    unclear = named or next((words for words in spoken if not _PEAK.search(words)), "")
    return None, 0, "" if _ONLY_ACCELERATION.fullmatch(unclear) else unclear[:60]


def _unit_in_text(line: str) -> str | None:
    """The unit that a line of words states: `Acceleration (cm/s/s)`, `ACCELERATION IN G AT 50 HZ`, `Units: gal`, or the
    unit alone. A line that gives a peak speaks of that number."""
    if acceleration_unit(line):
        return line.strip()
    if (named := _UNITS.search(line)) and (unit := unit_in(line[named.end() :])):
        return unit
    named = _ACCELERATION.search(line)
    unit = unit_in(line[named.end() :], ()) if named and not _PEAK.search(line) else None
    return None if unit is None or unit[0].isdigit() else unit


def _last_digit(word: str) -> float:
    """The last decimal of a number as printed; 0 where it has an exponent."""
    return 0.0 if re.search(r"[EeDd]", word) else 10.0 ** -len(word.partition(".")[2])


def _even_step(text: Text, times: np.ndarray, lines: list[int], given: float | None, digit: float) -> float:
    """The time step [s] of evenly rising `times` [s]; refused where they fall, stand or are uneven.

    lines : their indices in the file; given : the step the user gave; digit : the last digit they are printed with
    """
    if times.size < 2:
        raise text.refuse("only one sample found", "a motion needs at least two samples", lines[0] + 1)
    gaps = np.diff(times)
    step = float(f"{(times[-1] - times[0]) / gaps.size:.9g}")
    allowed = max(_UNEVEN * step, min(1.02 * digit, 0.25 * step))
    steps = [step] if given is None else [given, step]  # the step given is the exact one, where times are rounded
    even = [one for one in steps if np.abs(times - times[0] - one * np.arange(times.size)).max() <= allowed]
    if not even:
        usual = float(np.median(gaps))
        worst = int(np.argmax(np.abs(gaps - usual)))
        message = f"uneven times: a step of {gaps[worst]:.6g} s here, of {usual:.6g} s elsewhere"
        raise text.refuse(message, f"resample the record to even steps; {_ROW_BY_ROW}", lines[worst + 1] + 1)
    text.step(step, lines[0] + 1, given)
    return even[0]
