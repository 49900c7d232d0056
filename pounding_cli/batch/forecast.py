"""Forecast what a plan will do before it runs: which scenes, which effects they call for, and how long that takes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.model.effects import NOTHING_ECCENTRIC, TWIST_OF_FLOORS, DroppedEffect, effects_of
from pounding_cli.solver.kernels import find_kernel, is_compiled, read_rates
from pounding_cli.solver.layout import build_layout

if TYPE_CHECKING:
    from pounding_cli.model.scene import Scene
    from pounding_cli.study.run_plan import Plan

MAX_VIEWED_SCENES = 2000
"""Largest number of time histories whose effects are looked at; each of them stands for as many as there are more."""

HISTORY_OVERHEAD = 0.2e-3
"""Time that a time history takes outside its kernel [s]."""

RUN_OVERHEAD = 1.0
"""Time of a run besides its scenes [s]: imports, compiled kernels loaded, a file with its summary."""

SOLUTIONS_BY_ESTIMATE = {"none": 1.0, "sample": 1.2, "all": 2.4}
"""Solutions of a scene by `estimate`: one whose error and sensitivity are estimated is solved again, more finely."""


@dataclass
class Forecast:
    """Scenes that will run, and the effects that they call for.

    scenes : "of a building alone" or "of the group" -> number of scenes
    kept : effect -> scenes of the group with it
    dropped : effect with its reason -> scenes of the group without it
    """

    scenes: dict[str, int]
    kept: Counter[str] = field(default_factory=Counter)
    dropped: Counter[DroppedEffect] = field(default_factory=Counter)


def build_forecast(plan: Plan) -> Forecast:
    """Return what a run of a plan will do; nothing is solved."""
    _, columns = plan.first
    group = np.flatnonzero(columns == 0)
    step = max(1, len(group) // MAX_VIEWED_SCENES)
    forecast = Forecast({"of a building alone": int((columns > 0).sum()), "of the group": len(group)})
    has_plans = plan.study.has_plans
    for scene in plan.scenes(group[::step]):
        effects = effects_of(scene)
        forecast.kept.update(dict.fromkeys(effects.kept, step))
        forecast.dropped.update(dict.fromkeys(effects.dropped, step))
        if has_plans and TWIST_OF_FLOORS not in effects.kept:
            forecast.dropped[DroppedEffect(TWIST_OF_FLOORS, NOTHING_ECCENTRIC)] += step
    return forecast


# How long it takes


def classify_histories(plan: Plan) -> tuple[np.ndarray, np.ndarray]:
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
        kinds.append(_format_kind(plan, scene))
        floors = sum(building.storeys for building in scene.buildings)
        work.append(floors * (scene.motion.duration + scene.tail) / (plan.time_step or 1.0))
    group = group.ravel()
    return np.array(kinds, object)[group], np.array(work)[group]


def _format_kind(plan: Plan, scene: Scene) -> str:
    """Return what time histories of about one rate share: kernel, method, and whether buildings stand alone."""
    kernel = select_kernel(plan.method, plan.time_step, scene)
    return f"{kernel}, {plan.method}, {'linked' if scene.links else 'alone'}"


def select_kernel(method: str, time_step: float | None, scene: Scene) -> str:
    """Return the name of the kernel that solves a scene by a method."""
    takes_step = time_step is not None
    has_smooth = not takes_step and (method == "dop853" or build_layout(scene).has_smooth)
    return find_kernel(takes_step, has_smooth)


def measure_rates(plan: Plan, numbers: np.ndarray, seconds: np.ndarray) -> dict[str, float]:
    """Return the time for a unit of work by kind, of time histories that were solved.

    Parameters
    ----------
    numbers : of the time histories
    seconds : time in the solver of all of the plan [s], NaN where it is not known
    """
    all_kinds, all_work = classify_histories(plan)
    numbers = numbers[np.isfinite(seconds[numbers])]
    kinds = all_kinds[numbers]
    rates = {}
    for kind in dict.fromkeys(kinds):
        of_kind = numbers[kinds == kind]
        total = float(seconds[of_kind].sum())
        if total > 0:
            rates[kind] = total / float(all_work[of_kind].sum())
    return rates


@dataclass(frozen=True)
class RunDuration:
    """The expected time of a run on one core.

    seconds : with imports and files [s]; None where no run has measured it on this computer
    uncompiled : kernels that the run compiles first
    """

    seconds: float | None
    uncompiled: tuple[str, ...]


def estimate_duration(plan: Plan, missing: np.ndarray, count: int, measured: Mapping[str, float]) -> RunDuration:
    """Return the expected time of solving some time histories; nothing is solved or compiled for it.

    Parameters
    ----------
    missing : numbers of time histories of the plan that stand for those that are to be solved
    count : how many are to be solved
    measured : rates of this study, by kind; others are taken from earlier runs on this computer
    """
    if not count or not missing.size:
        return RunDuration(RUN_OVERHEAD, ())
    kinds, work = classify_histories(plan)
    rates = {**read_rates(), **measured}
    needed = {kind.partition(",")[0] for kind in kinds[missing]}
    uncompiled = tuple(sorted(kernel for kernel in needed if not is_compiled(kernel)))
    if uncompiled or not set(kinds[missing]) <= rates.keys():
        return RunDuration(None, uncompiled)
    solutions = SOLUTIONS_BY_ESTIMATE[plan.estimate]
    seconds = [solutions * rates[kinds[number]] * work[number] + HISTORY_OVERHEAD for number in missing]
    return RunDuration(RUN_OVERHEAD + count * float(np.mean(seconds)), ())
