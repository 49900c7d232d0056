"""Signals that stop a run, heard also while a compiled kernel or another library computes.

The main thread calls handlers of Python between two of its own instructions, hence not before such a computation ends.
The interpreter writes the numbers of signals to a pipe at once (`signal.set_wakeup_fd`), and a thread reads them there.
"""

from __future__ import annotations

import contextlib
import functools
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator

STOPPING = frozenset((signal.SIGINT, signal.SIGTERM))
"""Signals that stop a run, where a handler of Python takes them."""

_tasks: list[Callable[[], None]] = []


def do_when_stopped(task: Callable[[], None]) -> None:
    """Let another thread do a task, which takes no time, whenever a signal that stops a run is heard."""
    _tasks.append(task)


@contextlib.contextmanager
def hear_signals() -> Iterator[None]:
    """Hear signals for a while; only the main thread can, in any other nothing is heard."""
    if not _is_main_thread():
        yield
        return
    before = signal.set_wakeup_fd(_open_pipe(os.getpid()), warn_on_full_buffer=False)
    try:
        yield
    finally:
        signal.set_wakeup_fd(before, warn_on_full_buffer=False)


@contextlib.contextmanager
def take_signals(seconds: float, end: Callable[[], None]) -> Iterator[None]:
    """Hear signals for a while, let SIGTERM interrupt as Ctrl-C does, and call `end` some time after one [s].

    `end` is called in another thread. It is for what no flag can stop, such as the compiler: the main thread has until
    then to end the process itself.
    """
    if not _is_main_thread():
        yield
        return

    def wait_and_end() -> None:
        time.sleep(seconds)
        end()

    def start_waiting() -> None:
        threading.Thread(target=wait_and_end, daemon=True).start()

    _tasks.append(start_waiting)
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)  # batch systems send it when time is up
    try:
        with hear_signals():
            yield
    finally:
        signal.signal(signal.SIGTERM, before)
        _tasks.remove(start_waiting)


def _is_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()


@functools.cache
def _open_pipe(process: int) -> int:
    """Return the end of a pipe that the interpreter writes signals to.

    process : its number; one that is split off from this one has a pipe of its own
    """
    receiver, sender = os.pipe()
    if os.name == "posix":  # the interpreter never waits where the pipe is full
        os.set_blocking(sender, False)
    threading.Thread(target=_read_signals, args=(receiver,), name=f"signals of {process}", daemon=True).start()
    return sender


def _read_signals(receiver: int) -> None:
    """Do the tasks whenever a signal arrives that stops a run."""
    while True:
        if not STOPPING.isdisjoint(os.read(receiver, 64)):
            for task in tuple(_tasks):
                task()
