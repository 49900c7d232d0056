"""Swept keys in a results file: their values, and the unit the study writes each in."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

import h5py
import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.store.structure import number, refused, strings
from pounding_cli.texts import plain

PIECE = 1 << 16
"""Numbers or texts read at a time: a text takes some 150 bytes."""


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


def assumed_heights(file: h5py.File) -> tuple[str, ...]:
    """The buildings whose storey heights the study leaves to their default; none where a file does not say."""
    return tuple(plain(str(name)) for name in json.loads(file["study"].attrs.get("assumed_heights", "[]")))


def coordinate(file: h5py.File, name: str) -> list[Any]:
    """The values of a swept key: numbers or texts."""
    data = file[name]
    return list(strings(data)) if h5py.check_string_dtype(data.dtype) else [float(v) for v in data[:]]


def pieces(dataset: h5py.Dataset, lead: tuple[int | slice, ...]) -> Iterator[np.ndarray]:
    """A dataset over the swept axes, some of its points at a time: each piece with the points in its first dimension.

    lead : what is taken of every swept axis
    """
    behind = dataset.shape[len(lead) :]
    if not lead or not isinstance(lead[0], slice):
        yield dataset[lead].reshape(-1, *behind)
        return
    step = max(1, PIECE // max(1, math.prod(dataset.shape[1:])))
    for begin in range(0, dataset.shape[0], step):
        yield dataset[(slice(begin, begin + step), *lead[1:])].reshape(-1, *behind)
