"""Storey stiffnesses from the forces of one load case."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.imports.building import Choices, ImportedBuilding
from pounding_cli.imports.headings import normalize_name
from pounding_cli.imports.rows import TOTALS, get_row, refuse_nameless, select_case
from pounding_cli.imports.tables import ProgramColumn, ProgramRow, ProgramTable
from pounding_cli.numbers import join_limited
from pounding_cli.texts import escape_controls


def read_stiffness(table: ProgramTable, column: ProgramColumn, building: ImportedBuilding, choices: Choices) -> None:
    """Set the storey stiffnesses of a building.  Raises InputError."""
    rows, case = select_case(table, column, choices, "whose forces follow the first mode")
    storey = table.get_column("storey", "name of the storey")
    refuse_nameless(table, rows, storey)
    by_name = _pick_step(table, rows, storey, column, choices)
    direction = choices.direction
    stiffnesses = []
    for name in building.names:
        row = get_row(table, by_name, name)
        value = table.read_quantity(row, column, "N/m")
        if value <= 0.0:
            message = f"storey '{escape_controls(name)}' has the stiffness {table.read_text(row, column)}"
            hint = f"choose a load case that pushes along {direction} (--case), or the other direction (--direction)"
            raise table.refuse(message, hint, row, column)
        stiffnesses.append(value)
        _compare_with_drift(table, row, column, name, building)
    building.stiffness = np.array(stiffnesses)
    of_case = f", load case {escape_controls(case)}" if case else ""
    of_case += f", step {escape_controls(choices.step)}" if choices.step else ""
    building.notes.append(f"stiffness: {table.describe_column(column)}{of_case}, direction {direction}")
    no_storeys = {"base", *TOTALS}
    others = [name for name in by_name if name not in building.names and normalize_name(name) not in no_storeys]
    if others and not choices.tower:
        message = f"storey '{escape_controls(others[0])}' has a stiffness, but no height and mass"
        hint = "export all storeys, with one name for a storey in all tables"
        raise table.refuse(message, hint, by_name[others[0]], storey)


def _pick_step(
    table: ProgramTable, rows: Sequence[ProgramRow], storey: ProgramColumn, column: ProgramColumn, choices: Choices
) -> dict[str, ProgramRow]:
    """Return the row of each storey.  Raises InputError: rows of a storey differ, and no step is named."""
    step_columns = [each for each in map(table.find_column, ("step type", "step")) if each is not None]
    if choices.step:
        rows = [row for row in rows if choices.step in [table.read_text(row, each) for each in step_columns]]
        if not rows:
            raise table.refuse(f"has no step '{choices.step}' in this load case", "choose another one with --step")
    by_name: dict[str, ProgramRow] = {}
    for row in rows:
        name = table.read_text(row, storey)
        first = by_name.setdefault(name, row)
        if first is not row and table.read_text(first, column) != table.read_text(row, column):
            steps = {" ".join(filter(None, (table.read_text(each, c) for c in step_columns))): 0 for each in rows}
            there = join_limited([escape_controls(step) for step in steps if step], 200) or "without names"
            message = f"storey '{escape_controls(name)}' has another value in row {first[0]}; the steps are {there}"
            hint = "choose one, e.g. --step Max, or another load case"
            if not any(steps):
                hint = "leave one row for each storey, or export the column with the load cases"
            raise table.refuse(message, hint, row, column)
    return by_name


def _compare_with_drift(
    table: ProgramTable, row: ProgramRow, column: ProgramColumn, name: str, building: ImportedBuilding
) -> None:
    """Warn where a stiffness is not the storey shear over the drift of its row."""
    shear = table.find_column("shear")
    drift = table.find_column("drift")
    if shear is None or drift is None:
        return
    try:
        force = abs(table.read_quantity(row, shear, "N"))
        length = abs(table.read_quantity(row, drift, "m"))
    except InputError:  # a ratio in place of a drift, or an empty cell
        return
    if length == 0.0:
        return
    stiffness = table.read_quantity(row, column, "N/m")
    ratio = force / length / stiffness
    if abs(ratio - 1.0) > 0.02:
        words = f"{table.words}, row {row[0]}: '{column.name}' of storey '{escape_controls(name)}'"
        building.warnings.append(
            f"{words} is {stiffness / 1e6:.4g} kN/mm, but '{shear.name}' over '{drift.name}' is "
            f"{force / length / 1e6:.4g} kN/mm; check the units and the load case"
        )
