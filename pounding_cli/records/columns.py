"""Plain text: time and acceleration in two columns, a column of a table, or values with a time step beside them.

Any separator (blanks, tabs, commas, semicolons; a comma as decimal sign where the file shows it), headings with
units (`t [s]; a [cm/s2]`), comments behind `#`, `%` or `!`, and `# dt:`, `# unit:`, `# name:` lines.
"""

from __future__ import annotations

import re
from itertools import islice, pairwise

from pounding_cli.numbers import counted
from pounding_cli.records.text import Asked, Samples, Text, number, tokens
from pounding_cli.records.units import acceleration_unit, quantity_of

_BRACKETS = re.compile(r"[(\[]([^()\[\]]*)[)\]]")
_WORD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^()\[\]]*[)\]])?")
_SEPARATOR = re.compile(r"[,;:=]")
_BEFORE_UNIT = re.compile(r"\b(?:in|of|units?|are|is)\b\s*[:=]?", re.IGNORECASE)
_NAME = re.compile(r"^\s*(?:acc[a-z]*|ag?)(?![a-z])\.?\s*[_/]?", re.IGNORECASE)
_UNITS = re.compile(r"\bunits?\b", re.IGNORECASE)
_ACCELERATION = re.compile(r"\bacc(?:el[a-z]*|n)?\b", re.IGNORECASE)
_ONLY_ACCELERATION = re.compile(r"(?:(?:ground|base|input)\s+)?(?:acc[a-z]*|ag?)\.?|", re.IGNORECASE)
_TIME = re.compile(r"t(?:ime)?(?![a-z])|s(?:ec)?(?![a-z])", re.IGNORECASE)
_PEAK = re.compile(r"\b(?:peaks?|max[a-z]*|pga)\b|[)\]]\s*[:=]\s*[-+.\d]", re.IGNORECASE)
_STEP = re.compile(
    r"\b(?:dt|time[ _-]?step|delta[ _-]?t|sampling[ _-]?interval)\b[^\d.+-]{0,12}([\d.]+(?:e[-+]?\d+)?)\s*(ms)?",
    re.IGNORECASE,
)
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[EeDd][-+]?\d+)?\Z")
_TOP, _ROWS_OF_HEADINGS = 60, 3
# Lines over the numbers searched for units and a time step, and those that may hold headings: names and units stand in
# one line or in two.
_ROW_BY_ROW = "for values printed row by row say format 'column' and dt"


def kind_of(text: Text, asked: Asked) -> str:
    """two-column, column or table: by the numbers on the first line of numbers.

    Raises `InputError` for several columns and none named.
    """
    start = _first_row(text)
    width = len(tokens(text.lines[start]))
    if asked.column is None and width > 2:
        above = _above(text, start)
        headings = enumerate(_cells(above[0][1], width) if above else [], 1)
        shown = ", ".join(f"{place}: {words}" for place, words in headings if words)
        message = f"{width} values on a line{f' ({shown})' if shown else ''}, and no column is selected"
        hint = f"select one: column: 2 beside the file in a study, or --column 2; {_ROW_BY_ROW}"
        raise text.refuse(message, hint, start + 1)
    return "table" if asked.column is not None else ("column", "two-column")[width - 1]


def read_column(text: Text, asked: Asked) -> Samples:
    """Values row by row; the time step comes from `dt` or from the header."""
    start = _first_row(text)
    stated = (found for _, words in _above(text, start) if (found := _STEP.search(words)) and number(found[1]))
    written: str | float | None = None
    if "dt" in text.header:
        written = re.sub(r"\s*s(?:ec)?\s*\Z", "", text.header["dt"])
    elif found := next(stated, None):
        written = float(found[1]) / (1000.0 if found[2] else 1.0)
    if written is None and asked.dt is None:
        hint = "give dt (--dt 0.01, or dt: 0.01 s beside the file in a study), or put '# dt: 0.01 s' on top"
        raise text.refuse("one column of values, and no time step", hint, 1)
    step = text.step(float(asked.dt or 0.0), 0) if written is None else text.step(written, 1, asked.dt)
    values, line = text.values(start)
    if (said := text.header.get("samples")) is not None:
        text.count(said, len(values), 1, "samples")
    return Samples(step, values, line, *_unit(text, start, 1, 0))


def read_two_columns(text: Text, asked: Asked) -> Samples:
    """Time [s] and acceleration on every line; raises `InputError` for uneven or falling times."""
    return read_table(text, Asked(asked.dt, None, 2), 2)


def read_table(text: Text, asked: Asked, width: int | None = None) -> Samples:
    """One column of several; the first is the time, unless the time step is given and it does not rise."""
    if asked.column is None:
        raise text.refuse("format 'table' needs a column", "select one: column: 2, or --column 2", 1)
    start, place = _first_row(text), asked.column - 1
    rows = text.rows(start)
    columns = width or len(next(iter(rows.values())))
    if not 0 <= place < columns:
        raise text.refuse(f"there is no column {place + 1} among {columns}", f"write 1 to {columns}", start + 1)
    odd = next((index for index, row in rows.items() if len(row) != columns), None)
    if odd is not None:
        message = f"{counted(len(rows[odd]), 'value')} on this line, where every other has {columns}"
        raise text.refuse(message, f"write as many values on every line; {_ROW_BY_ROW}", odd + 1)
    values, times, lines = [row[place] for row in rows.values()], [row[0] for row in rows.values()], list(rows)
    unit = _unit(text, start, columns, place)
    rising = all(one < other for one, other in pairwise(times))
    if asked.dt is not None and width is None and (place == 0 or not rising):
        return Samples(text.step(float(asked.dt), 0), values, start + 1, *unit)
    if place == 0:
        hint = "write the acceleration's column, or give dt"
        raise text.refuse("column 1 is the time, unless dt is given", hint, start + 1)
    scale = 1e-3 if _in_milliseconds(text, start, columns) else 1.0
    digit = min(_last_digit(tokens(text.lines[index])[0]) for index in lines[:1000])
    step = text.even_step([time * scale for time in times], lines, asked.dt, digit * scale)
    return Samples(step, values, start + 1, *unit)


def _first_row(text: Text) -> int:
    """Index of the first line that opens with a number, with decimal points in place of commas; words and comments
    before are the header."""
    text.lines = _points(text.lines)
    for index, line in enumerate(text.lines):
        found = tokens(line)
        if found and (number(found[0]) is not None or found[0].lower() in ("nan", "inf", "-inf")):
            return index
    hint = "docs/records.md has the formats: at2, cosmos, csmip, smc, knet, esm, and plain columns"
    raise text.refuse("no line of numbers found", hint, 1)


def _points(lines: list[str]) -> list[str]:
    """The lines with decimal points where the file writes decimal commas: by its first lines of numbers."""
    sample = islice((line for line in lines if re.match(r"\s*[-+]?[\d.,]", line)), 20)
    rows = [[word for word in re.split(r"[;\s]+", line.strip()) if word] for line in sample]
    words = [word for row in rows for word in row]
    separated = any(len(row) > 1 for row in rows)
    pointed = any("." in word or word.endswith(",") for word in words)
    if not separated or pointed or not any(map(_DECIMAL_COMMA.match, words)):
        return lines
    return [line if line.lstrip()[:1] in ("#", "%", "!") else re.sub(r"(?<=\d),(?=\d)", ".", line) for line in lines]


def _above(text: Text, start: int) -> list[tuple[int, str]]:
    """Header lines with their indices, the nearest first, without the sign of a comment."""
    top = range(max(0, start - _TOP), start)
    return [(index, text.lines[index].strip().lstrip("#%! ")) for index in reversed(top) if text.lines[index].strip()]


def _cells(line: str, width: int) -> list[str]:
    """A header line as one text a column; empty texts where it is none of headings."""
    for separator in (";", "\t", ","):
        parts = [part.strip() for part in line.split(separator)]
        if len(parts) == width > 1:
            return parts
    found = _WORD.findall(line)
    if len(found) == width:
        return found
    return [line] if width == 1 and _BRACKETS.search(line) else [""] * width


def _unit(text: Text, start: int, width: int, place: int) -> tuple[str | None, int, str]:
    """What the file states as the unit of a column, the line that does, and a heading from which none can be read."""
    if (said := text.header.get("unit")) is not None:
        found = (re.match(r"\s*[#%!]\s*unit\s*[:=]", line, re.IGNORECASE) for line in text.lines)
        return said, next(line for line, this in enumerate(found, 1) if this), ""
    above = _above(text, start)
    rows = [(index, _cells(words, width)) for index, words in above[:_ROWS_OF_HEADINGS]]
    headings = [(index, cells[place]) for index, cells in rows if cells[place]]
    for index, words in headings:
        if unit := _unit_in(words):
            return unit, index + 1, ""
    for index, words in above:
        if unit := _unit_in_text(words):
            return unit, index + 1, ""
    unclear = headings[0][1] if headings and _TIME.match(_cells(above[0][1], width)[0]) else ""
    spoken = (words for _, words in above if _ACCELERATION.search(words) and _BRACKETS.search(words))
    unclear = unclear or next((words for words in spoken if not _PEAK.search(words)), "")
    return None, 0, "" if _ONLY_ACCELERATION.fullmatch(unclear) else unclear[:60]


def _unit_in(words: str, others: tuple[str, ...] = ("velocity", "displacement", "counts")) -> str | None:
    """The unit that a heading states, or the other quantity that it names: `m/s2`, `a [m/s^2]`, `Accel, mg`,
    `acc in gal`, `acc_g`, `Accel m / s2`, `v (cm/s)`, `velocity`."""
    plain = _BRACKETS.sub(" ", words)
    parts = [plain, *_SEPARATOR.split(plain)]
    parts += [piece for part in parts for piece in _BEFORE_UNIT.split(part)[1:]]
    parts += [_NAME.sub("", part) for part in parts]
    ends = [re.split(r"[\s_]", part.strip()) for part in parts]
    found = [*_BRACKETS.findall(words), *parts, *(part.replace("_", "/") for part in parts)]
    found += [end[place] for place in (-1, 0) for end in ends[1:]]
    return next((word.strip() for word in found if acceleration_unit(word) or quantity_of(word) in others), None)


def _unit_in_text(line: str) -> str | None:
    """The unit that a line of words states: `Acceleration (cm/s/s)`, `ACCELERATION IN G AT 50 HZ`, `Units: gal`, or the
    unit alone. A line that gives a peak speaks of that number."""
    if acceleration_unit(line):
        return line.strip()
    if (named := _UNITS.search(line)) and (unit := _unit_in(line[named.start() :])):
        return unit
    named = _ACCELERATION.search(line)
    unit = _unit_in(line[named.end() :], ()) if named and not _PEAK.search(line) else None
    return None if unit is None or unit[0].isdigit() else unit


def _in_milliseconds(text: Text, start: int, width: int) -> bool:
    """Whether the headings say so of the times."""
    cells = [_cells(words, width)[0] for _, words in _above(text, start)[:_ROWS_OF_HEADINGS]]
    words = [word for cell in cells for word in (*_BRACKETS.findall(cell), re.split(r"[\s,_/]", cell)[-1])]
    return any(word.strip().lower() in ("ms", "msec", "msecs", "milliseconds") for word in words)


def _last_digit(word: str) -> float:
    """The last decimal of a number as printed; 0 where it has an exponent."""
    return 0.0 if re.search(r"[EeDd]", word) else 10.0 ** -len(word.partition(".")[2])
