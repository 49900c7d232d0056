"""The figures of a study at one point of its sweep: storeys upwards, ratios across (Figs 6-7), the group to scale."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.laws import link_symbol
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import RESPONSES, Evidence, describe_motions
from pounding_cli.report.style import (
    case_handles,
    finish,
    grid,
    is_for_page,
    looks,
    new_figure,
    shared_legend,
    with_style,
)
from pounding_cli.results.columns import column_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Panel = tuple[xr.DataArray, str]
"""A quantity over case, record and storey or floor, of one analysis; the label of its axis."""


CONTACT_SENTENCE = "Accelerations and forces of floors that strike depend on the contact stiffness."
"""Caption of every figure of such numbers."""


def list_profiles(evidence: Evidence) -> list[Picture]:
    """Return the figures over the height: response and accelerations of every building, the main one first."""
    pictures = []
    for building in sorted(evidence.buildings_without_walls, key=lambda name: name != evidence.main_building):
        text = "Ratios to the building alone, storey by storey, one line per case."
        draw = partial(response, evidence, building)
        pictures.append(Picture(f"{building}-response", f"{building}: storey shears and ductility demands", text, draw))
        text = "Largest floor accelerations over those of the building alone, floor by floor."
        draw = partial(accelerations, evidence, building)
        pictures.append(Picture(f"{building}-accelerations", f"{building}: floor accelerations", text, draw))
        if find_frame_lines(evidence, building):
            text = "Ratios to the building alone of every frame line, storey by storey, one panel per line."
            draw = partial(frame_lines, evidence, building)
            pictures.append(Picture(f"{building}-lines", f"{building}: frame lines", text, draw))
    return pictures


MOST_LINES = 8
"""Frame lines of a building that a figure has a panel for."""


def find_frame_lines(evidence: Evidence, building: str) -> list[int]:
    """Return the numbers of the frame lines of a building that the figures show; none where its floors do not twist."""
    if "line_drift" not in evidence.data:
        return []
    drift = evidence.data["line_drift"].sel(building=building)
    twist = evidence.data["twist"].sel(building=building)
    if not (twist.fillna(0.0) != 0.0).any():
        return []
    there = np.isfinite(drift.transpose(..., "line").values.reshape(-1, drift.sizes["line"])).any(axis=0)
    return [int(line) for line, is_there in zip(drift["line"].values, there, strict=True) if is_there][:MOST_LINES]


def has_contacts(links: pd.DataFrame) -> bool:
    """Return whether floors strike each other in some run.

    links : kinds and impacts of the links
    """
    struck = links.loc[links["impacts"] > 0, "kind"]
    return any(link_symbol(kind) == "gap" for kind in struck.unique())


@with_style
def response(evidence: Evidence, building: str) -> Figure:
    """Return V/V0 elastic (left) and mu/mu0 inelastic (right) of one building, as in Figs 6 and 7."""
    panels = [
        (evidence.data[ratio].sel(analysis=analysis, building=building), column_of(ratio).label)
        for analysis, ratio in RESPONSES
        if analysis in evidence.analyses
    ]
    return _draw_over_height(evidence, building, panels, f"Ratios to {building} alone under the same motion")


@with_style
def frame_lines(evidence: Evidence, building: str) -> Figure:
    """Return the ratios of the frame lines of one building to those of the building alone, a panel for each line.

    They are those of the ductility demands, or of the shears where all is elastic.
    """
    is_inelastic = "inelastic" in evidence.analyses
    analysis = "inelastic" if is_inelastic else "elastic"
    ratio = "line_mu_ratio" if is_inelastic else "line_V_ratio"
    values = evidence.data[ratio].sel(analysis=analysis, building=building)
    lines = find_frame_lines(evidence, building)
    panels = [(values.sel(line=line), column_of(ratio).label) for line in lines]
    caption = f"Ratios of the frame lines of {building} to {building} alone under the same motion"
    is_along = np.isfinite(evidence.data["line_street"].sel(building=building, line=lines).values)
    ways = np.where(is_along, "", " across the row")
    titles = [f"Line {line}{way}, {analysis}" for line, way in zip(lines, ways, strict=True)]
    return _draw_over_height(evidence, building, panels, caption, titles=titles)


@with_style
def accelerations(evidence: Evidence, building: str) -> Figure:
    """Return the largest floor accelerations of one building over those of the building alone."""
    ratios = evidence.data["acceleration_ratio"].sel(building=building)
    label = "floor acceleration over that alone"
    panels = [(ratios.sel(analysis=analysis), label) for analysis in evidence.analyses]
    caption = f"Largest total accelerations of the floors of {building} over those of {building} alone"
    remark = CONTACT_SENTENCE if has_contacts(evidence.link) else ""
    return _draw_over_height(evidence, building, panels, caption, remark)


def _draw_over_height(
    evidence: Evidence,
    building: str,
    panels: Sequence[Panel],
    caption: str,
    remark: str = "",
    titles: Sequence[str] = (),
) -> Figure:
    """Return a figure with storeys or floors upwards and ratios to the building alone, whose 1 is marked, across.

    caption : meaning of the ratios
    remark : further sentence of the caption
    titles : of the panels, two in a row; the analysis of each, all in one row, unless given
    """
    columns = min(len(panels), 2) if titles else len(panels)
    rows = -(-len(panels) // columns)
    figure, lines = new_framed_panels(evidence, building, rows, columns, cases=evidence.plotted_cases)
    axes = [ax for line in lines for ax in line]
    for ax in axes[len(panels) :]:
        ax.axis("off")
    titles = titles or [str(values["analysis"].item()).capitalize() for values, _ in panels]
    for ax, (values, label), title in zip(axes, panels, titles, strict=False):
        _draw_panel(ax, evidence, values)
        ax.set_title(title, loc="left")
        ax.set_xlabel(label)
        ax.axvline(1, color="0.35", lw=1.0, zorder=1)
    sentences = [
        f"{caption}{_describe_spread(len(evidence.records))}.",
        remark,
        describe_motions(evidence.records),
        f"Point of the sweep: {evidence.label}." if evidence.label else "",
        "Grey and open: not meaningful for some motions." if evidence.void else "",
    ]
    title = f"{building} (T = {evidence.periods[building]:.2f} s): {evidence.title}"
    finish(figure, title, " ".join(filter(None, sentences)))
    return figure


def _describe_spread(motions: int) -> str:
    """Return what points and whiskers of some motions mean, for a caption; "" for a single motion."""
    return f": mean over the {motions} motions; whiskers: smallest to largest" if motions > 1 else ""


def new_framed_panels(
    evidence: Evidence, black: str, rows: int, columns: int, size: tuple[float, float] = (3.6, 3.3),
    cases: Sequence[str] = (),
) -> tuple[Figure, list[list[Axes]]]:  # fmt: skip
    """Return a figure of `rows` x `columns` panels of a size [in] with the group and a legend above, and its panels.

    The group is not drawn for a page, which has it in its head.

    black : building filled in the drawing of the group
    cases : those of the legend; () for none
    """
    width = max(columns * size[0], 5.4)
    if is_for_page() and not cases:
        figure = new_figure(width, rows * size[1] + 0.2)
        return figure, [list(row) for row in figure.subplots(rows, columns, squeeze=False)]
    legend_rows = min(len(cases), 3)
    head_height = 0.2 * legend_rows + 0.1 if is_for_page() else 0.95
    margin = 0.2 if is_for_page() else 0.8  # for title and caption
    figure = new_figure(width, rows * size[1] + head_height + margin)
    sides = figure.add_gridspec(2, 1, height_ratios=[head_height, size[1] * rows])
    if is_for_page():
        legend_ax = figure.add_subplot(sides[0])
    else:
        drawing_width = min(0.62 * len(evidence.group) + 0.2, 0.6 * width)
        head = sides[0].subgridspec(1, 2, width_ratios=[drawing_width, width - drawing_width])
        draw_group(figure.add_subplot(head[0]), evidence, black)
        legend_ax = figure.add_subplot(head[1])
    legend_ax.axis("off")
    if cases:
        handles = case_handles({case: evidence.mark_case(case) for case in cases})
        columns_of_legend = -(-len(cases) // 3)
        legend_ax.legend(handles=handles, loc="center left", ncols=columns_of_legend, handlelength=3.2, borderaxespad=0)
    return figure, [list(row) for row in sides[1].subgridspec(rows, columns).subplots(squeeze=False)]


def _draw_panel(ax: Axes, evidence: Evidence, values: xr.DataArray) -> None:
    """Draw one line a case over the levels: mean over the motions, whiskers from the smallest to the largest.

    A case of which some runs are not meaningful is grey.

    values : over case, record and storey or floor, of one analysis
    """
    level = str(values.dims[-1])
    analysis = str(values["analysis"].item())
    look = looks(evidence.plotted_cases)
    cases = [case for case in evidence.plotted_cases if np.isfinite(values.sel(case=case)).any()]
    # Whiskers of neighbouring cases would hide each other on one height.
    shifts = np.linspace(0.09, -0.09, len(cases)) if len(cases) > 1 else np.zeros(len(cases))
    for case, shift in zip(cases, shifts.tolist(), strict=True):
        spread = values.sel(case=case).to_series().groupby(level).agg(["mean", "min", "max"]).dropna()
        heights = spread.index.to_numpy(float)
        is_void = (case, analysis) in evidence.void
        # A line between floors that are not neighbours would show links where there are none.
        is_joined = len(heights) > 1 and bool((np.diff(heights) == 1).all())
        ax.errorbar(
            spread["mean"],
            heights + shift,
            xerr=[spread["mean"] - spread["min"], spread["max"] - spread["mean"]],
            color="0.6" if is_void else look[case].color,
            ls=look[case].line if is_joined else "none",
            marker=look[case].marker,
            ms=5,
            mfc="white" if is_void else None,
            lw=1.6,
            elinewidth=0.8,
            capsize=2,
        )
    drawn = values.sel(case=cases)
    if drawn.size and drawn.min() > 0 and drawn.max() / drawn.min() > 8:
        ax.set_xscale("log")
    levels = values[level].values[np.isfinite(values.values).any(axis=(0, 1))]
    low, top = (min(1, int(levels.min())), int(levels.max())) if len(levels) else (1, 1)  # a base is floor 0
    ticks = list(range(low, top + 1) if top <= 12 else range(5, top + 1, 5))
    ax.set(ylabel=level, ylim=(low - 0.4, top + 0.4))
    ax.set_yticks(ticks, [str(tick or "base") for tick in ticks])


# isolators

MOST_LOOPS = 6
"""Time histories in the figure of the loops."""


def list_loops(evidence: Evidence) -> list[Picture]:
    """Return the figure of the loops of isolators; none where no time history is kept."""
    bases = {name: evidence.building_of_study(name).get("foundation") for name in evidence.group}
    isolated = [name for name, base in bases.items() if isinstance(base, dict) and base.get("isolation")]
    kept = evidence.rows_here(evidence.results.histories()).head(MOST_LOOPS)
    if not isolated or kept.empty:
        return []
    text = f"Force of the isolators of {', '.join(isolated)} over the displacement of the base, of kept time histories."
    return [Picture("isolators", "Isolators", text, partial(draw_loops, evidence, isolated, kept))]


@with_style
def draw_loops(evidence: Evidence, isolated: list[str], kept: pd.DataFrame) -> Figure:
    """Draw a panel for each building on isolators, a line for each kept time history."""
    figure, axes = grid(len(isolated), 4.2, 3.4)
    look = looks(list(kept["case"]))
    for place in kept[["case", "analysis", "record"]].to_dict("records"):
        history = evidence.results.history(*place.values(), **evidence.point)
        color = look[place["case"]].color
        line = "--" if place["analysis"] == "inelastic" else "-"
        for ax, name in zip(axes, isolated, strict=True):
            number = list(history.buildings).index(name)
            displacement = 100 * history.sway[:, number]  # [cm]
            force = history.base_force[:, number] / 1e6  # [MN]
            ax.plot(displacement, force, lw=0.9, label=", ".join(place.values()), color=color, ls=line)
            ax.set_title(name, loc="left")
            ax.set(xlabel="displacement of the base [cm]", ylabel="force of the isolators [MN]")
    shared_legend(figure, axes)
    finish(figure, evidence.title, "Without the dashpots beside the isolators.")
    return figure


# the drawing of the group

WIDTH = 1.0
"""Width of a building, in units of the drawing."""
SPACE = 0.35
"""Space between two buildings."""
SKETCH_STOREY = 0.42
"""Height of a mean storey."""
KERB = 0.1
"""Least height of a wall."""
MANY = 7
"""From this many buildings on, the periods are written upright and without their symbol."""


@with_style
def draw_sketch(evidence: Evidence) -> Figure:
    """Draw the group by itself, with names, for the head of a page."""
    figure = new_figure(min(1.1 * len(evidence.group) + 0.3, 9.0), 1.9)
    draw_group(figure.add_subplot(), evidence, evidence.main_building, named=len(evidence.group) < MANY)
    return figure


def draw_group(ax: Axes, evidence: Evidence, black: str, named: bool = False) -> None:
    """Draw the buildings left to right as blocks of storeys to one scale, with their slabs and periods.

    Walls are hatched; one that ends at the ground is drawn as a kerb.

    black : building filled
    named : whether their names stand below
    """
    from matplotlib.patches import Rectangle

    are_many = len(evidence.group) >= MANY
    is_of_frame = evidence.buildings["building"].isin(evidence.buildings_without_walls)
    scale = SKETCH_STOREY / float(evidence.buildings["height"][is_of_frame].mean())
    top = 0.0
    for place, name in enumerate(evidence.group):
        rows = evidence.buildings[evidence.buildings["building"] == name]
        left = place * (WIDTH + SPACE)
        is_wall = name not in evidence.buildings_without_walls
        slab = scale * float(rows["slab"].iloc[0])
        face, edge, grey = ("black", "0.75", "0.75") if name == black else ("white", "black", "0.4")
        if is_wall:
            height = max(scale * float(rows["height"].iloc[0]), KERB)
            ax.add_patch(Rectangle((left, 0), WIDTH, height, facecolor="0.85", edgecolor="0.4", hatch="////", lw=0.8))
            top = max(top, height)
            rows = rows.iloc[:0]
        for height, level in zip(scale * rows["height"], scale * rows["height"].cumsum(), strict=True):
            ax.add_patch(Rectangle((left, level - height), WIDTH, height, facecolor=face, edgecolor=edge, lw=0.8))
            if slab:
                ax.add_patch(Rectangle((left, level - slab / 2), WIDTH, slab, color=grey, lw=0))
            top = max(top, level)
        period = f"{evidence.periods[name]:.2f}"
        if not are_many:
            period = f"T = {period} s"
        if is_wall:
            period = ""
        ax.annotate(
            f"{name}\n{period}" if named else period,
            (left + WIDTH / 2, 0),
            xytext=(0, -4),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=8 if named else 6 if are_many else 7,
            rotation=90 if are_many else 0,
            annotation_clip=False,
        )
    right = len(evidence.group) * (WIDTH + SPACE) - SPACE
    ax.plot([-0.3, right + 0.3], [0, 0], color="black", lw=1.2, clip_on=False)
    ax.set(xlim=(-0.4, right + 0.4), ylim=(-0.75, top + 0.1))
    ax.axis("off")
