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

_OF_GRAVITY = {
    "g": 1.0, "g's": 1.0, "%g": 0.01, "mg": 0.001, "millig": 0.001, "milli-g": 0.001, "ug": 1e-6,
}  # fmt: skip
_QUANTITIES = {(0.0, 1.0, -2.0): "acceleration", (0.0, 1.0, -1.0): "velocity", (0.0, 1.0, 0.0): "displacement"}
_WORDS = {"acc": "acceleration", "vel": "velocity", "disp": "displacement", "count": "counts"}
_NUMBER = r"((?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)"
_MULTIPLE = re.compile(rf"{_NUMBER}(?:/{_NUMBER})?\s*([^\d.].*)\Z", re.ASCII)
_PART = re.compile(rf"g/{_NUMBER}\Z", re.ASCII)


def acceleration_unit(text: str) -> float | None:
    """One of the unit `text` in m/s2; None where it is no unit of acceleration.

    Read are the names of `UNITS` in any case, spellings such as `cm/sec/sec`, `m/s^2`, `M S-2`, `g/10`, and
    multiples (`0.01 g`, `3920/6182761 gal`: what one count of a recorder is).
    """
    plain, factor = _plain(text), 1.0
    if found := _MULTIPLE.match(plain):
        factor, plain = float(found[1]) / (float(found[2] or 1.0) or math.inf), found[3]
    if found := _PART.match(plain):
        factor, plain = factor / (float(found[1]) or math.inf), "g"
    if plain in _OF_GRAVITY:
        factor *= _OF_GRAVITY[plain] * GRAVITY
    else:
        one, quantity = _measured(plain)
        factor *= one if quantity == "acceleration" else 0.0
    return factor if 0 < factor < math.inf else None


def quantity_of(text: str) -> str:
    """What a unit or a heading speaks of: acceleration, velocity, displacement, counts, or "" if unknown."""
    if acceleration_unit(text) is not None:
        return "acceleration"
    plain = _plain(text)
    return _measured(plain)[1] or next((_WORDS[start] for start in _WORDS if plain.startswith(start)), "")


def unit_in(words: str, others: tuple[str, ...] = ("velocity", "displacement", "counts")) -> str | None:
    """The unit of acceleration that a heading states, else the other quantity that it names: in brackets, or one or
    two of its words: `a [m/s^2]`, `Accel, mg`, `acc in 0.01 g`, `acc_g`, `acc_m_s2`, `v (cm/s)`, `velocity`."""
    inside, plain = BRACKETS.findall(words), re.sub(r"\s*/\s*", "/", BRACKETS.sub(" ", words))
    outside = [word for word in re.split(r"[\s,;:=_]+", plain) if word.lower() not in ("", "in")]
    pairs = [f"{one}{between}{other}" for between in " /" for one, other in pairwise(outside)]
    units = (word for word in (*inside, *pairs, *outside) if acceleration_unit(word))
    other = (word for word in (*inside, *outside) if quantity_of(word) in others)
    return next((word.strip(" .") for word in chain(units, other)), None)


def _plain(text: str) -> str:
    """Lower case, no brackets around, plain powers: `[CM/SEC²].` becomes `cm/sec2`, `ms⁻²` becomes `m/s2`."""
    plain = text.lower().translate(str.maketrans("µμ²⁻", "uu2-")).replace("feet", "ft").strip().rstrip(".")
    plain = re.sub(r"\A[(\[]\s*(.*?)\s*[)\]]\Z", r"\1", plain)
    return re.sub(r"\A(c?m)s(?:\^|\*\*)?-2\Z", r"\1/s2", plain)


def _measured(unit: str) -> tuple[float, str]:
    """One `unit` in SI, and its quantity, "" for one that is no length, velocity or acceleration."""
    try:
        one, dimension = measure(unit)
    except ValueError:
        return 0.0, ""
    return one, _QUANTITIES.get(dimension, "")
