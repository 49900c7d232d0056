"""Compiled kernels on disk (numba's cache): verified before they are used, deleted where they are damaged, and done
without where they cannot be kept.

Numba trusts its files: a truncated one is an exception in every call, a flipped bit is machine code that was never
compiled. So each file gets a checksum beside it when it is written. Until it has, the process that writes holds a lock
on the folder: what looks damaged to another is looked at again once that process is done."""

from __future__ import annotations

import os
import shutil
import stat
import time
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numba
from numba import njit
from numba.core.event import Event, Listener, install_listener

from pounding_cli.kernels.pipelines import nothing_twice

SUM = ".crc32"
"""End of the file that holds a file's checksum."""

_TRIES = 3
"""A damaged cache costs one try, one that cannot be written a second."""

_PATIENCE = 120.0
"""For so long others may write before what they have written is looked at all the same [s]: all kernels take 60."""

notes: list[str] = []
"""What a user should know of it, once; whoever shows it takes it away."""


def _probe(function: Callable[[], None]) -> Path | None:
    """Where numba keeps the kernels of this folder; None where it finds no place that can be written."""
    try:
        return Path(njit(cache=True)(function).stats.cache_path)
    except RuntimeError:
        notes.append("there is no folder to keep compiled kernels in: every run compiles them (set NUMBA_CACHE_DIR)")
        return None


def _nothing() -> None: ...


def _readable(folder: Path | None) -> Path | None:
    """The folder, or one of this user's own where it holds kernels of another user that cannot be read: numba fails on
    these in every call, and in a folder with the sticky bit nobody else can delete them."""
    if folder is None or all(os.access(path, os.R_OK) for path in folder.glob("*.nb[ic]")):
        return folder
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    own = base / "pound" / "kernels"
    notes.append(f"compiled kernels in {folder} belong to another user and cannot be read: {own} is used instead")
    numba.config.CACHE_DIR = str(own)  # of the functions that are compiled from here on
    return _probe(_nothing)


FOLDER = _readable(_probe(_nothing))
"""Where compiled kernels are kept."""

_seen: dict[Path, int] = {}
"""Files that were verified or written by this process, with the time of their last change [ns]."""


def loaded(call: Callable[[], Any]) -> Any:
    """`call()`, which may compile kernels or load compiled ones; a cache that is damaged or full does not stop it."""
    _verify()
    for left in reversed(range(_TRIES)):
        try:
            with _locked(), nothing_twice():
                found = call()
                _seal()
                return found
        except Exception as error:
            if not left or not _is_of_cache(error):
                raise
            _learn(error)


class _Teller(Listener):
    """Calls once what is to be called as a kernel begins to be compiled."""

    def __init__(self, tell: Callable[[], None]) -> None:
        self._tell: Callable[[], None] | None = tell

    def on_start(self, event: Event) -> None:
        tell, self._tell = self._tell, None
        if tell:
            tell()

    def on_end(self, event: Event) -> None:
        """Nobody waits for it."""


@contextmanager
def when_compiling(tell: Callable[[], None]) -> Iterator[None]:
    """While the `with` lasts, `tell()` is called once as a kernel is compiled, and not for one that is loaded."""
    with install_listener("numba:compile", _Teller(tell)):
        yield


@contextmanager
def _locked(alone: bool = False) -> Iterator[None]:
    """A lock on the folder, shared by those who write, or for who deletes `alone`; none where there is no folder, where
    its file system or the platform knows no such lock, or when the patience is at an end."""
    handle = -1
    with suppress(OSError, ImportError):
        import fcntl

        kind = fcntl.LOCK_EX if alone else fcntl.LOCK_SH
        handle = os.open(FOLDER, os.O_RDONLY) if FOLDER else -1
    try:
        end = time.monotonic() + _PATIENCE
        while handle >= 0 and time.monotonic() < end:
            try:
                fcntl.flock(handle, kind | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                time.sleep(0.05)
            except OSError:
                break
        yield
    finally:
        if handle >= 0:
            os.close(handle)


def _is_of_cache(error: BaseException) -> bool:
    """Whether an exception came out of numba's reading or writing of its cache."""
    trace = error.__traceback__
    while trace is not None:
        if Path(trace.tb_frame.f_code.co_filename).parts[-3:] == ("numba", "core", "caching.py"):
            return True
        trace = trace.tb_next
    return False


def _learn(error: Exception) -> None:
    """Delete what cannot be loaded. What cannot be written is compiled by now, and needed no more in this process."""
    if isinstance(error, OSError) and error.errno is not None:
        notes.append(f"compiled kernels cannot be kept in {FOLDER} ({error.strerror}): every run compiles them")
    else:
        with _locked(alone=True):
            _delete(_files())


def _files() -> list[Path]:
    """What numba has written."""
    try:
        return [path for path in sorted(FOLDER.iterdir()) if path.suffix in (".nbi", ".nbc")] if FOLDER else []
    except OSError:
        return []


def _verify() -> None:
    """Delete all files if one is not what was written. A file is looked at once, and again when it has changed."""
    files = _files()
    if files and not _seen and FOLDER is not None and FOLDER.stat().st_mode & stat.S_IWOTH:
        notes.append(f"everyone can write to {FOLDER}, and so run code as you: chmod -R o-w, or set NUMBA_CACHE_DIR")
    if not any(_sum(path).exists() for path in files):
        return  # kept before there were checksums: they get theirs if they load
    new = [path for path in files if _seen.get(path) != _changed(path)]
    if not all(_is_whole(path) for path in new):
        with _locked(alone=True):  # another process may have been about to write the checksums
            files = _files()
            new = [path for path in files if _seen.get(path) != _changed(path)]
            if not all(_is_whole(path) for path in new):
                _delete(files)
                return
    for path in new:
        _seen[path] = _changed(path)


def _sum(path: Path) -> Path:
    return path.with_name(path.name + SUM)


def _is_whole(path: Path) -> bool:
    try:
        return int(_sum(path).read_text(), 16) == zlib.crc32(path.read_bytes())
    except (OSError, ValueError):
        return False


def _delete(files: list[Path]) -> None:
    if files:
        notes.append(f"compiled kernels in {FOLDER} were damaged: they are deleted and compiled again")
    for path in files:
        for each in (path, _sum(path)):
            with suppress(OSError):
                if each.is_dir():
                    shutil.rmtree(each)
                else:
                    each.unlink()


def _seal() -> None:
    """Write the checksum of every file that this process has added or changed."""
    for path in _files():
        changed = _changed(path)
        if _seen.get(path) != changed:
            with suppress(OSError):
                aside = path.with_name(f"{path.name}.{os.getpid()}{SUM}")
                aside.write_text(f"{zlib.crc32(path.read_bytes()):08x}\n")
                aside.replace(_sum(path))
            _seen[path] = changed


def _changed(path: Path) -> int:
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0
