"""The figures of a study at one point of its sweep: storeys upwards, ratios across (Figs 6-7), the group to scale."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from itertools import accumulate, pairwise

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from pounding_cli.numbers import counted
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import Evidence, by_floor, motion_sentence
from pounding_cli.report.style import (
    VOID,
    Look,
    caption,
    entitle,
    is_for_paper,
    legend,
    looks,
    new_figure,
    span,
    styled,
)
from pounding_cli.report.table import column_of, digits

PANELS_IN_A_ROW = 6
MOST_CASES = 40
"""Cases in the figures and on the page; the tables hold all."""
RESPONSES = (("elastic", "V_ratio", "$V/V_0$"), ("inelastic", "mu_ratio", "$\\mu/\\mu_0$"))
"""The paper's panels: analysis, column, axis label."""


def plotted_cases(evidence: Evidence) -> list[str]:
    """The cases of the main figures: `report: {plot: [..]}` of the study, else all of them."""
    chosen = set((evidence.resolved.get("report") or {}).get("plot") or evidence.cases)
    return [case for case in evidence.cases if case in chosen]


def drawn_part(evidence: Evidence) -> Evidence:
    """The evidence with as many cases as figures and page have room for, those of `report: {plot: [..]}` first."""
    if len(evidence.cases) <= MOST_CASES:
        return evidence
    return evidence.only(list(dict.fromkeys([*plotted_cases(evidence), *evidence.cases]))[:MOST_CASES])


def main_building(evidence: Evidence) -> str:
    """The building whose figures come first: `report: {building: NAME}` of the study, else the stiffer."""
    chosen = (evidence.resolved.get("report") or {}).get("building")
    return chosen if chosen in evidence.group else evidence.stiffer


def profiles(evidence: Evidence) -> list[Picture]:
    """Every figure: response and accelerations of every building, forces of the links."""
    found = []
    for building in sorted(evidence.group, key=lambda name: name != main_building(evidence)):
        what, text = "storey shears and ductilities", " ".join(largest_means(evidence, building))
        said = f"Ratios to the building alone, storey by storey, one line per case. {text}"
        draw: Callable[[], Figure] = partial(response, evidence, building)
        found.append(Picture(f"{building}-response", f"{building}: {what}", said, draw))
        said = "Largest floor accelerations over those of the building alone, and over touching, floor by floor."
        draw = partial(accelerations, evidence, building)
        found.append(Picture(f"{building}-accelerations", f"{building}: floor accelerations", said, draw))
        if len(evidence.cases) > 4:
            said = f"One panel per case with every motion and their mean, storey by storey. {text}"
            draw = partial(small_multiples, evidence, building)
            found.append(Picture(f"{building}-cases", f"{building}: every case and motion", said, draw))
    if evidence.link["peak_force"].notna().any():
        said = "Largest force in every link, floor by floor."
        found.append(Picture("link-forces", "Forces between neighbours", said, partial(link_forces, evidence)))
    return found


def largest_means(evidence: Evidence, building: str) -> list[str]:
    """The largest mean ratios of a building in sentences, analysis by analysis."""
    said = []
    for analysis, ratio, _ in RESPONSES:
        means = {case: evidence.means(case, analysis, building, ratio) for case in evidence.cases}
        parts = [f"{case} {digits(of.max(), 3)} (storey {of.idxmax()})" for case, of in means.items() if len(of)]
        if parts:
            over = f"mean of {counted(len(evidence.records), 'motion')}, " if len(evidence.records) > 1 else ""
            ratio = column_of(ratio).label
            said.append(f"{ratio} of {building}, {analysis}, {over}largest over the height: {', '.join(parts)}.")
    return said


@styled
def response(evidence: Evidence, building: str) -> Figure:
    """V/V0 elastic (left) and mu/mu0 inelastic (right) of one building, as in Figs 6 and 7."""
    shown = [panel for panel in RESPONSES if panel[0] in evidence.analyses]
    figure, axes = framed(evidence, [building], 1, max(len(shown), 1), headline(evidence, building))
    for ax, (analysis, column, label) in zip(axes[0], shown, strict=False):
        rows = _rows(evidence.storey, analysis, building)
        _profiles(ax, rows, "storey", column, plotted_cases(evidence), _void(evidence, analysis))
        what = "storey shear" if column == "V_ratio" else "ductility"
        _finish(ax, f"{analysis.capitalize()}: {what}", label, "storey", rows["storey"], reference=True)
    caption(figure, _caption(evidence, f"Ratios to {building} alone under the same motion"))
    return figure


@styled
def accelerations(evidence: Evidence, building: str) -> Figure:
    """Largest floor accelerations of one building over those alone (top) and over touching (bottom)."""
    touching = evidence.case_of("touching")
    analyses = evidence.analyses
    figure, axes = framed(evidence, [building], 2 if touching else 1, len(analyses), headline(evidence, building))
    for column, analysis in enumerate(analyses):
        rows, void = _rows(evidence.floor, analysis, building), _void(evidence, analysis)
        ax = axes[0][column]
        _profiles(ax, rows, "floor", "acceleration_ratio", plotted_cases(evidence), void)
        label = "floor acceleration over that alone"
        _finish(ax, analysis.capitalize(), label, "floor", rows["floor"], reference=True)
        if touching:
            ax = axes[1][column]
            cases = [case for case in plotted_cases(evidence) if case != touching]
            _profiles(ax, _over_case(rows, touching), "floor", "relative", cases, void)
            label = f"floor acceleration over that {touching}"
            _finish(ax, analysis.capitalize(), label, "floor", rows["floor"], reference=True)
    caption(figure, _caption(evidence, f"Largest total accelerations of the floors of {building}"))
    return figure


@styled
def link_forces(evidence: Evidence) -> Figure:
    """Largest force between the floors, one by one: one row of panels a pair of neighbours."""
    links = by_floor(evidence.link)
    links = links.assign(force=links["peak_force"] / 1e6)
    pairs = list(dict.fromkeys(zip(links["left"], links["right"], strict=True)))
    analyses = evidence.analyses
    figure, axes = framed(evidence, [], len(pairs), len(analyses), "Forces between neighbours")
    for row, (left, right) in enumerate(pairs):
        for column, analysis in enumerate(analyses):
            here = (links["left"] == left) & (links["right"] == right) & (links["analysis"] == analysis)
            ax, rows = axes[row][column], links[here]
            _profiles(ax, rows, "floor", "force", plotted_cases(evidence), _void(evidence, analysis))
            title = f"{analysis.capitalize()}: {left} | {right}"
            _finish(ax, title, "largest force [MN]", "floor", rows["floor"], reference=False)
    caption(figure, _caption(evidence, "Largest force in each link"))
    return figure


@styled
def small_multiples(evidence: Evidence, building: str) -> Figure:
    """One panel a case, elastic above inelastic: each motion thin and grey, their mean in colour."""
    cases, look = evidence.cases, looks(evidence.cases)
    shown = [panel for panel in RESPONSES if panel[0] in evidence.analyses]
    columns = -(-len(cases) // -(-len(cases) // PANELS_IN_A_ROW))  # rows as even as they can be
    blocks = [cases[start : start + columns] for start in range(0, len(cases), columns)]
    figure, axes = framed(
        evidence, [building], len(blocks) * len(shown), columns, headline(evidence, building), width=1.75, height=2.2,
        cases=(),
    )  # fmt: skip
    lines = iter(axes)
    for block in blocks:
        for analysis, column, label in shown:
            rows, void, line = _rows(evidence.storey, analysis, building), _void(evidence, analysis), next(lines)
            for ax, case in zip(line, block, strict=False):
                mine, empty = rows[rows["case"] == case], case in void
                for _, motion in mine.groupby("record", sort=False):
                    ax.plot(motion[column], motion["storey"], color="0.65", lw=0.7)
                mean = mine.groupby("storey")[column].mean()
                color, marker = VOID if empty else look[case].color, look[case].marker
                ax.plot(mean, mean.index, ":" if empty else "-", color=color, marker=marker, ms=4, lw=1.8)
                title = evidence.marked(case) if empty else case
                _finish(ax, title, f"{label}, {analysis}", "storey", rows["storey"], reference=True)
            for ax in line[1 : len(block)]:
                ax.set_ylabel("")
            for ax in line[len(block) :]:
                ax.axis("off")
            ends = [ax.get_xlim() for ax in line[: len(block)]]
            for ax in line[: len(block)]:
                ax.set_xlim(min(low for low, _ in ends), max(high for _, high in ends))
    motions = counted(evidence.storey["record"].nunique(), "motion")
    where = f"; {evidence.label}" if evidence.label else ""
    said = f"Ratios to {building} alone; grey: the {motions}; bold: their mean{where}."
    caption(figure, f"{said} {motion_sentence(evidence.records)} {evidence.footnote}".rstrip())
    return figure


def _rows(frame: pd.DataFrame, analysis: str, building: str) -> pd.DataFrame:
    return frame[(frame["analysis"] == analysis) & (frame["building"] == building)]


def _over_case(rows: pd.DataFrame, base: str) -> pd.DataFrame:
    """Accelerations of every case over those of one, motion by motion, in the column `relative`."""
    below = rows[rows["case"] == base][["record", "floor", "acceleration"]]
    both = rows.merge(below, on=["record", "floor"], suffixes=("", "_base"))
    return both.assign(relative=both["acceleration"] / both["acceleration_base"].where(both["acceleration_base"] > 0))


def headline(evidence: Evidence, building: str) -> str:
    """A figure's title: the building and its period."""
    return f"{building} (T = {evidence.periods[building]:.2f} s)"


def _caption(evidence: Evidence, what: str) -> str:
    motions = counted(evidence.storey["record"].nunique(), "motion")
    where = f" Point of the sweep: {evidence.label}." if evidence.label else ""
    spread = f"mean over the {motions}; whiskers: smallest to largest"
    return f"{what}: {spread}. {motion_sentence(evidence.records)}{where} {evidence.footnote}".rstrip()


def framed(
    evidence: Evidence,
    black: Sequence[str],
    rows: int,
    columns: int,
    headline: str,
    *,
    width: float = 3.6,
    height: float = 3.3,
    cases: Sequence[str] | None = None,
) -> tuple[Figure, list[list[Axes]]]:
    """A figure with title, the group's drawing and the legend above `rows` x `columns` panels.

    black : buildings filled in the drawing
    cases : in the legend, none where it is empty; those of the main figures unless given
    """
    figure = new_figure(max(columns * width, 5.4), rows * height + 1.75)
    entitle(figure, headline, "bold")
    grid = figure.add_gridspec(2, 1, height_ratios=[0.95, height * rows])
    drawing = min(0.62 * len(evidence.group) + 0.2, 0.6 * figure.get_figwidth())
    head = grid[0].subgridspec(1, 2, width_ratios=[drawing, figure.get_figwidth() - drawing])
    draw_group(figure.add_subplot(head[0]), evidence, black)
    side = figure.add_subplot(head[1])
    side.axis("off")
    if not is_for_paper():
        characters = int(14 * (figure.get_figwidth() - drawing))
        side.text(0.0, 1.0, textwrap.fill(evidence.title, characters), va="top", fontsize=8.5, color="0.25")
    cases = plotted_cases(evidence) if cases is None else cases
    if cases:
        beside = -(-len(cases) // (2 if len(cases) <= 4 else 3))
        called = {case: evidence.marked(case) for case in cases}
        legend(side, called, loc="lower left", ncols=beside, columnspacing=1.5, borderpad=0, borderaxespad=0)
    return figure, [list(row) for row in grid[1].subgridspec(rows, columns).subplots(squeeze=False)]


def _void(evidence: Evidence, analysis: str) -> set[str]:
    """The cases whose numbers mean nothing for some motions."""
    return {case for case, kind in evidence.meaningless if kind == analysis}


def _profiles(
    ax: Axes, rows: pd.DataFrame, level: str, column: str, cases: Sequence[str], void: Collection[str]
) -> None:
    """One line a case: mean over the motions, whiskers from the smallest to the largest; `void` ones in grey."""
    drawn = [case for case in cases if rows[rows["case"] == case][column].notna().any()]
    # Whiskers of neighbouring cases would hide each other on one height.
    shifts = np.linspace(0.09, -0.09, len(drawn)) if len(drawn) > 1 else np.zeros(len(drawn))
    look = looks(cases)
    for case, shift in zip(drawn, shifts.tolist(), strict=True):
        spread = rows[rows["case"] == case].groupby(level)[column].agg(["mean", "min", "max"]).dropna()
        _profile(ax, spread, shift, look[case], case in void)
    low, high = span(rows[rows["case"].isin(drawn)][column])
    if low > 0 and high / low > 8:
        ax.set_xscale("log")
        plain_log(ax.xaxis)


def plain_log(axis: object) -> None:
    """Ticks 1, 2 and 5 of a logarithmic axis as plain numbers."""
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))  # type: ignore[attr-defined]
    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))  # type: ignore[attr-defined]
    axis.set_minor_formatter(NullFormatter())  # type: ignore[attr-defined]


def _profile(ax: Axes, spread: pd.DataFrame, shift: float, look: Look, void: bool) -> None:
    heights = spread.index.to_numpy(float)
    mean = spread["mean"].to_numpy()
    whiskers = np.vstack([mean - spread["min"], spread["max"] - mean]).clip(min=0)
    # A line between floors that are not neighbours would show links where there are none.
    joined = len(heights) > 1 and bool((np.diff(heights) == 1).all())
    line = "none" if not joined else ":" if void else look.line
    ax.errorbar(
        mean, heights + shift, xerr=whiskers, color=VOID if void else look.color, linestyle=line, marker=look.marker,
        markersize=5, markerfacecolor="white" if void else None, linewidth=1.6, elinewidth=0.8, capsize=2,
    )  # fmt: skip


def _finish(ax: Axes, title: str, label: str, level: str, heights: pd.Series, *, reference: bool) -> None:
    top = int(heights.max()) if len(heights) else 1
    ax.set_title(title, loc="left")
    ax.set(xlabel=label, ylabel=level)
    ticks = range(1, top + 1) if top <= 12 else range(5, top + 1, 5)
    ax.set(yticks=list(ticks), ylim=(0.6, top + 0.4))
    ax.tick_params(length=3)
    if reference:
        ax.axvline(1, color="0.35", lw=1.0, zorder=1)
    elif ax.get_xscale() == "linear":
        ax.set_xlim(left=-0.02 * ax.get_xlim()[1])  # markers at zero stand clear of the axis


# the drawing of the group

WIDTH, SPACE, STOREY = 1.0, 0.35, 0.42
"""Width of a building, space between two of them and height of a storey, in units of the drawing."""
STRUCK = "#c8102e"
"""Colour of the points where slabs strike columns."""
MANY = 7
"""From this many buildings on, the periods are written upright and without their symbol."""


@styled
def sketch(evidence: Evidence) -> Figure:
    """The group by itself, with names, for the head of a page."""
    figure = new_figure(min(1.1 * len(evidence.group) + 0.3, 9.0), 1.9)
    draw_group(figure.add_subplot(), evidence, [main_building(evidence)], named=len(evidence.group) < MANY)
    return figure


def draw_group(ax: Axes, evidence: Evidence, black: Sequence[str], named: bool = False) -> None:
    """Buildings left to right as blocks of storeys with their periods; those plotted are black. Storeys of several
    heights are drawn to one scale, slabs as thick as they are, and a point marks every place where a slab strikes
    columns.

    A period that is NaN is not written.
    """
    storeys = evidence.storey.dropna(subset=["V"]).groupby("building")["storey"].max()
    group, pitch = evidence.group, WIDTH + SPACE
    levels = _levels(evidence, {name: int(storeys.get(name, 1)) for name in group})
    many = len(group) >= MANY
    for place, name in enumerate(group):
        filled, left = name in black, place * pitch
        face, edge = ("black", "0.75") if filled else ("white", "black")
        for below, above in pairwise(levels[name]):
            ax.add_patch(Rectangle((left, below), WIDTH, above - below, facecolor=face, edgecolor=edge, linewidth=0.8))
        thick = _slab(evidence, name) * levels[name][-1] / (sum(_heights(evidence, name)) or 1.0)
        for above in levels[name][1:] if thick > 0 else ():
            shade = "0.75" if filled else "0.4"
            ax.add_patch(Rectangle((left, above - thick / 2), WIDTH, thick, color=shade, linewidth=0))
        period = evidence.periods[name]
        words = "" if math.isnan(period) else f"{period:.2f}" if many else f"T = {period:.2f} s"
        ax.annotate(
            f"{name}\n{words}" if named else words, (left + WIDTH / 2, 0), xytext=(0, -4), textcoords="offset points",
            ha="center", va="top", fontsize=8 if named else 6 if many else 7, rotation=90 if many else 0,
            annotation_clip=False,
        )  # fmt: skip
    struck = np.array(_struck(evidence, levels)).reshape(-1, 2)
    ax.plot(struck[:, 0], struck[:, 1], "o", color=STRUCK, ms=2.5, zorder=3)
    right = len(group) * pitch - SPACE
    ax.plot([-0.3, right + 0.3], [0, 0], color="black", lw=1.2, clip_on=False)
    ax.set(xlim=(-0.4, right + 0.4), ylim=(-0.75, max(own[-1] for own in levels.values()) + 0.1))
    ax.axis("off")


def _heights(evidence: Evidence, name: str) -> list[float]:
    """Storey heights of a building from the ground up [m]."""
    rows = evidence.buildings[evidence.buildings["building"] == name].sort_values("storey")
    return [float(height) for height in rows["height"]]


def _slab(evidence: Evidence, name: str) -> float:
    """Thickness of its slabs [m]."""
    buildings = evidence.buildings
    return float(buildings[buildings["building"] == name]["slab"].iloc[0]) if "slab" in buildings else 0.0


def _levels(evidence: Evidence, storeys: Mapping[str, int]) -> dict[str, list[float]]:
    """Heights of the ground and the floors of every building in the drawing: each storey alike, or to one scale where
    storeys have several heights."""
    heights = {name: _heights(evidence, name) for name in storeys}
    known = [height for own in heights.values() for height in own]
    if len(set(known)) < 2 or any(len(heights[name]) != count for name, count in storeys.items()):
        return {name: [STOREY * level for level in range(count + 1)] for name, count in storeys.items()}
    scale = STOREY * len(known) / sum(known)
    return {name: [0.0, *(scale * level for level in accumulate(own))] for name, own in heights.items()}


def _struck(evidence: Evidence, levels: Mapping[str, Sequence[float]]) -> list[tuple[float, float]]:
    """Where slabs strike columns in the drawing."""
    link, found = evidence.link, []
    if "left_at" not in link:
        return []
    for row in link[(link["left_at"] < 1) | (link["right_at"] < 1)].drop_duplicates("link").to_dict("records"):
        side = "left" if row["left_at"] < 1 else "right"
        floor = int(row["floor" if side == "left" else "right_floor"])
        below, above = levels[row[side]][floor - 1 : floor + 1]
        face = evidence.group.index(row[side]) * (WIDTH + SPACE) + (WIDTH if side == "left" else 0.0)
        found.append((face, below + row[f"{side}_at"] * (above - below)))
    return found
