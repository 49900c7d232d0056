"""A Dask cluster on this machine, as a process of its own: `python -m pounding_cli.batch.local_cluster WORKERS`.

Started within the program, Dask's workers get its Ctrl-C while they are being started, and the program then waits for
them without end. Here the cluster is a session of its own, which Ctrl-C does not reach. It ends when its standard input
does, so also when the program is killed.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from pounding_cli.errors import InputError, Problem

GRACE = 3.0
"""Time the cluster has to end after it was told to [s]."""


@contextmanager
def local_cluster(workers: int) -> Iterator[str]:
    """The address of a scheduler with `workers` workers of one thread, reached from this machine alone.

    Raises
    ------
    InputError : it does not start
    """
    command = [sys.executable, "-m", "pounding_cli.batch.local_cluster", str(workers)]
    paths = {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}  # what is found here is found there
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **paths},
        text=True,
        start_new_session=True,
    )
    try:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        if not address:
            hint = "use `--engine processes`, which needs no Dask, or start a scheduler and name it with --scheduler"
            raise InputError(Problem("no Dask cluster could be started on this machine", hint))
        yield address
    finally:
        _end(process)


def _end(process: subprocess.Popen[str]) -> None:
    """Ask it to end, and make it; its workers are of its session."""
    with suppress(OSError):
        assert process.stdin is not None
        process.stdin.close()
    try:
        process.wait(GRACE)
    except subprocess.TimeoutExpired:
        pass
    finally:
        with suppress(OSError):
            os.killpg(process.pid, signal.SIGKILL) if hasattr(os, "killpg") else process.kill()
        process.wait()


def serve(workers: int) -> None:
    """Run a cluster, say its address on standard output, and end it when standard input ends."""
    from distributed import LocalCluster

    told = os.fdopen(os.dup(sys.stdout.fileno()), "w")  # workers get no hold of it
    with open(os.devnull, "w") as nothing:
        os.dup2(nothing.fileno(), sys.stdout.fileno())
    with LocalCluster(workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster:
        told.write(f"{cluster.scheduler_address}\n")
        told.close()
        sys.stdin.read()


if __name__ == "__main__":
    serve(int(sys.argv[1]))
