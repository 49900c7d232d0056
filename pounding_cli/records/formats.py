"""The file formats of the strong-motion networks, one function each.

Each returns the samples of a file, or None of another format, and raises `InputError` for a file of its format that is
damaged, holds no acceleration, or several channels and none was named.
"""

from __future__ import annotations

import re

from pounding_cli.records.text import Asked, Samples, Text, number
from pounding_cli.records.units import quantity_of, unit_in

_CSMIP_LABEL = re.compile(r"(?i)\bCHAN(?:NEL)?\s*(\d+\s*:\s*\S+(?:\s\S+)*)")
_CSMIP_DATA = re.compile(r"(?i)\s*(\d{1,9})\s+points\s+of\s+(?:\w+\s+)?(accel|veloc|displ)\w*")
_CSMIP_SPACED = re.compile(r"(?i)at\s+(\d*\.?\d+)\s*sec")
_COSMOS_FIRST = re.compile(r"(?i)\(\s*format\s+v\s*[\d.]+(?:\s+with\s+(\d{1,3})\s+text\s+lines)?")
_COSMOS_CHANNEL = re.compile(r"(?i)sta chan? ?:? ?(.*?) ?(?:\(|location|\Z)")
_COSMOS_DATA = re.compile(
    r"(?i)\s*(\d{1,9}) (\w+) (?:data )?(?:pts|points).*?units? ?= ?([^,(]+?) ?(?:\( ?\d+ ?\))? ?,.*?(format.*)"
)


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
    first, end = text.first, text.first + 17
    if not text.lines[first].startswith("Origin Time"):
        return None
    rate, line = text.find(r"^Sampling Freq\S*\s+([1-9][\d.]*)", first, end, "Sampling Freq(Hz), e.g. 100Hz")
    step = text.step(1.0 / float(rate[1]), line, asked.dt)
    scale = r"^Scale Factor\s+([\d.]+) *\( *gal *\) */ *([1-9][\d.]*)"
    gal, scale_line = text.find(scale, first, end, "Scale Factor, e.g. 3920(gal)/6182761: its counts have no unit")
    counts, start = text.values(end)
    duration, line = text.find(r"^Duration Time\S*\s+(\d[\d.]*)", first, end, "Duration Time(s), e.g. 60")
    text.count(f"{float(duration[1]) * float(rate[1]):.0f}", len(counts), line, "duration x frequency")
    mean, one = sum(counts) / len(counts), float(gal[1]) / float(gal[2])
    values = [(each - mean) * one for each in counts]
    _check_peak(text, values, r"^Max\. Acc\S*(?: \(gal\))?\s+(\S+)", end, "gal")
    return Samples(step, values, start, "gal", scale_line)


def esm(text: Text, asked: Asked) -> Samples | None:
    """ESM and ITACA: the DYNA file, lines `KEY: value` (64 in DYNA 1.2), then one value a line.

    Luzi et al. (2016), The Engineering Strong-Motion Database, Seismological Research Letters 87(4), 987-997.
    """
    first = end = text.first
    if not text.lines[first].startswith("EVENT_NAME:"):
        return None
    while re.match(r"[A-Z][A-Z0-9_/^]*\s*:", text.line(end)):
        end += 1
    interval, line = text.find(r"^SAMPLING_INTERVAL_S:\s*(\S+)", first, end, "SAMPLING_INTERVAL_S")
    step = text.step(interval[1], line, asked.dt)
    kind, line = text.find(r"^DATA_TYPE:\s*(\S+)", first, end, "DATA_TYPE")
    if not kind[1].upper().startswith("ACC"):
        raise text.wrong_quantity(kind[1].lower(), line)
    unit, unit_line = text.find(r"^UNITS:\s*(\S+)", first, end, "UNITS")
    count, line = text.find(r"^NDATA:\s*(\S+)", first, end, "NDATA")
    values, start = text.values(end)
    text.count(count[1], len(values), line, "NDATA")
    if unit[1].startswith("cm"):
        _check_peak(text, values, r"^PGA_CM/S\^2:\s*(\S+)", end, "cm/s2")
    return Samples(step, values, start, unit[1], unit_line)


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
        raise text.damaged(f"the header says {comments} comments and {count} samples", place + 2)
    values, _ = text.fixed(start + comments, count, (8, 10), last=True)
    return Samples(step, values, start + comments + 1, "cm/s2")


def cosmos(text: Text, asked: Asked) -> Samples | None:
    """COSMOS V1 and V2: for every channel text, integers, reals, comments and samples, each with its own size.

    Consortium of Organizations for Strong-Motion Observation Systems (2001), COSMOS Strong Motion Data Format, 1.20.
    """
    index, channels, others = text.first, dict[int, str](), list[tuple[str, int]]()
    if not _COSMOS_FIRST.search(text.lines[index]):
        return None
    found: dict[int, tuple[float, re.Match[str]]] = {}
    while index < len(text.lines):
        if begins := _COSMOS_FIRST.search(text.lines[index]):
            words = text.lines[index : index + int(begins[1] or 13)]
            named = filter(None, (_COSMOS_CHANNEL.search(_one_blank(line)) for line in words))
            index, step, data = _cosmos_header(text, index + len(words))
            if quantity_of(data[2]) == "acceleration":
                found[index], channels[index] = (step, data), next((each[1] for each in named), "") or "unnamed"
            else:
                others.append((data[2].lower(), index))
        index += 1
    if not found:
        raise text.wrong_quantity(*others[0])
    start = list(found)[text.channel(asked, list(channels.values()), min(found))]
    step, data = found[start]
    values, _ = text.fixed(start, int(data[1]), _fortran(data[4]), last=True)
    return Samples(text.step(step, start, asked.dt), values, start + 1, data[3], start)


def _cosmos_header(text: Text, index: int) -> tuple[int, float, re.Match[str]]:
    """Index of the first sample behind a channel's words, its time step [s], and what its data line says: number,
    quantity and unit of the samples, and their Fortran format."""
    reals: list[float] = []
    for kind in ("integer", "real"):
        pattern, what = rf"^\s*(\d{{1,6}})\s+{kind}[- ]*header.*?(\(.*)", f"how many {kind} header values follow"
        found, _ = text.find(pattern, index, index + 1, f"{what}, e.g. 100 {kind.capitalize()}-header values (10I8)")
        reals, index = text.fixed(index + 1, int(found[1]), _fortran(found[2]))
    if comments := re.match(r"(?i)\s*(\d{1,6})\s+comment", text.line(index)):
        index += 1 + int(comments[1])
    data = _COSMOS_DATA.match(_one_blank(text.line(index)))
    if not data:
        example = "12091 acceleration pts, approx 120 secs, units=cm/s2 (4),Format=(8F10.5)"
        raise text.damaged(f"the header does not say how many samples follow, e.g. {example}", index + 1)
    reals += [-999.0] * 62  # the data's own step [ms], number 62 in the documentation, comes before the recorder's [s]
    return index + 1, float(f"{reals[61] / 1000.0 if reals[61] > 0 else reals[33]:.9g}"), data


def csmip(text: Text, asked: Asked) -> Samples | None:
    """CSMIP V2 of the California network, one or more channels: a line such as `4000 points of accel data equally
    spaced at .020 sec, in cm/sec2. (8f10.3)`, then the samples.

    Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, report OSMS 85-03.
    """
    start = text.first
    kind = re.match(r"\s*(UN|R)?(?:CORRECTED\s+ACCELEROGRAM|ESPONSE\s+AND\s+FOURIER)", text.lines[start].upper())
    if kind is None:
        return None
    if kind[1]:
        what = "spectra (V3)" if kind[1] == "R" else "uncorrected samples (V1)"
        raise text.refuse(f"a CSMIP file of {what}", "download the corrected record (V2)", start + 1)
    label, series = "unnamed", dict[int, tuple[str, re.Match[str], re.Match[str]]]()
    for index, line in enumerate(text.lines):
        if named := _CSMIP_LABEL.search(line):
            label = _one_blank(named[1])
        data, spaced = _CSMIP_DATA.match(line), _CSMIP_SPACED.search(line)
        if data and spaced:  # a line of the header may speak of the points too, without their spacing
            series[index] = label, data, spaced
    if not series:
        example = "4000 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.3)"
        raise text.damaged(f"the header does not say how many points follow, e.g. {example}", start + 1)
    kinds = {index: quantity_of(data[2]) for index, (_, data, _) in series.items()}
    found = [index for index, kind in kinds.items() if kind == "acceleration"]
    if len(found) < max(1, list(kinds.values()).count("velocity")):
        raise text.damaged("a channel holds no acceleration", min(series) + 1)
    index = found[text.channel(asked, [series[each][0] for each in found], start + 1)]
    _, data, spaced = series[index]
    line = text.lines[index]
    step = text.step(spaced[1], index + 1, asked.dt)
    values, _ = text.fixed(index + 1, int(data[1]), _fortran(line), last=True)
    return Samples(step, values, index + 2, unit_in(line[spaced.end() :], ()) or "cm/s2", index + 1)


def _check_peak(text: Text, values: list[float], pattern: str, end: int, unit: str) -> None:
    """Refuse samples whose peak is not the one that the header states, to 2 % and the last digit of what is printed."""
    peak = max(map(abs, values))
    for place, line in enumerate(text.lines[:end], 1):
        stated = abs(number(said[1]) or 0.0) if (said := re.search(pattern, line)) else 0.0
        if stated and abs(peak - stated) > 0.02 * stated + 0.01:
            raise text.damaged(f"the header says a peak of {stated:g} {unit}, but the samples reach {peak:.6g}", place)


def _fortran(written: str) -> tuple[int, int]:
    """Numbers a line and width of each, from a Fortran format such as (8F10.5), which is that of most files."""
    found = re.search(r"(?i)\(\s*(\d{0,2})\s*[IFEDG]\s*([1-9]\d?)", written)
    return (int(found[1] or 1) or 1, int(found[2])) if found else (8, 10)


def _one_blank(line: str) -> str:
    """A line with one blank between its words: patterns with several optional blanks need time by their power."""
    return " ".join(line.split())
