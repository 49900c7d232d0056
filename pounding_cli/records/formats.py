"""The file formats of the strong-motion networks, one function each, and plain columns.

Each returns the samples of a file, or None of another format, and raises `InputError` for a file of its format that is
damaged, holds no acceleration, or several channels and none was named.
"""

from __future__ import annotations

import re
from itertools import chain, islice

import numpy as np

from pounding_cli.numbers import counted
from pounding_cli.records.text import Samples, Text, number, tokens
from pounding_cli.records.units import BRACKETS, acceleration_unit, quantity_of, unit_in

_COSMOS = re.compile(r"(?i)\( ?format v ?[\d.]+(?: with (\d{1,3}) text lines)?")
_COSMOS_LABEL = r"sta chan? ?:? ?(.*?) ?(?:\(|location|\Z)"
_COSMOS_DATA = re.compile(
    r"(?i)\A(\d{1,9}) (\w+) (?:data )?(?:pts|points).*?units? ?= ?([^,(]+?) ?(?:\( ?\d+ ?\))? ?,.*?(format.*)"
)
_CSMIP = re.compile(r"\s*(UN|R)?(?:CORRECTED\s+ACCELEROGRAM|ESPONSE\s+AND\s+FOURIER)")
_CSMIP_LABEL = re.compile(r"(?i)\bchan(?:nel)? ?(\d+ ?: ?.+)")
_CSMIP_DATA = re.compile(r"(?i)\A(\d{1,9}) points of (?:\w+ )?(accel|veloc|displ)\w* .*?at (\d*\.?\d+) ?sec(.*)")
_SMC = re.compile(r"\s*\d\s+((?:UN)?CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE|FOURIER)")


def at2(text: Text) -> Samples | None:
    """PEER NGA: one component; count and time step on the fourth line (older files: `5437 0.0100 NPTS, DT`).

    Chiou, Darragh, Gregor and Silva (2008), NGA project strong-motion database, Earthquake Spectra 24(1), 23-44.
    """
    size, line = text.search(r"NPTS ?=? ?(\d{1,9}) ?,? ?DT ?=? ?([-+.\dE]+)", range(8))
    if size is None:
        size, line = text.search(r"^(\d{1,9}) ([-+.\dE]+) NPTS", range(8))
    if size is None:
        return None
    other, place = text.search("(velocity|displacement) time (?:series|history)", range(line - 1))
    if other:
        raise text.wrong_quantity(other[1].lower(), place)
    unit, unit_line = text.search(r"in units? of ([^\s,;]+)", range(line - 1))
    step = text.step(size[2], line)
    values, start = text.values(line)
    text.check_count(size[1], len(values), line)
    return Samples(step, values, start, unit[1] if unit else None, unit_line)


def knet(text: Text) -> Samples | None:
    """K-NET and KiK-net: seventeen lines `key value`, then counts with the scale that makes them gal.

    The counts carry the recorder's offset; as in the file's own `Max. Acc. (gal)`, the acceleration is what remains
    without the mean of the whole record (NIED, https://www.kyoshin.bosai.go.jp/kyoshin/man/knetform_en.html).
    """
    header = range(text.first, text.first + 17)
    if not text.lines[header.start].startswith("Origin Time"):
        return None
    rate, line = text.find(r"^Sampling Freq\S* ([1-9][\d.]*)", header, "Sampling Freq(Hz), e.g. 100Hz")
    step = text.step(1.0 / float(rate[1]), line)
    scale = r"^Scale Factor ([\d.]+) ?\( ?gal ?\) ?/ ?([1-9][\d.]*)"
    gal, scale_line = text.find(scale, header, "Scale Factor, e.g. 3920(gal)/6182761: its counts have no unit")
    counts, start = text.values(header.stop)
    duration, line = text.find(r"^Duration Time\S* (\d[\d.]*)", header, "Duration Time(s), e.g. 60")
    text.check_count(f"{float(duration[1]) * float(rate[1]):.0f}", len(counts), line, "duration x frequency")
    mean, one = sum(counts) / len(counts), float(gal[1]) / float(gal[2])
    values = [(each - mean) * one for each in counts]
    _check_peak(text, values, r"^Max\. Acc\S*(?: \(gal\))? (\S+)", header, "gal")
    return Samples(step, values, start, "gal", scale_line)


def esm(text: Text) -> Samples | None:
    """ESM and ITACA: the DYNA file, lines `KEY: value` (64 in DYNA 1.2), then one value a line.

    Luzi et al. (2016), The Engineering Strong-Motion Database, Seismological Research Letters 87(4), 987-997.
    """
    first = end = text.first
    if not text.lines[first].startswith("EVENT_NAME:"):
        return None
    while re.match(r"[A-Z][A-Z0-9_/^]*\s*:", text.line(end)):
        end += 1
    keys = ("SAMPLING_INTERVAL_S", "DATA_TYPE", "UNITS", "NDATA")
    said = [text.find(rf"^{key}: ?(\S+)", range(first, end), key) for key in keys]
    (interval, line), (kind, kind_line), (unit, unit_line), (count, count_line) = ((each[1], at) for each, at in said)
    step = text.step(interval, line)
    if not kind.upper().startswith("ACC"):
        raise text.wrong_quantity(kind.lower(), kind_line)
    values, start = text.values(end)
    text.check_count(count, len(values), count_line, "NDATA")
    if unit.startswith("cm"):
        _check_peak(text, values, r"^PGA_CM/S\^2: ?(\S+)", range(first, end), "cm/s2")
    return Samples(step, values, start, unit, unit_line)


def smc(text: Text) -> Samples | None:
    """SMC of the USGS: 11 lines of text, 48 integers (8I10), 50 reals (5E15.7), comments, samples in cm/s2.

    National Strong-Motion Program, https://escweb.wr.usgs.gov/nsmp-data/smcfmt.html.
    """
    place = text.first + 11
    kind = _SMC.match(text.lines[text.first].upper())
    if kind is None:
        return None
    if not kind[1].endswith("ACCELEROGRAM"):
        quantity = f"{kind[1].lower()} spectra" if kind[1] in ("RESPONSE", "FOURIER") else kind[1].lower()
        raise text.wrong_quantity(quantity, text.first + 1)
    integers, after = text.fixed(place, 48, "(8I10)")
    (unknown, rate, *_), start = text.fixed(after, 50, "(5E15.7)")
    if rate == unknown or rate <= 0:
        hint = "download the corrected record ('2 CORRECTED ACCELEROGRAM')"
        raise text.refuse("the header gives no sampling rate: the samples are not evenly spaced", hint, after + 1)
    step = text.step(float(f"{1.0 / rate:.9g}"), after + 1)
    comments, count, faulty = map(int, integers[15:18])
    if faulty == 1:
        hint = "read its comments; set the second integer of the third integer line to 0 if you judge it sound"
        raise text.refuse("the record is flagged as faulty", hint, place + 3)
    if not (0 <= comments < len(text.lines) and 0 < count < 10**9):
        raise text.damaged(f"the header says {comments} comments and {count} samples", place + 2)
    values, _ = text.fixed(start + comments, count, "(8F10)", last=True)
    return Samples(step, values, start + comments + 1, "cm/s2")


def cosmos(text: Text) -> Samples | None:
    """COSMOS V1 and V2: for every channel text, integers, reals, comments and samples, each with its own size.

    Consortium of Organizations for Strong-Motion Observation Systems (2001), COSMOS Strong Motion Data Format, 1.20.
    """
    index, found, others = text.first, dict[int, tuple[str, float, re.Match[str]]](), list[tuple[str, int]]()
    if not _COSMOS.search(text.words(index)):
        return None
    while index < len(text.lines):
        if begins := _COSMOS.search(text.words(index)):
            words = range(index, index + int(begins[1] or 13))
            named, _ = text.search(_COSMOS_LABEL, words)
            index, step, data = _cosmos_header(text, words.stop)
            if quantity_of(data[2])[0] == "acceleration":
                found[index] = (named[1] if named else "") or "unnamed", step, data
            else:
                others.append((data[2].lower(), index))
        index += 1
    if not found:
        raise text.wrong_quantity(*others[0])
    start = _chosen(text, {at: name for at, (name, *_) in found.items()}, min(found))
    _, step, data = found[start]
    values, _ = text.fixed(start, int(data[1]), data[4], last=True)
    return Samples(text.step(step, start), values, start + 1, data[3], start)


def _cosmos_header(text: Text, index: int) -> tuple[int, float, re.Match[str]]:
    """Index of the first sample behind a channel's words, its time step [s], and what its data line says: number,
    quantity and unit of the samples, and their Fortran format. Every part stands where the one before it ends."""
    values: list[float] = []
    for kind in ("integer", "real"):
        example = f"how many {kind} header values follow, e.g. 100 {kind.capitalize()}-header values (10I8)"
        found, _ = text.find(rf"^(\d{{1,6}}) {kind}[- ]*header.*?(\(.*)", range(index, index + 1), example)
        values, index = text.fixed(index + 1, int(found[1]), found[2])
    if comments := re.match(r"(?i)(\d{1,6}) comment", text.words(index)):
        index += 1 + int(comments[1])
    data = _COSMOS_DATA.match(text.words(index))
    if data is None:
        example = "12091 acceleration pts, approx 120 secs, units=cm/s2 (4),Format=(8F10.5)"
        raise text.damaged(f"the header does not say how many samples follow, e.g. {example}", index + 1)
    values += [-999.0] * 62  # the data's own step [ms], number 62 in the documentation, comes before the recorder's [s]
    return index + 1, float(f"{values[61] / 1000.0 if values[61] > 0 else values[33]:.9g}"), data


def csmip(text: Text) -> Samples | None:
    """CSMIP V2 of the California network, one or more channels: a line such as `4000 points of accel data equally
    spaced at .020 sec, in cm/sec2. (8f10.3)`, then the samples.

    Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, report OSMS 85-03.
    """
    kind = _CSMIP.match(text.lines[text.first].upper())
    if kind is None:
        return None
    if kind[1]:
        what = "spectra (V3)" if kind[1] == "R" else "uncorrected samples (V1)"
        raise text.refuse(f"a CSMIP file of {what}", "download the corrected record (V2)", text.first + 1)
    named, series = "unnamed", dict[int, tuple[str, re.Match[str]]]()
    for index in range(len(text.lines)):
        if label := _CSMIP_LABEL.search(text.words(index)):
            named = label[1]
        if said := _CSMIP_DATA.match(text.words(index)):
            series[index] = named, said
    if not series:
        example = "4000 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.3)"
        raise text.damaged(f"the header does not say how many points follow, e.g. {example}", text.first + 1)
    kinds = {index: quantity_of(said[2])[0] for index, (_, said) in series.items()}
    found = {index: series[index][0] for index, kind in kinds.items() if kind == "acceleration"}
    if len(found) < max(1, list(kinds.values()).count("velocity")):
        raise text.damaged("a channel holds no acceleration", min(series) + 1)
    at = _chosen(text, found, min(found) + 1)
    data = series[at][1]
    step = text.step(data[3], at + 1)
    values, _ = text.fixed(at + 1, int(data[1]), data[4], last=True)
    return Samples(step, values, at + 2, unit_in(data[4], ()) or "cm/s2", at + 1)


def _chosen(text: Text, channels: dict[int, str], line: int) -> int:
    """Index, in the file, of the channel asked for, of those with acceleration by name; refused where there are several
    and none was named."""
    listed = "; ".join(f"{place}: {name}" for place, name in enumerate(channels.values(), 1))
    if text.channel is None and len(channels) > 1:
        message = f"the file holds {len(channels)} channels of acceleration: {listed}"
        hint = "select one: channel: 1 beside the file in a study, or --channel 1"
        raise text.refuse(message, hint, line)
    channel = 1 if text.channel is None else text.channel
    if not 1 <= channel <= len(channels):
        raise text.refuse(f"there is no channel {channel} in the file", f"write one of {listed}", line)
    return list(channels)[channel - 1]


def _check_peak(text: Text, values: list[float], pattern: str, header: range, unit: str) -> None:
    """Refuse samples whose peak is not the one that the header states, to 2 % and the last digit of what is printed."""
    said, line = text.search(pattern, header)
    stated, peak = abs(number(said[1]) or 0.0) if said else 0.0, max(map(abs, values))
    if stated and abs(peak - stated) > 0.02 * stated + 0.01:
        raise text.damaged(f"the header says a peak of {stated:g} {unit}, but the samples reach {peak:.6g}", line)


NETWORKS = {"at2": at2, "cosmos": cosmos, "csmip": csmip, "smc": smc, "knet": knet, "esm": esm}
"""The formats of the networks by name."""


# Plain columns: time and acceleration, one column of a table, or values with a time step beside them. Blanks, tabs,
# commas or semicolons part them, with a comma as decimal sign where the file shows it. Above them may stand headings
# with units (`t [s]; a [cm/s2]`), comments behind `#`, `%` or `!`, and lines `# dt:`, `# unit:`.

COLUMNS = ("two-column", "column", "table")
"""The plain formats, which need not state a unit: g is taken."""

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
        wanted = f"write 1 to {columns}: column: 2 beside the file, or --column 2"
        raise text.refuse(what, wanted if columns > 1 else "leave 'column' out", start + 1)
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
    spoken = (words for _, words in above if _ACCELERATION.search(words) and BRACKETS.search(words))
    named = next((words for _, words in headings if words and _TIME.match(above[0][1])), "")
    unclear = named or next((words for words in spoken if not _PEAK.search(words)), "")
    return None, 0, "" if _ONLY_ACCELERATION.fullmatch(unclear) else unclear[:60]


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
