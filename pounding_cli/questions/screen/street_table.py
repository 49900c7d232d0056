"""Read the table of a street: a row for each pair of neighbours, as text whose cells are those of `cells`.

Every value keeps its row and column, so that whatever is wrong with it, here or in the study of its pair, is told at
its place in the table.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from pydantic_core import PydanticCustomError

from pounding_cli.cells import BLANKS, Fault, Grammar, choose_table_separator, hint_options, load_text
from pounding_cli.errors import InputError
from pounding_cli.model.archetypes import DESIGNS, list_types
from pounding_cli.questions.screen.designs import ZONES, find_design
from pounding_cli.questions.screen.street import LEFT, MIN_PGA, RIGHT, Cell, NeighbourPair, Settings, Street, mark_map
from pounding_cli.records.declaration import SEPARATOR_NAMES
from pounding_cli.study.construct.written import read_spec
from pounding_cli.study.schema.quantity import ACCELERATION, GAP, LENGTH, Quantity
from pounding_cli.study.text.file import Map, Mark, Problems, dump_yaml, nearest, parse_value

MAX_PAIRS = 10_000

MAX_PGA = 3.0
"""Largest peak ground acceleration that a site may have [g]."""

_SIDE_HEADINGS = {
    "name": "a name; the right building of a row and the left one of the next are one where their names agree",
    "type": "building type of HAZUS, e.g. C1M",
    "design": "design level: high-code, moderate-code, low-code or pre-code",
    "year": "year in which it was built; with the zone it gives the design level",
    "storeys": "number of storeys",
    "height": "height of the building, e.g. `left height [m]`",
    "period": "measured period, e.g. `left period [s]`",
    "damping": "measured damping ratio, e.g. `left damping [%]`",
    "base shear": "known base shear at yield over weight",
    "mass": "mass of a floor, e.g. `left mass [t]`",
}
"""Headings behind `left` and `right`, and what stands below them."""

HEADINGS = {
    "name": "name of the pair",
    **{f"{side} {name}": text for side in (LEFT, RIGHT) for name, text in _SIDE_HEADINGS.items()},
    "gap": "width of the gap, e.g. `gap [cm]`",
    "pga": "peak ground acceleration of the site with the return period, e.g. `pga [g]`",
    "return period": "its return period, `return period [years]`",
    "hazard": "hazard curve of the site: a file, or `{0.1 g: 0.02, 0.4 g: 1/475}` in quotes",
    "zone": "seismic zone of the Uniform Building Code, by which years become design levels",
}
"""Every heading that a table may have, and what stands below it; beside them `pga 475 [g]` and the like."""

HAZARD_EXAMPLE = "an export of OpenQuake, or a file with its columns, `{file: h.csv, intensity: 1, unit: g, rate: 2}`"
_REQUIRED = ("left type", "left storeys", "right type", "right storeys", "gap")
_EXAMPLES = {"gap": "gap [cm]"}
_HEADING = re.compile(r"(?P<name>[^\[(]*?)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?\Z")
_PGA_OF_PERIOD = re.compile(r"pga (?P<years>\d+)(?: years?)?\Z")
_NAMES = ("name", "type", "design", "zone", "hazard")
"""Headings, without their side, below which texts stand."""

_PLAIN = Grammar()
"""How numbers are written once the signs of the table are settled."""

_OVERRIDES = {"period": "period", "damping": "damping", "mass": "mass"}
_UNIT_EXAMPLES = {"gap": "cm", "height": "m", "period": "s", "mass": "t", "pga": "g"}
"""Headings, without their side, below which a number needs a unit, and an example of one."""

_UNIT_YEARS = ("", "years", "year", "a", "yr")


def read_street(path: Path, settings: Settings | None = None) -> Street:
    """Read a table of neighbours.

    Raises InputError: with everything wrong in it, each with row and column.
    """
    settings = settings or Settings()
    text = load_text(path, "table of neighbours")
    problems = Problems(str(path))
    if settings.zone and settings.zone.upper() not in ZONES:
        message = f"'{settings.zone[:40]}' is not a zone of the Uniform Building Code"
        problems.add(("--zone", 0), message, f"write one of {', '.join(ZONES)}")
    rows = {number: line for number, line in enumerate(text.lines, 1) if line.strip() and not line.startswith("#")}
    head_line, head = next(iter(rows.items()))
    grammar = _build_grammar(settings, list(rows.values()))
    headings = _read_headings(_split(head, grammar), head_line, problems)
    problems.check()
    if len(rows) < 2:
        raise text.refuse("there is no pair below the headings", "write a row for each pair of neighbours", head_line)
    if len(rows) > MAX_PAIRS + 1:
        raise text.refuse(f"there are {len(rows) - 1} pairs", f"give at most {MAX_PAIRS}", max(rows))
    reader = _RowReader(path, settings, problems)
    pairs = []
    for line, row in list(rows.items())[1:]:
        named = _name_cells(_split(row, grammar), headings, grammar, line, problems)
        pair = reader.read(named, line) if named is not None else None
        if pair is not None:
            pairs.append(pair)
    _refuse_equal_names(pairs, problems)
    _refuse_other_buildings_of_one_name(pairs, problems)
    problems.check()
    return Street(path, "\n".join(text.lines), pairs, settings)


def _build_grammar(settings: Settings, lines: Sequence[str]) -> Grammar:
    """Return how the cells of a table are written."""
    separator = SEPARATOR_NAMES[settings.separator] if settings.separator else choose_table_separator(lines)
    return Grammar(separator, settings.decimal or ".", settings.thousands)


def _split(line: str, grammar: Grammar) -> list[tuple[str, int]]:
    """Return the cells of a line without quotes, each with its column."""
    return [(cell, grammar.find_column(line, place)) for place, cell in enumerate(grammar.split_row(line))]


def _name_cells(
    cells: Sequence[tuple[str, int]],
    headings: Sequence[tuple[str, str]],
    grammar: Grammar,
    line: int,
    problems: Problems,
) -> dict[str, Cell] | None:
    """Return the cells of a row that are not empty, by heading; None where they cannot be told apart or read, which is
    noted."""
    if len(cells) != len(headings):
        message = f"the row has {len(cells)} cells below {len(headings)} headings"
        hint = "put texts that hold a comma in quotes, and leave unknown cells empty; --separator parts the cells"
        problems.add((line, 1), message, hint)
        return None
    named = {}
    is_readable = True
    for (name, unit), (text, column) in zip(headings, cells, strict=True):
        fault = _find_sign_fault(name, text, grammar)
        if fault is not None:
            problems.add((line, column), fault.message, hint_options(fault))
            is_readable = False
        elif text:
            named[name] = _read_cell(_settle_signs(name, text, grammar), unit, (line, column))
            _check_unit(name, named[name], problems)
    return named if is_readable else None


def _is_of_text(name: str) -> bool:
    """Return whether texts stand below a heading."""
    return name.removeprefix(f"{LEFT} ").removeprefix(f"{RIGHT} ") in _NAMES


def _find_sign_fault(name: str, text: str, grammar: Grammar) -> Fault | None:
    """Return what is wrong with a number that other signs than the declared ones would make one; None of others."""
    number = text.partition(" ")[0]
    if _is_of_text(name) or not number or grammar.parse(number) is not None:
        return None
    fault = replace(grammar, separator=BLANKS).describe_fault(number)  # in quotes a cell may have any sign
    return fault if fault.cure else None


def _settle_signs(name: str, text: str, grammar: Grammar) -> str:
    """Return a cell whose number, with or without a unit behind it, has a decimal point and nothing between
    thousands."""
    number, blank, unit = text.partition(" ")
    value = grammar.parse(number)
    is_settled = grammar.decimal == "." and not grammar.thousands
    if value is None or is_settled or _is_of_text(name):
        return text
    return f"{value:.15g}{blank}{unit}"


def _read_headings(cells: Sequence[tuple[str, int]], line: int, problems: Problems) -> list[tuple[str, str]]:
    """Return name and unit of every column; what is wrong with them is noted."""
    headings: list[tuple[str, str]] = []
    for text, column in cells:
        match = _HEADING.match(text)
        name = " ".join((match["name"] if match else text).lower().replace("_", " ").split())
        unit = (match["unit"] or "") if match else ""
        if name not in HEADINGS and not _PGA_OF_PERIOD.match(name):
            hint = nearest(name, HEADINGS) or f"write one of {', '.join(HEADINGS)}"
            problems.add((line, column), f"'{text[:60]}' is not a heading of a table of neighbours", hint)
        elif name in [each for each, _ in headings]:
            problems.add((line, column), f"the heading '{name}' stands twice", "leave one of the columns out")
        headings.append((name, unit))
    names = {name for name, _ in headings}
    for name in _REQUIRED:
        if name not in names:
            problems.add(
                (line, 1), f"there is no column '{name}'", f"add `{_EXAMPLES.get(name, name)}` to the headings"
            )
    for side in (LEFT, RIGHT):
        if not names & {f"{side} design", f"{side} year"}:
            message = f"there is no column '{side} design' or '{side} year'"
            problems.add((line, 1), message, f"add one of them: {HEADINGS[f'{side} design']}")
    return headings


def _read_cell(text: str, unit: str, mark: Mark) -> Cell:
    """Return a cell with the unit of its heading, unless it has one of its own."""
    is_number = _PLAIN.parse(text) is not None
    return Cell(f"{text} {unit}" if unit and is_number else text, mark)


def _check_unit(name: str, cell: Cell, problems: Problems) -> None:
    """Note a number that needs a unit and has none."""
    quantity = name.removeprefix(f"{LEFT} ").removeprefix(f"{RIGHT} ")
    example = _UNIT_EXAMPLES.get("pga" if _PGA_OF_PERIOD.match(name) else quantity)
    number = _PLAIN.parse(cell.text)
    if example is not None and number is not None and number != 0.0:
        hint = f"write the unit into the heading, `{name} [{example}]`, or behind the number, `{cell.text} {example}`"
        problems.add(cell.mark, f"{cell.text} has no unit", hint)


def _refuse_other_buildings_of_one_name(pairs: Sequence[NeighbourPair], problems: Problems) -> None:
    """Note names that stand for two buildings: in one row, or at the right of a row and the left of the next one."""
    for pair in pairs:
        if pair.names[0] and pair.names[0] == pair.names[1]:
            message = f"'{pair.names[0]}' is the name of both buildings"
            problems.add((pair.line, 1), message, "give each building a name of its own")
    for pair, next_pair in pairwise(pairs):
        name = next_pair.names[0]
        if not name or name != pair.names[1]:
            continue
        here = next_pair.buildings[LEFT]
        there = pair.buildings[RIGHT]
        if any(here[key] != there[key] for key in here if key in there):
            message = f"'{name}' is another building here than at the right of row {pair.line}"
            hint = "write the same type, design level, storeys and measured values in both rows, or another name"
            problems.add((next_pair.line, 1), message, hint)


def _refuse_equal_names(pairs: Sequence[NeighbourPair], problems: Problems) -> None:
    """Note pairs that have one name."""
    lines: dict[str, int] = {}
    for pair in pairs:
        if pair.name in lines:
            message = f"'{pair.name}' is the name of the pair in row {lines[pair.name]} too"
            problems.add((pair.line, 1), message, "give each pair a name of its own")
        lines.setdefault(pair.name, pair.line)


class _RowReader:
    """Reads the rows of a table; what is wrong with them is noted.

    path : the table
    settings : what holds for all rows
    problems : takes what is wrong
    """

    def __init__(self, path: Path, settings: Settings, problems: Problems) -> None:
        self.path = path
        self.settings = settings
        self.problems = problems
        self._checked: set[str] = set()  # buildings that are sound

    def read(self, cells: Mapping[str, Cell], line: int) -> NeighbourPair | None:
        """Return a pair; None where something is wrong with it.

        cells : those that are not empty, by heading
        """
        count = len(self.problems.found)
        sides = {side: self._read_building(cells, side, line) for side in (LEFT, RIGHT)}
        gap = self._read_gap(cells, line)
        hazard, hazard_mark = self._read_hazard(cells, line)
        if len(self.problems.found) > count:
            return None
        marks = {side: (building.mark, building.mark) for side, building in sides.items()}
        names = tuple(cells[f"{side} name"].text if f"{side} name" in cells else "" for side in (LEFT, RIGHT))
        name = " | ".join(names) if all(names) else f"row {line}"
        if "name" in cells:
            name = cells["name"].text
        buildings = Map(sides, (line, 1), marks)
        return NeighbourPair(line, name, buildings, (names[0], names[1]), gap, cells["gap"], hazard, hazard_mark)

    def _take(self, cells: Mapping[str, Cell], name: str, line: int, example: str) -> Cell | None:
        """Return a cell; where it is empty, that is noted."""
        if name not in cells:
            self.problems.add((line, 1), f"'{name}' is empty", f"write {example}")
            return None
        return cells[name]

    def _read_number(self, cell: Cell, quantity: Quantity) -> float | None:
        """Return the value of a cell [SI]; what is wrong with it is noted."""
        try:
            return float(quantity.read(cell.text))
        except PydanticCustomError as refused:
            context = refused.context or {}
            self.problems.add(cell.mark, context.get("message", str(refused)), context.get("hint", ""))
            return None

    def _read_gap(self, cells: Mapping[str, Cell], line: int) -> float:
        cell = self._take(cells, "gap", line, "e.g. 4 below `gap [cm]`; 0 where they touch")
        value = None if cell is None else self._read_number(cell, GAP)
        return 0.0 if value is None else value

    def _read_building(self, cells: Mapping[str, Cell], side: str, line: int) -> Map:
        """Return what is written of one building, as a study has it; what is wrong is noted."""
        count = len(self.problems.found)
        mark: Mark = (line, 1)
        building = Map({}, mark)

        def put(target: Map, key: str, value: Any, at: Mark) -> None:
            target[key] = value
            target.marks[key] = (at, at)

        type_cell = self._take(cells, f"{side} type", line, "a building type of HAZUS, e.g. C1M")
        storeys_cell = self._take(cells, f"{side} storeys", line, "a number of storeys, e.g. 5")
        if type_cell is not None and type_cell.text.upper() not in list_types():
            hint = nearest(type_cell.text.upper(), list_types())
            self.problems.add(type_cell.mark, f"'{type_cell.text[:40]}' is not a building type of HAZUS", hint)
        design = self._read_design(cells, side, line, type_cell)
        if len(self.problems.found) > count or type_cell is None or storeys_cell is None or design is None:
            return building
        number = _PLAIN.parse(storeys_cell.text)
        storeys = int(number) if number is not None and number == int(number) else storeys_cell.text
        archetype = Map({}, type_cell.mark)
        put(archetype, "type", type_cell.text.upper(), type_cell.mark)
        put(archetype, "design", design.text, design.mark)
        put(archetype, "storeys", storeys, storeys_cell.mark)
        put(archetype, "neighbours", self.settings.neighbours, ("--neighbours", 0))
        put(building, "archetype", archetype, type_cell.mark)
        for heading, key in _OVERRIDES.items():
            if (cell := cells.get(f"{side} {heading}")) is not None:
                put(building, key, cell.text, cell.mark)
        if (cell := cells.get(f"{side} base shear")) is not None:
            put(building, "yield", mark_map({"base_shear": cell.text}, cell.mark), cell.mark)
        if (cell := cells.get(f"{side} height")) is not None:
            height = self._read_number(cell, LENGTH)
            if height is not None and isinstance(storeys, int) and storeys > 0:
                put(building, "height", f"{height / storeys:.6g} m", cell.mark)
        # Closings count too where slabs strike columns of floors at other heights.
        put(building, "columns", "20 %", mark)
        self._check_building(building, side)
        return building

    def _check_building(self, building: Map, side: str) -> None:
        """Note what a study would refuse of a building."""
        written = dump_yaml(building)
        if written in self._checked:
            return
        mark = building.mark
        tree = Map({"buildings": Map({side: building}, mark, {side: (mark, mark)})}, mark, {"buildings": (mark, mark)})
        try:
            read_spec(tree, ("buildings", side))
        except InputError as refused:
            for issue in refused.issues:
                self.problems.add_issue(tree, issue)
        else:
            self._checked.add(written)

    def _read_design(self, cells: Mapping[str, Cell], side: str, line: int, type_cell: Cell | None) -> Cell | None:
        """Return the design level of a building, as it is given or by its year; None where something is wrong."""
        if (design := cells.get(f"{side} design")) is not None:
            level = design.text.lower().replace(" ", "-")
            if level in DESIGNS:
                return Cell(level, design.mark)
            hint = nearest(level, DESIGNS) or f"write one of {', '.join(DESIGNS)}"
            self.problems.add(design.mark, f"'{design.text[:40]}' is not a design level", hint)
            return None
        example = f"1965 below `{side} year`, or a design level below `{side} design`"
        year_cell = cells.get(f"{side} year")
        if year_cell is None:
            self.problems.add((line, 1), f"'{side} design' and '{side} year' are empty", f"write {example}")
            return None
        year = _PLAIN.parse(year_cell.text)
        if year is None or not 1000 <= year <= 2100 or year != int(year):
            self.problems.add(year_cell.mark, f"'{year_cell.text[:40]}' is not a year", f"write {example}")
            return None
        zone_cell = cells.get("zone", Cell(self.settings.zone, ("--zone", 0)))
        zone = zone_cell.text.upper()
        if not zone:
            message = f"a year gives a design level only with the seismic zone of '{side} type'"
            hint = f"add a column `zone` or --zone ({', '.join(ZONES)}), or write the level below `{side} design`"
            self.problems.add(year_cell.mark, message, hint)
            return None
        if zone not in ZONES:
            message = f"'{zone_cell.text[:40]}' is not a zone of the Uniform Building Code"
            self.problems.add(zone_cell.mark, message, f"write one of {', '.join(ZONES)}")
            return None
        if type_cell is None or type_cell.text.upper() not in list_types():
            return None
        return Cell(find_design(type_cell.text.upper(), int(year), zone), year_cell.mark)

    def _read_hazard(self, cells: Mapping[str, Cell], line: int) -> tuple[Any, Mark]:
        """Return the hazard curve of a row, as a study has it, and where it stands."""
        if (cell := cells.get("hazard")) is not None:
            return self._parse_hazard(cell.text, cell.mark, self.path.parent), cell.mark
        points: dict[str, float] = {}
        mark: Mark = (line, 1)
        accelerations = []
        for name, cell in cells.items():
            match = _PGA_OF_PERIOD.match(name)
            if name != "pga" and match is None:
                continue
            mark = cell.mark
            value = self._read_number(cell, ACCELERATION)
            years = float(match["years"]) if match else self._read_return_period(cells)
            if value is None or years is None:
                continue
            if value > ACCELERATION.read(f"{MAX_PGA} g"):
                message = f"{cell.text} is no peak ground acceleration of a site: those are below {MAX_PGA:g} g"
                self.problems.add(cell.mark, message, "write e.g. 0.3 below `pga [g]`")
                continue
            accelerations.append((value, 1.0 / years))
            points[f"{value / ACCELERATION.read('1 g'):.6g} g"] = 1.0 / years
        if len(accelerations) == 1:
            ((value, rate),) = accelerations
            pga = value / ACCELERATION.read("1 g")
            return mark_map(self._extend_point(pga, rate, self.settings.slope), mark), mark
        if accelerations:
            ordered = sorted(accelerations)
            if any(second[1] >= first[1] or second[0] <= first[0] for first, second in pairwise(ordered)):
                hint = "give larger accelerations for longer return periods"
                self.problems.add(mark, "these accelerations are no hazard curve", hint)
                return mark_map(points, mark), mark
            (first, first_rate), (second, second_rate) = ordered[:2]
            slope = math.log(first_rate / second_rate) / math.log(second / first)
            below = self._extend_point(first / ACCELERATION.read("1 g"), first_rate, min(slope, self.settings.slope))
            return mark_map(below | points, mark), mark
        if self.settings.hazard:
            option: Mark = ("--hazard", 0)
            return self._parse_hazard(self.settings.hazard, option, Path()), option
        if mark == (line, 1) and "pga" not in cells:
            hint = "write `pga [g]` of the site, two of `pga 475 [g]` and `pga 2475 [g]`, or give --hazard"
            self.problems.add(mark, "there is no hazard: how often the ground shakes how strongly", hint)
        return mark_map({}, mark), mark

    @staticmethod
    def _extend_point(pga: float, rate: float, slope: float) -> dict[str, float]:
        """Return the hazard curve through one point, down to MIN_PGA.

        pga : [g]
        rate : at which it is exceeded [1/year]
        slope : exponent of the power law [-]
        """
        lowest = min(MIN_PGA, 0.5 * pga)
        at_lowest = rate * (pga / lowest) ** slope
        return {f"{lowest:.6g} g": float(f"{at_lowest:.6g}"), f"{pga:.6g} g": rate}

    def _read_return_period(self, cells: Mapping[str, Cell]) -> float | None:
        """Return the return period of `pga` in a row [years]; None where it is faulty, which is noted."""
        cell = cells.get("return period")
        if cell is None:
            return self.settings.return_period
        text, _, unit = cell.text.partition(" ")
        years = _PLAIN.parse(text)
        if years is None or not 1 <= years <= 1e7 or unit not in _UNIT_YEARS:
            message = f"'{cell.text[:40]}' is not a return period in years"
            self.problems.add(cell.mark, message, "write e.g. 475 below `return period [years]`")
            return None
        return years

    def _parse_hazard(self, text: str, mark: Mark, folder: Path) -> Any:
        """Return a hazard curve, as a study has it: a mapping, or a file beside the table.

        folder : from which files are named
        """
        is_mapping = text.lstrip().startswith("{")
        node = parse_value(text, str(mark[0])) if is_mapping else {"file": text}
        if "file" not in node:
            return mark_map(node, mark)
        file = folder / str(node["file"])
        if not file.is_file():
            hint = f"name {HAZARD_EXAMPLE}, or write e.g. `{{0.1 g: 0.02, 0.4 g: 1/475}}`"
            self.problems.add(mark, f"there is no hazard curve {str(file)[:80]}", hint)
        try:
            written = Path(os.path.relpath(file, self.path.parent)).as_posix()
        except ValueError:  # another drive
            written = str(file.resolve())
        return mark_map(node | {"file": written}, mark) if is_mapping else written
