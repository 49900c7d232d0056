"""Figures of `pound fragility`: curves alone and with pounding, and what contributes to annual rates."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.numbers import Unit
from pounding_cli.questions.bootstrap import MIN_MOTIONS
from pounding_cli.questions.fragility.tables import CONTRIBUTIONS, CURVE_POINTS, CURVES, MOTIONS, RATES
from pounding_cli.questions.fragility.words import (
    compare_medians,
    describe_curve_place,
    describe_measure,
    format_confidence,
    join_place,
    list_twisting_buildings,
    median_column,
    pair_states,
)
from pounding_cli.questions.frames import ALONE, STATE_COLUMN, WITH_POUNDING
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import Evidence, describe_motions, find_nominal
from pounding_cli.report.style import Look, finish, grid, looks, shared_legend, with_style
from pounding_cli.tables import Column

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

MAX_PANEL_CASES = 4
"""Cases in one panel; of more, the first are drawn."""

LOOK_ALONE = Look("#777777", (0, (2, 1)), "x")
"""The look of a building alone; no case has it: one may be black, as `touching` is."""

_MARKERS = {
    "ida": "Markers: the share of motions that have passed by that intensity, by Kaplan and Meier where some are "
    "undecided.",
    "stripes": "Markers: the share of the decided motions that pass at each intensity.",
    "cloud": "Curves from a line through the cloud of demands.",
}
"""Sentence of a caption on the markers, by method."""

_LINE_OF_TEXT = 0.08
"""Height of a line of text over that of a panel."""


def list_figures(results: ResultTables) -> list[Picture]:
    """Return the figure of curves of every analysis and, with a hazard curve, that of contributions to rates."""
    evidence = find_nominal(results)
    curves = evidence.rows_here(results.answer(CURVES).frame)
    pictures = []
    for analysis, rows in curves.groupby("analysis", sort=False):
        draw = partial(draw_fragility_curves, evidence, str(analysis))
        heading = f"Fragility, {analysis} storeys"
        pictures.append(Picture(f"fragility-{analysis}", heading, _describe_curves(results, rows), draw))
    if RATES in results.answers and len(evidence.rows_here(results.answer(CONTRIBUTIONS).frame)):
        text = "Annual rates at which limits are passed, by the intensity at which they are."
        draw = partial(draw_contributions, evidence)
        pictures.append(Picture("fragility-rates", "What contributes to the annual rates", text, draw))
    return pictures


def _describe_curves(results: ResultTables, rows: pd.DataFrame) -> str:
    """Return in words what the curves of one analysis show."""
    median = median_column(results.answer(CURVES).column("median"))
    confidence = format_confidence(results)
    pairs = pair_states(rows)
    buildings = results.names("building")
    twisting = list_twisting_buildings(results)
    return " ".join(
        f"{describe_curve_place(curve.place, pairs, buildings, twisting=twisting)}: "
        f"{compare_medians(curve, median, confidence)}."
        for curve in pairs
    )


# Curves


@with_style
def draw_fragility_curves(evidence: Evidence, analysis: str) -> Figure:
    """Draw probability against intensity: a panel for each limit and building or pair."""
    results = evidence.results
    method = results.study_data["fragility"]["method"]
    median = median_column(results.answer(CURVES).column("median"))
    curves, motions, points = (
        _select(evidence.rows_here(results.answer(name).frame), analysis=analysis)
        for name in (CURVES, MOTIONS, CURVE_POINTS)
    )
    panels = curves.groupby(["limit", "building"], sort=False)
    cases = curves["case"].unique().tolist()
    look_by_case = dict(list(looks(cases).items())[:MAX_PANEL_CASES])
    figure, axes = grid(len(panels), 3.6, 2.8, "probability of passing the limit", sharey=True)
    for ax, ((limit, building), rows) in zip(axes, panels, strict=True):
        of_panel = {"limit": limit, "building": building}
        panel = _Panel(ax, method, median)
        panel.draw(rows, _select(motions, **of_panel), _select(points, **of_panel), look_by_case)
        ax.set(ylim=(0, 1), xlabel=median.unit.label(describe_measure(results)))
        ax.set_title(join_place(str(building), str(limit)), loc="left")
    shared_legend(figure, axes)
    finish(figure, evidence.title, _caption_curves(evidence, curves, len(cases)))
    return figure


def _select(frame: pd.DataFrame, **values: Any) -> pd.DataFrame:
    """Return the rows with some values of columns."""
    for name, value in values.items():
        frame = frame[frame[name] == value]
    return frame


def _caption_curves(evidence: Evidence, curves: pd.DataFrame, case_count: int) -> str:
    """Return what the figure of curves shows besides its axes."""
    spec = evidence.results.study_data["fragility"]
    point = evidence.format_point(curves)
    sentences = [f"At {point}."] if point else []
    sentences.append(_MARKERS[spec["method"]])
    if curves["motions"].max() < MIN_MOTIONS:
        sentences.append(f"No bands for fewer than {MIN_MOTIONS} motions.")
    else:
        confidence = format_confidence(evidence.results)
        sentences.append(f"Bands: {confidence} of {spec['draws']} bootstrap draws of the motions.")
    if case_count > MAX_PANEL_CASES:
        sentences.append(f"Of {case_count} cases the first {MAX_PANEL_CASES} are drawn.")
    return " ".join([*sentences, describe_motions(evidence.records)])


class _Panel:
    """A panel of curves.

    right : largest intensity that is drawn, in the unit of the axis
    text_height : over that of the panel, up to which texts stand in the corner
    """

    def __init__(self, ax: Axes, method: str, median: Column) -> None:
        self.ax = ax
        self.method = method
        self.median = median
        self.unit: Unit = median.unit
        self.right = 0.0
        self.text_height = 0.04

    def draw(
        self, rows: pd.DataFrame, motions: pd.DataFrame, points: pd.DataFrame, look_by_case: Mapping[str, Look]
    ) -> None:
        """Draw the curve of the building alone, which is the same in all cases, and that of every case."""
        records = [row for row in rows.to_dict("records") if row["case"] in look_by_case]
        alone = [row for row in records if row[STATE_COLUMN] == ALONE][:1]
        for row in [*alone, *(row for row in records if row[STATE_COLUMN] == WITH_POUNDING)]:
            place = {"case": row["case"], STATE_COLUMN: row[STATE_COLUMN]}
            look = LOOK_ALONE
            label = ALONE
            if row[STATE_COLUMN] == WITH_POUNDING:
                look = look_by_case[row["case"]]
                label = f"{WITH_POUNDING}: {row['case']}"
            points_of_curve = _select(points, **place)
            self._draw_curve(row, points_of_curve, look, label)
            self._draw_shares(_select(motions, **place), points_of_curve, look)
        self.ax.set_xlim(0, self.right or 1.0)

    def _draw_curve(self, row: Mapping[Any, Any], points: pd.DataFrame, look: Look, label: str) -> None:
        """Draw a curve with its band; write why there is none where there is none."""
        (line,) = self.ax.plot([], [], color=look.color, ls=look.line, lw=1.8, label=label)
        if np.isnan(row["median"]):
            self._write(f"{label}: {self.median.cell(row)}", look.color)
            return
        x = points["intensity"] / self.unit.factor
        line.set_data(x, points["probability"])
        self.ax.fill_between(
            x, points["probability_low"], points["probability_high"], color=look.color, alpha=0.13, lw=0
        )

    def _write(self, text: str, color: str) -> None:
        """Write a text in the lower right corner, above those before."""
        lines = textwrap.wrap(text, 50)
        self.ax.text(
            0.98, self.text_height, "\n".join(lines),
            transform=self.ax.transAxes, ha="right", fontsize=7.5, color=color,
        )  # fmt: skip
        self.text_height += _LINE_OF_TEXT * len(lines)

    def _draw_shares(self, motions: pd.DataFrame, points: pd.DataFrame, look: Look) -> None:
        """Draw the shares of motions that pass as markers, as far as the axis reaches."""
        right = self._find_right(motions, points)
        self.right = max(self.right, right)
        intensity, share = find_passed_shares(motions, self.method)
        is_inside = intensity / self.unit.factor <= self.right
        if is_inside.any():  # a line without points would count as one at the corner
            self.ax.plot(
                intensity[is_inside] / self.unit.factor, share[is_inside], clip_on=False,
                ls="", marker=look.marker, ms=3.2, color=look.color, alpha=0.75,
            )  # fmt: skip

    def _find_right(self, motions: pd.DataFrame, points: pd.DataFrame) -> float:
        """Return where the axis ends for a curve: at its last point or, without one, behind the last motion."""
        if len(points):
            return float(points["intensity"].max()) / self.unit.factor
        columns = ["intensity"] if "intensity" in motions else ["held", "passed"]
        known = motions[columns].to_numpy(float)
        return 1.1 * float(known[np.isfinite(known)].max(initial=0.0)) / self.unit.factor


def find_passed_shares(motions: pd.DataFrame, method: str) -> tuple[np.ndarray, np.ndarray]:
    """Return intensities [SI] and the share of motions that have passed by each (`ida`) or pass at each (`stripes`).

    motions : rows of one curve in the table of motions
    """
    if method == "ida":
        held = motions["held"].to_numpy(float)
        passed = motions["passed"].to_numpy(float)
        last_known = np.where(np.isfinite(passed), passed, held)
        intensity, passes = np.unique(passed[np.isfinite(passed)], return_counts=True)
        # Kaplan, E. L. and Meier, P. (1958). Nonparametric estimation from incomplete observations. JASA 53, 457-481
        left = np.array([(last_known >= x).sum() for x in intensity])
        return intensity, 1 - np.cumprod(1 - passes / left)
    if method == "stripes":
        decided = motions[motions["demand"].notna()]
        shares = (decided["demand"] > 1).groupby(decided["intensity"]).agg(["mean", "size"])
        shares = shares[shares["size"] > 1]  # intensities of single motions are no stripes
        return shares.index.to_numpy(float), shares["mean"].to_numpy(float)
    return np.zeros(0), np.zeros(0)


# Annual rates


@with_style
def draw_contributions(evidence: Evidence) -> Figure:
    """Draw the annual rate per ln of the intensity, alone and with pounding: a panel for each limit and building.

    Of several analyses the last is drawn.
    """
    answer = evidence.results.answer(CONTRIBUTIONS)
    unit = answer.column("from").unit
    rows = evidence.rows_here(answer.frame)
    rows = rows[rows["analysis"] == rows["analysis"].iloc[-1]]
    panels = rows.groupby(["limit", "building"], sort=False)
    look_by_case = looks(rows["case"].unique().tolist())
    figure, axes = grid(len(panels), 3.6, 2.8)
    for ax, ((limit, building), of_panel) in zip(axes, panels, strict=True):
        first_case = of_panel["case"].iloc[0]
        for (case, state), part in of_panel.groupby(["case", STATE_COLUMN], sort=False):
            if state == ALONE and case != first_case:  # the building alone is the same in all cases
                continue
            look = LOOK_ALONE if state == ALONE else look_by_case[str(case)]
            label = ALONE if state == ALONE else f"{WITH_POUNDING}: {case}"
            intensity = np.sqrt(part["from"] * part["to"]) / unit.factor
            density = part["rate"] / np.log(part["to"] / part["from"])
            ax.plot(intensity, density, color=look.color, ls=look.line, lw=1.8, label=label)
        ax.set_title(join_place(str(building), str(limit)), loc="left")
        ax.set(xscale="log", ylabel="annual rate per ln of the intensity")
        ax.set_xlabel(unit.label(describe_measure(evidence.results)))
        ax.set_ylim(bottom=0)
    shared_legend(figure, axes)
    finish(figure, evidence.title)
    return figure
