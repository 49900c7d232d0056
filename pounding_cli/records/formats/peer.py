"""PEER NGA: the AT2 file, one component of acceleration, with its count and time step on the fourth line.

Layout: three lines of text, the last of which names quantity and unit, then `NPTS= 5437, DT= .0100 SEC` (older
files: `5437 0.0100 NPTS, DT`), then values row by row (Chiou, Darragh, Gregor and Silva, 2008, NGA project
strong-motion database, Earthquake Spectra 24(1), 23-44).
"""

from __future__ import annotations

import re

from pounding_cli.records.formats.text import Asked, Samples, Text
from pounding_cli.records.units import quantity_of

_SIZE = re.compile(r"NPTS\s*=?\s*(\d{1,9})\s*,?\s*DT\s*=?\s*([-+.\dEe]+)", re.IGNORECASE)
_SIZE_OLD = re.compile(r"^\s*(\d{1,9})\s+([-+.\dEe]+)\s+NPTS", re.IGNORECASE)
_UNIT = re.compile(r"IN\s+UNITS?\s+OF\s+(\S+)", re.IGNORECASE)
_QUANTITY = re.compile(r"(VELOCITY|DISPLACEMENT)\s+TIME\s+(?:SERIES|HISTORY)", re.IGNORECASE)
_TOP = 8


def recognises(text: Text) -> bool:
    """Whether a line near the top has NPTS and DT."""
    return any(_size(line) for line in text.lines[:_TOP])


def read(text: Text, asked: Asked) -> Samples:
    """The samples; raises `InputError` for a wrong count, a velocity or a displacement."""
    sizes = ((index, _size(line)) for index, line in enumerate(text.lines[:_TOP]))
    index, size = next(((index, size) for index, size in sizes if size), (0, None))
    if size is None:
        raise text.refuse(
            "no header line with NPTS and DT",
            "a PEER AT2 file has 'NPTS= 5437, DT= .0100 SEC' on its fourth line; or say another format",
            1,
        )
    unit, unit_line = None, 0
    for place, line in enumerate(text.lines[:index]):
        other = _QUANTITY.search(line)
        if other:
            raise text.wrong_quantity(other[1].lower(), place + 1)
        found = _UNIT.search(line)
        if found:
            unit, unit_line = found[1].rstrip(",;"), place + 1
            if quantity_of(unit) in ("velocity", "displacement"):
                raise text.wrong_quantity(quantity_of(unit), place + 1)
    step = text.same_step(asked.dt, text.step(size[2], index + 1), index + 1)
    rows = text.rows(index + 1)
    values = [value for _, row in rows for value in row]
    text.count(size[1], len(values), index + 1)
    return Samples(step, values, rows[0][0] + 1, unit, unit_line)


def _size(line: str) -> re.Match[str] | None:
    return _SIZE.search(line) or _SIZE_OLD.search(line)
