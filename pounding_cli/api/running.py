"""Running a study: solve what its results still lack, answer what is asked, write one file."""

from __future__ import annotations

import contextlib
import hashlib
import json
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.batch.cache import Cache, cache_of
from pounding_cli.batch.pool import pool
from pounding_cli.batch.progress import Progress
from pounding_cli.batch.solve import Solver
from pounding_cli.errors import InputError
from pounding_cli.numbers import counted
from pounding_cli.results.file import facts, write
from pounding_cli.results.histories import kept_histories
from pounding_cli.results.keys import solution_key, solver_version
from pounding_cli.results.owner import check_results, written_place
from pounding_cli.workflows import workflow_of

if TYPE_CHECKING:
    from pounding_cli.study import Plan, Study
    from pounding_cli.workflows.workflow import Workflow


@dataclass(frozen=True)
class Failure:
    """A scene without a result: where it stands in the study, what happened, what to do about it."""

    place: str
    status: str
    advice: str


@dataclass(frozen=True)
class Outcome:
    """Counts of scenes, each scene once: done now, failed, reused from a former run.

    path : the results file
    failures : the scenes that failed, in the order of the study
    engine, workers : how the scenes were solved
    solver_seconds : time inside the solver now, all workers together [s]
    wall_seconds : from start to file [s]
    """

    path: Path
    done: int
    failed: int
    reused: int
    failures: tuple[Failure, ...]
    engine: str
    workers: int
    solver_seconds: float
    wall_seconds: float


def question(name: str) -> Workflow:
    """A question by its name, with all that it needs.  Raises InputError: there is none."""
    if name == "sensitivity":
        from pounding_cli.report.claims import at_samples
        from pounding_cli.workflows.sensitivity import Sensitivity

        return Sensitivity(at_samples)
    return workflow_of(name)


def run_study(
    study: Study,
    workflow: Workflow,
    output: Path,
    *,
    progress: Progress | None = None,
    workers: int | None = None,
    engine: str = "threads",
    scheduler: str | None = None,
    replace: bool = False,
) -> Outcome:
    """Solve what the cache beside `output` lacks and write the results file; parameters as those of `api.run`.

    A scene that fails is reported in the outcome and in the file, and the others go on. Stopped by Ctrl-C, what is
    solved is kept, and the next call goes on from there.

    Raises
    ------
    InputError : the study or the output is refused; another run is at work on it; no such engine; the disk is full
    KeyboardInterrupt : stopped
    """
    begin, told = time.perf_counter(), progress or Progress()
    workers_of = pool(engine, workers, scheduler)
    with contextlib.ExitStack() as stack:
        stack.callback(workers_of.close)
        content = _content(workflow, workflow.plan(study))
        check_results(output, study, workflow.name, replace)
        if not replace and (scenes := _finished(output, content)) is not None:
            return Outcome(output, 0, 0, scenes, (), "none", 1, 0.0, time.perf_counter() - begin)
        cache = stack.enter_context(contextlib.closing(Cache(cache_of(output))))
        _tell_reuse(cache, told)
        solver = Solver(cache, workers_of, told)
        try:
            found = workflow.run(study, solver)
        except KeyboardInterrupt:
            told.say(f"{counted(solver.solved, 'scene')} solved now and kept in {cache.path}")
            raise
        plan = found.plan
        histories = kept_histories(plan, found.dataset, told.say)
        wall = time.perf_counter() - begin
        said = {
            "content": content,
            "study_file": written_place(study, output),
            "answers": json.dumps([table.name for table in found.tables]),
            "scenes_solved_last": solver.solved,
            "scenes_reused_last": solver.reused,
            "wall_seconds_last": wall,
            "engine": solver.engine,
            "workers": solver.workers,
        }
        write(output, found.dataset.assign_attrs(said), found.tables, histories)
        if replace:
            cache.keep_only(solution_key(plan), [digest.tobytes() for digest in plan.digests])
    failures = tuple(_failures(plan, solver))
    done = solver.solved - len(solver.failed)
    wall = time.perf_counter() - begin
    counts = done, len(solver.failed), solver.reused
    return Outcome(output, *counts, failures, solver.engine, solver.workers, solver.seconds, wall)


def _content(workflow: Workflow, plan: Plan) -> str:
    """SHA-256 of all that results follow from: the study, its scenes, the solver."""
    study = plan.study
    sha = hashlib.sha256()
    for part in (
        solution_key(plan),
        workflow.name,
        study.title,
        study.text,
        json.dumps(study.resolved(), default=str, sort_keys=True),
        repr(([(row.point, row.case, row.analysis, row.record) for row in plan.kept], plan.every)),
    ):
        sha.update(part.encode() + b"\0")
    sha.update(np.ascontiguousarray(plan.digests).data)
    sha.update(np.ascontiguousarray(plan.numbers).data)
    return sha.hexdigest()


def _finished(output: Path, content: str) -> int | None:
    """The number of scenes of a results file that holds this already, every scene done; None where it does not."""
    try:
        known = facts(output)
        same = known["content"] == content and int(known["scenes_failed"]) == 0
        return int(known["scenes"]) if same else None
    except (InputError, KeyError):
        return None


def _tell_reuse(cache: Cache, told: Progress) -> None:
    if cache.was_damaged:
        told.say(f"{cache.path} was damaged: what it held is solved again")
    if cache.forget_other(f"solver {solver_version()} "):
        told.say(f"{cache.path} was made with another solver: all scenes are solved again")


def _failures(plan: Plan, solver: Solver) -> Iterator[Failure]:
    """Every failed scene once, named by the first place in the study where it stands."""
    rows, columns = plan.first
    for number, digest in enumerate(plan.digests) if solver.failed else ():
        if (said := solver.failed.get(digest.tobytes())) is not None:
            row = plan.row(int(rows[number]))
            swept = [f"{name} = {value}" for name, value in plan.shown(row.point).items()]
            what = f"{plan.buildings[columns[number] - 1]} alone" if columns[number] else row.case
            yield Failure(", ".join((*swept, what, row.analysis, row.record)), *said)
