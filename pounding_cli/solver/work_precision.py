"""What accuracy costs: error and time of every method at every setting on given scenes.

Errors are against Taylor with events at `REFERENCE`, which a second located method confirms; the difference of the two
is measured and kept, because no error below it means anything."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.methods import METHODS
from pounding_cli.model.scene import Scene
from pounding_cli.numbers import counted
from pounding_cli.solver.response import Response
from pounding_cli.solver.solve import refusal_of, solve

QUANTITIES = ("V", "mu", "acceleration", "force")
"""Peak storey shear, peak ductility, peak floor acceleration, peak link force."""

REFERENCE = ("taylor", 1e-12)
SECOND = ("dop853", 1e-11)
"""Methods and settings of the reference and of what confirms it."""

MAX_REPEATS, REPEATED = 20, 0.1
"""A run is repeated up to so often, or until its repeats took so long [s] together; the least counts."""

WARM_UP = 3
"""Samples of the motion that a method sees before it is timed, so that compiling is not."""


@dataclass(frozen=True)
class Subject:
    """A scene and its place in the study."""

    case: str
    analysis: str
    record: str
    scene: Scene

    @property
    def place(self) -> str:
        """Where it stands, in words."""
        return f"{self.case}, {self.analysis}, {self.record}"


@dataclass(frozen=True)
class Run:
    """One method at one setting on one scene.

    seconds : inside the solver, least of the repeats [s]
    errors : by QUANTITIES, largest over storeys, floors or links, relative [-]; nan when the run did not end
    impacts, expected : impacts counted in all, and those of the reference
    residual : energy missing over the largest entry of the ledger [-]; nan where the method keeps none
    """

    case: str
    analysis: str
    record: str
    method: str
    setting: float
    status: str
    advice: str
    seconds: float
    steps: int
    events: int
    errors: dict[str, float]
    impacts: int
    expected: int
    residual: float


@dataclass(frozen=True)
class Confirmed:
    """A scene's reference: difference of two methods by QUANTITIES [-], and of their counts of impacts."""

    case: str
    analysis: str
    record: str
    differences: dict[str, float]
    impacts: int


@dataclass(frozen=True)
class WorkPrecision:
    """All runs on all scenes.

    left_out : what the budget did not allow, method by method
    without_reference : scenes that no error could be told of, each with the reason
    spent, compiling : wall time of the runs, and of compiling before them [s]
    """

    runs: tuple[Run, ...]
    references: tuple[Confirmed, ...]
    left_out: tuple[str, ...]
    without_reference: tuple[str, ...] = ()
    spent: float = 0.0
    compiling: float = 0.0


def errors_of(found: Response, reference: Response) -> dict[str, float]:
    """Largest relative errors by QUANTITIES [-]; forces are relative to the scene's largest."""
    worst = dict.fromkeys(QUANTITIES, 0.0)
    fields = {"V": "shear", "mu": "ductility", "acceleration": "acceleration"}
    for mine, theirs in zip(found.buildings, reference.buildings, strict=True):
        for quantity, field in fields.items():
            x, y = getattr(mine, field), getattr(theirs, field)
            moving = y != 0
            if moving.any():
                worst[quantity] = max(worst[quantity], float(np.max(np.abs(x[moving] / y[moving] - 1))))
    force = reference.links.peak_force
    if force.size and force.max() > 0:
        worst["force"] = float(np.max(np.abs(found.links.peak_force - force)) / force.max())
    return worst


def chosen(names: Sequence[str]) -> tuple[str, ...]:
    """Methods by name, all of them when none is named.

    Raises
    ------
    InputError : a name that is no method
    """
    unknown = [name for name in names if name not in METHODS]
    if unknown:
        hint = f"write one of {', '.join(METHODS)}"
        raise InputError([Problem(f"there is no method {name}", hint) for name in unknown])
    return tuple(dict.fromkeys(names)) or tuple(METHODS)


def _solved(scene: Scene, name: str, setting: float) -> Response:
    """The response by a method at a value of its setting."""
    told = {METHODS[name].setting.key: setting}
    return solve(scene, method=name, **told)  # type: ignore[arg-type]


def measure(
    subjects: Sequence[Subject],
    methods: Sequence[str],
    budget: float,
    tell: Callable[[str], None] = lambda text: None,
) -> WorkPrecision:
    """Run every method at every setting on as many scenes as the budget [s] allows.

    Every case and analysis gets one motion first, then the next motion; each scene gets an even share of the time left.
    Of each method the settings are tried from coarse to fine as long as its share lasts. The budget is wall time, in
    which compiling does not count; the first scene gets its reference and one run of every method whatever they take.
    """
    runs: list[Run] = []
    references: list[Confirmed] = []
    without: list[str] = []
    dropped: dict[tuple[str, float], int] = {}
    records = list(dict.fromkeys(subject.record for subject in subjects))
    order = sorted(subjects, key=lambda subject: records.index(subject.record))
    begin, compiling, dearest, measured = time.perf_counter(), 0.0, 0.0, 0
    for place, subject in enumerate(order):
        left = budget - (time.perf_counter() - begin - compiling)
        if place and left <= dearest:
            break
        measured += 1
        tell(subject.place)
        started = time.perf_counter()
        _warm_up(subject.scene, {*methods, REFERENCE[0], SECOND[0]})
        compiling += time.perf_counter() - started
        started = time.perf_counter()
        reference, second = _solved(subject.scene, *REFERENCE), _solved(subject.scene, *SECOND)
        taken = time.perf_counter() - started
        dearest = max(dearest, taken)
        if reference.status != "done" or second.status != "done":
            without.append(f"{subject.place}: {reference.status} and {second.status}")
            continue
        impacts = int(np.abs(reference.links.impacts - second.links.impacts).sum())
        where = (subject.case, subject.analysis, subject.record)
        references.append(Confirmed(*where, errors_of(second, reference), impacts))
        together = sum(other.record == subject.record for other in order[place:])
        share = (left / together - taken) / len(methods)
        for name in methods:
            if refusal_of(METHODS[name], subject.scene):
                continue
            for setting, run in _settings(subject, name, reference, share, at_least_one=place == 0):
                if run is None:
                    dropped[name, setting] = dropped.get((name, setting), 0) + 1
                else:
                    runs.append(run)
    spent = time.perf_counter() - begin - compiling
    left_out = _left_out(len(order), measured, dropped)
    return WorkPrecision(tuple(runs), tuple(references), tuple(left_out), tuple(without), spent, compiling)


def _left_out(total: int, measured: int, dropped: Mapping[tuple[str, float], int]) -> list[str]:
    """What the budget did not allow, one text for the scenes and one a method."""
    found = [f"{total - measured} of {counted(total, 'scene')}"] if measured < total else []
    for method in dict.fromkeys(name for name, _ in dropped):
        settings = {setting: count for (name, setting), count in dropped.items() if name == method}
        listed = ", ".join(f"{setting:g}" for setting in settings)
        found.append(f"{method} at {listed} on {counted(max(settings.values()), 'scene')}")
    return found


def _warm_up(scene: Scene, methods: set[str]) -> None:
    short = dataclasses.replace(scene, motion=scene.motion.windowed(WARM_UP * scene.motion.dt))
    for name in methods:
        if not refusal_of(METHODS[name], scene):
            _solved(short, name, 1e-4)


def _settings(
    subject: Subject, name: str, reference: Response, allowed: float, at_least_one: bool
) -> Iterator[tuple[float, Run | None]]:
    """Runs of one method from coarse to fine; None for settings that the time allowed [s] does not reach."""
    spent, last, scale = 0.0, 0.0, 1.0
    settings = METHODS[name].setting.tried
    for number, setting in enumerate(settings):
        if number and METHODS[name].takes_step:
            scale = settings[number - 1] / setting
        if spent + last * scale > allowed and not (number == 0 and at_least_one):
            yield setting, None
            continue
        begin = time.perf_counter()
        response = _solved(subject.scene, name, setting)
        last = response.seconds
        seconds = [last]
        repeated = min(REPEATED, (allowed - spent) / len(settings))
        done = response.status == "done"
        while done and len(seconds) < MAX_REPEATS and sum(seconds) + last < repeated:
            seconds.append(_solved(subject.scene, name, setting).seconds)
        spent += time.perf_counter() - begin
        yield setting, Run(
            subject.case, subject.analysis, subject.record, response.method, setting, response.status,
            response.advice, min(seconds), response.steps, response.events,
            errors_of(response, reference) if done else dict.fromkeys(QUANTITIES, float("nan")),
            int(response.links.impacts.sum()), int(reference.links.impacts.sum()),
            response.energy.get("residual", float("nan")),
        )  # fmt: skip
