"""The report of `pound accuracy`: error against time of every method, and which is the cheapest for a wanted error."""

from __future__ import annotations

import os
import platform
import sys
from functools import partial
from importlib.metadata import version
from typing import Any, cast

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pounding_cli.methods import METHODS
from pounding_cli.numbers import Unit, pluralize
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.references import method_sources
from pounding_cli.report.style import Look, finish, new_figure, shared_legend, styled
from pounding_cli.results.tables import Column, Table
from pounding_cli.solver.work_precision import QUANTITIES, REFERENCE, SECOND, WorkPrecision

WISHES = (1e-2, 1e-3, 1e-4)
"""Errors for which the cheapest method is named [-]."""
LEAST_NOISE = 0.1
"""Times that differ by less than this part of them are the same, however well their repeats agree [-]."""
_LABELS = ("storey shear", "ductility", "floor acceleration", "link force")
ERRORS = {f"error_{quantity}": label for quantity, label in zip(QUANTITIES, _LABELS, strict=True)}
"""Columns of errors, and what they are called."""
LOOKS = {
    "taylor": Look("#000000", "-", "o"),
    "dop853": Look("#0072B2", "-", "s"),
    "central-difference": Look("#AA2211", (0, (5, 1.5, 1, 1.5)), "D"),
    "newmark": Look("#E69F00", "-", "^"),
}
LOWEST = 1e-13
"""Errors below this are drawn at it: they are rounding."""


def accuracy_report(found: WorkPrecision, title: str, command: str) -> Report:
    """What was measured; `command` repeats it."""
    runs = pd.DataFrame(found.runs)
    lines = lines_frame(runs)
    pictures = [
        Picture(f"accuracy-{analysis}", f"Error against time, {analysis} analyses",
                "Rows are quantities, columns cases.", partial(diagram, found, runs, analysis))
        for analysis in runs["analysis"].unique()
    ]  # fmt: skip
    shown = lines.drop(columns="seconds_noise").assign(
        setting=[METHODS[m].setting.text(s) for m, s in zip(lines.method, lines.setting, strict=True)]
    )
    columns = {name: Column(label=label) for name, label in ERRORS.items()}
    columns["seconds"] = Column(label="time a scene", unit=Unit("ms", 1e-3, "s"))
    noise = {"seconds_noise": Column(label="noise of the time", unit=Unit("ms", 1e-3, "s"))}
    notes = [
        "Errors: worst over storeys, floors or links and over the scenes, relative; time: mean of a scene, the least "
        "of its repeats, without compiling. Miscounted: scenes with other impacts than the reference.",
        "Settings whose times differ by less than their noise (as repeats show it, at least "
        f"{100 * LEAST_NOISE:g} %) count as equally fast: of these the most accurate is named.",
        _reference(found),
        *(f"Did not end: {text}." for text in _lost(runs)),
        *(f"Left out: {what}." for what in found.left_out),
        f"Runs took {found.spent:.2g} s, compiling before them {found.compiling:.2g} s.",
    ]
    software = ", ".join(f"{name} {version(name)}" for name in ("pounding-cli", "numpy", "scipy", "numba"))
    machine = f"{platform.platform()}, {platform.machine()}, {os.cpu_count()} cores, of which one was used"
    sources = [
        f"Machine: {machine}. Python {sys.version.split()[0]}, {software}.",
        f"Again: `{command}`",
        *(line.removeprefix("- ") for line in method_sources(runs["method"].unique())),
    ]
    return Report(
        f"What accuracy costs: {title}",
        Section("", [_wish(lines, wanted, len(found.references)) for wanted in WISHES],
                [Table("", shown, columns, "Methods")], pictures, notes),
        lambda: [
            Section("Every run", tables=[Table("accuracy", runs, noise, "Every run")], folded=True),
            Section("Sources", sources),
        ],
    )  # fmt: skip


def lines_frame(runs: pd.DataFrame) -> pd.DataFrame:
    """One row a method and setting: how many scenes ended, mean time and its noise [s], the worst error of every
    quantity [-], how many scenes have other impacts than the reference, the largest energy residual; those that did
    not end enter no mean."""
    done = runs["status"] == "done"
    ended = runs.assign(
        seconds=runs["seconds"].where(done), seconds_noise=runs["seconds_noise"].where(done),
        scenes=done, aborted=~done,
        miscounted=done & (runs["impacts"] != runs["impacts_reference"]), energy=runs["energy_residual"].abs(),
    )  # fmt: skip
    how = {
        "scenes": "sum", "aborted": "sum", "seconds": "mean", "seconds_noise": "mean",
        **dict.fromkeys(ERRORS, "max"), "miscounted": "sum", "energy": "max",
    }  # fmt: skip
    return ended.groupby(["method", "setting"], sort=False).agg(how).reset_index()


def _lost(runs: pd.DataFrame) -> list[str]:
    """Runs that did not end, by method, setting and outcome."""
    lost = runs[runs["status"] != "done"].groupby(["method", "setting", "status"], sort=False)["advice"]
    return [
        f"{method} at {METHODS[method].setting.text(setting)}: {status} on {pluralize(len(advice), 'scene')} "
        f"({advice.iloc[0]})"
        for (method, setting, status), advice in cast("Any", lost)
    ]


def cheapest(lines: pd.DataFrame, wanted: float, scenes: int) -> pd.DataFrame:
    """Return of every method the line that reaches the wanted error at the least cost, the cheapest method first.

    Of lines whose times cannot be told from that of the fastest the most accurate is taken, and of methods likewise;
    methods that do not reach the error on every scene are left out.

    Parameters
    ----------
    lines : as `lines_frame` has them
    wanted : largest error allowed, in every quantity [-]
    scenes : number of scenes that a line must have run
    """
    worst = lines[list(ERRORS)].max(axis=1)
    good = lines.assign(worst=worst)[(lines["scenes"] == scenes) & (worst <= wanted)]
    best = [_most_accurate_first(own).head(1) for _, own in good.groupby("method", sort=False)]
    return _most_accurate_first(pd.concat(best) if best else good).drop(columns="worst")


def _most_accurate_first(lines: pd.DataFrame) -> pd.DataFrame:
    """Return lines by time, with those first, by their error, that are as fast as the fastest within the noise."""
    if lines.empty:
        return lines
    by_time = lines.sort_values("seconds")
    fastest = by_time.iloc[0]
    noise = by_time["seconds_noise"].clip(lower=max(fastest["seconds_noise"], LEAST_NOISE * fastest["seconds"]))
    are_fastest = by_time["seconds"] - fastest["seconds"] <= noise
    return pd.concat([by_time[are_fastest].sort_values("worst", kind="stable"), by_time[~are_fastest]])


def _wish(lines: pd.DataFrame, wanted: float, scenes: int) -> str:
    """What to use for a wanted error, what it costs, and what the others cost for the same."""
    best = cheapest(lines, wanted, scenes).to_dict("records")
    if not best:
        return f"For {100 * wanted:g} %: no method and setting that was tried reaches it on every scene."
    costs = [f"{line['method']} {1e3 * line['seconds']:.3g} ms" for line in best]
    name, setting = best[0]["method"], METHODS[best[0]["method"]].setting
    text = f"For {100 * wanted:g} % use {name} with {setting.title} {setting.text(best[0]['setting'])}: "
    text += f"{costs[0].removeprefix(name).strip()} a scene."
    text += f" The others: {', '.join(costs[1:])}." if costs[1:] else ""
    lost = [each for each in lines["method"].unique() if each not in {line["method"] for line in best}]
    return text + (f" Not reached by {', '.join(lost)}." if lost else "")


def _reference(found: WorkPrecision) -> str:
    """How well the two reference methods agree."""
    if not found.references:
        return "No scene has a reference."
    both = pd.DataFrame(found.references)
    differences = ", ".join(f"{quantity} {both[quantity].max():.1e}" for quantity in QUANTITIES)
    differing = int((both["impacts"] > 0).sum())
    impacts = f"and counts other impacts in {differing} of them" if differing else "with the same impacts"
    return (
        f"Reference: {REFERENCE[0]} at accuracy {REFERENCE[1]:g}; {SECOND[0]} at {SECOND[1]:g} differs from it by at "
        f"most {differences} over {pluralize(len(both), 'scene')}, {impacts}."
    )


@styled
def diagram(found: WorkPrecision, runs: pd.DataFrame, analysis: str) -> Figure:
    """Rows are quantities, columns cases; runs that did not end are not drawn. A point is the mean time and the worst
    error over the motions; below the grey line the two reference methods differ."""
    runs = runs[runs["analysis"] == analysis]
    cases = runs["case"].unique()
    figure = new_figure(1.4 + 2.1 * len(cases), 8.2)
    axes = figure.subplots(len(QUANTITIES), len(cases), sharex=True, sharey="row", squeeze=False)
    for column, case in enumerate(cases):
        mine = runs[(runs["case"] == case) & (runs["status"] == "done")]
        here = [each for each in found.references if (each["case"], each["analysis"]) == (case, analysis)]
        for ax, quantity in zip(axes[:, column], QUANTITIES, strict=True):
            for name, own in mine.groupby("method", sort=False):
                points = own.groupby("setting", sort=False).agg({"seconds": "mean", f"error_{quantity}": "max"})
                errors, look = points[f"error_{quantity}"].to_numpy(float), LOOKS[str(name)]
                if (errors > 0).any():  # not so of a quantity that no run has, such as a force without contact
                    ax.plot(1e3 * points["seconds"], np.maximum(errors, LOWEST), color=look.color, ls=look.line,
                            marker=look.marker, ms=3.5, lw=1.2, label=METHODS[str(name)].title)  # fmt: skip
            differ = max([LOWEST, *(each[quantity] for each in here)])
            ax.axhspan(LOWEST / 10, differ, color="0.88", zorder=0)
            ax.set(xscale="log", yscale="log", ylim=(LOWEST / 3, 3.0))
        axes[0, column].set_title(case)
        axes[-1, column].set_xlabel("time a scene [ms]")
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
