"""Keeping two runs from one results file."""

from __future__ import annotations

import errno
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from pounding_cli.errors import InputError, Problem


def lock_of(path: Path) -> Path:
    """The lock file of a results file; it exists while a run is at work, or was killed."""
    return path.with_name(f".{path.name}.lock")


_held: set[Path] = set()
"""Files that runs in this process are at work on."""


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep every other run, in this process or another, from working on the results file at `path`.

    The lock goes with the process that holds it, however it ends.

    Raises
    ------
    InputError : another run holds it
    OSError : the lock file cannot be written
    """
    where, lock = path.resolve(), lock_of(path)
    if where in _held:
        raise _at_work(path, "this process")
    handle = _taken(path, lock)
    _held.add(where)
    try:
        yield
    finally:
        _held.discard(where)
        with suppress(OSError):  # the folder may be gone
            lock.unlink(missing_ok=True)
        os.close(handle)


def _taken(path: Path, lock: Path) -> int:
    """The open lock file, locked; one that its former holder has deleted meanwhile does not count."""
    while True:
        handle = os.open(lock, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            _lock(handle)
            if _is_still(lock, handle):
                os.truncate(handle, 0)
                os.write(handle, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
                return handle
        except OSError as error:
            os.close(handle)
            if error.errno in (errno.EACCES, errno.EAGAIN):
                raise _at_work(path, _holder(lock)) from None
            raise
        os.close(handle)


def _is_still(lock: Path, handle: int) -> bool:
    """Whether an open file is still the lock file: its former holder may delete it at any moment."""
    try:
        return os.path.samestat(os.fstat(handle), lock.stat())
    except FileNotFoundError:
        return False


def _holder(lock: Path) -> str:
    try:
        return lock.read_text().strip() or "just begun"
    except OSError:
        return "just ended"


def _lock(handle: int) -> None:
    try:
        import fcntl
    except ImportError:  # Windows
        import msvcrt

        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
        return
    # A record lock, which forked workers do not inherit: it must not outlive this process.
    try:
        fcntl.lockf(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno not in (errno.ENOLCK, errno.ENOTSUP):  # some network file systems have no locks
            raise


def _at_work(path: Path, who: str) -> InputError:
    hint = "wait until it has ended, or give this run another file with -o FILE.h5"
    return InputError(Problem(f"another run is using this file ({who})", hint, str(path)))
