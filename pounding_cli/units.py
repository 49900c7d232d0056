"""Units of measurement: one of a unit in SI, and its powers of kilogram, metre and second."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache

GRAVITY = 9.80665
"""Standard acceleration of gravity [m/s2]: the `g` of an acceleration."""

MAX_UNIT_LENGTH = 40
"""Characters of a unit."""

Dimension = tuple[float, float, float]
"""Powers of kg, m and s."""

_LENGTH, _TIME, _MASS, _PLAIN = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)
_UNITS = {
    "m": ("1", _LENGTH), "in": ("0.0254", _LENGTH), "ft": ("0.3048", _LENGTH),
    "s": ("1", _TIME), "sec": ("1", _TIME), "min": ("60", _TIME), "Hz": ("1", (0.0, 0.0, -1.0)),
    "g": ("0.001", _MASS), "t": ("1000", _MASS),
    "N": ("1", (1.0, 1.0, -2.0)), "Pa": ("1", (1.0, -1.0, -2.0)), "J": ("1", (1.0, 2.0, -2.0)),
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
_WEIGHT_OF_KILOGRAM = Fraction("9.80665")
_POUND_FORCE = _POUND * _WEIGHT_OF_KILOGRAM
_ONE |= {
    **dict.fromkeys(("inch", "inches"), (_INCH, _LENGTH)), **dict.fromkeys(("foot", "feet"), (12 * _INCH, _LENGTH)),
    "lb": (_POUND, _MASS), "lbf": (_POUND_FORCE, (1.0, 1.0, -2.0)),
    "kgf": (_WEIGHT_OF_KILOGRAM, (1.0, 1.0, -2.0)), "tonf": (1000 * _WEIGHT_OF_KILOGRAM, (1.0, 1.0, -2.0)),
    **dict.fromkeys(("kip", "kips"), (1000 * _POUND_FORCE, (1.0, 1.0, -2.0))),
    "psi": (_POUND_FORCE / _INCH**2, (1.0, -1.0, -2.0)), "ksi": (1000 * _POUND_FORCE / _INCH**2, (1.0, -1.0, -2.0)),
}  # fmt: skip
KNOWN_UNITS = (
    "m, cm, mm, km, in, ft; s, ms, min; kg, g, t, lb; N, kN, MN, kgf, tonf, lbf, kip; Pa, psi, ksi; J, kJ; "
    "Hz, Gal, rad, %"
)
"""The units that people write, with their prefixes, for messages."""
_NAME = re.compile(r"[A-Za-z]+|%")
_SEPARATOR = re.compile(r"\s*([*/·.]?)\s*")
_POWER = re.compile(r"(?:\*\*|\^)?(-?[0-9]{1,2}(?:\.[0-9]{1,3})?)|([²³])")

_PERCENT_POWER = re.compile(r"%\s*(?:\*\*|\^|[-0-9²³])")

_Powers = tuple[Fraction, Fraction, Fraction]
_Size = tuple[Fraction, float, _Powers]
# The part of a size that is exact, the part that is a root, and powers of kg, m and s.


@cache
def parse_unit(unit: str) -> tuple[float, Dimension]:
    """Return one `unit`, such as `kN/mm`, `N s/m`, `kN/(m/s)^0.3` or `1/s`, in SI, and its powers of kg, m and s.

    A slash divides by the next unit alone, or by what stands in brackets.

    Raises
    ------
    ValueError : for an unknown unit
    """
    text = unit.strip()
    is_percent_of_percent = "%" in text and (text.count("%") > 1 or _PERCENT_POWER.search(text) is not None)
    if not text or len(text) > MAX_UNIT_LENGTH or is_percent_of_percent:
        raise ValueError(unit)
    (exact, root, powers), end = _read_product(text, 2 if text.startswith("1/") else 0, text.startswith("1/"))
    if end < len(text):
        raise ValueError(unit)
    mass, length, time = map(float, powers)
    return float(exact) * root, (mass, length, time)


def _read_product(text: str, begin: int, divides: bool = False) -> tuple[_Size, int]:
    """Return the size of the product of units that begins at a place of a text, and where it ends.

    divides : whether its first unit is a divisor
    """
    exact = Fraction(1)
    root = 1.0
    powers = (Fraction(0), Fraction(0), Fraction(0))
    place = begin
    is_first = True
    while place < len(text) and text[place] != ")":
        separator = _SEPARATOR.match(text, place)
        sign = 1
        if separator is not None:
            if is_first and separator[1]:
                raise ValueError(text)
            sign = -1 if separator[1] == "/" or (is_first and divides) else 1
            place = separator.end()
        (size, size_of_root, own_powers), place = _read_factor(text, place)
        exact *= size**sign
        root *= size_of_root**sign
        mass, length, time = (old + sign * own for old, own in zip(powers, own_powers, strict=True))
        powers = mass, length, time
        is_first = False
        place += len(text[place:]) - len(text[place:].lstrip())
    if is_first:
        raise ValueError(text)
    return (exact, root, powers), place


def _read_factor(text: str, place: int) -> tuple[_Size, int]:
    """Return the size of one unit, or of a product in brackets, with its power, and where it ends."""
    name = _NAME.match(text, place)
    if text[place : place + 1] == "(":
        (exact, root, powers), place = _read_product(text, place + 1)
        if text[place : place + 1] != ")":
            raise ValueError(text)
        place += 1
    elif name is not None and name[0] in _ONE:
        exact, dimension = _ONE[name[0]]
        mass, length, time = map(Fraction, dimension)
        root = 1.0
        powers = (mass, length, time)
        place = name.end()
    else:
        raise ValueError(text)
    power_match = _POWER.match(text, place)
    if power_match is None:
        return (exact, root, powers), place
    power = Fraction(power_match[1]) if power_match[1] else Fraction({"²": 2, "³": 3}[power_match[2]])
    if power == 0:
        raise ValueError(text)
    mass, length, time = (power * each for each in powers)
    if power.denominator == 1:
        return (exact ** int(power), root ** int(power), (mass, length, time)), power_match.end()
    return (Fraction(1), float(exact) ** float(power) * root ** float(power), (mass, length, time)), power_match.end()


@cache
def find_unit_factor(unit: str, si: str) -> float | None:
    """One `unit` in the SI unit `si` ("" for plain numbers) [-]; None where its dimension is another.

    `g` is a gram, and the acceleration of gravity where `si` is m/s2.  Raises ValueError for an unknown unit.
    """
    if unit == "g" and si == "m/s2":
        return GRAVITY
    one, dimension = parse_unit(unit)
    return one if dimension == (parse_unit(si)[1] if si else _PLAIN) else None
