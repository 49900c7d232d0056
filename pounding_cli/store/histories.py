"""The group `/histories` of a results file: what chosen scenes did over time (docs/histories.md)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from pounding_cli.solve.histories import ENERGIES, History
from pounding_cli.store.layout import COORDINATES

GROUP = "histories"

FIELDS = {
    "ground_acceleration": (("time",), "m/s2", "ground acceleration"),
    "ground_displacement": (("time",), "m", "ground acceleration integrated twice from rest, no baseline correction"),
    "displacement": (("time", "building", "floor"), "m", "floor displacement relative to the ground"),
    "total_acceleration": (("time", "building", "floor"), "m/s2", "floor acceleration, ground included"),
    "drift": (("time", "building", "storey"), "m", "storey drift"),
    "shear": (("time", "building", "storey"), "N", "storey shear, without damping force"),
    "sway": (("time", "building"), "m", "translation of the foundation"),
    "rocking": (("time", "building"), "rad", "rotation of the foundation"),
    "link_force": (("time", "link"), "N", "link force, pulling negative"),
    "energy_input": (("time",), "J", "energy put in by the ground so far"),
    "energy_kinetic": (("time",), "J", "kinetic energy"),
    "energy_stored": (("time",), "J", "elastic energy in storeys and foundations"),
    "energy_damping": (("time",), "J", "energy lost in structural damping so far"),
    "energy_hysteresis": (("time",), "J", "energy lost in yielding storeys so far"),
    "energy_links": (("time",), "J", "energy the links took so far, stored or lost"),
}
"""Dataset -> dimensions, unit, meaning."""


def write_history(file: h5py.File, place: Mapping[str, Any], history: History, columns: list[int]) -> None:
    """Write one kept scene as `/histories/<n>`, n from 0.

    Parameters
    ----------
    file : a results file whose coordinates (building, storey, floor, link) are written
    place : case, analysis, record and the swept values, as attributes
    history : of the scene
    columns : place of every link of the scene along the file's dimension `link`
    """
    parent = file.require_group(GROUP)
    group = parent.create_group(str(len(parent)))
    group.attrs.update(place)
    scales = {"time": _scale(group, "time", history.time, "s", "time since the motion began")}
    for dim in ("building", "storey", "floor", "link"):
        if dim in file:  # links: no case may have one
            scales[dim] = _scale(group, dim, file[dim][()], *COORDINATES[dim])
    for name, (dims, unit, text) in FIELDS.items():
        if not all(dim in scales for dim in dims):
            continue
        values = _values(history, name)
        whole = np.full([scales[dim].size for dim in dims], np.nan, np.float32)
        if name == "link_force":
            whole[:, columns] = values
        else:
            whole[tuple(slice(size) for size in values.shape)] = values
        chunks = (max(1, whole.shape[0]), *(1 for _ in dims[1:]))  # one series is read without the others
        dataset = group.create_dataset(name, data=whole, chunks=chunks, compression="gzip", shuffle=True)
        dataset.attrs.update({"units": unit, "long_name": text})
        for number, dim in enumerate(dims):
            dataset.dims[number].attach_scale(scales[dim])


def read_history(group: h5py.Group) -> History:
    """A kept scene; links in the file's order, NaN where the scene has none."""
    texts = {dim: tuple(group[dim].asstr()[:]) if dim in group else () for dim in ("building", "link")}
    time = group["time"][()]
    arrays = {name: group[name][()] if name in group else np.empty((time.size, 0), np.float32) for name in FIELDS}
    energy = {name: arrays.pop(f"energy_{name}") for name in ENERGIES}
    return History(time=time, **arrays, energy=energy, buildings=texts["building"], links=texts["link"])


def _values(history: History, name: str) -> np.ndarray:
    kind = name.removeprefix("energy_")
    return getattr(history, name) if kind == name else history.energy[kind]


def _scale(group: h5py.Group, name: str, values: np.ndarray, unit: str, text: str) -> h5py.Dataset:
    dtype = h5py.string_dtype() if values.dtype == object else values.dtype
    dataset = group.create_dataset(name, data=values, dtype=dtype)
    dataset.attrs["long_name"] = text
    if unit:
        dataset.attrs["units"] = unit
    dataset.make_scale(name)
    return dataset
