"""The figures of `pound accuracy`: error against time."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from pounding_cli.methods import METHODS
from pounding_cli.numbers import pluralize
from pounding_cli.questions.accuracy.tables import ERRORS
from pounding_cli.report.document import Picture
from pounding_cli.report.style import Look, finish, new_figure, shared_legend, with_style
from pounding_cli.solver.response import DONE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pounding_cli.questions.accuracy import Measurement

LOOKS = {
    "taylor": Look("#000000", "-", "o"),
    "dop853": Look("#0072B2", "-", "s"),
    "central-difference": Look("#AA2211", (0, (5, 1.5, 1, 1.5)), "D"),
    "newmark": Look("#E69F00", "-", "^"),
}
"""Colour, line and marker of every method."""

MIN_ERROR = 1e-13
"""Error at which smaller ones are drawn, which are rounding [-]."""


def list_figures(measurement: Measurement) -> list[Picture]:
    """Return the figures of errors against time, one an analysis."""
    return [
        Picture(
            f"accuracy-{analysis}",
            f"Error against time, {analysis} analyses",
            "Rows are quantities, columns cases.",
            partial(draw_errors, measurement, analysis),
        )
        for analysis in measurement.runs["analysis"].unique()
    ]


@with_style
def draw_errors(measurement: Measurement, analysis: str) -> Figure:
    """Draw errors against time: rows are quantities, columns cases; runs that did not end are not drawn.

    A point is the mean time and the worst error over the motions; below the grey line the two reference methods differ.
    """
    runs = measurement.runs[measurement.runs["analysis"] == analysis]
    cases = list(runs["case"].unique())
    figure = new_figure(1.4 + 2.1 * len(cases), 8.2)
    axes = figure.subplots(len(ERRORS), len(cases), sharex=True, sharey="row", squeeze=False)
    for place, case in enumerate(cases):
        solved = runs[(runs["case"] == case) & (runs["status"] == DONE)]
        for ax, name in zip(axes[:, place], ERRORS, strict=True):
            _draw_methods(ax, solved, name)
            floor = _find_reference_difference(measurement, case, analysis, name)
            ax.axhspan(MIN_ERROR / 10, floor, color="0.88", zorder=0)
            ax.set(xscale="log", yscale="log", ylim=(MIN_ERROR / 3, 3.0))
        axes[0, place].set_title(case)
        axes[-1, place].set_xlabel("time per time history [ms]")
    for ax, label in zip(axes[:, 0], ERRORS.values(), strict=True):
        ax.set_ylabel(f"error of {label}")
    shared_legend(figure, axes.flat, "outside upper center", columns=len(cases))
    finish(
        figure,
        "",
        f"{analysis.capitalize()} analyses: largest relative error over the storeys (floors, links) and "
        f"{pluralize(runs['record'].nunique(), 'motion')} against time in the solver, from coarse to fine settings. "
        "Grey: the two reference methods differ by this much. Runs that did not end are not drawn.",
    )
    return figure


def _draw_methods(ax: Axes, runs: pd.DataFrame, error: str) -> None:
    """Draw the largest error of some runs against their mean time, one line a method.

    error : column of the error
    """
    for method, runs_of_method in runs.groupby("method", sort=False):
        points = runs_of_method.groupby("setting", sort=False).agg({"seconds": "mean", error: "max"})
        errors = points[error].to_numpy(float)
        if not (errors > 0).any():  # a quantity that no run has, such as a force without contact
            continue
        look = LOOKS[str(method)]
        ax.plot(
            1e3 * points["seconds"],
            np.maximum(errors, MIN_ERROR),
            color=look.color,
            ls=look.line,
            marker=look.marker,
            ms=3.5,
            lw=1.2,
            label=METHODS[str(method)].title,
        )


def _find_reference_difference(measurement: Measurement, case: str, analysis: str, error: str) -> float:
    """Return by how much the two reference methods differ at most in one case and analysis [-]."""
    quantity = error.removeprefix("error_")
    differences = [
        reference[quantity]
        for reference in measurement.found.references
        if (reference["case"], reference["analysis"]) == (case, analysis)
    ]
    return max([MIN_ERROR, *differences])
