"""A file for the HDF5 library to write to that never fails under it: after a failed write the library may crash."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from pounding_cli.store.seal import seal


@contextmanager
def writing(path: Path, track_order: bool = False) -> Iterator[tuple[h5py.File, Sink]]:
    """A new results file: written beside its place, sealed, then put there in one step, or not at all.

    Yields the HDF5 file and the sink under it, whose `check` tells of writes that failed.
    track_order : keep groups and attributes in the order in which they are written

    Raises
    ------
    OSError : the disk is full, or the folder went away; `path` is as it was
    """
    hidden = path.with_name(f".{path.name}.tmp")
    try:
        with Sink(hidden) as sink:
            with h5py.File(sink, "w", libver=("v110", "latest"), track_order=track_order) as file:
                yield file, sink
            sink.finish()
        hidden.replace(path)
        _sync(path.parent)
    finally:
        hidden.unlink(missing_ok=True)


def _sync(folder: Path) -> None:
    """Bring the entry of a file in its folder to the disk."""
    if os.name == "nt":
        return  # a folder has no handle to synchronise there
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


class Sink(io.RawIOBase):
    """A new file; `check` tells of a write that failed, and everything after that stays in memory, to be forgotten.

    Raises
    ------
    OSError : the file cannot be made
    """

    def __init__(self, path: Path) -> None:
        self._handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o666)
        self._at = self._end = 0
        self._failure: OSError | None = None
        self._lost: list[tuple[int, bytes]] = []

    def check(self) -> None:
        """Raises the OSError of the first write that failed, if one did."""
        if self._failure is not None:
            raise OSError(self._failure.errno, self._failure.strerror)

    def finish(self) -> None:
        """Put the seal behind what was written and bring all to the disk.  Raises OSError."""
        self.check()
        seal(self._handle)
        os.fsync(self._handle)

    def close(self) -> None:
        if not self.closed:
            os.close(self._handle)
        super().close()

    # What the library asks for

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        self._at = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._end}[whence]
        return self._at

    def tell(self) -> int:
        return self._at

    def write(self, data) -> int:  # any buffer
        left = memoryview(data).cast("B")
        size, begin = len(left), self._at
        while len(left) and self._failure is None:
            try:
                done = os.pwrite(self._handle, left, self._at)
            except OSError as error:
                self._failure = error
                break
            left, self._at = left[done:], self._at + done
        if len(left):
            self._lost.append((self._at, bytes(left)))
        self._at = begin + size
        self._end = max(self._end, self._at)
        return size

    def readinto(self, buffer) -> int:
        view = memoryview(buffer).cast("B")
        begin, size = self._at, max(0, min(len(view), self._end - self._at))
        there = os.pread(self._handle, size, begin)
        view[:size] = there + bytes(size - len(there))
        for place, data in self._lost:
            first, last = max(begin, place), min(begin + size, place + len(data))
            if first < last:
                view[first - begin : last - begin] = data[first - place : last - place]
        self._at += size
        return size

    def truncate(self, size: int | None = None) -> int:
        self._end = self._at if size is None else size
        if self._failure is None:
            try:
                os.ftruncate(self._handle, self._end)
            except OSError as error:
                self._failure = error
        return self._end

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True
