"""The seal of a results file: checksums of all its bytes behind the HDF5 content, verified with whatever is read.

The content is cut into blocks. Behind it stand the CRC-32 of every block (little-endian, 4 bytes each) and a foot:
a magic word, the size of the content, the size of a block, and the SHA-256 of the foot and the checksums. HDF5 ignores
what stands behind its content, so any program that reads HDF5 reads a sealed file.
"""

from __future__ import annotations

import errno
import hashlib
import io
import os
import stat
import struct
from collections import OrderedDict
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pounding_cli.store.packed import deflate

MAGIC = b"pound seal 1\n\0\0\0"
BLOCK = 1 << 12
"""Bytes of content with a checksum of their own: so much is lost where one bit is."""

_FOOT = struct.Struct("<16sQI32s")
_SPAN = 1 << 8
"""Blocks read at a time."""

_CACHED = 256
"""Verified blocks that are held; HDF5 reads its own records a few hundred bytes at a time."""


class Unsealed(OSError):
    """The file carries no seal, or one that is damaged itself."""


def seal(handle: int) -> None:
    """Write the seal behind the content of an open file.  Raises OSError."""
    size = os.fstat(handle).st_size
    sums = np.fromiter(_sums_of(handle, size), "<u4", -(-size // BLOCK)).tobytes()
    left = memoryview(sums + _foot(size, BLOCK, sums))
    while len(left):
        done = os.pwrite(handle, left, size)
        left, size = left[done:], size + done


def _sums_of(handle: int, size: int) -> Iterator[int]:
    """The checksum of every block of an open file of this size [bytes]."""
    for begin in range(0, size, _SPAN * BLOCK):
        content = memoryview(os.pread(handle, min(_SPAN * BLOCK, size - begin), begin))
        yield from (deflate.crc32(content[at : at + BLOCK]) for at in range(0, len(content), BLOCK))


def is_sealed(path: Path) -> bool:
    """Whether a file ends as sealed ones do, damaged or not."""
    try:
        with path.open("rb") as stream:
            stream.seek(-_FOOT.size, os.SEEK_END)
            return stream.read(len(MAGIC)) == MAGIC
    except OSError:
        return False


class Sealed(io.RawIOBase):
    """The content of a sealed file, to be read by the HDF5 library; a block that is damaged is never handed out.

    Attributes
    ----------
    damage : in words, what was found damaged so far; "" where nothing was
    foot : the end of the seal, with the SHA-256 of all checksums

    Raises
    ------
    OSError : on opening, no regular file, or one that cannot be read (`Unsealed`: that carries no sound seal); on
        reading, a block is damaged
    """

    _handle = -1

    def __init__(self, path: Path) -> None:
        self.damage = ""
        self._at = 0
        self._held: OrderedDict[int, bytes] = OrderedDict()
        self._handle = open_regular(path)
        try:
            self.size, self._block, self._sums, self.foot = _seal_of(self._handle)
        except BaseException:
            self.close()  # now: closed later, by the collector, its number may be another file's
            raise

    def verify(self) -> None:
        """Read everything.  Raises OSError where a block is damaged."""
        for first in range(0, len(self._sums), _SPAN):
            self._read(first, min(first + _SPAN, len(self._sums)))

    def close(self) -> None:
        handle, self._handle = self._handle, -1
        if handle >= 0:
            os.close(handle)
        super().close()

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        self._at = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self.size}[whence]
        return self._at

    def tell(self) -> int:
        return self._at

    def readinto(self, buffer) -> int:
        view = memoryview(buffer).cast("B")
        count = max(0, min(len(view), self.size - self._at))
        if count:
            first, last = self._at // self._block, (self._at + count - 1) // self._block + 1
            pieces = self._held_block(first) if last == first + 1 else self._read(first, last)
            begin = self._at - first * self._block
            view[:count] = memoryview(pieces)[begin : begin + count]
            self._at += count
        return count

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def _held_block(self, number: int) -> bytes:
        """One block, verified, and held for the next time."""
        if number in self._held:
            self._held.move_to_end(number)
        else:
            self._held[number] = self._read(number, number + 1)
            if len(self._held) > _CACHED:
                self._held.popitem(last=False)
        return self._held[number]

    def _read(self, first: int, last: int) -> bytes:
        """Blocks from `first` to before `last`, verified."""
        content = os.pread(self._handle, (last - first) * self._block, first * self._block)
        view = memoryview(content)[: self.size - first * self._block]
        for number in range(first, last):
            begin = (number - first) * self._block
            if deflate.crc32(view[begin : begin + self._block]) != self._sums[number]:
                begin = number * self._block
                end = min(begin + self._block, self.size)
                self.damage = f"bytes {begin} to {end - 1} are not those that were written"
                raise OSError(errno.EIO, self.damage)
        return content


def open_regular(path: Path) -> int:
    """A handle of a regular file, to read; a pipe or a device is refused at once.  Raises OSError."""
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise OSError(errno.EINVAL, "it is not a regular file")
    return handle


def _foot(size: int, block: int, sums: bytes) -> bytes:
    sha = hashlib.sha256(_FOOT.pack(MAGIC, size, block, b"") + sums).digest()
    return _FOOT.pack(MAGIC, size, block, sha)


def _seal_of(handle: int) -> tuple[int, int, memoryview, bytes]:
    """Size of the content, size of a block, checksums of the blocks, the foot.  Raises Unsealed."""
    whole = os.fstat(handle).st_size
    foot = os.pread(handle, _FOOT.size, max(0, whole - _FOOT.size))
    if len(foot) != _FOOT.size or not foot.startswith(MAGIC):
        raise Unsealed(errno.EIO, "its checksums are missing: it was cut short, or changed by another program")
    _, size, block, _ = _FOOT.unpack(foot)
    count = (whole - _FOOT.size - size) // 4
    if block != BLOCK or count != -(-size // BLOCK) or size + 4 * count + _FOOT.size != whole:
        raise Unsealed(errno.EIO, "its checksums are damaged")
    sums = os.pread(handle, 4 * count, size)
    if foot != _foot(size, block, sums):
        raise Unsealed(errno.EIO, "its checksums are damaged")
    return size, block, np.frombuffer(sums, "<u4").astype(np.uint32).data, foot
