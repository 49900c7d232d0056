"""The columns of the tables of a results file: meaning, and the unit that people read them in."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from pounding_cli.numbers import Unit
from pounding_cli.tables import Column
from pounding_cli.variables import COORDINATE_VARIABLES, VARIABLES

TABLES = (
    *("storey", "floor", "line", "link", "struck", "base", "scene"),
    *("flagged", "accuracy", "summary", "records", "buildings"),
)
"""The tables that every results file has."""

CONTACT_STIFFNESS_UNKNOWN = (
    "Floor accelerations and link forces of floors that strike depend on the contact stiffness, which is unknown: they "
    "grow with about its square root."
)
"""Note on accelerations and forces of floors that strike."""

_FURTHER = {
    "place": ("1", "place of the building from the left, from 1"),
    "records_used": ("1", "number of records with a V_ratio"),
    "records_flagged": ("1", "number of records whose scene carries a flag"),
    "records_meaningless": ("1", "number of records whose numbers have no meaning"),
    "records_collapsed": ("1", "number of records in which the building, or one linked to it, collapsed"),
    "code": ("", "the note of the flag: pound explain CODE"),
    "flag": ("", "what is flagged"),
    "detail": ("", "where, and by how much"),
    "severity": ("1", "larger where a flag of that kind is worse; none where its kind does not compare"),
    "meaningless": ("", "whether the numbers of the scene have no meaning"),
    "at": ("1", "height of the end of the link, such as a blow: part of the height of the storey"),
    "by": ("", "building at the other end of the link, such as that whose slab strikes"),
    "by_floor": ("1", "its floor"),
    "left": COORDINATE_VARIABLES["link_left"],
    "right": COORDINATE_VARIABLES["link_right"],
    "right_floor": COORDINATE_VARIABLES["link_right_floor"],
}
"""Columns that are no variables of the file: SI unit and meaning."""

_OPTIONAL_ENDINGS = {
    "summary": ("_error", "_sensitivity", "_std", "_min"),
    "scene": (
        *("advice", "flag_details", "flag_severity", "effects", "dropped", "dropped_links", "dropped_reasons"),
        *("_input", "_kinetic", "_stored", "_damping", "_hysteresis", "_links"),
    ),
    "records": ("digest",),
}
"""Table -> endings of the names of columns that are left out first where there is no room; CSV has them all."""

_COUNTS = ("impacts", "facing", "place", "records_used", "records_flagged", "records_meaningless", "records_collapsed")
"""Columns of whole numbers that files have as doubles, since some of their rows have none."""

_DISPLAY_UNITS = {
    "N": Unit("kN", 1e3),
    "m": Unit("mm", 1e-3),
    "J": Unit("kJ", 1e3),
    "N s": Unit("kN s", 1e3),
    "N/m": Unit("MN/m", 1e6),
    "kg": Unit("t", 1e3),
    "kg m2": Unit("t m²", 1e3),
    "N m": Unit("MN m", 1e6),
}
"""SI unit -> the one that people read."""

_DISPLAY_UNITS_OF_COLUMNS = {
    "seconds": Unit("ms", 1e-3),
    "contact_time": Unit("ms", 1e-3),
    "drift_ratio": Unit("%", 0.01),
    "height": Unit("m"),
    "window": Unit("s"),
    "period": Unit("s"),
    "arias": Unit("m/s"),
    "inclination": Unit("deg", math.pi / 180.0),
    "twist": Unit("mrad", 1e-3),
    "twist0": Unit("mrad", 1e-3),
    **dict.fromkeys(("edge_drift_ratio", "line_drift_ratio"), Unit("%", 0.01)),
    **dict.fromkeys(
        (
            *("plan_low", "plan_high", "plan_centre", "stiffness_centre"),
            *("line_street", "street", "line_x", "x", "left_arm", "right_arm"),
        ),
        Unit("m"),
    ),
}
"""Columns that are read in another unit than those of their kind."""


def column_of(name: str, units: Mapping[str, Unit] | None = None, table: str = "") -> Column:
    """Return a column of the tables of a results file, in the unit that people read it in.

    units : column -> the unit the study writes it in (`Results.units`); it comes before the usual one
    table : that has the column; the floor of a link is that of its left building, V and others of the table of lines
        are those of lines
    """
    kind = ""
    is_given = False
    label = name.replace("_", " ")
    variable = VARIABLES.get(name) or VARIABLES.get(f"record_{name}")
    if table == "line":
        variable = VARIABLES.get(f"line_{name}") or variable
    if name in _FURTHER or name in COORDINATE_VARIABLES:
        key = "link_floor" if (table, name) == ("link", "floor") else name
        si, text = {**COORDINATE_VARIABLES, **_FURTHER}[key]
        label = "floor right" if name == "right_floor" else label
    elif variable:
        si = variable.unit
        text = variable.text
        label = variable.label or label
        kind = variable.kind
    else:
        si = ""
        text = "swept; as in the study file, SI"
        label = name
        is_given = True
    unit = find_display_unit(name, Unit("" if si == "1" else si, 1.0, si), units)
    digits = 0 if kind == "i" or name in _COUNTS else 4
    is_optional = name.endswith(_OPTIONAL_ENDINGS.get(table, ()))
    return Column(name, text, unit, label, digits=digits, optional=is_optional, is_given=is_given)


def find_display_unit(name: str, unit: Unit, units: Mapping[str, Unit] | None = None) -> Unit:
    """Return the unit that people read a column in: that of the study, or kN and mm.

    unit : of the column, in SI
    """
    shown = (units or {}).get(name) or _DISPLAY_UNITS_OF_COLUMNS.get(name) or _DISPLAY_UNITS.get(unit.si, unit)
    return replace(shown, name=shown.name.replace("m/s2", "m/s²"), si=unit.si or shown.si)
