"""The rows of a table that are imported: of one tower, one load case, one storey."""

from __future__ import annotations

from collections.abc import Sequence

from pounding_cli.imports.building import Choices
from pounding_cli.imports.headings import CASE_HEADINGS, TOWER_HEADINGS
from pounding_cli.imports.tables import ProgramColumn, ProgramRow, ProgramTable
from pounding_cli.numbers import join_limited, pluralize
from pounding_cli.texts import escape_controls


def select_tower(table: ProgramTable, rows: Sequence[ProgramRow], choices: Choices) -> list[ProgramRow]:
    """Return the rows of the tower that is imported.  Raises InputError: there are several and none is chosen."""
    column = table.find_column(TOWER_HEADINGS)
    if column is None:
        return list(rows)
    towers = list(dict.fromkeys(table.read_text(row, column) for row in rows))
    if choices.tower in towers:
        return [row for row in rows if table.read_text(row, column) == choices.tower]
    if len(towers) > 1 or choices.tower:
        there = join_limited([escape_controls(tower) for tower in towers], 300)
        message = f"no tower '{choices.tower}'" if choices.tower else f"has {pluralize(len(towers), 'tower')}"
        raise table.refuse(f"{message}: {there}", f"name one, e.g. --tower {escape_controls(towers[0])}")
    return list(rows)


def get_row(table: ProgramTable, by_name: dict[str, ProgramRow], name: str) -> ProgramRow:
    """Return the row of a storey.  Raises InputError: there is none."""
    if name not in by_name:
        there = join_limited([escape_controls(each) for each in by_name], 300) or "none"
        message = f"has no row for storey '{escape_controls(name)}'; it has {there}"
        raise table.refuse(message, "export all storeys, with one name for a storey in all tables")
    return by_name[name]


def read_positive(
    table: ProgramTable, row: ProgramRow, column: ProgramColumn, si: str, may_be_zero: bool = False
) -> float:
    """Return a number above zero in SI.  Raises InputError."""
    if si:
        value = table.read_quantity(row, column, si)
    else:
        value = table.read_number(row, column) * (0.01 if column.unit.strip() == "%" else 1.0)
    if value < 0.0 or (value == 0.0 and not may_be_zero):
        shown = table.read_text(row, column)
        raise table.refuse(f"{shown} is not above zero", "write what the model has there", row, column)
    return value


def select_case(
    table: ProgramTable, column: ProgramColumn, choices: Choices, meaning: str
) -> tuple[list[ProgramRow], str]:
    """Return the rows of the load case that is imported, and its name.

    column : of the direction, which is not zero in cases along it
    meaning : what the case is for

    Raises
    ------
    InputError : there are several cases and none is chosen, or the chosen one is not there
    """
    case = table.find_column(CASE_HEADINGS)
    rows = select_tower(table, table.rows, choices)
    if case is None:
        return rows, ""
    cases = list(dict.fromkeys(table.read_text(row, case) for row in rows))
    chosen = choices.case or (cases[0] if len(cases) == 1 else "")
    if chosen in cases and chosen:
        return [row for row in rows if table.read_text(row, case) == chosen], chosen
    useful = [each for each in cases if _is_filled(table, rows, case, each, column)]
    there = join_limited([escape_controls(each) for each in useful], 300) or "none"
    many = f"has {pluralize(len(cases), 'load case')}"
    message = f"has no load case '{escape_controls(chosen)}'" if chosen else many
    along = f"with '{column.name}' in them: {there}"
    example = escape_controls(useful[0]) if useful else "EQX"
    raise table.refuse(f"{message}; {along}", f"name the one {meaning}, e.g. --case {example}")


def _is_filled(
    table: ProgramTable, rows: Sequence[ProgramRow], case: ProgramColumn, name: str, column: ProgramColumn
) -> bool:
    """Return whether a column holds numbers other than zero in the rows of a load case."""
    texts = [table.read_text(row, column) for row in rows if table.read_text(row, case) == name]
    return any(text not in ("", "0", "0.0") for text in texts)
