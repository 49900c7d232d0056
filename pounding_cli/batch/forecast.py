"""What a plan will do before it does it: which scenes run, which effects they call for, and what that costs."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.batch.solve import BESIDE
from pounding_cli.errors import InputError
from pounding_cli.model.effects import DroppedEffect, effects_of

if TYPE_CHECKING:
    from pounding_cli.model.scene import Scene
    from pounding_cli.study.plan import Plan

MOST_SCENES = 2000
"""Scenes whose effects are looked at; of more, as many spread evenly, each for as many as it stands for."""

START = 1.0
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


def expected(plan: Plan) -> tuple[float, int]:
    """The time that a run of scenes takes on one core [s], from one scene of each kind (case or building, analysis,
    motion) that is solved for it; how many were."""
    rows, columns = plan.first
    *_, case, analysis, motion = np.unravel_index(rows, plan.shape)
    kinds = np.stack([np.where(columns > 0, -columns, case), analysis, motion])
    _, first, kind = np.unique(kinds, axis=1, return_index=True, return_inverse=True)
    seconds = np.array([_timed(plan, scene) for scene in plan.scenes(first)])[kind.ravel()]
    return START + float((RUNS[plan.estimate] * seconds + BESIDE).sum()), len(first)


def _timed(plan: Plan, scene: Scene) -> float:
    """The time that a scene takes [s]; nothing where it is refused."""
    from pounding_cli.solver.solve import solve

    told: dict[str, Any] = {} if plan.time_step is None else {"time_step": plan.time_step}
    try:
        return solve(scene, plan.accuracy, plan.method, **told).seconds
    except InputError:
        return 0.0
