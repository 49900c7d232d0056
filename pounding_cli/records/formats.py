"""The file formats, one function each.

Those of the strong-motion networks return the samples of a file, or None of another format, and raise `InputError` for
a file of their format that is damaged, holds no acceleration, or several channels and none was named.

Plain text has time and acceleration in two columns, a column of a table, or values with a time step beside them; with
any separator (blanks, tabs, commas, semicolons; a comma as decimal sign where the file shows it), headings with units
(`t [s]; a [cm/s2]`), comments behind `#`, `%` or `!`, and `# dt:`, `# unit:`, `# name:` lines.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import islice, pairwise
from typing import NamedTuple

from pounding_cli.numbers import counted
from pounding_cli.records.text import Asked, Samples, Text, fortran, number, tokens
from pounding_cli.records.units import acceleration_unit, quantity_of

_CSMIP_DATA = re.compile(r"(?i)\s*(\d{1,9})\s+points\s+of\s+(?:\w+\s+)?(accel|veloc|displ)\w*")
_CSMIP_SPACED = re.compile(r"(?i)(?:spaced\s+at|at)\s+(\d*\.?\d+)\s*sec")
_CSMIP_UNITS = {
    "g/10": r"g\s*/\s*10",
    "cm/s2": r"cm\s*/\s*s(?:ec)?(?:\s*/\s*s(?:ec)?|\s*\*\*\s*2|\^?2)",
    "gal": r"\bgals?\b",
    "g": r"\bg\b",
}
_COSMOS_FIRST = re.compile(r"(?i)\(\s*format\s+v\s*[\d.]+")
_COSMOS_DATA = re.compile(
    r"(?i)\s*(\d{1,9}) (\w+) (?:data )?(?:pts|points).*?units? ?= ?([^,(]+?) ?(?:\( ?\d+ ?\))? ?,.*?(format.*)"
)


class _Series(NamedTuple):
    """One series of a COSMOS file: what its data line says, and where its samples begin (index)."""

    quantity: str
    unit: str
    size: int
    columns: tuple[int, int]
    channel: str
    step: float
    start: int


def at2(text: Text, asked: Asked) -> Samples | None:
    """PEER NGA: one component; count and time step on the fourth line (older files: `5437 0.0100 NPTS, DT`).

    Chiou, Darragh, Gregor and Silva (2008), NGA project strong-motion database, Earthquake Spectra 24(1), 23-44.
    """
    newer, older = r"(?i)NPTS\s*=?\s*(\d{1,9})\s*,?\s*DT\s*=?\s*([-+.\dE]+)", r"(?i)\s*(\d{1,9})\s+([-+.\dE]+)\s+NPTS"
    sizes = enumerate((re.search(newer, line) or re.match(older, line) for line in text.lines[:8]), 1)
    line, size = next(((line, size) for line, size in sizes if size), (0, None))
    if size is None:
        return None
    unit, unit_line = None, 0
    for place, words in enumerate(text.lines[: line - 1], 1):
        if other := re.search(r"(?i)(VELOCITY|DISPLACEMENT)\s+TIME\s+(?:SERIES|HISTORY)", words):
            raise text.wrong_quantity(other[1].lower(), place)
        if found := re.search(r"(?i)IN\s+UNITS?\s+OF\s+(\S+)", words):
            unit, unit_line = found[1].rstrip(",;"), place
    step = text.step(size[2], line, asked.dt)
    values, start = text.values(line)
    text.count(size[1], len(values), line)
    return Samples(step, values, start, unit, unit_line)


def knet(text: Text, asked: Asked) -> Samples | None:
    """K-NET and KiK-net: seventeen lines `key value`, then counts with the scale that makes them gal.

    The counts carry the recorder's offset; as in the file's own `Max. Acc. (gal)`, the acceleration is what remains
    without the mean of the whole record (NIED, https://www.kyoshin.bosai.go.jp/kyoshin/man/knetform_en.html).
    """
    head = text.lines[text.first : text.first + 17]
    keys = {
        line[:18].partition("(")[0].strip(" ."): (line[18:].strip(), place)
        for place, line in enumerate(head, text.first + 1)
    }
    if not head[0].startswith("Origin Time") or "Sampling Freq" not in keys:
        return None
    frequency, line = _said(text, keys, "Sampling Freq", "100Hz")
    rate = number(frequency.lower().removesuffix("hz").strip())
    if not rate or rate < 0:
        raise text.refuse(f"the sampling frequency is '{frequency}'", "write e.g. Sampling Freq(Hz) 100Hz", line)
    step = text.step(1.0 / rate, line, asked.dt)
    scale, scale_line = _said(text, keys, "Scale Factor", "3920(gal)/6182761")
    gal, count = (
        map(number, found.groups())
        if (found := re.fullmatch(r"(\S+?) *\( *gal *\) */ *(\S+)", scale))
        else (None, None)
    )
    if not gal or not count:
        hint = "write gal over counts, e.g. Scale Factor 3920(gal)/6182761"
        raise text.refuse(f"the scale factor is '{scale}': the counts have no unit", hint, scale_line)
    counts, start = text.values(text.first + 17)
    duration, line = _said(text, keys, "Duration Time", "60")
    wanted = f"{(number(duration) or 0.0) * rate:.0f}"
    text.count(wanted, len(counts), line, "duration x frequency")
    mean = sum(counts) / len(counts)
    values = [(each - mean) * (gal / count) for each in counts]
    _check_peak(text, values, keys.get("Max. Acc"), "gal", 0.01)  # it is printed with three decimals
    return Samples(step, values, start, "gal", scale_line)


def esm(text: Text, asked: Asked) -> Samples | None:
    """ESM and ITACA: the DYNA file, lines `KEY: value` (64 in DYNA 1.2), then one value a line.

    Luzi et al. (2016), The Engineering Strong-Motion Database, Seismological Research Letters 87(4), 987-997.
    """
    if not text.lines[text.first].startswith("EVENT_NAME:"):
        return None
    found = {
        place: re.match(r"([A-Z][A-Z0-9_/^]*)\s*:\s?(.*)", line.rstrip())
        for place, line in enumerate(text.lines, 1)
        if line.strip()
    }
    end = next((place for place, this in found.items() if this is None), len(text.lines)) - 1
    keys = {this[1]: (this[2], place) for place, this in found.items() if this and place <= end}
    interval, line = _said(text, keys, "SAMPLING_INTERVAL_S", "0.005")
    step = text.step(interval, line, asked.dt)
    kind, line = keys.get("DATA_TYPE", ("ACCELERATION", 0))
    if not kind.upper().startswith("ACC"):
        raise text.wrong_quantity(kind.lower() or "no named quantity", line)
    unit, unit_line = _said(text, keys, "UNITS", "cm/s^2")
    count, line = _said(text, keys, "NDATA", "12000")
    values, start = text.values(end)
    text.count(count, len(values), line, "NDATA")
    _check_peak(text, values, keys.get("PGA_CM/S^2") if unit.startswith("cm") else None, "cm/s2")
    return Samples(step, values, start, unit, unit_line)


def smc(text: Text, asked: Asked) -> Samples | None:
    """SMC of the USGS: 11 lines of text, 48 integers (8I10), 50 reals (5E15.7), comments, samples in cm/s2.

    National Strong-Motion Program, https://escweb.wr.usgs.gov/nsmp-data/smcfmt.html.
    """
    first = text.first
    kinds = r"\s*\d\s+((?:UN)?CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE|FOURIER)"
    kind = re.match(kinds, text.lines[first].upper())
    if kind is None:
        return None
    if not kind[1].endswith("ACCELEROGRAM"):
        spectra = {"RESPONSE": "response spectra", "FOURIER": "Fourier spectra"}
        raise text.wrong_quantity(spectra.get(kind[1], kind[1].lower()), first + 1)
    place = first + 11
    integers, after = text.fixed(place, 48, (8, 10))
    reals, start = text.fixed(after, 50, (5, 15))
    unknown, rate = reals[:2]
    if rate == unknown or rate <= 0:
        hint = "download the corrected record ('2 CORRECTED ACCELEROGRAM')"
        raise text.refuse("the header gives no sampling rate: the samples are not evenly spaced", hint, after + 1)
    step = text.step(float(f"{1.0 / rate:.9g}"), after + 1, asked.dt)
    comments, count, faulty = map(int, integers[15:18])
    if faulty == 1:
        hint = "read its comments; set the second integer of the third integer line to 0 if you judge it sound"
        raise text.refuse("the record is flagged as faulty", hint, place + 3)
    if not (0 <= comments < len(text.lines) and 0 < count < 10**9):
        message = f"the header says {comments} comments and {count} samples"
        raise text.refuse(message, "download the file again", place + 2)
    values, _ = text.fixed(start + comments, count, (8, 10), last=True)
    return Samples(step, values, start + comments + 1, "cm/s2")


def cosmos(text: Text, asked: Asked) -> Samples | None:
    """COSMOS V1 and V2: for every channel text, integers, reals, comments and samples, each with its own size.

    Consortium of Organizations for Strong-Motion Observation Systems (2001), COSMOS Strong Motion Data Format, 1.20.
    """
    index = text.first
    if not _COSMOS_FIRST.search(text.lines[index]):
        return None
    series = []
    while index < len(text.lines):
        if _COSMOS_FIRST.search(text.lines[index]):
            series.append(_cosmos_series(text, index))
            index = series[-1].start
        index += 1
    found = [each for each in series if quantity_of(each.quantity) == "acceleration"]
    if not found:
        raise text.wrong_quantity(series[0].quantity, series[0].start)
    chosen = found[text.channel(asked, [each.channel for each in found], found[0].start)]
    step = text.step(chosen.step, chosen.start, asked.dt)
    values, _ = text.fixed(chosen.start, chosen.size, chosen.columns, last=True)
    return Samples(step, values, chosen.start + 1, chosen.unit, chosen.start)


def _cosmos_series(text: Text, index: int) -> _Series:
    size = re.search(r"(?i)with\s+(\d{1,3})\s+text\s+lines", text.lines[index])
    top = text.lines[index : index + (int(size[1]) if size else 13)]
    named = (re.search(r"(?i)sta chan? ?:? ?(.*?) ?(?:\(|location|\Z)", _one_blank(line)) for line in top)
    _, index = _cosmos_header(text, index + len(top), "integer")
    reals, index = _cosmos_header(text, index, "real")
    if comments := re.match(r"(?i)\s*(\d{1,6})\s+comment", text.line(index)):
        index += 1 + int(comments[1])
    data = _COSMOS_DATA.match(_one_blank(text.line(index)))
    columns = fortran(data[4]) if data else None
    if not data or columns is None:
        example = "12091 acceleration pts, approx 120 secs, units=cm/s2 (4),Format=(8F10.5)"
        message = "no line that says how many samples follow, in which unit and format"
        raise text.refuse(message, f"a COSMOS file has e.g. '{example}'", index + 1)
    reals += [-999.0] * 62  # the data's own step [ms], number 62 in the documentation, comes before the recorder's [s]
    step = float(f"{reals[61] / 1000.0 if reals[61] > 0 else reals[33]:.9g}")
    channel = next((found[1] for found in named if found), "") or "unnamed"
    return _Series(data[2].lower(), data[3], int(data[1]), columns, channel, step, index + 1)


def _cosmos_header(text: Text, index: int, kind: str) -> tuple[list[float], int]:
    line = text.line(index)
    found, columns = re.match(rf"(?i)\s*(\d{{1,6}})\s+{kind}[- ]*header", line), fortran(line)
    if not found or columns is None:
        example = f"100 {kind.capitalize()}-header values follow on 10 lines, Format= (10I8)"
        message = f"no line that says how many {kind} header values follow"
        raise text.refuse(message, f"a COSMOS file has e.g. '{example}' here", index + 1)
    return text.fixed(index + 1, int(found[1]), columns)


def csmip(text: Text, asked: Asked) -> Samples | None:
    """CSMIP V2 of the California network, one or more channels: a line such as `4000 points of accel data equally
    spaced at .020 sec, in cm/sec2. (8f10.3)`, then the samples.

    Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, report OSMS 85-03.
    """
    start = text.first
    kind = re.match(r"\s*(UN|R)?(?:CORRECTED\s+ACCELEROGRAM|ESPONSE\s+AND\s+FOURIER)", text.lines[start].upper())
    if kind is None:
        return None
    if kind[1] == "R":
        raise text.wrong_quantity("spectra (V3)", start + 1)
    if kind[1]:
        message = "an uncorrected CSMIP record (V1)"
        raise text.refuse(message, "download the corrected record (V2)", start + 1)
    ends = [index for index, line in enumerate(text.lines) if re.search(r"(?i)END\s+OF\s+DATA\s+FOR\s+CHAN", line)]
    channels = {}
    for begin, end in zip([start, *(end + 1 for end in ends)], [*ends, len(text.lines)], strict=True):
        filled = [index for index in range(begin, end) if text.lines[index].strip(" \t\x1a")]
        named = (re.search(r"(?i)\bCHAN(?:NEL)?\s*(\d+\s*:\s*\S+(?:\s\S+)*)", text.lines[each]) for each in filled[:26])
        if filled:
            channels[filled[0], end] = next((_one_blank(found[1]) for found in named if found), "unnamed")
    begin, end = list(channels)[text.channel(asked, list(channels.values()), start + 1)]
    for index in range(begin, end):
        line = text.lines[index]
        data, spaced = _CSMIP_DATA.match(line), _CSMIP_SPACED.search(line)
        if not data or not spaced:  # a line of the header may speak of the points too, without their spacing
            continue
        if data[2].lower() != "accel":
            raise text.wrong_quantity({"v": "velocity", "d": "displacement"}[data[2][0].lower()], index + 1)
        step = text.step(spaced[1], index + 1, asked.dt)
        values, _ = text.fixed(index + 1, int(data[1]), fortran(line) or (8, 10), last=True)
        words = line[spaced.end() :]
        units = (unit for unit, pattern in _CSMIP_UNITS.items() if re.search(pattern, words, re.IGNORECASE))
        return Samples(step, values, index + 2, next(units, "cm/s2"), index + 1)
    hint = "a CSMIP V2 file has e.g. '4000 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.3)'"
    message = "no line that says how many points of acceleration follow, and their spacing"
    raise text.refuse(message, hint, begin + 1)


def _said(text: Text, keys: Mapping[str, tuple[str, int]], key: str, example: str) -> tuple[str, int]:
    """What the header says of `key`, and the line that does; refused where it says nothing."""
    value, line = keys.get(key, ("", text.first + 1))
    if not value:
        raise text.refuse(f"the header does not say {key}", f"write e.g. {example}", line)
    return value, line


def _check_peak(text: Text, values: list[float], said: tuple[str, int] | None, unit: str, digits: float = 0.0) -> None:
    """Refuse samples whose peak is not the one that the header states, to 2 % and the `digits` it is printed with."""
    peak, stated = max(map(abs, values)), abs(number(said[0]) or 0.0) if said else 0.0
    if said and stated and abs(peak - stated) > 0.02 * stated + digits:
        message = f"the header says a peak of {stated:g} {unit}, but the samples reach {peak:.6g} {unit}"
        raise text.refuse(message, "the file is damaged, or its scale is another's: download it again", said[1])


def _one_blank(line: str) -> str:
    """A line with one blank between its words: patterns with several optional blanks need time by their power."""
    return " ".join(line.split())


# plain columns

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
        headings = ", ".join(
            f"{place}: {words}" for place, words in enumerate(_cells(above[0][1], width) if above else [], 1) if words
        )
        shown = f" ({headings})" if headings else ""
        hint = f"select one: column: 2 beside the file in a study, or --column 2; {_ROW_BY_ROW}"
        raise text.refuse(f"{width} values on a line{shown}, and no column is selected", hint, start + 1)
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
