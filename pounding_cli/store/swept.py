"""HDF5 for studies that are not time histories of groups: swept dimensions, scalars and vectors over them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from pounding_cli import __version__
from pounding_cli.errors import InputError, Problem
from pounding_cli.words import Unit

if TYPE_CHECKING:
    from pounding_cli.study.points import PointAxis


def create(path: Path) -> h5py.File:
    """A new file in place of an old one.  Raises `InputError` where the folder refuses."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return h5py.File(path, "w", track_order=True)
    except OSError as error:
        raise InputError(
            Problem(f"cannot write {path}: {error.strerror or error}", "name another file with -o FILE.h5")
        ) from error


def open_swept(path: Path, kind: str) -> h5py.File:
    """A file written for `kind` ("connector" or "wall"), to read.  Raises `InputError` for any other file."""
    try:
        file = h5py.File(path, "r")
    except OSError:
        hint = f"write it with `pound {kind} STUDY -o {path}`"
        raise InputError(Problem(f"{path} is not a results file", hint)) from None
    if file.attrs.get("kind") != kind:
        file.close()
        raise InputError(Problem(f"{path} holds no results of `pound {kind}`", f"run `pound {kind} STUDY -o FILE.h5`"))
    return file


def kind_of(path: Path) -> str:
    """What wrote an HDF5 file: "connector", "wall", or "" for anything else."""
    try:
        with h5py.File(path, "r") as file:
            return str(file.attrs.get("kind", ""))
    except OSError:
        return ""


def write_head(file: h5py.File, kind: str, title: str, text: str, resolved: dict[str, Any]) -> None:
    """The study as written and as resolved, and the version that wrote the file."""
    file.attrs["kind"] = kind
    file.attrs["title"] = title
    file.attrs["study"] = text
    file.attrs["resolved"] = json.dumps(resolved)
    file.attrs["pounding_cli"] = __version__


def write_axes(
    file: h5py.File, axes: Sequence[PointAxis], values: Sequence[tuple[tuple[int, ...], dict[str, Any]]]
) -> tuple[str, ...]:
    """One dimension scale per swept axis, named like its first key; further keys of the axis lie along it."""
    names = []
    for place, axis in enumerate(axes):
        for name, unit in zip(axis.names, axis.units, strict=True):
            column: dict[int, Any] = {index[place]: found[name] for index, found in values}
            ordered = [column[i] for i in sorted(column)]
            text = any(isinstance(value, str) for value in ordered)
            data = [str(v) for v in ordered] if text else np.array(ordered, dtype=float)
            # A variable named like a path would lie in folders: HDF5 separates those by "/", not by "."
            dataset = file.create_dataset(name, data=data, dtype=h5py.string_dtype() if text else float)
            describe_unit(dataset, unit)
            if name == axis.names[0]:
                dataset.make_scale(name)
            else:
                dataset.dims[0].attach_scale(file[axis.names[0]])
        names.append(axis.names[0])
    return tuple(names)


def write_scale(group: h5py.Group, name: str, data: np.ndarray, units: str) -> None:
    """A coordinate along a dimension of its own."""
    group[name] = data
    group[name].make_scale(name)
    group[name].attrs["units"] = units


def write_array(group: h5py.Group, name: str, data: Any, dims: Sequence[str], units: str, text: str) -> None:
    """An array with named dimensions, its unit, and what it is."""
    dataset = group.create_dataset(name, data=data)
    for place, dim in enumerate(dims):
        scale = group[dim] if dim in group else group.file[dim]
        dataset.dims[place].attach_scale(scale)
    dataset.attrs["units"] = units
    dataset.attrs["long_name"] = text


def axes_of(file: h5py.File, like: str) -> tuple[str, ...]:
    """The swept dimensions, read off the scalar variable `like`."""
    return tuple(dim[0].name.rsplit("/", 1)[-1] for dim in file[like].dims)


def describe_unit(dataset: h5py.Dataset, unit: Unit) -> None:
    """Note the unit of a swept key: `units` (SI) of its numbers, and how the study wrote it."""
    if unit.si and dataset.dtype.kind == "f":
        dataset.attrs["units"] = unit.si
    dataset.attrs["unit_written"] = unit.name
    dataset.attrs["unit_factor"] = unit.factor


def written(dataset: h5py.Dataset) -> Unit:
    """The unit the study wrote a swept key in; SI where a file does not say."""
    si = str(dataset.attrs.get("units", ""))
    return Unit(str(dataset.attrs.get("unit_written", si)), float(dataset.attrs.get("unit_factor", 1.0)), si)


def coordinate(file: h5py.File, name: str) -> list[Any]:
    """The values of a swept key: numbers or texts."""
    data = file[name]
    return list(data.asstr()[:]) if h5py.check_string_dtype(data.dtype) else [float(v) for v in data[:]]
