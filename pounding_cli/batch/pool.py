"""Where scenes are solved: threads or processes of this machine, or the workers of a Dask cluster."""

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
from typing import Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.results.solved import solver_version

ENGINES = ("threads", "processes", "dask", "serial")

PATIENCE = 60.0
"""Time that a Dask scheduler has to answer, and that it may have no workers [s]."""


@dataclass(frozen=True)
class Pool:
    """Workers.

    name : one of ENGINES
    workers : how many
    open : makes the executor; called again where it broke
    check : asked every second while scenes are under way; raises InputError where nobody will solve them
    close : ends what belongs to the pool besides its executors
    """

    name: str
    workers: int
    open: Callable[[], Executor]
    check: Callable[[], None] = lambda: None
    close: Callable[[], None] = lambda: None


def pool(name: str, workers: int | None = None, scheduler: str | None = None) -> Pool:
    """A pool by its name.

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
        raise InputError(Problem(f"there is no engine '{name}'", f"write one of {', '.join(ENGINES)}"))
    if scheduler is not None and name != "dask":
        raise InputError(Problem(f"the engine '{name}' has no scheduler", "add --engine dask"))
    if name == "dask":
        return _dask(workers, scheduler)
    count = 1 if name == "serial" else workers or _cores()
    if name == "processes":
        how = multiprocessing.get_context("forkserver" if os.name == "posix" else "spawn")
        if os.name == "posix":
            how.set_forkserver_preload(["pounding_cli.batch.attempt"])
        return Pool(name, count, lambda: ProcessPoolExecutor(count, how, _begin))
    return Pool(name, count, lambda: ThreadPoolExecutor(count))


def _cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def end(executor: Executor, running: Iterable[Future]) -> None:
    """End an executor now; of threads the scenes that they are at end first."""
    for future in running:
        future.cancel()
    workers = list((getattr(executor, "_processes", None) or {}).values())
    executor.shutdown(wait=False)
    for process in workers:
        process.kill()


def _begin() -> None:
    """The beginning of a worker process: Ctrl-C is for its parent, and when that is gone it ends."""
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=watch, daemon=True).start()


def _dask(workers: int | None, scheduler: str | None) -> Pool:
    try:
        from distributed import Client
    except ImportError:
        hint = "install it: pip install 'pounding-cli[dask]'"
        raise InputError(Problem("the engine 'dask' needs the package distributed", hint)) from None
    own = {"n_workers": workers or _cores(), "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50}
    about: dict[str, Any] = {"address": scheduler, "timeout": PATIENCE} if scheduler else own
    try:
        client = Client(set_as_default=False, **about)
    except (OSError, ValueError, RuntimeError) as error:
        said = (str(error) or type(error).__name__).splitlines()[0]
        hint = "start one with `dask scheduler`, and give its address, e.g. tcp://node:8786"
        raise InputError(Problem(f"no Dask scheduler answers at {scheduler} ({said})", hint)) from None

    def close() -> None:
        with contextlib.suppress(Exception):  # what it solved is kept
            client.close(timeout=5)

    if scheduler and not client.nthreads():
        close()
        problem = Problem(f"the Dask scheduler at {scheduler} has no workers", f"start some: dask worker {scheduler}")
        raise InputError(problem)
    try:
        versions = set(client.run(solver_version).values()) if scheduler else set()
    except Exception as error:  # whatever a worker without this program may say
        versions = {f"none: {error}"}
    if other := sorted(versions - {solver_version()}):
        close()
        what = f"a worker at {scheduler} has another version of pounding_cli ({other[0]})"
        raise InputError(Problem(what, f"install {solver_version()} on every worker"))
    seen = time.monotonic()

    def check() -> None:
        """Whether the cluster has workers; raises InputError where there were none for a while."""
        nonlocal seen
        with contextlib.suppress(Exception):  # whatever a connection that is lost may say
            if client.status == "running" and client.nthreads():
                seen = time.monotonic()
        if time.monotonic() - seen > PATIENCE:
            hint = "start some; what was solved is kept, and the same command goes on"
            raise InputError(Problem("the Dask cluster has no worker any more", hint))

    threads = max(1, sum(client.nthreads().values()))
    return Pool(
        "dask", min(threads, workers or threads), lambda: client.get_executor(pure=False, retries=0), check, close
    )
