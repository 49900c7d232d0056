"""Solving the scenes of plans: what the cache lacks goes to workers in groups, and what comes back is kept at once."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.batch.cache import Cache
from pounding_cli.batch.forecast import BESIDE, measure_rates
from pounding_cli.batch.pool import Pool, end
from pounding_cli.batch.progress import Progress
from pounding_cli.results.solved import Row, Solved, encode, solution_key
from pounding_cli.solver.kernels import store_rates
from pounding_cli.solver.response import OUTCOMES

if TYPE_CHECKING:
    from pounding_cli.batch.attempt import Task
    from pounding_cli.results.arrays import ResultArrays
    from pounding_cli.study.plan import Plan

GROUP_SECONDS = 0.2
"""Work [s] that a worker gets at a time, about: what is lost by a kill, and what Ctrl-C waits for."""

MOST_SCENES = 512
"""Scenes that a worker gets at a time."""

TIMED = 16
"""Scenes that are solved here first, to see how long one takes."""

MEASURED = 60
"""Time histories of a run by which its rates are measured."""

WORTH_WORKERS = 1.0
"""Work [s] from which starting workers pays."""

LOST = (
    "lost: the process that solved it ended, twice",
    "it may take too much memory: solve it alone, with `--engine serial`",
)

Answer = tuple[np.ndarray, list[Row]]
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
        self._each_takes = BESIDE  # [s]
        self._is_measured = False  # whether the rates of this run are kept
        self._executor: Executor | None = None  # of the pool, from when it is first needed

    def close(self) -> None:
        """End the workers."""
        if self._executor is not None:
            end(self._executor, ())
            self._executor = None

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
        solved = Solved(plan)
        self._find(plan, wanted, solved)
        if rough and plan.estimate == "all":
            plan = replace(plan, estimate="alone")
            self._find(plan, wanted[~solved.there[wanted]], solved)
        digests = [plan.digests[number].tobytes() for number in wanted.tolist()]
        new = np.array([digest not in self._seen for digest in digests], bool)
        self._seen.update(digests)
        missing = ~solved.there[wanted] | (new & ~solved.ended[wanted])  # what failed in a run before is solved too
        self.reused += int((new & ~missing).sum())
        if missing.any():
            self._solve(plan, wanted[missing], solved)
        return solved

    def contents(self, plan: Plan, numbers: np.ndarray | None = None) -> ResultArrays:
        """All that a results file says of a plan: see `responses` and `results.dataset`."""
        from pounding_cli.results.dataset import build_arrays

        return build_arrays(plan, self.responses(plan, numbers))

    def _find(self, plan: Plan, numbers: np.ndarray, solved: Solved) -> None:
        """Take some scenes from the cache."""
        digests = {plan.digests[number].tobytes(): number for number in numbers.tolist()}
        for rows in self.cache.get(solution_key(plan), list(digests)):
            solved.put({digests[digest]: row for digest, row in rows.items()})

    def _solve(self, plan: Plan, missing: np.ndarray, solved: Solved) -> None:
        """Solve scenes, and put them into the cache and among those that are solved."""
        from pounding_cli.batch.attempt import Task  # here: whoever has all scenes needs no numba
        from pounding_cli.solver import solve

        solve.say = self.progress.say
        task = Task(plan.accuracy, plan.method, plan.estimate, plan.time_step, plan.harder)
        self.progress.start(len(missing), self.reused)
        try:
            for numbers, rows in self._each(plan, task, missing):
                digests = [plan.digests[number].tobytes() for number in numbers]
                self.cache.put(solution_key(plan), dict(zip(digests, rows, strict=True)))
                solved.put(dict(zip(numbers.tolist(), rows, strict=True)))
                said = zip(solved.texts["status"][numbers], solved.texts["advice"][numbers], strict=True)
                failed = {digest: each for digest, each in zip(digests, said, strict=True) if each[0] not in OUTCOMES}
                self.failed |= failed
                self.solved += len(rows)
                self.seconds += float(solved.values["seconds"][numbers].sum())
                self.progress.step(len(rows) - len(failed), len(failed))
        finally:
            self.progress.stop()
        self._measure(plan, missing, solved)

    def _measure(self, plan: Plan, numbers: np.ndarray, solved: Solved) -> None:
        """Keep the rates of the first time histories of a run, for `pound check`."""
        if not self._is_measured:
            some = numbers[:: max(1, len(numbers) // MEASURED)]
            store_rates(measure_rates(plan, some, solved.values["seconds"]))
            self._is_measured = True

    def _each(self, plan: Plan, task: Task, order: np.ndarray) -> Iterator[Answer]:
        """Groups of scenes and their rows as they come."""

        def here(numbers: np.ndarray) -> Answer:
            return numbers, task.rows(list(plan.scenes(numbers)))

        self.engine = "serial" if self.engine == "none" else self.engine
        if self.solved:
            self._each_takes = max(self._each_takes, BESIDE + self.seconds / self.solved)
        else:
            first = order[:: max(4, len(order) // TIMED)]
            yield here(first[:1])  # compiles, or loads what was compiled
            begin = time.perf_counter()
            yield from map(here, _parts(first[1:], 1))
            if len(first) > 1:
                self._each_takes = (time.perf_counter() - begin) / (len(first) - 1)
            order = np.setdiff1d(order, first)
        workers, size = self.pool.workers, int(np.clip(GROUP_SECONDS / self._each_takes, 1, MOST_SCENES))
        by_one = self.pool.name == "serial" or (workers == 1 and self.pool.name == "threads")
        if by_one or self._each_takes * len(order) < WORTH_WORKERS:
            yield from map(here, _parts(order, size))
        elif len(order):
            self.engine, self.workers = self.pool.name, workers
            yield from self._by_workers(_parts(order, size, 4 * workers), task, plan)

    def _by_workers(self, parts: list[np.ndarray], task: Task, plan: Plan) -> Iterator[Answer]:
        """Parts of the scenes and their rows as they end.

        Where a worker ends, its pool is opened again, and the scenes that were under way go alone: one that ends its
        worker then too is lost.
        """
        todo, alone = deque(parts), set[int]()  # scenes that go alone
        executor = self._executor = self._executor or self.pool.open()
        running = dict[Future, np.ndarray]()
        try:
            while todo or running:
                lost, is_broken = list[np.ndarray](), False
                next_to = (*running.values(), *islice(todo, 1))
                most = 1 if any(part[0] in alone for part in next_to) else 2 * self.pool.workers
                try:
                    while todo and len(running) < most:
                        running[executor.submit(task.rows, list(plan.scenes(todo[0])))] = todo[0]
                        todo.popleft()
                except BrokenExecutor:
                    is_broken = True
                ended = set() if is_broken else wait(running, 1.0, FIRST_COMPLETED)[0]
                if not ended:
                    self.pool.check()
                for future in ended:
                    numbers = running.pop(future)
                    try:
                        rows = future.result()
                    except Exception as error:  # a worker ended; each kind of pool has its own word for it
                        lost.append(numbers)
                        is_broken |= isinstance(error, BrokenExecutor)
                    else:
                        yield numbers, rows
                if is_broken:
                    end(executor, running)
                    lost += running.values()
                    running.clear()
                    executor = self._executor = self.pool.open()
                for numbers in lost:
                    if numbers[0] in alone:
                        yield numbers, [encode(task.without(scene, *LOST)) for scene in plan.scenes(numbers)]
                    else:
                        alone.update(numbers.tolist())
                        todo.extendleft(_parts(numbers, 1))
        finally:
            if running:  # stopped on the way
                end(executor, running)
                self._executor = None


def _parts(numbers: np.ndarray, size: int, share: int = 1) -> list[np.ndarray]:
    """Parts of `size` numbers; towards the end of what is left one in `share`, so that workers end together."""
    parts = []
    while len(numbers):
        count = max(1, min(size, len(numbers) // share))
        parts.append(numbers[:count])
        numbers = numbers[count:]
    return parts
