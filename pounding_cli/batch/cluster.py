"""The Dask engine: scenes go to the workers of a scheduler, on this machine or on many (docs/cluster.md)."""

from __future__ import annotations

import itertools
import logging
import threading
import time
from collections.abc import Generator, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Any

from pounding_cli.batch.bundles import Queue, Work, solve_bundle
from pounding_cli.batch.engines import Engine, Finished
from pounding_cli.batch.local_cluster import local_cluster
from pounding_cli.batch.processes import ADVICE, DIED
from pounding_cli.errors import InputError, Problem
from pounding_cli.model.placed import found
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.keys import solver_version

if TYPE_CHECKING:
    from distributed import Client, Future

WORK = 2.0
"""Work in one bundle [s]: a network is slower than a pipe."""

PATIENCE = 20.0
"""Time a scheduler has to answer, and may be without a worker [s]."""

POLL = 1.0
"""How often the scheduler is asked whether it still has workers while none finishes [s]."""

GOODBYE = 5.0
"""Time the connection has to close [s]."""

SCHEMES = ("tcp", "tls", "ucx", "ucxx", "ws", "wss")
"""How addresses of schedulers begin."""


class Cluster(Engine):
    """See `engines.Engine`.

    Scenes are sent whole: the workers need this package, and neither the study nor its motions. The connection, and a
    cluster on this machine, last from the first call of `solve` until `close`: a search solves hundreds of rounds.
    """

    name = "dask"

    def __init__(self, workers: int, scheduler: str | None) -> None:
        self.workers = workers
        self.scheduler = scheduler
        self._held = ExitStack()
        self._client: Client | None = None
        self._known: set[str] = set()
        if scheduler is not None:
            _check_address(scheduler)
        try:
            import distributed  # noqa: F401
        except ImportError:
            hint = "install it with: pip install 'pounding-cli[dask]'"
            raise InputError(Problem("the dask engine needs the package 'distributed'", hint)) from None

    def solve(self, queue: Queue, scenes: Mapping[str, Any], task: Work, key: str) -> Generator[Finished]:
        """The scenes as workers finish them."""
        from distributed import wait
        from distributed.comm.core import CommClosedError

        where = self._where
        running: dict[Future, list[str]] = {}
        suspects: list[str] = []
        client = self._connection()
        seen = time.monotonic()
        try:
            while queue or suspects or running:
                threads = _threads(client)
                _check_workers(client, set(threads) - self._known)
                self._known |= set(threads)
                count = sum(threads.values())
                seen = time.monotonic() if count else seen
                if time.monotonic() - seen > PATIENCE:
                    hint = f"start workers: dask worker {self._address} --nthreads 1; {_AGAIN}"
                    told = f"the Dask scheduler {where} has had no worker for {PATIENCE:.0f} s"
                    raise InputError(Problem(told, hint))
                self.workers = max(1, count)  # workers come and go
                while (queue or suspects) and len(running) < self.workers:
                    bundle = [suspects.pop()] if suspects else queue.take(WORK)
                    running[_sent(client, bundle, scenes, task, key)] = bundle
                try:
                    with client.as_current():
                        ready, _ = wait(list(running), timeout=POLL, return_when="FIRST_COMPLETED")
                except TimeoutError:
                    continue
                for future in ready:
                    bundle = running.pop(future)
                    try:
                        yield from _received(future, bundle, scenes, task, key, queue, suspects)
                    except TimeoutError:  # its worker died before it sent the result; Dask runs the bundle again
                        running[future] = bundle
                        break
        except (CancelledError, CommClosedError, OSError, TimeoutError) as error:
            self.close()
            raise _lost(where, error) from None
        except BaseException:  # also where the caller stops early: what still runs is given up
            self.close()
            raise

    @property
    def _where(self) -> str:
        return self.scheduler or "on this machine"

    def _connection(self) -> Client:
        """A client of the scheduler, which the first call connects, starting a cluster where none is named."""
        if self._client is None:
            with ExitStack() as ends:
                ends.enter_context(_quiet())
                self._address = self.scheduler or ends.enter_context(local_cluster(self.workers))
                self._client = _connected(self._address, self._where)
                ends.callback(_closed, self._client)
                self._held = ends.pop_all()
        return self._client

    def close(self) -> None:
        """End the connection, and the cluster that was started for it."""
        self._client, self._known = None, set()
        self._held.close()


_SAME = "install this version of pounding-cli on the machines of the scheduler and the workers"
_AGAIN = "then run the same command again; solved scenes are kept"


def _check_address(scheduler: str) -> None:
    scheme, colons, rest = scheduler.rpartition("://")
    if colons and scheme not in SCHEMES:
        hint = "write tcp://HOST:8786, as the scheduler prints it; tls:// where it asks for certificates"
        raise InputError(Problem(f"the Dask scheduler {scheduler}: no scheduler is reached by {scheme}://", hint))
    if not rest.rpartition(":")[2].strip("/").isdigit():
        raise InputError(Problem(f"the Dask scheduler {scheduler}: no port", "write e.g. tcp://HOST:8786"))


def _connected(address: str, where: str) -> Client:
    """A client of the scheduler.

    It connects in a thread of its own: what does not speak Dask's language, such as a web server, can hold it longer
    than any of its timeouts.
    """
    from distributed import Client

    found: list[Client] = []
    errors: list[Exception] = []

    def connect() -> None:
        try:
            found.append(Client(address, timeout=PATIENCE, set_as_default=False))
        except Exception as error:  # another program may answer anything; told below
            errors.append(error)

    trying = threading.Thread(target=connect, daemon=True)
    trying.start()
    trying.join(PATIENCE + POLL)
    if found:
        return found[0]
    error = errors[0] if errors else TimeoutError()
    if isinstance(error, ValueError | TypeError | RuntimeError) and address.startswith("tls"):
        hint = "set DASK_DISTRIBUTED__COMM__TLS__CA_FILE, __CLIENT__CERT and __CLIENT__KEY (docs/cluster.md)"
        raise InputError(Problem(f"the Dask scheduler {where}: no certificates to reach it with", hint))
    raise _lost(where, error)


def _threads(client: Client) -> dict[str, int]:
    """Threads of every worker by its address; unlike `Client.nthreads`, it has a time limit."""
    scheduler: Any = client.scheduler
    return client.sync(scheduler.ncores, callback_timeout=PATIENCE)


def _check_workers(client: Client, new: set[str]) -> None:
    """Raise InputError if a new worker lacks this package: a scene that it cannot unpack would end it, not its task."""

    from distributed import KilledWorker

    def lacks() -> bool:  # a function within a function is sent as it is, not by the name of its module
        from importlib.util import find_spec

        return find_spec("pounding_cli") is None

    asked = {
        worker: client.submit(lacks, workers=[worker], key=f"pound-check-{next(_numbers)}", priority=1, pure=False)
        for worker in new
    }
    for worker, future in asked.items():
        lacking = False
        with suppress(TimeoutError, KilledWorker):  # it is gone again, or cannot be asked
            lacking = future.result(timeout=PATIENCE)
        if lacking:
            raise InputError(Problem(f"the workers cannot solve this study: {worker} has no pounding_cli", _SAME))


def _closed(client: Client) -> None:
    """Close the connection with a time limit: a scheduler that is lost or busy may not answer."""

    def close() -> None:
        with suppress(Exception):
            client.close(GOODBYE)

    closing = threading.Thread(target=close, daemon=True)
    closing.start()
    closing.join(GOODBYE)


@contextmanager
def _quiet() -> Iterator[None]:
    """Without what Dask would log: each fault is told in one sentence."""
    import distributed  # noqa: F401  # makes its loggers

    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] in ("distributed", "tornado")]
    talking = [log for log in map(logging.getLogger, ("asyncio", *names)) if not log.disabled]
    for log in talking:
        log.disabled = True
    try:
        yield
    finally:
        for log in talking:
            log.disabled = False


def _sent(client: Client, bundle: list[str], scenes: Mapping[str, Any], task: Work, key: str) -> Future:
    # A key of its own for every try: Dask takes equal calls for one.
    name = f"pound-{next(_numbers)}-{bundle[0][:12]}"
    scene_of = found(scenes, bundle)
    whole = [(digest, scene_of(digest)) for digest in bundle]
    return client.submit(solve_there, whole, task, key, solver_version(), key=name, pure=False)


def _received(
    future: Future,
    bundle: list[str],
    scenes: Mapping[str, Any],
    task: Work,
    key: str,
    queue: Queue,
    suspects: list[str],
) -> Generator[Finished]:
    """What came back for a bundle; where workers died of it, its scenes are tried one by one."""
    from distributed import KilledWorker

    try:
        content, seconds = future.result(timeout=PATIENCE)
    except KilledWorker:
        if len(bundle) > 1:
            suspects.extend(reversed(bundle))
        else:
            yield Finished(Chunk.of({bundle[0]: task.without(scenes[bundle[0]], DIED, ADVICE)}))
        return
    except (ImportError, AttributeError, WrongSolver) as error:
        raise InputError(Problem(f"the workers cannot solve this study: {error}", _SAME)) from None
    except RuntimeError as error:  # Dask's word for scenes that its scheduler could not unpack
        said = str(error.__cause__ or error).partition("\n")[0]
        raise InputError(Problem(f"the scheduler cannot pass on this study: {said}", _SAME)) from None
    chunk = Chunk.from_bytes(content, key, bundle)
    assert chunk is not None
    queue.give_back(bundle[len(chunk) :])
    queue.learn(len(chunk), seconds)
    yield Finished(chunk, content)


_numbers = itertools.count()


class WrongSolver(Exception):
    """A worker runs another version of the solver."""


def solve_there(bundle: list[tuple[str, Any]], task: Work, key: str, version: str) -> tuple[bytes, float]:
    """On a worker: a chunk as bytes, and the time it took [s].  Raises WrongSolver."""
    if (mine := solver_version()) != version:
        raise WrongSolver(f"they run solver {mine}, this is {version}")
    at_hand: Any = dict(bundle)
    chunk, seconds = solve_bundle(list(at_hand), at_hand.__getitem__, task, work=WORK)
    return chunk.to_bytes(key), seconds


def _lost(where: str, error: BaseException) -> InputError:
    said = str(error).partition("\n")[0] or "time is up"
    hint = f"see that it runs, and that the port is its own (8786) and not its dashboard's (8787), {_AGAIN}"
    return InputError(Problem(f"the Dask scheduler {where} does not answer ({said})", hint))
