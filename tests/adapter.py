"""The only test file that imports the inside of the package: scenes are written in the words of a study, and answers
come back as plain arrays, so that the inside may change."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from click.testing import CliRunner
from matplotlib.figure import Figure

import pounding_cli as pound
from pounding_cli.api.studies import load_study
from pounding_cli.cli.main import cli
from pounding_cli.laws.foundation import Bearings as Bearings
from pounding_cli.laws.foundation import FrictionPendulum as FrictionPendulum
from pounding_cli.laws.foundation import Rubber as Rubber
from pounding_cli.laws.joints import Connector as Connector
from pounding_cli.model.building import Building as Building
from pounding_cli.model.building import UnstableError as UnstableError
from pounding_cli.model.links import Link as Link
from pounding_cli.model.plan import FloorPlan as FloorPlan
from pounding_cli.model.plan import FrameLine as FrameLine
from pounding_cli.model.wall import Wall
from pounding_cli.notes import NOTES as NOTES
from pounding_cli.paper import points
from pounding_cli.questions.reports import build_report
from pounding_cli.records.hazard import HazardColumns as HazardColumns
from pounding_cli.records.hazard import read_hazard as read_hazard
from pounding_cli.solver import estimate as estimates
from pounding_cli.solver import response as response
from pounding_cli.solver import solve as solver
from pounding_cli.study import make_plan
from pounding_cli.study.expressions.expression import Scope as Scope
from pounding_cli.study.expressions.limits import parse_limit as parse_limit


def is_wall(building: Building) -> bool:
    """Return whether a building of a scene is a wall."""
    return isinstance(building, Wall)


def sketch(results: pound.Results) -> Figure:
    """The drawing of the group at the head of a page."""
    return build_report(results).sketch()


FLOORS = "shear", "drift", "ductility", "acceleration", "displacement_max", "displacement_min", "residual_drift"
LINKS = "peak_force", "max_closing", "impulse", "contact_time", "impacts"
LINES = "shear", "drift", "ductility", "residual_drift"
TURNS = "twist", "edge_drift_low", "edge_drift_high"
LENGTHS = "drift", "displacement_max", "displacement_min", "residual_drift", "max_closing"
FORCES = "shear", "peak_force"


@dataclass(frozen=True)
class Scene:
    """One scene in the words of a study; numbers without unit are in SI.

    Parameters
    ----------
    buildings : keys of a study's building; ground : acceleration [m/s2] at steps of `dt` [s]
    case : keys of a study's case; {} for nothing between the buildings
    more : further sections of the study: impact, laws
    tail : free vibration after the motion [s]
    start : displacements [m] and velocities [m/s] of floors at the start, one list a building; None is rest
    """

    buildings: Sequence[Mapping[str, Any]]
    ground: np.ndarray
    dt: float
    case: Mapping[str, Any] = field(default_factory=dict)
    analysis: str = "elastic"
    more: Mapping[str, Any] = field(default_factory=dict)
    tail: float = 0.0
    start: Any = None

    @cached_property
    def built(self) -> pound.Scene:
        """The scene as the package knows it."""
        names = [f"b{place}" for place in range(len(self.buildings))]
        buildings = dict(zip(names, map(dict, self.buildings), strict=True))
        case = {"case": dict(self.case) or {"link": "none"}}
        study = {"records": {"use": ["elcentro"]}, "buildings": buildings, "group": (names * 2)[: max(2, len(names))]}
        study |= {"cases": case, "analyses": [self.analysis], "tail": self.tail, **self.more}
        plan = make_plan(load_study(study))
        scene = plan.build(0)
        motion = pound.motion(self.ground, dt=self.dt)
        links = scene.links if len(names) > 1 else ()
        return pound.Scene(scene.buildings[: len(names)], links, motion, scene.analysis, scene.tail)


@dataclass(frozen=True)
class Run:
    """What came of a scene: peaks of all storeys and floors left to right, of all links, energies, outcome.

    numbers : by the names of FLOORS and LINKS, of "sway" and "rocking" (n buildings), "shear_below" and "shear_above"
        of struck columns, "end" and "end_velocity" of all floors
    energy : [J], "residual" relative to the input [-]
    place : building from 0 and storey from 1 that collapsed, at `time` [s]
    error : estimated error [-], nan where it was not asked for
    """

    status: str
    advice: str
    numbers: Mapping[str, np.ndarray]
    energy: Mapping[str, float]
    steps: int
    events: int
    seconds: float
    time: float
    place: tuple[int, int]
    error: float
    flags: tuple[str, ...]
    effects: tuple[str, ...]

    def __getattr__(self, name: str) -> np.ndarray:
        if name == "numbers" or name not in self.numbers:
            raise AttributeError(name)
        return self.numbers[name]


def solve(scene: Scene | pound.Scene, accuracy: float = 1e-6, *, estimate: bool = False, **settings: Any) -> Run:
    """The run of a scene, by Taylor series unless `settings` say otherwise; `estimate` its error as in a batch."""
    built, start = (scene.built, scene.start) if isinstance(scene, Scene) else (scene, None)
    found = solver.solve(built, accuracy, **{"initial": start, **settings})
    if estimate:
        (found,) = estimates.assess([built], [found], accuracy)
    numbers = {name: np.concatenate([getattr(each, name) for each in found.buildings]) for name in FLOORS}
    numbers |= {name: np.array([getattr(each, name) for each in found.buildings]) for name in ("sway", "rocking")}
    numbers |= {name: getattr(found.links, name) for name in LINKS}
    numbers |= {name: getattr(found.columns, name) for name in ("shear_below", "shear_above", "demand")}
    if found.peaks.dtype.names and "twist" in found.peaks.dtype.names:
        numbers |= {f"line_{name}": _flat([getattr(each, name) for each in found.lines]) for name in LINES}
        numbers |= {name: np.concatenate([getattr(each, name) for each in found.turns]) for name in TURNS}
        numbers["end_twist"], numbers["end_twist_rate"] = map(np.concatenate, zip(*found.final_turns, strict=True))
    numbers["end"], numbers["end_velocity"] = (np.concatenate(each) for each in zip(*found.final, strict=True))
    place = found.collapse_building, found.collapse_storey
    return Run(
        found.status, found.advice, numbers, found.energy, found.steps, found.events, found.seconds,
        found.collapse_time, place, found.error_estimate, tuple(map(str, found.flags)), found.effects,
    )  # fmt: skip


def solve_scene(scene: pound.Scene, accuracy: float = 1e-6, **settings: Any) -> pound.Response:
    """Return the response of a scene, with its numbers by building."""
    return solver.solve(scene, accuracy, **settings)


def solve_whole(scene: Scene, accuracy: float = 1e-6) -> pound.Response:
    """Return the response of a scene that is solved as one, though nothing may touch in it."""
    run = solver.prepare_run([scene.built], accuracy)
    run.integrate()
    return run.build_responses()[0]


def events_until_stalled(elements: int, part: float, most: int) -> int:
    """Count the events, each at this part of its step, after which a run of so many elements has stalled; `most` where
    it has not after as many."""
    from pounding_cli.solver import records
    from pounding_cli.solver.run import count_step

    run = np.zeros(1, records.RUN).view(np.recarray)[0]
    run.m, run.end, run.status, run.most_steps, run.most_events = elements, part, records.DONE, most, most
    for count in range(1, most):
        count_step.py_func(run, True)
        if run.status == records.STALLED:
            return count
    return most


def _flat(arrays: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate([array.ravel() for array in arrays])


def difference(one: Any, other: Any, names: Sequence[str] = (*FLOORS[:6], *LINKS[:4])) -> float:
    """Largest difference of two runs, over the largest of its kind in the scene [-]; inf where the outcomes differ. A
    number below 1e-8 of the scene's largest length or force counts as zero, and the contact time of a link that presses
    by rounding, by 1e-10 of the largest force."""
    if getattr(one, "status", "done") != getattr(other, "status", "done"):
        return float("inf")
    worst = 0.0
    for name in names:
        a, b = (np.asarray(getattr(each, name), dtype=float) for each in (one, other))
        if name == "contact_time" and hasattr(one, "peak_force"):
            least = 1e-10 * max(_largest(each, kind) for each in (one, other) for kind in FORCES)
            presses = np.maximum(one.peak_force, other.peak_force) > least
            a, b = np.where(presses, a, 0.0), np.where(presses, b, 0.0)
        alike = LENGTHS if name in LENGTHS else FORCES if name in (*FORCES, "impulse") else ()
        nothing = 1e-8 * max((_largest(each, kind) for each in (one, other) for kind in alike), default=0.0)
        if name == "impulse":
            nothing *= max(_largest(each, "contact_time") for each in (one, other))
        size = max(np.abs(a).max(initial=0.0), np.abs(b).max(initial=0.0))
        worst = max(worst, float(np.abs(a - b).max(initial=0.0) / size) if size > nothing else 0.0)
    return worst


def _largest(run: Any, name: str) -> float:
    """Return the largest absolute value of a number of a run, 0 where there is none."""
    return float(np.fmax.reduce(np.abs(np.asarray(getattr(run, name, ()), dtype=float)).ravel(), initial=0.0))


def scenes(study: Path) -> Iterator[tuple[str, pound.Scene, float]]:
    """Every scene of a study once, baselines too: its place in words, the scene, the accuracy asked."""
    plan = make_plan(load_study(study))
    rows, columns = plan.first
    for number, scene in enumerate(plan.scenes(np.arange(len(plan)))):
        row = plan.row(int(rows[number]))
        where = f"{row.case}, alone" if columns[number] else f"{row.case}, {row.analysis} {row.point or ''}".strip()
        yield where, scene, plan.accuracy


def refused(study: str | Mapping[str, Any]) -> list[tuple[int, int, str]]:
    """Line, column (0 of a mapping) and words of every problem that `pound check` finds; [] if none."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "study.yaml")
        try:
            if isinstance(study, Mapping):
                pound.load_study(study)
            else:
                path.write_text(study, encoding="utf-8")
                CliRunner().invoke(cli, ["check", str(path)], standalone_mode=False, catch_exceptions=False)
        except pound.InputError as error:
            return [(each.line, each.column, str(each)) for each in error.issues]
    return []


def system(command: str, study: Path) -> xr.Dataset:
    """What `pound wall` or `pound connector` finds, without its figures."""
    sweep = points.load_sweep(study, command)
    return points.build_dataset(
        replace(sweep, points=tuple(points.solve_point(sweep, point) for point in sweep.points))
    )
