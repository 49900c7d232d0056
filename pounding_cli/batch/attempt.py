"""One scene, solved or reported: whatever goes wrong in it stays in it."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from pounding_cli.errors import InputError
from pounding_cli.model.scene import Scene
from pounding_cli.solve.assess import assess, judging, judging_bounded
from pounding_cli.solve.groups import GroupSolver
from pounding_cli.solve.read import OneOf, read
from pounding_cli.solve.response import Response
from pounding_cli.solve.run import Prepared, prepare, solve
from pounding_cli.solve.tangent import FINEST_BOUNDED
from pounding_cli.store.codec import failed

Solve = Callable[..., Response]
"""solve(scene, accuracy=..., method=..., all_effects=..., watch=..., ledger=..., tangent=...) -> Response; with
time_step=... where the study has one."""

_Answer = TypeVar("_Answer", Response, OneOf)


HARDER = 0.01
"""Accuracy and time step of a second try over those of the first [-]."""


@dataclass
class _Begun:
    """A scene whose runs are laid out: its own and those that it is judged by; `beside` as in
    `GroupSolver.without_a_run`."""

    scene: Scene
    first: Prepared
    judges: list[Prepared]
    beside: float

    def integrate(self) -> None:
        """Run them; a run that did not end is not judged."""
        self.first.integrate()
        if self.judges:
            for judge in self.done()[1:]:
                judge.integrate()

    def done(self) -> list[Prepared]:
        """The runs that are run."""
        return [self.first, *(self.judges if self.first.is_done else ())]


@dataclass(frozen=True)
class Task:
    """How every row of buildings is solved: a `bundles.Work`.

    estimate : which scenes are assessed: none, sample or all; alone, those of buildings with nothing beside them
    all_effects : simulate what cannot matter too, and every row of buildings whole
    time_step : of a method that takes one [s]
    """

    solve: Solve
    accuracy: float
    method: str
    estimate: str = "none"
    all_effects: bool = False
    time_step: float | None = None
    harder: bool = False
    solver: str = ""

    def __call__(self, scene: Scene) -> Response:
        """The response; an exception becomes a failed response that names it."""
        return self._again(scene, self._caught(scene, self._respond_or_prove, scene))

    def each(
        self, scenes: Sequence[Scene], begins: Callable[[int], None], halted: Callable[[], bool]
    ) -> list[Response | OneOf]:
        """The responses of scenes in their order; only the first of them, at least one, where it is `halted`.

        One thing is done for all of them before the next: what need not be run is found, what is to be run is laid out,
        run, read. Between two runs of the solver, and between two kinds of work, Python finds its caches cold: the same
        work takes twice to three times as long there.

        begins : told the place of every scene before something of it is run
        """
        answers, groups = [], _group_solver(self) if self.falls_apart() else None
        for place, scene in enumerate(scenes):
            begins(place)
            answers.append(self._caught(scene, self._without_a_run, scene, groups))
            if halted():
                break
        for place, beside in enumerate(answers):
            if isinstance(beside, float):
                answers[place] = self._caught(scenes[place], self._begun, scenes[place], beside)
        for place, answer in enumerate(answers):
            if isinstance(answer, _Begun):
                begins(place)
                failure = self._caught(answer.scene, answer.integrate)
                answers[place] = failure or answer
                if halted():
                    del answers[place + 1 :]
        begun = [(place, each) for place, each in enumerate(answers) if isinstance(each, _Begun)]
        found = _read_together([run for _, each in begun for run in each.done()])
        open_ones = [
            (place, each) for place, each in begun if self._caught(each.scene, self._judge, each, found) is True
        ]
        for place, each in open_ones:
            begins(place)
            self._caught(each.scene, each.judges[0].integrate)
        found |= _read_together([run for _, each in open_ones for run in each.judges])
        ended = (
            self._caught(each.scene, self._ended, each, found) if isinstance(each, _Begun) else each for each in answers
        )
        return [self._again(scene, answer) for scene, answer in zip(scenes, ended, strict=False)]

    def _again(self, scene: Scene, response: _Answer) -> _Answer | Response:
        """The response, or of a scene that failed that of a harder try, which says so; the first where that fails."""
        if not self.harder or response.status == "done":
            return response
        step = None if self.time_step is None else self.time_step * HARDER
        task = dataclasses.replace(self, accuracy=self.accuracy * HARDER, time_step=step, harder=False)
        second: Response = task._caught(scene, task.respond, scene, False)
        if second.status != "done":
            return response
        first = response.response() if isinstance(response, OneOf) else response
        note = f"solved once more, {1 / HARDER:g} times as finely: {first.status}"
        return dataclasses.replace(second, flags=(*second.flags, note), seconds=first.seconds + second.seconds)

    def _caught(self, scene: Scene, work: Callable[..., Any], *arguments: Any) -> Any:
        """What `work` gives; an exception becomes a failed response that names it."""
        try:
            return work(*arguments)
        except InputError as refused:  # the method does not run this scene
            problem = refused.problems[0]
            return self.without(scene, f"refused: {problem.message}", problem.hint)
        except Exception as error:  # one scene must not take the others with it
            advice = "this is an internal error: please report it with the study file"
            return self.without(scene, f"error: {type(error).__name__}: {error}", advice)

    def _respond_or_prove(self, scene: Scene) -> Response:
        return _group_solver(self)(scene) if self.falls_apart() else self.respond(scene, False)

    def _without_a_run(self, scene: Scene, groups: GroupSolver | None) -> Response | float:
        """The response of a scene that need not be run as a whole, or the time that groups took, as in
        `GroupSolver.without_a_run` [s]."""
        if self.solve is not solve:
            return self._respond_or_prove(scene)
        response, beside = groups.without_a_run(scene) if groups else (None, 0.0)
        if response is None:
            return beside
        return dataclasses.replace(response, seconds=response.seconds + beside) if beside else response

    def _begun(self, scene: Scene, beside: float) -> _Begun:
        """The runs of a scene laid out."""
        is_assessed = self.is_assessed(scene)
        first = prepare(
            scene, self.accuracy, self.method, time_step=self.time_step, all_effects=self.all_effects,
            tangent=is_assessed and self.accuracy >= FINEST_BOUNDED,
        )  # fmt: skip
        if not is_assessed or first.carries_tangent:
            return _Begun(scene, first, [], beside)
        asked = judging(scene, first.what.method.name, self.accuracy, self.all_effects)
        return _Begun(scene, first, [prepare(each, **settings) for each, settings in asked], beside)

    def _judge(self, begun: _Begun, found: Mapping[Prepared, OneOf]) -> bool:
        """Whether a finer run is to judge a run whose tangent does not tell enough; it is laid out."""
        one = found.get(begun.first)
        if one is None or not one.is_open:
            return False
        method = begun.first.what.method.name
        asked = judging_bounded(begun.scene, method, self.accuracy, one.sensitivity, self.all_effects)
        begun.judges = [prepare(scene, **settings) for scene, settings in asked]
        return bool(asked)

    def _ended(self, begun: _Begun, found: Mapping[Prepared, OneOf]) -> Response | OneOf:
        """The response of runs that are done, as far as they are `found` already."""
        one, *others = [found.get(run) or read([run])[0] for run in begun.done()]
        if not (begun.judges or begun.beside or one.is_open):
            return one
        response = one.response()
        if (others or one.is_open) and response.has_result:
            judges = [other.response() for other in others]
            response = assess(begun.scene, response, self.accuracy, self.solve, self.all_effects, judges)
        return dataclasses.replace(response, seconds=response.seconds + begun.beside) if begun.beside else response

    def respond(self, scene: Scene, watch: bool) -> Response:
        """The response of the scene as a whole, assessed where the study asks for that."""
        told: dict[str, Any] = {} if self.time_step is None else {"time_step": self.time_step}
        if self.is_assessed(scene) and self.accuracy >= FINEST_BOUNDED:
            told["tangent"] = True
        response = self.solve(
            scene, accuracy=self.accuracy, method=self.method, all_effects=self.all_effects, watch=watch, **told
        )
        if not self.is_assessed(scene):
            return response
        return assess(scene, response, self.accuracy, self.solve, self.all_effects)

    def free(self, scene: Scene, accuracy: float) -> Response:
        """The response of neighbours with nothing between them; it tells its error where errors are asked for."""
        told = {"tangent": True} if self.estimate in ("all", "sample") and accuracy >= FINEST_BOUNDED else {}
        return self.solve(scene, accuracy=accuracy, method=self.method, **told)

    def falls_apart(self) -> bool:
        """Whether scenes may be solved in groups: a user of fixed steps wants those steps in every scene."""
        return not self.all_effects and self.time_step is None

    def is_assessed(self, scene: Scene) -> bool:
        """Whether error and sensitivity of this scene are asked for; a sample is one scene in eight, the same ones in
        every run."""
        if self.estimate == "alone":
            return not scene.links
        return self.estimate == "all" or (self.estimate == "sample" and scene.digest[0] in "01")

    def without(self, scene: Scene, status: str, advice: str) -> Response:
        """The response of a scene that gave none."""
        storeys = [building.storeys for building in scene.buildings]
        asked = (self.accuracy, math.nan) if self.time_step is None else (math.nan, self.time_step)
        return failed(storeys, len(scene.links), status, advice, self.method, *asked)


def _read_together(runs: Sequence[Prepared]) -> dict[Prepared, OneOf]:
    """What came of runs; none of it where one of them cannot be read, so that each is read by itself."""
    try:
        return dict(zip(runs, read(runs), strict=True))
    except Exception:
        return {}


@functools.lru_cache(maxsize=1)
def _group_solver(task: Task) -> GroupSolver:
    """One memory of groups in every process, for the task at hand."""
    return GroupSolver(task.respond, task.free, task.accuracy, task.is_assessed)
