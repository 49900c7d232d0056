"""Swept keys in a results file: their values, and the unit the study writes each in."""

from __future__ import annotations

from typing import Any

import h5py

from pounding_cli.numbers import Unit
from pounding_cli.store.structure import number, refused, strings


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
