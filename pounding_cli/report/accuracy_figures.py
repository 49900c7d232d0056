"""The work-precision diagram: error against time of every method, by quantity and case."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pounding_cli.methods import METHODS
from pounding_cli.numbers import counted
from pounding_cli.report.style import Look, caption, new_figure, save, styled
from pounding_cli.solver.work_precision import QUANTITIES, Run, WorkPrecision

LABELS = {
    "V": "storey shear",
    "mu": "ductility",
    "acceleration": "floor acceleration",
    "force": "link force",
}

LOOKS = {
    "taylor": Look("#000000", "-", "o"),
    "dop853": Look("#0072B2", "-", "s"),
    "central-difference": Look("#AA2211", (0, (5, 1.5, 1, 1.5)), "D"),
    "newmark": Look("#E69F00", "-", "^"),
}

LOWEST = 1e-13
"""Errors below this are drawn at it: they are rounding."""


def draw_accuracy(found: WorkPrecision, folder: Path, formats: tuple[str, ...] = ("png", "svg")) -> list[Path]:
    """One diagram an analysis, `accuracy-elastic` and `accuracy-inelastic`; returns the files."""
    analyses = dict.fromkeys(run.analysis for run in found.runs)
    return save({f"accuracy-{analysis}": diagram(found, analysis) for analysis in analyses}, folder, formats)


@styled
def diagram(found: WorkPrecision, analysis: str) -> Figure:
    """Rows are quantities, columns cases; runs that did not end are not drawn. A point is the mean time and the worst
    error over the motions; below the grey line the two reference methods differ."""
    runs = [run for run in found.runs if run.analysis == analysis]
    cases = list(dict.fromkeys(run.case for run in runs))
    methods = [name for name in METHODS if any(run.method == name for run in runs)]
    figure = new_figure(1.4 + 2.1 * len(cases), 8.2)
    axes = figure.subplots(len(QUANTITIES), len(cases), sharex=True, sharey="row", squeeze=False)
    for column, case in enumerate(cases):
        for row, quantity in enumerate(QUANTITIES):
            ax = axes[row, column]
            mine = [run for run in runs if run.case == case and run.status == "done"]
            _panel(ax, mine, quantity, methods)
            differences = [
                reference.differences[quantity]
                for reference in found.references
                if (reference.case, reference.analysis) == (case, analysis)
            ]
            ax.axhspan(LOWEST / 10, max([*differences, LOWEST]), color="0.88", zorder=0)
            if row == 0:
                ax.set_title(case)
            if column == 0:
                ax.set_ylabel(f"error of {LABELS[quantity]}")
            if row == len(QUANTITIES) - 1:
                ax.set_xlabel("time a scene [ms]")
    handles = [_handle(name) for name in methods]
    figure.legend(
        handles=handles, loc="outside upper center", ncols=min(len(handles), max(2, len(cases))), handlelength=3.2
    )
    records = len(dict.fromkeys(run.record for run in runs))
    caption(
        figure,
        f"{analysis.capitalize()} analyses: largest relative error over the storeys (floors, links) and "
        f"{counted(records, 'motion')} against time in the solver, from coarse to fine settings. Grey: the two "
        "reference methods differ by this much. Runs that did not end are not drawn.",
    )
    return figure


def _panel(ax: Axes, runs: list[Run], quantity: str, methods: list[str]) -> None:
    for name in methods:
        settings = dict.fromkeys(run.setting for run in runs if run.method == name)
        points = []
        for setting in settings:
            mine = [run for run in runs if (run.method, run.setting) == (name, setting)]
            worst = max(run.errors[quantity] for run in mine)
            points.append((1e3 * float(np.mean([run.seconds for run in mine])), worst))
        if any(error > 0 for _, error in points):  # a quantity that no run has, such as a force without contact
            look = LOOKS[name]
            times, errors = np.array(points).T
            errors = np.maximum(errors, LOWEST)
            ax.plot(times, errors, color=look.color, linestyle=look.line, marker=look.marker, ms=3.5, lw=1.2)
    ax.set(xscale="log", yscale="log", ylim=(LOWEST / 3, 3.0))


def _handle(name: str) -> Line2D:
    look = LOOKS[name]
    title = METHODS[name].title
    return Line2D([], [], color=look.color, linestyle=look.line, marker=look.marker, ms=4.5, lw=1.4, label=title)
