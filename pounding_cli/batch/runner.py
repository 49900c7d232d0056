"""Running a plan: find what is solved, solve the rest, keep every step of the way, write one file."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from pounding_cli.batch.attempt import Solve, Task
from pounding_cli.batch.engines import Engine, engine
from pounding_cli.batch.histories import kept_histories
from pounding_cli.batch.outcome import Failure, Outcome
from pounding_cli.batch.progress import Progress, Quiet
from pounding_cli.batch.serial import Serial
from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import Response
from pounding_cli.store import (
    PartStore,
    Run,
    check_output,
    is_current,
    solution_key,
    stored_solutions,
    write_results,
)

if TYPE_CHECKING:
    from pounding_cli.study import Plan

WORTH_PROCESSES = 1.0
"""Expected work [s] from which starting processes pays."""

_COMPILE_PATIENCE = 1.5
"""Loading compiled kernels takes less than this [s]; only a first run, which compiles them, takes more."""


def run_plan(
    plan: Plan,
    output: Path,
    *,
    progress: Progress | None = None,
    solve: Solve | None = None,
    workers: int | None = None,
    engine_name: str = "processes",
) -> Outcome:
    """Solve what `output` and its parts still lack and write the results file.

    A scene that fails is reported in the outcome and in the file, and the others go on. Stopped by Ctrl-C,
    what is solved is kept beside `output`, and the next call goes on from there.

    Parameters
    ----------
    plan : the study expanded
    output : the results file
    progress : told what happens; nothing unless given
    solve : solves a scene; `pounding_cli.solve.solve` unless given
    workers : scenes side by side; the cores of this machine unless given
    engine_name : "serial" or "processes"; small studies are solved serially either way

    Raises
    ------
    InputError : `output` cannot be written; no such engine
    KeyboardInterrupt : stopped; what is solved is on disk
    """
    begin = time.perf_counter()
    progress = progress or Quiet()
    chosen = engine(engine_name, workers or _cores())
    check_output(output)
    if is_current(output, plan):
        return Outcome(output, 0, 0, len(plan.scenes), (), "none", 0, 0.0, time.perf_counter() - begin)
    key = solution_key(plan.accuracy, plan.method, plan.estimate)
    parts = PartStore(output, key)
    found = stored_solutions(output, key, plan.scenes) | parts.load()
    responses = {digest: found[digest] for digest in plan.scenes if digest in found}
    reused = len(responses)
    missing = {digest: scene for digest, scene in plan.scenes.items() if digest not in responses}
    used: Engine = Serial()
    if missing:
        progress.start(len(missing), reused)
        try:
            used = _solve_missing(plan, missing, responses, parts, chosen, progress, solve)
        except BaseException:
            parts.flush()
            progress.stop()
            progress.say(f"{len(responses)} of {len(plan.scenes)} scenes are kept in {parts.folder}")
            raise
        progress.stop()
    run = Run(time.perf_counter() - begin, len(missing), reused, used.name, used.workers)
    write_results(output, plan, responses, run, kept_histories(plan, responses, output, key, progress.say))
    parts.remove()
    failures = tuple(_failures(plan, responses))
    return Outcome(
        output,
        len(missing) - len(failures),
        len(failures),
        reused,
        failures,
        used.name,
        used.workers,
        sum(responses[digest].seconds for digest in missing),
        time.perf_counter() - begin,
    )


def _solve_missing(
    plan: Plan,
    missing: dict[str, Scene],
    responses: dict[str, Response],
    parts: PartStore,
    chosen: Engine,
    progress: Progress,
    solve: Solve | None,
) -> Engine:
    """Solve two scenes of every sort here, one to compile, one to price the rest; then solve the rest."""
    task = Task(solve or _default_solve(), plan.accuracy, plan.method, plan.estimate)

    def keep(digest: str, response: Response) -> None:
        responses[digest] = response
        if response.status == "done":
            parts.add(digest, response)
        progress.step(response.status != "done")

    sorts: dict[tuple, list[str]] = {}
    for digest, scene in missing.items():
        sorts.setdefault(_sort(scene), []).append(digest)
    with _compile_notice(progress, solve):
        for digests in sorts.values():
            keep(digests[0], task(missing[digests[0]]))
    expected = 0.0
    for digests in sorts.values():
        for digest in digests[1:2]:
            keep(digest, task(missing[digest]))
            expected += responses[digest].seconds * len(digests[2:])
    rest = [(digest, missing[digest]) for digests in sorts.values() for digest in digests[2:]]
    used = chosen if expected > WORTH_PROCESSES and chosen.workers > 1 else Serial()
    with contextlib.closing(used.solve(rest, task, expected / max(1, len(rest)))) as solved:
        for digest, response in solved:
            keep(digest, response)
    return used


def _sort(scene: Scene) -> tuple:
    """Scenes of one sort run the same compiled code and cost about the same."""
    kinds = frozenset(str(link.kind) for link in scene.links)
    founded = any(building.foundation is not None for building in scene.buildings)
    return str(scene.analysis), kinds, founded, len(scene.buildings)


def _default_solve() -> Solve:
    from pounding_cli.solve import solve  # here, so that a finished study need not load it

    return solve


@contextlib.contextmanager
def _compile_notice(progress: Progress, solve: Solve | None) -> Iterator[None]:
    """Say that kernels are being compiled, if the first scenes take as long as that."""
    from pounding_cli.solve import is_compiled

    if solve is not None or is_compiled():
        yield
        return
    notice = threading.Timer(_COMPILE_PATIENCE, progress.say, ["compiling kernels (first run only)"])
    notice.daemon = True
    notice.start()
    try:
        yield
    finally:
        notice.cancel()
        notice.join()


def _failures(plan: Plan, responses: dict[str, Response]) -> Iterator[Failure]:
    """Every failed scene once, named by the first place in the study where it stands."""
    named: set[str] = set()
    for row in plan.rows:
        swept = [
            f"{name} = {value}"
            for axis, number in zip(plan.axes, row.point, strict=True)
            for name, value in zip(axis.names, axis.values[number], strict=True)
        ]
        places = [(row.scene, row.case)]
        places += [(key, f"{building} alone") for building, key in zip(plan.buildings, row.baselines, strict=True)]
        for digest, what in places:
            response = responses[digest]
            if response.status != "done" and digest not in named:
                named.add(digest)
                place = ", ".join([*swept, what, row.analysis, row.record])
                yield Failure(place, response.status, response.advice)


def _cores() -> int:
    """Cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
