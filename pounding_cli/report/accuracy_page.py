"""The answer of `pound accuracy`: runs by method and setting, the cheapest for a wish, the table and the page."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pandas as pd

from pounding_cli.methods import METHODS
from pounding_cli.numbers import counted
from pounding_cli.report.citations import method_sources
from pounding_cli.report.style import unwritable
from pounding_cli.solver.work_precision import QUANTITIES, REFERENCE, SECOND, Run, WorkPrecision
from pounding_cli.texts import cells, write_markdown

PACKAGES = ("pounding-cli", "numpy", "scipy", "numba")


@dataclass(frozen=True)
class Line:
    """One method at one setting over all scenes it ran.

    scenes, aborted : how many ended and how many did not
    milliseconds : mean time a scene [ms]
    worst, median : errors over the scenes by QUANTITIES [-]
    miscounted : scenes whose number of impacts is not the reference's
    residual : largest energy residual [-], nan where the method keeps no ledger
    """

    method: str
    setting: float
    scenes: int
    aborted: int
    milliseconds: float
    worst: dict[str, float]
    median: dict[str, float]
    miscounted: int
    residual: float

    @property
    def error(self) -> float:
        """Largest error of any quantity [-]."""
        return max(self.worst.values())


def lines_of(runs: Sequence[Run]) -> tuple[Line, ...]:
    """Runs by method and setting; those that did not end count as aborted and enter no mean."""
    lines = []
    for method, setting in dict.fromkeys((run.method, run.setting) for run in runs):
        mine = [run for run in runs if (run.method, run.setting) == (method, setting)]
        done = [run for run in mine if run.status == "done"]
        if not done:
            nothing = dict.fromkeys(QUANTITIES, float("nan"))
            lines.append(Line(method, setting, 0, len(mine), float("nan"), nothing, nothing, 0, float("nan")))
            continue
        residuals = [abs(run.residual) for run in done if np.isfinite(run.residual)]
        lines.append(
            Line(
                method,
                setting,
                len(done),
                len(mine) - len(done),
                1e3 * float(np.mean([run.seconds for run in done])),
                {q: float(max(run.errors[q] for run in done)) for q in QUANTITIES},
                {q: float(np.median([run.errors[q] for run in done])) for q in QUANTITIES},
                sum(run.impacts != run.expected for run in done),
                max(residuals, default=float("nan")),
            )
        )
    return tuple(lines)


def cheapest(lines: Sequence[Line], wanted: float, scenes: int) -> Line | None:
    """The fastest line that ran every scene to the wanted error [-] in every quantity, if there is one."""
    good = [line for line in lines if line.scenes == scenes and line.error <= wanted]
    return min(good, key=lambda line: line.milliseconds, default=None)


def setting_text(line: Line) -> str:
    """A setting with its unit."""
    return METHODS[line.method].setting.text(line.setting)


def in_words(found: WorkPrecision, wishes: Sequence[float] = (1e-2, 1e-3, 1e-4)) -> list[str]:
    """The answer: what to use for each wanted error, what it costs, and what the others cost for the same."""
    scenes = len(found.references)
    lines = lines_of(found.runs)
    said = []
    for wanted in wishes:
        best = cheapest(lines, wanted, scenes)
        if best is None:
            said.append(f"For {100 * wanted:g} %: no method and setting that was tried reaches it on every scene.")
            continue
        text = f"For {100 * wanted:g} % use {_use(best)}: {best.milliseconds:.3g} ms a scene."
        finer = cheapest(lines, wanted / 10, scenes)
        if finer is None:
            text += " The next digit was not reached."
        elif finer == best:
            text += " That gives the next digit too."
        else:
            text += (
                f" The next digit ({_use(finer)}) costs {max(finer.milliseconds - best.milliseconds, 0):.2g} ms more."
            )
        others, beaten = [], []
        for name in dict.fromkeys(line.method for line in lines if line.method != best.method):
            other = cheapest([line for line in lines if line.method == name], wanted, scenes)
            if other is not None:
                others.append(f"{name} {other.milliseconds:.3g} ms")
            elif max((line.scenes for line in lines if line.method == name), default=0) == scenes:
                beaten.append(name)
        if others:
            text += f" The others: {', '.join(others)}."
        if beaten:
            text += f" Not reached by {', '.join(beaten)}."
        said.append(text)
    return said


def _use(line: Line) -> str:
    return f"{line.method} with {METHODS[line.method].setting.said(line.setting)}"


def reference_in_words(found: WorkPrecision) -> str:
    """How well the two reference methods agree."""
    if not found.references:
        return "No scene has a reference."
    worst = {q: max(reference.differences[q] for reference in found.references) for q in QUANTITIES}
    differing = sum(reference.impacts > 0 for reference in found.references)
    differences = ", ".join(f"{q} {difference:.1e}" for q, difference in worst.items())
    return (
        f"Reference: {REFERENCE[0]} at accuracy {REFERENCE[1]:g}; {SECOND[0]} at {SECOND[1]:g} differs from it by at "
        f"most {differences} over {counted(len(found.references), 'scene')}"
        + (f", and counts other impacts in {differing} of them." if differing else ", with the same impacts.")
    )


def aborted_in_words(found: WorkPrecision) -> list[str]:
    """Runs that did not end, by method, setting and outcome."""
    groups: dict[tuple[str, float, str, str], int] = {}
    for run in found.runs:
        if run.status != "done":
            key = (run.method, run.setting, run.status, run.advice)
            groups[key] = groups.get(key, 0) + 1
    return [
        f"{method} at {METHODS[method].setting.text(setting)}: {status} on {counted(count, 'scene')}"
        + (f" ({advice})" if advice else "")
        for (method, setting, status, advice), count in groups.items()
    ]


def runs_frame(found: WorkPrecision) -> pd.DataFrame:
    """One row a run: what `accuracy.csv` holds; errors [-], seconds [s]."""
    return pd.DataFrame(
        [
            {
                "case": run.case, "analysis": run.analysis, "record": run.record, "method": run.method,
                "setting": run.setting, "status": run.status, "seconds": run.seconds, "steps": run.steps,
                "events": run.events, **{f"error_{q}": run.errors[q] for q in QUANTITIES}, "impacts": run.impacts,
                "impacts_reference": run.expected, "energy_residual": run.residual, "advice": run.advice,
            }
            for run in found.runs
        ]
    )  # fmt: skip


def lines_frame(found: WorkPrecision) -> pd.DataFrame:
    """One row a method and setting: the printed table; errors are the worst over the scenes [-], time a scene [ms]."""
    return pd.DataFrame(
        [
            {
                "method": line.method, "setting": setting_text(line), "scenes": line.scenes, "aborted": line.aborted,
                "ms": line.milliseconds, **line.worst, "miscounted": line.miscounted, "energy": line.residual,
            }
            for line in lines_of(found.runs)
        ]
    )  # fmt: skip


def machine() -> str:
    """Processor, cores, system."""
    name = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        name = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), name)
    except OSError:
        pass  # not Linux: the plain name has to do
    return f"{name}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}; one core was used"


def left_out_in_words(found: WorkPrecision) -> list[str]:
    """What the budget did not allow, in one sentence; nothing where all was run."""
    if not found.left_out:
        return []
    return [f"Left out because the budget ended before them (--budget gives more): {'; '.join(found.left_out)}."]


def without_reference_in_words(found: WorkPrecision) -> list[str]:
    """Scenes without a reference, in one sentence; nothing where each has one."""
    if not found.without_reference:
        return []
    return [f"Left out because the reference did not end: {'; '.join(found.without_reference)}."]


def page(found: WorkPrecision, title: str, drawn: Sequence[str], command: str) -> list[str]:
    """`accuracy.md`, line by line."""
    frame = lines_frame(found)
    shown = frame.copy()
    for column in (*QUANTITIES, "energy"):
        shown[column] = [f"{value:.1e}" if np.isfinite(value) else "-" for value in frame[column]]
    shown["ms"] = [f"{value:.3g}" if np.isfinite(value) else "-" for value in frame["ms"]]
    rows = ["| " + " | ".join(map(str, row)) + " |" for row in shown.itertuples(index=False)]
    aborted, versions = aborted_in_words(found), ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    return [
        f"# What accuracy costs: {title}", "",
        *(f"- {text}" for text in in_words(found)), "",
        reference_in_words(found), "",
        *(f"![error against time]({name})" for name in drawn), "",
        "Errors are the worst over storeys, floors or links and over the scenes; time is the mean of a scene, the "
        "least of its repeats, without compiling. `miscounted`: scenes with other impacts than the reference.", "",
        "| " + " | ".join(shown.columns) + " |", "|" + "---|" * len(shown.columns), *rows, "",
        *(["Did not end, and are not drawn:", "", *(f"- {text}" for text in aborted), ""] if aborted else []),
        *(line for text in (*without_reference_in_words(found), *left_out_in_words(found)) for line in (text, "")),
        "Sources:", "",
        *method_sources(dict.fromkeys(run.method for run in found.runs)), "",
        f"Machine: {machine()}. Python {sys.version.split()[0]}, {versions}.", "",
        f"Again: `{command}`",
    ]  # fmt: skip


def write(found: WorkPrecision, title: str, drawn: Sequence[Path], command: str, folder: Path) -> list[Path]:
    """Write `accuracy.csv` and `accuracy.md`; returns the files. Raises InputError where the folder refuses."""
    files = [folder / "accuracy.csv", folder / "accuracy.md"]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        cells(runs_frame(found)).to_csv(files[0], index=False)
        pictures = [path.name for path in drawn if path.suffix == ".png"]
        write_markdown(files[1], page(found, title, pictures, command))
    except OSError as error:
        raise unwritable(folder, error) from error
    return files
