"""Units as frame programs write them: in a row below the headings, in brackets behind a heading, or once for a file."""

from __future__ import annotations

import re
from functools import cache

from pounding_cli.errors import InputError
from pounding_cli.units import find_unit_factor, parse_unit

NO_UNITS = {"", "-", "text", "unitless", "yes/no"}
"""Cells of a row of units that name none."""

_SPELLINGS = {
    "n": "N", "kn": "kN", "mn": "MN", "lb": "lb", "lbf": "lbf", "kip": "kip", "kips": "kip", "kgf": "kgf",
    "tonf": "tonf", "kg": "kg", "t": "t", "m": "m", "mm": "mm", "cm": "cm", "in": "in", "ft": "ft", "s": "s",
    "sec": "s", "cyc": "rad", "rad": "rad",
}  # fmt: skip
"""Spelling in lower case -> unit of the program."""

SYSTEM_HINT = "give --units, force and length of the model, e.g. --units 'kN, m'"


@cache
def find_factor(text: str, si: str) -> float | None:
    """Return one unit of a program in the SI unit `si` [-]; None where it is unknown or of another dimension.

    A pound is a force where a mass is written with seconds and a length (`lb-s²/ft`), and in a stiffness.
    """
    unit = _normalize(text)
    for candidate in (unit, re.sub(r"\blb\b", "lbf", unit)):
        try:
            factor = find_unit_factor(candidate, si)
        except ValueError:
            continue
        if factor is not None:
            return factor
    return None


def is_unit(text: str) -> bool:
    """Return whether a cell is a unit, or says that there is none."""
    if text.strip().lower() in NO_UNITS:
        return True
    try:
        parse_unit(_normalize(text))
    except ValueError:
        return False
    return True


def is_same_unit(one: str, other: str) -> bool:
    """Return whether two texts are one unit: `kN/mm` and `MN/m`."""
    try:
        return parse_unit(_normalize(one)) == parse_unit(_normalize(other))
    except ValueError:
        return one.strip() == other.strip()


def parse_system(text: str) -> dict[str, float]:
    """Return the factors to SI of a system of units such as `kN, m`: by SI unit.

    Raises
    ------
    InputError : the text is not a force and a length
    """
    words = [word for word in re.split(r"[,;\s]+", text.strip()) if word]
    factors = [find_factor(word, si) for word, si in zip(words, ("N", "m"), strict=False)]
    if len(words) < 2 or None in factors:
        hint = "write the units of force and length of the model, e.g. --units 'kN, m'"
        raise InputError(f"--units '{text}' is not a force and a length", hint)
    force, length = (factor for factor in factors if factor is not None)
    return {"m": length, "N": force, "N/m": force / length, "kg": force / length, "s": 1.0}


def _normalize(text: str) -> str:
    """Return a unit in the spelling of studies: `KN-sec2/m` as `kN s2/m`."""
    spaced = re.sub(r"(?<=[\w²³])-(?=[A-Za-z])", " ", text.strip())
    return re.sub(r"[A-Za-z]+", lambda match: _respell(match[0]), spaced)


def _respell(word: str) -> str:
    """Return the name of one unit in the spelling of studies; a name that is known as it stands stays."""
    try:
        parse_unit(word)
    except ValueError:
        return _SPELLINGS.get(word.lower(), word)
    return word
