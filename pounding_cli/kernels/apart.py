"""Bytes that another process works out while this one goes on: a fork of this one, so it begins where this one is.

Numba's Python takes most of the wait for a kernel, and a second thread of it would wait for the first."""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import signal
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Callable
from typing import Any, NoReturn

PATIENCE = 5.0, 3.0
"""The other process is given up after so long a wait [s], and so many times what this one has worked meanwhile."""

_END_WITH_PARENT = 1
"""PR_SET_PDEATHSIG of Linux: the signal that a process gets when the one that has forked it ends."""

_DONE = b"done"
"""Ends what was not cut short."""


def may_fork() -> bool:
    """Whether a fork is safe, as it copies the locks of other threads as they are and nobody there would open them; and
    whether it pays: a process that works for another one has others beside it, or is there to spare memory."""
    return sys.platform == "linux" and threading.active_count() == 1 and multiprocessing.parent_process() is None


class Apart:
    """Bytes that another process works out; what it does not give, because it was killed, failed or hangs, is worked
    out here. Used in a `with`, whose end is that of the other process too."""

    def __init__(self, work: Callable[[], bytes]) -> None:
        """Begin. Raises OSError where there can be no other process, or no file for what it finds."""
        self._work, self._begin = work, time.monotonic()
        self._file = tempfile.TemporaryFile()  # noqa: SIM115 - a pipe would be full before it is read
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)  # of threads that are not Python's: none compiles
                self._process = os.fork()
        except OSError:
            self._file.close()
            raise
        if not self._process:
            self._give()

    def _give(self) -> NoReturn:
        """What the other process does. It ends without what Python does at an end: files are this one's to write."""
        status = 1
        try:
            ctypes.CDLL(None).prctl(_END_WITH_PARENT, int(signal.SIGKILL))
            for each in (signal.SIGINT, signal.SIGTERM):
                if callable(signal.getsignal(each)):  # it runs Python here, which is not to run there
                    signal.signal(each, signal.SIG_DFL)
            self._file.write(self._work() + _DONE)
            self._file.flush()
            status = 0
        finally:
            os._exit(status)

    def result(self) -> bytes:
        """The bytes."""
        now = time.monotonic()
        last = now + PATIENCE[0] + PATIENCE[1] * (now - self._begin)
        while not self._has_ended(os.WNOHANG) and time.monotonic() < last:
            time.sleep(0.002)
        if not self._process:
            self._file.seek(0)
            found = self._file.read()
            if found.endswith(_DONE):
                return found[: -len(_DONE)]
        return self._work()

    def _has_ended(self, how: int = 0) -> bool:
        try:
            if self._process and os.waitpid(self._process, how)[0]:
                self._process = 0
        except ChildProcessError:  # somebody else has waited for it
            self._process = 0
        return not self._process

    def __enter__(self) -> Apart:
        return self

    def __exit__(self, *_: Any) -> None:
        if self._process:
            os.kill(self._process, signal.SIGKILL)
            self._has_ended()
        self._file.close()
