"""The serial engine: one scene after another, in this process; the one to debug with."""

from __future__ import annotations

from collections.abc import Generator, Iterable

from pounding_cli.batch.attempt import Task
from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import Response


class Serial:
    """See `engines.Engine`."""

    name = "serial"
    workers = 1

    def solve(
        self, scenes: Iterable[tuple[str, Scene]], task: Task, expected: float
    ) -> Generator[tuple[str, Response]]:
        """The scenes in their order."""
        for digest, scene in scenes:
            yield digest, task(scene)
