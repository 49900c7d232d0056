"""Stopping a kernel: it looks at a flag at every step, and returns where that is raised.

Every thread has a flag. That of the main thread is raised by Ctrl-C, and by SIGTERM where a handler of Python takes it;
threads of a pool share one (`use_flag`).
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from pounding_cli.signals import do_when_stopped, hear_signals
from pounding_cli.solver.kernels import IS_INTERPRETED


def make_flag() -> np.ndarray:
    """Return a flag, shape (1,): 0, or 1 once it is raised."""
    return np.zeros(1, np.int64)


class _OfThread(threading.local):
    """What a thread has for itself: its flag."""

    def __init__(self) -> None:
        self.flag = make_flag()


_of_thread = _OfThread()
_of_main_thread = make_flag()


def use_flag(flag: np.ndarray) -> None:
    """Let the kernels of this thread look at a flag that others may raise."""
    _of_thread.flag = flag


def find_flag() -> np.ndarray:
    """Return the flag that the next kernel of this thread looks at; that of the main thread is lowered for it."""
    if threading.current_thread() is not threading.main_thread():
        return _of_thread.flag
    _of_main_thread[0] = 0
    return _of_main_thread


def call_kernel(kernel: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    """Call a kernel so that a signal, or whoever raises the flag of this thread, stops it.

    arguments : the last one is the flag (`find_flag`)

    Raises
    ------
    KeyboardInterrupt : it was stopped; nothing that it has left is of use
    """
    flag = arguments[-1]
    if IS_INTERPRETED:
        arguments = tuple(map(_name_fields, arguments))
    with hear_signals(), np.errstate(all="ignore"):  # compiled code does not warn either
        kernel(*arguments)
    if flag[0]:
        raise KeyboardInterrupt


def _name_fields(argument: Any) -> Any:
    """Return an argument of a kernel as Python can run it: the fields of records by their names, as compiled code has
    them."""
    if isinstance(argument, tuple):
        return type(argument)(*map(_name_fields, argument))
    is_records = isinstance(argument, np.ndarray) and argument.dtype.names
    return argument.view(np.recarray) if is_records else argument


def _raise_flag() -> None:
    """Raise the flag of the main thread."""
    _of_main_thread[0] = 1


do_when_stopped(_raise_flag)
