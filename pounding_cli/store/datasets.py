"""The datasets of a results file: described, large ones compressed, each tied to its dimensions."""

from __future__ import annotations

import h5py
import numpy as np
from h5py import h5a, h5s, h5t

from pounding_cli.store import packed
from pounding_cli.store.packed import Slabs

_PACKED_ABOVE = 1 << 13
"""Arrays above this size [bytes] are compressed; smaller ones are not worth the chunk index."""

_TEXTS = 1 << 16
"""Texts written at a time: for each, h5py takes some 50 bytes until all are written."""

_DIMENSIONS = h5py.vlen_dtype(h5py.ref_dtype)
_ONE = h5s.create(h5s.SCALAR)
_PLACES = np.dtype([("dataset", h5py.ref_dtype), ("dimension", np.uint32)], align=True)
"""Of the attributes by which datasets and scales know each other (HDF5's "Dimension Scale Specification")."""


class Datasets:
    """Makes the datasets of a file.

    `tie` comes last: HDF5 ties one dimension of one dataset at a time, and each time writes all that a scale knows.
    """

    def __init__(self, file: h5py.File) -> None:
        self._file = file
        self._scales: dict[str, h5py.Dataset] = {}
        self._along: list[tuple[h5py.Dataset, tuple[str, ...]]] = []

    def scale(self, name: str, values: np.ndarray, unit: str, text: str) -> h5py.Dataset:
        """The coordinate along a dimension of its own."""
        dataset = self._file.create_dataset(name, data=values, dtype=_dtype(values))
        _describe(dataset, unit, text)
        dataset.make_scale(name)
        self._scales[name] = dataset
        return dataset

    def write(self, name: str, dims: tuple[str, ...], array: np.ndarray | Slabs, unit: str, text: str) -> h5py.Dataset:
        """A variable over some dimensions."""
        if array.dtype != object and array.nbytes > _PACKED_ABOVE:
            dataset = packed.write(self._file, name, array)
        elif array.size > _TEXTS:
            dataset = self._file.create_dataset(name, array.shape, _dtype(array))
            for at in packed.slabs(array.shape, packed.slab_of(array.shape, _TEXTS)):
                dataset[at] = array[at]
        else:
            whole = array.whole() if isinstance(array, Slabs) else array
            dataset = self._file.create_dataset(name, data=whole, dtype=_dtype(whole))
        return self._told(dataset, dims, unit, text)

    def empty(
        self, name: str, dims: tuple[str, ...], shape: tuple[int, ...], like: np.ndarray, unit: str, text: str
    ) -> h5py.Dataset:
        """A variable that comes in pieces such as `like`, for `put`."""
        if like.dtype == object:
            # pieces are written whole: HDF5 need not hold them, 8 MB of each variable; h5py takes 0 bytes for no answer
            dataset = self._file.create_dataset(name, shape, _dtype(like), chunks=like.shape, rdcc_nbytes=1)
        else:
            dataset = packed.create(self._file, name, shape, like.dtype, like.shape)
        return self._told(dataset, dims, unit, text)

    def tie(self) -> None:
        """Tell every dataset its scales, and every scale the datasets along it."""
        own = {name: np.array([scale.ref], h5py.ref_dtype) for name, scale in self._scales.items()}
        places: dict[str, list[tuple[h5py.Reference, int]]] = {name: [] for name in own}
        for dataset, dims in self._along:
            known = np.empty(len(dims), _DIMENSIONS)
            for number, dim in enumerate(dims):
                known[number] = own[dim]
                places[dim].append((dataset.ref, number))
            _add(dataset, "DIMENSION_LIST", known, _DIMENSIONS)
        for name, found in places.items():
            if found:
                self._scales[name].attrs.create("REFERENCE_LIST", np.array(found, _PLACES))

    def _told(self, dataset: h5py.Dataset, dims: tuple[str, ...], unit: str, text: str) -> h5py.Dataset:
        _describe(dataset, unit, text)
        if dims:
            self._along.append((dataset, dims))
        return dataset


def put(dataset: h5py.Dataset, at: tuple[int, ...], piece: np.ndarray) -> None:
    """Fill a piece of a variable that was made `empty`; `at`: where it begins."""
    if piece.dtype == object:
        dataset[tuple(slice(begin, begin + size) for begin, size in zip(at, piece.shape, strict=True))] = piece
    else:
        packed.put(dataset, at, piece)


def _describe(dataset: h5py.Dataset, unit: str, text: str) -> None:
    for name, value in (("long_name", text), *([("units", unit)] if unit else [])):
        _add(dataset, name, np.array(value, object), h5py.string_dtype())


def _add(dataset: h5py.Dataset, name: str, value: np.ndarray, dtype: np.dtype) -> None:
    """A new attribute. h5py makes it under another name and renames it, in case there is one: three times as long."""
    space = h5s.create_simple(value.shape) if value.shape else _ONE
    kind, here = h5t.py_create(dtype, logical=True), h5t.py_create(dtype)
    h5a.create(dataset.id, name.encode(), kind, space).write(value, mtype=here)


def _dtype(array: np.ndarray | Slabs):
    return h5py.string_dtype() if array.dtype == object else array.dtype
