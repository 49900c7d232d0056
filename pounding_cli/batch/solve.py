"""Solve the scenes of plans: workers get in groups what the cache lacks, and what comes back is kept at once."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pounding_cli.batch.cache import Cache
from pounding_cli.batch.forecast import HISTORY_OVERHEAD, measure_rates
from pounding_cli.batch.pool import Pool, stop_executor
from pounding_cli.batch.progress import Progress
from pounding_cli.results.responses import Responses, Row, encode_response, solution_key
from pounding_cli.solver.kernels import COMPILE_TIME, is_compiled, store_rates
from pounding_cli.solver.response import OUTCOMES

if TYPE_CHECKING:
    from pounding_cli.batch.apart import ApartResponses
    from pounding_cli.batch.attempt import Attempt, GroupResult, Task
    from pounding_cli.batch.parts import SceneList
    from pounding_cli.results.arrays import ResultArrays
    from pounding_cli.study.run_plan import Plan

GROUP_SECONDS = 0.2
"""Work [s] that a worker gets at a time, about: what is lost by a kill, and what Ctrl-C waits for."""

MAX_GROUP_SIZE = 512
"""Largest number of scenes that a worker gets at a time."""

TIMED_SCENES = 16
"""Scenes that are solved here first, to see how long one takes."""

RATED_HISTORIES = 60
"""Time histories of a run by which its rates are measured."""

MIN_PARALLEL_SECONDS = 1.0
"""Work [s] from which starting workers pays."""

LOST_STATUS = "lost: the worker that solved it ended twice"
LOST_ADVICE = "it may need too much memory: solve it alone, with `--engine serial`"


class SolvedGroup(NamedTuple):
    """Scenes of a plan by number, shape (scenes,), and their responses as rows."""

    numbers: np.ndarray
    rows: list[Row]


class Solver:
    """Solves scenes, each once: what is in the cache is not solved again.

    Parameters
    ----------
    cache : where responses are kept as they come
    pool : where scenes are solved; few are solved here
    progress : takes in what happens

    Attributes
    ----------
    solved_count, reused_count : scenes that were solved now, and those that were found solved
    divided_count, part_count : of those solved now, scenes that were put together from parts, and the parts that were
        solved for them, without buildings alone
    failures : status and advice of those that were solved now without a result, by digest
    seconds : time inside the solver now, all workers together [s]
    engine, workers : how scenes were solved; "none" where none was
    """

    def __init__(self, cache: Cache, pool: Pool, progress: Progress) -> None:
        self.cache = cache
        self.pool = pool
        self.progress = progress
        self.solved_count = 0
        self.reused_count = 0
        self.divided_count = 0
        self.part_count = 0
        self.failures: dict[bytes, tuple[str, str]] = {}
        self.seconds = 0.0
        self.engine = "none"
        self.workers = 1
        self._counted_digests: set[bytes] = set()  # of scenes that were solved now, or found
        self._seconds_per_scene = HISTORY_OVERHEAD
        self._has_stored_rates = False
        self._executor: Executor | None = None  # of the pool, from when it is first needed
        self._task: Task | None = None  # whose neighbours with nothing between them are known
        self._apart_responses: ApartResponses

    def close(self) -> None:
        """End the workers."""
        if self._executor is not None:
            stop_executor(self._executor, ())
            self._executor = None

    def solve_plan(self, plan: Plan, numbers: np.ndarray | None = None, rough: bool = False) -> Responses:
        """Return the responses of a plan's scenes, solved where the cache has none.

        Parameters
        ----------
        numbers : the scenes that are wanted; all unless given
        rough : whether the responses only lead to those that are reported: with `estimate: all` the error of buildings
            alone is estimated then, which other scenes share, and no other

        Raises
        ------
        InputError : the cache cannot be written
        KeyboardInterrupt : stopped; what is solved is kept
        """
        wanted = np.arange(len(plan)) if numbers is None else np.unique(numbers[numbers >= 0])
        solved = Responses(plan)
        self._load_rows(plan, wanted, solved)
        if rough and plan.estimate == "all":
            plan = replace(plan, estimate="alone")
            self._load_rows(plan, wanted[~solved.is_known[wanted]], solved)
        digests = [plan.digests[number].tobytes() for number in wanted.tolist()]
        is_new = np.array([digest not in self._counted_digests for digest in digests], bool)
        self._counted_digests.update(digests)
        has_failed_before = is_new & ~solved.has_result[wanted]  # in an earlier run; it is solved again
        is_missing = ~solved.is_known[wanted] | has_failed_before
        self.reused_count += int((is_new & ~is_missing).sum())
        if is_missing.any():
            self._solve_missing(plan, wanted[is_missing], solved)
        return solved

    def solve_arrays(self, plan: Plan, numbers: np.ndarray | None = None) -> ResultArrays:
        """Return all that a results file says of a plan: see `solve_plan` and `results.dataset`."""
        from pounding_cli.results.dataset import build_arrays

        return build_arrays(plan, self.solve_plan(plan, numbers))

    def iter_histories(self, plan: Plan, arrays: ResultArrays) -> Iterator[tuple[tuple[int, ...], ResultArrays]]:
        """Yield the histories that a plan keeps, each with the index of its row: see `results.histories`.

        arrays : of the plan
        """
        from pounding_cli.results.histories import iter_kept_histories

        return iter_kept_histories(plan, arrays, self.progress.write_note, self.cache)

    def _load_rows(self, plan: Plan, numbers: np.ndarray, solved: Responses) -> None:
        """Take some scenes from the cache."""
        number_by_digest = {plan.digests[number].tobytes(): number for number in numbers.tolist()}
        for rows in self.cache.iter_rows(solution_key(plan), list(number_by_digest)):
            solved.add({number_by_digest[digest]: row for digest, row in rows.items()})

    def _solve_missing(self, plan: Plan, missing: np.ndarray, solved: Responses) -> None:
        """Solve scenes, and put them into the cache and among those that are solved."""
        from pounding_cli.batch.parts import DividedScenes, SceneList

        is_divided = plan.divided[missing]
        whole = missing[~is_divided]
        divided = DividedScenes(plan, missing[is_divided])
        of_known_parts = divided.load(self.cache, plan)
        self.reused_count += len(of_known_parts)
        self._keep_rows(plan, of_known_parts, solved)
        missing = np.setdiff1d(missing, list(of_known_parts))
        if not missing.size:
            return
        self.progress.add_histories(len(missing), self.reused_count)
        task = self._build_task(plan)
        try:
            number_by_digest = {plan.digests[number].tobytes(): number for number in whole.tolist()}
            scenes = SceneList(plan, divided.list_unknown(number_by_digest))
            to_solve = np.concatenate((whole, scenes.part_numbers))
            for numbers, rows in self._iter_groups(scenes, task, to_solve):
                row_by_number = dict(zip(numbers.tolist(), rows, strict=True))
                row_by_digest = {scenes.digest(number): row for number, row in row_by_number.items()}
                parts = [digest for digest in row_by_digest if digest not in number_by_digest]
                self.cache.store(solution_key(plan), {digest: row_by_digest[digest] for digest in parts})
                of_plan = {number: row for number, row in row_by_number.items() if number < len(plan)}
                of_parts = divided.add(row_by_digest, parts)
                self.divided_count += len(of_parts)
                self.part_count += len(parts)
                self._take_rows(plan, of_plan | of_parts, solved)
        finally:
            self.progress.stop_display()
        if not self._has_stored_rates:
            self._store_rates(plan, missing, solved)

    def _take_rows(self, plan: Plan, rows: Mapping[int, Row], solved: Responses) -> None:
        """Keep responses of a plan's scenes that were solved now, and count them."""
        if not rows:
            return
        self._keep_rows(plan, rows, solved)
        self._count_group([plan.digests[number].tobytes() for number in rows], np.array(list(rows)), solved)

    def _keep_rows(self, plan: Plan, rows: Mapping[int, Row], solved: Responses) -> None:
        """Put responses of a plan's scenes, by number, into the cache and among those that are solved."""
        row_by_digest = {plan.digests[number].tobytes(): row for number, row in rows.items()}
        self.cache.store(solution_key(plan), row_by_digest)
        solved.add(rows)

    def _build_task(self, plan: Plan) -> Task:
        """Return the settings of a plan; what is known of neighbours with nothing between them stays while they do."""
        from pounding_cli.batch.apart import ApartResponses  # here: whoever has all scenes needs no numba
        from pounding_cli.batch.attempt import Task

        task = Task(plan.accuracy, plan.method, plan.estimate, plan.time_step, plan.harder)
        if task != self._task:
            self._task = task
            self._apart_responses = ApartResponses()
        return task

    def _count_group(self, digests: Sequence[bytes], numbers: np.ndarray, solved: Responses) -> None:
        """Take in a group of scenes that came back."""
        failed_count = 0
        statuses = solved.texts["status"][numbers]
        advices = solved.texts["advice"][numbers]
        for digest, status, advice in zip(digests, statuses, advices, strict=True):
            if status not in OUTCOMES:
                self.failures[digest] = (status, advice)
                failed_count += 1
        self.solved_count += len(digests)
        self.seconds += float(solved.values["seconds"][numbers].sum())
        self.progress.count_solved(len(digests) - failed_count, failed_count)

    def _store_rates(self, plan: Plan, numbers: np.ndarray, solved: Responses) -> None:
        """Keep the rates of the first time histories of a run, for `pound check`."""
        some = numbers[:: max(1, len(numbers) // RATED_HISTORIES)]
        store_rates(measure_rates(plan, some, solved.values["seconds"]))
        self._has_stored_rates = True

    def _iter_groups(self, scenes: SceneList, task: Task, numbers: np.ndarray) -> Iterator[SolvedGroup]:
        """Yield groups of scenes and their rows as they are solved."""
        if not numbers.size:
            return
        run = _PlanRun(scenes, task, self._apart_responses, self.progress)
        if self.engine == "none":
            self.engine = "serial"
        if self.solved_count:
            seconds = HISTORY_OVERHEAD + self.seconds / self.solved_count
            self._seconds_per_scene = max(self._seconds_per_scene, seconds)
        else:
            first = numbers[:: max(4, len(numbers) // TIMED_SCENES)]
            yield run.solve_here(first[:1])  # compiles kernels, or loads them
            begin = time.perf_counter()
            yield from map(run.solve_here, _split_groups(first[1:], 1))
            if len(first) > 1:
                self._seconds_per_scene = (time.perf_counter() - begin) / (len(first) - 1)
            numbers = np.setdiff1d(numbers, first)
        size = int(np.clip(GROUP_SECONDS / self._seconds_per_scene, 1, MAX_GROUP_SIZE))
        workers = self.pool.workers
        is_serial = self.pool.name == "serial" or (workers == 1 and self.pool.name == "threads")
        if is_serial or self._seconds_per_scene * len(numbers) < MIN_PARALLEL_SECONDS:
            yield from map(run.solve_here, _split_groups(numbers, size))
        elif len(numbers):
            self.engine = self.pool.name
            self.workers = workers
            yield from self._iter_from_workers(_split_groups(numbers, size, 4 * workers), run)

    def _iter_from_workers(self, groups: list[np.ndarray], run: _PlanRun) -> Iterator[SolvedGroup]:
        """Yield groups of scenes and their rows as workers return them.

        Where a worker ends, its pool is opened again, and the scenes that were under way go alone: one that ends its
        worker then too is lost.
        """
        waiting = deque(groups)
        going_alone = set[int]()
        executor = self._executor = self._executor or self.pool.open()
        running: dict[Future[GroupResult], np.ndarray] = {}
        try:
            while waiting or running:
                lost = list[np.ndarray]()
                is_broken = False
                next_groups = (*running.values(), *islice(waiting, 1))
                max_running = 1 if any(group[0] in going_alone for group in next_groups) else 2 * self.pool.workers
                try:
                    while waiting and len(running) < max_running:
                        running[run.submit(executor, waiting[0], self.pool.shares_memory)] = waiting[0]
                        waiting.popleft()
                except BrokenExecutor:
                    is_broken = True
                ended = set() if is_broken else wait(running, 1.0, FIRST_COMPLETED)[0]
                if not ended:
                    self.pool.check()
                for future in ended:
                    numbers = running.pop(future)
                    try:
                        result = future.result()
                    except Exception as error:  # a worker ended; each kind of pool has its own word for it
                        lost.append(numbers)
                        is_broken |= isinstance(error, BrokenExecutor)
                    else:
                        yield run.take_result(numbers, result)
                if is_broken:
                    stop_executor(executor, running)
                    lost += running.values()
                    running.clear()
                    executor = self._executor = self.pool.open()
                for numbers in lost:
                    if numbers[0] in going_alone:
                        yield run.build_lost_group(numbers)
                    else:
                        going_alone.update(numbers.tolist())
                        waiting.extendleft(_split_groups(numbers, 1))
        finally:
            if running:  # stopped on the way
                stop_executor(executor, running)
                self._executor = None


class _PlanRun:
    """Groups of scenes, as they are given to whoever solves them.

    Parameters
    ----------
    scene_list : the scenes of a plan, and parts of them
    task : settings
    apart_responses : what is known of neighbours with nothing between them by these settings; new ones are added
    progress : takes in which kernels are compiled
    """

    def __init__(self, scene_list: SceneList, task: Task, apart_responses: ApartResponses, progress: Progress) -> None:
        self.scene_list = scene_list
        self.task = task
        self.apart_responses = apart_responses
        self.progress = progress
        self._uncompiled = {kernel for kernel in COMPILE_TIME if not is_compiled(kernel)}
        self._viewed_kinds = set[tuple[Any, ...]]()  # of scenes whose kernels are known

    def solve_here(self, numbers: np.ndarray) -> SolvedGroup:
        """Return a group of scenes solved in this thread."""
        return SolvedGroup(numbers, self.task.run(self._list_attempts(numbers), self.apart_responses).rows)

    def submit(self, executor: Executor, numbers: np.ndarray, shares_memory: bool) -> Future[GroupResult]:
        """Return the future result of a group of scenes that a worker solves.

        shares_memory : the worker is a thread of this process
        """
        attempts = self._list_attempts(numbers)
        known = self.apart_responses
        if not shares_memory:
            known = known.select(attempt.apart.scene for attempt in attempts if attempt.apart is not None)
        return executor.submit(self.task.run, attempts, known)

    def take_result(self, numbers: np.ndarray, result: GroupResult) -> SolvedGroup:
        """Return a group of scenes that a worker solved; what it found of neighbours is known from now on."""
        self.apart_responses.add(result.apart_responses)
        return SolvedGroup(numbers, result.rows)

    def build_lost_group(self, numbers: np.ndarray) -> SolvedGroup:
        """Return scenes that ended their worker, without results."""
        responses = [
            self.task.build_failed_response(scene, LOST_STATUS, LOST_ADVICE)
            for scene in self.scene_list.scenes(numbers)
        ]
        return SolvedGroup(numbers, [encode_response(response) for response in responses])

    def _list_attempts(self, numbers: np.ndarray) -> list[Attempt]:
        """Return the attempts to solve some scenes, after a note on kernels that are compiled for them."""
        attempts = self.task.list_attempts(self.scene_list.scenes(numbers))
        if self._uncompiled:
            self._announce_kernels(attempts)
        return attempts

    def _announce_kernels(self, attempts: Sequence[Attempt]) -> None:
        """Write a note on every kernel that is compiled for these scenes, the first time that one needs it."""
        for scene, _ in attempts:
            laws = tuple(type(link.law) for link in scene.links)
            buildings = tuple(map(id, scene.buildings))  # the plan holds them, so that no other gets their id
            kind = (buildings, laws, scene.analysis, self.task.is_assessed(scene))
            if kind in self._viewed_kinds:  # to lay out every scene would take a hundredth of the time of a short one
                continue
            self._viewed_kinds.add(kind)
            for kernel in self.task.list_kernels(scene):
                if kernel in self._uncompiled:
                    self._uncompiled.remove(kernel)
                    seconds = COMPILE_TIME[kernel]
                    self.progress.write_note(f"compiling {kernel}, once on this computer (about {seconds:.0f} s)")


def _split_groups(numbers: np.ndarray, size: int, share: int = 1) -> list[np.ndarray]:
    """Return groups of at most `size` numbers.

    share : a group is at most one part in `share` of what is left, so that workers end together
    """
    groups = []
    while len(numbers):
        count = max(1, min(size, len(numbers) // share))
        groups.append(numbers[:count])
        numbers = numbers[count:]
    return groups
