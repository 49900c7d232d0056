"""One scene, solved or reported: whatever goes wrong in it stays in it.

Neighbours with nothing between them answer every scene in which no gap closes, since no force crosses those: of scenes
that differ in such gaps alone, one is solved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.results.solved import Row, encode
from pounding_cli.solver import solve as solver
from pounding_cli.solver.estimate import assess
from pounding_cli.solver.response import DONE, NEVER_CLOSES, LinkResponse, Response, nothing

HARDER = 0.01
"""Accuracy and time step of a second try over those of the first [-]."""

MEMORY = 256
"""Responses of neighbours with nothing between them that are kept."""

ERRORS = 10.0
"""By how many times its accuracy a closing may be wrong at most [-]."""


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
            if not _may_stay_open(scene):
                return self._run(scene)
            response = self._run(scene) if self.time_step is not None else self._run_or_known(scene)
            return replace(response, dropped=(*response.dropped, *_stays_open(scene, response)))
        except InputError as refused:  # the method does not run this scene
            problem = refused.problems[0]
            return self.without(scene, f"refused: {problem.message}", problem.hint)
        except Exception as error:  # one scene must not take the others with it
            advice = "this is an internal error: please report it with the study file"
            return self.without(scene, f"error: {type(error).__name__}: {error}", advice)

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

    def _run_or_known(self, scene: Scene) -> Response:
        """The response of a scene, from that of the neighbours with nothing between them where no gap closes, whether
        this is known before or seen by a run: the same numbers whatever came first."""
        apart = [Link.apart(*(getattr(link, name) for name in _ENDS)) for link in scene.links]
        links = tuple(dict.fromkeys(apart))
        numbers, memory = [links.index(link) for link in apart], _memory(self)
        key = tuple(each.digest for each in scene.buildings), links, scene.motion.digest, scene.analysis, scene.tail
        if (known := memory.get(key)) and self._stays_apart(scene, known, numbers):
            return _of_scene(scene, replace(known, seconds=0.0), numbers)
        response = self._run(scene)
        if response.status != DONE or response.links.impacts.any():
            return response
        known = known or self._run(replace(scene, links=links))
        if known.status != DONE:
            return response
        if len(memory) >= MEMORY:
            memory.clear()
        memory[key] = known
        return _of_scene(scene, known, numbers)

    def _stays_apart(self, scene: Scene, known: Response, numbers: list[int]) -> bool:
        """Whether no link of a scene acts at the closings with nothing between, and at the most they may be wrong."""
        moved = [each for b in known.buildings for each in (b.displacement_max, b.displacement_min)]
        furthest = np.nanmax(np.abs(np.concatenate(moved)), initial=0.0)  # a wall that moves with the ground has none
        return bool(np.all(_left_open(scene, known.links.max_closing[numbers]) > ERRORS * self.accuracy * furthest))


_ENDS = ("left", "left_floor", "right_floor", "left_at", "right_at")


@lru_cache(maxsize=1)
def _memory(task: Task) -> dict[object, Response]:
    """Of neighbours with nothing between them, one in every process, for the task at hand; threads share it."""
    return {}


def _may_stay_open(scene: Scene) -> bool:
    """Whether all links of a scene act across a gap alone, and none asks for the shears of columns."""
    return bool(scene.links) and not any(link.law.joins or link.columns for link in scene.links)


def _left_open(scene: Scene, closings: np.ndarray) -> np.ndarray:
    """How much further than these closings every link may close before it acts [m]."""
    return np.array([link.law.free_below for link in scene.links]) - closings


def _stays_open(scene: Scene, response: Response) -> list[str]:
    """In words how much of their gap stays open between neighbours, where none of them closed."""
    if not response.has_result or response.links.impacts.any():
        return []
    left_open, said = _left_open(scene, response.links.max_closing), []
    for place in dict.fromkeys(link.left for link in scene.links):
        least = min(width for width, link in zip(left_open.tolist(), scene.links, strict=True) if link.left == place)
        if math.isfinite(least):
            names = f"{scene.buildings[place].name} | {scene.buildings[place + 1].name}"
            said.append(f"links {names}: {NEVER_CLOSES}, {least * 1000:.3g} mm of it stay open")
    return said


def _of_scene(scene: Scene, apart: Response, numbers: list[int]) -> Response:
    """The response of a scene whose gaps never close, from that of the neighbours with nothing between them.

    numbers : of every link that of the place of its ends there
    """
    effects, none = effects_of(scene), np.zeros(len(numbers))
    links = LinkResponse(none.astype(np.int64), none, apart.links.max_closing[numbers], none, none)
    return replace(apart, links=links, effects=effects.kept, dropped=effects.dropped)
