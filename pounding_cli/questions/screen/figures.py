"""The figure of `pound screen`: the street, its buildings to scale and its gaps coloured by the rate of contact."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.questions.screen.tables import SCREEN_TABLE
from pounding_cli.report.document import Picture
from pounding_cli.report.style import finish, styled

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap, LogNorm
    from matplotlib.figure import Figure

    from pounding_cli.results.results import ResultTables

PAIRS_PER_LINE = 8
"""Pairs side by side, so that a page of a telephone shows their numbers."""

_WIDTH = 3.0
_GAP = 0.9
_SPACE = 1.2
"""Widths of a building, of a gap and of the space between pairs, in units of the drawing."""

_WALL = "0.80"
_EDGE = "0.35"


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


@styled
def draw_street(frame: pd.DataFrame, title: str) -> Figure:
    """Draw the pairs in the order of their rows, a few in each line; numbers are ranks."""
    import matplotlib.pyplot as plt
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm

    rows: list[dict[Any, Any]] = frame.sort_values("row").to_dict("records")
    lines = [rows[first : first + PAIRS_PER_LINE] for first in range(0, len(rows), PAIRS_PER_LINE)]
    tallest = float(frame[["left_height", "right_height"]].max().max())
    rates = frame["rate"][frame["rate"] > 0]
    low = float(rates.min())
    high = float(rates.max())
    norm = LogNorm(low / 1.5 if low == high else low, high * 1.5 if low == high else high)
    colours = plt.get_cmap("YlOrRd")
    height = 0.9 + 0.95 * len(lines)
    figure, axes = plt.subplots(len(lines), 1, figsize=(6.4, height), squeeze=False, layout="constrained")
    for ax, line in zip(axes[:, 0], lines, strict=True):
        _draw_line(ax, line, tallest, colours, norm)
    scale = ScalarMappable(norm, colours)
    bar = figure.colorbar(scale, ax=axes[:, 0].tolist(), location="top", aspect=40, shrink=0.9, pad=0.02)
    bar.set_label("annual rate of contact [1/year]")
    finish(figure, title, "Buildings to scale in height; the number below a gap is the rank of the pair, 1 the worst.")
    return figure


def _draw_line(ax: Axes, line: list[dict[Any, Any]], tallest: float, colours: Colormap, norm: LogNorm) -> None:
    """Draw some pairs side by side; a building that two of them share stands once."""
    x = 0.0
    before = ""
    for row in line:
        is_shared = bool(before) and row["left_name"] == before
        if not is_shared:
            x += _SPACE if before is not None and x > 0 else 0.0
            _draw_building(ax, x, row["left_height"], row["left_storeys"])
            x += _WIDTH
        colour = colours(norm(row["rate"])) if row["rate"] > 0 else "1.0"
        facing = min(row["left_height"], row["right_height"])
        ax.add_patch(_build_box(x, _GAP, facing, facecolor=colour, edgecolor="none"))
        ax.text(x + _GAP / 2, -0.04 * tallest, str(row["rank"]), ha="center", va="top", fontsize=9)
        x += _GAP
        _draw_building(ax, x, row["right_height"], row["right_storeys"])
        x += _WIDTH
        before = str(row["right_name"])
    full = PAIRS_PER_LINE * (2 * _WIDTH + _GAP + _SPACE) - _SPACE
    ax.set_xlim(-0.2, full + 0.2)
    ax.set_ylim(-0.28 * tallest, 1.05 * tallest)
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
