"""What every column of a table is: unit and meaning, for whoever reads it away from this program."""

from __future__ import annotations

from pounding_cli.variables import COORDINATES, VARIABLES

TABLES = ("storey", "floor", "link", "struck", "scene", "flagged", "accuracy", "summary", "records", "buildings")
"""The tables of `Results`."""

ANSWERS: dict[str, tuple[str, ...]] = {
    "gap": ("gap", "gap_cases", "property_line"),
    "fragility": ("fragility", "fragility_motions"),
    "sensitivity": (
        "sensitivity",
        "sensitivity_outputs",
        "sensitivity_probabilities",
        "sensitivity_samples",
    ),
    "optimise": ("optimise", "optimise_design", "optimise_points"),
}
"""The tables that commands add to a results file."""

_BARE = {
    "place": ("1", "place of the building from the left, from 1"),
    "records_used": ("1", "number of records with a V_ratio"),
    "records_flagged": ("1", "number of records whose scene carries a flag"),
    "records_meaningless": ("1", "number of records whose numbers have no meaning"),
    "records_collapsed": ("1", "number of records in whose scene a storey collapsed"),
    "flag": ("", "what is flagged"),
    "detail": ("", "where, and by how much"),
    "meaningless": ("", "whether the numbers of the scene have no meaning"),
    "at": ("1", "height of the blow: part of the height of the storey"),
    "by": ("", "building whose slab strikes"),
    "by_floor": ("1", "its floor"),
    "left": COORDINATES["link_left"],
    "right": COORDINATES["link_right"],
    "right_floor": COORDINATES["link_right_floor"],
}


def meaning(table: str, column: str) -> tuple[str, str]:
    """Unit (SI; "1" for a pure number, "" for text and swept keys) and meaning of a column of a table."""
    if table == "link" and column == "floor":
        return COORDINATES["link_floor"]
    if column in _BARE:
        return _BARE[column]
    if column in COORDINATES:
        return COORDINATES[column]
    for name in (column, f"record_{column}"):
        if name in VARIABLES:
            return VARIABLES[name].unit, VARIABLES[name].text
    return "", "swept; as in the study file, SI"
