"""Find the order of the storeys of a table, from the ground up or from the roof down."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from pounding_cli.imports.building import Choices
from pounding_cli.imports.headings import STIFFNESS_TABLES, normalize_name
from pounding_cli.imports.tables import ProgramColumn, ProgramRow, ProgramTable, TableFile


def find_base_order(rows: Sequence[ProgramRow], bases: Sequence[ProgramRow]) -> list[str]:
    """Return "up" where the base is the first row of a table, "down" where it is the last."""
    if len(bases) == 1 and bases[0] in (rows[0], rows[-1]) and len(rows) > 1:
        return ["up" if bases[0] is rows[0] else "down"]
    return []


def find_base_order_in_masses(mass_names: Sequence[str], names: Sequence[str]) -> list[str]:
    """Return the order of the storeys that a base in the table of masses shows, if both tables have one order."""
    storeys = [name for name in mass_names if name in names]
    bases = [place for place, name in enumerate(mass_names) if normalize_name(name) == "base"]
    if storeys != list(names) or bases not in ([0], [len(mass_names) - 1]):
        return []
    return ["up" if bases == [0] else "down"]


def find_shears(tables: TableFile, names: Sequence[str], choices: Choices) -> list[float]:
    """Return the storey shears of one load case, in the order of `names`; empty where the tables do not have them."""
    table = tables.find_table(STIFFNESS_TABLES)
    column = table.find_column("shear") if table is not None else None
    storey = table.find_column("storey") if table is not None else None
    if table is None or column is None or storey is None:
        return []
    case = table.find_column("case")
    shears: dict[str, dict[str, float]] = {}
    for row in table.rows:
        name_of_case = table.read_text(row, case) if case is not None else ""
        if choices.case in ("", name_of_case):
            shear = table.find_number(row, column)
            if shear is None:
                continue
            of_case = shears.setdefault(name_of_case, {})
            name = table.read_text(row, storey)
            of_case[name] = max(abs(shear), of_case.get(name, 0.0))
    for of_case in shears.values():
        if all(name in of_case for name in names) and max(of_case.values()) > 0.0:
            return [of_case[name] for name in names]
    return []


def find_order(
    table: ProgramTable,
    rows: Sequence[ProgramRow],
    storey: ProgramColumn,
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
    elevation = table.find_column("elevation")
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
    numbers = find_numbers(names)
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


def find_numbers(names: Sequence[str]) -> list[int]:
    """Return the numbers in names such as Story1, Story2, which differ in nothing else; none in other names.

    A minus counts where it does not join a word and a number: of `-1`, not of `Story-1`.
    """
    matches = [re.fullmatch(r"(|\D*\s|\D*(?=\d))(-?\d+)(\D*)", name) for name in names]
    kinds = {(match[1].strip(), match[3].strip()) for match in matches if match}
    numbers = [int(match[2]) for match in matches if match]
    is_numbered = len(numbers) == len(names) and len(kinds) == 1 and len(set(numbers)) == len(names)
    return numbers if is_numbered else []
