"""The file formats of the strong-motion networks, one function each, read strictly by their specifications.

Each returns the samples of a file, or None of another format, and raises `InputError` for a file of its format that is
damaged, holds no acceleration, or several channels and none was named.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from pounding_cli.numbers import pluralize
from pounding_cli.records.declaration import BASELINES
from pounding_cli.records.instrument import InstrumentFile, is_numeric, parse_number
from pounding_cli.records.samples import Samples

_COSMOS = re.compile(r"(?i)\( ?format v ?[\d.]+(?: with (\d{1,3}) text lines)?")
_COSMOS_LABEL = r"sta chan? ?:? ?(.*?) ?(?:\(|location|\Z)"
_COSMOS_DATA = re.compile(
    r"(?i)\A(\d{1,9}) (\w+) (?:data )?(?:pts|points).*?units? ?= ?([^,(]+?) ?(?:\( ?\d+ ?\))? ?,.*?(format.*)"
)
_CSMIP = re.compile(r"\s*(UN|R)?(?:CORRECTED\s+ACCELEROGRAM|ESPONSE\s+AND\s+FOURIER)")
_CSMIP_LABEL = re.compile(r"(?i)\bchan(?:nel)? ?(\d+ ?: ?.+)")
_CSMIP_DATA = re.compile(r"(?i)\A(\d{1,9}) points of (?:\w+ )?(accel|veloc|displ)\w* .*?at (\d*\.?\d+) ?sec(.*)")
_SMC = re.compile(r"\s*\d\s+((?:UN)?CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE|FOURIER)")


def read_at2(text: InstrumentFile) -> Samples | None:
    """PEER NGA: one component; the quantity and its unit on the third line, count and time step on the fourth (older
    files: `5437 0.0100 NPTS, DT`), then the values, row by row.

    Chiou, Darragh, Gregor and Silva (2008), NGA project strong-motion database, Earthquake Spectra 24(1), 23-44.
    """
    third, fourth = text.first + 2, text.first + 3
    size, line = text.search(
        r"^NPTS ?= ?(\d{1,9}) ?,? ?DT ?= ?([-+.\dE]+)(?: ?SEC\b| ?,| ?\Z)", range(fourth, fourth + 1)
    )
    if size is None:
        size, line = text.search(r"^(\d{1,9}) ([-+.\dE]+) NPTS, ?DT", range(fourth, fourth + 1))
    kind = r"^(acceleration|velocity|displacement)\b.*in units? of ([^\s,;]+?)\.?(?:[\s,;]|\Z)"
    quantity, unit_line = text.search(kind, range(third, third + 1))
    if size is None or quantity is None:
        return None
    if quantity[1].lower() != "acceleration":
        raise text.refuse_quantity(quantity[1].lower(), unit_line)
    step = text.step(size[2], line)
    values, start = text.values(line)
    text.check_count(size[1], len(values), line)
    return Samples(step, values, quantity[2], start, unit_line=unit_line)


def read_pound(text: InstrumentFile) -> Samples | None:
    """The program's own: comments `# unit: m/s2`, `# dt: 0.01 s` and others above, then one value a line.

    `# samples:`, where it stands, must be their number; `# name:` and `# baseline:` are those of the study.
    """
    header = dict[str, tuple[str, int]]()
    end = text.first
    while match := re.match(r"#\s*([a-z][a-z -]*):(.*)\Z", text.line(end)):
        header.setdefault(match[1], (match[2].strip(), end + 1))
        end += 1
    if not {"unit", "dt"} <= header.keys():
        return None
    written, line = header["dt"]
    seconds = re.fullmatch(r"([-+.\dEe]+) ?s?", written)
    if seconds is None:
        raise text.refuse(f"the time step is written '{written[:40]}'", "write it in seconds, `# dt: 0.01 s`", line)
    step = text.step(seconds[1], line)
    rows = text.rows(end)
    wide = next((row for row in rows if len(row.cells) != 1), None)
    if wide is not None:
        raise text.refuse_damaged(f"{pluralize(len(wide.cells), 'value')} on a line, where one should stand", wide.line)
    values = text.read_numbers(rows)
    if "samples" in header:
        text.check_count(header["samples"][0], len(values), header["samples"][1], "samples")
    name, _ = header.get("name", ("", 0))
    baseline, baseline_line = header.get("baseline", ("", 0))
    if baseline not in ("", *BASELINES):
        raise text.refuse(f"unknown baseline '{baseline}'", f"write {' or '.join(BASELINES)}", baseline_line)
    return Samples(step, values, header["unit"][0], rows[0].line, name=name, baseline=baseline)


def read_knet(text: InstrumentFile) -> Samples | None:
    """K-NET and KiK-net: seventeen lines `key value`, then counts with the scale that makes them gal.

    The counts carry the recorder's offset; as in the file's own `Max. Acc. (gal)`, the acceleration is what remains
    without the mean of the whole record (NIED, https://www.kyoshin.bosai.go.jp/kyoshin/man/knetform_en.html).
    """
    header = range(text.first, text.first + 17)
    keys = (r"^Sampling Freq", r"^Scale Factor", r"^Memo\.")
    is_knet = text.lines[header.start].startswith("Origin Time")
    if not is_knet or sum(text.search(key, header)[0] is not None for key in keys) < 2:
        return None
    rate, line = text.find(r"^Sampling Freq\S* ([1-9][\d.]*)", header, "Sampling Freq(Hz), e.g. 100Hz")
    step = text.step(1.0 / float(rate[1]), line)
    scale = r"^Scale Factor ([\d.]+) ?\( ?gal ?\) ?/ ?([1-9][\d.]*)"
    gal, _ = text.find(scale, header, "Scale Factor, e.g. 3920(gal)/6182761: its counts have no unit")
    counts, start = text.values(header.stop)
    duration, line = text.find(r"^Duration Time\S* (\d[\d.]*)", header, "Duration Time(s), e.g. 60")
    text.check_count(f"{float(duration[1]) * float(rate[1]):.0f}", len(counts), line, "duration x frequency")
    values = (counts - counts.mean()) * (float(gal[1]) / float(gal[2]))
    _check_peak(text, values, r"^Max\. Acc\S*(?: \(gal\))? (\S+)", header, "gal")
    return Samples(step, values, "gal", start)


def read_esm(text: InstrumentFile) -> Samples | None:
    """ESM and ITACA: the DYNA file, lines `KEY: value` (64 in DYNA 1.2), then one value a line.

    Luzi et al. (2016), The Engineering Strong-Motion Database, Seismological Research Letters 87(4), 987-997.
    """
    first = end = text.first
    if not text.lines[first].startswith("EVENT_NAME:"):
        return None
    while re.match(r"[A-Z][A-Z0-9_/^]*\s*:", text.line(end)):
        end += 1
    keys = ("SAMPLING_INTERVAL_S", "DATA_TYPE", "UNITS", "NDATA")
    matches = [text.find(rf"^{key}: ?(\S.*)", range(first, end), key) for key in keys]
    (interval, line), (kind, kind_line), (unit, unit_line), (count, count_line) = (
        (each[1], at) for each, at in matches
    )
    step = text.step(interval, line)
    if "ACC" not in kind.upper():
        raise text.refuse_quantity(kind.lower(), kind_line)
    values, start = text.values(end)
    text.check_count(count, len(values), count_line, "NDATA")
    if unit.startswith("cm"):
        _check_peak(text, values, r"^PGA_CM/S\^2: ?(\S+)", range(first, end), "cm/s2")
    return Samples(step, values, unit, start, unit_line=unit_line)


def read_smc(text: InstrumentFile) -> Samples | None:
    """SMC of the USGS: 11 lines of text, 48 integers (8I10), 50 reals (5E15.7), comments, samples in cm/s2.

    National Strong-Motion Program, https://escweb.wr.usgs.gov/nsmp-data/smcfmt.html.
    """
    place = text.first + 11
    kind = _SMC.match(text.lines[text.first].upper())
    if kind is None:
        return None
    if not kind[1].endswith("ACCELEROGRAM"):
        quantity = f"{kind[1].lower()} spectra" if kind[1] in ("RESPONSE", "FOURIER") else kind[1].lower()
        raise text.refuse_quantity(quantity, text.first + 1)
    integers, after = text.read_fixed_width(place, 48, "(8I10)")
    (unknown, rate, *_), start = text.read_fixed_width(after, 50, "(5E15.7)")
    if rate == unknown or rate <= 0:
        hint = "download the corrected record ('2 CORRECTED ACCELEROGRAM')"
        raise text.refuse("the header gives no sampling rate: the samples are not evenly spaced", hint, after + 1)
    step = text.step(float(f"{1.0 / rate:.9g}"), after + 1)
    comments, count, faulty = map(int, integers[15:18])
    if faulty == 1:
        hint = "read its comments; set the second integer of the third integer line to 0 if you judge it sound"
        raise text.refuse("the record is flagged as faulty", hint, place + 3)
    if not (0 <= comments < len(text.lines) and 0 < count < 10**9):
        raise text.refuse_damaged(f"the header says {comments} comments and {count} samples", place + 2)
    values, _ = text.read_fixed_width(start + comments, count, "(8F10)", last=True)
    return Samples(step, np.array(values), "cm/s2", start + comments + 1)


def read_cosmos(text: InstrumentFile) -> Samples | None:
    """COSMOS V1 and V2: for every channel text, integers, reals, comments and samples, each with its own size.

    Consortium of Organizations for Strong-Motion Observation Systems (2001), COSMOS Strong Motion Data Format, 1.20.
    """
    index = text.first
    channels = dict[int, tuple[str, float, re.Match[str]]]()
    others = list[tuple[str, int]]()
    if not _COSMOS.search(text.words(index)):
        return None
    while index < len(text.lines):
        if begins := _COSMOS.search(text.words(index)):
            words = range(index, index + int(begins[1] or 13))
            label, _ = text.search(_COSMOS_LABEL, words)
            index, step, data = _cosmos_header(text, words.stop)
            if data[2].lower().startswith("acc"):
                channels[index] = (label[1] if label else "") or "unnamed", step, data
            else:
                others.append((data[2].lower(), index))
        index += 1
    if not channels:
        raise text.refuse_quantity(*others[0])
    start = _select_channel(text, {at: name for at, (name, *_) in channels.items()}, min(channels))
    _, step, data = channels[start]
    values, _ = text.read_fixed_width(start, int(data[1]), data[4], last=True)
    return Samples(text.step(step, start), np.array(values), data[3], start + 1, unit_line=start)


def _cosmos_header(text: InstrumentFile, index: int) -> tuple[int, float, re.Match[str]]:
    """Index of the first sample behind a channel's words, its time step [s], and what its data line says: number,
    quantity and unit of the samples, and their Fortran format. Every part stands where the one before it ends."""
    values: list[float] = []
    for kind in ("integer", "real"):
        example = f"how many {kind} header values follow, e.g. 100 {kind.capitalize()}-header values (10I8)"
        match, _ = text.find(rf"^(\d{{1,6}}) {kind}[- ]*header.*?(\(.*)", range(index, index + 1), example)
        values, index = text.read_fixed_width(index + 1, int(match[1]), match[2])
    if comments := re.match(r"(?i)(\d{1,6}) comment", text.words(index)):
        index += 1 + int(comments[1])
    data = _COSMOS_DATA.match(text.words(index))
    if data is None:
        example = "12091 acceleration pts, approx 120 secs, units=cm/s2 (4),Format=(8F10.5)"
        raise text.refuse_damaged(f"the header does not say how many samples follow, e.g. {example}", index + 1)
    values += [-999.0] * 62  # the data's own step [ms], number 62 in the documentation, comes before the recorder's [s]
    return index + 1, float(f"{values[61] / 1000.0 if values[61] > 0 else values[33]:.9g}"), data


def read_csmip(text: InstrumentFile) -> Samples | None:
    """CSMIP V2 of the California network, one or more channels: a line such as `4000 points of accel data equally
    spaced at .020 sec, in cm/sec2. (8f10.3)`, then the samples.

    Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, report OSMS 85-03.
    """
    kind = _CSMIP.match(text.lines[text.first].upper())
    if kind is None:
        return None
    if kind[1]:
        what = "spectra (V3)" if kind[1] == "R" else "uncorrected samples (V1)"
        hint = (
            "download the corrected record (V2); of another network, export the acceleration and give format, unit, dt"
        )
        raise text.refuse(f"a CSMIP file of {what}", hint, text.first + 1)
    named = "unnamed"
    series = dict[int, tuple[str, re.Match[str]]]()
    for index in range(len(text.lines)):
        if label := _CSMIP_LABEL.search(text.words(index)):
            named = label[1]
        if data_line := _CSMIP_DATA.match(text.words(index)):
            series[index] = named, data_line
    if not series:
        return None  # another network's accelerogram, or that of Caltech
    kinds = {index: data_line[2].lower() for index, (_, data_line) in series.items()}
    channels = {index: series[index][0] for index, kind in kinds.items() if kind == "accel"}
    if len(channels) < max(1, list(kinds.values()).count("veloc")):
        raise text.refuse_damaged("a channel holds no acceleration", min(series) + 1)
    start = _select_channel(text, channels, min(channels) + 1)
    data = series[start][1]
    step = text.step(data[3], start + 1)
    values, _ = text.read_fixed_width(start + 1, int(data[1]), data[4], last=True)
    unit = re.search(r"(?i)\bin (cm/s(?:ec)?(?:/s(?:ec)?|\^?2)|m/s(?:ec)?(?:/s(?:ec)?|\^?2)|g)(?![\w/])", data[4])
    return Samples(step, np.array(values), unit[1].lower() if unit else "cm/s2", start + 2)


def _select_channel(text: InstrumentFile, channels: dict[int, str], line: int) -> int:
    """Index, in the file, of the channel asked for, of those with acceleration by name; refused where there are several
    and none was named."""
    names = "; ".join(f"{place}: {name}" for place, name in enumerate(channels.values(), 1))
    chosen = text.declared.channel
    if chosen is None and len(channels) > 1:
        message = f"the file holds {len(channels)} channels of acceleration: {names}"
        hint = "select one: channel: 1 beside the file in a study, or --channel 1"
        raise text.refuse(message, hint, line)
    channel = 1 if chosen is None else chosen
    if not 1 <= channel <= len(channels):
        raise text.refuse(f"there is no channel {channel} in the file", f"write one of {names}", line)
    return list(channels)[channel - 1]


def _check_peak(
    text: InstrumentFile, values: Sequence[float] | np.ndarray, pattern: str, header: range, unit: str
) -> None:
    """Refuse samples whose peak is not the one that the header states, to 2 % and the last digit of what is printed."""
    match, line = text.search(pattern, header)
    stated = abs(parse_number(match[1]) or 0.0) if match else 0.0
    peak = float(np.abs(values).max())
    if stated and abs(peak - stated) > 0.02 * stated + 0.01:
        raise text.refuse_damaged(
            f"the header says a peak of {stated:g} {unit}, but the samples reach {peak:.6g}", line
        )


def read_geonet(text: InstrumentFile) -> Samples | None:
    """Return a channel of GeoNet's V1A and V2A (New Zealand), in mm/s2.

    Every component has 16 lines of text, four of integers, six of reals, then samples, ten a line; in V2A velocities
    and displacements follow.

    GeoNet, Strong motion file formats, https://www.geonet.org.nz/data/supplementary/strong_motion_file_formats.
    """
    first = " ".join(text.lines[text.first : text.first + 3])
    if not _GEONET.match(first) or not re.search(r"GNS Science|GeoNet", first, re.IGNORECASE):
        return None
    begins = [index for index in range(len(text.lines)) if _GEONET.match(text.lines[index])]
    channels = {}
    for begin in begins:
        label, _ = text.search(r"^Component (\S+)", range(begin, begin + 16))
        channels[begin] = label[1] if label else "unnamed"
    begin = _select_channel(text, channels, begins[0] + 1)
    words = range(begin, begin + 16)
    numbers = begin + 16
    if not is_numeric(text.line(numbers)):
        numbers = next((index for index in range(begin + 1, begin + 26) if is_numeric(text.line(index))), numbers)
    header, start = text.read_fixed_width(numbers, 100, "(10I8)")
    places = (30,) if "uncorrected" in text.lines[begin].lower() else (33, 30)
    coded = next((header[place] for place in places if header[place] > 0), 0.0)
    size, _ = text.search(r"number of points\D{0,3}(\d{1,9})", words)
    count = int(size[1]) if size else int(coded)
    if not 0 < count < 10**9:
        raise text.refuse_damaged(
            "the header does not say how many points follow, e.g. Number of points 8000", begin + 1
        )
    spaced, step_line = text.search(r"at (\d*\.?\d+) sec(?:ond)? intervals", words)
    step = text.step(spaced[1] if spaced else header[65], step_line or numbers + 7)
    unit, _ = text.search(r"^acceleration\b.*?\d (mm/s/s|cm/s/s|m/s/s|mm/s\^?2|g)\b", words)
    values, after = text.read_fixed_width(start, count, "(10F8.1)")
    if "uncorrected" in text.lines[begin].lower() and is_numeric(text.line(after)):
        raise text.refuse_damaged(f"more than the {count} values that the header says follow", after + 1)
    peak, peak_line = text.search(r"^acceleration\b\W*peak ([-+]?[\d.]+)", words)
    if peak and abs(abs(parse_number(peak[1]) or 0.0) - max(map(abs, values))) > 0.02 * max(map(abs, values)) + 0.1:
        raise text.refuse_damaged(
            f"the header says a peak of {peak[1]}, but the samples reach {max(values, key=abs):g}", peak_line
        )
    return Samples(step, np.array(values), unit[1].lower() if unit else "mm/s2", start + 1)


def read_asa(text: InstrumentFile) -> Samples | None:
    """Return a channel of the Mexican ASA 2.0 format.

    About 109 lines `CLAVE : valor`, with the values of channels as `/a/b/c`, then one column a channel.

    Base Mexicana de Datos de Sismos Fuertes (1995), Formato estandar de archivo de aceleracion, version 2.0.
    """
    is_asa, _ = text.search(r"ARCHIVO EST[AÁ]NDAR DE ACELERACI[OÓ]N", range(40))
    units, _ = text.search(r"^UNIDADES DE LOS DATOS ?\W{0,3}(.*)", range(130))
    intervals, step_line = text.search(r"^INTERVALO DE MUESTREO.*?[:=] ?(.*)", range(130))
    if intervals is None or not (is_asa or units):
        return None
    start = next((at for at in range(step_line, len(text.lines)) if is_numeric(text.lines[at])), None)
    if start is None:
        raise text.refuse("no numbers after the header", "give a file that holds a ground motion", step_line)
    rows = text.rows(start)
    width = len(rows[0].cells)
    odd = next((row for row in rows if len(row.cells) != width), None)
    if odd is not None:
        raise text.refuse_damaged(
            f"{pluralize(len(odd.cells), 'value')} on this line, where every other has {width}", odd.line
        )
    header = range(start)
    oriented, _ = text.search(r"^ORIENTACION.*?[:=] ?(.*)", header)
    names = _values_of_channels(oriented[1]) if oriented else []
    channels = {place: names[place] if place < len(names) else f"canal {place + 1}" for place in range(width)}
    place = _select_channel(text, channels, start + 1)
    steps = _values_of_channels(intervals[1])
    written = steps[min(place, len(steps) - 1)] if steps else ""
    seconds = re.match(r"([\d.]+)(?: ?s(?:eg)?)?\.?\Z", written)
    step = text.step(seconds[1] if seconds else written, step_line)
    numbers, _ = text.values(start)
    values = numbers[place::width]
    said, line = text.search(r"^NUM\. ?TOTAL DE MUESTRAS.*?[:=] ?(.*)", header)
    sizes = _values_of_channels(said[1]) if said else []
    if place < len(sizes):
        text.check_count(sizes[place], len(values), line, "NUM. TOTAL DE MUESTRAS")
    unit = units[1].strip(" /'\"()") if units else ""
    if not unit:
        peaks, _ = text.search(r"^ACEL\. ?MAX\.? ?\((\w+)\)", header)
        unit = peaks[1] if peaks else ""
    named = re.search(r"(?i)(?<![a-z])(gal(?=s?(?![a-z]))|[mc]?m/s(?:eg)?\^?2|g(?![a-z]))", unit)
    return Samples(step, values, named[1].lower().replace("seg", "s") if named else unit, start + 1)


def _values_of_channels(written: str) -> list[str]:
    """Return the values of channels that are written as `/a/b/c/`."""
    return [value.strip() for value in written.strip().strip("/").split("/") if value.strip()]


_GEONET = re.compile(r"\s*(?:un)?corrected\s+accelerogram\b", re.IGNORECASE)

FORMATS = {
    "pound": read_pound,
    "at2": read_at2,
    "geonet": read_geonet,
    "cosmos": read_cosmos,
    "csmip": read_csmip,
    "smc": read_smc,
    "knet": read_knet,
    "esm": read_esm,
    "asa": read_asa,
}
"""The formats by name."""

FORMATS_WITH_CHANNELS = ("cosmos", "csmip", "geonet", "asa")
"""The formats of which a file may hold several channels."""
