"""Storeys of a building from the tables of a frame program: their names, heights and masses from the ground up."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.imports.building import Choices, ImportedBuilding
from pounding_cli.imports.dynamics import read_eccentricity, read_period
from pounding_cli.imports.headings import (
    HEIGHT_TABLES,
    MASS_TABLES,
    PERIOD_TABLES,
    STIFFNESS_TABLES,
    normalize_name,
)
from pounding_cli.imports.rows import get_row, leave_out_totals, read_positive, select_tower
from pounding_cli.imports.stiffness import read_stiffness
from pounding_cli.imports.storey_order import (
    find_base_order,
    find_base_order_in_masses,
    find_numbers,
    find_order,
    find_shears,
)
from pounding_cli.imports.tables import ProgramColumn, ProgramRow, ProgramTable, TableFile
from pounding_cli.numbers import join_limited
from pounding_cli.reading import shorten_path
from pounding_cli.texts import escape_controls

BELOW_GROUND = r"-\s*\d+|.*\s-\d+|.*(basement|cellar|underground|below ground).*"
"""Names of storeys that lie below the ground."""

BELOW_GROUND_HINT = (
    "a study has one ground for all buildings, on which the lowest storey stands here: take the storeys below the "
    "ground out of the tables, unless the neighbour has them too"
)
"""What to do about storeys below the ground."""


def read_building(tables: TableFile, choices: Choices, needs_stiffness: bool = True) -> ImportedBuilding:
    """Return a building from tables of a frame program, or from one plain table of storeys.

    needs_stiffness : False where the stiffnesses come from elsewhere

    Raises
    ------
    InputError : a table, column, row or number is missing or wrong, by name
    """
    plain = _find_plain_table(tables, needs_stiffness)
    if plain is not None:
        building = _read_plain_table(plain, choices, needs_stiffness)
    else:
        _refuse_missing_columns(tables, needs_stiffness)
        _refuse_missing_tables(tables, needs_stiffness)
        building = _read_storeys(tables, choices)
        if needs_stiffness:
            table = _get_table(tables, STIFFNESS_TABLES)
            read_stiffness(table, table.get_column("stiffness", "storey stiffness"), building, choices)
    read_eccentricity(tables, building, choices)
    read_period(tables, building, choices)
    if choices.tower:
        building.notes.append(f"tower: {escape_controls(choices.tower)}")
    _refuse_options_without_effect(tables, choices)
    warn_three_decimals(tables, building)
    _warn_below_ground(building)
    return building


def _refuse_options_without_effect(tables: TableFile, choices: Choices) -> None:
    """Raise InputError where a tower or mode is chosen and no table has any."""
    if choices.tower and not any(table.find_column("tower") for table in tables.tables):
        message = f"no table has a column Tower, so that --tower {escape_controls(choices.tower)} has no effect"
        raise InputError(Issue((), message, "leave --tower out", file=shorten_path(tables.path)))
    if choices.mode is not None and tables.find_table(PERIOD_TABLES) is None:
        message = f"there is no table '{PERIOD_TABLES[0]}', so that --mode {choices.mode} has no effect"
        raise InputError(Issue((), message, "export it too, or leave --mode out", file=shorten_path(tables.path)))


def warn_three_decimals(tables: TableFile, building: ImportedBuilding) -> None:
    """Warn where every point of a text file may part thousands, as it does where commas are decimal signs."""
    for path in dict.fromkeys(table.path for table in tables.tables if table.may_have_thousands):
        building.warnings.append(
            f"three digits stand behind every point of {shorten_path(path)}; it is taken for a decimal sign, as "
            "--decimal '.' says; where it parts thousands, give --thousands '.'"
        )


def _warn_below_ground(building: ImportedBuilding) -> None:
    """Warn of storeys whose names say that they lie below the ground, where the elevations have not told so already."""
    names = [name for name in building.names if re.fullmatch(BELOW_GROUND, name, re.IGNORECASE)]
    if names and not any("below the ground" in warning for warning in building.warnings):
        listed = join_limited([escape_controls(name) for name in names], 200)
        verb = "sounds" if len(names) == 1 else "sound"
        building.warnings.append(f"{listed} {verb} as if below the ground; {BELOW_GROUND_HINT}")


def _refuse_missing_columns(tables: TableFile, needs_stiffness: bool) -> None:
    """Raise InputError with the columns that a plain table lacks, unless the file has tables of a frame program."""
    if any(tables.find_table(names) for names in (HEIGHT_TABLES, MASS_TABLES, STIFFNESS_TABLES)):
        return
    wanted = {"storey": "name of the storey", "height": "storey height", "mass": "mass of the floor"}
    if needs_stiffness:
        wanted["stiffness"] = "storey stiffness"
    counts = [sum(table.find_column(each) is not None for each in wanted) for table in tables.tables]
    best = int(np.argmax(counts))
    is_one_table = len(tables.tables) == 1 and needs_stiffness
    if counts[best] < 2 and not is_one_table:
        return
    problems: list[Issue] = []
    for quantity, meaning in wanted.items():
        try:
            tables.tables[best].get_column(quantity, meaning)
        except InputError as error:
            problems += error.issues
    if problems:
        raise InputError(problems)


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
            hint = f"export it too, {meaning}; a plain table has the columns storey, height, mass"
            hint += ", stiffness" if needs_stiffness else ": --storeys storeys.csv"
            message = f"no table {shown} ({meaning}); the file has {tables.list_titles()}"
            problems.append(Issue((), message, hint, file=shorten_path(tables.path)))
    if problems:
        raise InputError(problems)


def _get_table(tables: TableFile, names: Sequence[str]) -> ProgramTable:
    table = tables.find_table(names)
    assert table is not None
    return table


def _find_plain_table(tables: TableFile, needs_stiffness: bool) -> ProgramTable | None:
    """Return a table that has storeys, heights and masses together; None where there is none."""
    if tables.find_table(HEIGHT_TABLES) is not None:
        return None
    wanted = ("storey", "height", "mass")
    with_stiffness = tables.find_table_with(*wanted, "stiffness") if needs_stiffness else None
    return with_stiffness or tables.find_table_with(*wanted)


def _read_plain_table(table: ProgramTable, choices: Choices, needs_stiffness: bool) -> ImportedBuilding:
    """Return a building from one table with a row for each storey.  Raises InputError."""
    for option, value in (("--case", choices.case), ("--step", choices.step)):
        if value and needs_stiffness:
            message = f"has a row for each storey and no load cases, so that {option} {value} has no effect"
            raise table.refuse(message, f"leave {option} out")
    storey = table.get_column("storey", "name of the storey")
    rows, notes = leave_out_totals(table, select_tower(table, table.rows, choices), storey)
    if not rows:
        raise table.refuse("has no row of a storey", "write one for each storey below the headings")
    columns = {
        "height": (table.get_column("height", "storey height"), "m"),
        "mass": (table.get_column("mass", "mass of the floor"), "kg"),
    }
    if needs_stiffness:
        columns["stiffness"] = (table.get_column("stiffness", "storey stiffness"), "N/m")
    for quantity, si in (("yield shear", "N"), ("hardening", "")):
        if table.find_column(quantity) is not None and needs_stiffness:
            columns[quantity] = (table.get_column(quantity, quantity), si)
    names = [table.read_text(row, storey) for row in rows]
    _refuse_twice(table, rows, storey, names)
    place_of, reason = find_order(table, rows, storey, names, [], choices)
    ordered = [rows[place] for place in place_of]
    values: dict[str, Any] = {}
    notes.append(f"order of the storeys: {reason}")
    for key, (column, si) in columns.items():
        numbers = [read_positive(table, row, column, si, key == "hardening") for row in ordered]
        values[key.replace(" ", "_")] = np.array(numbers)
        notes.append(f"{key}: {table.describe_column(column)}")
    if "hardening" in values:
        _refuse_large_hardening(table, ordered, columns["hardening"][0], values["hardening"])
    if titles := table.list_unread_titles():
        notes.append(f"not read: {join_limited([repr(escape_controls(each)) for each in titles], 300)}")
    taken = [storey.place, *(column.place for column, _ in columns.values())]
    unused = [each.name for each in table.columns if each.place not in taken and needs_stiffness]
    if unused:
        notes.append(f"columns left out: {join_limited([escape_controls(name) for name in unused], 300)}")
    building = ImportedBuilding(tuple(names[place] for place in place_of), notes=notes, **values)
    _warn_gaps_in_numbers(building)
    _warn_total(building)
    return building


def _refuse_large_hardening(
    table: ProgramTable, rows: Sequence[ProgramRow], column: ProgramColumn, ratios: np.ndarray
) -> None:
    """Raise InputError where a hardening ratio is 1 or more."""
    for row, ratio in zip(rows, ratios, strict=True):
        if ratio >= 1.0:
            message = f"{table.read_text(row, column)} is no hardening ratio, which is below 1"
            raise table.refuse(message, f"write 0.05, or percent as `{column.name} [%]`", row, column)


def _warn_total(building: ImportedBuilding) -> None:
    """Warn where a storey has the height and the mass of all others together, as a row of totals has."""
    for name, height, mass in zip(building.names, building.height, building.mass, strict=True):
        others = (building.height.sum() - height, building.mass.sum() - mass)
        if len(building.names) > 2 and np.allclose(others, (height, mass), rtol=1e-3, atol=0.0):
            building.warnings.append(
                f"storey '{escape_controls(name)}' has the height and the mass of all others together: is it a total?"
            )


def _warn_gaps_in_numbers(building: ImportedBuilding) -> None:
    """Warn where the numbers of the storeys leave some out, since a row may be missing."""
    numbers = find_numbers(building.names)
    if not numbers:
        return
    present = {0, *numbers}
    absent = list(islice((number for number in range(min(numbers), max(numbers)) if number not in present), 10))
    if absent:
        listed = join_limited([str(number) for number in absent], 100)
        building.warnings.append(f"the names of the storeys leave out the number {listed}: is a row missing?")


def _read_storeys(tables: TableFile, choices: Choices) -> ImportedBuilding:
    """Return heights and masses from the tables of ETABS.  Raises InputError."""
    table = _get_table(tables, HEIGHT_TABLES)
    storey = table.get_column("storey", "name of the storey")
    height = table.get_column("height", "storey height")
    rows = [row for row in select_tower(table, table.rows, choices) if table.read_text(row, storey)]
    rows, notes = leave_out_totals(table, rows, storey)
    bases = [row for row in rows if _is_base(table, row, storey, height)]
    above = [row for row in rows if row not in bases]
    names = [table.read_text(row, storey) for row in above]
    if not above:
        raise table.refuse("has no storey", "export it with a row for each storey")
    _refuse_twice(table, above, storey, names)
    mass_table = _get_table(tables, MASS_TABLES)
    mass_storey = mass_table.get_column("storey", "name of the storey")
    mass_rows = select_tower(mass_table, mass_table.rows, choices)
    mass_rows, mass_notes = leave_out_totals(mass_table, mass_rows, mass_storey)
    mass_names = [mass_table.read_text(row, mass_storey) for row in mass_rows]
    _refuse_twice(mass_table, mass_rows, mass_storey, mass_names)
    base_order = find_base_order(rows, bases) or find_base_order_in_masses(mass_names, names)
    place_of, reason = find_order(table, above, storey, names, base_order, choices, find_shears(tables, names, choices))
    ordered = [above[place] for place in place_of]
    ordered_names = tuple(names[place] for place in place_of)
    heights = np.array([read_positive(table, row, height, "m") for row in ordered])
    mass_column = mass_table.get_column("mass", "mass of the floor")
    by_name = dict(zip(mass_names, mass_rows, strict=True))
    masses = [
        read_positive(mass_table, get_row(mass_table, by_name, name), mass_column, "kg") for name in ordered_names
    ]
    building = ImportedBuilding(ordered_names, heights, np.array(masses))
    building.notes = [
        *notes,
        *mass_notes,
        f"order of the storeys: {reason}",
        f"height: {table.describe_column(height)}",
        f"mass: {mass_table.describe_column(mass_column)}",
    ]
    base_names = ["base", *(normalize_name(table.read_text(row, storey)) for row in bases)]
    names_of_all_towers = [table.read_text(row, storey) for row in table.rows]
    for name in mass_names:
        if normalize_name(name) in base_names:
            ground_mass = mass_table.read_quantity(by_name[name], mass_column, "kg")
            building.notes.append(
                f"{ground_mass / 1e3:.6g} t of '{escape_controls(name)}' move with the ground, left out"
            )
        elif name not in names_of_all_towers:
            message = f"storey '{escape_controls(name)}' has a mass, but no row in '{table.title}'"
            hint = "export all storeys, with one name for a storey in all tables; the base is called Base"
            raise mass_table.refuse(message, hint, by_name[name], mass_storey)
    _check_elevations(table, ordered, height, building)
    _warn_gaps_in_numbers(building)
    return building


def _check_elevations(
    table: ProgramTable, ordered: Sequence[ProgramRow], height: ProgramColumn, building: ImportedBuilding
) -> None:
    """Make sure that elevations, where a table has them, are the sums of the heights; warn of those below the ground.

    Raises
    ------
    InputError : an elevation is not that of the storey below plus a height
    """
    column = table.find_column("elevation")
    if column is None:
        return
    elevations = [table.read_quantity(row, column, "m") for row in ordered]
    for below, above, row in zip(elevations, elevations[1:], ordered[1:], strict=False):
        storey_height = table.read_quantity(row, height, "m")
        if abs(above - below - storey_height) > 2e-3 + 1e-3 * storey_height:
            rise = f"the elevation is {above - below:.6g} m above that of the storey below"
            raise table.refuse(f"{rise}, the height {storey_height:.6g} m", "correct one of the two", row, column)
    base = elevations[0] - table.read_quantity(ordered[0], height, "m")
    if base < -2e-3 and elevations[-1] > 0.0:
        building.warnings.append(f"the base lies {-base:.6g} m below the ground ({column.name} 0); {BELOW_GROUND_HINT}")


def _is_base(table: ProgramTable, row: ProgramRow, storey: ProgramColumn, height: ProgramColumn) -> bool:
    """Return whether a row is the base, which has no storey below it."""
    if table.read_text(row, height) not in ("", "0"):
        return False
    elevation = table.find_column("elevation")
    if elevation is None:
        return normalize_name(table.read_text(row, storey)) == "base"
    lowest = min(table.read_number(each, elevation) for each in table.rows)
    return table.read_number(row, elevation) == lowest


def _refuse_twice(table: ProgramTable, rows: Sequence[ProgramRow], storey: ProgramColumn, names: Sequence[str]) -> None:
    """Raise InputError where a storey stands twice, or has no name."""
    for place, name in enumerate(names):
        if not name:
            hint = "write the name of the storey, or take the row out if it is a total"
            raise table.refuse("is empty", hint, rows[place], storey)
        if name in names[:place]:
            first = rows[names.index(name)][0]
            message = f"storey '{escape_controls(name)}' stands in row {first} too"
            raise table.refuse(message, "leave one row for each storey", rows[place], storey)
