"""Units of measurement: one of a unit in SI, and its powers of kilogram, metre and second."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache

GRAVITY = 9.80665
"""Standard acceleration of gravity [m/s2]: the `g` of an acceleration."""

LONGEST = 40
"""Characters of a unit."""

Dimension = tuple[float, float, float]
"""Powers of kg, m and s."""

_LENGTH, _TIME, _MASS, _PLAIN = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)
_UNITS = {
    "m": ("1", _LENGTH), "in": ("0.0254", _LENGTH), "ft": ("0.3048", _LENGTH),
    "s": ("1", _TIME), "sec": ("1", _TIME), "min": ("60", _TIME), "Hz": ("1", (0.0, 0.0, -1.0)),
    "g": ("0.001", _MASS), "t": ("1000", _MASS),
    "N": ("1", (1.0, 1.0, -2.0)), "Pa": ("1", (1.0, -1.0, -2.0)),
    "Gal": ("0.01", (0.0, 1.0, -2.0)), "gal": ("0.01", (0.0, 1.0, -2.0)),
    "%": ("0.01", _PLAIN), "rad": ("1", _PLAIN),
}  # fmt: skip
_PREFIXES = {"G": "1000000000", "M": "1000000", "k": "1000", "c": "0.01", "m": "0.001", "": "1"}
_ONE = {
    prefix + name: (Fraction(value) * Fraction(size), dimension)
    for prefix, size in _PREFIXES.items() for name, (value, dimension) in _UNITS.items()
}  # fmt: skip
# Where a name is two, as `min`, the one without prefix counts.
_POUND, _INCH = Fraction("0.45359237"), Fraction("0.0254")
_POUND_FORCE = _POUND * Fraction("9.80665")
_ONE |= {
    **dict.fromkeys(("inch", "inches"), (_INCH, _LENGTH)), **dict.fromkeys(("foot", "feet"), (12 * _INCH, _LENGTH)),
    "lb": (_POUND, _MASS), "lbf": (_POUND_FORCE, (1.0, 1.0, -2.0)),
    **dict.fromkeys(("kip", "kips"), (1000 * _POUND_FORCE, (1.0, 1.0, -2.0))),
    "psi": (_POUND_FORCE / _INCH**2, (1.0, -1.0, -2.0)), "ksi": (1000 * _POUND_FORCE / _INCH**2, (1.0, -1.0, -2.0)),
}  # fmt: skip
KNOWN_UNITS = "m, cm, mm, km, in, ft; s, ms, min; kg, g, t, lb; N, kN, MN, lbf, kip; Pa, psi, ksi; Hz, Gal, rad, %"
"""The units that people write, with their prefixes, for messages."""
_FACTOR = re.compile(r"\s*([*/·.]?)\s*([A-Za-z]+|%)(?:(?:\*\*|\^)?(-?[1-9](?:\.5)?)|([²³]))?\s*")


@cache
def measure(unit: str) -> tuple[float, Dimension]:
    """One `unit`, such as `kN/mm`, `N s/m` or `1/s`, in SI, and its powers of kg, m and s.

    Raises ValueError for an unknown unit.
    """
    text, exact, rounded, dimension = unit.strip(), Fraction(1), 1.0, _PLAIN
    at = 1 if text.startswith("1/") else 0
    if not text or len(text) > LONGEST:
        raise ValueError(unit)
    while at < len(text):
        found = _FACTOR.match(text, at)
        if found is None or (at == 0 and found[1]) or found[2] not in _ONE:
            raise ValueError(unit)
        power = float(found[3] or {"²": 2, "³": 3}.get(found[4], 1)) * (-1 if found[1] == "/" else 1)
        one, (mass, length, time) = _ONE[found[2]]
        if power.is_integer():
            exact *= one ** int(power)
        else:
            rounded *= float(one) ** power
        dimension = dimension[0] + power * mass, dimension[1] + power * length, dimension[2] + power * time
        at = found.end()
    return float(exact) * rounded, dimension


@cache
def factor(unit: str, si: str) -> float | None:
    """One `unit` in the SI unit `si` ("" for plain numbers) [-]; None where its dimension is another.

    `g` is a gram, and the acceleration of gravity where `si` is m/s2.  Raises ValueError for an unknown unit.
    """
    if unit == "g" and si == "m/s2":
        return GRAVITY
    one, dimension = measure(unit)
    return one if dimension == (measure(si)[1] if si else _PLAIN) else None
