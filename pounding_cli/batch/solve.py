"""Solving the scenes of plans: what the cache lacks goes to workers in groups, and what comes back is kept at once."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.batch.cache import Cache
from pounding_cli.batch.pool import Pool, end
from pounding_cli.batch.progress import Progress
from pounding_cli.results.keys import solution_key
from pounding_cli.results.solved import Row, Solved, encode, has_result, said, seconds_of

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.batch.attempt import Task
    from pounding_cli.model.scene import Scene
    from pounding_cli.study.plan import Plan

GROUP_SECONDS = 0.25
"""Work [s] that a worker gets at a time, about: what is lost by a kill."""

MOST_SCENES = 128
"""Scenes that a worker gets at a time."""

MOST_TIMED = 16
"""Scenes that are solved here first, to see how long one takes."""

WORTH_WORKERS = 1.0
"""Work [s] from which starting workers pays."""

LOST = (
    "lost: the process that solved it ended, twice",
    "it may take too much memory: solve it alone, with `--engine serial`",
)


class Solver:
    """Solves scenes, each once: what is in the cache is not solved again.

    Parameters
    ----------
    cache : where responses are kept as they come
    pool : where scenes are solved; few are solved here
    progress : told what happens
    all_effects : simulate what cannot matter too, whatever a plan says

    Attributes
    ----------
    solved, reused : scenes that were solved now, and those that were found
    failed : status and advice of those that were solved now without a result, by digest
    seconds : time inside the solver now, all workers together [s]
    engine, workers : how scenes were solved; "none" where none was
    """

    def __init__(self, cache: Cache, pool: Pool, progress: Progress, all_effects: bool = False) -> None:
        self.cache, self.pool, self.progress, self.all_effects = cache, pool, progress, all_effects
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
        plan = self.asked(plan)
        wanted = np.arange(len(plan)) if numbers is None else np.unique(numbers[numbers >= 0])
        found = self._found(plan, wanted)
        if rough and plan.estimate == "all":
            roughly = replace(plan, estimate="alone")
            left = np.setdiff1d(wanted, np.fromiter(found, int, len(found)))
            found |= self._found(roughly, left)
        else:
            roughly = plan
        missing = self._missing(plan, wanted, found)
        if missing.size:
            self._solve(roughly, missing, found)
        solved = Solved(plan, most_storeys(plan))
        solved.fill(found.keys(), found.values())
        return solved

    def dataset(self, plan: Plan, numbers: np.ndarray | None = None) -> xr.Dataset:
        """All that a results file says of a plan: see `responses` and `results.dataset`."""
        from pounding_cli.results.dataset import dataset

        return dataset(self.asked(plan), self.responses(plan, numbers))

    def asked(self, plan: Plan) -> Plan:
        """The plan as it is solved."""
        return replace(plan, all_effects=True) if self.all_effects else plan

    def _missing(self, plan: Plan, wanted: np.ndarray, found: dict[int, Row]) -> np.ndarray:
        """The scenes that are to be solved: those that are not found, and those that failed in a run before."""
        missing = []
        for number in wanted.tolist():
            digest = plan.digests[number].tobytes()
            is_new = digest not in self._seen
            if number not in found or (is_new and not has_result(found[number])):
                missing.append(number)
            elif is_new:
                self.reused += 1
            self._seen.add(digest)
        return np.array(missing, int)

    def _found(self, plan: Plan, numbers: np.ndarray) -> dict[int, Row]:
        """What the cache has of some scenes, by number."""
        digests = {plan.digests[number].tobytes(): number for number in numbers.tolist()}
        return {digests[digest]: row for digest, row in self.cache.get(solution_key(plan), list(digests))}

    def _solve(self, plan: Plan, missing: np.ndarray, found: dict[int, Row]) -> None:
        """Solve scenes and put them among those that are found."""
        from pounding_cli.batch.attempt import Task  # here: whoever has all scenes needs no numba
        from pounding_cli.solver import solve

        solve.say = self.progress.say
        task = Task(plan.accuracy, plan.method, plan.estimate, plan.all_effects, plan.time_step, plan.harder)
        key = solution_key(plan)
        self.progress.start(len(missing), self.reused)

        def keep(numbers: Sequence[int], rows: Sequence[Row]) -> None:
            digests = [plan.digests[number].tobytes() for number in numbers]
            self.cache.put(key, dict(zip(digests, rows, strict=True)))
            found.update(zip(numbers, rows, strict=True))
            self.solved += len(rows)
            self.seconds += sum(map(seconds_of, rows))
            failed = {digest: said(row) for digest, row in zip(digests, rows, strict=True) if not has_result(row)}
            self.failed |= failed
            self.progress.step(len(rows) - len(failed), len(failed))

        try:
            for numbers, rows in self._each(plan, task, _ordered(plan, missing)):
                keep(numbers, rows)
        finally:
            self.progress.stop()

    def _each(self, plan: Plan, task: Task, order: np.ndarray) -> Iterator[tuple[list[int], list[Row]]]:
        """Groups of scenes and their rows as they come."""

        def here(numbers: np.ndarray) -> tuple[list[int], list[Row]]:
            return numbers.tolist(), task.rows(list(plan.scenes(numbers)))

        self.engine = "serial" if self.engine == "none" else self.engine
        if self._mean is None:
            first = _first_of_kinds(plan, order)
            yield here(first)  # compiles, or loads what was compiled
            self.progress.compiled()
            order = order[~np.isin(order, first)]
            timed, begin = order[:: max(4, len(order) // MOST_TIMED)], time.perf_counter()
            for number in timed:
                yield here(np.array([number]))
            order = order[~np.isin(order, timed)]
            self._mean = (time.perf_counter() - begin) / len(timed) if len(timed) else None
        mean = self._mean or 0.0
        if not len(order):
            return
        size = int(np.clip(GROUP_SECONDS / max(mean, 1e-6), 1, MOST_SCENES))
        is_small = mean * len(order) < WORTH_WORKERS
        if self.pool.name == "serial" or (self.pool.workers == 1 and self.pool.name == "threads") or is_small:
            for begin in range(0, len(order), size):
                yield here(order[begin : begin + size])
            return
        self.engine, self.workers = self.pool.name, self.pool.workers
        size = max(1, min(size, len(order) // (3 * self.pool.workers)))
        groups = deque(_Group(order[begin : begin + size]) for begin in range(0, len(order), size))
        yield from _by_workers(groups, self.pool, task, lambda numbers: list(plan.scenes(numbers)))


@dataclass(frozen=True, eq=False)
class _Group:
    """Scenes that go to a worker together; `alone`: with nothing else under way, to see whether they end it."""

    numbers: np.ndarray
    alone: bool = False

    def parts(self) -> list[_Group]:
        """Halves of it, to look for the scene that ends its worker."""
        middle = len(self.numbers) // 2
        return [_Group(some, True) for some in (self.numbers[:middle], self.numbers[middle:]) if len(some)]


def _by_workers(
    todo: deque[_Group], pool: Pool, task: Task, scenes: Callable[[np.ndarray], list[Scene]]
) -> Iterator[tuple[list[int], list[Row]]]:
    """Numbers of scenes and their rows as groups end.

    Where a worker ends, its pool is opened again, and the groups that were under way go one by one, in halves where
    that happens again: a scene that ends its worker twice fails alone.
    """
    executor, running = pool.open(), dict[Future, _Group]()
    halt = threading.Event()

    def lost(group: _Group) -> tuple[list[int], list[Row]]:
        return group.numbers.tolist(), [encode(task.without(scene, *LOST)) for scene in scenes(group.numbers)]

    try:
        while todo or running:
            broken = _fill(executor, running, todo, pool, task, scenes, halt)
            ended = set() if broken else wait(running, 1.0, FIRST_COMPLETED)[0]
            if not ended:
                pool.check()
            failed: list[_Group] = []
            for future in ended:
                group = running.pop(future)
                try:
                    yield group.numbers.tolist(), future.result()
                except BrokenExecutor:
                    failed.append(group)
                except Exception:  # a worker of Dask ended
                    if group.alone and len(group.numbers) == 1:
                        yield lost(group)
                    else:
                        todo.extend(group.parts() if len(group.numbers) > 1 else [_Group(group.numbers, True)])
            if failed or broken:
                end(executor, running)
                failed += running.values()
                running.clear()
                executor = pool.open()
                guilty = len(failed) == 1 and failed[0].alone
                if guilty and len(failed[0].numbers) == 1:
                    yield lost(failed[0])
                elif guilty:
                    todo.extendleft(failed[0].parts())
                else:
                    todo.extendleft(replace(group, alone=True) for group in failed)
    finally:
        halt.set()
        end(executor, running)


def _fill(
    executor: Executor,
    running: dict[Future, _Group],
    todo: deque[_Group],
    pool: Pool,
    task: Task,
    scenes: Callable[[np.ndarray], list[Scene]],
    halt: threading.Event,
) -> bool:
    """Give workers what they have room for; whether the pool turned out to be broken."""
    while todo and len(running) < 2 * pool.workers:
        if running and (todo[0].alone or any(group.alone for group in running.values())):
            return False
        group = todo.popleft()
        more = (halt.is_set,) if pool.name == "threads" else ()
        try:
            running[executor.submit(task.rows, scenes(group.numbers), *more)] = group
        except BrokenExecutor:
            todo.appendleft(group)
            return True
    return False


def _ordered(plan: Plan, missing: np.ndarray) -> np.ndarray:
    """Scenes in the order in which they are solved: those that share their baselines one after the other, the
    baselines first, since the others can often be answered from them."""
    rows = plan.numbers.reshape(-1, plan.numbers.shape[-1])
    _, family = np.unique(rows[:, 1:], axis=0, return_inverse=True)
    flat = np.roll(rows[np.argsort(family.ravel(), kind="stable")], -1, axis=1).ravel()
    found, first = np.unique(flat, return_index=True)
    found = found[np.argsort(first)]
    return found[np.isin(found, missing)]


def _first_of_kinds(plan: Plan, order: np.ndarray) -> np.ndarray:
    """One scene of every case and analysis, alone and with neighbours: between them they need all that is compiled."""
    rows, columns = plan.first
    kinds = rows[order] // len(plan.records) % (len(plan.cases) * len(plan.analyses))
    kinds = np.where(columns[order] > 0, -1 - kinds % len(plan.analyses), kinds)
    return order[np.sort(np.unique(kinds, return_index=True)[1])]


def most_storeys(plan: Plan) -> int:
    """Storeys of the highest building at any point of the sweep."""
    study, sizes = plan.study, [len(axis.values) for axis in plan.axes]
    return max(
        study.building(point, place).storeys
        for place in range(len(plan.buildings))
        for point in np.ndindex(
            *(size if mine else 1 for size, mine in zip(sizes, study.touching("buildings", place), strict=True))
        )
    )
