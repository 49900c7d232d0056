"""The report of `pound accuracy`: error against time of every method, and which is the cheapest for a wanted error."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Sequence
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pounding_cli.methods import METHODS
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.references import REFERENCES
from pounding_cli.report.style import Look, caption, new_figure, styled
from pounding_cli.report.table import from_rows
from pounding_cli.results.tables import Column, Table
from pounding_cli.solver.work_precision import QUANTITIES, REFERENCE, SECOND, WorkPrecision

PACKAGES = ("pounding-cli", "numpy", "scipy", "numba")
WISHES = (1e-2, 1e-3, 1e-4)
"""Errors for which the cheapest method is named [-]."""
LABELS = dict(zip(QUANTITIES, ("storey shear", "ductility", "floor acceleration", "link force"), strict=True))
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
    lines, scenes = lines_frame(runs), len(found.references)
    said = [_wish(lines, wanted, scenes) for wanted in WISHES]
    pictures = [
        Picture(f"accuracy-{analysis}", f"Error against time, {analysis} analyses",
                "Rows are quantities, columns cases.", partial(diagram, found, runs, analysis))
        for analysis in dict.fromkeys(runs["analysis"])
    ]  # fmt: skip
    shown = lines.assign(setting=[METHODS[m].setting.text(s) for m, s in zip(lines.method, lines.setting, strict=True)])
    columns = {name: Column(label=text) for name, text in LABELS.items()}
    columns["seconds"] = Column(label="time a scene", unit=Unit("ms", 1e-3, "s"))
    notes = [
        "Errors: worst over storeys, floors or links and over the scenes, relative; time: mean of a scene, the least "
        "of its repeats, without compiling. Miscounted: scenes with other impacts than the reference.",
        _reference(found),
        *(f"Did not end: {text}." for text in _aborted(runs)),
        *(f"Left out: {what}." for what in found.left_out),
        f"Runs took {found.spent:.2g} s, compiling before them {found.compiling:.2g} s.",
    ]  # fmt: skip
    cited = [
        [name, "; ".join(f"{REFERENCES[key].text} {where}".rstrip() for key, where in METHODS[name].citation)]
        for name in dict.fromkeys(runs["method"])
    ]
    made = (
        f"{_machine()}. Python {sys.version.split()[0]}, {', '.join(f'{each} {version(each)}' for each in PACKAGES)}."
    )
    return Report(
        f"What accuracy costs: {title}",
        Section("", said, [Table("", shown, columns, "Methods")], pictures, notes),
        lambda: [
            Section("Every run", tables=[Table("accuracy", runs, caption="Every run")], folded=True),
            Section("Sources", [f"Machine: {made}", f"Again: `{command}`"],
                    [from_rows("Methods and who published them", ("method", "source"), cited)]),
        ],
    )  # fmt: skip


def lines_frame(runs: pd.DataFrame) -> pd.DataFrame:
    """One row a method and setting: how many scenes ended, mean time [s], the worst error of every quantity [-], how
    many scenes have other impacts than the reference, the largest energy residual; those that did not end enter no
    mean."""
    done = runs["status"] == "done"
    ended = runs.assign(
        seconds=runs["seconds"].where(done),
        scenes=done,
        aborted=~done,
        miscounted=done & (runs["impacts"] != runs["impacts_reference"]),
        energy=runs["energy_residual"].abs(),
    )
    how = {"scenes": "sum", "aborted": "sum", "seconds": "mean", **{f"error_{q}": "max" for q in QUANTITIES},
           "miscounted": "sum", "energy": "max"}  # fmt: skip
    lines = ended.groupby(["method", "setting"], sort=False, as_index=False).agg(how)
    return lines.rename(columns={f"error_{q}": q for q in QUANTITIES})


def cheapest(lines: pd.DataFrame, wanted: float, scenes: int) -> pd.Series | None:
    """The fastest line that ran every scene to the wanted error [-] in every quantity, if there is one."""
    good = lines[(lines["scenes"] == scenes) & (lines[list(QUANTITIES)].max(axis=1) <= wanted)]
    return None if good.empty else good.iloc[int(good["seconds"].argmin())]


def _wish(lines: pd.DataFrame, wanted: float, scenes: int) -> str:
    """What to use for a wanted error, what it and the next digit cost, and what the others cost for the same."""
    best = cheapest(lines, wanted, scenes)
    if best is None:
        return f"For {100 * wanted:g} %: no method and setting that was tried reaches it on every scene."
    text = f"For {100 * wanted:g} % use {_use(best)}: {1e3 * best['seconds']:.3g} ms a scene."
    finer = cheapest(lines, wanted / 10, scenes)
    if finer is None:
        text += " The next digit was not reached."
    elif finer.name == best.name:
        text += " That gives the next digit too."
    else:
        more = 1e3 * max(finer["seconds"] - best["seconds"], 0)
        text += f" The next digit ({_use(finer)}) costs {more:.2g} ms more."
    others, beaten = [], []
    for name, mine in lines[lines["method"] != best["method"]].groupby("method", sort=False):
        other = cheapest(mine, wanted, scenes)
        if other is not None:
            others.append(f"{name} {1e3 * other['seconds']:.3g} ms")
        elif mine["scenes"].max() == scenes:
            beaten.append(str(name))
    text += f" The others: {', '.join(others)}." if others else ""
    return text + (f" Not reached by {', '.join(beaten)}." if beaten else "")


def _use(line: pd.Series) -> str:
    return f"{line['method']} with {METHODS[line['method']].setting.said(line['setting'])}"


def _reference(found: WorkPrecision) -> str:
    """How well the two reference methods agree."""
    if not found.references:
        return "No scene has a reference."
    worst = {q: max(reference[q] for reference in found.references) for q in QUANTITIES}
    differing = sum(reference["impacts"] > 0 for reference in found.references)
    differences = ", ".join(f"{q} {difference:.1e}" for q, difference in worst.items())
    impacts = f"and counts other impacts in {differing} of them" if differing else "with the same impacts"
    return (
        f"Reference: {REFERENCE[0]} at accuracy {REFERENCE[1]:g}; {SECOND[0]} at {SECOND[1]:g} differs from it by at "
        f"most {differences} over {counted(len(found.references), 'scene')}, {impacts}."
    )


def _aborted(runs: pd.DataFrame) -> list[str]:
    """Runs that did not end, by method, setting and outcome."""
    lost = runs[runs["status"] != "done"]
    said = []
    place: Any
    for place, rows in lost.groupby(["method", "setting", "status", "advice"], sort=False):
        method, setting, status, advice = place
        where = f"{method} at {METHODS[method].setting.text(setting)}"
        said.append(f"{where}: {status} on {counted(len(rows), 'scene')}{f' ({advice})' if advice else ''}")
    return said


def _machine() -> str:
    """Processor, cores, system."""
    name = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        name = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), name)
    except OSError:
        pass  # not Linux: the plain name has to do
    return f"{name}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}; one core was used"


@styled
def diagram(found: WorkPrecision, runs: pd.DataFrame, analysis: str) -> Figure:
    """Rows are quantities, columns cases; runs that did not end are not drawn. A point is the mean time and the worst
    error over the motions; below the grey line the two reference methods differ."""
    runs = runs[runs["analysis"] == analysis]
    cases = list(dict.fromkeys(runs["case"]))
    figure = new_figure(1.4 + 2.1 * len(cases), 8.2)
    axes = figure.subplots(len(QUANTITIES), len(cases), sharex=True, sharey="row", squeeze=False)
    for column, case in enumerate(cases):
        mine = runs[(runs["case"] == case) & (runs["status"] == "done")]
        here = [each for each in found.references if (each["case"], each["analysis"]) == (case, analysis)]
        for ax, quantity in zip(axes[:, column], QUANTITIES, strict=True):
            _panel(ax, mine, quantity)
            ax.axhspan(LOWEST / 10, max([LOWEST, *(each[quantity] for each in here)]), color="0.88", zorder=0)
        axes[0, column].set_title(case)
        axes[-1, column].set_xlabel("time a scene [ms]")
    for ax, quantity in zip(axes[:, 0], QUANTITIES, strict=True):
        ax.set_ylabel(f"error of {LABELS[quantity]}")
    methods = [name for name in METHODS if (runs["method"] == name).any()]
    figure.legend(handles=_handles(methods), loc="outside upper center", ncols=max(2, len(cases)), handlelength=3.2)
    motions = counted(runs["record"].nunique(), "motion")
    caption(
        figure,
        f"{analysis.capitalize()} analyses: largest relative error over the storeys (floors, links) and {motions} "
        "against time in the solver, from coarse to fine settings. Grey: the two reference methods differ by this "
        "much. Runs that did not end are not drawn.",
    )
    return figure


def _panel(ax: Axes, runs: pd.DataFrame, quantity: str) -> None:
    for name, mine in runs.groupby("method", sort=False):
        points = mine.groupby("setting", sort=False).agg({"seconds": "mean", f"error_{quantity}": "max"})
        errors = points[f"error_{quantity}"].to_numpy(float)
        if (errors > 0).any():  # not so of a quantity that no run has, such as a force without contact
            look, times = LOOKS[str(name)], 1e3 * points["seconds"]
            ax.plot(
                times, np.maximum(errors, LOWEST), color=look.color, ls=look.line, marker=look.marker, ms=3.5, lw=1.2
            )
    ax.set(xscale="log", yscale="log", ylim=(LOWEST / 3, 3.0))


def _handles(methods: Sequence[str]) -> list[Line2D]:
    return [
        Line2D([], [], color=look.color, ls=look.line, marker=look.marker, ms=4.5, lw=1.4, label=METHODS[name].title)
        for name, look in ((name, LOOKS[name]) for name in methods)
    ]
