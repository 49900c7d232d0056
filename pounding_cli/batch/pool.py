"""Where scenes are solved: threads or processes of this machine, or the workers of a Dask cluster."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import re
import signal
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.results.keys import solver_version

ENGINES = ("threads", "processes", "dask", "serial")

PATIENCE = 60.0
"""Time that a Dask scheduler has to answer, and that it may have no workers [s]."""

_ADDRESS = re.compile(r"((tcp|tls)://)?[^/]+:\d+")


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
    count = workers or cores()
    if name == "dask":
        return _dask(count, workers is not None, scheduler)
    if name == "processes":
        how = multiprocessing.get_context("forkserver" if os.name == "posix" else "spawn")
        if os.name == "posix":
            how.set_forkserver_preload(["pounding_cli.batch.attempt"])
        return Pool(name, count, lambda: ProcessPoolExecutor(count, how, _begin))
    return Pool(name, 1 if name == "serial" else count, lambda: ThreadPoolExecutor(count))


def cores() -> int:
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


def _dask(workers: int, is_asked: bool, scheduler: str | None) -> Pool:
    try:
        import distributed
    except ImportError:
        hint = "install it: pip install 'pounding-cli[cluster]'"
        raise InputError(Problem("the engine 'dask' needs the package distributed", hint)) from None
    if scheduler is None:
        about: dict[str, Any] = {"threads_per_worker": 1, "dashboard_address": None, "n_workers": workers}
        client = distributed.Client(set_as_default=False, silence_logs=50, **about)
    else:
        if not _ADDRESS.fullmatch(scheduler):
            what = f"'{scheduler}' is no address of a Dask scheduler: protocol (tcp or tls), host and port"
            raise InputError(Problem(what, "write e.g. tcp://node:8786"))
        try:
            client = distributed.Client(scheduler, set_as_default=False, timeout=PATIENCE)
        except (OSError, ValueError, RuntimeError) as error:
            said = str(error).splitlines()[0] if str(error) else type(error).__name__
            hint = "start one with `dask scheduler`, and give its address, e.g. tcp://node:8786"
            raise InputError(Problem(f"no Dask scheduler answers at {scheduler} ({said})", hint)) from None
        try:
            _check_workers(client, scheduler)
        except InputError:
            _close(client)
            raise
    count = max(1, sum(client.nthreads().values()))
    seen = time.monotonic()

    def check() -> None:
        """Whether the cluster has workers; raises InputError where there were none for a while."""
        nonlocal seen
        is_there = False
        with contextlib.suppress(Exception):  # whatever a connection that is lost may say
            is_there = client.status == "running" and bool(client.nthreads())
        if is_there:
            seen = time.monotonic()
        elif time.monotonic() - seen > PATIENCE:
            hint = "start some; what was solved is kept, and the same command goes on"
            raise InputError(Problem("the Dask cluster has no worker any more", hint))

    count = min(count, workers) if is_asked else count
    return Pool("dask", count, lambda: client.get_executor(pure=False, retries=0), check, lambda: _close(client))


def _close(client: Any) -> None:
    with contextlib.suppress(Exception):  # what it solved is kept
        client.close(timeout=5)


def _check_workers(client: Any, scheduler: str) -> None:
    """Refuse workers without this very program: their numbers could differ.  Raises InputError."""
    if not client.nthreads():
        hint = f"start some with: dask worker {scheduler}"
        raise InputError(Problem(f"the Dask scheduler at {scheduler} has no workers", hint))
    try:
        versions = set(client.run(solver_version).values())
    except Exception as error:  # whatever a worker without this program may say
        versions = {f"none: {error}"}
    if other := sorted(versions - {solver_version()}):
        what = f"a worker at {scheduler} has another version of pounding_cli ({other[0]})"
        raise InputError(Problem(what, f"install {solver_version()} on every worker"))
