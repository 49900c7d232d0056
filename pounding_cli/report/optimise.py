"""The report of `pound optimise`: the number sought along every key, and its map over the two that matter most."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from pounding_cli.numbers import Unit
from pounding_cli.report.answer_page import AnswerPage, Illustration
from pounding_cli.report.citations import Use
from pounding_cli.report.evidence import Evidence, motion_sentence
from pounding_cli.report.key_words import name_axis
from pounding_cli.report.maps import COLOURS
from pounding_cli.report.optimise_text import (
    DESIGN_HEADS,
    Optimum,
    cells,
    design_cells,
    heads,
    notes,
    optimum_of,
    sentences,
)
from pounding_cli.report.style import caption, entitle, new_figure, styled
from pounding_cli.report.web.story import Grid
from pounding_cli.store import Results

MOST_KEYS = 8
"""Keys that are drawn."""

_LINE, _BEST, _WRITTEN, _FLAT = "#0072B2", "#AA2211", "#E69F00", "0.9"


def optimise_page(results: Results, shown: Evidence, with_figures: bool = True) -> AnswerPage:
    """What the report of an optimum says."""
    found = optimum_of(results)
    lead, grids = sentences(found), []
    figures: dict[str, Illustration] = {}
    if found.is_found:
        grids.append(("The optimum", Grid(heads(found), cells(found), range(1, len(heads(found))))))
        grids.append(("What the buildings do", Grid(DESIGN_HEADS, design_cells(found), (1, 2))))
        if with_figures:
            text = f"{lead[0]} Along each key through the optimum, and every point that was tried."
            figures["optimise"] = Illustration(draw_optimum(found, shown), "The optimum and its surroundings", text)
    return AnswerPage("Optimum", lead, figures, grids, notes(found))


@styled
def draw_optimum(found: Optimum, shown: Evidence) -> Figure:
    """A panel for each key, and the map."""
    keys = found.keys[:MOST_KEYS]
    mapped = [key for key in found.keys if key["mapped"]]
    panels = len(keys) + (1 if mapped else 0)
    columns = 2 if panels == 4 else min(panels, 3)
    lines = -(-panels // columns)
    figure = new_figure(3.3 * columns + 0.6, 2.7 * lines + 0.9)
    axes = figure.subplots(lines, columns, squeeze=False).ravel()
    window = _window(found)
    for ax, key in zip(axes, keys, strict=False):
        _along(ax, found, key, window)
    for number, ax in enumerate(axes[: len(keys)]):
        if number % columns == 0:
            ax.set_ylabel(found.label_of_value, fontsize=7.5)
    if mapped:
        _map(figure, axes[len(keys)], found, mapped)
    for ax in axes[panels:]:
        ax.axis("off")
    handles = {h.get_label(): h for ax in axes[:panels] for h in ax.get_legend_handles_labels()[0]}
    below_title = (0.005, 1.0 - 0.27 / figure.get_figheight())
    figure.legend(handles.values(), handles.keys(), loc="upper left", bbox_to_anchor=below_title, ncols=5, fontsize=8)
    entitle(figure, f"{shown.title}\n")  # the second line is the legend's
    caption(figure, f"{' '.join(sentences(found))} {motion_sentence(shown.records)}")
    return figure


def _window(found: Optimum) -> tuple[float, float]:
    """The values that are drawn: those of the slices and the map, and of the file as written."""
    frame = found.tried.frame
    here = frame.loc[frame["stage"].isin(["slices", "map", "as written"]), "value"].to_numpy(float)
    here = here if np.isfinite(here).any() else frame["value"].to_numpy(float)
    here = np.append(here[np.isfinite(here)], found.first["optimum"])
    low, high = float(here.min()), float(here.max())
    room = 0.05 * (high - low) or 0.01 * abs(high) or 1.0
    return low - room, high + room


def _slice(found: Optimum, key: dict[Any, Any]) -> pd.DataFrame:
    """The points that differ from the optimum in one key alone."""
    frame = found.tried.frame
    here = np.ones(len(frame), bool)
    for other in found.keys:
        if other["key"] != key["key"]:
            column = frame[other["key"]]
            here &= (column == (other["option"] or other["value"])).to_numpy()
    return frame[here & frame["value"].notna().to_numpy()].sort_values(key["key"])


def _shown(found: Optimum, name: str, values: Any) -> np.ndarray:
    """Values of a key in the unit of the study."""
    unit = found.tried.units.get(name)
    return np.asarray(values, float) / (unit.factor if unit else 1.0)


def _name(ax: Axes, which: str, found: Optimum, key: dict[Any, Any]) -> None:
    unit = found.tried.units.get(key["key"], Unit())
    name_axis(ax, which, [key["key"]], [unit], found.resolved, 7.5, 32)


def _along(ax: Axes, found: Optimum, key: dict[Any, Any], window: tuple[float, float]) -> None:
    """The number sought along one key through the optimum, every point behind it."""
    name, frame, line = key["key"], found.tried.frame, _slice(found, key)
    ax.set_ylim(window)
    _name(ax, "x", found, key)
    ax.tick_params(labelsize=7.5)
    first = found.first
    if key["option"]:
        options = list(dict.fromkeys(frame[name]))
        number = {option: place for place, option in enumerate(options)}
        x = frame[name].map(number).to_numpy(float)
        shift = np.random.default_rng(1).uniform(-0.25, 0.25, x.size)
        ax.plot(x + shift, frame["value"], ls="", marker=".", ms=2.5, color="0.65", label="point tried")
        best = line.groupby(name)["value"].agg("min" if found.direction == "least" else "max")
        ax.plot(
            [number[option] for option in best.index], best, ls="", marker="_", ms=16, mew=2, color=_LINE,
            label="through the optimum",
        )  # fmt: skip
        ax.set_xticks(range(len(options)), options)
        at, written = float(number[key["option"]]), float(number.get(key["written_option"], np.nan))
    else:
        if key["flat_from"] == key["flat_from"]:
            ax.axvspan(
                *_shown(found, name, [key["flat_from"], key["flat_to"]]), color=_FLAT, lw=0, label="as good by itself"
            )
        ax.plot(
            _shown(found, name, frame[name]), frame["value"], ls="", marker=".", ms=2.5, color="0.65",
            label="point tried",
        )  # fmt: skip
        ax.plot(_shown(found, name, line[name]), line["value"], color=_LINE, lw=1.6, label="through the optimum")
        if key["spacing"] == "log":
            ax.set_xscale("log")
        at, written = (float(_shown(found, name, key[which])) for which in ("value", "written"))
    if first["as_written"] == first["as_written"]:
        ax.plot([written], [first["as_written"]], ls="", marker="D", ms=6, color=_WRITTEN, mec="k", label="as written")
    ax.plot([at], [first["optimum"]], ls="", marker="*", ms=11, color=_BEST, mec="k", mew=0.6, label="optimum")


def _map(figure: Figure, ax: Axes, found: Optimum, mapped: list[dict[Any, Any]]) -> None:
    """Contours of the number over two keys, the others at the optimum; every point that lies there."""
    x_key, y_key = mapped
    frame = found.tried.frame
    here = np.array(frame["stage"].isin(["map", "slices"]) & frame["value"].notna())
    for other in found.keys:
        if other["key"] not in (x_key["key"], y_key["key"]):
            here &= (frame[other["key"]] == (other["option"] or other["value"])).to_numpy()
    frame = frame[here]
    x, y = (_shown(found, key["key"], frame[key["key"]]) for key in mapped)
    for key, apply in ((x_key, ax.set_xscale), (y_key, ax.set_yscale)):
        apply(key["spacing"])
    on_paper = [np.log(v) if key["spacing"] == "log" else v for v, key in zip((x, y), mapped, strict=True)]
    flat = [(v - v.min()) / np.ptp(v) for v in on_paper]
    corners = Triangulation(x, y, Triangulation(*flat).triangles)
    drawn = ax.tricontourf(corners, frame["value"].to_numpy(float), levels=14, cmap=COLOURS)
    bar = figure.colorbar(drawn, ax=ax, pad=0.02, aspect=22)
    bar.ax.tick_params(labelsize=7.5)
    bar.set_label(found.label_of_value, fontsize=7.5)
    ax.plot(x, y, ls="", marker=".", ms=1.5, color="0.85")
    ax.plot(
        *(_shown(found, key["key"], [key["value"]]) for key in mapped), ls="", marker="*", ms=11, color=_BEST, mec="k",
        mew=0.6,
    )  # fmt: skip
    ax.grid(False)
    ax.tick_params(labelsize=7.5)
    _name(ax, "x", found, x_key)
    _name(ax, "y", found, y_key)


def cite_optimise(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of a search."""
    used("storn1997", "differential evolution, as in SciPy")
    used("nelder1965", "the simplex method, as in SciPy")
