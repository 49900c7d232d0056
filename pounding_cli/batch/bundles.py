"""Bundles: the scenes that go to a worker at a time, and the chunk that comes back and is kept whole."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from pounding_cli.solver.response import Response
from pounding_cli.store.chunk import Chunk

CHUNK_SECONDS = 0.5
"""Work in one chunk: long against sending and keeping it (milliseconds), little to lose."""

LEAST = 0.1
"""Work in the last chunks over that in the others: an idle worker waits for so much at most."""

FARTHEST = 0.5
"""Part of a bundle by which it may be longer or shorter so that families stay whole."""

MOST = 1000
"""Scenes in one bundle at most."""

TOGETHER = 256
"""Scenes that are taken step by step together (`Work.each`)."""

_LATE = 2.0
"""A worker that has been at a bundle for so many times the work wanted gives the rest of it back."""


class Work(Protocol):
    """How every scene of a run is solved; goes to the workers once."""

    def __call__(self, scene: Any) -> Response:
        """The response of a scene; whatever goes wrong in it becomes a failed response."""
        ...

    def each(
        self, scenes: Sequence[Any], begins: Callable[[int], None], halted: Callable[[], bool]
    ) -> Sequence[Response]:
        """The responses of scenes in their order; only the first of them, at least one, where it is `halted`.

        begins : told the place of every scene before something of it is run
        """
        ...

    def without(self, scene: Any, status: str, advice: str) -> Response:
        """The response of a scene that gave none."""
        ...


class Queue:
    """The scenes still to be solved, in order; says how many make half a second of work.

    Parameters
    ----------
    digests : in the order in which they are to be solved
    workers : that take from it
    seconds : expected time of one scene [s]
    families : places where a family of scenes begins, rising: bundles end there if they can, since every worker that
        has one of a family solves its baselines
    """

    def __init__(
        self, digests: Sequence[str], workers: int, seconds: float, families: np.ndarray | None = None
    ) -> None:
        self._digests, self._next = digests, 0
        self._families = np.array([*(() if families is None else families), len(digests)])
        self._back: list[str] = []  # what came back, the next one last
        self._workers = workers
        self._seconds, self._scenes = max(seconds, 1e-6), 1

    def __len__(self) -> int:
        return len(self._digests) - self._next + len(self._back)

    def take(self, work: float | None = None) -> list[str]:
        """The next bundle, of about `work` seconds; towards the end smaller ones, so that all workers end together."""
        size = (CHUNK_SECONDS if work is None else work) / (self._seconds / self._scenes)
        if self._workers > 1:
            size = min(size, max(len(self) / (3 * self._workers), LEAST * size))
        size = max(1, min(math.ceil(size), MOST))
        bundle = self._back[: -size - 1 : -1]
        del self._back[len(self._back) - len(bundle) :]
        end = self._next + size - len(bundle)
        if self._workers > 1 and not bundle:
            end = self._end_near(end, size)
        new = self._digests[self._next : end]
        self._next += len(new)
        return [*bundle, *new]

    def _end_near(self, end: int, size: int) -> int:
        """The end of a family that a bundle may have in place of `end`."""
        place = int(np.searchsorted(self._families, end))
        near = self._families[max(0, place - 1) : place + 1]
        nearest = int(near[np.argmin(np.abs(near - end))])
        allowed = nearest > self._next and abs(nearest - end) <= FARTHEST * size and nearest - self._next <= MOST
        return nearest if allowed else end

    def give_back(self, digests: Sequence[str]) -> None:
        """Scenes that were taken and not solved; they come next."""
        self._back.extend(reversed(digests))

    def learn(self, scenes: int, seconds: float) -> None:
        """Some scenes took so long [s]."""
        self._scenes += scenes
        self._seconds += seconds


def solve_bundle(
    bundle: Sequence[str],
    scene_of: Callable[[str], Any],
    task: Work,
    begins: Callable[[int], None] = lambda place: None,
    stopped: Callable[[], bool] = lambda: False,
    work: float = CHUNK_SECONDS,
) -> tuple[Chunk, float]:
    """Solve scenes until they end, or time is up, or `stopped`; what came of them and the time it took [s].

    begins : told the place in the bundle of every scene before it is solved
    """
    found: dict[str, Response] = {}
    begin = time.perf_counter()

    def halted() -> bool:
        return stopped() or time.perf_counter() - begin > _LATE * work

    for first in range(0, len(bundle), TOGETHER):
        some = bundle[first : first + TOGETHER]
        scenes = [scene_of(digest) for digest in some]

        def later(place: int, first: int = first) -> None:
            begins(first + place)

        found |= zip(some, task.each(scenes, later, halted), strict=False)
        if halted():
            break
    return Chunk.of(found), time.perf_counter() - begin
