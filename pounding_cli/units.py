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

_UNITS: dict[str, tuple[Fraction, Dimension]] = {
    name: (Fraction(factor), dimension)
    for names, factor, dimension in (
        ("m metre meter", "1", (0.0, 1.0, 0.0)),
        ("in inch", "0.0254", (0.0, 1.0, 0.0)),
        ("ft foot", "0.3048", (0.0, 1.0, 0.0)),
        ("s sec second", "1", (0.0, 0.0, 1.0)),
        ("min minute", "60", (0.0, 0.0, 1.0)),
        ("g gram", "0.001", (1.0, 0.0, 0.0)),
        ("t ton tonne", "1000", (1.0, 0.0, 0.0)),
        ("N newton", "1", (1.0, 1.0, -2.0)),
        ("Pa pascal", "1", (1.0, -1.0, -2.0)),
        ("Hz hertz", "1", (0.0, 0.0, -1.0)),
        ("Gal gal", "0.01", (0.0, 1.0, -2.0)),
        ("% pct percent", "0.01", (0.0, 0.0, 0.0)),
        ("rad radian", "1", (0.0, 0.0, 0.0)),
    )
    for name in names.split()
}
_PREFIXES = {
    "m": Fraction("0.001"),
    "c": Fraction("0.01"),
    "k": Fraction(10**3),
    "M": Fraction(10**6),
    "G": Fraction(10**9),
    "milli": Fraction("0.001"),
    "centi": Fraction("0.01"),
    "kilo": Fraction(10**3),
    "mega": Fraction(10**6),
    "giga": Fraction(10**9),
}
_FACTOR = re.compile(
    r"\s*(?P<sign>[*/·.]?)\s*(?P<open>\(?)\s*(?P<word>[A-Za-z]+|%)"
    r"(?:(?:\*\*|\^)?(?P<power>-?[1-9](?:\.5)?)|(?P<small>[²³]))?\s*(?P<close>\)?)"
)


@cache
def measure(unit: str) -> tuple[float, Dimension]:
    """One `unit`, such as `kN/mm`, `N s/m` or `1/s`, in SI, and its powers of kg, m and s.

    Raises ValueError for an unknown unit.
    """
    text, exact, rounded, dimension, at, inside = unit.strip(), Fraction(1), 1.0, (0.0, 0.0, 0.0), 0, 0
    if not text or len(text) > LONGEST:
        raise ValueError(unit)
    at = 1 if text.startswith("1/") else 0
    while at < len(text):
        found = _FACTOR.match(text, at)
        if found is None or (at == 0 and found["sign"]) or (found["open"] and inside):
            raise ValueError(unit)
        below = found["sign"] == "/"
        if found["open"]:
            inside, below = (-1 if below else 1), False
        sign = (-1 if below else 1) * (inside or 1)
        if found["close"]:
            if not inside:
                raise ValueError(unit)
            inside = 0
        power = sign * float(found["power"] or {"²": 2, "³": 3}.get(found["small"], 1))
        one, own = _one(found["word"])
        if power.is_integer():
            exact *= one ** int(power)
        else:
            rounded *= float(one) ** power
        dimension = (
            dimension[0] + power * own[0],
            dimension[1] + power * own[1],
            dimension[2] + power * own[2],
        )
        at = found.end()
    if inside:
        raise ValueError(unit)
    return float(exact) * rounded, dimension


@cache
def factor(unit: str, si: str) -> float | None:
    """One `unit` in the SI unit `si` ("" for plain numbers) [-]; None where its dimension is another.

    `g` is a gram, and the acceleration of gravity where `si` is m/s2.  Raises ValueError for an unknown unit.
    """
    if unit == "g" and si == "m/s2":
        return GRAVITY
    one, dimension = measure(unit)
    return one if dimension == (measure(si)[1] if si else (0.0, 0.0, 0.0)) else None


def _one(word: str) -> tuple[Fraction, Dimension]:
    """A single unit with its prefix and its plural, as `kilometres`."""
    for name in dict.fromkeys((word, word.removesuffix("s") if len(word) > 3 else word)):
        if name in _UNITS:
            return _UNITS[name]
        for prefix, size in _PREFIXES.items():
            if name.startswith(prefix) and name[len(prefix) :] in _UNITS and "%" not in name:
                value, dimension = _UNITS[name[len(prefix) :]]
                return value * size, dimension
    raise ValueError(word)
