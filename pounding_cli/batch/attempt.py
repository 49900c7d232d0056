"""One scene, solved or reported: whatever goes wrong in it stays in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pounding_cli.errors import InputError
from pounding_cli.model.scene import Scene
from pounding_cli.solve.assess import assess
from pounding_cli.solve.response import Response
from pounding_cli.store.codec import failed

Solve = Callable[..., Response]
"""solve(scene, accuracy=..., method=...) -> Response"""


@dataclass(frozen=True)
class Task:
    """How every scene of a run is solved; goes to the workers once."""

    solve: Solve
    accuracy: float
    method: str
    estimate: str = "none"

    def __call__(self, scene: Scene) -> Response:
        """The response; an exception becomes a failed response that names it."""
        try:
            response = self.solve(scene, accuracy=self.accuracy, method=self.method)
            return assess(scene, response, self.accuracy, self.solve) if self._is_assessed(scene) else response
        except InputError as refused:  # the method does not run this scene
            problem = refused.problems[0]
            return self.without(scene, f"refused: {problem.message}", problem.hint)
        except Exception as error:  # one scene must not take the others with it
            advice = "this is a fault of the program: please report it with the study file"
            return self.without(scene, f"error: {type(error).__name__}: {error}", advice)

    def _is_assessed(self, scene: Scene) -> bool:
        """Whether this scene is solved twice more; a sample is one scene in eight, the same ones in every run."""
        return self.estimate == "all" or (self.estimate == "sample" and scene.digest[0] in "01")

    def without(self, scene: Scene, status: str, advice: str) -> Response:
        """The response of a scene that gave none."""
        storeys = [building.storeys for building in scene.buildings]
        return failed(storeys, len(scene.links), status, advice, self.method, self.accuracy)
