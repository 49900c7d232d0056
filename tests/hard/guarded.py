"""Work in a process of its own, under a limit of processor time and memory: what would hang or crash is told."""

from __future__ import annotations

import os
import resource
import signal
from collections.abc import Callable

from pounding_cli import InputError

SECONDS, MEGABYTES = 5, 500
"""What a refusal may take, beyond what the process had before."""


def guarded(work: Callable[[], object], seconds: int = SECONDS, megabytes: int = MEGABYTES) -> str:
    """What came of `work`: "done", "refused: ...", "traceback: ...", "hang" or "crash: signal N"."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        try:
            with open("/proc/self/statm") as file:
                there = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
            resource.setrlimit(resource.RLIMIT_AS, (there + megabytes * 1_000_000,) * 2)
            used = int(sum(resource.getrusage(resource.RUSAGE_SELF)[:2]))
            resource.setrlimit(resource.RLIMIT_CPU, (used + seconds + 1,) * 2)
            signal.alarm(24 * seconds)  # who waits uses no time
            os.write(writer, _told(work).encode("utf-8", "replace")[:60_000])
        finally:
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as file:
        said = file.read().decode()
    _, status = os.waitpid(child, 0)
    number = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
    if number in (signal.SIGXCPU, signal.SIGALRM, signal.SIGKILL):
        return "hang"
    return f"crash: signal {number}" if number else said or "crash: nothing said"


def _told(work: Callable[[], object]) -> str:
    try:
        work()
    except InputError as refused:
        return f"refused: {refused}"
    except BaseException as fault:
        return f"traceback: {type(fault).__name__}: {str(fault)[:500]}"
    return "done"
