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
from pounding_cli.records.units import quantity_of

_BRACKETS = re.compile(r"[(\[]([^()\[\]]*)[)\]]")
_WORD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^()\[\]]*[)\]])?")
_IN_UNITS = re.compile(r"\bunits?\b\s*(?:of|are|is|in|:|=)?\s*[:=]?\s*([^\s,;)\]]+)", re.IGNORECASE)
_STEP = re.compile(
    r"\b(?:dt|time[ _-]?step|delta[ _-]?t|sampling[ _-]?interval)\b[^\d.+-]{0,12}([\d.]+(?:e[-+]?\d+)?)\s*(ms)?",
    re.IGNORECASE,
)

_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[EeDd][-+]?\d+)?\Z")
_TOP = 60
# Lines of a header searched for units and a time step.


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
    unit, unit_line = _unit(text, start, 1, 0)
    return Samples(step, values, start + 1, unit, unit_line)


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
    unit, unit_line = _unit(text, start, width, place)
    values = [row[place] for _, row in rows]
    times = [row[0] for _, row in rows]
    rising = all(one < other for one, other in pairwise(times))
    if asked.dt is not None and (place == 0 or not rising) and wanted is None:
        return Samples(text.step(asked.dt, 0), values, start + 1, unit, unit_line)
    if place == 0:
        raise text.refuse(
            "column 1 is the time, unless dt is given", "write the acceleration's column, or give dt", start + 1
        )
    scale = 1e-3 if _time_unit(text, start, width) == "ms" else 1.0
    decimals = max(_decimals(text.lines[index]) for index, _ in rows[: min(len(rows), 1000)])
    step = even_step(
        text, [time * scale for time in times], [index for index, _ in rows], asked.dt,
        digits=decimals if scale == 1.0 else decimals + 3,
    )  # fmt: skip
    return Samples(step, values, start + 1, unit, unit_line)


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
    if above:
        line = above[0][1]
        for separator in (";", "\t", ","):
            parts = [part.strip() for part in line.split(separator)]
            if len(parts) == width > 1:
                return parts
        found = _WORD.findall(line)
        if len(found) == width or (width == 1 and _BRACKETS.search(line)):
            return found if len(found) == width else [line]
    return [""] * width


def _unit(text: Text, start: int, width: int, place: int) -> tuple[str | None, int]:
    """The unit of a column as the file states it, and the line that does.

    Raises `InputError` where the file says that it holds something else.
    """
    if "unit" in text.header:
        said = (i for i, words in enumerate(text.lines, 1) if re.match(r"\s*[#%!]\s*unit\s*[:=]", words, re.IGNORECASE))
        where = next(said, 1)
        return _sound(text, text.header["unit"], where), where
    above = _above(text, start)
    heading = _headings(text, start, width)[place]
    if heading:
        bracket = _BRACKETS.search(heading)
        if bracket and quantity_of(bracket[1]):
            return _sound(text, bracket[1], above[0][0] + 1), above[0][0] + 1
        if quantity_of(heading) in ("velocity", "displacement", "counts"):
            return _sound(text, heading, above[0][0] + 1), above[0][0] + 1
    for index, words in above:
        found = _IN_UNITS.search(one_blank(words))
        if found and quantity_of(found[1]):
            return _sound(text, found[1], index + 1), index + 1
    return None, 0


def _sound(text: Text, unit: str, line: int) -> str:
    quantity = quantity_of(unit)
    if quantity in ("velocity", "displacement"):
        raise text.wrong_quantity(quantity, line)
    if quantity == "":
        raise text.refuse(f"unknown unit '{unit}' of acceleration", "write e.g. g, m/s2, cm/s2 or gal", line)
    return unit


def _time_unit(text: Text, start: int, width: int) -> str:
    found = _BRACKETS.search(_headings(text, start, width)[0])
    return found[1].strip().lower() if found else ""


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
