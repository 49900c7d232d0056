"""Tables and headings that are known: those of ETABS and SAP2000, and the names of quantities in any other table."""

from __future__ import annotations

from collections.abc import Mapping

HEIGHT_TABLES = ("Story Definitions", "Story Data")
MASS_TABLES = ("Mass Summary by Story",)
STIFFNESS_TABLES = ("Story Stiffness",)
PERIOD_TABLES = ("Modal Periods And Frequencies",)
RATIO_TABLES = ("Modal Participating Mass Ratios",)
CENTRE_TABLES = ("Centers Of Mass And Rigidity",)
PROGRAM_TABLES = (
    *HEIGHT_TABLES, *MASS_TABLES, *STIFFNESS_TABLES, *PERIOD_TABLES, *RATIO_TABLES, *CENTRE_TABLES,
)  # fmt: skip
"""Titles of the tables of ETABS; SAP2000 has those of modes."""

PROGRAM_HEADINGS: Mapping[str, tuple[str, ...]] = {
    "storey": ("Story", "Name"),
    "height": ("Height",),
    "elevation": ("Elevation",),
    "tower": ("Tower",),
    "case": ("Output Case", "Load Case", "Load Case/Combo", "Case", "Case/Combo"),
    "step type": ("Step Type",),
    "step": ("Step Number", "Step Num"),
    "mode": ("Mode", "Step Number", "Step Num"),
    "period": ("Period",),
    "ratio": ("U{direction}",),
    "mass": ("U{direction}",),
    "stiffness": ("Stiff{direction}", "Stiffness {direction}"),
    "shear": ("Shear {direction}",),
    "drift": ("Drift {direction}",),
    "mass centre": ("{across}CM",),
    "stiffness centre": ("{across}CR",),
}
"""Quantity -> its headings in the versions of these programs, along the direction of the row or across it."""

PLAIN_HEADINGS: Mapping[str, tuple[str, ...]] = {
    "storey": ("Storey", "Story"),
    "height": ("Height",),
    "mass": ("Mass",),
    "stiffness": ("Stiffness",),
    "yield shear": ("Yield shear",),
    "hardening": ("Hardening",),
    "elevation": ("Elevation",),
    "tower": ("Tower",),
    "drift": ("Drift",),
    "shear": ("Shear",),
    "case": ("Case",),
    "step": ("Step",),
}
"""Quantity of any other table -> the heading that needs no declaration: its name."""


def normalize_name(text: str) -> str:
    """Return the letters and digits of a name in lower case: `Stiff X` and `StiffX` are one."""
    return "".join(character for character in text.lower() if character.isalnum())


def list_headings(titles: tuple[str, ...], direction: str) -> dict[str, tuple[str, ...]]:
    """Return the headings that a table has, by quantity.

    titles : of the table and of its sheet
    direction : of the row, "X" or "Y"
    """
    is_known = any(is_named(title, name) for title in titles for name in PROGRAM_TABLES)
    across = "Y" if direction == "X" else "X"
    return {
        quantity: tuple(heading.format(direction=direction, across=across) for heading in headings)
        for quantity, headings in (PROGRAM_HEADINGS if is_known else PLAIN_HEADINGS).items()
    }


def is_named(title: str, name: str) -> bool:
    """Return whether the title of a table is a name; a sheet of a workbook holds at most 31 characters of it."""
    found = normalize_name(title)
    wanted = normalize_name(name)
    return found == wanted or (len(title) == 31 and wanted.startswith(found))
