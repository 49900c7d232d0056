"""What an engine is, and the choice of one by name; each engine stands in a module of its own."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from typing import Protocol

from pounding_cli.batch.attempt import Task
from pounding_cli.errors import InputError, Problem
from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import Response

ENGINES = ("serial", "processes")


class Engine(Protocol):
    """Solves scenes somewhere; never writes a file, never raises for a scene.

    name : as in ENGINES
    workers : scenes solved side by side
    """

    name: str
    workers: int

    def solve(
        self, scenes: Iterable[tuple[str, Scene]], task: Task, expected: float
    ) -> Generator[tuple[str, Response]]:
        """Every scene's response under its digest, in any order, each as soon as it is there.

        expected : expected time of one scene [s]

        A caller that stops early closes the generator; that ends the workers.
        """
        ...


def engine(name: str, workers: int) -> Engine:
    """The engine of that name.

    Raises
    ------
    InputError : no such engine, fewer than one worker
    """
    if workers < 1:
        raise InputError(Problem(f"workers: {workers} is not a number of workers", "write a number from 1"))
    if name == "serial":
        from pounding_cli.batch.serial import Serial

        return Serial()
    if name == "processes":
        from pounding_cli.batch.processes import Processes

        return Processes(workers)
    raise InputError(Problem(f"there is no engine {name!r}", f"choose one of: {', '.join(ENGINES)}"))
