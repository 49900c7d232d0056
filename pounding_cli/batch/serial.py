"""The serial engine: scene after scene in this process, for small studies and for debugging."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from typing import Any

from pounding_cli.batch.bundles import Queue, Work, solve_bundle
from pounding_cli.batch.engines import Engine, Finished
from pounding_cli.model.placed import found


class Serial(Engine):
    """See `engines.Engine`."""

    name = "serial"
    workers = 1

    def solve(self, queue: Queue, scenes: Mapping[str, Any], task: Work, key: str) -> Generator[Finished]:
        """The scenes in their order."""
        while queue:
            bundle = queue.take()
            chunk, seconds = solve_bundle(bundle, found(scenes, bundle), task)
            queue.give_back(bundle[len(chunk) :])
            queue.learn(len(chunk), seconds)
            yield Finished(chunk)
