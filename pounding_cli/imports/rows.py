"""The rows of a table that are imported: of one tower, one load case, one storey."""

from __future__ import annotations

from collections.abc import Sequence

from pounding_cli.imports.building import Choices
from pounding_cli.imports.headings import normalize_name
from pounding_cli.imports.tables import ProgramColumn, ProgramRow, ProgramTable
from pounding_cli.numbers import join_limited, pluralize
from pounding_cli.texts import escape_controls

TOTALS = {"total", "totals", "sum"}
"""Names of rows that are sums of the others, by their letters."""


def leave_out_totals(
    table: ProgramTable, rows: Sequence[ProgramRow], storey: ProgramColumn
) -> tuple[list[ProgramRow], list[str]]:
    """Return the rows of storeys, and a note of every row that is a total."""
    rows_of_storeys = []
    notes = []
    for row in rows:
        name = table.read_text(row, storey)
        if normalize_name(name) in TOTALS:
            notes.append(f"left out: row {row[0]} of '{table.title}', '{escape_controls(name)}'")
        else:
            rows_of_storeys.append(row)
    return rows_of_storeys, notes


def select_tower(table: ProgramTable, rows: Sequence[ProgramRow], choices: Choices) -> list[ProgramRow]:
    """Return the rows of the tower that is imported.  Raises InputError: there are several and none is chosen."""
    column = table.find_column("tower")
    if column is None:
        return list(rows)
    towers = [tower for tower in dict.fromkeys(table.read_text(row, column) for row in rows) if tower]
    if choices.tower in towers:
        nameless = [row for row in rows if not table.read_text(row, column)]
        if nameless and len(towers) > 1:
            raise table.refuse("is empty", "write the tower in every row", nameless[0], column)
        return [row for row in rows if table.read_text(row, column) in (choices.tower, "")]
    if len(towers) > 1 or choices.tower:
        there = join_limited([escape_controls(tower) for tower in towers], 300)
        message = f"has {pluralize(len(towers), 'tower')}"
        if choices.tower:
            message = f"has no tower '{escape_controls(choices.tower)}'"
        example = escape_controls(towers[0]) if towers else "T1"
        raise table.refuse(f"{message}: {there or 'the cells are empty'}", f"name one, e.g. --tower {example}")
    return list(rows)


def refuse_nameless(table: ProgramTable, rows: Sequence[ProgramRow], storey: ProgramColumn) -> None:
    """Raise InputError where a row has no name of a storey, such as below the first row of merged cells."""
    for row in rows:
        if not table.read_text(row, storey):
            hint = "write the name of the storey in every row; merged cells have it in their first one alone"
            raise table.refuse("is empty", hint, row, storey)


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
        value = table.read_number(row, column) * column.factor * (0.01 if column.unit.strip() == "%" else 1.0)
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
    case = table.find_column("case")
    rows = select_tower(table, table.rows, choices)
    if case is None and choices.case:
        message = f"has no column of load cases, so that --case {escape_controls(choices.case)} has no effect"
        raise table.refuse(message, "leave --case out, or export the column with the load cases")
    if case is None:
        return rows, ""
    cases = list(dict.fromkeys(table.read_text(row, case) for row in rows))
    chosen = choices.case or (cases[0] if len(cases) == 1 else "")
    if not cases:
        raise table.refuse("has no row", "export it with the results of a load case")
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
    return any(table.find_number(row, column) for row in rows if table.read_text(row, case) == name)
