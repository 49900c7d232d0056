"""Groups of a results file: arrays with dimensions and attributes, and their bytes as netCDF-4 by h5py, made in memory;
what `xarray.Dataset.to_netcdf` does in a tenth of the time."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

if TYPE_CHECKING:
    import xarray as xr

SMALL = 2048
"""Bytes up to which a variable is not compressed."""


class Array(NamedTuple):
    """A variable: the names of its dimensions, its values, its attributes."""

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: Mapping[str, Any] = {}


class Group(NamedTuple):
    """What an xarray.Dataset has, which takes long to import and to make.

    data, coordinates : variables by name
    """

    data: Mapping[str, Array]
    coordinates: Mapping[str, Array]
    attrs: Mapping[str, Any]

    @classmethod
    def of(cls, dataset: xr.Dataset) -> Group:
        """The same as a Dataset."""
        every = {str(name): Array(tuple(map(str, v.dims)), v.values, v.attrs) for name, v in dataset.variables.items()}
        coordinates = {str(name): every.pop(str(name)) for name in dataset.coords}
        return cls(every, coordinates, {str(name): value for name, value in dataset.attrs.items()})

    def dataset(self) -> xr.Dataset:
        """As a Dataset that shares the arrays."""
        import xarray as xr  # here: few commands need it

        data, coordinates = (
            {name: xr.Variable(*v, fastpath=True) for name, v in variables.items()}  # otherwise it asks Dask of each
            for variables in (self.data, self.coordinates)
        )
        return xr.Dataset(data, coordinates, self.attrs)


def content(groups: Mapping[str, Group]) -> memoryview:
    """The bytes of a file of groups by their names."""
    sink = io.BytesIO()
    with h5py.File(sink, "w", libver=("v110", "latest")) as file:
        for name, each in groups.items():
            _put(file.require_group(name), each)
    return sink.getbuffer()


def _put(group: h5py.Group, each: Group) -> None:
    variables, scales = {**each.coordinates, **each.data}, dict[str, h5py.Dataset]()
    sizes = {dim: size for v in variables.values() for dim, size in zip(v.dims, v.values.shape, strict=True)}
    variables |= {dim: Array((dim,), np.arange(size)) for dim, size in sizes.items() if dim not in variables}
    for name, v in sorted(variables.items(), key=lambda item: item[1].dims != (item[0],)):  # dimensions first
        how: dict[str, Any] = {}
        if v.values.dtype.kind in "OU":
            how = {"dtype": h5py.string_dtype()}
        elif v.dims and v.values.nbytes > SMALL:
            how = {"compression": 1, "shuffle": True, "fletcher32": True}
        made = group.create_dataset(name, data=v.values.astype(object) if "dtype" in how else v.values, **how)
        if v.dims == (name,):
            made.make_scale(name)
            scales[name] = made
        else:
            for place, dim in enumerate(v.dims):
                made.dims[place].attach_scale(scales[dim])
        made.attrs.update(v.attrs)
    beside = [name for name in each.coordinates if name not in sizes]
    group.attrs.update({**each.attrs, **({"coordinates": " ".join(beside)} if beside else {})})
