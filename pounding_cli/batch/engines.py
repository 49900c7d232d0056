"""What an engine is, and the choice of one by name; each engine stands in a module of its own."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from pounding_cli.batch.bundles import Queue, Work
from pounding_cli.errors import InputError, Problem
from pounding_cli.store.chunk import Chunk

ENGINES = ("serial", "threads", "processes", "dask")


@dataclass(frozen=True)
class Finished:
    """A chunk as it comes from a worker; `content`: its bytes, where it came as bytes."""

    chunk: Chunk
    content: bytes = b""


class Engine(Protocol):
    """Solves scenes somewhere; never writes a file, never raises for a scene.

    name : as in ENGINES
    workers : scenes solved side by side
    """

    name: str
    workers: int

    def solve(self, queue: Queue, scenes: Mapping[str, Any], task: Work, key: str) -> Generator[Finished]:
        """Everything in the queue, chunk by chunk as workers finish.

        key : `solution_key`, which chunks made into bytes carry

        A worker gets its next bundle when the caller asks on, so after it has kept the chunk: a run that is killed
        loses one chunk a worker. A caller that stops early closes the generator; that ends the workers.
        """
        ...

    def close(self) -> None:
        """Give back what is held from one call of `solve` to the next; nothing unless an engine says otherwise."""
        return None


def engine(name: str, workers: int, scheduler: str | None = None) -> Engine:
    """The engine of that name.

    Parameters
    ----------
    scheduler : address of a Dask scheduler, for the dask engine; a cluster on this machine unless given

    Raises
    ------
    InputError : no such engine, fewer than one worker, a scheduler for another engine, dask not installed
    """
    if workers < 1:
        raise InputError(Problem(f"workers: {workers} is not a number of workers", "write a number from 1"))
    if scheduler is not None and name != "dask":
        hint = "write `--engine dask --scheduler ...`, or leave the scheduler out"
        raise InputError(Problem(f"there is no scheduler for the engine {name!r}", hint))
    if name == "serial":
        from pounding_cli.batch.serial import Serial

        return Serial()
    if name == "threads":
        from pounding_cli.batch.threads import Threads

        return Threads(workers)
    if name == "processes":
        from pounding_cli.batch.processes import Processes

        return Processes(workers)
    if name == "dask":
        from pounding_cli.batch.cluster import Cluster

        return Cluster(workers, scheduler)
    raise InputError(Problem(f"there is no engine {name!r}", f"choose one of: {', '.join(ENGINES)}"))
