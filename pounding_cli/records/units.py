"""Units of acceleration as people and files write them: what one is in m/s2, and what is no acceleration."""

from __future__ import annotations

import math
import re

from pounding_cli.records.motion import GRAVITY

UNITS: dict[str, float] = {
    "g": GRAVITY,
    "m/s2": 1.0,
    "cm/s2": 0.01,
    "gal": 0.01,
    "mm/s2": 0.001,
    "ft/s2": 0.3048,
    "in/s2": 0.0254,
    "mg": 0.001 * GRAVITY,
}
"""The common units, and one of each in m/s2; other spellings and multiples are read too (`acceleration_unit`)."""

_LENGTHS = {
    "m": 1.0, "meter": 1.0, "metre": 1.0, "meters": 1.0, "metres": 1.0, "cm": 0.01, "mm": 0.001, "um": 1e-6,
    "ft": 0.3048, "feet": 0.3048, "in": 0.0254, "inch": 0.0254,
}  # fmt: skip
_OTHERS = {
    "%g": 0.01 * GRAVITY, "ug": 1e-6 * GRAVITY, "mgal": 1e-5, "millig": 0.001 * GRAVITY, "milli-g": 0.001 * GRAVITY,
    "g's": GRAVITY, "gals": 0.01, "ms2": 1.0, "mps2": 1.0, "cms2": 0.01, "cmps2": 0.01,
}  # fmt: skip
_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
_MULTIPLE = re.compile(rf"(?P<top>{_NUMBER})(?:/(?P<bottom>{_NUMBER}))?(?P<unit>[^\d.].*)\Z")
_PART = re.compile(rf"g/(?P<part>{_NUMBER})\Z")
_PER_TIME = re.compile(rf"(?P<length>{'|'.join(_LENGTHS)})(?P<per>/s/s|/s2|/ss|s-2|/s|s-1|)\Z")


def acceleration_unit(text: str) -> float | None:
    """One of the unit `text` in m/s2; None where it is no unit of acceleration.

    Read are the names of `UNITS` in any case, spellings such as `cm/sec/sec`, `m/s^2`, `M S-2`, `g/10`, and
    multiples (`0.01 g`, `3920/6182761 gal`: what one count of a recorder is).
    """
    plain = _plain(text)
    multiple = _MULTIPLE.match(plain)
    factor = 1.0
    if multiple:
        factor = float(multiple["top"]) / (float(multiple["bottom"] or 1.0) or math.inf)
        plain = multiple["unit"]
    part = _PART.match(plain)
    if part:
        factor, plain = factor / (float(part["part"]) or math.inf), "g"
    one = UNITS.get(plain, _OTHERS.get(plain))
    if one is None:
        found = _PER_TIME.match(plain)
        if not found or _order(found["per"]) != 2:
            return None
        one = _LENGTHS[found["length"]]
    return factor * one if 0 < factor * one < math.inf else None


def quantity_of(text: str) -> str:
    """What a unit or a heading speaks of: acceleration, velocity, displacement, counts, or "" if unknown."""
    plain = _plain(text)
    if acceleration_unit(text) is not None:
        return "acceleration"
    found = _PER_TIME.match(plain)
    if found:
        return ("displacement", "velocity")[_order(found["per"])]
    for start, quantity in (
        ("acc", "acceleration"),
        ("vel", "velocity"),
        ("disp", "displacement"),
        ("count", "counts"),
    ):
        if plain.startswith(start):
            return quantity
    return ""


def _plain(text: str) -> str:
    """Lower case, no blanks, `s` for second, plain powers: `CM/SEC**2.` becomes `cm/s2`."""
    plain = text.strip().lower().replace("µ", "u").replace("μ", "u").replace("²", "2").replace("⁻", "-")
    plain = re.sub(r"(?<![a-z])sec(?:ond)?s?(?![a-z])", "s", plain)
    return re.sub(r"[\s*^·()\[\]]|\.+\Z|(?<=[a-z])\.(?=[a-z])", "", plain)


def _order(per: str) -> int:
    """How many times the length is divided by time."""
    return {"": 0, "/s": 1, "s-1": 1}.get(per, 2)
