"""The arrays of a results file: names, dimensions and attributes, and their bytes as netCDF-4 by h5py."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

if TYPE_CHECKING:
    import xarray as xr

MAX_UNCOMPRESSED = 2048
"""Bytes up to which a variable is not compressed."""

MIN_STORED = 1 << 18
"""Bytes from which a variable of a file is read when it is asked for; its file stays open until then."""

HDF5_ATTRIBUTES = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "DIMENSION_LABELS")
"""Attributes by which HDF5 ties dimensions to variables."""


class StoredValues:
    """Values that stay in their file until they are asked for.

    The open file has neither copies nor pickles: copies share it, since a results file is written once and never
    changed; a pickle holds the values.
    """

    def __init__(self, item: h5py.Dataset, key: tuple[slice, ...] = ()) -> None:
        self.item = item
        self.key = key
        self.is_text = h5py.check_string_dtype(item.dtype) is not None
        self.dtype = np.dtype(object) if self.is_text else item.dtype
        lengths = [len(range(*each.indices(size))) for each, size in zip(key, item.shape, strict=False)]
        self.shape = (*lengths, *item.shape[len(key) :])
        self._values: np.ndarray | None = None

    def read(self) -> np.ndarray:
        """Return all values."""
        if self._values is None:
            self._values = _read_item(self.item, self.key)
        return self._values

    def read_part(self, key: tuple[Any, ...]) -> np.ndarray:
        """Return the values at integers and slices, without reading the others."""
        if self._values is None and not self.key:
            return _read_item(self.item, key)
        return np.asarray(self.read()[key])

    def __reduce__(self) -> tuple[Any, ...]:
        return np.asarray, (self.read(),)

    def __deepcopy__(self, memo: dict[int, Any]) -> StoredValues:
        return self


def _read_item(item: h5py.Dataset, key: tuple[Any, ...]) -> np.ndarray:
    values = np.asarray(item[key])
    if h5py.check_string_dtype(item.dtype) is None:
        return values
    texts = {text: text.decode() for text in set(values.ravel().tolist())}  # many scenes have the same
    return np.array([texts[text] for text in values.ravel().tolist()], object).reshape(values.shape)


@dataclass(frozen=True, eq=False)
class Array:
    """A variable: the names of its dimensions, its values, its attributes."""

    dims: tuple[str, ...]
    data: np.ndarray | StoredValues
    attrs: Mapping[str, Any] = field(default_factory=dict)

    @property
    def values(self) -> np.ndarray:
        """The values, read from the file if they are still there."""
        return self.data.read() if isinstance(self.data, StoredValues) else self.data

    @property
    def shape(self) -> tuple[int, ...]:
        """The lengths of its dimensions."""
        return self.data.shape

    def cut(self, index: Mapping[str, int]) -> Array:
        """Return the array with some dimensions cut to one place each, which stay dimensions of length 1."""
        if not set(index) & set(self.dims):
            return self
        key = tuple(slice(index[dim], index[dim] + 1) if dim in index else slice(None) for dim in self.dims)
        if isinstance(self.data, StoredValues) and not self.data.key:
            return Array(self.dims, StoredValues(self.data.item, key), self.attrs)
        return Array(self.dims, self.values[key], self.attrs)


@dataclass(frozen=True, eq=False)
class ResultArrays:
    """The arrays of a results file, or of a group in it; what an xarray.Dataset has, which takes long to import.

    data, coordinates : variables by name
    """

    data: Mapping[str, Array]
    coordinates: Mapping[str, Array]
    attrs: Mapping[str, Any]

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> ResultArrays:
        """Return the arrays of an xarray.Dataset."""
        arrays = {str(name): Array(tuple(map(str, v.dims)), v.values, v.attrs) for name, v in dataset.variables.items()}
        coordinates = {str(name): arrays.pop(str(name)) for name in dataset.coords}
        return cls(arrays, coordinates, {str(name): value for name, value in dataset.attrs.items()})

    def __contains__(self, name: str) -> bool:
        return name in self.data or name in self.coordinates

    def __getitem__(self, name: str) -> Array:
        return self.data[name] if name in self.data else self.coordinates[name]

    @property
    def sizes(self) -> dict[str, int]:
        """The lengths of all dimensions."""
        arrays = (*self.coordinates.values(), *self.data.values())
        return {dim: size for array in arrays for dim, size in zip(array.dims, array.shape, strict=True)}

    def cut(self, index: Mapping[str, int]) -> ResultArrays:
        """Return the arrays with some dimensions cut to one place each, which stay dimensions of length 1."""
        data = {name: array.cut(index) for name, array in self.data.items()}
        coordinates = {name: array.cut(index) for name, array in self.coordinates.items()}
        return ResultArrays(data, coordinates, self.attrs)

    def with_attrs(self, attrs: Mapping[str, Any]) -> ResultArrays:
        """Return the same arrays with further attributes."""
        return ResultArrays(self.data, self.coordinates, {**self.attrs, **attrs})

    def with_text(self, name: str, text: str, about: str) -> ResultArrays:
        """Return the same arrays with a text beside them; about : what it is."""
        array = Array((), np.array(text, object), {"long_name": about})
        return ResultArrays({**self.data, name: array}, self.coordinates, self.attrs)

    def to_dataset(self) -> xr.Dataset:
        """Return an xarray.Dataset that shares the arrays; large ones of a file are read when they are asked for."""
        import xarray as xr  # here: few commands need it

        from pounding_cli.results.lazy import to_variable

        data = {name: to_variable(array) for name, array in self.data.items()}
        coordinates = {name: to_variable(array) for name, array in self.coordinates.items()}
        return xr.Dataset(data, coordinates, dict(self.attrs))

    def to_bytes(self) -> memoryview:
        """Return the bytes of a file of these arrays."""
        return to_hdf5({"/": self})


def to_hdf5(groups: Mapping[str, ResultArrays]) -> memoryview:
    """Return the bytes of an HDF5 file of groups by their names, made in memory."""
    sink = io.BytesIO()
    with h5py.File(sink, "w", libver=("v110", "latest")) as file:
        for name, arrays in groups.items():
            _write_group(file.require_group(name), arrays)
    return sink.getbuffer()


def _write_group(group: h5py.Group, arrays: ResultArrays) -> None:
    variables = {**arrays.coordinates, **arrays.data}
    sizes = arrays.sizes
    variables |= {dim: Array((dim,), np.arange(size)) for dim, size in sizes.items() if dim not in variables}
    scales: dict[str, h5py.Dataset] = {}
    for name, array in sorted(variables.items(), key=lambda item: item[1].dims != (item[0],)):  # dimensions first
        values = array.values
        options: dict[str, Any] = {}
        if values.dtype.kind in "OU":
            values = values.astype(object)
            options = {"dtype": h5py.string_dtype()}
        elif array.dims and values.nbytes > MAX_UNCOMPRESSED:
            options = {"compression": 1, "shuffle": True, "fletcher32": True}
        item = group.create_dataset(name, data=values, **options)
        if array.dims == (name,):
            item.make_scale(name)
            scales[name] = item
        else:
            for place, dim in enumerate(array.dims):
                item.dims[place].attach_scale(scales[dim])
        item.attrs.update(array.attrs)
    further = [name for name in arrays.coordinates if name not in sizes]
    group.attrs.update({**arrays.attrs, **({"coordinates": " ".join(further)} if further else {})})


def read_arrays(path: Path, group: str = "/") -> ResultArrays:
    """Return the arrays of a group of a file; large ones are read when they are asked for."""
    file = h5py.File(path)
    attrs = dict(file[group].attrs)
    further = str(attrs.pop("coordinates", "")).split()
    items = {name: item for name, item in file[group].items() if isinstance(item, h5py.Dataset)}
    arrays = {name: _array_of(name, item) for name, item in items.items()}
    if not any(isinstance(array.data, StoredValues) for array in arrays.values()):
        file.close()
    coordinates = {name: array for name, array in arrays.items() if array.dims == (name,) or name in further}
    return ResultArrays({n: a for n, a in arrays.items() if n not in coordinates}, coordinates, attrs)


def _array_of(name: str, item: h5py.Dataset) -> Array:
    dims = tuple(dim[0].name.rpartition("/")[2] if len(dim) else name for dim in item.dims)
    attrs = {key: value for key, value in item.attrs.items() if key not in HDF5_ATTRIBUTES}
    is_large = item.nbytes > MIN_STORED
    return Array(dims, StoredValues(item) if is_large else _read_item(item, ()), attrs)
