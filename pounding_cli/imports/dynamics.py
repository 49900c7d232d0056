"""Eccentricities and the period of the model, for the twist and the first period of the stick."""

from __future__ import annotations

import numpy as np

from pounding_cli.imports.building import Choices, ImportedBuilding
from pounding_cli.imports.headings import CENTRE_TABLES, PERIOD_TABLES, RATIO_TABLES
from pounding_cli.imports.rows import read_positive, select_tower
from pounding_cli.imports.tables import ProgramRow, ProgramTable, TableFile
from pounding_cli.numbers import join_limited
from pounding_cli.texts import escape_controls


def read_eccentricity(tables: TableFile, building: ImportedBuilding, choices: Choices) -> None:
    """Set the eccentricities of a building where a table has them.  Raises InputError.

    Across the row means y for a row along x, and the way against x for a row along y, so that the row, the way across
    it and the vertical are right-handed.
    """
    table = tables.find_table(CENTRE_TABLES)
    if table is None:
        return
    across = "Y" if choices.direction == "X" else "X"
    mass_centre = table.find_column("mass centre")
    stiffness_centre = table.find_column("stiffness centre")
    storey = table.find_column("storey")
    if mass_centre is None or stiffness_centre is None or storey is None:
        building.notes.append(f"eccentricity: '{table.title}' has no {across}CM and {across}CR, left out")
        return
    rows = select_tower(table, table.rows, choices)
    by_name: dict[str, ProgramRow] = {}
    for row in rows:
        name = table.read_text(row, storey)
        if name in by_name and name in building.names:
            message = f"storey '{escape_controls(name)}' has several diaphragms; no plan is read from '{table.title}'"
            building.warnings.append(message)
            return
        by_name[name] = row
    empty = [
        name for name in building.names if name not in by_name or not table.read_text(by_name[name], stiffness_centre)
    ]
    if empty:
        shown = join_limited([escape_controls(name) for name in empty], 200)
        building.warnings.append(f"'{table.title}' has no {stiffness_centre.name} of {shown}; no plan is read from it")
        return
    sign = 1.0 if choices.direction == "X" else -1.0
    building.eccentricity = np.array(
        [
            sign
            * (
                table.read_quantity(by_name[name], stiffness_centre, "m")
                - table.read_quantity(by_name[name], mass_centre, "m")
            )
            for name in building.names
        ]
    )
    building.notes.append(
        f"eccentricity: '{table.title}', {stiffness_centre.name} less {mass_centre.name}"
        + (", with the other sign: across the row is against X" if sign < 0 else "")
    )


def read_period(tables: TableFile, building: ImportedBuilding, choices: Choices) -> None:
    """Set the period of the model that the stick is compared with.  Raises InputError."""
    if choices.period is not None:
        building.model_period = choices.period
        building.mode_words = "given with --period"
        return
    table = tables.find_table(PERIOD_TABLES)
    if table is None:
        return
    period = table.get_column("period", "period of the mode")
    mode = table.get_column("mode", "number of the mode")
    rows = _select_modal_case(table, building)
    if not rows:
        building.notes.append(f"period of the model: '{table.title}' has no row, left out")
        return
    by_mode = {table.read_text(row, mode): row for row in reversed(rows)}
    if choices.mode is not None:
        chosen = str(choices.mode)
        words = f"mode {chosen}, as --mode says"
    else:
        chosen, words = _find_mode_along(tables, building, choices) or (next(iter(reversed(by_mode)), ""), "")
        words = words or f"mode {chosen}; whether it is along {choices.direction} no table '{RATIO_TABLES[0]}' says"
    if chosen not in by_mode:
        raise table.refuse(f"has no mode {chosen}", f"name one of {join_limited(reversed(by_mode), 200)} with --mode")
    value = read_positive(table, by_mode[chosen], period, "s")
    building.model_period = value
    building.mode_words = f"mode {chosen}"
    building.notes.append(f"period of the model: {table.describe_column(period)}, {words}")


def _select_modal_case(table: ProgramTable, building: ImportedBuilding) -> list[ProgramRow]:
    """Return the rows of the first modal case of a table; a note names it where there are others."""
    case = table.find_column("case")
    rows = list(table.rows)
    if case is None:
        return rows
    cases = list(dict.fromkeys(table.read_text(row, case) for row in rows))
    if len(cases) > 1:
        there = join_limited([escape_controls(each) for each in cases], 200)
        building.notes.append(f"'{table.title}' has the cases {there}: {escape_controls(cases[0])} is taken")
    return [row for row in rows if table.read_text(row, case) == cases[0]] if cases else rows


def _find_mode_along(tables: TableFile, building: ImportedBuilding, choices: Choices) -> tuple[str, str] | None:
    """Return the mode that moves most of the mass along the row, and its words; None where no table tells."""
    table = tables.find_table(RATIO_TABLES)
    ratio = table.find_column("ratio") if table is not None else None
    mode = table.find_column("mode") if table is not None else None
    if table is None or ratio is None or mode is None:
        return None
    rows = [row for row in _select_modal_case(table, building) if table.read_text(row, ratio)]
    if not rows:
        return None
    shares = [table.read_number(row, ratio) for row in rows]
    first = int(np.argmax(shares))
    chosen = table.read_text(rows[first], mode)
    share = f"{100 * shares[first]:.3g} % of the mass along {choices.direction}"
    return chosen, f"mode {chosen}, which moves {share} ('{table.title}', {ratio.name})"
