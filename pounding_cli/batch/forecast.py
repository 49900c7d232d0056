"""What a plan will do before it does it: which scenes run, which effects they call for, and what that costs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.model.effects import DroppedEffect, effects_of
from pounding_cli.solver.assemble import layout_of
from pounding_cli.solver.kernels import is_compiled, kernel_for, read_rates

if TYPE_CHECKING:
    from pounding_cli.model.scene import Scene
    from pounding_cli.study.plan import Plan

MOST_SCENES = 2000
"""Time histories whose effects are looked at; of more, as many spread evenly, each for as many as it stands for."""

BESIDE = 0.2e-3
"""Time that a time history takes outside its kernel [s]."""

TIME_BESIDE_SCENES = 1.0
"""Time of a run besides its scenes [s]: imports, compiled kernels loaded, a file with its summary."""

RUNS = {"none": 1.0, "sample": 1.2, "all": 2.4}
"""Runs of a scene by `estimate`: one whose error and sensitivity are asked for is run again, more finely."""


@dataclass
class Forecast:
    """What will run.

    scenes : "of a building alone" or "of the group" -> number of scenes
    kept : effect -> scenes of the group with it; dropped : effect with its reason -> scenes of the group without it
    """

    scenes: dict[str, int]
    kept: Counter[str] = field(default_factory=Counter)
    dropped: Counter[DroppedEffect] = field(default_factory=Counter)


def forecast(plan: Plan) -> Forecast:
    """Look at scenes of a plan by number; none is solved."""
    _, columns = plan.first
    group = np.flatnonzero(columns == 0)
    step = max(1, len(group) // MOST_SCENES)
    found = Forecast({"of a building alone": int((columns > 0).sum()), "of the group": len(group)})
    for scene in plan.scenes(group[::step]):
        effects = effects_of(scene)
        found.kept.update(dict.fromkeys(effects.kept, step))
        found.dropped.update(dict.fromkeys(effects.dropped, step))
    return found


# How long it takes


def kinds_and_work(plan: Plan) -> tuple[np.ndarray, np.ndarray]:
    """Return the kind of every time history of a plan and its work, as its rate takes them, both of shape (scenes,).

    Work is the number of floors times the duration [s], or times the number of steps of a method that takes a time
    step. One time history of each case or building, analysis and motion stands for all of them.
    """
    rows, columns = plan.first
    *_, case, analysis, motion = np.unravel_index(rows, plan.shape)
    alike = np.stack([np.where(columns > 0, -columns, case), analysis, motion])
    _, first, group = np.unique(alike, axis=1, return_index=True, return_inverse=True)
    kinds = list[str]()
    work = list[float]()
    for scene in plan.scenes(first):
        kinds.append(_kind_of(plan, scene))
        floors = sum(building.storeys for building in scene.buildings)
        work.append(floors * (scene.motion.duration + scene.tail) / (plan.time_step or 1.0))
    group = group.ravel()
    return np.array(kinds, object)[group], np.array(work)[group]


def _kind_of(plan: Plan, scene: Scene) -> str:
    """Return what time histories of about one rate share: kernel, method, and whether buildings stand alone."""
    kernel = _kernel_of(plan, scene)
    return f"{kernel}, {plan.method}, {'linked' if scene.links else 'alone'}"


def _kernel_of(plan: Plan, scene: Scene) -> str:
    takes_step = plan.time_step is not None
    has_smooth = not takes_step and (plan.method == "dop853" or layout_of(scene).has_smooth)
    return kernel_for(takes_step, has_smooth)


def measure_rates(plan: Plan, numbers: np.ndarray, seconds: np.ndarray) -> dict[str, float]:
    """Return the time for a unit of work by kind, of time histories that were solved.

    numbers : of the time histories
    seconds : time in the solver of all of the plan [s], NaN where it is not known
    """
    every_kind, every_work = kinds_and_work(plan)
    numbers = numbers[np.isfinite(seconds[numbers])]
    kinds = every_kind[numbers]
    rates = {}
    for kind in dict.fromkeys(kinds):
        mine = numbers[kinds == kind]
        if (spent := float(seconds[mine].sum())) > 0:
            rates[kind] = spent / float(every_work[mine].sum())
    return rates


@dataclass(frozen=True)
class Duration:
    """The expected time of a run on one core.

    seconds : with imports and files [s]; None where no run has measured it on this computer
    uncompiled : kernels that the run compiles first
    """

    seconds: float | None
    uncompiled: tuple[str, ...]


def expected_duration(plan: Plan, missing: np.ndarray, count: int, measured: Mapping[str, float]) -> Duration:
    """Return the expected time of solving some time histories; nothing is solved or compiled for it.

    Parameters
    ----------
    missing : numbers of time histories of the plan that stand for those that are to be solved
    count : how many are to be solved
    measured : rates of this study, by kind; others are taken from earlier runs on this computer
    """
    if not count or not missing.size:
        return Duration(TIME_BESIDE_SCENES, ())
    kinds, work = kinds_and_work(plan)
    rates = {**read_rates(), **measured}
    needed = {kind.partition(",")[0] for kind in kinds[missing]}
    uncompiled = tuple(sorted(kernel for kernel in needed if not is_compiled(kernel)))
    if uncompiled or not set(kinds[missing]) <= rates.keys():
        return Duration(None, uncompiled)
    each = [RUNS[plan.estimate] * rates[kinds[number]] * work[number] + BESIDE for number in missing]
    return Duration(TIME_BESIDE_SCENES + count * float(np.mean(each)), ())
