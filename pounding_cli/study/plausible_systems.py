"""What studies of two oscillators and of the bumper wall may say but hardly mean: their ranges, by key."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pydantic import BaseModel

from pounding_cli.study.file import Map, Problems, get
from pounding_cli.study.plausible import RANGES, Plausible, doubt

_LENGTHS = {"cm": 1e-2, "m": 1.0, "mm": 1e-3}
_SECTION = Plausible(0.05, 3.0, "beams and columns of buildings are 5 cm to 3 m wide and deep", _LENGTHS)
_PERIOD = replace(RANGES["period"], units={"s": 1.0})
_MASS, _HEIGHT, _DAMPING = RANGES["floor mass"], RANGES["storey height"], RANGES["damping ratio"]

CONNECTOR = {
    "first.mass": _MASS,
    "second.mass": _MASS,
    "first.period": _PERIOD,
    "second.period": _PERIOD,
    "second.frequency_ratio": Plausible(0.05, 20.0, "neighbours differ in frequency by a factor of a few", {"": 1.0}),
    "damping": _DAMPING,
    "first.damping": _DAMPING,
    "second.damping": _DAMPING,
}
"""Plausible values of a study of `pound connector`; the periods also where mass and stiffness give them."""

WALL = {
    "wall.length": Plausible(0.1, 30.0, "bumper walls are decimetres to metres long", _LENGTHS),
    "wall.thickness": Plausible(0.05, 2.0, "concrete walls are 5 cm to 2 m thick", _LENGTHS),
    "frame.storey_height": _HEIGHT,
    "frame.beam.width": _SECTION,
    "frame.beam.depth": _SECTION,
    "frame.column.width": _SECTION,
    "frame.column.depth": _SECTION,
    "frame.floor_mass": _MASS,
    "concrete.young": Plausible(
        1e9, 3e11, "concrete has 20 to 50 GPa, steel 210 GPa", {"GPa": 1e9, "MPa": 1e6, "N/m2": 1.0}
    ),
    "concrete.density": Plausible(500.0, 10e3, "concrete weighs 2400 kg a cubic metre, steel 7850", {"kg/m3": 1.0}),
    "striker.mass": _MASS,
    "striker.speed": Plausible(
        0.01, 10.0, "floors meet at decimetres to a few metres a second", {"m/s": 1.0, "cm/s": 0.01}
    ),
    "contact.patch": Plausible(0.01, 3.0, "slabs are 10 to 50 cm thick", _LENGTHS),
    "time.end": Plausible(1e-3, 10.0, "an impact lasts milliseconds to tenths of a second", {"s": 1.0, "ms": 1e-3}),
}
"""Plausible values of a study of `pound wall`."""


def doubt_spec(spec: BaseModel, ranges: Mapping[str, Plausible], root: Map, notes: Problems) -> None:
    """Note what is unlikely in a study at one point of its sweep, of the keys that it says."""
    for key, fits in ranges.items():
        path = tuple(key.split("."))
        value: Any = spec
        for step in path:
            value = getattr(value, step)
        if value is not None and get(root, *path) is not None:
            doubt(_words(key), fits, float(value), root, path, notes)


def doubt_period(period: float, who: str, root: Map, notes: Problems) -> None:
    """Note a period [s] that mass and stiffness of the system `who` (first, second) give it."""
    fits = RANGES["period"]
    if not fits.holds(period):
        message = f"mass and stiffness give the {who} system a period of {period:.3g} s: {fits.reason}"
        hint = "check the units of both; otherwise leave it, the study runs as it is"
        notes.at(root, (who, "stiffness"), message, hint)


def _words(key: str) -> str:
    """A key as it is spoken of: "striker speed"."""
    return re.sub(r"[._]", " ", key)
