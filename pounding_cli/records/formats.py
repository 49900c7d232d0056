"""The file formats of the strong-motion networks, one function each: the samples of a file, or None of another format.

Each raises `InputError` for a file of its format that is damaged, holds no acceleration, or several channels and none
was named.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

from pounding_cli.records.text import Asked, Samples, Text, fortran, number
from pounding_cli.records.units import quantity_of

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
    """CSMIP V1 and V2 of the California network, one or more channels.

    V2: a line such as `4000 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.3)`, then the samples.
    V1: 13 lines of text, 100 integers (16I5), 50 reals (8F10.3), then times and samples in turns (10F7), or samples
    behind a line such as `13200 Accelerogram points at 200 pts/sec in units of g. Format: (8f9.6)`.
    Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, report OSMS 85-03.
    """
    start = text.first
    kind = re.match(r"\s*(UN|R)?(?:CORRECTED\s+ACCELEROGRAM|ESPONSE\s+AND\s+FOURIER)", text.lines[start].upper())
    if kind is None:
        return None
    if kind[1] == "R":
        raise text.wrong_quantity("spectra (V3)", start + 1)
    ends = [index for index, line in enumerate(text.lines) if re.search(r"(?i)END\s+OF\s+DATA\s+FOR\s+CHAN", line)]
    channels = {}
    for begin, end in zip([start, *(end + 1 for end in ends)], [*ends, len(text.lines)], strict=True):
        filled = [index for index in range(begin, end) if text.lines[index].strip(" \t\x1a")]
        named = (re.search(r"(?i)\bCHAN(?:NEL)?\s*(\d+\s*:\s*\S+(?:\s\S+)*)", text.lines[each]) for each in filled[:26])
        if filled:
            channels[filled[0], end] = next((_one_blank(found[1]) for found in named if found), "unnamed")
    begin, end = list(channels)[text.channel(asked, list(channels.values()), start + 1)]
    if kind[1]:
        return _csmip_v1(text, asked, begin)
    for index in range(begin, end):
        line = text.lines[index]
        data, spaced = _CSMIP_DATA.match(line), _CSMIP_SPACED.search(line)
        if not data or not spaced:  # a line of the header may speak of the points too, without their spacing
            continue
        if data[2].lower() != "accel":
            raise text.wrong_quantity({"v": "velocity", "d": "displacement"}[data[2][0].lower()], index + 1)
        step = text.step(spaced[1], index + 1, asked.dt)
        values, _ = text.fixed(index + 1, int(data[1]), fortran(line) or (8, 10), last=True)
        return Samples(step, values, index + 2, _csmip_unit(line[spaced.end() :]) or "cm/s2", index + 1)
    hint = "a CSMIP V2 file has e.g. '4000 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.3)'"
    message = "no line that says how many points of acceleration follow, and their spacing"
    raise text.refuse(message, hint, begin + 1)


def _csmip_v1(text: Text, asked: Asked, begin: int) -> Samples:
    top, data = text.lines[begin : begin + 13], begin + 27
    sizes = text.line(begin + 15)[:5], text.line(begin + 14)[55:60]  # newer files have the count of samples later
    count = int(next((size for word in sizes if (size := number(word.strip()))), 0.0))
    if count < 2:
        raise text.refuse("the header does not say how many samples follow", "download the file again", begin + 16)
    stated = ((_csmip_unit(line.lower().partition("unit")[2]), place) for place, line in enumerate(top, begin + 1))
    unit, unit_line = next((each for each in stated if each[0]), (None, 0))
    line = text.line(data)
    if not re.search(r"[A-DF-Za-df-z]", line):
        pairs, _ = text.fixed(data, 2 * count, (10, 7), last=True)
        lines = [data + place // 5 for place in range(count)]
        step = text.even_step(pairs[::2], lines, asked.dt, way_out="download the corrected record (V2)")
        return Samples(step, pairs[1::2], data + 1, unit, unit_line)
    said, spaced = _CSMIP_DATA.match(line), _CSMIP_SPACED.search(line)
    rated = re.search(r"(?i)at\s+(\d+\.?\d*)\s*(?:pts|points|samples)\s*/\s*sec", line)
    rate = number(rated[1]) if rated else None
    written = spaced[1] if spaced else float(f"{1.0 / rate:.9g}") if rate else asked.dt
    step = text.step(written or "not stated: give dt", data + 1, asked.dt)
    own = _csmip_unit(line[spaced.end() :] if spaced else line)
    values, _ = text.fixed(data + 1, int(said[1]) if said else count, fortran(line) or (8, 9), last=True)
    return Samples(step, values, data + 2, own or unit, data + 1 if own else unit_line)


def _csmip_unit(words: str) -> str | None:
    return next((unit for unit, pattern in _CSMIP_UNITS.items() if re.search(pattern, words, re.IGNORECASE)), None)


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
