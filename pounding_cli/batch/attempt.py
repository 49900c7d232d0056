"""One scene, solved or reported: whatever goes wrong in it stays in it."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

from pounding_cli.errors import InputError
from pounding_cli.model.scene import Scene
from pounding_cli.solve.assess import assess
from pounding_cli.solve.groups import GroupSolver
from pounding_cli.solve.response import Response
from pounding_cli.store.codec import failed

Solve = Callable[..., Response]
"""solve(scene, accuracy=..., method=..., all_effects=..., watch=...) -> Response; with time_step=... where the
study has one."""


@dataclass(frozen=True)
class Task:
    """How every scene of a run is solved; goes to the workers once.

    all_effects : simulate what cannot matter too, and every row of buildings whole
    time_step : of a method that takes one [s]
    """

    solve: Solve
    accuracy: float
    method: str
    estimate: str = "none"
    all_effects: bool = False
    time_step: float | None = None

    def __call__(self, scene: Scene) -> Response:
        """The response; an exception becomes a failed response that names it."""
        try:
            return _group_solver(self)(scene) if self.falls_apart() else self.respond(scene, False)
        except InputError as refused:  # the method does not run this scene
            problem = refused.problems[0]
            return self.without(scene, f"refused: {problem.message}", problem.hint)
        except Exception as error:  # one scene must not take the others with it
            advice = "this is a fault of the program: please report it with the study file"
            return self.without(scene, f"error: {type(error).__name__}: {error}", advice)

    def respond(self, scene: Scene, watch: bool) -> Response:
        """The response of the scene as a whole, assessed where the study asks for that."""
        told = {} if self.time_step is None else {"time_step": self.time_step}
        response = self.solve(
            scene, accuracy=self.accuracy, method=self.method, all_effects=self.all_effects, watch=watch, **told
        )
        if not self.is_assessed(scene):
            return response
        return assess(scene, response, self.accuracy, self.solve, self.all_effects)

    def free(self, scene: Scene, accuracy: float) -> Response:
        """The response of neighbours with nothing between them."""
        return self.solve(scene, accuracy=accuracy, method=self.method)

    def falls_apart(self) -> bool:
        """Whether scenes may be solved in groups: a user of fixed steps wants those steps in every scene."""
        return not self.all_effects and self.time_step is None

    def is_assessed(self, scene: Scene) -> bool:
        """Whether this scene is solved twice more; a sample is one scene in eight, the same ones in every run."""
        return self.estimate == "all" or (self.estimate == "sample" and scene.digest[0] in "01")

    def without(self, scene: Scene, status: str, advice: str) -> Response:
        """The response of a scene that gave none."""
        storeys = [building.storeys for building in scene.buildings]
        asked = (self.accuracy, math.nan) if self.time_step is None else (math.nan, self.time_step)
        return failed(storeys, len(scene.links), status, advice, self.method, *asked)


@functools.lru_cache(maxsize=1)
def _group_solver(task: Task) -> GroupSolver:
    """One memory of groups in every process, for the task at hand."""
    return GroupSolver(task.respond, task.free, task.accuracy, task.is_assessed)
