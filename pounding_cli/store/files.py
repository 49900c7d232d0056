"""Opening results files, refusing what is not one, and keeping two runs from one file."""

from __future__ import annotations

import errno
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import h5py

from pounding_cli.errors import InputError, Problem
from pounding_cli.store.keys import FORMAT, FORMAT_VERSION


@contextmanager
def opened(path: Path, any_version: bool = False) -> Iterator[h5py.File]:
    """A results file, open for reading.

    Raises
    ------
    InputError : missing, a folder, not HDF5, not ours, or (unless `any_version`) of another format version
    """
    name = str(path)
    if not path.exists():
        raise InputError(Problem("there is no such results file", "make one with: pound run STUDY -o FILE.h5", name))
    if path.is_dir():
        raise InputError(Problem("is a folder, not a results file", "name the .h5 file in it", name))
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        advice = "give the file that pound run wrote; if it was damaged, run the study again"
        raise InputError(Problem(f"cannot be read as HDF5 ({_first_line(error)})", advice, name)) from None
    with file:
        if file.attrs.get("format") != FORMAT:
            advice = "give a file that pound run wrote"
            raise InputError(Problem("is HDF5 but not a results file of pound", advice, name))
        version = int(file.attrs.get("format_version", 0))
        if version != FORMAT_VERSION and not any_version:
            raise InputError(
                Problem(
                    f"has format version {version}, this program reads version {FORMAT_VERSION}",
                    "run the study again with this program: pound run STUDY -o FILE.h5",
                    name,
                )
            )
        yield file


def check_output(path: Path) -> None:
    """Make sure that results can be written at `path`, before anything is simulated; makes the folder.

    Raises
    ------
    InputError : a folder stands there, another file, or results of a newer program; the folder cannot be made or
        written
    """
    name = str(path)
    if path.is_dir():
        raise InputError(Problem("the output is a folder", f"name a file, e.g. {path / 'results.h5'}", name))
    if path.exists():
        advice = "it would be overwritten: choose another name with -o FILE.h5, or move it away"
        try:
            with opened(path, any_version=True) as file:
                version = int(file.attrs["format_version"])
        except InputError:
            raise InputError(Problem("the output exists and is not a results file of pound", advice, name)) from None
        if version > FORMAT_VERSION:
            what = f"the output has format version {version}, newer than this program's {FORMAT_VERSION}"
            raise InputError(Problem(what, advice, name))
    advice = "choose another place with -o FILE.h5"
    probe = path.with_name(f".{path.name}.probe")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError as error:
        what = f"the output folder {path.parent} cannot be written ({error.strerror or error})"
        raise InputError(Problem(what, advice, name)) from None


@dataclass(frozen=True)
class FormerRun:
    """The results file that stands where new results will.

    differs : in words, what keeps its scenes from being used again; "" where nothing does
    scenes, failed : counts
    """

    differs: str
    scenes: int
    failed: int


def former_run(path: Path, key: str) -> FormerRun | None:
    """What stands at `path`, if anything; `key`: the `solution_key` of the new run."""
    try:
        with opened(path, any_version=True) as file:
            attrs = dict(file.attrs)
    except (InputError, OSError):
        return None
    mine, its = (dict(part.split(" ", 1) for part in text.split(" | ")) for text in (key, attrs["solution_key"]))
    changes = [f"{name} {its.get(name, '?')} (now {value})" for name, value in mine.items() if its.get(name) != value]
    return FormerRun(", ".join(changes), int(attrs["scenes"]), int(attrs["scenes_failed"]))


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
            if lock.exists() and os.path.samestat(os.fstat(handle), lock.stat()):
                os.truncate(handle, 0)
                os.write(handle, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
                return handle
        except OSError as error:
            os.close(handle)
            if error.errno in (errno.EACCES, errno.EAGAIN):
                raise _at_work(path, lock.read_text().strip()) from None
            raise
        os.close(handle)


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
    return InputError(Problem(f"another run is at work on this file ({who})", hint, str(path)))


_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_SHUT = (errno.EROFS, errno.EACCES, errno.EPERM)


def refused_write(error: OSError, path: Path, parts: Path) -> InputError:
    """A write that failed while a run was at work, in words: what is on disk is whole, and the run can go on."""
    if error.errno in _FULL or "No space left" in str(error):
        what, first = "there is no space left", "free some"
    elif error.errno in _SHUT:
        what, first = "may not be written", "give yourself the right to"
    else:
        what, first = error.strerror or _first_line(error), "see to that"
    hint = f"{first}, then run the same command again: what was solved is kept in {parts}, and no file was damaged"
    return InputError(Problem(f"cannot write results: {what} ({error.filename or path.parent})", hint, str(path)))


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__
