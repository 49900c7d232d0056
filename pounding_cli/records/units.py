"""Units of acceleration as motion files write them: what one is in m/s2, and what is no acceleration."""

from __future__ import annotations

import math
import re
from itertools import chain, pairwise

from pounding_cli.units import GRAVITY, measure

UNITS = {name: measure(name)[0] for name in ("m/s2", "cm/s2", "gal", "mm/s2", "ft/s2", "in/s2")}
UNITS = {"g": GRAVITY, **UNITS, "mg": 0.001 * GRAVITY}
"""The common units, and one of each in m/s2; other spellings and multiples are read too (`acceleration_unit`)."""

BRACKETS = re.compile(r"[(\[]([^()\[\]]*)[)\]]")
"""Words in brackets."""

_OF_GRAVITY = {"g": 1.0, "g's": 1.0, "%g": 0.01, "mg": 1e-3, "millig": 1e-3, "milli-g": 1e-3, "ug": 1e-6}
_QUANTITIES = {(0.0, 1.0, -2.0): "acceleration", (0.0, 1.0, -1.0): "velocity", (0.0, 1.0, 0.0): "displacement"}
_WORDS = {"acc": "acceleration", "vel": "velocity", "disp": "displacement", "count": "counts"}
_NUMBER = r"((?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)"
_MULTIPLE = re.compile(rf"(?:{_NUMBER}(?:/{_NUMBER})?\s*)?([^\d.].*?)(?:(?<=g)/{_NUMBER})?\Z", re.ASCII)


def quantity_of(text: str) -> tuple[str, float]:
    """What a unit or a heading speaks of (acceleration, velocity, displacement, counts, "" if unknown), and one of the
    unit in SI, 0 if that is unknown.

    Read are the names of `UNITS` in any case, spellings such as `cm/sec/sec`, `m/s^2`, `M S-2`, `g/10`, and multiples
    (`0.01 g`, `3920/6182761 gal`: what one count of a recorder is).
    """
    plain = text.lower().translate(str.maketrans("µμ²⁻", "uu2-")).replace("feet", "ft").strip().rstrip(".")
    plain = re.sub(r"\A[(\[]\s*(.*?)\s*[)\]]\Z", r"\1", plain)
    found = _MULTIPLE.match(re.sub(r"\A(c?m)s(?:\^|\*\*)?-2\Z", r"\1/s2", plain))
    if found is None:
        return "", 0.0
    times, over, unit, part = found.groups()
    factor = float(times or 1) / (float(over or 1) or math.inf) / (float(part or 1) or math.inf)
    if unit in _OF_GRAVITY:
        return "acceleration", factor * _OF_GRAVITY[unit] * GRAVITY
    try:
        one, dimension = measure(unit)
    except ValueError:
        return next((_WORDS[start] for start in _WORDS if unit.startswith(start)), ""), 0.0
    return _QUANTITIES.get(dimension, ""), factor * one


def acceleration_unit(text: str) -> float | None:
    """One of the unit `text` in m/s2; None where it is no unit of acceleration."""
    quantity, one = quantity_of(text)
    return one if quantity == "acceleration" and 0 < one < math.inf else None


def unit_in(words: str, others: tuple[str, ...] = ("velocity", "displacement", "counts")) -> str | None:
    """The unit of acceleration that a heading states, else the other quantity that it names: in brackets, or one or
    two of its words: `a [m/s^2]`, `Accel, mg`, `acc in 0.01 g`, `acc_g`, `acc_m_s2`, `v (cm/s)`, `velocity`."""
    inside, plain = BRACKETS.findall(words), re.sub(r"\s*/\s*", "/", BRACKETS.sub(" ", words))
    outside = [word for word in re.split(r"[\s,;:=_]+", plain) if word.lower() not in ("", "in")]
    pairs = [f"{one}{between}{other}" for between in " /" for one, other in pairwise(outside)]
    units = (word for word in (*inside, *pairs, *outside) if acceleration_unit(word))
    other = (word for word in (*inside, *outside) if quantity_of(word)[0] in others)
    return next((word.strip(" .") for word in chain(units, other)), None)
