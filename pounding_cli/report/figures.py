"""The figures of a study at one point of its sweep: storeys upwards, ratios across (Figs 6-7), the group to scale."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.numbers import pluralize
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import RESPONSES, Evidence, describe_motions
from pounding_cli.report.style import case_handles, finish, grid, looks, new_figure, shared_legend, styled
from pounding_cli.results.columns import column_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Panel = tuple[xr.DataArray, str]
"""A quantity over case, record and storey or floor, of one analysis; the label of its axis."""


def profiles(evidence: Evidence) -> list[Picture]:
    """Every figure: response and accelerations of every building."""
    found = []
    for building in sorted(evidence.buildings_without_walls, key=lambda name: name != evidence.main_building):
        said = "Ratios to the building alone, storey by storey, one line per case."
        draw = partial(response, evidence, building)
        found.append(Picture(f"{building}-response", f"{building}: storey shears and ductilities", said, draw))
        said = "Largest floor accelerations over those of the building alone, floor by floor."
        draw = partial(accelerations, evidence, building)
        found.append(Picture(f"{building}-accelerations", f"{building}: floor accelerations", said, draw))
    return found


@styled
def response(evidence: Evidence, building: str) -> Figure:
    """V/V0 elastic (left) and mu/mu0 inelastic (right) of one building, as in Figs 6 and 7."""
    line = [
        (evidence.data[ratio].sel(analysis=analysis, building=building), column_of(ratio).label)
        for analysis, ratio in RESPONSES
        if analysis in evidence.analyses
    ]
    return _over_height(evidence, building, line, f"Ratios to {building} alone under the same motion")


@styled
def accelerations(evidence: Evidence, building: str) -> Figure:
    """Largest floor accelerations of one building over those alone."""
    data, label = evidence.data.sel(building=building), "floor acceleration over that alone"
    line = [(data["acceleration_ratio"].sel(analysis=each), label) for each in evidence.analyses]
    return _over_height(evidence, building, line, f"Largest total accelerations of the floors of {building}")


def _over_height(evidence: Evidence, building: str, line: Sequence[Panel], what: str) -> Figure:
    """A line of panels with storeys or floors upwards and ratios to the building alone, whose 1 is marked, across.

    what : is drawn, for the caption
    """
    figure, ((*axes,),) = framed(evidence, building, 1, len(line), cases=evidence.plotted_cases)
    for ax, (values, label) in zip(axes, line, strict=True):
        _panel(ax, evidence, values)
        ax.set_title(str(values["analysis"].item()).capitalize(), loc="left")
        ax.set_xlabel(label)
        ax.axvline(1, color="0.35", lw=1.0, zorder=1)
    text = f"{what}: mean over the {pluralize(len(evidence.records), 'motion')}; whiskers: smallest to largest."
    text += f" {describe_motions(evidence.records)}"
    text += f" Point of the sweep: {evidence.label}." if evidence.label else ""
    text += " Grey and open: not meaningful for some motions." if evidence.void else ""
    finish(figure, f"{building} (T = {evidence.periods[building]:.2f} s): {evidence.title}", text)
    return figure


def framed(
    evidence: Evidence, black: str, rows: int, columns: int, size: tuple[float, float] = (3.6, 3.3),
    cases: Sequence[str] = (),
) -> tuple[Figure, list[list[Axes]]]:  # fmt: skip
    """A figure with the group's drawing and the legend of `cases` above `rows` x `columns` panels of a size [in].

    black : building filled in the drawing
    """
    figure = new_figure(max(columns * size[0], 5.4), rows * size[1] + 1.75)
    grid = figure.add_gridspec(2, 1, height_ratios=[0.95, size[1] * rows])
    wide = figure.get_figwidth()
    drawing = min(0.62 * len(evidence.group) + 0.2, 0.6 * wide)
    head = grid[0].subgridspec(1, 2, width_ratios=[drawing, wide - drawing])
    draw_group(figure.add_subplot(head[0]), evidence, black)
    side = figure.add_subplot(head[1])
    side.axis("off")
    if cases:
        handles = case_handles({case: evidence.mark_case(case) for case in cases})
        side.legend(handles=handles, loc="center left", ncols=-(-len(cases) // 3), handlelength=3.2, borderaxespad=0)
    return figure, [list(row) for row in grid[1].subgridspec(rows, columns).subplots(squeeze=False)]


def _panel(ax: Axes, evidence: Evidence, values: xr.DataArray) -> None:
    """One line a case over the levels: mean over the motions, whiskers from the smallest to the largest; grey where it
    means nothing.

    values : over case, record and storey or floor, of one analysis
    """
    level, analysis, look = str(values.dims[-1]), str(values["analysis"].item()), looks(evidence.plotted_cases)
    cases = [case for case in evidence.plotted_cases if np.isfinite(values.sel(case=case)).any()]
    # Whiskers of neighbouring cases would hide each other on one height.
    shifts = np.linspace(0.09, -0.09, len(cases)) if len(cases) > 1 else np.zeros(len(cases))
    for case, shift in zip(cases, shifts.tolist(), strict=True):
        spread = values.sel(case=case).to_series().groupby(level).agg(["mean", "min", "max"]).dropna()
        heights, void = spread.index.to_numpy(float), (case, analysis) in evidence.void
        # A line between floors that are not neighbours would show links where there are none.
        joined = len(heights) > 1 and bool((np.diff(heights) == 1).all())
        ax.errorbar(
            spread["mean"], heights + shift, xerr=[spread["mean"] - spread["min"], spread["max"] - spread["mean"]],
            color="0.6" if void else look[case].color, ls=look[case].line if joined else "none",
            marker=look[case].marker, ms=5, mfc="white" if void else None, lw=1.6, elinewidth=0.8, capsize=2,
        )  # fmt: skip
    shown = values.sel(case=cases)
    if shown.size and shown.min() > 0 and shown.max() / shown.min() > 8:
        ax.set_xscale("log")
    there = values[level].values[np.isfinite(values.values).any(axis=(0, 1))]
    low, top = (min(1, int(there.min())), int(there.max())) if len(there) else (1, 1)  # a base is floor 0
    ticks = list(range(low, top + 1) if top <= 12 else range(5, top + 1, 5))
    ax.set(ylabel=level, ylim=(low - 0.4, top + 0.4))
    ax.set_yticks(ticks, [str(tick or "base") for tick in ticks])


# isolators

MOST_LOOPS = 6
"""Scenes in the figure of the loops."""


def loop_pictures(evidence: Evidence) -> list[Picture]:
    """The force of isolators over the displacement of their base, of kept scenes; nothing where there are none."""
    bases = {name: evidence.building_of_study(name).get("foundation") for name in evidence.group}
    isolated = [name for name, base in bases.items() if isinstance(base, dict) and base.get("isolation")]
    kept = evidence.rows_here(evidence.results.histories()).head(MOST_LOOPS)
    if not isolated or kept.empty:
        return []
    text = f"Force of the isolators of {', '.join(isolated)} over the displacement of the base, of kept scenes."
    return [Picture("isolators", "Isolators", text, partial(draw_loops, evidence, isolated, kept))]


@styled
def draw_loops(evidence: Evidence, isolated: list[str], kept: pd.DataFrame) -> Figure:
    """A panel for each building on isolators, a line for each kept scene."""
    figure, axes = grid(len(isolated), 4.2, 3.4)
    look = looks(list(kept["case"]))
    for place in kept[["case", "analysis", "record"]].to_dict("records"):
        history = evidence.results.history(*place.values(), **evidence.point)
        how: dict[str, Any] = {
            "color": look[place["case"]].color,
            "ls": "--" if place["analysis"] == "inelastic" else "-",
        }
        for ax, name in zip(axes, isolated, strict=True):
            number = list(history.buildings).index(name)
            sway, force = history.sway[:, number], history.base_force[:, number]
            ax.plot(100 * sway, force / 1e6, lw=0.9, label=", ".join(place.values()), **how)
            ax.set_title(name, loc="left")
            ax.set(xlabel="displacement of the base [cm]", ylabel="force of the isolators [MN]")
    shared_legend(figure, axes)
    finish(figure, evidence.title, "Without the dashpots beside the isolators.")
    return figure


# the drawing of the group

WIDTH, SPACE, STOREY = 1.0, 0.35, 0.42
"""Width of a building, space between two of them and height of a mean storey, in units of the drawing."""
MANY = 7
"""From this many buildings on, the periods are written upright and without their symbol."""


@styled
def draw_sketch(evidence: Evidence) -> Figure:
    """The group by itself, with names, for the head of a page."""
    figure = new_figure(min(1.1 * len(evidence.group) + 0.3, 9.0), 1.9)
    draw_group(figure.add_subplot(), evidence, evidence.main_building, named=len(evidence.group) < MANY)
    return figure


def draw_group(ax: Axes, evidence: Evidence, black: str, named: bool = False) -> None:
    """Buildings left to right as blocks of storeys to one scale with their periods, slabs as thick as they are. Walls
    are filled.

    black : building filled; named : whether their names stand below
    """
    from matplotlib.patches import Rectangle

    many, scale, top = len(evidence.group) >= MANY, STOREY / float(evidence.buildings["height"].mean()), 0.0
    for place, name in enumerate(evidence.group):
        rows, left = evidence.buildings[evidence.buildings["building"] == name], place * (WIDTH + SPACE)
        is_wall, slab = name not in evidence.buildings_without_walls, scale * float(rows["slab"].iloc[0])
        face, edge, grey = ("black", "0.75", "0.75") if name == black or is_wall else ("white", "black", "0.4")
        for height, level in zip(scale * rows["height"], scale * rows["height"].cumsum(), strict=True):
            ax.add_patch(Rectangle((left, level - height), WIDTH, height, facecolor=face, edgecolor=edge, lw=0.8))
            if slab:
                ax.add_patch(Rectangle((left, level - slab / 2), WIDTH, slab, color=grey, lw=0))
            top = max(top, level)
        period = "" if is_wall else f"{evidence.periods[name]:.2f}" if many else f"T = {evidence.periods[name]:.2f} s"
        ax.annotate(
            f"{name}\n{period}" if named else period, (left + WIDTH / 2, 0), xytext=(0, -4),
            textcoords="offset points", ha="center", va="top", fontsize=8 if named else 6 if many else 7,
            rotation=90 if many else 0, annotation_clip=False,
        )  # fmt: skip
    right = len(evidence.group) * (WIDTH + SPACE) - SPACE
    ax.plot([-0.3, right + 0.3], [0, 0], color="black", lw=1.2, clip_on=False)
    ax.set(xlim=(-0.4, right + 0.4), ylim=(-0.75, top + 0.1))
    ax.axis("off")
