"""The figures of a study at one point of its sweep: storeys upwards, ratios across (Figs 6-7)."""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from pounding_cli.numbers import counted
from pounding_cli.report.evidence import Evidence, by_floor, motion_sentence
from pounding_cli.report.inset import draw_group
from pounding_cli.report.style import VOID, Look, caption, entitle, is_for_paper, legend, looks, new_figure, styled

SPREAD = "mean over the {motions}; whiskers: smallest to largest"
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


def draw_all(evidence: Evidence) -> dict[str, Figure]:
    """Every figure by file name: response and accelerations of every building, forces of the links."""
    figures = {}
    for building in sorted(evidence.group, key=lambda name: name != main_building(evidence)):
        figures[f"{building}-response"] = response(evidence, building)
        figures[f"{building}-accelerations"] = accelerations(evidence, building)
        if len(evidence.cases) > 4:
            figures[f"{building}-cases"] = small_multiples(evidence, building)
    if evidence.link["peak_force"].notna().any():
        figures["link-forces"] = link_forces(evidence)
    return figures


def main_building(evidence: Evidence) -> str:
    """The building whose figures come first: `report: {building: NAME}` of the study, else the stiffer."""
    chosen = (evidence.resolved.get("report") or {}).get("building")
    return chosen if chosen in evidence.group else evidence.stiffer


@styled
def response(evidence: Evidence, building: str) -> Figure:
    """V/V0 elastic (left) and mu/mu0 inelastic (right) of one building, as in Figs 6 and 7."""
    panels = [panel for panel in RESPONSES if panel[0] in evidence.analyses]
    figure, axes = framed(evidence, [building], 1, max(len(panels), 1), headline(evidence, building))
    for ax, (analysis, column, label) in zip(axes[0], panels, strict=False):
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
    rows_of_panels = 2 if touching else 1
    analyses = evidence.analyses
    figure, axes = framed(evidence, [building], rows_of_panels, len(analyses), headline(evidence, building))
    for column, analysis in enumerate(analyses):
        rows = _rows(evidence.floor, analysis, building)
        ax = axes[0][column]
        _profiles(ax, rows, "floor", "acceleration_ratio", plotted_cases(evidence), _void(evidence, analysis))
        label = "floor acceleration over that alone"
        _finish(ax, analysis.capitalize(), label, "floor", rows["floor"], reference=True)
        if touching:
            relative = _over_case(rows, touching)
            ax = axes[1][column]
            cases = [case for case in plotted_cases(evidence) if case != touching]
            _profiles(ax, relative, "floor", "relative", cases, _void(evidence, analysis))
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
            rows = links[here]
            ax = axes[row][column]
            _profiles(ax, rows, "floor", "force", plotted_cases(evidence), _void(evidence, analysis))
            title = f"{analysis.capitalize()}: {left} | {right}"
            _finish(ax, title, "largest force [MN]", "floor", rows["floor"], reference=False)
    caption(figure, _caption(evidence, "Largest force in each link"))
    return figure


@styled
def small_multiples(evidence: Evidence, building: str) -> Figure:
    """One panel a case, elastic above inelastic: each motion thin and grey, their mean in colour."""
    cases = evidence.cases
    panels = [panel for panel in RESPONSES if panel[0] in evidence.analyses]
    columns = -(-len(cases) // -(-len(cases) // PANELS_IN_A_ROW))  # rows as even as they can be
    blocks = [cases[start : start + columns] for start in range(0, len(cases), columns)]
    rows_of_panels = len(blocks) * len(panels)
    figure, axes = framed(
        evidence,
        [building],
        rows_of_panels,
        columns,
        headline(evidence, building),
        width=1.75,
        height=2.2,
        cases=(),
    )
    look = looks(cases)
    for number, block in enumerate(blocks):
        for offset, (analysis, column, label) in enumerate(panels):
            rows = _rows(evidence.storey, analysis, building)
            line_of_axes = axes[number * len(panels) + offset]
            for ax, case in zip(line_of_axes, block, strict=False):
                mine = rows[rows["case"] == case]
                void = case in _void(evidence, analysis)
                shade = VOID if void else look[case].color
                for _, motion in mine.groupby("record", sort=False):
                    ax.plot(motion[column], motion["storey"], color="0.65", lw=0.7)
                mean = mine.groupby("storey")[column].mean()
                ax.plot(mean, mean.index, ":" if void else "-", color=shade, marker=look[case].marker, ms=4, lw=1.8)
                _finish(
                    ax,
                    evidence.marked(case) if void else case,
                    f"{label}, {analysis}",
                    "storey",
                    rows["storey"],
                    reference=True,
                )
            for ax in line_of_axes[1 : len(block)]:
                ax.set_ylabel("")
            for ax in line_of_axes[len(block) :]:
                ax.axis("off")
            _same_span(line_of_axes[: len(block)])
    motions = counted(evidence.storey["record"].nunique(), "motion")
    where = f"; {evidence.label}" if evidence.label else ""
    caption(
        figure,
        f"Ratios to {building} alone; grey: the {motions}; bold: their mean{where}. "
        f"{motion_sentence(evidence.records)} {evidence.footnote}".rstrip(),
    )
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
    spread = SPREAD.format(motions=counted(evidence.storey["record"].nunique(), "motion"))
    where = f" Point of the sweep: {evidence.label}." if evidence.label else ""
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
    characters = int(14 * (figure.get_figwidth() - drawing))
    if not is_for_paper():
        side.text(0.0, 1.0, textwrap.fill(evidence.title, characters), va="top", fontsize=8.5, color="0.25")
    cases = plotted_cases(evidence) if cases is None else cases
    if cases:
        lines = 2 if len(cases) <= 4 else 3
        legend(
            side,
            {case: evidence.marked(case) for case in cases},
            loc="lower left",
            ncols=-(-len(cases) // lines),
            columnspacing=1.5,
            borderpad=0,
            borderaxespad=0,
        )
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
    dodge = dict(
        zip(drawn, np.linspace(0.09, -0.09, len(drawn)) if len(drawn) > 1 else [0.0] * len(drawn), strict=True)
    )
    look = looks(cases)
    for case in drawn:
        spread = rows[rows["case"] == case].groupby(level)[column].agg(["mean", "min", "max"]).dropna()
        _profile(ax, spread, dodge[case], look[case], case, case in void)
    low, high = _span(rows[rows["case"].isin(drawn)], column)
    if low > 0 and high / low > 8:
        ax.set_xscale("log")
        ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        ax.xaxis.set_minor_formatter(NullFormatter())


def _profile(ax: Axes, spread: pd.DataFrame, dodge: float, look: Look, case: str, void: bool) -> None:
    heights = spread.index.to_numpy(float)
    mean = spread["mean"].to_numpy()
    whiskers = np.vstack([mean - spread["min"], spread["max"] - mean]).clip(min=0)
    # A line between floors that are not neighbours would show links where there are none.
    joined = len(heights) > 1 and bool((np.diff(heights) == 1).all())
    ax.errorbar(
        mean,
        heights + dodge,
        xerr=whiskers,
        color=VOID if void else look.color,
        linestyle="none" if not joined else ":" if void else look.line,
        marker=look.marker,
        markersize=5,
        markerfacecolor="white" if void else None,
        linewidth=1.6,
        elinewidth=0.8,
        capsize=2,
        label=case,
    )


def _span(rows: pd.DataFrame, column: str) -> tuple[float, float]:
    values = rows[column].to_numpy(float)
    values = values[np.isfinite(values)]
    return (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)


def _same_span(axes: Sequence[Axes]) -> None:
    low = min(ax.get_xlim()[0] for ax in axes)
    high = max(ax.get_xlim()[1] for ax in axes)
    for ax in axes:
        ax.set_xlim(low, high)


def _finish(ax: Axes, title: str, label: str, level: str, heights: pd.Series, *, reference: bool) -> None:
    top = int(heights.max()) if len(heights) else 1
    ax.set_title(title, loc="left")
    ax.set_xlabel(label)
    ax.set_ylabel(level)
    ticks = range(1, top + 1) if top <= 12 else range(0, top + 1, 5)
    ax.set(yticks=[tick for tick in ticks if tick > 0], ylim=(0.6, top + 0.4))
    ax.tick_params(length=3)
    if reference:
        ax.axvline(1, color="0.35", lw=1.0, zorder=1)
    elif ax.get_xscale() == "linear":
        ax.set_xlim(left=-0.02 * ax.get_xlim()[1])  # markers at zero stand clear of the axis
