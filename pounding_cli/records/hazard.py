"""Read files of hazard curves: annual rates at which intensities are exceeded.

An export of OpenQuake says in its headings what it holds: a comment with `investigation_time` and `imt`, columns
`poe-0.1` of probabilities, and the row of a site. Every other file has a row for each point, and its columns and unit
are declared; nothing is found out from its words. The rate of a probability p in t years is -ln(1 - p) / t."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from pounding_cli.cells import Grammar, Row, TextFile, load_text
from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import pluralize
from pounding_cli.reading import shorten_path
from pounding_cli.records.declaration import Declaration
from pounding_cli.records.number_rows import NumberRows, read_number_rows
from pounding_cli.records.units import find_acceleration_unit
from pounding_cli.units import GRAVITY, find_unit_factor

MAX_RATE = 1e3
"""Annual rate above which none is meant [1/year]."""

USUAL_RATE = 0.03
"""Annual rate at which 1 g is exceeded above which unit and columns are doubted [1/year]: once in 33 years."""

MAX_INTENSITY = 100.0
"""Acceleration above which none is meant [g]."""

_TIME = re.compile(r"investigation_time\s*=\s*[\"']*([^\"',\s]+)")
_MEASURE = re.compile(r"\bimt\s*=\s*[\"']*([^\"',]+)", re.IGNORECASE)
_SPECTRAL = re.compile(r"SA\((?P<period>[\d.]+)\)\Z")
_EXAMPLE_UNITS = {"m/s2": "g", "m/s": "cm/s"}
_SHOWN_LINES = 3


@dataclass(frozen=True)
class HazardColumns:
    """What is declared of a file of a hazard curve; None where it is not.

    intensity, rate, probability : columns, from 1
    unit : of the intensities
    years : in which the probabilities are those of being exceeded
    skip, rows, separator, decimal, thousands : as of a motion (`Declaration`)
    """

    intensity: int | None = None
    unit: str | None = None
    rate: int | None = None
    probability: int | None = None
    years: float | None = None
    skip: int | None = None
    rows: int | None = None
    separator: str | None = None
    decimal: str | None = None
    thousands: str | None = None

    def list_given(self) -> dict[str, object]:
        """Return what is declared, by its key."""
        return {each.name: value for each in fields(self) if (value := getattr(self, each.name)) is not None}

    def declare_cells(self) -> Declaration:
        """Return how the rows are written: those of a table with two columns, as of times and accelerations."""
        return Declaration(
            time=self.intensity, column=self.rate or self.probability, skip=self.skip, rows=self.rows,
            separator=self.separator, decimal=self.decimal, thousands=self.thousands,
        )  # fmt: skip


@dataclass(frozen=True)
class HazardCurve:
    """A hazard curve as a file has it.

    intensity : rising [SI], shape (n,), n >= 2
    rate : at which they are exceeded, falling [1/year], shape (n,)
    taken : what was taken of the file, in a sentence
    """

    intensity: np.ndarray
    rate: np.ndarray
    taken: str


@dataclass(frozen=True)
class _Points:
    """The points of a file as they stand there.

    intensity : in the unit of the file, shape (n,)
    rate : [1/year], inf of a probability of 1, shape (n,)
    places : line and column of the cell of each rate, from 1
    words : where they stand, for a reader
    """

    intensity: np.ndarray
    rate: np.ndarray
    places: Sequence[tuple[int, int]]
    words: str


def read_hazard(path: Path, si: str, declared: HazardColumns | None = None, measure: str = "") -> HazardCurve:
    """Return the hazard curve of a file: an export of OpenQuake where nothing is declared, else columns.

    si : SI unit of the intensities, "m/s2" of accelerations, "m/s" of velocities, "" of a factor
    measure : that the intensities are, as OpenQuake names it: PGA, PGV, SA(0.5), or SA of any period

    Raises
    ------
    InputError : no such file, nothing declared of one that OpenQuake has not written, another measure, several sites,
        rates that do not fall, probabilities above 1, cells that are no numbers; at line and column
    """
    declared = declared or HazardColumns()
    text = load_text(path, "hazard curve")
    heading = _find_openquake_heading(text)
    if heading is None:
        points = _read_columns(text, declared, si)
        return _build_curve(text, points, intensity_factor(declared.unit, si, str(path)), declared.unit or "", si)
    if given := declared.list_given():
        message = f"this is an export of OpenQuake, which says itself what {', '.join(given)} would"
        raise text.refuse(message, f"write `hazard: {path.name}`", heading.line)
    points = _read_openquake(text, heading, measure)
    unit = "g" if si == "m/s2" else "cm/s"
    return _build_curve(text, points, intensity_factor(unit, si, str(path)), unit, si)


def intensity_factor(unit: str | None, si: str, file: str) -> float:
    """Return one of a unit of intensity in SI.

    Parameters
    ----------
    unit : as written; None where nothing says it
    si : as in `read_hazard`
    file : where it is written, for the message

    Raises
    ------
    InputError : no unit, or one of another quantity
    """
    if si == "" and unit is None:
        return 1.0
    factor = None
    if unit is not None and si:
        try:
            factor = find_acceleration_unit(unit) if si == "m/s2" else find_unit_factor(unit, si)
        except ValueError:
            factor = None
    if factor is None:
        message = f"'{unit[:40]}' is no unit of this intensity" if unit else "nothing says the unit of the intensity"
        hint = f"write `unit: {_EXAMPLE_UNITS[si]}` beside it" if si else "leave `unit` out: a scale factor has none"
        raise InputError(Issue((), message, hint, file=file))
    return factor


def _build_curve(text: TextFile, points: _Points, one: float, unit: str, si: str) -> HazardCurve:
    """Return the curve through the points of a file that have a finite rate.

    one : unit of the file [SI]

    Raises
    ------
    InputError : fewer than two points, intensities that are not above 0 or stand twice, rates that do not fall
    """
    order = np.argsort(points.intensity, kind="stable")
    intensity = points.intensity[order]
    rate = points.rate[order]
    for place in range(order.size):
        line, column = points.places[order[place]]
        before = rate[place - 1] if place else np.inf
        has_no_rate = rate[place] == before and rate[place] in (0.0, np.inf)
        message = ""
        if not intensity[place] > 0:
            message = f"the intensity {intensity[place]:g} is not above 0"
        elif place and intensity[place] == intensity[place - 1]:
            message = f"the intensity {intensity[place]:g} stands twice"
        elif not (rate[place] < before or has_no_rate):
            message = (
                f"the rate does not fall from the intensity {intensity[place - 1]:g} to {intensity[place]:g}: "
                f"{before:.4g} and {rate[place]:.4g} a year"
            )
        elif si == "m/s2" and one * intensity[place] > MAX_INTENSITY * GRAVITY:
            message = f"the ground does not reach {intensity[place]:g} {unit}"
        if message:
            hint = "a hazard curve has each intensity once, and rates that fall as it rises: check columns and unit"
            raise text.refuse(f"this is not a hazard curve: {message}", hint, line, column)
    kept = (rate > 0.0) & np.isfinite(rate)
    if kept.sum() < 2:
        message = f"this is not a hazard curve: it has {pluralize(int(kept.sum()), 'point')} with a finite rate above 0"
        raise text.refuse(message, "give at least two intensities with their rates")
    taken = _describe(text, points, intensity[kept], rate[kept], unit)
    if left_out := _describe_left_out(intensity, rate, unit):
        taken += f"; left out: {left_out}"
    if si == "m/s2" and (doubt := _describe_doubt(one * intensity[kept] / GRAVITY, rate[kept])):
        taken += f"; {doubt}"
    return HazardCurve(one * intensity[kept], rate[kept], taken)


def _describe(text: TextFile, points: _Points, intensity: np.ndarray, rate: np.ndarray, unit: str) -> str:
    """Return what was taken of a file in words."""
    ends = f"from {intensity[0]:.6g} to {intensity[-1]:.6g}{f' {unit}' if unit else ''}"
    rates = f"annual rates from {rate[0]:.4g} to {rate[-1]:.4g}"
    name = shorten_path(text.path.name)
    return f"{name}: hazard curve of {pluralize(intensity.size, 'point')}, intensities {ends}, {rates}; {points.words}"


def _describe_left_out(intensity: np.ndarray, rate: np.ndarray, unit: str) -> str:
    """Return which points have no finite rate above 0, in words; "" where all have."""
    certain = np.isinf(rate)
    said = []
    if certain.any():
        lowest = f"{intensity[~certain][0]:.6g} {unit}".strip()
        points = pluralize(int(certain.sum()), "point")
        said.append(f"{points} of probability 1, which tells no rate, so that nothing below {lowest} counts")
    if rare := int((rate == 0.0).sum()):
        said.append(f"{pluralize(rare, 'point')} of 0, too rare to say")
    return " and ".join(said)


def _describe_doubt(acceleration: np.ndarray, rate: np.ndarray) -> str:
    """Return that 1 g is exceeded more often than at any known site, in words; "" where it is not.

    acceleration : [g]
    """
    if acceleration[-1] < 1.0:
        return ""
    at_one = float(np.exp(np.interp(0.0, np.log(acceleration), np.log(rate))))
    if at_one <= USUAL_RATE:
        return ""
    return f"1 g would be exceeded every {1.0 / at_one:.3g} years: are columns and unit right?"


# Exports of OpenQuake


def _find_openquake_heading(text: TextFile) -> Row | None:
    """Return the row of headings of an export of OpenQuake, the first one below its comment; None of other files."""
    for number, line in enumerate(text.lines, 1):
        if line.strip() and not line.lstrip('"').startswith("#"):
            row = Row(number, Grammar(",").split(line))
            return row if any(cell.startswith("poe-") for cell in row.cells) else None
    return None


def _read_openquake(text: TextFile, heading: Row, measure: str) -> _Points:
    """Return the points of the one site of an export of OpenQuake [g, or cm/s of PGV].

    Raises
    ------
    InputError : the comment does not say years and measure, another measure, several sites, a cell that is no number
    """
    grammar = Grammar(",")
    comment = "\n".join(text.lines[: heading.line - 1])
    years_match = _TIME.search(comment)
    years = grammar.parse(years_match[1]) if years_match else None
    if not years or years < 0:
        hint = "write `# investigation_time=50.0, imt='PGA'` above the heading, as the export has it"
        raise text.refuse("the probabilities are for an unknown number of years", hint, 1)
    measure_match = _MEASURE.search(comment)
    if measure_match is None:
        hint = "write `imt='PGA'` beside `investigation_time=`, as the export has it"
        raise text.refuse("the comment does not say of what intensity measure the curve is", hint, 1)
    found = measure_match[1].strip()
    if not _is_measure(found, measure):
        hint = f"export the curve of {measure or 'an intensity that the study has'}, or scale the motions to {found}"
        raise text.refuse(f"the hazard is that of {found}, the intensity is {measure or 'another'}", hint, 1)
    below = enumerate(text.lines[heading.line :], heading.line + 1)
    sites = [Row(number, grammar.split(line)) for number, line in below if line.strip()]
    if len(sites) != 1:
        hint = "leave the row of your site, and the heading"
        raise text.refuse(f"the file has the curves of {len(sites)} sites", hint, len(text.lines))
    site = sites[0]
    if len(site.cells) != len(heading.cells):
        message = f"the row has {len(site.cells)} cells below {len(heading.cells)} headings"
        raise text.refuse(message, "export the curve again", site.line)
    levels = Row(heading.line, [cell.removeprefix("poe-") for cell in heading.cells])
    intensity: list[float] = []
    probability: list[float] = []
    places = []
    for place, cell in enumerate(heading.cells):
        if cell.startswith("poe-"):
            for row, values in ((levels, intensity), (site, probability)):
                value = grammar.parse(row.cells[place])
                if value is None:
                    raise grammar.refuse_cell(text, row, place)
                values.append(value)
            places.append((site.line, grammar.find_column(text.lines[site.line - 1], place)))
    rates = _find_rates(text, np.array(probability), years, places)
    words = f"an export of OpenQuake, {found}, probabilities in {years:g} years"
    return _Points(np.array(intensity), rates, places, words)


def _is_measure(found: str, wanted: str) -> bool:
    """Return whether a measure of OpenQuake is the wanted one: PGA, SA(1.0) for SA(1), any SA(...) for SA."""
    spectral = _SPECTRAL.match(found)
    wanted_spectral = _SPECTRAL.match(wanted)
    if spectral and wanted_spectral:
        return float(spectral["period"]) == float(wanted_spectral["period"])
    return found == wanted or (wanted == "SA" and spectral is not None)


# Other files


def _read_columns(text: TextFile, declared: HazardColumns, si: str) -> _Points:
    """Return the points of the columns that are declared.

    Raises
    ------
    InputError : nothing is declared, a row is not as those above, a cell is no number, a column is not there
    """
    is_without_unit = declared.unit is None and si != ""
    if declared.intensity is None or is_without_unit:
        message = "nothing says the unit of the intensities"
        if declared.intensity is None:
            first = " ".join(next(line for line in text.lines if line.strip()).split())[:80]
            message = (
                f"nothing says which columns hold intensities and annual rates or probabilities; it begins '{first}'"
            )
        raise text.refuse(message, _propose(text, declared, si))
    table = read_number_rows(text, declared.declare_cells())
    value_column = declared.rate or declared.probability or 0
    for key, column in (("intensity", declared.intensity), ("rate or probability", value_column)):
        if column > table.width:
            hint = f"write one from 1 to {table.width}, or `separator:` for what parts the cells"
            message = f"{key}: there is no column {column}, the rows have {table.width}"
            raise text.refuse(message, hint, table.rows[0].line)
    lines = [(row.line, text.lines[row.line - 1]) for row in table.rows]
    places = [(line, table.grammar.find_column(cells, value_column - 1)) for line, cells in lines]
    values = table.take_column(value_column)
    is_rate = declared.years is None
    rates = values if is_rate else _find_rates(text, values, declared.years or 1.0, places)
    for rate, (line, column) in zip(values, places, strict=True):
        if not 0 <= rate <= MAX_RATE:
            raise text.refuse(f"{rate:g} is no annual rate", f"those are from 0 to {MAX_RATE:g}", line, column)
    what = "rate" if is_rate else f"probability in {declared.years:g} years"
    words = f"intensity: column {declared.intensity}, {what}: column {value_column}"
    return _Points(table.take_column(declared.intensity), rates, places, words + _quote_unread(table))


def _find_rates(
    text: TextFile, probability: np.ndarray, years: float, places: Sequence[tuple[int, int]]
) -> np.ndarray:  # fmt: skip
    """Return the annual rates of probabilities in so many years, inf of 1, shape (n,).

    Raises
    ------
    InputError : one is below 0 or above 1
    """
    for value, (line, column) in zip(probability, places, strict=True):
        if not 0 <= value <= 1:
            hint = "probabilities are from 0 to 1: divide those in percent by 100; write `rate:` if they are rates"
            raise text.refuse(f"{value:g} is no probability", hint, line, column)
    with np.errstate(divide="ignore"):
        return -np.log1p(-probability) / years


def _propose(text: TextFile, declared: HazardColumns, si: str) -> str:
    """Return the line of a study to fill in and write, with what is declared already."""
    entry: dict[str, object] = {"file": text.path.name, "intensity": 1}
    if si:
        entry["unit"] = _EXAMPLE_UNITS[si]
    column = 1 if declared.intensity == 2 else 2
    ways: list[dict[str, object]] = [{"rate": column}, {"probability": column, "years": 50}]
    if declared.rate is not None or declared.probability is not None:
        ways = ways[:1] if declared.probability is None else ways[1:]
    given = declared.list_given()
    lines = [", ".join(f"{key}: {_quote(value)}" for key, value in (entry | way | given).items()) for way in ways]
    return "write " + " or ".join(f"`hazard: {{{line}}}`" for line in lines) + ", with the columns from 1"


def _quote(value: object) -> str:
    """Return a value as YAML writes it in braces."""
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return text if re.fullmatch(r"[\w./%][\w./ %^-]*", text) else f'"{text}"'


def _quote_unread(table: NumberRows) -> str:
    """Return the lines that were not read in words; "" where there is none."""
    if not table.unread:
        return ""
    shown = ", ".join(f"'{line.words[:80]}'" for line in table.unread[:_SHOWN_LINES])
    more = " ..." if len(table.unread) > _SHOWN_LINES else ""
    return f"; {pluralize(len(table.unread), 'line')} not read: {shown}{more}"
