"""The process engine: scenes in bundles on several cores; a worker that dies costs one scene, no more."""

from __future__ import annotations

import itertools
import multiprocessing
import signal
import sys
import time
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool

from pounding_cli.batch.attempt import Task
from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import Response

Bundle = list[tuple[str, Scene]]

BUNDLE_SECONDS = 0.1
"""Work in one bundle: long against sending it (a millisecond), short against a user's patience."""

BUNDLE_MOST = 256
"""Scenes in one bundle at most, so that little is lost when a worker dies."""

_AHEAD = 3
"""Bundles handed out per worker: one at work, two waiting, so that no worker idles and memory stays small."""


_GRACE = 2.0
"""Time a worker has to end by itself [s]."""


class Processes:
    """See `engines.Engine`."""

    name = "processes"

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def solve(
        self, scenes: Iterable[tuple[str, Scene]], task: Task, expected: float
    ) -> Generator[tuple[str, Response]]:
        """The scenes as their bundles come back."""
        size = max(1, min(BUNDLE_MOST, int(BUNDLE_SECONDS / max(expected, 1e-9))))
        bundles = _bundles(scenes, size)
        suspects: list[Bundle] = []
        while True:
            yield from self._until_broken(bundles, task, suspects)
            if not suspects:
                return
            for digest, scene in itertools.chain.from_iterable(suspects):
                yield digest, _alone(digest, scene, task)
            suspects.clear()

    def _until_broken(
        self, bundles: Iterator[Bundle], task: Task, suspects: list[Bundle]
    ) -> Generator[tuple[str, Response]]:
        """Solve until the bundles end, or a worker dies: then `suspects` holds the bundles that were out."""
        running: dict[Future, Bundle] = {}
        pool = _pool(self.workers, task)

        def hand_out(most: int) -> None:
            for bundle in itertools.islice(bundles, most):
                suspects.append(bundle)  # until the pool has taken it
                running[pool.submit(_solve, bundle)] = bundle
                suspects.pop()

        try:
            hand_out(self.workers * _AHEAD)
            while running:
                ready, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in ready:
                    yield from future.result()
                    del running[future]
                hand_out(len(ready))
        except BrokenProcessPool:
            suspects.extend(running.values())
        finally:
            _end(pool)


def _alone(digest: str, scene: Scene, task: Task) -> Response:
    """Solve one scene in a worker of its own; if that dies too, the scene is the cause."""
    pool = _pool(1, task)
    try:
        return pool.submit(_solve, [(digest, scene)]).result()[0][1]
    except BrokenProcessPool:
        advice = "memory may be short: use fewer workers; otherwise report it with the study file"
        return task.without(scene, "the worker died", advice)
    finally:
        _end(pool)


def _pool(workers: int, task: Task) -> ProcessPoolExecutor:
    # Forked workers inherit the compiled kernels; elsewhere forking is not safe and each worker loads them.
    context = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
    return ProcessPoolExecutor(workers, mp_context=context, initializer=_begin, initargs=(task,))


def _end(pool: ProcessPoolExecutor) -> None:
    """End the workers; a bundle at work may end by itself, so that no message is cut in two."""
    workers = list((pool._processes or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    deadline = time.monotonic() + _GRACE
    for worker in workers:
        worker.join(max(0.0, deadline - time.monotonic()))
        if worker.is_alive():
            worker.terminate()


def _bundles(scenes: Iterable[tuple[str, Scene]], size: int) -> Iterator[Bundle]:
    rest = iter(scenes)
    while bundle := list(itertools.islice(rest, size)):
        yield bundle


_task: Task | None = None
"""In a worker: how it solves scenes."""


def _begin(task: Task) -> None:
    """Start of a worker; Ctrl-C is for the parent, which then ends its workers."""
    global _task
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _task = task


def _solve(bundle: Bundle) -> list[tuple[str, Response]]:
    assert _task is not None
    return [(digest, _task(scene)) for digest, scene in bundle]
