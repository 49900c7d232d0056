"""The thread engine: the compiled solver lets go of the interpreter, so threads of one process solve side by side."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from threading import Event
from typing import Any

from pounding_cli.batch.bundles import Queue, Work, solve_bundle
from pounding_cli.batch.engines import Engine, Finished
from pounding_cli.model.placed import found
from pounding_cli.store.chunk import Chunk


class Threads(Engine):
    """See `engines.Engine`; for systems where starting processes is slow or forbidden."""

    name = "threads"

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def solve(self, queue: Queue, scenes: Mapping[str, Any], task: Work, key: str) -> Generator[Finished]:
        """The scenes as threads finish them."""
        stop = Event()
        running: dict[Future[tuple[Chunk, float]], list[str]] = {}
        pool = ThreadPoolExecutor(self.workers, thread_name_prefix="pound")
        try:
            while queue or running:
                while queue and len(running) < self.workers:
                    bundle = queue.take()
                    job = pool.submit(solve_bundle, bundle, found(scenes, bundle), task, stopped=stop.is_set)
                    running[job] = bundle
                ready, _ = wait(running, return_when=FIRST_COMPLETED)
                for job in ready:
                    bundle = running.pop(job)
                    chunk, seconds = job.result()
                    queue.give_back(bundle[len(chunk) :])
                    queue.learn(len(chunk), seconds)
                    yield Finished(chunk)
        finally:
            stop.set()
            pool.shutdown()
