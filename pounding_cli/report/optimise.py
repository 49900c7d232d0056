"""The report of `pound optimise`: the optimum, and the number sought along every key."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.numbers import Unit, counted
from pounding_cli.report.background import background, frame_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, axis_keys, motion_sentence, nominal
from pounding_cli.report.references import Use
from pounding_cli.report.style import caption, entitle, name_axis, new_figure, styled
from pounding_cli.report.table import NOTHING, from_rows
from pounding_cli.results.tables import Table
from pounding_cli.workflows.optimise import DESIGN, OPTIMUM, POINTS, UNSETTLED
from pounding_cli.workflows.optimise import NOTHING as NO_OPTIMUM

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

MOST_KEYS = 8
"""Keys that are drawn."""
_AT_END = 1e-6
"""Of a range: nearer to its end than that, the optimum lies at it [-]."""
_LINE, _BEST, _WRITTEN, _GOOD = "#0072B2", "#AA2211", "#E69F00", "0.9"

Key = dict[Any, Any]
"""A row of the table of keys."""
_OF_KEY = ("value", "written")
"""Its columns, beside the ends of ranges, in the unit of the key."""


@dataclass(frozen=True)
class Optimum:
    """The answer as it was read back, keys in the units of the study.

    keys : a row of the table for each
    tried : every point; units : of its columns
    design : what the buildings do at the optimum and with the study as written, a row for each quantity
    """

    keys: list[Key]
    tried: pd.DataFrame
    units: Mapping[str, Unit]
    design: list[Key]

    @classmethod
    def of(cls, results: Results) -> Optimum:
        """The answer in a results file."""
        keys, points, design = (results.answer(name) for name in (OPTIMUM, POINTS, DESIGN))
        units, tried = {name: column.unit for name, column in points.columns.items()}, points.frame.copy()
        rows = keys.frame.to_dict("records")
        for row in rows:
            factor = units[row["key"]].factor
            row |= {
                name: row[name] / factor for name in map(str, row) if name in _OF_KEY or name.endswith(("_from", "_to"))
            }
            if pd.api.types.is_numeric_dtype(tried[row["key"]]):
                tried[row["key"]] /= factor
        return cls(rows, tried, units, design.frame.to_dict("records"))

    @property
    def first(self) -> Key:
        """What is the same for all keys."""
        return self.keys[0]

    @property
    def sought(self) -> str:
        """What is sought least or most, with its unit."""
        return self.units["value"].label(str(self.first["sought"]).partition(" ")[2])

    def through(self, free: Key) -> pd.DataFrame:
        """The points with a number that differ from the optimum in one key alone."""
        here = self.tried["value"].notna()
        for key in self.keys:
            if key is not free:
                here &= self.tried[key["key"]] == (key["option"] or key["value"])
        return self.tried[here]


def optimise_report(results: Results) -> Report:
    """What the search for an optimum says."""
    whole, results = results, results.first_sample()
    found, shown = Optimum.of(results), nominal(results)
    said, tables, pictures = sentences(found), list[Table](), list[Picture]()
    if found.first["outcome"] != NO_OPTIMUM:
        tables = [_optimum(found), _design(found)]
        text = f"{said[0]} Along each key through the optimum, and every point that was tried."
        draw = partial(draw_optimum, found, shown)
        pictures = [Picture("optimise", "The optimum and its surroundings", text, draw, has_scale=True)]
    scene = whole.scene()
    return Report(
        **frame_of(results, shown, scene, len(scene[axis_keys(scene)].drop_duplicates())),
        answer=Section("", said, tables, pictures, list(notes(found))),
        more=lambda: background(whole, shown, scene, ("records",)),
    )


# In words


def _optimum(found: Optimum) -> Table:
    """A row for each key."""

    def text(*values: float) -> str:
        return NOTHING if any(map(isnan, values)) else " to ".join(Unit().text(value, 4) for value in values)

    rows = []
    for key in found.keys:
        spans = [text(key[f"{name}_from"], key[f"{name}_to"]) for name in ("good", "range")]
        if key["option"]:
            spans[1] = ", ".join(dict.fromkeys(map(str, found.tried[key["key"]])))
        values = [key["option"] or text(key["value"]), key["written_option"] or text(key["written"])]
        rows.append([found.units[key["key"]].label(key["key"]), *values, *spans])
    heads = ("key", "best", "as written", "as good", "searched")
    return from_rows("The optimum", heads, rows)


def _design(found: Optimum) -> Table:
    """What the buildings do at the optimum, and beside it with the study as written."""

    def text(row: Key, value: float) -> str:
        if value != value:
            return NOTHING
        if row["of"]:
            return f"{value:.0f} of {row['of']}"
        return f"{value:.5g} {row['unit'] if row['unit'] != '1' else ''}".rstrip()

    rows = [
        [row["quantity"], text(row, row["optimum"]), text(row, row["as_written"])]
        for row in found.design
        if row["quantity"] != "scenes that failed" or row["optimum"] or row["as_written"]
    ]
    return from_rows("What the buildings do", ("quantity", "at the optimum", "as written"), rows)


def sentences(found: Optimum) -> list[str]:
    """The answer, and what is left of contacts and flags at the optimum."""
    first, unit = found.first, f" {found.units['value'].name}".rstrip()
    direction, _, sought = str(first["sought"]).partition(" ")
    what = f"{direction.capitalize()} of {sought}"
    if first["outcome"] == NO_OPTIMUM:
        return [f"{what}: no point gave a number that means something, so there is no answer."]
    worth = f" ± {first['error']:.1g}" if first["error"] > 0 else ""
    said = f"{what}: {first['optimum']:.5g}{worth}{unit}"
    if first["as_written"] == first["as_written"]:
        said += f"; with the study as written: {first['as_written']:.5g}{unit}"
    flags = [
        row["quantity"].partition(": ")[2] for row in found.design if "flagged: " in row["quantity"] and row["optimum"]
    ]
    count, of = next((row["optimum"], row["of"]) for row in found.design if row["quantity"] == "scenes with contact")
    contact = "no contact is left" if count == 0 else f"contact is left in {count:.0f} of {counted(of, 'scene')}"
    if count != count:
        contact = "contacts are not known, since a scene failed"
    flagged = f"flagged: {', '.join(flags)}" if flags else "nothing is flagged"
    return [f"{said}.", f"At the optimum {contact}; {flagged}."]


def notes(found: Optimum) -> Iterator[str]:
    """What a reader should know of the numbers."""
    first = found.first
    if first["outcome"] != NO_OPTIMUM and first["error"] != first["error"]:
        yield "The numerical error is not known: no scene near the optimum was assessed (`estimate:`)."
    for key in found.keys if first["outcome"] != NO_OPTIMUM else ():
        ends = np.array([key["range_from"], key["range_to"]], float)
        near = np.abs(ends - key["value"]) <= _AT_END * abs(ends[1] - ends[0])
        if near.any():
            yield f"{key['key']} is best at the end of its range: a better value may lie beyond."
    if first["outcome"] == UNSETTLED:
        yield ("The search ended before the points of a generation were nearly as good: write more `generations:`.")
    of = int(first["points"])
    if first["failed"]:
        yield f"{counted(int(first['failed']), 'point')} of {of} gave no number: a scene failed, or has no such number."
    if first["meaningless"]:
        yield (
            f"{counted(int(first['meaningless']), 'point')} of {of} were excluded: a link left the range in which its "
            "law has a meaning (`pound show FILE.h5 flagged`)."
        )


# Figures


@styled
def draw_optimum(found: Optimum, shown: Evidence) -> Figure:
    """A panel for each key."""
    keys = found.keys[:MOST_KEYS]
    count = len(keys)
    columns = 2 if count == 4 else min(count, 3)
    lines = -(-count // columns)
    figure = new_figure(3.3 * columns + 0.6, 2.7 * lines + 0.9)
    axes = figure.subplots(lines, columns, squeeze=False).ravel()
    near = found.tried[found.tried["stage"].isin(["slices", "as written"])]["value"].dropna()
    values = [*(near if len(near) else found.tried["value"].dropna()), found.first["optimum"]]
    room = 0.05 * float(np.ptp(values)) or 0.01 * abs(values[-1]) or 1.0
    for number, (ax, key) in enumerate(zip(axes, keys, strict=False)):
        _along(ax, found, key)
        ax.set_ylim(min(values) - room, max(values) + room)
        if number % columns == 0:
            ax.set_ylabel(found.sought, fontsize=7.5)
    for ax in axes[count:]:
        ax.axis("off")
    handles = {h.get_label(): h for ax in axes[:count] for h in ax.get_legend_handles_labels()[0]}
    below_title = (0.005, 1.0 - 0.27 / figure.get_figheight())
    figure.legend(handles.values(), handles.keys(), loc="upper left", bbox_to_anchor=below_title, ncols=5, fontsize=8)
    entitle(figure, f"{shown.title}\n")  # the second line is the legend's
    caption(figure, f"{' '.join(sentences(found))} {motion_sentence(shown.records)}")
    return figure


def _along(ax: Axes, found: Optimum, key: Key) -> None:
    """The number sought along one key through the optimum, every point behind it."""
    name, frame, line = key["key"], found.tried, found.through(key)
    dots: dict[str, Any] = {"ls": "", "marker": ".", "ms": 2.5, "color": "0.65", "label": "point tried"}
    through: dict[str, Any] = {"color": _LINE, "label": "through the optimum"}
    if key["option"]:
        numbers, options = pd.factorize(frame[name].to_numpy())
        shift = np.random.default_rng(1).uniform(-0.25, 0.25, len(numbers))
        ax.plot(numbers + shift, frame["value"], **dots)
        number = {option: place for place, option in enumerate(options)}
        ax.plot([number[option] for option in line[name]], line["value"], ls="", marker="_", ms=16, mew=2, **through)
        ax.set_xticks(range(len(options)), options)
        at, written = float(number[key["option"]]), float(number.get(key["written_option"], np.nan))
    else:
        if key["good_from"] == key["good_from"]:
            ax.axvspan(key["good_from"], key["good_to"], color=_GOOD, lw=0, label="as good")
        ax.plot(frame[name], frame["value"], **dots)
        line = line.sort_values(name)
        ax.plot(line[name], line["value"], lw=1.6, **through)
        ax.set_xscale(key["spacing"])
        at, written = key["value"], key["written"]
    if found.first["as_written"] == found.first["as_written"]:
        mark: dict[str, Any] = {"marker": "D", "ms": 6, "color": _WRITTEN, "mec": "k", "label": "as written"}
        ax.plot([written], [found.first["as_written"]], ls="", **mark)
    ax.plot([at], [found.first["optimum"]], ls="", marker="*", ms=11, color=_BEST, mec="k", mew=0.6, label="optimum")
    name_axis(ax, "x", [name], [found.units[name]], 7.5, 32)
    ax.tick_params(labelsize=7.5)


def cite_optimise(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of a search."""
    used("storn1997", "differential evolution, as in SciPy")
    used("nelder1965", "the simplex method, as in SciPy")
