"""What a plan will do before it does it: which scenes run and how, which are answered by proof, and what that costs."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.batch.attempt import Task
from pounding_cli.batch.families import order_of
from pounding_cli.methods import AUTO
from pounding_cli.model.condense import condensed
from pounding_cli.model.effects import effects_of
from pounding_cli.model.scene import Scene
from pounding_cli.solve.cost import BESIDE, NEW_LINKS, cost, method_of, runs_assessed
from pounding_cli.solve.groups import GroupSolver, sure_parts
from pounding_cli.solve.response import Response
from pounding_cli.study.thinned import times

if TYPE_CHECKING:
    from pounding_cli.study import Plan
    from pounding_cli.study.load import Study

MOST_SCENES = 2000
"""Scenes that are looked at; of more, as many spread evenly."""

MOST_TIMED, TIMED = 64, 0.5
"""Rows of a method that are run to see how long they take, at most so many, and for so long about [s]: how often floors
strike each other decides, which no formula tells."""

ALONE, PARTS, GROUP = "of a building alone", "of smaller groups", "of the group"
APART = "of neighbours kept apart"
"""What is solved: baselines; several neighbours of a row, to see whether they reach the next one; whole rows;
neighbours with nothing between them, for the peaks of their closing."""


@dataclass
class Forecast:
    """What will run.

    scenes, seconds : (ALONE, PARTS, GROUP or APART, method) -> number of scenes and their expected time on one core [s]
    not_simulated : case -> scenes of the group that are answered by smaller groups, where that was looked into
    kept : effect -> scenes of the group with it; dropped: effect and reason -> scenes of the group without it
    all, alone : scenes of the study, and of buildings alone; about so many where it was thinned
    looked_at, proven : share of the scenes looked at; whether the buildings alone and the smaller groups were run
    timed : rows of the group that were run to see how long they take
    """

    scenes: defaultdict[tuple[str, str], float] = field(default_factory=lambda: defaultdict(float))
    seconds: defaultdict[tuple[str, str], float] = field(default_factory=lambda: defaultdict(float))
    not_simulated: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    kept: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    dropped: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    all: int = 0
    alone: int = 0
    looked_at: float = 1.0
    proven: bool = False
    timed: int = 0

    @property
    def total(self) -> float:
        """Expected time of the scenes on one core [s]."""
        return sum(self.seconds.values())


def forecast(plan: Plan, prove: bool, whole: Study | None = None) -> Forecast:
    """Look at the scenes of a plan. To find rows that need no run, run their buildings alone and smaller groups.

    Then everything is found as a run will find it; of the whole rows a few are solved, to time them. Without proof
    every row counts as solved whole, and smaller groups only where a first movement closes their links.

    whole : the study that will run, where the plan is that of a thinned one (`study.thinned`)
    """
    found = Forecast(proven=prove and not plan.all_effects)
    baselines = {digest for row in plan.rows for digest in row.baselines}
    cases = {row.scene: row.case for row in reversed(plan.rows)}
    digests = _looked_at(plan)
    each, apart = _stands_for(plan, whole or plan.study)
    found.all, found.alone = round(sum(each.values())), round(sum(each.get(digest, 0.0) for digest in baselines))
    found.looked_at = len(digests) / max(1, found.all)
    every = _every(plan)
    parts: set[str] = set()
    whole_rows: defaultdict[str, list[Scene]] = defaultdict(list)
    solver_seconds: defaultdict[str, float] = defaultdict(float)
    share = {"none": 0.0, "sample": 1 / 8, "all": 1.0}[plan.estimate]

    def count(what: str, scene: Scene, number: float) -> None:
        method = _method(plan, scene)
        runs = 1 + share * (runs_assessed(scene, method, plan.accuracy, plan.all_effects) - 1) if share else 1.0
        found.scenes[what, method] += number
        solver = number * runs * cost(scene, method, plan.time_step)
        found.seconds[what, method] += solver + number * BESIDE
        if what == GROUP:  # scenes of a point share their links
            found.seconds[what, method] += number * NEW_LINKS / (len(plan.analyses) * len(plan.records))
            whole_rows[method].append(scene)
            solver_seconds[method] += solver

    def count_part(scene: Scene) -> None:
        if len(scene.buildings) > 1 and scene.digest not in parts:
            parts.add(scene.digest)
            linked = all(link.law.can_close for link in scene.links)
            count(PARTS if linked else APART, scene, every * (stands if linked else apart))

    solver = _prover(plan, count_part)
    for digest in digests:
        scene, stands = plan.scenes[digest], each[digest]
        if digest in baselines:
            count(ALONE, scene, every * stands)
            continue
        _count_effects(found, plan, scene, every * stands)
        if solver is not None and found.proven:
            if solver.by_proof(scene) is not None:
                found.not_simulated[cases[digest]] += every * stands
                continue
        elif solver is not None:
            for part in sure_parts(scene):
                count_part(part)
        count(GROUP, scene, every * stands)
    for method, scenes in whole_rows.items() if prove else ():
        timed, rate = _timed(plan, method, scenes)
        found.timed += timed
        found.seconds[GROUP, method] += (rate - 1.0) * solver_seconds[method]
    return found


def _timed(plan: Plan, method: str, scenes: Sequence[Scene]) -> tuple[int, float]:
    """How many rows of a method were run, spread evenly, and the time that they took over what `cost` says; none, and
    1, where each would take too long."""
    from pounding_cli.solve import solve

    expected = sum(cost(scene, method, plan.time_step) for scene in scenes)
    most = min(MOST_TIMED, int(TIMED / (expected / len(scenes))))
    if not most:
        return 0, 1.0
    some = scenes[:: -(-len(scenes) // most)]
    told: dict[str, Any] = {} if plan.time_step is None else {"time_step": plan.time_step}
    taken = 0.0
    for scene in some:
        runs = (solve(scene, plan.accuracy, plan.method, all_effects=plan.all_effects, **told) for _ in range(2))
        taken += min(run.seconds for run in runs)  # other programs may be at work, and a first run compiles
    rate = taken / sum(cost(scene, method, plan.time_step) for scene in some)
    return (len(some), rate) if rate else (0, 1.0)


def _stands_for(plan: Plan, whole: Study) -> tuple[dict[str, float], float]:
    """How many scenes of the whole study each scene of a plan stands for, and each row of neighbours kept apart."""
    some, ground = plan.study, ("records", "tail")
    if some is whole:
        return dict.fromkeys(plan.scenes, 1.0), 1.0
    alone = [times(whole, some, ("buildings", name), *ground) for name in some.model.group]
    linked = {case: times(whole, some, "buildings", "impact", "laws", ("cases", case), *ground) for case in plan.cases}
    found: dict[str, float] = {}
    for row in plan.rows:
        for digest, each in (*zip(row.baselines, alone, strict=True), (row.scene, linked[row.case])):
            found.setdefault(digest, each)
    return found, times(whole, some, "buildings", *ground)


def methods_needed(plan: Plan) -> set[str]:
    """Keys in METHODS of the methods that a run of the plan will take.

    Where the buildings alone need no series, a row of the group may not either: its gaps may never close. Rows are
    looked at until one is found that does.
    """
    baselines = {digest for row in plan.rows for digest in row.baselines}
    some = itertools.chain(_looked_at(plan), *order_of(plan, _none).samples.values())
    methods = {digest: _method(plan, plan.scenes[digest]) for digest in some}
    in_series = [digest for digest, method in methods.items() if method == "taylor"]
    needed, solver = set(methods.values()), _prover(plan)
    if solver is None or plan.method != AUTO or not baselines.isdisjoint(in_series):
        return needed
    answers = (solver.by_proof(plan.scenes[digest]) for digest in in_series)
    if any(answer is None or "taylor" in answer.methods for answer in answers):
        return needed
    return needed - {"taylor"}


def _none(digests: Sequence[str]) -> np.ndarray:
    """Solved so far."""
    return np.zeros(len(digests), bool)


def _every(plan: Plan) -> int:
    return max(1, len(plan.scenes) // MOST_SCENES)


def _looked_at(plan: Plan) -> list[str]:
    """Digests of all scenes, or of MOST_SCENES of them and a few more, spread evenly."""
    return list(itertools.islice(plan.scenes, 0, None, _every(plan)))


def _method(plan: Plan, scene: Scene) -> str:
    """Key in METHODS of what solves a scene that is not answered by proof."""
    if plan.method != AUTO:
        return plan.method
    return "taylor" if plan.all_effects else method_of(scene)


def _prover(plan: Plan, tell: Callable[[Scene], None] = lambda scene: None) -> GroupSolver | None:
    """What proves that a row needs no run, telling what it solves; None where a run simulates all rows."""
    from pounding_cli.solve import solve

    task = Task(solve, plan.accuracy, plan.method, all_effects=plan.all_effects, time_step=plan.time_step)

    def respond(scene: Scene, watch: bool) -> Response:
        tell(scene)
        return task.respond(scene, watch)

    def free(scene: Scene, accuracy: float) -> Response:
        tell(scene)
        return task.free(scene, accuracy)

    return GroupSolver(respond, free, plan.accuracy) if task.falls_apart() else None


def _count_effects(found: Forecast, plan: Plan, scene: Scene, times: float) -> None:
    effects = effects_of(scene)
    dropped = effects.dropped
    if not plan.all_effects and plan.time_step is None:
        dropped += condensed(scene, plan.accuracy)[1]
    for counts, said in ((found.kept, effects.kept), (found.dropped, dropped)):
        for text in said:
            counts[text] += times
