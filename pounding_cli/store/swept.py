"""HDF5 for studies that are not time histories of groups: swept dimensions, scalars and vectors over them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from pounding_cli import __version__
from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit
from pounding_cli.store.former import written_place
from pounding_cli.store.keys import FORMAT_VERSION
from pounding_cli.store.sink import writing
from pounding_cli.store.structure import number, refused, strings

if TYPE_CHECKING:
    from pounding_cli.study.points import PointAxis
    from pounding_cli.study.system_study import SystemStudy


@contextmanager
def create(path: Path) -> Iterator[h5py.File]:
    """A new file, put in place of an old one once it is whole.  Raises `InputError` where the disk refuses."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with writing(path, track_order=True) as (file, _):
            yield file
    except BrokenPipeError:  # of the screen, not of the file: `cli.streams` deals with it
        raise
    except OSError as error:
        raise InputError(
            Problem(f"cannot write {path}: {error.strerror or error}", "name another file with -o FILE.h5")
        ) from error


def write_head(file: h5py.File, kind: str, study: SystemStudy[Any], path: Path) -> None:
    """The study as written and as resolved, where it stands, and the version that wrote the file."""
    file.attrs["kind"] = kind
    file.attrs["title"] = study.title
    file.attrs["study_file"] = written_place(study, path)
    file.attrs["study"] = study.text
    file.attrs["resolved"] = json.dumps(study.resolved)
    file.attrs["format_version"] = FORMAT_VERSION
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
    """The unit the study wrote a swept key in; SI where a file does not say.  Raises InputError: it is no unit."""
    si = str(dataset.attrs.get("units", ""))
    factor = number(dataset.attrs, "unit_factor") if "unit_factor" in dataset.attrs else 1.0
    if not factor > 0:
        raise refused(dataset.name.strip("/"), "has a unit that is not positive")
    return Unit(str(dataset.attrs.get("unit_written", si)), factor, si)


def coordinate(file: h5py.File, name: str) -> list[Any]:
    """The values of a swept key: numbers or texts."""
    data = file[name]
    return list(strings(data)) if h5py.check_string_dtype(data.dtype) else [float(v) for v in data[:]]
