"""Numbers in compressed pieces, as HDF5's own filters make them (shuffle, deflate, fletcher32), several times as fast.

Any program that reads HDF5 reads them, and verifies the checksum of every piece."""

from __future__ import annotations

import functools
import importlib
import math
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np
from h5py import h5d, h5p, h5s, h5t

deflate: Any
try:
    deflate, _LEVEL = importlib.import_module("isal.isal_zlib"), 2
except ImportError:  # no wheel for this machine: another stream of the same kind, in six times the time
    deflate, _LEVEL = zlib, 1
"""The quickest levels: the digits of peaks are noise, of which slower ones make half a percent less."""

PIECE_BYTES = 1 << 20
"""Most bytes of a piece."""

_ROW = 1 << 13
"""Words that are summed at a time: few enough that BLAS does it in one thread (others that wait for more take a core),
and that sums of doubles are exact."""
_PLACES = np.arange(_ROW, dtype=float)


@dataclass(frozen=True)
class Slabs:
    """An array that is made a slab at a time, so that it takes little memory.

    shape, dtype : of the whole
    made : gives a slab; every slice has its ends
    """

    shape: tuple[int, ...]
    dtype: np.dtype
    made: Callable[[tuple[slice, ...]], np.ndarray]

    def __getitem__(self, at: tuple[slice, ...]) -> np.ndarray:
        return self.made(at)

    @property
    def size(self) -> int:
        """Its values."""
        return math.prod(self.shape)

    @property
    def nbytes(self) -> int:
        """What it would take in memory [bytes]."""
        return self.size * self.dtype.itemsize

    def whole(self) -> np.ndarray:
        """All of it."""
        return self[tuple(map(slice, (0,) * len(self.shape), self.shape))]


def create(
    group: h5py.Group, name: str, shape: tuple[int, ...], dtype: np.dtype, piece: tuple[int, ...]
) -> h5py.Dataset:
    """A dataset to be filled piece by piece; `piece`: the shape of each. As `h5py.Group.create_dataset` makes it, in
    half the time."""
    return h5py.Dataset(h5d.create(group.id, name.encode(), *_form(shape, dtype, piece)))


@functools.lru_cache(maxsize=64)
def _form(
    shape: tuple[int, ...], dtype: np.dtype, piece: tuple[int, ...]
) -> tuple[h5t.TypeID, h5s.SpaceID, h5p.PropDCID]:
    """Type, space and properties of a dataset."""
    how = h5p.create(h5p.DATASET_CREATE)
    how.set_chunk(piece)
    how.set_shuffle()
    how.set_deflate(1)
    how.set_fletcher32()
    how.set_obj_track_times(False)
    return h5t.py_create(dtype, logical=True), h5s.create_simple(shape), how


def put(dataset: h5py.Dataset, at: tuple[int, ...], values: np.ndarray) -> None:
    """Fill a piece; at the end of the dataset it may have fewer values.

    at : where it begins, a multiple of the piece along every dimension
    values : as many dimensions as the dataset
    """
    values = filled(values, dataset.chunks)
    planes = np.ascontiguousarray(np.ascontiguousarray(values).view(np.uint8).reshape(values.size, -1).T)
    content = deflate.compress(planes, _LEVEL)
    dataset.id.write_direct_chunk(at, content + fletcher32(content).to_bytes(4, "little"))


def filled(values: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Values as a whole piece: zeros behind those at the end of a dataset."""
    if values.shape == shape:
        return values
    whole = np.zeros(shape, values.dtype)
    whole[tuple(slice(size) for size in values.shape)] = values
    return whole


def write(group: h5py.Group, name: str, values: np.ndarray | Slabs) -> h5py.Dataset:
    """A dataset of values that are at hand, or are made a slab at a time."""
    size = slab_of(values.shape, PIECE_BYTES // values.dtype.itemsize)
    dataset = create(group, name, values.shape, values.dtype, size)
    for at in slabs(values.shape, size):
        put(dataset, tuple(each.start for each in at), values[at])
    return dataset


def slab_of(shape: tuple[int, ...], most: int) -> tuple[int, ...]:
    """The shape of slabs of at most so many values: whole in the last dimensions, one place in the first ones."""
    for number, size in enumerate(shape):
        after = math.prod(shape[number + 1 :])
        if after <= most:
            return (*(1 for _ in shape[:number]), min(size, most // after), *shape[number + 1 :])
    return shape


def slabs(shape: tuple[int, ...], size: tuple[int, ...]) -> Iterator[tuple[slice, ...]]:
    """The slabs of this size that make up an array, those at its ends smaller."""
    for place in np.ndindex(*(-(-whole // step) for whole, step in zip(shape, size, strict=True))):
        begins = (number * step for number, step in zip(place, size, strict=True))
        yield tuple(slice(at, min(at + step, end)) for at, step, end in zip(begins, size, shape, strict=True))


def fletcher32(content: bytes) -> int:
    """Fletcher's checksum as HDF5 forms it: of big-endian words of 16 bits, modulo 65535, 0 where all are 0. To swap
    the bytes of a word is to multiply it by 256, modulo 65535: the sums are those of little-endian words."""
    words = np.frombuffer(content + b"\0" if len(content) % 2 else content, "<u2")
    first = second = 0
    for begin in range(0, words.size, _ROW):
        some = words[begin : begin + _ROW].astype(float)
        total = int(some.sum())
        first += total
        second += (words.size - begin) * total - int(some @ _PLACES[: some.size])
    low, high = ((256 * total - 1) % 65535 + 1 if total else 0 for total in (first, second))
    return high << 16 | low
