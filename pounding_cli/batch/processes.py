"""The process engine: workers on the cores of this machine; one that ends loses one scene."""

from __future__ import annotations

import gc
import multiprocessing
import os
import pickle
import signal
import sys
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from multiprocessing.connection import Connection, wait
from typing import Any

from pounding_cli.batch.bundles import Queue, Work, solve_bundle
from pounding_cli.batch.engines import Engine, Finished
from pounding_cli.model.placed import Placed, found
from pounding_cli.model.scene import Scene
from pounding_cli.store.chunk import Chunk

_GRACE = 2.0
"""Time a worker has to end after it was told to [s]."""

_STOPPED = 30.0
"""A worker that was stopped (SIGSTOP) for so long is ended, and its scenes are solved by another [s]."""

_LOOK = 1.0
"""Time between two looks at workers that say nothing [s]."""

Told = Scene | int | str
"""A scene as a worker is told of it: itself, or, where it inherits all, its place among them or its digest."""

DIED = "the worker died"
ADVICE = "memory may be short: use fewer workers; otherwise report it with the study file"


class Processes(Engine):
    """See `engines.Engine`.

    Workers are forked on Linux and spawned elsewhere, unless `multiprocessing.set_start_method` says otherwise.
    """

    name = "processes"

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def solve(self, queue: Queue, scenes: Mapping[str, Scene], task: Work, key: str) -> Generator[Finished]:
        """The scenes as workers finish them."""
        staff = _Staff(scenes, task, key)
        suspects: list[str] = []
        tried: set[str] = set()

        def hand_out() -> None:
            while (queue or suspects) and len(staff.busy) < self.workers:
                staff.send([suspects.pop()] if suspects else queue.take())

        try:
            while queue or suspects or staff.busy:
                hand_out()
                for worker in staff.ready():
                    bundle = staff.busy.pop(worker)
                    answer = worker.answer()
                    if answer is not None:
                        content, seconds = answer
                        chunk = Chunk.from_bytes(content, key, bundle)
                        assert chunk is not None
                        staff.idle.append(worker)
                        queue.give_back(bundle[len(chunk) :])
                        queue.learn(len(chunk), seconds)
                        hand_out()  # now: to bring a chunk to the disk takes milliseconds
                        yield Finished(chunk, content)
                        continue
                    worker.end()
                    culprit = bundle.pop(worker.place())
                    queue.give_back(bundle)
                    if culprit in tried:
                        yield Finished(Chunk.of({culprit: task.without(scenes[culprit], DIED, ADVICE)}))
                    else:  # once more, alone: something else may have killed the worker
                        tried.add(culprit)
                        suspects.append(culprit)
        finally:
            staff.end()


def _start_method() -> str:
    """How processes begin. Forked workers inherit the compiled kernels and the plan; where forking is not safe, scenes
    are sent."""
    return multiprocessing.get_start_method(allow_none=True) or ("fork" if sys.platform == "linux" else "spawn")


def apart(work: Callable[[], object]) -> None:
    """Do some work in a fork, whose memory is free again at its end. Whatever goes wrong there is not told; nothing is
    done where processes are not forked."""
    if _start_method() == "fork":
        process = multiprocessing.get_context("fork").Process(target=_quietly, args=(work,), daemon=True)
        process.start()
        process.join()


def _quietly(work: Callable[[], object]) -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with suppress(Exception):
        work()


class _Staff:
    """The workers: at work on a bundle, or idle; hired when they are needed."""

    def __init__(self, scenes: Mapping[str, Scene], task: Work, key: str) -> None:
        method = _start_method()
        self._forks = method == "fork"
        self._context: Any = multiprocessing.get_context(method)
        self._scenes, self._task, self._key = scenes, task, key
        self.busy: dict[_Worker, list[str]] = {}
        self.idle: list[_Worker] = []

    def send(self, bundle: list[str]) -> None:
        """Give an idle or a new worker a bundle."""
        worker = self.idle.pop() if self.idle else self._hired()
        self.busy[worker] = bundle
        worker.give(list(zip(bundle, self._told(bundle), strict=True)))

    def _told(self, bundle: list[str]) -> Sequence[Told]:
        """What a worker needs to know of scenes."""
        if not self._forks:
            return list(map(found(self._scenes, bundle), bundle))
        return self._scenes.places(bundle) if isinstance(self._scenes, Placed) else bundle

    def _hired(self) -> _Worker:
        others = [worker.line for worker in (*self.busy, *self.idle)]
        return _Worker(self._context, self._scenes if self._forks else None, self._task, self._key, others)

    def ready(self) -> list[_Worker]:
        """Wait for workers that have finished or died."""
        by_line = {worker.line: worker for worker in self.busy}
        while not (lines := wait(list(by_line), _LOOK)):
            for worker in self.busy:
                worker.end_if_stopped()
        return [by_line[line] for line in lines if isinstance(line, Connection)]

    def end(self) -> None:
        """End all workers: what they are at is lost, what they have sent is not."""
        workers = (*self.busy, *self.idle)
        for worker in workers:
            worker.tell()
        deadline = time.monotonic() + _GRACE
        for worker in workers:
            worker.end(deadline)


class _Worker:
    """One worker process, seen from the parent."""

    def __init__(
        self, context: Any, scenes: Mapping[str, Scene] | None, task: Work, key: str, others: Sequence[Connection]
    ) -> None:
        self.line, far = context.Pipe()
        self._place = context.RawValue("q", 0)
        self._runs = time.monotonic()  # when it was last seen not to be stopped
        # A fork holds the parent's ends of all pipes; it closes them, so that workers see when the parent is gone.
        inherited = (self.line, *others) if scenes is not None else ()
        arguments = (far, self._place, scenes, task, key, inherited)
        self._process = context.Process(target=_work, args=arguments, daemon=True)
        self._process.start()
        far.close()

    def give(self, bundle: Sequence[Any]) -> None:
        self._place.value = 0
        self._runs = time.monotonic()
        with suppress(OSError):  # it has died: its line says so when it is looked at
            self.line.send(bundle)

    def answer(self) -> tuple[bytes, float] | None:
        """The bytes of a chunk and the time it took [s]; None when the worker has died."""
        try:
            return self.line.recv()
        except (EOFError, OSError, pickle.UnpicklingError):
            return None

    def place(self) -> int:
        """The place in its bundle of the scene it was last at."""
        return int(self._place.value)

    def end_if_stopped(self) -> None:
        """End it if it was stopped at every look for _STOPPED seconds; its line then says that it has died."""
        now = time.monotonic()
        self._runs = self._runs if self._is_stopped() else now
        if now - self._runs > _STOPPED:
            self._process.kill()

    def _is_stopped(self) -> bool:
        if not hasattr(os, "waitid"):
            return False
        try:
            # Only stops are asked for, and left to be seen again: whether it has ended is multiprocessing's to ask.
            return os.waitid(os.P_PID, self._process.pid, os.WSTOPPED | os.WNOHANG | os.WNOWAIT) is not None
        except ChildProcessError:
            return False

    def tell(self) -> None:
        self.line.close()
        self._process.terminate()

    def end(self, deadline: float | None = None) -> None:
        """Wait until it has ended, and make it."""
        if deadline is None:
            self.line.close()
            deadline = time.monotonic() + _GRACE
        self._process.join(max(0.0, deadline - time.monotonic()))
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def _work(
    line: Connection,
    place: Any,
    scenes: Mapping[str, Scene] | None,
    task: Work,
    key: str,
    inherited: Sequence[Connection],
) -> None:
    """A worker's life; Ctrl-C is for the parent, which then ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    gc.freeze()  # a collection would write to, and so copy, every page shared with the parent
    for other in inherited:
        other.close()

    def begins(number: int) -> None:
        place.value = number

    with suppress(EOFError, OSError):  # the parent is gone
        while True:
            told: dict[str, Told] = dict(line.recv())
            chunk, seconds = solve_bundle(list(told), partial(_scene, scenes, told), task, begins)
            line.send((chunk.to_bytes(key), seconds))


def _scene(scenes: Mapping[str, Scene] | None, told: Mapping[str, Told], digest: str) -> Scene:
    """A scene that a worker was told of."""
    what = told[digest]
    if isinstance(what, Scene):
        return what
    assert scenes is not None
    if isinstance(what, str):
        return scenes[what]
    assert isinstance(scenes, Placed)
    return scenes.at(what)
