"""A point of a model of its own, solved or reported: whatever goes wrong in it stays in it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.solver.response import PointResponse
from pounding_cli.workflows import WORKFLOWS


@dataclass(frozen=True)
class PointTask:
    """How every point of a workflow with a model of its own is solved: a `bundles.Work`.

    workflow : a key of WORKFLOWS; it says how to `solve`, and the `variables` that are kept
    """

    workflow: str

    @property
    def solver(self) -> str:
        """What solves it, as "module:name"."""
        return WORKFLOWS[self.workflow].solve

    def __call__(self, scene: Any) -> PointResponse:
        """The response; an exception becomes a failed response that names it."""
        workflow, begin = WORKFLOWS[self.workflow], time.thread_time()
        try:
            found = workflow.part("solve")(scene)
        except InputError as refused:
            problem = refused.problems[0]
            return self.without(scene, f"refused: {problem.message}", problem.hint)
        except Exception as error:  # one point must not take the others with it
            advice = "this is an internal error: please report it with the study file"
            return self.without(scene, f"error: {type(error).__name__}: {error}", advice)
        values = {}
        for variable in workflow.part("variables"):
            of = variable.of or variable.name
            whole, field = (scene, of.removeprefix("model.")) if of.startswith("model.") else (found, of)
            values[variable.name] = np.asarray(attrgetter(field)(whole), float)
        return PointResponse(values, flags=getattr(found, "flags", ()), seconds=time.thread_time() - begin)

    def each(
        self, scenes: Sequence[Any], begins: Callable[[int], None], halted: Callable[[], bool]
    ) -> list[PointResponse]:
        """See `bundles.Work`."""
        answers = []
        for place, scene in enumerate(scenes):
            begins(place)
            answers.append(self(scene))
            if halted():
                break
        return answers

    def without(self, scene: Any, status: str, advice: str) -> PointResponse:
        """The response of a point that gave none."""
        return PointResponse({}, status, advice)
