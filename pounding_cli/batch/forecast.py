"""What a plan will do before it does it: which scenes run, which effects they call for, and what that costs."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.batch.solve import BESIDE
from pounding_cli.errors import InputError
from pounding_cli.model.effects import effects_of

if TYPE_CHECKING:
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

    scenes, seconds : "of a building alone", "of the group" -> number of scenes, and their expected time on one core [s]
    timed : scenes that were run to see how long they take
    kept : effect -> scenes of the group with it; dropped: effect and reason -> scenes of the group without it
    """

    scenes: dict[str, int]
    seconds: dict[str, float]
    timed: int
    kept: Counter[str] = field(default_factory=Counter)
    dropped: Counter[str] = field(default_factory=Counter)

    @property
    def total(self) -> float:
        """Expected time of the scenes on one core [s]."""
        return sum(self.seconds.values())


def forecast(plan: Plan, numbers: np.ndarray) -> Forecast:
    """Look at scenes of a plan by number, and run one of each kind (case or building, analysis, motion) to see how long
    it takes."""
    rows, columns = (each[numbers] for each in plan.first)
    *_, case, analysis, motion = np.unravel_index(rows, plan.shape)
    kinds = np.stack([np.where(columns > 0, -columns, case), analysis, motion])
    _, first, kind = np.unique(kinds, axis=1, return_index=True, return_inverse=True)
    timed = np.array([_timed(plan, number) for number in numbers[first]])
    seconds = RUNS[plan.estimate] * timed[kind.ravel()] + BESIDE
    which = {"of a building alone": columns > 0, "of the group": columns == 0}
    scenes = {name: int(mine.sum()) for name, mine in which.items()}
    found = Forecast(scenes, {name: float(seconds[mine].sum()) for name, mine in which.items()}, len(first))
    group = numbers[columns == 0]
    step = max(1, len(group) // MOST_SCENES)
    for scene in plan.scenes(group[::step]):
        effects = effects_of(scene)
        found.kept.update(dict.fromkeys(effects.kept, step))
        found.dropped.update(dict.fromkeys(effects.dropped, step))
    return found


def _timed(plan: Plan, number: int) -> float:
    """The time that a scene takes [s]; nothing where it is refused."""
    from pounding_cli.solver.solve import solve

    told: dict[str, Any] = {} if plan.time_step is None else {"time_step": plan.time_step}
    try:
        return solve(plan.scene(number), plan.accuracy, plan.method, **told).seconds
    except InputError:
        return 0.0
