"""One scene, solved or reported: whatever goes wrong in it stays in it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from pounding_cli.batch.open_gaps import NeverClosed, stays_open
from pounding_cli.errors import InputError
from pounding_cli.model.scene import Scene
from pounding_cli.results.solved import Row, encode
from pounding_cli.solver import solve as solver
from pounding_cli.solver.estimate import assess
from pounding_cli.solver.response import DONE, Response, nothing

HARDER = 0.01
"""Accuracy and time step of a second try over those of the first [-]."""


@dataclass(frozen=True)
class Task:
    """How the scenes of a plan are solved; workers have a copy of it.

    estimate : which scenes are assessed: none, sample or all; alone, those of buildings with nothing beside them
    time_step : of a method that takes one [s]
    harder : solve a scene that fails once more, a hundred times as finely
    """

    accuracy: float
    method: str
    estimate: str = "none"
    time_step: float | None = None
    harder: bool = False

    def rows(self, scenes: Sequence[Scene]) -> list[Row]:
        """The responses of scenes as rows, in their order."""
        return [encode(self(scene)) for scene in scenes]

    def __call__(self, scene: Scene) -> Response:
        """The response; an exception becomes a failed response that names it."""
        response = self._caught(scene)
        if self.harder and response.status != DONE:
            step = None if self.time_step is None else self.time_step * HARDER
            second = replace(self, accuracy=self.accuracy * HARDER, time_step=step, harder=False)(scene)
            if second.status == DONE:
                note = f"solved once more, {1 / HARDER:g} times as finely: {response.status}"
                response = replace(second, flags=(*second.flags, note), seconds=response.seconds + second.seconds)
        return response

    def without(self, scene: Scene, status: str, advice: str) -> Response:
        """The response of a scene that gave none."""
        peaks = nothing([building.storeys for building in scene.buildings], len(scene.links))
        accuracy, step = (self.accuracy, math.nan) if self.time_step is None else (math.nan, self.time_step)
        return Response(*peaks, status, advice, self.method, accuracy, 0, 0, 0.0, time_step=step)

    def _caught(self, scene: Scene) -> Response:
        try:
            return self._respond(scene)
        except InputError as refused:  # the method does not run this scene
            problem = refused.problems[0]
            return self.without(scene, f"refused: {problem.message}", problem.hint)
        except Exception as error:  # one scene must not take the others with it
            advice = "this is an internal error: please report it with the study file"
            return self.without(scene, f"error: {type(error).__name__}: {error}", advice)

    def _respond(self, scene: Scene) -> Response:
        """The response of a scene, from neighbours with nothing between them where no gap closes."""
        response = _run_or_known(self)(scene) if self.time_step is None else self._run(scene)
        return replace(response, dropped=(*response.dropped, *stays_open(scene, response)))

    def _run(self, scene: Scene) -> Response:
        told: dict[str, Any] = {} if self.time_step is None else {"time_step": self.time_step}
        response = solver.solve(scene, accuracy=self.accuracy, method=self.method, **told)
        return assess(scene, response, self.accuracy, solver.solve) if self._is_assessed(scene) else response

    def _is_assessed(self, scene: Scene) -> bool:
        """Whether error and sensitivity of this scene are asked for; a sample is one scene in eight, the same ones in
        every run."""
        if self.estimate == "alone":
            return not scene.links
        return self.estimate == "all" or (self.estimate == "sample" and scene.digest[0] in "01")


@lru_cache(maxsize=1)
def _run_or_known(task: Task) -> NeverClosed:
    """One memory in every process, for the task at hand."""
    return NeverClosed(task._run, task.accuracy)
