"""The pair of docs/from-opensees.md by OpenSees and by `pound`: the table of that page, and the figure of error against
time of the README."""

from __future__ import annotations

import contextlib
import runpy
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from pounding_cli.api.studies import load_study
from pounding_cli.methods import METHODS
from pounding_cli.model.scene import Scene
from pounding_cli.questions.accuracy.figures import LOOKS, MIN_ERROR
from pounding_cli.report.style import Look, new_figure, save_figures, with_style
from pounding_cli.solver.solve import solve
from pounding_cli.solver.work_precision import measure
from pounding_cli.study import make_plan
from tests.bench.pages import FIGURES, ROOT, format_error, format_time, table

STUDY: Mapping[str, Any] = MappingProxyType({
    "records": {"use": ["elcentro"], "duration": "10 s"},
    "buildings": {"stiff": {"storeys": 5, "period": "0.36 s"}, "soft": {"like": "stiff", "period": "0.60 s"}},
    "group": ["stiff", "soft"],
    "cases": {"touching": {"link": "pounding", "gap": "0 cm"}},
})  # fmt: skip
"""The study of the page."""

STEPS = (1e-3, 1e-4, 5e-5, 2e-5)
"""Time steps of OpenSees [s]."""
SHOWN = ((0, 0), (0, 4), (1, 0), (1, 4))
"""Building and storey, from 0, of the shears in the table: storeys 1 and 5 of both buildings."""
BUDGET = 60.0
"""Time for the runs of the methods of `pound` [s]."""
REPEATS = 7
OPENSEES = Look("#56B4E9", "-", "v")


def measure_opensees() -> tuple[str, str]:
    """Return the table of docs/from-opensees.md and the README's sentence on its figure, which is drawn anew."""
    elastic = compare("elastic")
    inelastic = compare("inelastic")
    draw_error_against_time(find_scene("elastic"), elastic.opensees)
    rows = [["**elastic**", *[""] * 6], *elastic.rows, ["**inelastic**", *[""] * 6], *inelastic.rows]
    finest = elastic.opensees[-1]
    sentence = (
        "The elastic pair in touch of [coming from OpenSees](docs/from-opensees.md): `pound` at its default accuracy "
        f"of 1e-6 takes {format_time(elastic.pound.seconds)} and is wrong by {format_error(elastic.pound.error)}; "
        f"OpenSees at steps of {1e3 * STEPS[-1]:g} ms takes {format_time(finest.seconds)} and is wrong by "
        f"{format_error(finest.error)}. The error is that of the worst storey shear against a run at 1e-12, which a "
        "second method confirms."
    )
    return table(" | stiff 1 | stiff 5 | soft 1 | soft 5 | error | time", rows), sentence


@dataclass(frozen=True)
class Run:
    """Time [s] and error [-] of one run that ended."""

    seconds: float
    error: float


@dataclass(frozen=True)
class Comparison:
    """The rows of the table for one analysis, and the runs of both programs behind them, coarse steps first."""

    rows: list[list[str]]
    opensees: list[Run]
    pound: Run


def compare(analysis: str) -> Comparison:
    """Solve the pair of an analysis by OpenSees at every step and by `pound` at its default accuracy."""
    scene = find_scene(analysis)
    reference = find_shears(scene, 1e-12)
    rows = []
    runs = []
    for step in STEPS:
        try:
            shears, seconds = run_opensees(step, analysis)
        except RuntimeError as failure:
            instant = str(failure).split(" at ")[1].split(" s ")[0]
            rows.append([f"OpenSees, {1e3 * step:g} ms", f"failed at {float(instant):.1f} s", *[""] * 5])
            continue
        runs.append(Run(seconds, find_error(shears, reference)))
        rows.append([f"OpenSees, {1e3 * step:g} ms", *format_cells(shears, runs[-1])])
    shears = find_shears(scene, 1e-6)
    seconds = min(solve(scene, accuracy=1e-6).seconds for _ in range(REPEATS))
    pound = Run(seconds, find_error(shears, reference))
    rows.append(["pound, 1e-6", *format_cells(shears, pound)])
    return Comparison(rows, runs, pound)


def format_cells(shears: np.ndarray, run: Run) -> list[str]:
    """Return the cells of a run: four shears [kN], the error and the time."""
    shown = [f"{shears[place] / 1e3:.1f}" for place in SHOWN]
    return [*shown, format_error(run.error), format_time(run.seconds)]


def find_error(shears: np.ndarray, reference: np.ndarray) -> float:
    """Return the largest relative difference of storey shears from the reference [-]."""
    return float(np.abs(shears / reference - 1.0).max())


def find_scene(analysis: str) -> Scene:
    """Return the scene of the page's study, elastic or inelastic."""
    plan = make_plan(load_study(dict(STUDY)))
    rows = [plan.row(number) for number in range(len(plan.cases) * len(plan.analyses))]
    return next(plan.scene(row.scene) for row in rows if row.analysis == analysis)


def find_shears(scene: Scene, accuracy: float) -> np.ndarray:
    """Return the peak storey shears [N], shape (2, 5), of a scene solved to an accuracy [-]."""
    response = solve(scene, accuracy=accuracy)
    return np.array([building.shear for building in response.buildings])


def run_opensees(step: float, analysis: str) -> tuple[np.ndarray, float]:
    """Run the script of the page at a time step [s]; return storey shears [N], shape (2, 5), and the time stepping [s].

    Raises
    ------
    RuntimeError : OpenSees fails; the message says when
    """
    with reader_folder():
        march = runpy.run_path(str(ROOT / "docs" / "examples" / "opensees_pair.py"))["march"]
        shears, seconds = march(step, analysis == "inelastic")
    return shears.reshape(2, -1), seconds


@contextlib.contextmanager
def reader_folder() -> Iterator[None]:
    """A folder with the motions, in which the script of the page runs and leaves its files."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        Path("records").symlink_to(ROOT / "records")
        yield


def draw_error_against_time(scene: Scene, opensees: list[Run]) -> None:
    """Draw error of storey shears against time of every method of `pound` and of OpenSees into docs/figures."""
    place = {"case": "touching", "analysis": "elastic", "record": "elcentro"}
    found = measure([(place, scene)], tuple(METHODS), BUDGET)
    save_figures({"error-against-time": _draw(found.runs, opensees)}, FIGURES, ["png"])


@with_style
def _draw(runs: list[dict[str, Any]], opensees: list[Run]) -> Figure:
    """Return the figure: a line a method, from coarse to fine settings."""
    figure = new_figure(6.4, 3.6)
    ax = figure.subplots()
    for name, method in METHODS.items():
        points = [(run["seconds"], run["error_V"]) for run in runs if run["method"] == name and run["status"] == "done"]
        _plot(ax, points, LOOKS[name], method.title)
    _plot(ax, [(run.seconds, run.error) for run in opensees], OPENSEES, "OpenSees, Newmark")
    ax.set(xscale="log", yscale="log", xlabel="time of the scene [ms]", ylabel="error of the largest storey shear [-]")
    figure.legend(loc="outside right center", fontsize=8)
    return figure


def _plot(ax: Any, points: list[tuple[float, float]], look: Look, label: str) -> None:
    """Plot errors [-] against times [s]; errors of rounding stand at `MIN_ERROR`."""
    milliseconds = [1e3 * seconds for seconds, _ in points]
    errors = [max(error, MIN_ERROR) for _, error in points]
    ax.plot(milliseconds, errors, color=look.color, ls=look.line, marker=look.marker, ms=4, lw=1.3, label=label)


def opensees_version() -> str:
    """Return the version of OpenSees that was measured."""
    import openseespy.opensees as ops

    return str(ops.version())
