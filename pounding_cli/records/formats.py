"""The file formats of the strong-motion networks, one function each.

Each returns the samples of a file, or None of another format, and raises `InputError` for a file of its format that is
damaged, holds no acceleration, or several channels and none was named.
"""

from __future__ import annotations

import re

from pounding_cli.records.text import Samples, Text, number
from pounding_cli.records.units import quantity_of, unit_in

_AT2_NEWER = re.compile(r"(?i)NPTS\s*=?\s*(\d{1,9})\s*,?\s*DT\s*=?\s*([-+.\dE]+)")
_AT2_OLDER = re.compile(r"(?i)\s*(\d{1,9})\s+([-+.\dE]+)\s+NPTS")
_COSMOS = re.compile(r"(?i)\(\s*format\s+v\s*[\d.]+")
_COSMOS_LABEL = re.compile(r"(?i)\Asta chan? ?:? ?(.*?) ?(?:\(|location|\Z)")
_COSMOS_DATA = re.compile(
    r"(?i)\A(\d{1,9}) (\w+) (?:data )?(?:pts|points).*?units? ?= ?([^,(]+?) ?(?:\( ?\d+ ?\))? ?,.*?(format.*)"
)
_REALS = re.compile(r"(?i)\A(\d{1,6}) real[- ]*header.*?(\(.*)")
_CSMIP = re.compile(r"\s*(UN|R)?(?:CORRECTED\s+ACCELEROGRAM|ESPONSE\s+AND\s+FOURIER)")
_CSMIP_LABEL = re.compile(r"(?i)\bchan(?:nel)? ?(\d+ ?: ?.+)")
_CSMIP_DATA = re.compile(r"(?i)\A(\d{1,9}) points of (?:\w+ )?(accel|veloc|displ)\w* .*?at (\d*\.?\d+) ?sec(.*)")
_SMC = re.compile(r"\s*\d\s+((?:UN)?CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE|FOURIER)")


def at2(text: Text) -> Samples | None:
    """PEER NGA: one component; count and time step on the fourth line (older files: `5437 0.0100 NPTS, DT`).

    Chiou, Darragh, Gregor and Silva (2008), NGA project strong-motion database, Earthquake Spectra 24(1), 23-44.
    """
    sizes = enumerate((_AT2_NEWER.search(line) or _AT2_OLDER.match(line) for line in text.lines[:8]), 1)
    line, size = next(((line, size) for line, size in sizes if size), (0, None))
    if size is None:
        return None
    unit, unit_line = None, 0
    for place, words in enumerate(text.lines[: line - 1], 1):
        if other := re.search(r"(?i)(VELOCITY|DISPLACEMENT)\s+TIME\s+(?:SERIES|HISTORY)", words):
            raise text.wrong_quantity(other[1].lower(), place)
        if found := re.search(r"(?i)IN\s+UNITS?\s+OF\s+(\S+)", words):
            unit, unit_line = found[1].rstrip(",;"), place
    step = text.step(size[2], line)
    values, start = text.values(line)
    text.check_count(size[1], len(values), line)
    return Samples(step, values, start, unit, unit_line)


def knet(text: Text) -> Samples | None:
    """K-NET and KiK-net: seventeen lines `key value`, then counts with the scale that makes them gal.

    The counts carry the recorder's offset; as in the file's own `Max. Acc. (gal)`, the acceleration is what remains
    without the mean of the whole record (NIED, https://www.kyoshin.bosai.go.jp/kyoshin/man/knetform_en.html).
    """
    header = range(text.first, text.first + 17)
    if not text.lines[header.start].startswith("Origin Time"):
        return None
    rate, line = text.find(r"^Sampling Freq\S*\s+([1-9][\d.]*)", header, "Sampling Freq(Hz), e.g. 100Hz")
    step = text.step(1.0 / float(rate[1]), line)
    scale = r"^Scale Factor\s+([\d.]+) *\( *gal *\) */ *([1-9][\d.]*)"
    gal, scale_line = text.find(scale, header, "Scale Factor, e.g. 3920(gal)/6182761: its counts have no unit")
    counts, start = text.values(header.stop)
    duration, line = text.find(r"^Duration Time\S*\s+(\d[\d.]*)", header, "Duration Time(s), e.g. 60")
    text.check_count(f"{float(duration[1]) * float(rate[1]):.0f}", len(counts), line, "duration x frequency")
    mean, one = sum(counts) / len(counts), float(gal[1]) / float(gal[2])
    values = [(each - mean) * one for each in counts]
    _check_peak(text, values, r"^Max\. Acc\S*(?: \(gal\))?\s+(\S+)", header, "gal")
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
    said = [text.find(rf"^{key}:\s*(\S+)", range(first, end), key) for key in keys]
    (interval, line), (kind, kind_line), (unit, unit_line), (count, count_line) = ((each[1], at) for each, at in said)
    step = text.step(interval, line)
    if not kind.upper().startswith("ACC"):
        raise text.wrong_quantity(kind.lower(), kind_line)
    values, start = text.values(end)
    text.check_count(count, len(values), count_line, "NDATA")
    if unit.startswith("cm"):
        _check_peak(text, values, r"^PGA_CM/S\^2:\s*(\S+)", range(first, end), "cm/s2")
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
    if not _COSMOS.search(text.lines[text.first]):
        return None
    example = "12091 acceleration pts, approx 120 secs, units=cm/s2 (4),Format=(8F10.5)"
    at, data = _channel(text, _COSMOS_LABEL, _COSMOS_DATA, example)
    above = ((index, _REALS.match(_one_blank(text.lines[index]))) for index in range(at, -1, -1))
    reals = next(((index, found) for index, found in above if found), None)
    if reals is None:
        raise text.damaged("the header does not say its values, e.g. 100 Real-header values (5F15.6)", at + 1)
    index, found = reals
    # The data's own step [ms], number 62 in the documentation, comes before the recorder's [s].
    said = text.fixed(index + 1, int(found[1]), found[2])[0] + [-999.0] * 62
    step = text.step(float(f"{said[61] / 1000.0 if said[61] > 0 else said[33]:.9g}"), at + 1)
    values, _ = text.fixed(at + 1, int(data[1]), data[4], last=True)
    return Samples(step, values, at + 2, data[3], at + 1)


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
    example = "4000 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.3)"
    at, data = _channel(text, _CSMIP_LABEL, _CSMIP_DATA, example)
    step = text.step(data[3], at + 1)
    values, _ = text.fixed(at + 1, int(data[1]), data[4], last=True)
    return Samples(step, values, at + 2, unit_in(data[4], ()) or "cm/s2", at + 1)


def _channel(text: Text, label: re.Pattern[str], data: re.Pattern[str], example: str) -> tuple[int, re.Match[str]]:
    """Index and match of the line that says count and quantity of the samples of the channel asked for.

    Raises `InputError` where there is none, or there are several and none was named.
    """
    named, series, others = "unnamed", dict[int, tuple[str, re.Match[str]]](), list[tuple[str, int]]()
    for index, line in enumerate(map(_one_blank, text.lines)):
        if found := label.search(line):
            named = found[1] or "unnamed"
        if found := data.match(line):
            if quantity_of(found[2])[0] == "acceleration":
                series[index] = named, found
            else:
                others.append((found[2].lower(), index + 1))
    if not series and others:
        raise text.wrong_quantity(*others[0])
    if not series:
        raise text.damaged(f"the header does not say how many samples follow, e.g. {example}", text.first + 1)
    listed = "; ".join(f"{place}: {name}" for place, (name, _) in enumerate(series.values(), 1))
    if text.channel is None and len(series) > 1:
        message = f"the file holds {len(series)} channels of acceleration: {listed}"
        hint = "select one: channel: 1 beside the file in a study, or --channel 1"
        raise text.refuse(message, hint, min(series) + 1)
    channel = text.channel or 1
    if not 1 <= channel <= len(series):
        raise text.refuse(f"there is no channel {channel} in the file", f"write one of {listed}", min(series) + 1)
    index = list(series)[channel - 1]
    return index, series[index][1]


def _check_peak(text: Text, values: list[float], pattern: str, header: range, unit: str) -> None:
    """Refuse samples whose peak is not the one that the header states, to 2 % and the last digit of what is printed."""
    peak = max(map(abs, values))
    for index in header:
        stated = abs(number(said[1]) or 0.0) if (said := re.search(pattern, text.line(index))) else 0.0
        if stated and abs(peak - stated) > 0.02 * stated + 0.01:
            message = f"the header says a peak of {stated:g} {unit}, but the samples reach {peak:.6g}"
            raise text.damaged(message, index + 1)


def _one_blank(line: str) -> str:
    """A line with one blank between its words: patterns with several optional blanks need time by their power."""
    return " ".join(line.split())
