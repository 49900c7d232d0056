"""Plain text: time and acceleration in two columns, a column of a table, or values with a time step beside them.

Any separator (blanks, tabs, commas, semicolons; a comma as decimal sign where the file shows it), headings with
units (`t [s]; a [cm/s2]`), comments behind `#`, `%` or `!`, and `# dt:`, `# unit:`, `# name:` lines.
"""

from __future__ import annotations

import re
from itertools import islice, pairwise

from pounding_cli.numbers import counted
from pounding_cli.records.formats.text import Asked, Samples, Text, number, one_blank, tokens
from pounding_cli.records.formats.times import even_step
from pounding_cli.records.units import acceleration_unit, quantity_of

_BRACKETS = re.compile(r"[(\[]([^()\[\]]*)[)\]]")
_WORD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^()\[\]]*[)\]])?")
_IN_UNITS = re.compile(r"\bunits?\b\s*(?:of|are|is|in|:|=)?\s*[:=]?\s*([^\s,;)\]]+)", re.IGNORECASE)
_STEP = re.compile(
    r"\b(?:dt|time[ _-]?step|delta[ _-]?t|sampling[ _-]?interval)\b[^\d.+-]{0,12}([\d.]+(?:e[-+]?\d+)?)\s*(ms)?",
    re.IGNORECASE,
)
_PARTS = re.compile(r"[,;:=]")
_BEFORE_UNIT = re.compile(r"\b(?:in|of|units?)\b\s*[:=]?", re.IGNORECASE)
_NAME = re.compile(r"^\s*(?:acc[a-z]*|ag?)(?![a-z])\.?\s*[_/]?", re.IGNORECASE)
_ACCELERATION = re.compile(r"\bacc(?:el[a-z]*|n)?\b", re.IGNORECASE)
_ONLY_ACCELERATION = re.compile(r"(?:(?:ground|base|input)\s+)?(?:acc[a-z]*|ag?)\.?|", re.IGNORECASE)
_TIME = re.compile(r"t(?:ime)?(?![a-z])|s(?:ec)?(?![a-z])", re.IGNORECASE)
_PEAK = re.compile(r"\b(?:peaks?|max[a-z]*|pga)\b|[)\]]\s*[:=]\s*[-+.\d]", re.IGNORECASE)

_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[EeDd][-+]?\d+)?\Z")
_TOP = 60
# Lines of a header searched for units and a time step.
_ROWS_OF_HEADINGS = 3
# Lines over the columns that may hold their headings: names and units stand in one line or in two.


def kind_of(text: Text, asked: Asked) -> str:
    """two-column, column or table: by the numbers on the first line of numbers.

    Raises `InputError` for several columns and none named.
    """
    text.lines = _points(text.lines)
    start = _first_row(text)
    width = len(tokens(text.lines[start]))
    if asked.column is not None:
        return "table"
    if width == 1:
        return "column"
    if width == 2:
        return "two-column"
    headings = ", ".join(f"{place}: {words}" for place, words in enumerate(_headings(text, start, width), 1) if words)
    raise text.refuse(
        f"{width} values on a line{f' ({headings})' if headings else ''}, and no column is selected",
        "select one: column: 2 beside the file in a study, or --column 2; "
        "for values printed row by row say format 'column' and dt",
        start + 1,
    )


def read_two_columns(text: Text, asked: Asked) -> Samples:
    """Time [s] and acceleration on every line; raises `InputError` for uneven or falling times."""
    return _table(text, Asked(asked.dt, None, 2), 2)


def read_table(text: Text, asked: Asked) -> Samples:
    """One column of several; the first is the time, unless the time step is given and it does not rise."""
    if asked.column is None:
        raise text.refuse("format 'table' needs a column", "select one: column: 2, or --column 2", 1)
    return _table(text, asked, None)


def read_column(text: Text, asked: Asked) -> Samples:
    """Values row by row; the time step comes from `dt` or from the header."""
    text.lines = _points(text.lines)
    start = _first_row(text)
    found, line = _stated_step(text, start)
    if found is None and asked.dt is None:
        raise text.refuse(
            "one column of values, and no time step",
            "give dt (--dt 0.01, or dt: 0.01 s beside the file in a study), or put '# dt: 0.01 s' on top",
            1,
        )
    step = text.step(asked.dt or 0.0, 0) if found is None else text.same_step(asked.dt, text.step(found, line), line)
    values = [value for _, row in text.rows(start) for value in row]
    said = text.header.get("samples", "")
    if re.fullmatch(r"\d{1,9}", said):
        text.count(said, len(values), 1, "samples")
    return Samples(step, values, start + 1, *_unit(text, start, 1, 0))


def _table(text: Text, asked: Asked, wanted: int | None) -> Samples:
    text.lines = _points(text.lines)
    start = _first_row(text)
    rows = text.rows(start)
    width = wanted or len(rows[0][1])
    place = (asked.column or 2) - 1
    if not 0 <= place < width:
        raise text.refuse(f"there is no column {place + 1} among {width}", f"write 1 to {width}", start + 1)
    for index, row in rows:
        if len(row) != width:
            raise text.refuse(
                f"{counted(len(row), 'value')} on this line, where every other has {'two' if width == 2 else width}",
                "write as many values on every line; for values printed row by row say format 'column' and dt",
                index + 1,
            )
    unit = _unit(text, start, width, place)
    values = [row[place] for _, row in rows]
    times = [row[0] for _, row in rows]
    rising = all(one < other for one, other in pairwise(times))
    if asked.dt is not None and (place == 0 or not rising) and wanted is None:
        return Samples(text.step(asked.dt, 0), values, start + 1, *unit)
    if place == 0:
        raise text.refuse(
            "column 1 is the time, unless dt is given", "write the acceleration's column, or give dt", start + 1
        )
    scale = 1e-3 if _in_milliseconds(text, start, width) else 1.0
    decimals = max(_decimals(text.lines[index]) for index, _ in rows[: min(len(rows), 1000)])
    step = even_step(
        text, [time * scale for time in times], [index for index, _ in rows], asked.dt,
        digits=decimals if scale == 1.0 else decimals + 3,
    )  # fmt: skip
    return Samples(step, values, start + 1, *unit)


def _first_row(text: Text) -> int:
    """Index of the first line that opens with a number; words and comments before are the header."""
    for index, line in enumerate(text.lines):
        found = tokens(line)
        if found and (number(found[0]) is not None or found[0].lower() in ("nan", "inf", "-inf")):
            return index
    raise text.refuse(
        "no line of numbers found",
        "give a motion in one of the formats of docs/records.md: at2, cosmos, csmip, smc, knet, esm, or plain columns",
        1,
    )


def _points(lines: list[str]) -> list[str]:
    """The lines with decimal points where the file writes decimal commas: by its first lines of numbers."""
    sample = list(islice((line for line in lines if re.match(r"\s*[-+]?[\d.,]", line)), 20))
    words = [re.split(r"[;\s]+", line.strip().rstrip(";")) for line in sample]
    shown = [word for row in words for word in row if word]
    commas = [word for word in shown if _DECIMAL_COMMA.match(word)]
    separated = any(len([word for word in row if word]) > 1 for row in words)
    if not commas or not separated or any("." in word for word in shown) or any(word.endswith(",") for word in shown):
        return lines
    return [line if line.lstrip()[:1] in ("#", "%", "!") else re.sub(r"(?<=\d),(?=\d)", ".", line) for line in lines]


def _above(text: Text, start: int) -> list[tuple[int, str]]:
    """Header lines with their indices, the nearest first, without the sign of a comment."""
    top = range(max(0, start - _TOP), start)
    return [(index, text.lines[index].strip().lstrip("#%! ")) for index in reversed(top) if text.lines[index].strip()]


def _headings(text: Text, start: int, width: int) -> list[str]:
    """What stands over the columns, one text each; empty texts where nothing does."""
    above = _above(text, start)
    return _cells(above[0][1], width) if above else [""] * width


def _cells(line: str, width: int) -> list[str]:
    """A header line as one text a column; empty texts where it is none of headings."""
    for separator in (";", "\t", ","):
        parts = [part.strip() for part in line.split(separator)]
        if len(parts) == width > 1:
            return parts
    found = _WORD.findall(line)
    if len(found) == width or (width == 1 and _BRACKETS.search(line)):
        return found if len(found) == width else [line]
    return [""] * width


def _unit(text: Text, start: int, width: int, place: int) -> tuple[str | None, int, str]:
    """The unit of a column as the file states it, the line that does, and a heading from which none can be read.

    Raises `InputError` where the file says that it holds something else.
    """
    if "unit" in text.header:
        said = (i for i, words in enumerate(text.lines, 1) if re.match(r"\s*[#%!]\s*unit\s*[:=]", words, re.IGNORECASE))
        where = next(said, 1)
        return _sound(text, text.header["unit"], where), where, ""
    above = _above(text, start)
    headings = [(index, cells[place]) for index, words in above[:_ROWS_OF_HEADINGS] if (cells := _cells(words, width))]
    for index, heading in headings:
        if unit := _unit_in(heading):
            return unit, index + 1, ""
    for index, heading in headings[:1]:
        for words in (heading, *_BRACKETS.findall(heading), *_PARTS.split(heading)[1:]):
            if quantity_of(words) in ("velocity", "displacement", "counts"):
                return _sound(text, words, index + 1), index + 1, ""
    for index, words in above:
        found = _IN_UNITS.search(one_blank(words))
        if found and quantity_of(found[1]):
            return _sound(text, found[1], index + 1), index + 1, ""
        if unit := _unit_in_text(words):
            return unit, index + 1, ""
    unclear = headings[0][1] if headings and _TIME.match(_cells(above[0][1], width)[0]) else ""
    bracketed = (words for _, words in above if _ACCELERATION.search(words) and _BRACKETS.search(words))
    unclear = unclear or next((words for words in bracketed if not _PEAK.search(words)), "")
    return None, 0, "" if _ONLY_ACCELERATION.fullmatch(unclear) else unclear[:60]


def _unit_in(heading: str) -> str | None:
    """The unit of acceleration that a heading states: `m/s2`, `a [m/s^2]`, `Accel, mg`, `acc in gal`, `acc_g`."""
    plain = _BRACKETS.sub(" ", heading)
    parts = [plain, *_PARTS.split(plain)]
    parts += [piece for part in parts for piece in _BEFORE_UNIT.split(part)[1:]]
    parts += [_NAME.sub("", part) for part in parts]
    words = [*_BRACKETS.findall(heading), *parts, *(part.replace("_", "/") for part in parts)]
    words += [re.split(r"[\s_]", part.strip())[-1] for part in parts]
    return next((word.strip() for word in words if acceleration_unit(word) is not None), None)


def _unit_in_text(line: str) -> str | None:
    """The unit of acceleration that a line of words states: `Acceleration (cm/s/s)`, `ACCELERATION IN G AT 50 HZ`, or
    the unit alone. A line that gives a peak speaks of that number."""
    if acceleration_unit(line) is not None:
        return line.strip()
    named = _ACCELERATION.search(line)
    if not named or _PEAK.search(line):
        return None
    rest = line[named.end() :]
    words = [*_BRACKETS.findall(rest), *_PARTS.split(rest), *_PARTS.split(_BRACKETS.sub(" ", rest))]
    words += [piece.split()[0] for piece in _BEFORE_UNIT.split(rest)[1:] if piece.split()]
    found = (word.strip() for word in words if acceleration_unit(word) is not None)
    return next((word for word in found if not word[0].isdigit()), None)


def _sound(text: Text, unit: str, line: int) -> str:
    quantity = quantity_of(unit)
    if quantity in ("velocity", "displacement"):
        raise text.wrong_quantity(quantity, line)
    if quantity == "":
        raise text.refuse(f"unknown unit '{unit}' of acceleration", "write e.g. g, m/s2, cm/s2 or gal", line)
    return unit


def _in_milliseconds(text: Text, start: int, width: int) -> bool:
    """Whether the headings say so of the times."""
    cells = [_cells(words, width)[0] for _, words in _above(text, start)[:_ROWS_OF_HEADINGS]]
    words = [word.lower() for cell in cells for word in (*_BRACKETS.findall(cell), re.split(r"[\s,_/]", cell)[-1])]
    return any(word.strip() in ("ms", "msec", "msecs", "milliseconds") for word in words)


def _stated_step(text: Text, start: int) -> tuple[str | None, int]:
    if "dt" in text.header:
        return re.sub(r"\s*s(?:ec)?\s*\Z", "", text.header["dt"]), 1
    for index, line in _above(text, start):
        found = _STEP.search(line)
        if found and number(found[1]):
            return str(float(found[1]) / 1000.0) if found[2] else found[1], index + 1
    return None, 0


def _decimals(line: str) -> int:
    """Decimals of the first number on a line; 15 where it has an exponent."""
    first = tokens(line)[0]
    if re.search(r"[EeDd]", first):
        return 15
    return len(first.partition(".")[2])
