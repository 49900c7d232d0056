"""Storeys of a building from the tables of a frame program: heights, masses, stiffnesses, eccentricities, periods."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.imports.tables import Column, ProgramTable, Row, TableFile, normalize_name
from pounding_cli.model.stiffness import frequencies
from pounding_cli.numbers import join_limited, pluralize
from pounding_cli.reading import shorten_path
from pounding_cli.texts import escape_controls

HEIGHT_TABLES = ("Story Definitions", "Story Data", "Storey Definitions", "Storey Data")
MASS_TABLES = ("Mass Summary by Story", "Story Mass Summary", "Masses by Story")
STIFFNESS_TABLES = ("Story Stiffness", "Storey Stiffness")
PERIOD_TABLES = ("Modal Periods And Frequencies", "Modal Periods")
RATIO_TABLES = ("Modal Participating Mass Ratios",)
CENTRE_TABLES = ("Centers Of Mass And Rigidity", "Center Of Mass And Rigidity", "Centers Of Mass And Rigidity Data")

STOREY = ("Story", "Storey", "Name", "Story Name", "Storey Name", "Level", "Floor")
HEIGHT = ("Height", "Story Height", "Storey Height")
ELEVATION = ("Elevation", "Elev", "Story Elevation")
CASE = ("Output Case", "Load Case", "Load Case/Combo", "Case", "Case/Combo", "Load")
STEP_TYPE = ("Step Type",)
STEP_NUMBER = ("Step Number", "Step Num", "Step")
TOWER = ("Tower",)
MODE = ("Mode", "Step Num", "Step Number")
PERIOD = ("Period",)
YIELD_SHEAR = ("Yield shear", "Vy", "Strength", "Shear strength")
HARDENING = ("Hardening", "Hardening ratio")
"""Headings of a column, the best one first."""

_SHEAR = ("Shear", "Story Shear", "Storey Shear", "V")
_DRIFT = ("Drift", "Story Drift", "Storey Drift", "Interstorey Drift")
OF_DIRECTION = {
    direction: {
        "mass": (f"U{direction}", f"U{number}", f"Mass {direction}", "Mass"),
        "stiffness": (f"Stiff{direction}", f"Stiffness {direction}", "Stiffness", "K"),
        "shear": (f"Shear {direction}", f"V{direction}", *_SHEAR),
        "drift": (f"Drift {direction}", *_DRIFT),
        "ratio": (f"U{direction}", f"U{number}"),
    }
    for number, direction in ((1, "X"), (2, "Y"))
}
"""Direction -> what is read -> headings, the best one first."""

TOTALS = {"total", "totals", "grandtotal", "sum", "sums", "sumtotal", "summe", "gesamt", "somme", "suma", "toplam"}
"""Names of rows that are sums of the others, by their letters."""

BELOW_GROUND = r"-\s*\d+|.*\s-\d+|.*(basement|cellar|underground|below ground).*"
"""Names of storeys that lie below the ground."""

BELOW_GROUND_HINT = (
    "a study has one ground for all buildings, on which the lowest storey stands here: take the storeys below the "
    "ground out of the tables, unless the neighbour has them too"
)
"""What to do about storeys below the ground."""

MAX_PERIOD_DIFFERENCE = 0.05
"""Relative difference of the periods of stick and model beyond which storeys do not deform in shear alone."""


@dataclass(frozen=True)
class Choices:
    """What the tables leave open, as options of the command say it.

    direction : of the row, "X" or "Y"
    case, step, tower : of the tables; "" where they leave no choice
    order : "up" or "down": the order of the rows, where nothing else shows it; "" for none
    mode : number of the mode whose period the stick is compared with; None: the first one along the row
    period : of the model [s], where the tables have none; None for none
    """

    direction: str = "X"
    case: str = ""
    step: str = ""
    tower: str = ""
    order: str = ""
    mode: int | None = None
    period: float | None = None


@dataclass
class ImportedBuilding:
    """A building from tables; arrays run from the ground up, shape (n,).

    names : of the storeys
    height [m], mass [kg], stiffness [N/m], yield_shear [N], hardening [-]
    eccentricity : of the centres of stiffness from the centres of mass, across the row [m]; None where no table has it
    model_period : of the model [s]; None where no table has it
    mode_words : which mode that is
    notes : which table and column was taken for what
    warnings : what a reader must know
    """

    names: tuple[str, ...]
    height: np.ndarray
    mass: np.ndarray
    stiffness: np.ndarray | None = None
    yield_shear: np.ndarray | None = None
    hardening: np.ndarray | None = None
    eccentricity: np.ndarray | None = None
    model_period: float | None = None
    mode_words: str = ""
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def stick_period(self) -> float:
        """First period of the shear building on a fixed base [s]."""
        assert self.stiffness is not None
        return float(2 * math.pi / frequencies(self.mass, self.stiffness)[0])

    def match_period(self) -> None:
        """Scale the stiffnesses so that the first period is that of the model.

        Raises
        ------
        InputError : the period of the model is not known
        """
        if self.model_period is None or self.stiffness is None:
            message = "--match-period needs the period of the model, and no table has it"
            raise InputError(Problem(message, f"export the table '{PERIOD_TABLES[0]}', or give --period 1.2 s"))
        factor = (self.stick_period / self.model_period) ** 2
        self.stiffness = self.stiffness * factor
        self.notes.append(f"stiffnesses: scaled by {factor:.6g}, so that the first period is that of the model")


def read_building(tables: TableFile, choices: Choices, needs_stiffness: bool = True) -> ImportedBuilding:
    """Return a building from tables of a frame program, or from one plain table of storeys.

    needs_stiffness : False where the stiffnesses come from elsewhere

    Raises
    ------
    InputError : a table, column, row or number is missing or wrong, by name
    """
    quantities = OF_DIRECTION[choices.direction]
    plain = _find_plain_table(tables, choices, needs_stiffness)
    if plain is not None:
        building = _read_plain_table(plain, choices, needs_stiffness)
    else:
        _refuse_missing_columns(tables, choices, needs_stiffness)
        _refuse_missing_tables(tables, needs_stiffness)
        building = _read_storeys(tables, choices)
        if needs_stiffness:
            table = _get_table(tables, STIFFNESS_TABLES)
            _read_stiffness(table, table.get_column(quantities["stiffness"][:2], "storey stiffness"), building, choices)
    _read_eccentricity(tables, building, choices)
    _read_period(tables, building, choices)
    if choices.tower:
        building.notes.append(f"tower: {escape_controls(choices.tower)}")
        if not any(table.find_column(TOWER) for table in tables.tables):
            message = f"no table has a column Tower, so that --tower {escape_controls(choices.tower)} has no effect"
            raise InputError(Problem(message, "leave --tower out", shorten_path(tables.path)))
    if choices.mode is not None and tables.find_table(PERIOD_TABLES) is None:
        message = f"there is no table '{PERIOD_TABLES[0]}', so that --mode {choices.mode} has no effect"
        raise InputError(Problem(message, "export it too, or leave --mode out", shorten_path(tables.path)))
    note_decimals(tables, building)
    _warn_below_ground(building)
    return building


def note_decimals(tables: TableFile, building: ImportedBuilding) -> None:
    """Note how the numbers of the files were read, where they have decimal commas or could be read in another way."""
    for decimals in tables.list_decimals():
        if decimals.example:
            building.notes.append(f"decimal commas: '{decimals.example}' is {decimals.example.replace(',', '.')}")
        if decimals.is_ambiguous:
            sign = "comma" if decimals.example else "point"
            building.warnings.append(
                f"three digits stand behind every {sign} of {shorten_path(tables.path)}; it is taken for a decimal "
                "sign: where it parts thousands, take it out"
            )


def _warn_below_ground(building: ImportedBuilding) -> None:
    """Warn of storeys whose names say that they lie below the ground, where the elevations have not told so already."""
    names = [name for name in building.names if re.fullmatch(BELOW_GROUND, name, re.IGNORECASE)]
    if names and not any("below the ground" in warning for warning in building.warnings):
        shown = join_limited([escape_controls(name) for name in names], 200)
        building.warnings.append(
            f"{shown} {'sounds' if len(names) == 1 else 'sound'} as if below the ground; {BELOW_GROUND_HINT}"
        )


def _refuse_missing_columns(tables: TableFile, choices: Choices, needs_stiffness: bool) -> None:
    """Raise InputError with the columns that a plain table lacks, unless the file has tables of a frame program."""
    if any(tables.find_table(names) for names in (HEIGHT_TABLES, MASS_TABLES, STIFFNESS_TABLES)):
        return
    quantities = OF_DIRECTION[choices.direction]
    wanted = [
        (("Storey", *STOREY), "name of the storey"),
        (HEIGHT, "storey height"),
        (("Mass", *quantities["mass"]), "mass of the floor"),
        *([(("Stiffness", *quantities["stiffness"]), "storey stiffness")] if needs_stiffness else []),
    ]
    counts = [sum(table.find_column(names) is not None for names, _ in wanted) for table in tables.tables]
    best = int(np.argmax(counts))
    is_one_table = len(tables.tables) == 1 and needs_stiffness
    if counts[best] < 2 and not is_one_table:
        return
    problems: list[Problem] = []
    for names, meaning in wanted:
        try:
            tables.tables[best].get_column(names, meaning)
        except InputError as error:
            problems += error.problems
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
            problems.append(Problem(message, hint, shorten_path(tables.path)))
    if problems:
        raise InputError(problems)


def _get_table(tables: TableFile, names: Sequence[str]) -> ProgramTable:
    table = tables.find_table(names)
    assert table is not None
    return table


def _find_plain_table(tables: TableFile, choices: Choices, needs_stiffness: bool) -> ProgramTable | None:
    """Return a table that has storeys, heights and masses together; None where there is none."""
    quantities = OF_DIRECTION[choices.direction]
    wanted = [STOREY, HEIGHT, quantities["mass"]]
    if tables.find_table(HEIGHT_TABLES) is not None:
        return None
    with_stiffness = tables.find_table_with(*wanted, quantities["stiffness"])
    if with_stiffness is not None or needs_stiffness:
        return with_stiffness or tables.find_table_with(*wanted)
    return tables.find_table_with(*wanted)


# Storeys and their order


def _read_plain_table(table: ProgramTable, choices: Choices, needs_stiffness: bool) -> ImportedBuilding:
    """Return a building from one table with a row for each storey.  Raises InputError."""
    quantities = OF_DIRECTION[choices.direction]
    for option, value in (("--case", choices.case), ("--step", choices.step)):
        if value and needs_stiffness:
            message = f"has a row for each storey and no load cases, so that {option} {value} has no effect"
            raise table.refuse(message, f"leave {option} out")
    storey = table.get_column(STOREY, "name of the storey")
    rows, notes = leave_out_totals(table, _select_tower(table, table.rows, choices), storey)
    if not rows:
        raise table.refuse("has no row of a storey", "write one for each storey below the headings")
    columns = {
        "height": (table.get_column(HEIGHT, "storey height"), "m"),
        "mass": (table.get_column(quantities["mass"], "mass of the floor"), "kg"),
    }
    if needs_stiffness:
        columns["stiffness"] = (table.get_column(quantities["stiffness"], "storey stiffness"), "N/m")
    for key, headings, si in (("yield_shear", YIELD_SHEAR, "N"), ("hardening", HARDENING, "")):
        if table.find_column(headings) is not None and needs_stiffness:
            columns[key] = (table.get_column(headings, key.replace("_", " ")), si)
    names = [table.read_text(row, storey) for row in rows]
    _refuse_twice(table, rows, storey, names)
    place_of, reason = _find_order(table, rows, storey, names, [], choices)
    ordered = [rows[place] for place in place_of]
    values: dict[str, Any] = {}
    notes.append(f"order of the storeys: {reason}")
    for key, (column, si) in columns.items():
        values[key] = np.array([_read_positive(table, row, column, si, key == "hardening") for row in ordered])
        notes.append(f"{key.replace('_', ' ')}: {table.describe_column(column)}")
    if "hardening" in values:
        _refuse_large_hardening(table, ordered, columns["hardening"][0], values["hardening"])
    taken = [storey.place, *(column.place for column, _ in columns.values())]
    unused = [each.name for each in table.columns if each.place not in taken and needs_stiffness]
    if unused:
        notes.append(f"columns left out: {join_limited([escape_controls(name) for name in unused], 300)}")
    building = ImportedBuilding(tuple(names[place] for place in place_of), notes=notes, **values)
    _warn_gaps_in_numbers(building)
    return building


def _refuse_large_hardening(table: ProgramTable, rows: Sequence[Row], column: Column, ratios: np.ndarray) -> None:
    """Raise InputError where a hardening ratio is 1 or more."""
    for row, ratio in zip(rows, ratios, strict=True):
        if ratio >= 1.0:
            message = f"{table.read_text(row, column)} is no hardening ratio, which is below 1"
            raise table.refuse(message, f"write 0.05, or percent as `{column.name} [%]`", row, column)


def _warn_gaps_in_numbers(building: ImportedBuilding) -> None:
    """Warn where the numbers of the storeys leave some out, since a row may be missing."""
    numbers = _find_numbers(building.names)
    if not numbers:
        return
    present = {0, *numbers}
    absent = list(islice((number for number in range(min(numbers), max(numbers)) if number not in present), 10))
    if absent:
        shown = join_limited([str(number) for number in absent], 100)
        building.warnings.append(f"the names of the storeys leave out the number {shown}: is a row missing?")


def leave_out_totals(table: ProgramTable, rows: Sequence[Row], storey: Column) -> tuple[list[Row], list[str]]:
    """Return the rows of storeys, and a note of every row that is a total."""
    kept = []
    notes = []
    for row in rows:
        name = table.read_text(row, storey)
        if normalize_name(name) in TOTALS:
            notes.append(f"left out: row {row[0]} of '{table.title}', '{escape_controls(name)}'")
        else:
            kept.append(row)
    return kept, notes


def _read_storeys(tables: TableFile, choices: Choices) -> ImportedBuilding:
    """Return heights and masses from the tables of ETABS.  Raises InputError."""
    table = _get_table(tables, HEIGHT_TABLES)
    storey = table.get_column(STOREY, "name of the storey")
    height = table.get_column(HEIGHT, "storey height")
    rows = [row for row in _select_tower(table, table.rows, choices) if table.read_text(row, storey)]
    rows, notes = leave_out_totals(table, rows, storey)
    bases = [row for row in rows if _is_base(table, row, storey, height)]
    above = [row for row in rows if row not in bases]
    names = [table.read_text(row, storey) for row in above]
    if not above:
        raise table.refuse("has no storey", "export it with a row for each storey")
    _refuse_twice(table, above, storey, names)
    mass_table = _get_table(tables, MASS_TABLES)
    mass_storey = mass_table.get_column(STOREY, "name of the storey")
    mass_rows = _select_tower(mass_table, mass_table.rows, choices)
    mass_rows, mass_notes = leave_out_totals(mass_table, mass_rows, mass_storey)
    mass_names = [mass_table.read_text(row, mass_storey) for row in mass_rows]
    _refuse_twice(mass_table, mass_rows, mass_storey, mass_names)
    base_order = _find_base_order(rows, bases) or _find_base_order_in_masses(mass_names, names)
    place_of, reason = _find_order(
        table, above, storey, names, base_order, choices, _find_shears(tables, names, choices)
    )
    ordered = [above[place] for place in place_of]
    ordered_names = tuple(names[place] for place in place_of)
    heights = np.array([_read_positive(table, row, height, "m") for row in ordered])
    mass_column = mass_table.get_column(OF_DIRECTION[choices.direction]["mass"][:3], "mass of the floor")
    by_name = dict(zip(mass_names, mass_rows, strict=True))
    masses = [
        _read_positive(mass_table, _get_row(mass_table, by_name, name), mass_column, "kg") for name in ordered_names
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
    of_all_towers = [table.read_text(row, storey) for row in table.rows]
    for name in mass_names:
        if normalize_name(name) in base_names:
            ground_mass = mass_table.read_quantity(by_name[name], mass_column, "kg")
            building.notes.append(
                f"{ground_mass / 1e3:.6g} t of '{escape_controls(name)}' move with the ground, left out"
            )
        elif name not in of_all_towers:
            message = f"storey '{escape_controls(name)}' has a mass, but no row in '{table.title}'"
            hint = "export all storeys, with one name for a storey in all tables; the base is called Base"
            raise mass_table.refuse(message, hint, by_name[name], mass_storey)
    _check_elevations(table, ordered, height, building)
    _warn_gaps_in_numbers(building)
    return building


def _check_elevations(table: ProgramTable, ordered: Sequence[Row], height: Column, building: ImportedBuilding) -> None:
    """Make sure that elevations, where a table has them, are the sums of the heights; warn of those below the ground.

    Raises
    ------
    InputError : an elevation is not that of the storey below plus a height
    """
    column = table.find_column(ELEVATION)
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


def _select_tower(table: ProgramTable, rows: Sequence[Row], choices: Choices) -> list[Row]:
    """Return the rows of the tower that is imported.  Raises InputError: there are several and none is chosen."""
    column = table.find_column(TOWER)
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


def _is_base(table: ProgramTable, row: Row, storey: Column, height: Column) -> bool:
    """Return whether a row is the base, which has no storey below it."""
    if table.read_text(row, height) not in ("", "0"):
        return False
    elevation = table.find_column(ELEVATION)
    if elevation is None:
        return normalize_name(table.read_text(row, storey)) == "base"
    lowest = min(table.read_number(each, elevation) for each in table.rows)
    return table.read_number(row, elevation) == lowest


def _refuse_twice(table: ProgramTable, rows: Sequence[Row], storey: Column, names: Sequence[str]) -> None:
    """Raise InputError where a storey stands twice, or has no name."""
    for place, name in enumerate(names):
        if not name:
            hint = "write the name of the storey, or take the row out if it is a total"
            raise table.refuse("is empty", hint, rows[place], storey)
        if name in names[:place]:
            first = rows[names.index(name)][0]
            message = f"storey '{escape_controls(name)}' stands in row {first} too"
            raise table.refuse(message, "leave one row for each storey", rows[place], storey)


def refuse_nameless(table: ProgramTable, rows: Sequence[Row], storey: Column) -> None:
    """Raise InputError where a row has no name of a storey, such as below the first row of merged cells."""
    for row in rows:
        if not table.read_text(row, storey):
            hint = "write the name of the storey in every row; merged cells have it in their first one alone"
            raise table.refuse("is empty", hint, row, storey)


def _get_row(table: ProgramTable, by_name: dict[str, Row], name: str) -> Row:
    """Return the row of a storey.  Raises InputError: there is none."""
    if name not in by_name:
        there = join_limited([escape_controls(each) for each in by_name], 300) or "none"
        message = f"has no row for storey '{escape_controls(name)}'; it has {there}"
        raise table.refuse(message, "export all storeys, with one name for a storey in all tables")
    return by_name[name]


def _find_base_order(rows: Sequence[Row], bases: Sequence[Row]) -> list[str]:
    """Return "up" where the base is the first row of a table, "down" where it is the last."""
    if len(bases) == 1 and bases[0] in (rows[0], rows[-1]) and len(rows) > 1:
        return ["up" if bases[0] is rows[0] else "down"]
    return []


def _find_base_order_in_masses(mass_names: Sequence[str], names: Sequence[str]) -> list[str]:
    """Return the order of the storeys that a base in the table of masses shows, if both tables have one order."""
    storeys = [name for name in mass_names if name in names]
    bases = [place for place, name in enumerate(mass_names) if normalize_name(name) == "base"]
    if storeys != list(names) or bases not in ([0], [len(mass_names) - 1]):
        return []
    return ["up" if bases == [0] else "down"]


def _find_shears(tables: TableFile, names: Sequence[str], choices: Choices) -> list[float]:
    """Return the storey shears of one load case, in the order of `names`; empty where the tables do not have them."""
    table = tables.find_table(STIFFNESS_TABLES)
    column = table.find_column(OF_DIRECTION[choices.direction]["shear"]) if table is not None else None
    storey = table.find_column(STOREY) if table is not None else None
    if table is None or column is None or storey is None:
        return []
    case = table.find_column(CASE)
    shears: dict[str, dict[str, float]] = {}
    for row in table.rows:
        name_of_case = table.read_text(row, case) if case is not None else ""
        if choices.case in ("", name_of_case):
            try:
                shear = abs(float(table.read_text(row, column)))
            except ValueError:
                continue
            of_case = shears.setdefault(name_of_case, {})
            name = table.read_text(row, storey)
            of_case[name] = max(shear, of_case.get(name, 0.0))
    for of_case in shears.values():
        if all(name in of_case for name in names) and max(of_case.values()) > 0.0:
            return [of_case[name] for name in names]
    return []


def _find_order(
    table: ProgramTable,
    rows: Sequence[Row],
    storey: Column,
    names: Sequence[str],
    base_order: Sequence[str],
    choices: Choices,
    shears: Sequence[float] = (),
) -> tuple[list[int], str]:
    """Return the places of the storeys from the ground up, and how that was found.

    Raises
    ------
    InputError : nothing shows the order
    """
    places = list(range(len(names)))
    if len(places) == 1:
        return places, "one storey"
    elevation = table.find_column(ELEVATION)
    if elevation is not None:
        levels = [table.read_number(row, elevation) for row in rows]
        by_level = sorted(places, key=lambda place: levels[place])
        if choices.order and by_level != (places if choices.order == "up" else places[::-1]):
            message = f"--order {choices.order} contradicts the column '{elevation.name}'"
            raise table.refuse(message, "leave --order out, or correct the column", rows[0], elevation)
        return by_level, f"by {table.describe_column(elevation)}"
    evidence: dict[str, list[int]] = {}
    if base_order:
        side = "first" if base_order[0] == "up" else "last"
        evidence[f"the base stands {side}"] = places if base_order[0] == "up" else places[::-1]
    steps = np.diff(shears)
    if steps.size and ((steps < 0).all() or (steps > 0).all()):
        evidence["the storey shears grow towards the ground"] = places if (steps < 0).all() else places[::-1]
    numbers = _find_numbers(names)
    if numbers:
        evidence["by the numbers in the names"] = sorted(places, key=lambda place: numbers[place])
    if choices.order:
        chosen = places if choices.order == "up" else places[::-1]
        against = [reason for reason, order in evidence.items() if order != chosen]
        doubt = f", against the evidence: {'; '.join(against)}" if against else ""
        return chosen, f"--order {choices.order}{doubt}"
    hint = "give --order up, or --order down; or export the elevations"
    if not evidence:
        message = "nothing shows whether the storeys stand from the ground up or from the roof down"
        raise table.refuse(message, hint, rows[0], storey)
    if any(order != next(iter(evidence.values())) for order in evidence.values()):
        message = f"the order of the storeys is not clear: {'; '.join(evidence)} contradict each other"
        raise table.refuse(message, hint, rows[0], storey)
    return next(iter(evidence.values())), next(iter(evidence))


def _find_numbers(names: Sequence[str]) -> list[int]:
    """Return the numbers in names such as Story1, Story2, which differ in nothing else; none in other names.

    A minus counts where it does not join a word and a number: of `-1`, not of `Story-1`.
    """
    matches = [re.fullmatch(r"(|\D*\s|\D*(?=\d))(-?\d+)(\D*)", name) for name in names]
    kinds = {(match[1].strip(), match[3].strip()) for match in matches if match}
    numbers = [int(match[2]) for match in matches if match]
    is_numbered = len(numbers) == len(names) and len(kinds) == 1 and len(set(numbers)) == len(names)
    return numbers if is_numbered else []


def _read_positive(table: ProgramTable, row: Row, column: Column, si: str, may_be_zero: bool = False) -> float:
    """Return a number above zero in SI.  Raises InputError."""
    if si:
        value = table.read_quantity(row, column, si)
    else:
        value = table.read_number(row, column) * (0.01 if column.unit.strip() == "%" else 1.0)
    if value < 0.0 or (value == 0.0 and not may_be_zero):
        shown = table.read_text(row, column)
        raise table.refuse(f"{shown} is not above zero", "write what the model has there", row, column)
    return value


# Stiffness


def select_case(table: ProgramTable, column: Column, choices: Choices, meaning: str) -> tuple[list[Row], str]:
    """Return the rows of the load case that is imported, and its name.

    column : of the direction, which is not zero in cases along it
    meaning : what the case is for

    Raises
    ------
    InputError : there are several cases and none is chosen, or the chosen one is not there
    """
    case = table.find_column(CASE)
    rows = _select_tower(table, table.rows, choices)
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


def _is_filled(table: ProgramTable, rows: Sequence[Row], case: Column, name: str, column: Column) -> bool:
    """Return whether a column holds numbers other than zero in the rows of a load case."""
    texts = [table.read_text(row, column) for row in rows if table.read_text(row, case) == name]
    return any(text not in ("", "0", "0.0") for text in texts)


def _read_stiffness(table: ProgramTable, column: Column, building: ImportedBuilding, choices: Choices) -> None:
    """Set the storey stiffnesses of a building.  Raises InputError."""
    rows, case = select_case(table, column, choices, "whose forces follow the first mode")
    storey = table.get_column(STOREY, "name of the storey")
    refuse_nameless(table, rows, storey)
    by_name = _pick_step(table, rows, storey, column, choices)
    direction = choices.direction
    stiffnesses = []
    for name in building.names:
        row = _get_row(table, by_name, name)
        value = table.read_quantity(row, column, "N/m")
        if value <= 0.0:
            message = f"storey '{escape_controls(name)}' has the stiffness {table.read_text(row, column)}"
            hint = f"choose a load case that pushes along {direction} (--case), or the other direction (--direction)"
            raise table.refuse(message, hint, row, column)
        stiffnesses.append(value)
        _compare_with_drift(table, row, column, name, building, direction)
    building.stiffness = np.array(stiffnesses)
    of_case = f", load case {escape_controls(case)}" if case else ""
    of_case += f", step {escape_controls(choices.step)}" if choices.step else ""
    building.notes.append(f"stiffness: {table.describe_column(column)}{of_case}, direction {direction}")
    others = [name for name in by_name if name not in building.names and normalize_name(name) not in {"base", *TOTALS}]
    if others and not choices.tower:
        message = f"storey '{escape_controls(others[0])}' has a stiffness, but no height and mass"
        hint = "export all storeys, with one name for a storey in all tables"
        raise table.refuse(message, hint, by_name[others[0]], storey)


def _pick_step(
    table: ProgramTable, rows: Sequence[Row], storey: Column, column: Column, choices: Choices
) -> dict[str, Row]:
    """Return the row of each storey.  Raises InputError: rows of a storey differ, and no step is named."""
    step_columns = [each for each in (table.find_column(STEP_TYPE), table.find_column(STEP_NUMBER)) if each is not None]
    if choices.step:
        rows = [row for row in rows if choices.step in [table.read_text(row, each) for each in step_columns]]
        if not rows:
            raise table.refuse(f"has no step '{choices.step}' in this load case", "choose another one with --step")
    by_name: dict[str, Row] = {}
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
    table: ProgramTable, row: Row, column: Column, name: str, building: ImportedBuilding, direction: str
) -> None:
    """Warn where a stiffness is not the storey shear over the drift of its row."""
    shear = table.find_column(OF_DIRECTION[direction]["shear"][:1])
    drift = table.find_column(OF_DIRECTION[direction]["drift"][:1])
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


# Eccentricity and period


def _read_eccentricity(tables: TableFile, building: ImportedBuilding, choices: Choices) -> None:
    """Set the eccentricities of a building where a table has them.  Raises InputError.

    Across the row means y for a row along x, and the way against x for a row along y, so that the row, the way across
    it and the vertical are right-handed.
    """
    table = tables.find_table(CENTRE_TABLES)
    if table is None:
        return
    across = "Y" if choices.direction == "X" else "X"
    mass_centre = table.find_column([f"{across}CM"])
    stiffness_centre = table.find_column([f"{across}CR"])
    storey = table.find_column(STOREY)
    if mass_centre is None or stiffness_centre is None or storey is None:
        building.notes.append(f"eccentricity: '{table.title}' has no {across}CM and {across}CR, left out")
        return
    rows = _select_tower(table, table.rows, choices)
    by_name: dict[str, Row] = {}
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


def _read_period(tables: TableFile, building: ImportedBuilding, choices: Choices) -> None:
    """Set the period of the model that the stick is compared with.  Raises InputError."""
    if choices.period is not None:
        building.model_period = choices.period
        building.mode_words = "given with --period"
        return
    table = tables.find_table(PERIOD_TABLES)
    if table is None:
        return
    period = table.get_column(PERIOD, "period of the mode")
    mode = table.get_column(MODE, "number of the mode")
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
    value = _read_positive(table, by_mode[chosen], period, "s")
    building.model_period = value
    building.mode_words = f"mode {chosen}"
    building.notes.append(f"period of the model: {table.describe_column(period)}, {words}")


def _select_modal_case(table: ProgramTable, building: ImportedBuilding) -> list[Row]:
    """Return the rows of the first modal case of a table; a note names it where there are others."""
    case = table.find_column(CASE)
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
    ratio = table.find_column(OF_DIRECTION[choices.direction]["ratio"]) if table is not None else None
    mode = table.find_column(MODE) if table is not None else None
    if table is None or ratio is None or mode is None:
        return None
    rows = _select_modal_case(table, building)
    if not rows:
        return None
    rows = [row for row in rows if table.read_text(row, ratio)]
    if not rows:
        return None
    shares = [table.read_number(row, ratio) for row in rows]
    first = int(np.argmax(shares))
    chosen = table.read_text(rows[first], mode)
    share = f"{100 * shares[first]:.3g} % of the mass along {choices.direction}"
    return chosen, f"mode {chosen}, which moves {share} ('{table.title}', {ratio.name})"
