"""Storeys of a building from the tables of a frame program: their names, heights and masses from the ground up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.imports.building import Choices, ImportedBuilding
from pounding_cli.imports.dynamics import read_eccentricity, read_period
from pounding_cli.imports.headings import (
    ELEVATION_HEADINGS,
    HARDENING_HEADINGS,
    HEADINGS_OF_DIRECTION,
    HEIGHT_HEADINGS,
    HEIGHT_TABLES,
    MASS_TABLES,
    STIFFNESS_TABLES,
    STOREY_HEADINGS,
    YIELD_SHEAR_HEADINGS,
)
from pounding_cli.imports.rows import get_row, read_positive, select_tower
from pounding_cli.imports.stiffness import read_stiffness
from pounding_cli.imports.storey_order import find_base_order, find_base_order_in_masses, find_order, find_shears
from pounding_cli.imports.tables import ProgramColumn, ProgramRow, ProgramTable, TableFile, normalize_name
from pounding_cli.reading import shorten_path
from pounding_cli.texts import escape_controls


def read_building(tables: TableFile, choices: Choices, needs_stiffness: bool = True) -> ImportedBuilding:
    """Return a building from tables of a frame program, or from one plain table of storeys.

    needs_stiffness : False where the stiffnesses come from elsewhere

    Raises
    ------
    InputError : a table, column, row or number is missing or wrong, by name
    """
    quantities = HEADINGS_OF_DIRECTION[choices.direction]
    plain = _find_plain_table(tables, choices, needs_stiffness)
    if plain is not None:
        building = _read_plain_table(plain, choices, needs_stiffness)
    else:
        _refuse_missing_tables(tables, needs_stiffness)
        building = _read_storeys(tables, choices)
        if needs_stiffness:
            table = _get_table(tables, STIFFNESS_TABLES)
            read_stiffness(table, table.get_column(quantities["stiffness"][:2], "storey stiffness"), building, choices)
    read_eccentricity(tables, building, choices)
    read_period(tables, building, choices)
    return building


def _refuse_missing_tables(tables: TableFile, needs_stiffness: bool) -> None:
    """Raise InputError with every table that is missing, by name."""
    wanted = [
        (HEIGHT_TABLES, "'Story Definitions' or 'Story Data'", "the storey heights"),
        (MASS_TABLES, "'Mass Summary by Story'", "the masses of the floors"),
    ]
    if needs_stiffness:
        wanted.append((STIFFNESS_TABLES, "'Story Stiffness'", "the storey stiffnesses"))
    problems = []
    for names, shown, meaning in wanted:
        if tables.find_table(names) is None:
            hint = f"export it too, {meaning}; a plain table has the columns storey, height, mass, stiffness"
            message = f"no table {shown} ({meaning}); the file has {tables.list_titles()}"
            problems.append(Problem(message, hint, shorten_path(tables.path)))
    if problems:
        raise InputError(problems)


def _get_table(tables: TableFile, names: Sequence[str]) -> ProgramTable:
    table = tables.find_table(names)
    assert table is not None
    return table


def _find_plain_table(tables: TableFile, choices: Choices, needs_stiffness: bool) -> ProgramTable | None:
    """Return a table that has storeys, heights and masses together; None where there is none."""
    quantities = HEADINGS_OF_DIRECTION[choices.direction]
    wanted = [STOREY_HEADINGS, HEIGHT_HEADINGS, quantities["mass"]]
    if tables.find_table(HEIGHT_TABLES) is not None:
        return None
    with_stiffness = tables.find_table_with(*wanted, quantities["stiffness"])
    if with_stiffness is not None or needs_stiffness:
        return with_stiffness or tables.find_table_with(*wanted)
    return tables.find_table_with(*wanted)


def _read_plain_table(table: ProgramTable, choices: Choices, needs_stiffness: bool) -> ImportedBuilding:
    """Return a building from one table with a row for each storey.  Raises InputError."""
    quantities = HEADINGS_OF_DIRECTION[choices.direction]
    storey = table.get_column(STOREY_HEADINGS, "name of the storey")
    rows = select_tower(table, table.rows, choices)
    columns = {
        "height": (table.get_column(HEIGHT_HEADINGS, "storey height"), "m"),
        "mass": (table.get_column(quantities["mass"], "mass of the floor"), "kg"),
    }
    if needs_stiffness:
        columns["stiffness"] = (table.get_column(quantities["stiffness"], "storey stiffness"), "N/m")
    for key, headings, si in (("yield_shear", YIELD_SHEAR_HEADINGS, "N"), ("hardening", HARDENING_HEADINGS, "")):
        column = table.find_column(headings)
        if column is not None and needs_stiffness:
            columns[key] = (column, si)
    names = [table.read_text(row, storey) for row in rows]
    _refuse_twice(table, rows, storey, names)
    place_of, reason = find_order(table, rows, storey, names, [], choices)
    ordered = [rows[place] for place in place_of]
    values: dict[str, Any] = {}
    notes = [f"order of the storeys: {reason}"]
    for key, (column, si) in columns.items():
        values[key] = np.array([read_positive(table, row, column, si, key == "hardening") for row in ordered])
        notes.append(f"{key.replace('_', ' ')}: {table.describe_column(column)}")
    return ImportedBuilding(tuple(names[place] for place in place_of), notes=notes, **values)


def _read_storeys(tables: TableFile, choices: Choices) -> ImportedBuilding:
    """Return heights and masses from the tables of ETABS.  Raises InputError."""
    table = _get_table(tables, HEIGHT_TABLES)
    storey = table.get_column(STOREY_HEADINGS, "name of the storey")
    height = table.get_column(HEIGHT_HEADINGS, "storey height")
    rows = [row for row in select_tower(table, table.rows, choices) if table.read_text(row, storey)]
    bases = [row for row in rows if _is_base(table, row, storey, height)]
    above = [row for row in rows if row not in bases]
    names = [table.read_text(row, storey) for row in above]
    if not above:
        raise table.refuse("has no storey", "export it with a row for each storey")
    _refuse_twice(table, above, storey, names)
    mass_table = _get_table(tables, MASS_TABLES)
    mass_rows = select_tower(mass_table, mass_table.rows, choices)
    mass_storey = mass_table.get_column(STOREY_HEADINGS, "name of the storey")
    mass_names = [mass_table.read_text(row, mass_storey) for row in mass_rows]
    _refuse_twice(mass_table, mass_rows, mass_storey, mass_names)
    base_order = find_base_order(rows, bases) or find_base_order_in_masses(mass_names, names)
    place_of, reason = find_order(table, above, storey, names, base_order, choices, find_shears(tables, names, choices))
    ordered = [above[place] for place in place_of]
    ordered_names = tuple(names[place] for place in place_of)
    heights = np.array([read_positive(table, row, height, "m") for row in ordered])
    mass_column = mass_table.get_column(HEADINGS_OF_DIRECTION[choices.direction]["mass"][:3], "mass of the floor")
    by_name = dict(zip(mass_names, mass_rows, strict=True))
    masses = [
        read_positive(mass_table, get_row(mass_table, by_name, name), mass_column, "kg") for name in ordered_names
    ]
    building = ImportedBuilding(ordered_names, heights, np.array(masses))
    building.notes = [
        f"order of the storeys: {reason}",
        f"height: {table.describe_column(height)}",
        f"mass: {mass_table.describe_column(mass_column)}",
    ]
    for name in mass_names:
        if name not in ordered_names:
            ground_mass = mass_table.read_quantity(by_name[name], mass_column, "kg")
            building.notes.append(
                f"{ground_mass / 1e3:.6g} t of '{escape_controls(name)}' move with the ground, left out"
            )
    _check_elevations(table, ordered, height)
    return building


def _check_elevations(table: ProgramTable, ordered: Sequence[ProgramRow], height: ProgramColumn) -> None:
    """Make sure that elevations, where a table has them, are the sums of the heights.  Raises InputError."""
    column = table.find_column(ELEVATION_HEADINGS)
    if column is None:
        return
    elevations = [table.read_quantity(row, column, "m") for row in ordered]
    for below, above, row in zip(elevations, elevations[1:], ordered[1:], strict=False):
        storey_height = table.read_quantity(row, height, "m")
        if abs(above - below - storey_height) > 2e-3 + 1e-3 * storey_height:
            rise = f"the elevation is {above - below:.6g} m above that of the storey below"
            raise table.refuse(f"{rise}, the height {storey_height:.6g} m", "correct one of the two", row, column)


def _is_base(table: ProgramTable, row: ProgramRow, storey: ProgramColumn, height: ProgramColumn) -> bool:
    """Return whether a row is the base, which has no storey below it."""
    if table.read_text(row, height) not in ("", "0"):
        return False
    elevation = table.find_column(ELEVATION_HEADINGS)
    if elevation is None:
        return normalize_name(table.read_text(row, storey)) == "base"
    lowest = min(table.read_number(each, elevation) for each in table.rows)
    return table.read_number(row, elevation) == lowest


def _refuse_twice(table: ProgramTable, rows: Sequence[ProgramRow], storey: ProgramColumn, names: Sequence[str]) -> None:
    """Raise InputError where a storey stands twice, or has no name."""
    for place, name in enumerate(names):
        if not name:
            raise table.refuse("is empty", "write the name of the storey", rows[place], storey)
        if name in names[:place]:
            first = rows[names.index(name)][0]
            message = f"storey '{escape_controls(name)}' stands in row {first} too"
            raise table.refuse(message, "leave one row for each storey", rows[place], storey)
