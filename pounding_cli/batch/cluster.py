"""The Dask engine: scenes go to the workers of a scheduler, on this machine or on many (docs/cluster.md)."""

from __future__ import annotations

import itertools
from collections.abc import Generator, Mapping
from typing import TYPE_CHECKING, Any

from pounding_cli.batch.attempt import Task
from pounding_cli.batch.bundles import Queue, solve_bundle
from pounding_cli.batch.engines import Finished
from pounding_cli.batch.processes import ADVICE, DIED
from pounding_cli.errors import InputError, Problem
from pounding_cli.model.scene import Scene
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.keys import solver_version

if TYPE_CHECKING:
    from distributed import Client, Future

WORK = 2.0
"""Work in one bundle [s]: a network is slower than a pipe."""

PATIENCE = 30.0
"""Time a scheduler has to answer, and to find a worker [s]."""


class Cluster:
    """See `engines.Engine`.

    Scenes are sent whole: the workers need this package, and neither the study nor its motions.
    """

    name = "dask"

    def __init__(self, workers: int, scheduler: str | None) -> None:
        self.workers = workers
        self.scheduler = scheduler
        try:
            import distributed  # noqa: F401
        except ImportError:
            hint = "install it with: pip install 'pounding-cli[dask]'"
            raise InputError(Problem("the dask engine needs the package 'distributed'", hint)) from None

    def solve(self, queue: Queue, scenes: Mapping[str, Scene], task: Task, key: str) -> Generator[Finished]:
        """The scenes as workers finish them."""
        from distributed import wait
        from distributed.comm.core import CommClosedError

        client = self._client()
        running: dict[Future, list[str]] = {}
        suspects: list[str] = []
        try:
            while queue or suspects or running:
                self.workers = max(1, sum(client.nthreads().values()))  # workers come and go
                while (queue or suspects) and len(running) < self.workers:
                    bundle = [suspects.pop()] if suspects else queue.take(WORK)
                    running[_sent(client, bundle, scenes, task, key)] = bundle
                with client.as_current():
                    ready, _ = wait(list(running), return_when="FIRST_COMPLETED")
                for future in ready:
                    bundle = running.pop(future)
                    yield from _received(future, bundle, scenes, task, key, queue, suspects)
        except (CommClosedError, OSError, TimeoutError) as error:
            raise _lost(self.scheduler, error) from None
        finally:
            client.close()

    def _client(self) -> Client:
        from distributed import Client

        try:
            if self.scheduler is None:
                return Client(
                    n_workers=self.workers, threads_per_worker=1, dashboard_address=None, set_as_default=False
                )
            client = Client(self.scheduler, timeout=PATIENCE, set_as_default=False)
            client.wait_for_workers(1, timeout=PATIENCE)
            return client
        except (OSError, TimeoutError, ValueError) as error:
            raise _lost(self.scheduler, error) from None


def _sent(client: Client, bundle: list[str], scenes: Mapping[str, Scene], task: Task, key: str) -> Future:
    # A key of its own for every try: Dask takes equal calls for one.
    name = f"pound-{next(_numbers)}-{bundle[0][:12]}"
    whole = [(digest, scenes[digest]) for digest in bundle]
    return client.submit(solve_there, whole, task, key, solver_version(), key=name, pure=False)


def _received(
    future: Future,
    bundle: list[str],
    scenes: Mapping[str, Scene],
    task: Task,
    key: str,
    queue: Queue,
    suspects: list[str],
) -> Generator[Finished]:
    """What came back for a bundle; where workers died of it, its scenes are tried one by one."""
    from distributed import KilledWorker

    try:
        content, seconds = future.result()
    except KilledWorker:
        if len(bundle) > 1:
            suspects.extend(reversed(bundle))
        else:
            yield Finished(Chunk.of({bundle[0]: task.without(scenes[bundle[0]], DIED, ADVICE)}))
        return
    except (ImportError, AttributeError, WrongSolver) as error:
        hint = "install this very version of pounding-cli where the workers run"
        raise InputError(Problem(f"the workers cannot solve this study: {error}", hint)) from None
    chunk = Chunk.from_bytes(content, key)
    assert chunk is not None
    queue.give_back(bundle[len(chunk) :])
    queue.learn(len(chunk), seconds)
    yield Finished(chunk, content)


_numbers = itertools.count()


class WrongSolver(Exception):
    """A worker runs another version of the solver."""


def solve_there(bundle: list[tuple[str, Scene]], task: Task, key: str, version: str) -> tuple[bytes, float]:
    """On a worker: a chunk as bytes, and the time it took [s].  Raises WrongSolver."""
    if solver_version() != version:
        raise WrongSolver(f"they run solver {solver_version()}, this is {version}")
    at_hand: Any = dict(bundle)
    chunk, seconds = solve_bundle(list(at_hand), at_hand.__getitem__, task, work=WORK)
    return chunk.to_bytes(key), seconds


def _lost(scheduler: str | None, error: Exception) -> InputError:
    where = scheduler or "on this machine"
    hint = "see that it runs and has workers, then run the same command again: what is solved is kept"
    return InputError(Problem(f"the Dask scheduler {where} does not answer ({str(error) or 'time is up'})", hint))
