"""What is declared of tables: units, signs, and which column holds a quantity that the headings name otherwise."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pounding_cli.cells import Grammar, TextFile, choose_table_separator, load_text
from pounding_cli.errors import InputError, Issue
from pounding_cli.imports.headings import PLAIN_HEADINGS, normalize_name
from pounding_cli.records.declaration import SEPARATOR_NAMES
from pounding_cli.study.text.file import Map, nearest, parse_value

GRAVITIES = (9.78, 9.84)
"""Accelerations of gravity by which a weight is divided [m/s2]: those of the Earth."""

_SOURCE = re.compile(
    r"(?P<what>.+?)\s*(?:[\[(](?P<unit>[^\])]*)[\])]\s*)?(?:(?P<sign>[*/])\s*(?P<number>\d+\.?\d*(?:[eE][-+]?\d+)?))?\s*\Z"
)
SOURCE_HINT = "write e.g. `stiffness=4`, `stiffness=4 [kN/mm]`, `mass=Weight/9.81` or `height=Storey height [m]`"


@dataclass
class ColumnSource:
    """Where a quantity stands in a table that does not name it so.

    written : as it was declared
    heading : of its column; "" where its place is declared
    place : of its column, from 0; -1 where its heading is declared
    unit : of the column; "" where the table names it
    factor : by which its numbers are multiplied [-]; of a mass out of weights one over g [s2/m]
    is_used : whether a table has it
    """

    written: str
    heading: str
    place: int
    unit: str
    factor: float
    is_used: bool = False


@dataclass(frozen=True)
class TableDeclaration:
    """What is declared of tables.

    direction : of the row, "X" or "Y"
    system : factors to SI of columns without a unit, by SI unit; empty: they are refused
    separator : what parts the cells of text, one of `SEPARATOR_NAMES`; "": what stands on the most lines
    decimal, thousands : signs in numbers of text; "": a point, and none between thousands
    sources : columns of quantities, by their names
    """

    direction: str = "X"
    system: Mapping[str, float] = field(default_factory=dict)
    separator: str = ""
    decimal: str = ""
    thousands: str = ""
    sources: Mapping[str, ColumnSource] = field(default_factory=dict)

    def build_grammar(self, text: TextFile | None = None) -> Grammar:
        """Return how the cells of a text are written; without one, those of a workbook that hold text."""
        separator = SEPARATOR_NAMES[self.separator] if self.separator else ","
        if text is not None and not self.separator:
            separator = choose_table_separator(text.lines)
        return Grammar(separator, self.decimal or ".", self.thousands)

    def refuse_unused(self) -> None:
        """Raise InputError where the column of a quantity was declared and no table has it."""
        problems = [
            Issue(
                (),
                f"--column '{quantity}={source.written}' has no effect: no table of storeys or curves has that column",
                "correct it, or leave it out; tables of ETABS are read by their own headings",
            )
            for quantity, source in self.sources.items()
            if not source.is_used
        ]
        if problems:
            raise InputError(problems)


def parse_sources(written: Iterable[str], path: Path | None) -> dict[str, ColumnSource]:
    """Return the columns of quantities, those of the command over those of a file.

    written : of the command, `mass=Weight/9.81`
    path : YAML file of quantities and their columns; None for none

    Raises
    ------
    InputError : a quantity that is not known, or no column
    """
    sources = {} if path is None else _read_sources(path)
    for text in written:
        quantity, sign, source = text.partition("=")
        if not sign:
            raise InputError(f"--column '{text}' is not a quantity and its column", SOURCE_HINT)
        sources |= {_find_quantity(quantity, Issue((), "", file="--column")): _parse_source(source, "--column")}
    return sources


def _read_sources(path: Path) -> dict[str, ColumnSource]:
    """Return the columns of quantities in a file.  Raises InputError."""
    text = "\n".join(load_text(path, "file of columns").lines)
    tree = parse_value(text, str(path))
    if not isinstance(tree, Map):
        raise InputError(
            Issue((), "this is not a mapping of quantities to columns", "write e.g. `mass: 3`", file=str(path))
        )
    sources = {}
    for key, value in tree.items():
        (line, column), _ = tree.marks[key]
        place = Issue((), "", file=str(path), line=int(line), column=column)
        sources[_find_quantity(key, place)] = _parse_source(str(value), f"{path}:{line}:{column}")
    return sources


def _find_quantity(written: str, place: Issue) -> str:
    """Return the name of a quantity.  Raises InputError: there is none such."""
    for quantity in PLAIN_HEADINGS:
        if normalize_name(quantity) == normalize_name(written):
            return quantity
    message = f"'{written.strip()[:60]}' is not a quantity of a table"
    raise InputError(
        Issue(
            (), message, nearest(written.strip(), PLAIN_HEADINGS), file=place.file, line=place.line, column=place.column
        )
    )


def _parse_source(written: str, place: str) -> ColumnSource:
    """Return a column as declared.  Raises InputError."""
    match = _SOURCE.match(written.strip())
    factor = float(match["number"] or 1.0) if match else 0.0
    if match is None or factor == 0.0 or match["what"] == "0":
        raise InputError(
            Issue((), f"'{written[:60]}' is not a column, from 1, or its heading", SOURCE_HINT, file=place)
        )
    if match["sign"] == "/":
        factor = 1.0 / factor
    number = int(match["what"]) - 1 if match["what"].isdecimal() else -1
    heading = "" if number >= 0 else match["what"]
    return ColumnSource(written.strip(), heading, number, match["unit"] or "", factor)
