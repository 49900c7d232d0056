"""Tables: rows in SI units, with the meaning of every column and the unit that people read it in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from pounding_cli.numbers import Unit
from pounding_cli.variables import COORDINATE_VARIABLES, VARIABLES

if TYPE_CHECKING:
    import pandas as pd


TABLES = (
    *("storey", "floor", "link", "struck", "base", "scene"),
    *("flagged", "accuracy", "summary", "records", "buildings"),
)
"""The tables of `Results`."""

ANSWERS: dict[str, tuple[str, ...]] = {
    "gap": ("gap", "gap_cases", "property_line", "gap_rate"),
    "fragility": ("fragility", *(f"fragility_{end}" for end in ("motions", "curves", "rates", "contributions"))),
    "sensitivity": ("sensitivity", *(f"sensitivity_{end}" for end in ("outputs", "probabilities", "samples"))),
    "optimise": ("optimise", "optimise_design", "optimise_points"),
}
"""The tables that commands add to a results file."""


@dataclass(frozen=True)
class Column:
    """What a column means and how people read it.

    text : meaning
    unit : that people read it in; `unit.si` is "1" for a pure number, "" for a text
    label : what pages and figures call it
    """

    text: str = ""
    unit: Unit = field(default_factory=Unit)
    label: str = ""

    @property
    def head(self) -> str:
        """The label with its unit."""
        return self.unit.label(self.label)


@dataclass(frozen=True, eq=False)
class Table:
    """A table.

    name : of the table; "" of one that is shown and not kept
    frame : numbers in SI units, and texts; further lines of a text say where its number stands
    columns : meaning and unit of every column; of those left out what is known of the column of that name
    caption : what it is
    """

    name: str
    frame: pd.DataFrame
    columns: Mapping[str, Column] = field(default_factory=dict)
    caption: str = ""


_OTHERS = {
    "place": ("1", "place of the building from the left, from 1"),
    "records_used": ("1", "number of records with a V_ratio"),
    "records_flagged": ("1", "number of records whose scene carries a flag"),
    "records_meaningless": ("1", "number of records whose numbers have no meaning"),
    "records_collapsed": ("1", "number of records in whose scene a storey collapsed"),
    "flag": ("", "what is flagged"),
    "detail": ("", "where, and by how much"),
    "severity": ("1", "larger where a flag of that kind is worse; none where its kind does not compare"),
    "meaningless": ("", "whether the numbers of the scene have no meaning"),
    "at": ("1", "height of the blow: part of the height of the storey"),
    "by": ("", "building whose slab strikes"),
    "by_floor": ("1", "its floor"),
    "left": COORDINATE_VARIABLES["link_left"],
    "right": COORDINATE_VARIABLES["link_right"],
    "right_floor": COORDINATE_VARIABLES["link_right_floor"],
}
"""Columns that are no variables of the file."""


def column_of(name: str, table: str = "") -> Column:
    """What a column of a table of `Results` means, in SI units; "" of text and swept keys."""
    if name in _OTHERS or name in COORDINATE_VARIABLES:
        si, text = {**COORDINATE_VARIABLES, **_OTHERS}["link_floor" if (table, name) == ("link", "floor") else name]
        label = "floor right" if name == "right_floor" else name.replace("_", " ")
    elif variable := VARIABLES.get(name) or VARIABLES.get(f"record_{name}"):
        si, text, label = variable.unit, variable.text, variable.label or name.replace("_", " ")
    else:
        si, text, label = "", "swept; as in the study file, SI", name
    return Column(text, Unit("" if si == "1" else si, 1.0, si), label)
