"""Open pools of workers: threads or processes of this machine, or the workers of a Dask cluster."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pounding_cli.errors import InputError, Issue
from pounding_cli.results.responses import solver_version
from pounding_cli.solver.stopping import make_flag, use_flag

if TYPE_CHECKING:
    from distributed import Client

ENGINES = ("threads", "processes", "dask", "serial")

DASK_TIMEOUT = 60.0
"""Time that a Dask scheduler has to answer, and that it may have no workers [s]."""


def do_nothing() -> None:
    """Do nothing: of a pool that is always there, and has nothing to end."""


@dataclass(frozen=True)
class Pool:
    """Workers that solve scenes side by side.

    name : one of ENGINES
    workers : number of them
    open : makes the executor; called again where it broke
    shares_memory : workers are threads of this process
    check : called every second while scenes are under way; raises InputError where nobody will solve them
    close : ends what belongs to the pool besides its executors
    """

    name: str
    workers: int
    open: Callable[[], Executor]
    shares_memory: bool = False
    check: Callable[[], None] = do_nothing
    close: Callable[[], None] = do_nothing


def open_pool(name: str, workers: int | None = None, scheduler: str | None = None) -> Pool:
    """Return a pool by its name.

    Parameters
    ----------
    name : one of ENGINES
    workers : scenes side by side; the cores of this machine unless given
    scheduler : address of a Dask scheduler, e.g. tcp://node:8786; a cluster on this machine unless given

    Raises
    ------
    InputError : no such engine; Dask is not installed; the scheduler does not answer, or its workers are other programs
    """
    if name not in ENGINES:
        raise InputError(f"'{name}' is not an engine", f"write one of {', '.join(ENGINES)}")
    if scheduler is not None and name != "dask":
        raise InputError(f"the engine '{name}' takes no scheduler", "add --engine dask, or leave the scheduler out")
    if name == "dask":
        return _open_dask_pool(workers, scheduler)
    count = 1 if name == "serial" else workers or _count_cores()
    if name == "processes":
        return Pool(name, count, lambda: _open_processes(count))
    return Pool(name, count, lambda: _Threads(count), shares_memory=True)


def _count_cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Threads(ThreadPoolExecutor):
    """Threads of this process; `stop` is the flag that their kernels look at."""

    def __init__(self, count: int) -> None:
        self.stop = make_flag()
        super().__init__(count, initializer=use_flag, initargs=(self.stop,))


def _open_processes(count: int) -> Executor:
    """Return an executor of worker processes that have the solver imported."""
    context = multiprocessing.get_context("forkserver" if os.name == "posix" else "spawn")
    if os.name == "posix":
        context.set_forkserver_preload(["pounding_cli.batch.attempt"])
    return ProcessPoolExecutor(count, context, _prepare_worker)


def _prepare_worker() -> None:
    """Leave Ctrl-C to the parent of a worker process, and end the worker when its parent is gone."""
    parent = multiprocessing.parent_process()

    def end_with_parent() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=end_with_parent, daemon=True).start()


def stop_executor(executor: Executor, running: Iterable[Future]) -> None:
    """End an executor now; what is under way in it is lost."""
    for future in running:
        future.cancel()
    if isinstance(executor, _Threads):
        executor.stop[0] = 1
    workers = list((getattr(executor, "_processes", None) or {}).values())
    executor.shutdown(wait=False)
    for process in workers:
        process.kill()


def _open_dask_pool(workers: int | None, scheduler: str | None) -> Pool:
    """Return the pool of a Dask cluster; parameters and errors as of `open_pool`."""
    client = _connect_to_dask(workers, scheduler)
    if scheduler:
        try:
            _check_dask_workers(client, scheduler)
        except InputError:
            _close_client(client)
            raise
    watch = _ClusterWatch(client)
    threads = max(1, sum(client.nthreads().values()))
    return Pool(
        "dask",
        min(threads, workers or threads),
        lambda: client.get_executor(pure=False, retries=0),
        check=watch.check,
        close=lambda: _close_client(client),
    )


def _connect_to_dask(workers: int | None, scheduler: str | None) -> Client:
    """Return a client of the scheduler at an address, or of a cluster on this machine."""
    try:
        from distributed import Client
    except ImportError:
        hint = "install it: pip install 'pounding-cli[dask]'"
        raise InputError("the engine 'dask' needs the package distributed", hint) from None
    settings: dict[str, Any]
    if scheduler:
        settings = {"address": scheduler, "timeout": DASK_TIMEOUT}
    else:
        settings = {"n_workers": workers or _count_cores(), "threads_per_worker": 1}
        settings |= {"dashboard_address": None, "silence_logs": 50}
    try:
        return Client(set_as_default=False, **settings)
    except (OSError, ValueError, RuntimeError) as error:
        reason = (str(error) or type(error).__name__).splitlines()[0]
        hint = "start one with `dask scheduler`, and give its address, e.g. tcp://node:8786"
        raise InputError(f"no Dask scheduler answers at {scheduler} ({reason})", hint) from None


def _check_dask_workers(client: Client, scheduler: str) -> None:
    """Refuse a cluster without workers, and one whose workers have another version of this program."""
    if not client.nthreads():
        problem = Issue((), f"the Dask scheduler at {scheduler} has no workers", f"start some: dask worker {scheduler}")
        raise InputError(problem)
    try:
        versions = set(client.run(solver_version).values())
    except Exception as error:  # whatever a worker without this program may say
        versions = {f"none: {error}"}
    others = sorted(versions - {solver_version()})
    if others:
        message = f"a worker at {scheduler} has another version of pounding_cli ({others[0]})"
        raise InputError(message, f"install {solver_version()} on every worker")


def _close_client(client: Client) -> None:
    """Close the connection to a cluster; what it solved is kept, whatever happens."""
    with contextlib.suppress(Exception):
        client.close(timeout=5)


class _ClusterWatch:
    """Watches that a cluster has workers."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._last_time_with_workers = time.monotonic()

    def check(self) -> None:
        """Raise InputError where there were no workers for a while."""
        with contextlib.suppress(Exception):  # whatever a connection that is lost may say
            if self._client.status == "running" and self._client.nthreads():
                self._last_time_with_workers = time.monotonic()
        if time.monotonic() - self._last_time_with_workers > DASK_TIMEOUT:
            hint = "start some; solved time histories are kept, and the same command resumes"
            raise InputError(f"the Dask cluster has had no workers for {DASK_TIMEOUT:g} s", hint)
