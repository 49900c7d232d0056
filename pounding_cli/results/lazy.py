"""Arrays of a results file as variables of xarray that are read when they are asked for."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from pounding_cli.results.arrays import Array, StoredValues


def to_variable(array: Array) -> xr.Variable:
    """Return an array as a variable of xarray."""
    data: Any = array.data
    if isinstance(data, StoredValues):
        data = indexing.LazilyIndexedArray(_LazyValues(data))
    return xr.Variable(array.dims, data, dict(array.attrs), fastpath=True)  # otherwise it asks Dask of each


class _LazyValues(BackendArray):
    """Values of a file as xarray asks for them; a pickle holds the values."""

    def __init__(self, stored: StoredValues) -> None:
        self.stored = stored
        self.shape = stored.shape
        self.dtype = stored.dtype

    def __deepcopy__(self, memo: dict[int, Any]) -> _LazyValues:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return indexing.NumpyIndexingAdapter, (self.stored.read(),)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self._read_part)

    def _read_part(self, key: tuple[Any, ...]) -> np.ndarray:
        return self.stored.read_part(key)
