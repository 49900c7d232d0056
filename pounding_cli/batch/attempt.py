"""One scene, solved or reported: whatever goes wrong in it stays in it."""

from __future__ import annotations

import dataclasses
import math
import threading
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
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

ERRORS = 10.0
"""By so many accuracies of the floors' own displacements a gap must stay open to count as never closed."""

MEMORY = 256
"""Scenes whose gaps never closed that are kept for those that follow."""


@dataclass(frozen=True)
class Task:
    """How the scenes of a plan are solved; workers have a copy of it.

    estimate : which scenes are assessed: none, sample or all; alone, those of buildings with nothing beside them
    all_effects : run scenes too whose gaps are known not to close
    time_step : of a method that takes one [s]
    harder : solve a scene that fails once more, a hundred times as finely
    """

    accuracy: float
    method: str
    estimate: str = "none"
    all_effects: bool = False
    time_step: float | None = None
    harder: bool = False

    def rows(self, scenes: Sequence[Scene], halted: Callable[[], bool] = lambda: False) -> list[Row]:
        """The responses of scenes as rows, in their order; only the first of them where it is `halted`."""
        found = []
        for scene in scenes:
            found.append(encode(self(scene)))
            if halted():
                break
        return found

    def __call__(self, scene: Scene) -> Response:
        """The response; an exception becomes a failed response that names it."""
        response = self._caught(scene)
        if self.harder and response.status != DONE:
            step = None if self.time_step is None else self.time_step * HARDER
            second = dataclasses.replace(self, accuracy=self.accuracy * HARDER, time_step=step, harder=False)(scene)
            if second.status == DONE:
                note = f"solved once more, {1 / HARDER:g} times as finely: {response.status}"
                seconds = response.seconds + second.seconds
                response = dataclasses.replace(second, flags=(*second.flags, note), seconds=seconds)
        return response

    def is_assessed(self, scene: Scene) -> bool:
        """Whether error and sensitivity of this scene are asked for; a sample is one scene in eight, the same ones in
        every run."""
        if self.estimate == "alone":
            return not scene.links
        return self.estimate == "all" or (self.estimate == "sample" and scene.digest[0] in "01")

    def without(self, scene: Scene, status: str, advice: str) -> Response:
        """The response of a scene that gave none."""
        buildings, links, columns = nothing([building.storeys for building in scene.buildings], len(scene.links), 0)
        accuracy, step = (self.accuracy, math.nan) if self.time_step is None else (math.nan, self.time_step)
        return Response(
            buildings, links, status, advice, self.method, accuracy, 0, 0, 0.0, time_step=step, columns=columns
        )

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
        """The response of a scene, from one with narrower gaps where that is known."""
        memory = _memory(self) if self.time_step is None and not self.all_effects else None
        response = memory.answer(scene, self.accuracy) if memory else None
        if response is None:
            response = self._run(scene)
            if memory:
                response = memory.of_open(scene, response)
        return _with_open_gaps(scene, response)

    def _run(self, scene: Scene) -> Response:
        told: dict[str, Any] = {} if self.time_step is None else {"time_step": self.time_step}
        response = solver.solve(scene, accuracy=self.accuracy, method=self.method, **told)
        return assess(scene, response, self.accuracy, solver.solve) if self.is_assessed(scene) else response


@lru_cache(maxsize=1)
def _memory(task: Task) -> NeverClosed:
    """One memory in every process, for the task at hand."""
    return NeverClosed(task._run)


class NeverClosed:
    """Neighbours with nothing between them: their response is that of every scene whose gaps never close, since no
    force crosses those. It is solved once a scene was seen to stay open, and answers all that do without a run of their
    own, whatever came first. Threads may share it."""

    def __init__(self, run: Callable[[Scene], Response]) -> None:
        self._run = run
        self._kept: OrderedDict[tuple[Any, ...], Response] = OrderedDict()
        self._lock = threading.Lock()

    def answer(self, scene: Scene, accuracy: float) -> Response | None:
        """The response of a scene whose gaps are known not to close, or None."""
        with self._lock:
            known = self._kept.get(_key(scene)) if _may_stay_open(scene) else None
        if known is None:
            return None
        found = _of_scene(scene, known)
        furthest = (max(b.displacement_max.max(), -b.displacement_min.min()) for b in known.buildings)
        closes_to = found.links.max_closing + ERRORS * accuracy * float(max(furthest))
        return dataclasses.replace(found, seconds=0.0) if np.all(_gaps(scene) > closes_to) else None

    def of_open(self, scene: Scene, response: Response) -> Response:
        """The response of a scene after its run: where no gap closed that of the neighbours with nothing between."""
        if response.status != DONE or not _may_stay_open(scene) or response.links.impacts.any():
            return response
        key = _key(scene)
        with self._lock:
            known = self._kept.get(key)
        if known is None:
            known = self._run(dataclasses.replace(scene, links=tuple(_apart(scene))))
            with self._lock:
                self._kept[key] = known
                while len(self._kept) > MEMORY:
                    self._kept.popitem(last=False)
        return _of_scene(scene, known) if known.status == DONE else response


def _may_stay_open(scene: Scene) -> bool:
    """Whether all links of a scene act across a gap alone, and none asks for the shears of columns."""
    return bool(scene.links) and not any(link.law.joins or link.columns for link in scene.links)


def _apart(scene: Scene) -> dict[Link, int]:
    """Nothing between the floors that links of a scene join, with its place among them."""
    links = dict.fromkeys(
        Link.apart(link.left, link.left_floor, link.right_floor, link.left_at, link.right_at) for link in scene.links
    )
    return {link: place for place, link in enumerate(links)}


def _of_scene(scene: Scene, apart: Response) -> Response:
    """The response of a scene whose gaps never close, from that of the neighbours with nothing between them."""
    places, effects = _apart(scene), effects_of(scene)
    of_links = [
        places[Link.apart(link.left, link.left_floor, link.right_floor, link.left_at, link.right_at)]
        for link in scene.links
    ]
    none = np.zeros(len(of_links))
    links = LinkResponse(none.astype(np.int64), none, apart.links.max_closing[of_links], none, none)
    return dataclasses.replace(apart, links=links, effects=effects.kept, dropped=effects.dropped)


def _gaps(scene: Scene) -> np.ndarray:
    """The closings [m] below which no link acts, in their order."""
    return np.array([link.law.free_below for link in scene.links])


def _key(scene: Scene) -> tuple[Any, ...]:
    """What scenes share whose links differ in their laws alone."""
    buildings = tuple(building.digest for building in scene.buildings)
    return buildings, tuple(_apart(scene)), scene.motion.digest, scene.analysis, scene.tail


def _with_open_gaps(scene: Scene, response: Response) -> Response:
    """The response of a scene, which says of neighbours whose gap never closed how much of it stays open."""
    if not response.has_result or not _may_stay_open(scene) or response.links.impacts.any():
        return response
    left_open = _gaps(scene) - response.links.max_closing
    said = []
    for place in dict.fromkeys(link.left for link in scene.links):
        least = min(o for o, link in zip(left_open.tolist(), scene.links, strict=True) if link.left == place)
        names = f"{scene.buildings[place].name} | {scene.buildings[place + 1].name}"
        if math.isfinite(least):
            said.append(f"links {names}: {NEVER_CLOSES}, {least * 1000:.3g} mm of it stay open")
    return dataclasses.replace(response, dropped=(*response.dropped, *said))
