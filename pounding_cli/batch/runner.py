"""Running a plan: find what is solved, solve the rest, keep every step of the way, write one file."""

from __future__ import annotations

import contextlib
import gc
import itertools
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pounding_cli.batch.attempt import Solve, Task
from pounding_cli.batch.bundles import CHUNK_SECONDS, Queue, Work
from pounding_cli.batch.engines import Engine, Finished, engine
from pounding_cli.batch.families import Order, order_of
from pounding_cli.batch.histories import kept_histories
from pounding_cli.batch.outcome import Failure, Outcome
from pounding_cli.batch.progress import Progress, Quiet
from pounding_cli.batch.reuse import reuse
from pounding_cli.batch.serial import Serial
from pounding_cli.errors import InputError
from pounding_cli.numbers import counted
from pounding_cli.outputs import check_output
from pounding_cli.store import (
    PartStore,
    Run,
    check_results,
    former_run,
    is_current,
    is_finished,
    locked,
    write_results,
)
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.expanded import keep_expanded
from pounding_cli.store.files import is_results, refused_write
from pounding_cli.store.keys import key_of
from pounding_cli.store.locks import lock_of
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    from pounding_cli.study import Plan, Study

WORTH_WORKERS = 1.0
"""Expected work [s] from which starting workers pays."""

SELDOM = 20_000
"""Objects made since the last look for garbage: 700 otherwise, which are those of ten scenes."""


def run_plan(
    plan: Plan,
    output: Path,
    *,
    progress: Progress | None = None,
    solve: Solve | None = None,
    workers: int | None = None,
    engine_name: str = "processes",
    scheduler: str | None = None,
    replace: bool = False,
) -> Outcome:
    """Solve what `output` and its parts still lack and write the results file.

    A scene that fails is reported in the outcome and in the file, and the others go on. Stopped by Ctrl-C,
    what is solved is kept beside `output`, and the next call goes on from there.

    Parameters
    ----------
    plan : the study expanded
    output : the results file
    progress : told what happens; nothing unless given
    solve : solves a scene; `solver.solve.solve` unless given
    workers : scenes side by side; the cores of this machine unless given
    engine_name : one of `engines.ENGINES`; small studies are solved serially whatever it is
    scheduler : address of a Dask scheduler, e.g. tcp://node:8786; only for the dask engine
    replace : replace results of another study too, and leave out scenes and histories that the study does not ask for

    Raises
    ------
    InputError : `output` cannot be written, holds another study or histories that this run would drop, or another run
        is at work on it; no such engine; the disk is full
    KeyboardInterrupt : stopped; what is solved is on disk
    """
    begin = time.perf_counter()
    progress = progress or Quiet()
    chosen = engine(engine_name, workers or cores(), scheduler)
    check_output(output, [plan.study.path], lambda path, _: is_results(path))
    key = key_of(plan)
    if not replace and is_current(output, plan):
        return _current(output, begin)
    parts = PartStore(output, key, plan.rows.table)
    check_results(output, plan.study, "" if plan.workflow == "run" else plan.workflow, replace)
    try:
        with locked(output):
            return _run(plan, parts, output, progress, solve, chosen, begin, replace)
    except OSError as error:
        with contextlib.suppress(OSError):  # results need more room than what they are made of
            parts.flush()
        raise refused_write(error, output, parts.folder) from None


@contextlib.contextmanager
def _garbage_of_the_run() -> Iterator[None]:
    """Look for garbage seldom, and in what the run makes alone. What was there before is looked at again afterwards,
    unless the caller had set it aside."""
    before, every = gc.get_freeze_count(), gc.get_threshold()
    gc.set_threshold(SELDOM, *every[1:])
    try:
        yield
    finally:
        gc.set_threshold(*every)
        if not before:
            gc.unfreeze()


def finished(study: Study, workflow: str, output: Path, all_effects: bool = False) -> Outcome | None:
    """What `run_plan` says of a long study whose results are there already, without expanding it; None where it has
    to be expanded."""
    begin = time.perf_counter()
    return _current(output, begin) if workflow == "run" and is_finished(output, study, all_effects) else None


def _current(output: Path, begin: float) -> Outcome:
    """The outcome of a run with nothing to do."""
    _tidy(output, PartStore(output, ""))
    former = former_run(output, "")
    scenes = 0 if former is None else former.scenes  # of all rounds
    return Outcome(output, 0, 0, scenes, (), "none", 0, 0.0, time.perf_counter() - begin)


def _tidy(output: Path, parts: PartStore) -> None:
    """Remove what a run left that was killed between its last two steps."""
    if parts.folder.exists() or lock_of(output).exists():
        with contextlib.suppress(InputError, OSError), locked(output):  # unless that run is still at it
            parts.remove()


def _run(
    plan: Plan,
    parts: PartStore,
    output: Path,
    progress: Progress,
    solve: Solve | None,
    chosen: Engine,
    begin: float,
    replace: bool,
) -> Outcome:
    reuse(plan, output, parts, progress.say, replace)
    with contextlib.closing(chosen), _garbage_of_the_run():
        plan, solved = _solve_rounds(plan, parts, chosen, progress, solve)
    if replace:
        parts.only(plan.scenes)
    reused = len(plan.scenes) - solved.scenes
    workers = chosen.workers if solved.engine == chosen.name else 1
    run = Run(time.perf_counter() - begin, solved.scenes, reused, solved.engine, workers)
    histories = kept_histories(plan, parts, output, parts.key, progress.say, replace)
    write_results(output, plan, parts, run, histories)
    parts.remove()
    failures = tuple(_failures(plan, parts))
    done = solved.scenes - len(failures)
    wall = time.perf_counter() - begin
    return Outcome(output, done, len(failures), reused, failures, solved.engine, workers, solved.seconds, wall)


@dataclass
class _Solved:
    """How many scenes were solved, by which engine, and the time in the solver, all workers together [s]."""

    scenes: int = 0
    engine: str = "none"
    seconds: float = 0.0


def _solve_rounds(
    plan: Plan, parts: PartStore, chosen: Engine, progress: Progress, solve: Solve | None
) -> tuple[Plan, _Solved]:
    """Solve what is missing of a plan and of the plans that follow from it, and show how it goes; what is solved is
    kept, whatever happens. Returns the last plan."""
    refine = WORKFLOWS[plan.workflow].part("refine")
    solved, saved = _Solved(), time.monotonic()
    following: Plan | None = plan
    try:
        while following is not None:
            plan = following
            order = order_of(plan, parts.has)
            if order.digests:
                progress.start(len(order.digests), len(plan.scenes) - len(order.digests), plan.ahead)
                solved.scenes += len(order.digests)
                by, spent = _solve_missing(plan, order, parts, chosen, progress, solve)
                solved.engine = by if solved.engine in ("none", "serial") else solved.engine
                solved.seconds += spent
            if time.monotonic() - saved > CHUNK_SECONDS:  # rounds may be many, each too short for the disk
                parts.flush()
                saved = time.monotonic()
            following = None if refine is None else refine(plan, parts)
    except BaseException:
        with contextlib.suppress(OSError):  # the disk may be why
            parts.flush()
        if solved.scenes:
            progress.stop()
            progress.say(f"{parts.saved(plan.scenes)} of {counted(len(plan.scenes), 'scene')} kept in {parts.folder}")
        raise
    if solved.scenes:
        progress.stop()
    return plan, solved


def _solve_missing(
    plan: Plan, order: Order, parts: PartStore, chosen: Engine, progress: Progress, solve: Solve | None
) -> tuple[str, float]:
    """Solve two scenes of every sort here, one to compile and one to estimate the time; then solve the rest.

    Returns the engine's name and the time in the solver, all workers together [s].
    """
    task = _work(plan, solve)
    spent, saved = 0.0, time.monotonic()

    def keep(finished: Finished, small: bool = True) -> None:
        nonlocal spent, saved
        chunk = finished.chunk
        parts.add(chunk, finished.content)
        if not small or time.monotonic() - saved > CHUNK_SECONDS:
            parts.flush()
            saved = time.monotonic()
        spent += float(chunk.seconds.sum())
        done = int(chunk.is_done.sum())
        progress.step(done, len(chunk) - done)

    def here(digest: str) -> float:
        begin = time.perf_counter()
        keep(Finished(Chunk.of({digest: task(plan.scenes[digest])})))
        return time.perf_counter() - begin

    if solve is None:
        _tell_compiling(progress)
    for digests in order.samples.values():
        here(digests[0])
    progress.compiled()
    gc.freeze()  # kernels are loaded, the plan is made: to look for garbage in them takes a thirtieth of a short run
    work = sum(here(digests[1]) * (order.counts[sort] - 2) for sort, digests in order.samples.items() if digests[1:])
    # What takes no time need not touch the disk; of anything longer, every chunk does.
    small = work < WORTH_WORKERS
    used = Serial() if small or (chosen.workers == 1 and chosen.name != "dask") else chosen
    if not small:
        keep_expanded(plan, parts.folder)  # first, so that a run with parts never expands again
        parts.flush()
    queue = Queue(order.rest, used.workers, work / max(1, len(order.rest)), order.begins)
    with contextlib.closing(used.solve(queue, plan.scenes, task, parts.key)) as solved:
        for finished in solved:
            keep(finished, small)
    return used.name, spent


def _work(plan: Plan, solve: Solve | None) -> Work:
    """How the scenes of a plan are solved."""
    estimate = "alone" if plan.rough and plan.estimate == "all" else plan.estimate
    return Task(
        solve or _default_solve(), plan.accuracy, plan.method, estimate, plan.all_effects, plan.time_step,
        plan.harder,
    )  # fmt: skip


def _default_solve() -> Solve:
    from pounding_cli.solver.solve import solve  # here, so that a finished study need not load it

    return solve


def _tell_compiling(progress: Progress) -> None:
    """Have the solver say when it compiles."""
    from pounding_cli.solver import solve

    solve.say = progress.say


def _failures(plan: Plan, parts: PartStore) -> Iterator[Failure]:
    """Every failed scene once, named by the first place in the study where it stands."""
    failed = set(itertools.compress(plan.scenes, ~parts.is_done(plan.scenes)))
    for row in plan.rows if failed else ():
        swept = [
            f"{name} = {value}"
            for axis, number in zip(plan.axes, row.point, strict=True)
            for name, value in zip(axis.names, axis.values[number], strict=True)
        ]
        places = [(row.scene, row.case)]
        places += [(key, f"{building} alone") for building, key in zip(plan.buildings, row.baselines, strict=True)]
        for digest, what in places:
            if digest in failed:
                failed.remove(digest)
                facts = parts.header(digest).facts
                place = ", ".join(filter(None, [*swept, what, row.analysis, row.record]))
                yield Failure(place or "the study", facts["status"], facts["advice"])


def cores() -> int:
    """Cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
