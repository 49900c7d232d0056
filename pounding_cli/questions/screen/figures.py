"""The figure of `pound screen`: the street, its buildings to scale and its gaps coloured by the rate of contact."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pounding_cli.questions.screen.tables import SCREEN_TABLE
from pounding_cli.report.document import Picture
from pounding_cli.report.style import finish, with_style

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap, LogNorm
    from matplotlib.figure import Figure

    from pounding_cli.results.results import ResultTables

ROW_WIDTH = 34.0
"""Width of a line of buildings, so that a page of a telephone shows the ranks of pairs."""

_WIDTH = 3.0
_GAP = 0.9
_SPACE = 1.2
"""Widths of a building, of a gap and of the space between pairs, in units of the drawing."""

MEDIAN_HEIGHT, MAX_HEIGHT, MIN_LINE = 0.32, 2.4, 0.35
"""Heights in the drawing of the median building, of the tallest one at most, and of a line at least [in]."""

_BELOW = 0.22
"""Height below a line of buildings, for the ranks [in]."""

_WALL = "0.80"
_EDGE = "0.35"


class _PlacedPair(NamedTuple):
    """A pair in the drawing.

    row : of the table
    begin : where its left building begins
    is_shared : whether the pair before has drawn it
    """

    row: dict[Any, Any]
    begin: float
    is_shared: bool


def list_figures(results: ResultTables) -> list[Picture]:
    """Return the street; nothing where no pair has a rate."""
    frame = results.answer(SCREEN_TABLE).frame
    if not (frame["rate"] > 0).any():
        return []
    text = (
        "Pairs of neighbours in the order of the table, heights to scale, gaps coloured by the annual rate of contact."
    )
    draw = partial(draw_street, frame, results.title)
    return [Picture("street", "The street", text, draw, has_scale=True)]


@with_style
def draw_street(frame: pd.DataFrame, title: str) -> Figure:
    """Draw the pairs in the order of their rows, a few in each line; numbers are ranks."""
    import matplotlib.pyplot as plt
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm
    from matplotlib.ticker import LogLocator

    rows: list[dict[Any, Any]] = frame.sort_values("row").to_dict("records")
    lines = _break_lines(rows)
    heights = frame[["left_height", "right_height"]].to_numpy()
    scale = min(MEDIAN_HEIGHT / float(np.median(heights)), MAX_HEIGHT / float(heights.max()))  # [in/m]
    inches = [max(scale * _find_tallest(line), MIN_LINE) + _BELOW for line in lines]
    rates = frame["rate"][frame["rate"] > 0]
    low = float(rates.min())
    high = float(rates.max())
    norm = LogNorm(low / 1.5 if low == high else low, high * 1.5 if low == high else high)
    colours = plt.get_cmap("YlOrRd")
    figure, axes = plt.subplots(
        len(lines),
        1,
        figsize=(3.4, 0.9 + 1.05 * sum(inches)),
        squeeze=False,
        layout="constrained",
        height_ratios=inches,
    )
    for ax, line, line_inches in zip(axes[:, 0], lines, inches, strict=True):
        _draw_line(ax, line, scale, line_inches, colours, norm)
    mappable = ScalarMappable(norm, colours)
    bar = figure.colorbar(
        mappable, ax=axes[:, 0].tolist(), location="top", aspect=40, shrink=0.9, pad=0.02, ticks=LogLocator(numticks=5)
    )
    bar.set_label("annual rate of contact [1/year]", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    finish(figure, title, "Buildings to scale in height; the number below a gap is the rank of the pair, 1 the worst.")
    return figure


def _break_lines(rows: list[dict[Any, Any]]) -> list[list[_PlacedPair]]:
    """Return the pairs line by line, each with its place; a building that two of them share stands once."""
    lines: list[list[_PlacedPair]] = []
    x = 0.0
    before = ""
    for row in rows:
        is_shared = bool(before) and row["left_name"] == before
        begin = x - _WIDTH if is_shared else x + _SPACE
        if not lines or begin + 2 * _WIDTH + _GAP > ROW_WIDTH:
            lines.append([])
            is_shared = False
            begin = 0.0
        lines[-1].append(_PlacedPair(row, begin, is_shared))
        x = begin + 2 * _WIDTH + _GAP
        before = str(row["right_name"])
    return lines


def _find_tallest(line: list[_PlacedPair]) -> float:
    """Return the height of the tallest building of a line [m]."""
    return max(max(place.row["left_height"], place.row["right_height"]) for place in line)


def _draw_line(
    ax: Axes, line: list[_PlacedPair], scale: float, inches: float, colours: Colormap, norm: LogNorm
) -> None:
    """Draw some pairs side by side.

    scale : of the drawing [in/m]
    inches : height of the line with its ranks [in]
    """
    for row, begin, is_shared in line:
        if not is_shared:
            _draw_building(ax, begin, row["left_height"], row["left_storeys"])
        x = begin + _WIDTH
        colour = colours(norm(row["rate"])) if row["rate"] > 0 else "1.0"
        facing = min(row["left_height"], row["right_height"])
        ax.add_patch(_build_box(x, _GAP, facing, facecolor=colour, edgecolor="none"))
        ax.text(x + _GAP / 2, -0.03 / scale, str(row["rank"]), ha="center", va="top", fontsize=8)
        _draw_building(ax, x + _GAP, row["right_height"], row["right_storeys"])
    ax.set_xlim(-0.2, ROW_WIDTH + 0.2)
    ax.set_ylim(-_BELOW / scale, (inches - _BELOW) / scale)
    ax.axhline(0.0, color=_EDGE, lw=0.8)
    ax.axis("off")


def _draw_building(ax: Axes, x: float, height: float, storeys: float) -> None:
    """Draw a building with its floors."""
    ax.add_patch(_build_box(x, _WIDTH, height, facecolor=_WALL, edgecolor=_EDGE, lw=0.6))
    floors = np.linspace(0.0, height, int(storeys) + 1)[1:-1]
    ax.hlines(floors, x, x + _WIDTH, color="1.0", lw=0.5)


def _build_box(x: float, width: float, height: float, **look: Any) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((x, 0.0), width, height, **look)
