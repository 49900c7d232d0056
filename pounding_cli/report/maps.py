"""Maps of a quantity over two swept axes: one panel a case, one colour scale a quantity."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PatchCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from pounding_cli.report.axes import MOST_TICKS, Placed, SweptAxis, placed
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.figures import framed
from pounding_cli.report.quantity import OverSweep, Panels
from pounding_cli.report.style import caption, styled

COLOURS = "viridis"  # equal steps of a number are equal steps to the eye, also printed in grey
NOTHING = "0.87"
PANELS_IN_A_ROW = 4
LARGE_RANGE = 30.0
"""Largest over smallest value above which the colours follow the logarithm."""


@styled
def draw_maps(evidence: Evidence, black: Sequence[str], headline: str, panels: Sequence[Panels], words: str) -> Figure:
    """One panel for every case of each of `panels`; the second axis of the quantities is across.

    black : buildings filled in the drawing of the group
    words : what is drawn, for the caption
    """
    columns = min(max(len(row.by_case) for row in panels), PANELS_IN_A_ROW)
    blocks = [
        (row, list(row.by_case)[start : start + columns])
        for row in panels
        for start in range(0, len(row.by_case), columns)
    ]
    along, across = next(iter(panels[0].by_case.values())).axes
    width, height = _inches(across, columns), _inches(along, columns)
    figure, axes = framed(
        evidence, black, len(blocks), columns, headline, cases=(), width=width + 0.3, height=height + 0.5
    )
    x, y = placed(across, int(11 * width), cells=True), placed(along, 200, cells=True)
    for line, (row, cases) in zip(axes, blocks, strict=True):
        norm = _norm(row)
        for ax, case in zip(line, cases, strict=False):
            _draw(ax, row.by_case[case], x, y, norm)
            ax.set_title(f"{case}, {row.heading.lower()}", loc="left")
        along.name(line[0], "y")
        for ax in line[len(cases) :]:
            ax.axis("off")
        bar = figure.colorbar(ScalarMappable(norm, COLOURS), ax=line[: len(cases)], pad=0.02, aspect=18)
        bar.set_label(next(iter(row.by_case.values())).title)
        if isinstance(norm, LogNorm):
            bar.ax.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            bar.ax.yaxis.set_minor_formatter(NullFormatter())
    caption(figure, f"{words}.{_marks(panels)}{x.key}{y.key}")
    return figure


def _inches(axis: SweptAxis, columns: int) -> float:
    """Width or height of a panel: room for a number in every cell, or for the picture of many."""
    return 1.0 + 0.34 * max(len(axis), 3) if len(axis) <= MOST_TICKS else (4.5 if columns == 1 else 3.2)


def _norm(row: Panels) -> Normalize:
    """The colour scale of all panels of a quantity."""
    every = np.concatenate([over.mean.ravel() for over in row.by_case.values()])
    every = every[np.isfinite(every)]
    low, high = (float(every.min()), float(every.max())) if every.size else (0.0, 1.0)
    if low > 0 and high > LARGE_RANGE * low:
        return LogNorm(low, high)
    return Normalize(low, high if high > low else low + 1e-3 * max(abs(low), 1.0))


def _draw(ax: Axes, over: OverSweep, x: Placed, y: Placed, norm: Normalize) -> None:
    order = np.ix_(y.order, x.order)
    values, void = np.ma.masked_invalid(over.mean[order]), over.meaningless[order] > 0
    ax.grid(False)
    ax.set_facecolor(NOTHING)
    x.apply(ax, "x")
    y.apply(ax, "y")
    ax.pcolormesh(x.positions, y.positions, values, norm=norm, cmap=COLOURS, shading="nearest", rasterized=True)
    if void.any():
        _hatch(ax, x.positions, y.positions, void)
    if x.ticks is not None and y.ticks is not None:
        _print(ax, values, void, x, y, norm)
    elif over.is_ratio and min(values.shape) > 2 and values.count() and values.min() < 1 < values.max():
        ax.contour(x.positions, y.positions, values, levels=[1.0], colors="white", linewidths=1.2)
    _, across = over.axes
    across.name(ax, "x")
    ax.tick_params(length=3)


def _hatch(ax: Axes, x: np.ndarray, y: np.ndarray, cells: np.ndarray) -> None:
    """Hatch the cells whose numbers mean nothing."""
    across, up = _edges(x), _edges(y)
    found = [Rectangle((across[j], up[i]), across[j + 1] - across[j], up[i + 1] - up[i]) for i, j in np.argwhere(cells)]
    ax.add_collection(PatchCollection(found, facecolor="none", edgecolor="white", hatch="//", linewidth=0))


def _edges(places: np.ndarray) -> np.ndarray:
    """Where cells around places begin and end: half way to their neighbours."""
    half = np.diff(places) / 2
    return np.concatenate(([places[0] - half[0]], places[:-1] + half, [places[-1] + half[-1]]))


def _print(ax: Axes, values: np.ma.MaskedArray, void: np.ndarray, x: Placed, y: Placed, norm: Normalize) -> None:
    """The numbers in the cells, dark on light and light on dark; hatching ends before them."""
    colours = mpl.colormaps[COLOURS]
    for i, j in np.argwhere(~np.ma.getmaskarray(values)):
        colour = colours(norm(values[i, j]))
        dark = float(np.dot(colour[:3], (0.299, 0.587, 0.114))) < 0.5
        ax.text(
            x.positions[j], y.positions[i], short(values[i, j]), ha="center", va="center", fontsize=7,
            color="white" if dark else "black",
            bbox={"facecolor": colour, "edgecolor": "none", "pad": 0.8} if void[i, j] else None,
        )  # fmt: skip


def short(value: float) -> str:
    """A number for a cell: three digits, two below one, no more than five characters."""
    size = abs(value)
    if size == 0:
        return "0"
    if size >= 1e5:
        return f"{value:.0e}".replace("e+0", "e")
    return f"{value:.0f}" if size >= 99.95 else f"{value:.1f}" if size >= 9.995 else f"{value:.2f}"


def _marks(panels: Sequence[Panels]) -> str:
    """What hatching, grey and the white line mean, in sentences."""
    every = [over for row in panels for over in row.by_case.values()]
    said = ""
    if any(over.meaningless.any() for over in every):
        reasons = "; ".join(dict.fromkeys(reason for over in every for reason in over.reasons))
        said += f" Hatched: the numbers of some motions have no meaning, {reasons}."
    if any(np.isnan(over.mean).any() for over in every):
        said += " Grey: no number."
    if any(over.is_ratio and max(over.mean.shape) > MOST_TICKS for over in every):
        said += " White line: ratio 1."
    return said
