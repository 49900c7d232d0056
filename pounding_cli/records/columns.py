"""Plain columns: time and acceleration, one column of a table, or values with a time step beside them.

They are separated by blanks, tabs, commas or semicolons, with a comma as decimal sign where the file shows it. Above
them may stand headings with units (`t [s]; a [cm/s2]`), comments behind `#`, `%` or `!`, and lines `# dt:`, `# unit:`.
"""

from __future__ import annotations

import re
from itertools import chain, islice

import numpy as np

from pounding_cli.numbers import counted
from pounding_cli.records.text import Samples, Text, number, tokens
from pounding_cli.records.units import BRACKETS, acceleration_unit, unit_in

FORMATS = ("two-column", "column", "table")

_TOP, _ROWS_OF_HEADINGS = 60, 3
# Lines over the numbers searched for units, and those that may hold headings: names and units may be in two lines.
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
_STEPS = ("dt", "time step", "delta t", "sampling interval")
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[EeDd][-+]?\d+)?\Z")
_ROW_BY_ROW = "for values printed row by row say format 'column' and dt"


def read_columns(text: Text, format: str | None) -> tuple[str, Samples]:
    """The format, by the first line of numbers unless given, and the samples.

    Raises
    ------
    InputError : several columns and none selected, no time step, uneven or falling times, lines of different lengths
    """
    text.lines = _with_points(text.lines)
    start = _first_row(text)
    width = len(tokens(text.lines[start]))
    if format is None and text.column is None and width > 2:
        hint = f"select one: column: 2 beside the file in a study, or --column 2; {_ROW_BY_ROW}"
        raise text.refuse(f"{width} values on a line, and no column is selected", hint, start + 1)
    kind = format or ("table" if text.column is not None else ("column", "two-column")[width - 1])
    return kind, _column(text, start) if kind == "column" else _table(text, start, kind)


def _column(text: Text, start: int) -> Samples:
    """Values row by row; the time step comes from `dt` or from the header."""
    stated = [text.header[key] for key in _STEPS if key in text.header]
    if not stated and text.dt is None:
        hint = "give dt (--dt 0.01, or dt: 0.01 s beside the file in a study), or put '# dt: 0.01 s' on top"
        raise text.refuse("one column of values, and no time step", hint, 1)
    written, line = stated[0] if stated else (f"{text.dt}", 0)
    step = text.step(re.sub(r"(?<=[\d.\s])s(?:ec)?\Z", "", written, flags=re.IGNORECASE).strip(), line)
    values, begin = text.values(start)
    if "samples" in text.header:
        said, line = text.header["samples"]
        text.check_count(said, len(values), line, "samples")
    return Samples(step, values, begin, *_unit(text, start, 1, 0))


def _table(text: Text, start: int, kind: str) -> Samples:
    """One column of several; the first is the time, unless the time step is given and it does not rise."""
    rows = text.rows(start)
    lines, columns = list(rows), 2 if kind == "two-column" else len(rows[start])
    place = 2 if kind == "two-column" else text.column
    if place is None or not 1 <= place <= columns:
        what = "format 'table' needs a column" if place is None else f"there is no column {place} among {columns}"
        raise text.refuse(what, f"write 1 to {columns}: column: 2 beside the file, or --column 2", start + 1)
    odd = next((index for index, row in rows.items() if len(row) != columns), None)
    if odd is not None:
        message = f"{counted(len(rows[odd]), 'value')} on this line, where every other has {columns}"
        raise text.refuse(message, f"write as many values on every line; {_ROW_BY_ROW}", odd + 1)
    values, times = [row[place - 1] for row in rows.values()], np.array([row[0] for row in rows.values()])
    unit = _unit(text, start, columns, place - 1)
    if text.dt is not None and kind == "table" and (place == 1 or (np.diff(times) <= 0).any()):
        return Samples(text.step(float(text.dt), 0), values, start + 1, *unit)
    if place == 1:
        hint = "write the acceleration's column, or give dt"
        raise text.refuse("column 1 is the time, unless dt is given", hint, start + 1)
    heads = [_cells(words, columns)[0] for _, words in _above(text, start)[:_ROWS_OF_HEADINGS]]
    scale = 1e-3 if any(map(_MILLISECONDS.search, heads)) else 1.0
    return Samples(_even_step(text, times, lines, scale), values, start + 1, *unit)


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


def _above(text: Text, start: int) -> list[tuple[int, str]]:
    """The lines over the numbers (from 1) with their words, the nearest first."""
    top = range(start, max(0, start - _TOP), -1)
    return [(line, words) for line in top if (words := text.lines[line - 1].strip().lstrip("#%! "))]


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


def _unit(text: Text, start: int, width: int, place: int) -> tuple[str | None, int, str]:
    """What the file states as the unit of a column, the line that does, and a heading from which none can be read."""
    if "unit" in text.header:
        return *text.header["unit"], ""
    above = _above(text, start)
    headings = [(line, _cells(words, width)[place]) for line, words in above[:_ROWS_OF_HEADINGS]]
    said = chain(
        ((line, unit_in(words)) for line, words in headings), ((line, _stated(words)) for line, words in above)
    )
    line, unit = next(((line, unit) for line, unit in said if unit), (0, None))
    if unit is not None:
        return unit, line, ""
    heading = next((words for _, words in headings if words), "")
    is_heading = width == 1 or (above and _TIME.match(above[0][1]))
    unclear = heading if is_heading and not _ONLY_ACCELERATION.fullmatch(heading) else ""
    return None, 0, unclear[:60]


def _stated(line: str) -> str | None:
    """The unit that a line of words states: `Acceleration (cm/s/s)`, `ACCELERATION IN G AT 50 HZ`, `Units: gal`, or the
    unit alone. A line that gives a peak speaks of that number."""
    if acceleration_unit(line):
        return line.strip()
    if (named := _UNITS.search(line)) and (unit := unit_in(line[named.end() :])):
        return unit
    named = _ACCELERATION.search(line)
    unit = unit_in(line[named.end() :], ()) if named and not _PEAK.search(line) else None
    return None if unit is None or unit[0].isdigit() else unit


def _even_step(text: Text, written: np.ndarray, lines: list[int], scale: float) -> float:
    """The time step [s] of evenly rising times; refused where they fall, stand or are uneven.

    written : the times as the file has them, one of which is `scale` [s]; lines : their indices in the file
    """
    if written.size < 2:
        raise text.refuse("only one sample found", "a motion needs at least two samples", lines[0] + 1)
    first = [tokens(text.lines[index])[0] for index in lines[:1000]]
    digit = scale * min(0.0 if re.search(r"[EeDd]", word) else 10.0 ** -len(word.partition(".")[2]) for word in first)
    times, gaps = scale * written, scale * np.diff(written)
    step = float(f"{(times[-1] - times[0]) / gaps.size:.9g}")
    allowed = max(_UNEVEN * step, min(1.02 * digit, 0.25 * step))
    steps = [step] if text.dt is None else [text.dt, step]  # the step given is the exact one, where times are rounded
    even = [one for one in steps if np.abs(times - times[0] - one * np.arange(times.size)).max() <= allowed]
    if not even:
        usual = float(np.median(gaps))
        worst = int(np.argmax(np.abs(gaps - usual)))
        message = f"uneven times: a step of {gaps[worst]:.6g} s here, of {usual:.6g} s elsewhere"
        raise text.refuse(message, f"resample the record to even steps; {_ROW_BY_ROW}", lines[worst + 1] + 1)
    text.step(step, lines[0] + 1)
    return even[0]
