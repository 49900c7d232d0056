"""Solve groups of scenes; whatever goes wrong in a scene stays in it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from pounding_cli.batch.apart import (
    ApartResponses,
    ApartScene,
    add_open_gaps,
    answer_from_apart,
    build_apart,
    can_stay_open,
    stays_open,
    stays_open_to_rest,
)
from pounding_cli.batch.forecast import select_kernel
from pounding_cli.errors import InputError
from pounding_cli.model.scene import Scene
from pounding_cli.results.responses import Row, encode_response
from pounding_cli.solver import solve as solver
from pounding_cli.solver.estimate import assess
from pounding_cli.solver.response import DONE, Flag, Response, no_peaks

FINER = 0.01
"""Accuracy and time step of a second try over those of the first [-]."""


class Attempt(NamedTuple):
    """A scene that is to be solved.

    apart : its neighbours with nothing between them, whose response is that of the scene where no gap closes; None
        where a link acts without a gap, or the method takes time steps
    """

    scene: Scene
    apart: ApartScene | None


class GroupResult(NamedTuple):
    """The responses of a group of scenes as rows, in the order of the scenes.

    apart_responses : of neighbours with nothing between them that were solved for it, by digest
    """

    rows: list[Row]
    apart_responses: dict[str, Response]


@dataclass(frozen=True)
class Task:
    """Settings by which the scenes of a plan are solved; workers have a copy of it.

    estimate : which scenes are assessed: none, sample or all; alone, those of buildings with nothing beside them
    time_step : of a method that takes one [s]
    retry_failed_finer : solve a scene that fails once more, a hundred times as finely
    """

    accuracy: float
    method: str
    estimate: str = "none"
    time_step: float | None = None
    retry_failed_finer: bool = False

    def list_attempts(self, scenes: Iterable[Scene]) -> list[Attempt]:
        """Return the attempts to solve scenes, in their order."""
        attempts = []
        shared_scenes: dict[str, Scene] = {}  # one object for all that have it, which is sent to a worker once
        for scene in scenes:
            apart = None
            if self.time_step is None and can_stay_open(scene):
                apart = build_apart(scene)
                apart = apart._replace(scene=shared_scenes.setdefault(apart.scene.digest, apart.scene))
            attempts.append(Attempt(scene, apart))
        return attempts

    def run(self, attempts: Sequence[Attempt], known: ApartResponses) -> GroupResult:
        """Return the result of a group of scenes; an exception in one becomes a failed response that names it.

        Parameters
        ----------
        known : responses of neighbours with nothing between them; new ones are added
        """
        group = GroupSolver(self, known)
        responses = group.solve(attempts)
        return GroupResult([encode_response(response) for response in responses], group.new_apart_responses)

    def is_assessed(self, scene: Scene) -> bool:
        """Return whether error and sensitivity of a scene are estimated.

        A sample is one scene in eight, the same ones in every run.
        """
        if self.estimate == "alone":
            return not scene.links
        return self.estimate == "all" or (self.estimate == "sample" and scene.digest[0] in "01")

    def list_kernels(self, scene: Scene) -> list[str]:
        """Return the names of the kernels that solve and assess a scene."""
        kernels = [select_kernel(self.method, self.time_step, scene)]
        if self.time_step is not None and self.is_assessed(scene):
            kernels.append(select_kernel("taylor", None, scene))
        return kernels

    def to_finer(self) -> Task:
        """Return the settings of a second try."""
        time_step = None if self.time_step is None else self.time_step * FINER
        return replace(self, accuracy=self.accuracy * FINER, time_step=time_step, retry_failed_finer=False)

    def build_failed_response(self, scene: Scene, status: str, advice: str) -> Response:
        """Return the response of a scene that has no result.

        Parameters
        ----------
        status, advice : what happened, and what to do about it
        """
        storeys = tuple(building.storeys for building in scene.buildings)
        return Response(
            peaks=no_peaks(storeys, len(scene.links)),
            storeys=storeys,
            status=status,
            advice=advice,
            method=self.method,
            accuracy=self.accuracy if self.time_step is None else math.nan,
            time_step=math.nan if self.time_step is None else self.time_step,
            steps=0,
            events=0,
            seconds=0.0,
        )


class GroupSolver:
    """Solves a group of scenes together.

    Parameters
    ----------
    task : settings
    known : responses of neighbours with nothing between them; new ones are added

    Attributes
    ----------
    apart_responses : those of this group, by digest
    new_apart_responses : those of them that were solved here
    """

    def __init__(self, task: Task, known: ApartResponses) -> None:
        self.task = task
        self.known = known
        self.apart_responses: dict[str, Response] = {}
        self.new_apart_responses: dict[str, Response] = {}
        self._apart_seconds: dict[str, float] = {}  # of new ones, until a scene is charged with it

    def solve(self, attempts: Sequence[Attempt]) -> list[Response]:
        """Return the responses in the order of the scenes."""
        responses = self._solve_safely(attempts)
        failed = [number for number, response in enumerate(responses) if response.status != DONE]
        if self.task.retry_failed_finer and failed:
            retry = GroupSolver(self.task.to_finer(), ApartResponses())
            second_responses = retry.solve([attempts[number] for number in failed])
            for number, second in zip(failed, second_responses, strict=True):
                if second.status == DONE:
                    responses[number] = _replace_failed(responses[number], second)
        return responses

    def _solve_safely(self, attempts: Sequence[Attempt]) -> list[Response]:
        """Return the responses; scenes are solved one by one where something goes wrong, so that it stays in one."""
        try:
            responses = self._solve_group(attempts)
        except Exception as error:
            if len(attempts) > 1:
                return [self._solve_safely([attempt])[0] for attempt in attempts]
            return [self._build_error_response(attempts[0].scene, error)]
        return [add_open_gaps(attempt.scene, each) for attempt, each in zip(attempts, responses, strict=True)]

    def _build_error_response(self, scene: Scene, error: Exception) -> Response:
        """Return the response of a scene whose solution raised an exception."""
        if isinstance(error, InputError):  # the method cannot run this scene
            problem = error.issues[0]
            return self.task.build_failed_response(scene, f"refused: {problem.message}", problem.hint)
        status = f"error: {type(error).__name__}: {error}"
        advice = "this is an internal error: please report it with the study file"
        return self.task.build_failed_response(scene, status, advice)

    def _solve_group(self, attempts: Sequence[Attempt]) -> list[Response]:
        """Return the responses of scenes, where no gap closes from those of their neighbours with nothing between.

        These are solved first where scenes of the group share them or they are known, otherwise once a scene has shown
        no contact. So a scene has the same numbers in every group.
        """
        apart_scenes = {number: apart for number, (_, apart) in enumerate(attempts) if apart is not None}
        responses = self._answer_from_shared(attempts, apart_scenes)
        others = [number for number in range(len(attempts)) if number not in responses]
        responses |= zip(others, self._solve_scenes([attempts[number].scene for number in others]), strict=True)
        open_ones = [
            number for number in others
            if number in apart_scenes and _is_done_without_impact(responses[number])
        ]  # fmt: skip
        self._solve_apart([apart_scenes[number].scene for number in open_ones])
        for number in open_ones:
            scene = attempts[number].scene
            apart = apart_scenes[number]
            of_apart = self.apart_responses[apart.scene.digest]
            if stays_open_to_rest(scene, apart, of_apart):
                answer = answer_from_apart(scene, apart, of_apart)
                responses[number] = replace(answer, seconds=responses[number].seconds)
        for number, apart in apart_scenes.items():
            seconds = self._apart_seconds.pop(
                apart.scene.digest, 0.0
            )  # the first scene that shares a run is charged with it
            if seconds:
                responses[number] = replace(responses[number], seconds=responses[number].seconds + seconds)
        return [responses[number] for number in range(len(attempts))]

    def _answer_from_shared(
        self, attempts: Sequence[Attempt], apart_scenes: dict[int, ApartScene]
    ) -> dict[int, Response]:
        """Return the responses of scenes that neighbours with nothing between them answer, by number.

        Only neighbours that several scenes share, or that are known, are looked at.
        """
        counts = Counter(apart.scene.digest for apart in apart_scenes.values())
        shared = [
            apart.scene for apart in apart_scenes.values()
            if counts[apart.scene.digest] > 1 or self.known.find(apart.scene.digest) is not None
        ]  # fmt: skip
        self._solve_apart(shared)
        responses = {}
        for number, apart in apart_scenes.items():
            scene = attempts[number].scene
            of_apart = self.apart_responses.get(apart.scene.digest)
            if of_apart is not None and stays_open(scene, apart, of_apart, self.task.accuracy):
                responses[number] = answer_from_apart(scene, apart, of_apart)
        return responses

    def _solve_apart(self, scenes: Iterable[Scene]) -> None:
        """Take in the responses of neighbours with nothing between them, solved where they are not known."""
        missing: dict[str, Scene] = {}
        for scene in scenes:
            digest = scene.digest
            response = self.apart_responses.get(digest) or self.known.find(digest)
            if response is None:
                missing[digest] = scene
            else:
                self.apart_responses[digest] = response
        solved: dict[str, Response] = {}
        for digest, response in zip(missing, self._solve_scenes(list(missing.values())), strict=True):
            self._apart_seconds[digest] = response.seconds
            solved[digest] = replace(response, seconds=0.0)
        self.apart_responses.update(solved)
        self.new_apart_responses.update(solved)
        self.known.add(solved)

    def _solve_scenes(self, scenes: Sequence[Scene]) -> list[Response]:
        """Return the responses of scenes as they are, assessed where they are to be."""
        task = self.task
        responses = solver.solve_all(scenes, task.accuracy, task.method, time_step=task.time_step)
        numbers = [number for number, scene in enumerate(scenes) if task.is_assessed(scene)]
        assessed = assess(
            [scenes[number] for number in numbers], [responses[number] for number in numbers], task.accuracy
        )
        for number, response in zip(numbers, assessed, strict=True):
            responses[number] = response
        return responses


def _is_done_without_impact(response: Response) -> bool:
    return response.status == DONE and not response.peaks["impacts"].any()


def _replace_failed(first: Response, second: Response) -> Response:
    """Return the response of a second try, with a flag that names how the first ended and with the time of both."""
    flag = Flag("retried", f"{first.status} at first")
    return replace(second, flags=(*second.flags, flag), seconds=first.seconds + second.seconds)
