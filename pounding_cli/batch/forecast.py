"""What a plan will do before it does it: which scenes run, which effects they call for, and what that costs."""

from __future__ import annotations

import itertools
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pounding_cli.model.effects import effects_of
from pounding_cli.model.scene import Scene
from pounding_cli.study.thinned import times

if TYPE_CHECKING:
    from pounding_cli.study import Plan, Study

MOST_SCENES = 2000
"""Scenes that are looked at; of more, as many spread evenly."""

START = 1.0
"""Time of a run besides its scenes [s]: imports, compiled kernels loaded, a file with its summary."""

BESIDE = 0.4e-3
"""Time a scene spends outside the solver [s]: laid out, peaks out, kept on disk, written."""

ASSESSED = 2.4
"""Runs of a scene whose error and sensitivity are asked for, a finer one taking longer."""

ALONE, GROUP = "of a building alone", "of the group"
"""What is solved: baselines, and rows of buildings."""

Kind = tuple[str, str, str]
"""Case ("" for a building alone), analysis and motion: scenes of one kind take about the same time, which one run
tells."""


@dataclass
class Forecast:
    """What will run.

    scenes, seconds : ALONE or GROUP -> number of scenes and their expected time on one core [s]
    kept : effect -> scenes of the group with it; dropped: effect and reason -> scenes of the group without it
    all, alone : scenes of the study, and of buildings alone; about so many where it was thinned
    looked_at : share of the scenes looked at
    timed : scenes that were run to see how long they take
    """

    scenes: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    seconds: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    kept: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    dropped: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    all: int = 0
    alone: int = 0
    looked_at: float = 1.0
    timed: int = 0

    @property
    def total(self) -> float:
        """Expected time of the scenes on one core [s]."""
        return sum(self.seconds.values())


def forecast(plan: Plan, whole: Study | None = None) -> Forecast:
    """Look at the scenes of a plan, and run one of each kind to see how long it takes.

    whole : the study that will run, where the plan is that of a thinned one (`study.thinned`)
    """
    found = Forecast()
    baselines = {digest for row in plan.rows for digest in row.baselines}
    kinds: dict[str, Kind] = {}
    for row in plan.rows:
        for digest, case in (*((digest, "") for digest in row.baselines), (row.scene, row.case)):
            kinds.setdefault(digest, (case, row.analysis, row.record))
    each = _stands_for(plan, whole or plan.study)
    found.all, found.alone = round(sum(each.values())), round(sum(each.get(digest, 0.0) for digest in baselines))
    every = max(1, len(plan.scenes) // MOST_SCENES)
    digests = list(itertools.islice(plan.scenes, 0, None, every))
    found.looked_at = len(digests) / max(1, found.all)
    runs = {"none": 1.0, "sample": 1.0 + (ASSESSED - 1.0) / 8, "all": ASSESSED}[plan.estimate]
    cost: dict[Kind, float] = {}
    for digest in digests:
        scene, number, kind = plan.scenes[digest], every * each[digest], kinds.get(digest, ("", "", ""))
        what = ALONE if digest in baselines else GROUP
        if kind not in cost:
            cost[kind] = _timed(plan, scene)
            found.timed += 1
        found.scenes[what] += number
        found.seconds[what] += number * (runs * cost[kind] + BESIDE)
        if what == GROUP:
            effects = effects_of(scene)
            for counts, said in ((found.kept, effects.kept), (found.dropped, effects.dropped)):
                for text in said:
                    counts[text] += number
    return found


def _timed(plan: Plan, scene: Scene) -> float:
    """The time that a scene takes [s]; nothing where it is refused."""
    from pounding_cli.errors import InputError
    from pounding_cli.solver.solve import solve

    told: dict[str, Any] = {} if plan.time_step is None else {"time_step": plan.time_step}
    try:
        return solve(scene, plan.accuracy, plan.method, **told).seconds
    except InputError:
        return 0.0


def _stands_for(plan: Plan, whole: Study) -> dict[str, float]:
    """How many scenes of the whole study each scene of a plan stands for."""
    some, ground = plan.study, ("records", "tail")
    if some is whole:
        return dict.fromkeys(plan.scenes, 1.0)
    alone = [times(whole, some, ("buildings", name), *ground) for name in some.model.group]
    linked = {case: times(whole, some, "buildings", "impact", "laws", ("cases", case), *ground) for case in plan.cases}
    found: dict[str, float] = {}
    for row in plan.rows:
        for digest, each in (*zip(row.baselines, alone, strict=True), (row.scene, linked[row.case])):
            found.setdefault(digest, each)
    return found
