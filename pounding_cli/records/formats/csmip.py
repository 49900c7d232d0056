"""CSMIP: the California network's V1 (uncorrected) and V2 (corrected) files, one or more channels.

V2: text, integers and reals, then a line such as `4000 points of accel data equally spaced at .020 sec, in cm/sec2.
(8f10.3)` and the samples; velocity and displacement follow.  V1: 13 lines of text, 7 of integers (16I5), 7 of reals
(8F10.3), then time and acceleration in turns, ten columns of seven, or samples alone behind a line such as
`13200 Accelerogram points at 200 pts/sec in units of g. Format: (8f9.6)`
(Shakal and Huang, 1985, Standard tape format for CSMIP strong-motion data tapes, report OSMS 85-03).
"""

from __future__ import annotations

import re

from pounding_cli.records.formats.text import Asked, Samples, Text, fortran, number
from pounding_cli.records.formats.times import even_step

_V1 = re.compile(r"\s*UNCORRECTED\s+ACCELEROGRAM\s+DATA", re.IGNORECASE)
_V2 = re.compile(r"\s*CORRECTED\s+ACCELEROGRAM", re.IGNORECASE)
_V3 = re.compile(r"\s*RESPONSE\s+AND\s+FOURIER\s+AMPLITUDE\s+SPECTRA", re.IGNORECASE)
_END = re.compile(r"END\s+OF\s+DATA\s+FOR\s+CHAN", re.IGNORECASE)
_DATA = re.compile(r"\s*(\d{1,9})\s+points\s+of\s+(?:\w+\s+)?(accel|veloc|displ)\w*", re.IGNORECASE)
_SPACED = re.compile(r"(?:spaced\s+at|at)\s+(\d*\.?\d+)\s*sec", re.IGNORECASE)
_RATE = re.compile(r"at\s+(\d+\.?\d*)\s*(?:pts|points|samples)\s*/\s*sec", re.IGNORECASE)
_CHANNEL = re.compile(r"\bCHAN(?:NEL)?\s*(\d+\s*:\s*\S+(?:\s\S+)*)", re.IGNORECASE)
_UNITS = re.compile(
    r"(?P<tenth>g\s*/\s*10)|(?P<cm>cm\s*/\s*s(?:ec)?(?:\s*/\s*s(?:ec)?|\s*\*\*\s*2|\^?2))|(?P<gal>\bgals?\b)|(?P<g>\bg\b)",
    re.IGNORECASE,
)
_NAMES = {"tenth": "g/10", "cm": "cm/s2", "gal": "gal", "g": "g"}
_WORDS, _INTEGERS, _REALS = 13, 100, 50
_COUNT_NEW, _COUNT = 32, 27
_LENGTH = 2
# Places of the count of samples among the integers (newer files have it later) and of the length [s] among the reals.


def recognises(text: Text) -> bool:
    """Whether the first line is that of a V1, V2 or V3 file."""
    line = text.lines[text.first()]
    return any(kind.match(line) for kind in (_V1, _V2, _V3))


def read(text: Text, asked: Asked) -> Samples:
    """The samples of one channel; raises `InputError` for spectra, uneven times, or several channels and none named."""
    first = text.first()
    if _V3.match(text.lines[first]):
        raise text.wrong_quantity("spectra (V3)", first + 1)
    whole = _channels(text, first)
    labels = [_label(text, start, end) for start, end in whole]
    start, end = whole[text.channel(asked, labels, first + 1)]
    if _V1.match(text.lines[start]):
        return _volume_one(text, asked, start, end)
    return _volume_two(text, asked, start, end)


def _channels(text: Text, first: int) -> list[tuple[int, int]]:
    """Begin and end (lines) of every channel."""
    found, start = [], first
    for index in range(first, len(text.lines)):
        if _END.search(text.lines[index]):
            found.append((start, index))
            start = index + 1
    found.append((start, len(text.lines)))
    trimmed = []
    for begin, end in found:
        filled = next((index for index in range(begin, end) if text.lines[index].strip(" \t\x1a")), None)
        if filled is not None:
            trimmed.append((filled, end))
    return trimmed


def _label(text: Text, start: int, end: int) -> str:
    for line in text.lines[start : min(end, start + 26)]:
        found = _CHANNEL.search(line)
        if found:
            return re.sub(r"\s+", " ", found[1]).strip()
    return "unnamed"


def _volume_two(text: Text, asked: Asked, start: int, end: int) -> Samples:
    for index in range(start, end):
        line = text.lines[index]
        data, spaced = _DATA.match(line), _SPACED.search(line)
        # A line of the header may speak of the points too, without their spacing.
        if not data or not spaced:
            continue
        if not data[2].lower().startswith("accel"):
            raise text.wrong_quantity({"veloc": "velocity", "displ": "displacement"}[data[2].lower()], index + 1)
        step = text.same_step(asked.dt, text.step(spaced[1], index + 1), index + 1)
        columns = fortran(line) or (8, 10)
        values, _ = text.fixed(index + 1, int(data[1]), *columns)
        return Samples(step, values, index + 2, _unit(line[spaced.end() :]) or "cm/s2", index + 1)
    raise text.refuse(
        "no line that says how many points of acceleration follow, and their spacing",
        "a CSMIP V2 file has e.g. '4000 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.3)'",
        start + 1,
    )


def _volume_one(text: Text, asked: Asked, start: int, end: int) -> Samples:
    integers, after = text.fixed_block(start + _WORDS, _INTEGERS, 16, 5, blank_as_zero=True)
    reals, data = text.fixed_block(after, _REALS, 8, 10, blank_as_zero=True)
    count = int(integers[_COUNT_NEW]) or int(integers[_COUNT])
    if not 1 < count < 10**8 or data >= end:
        raise text.refuse(f"the header says {count} samples", "download the file again", after)
    unit, unit_line = _unit_of_v1(text, start, data)
    line = text.lines[data]
    if re.search(r"[A-DF-Za-df-z]", line):
        return _behind_words(text, asked, data, count, reals[_LENGTH], unit, unit_line)
    pairs, _ = text.fixed(data, 2 * count, 10, 7)
    lines = [data + place // 5 for place in range(count)]
    step = even_step(text, pairs[0::2], lines, asked.dt, "download the corrected record (V2)")
    return Samples(step, pairs[1::2], data + 1, unit, unit_line)


def _behind_words(
    text: Text, asked: Asked, data: int, count: int, length: float, unit: str | None, unit_line: int
) -> Samples:
    line = text.lines[data]
    said, spaced = _DATA.match(line), _SPACED.search(line)
    count = int(said[1]) if said else count
    rated = _RATE.search(line)
    written = number(spaced[1]) if spaced else None
    if written is None:
        # Without either: the samples a second are a whole number, and the length is printed with few digits.
        rate = float(rated[1]) if rated else round((count - 1) / length) if length > 0 else 0
        written = float(f"{1.0 / rate:.9g}") if rate else 0.0
    step = text.same_step(asked.dt, text.step(written, data + 1), data + 1)
    own = _unit(line[spaced.end() :] if spaced else line)
    values, _ = text.fixed(data + 1, count, *(fortran(line) or (8, 9)))
    return Samples(step, values, data + 2, own or unit, data + 1 if own else unit_line)


def _unit_of_v1(text: Text, start: int, data: int) -> tuple[str | None, int]:
    for index in range(start, min(data, start + _WORDS)):
        line = text.lines[index]
        place = line.lower().find("unit")
        found = _unit(line[place:]) if place >= 0 else None
        if found:
            return found, index + 1
    return None, 0


def _unit(words: str) -> str | None:
    found = _UNITS.search(words)
    return _NAMES[found.lastgroup] if found and found.lastgroup else None
