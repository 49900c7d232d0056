"""The datasets of a results file: described, large ones in pieces, each tied to its dimensions."""

from __future__ import annotations

import functools

import h5py
import numpy as np
from h5py import h5a, h5d, h5p, h5s, h5t

from pounding_cli.store import packed
from pounding_cli.store.packed import Slabs
from pounding_cli.store.shared import REFERENCE, SharedTexts

_PIECES_ABOVE = 1 << 13
"""Arrays above this size [bytes] are stored in pieces; smaller ones are not worth the chunk index."""

_TEXT = h5py.string_dtype()
_DIMENSIONS = h5py.vlen_dtype(h5py.ref_dtype)
_ONE = h5s.create(h5s.SCALAR)
_PLACES = np.dtype([("dataset", h5py.ref_dtype), ("dimension", np.uint32)], align=True)
"""Of the attributes by which datasets and scales know each other (HDF5's "Dimension Scale Specification")."""


class Datasets:
    """Makes the datasets of a file, by the calls of HDF5 itself: h5py's take up to four times as long.

    `tie` comes last: HDF5 ties one dimension of one dataset at a time, and each time writes all that a scale knows.
    """

    def __init__(self, file: h5py.File) -> None:
        self._file = file
        self._shared = SharedTexts(file)
        self._scales: dict[str, h5py.Dataset] = {}
        self._along: list[tuple[h5py.Dataset, tuple[str, ...]]] = []

    def scale(self, name: str, values: np.ndarray, unit: str, text: str) -> h5py.Dataset:
        """The coordinate along a dimension of its own."""
        dataset = self._file.create_dataset(name, data=values, dtype=_TEXT if values.dtype == object else values.dtype)
        _describe(dataset, unit, text)
        dataset.make_scale(name)
        self._scales[name] = dataset
        return dataset

    def write(self, name: str, dims: tuple[str, ...], array: np.ndarray | Slabs, unit: str, text: str) -> h5py.Dataset:
        """A variable over some dimensions."""
        each = _size(array.dtype)
        if array.size * each <= _PIECES_ABOVE:
            whole = array.whole() if isinstance(array, Slabs) else array
            return self._told(_stored(self._file, name, whole), dims, unit, text)
        size = packed.slab_of(array.shape, packed.PIECE_BYTES // each)
        dataset = self.empty(name, dims, array.shape, array.dtype, size, unit, text)
        for at in packed.slabs(array.shape, size):
            self.put(dataset, tuple(each.start for each in at), array[at])
        return dataset

    def empty(
        self,
        name: str,
        dims: tuple[str, ...],
        shape: tuple[int, ...],
        dtype: np.dtype,
        piece: tuple[int, ...],
        unit: str,
        text: str,
    ) -> h5py.Dataset:
        """A variable that comes in pieces of this shape, for `put`."""
        if dtype.hasobject:
            # pieces are written whole: HDF5 need not hold them, 8 MB of each variable; h5py takes 0 bytes for no answer
            dataset = self._file.create_dataset(name, shape, _TEXT, chunks=piece, rdcc_nbytes=1)
        else:
            dataset = packed.create(self._file, name, shape, dtype, piece)
        return self._told(dataset, dims, unit, text)

    def put(self, dataset: h5py.Dataset, at: tuple[int, ...], piece: np.ndarray) -> None:
        """Fill a piece of a variable that was made `empty`; `at`: where it begins."""
        if piece.dtype != object:
            packed.put(dataset, at, piece)
            return
        references = self._shared.references(piece)
        if references is None:
            dataset[tuple(slice(begin, begin + size) for begin, size in zip(at, piece.shape, strict=True))] = piece
        else:
            dataset.id.write_direct_chunk(at, packed.filled(references, dataset.chunks).tobytes())

    def tie(self) -> None:
        """Tell every dataset its scales, and every scale the datasets along it."""
        own = {name: np.array([scale.ref], h5py.ref_dtype) for name, scale in self._scales.items()}
        places: dict[str, list[tuple[h5py.Reference, int]]] = {name: [] for name in own}
        for dataset, dims in self._along:
            known = np.empty(len(dims), _DIMENSIONS)
            reference = dataset.ref
            for number, dim in enumerate(dims):
                known[number] = own[dim]
                places[dim].append((reference, number))
            _add(dataset, "DIMENSION_LIST", known, *_dimension_types())
        for name, found in places.items():
            if found:
                self._scales[name].attrs.create("REFERENCE_LIST", np.array(found, _PLACES))

    def _told(self, dataset: h5py.Dataset, dims: tuple[str, ...], unit: str, text: str) -> h5py.Dataset:
        _describe(dataset, unit, text)
        if dims:
            self._along.append((dataset, dims))
        return dataset


def _size(dtype: np.dtype) -> int:
    """What a value takes in the file [bytes]."""
    return REFERENCE.itemsize if dtype.hasobject else dtype.itemsize


def _stored(group: h5py.Group, name: str, values: np.ndarray) -> h5py.Dataset:
    """A small dataset."""
    how = h5p.create(h5p.DATASET_CREATE)
    how.set_obj_track_times(False)
    dtype = _TEXT if values.dtype == object else values.dtype
    kind, here = h5t.py_create(dtype, logical=True), h5t.py_create(dtype)
    space = h5s.create_simple(values.shape) if values.shape else _ONE
    made = h5d.create(group.id, name.encode(), kind, space, how)
    made.write(h5s.ALL, h5s.ALL, np.ascontiguousarray(values), here)
    return h5py.Dataset(made)


def _describe(dataset: h5py.Dataset, unit: str, text: str) -> None:
    for name, value in (("long_name", text), *([("units", unit)] if unit else [])):
        _add(dataset, name, np.array(value, object), *_text_types())


@functools.cache
def _text_types() -> tuple[h5t.TypeID, h5t.TypeID]:
    """Texts in the file and here."""
    return h5t.py_create(_TEXT, logical=True), h5t.py_create(_TEXT)


@functools.cache
def _dimension_types() -> tuple[h5t.TypeID, h5t.TypeID]:
    """Values of DIMENSION_LIST in the file and here."""
    return h5t.py_create(_DIMENSIONS, logical=True), h5t.py_create(_DIMENSIONS)


def _add(dataset: h5py.Dataset, name: str, value: np.ndarray, kind: h5t.TypeID, here: h5t.TypeID) -> None:
    """A new attribute. h5py makes it under another name and renames it, in case there is one: three times as long."""
    space = h5s.create_simple(value.shape) if value.shape else _ONE
    h5a.create(dataset.id, name.encode(), kind, space).write(value, mtype=here)
