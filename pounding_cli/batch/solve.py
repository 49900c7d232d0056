"""Solving the scenes of plans: what the cache lacks goes to workers in groups, and what comes back is kept at once."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.batch.cache import Cache
from pounding_cli.batch.pool import Pool, end
from pounding_cli.batch.progress import Progress
from pounding_cli.results.keys import solution_key
from pounding_cli.results.solved import Row, Solved, encode, has_result, kind_of, seconds_of

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.batch.attempt import Task
    from pounding_cli.study.plan import Plan

GROUP_SECONDS = 0.25
"""Work [s] that a worker gets at a time, about: what is lost by a kill."""

MOST_SCENES = 128
"""Scenes that a worker gets at a time."""

TIMED = 16
"""Scenes that are solved here first, to see how long one takes."""

WORTH_WORKERS = 1.0
"""Work [s] from which starting workers pays."""

LOST = (
    "lost: the process that solved it ended, twice",
    "it may take too much memory: solve it alone, with `--engine serial`",
)

Answer = tuple[list[int], list[Row]]
"""Numbers of scenes, and their rows."""


class Solver:
    """Solves scenes, each once: what is in the cache is not solved again.

    Parameters
    ----------
    cache : where responses are kept as they come
    pool : where scenes are solved; few are solved here
    progress : told what happens

    Attributes
    ----------
    solved, reused : scenes that were solved now, and those that were found
    failed : status and advice of those that were solved now without a result, by digest
    seconds : time inside the solver now, all workers together [s]
    engine, workers : how scenes were solved; "none" where none was
    """

    def __init__(self, cache: Cache, pool: Pool, progress: Progress) -> None:
        self.cache, self.pool, self.progress = cache, pool, progress
        self.solved, self.reused, self.seconds = 0, 0, 0.0
        self.failed: dict[bytes, tuple[str, str]] = {}
        self.engine, self.workers = "none", 1
        self._seen: set[bytes] = set()  # solved now, or found
        self._mean: float | None = None  # time of a scene [s], once kernels are compiled

    def responses(self, plan: Plan, numbers: np.ndarray | None = None, rough: bool = False) -> Solved:
        """The responses of a plan's scenes, solved where the cache has none.

        Parameters
        ----------
        numbers : the scenes that are wanted; all unless given
        rough : whether the numbers only lead to those that are told: with `estimate: all` the error of buildings alone
            is estimated then, which other scenes share, and no other

        Raises
        ------
        InputError : the cache cannot be written
        KeyboardInterrupt : stopped; what is solved is kept
        """
        wanted = np.arange(len(plan)) if numbers is None else np.unique(numbers[numbers >= 0])
        found = self._found(plan, wanted)
        if rough and plan.estimate == "all":
            plan = replace(plan, estimate="alone")
            found |= self._found(plan, np.setdiff1d(wanted, list(found)))
        digests = {number: plan.digests[number].tobytes() for number in wanted.tolist()}
        new = {number for number, digest in digests.items() if digest not in self._seen}
        # what failed in a run before is solved again too
        missing = [n for n in digests if n not in found or (n in new and not has_result(found[n]))]
        self.reused += len(new.difference(missing))
        self._seen.update(digests.values())
        if missing:
            self._solve(plan, np.array(missing), found)
        return Solved(plan, found)

    def dataset(self, plan: Plan, numbers: np.ndarray | None = None) -> xr.Dataset:
        """All that a results file says of a plan: see `responses` and `results.dataset`."""
        from pounding_cli.results.dataset import dataset

        return dataset(plan, self.responses(plan, numbers))

    def _found(self, plan: Plan, numbers: np.ndarray) -> dict[int, Row]:
        """What the cache has of some scenes, by number."""
        digests = {plan.digests[number].tobytes(): number for number in numbers.tolist()}
        return {digests[digest]: row for digest, row in self.cache.get(solution_key(plan), list(digests))}

    def _solve(self, plan: Plan, missing: np.ndarray, found: dict[int, Row]) -> None:
        """Solve scenes, and put them into the cache and among those that are found."""
        from pounding_cli.batch.attempt import Task  # here: whoever has all scenes needs no numba
        from pounding_cli.solver import solve

        solve.say = self.progress.say
        task = Task(plan.accuracy, plan.method, plan.estimate, plan.time_step, plan.harder)
        key = solution_key(plan)
        self.progress.start(len(missing), self.reused)
        try:
            for numbers, rows in self._each(plan, task, missing):
                mine = {plan.digests[n].tobytes(): row for n, row in zip(numbers, rows, strict=True)}
                self.cache.put(key, mine)
                found.update(zip(numbers, rows, strict=True))
                failed = {digest: kind_of(row[0]).texts[:2] for digest, row in mine.items() if not has_result(row)}
                self.failed |= failed
                self.solved += len(rows)
                self.seconds += sum(map(seconds_of, rows))
                self.progress.step(len(rows) - len(failed), len(failed))
        finally:
            self.progress.stop()

    def _each(self, plan: Plan, task: Task, order: np.ndarray) -> Iterator[Answer]:
        """Groups of scenes and their rows as they come."""

        def here(numbers: np.ndarray) -> Answer:
            return numbers.tolist(), task.rows(list(plan.scenes(numbers)))

        self.engine = "serial" if self.engine == "none" else self.engine
        if self._mean is None:
            first = _first_of_kinds(plan, order)
            yield here(first)  # compiles, or loads what was compiled
            self.progress.compiled()
            order = np.setdiff1d(order, first)
            timed, begin = order[:: max(4, len(order) // TIMED)], time.perf_counter()
            for number in timed:
                yield here(np.array([number]))
            order = np.setdiff1d(order, timed)
            self._mean = (time.perf_counter() - begin) / len(timed) if len(timed) else None
        mean, workers = self._mean or 0.0, self.pool.workers
        size = int(np.clip(GROUP_SECONDS / max(mean, 1e-6), 1, MOST_SCENES))
        by_one = self.pool.name == "serial" or (workers == 1 and self.pool.name == "threads")
        if by_one or mean * len(order) < WORTH_WORKERS:
            yield from map(here, _parts(order, size))
        elif len(order):
            self.engine, self.workers = self.pool.name, workers
            size = max(1, min(size, len(order) // (3 * workers)))
            yield from _by_workers(deque(_parts(order, size)), self.pool, task, plan)


def _parts(numbers: np.ndarray, size: int) -> list[np.ndarray]:
    """`size` numbers in each but the last."""
    return [numbers[begin : begin + size] for begin in range(0, len(numbers), size)]


def _by_workers(todo: deque[np.ndarray], pool: Pool, task: Task, plan: Plan) -> Iterator[Answer]:
    """Numbers of scenes and their rows as groups of `todo` end.

    Where a worker ends, its pool is opened again, and the scenes that were under way go one by one: one that ends its
    worker then too fails alone.
    """
    executor, running = pool.open(), dict[Future, tuple[deque[np.ndarray], np.ndarray]]()
    suspects = deque[np.ndarray]()
    try:
        while todo or suspects or running:
            is_broken = False
            queue, most = (suspects, 1) if suspects else (todo, 2 * pool.workers)
            while queue and len(running) < most and not is_broken:
                try:
                    running[executor.submit(task.rows, list(plan.scenes(queue[0])))] = queue, queue[0]
                    queue.popleft()
                except BrokenExecutor:
                    is_broken = True
            ended = set() if is_broken else wait(running, 1.0, FIRST_COMPLETED)[0]
            if not ended:
                pool.check()
            failed = []
            for future in ended:
                queue, numbers = running.pop(future)
                try:
                    rows = future.result()
                except Exception as error:  # a worker ended; each kind of pool has its own word for it
                    failed.append((queue, numbers))
                    is_broken |= isinstance(error, BrokenExecutor)
                else:
                    yield numbers.tolist(), rows
            if is_broken:
                end(executor, running)
                failed += running.values()
                running.clear()
                executor = pool.open()
            for queue, numbers in failed:
                if queue is suspects:
                    yield numbers.tolist(), [encode(task.without(scene, *LOST)) for scene in plan.scenes(numbers)]
                else:
                    suspects.extend(_parts(numbers, 1))
    finally:
        end(executor, running)


def _first_of_kinds(plan: Plan, order: np.ndarray) -> np.ndarray:
    """One scene of every case and analysis, alone and with neighbours: between them they need all that is compiled."""
    rows, columns = plan.first
    kinds = rows[order] // len(plan.records) % (len(plan.cases) * len(plan.analyses))
    kinds = np.where(columns[order] > 0, -1 - kinds % len(plan.analyses), kinds)
    return order[np.sort(np.unique(kinds, return_index=True)[1])]
