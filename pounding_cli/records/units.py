"""Units of acceleration: what one is in m/s2, and where a line plainly states another one than is declared."""

from __future__ import annotations

import re

from pounding_cli.units import GRAVITY, find_unit_factor, parse_unit

ACCELERATION_UNITS = {
    "g": GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01, "mm/s2": 0.001, "ft/s2": 0.3048, "in/s2": 0.0254,
    "mg": 0.001 * GRAVITY,
}  # fmt: skip
"""The common units, and one of each in m/s2; `find_acceleration_unit` takes multiples and other spellings too."""

USUAL_UNITS = ("g", "m/s2", "cm/s2", "mm/s2")
"""Units that most files are in; a gal is one cm/s2."""

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_MULTIPLE = re.compile(rf"({_NUMBER})(?:\s*/\s*({_NUMBER}))?\s*[*x]?\s*(\D.*)\Z")
_STATED = re.compile(
    r"(?<![\w/^*%.])(?:[mc]?m/s\^?2|[Gg](?:al|AL)|(?<=[(\[])[Gg](?=[)\]])|(?<=[Ii][Nn] )[Gg])(?![\w/^*'.]*\w)"
)
# m/s2, cm/s2, mm/s2, gal; g where it stands in brackets or behind "in".


def find_acceleration_unit(text: str) -> float | None:
    """Return one of the unit `text` in m/s2; None where it is no unit of acceleration.

    Read are `cm/s2`, `CM/SEC2`, `m/s^2`, `cm/sec/sec`, `g`, `gal`, and multiples: `0.01 g`, `3920/6182761 gal` (one
    count of a recorder).
    """
    multiple = 1.0
    unit = text.strip()
    if match := _MULTIPLE.match(unit):
        divisor = float(match[2] or 1.0)
        multiple = float(match[1]) / divisor if divisor else 0.0
        unit = match[3].strip()
    plain = unit.lower() if unit.lower() in ("g", "gal") else unit
    for spelling in (plain, plain.lower()):
        try:
            one = ACCELERATION_UNITS.get(spelling) or find_unit_factor(spelling, "m/s2")
        except ValueError:
            continue
        return multiple * one if one and 0 < multiple < 1e12 else None
    return None


def find_quantity(unit: str) -> str:
    """Return what a unit that is none of acceleration measures: velocity or displacement; "" for anything else."""
    try:
        _, dimension = parse_unit(unit.lower())
    except ValueError:
        return ""
    return {(0.0, 1.0, -1.0): "velocity", (0.0, 1.0, 0.0): "displacement"}.get(dimension, "")


def find_stated_units(line: str) -> list[str]:
    """Return the units of acceleration that stand on a line in one of five plain spellings: g, m/s2, cm/s2, gal, mm/s2.

    They are shown beside what is declared, and decide nothing.
    """
    return [match[0] for match in _STATED.finditer(line)]
