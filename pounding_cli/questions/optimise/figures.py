"""The figure of `pound optimise`: the number sought over every key, and every point that was tried."""

from __future__ import annotations

import textwrap
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.questions.expression_words import describe_output
from pounding_cli.questions.optimise.question import NO_OPTIMUM
from pounding_cli.questions.optimise.tables import OPTIMUM, SEARCHED_POINTS
from pounding_cli.questions.optimise.words import MAX_KEYS, find_goal, key_unit, list_sentences, sought_unit
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import describe_motions, find_nominal
from pounding_cli.report.style import finish, grid, is_for_page, name_axis, shared_legend, with_style
from pounding_cli.tables import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pounding_cli.results.results import ResultTables

_OF_SOUGHT = ["optimum", "as_written"]
"""Columns in the unit of the number sought."""

_OF_KEY = ["value", "written", "good_from", "good_to", "range_from", "range_to"]
"""Columns in the unit of the key."""


def list_figures(results: ResultTables) -> list[Picture]:
    """Return the figure of the optimum; none where there is none."""
    if results.answer(OPTIMUM).frame["outcome"].iloc[0] in NO_OPTIMUM:
        return []
    text = f"{list_sentences(results)[0]} Along each key through the optimum, and every point that was tried."
    return [Picture("optimise", "The optimum and its surroundings", text, partial(draw_optimum, results))]


@with_style
def draw_optimum(results: ResultTables) -> Figure:
    """Return the number sought over each key: every point tried, and a line along this key through the optimum."""
    keys = _scale_keys(results)
    points = _scale_points(results, list(keys["key"]))
    rows = keys.head(MAX_KEYS).to_dict("records")
    best = keys["option"].where(keys["option"] != "", keys["value"])
    is_best = pd.DataFrame({key: points[key] == value for key, value in zip(keys["key"], best, strict=True)})
    lines = [points[is_best.drop(columns=row["key"]).all(axis=1) & points["value"].notna()] for row in rows]
    values = pd.concat([*(line["value"] for line in lines), keys["optimum"], keys["as_written"]]).dropna()
    room = 0.05 * float(np.ptp(values)) or 0.01 * abs(values.iloc[0]) or 1.0
    sought = sought_unit(results).label(describe_output(find_goal(results)[1]))
    figure, axes = grid(len(rows), 3.3, 2.7, textwrap.fill(sought, 36))
    for ax, row, line in zip(axes, rows, lines, strict=True):
        _draw_key(ax, row, points, line)
        ax.set_ylim(values.min() - room, values.max() + room)
        name_axis(ax, "x", [row["key"]], [key_unit(results, row["key"])], 7.5, 32)
        ax.yaxis.label.set_fontsize(7.5)
        ax.tick_params(labelsize=7.5)
    shared_legend(figure, axes)
    motions = describe_motions(find_nominal(results.first_sample()).records)
    answer = [] if is_for_page() else list_sentences(results)  # stands above the figure on a page
    finish(figure, results.title, " ".join([*answer, "Every point that was tried.", motions]))
    return figure


def _scale_keys(results: ResultTables) -> pd.DataFrame:
    """Return the rows of the keys in the units in which they are drawn."""
    keys = results.answer(OPTIMUM).frame.copy()
    keys[_OF_SOUGHT] /= sought_unit(results).factor
    factors = keys["key"].map(lambda key: key_unit(results, key).factor)
    keys[_OF_KEY] = keys[_OF_KEY].div(factors, axis=0)
    return keys


def _scale_points(results: ResultTables, keys: list[str]) -> pd.DataFrame:
    """Return the points that were tried in the units in which they are drawn."""
    points = results.answer(SEARCHED_POINTS).frame.copy()
    points["value"] /= sought_unit(results).factor
    for key in keys:
        if pd.api.types.is_numeric_dtype(points[key]):  # not of a choice
            points[key] /= key_unit(results, key).factor
    return points


def _draw_key(ax: Axes, row: Row, points: pd.DataFrame, line: pd.DataFrame) -> None:
    """Draw one panel; options of a choice stand beside each other.

    row : of the key
    line : the points that differ from the optimum in this key alone
    """
    key = row["key"]
    best = row["value"]
    written = row["written"]
    style: dict[str, Any] = {}
    x: Any = points[key]
    along: Any = line.sort_values(key)[key]
    if row["option"]:
        numbers, options = pd.factorize(x.to_numpy())
        places = {option: number for number, option in enumerate(options)}
        best = places[row["option"]]
        written = places.get(row["written_option"], np.nan)
        x = numbers + np.random.default_rng(1).uniform(-0.25, 0.25, len(numbers))
        along = along.map(places)
        style = {"ls": "", "marker": "_", "ms": 16, "mew": 2}
        ax.set_xticks(range(len(options)), options)
    else:
        ax.set_xscale(row["spacing"])
        if not np.isnan(row["good_from"]):
            ax.axvspan(row["good_from"], row["good_to"], color="0.9", lw=0, label="as good")
    x = pd.Series(np.asarray(x), points.index)
    is_met = points["unmet"] == 0
    ax.plot(x[is_met], points["value"][is_met], ls="", marker=".", ms=2.5, color="0.65", label="point tried")
    if not is_met.all():
        style_unmet: dict[str, Any] = {"ls": "", "marker": "x", "ms": 3, "mew": 0.6, "color": "#CC79A7"}
        ax.plot(x[~is_met], points["value"][~is_met], label="does not meet what is required", **style_unmet)
    ax.plot(along, line["value"][along.index], color="#0072B2", label="through the optimum", **style)
    mark: dict[str, Any] = {"ls": "", "mec": "k", "mew": 0.6}
    ax.plot(written, row["as_written"], marker="D", ms=6, color="#E69F00", label="as written", **mark)
    ax.plot(best, row["optimum"], marker="*", ms=11, color="#AA2211", label="optimum", **mark)
