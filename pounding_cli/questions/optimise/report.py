"""The report of `pound optimise`: the optimum, what the buildings do there, and the number sought along every key."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.numbers import Unit, pluralize
from pounding_cli.questions.optimise.optimum import DESIGN, OPTIMUM, POINTS, UNSETTLED
from pounding_cli.questions.optimise.optimum import NOTHING as NO_OPTIMUM
from pounding_cli.report.background import report_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, describe_motions, find_nominal
from pounding_cli.report.style import finish, grid, name_axis, shared_legend, styled
from pounding_cli.report.table import NOTHING, column_of, from_rows
from pounding_cli.results.tables import Table

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

MOST_KEYS = 8
"""Keys that are drawn."""
_AT_END = 1e-6
"""Of a range: nearer to its end than that, the optimum lies at it [-]."""

NOTICED = 0.01
"""What the optimum makes larger by more than this part is said [-]."""
_NOT_WORSE = ("contacts, all motions", "largest max_closing")
"""Rows of the design in which more is not worse: a wider gap may close further; scenes with contact are counted."""

_SOUGHT = ["optimum", "as_written", "error"]
"""Columns in the unit of the number sought."""
_OF_KEY = ["value", "written", *(f"{name}_{end}" for name in ("good", "range") for end in ("from", "to"))]
"""Columns in the unit of the key."""

Row = Mapping[Any, Any]


def optimise_report(results: ResultTables) -> Report:
    """What the search for an optimum says."""
    shown = find_nominal(results.first_sample())
    keys, tried, units = _in_units(results)
    first, design = keys.iloc[0].to_dict(), results.answer(DESIGN).frame.to_dict("records")
    said, tables, pictures = _sentences(results, first, design, units["value"]), list[Table](), list[Picture]()
    if first["outcome"] != NO_OPTIMUM:
        tables = [_optimum(keys, tried, units), _design(results, design)]
        draw = partial(draw_optimum, keys, tried, units, shown, " ".join(said))
        text = f"{said[0]} Along each key through the optimum, and every point that was tried."
        pictures = [Picture("optimise", "The optimum and its surroundings", text, draw)]
    return report_of(results, shown, Section("", said, tables, pictures, list(_notes(keys))), is_sampled=True)


def _in_units(results: ResultTables) -> tuple[pd.DataFrame, pd.DataFrame, dict[str, Unit]]:
    """Keys and points that were tried, in the units in which they are shown, and these by column."""
    keys, points = results.answer(OPTIMUM).frame.copy(), results.answer(POINTS)
    tried, units = points.frame.copy(), {name: column.unit for name, column in points.columns.items()}
    units["value"] = _unit_of(results, keys["sought"].iloc[0], units["value"])
    keys[_SOUGHT] /= units["value"].factor
    keys[_OF_KEY] = keys[_OF_KEY].div(keys["key"].map(lambda key: units[key].factor), axis=0)
    for name in ("value", *keys["key"]):
        if pd.api.types.is_numeric_dtype(tried[name]):  # not of a choice
            tried[name] /= units[name].factor
    return keys, tried, units


def _unit_of(results: ResultTables, words: str, known: Unit) -> Unit:
    """The unit in which a number is shown that is called "largest drift in stiff", and has a unit: that of the variable
    named alone; `known` of sums, shares and other expressions."""
    named = [word for word in words.split() if word in results.data]
    return column_of(named[0], results.units).unit if known.name and len(named) == 1 else known


def _optimum(keys: pd.DataFrame, tried: pd.DataFrame, units: Mapping[str, Unit]) -> Table:
    """A row for each key."""

    def text(*values: float) -> str:
        return NOTHING if np.isnan(values).any() else " to ".join(Unit().text(value, 4) for value in values)

    rows = []
    for row in keys.to_dict("records"):
        spans = [text(row[f"{name}_from"], row[f"{name}_to"]) for name in ("good", "range")]
        if row["option"]:
            spans[-1] = ", ".join(tried[row["key"]].unique())
        values = [row["option"] or text(row["value"]), row["written_option"] or text(row["written"])]
        rows.append([units[row["key"]].label(row["key"]), *values, *spans])
    heads = ("key", "best", "as written", "as good", "searched")
    return from_rows("The optimum", heads, rows)


def _design(results: ResultTables, design: Sequence[Row]) -> Table:
    """What the buildings do at the optimum, and beside it with the study as written."""
    rows = []
    for row in design:
        if row["quantity"] == "scenes that failed" and not (row["optimum"] or row["as_written"]):
            continue
        values = [_value_text(results, row, row[name]) for name in ("optimum", "as_written")]
        rows.append([row["quantity"] + _over_motions(results, row), *values])
    return from_rows("What the buildings do", ("quantity", "at the optimum", "as written"), rows)


def _value_text(results: ResultTables, row: Row, value: float) -> str:
    """Return a value of a row of the design as people read it: "3 of 5" scenes, "38.5 mm"."""
    if np.isnan(value):
        return NOTHING
    if row["of"]:
        return f"{value:.0f} of {row['of']}"
    return _unit_of(results, row["quantity"], Unit(row["unit"].removeprefix("1"))).text(value, 5)


def _over_motions(results: ResultTables, row: Row) -> str:
    """Return what is taken of the number sought over several motions and points of a sweep; "" of the other rows."""
    if not row["over_motions"]:
        return ""
    words = f", {row['over_motions']} of {pluralize(len(results.data['record']), 'motion')}"
    if len(results.axes) > len(results.swept[-1]):
        words += f", {results.resolved['optimise']['over_sweep']} of the sweep"
    return words


def _worse(results: ResultTables, direction: str, sought: str, design: Sequence[Row]) -> str:
    """Return in a sentence what is larger at the optimum than with the study as written, by more than NOTICED; "" where
    nothing is.

    direction : of the search, "least" or "most"; where the most is sought, that quantity is larger by intention
    """
    said = []
    for row in design[1:]:
        name = row["quantity"]
        if name in _NOT_WORSE or (direction == "most" and set(name.split()) & set(sought.split()) & set(results.data)):
            continue
        if row["optimum"] > (1 + NOTICED) * row["as_written"]:
            values = [_value_text(results, row, row[column]) for column in ("optimum", "as_written")]
            said.append(f"{name}, {values[0]} in place of {values[1]}")
    return f"The optimum makes worse: {'; '.join(said)}." if said else ""


def _sentences(results: ResultTables, first: Row, design: Sequence[Row], unit: Unit) -> list[str]:
    """The answer, what is left of contacts and flags at the optimum, and what it makes worse."""
    direction, _, sought = str(first["sought"]).partition(" ")
    what = f"{direction.capitalize()} of {sought}"
    if first["outcome"] == NO_OPTIMUM:
        return [f"{what}: no point gave a number that means something, so there is no answer."]
    worth = f" ± {first['error']:.1g}" if first["error"] > 0 else ""
    said = f"{what}: {first['optimum']:.5g}{worth} {unit.name}".rstrip()
    if not np.isnan(first["as_written"]):
        said += f"; with the study as written: {first['as_written']:.5g} {unit.name}".rstrip()
    if over := _over_motions(results, design[0]).removeprefix(", "):
        said += f" ({over}, storey by storey)"
    at = {row["quantity"]: row["optimum"] for row in design}
    of = next(row["of"] for row in design if row["quantity"] == "scenes with contact")
    contact = "contacts are not known, since a scene failed"
    if not np.isnan(count := at["scenes with contact"]):
        contact = f"contact is left in {count:.0f} of {pluralize(of, 'scene')}" if count else "no contact is left"
    flags = ", ".join(name.partition(": ")[2] for name, number in at.items() if "flagged: " in name and number)
    left = f"At the optimum {contact}; {f'flagged: {flags}' if flags else 'nothing is flagged'}."
    worse = _worse(results, direction, sought, design)
    return [f"{said}.", left, *([worse] if worse else [])]


def _notes(keys: pd.DataFrame) -> Iterator[str]:
    """What a reader should know of the numbers."""
    first = keys.iloc[0].to_dict()
    of = int(first["points"])
    if first["outcome"] != NO_OPTIMUM:
        if np.isnan(first["error"]):
            yield "The numerical error is not known: no scene near the optimum was assessed (`estimate:`)."
        ends = keys[["range_from", "range_to"]].to_numpy(float)
        near = abs(ends - keys[["value"]].to_numpy(float)) <= _AT_END * np.ptp(ends, axis=1, keepdims=True)
        for key in keys["key"][near.any(axis=1)]:
            yield f"{key} is best at the end of its range: a better value may lie beyond."
    if first["outcome"] == UNSETTLED:
        yield "The search ended before the points of a generation were nearly as good: write more `generations:`."
    if first["failed"]:
        points = pluralize(int(first["failed"]), "point")
        yield f"{points} of {of} gave no number: a scene failed, or has no such number."
    if first["meaningless"]:
        points = pluralize(int(first["meaningless"]), "point")
        yield (
            f"{points} of {of} were excluded: a link left the range in which its "
            "law has a meaning (`pound show FILE.h5 flagged`)."
        )


@styled
def draw_optimum(
    keys: pd.DataFrame, tried: pd.DataFrame, units: Mapping[str, Unit], shown: Evidence, said: str
) -> Figure:
    """The number sought over each key: every point that was tried, and a line through those that differ from the
    optimum in this key alone."""
    rows, best = keys.head(MOST_KEYS).to_dict("records"), keys["option"].where(keys["option"] != "", keys["value"])
    is_best = pd.DataFrame({key: tried[key] == value for key, value in zip(keys["key"], best, strict=True)})
    along = [tried[is_best.drop(columns=row["key"]).all(axis=1) & tried["value"].notna()] for row in rows]
    values = pd.concat([*(line["value"] for line in along), keys["optimum"], keys["as_written"]]).dropna()
    room = 0.05 * float(np.ptp(values)) or 0.01 * abs(values.iloc[0]) or 1.0
    sought = units["value"].label(rows[0]["sought"].partition(" ")[2])
    figure, axes = grid(len(rows), 3.3, 2.7, textwrap.fill(sought, 36))
    for ax, row, line in zip(axes, rows, along, strict=True):
        _along(ax, row, tried, line)
        ax.set_ylim(values.min() - room, values.max() + room)
        name_axis(ax, "x", [row["key"]], [units[row["key"]]], 7.5, 32)
        ax.yaxis.label.set_fontsize(7.5)
        ax.tick_params(labelsize=7.5)
    shared_legend(figure, axes)
    finish(figure, shown.title, f"{said} {describe_motions(shown.records)}")
    return figure


def _along(ax: Axes, row: Row, tried: pd.DataFrame, line: pd.DataFrame) -> None:
    """One panel; options of a choice stand beside each other."""
    name, at, written, style = row["key"], row["value"], row["written"], dict[str, Any]()
    x: Any = tried[name]
    through: Any = line.sort_values(name)[name]
    if row["option"]:
        numbers, options = pd.factorize(x.to_numpy())
        place = {option: number for number, option in enumerate(options)}
        at, written = place[row["option"]], place.get(row["written_option"], np.nan)
        x, through = numbers + np.random.default_rng(1).uniform(-0.25, 0.25, len(numbers)), through.map(place)
        style = {"ls": "", "marker": "_", "ms": 16, "mew": 2}
        ax.set_xticks(range(len(options)), options)
    else:
        ax.set_xscale(row["spacing"])
        if not np.isnan(row["good_from"]):
            ax.axvspan(row["good_from"], row["good_to"], color="0.9", lw=0, label="as good")
    ax.plot(x, tried["value"], ls="", marker=".", ms=2.5, color="0.65", label="point tried")
    ax.plot(through, line["value"][through.index], color="#0072B2", label="through the optimum", **style)
    mark: dict[str, Any] = {"ls": "", "mec": "k", "mew": 0.6}
    ax.plot(written, row["as_written"], marker="D", ms=6, color="#E69F00", label="as written", **mark)
    ax.plot(at, row["optimum"], marker="*", ms=11, color="#AA2211", label="optimum", **mark)


def cite_optimise(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """The references of a search."""
    yield "storn1997", "differential evolution, as in SciPy"
    yield "nelder1965", "the simplex method, as in SciPy"
