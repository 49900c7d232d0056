"""ESM and ITACA: the DYNA file of the European and Italian strong-motion databases, one value a line.

Layout: lines `KEY: value` (64 in DYNA 1.2), then the samples (Luzi et al., 2016, The Engineering
Strong-Motion Database, Seismological Research Letters 87(4), 987-997; https://esm-db.eu).
"""

from __future__ import annotations

import re

from pounding_cli.records.formats.text import Asked, Samples, Text, number
from pounding_cli.records.units import quantity_of

_KEY = re.compile(r"([A-Z][A-Z0-9_/^]*)\s*:\s?(.*)\Z")
_MOST = 120
_PEAK_AGREES = 0.02


def recognises(text: Text) -> bool:
    """Whether the file opens with an event name and states a sampling interval."""
    first = text.first()
    return text.lines[first].startswith("EVENT_NAME:") and any(
        line.startswith("SAMPLING_INTERVAL_S:") for line in text.lines[first : first + _MOST]
    )


def read(text: Text, asked: Asked) -> Samples:
    """The samples; raises `InputError` for a wrong count, a velocity or displacement, a peak other than stated."""
    keys, start = _keys(text)
    interval, line = _need(text, keys, "SAMPLING_INTERVAL_S", "0.005")
    step = text.same_step(asked.dt, text.step(interval, line), line)
    kind, kind_line = keys.get("DATA_TYPE", ("ACCELERATION", 0))
    if not kind.upper().startswith("ACC"):
        raise text.wrong_quantity(kind.lower() or "no named quantity", kind_line)
    unit, unit_line = _need(text, keys, "UNITS", "cm/s^2")
    if quantity_of(unit) in ("velocity", "displacement"):
        raise text.wrong_quantity(quantity_of(unit), unit_line)
    count, count_line = _need(text, keys, "NDATA", "12000")
    rows = text.rows(start)
    values = [value for _, row in rows for value in row]
    if not re.fullmatch(r"\d{1,9}", count):
        raise text.refuse(f"NDATA is '{count}'", "write the number of samples", count_line)
    text.count(count, len(values), count_line, "NDATA")
    stated = number(keys.get("PGA_CM/S^2", ("", 0))[0])
    peak = max(abs(value) for value in values)
    if stated and unit.startswith("cm") and abs(peak - abs(stated)) > _PEAK_AGREES * abs(stated):
        raise text.refuse(
            f"the header says a peak of {abs(stated):g} cm/s2, but the samples reach {peak:.6g} cm/s2",
            "the file is damaged: download it again",
            keys["PGA_CM/S^2"][1],
        )
    return Samples(step, values, rows[0][0] + 1, unit, unit_line)


def _keys(text: Text) -> tuple[dict[str, tuple[str, int]], int]:
    keys: dict[str, tuple[str, int]] = {}
    index = text.first()
    while index < len(text.lines):
        found = _KEY.match(text.lines[index].rstrip())
        if not found and text.lines[index].strip():
            break
        if found:
            keys[found[1]] = (found[2], index + 1)
        index += 1
    return keys, index


def _need(text: Text, keys: dict[str, tuple[str, int]], key: str, example: str) -> tuple[str, int]:
    if not keys.get(key, ("", 0))[0]:
        raise text.refuse(f"the header does not say {key}", f"write e.g. {key}: {example}", keys.get(key, ("", 1))[1])
    return keys[key]
