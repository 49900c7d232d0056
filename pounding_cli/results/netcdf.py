"""Groups of a results file as xarray Datasets: what `xarray.open_dataset` does in a tenth of the time. Numbers that are
large are read when they are asked for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

LARGE = 1 << 18
"""Bytes from which a variable is read when it is asked for; its file stays open until then."""

_OF_HDF5 = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "DIMENSION_LABELS")
"""Attributes by which HDF5 ties dimensions to variables."""


def read(path: Path, group: str) -> xr.Dataset:
    """A group of a file."""
    file = h5py.File(path)
    attrs = dict(file[group].attrs)
    beside = str(attrs.pop("coordinates", "")).split()
    items = {name: item for name, item in file[group].items() if isinstance(item, h5py.Dataset)}
    variables = {name: _variable(name, item) for name, item in items.items()}
    if not any(item.nbytes > LARGE for item in items.values()):
        file.close()
    coords = {name: v for name, v in variables.items() if v.dims == (name,) or name in beside}
    return xr.Dataset({name: v for name, v in variables.items() if name not in coords}, coords, attrs)


def _variable(name: str, item: h5py.Dataset) -> xr.Variable:
    dims = tuple(dim[0].name.rpartition("/")[2] if len(dim) else name for dim in item.dims)
    attrs = {key: value for key, value in item.attrs.items() if key not in _OF_HDF5}
    stored = _Stored(item)
    data = indexing.LazilyIndexedArray(stored) if item.nbytes > LARGE else stored.values(())
    return xr.Variable(dims, data, attrs, fastpath=True)


class _Stored(BackendArray):
    """Values that stay in their file until they are asked for.

    The open file is one of HDF5, which has neither copies nor pickles: copies share it, for a file that is written once
    does not change under them; a pickle holds the values.
    """

    def __init__(self, item: h5py.Dataset) -> None:
        self.is_text = h5py.check_string_dtype(item.dtype) is not None
        self.item, self.shape, self.dtype = item, item.shape, np.dtype(object) if self.is_text else item.dtype

    def __deepcopy__(self, memo: dict[int, Any]) -> _Stored:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return indexing.NumpyIndexingAdapter, (self.values(()),)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self.values)

    def values(self, key: tuple[Any, ...]) -> np.ndarray:
        """The values at integers and slices."""
        found = np.asarray(self.item[key])
        if not self.is_text:
            return found
        known = {text: text.decode() for text in set(found.ravel().tolist())}  # many scenes say the same
        return np.array([known[text] for text in found.ravel().tolist()], object).reshape(found.shape)
