"""How a report shows each column of the tables: its name, the unit an engineer reads it in, what it means."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from pounding_cli.numbers import Unit
from pounding_cli.variables import COORDINATES, VARIABLES


@dataclass(frozen=True)
class Shown:
    """One column.

    label : name in figures and on the page
    unit : unit shown; "–" for a pure number, "" for text and counts
    factor : what the SI number is multiplied by
    text : meaning, in words
    """

    label: str
    unit: str = ""
    factor: float = 1.0
    text: str = ""


_UNITS = {"N": ("kN", 1e-3), "m": ("mm", 1e3), "J": ("kJ", 1e-3), "N s": ("kN s", 1e-3), "m/s2": ("m/s²", 1.0)}
_UNITS |= {"N/m": ("MN/m", 1e-6), "kg": ("t", 1e-3), "1": ("–", 1.0)}
_COUNTS = ("impacts", "steps", "events", "orders", "storey", "floor", "place", "records_used")
_LARGE = ("height", "window", "period", "pga", "arias")
"""Columns whose SI unit is already the one they are read in."""

_LABELS = {v.name.removeprefix("record_"): v.label for v in VARIABLES.values() if v.label}
_LABELS |= {"right_floor": "floor right"}
_TEXTS = {v.name: v.brief for v in VARIABLES.values() if v.brief} | {"V_ratio_mean": "mean over the motions"}
_ASIDE = {
    "seconds": ("ms", 1e3), "contact_time": ("ms", 1e3), "error_estimate": ("–", 1.0), "sensitivity": ("–", 1.0),
    "drift_ratio": ("%", 100.0),
}  # fmt: skip
_STATISTICS = {"mean": "mean", "std": "std", "min": "min", "max": "max", "error": "error", "sensitivity": "sensitivity"}
_RELATIVE = ("error", "sensitivity")
"""Statistics without the unit of their column."""


def shown(key: str, units: Mapping[str, Unit] | None = None) -> Shown:
    """What is known of a column; of one that is not, its own name.

    units : column -> the unit the study writes it in (`Results.units`); it comes before the usual one
    """
    if units and key in units:
        written = units[key]
        return replace(shown(key), unit=written.name.replace("m/s2", "m/s²"), factor=1 / written.factor)
    base, _, statistic = key.rpartition("_")
    if statistic in _STATISTICS and base in VARIABLES:
        of = shown(base)
        unit, factor = ("–", 1.0) if statistic in _RELATIVE else (of.unit, of.factor)
        return Shown(f"{of.label} {_STATISTICS[statistic]}", unit, factor, _meaning(key) or of.text)
    label = key if "." in key else _LABELS.get(key, key.replace("_", " "))  # a swept key stays as it is written
    if key in _COUNTS:
        return Shown(label, "", 1.0, _meaning(key))
    if key in _ASIDE:
        return Shown(label, *_ASIDE[key], _meaning(key))
    variable = VARIABLES.get(key) or VARIABLES.get(f"record_{key}")
    if variable is None or not variable.unit:
        return Shown(label, "", 1.0, _meaning(key))
    unit, factor = (variable.unit.replace("m/s2", "m/s²"), 1.0) if key in _LARGE else _known(variable.unit)
    return Shown(label, unit, factor, _meaning(key))


def _known(unit: str) -> tuple[str, float]:
    return _UNITS.get(unit, (unit, 1.0))


def _meaning(key: str) -> str:
    if key in _TEXTS:
        return _TEXTS[key]
    variable = VARIABLES.get(key) or VARIABLES.get(f"record_{key}")
    return variable.text if variable else COORDINATES.get(key, ("", ""))[1]
