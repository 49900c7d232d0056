"""One scene, solved or reported: whatever goes wrong in it stays in it.

Neighbours with nothing between them answer every scene in which no gap closes, since no force crosses those: of scenes
that differ in such gaps alone, one is solved."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.model.effects import DroppedEffect, effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.results.solved import Row, encode
from pounding_cli.solver import solve as solver
from pounding_cli.solver.estimate import assess
from pounding_cli.solver.response import BASES, DONE, LINKS, STOREYS, Flag, Response, no_peaks

HARDER = 0.01
"""Accuracy and time step of a second try over those of the first [-]."""

MEMORY = 4096
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
        return [encode(response) for response in self(scenes)]

    def __call__(self, scenes: Sequence[Scene]) -> list[Response]:
        """The responses, in the order of the scenes; an exception becomes a failed response that names it."""
        responses = self._caught(scenes)
        failed = [number for number, each in enumerate(responses) if each.status != DONE]
        if self.harder and failed:
            step = None if self.time_step is None else self.time_step * HARDER
            finer = replace(self, accuracy=self.accuracy * HARDER, time_step=step, harder=False)
            for number, second in zip(failed, finer([scenes[number] for number in failed]), strict=True):
                first = responses[number]
                if second.status == DONE:
                    again = Flag(f"solved once more, {1 / HARDER:g} times as finely", first.status)
                    flags = (*second.flags, again)
                    responses[number] = replace(second, flags=flags, seconds=first.seconds + second.seconds)
        return responses

    def without(self, scene: Scene, status: str, advice: str) -> Response:
        """The response of a scene that gave none."""
        storeys = tuple(building.storeys for building in scene.buildings)
        accuracy, step = (self.accuracy, math.nan) if self.time_step is None else (math.nan, self.time_step)
        peaks = no_peaks(storeys, len(scene.links))
        return Response(peaks, storeys, status, advice, self.method, accuracy, 0, 0, 0.0, time_step=step)

    def _caught(self, scenes: Sequence[Scene]) -> list[Response]:
        """The responses; where something goes wrong the scenes are solved one by one, so that it stays in its scene."""
        try:
            responses = self._run_or_known(scenes) if self.time_step is None else self._run(scenes)
        except Exception as error:
            if len(scenes) > 1:
                return [self._caught([scene])[0] for scene in scenes]
            if isinstance(error, InputError):  # the method does not run this scene
                problem = error.problems[0]
                return [self.without(scenes[0], f"refused: {problem.message}", problem.hint)]
            advice = "this is an internal error: please report it with the study file"
            return [self.without(scenes[0], f"error: {type(error).__name__}: {error}", advice)]
        for number, scene in enumerate(scenes):
            if _may_stay_open(scene) and (open_gaps := find_open_gaps(scene, responses[number])):
                responses[number] = replace(responses[number], dropped=(*responses[number].dropped, *open_gaps))
        return responses

    def _run(self, scenes: Sequence[Scene]) -> list[Response]:
        responses = solver.solve_all(scenes, self.accuracy, self.method, time_step=self.time_step)
        assessed = [number for number, scene in enumerate(scenes) if self._is_assessed(scene)]
        some = [scenes[number] for number in assessed], [responses[number] for number in assessed]
        for number, response in zip(assessed, assess(*some, self.accuracy), strict=True):
            responses[number] = response
        return responses

    def _is_assessed(self, scene: Scene) -> bool:
        """Whether error and sensitivity of this scene are asked for; a sample is one scene in eight, the same ones in
        every run."""
        if self.estimate == "alone":
            return not scene.links
        return self.estimate == "all" or (self.estimate == "sample" and scene.digest[0] in "01")

    def _run_or_known(self, scenes: Sequence[Scene]) -> list[Response]:
        """The responses of scenes, from those of their neighbours with nothing between them where no gap closes. These
        are run first where scenes share them, otherwise once a scene has shown no contact."""
        memory = _memory(self)
        apart = {number: _apart(scene) for number, scene in enumerate(scenes) if _may_stay_open(scene)}
        shared, found = Counter(each.digest for each in apart.values()), dict[int, Response]()
        known, spent = self._known(each for each in apart.values() if shared[each.digest] > 1 or each.digest in memory)
        for number, other in apart.items():
            response = known.get(other.digest)
            if response is not None and self._stays_apart(scenes[number], other, response):
                found[number] = _answer(scenes[number], other, response)
        rest = [number for number in range(len(scenes)) if number not in found]
        found |= zip(rest, self._run([scenes[number] for number in rest]), strict=True)
        open_ones = [
            number for number in rest
            if number in apart and found[number].status == DONE and not found[number].peaks["impacts"].any()
        ]  # fmt: skip
        more, spent_more = self._known(apart[number] for number in open_ones if apart[number].digest not in known)
        known, spent = known | more, spent | spent_more
        for number in open_ones:
            response = known[apart[number].digest]
            if response.status == DONE and _stays_apart_to_rest(scenes[number], apart[number], response):
                answer = _answer(scenes[number], apart[number], response)
                found[number] = replace(answer, seconds=found[number].seconds)
        for number, other in apart.items():  # of scenes that share a run, the first is told its time
            seconds = found[number].seconds + spent.pop(other.digest, 0.0)
            found[number] = replace(found[number], seconds=seconds)
        return [found[number] for number in range(len(scenes))]

    def _known(self, apart: Iterable[Scene]) -> tuple[dict[str, Response], dict[str, float]]:
        """The responses of neighbours with nothing between them by digest, and the times of those that are run now."""
        memory, wanted = _memory(self), {scene.digest: scene for scene in apart}
        found = {digest: memory.get(digest) for digest in wanted}
        known, spent = {digest: each for digest, each in found.items() if each is not None}, dict[str, float]()
        new = {digest: scene for digest, scene in wanted.items() if digest not in known}
        for digest, response in zip(new, self._run(tuple(new.values())), strict=True):
            known[digest], spent[digest] = replace(response, seconds=0.0), response.seconds
        if len(memory) + len(new) > MEMORY:
            memory.clear()
        memory.update((digest, known[digest]) for digest in new)
        return known, spent

    def _stays_apart(self, scene: Scene, apart: Scene, known: Response) -> bool:
        """Whether no link of a scene acts at the closings with nothing between until its neighbours are at rest, and at
        the most they may be wrong."""
        if known.status != DONE:
            return False
        moved = [known.peaks[name].ravel() for name in ("displacement_max", "displacement_min")]
        furthest = np.nanmax(np.abs(np.concatenate(moved)), initial=0.0)  # a wall that moves with the ground has none
        left_open = _left_open(scene, _closings(scene, apart, known.closing_to_rest))
        return bool(np.all(left_open > ERRORS * self.accuracy * furthest))


@lru_cache(maxsize=1)
def _memory(task: Task) -> dict[str, Response]:
    """Of neighbours with nothing between them by digest, one in every process, for the task at hand; threads share
    it."""
    return {}


def _ends(link: Link) -> Link:
    """Nothing between the ends of a link."""
    return Link.apart(link.left, link.left_floor, link.right_floor, link.left_at, link.right_at)


def _apart(scene: Scene) -> Scene:
    """The neighbours of a scene with nothing between them."""
    return replace(scene, links=tuple(dict.fromkeys(map(_ends, scene.links))))


def _closings(scene: Scene, apart: Scene, known: np.ndarray) -> np.ndarray:
    """Return, for every link of a scene, the largest closing [m] that is `known` of its neighbours with nothing between
    them."""
    return known[[apart.links.index(_ends(link)) for link in scene.links]]


def _stays_apart_to_rest(scene: Scene, apart: Scene, known: Response) -> bool:
    """Return whether no link of a scene acts before its neighbours with nothing between them are at rest: then their
    residual drifts are those of the scene."""
    return bool(np.all(_left_open(scene, _closings(scene, apart, known.closing_to_rest)) > 0.0))


def _answer(scene: Scene, apart: Scene, known: Response) -> Response:
    """The response of a scene, if none of its gaps closes, from that of its neighbours with nothing between them."""
    effects, peaks = effects_of(scene), no_peaks(known.storeys, len(scene.links))
    for name in (*STOREYS, *BASES):
        peaks[name] = known.peaks[name]
    for name in LINKS:
        peaks[name] = 0.0
    peaks["max_closing"] = _closings(scene, apart, known.peaks["max_closing"])
    return replace(known, peaks=peaks, effects=effects.kept, dropped=effects.dropped)


def _may_stay_open(scene: Scene) -> bool:
    """Whether all links of a scene act across a gap alone, and none asks for the shears of columns."""
    return bool(scene.links) and not any(link.law.joins or link.columns for link in scene.links)


def _left_open(scene: Scene, closings: np.ndarray) -> np.ndarray:
    """How much further than these closings every link may close before it acts [m]."""
    return np.array([link.law.free_below for link in scene.links]) - closings


def find_open_gaps(scene: Scene, response: Response) -> list[DroppedEffect]:
    """Return the links of every pair of neighbours that never met, with what stays open of their gap."""
    if not response.has_result:
        return []
    left_open = _left_open(scene, response.peaks["max_closing"])
    impacts = response.peaks["impacts"]
    open_gaps = []
    for place in dict.fromkeys(link.left for link in scene.links):
        own = [number for number, link in enumerate(scene.links) if link.left == place]
        least = float(left_open[own].min())
        if math.isfinite(least) and not impacts[own].any():
            neighbours = f"{scene.buildings[place].name} | {scene.buildings[place + 1].name}"
            open_gaps.append(DroppedEffect.of_open_gap(neighbours, least))
    return open_gaps
