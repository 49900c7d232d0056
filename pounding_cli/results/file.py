"""The results file: written whole or not at all, sealed, and checked before it is read."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import Unit
from pounding_cli.results.arrays import Array, ResultArrays, read_arrays, to_hdf5
from pounding_cli.tables import Column, Table
from pounding_cli.texts import escape_controls

FORMAT = "pounding study results"
"""Attribute `format` of every results file."""

FORMAT_VERSION = 10
"""Raised whenever a reader of the former version would misread the file."""

SEAL = b"pound seal 2\n\0\0\0"
"""Stands behind the HDF5 content, and behind it the SHA-256 of that."""

SMALL = 1 << 20
"""Bytes that any variable of a file may have."""

MOST_COMPRESSED = 1100
"""Deflate makes data smaller by this factor at most."""

_END = len(SEAL) + 32
_HINT = "give a file that a pound command wrote, or run the study again"


def write_results(
    path: Path, arrays: ResultArrays, tables: Iterable[Table] = (), histories: Iterable[ResultArrays] = ()
) -> None:
    """Write a results file in the place of `path`.  Raises InputError as `write_file`."""
    groups = {"/": arrays} | {f"answer/{table.name}": _arrays_of_table(table) for table in tables}
    groups |= {f"histories/{number}": each for number, each in enumerate(histories)}
    content = to_hdf5(groups)  # in memory: where a disk is full, HDF5 ends the process
    write_file(path, content, SEAL + hashlib.sha256(content).digest())


def write_file(path: Path, *parts: bytes | memoryview) -> Path:
    """Write a file beside its place, then put it there.

    Raises
    ------
    InputError : the disk is full, or the folder went away; `path` is as it was
    """
    hidden = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        with hidden.open("wb") as stream:
            stream.writelines(parts)
            stream.flush()
            os.fsync(stream.fileno())
        hidden.replace(path)
    except OSError as error:
        hint = "free some space or choose another place; what a run has solved is kept, and the same command goes on"
        raise InputError(Issue((), f"cannot be written: {error.strerror or error}", hint, file=str(path))) from None
    finally:
        hidden.unlink(missing_ok=True)
    return path


def open_arrays(path: Path, group: str = "/") -> ResultArrays:
    """Return the arrays of a group of a results file; large ones are read when they are asked for.

    Raises
    ------
    InputError : missing, no results file, damaged, of another format version; one that would read other files or
        declares more than it holds
    """
    read_attributes(path)
    try:
        return read_arrays(path, group)
    except Exception as error:
        raise _bad(path, f"cannot be read ({error})") from None


def read_attributes(path: Path, version: int | None = FORMAT_VERSION) -> dict[str, Any]:
    """Return the attributes of a results file, which is checked.

    Parameters
    ----------
    version : format version that it must have; None: any, only attributes are to be read

    Raises InputError as `open_arrays`.
    """
    try:
        if not path.is_file():
            what = "this is not a regular file" if path.exists() else "there is no such results file"
            raise _bad(path, what, "name the file, not its folder; pound run STUDY -o FILE.h5 makes one")
        sound = _is_sealed(path)
        with h5py.File(path) as file:
            _check_kind(file, path, version)
            if not sound:
                again = "run the study again: what its cache holds is not solved again"
                raise _bad(path, "is damaged, or was changed by another program", again)
            _check(file.id, path, path.stat().st_size)
            return dict(file.attrs)
    except InputError:
        raise
    except Exception as error:  # whatever HDF5 says of a file that is none
        why = getattr(error, "strerror", None) or f"it is no sound HDF5 file ({str(error).partition(chr(10))[0]})"
        raise _bad(path, f"cannot be read: {why}") from None


def is_results(path: Path) -> bool:
    """Return whether a pound command wrote this file as its results, damaged since or not."""
    if has_seal(path):
        return True
    try:
        with h5py.File(path) as file:
            return _is_ours(file)
    except (OSError, ValueError):
        return False


def has_seal(path: Path) -> bool:
    """Return whether a seal stands at the end of a file, right or wrong."""
    try:
        with path.open("rb") as stream:
            stream.seek(-_END, os.SEEK_END)
            return stream.read(len(SEAL)) == SEAL
    except (OSError, ValueError):
        return False


def list_histories(path: Path) -> list[dict[str, Any]]:
    """Return for every history of a sound file its attributes, its `number` and how many `times` it has."""
    with h5py.File(path) as file:
        there = sorted(file["histories"].items(), key=lambda each: int(each[0])) if "histories" in file else []
        return [
            {"number": int(number), "times": group["time"].size}
            | {name: plain_value(value) for name, value in group.attrs.items()}
            for number, group in there
        ]


# Tables of answers, and units


def _arrays_of_table(table: Table) -> ResultArrays:
    """Return a table as arrays over `row`; the attribute `columns` has their order."""
    arrays = {}
    for column in table.columns:
        values = table.frame[column.name].to_numpy()
        if values.dtype.kind in "OU":
            values = np.array(list(map(str, values)), object)
        elif values.dtype.kind == "b":
            values = values.astype(np.int8)
        attrs = {"long_name": column.text} | unit_attributes(column.unit)
        attrs |= {name: getattr(column, name) for name in _OF_COLUMNS if getattr(column, name) != ""}
        attrs["is_truth"] = int(table.frame[column.name].dtype.kind == "b")
        arrays[column.name] = Array(("row",), values, attrs)
    attrs = {"columns": json.dumps([column.name for column in table.columns]), "caption": table.caption}
    return ResultArrays(arrays, {}, attrs)


def read_table(path: Path, name: str) -> Table:
    """Return a table of the group `answer` of a sound file."""
    import pandas as pd

    arrays = read_arrays(path, f"answer/{name}")
    frame = {}
    columns = []
    for key in json.loads(arrays.attrs["columns"]):
        array = arrays[key]
        frame[key] = array.values.astype(bool) if array.attrs.get("is_truth") else array.values
        further = {each: plain_value(array.attrs[each]) for each in _OF_COLUMNS if each in array.attrs}
        columns.append(Column(key, plain_value(str(array.attrs["long_name"])), read_unit(array.attrs), **further))
    return Table(name, pd.DataFrame(frame), columns, plain_value(str(arrays.attrs["caption"])))


def plain_value(value: Any) -> Any:
    """Return an attribute or a coordinate as Python has it, without control characters."""
    value = value.item() if isinstance(value, np.generic) else value
    return escape_controls(value) if isinstance(value, str) else value


_OF_COLUMNS = ("label", "digits", "low", "high", "error")
"""Properties of columns that a file keeps, besides meaning and unit."""


def unit_attributes(unit: Unit) -> dict[str, Any]:
    """Return the attributes of a variable that say its unit: SI, and as the study writes it."""
    found: dict[str, Any] = {"units": unit.si} if unit.si else {}
    return found | {"unit_written": unit.name, "unit_factor": unit.factor}


def read_unit(attrs: Mapping[Any, Any]) -> Unit:
    """Return the unit the study wrote a quantity in; SI where a file does not say."""
    si = str(attrs.get("units", ""))
    return Unit(str(attrs.get("unit_written", si)), float(attrs.get("unit_factor", 1.0)), si)


# What is checked before a file is read


def _is_sealed(path: Path) -> bool:
    """Return whether the seal stands at the end, and the bytes before it are those it was made for."""
    content = np.memmap(path, mode="r")
    return content[-_END:].tobytes() == SEAL + hashlib.sha256(content[:-_END].data).digest()


def _is_ours(file: h5py.File) -> bool:
    """`kind` stands in what `pound connector` and `pound wall` write."""
    return file.attrs.get("format") == FORMAT or file.attrs.get("kind") in ("connector", "wall")


def _check_kind(file: h5py.File, path: Path, version: int | None) -> None:
    """Refuse what is no results file of a study, or one of another format version.  Raises InputError."""
    if not _is_ours(file):
        raise _bad(path, "is HDF5 but not a results file of pound")
    if version is None:
        return
    if kind := file.attrs.get("kind"):
        hint = "its table, figures and page are in the folder of its name; xarray with h5netcdf opens the file"
        raise _bad(path, f"holds results of `pound {kind}`", hint)
    if (its := int(file.attrs["format_version"])) != version:
        hint = "install the pounding_cli that wrote it, or a newer one"
        if its < version:
            command = file.attrs.get("workflow", "run")
            hint = f"run the study again with this program: pound {command} STUDY -o {path.name} --replace"
        age = "older" if its < version else "newer"
        raise _bad(path, f"has the {age} format version {its}; this program reads version {version}", hint)


def _check(group: h5py.h5g.GroupID, path: Path, size: int) -> None:
    """Refuse what leads out of the file, or declares more than it can hold.  Raises InputError."""
    names: list[bytes] = []
    group.links.iterate(names.append)
    for name in names:
        if group.links.get_info(name).type != h5py.h5l.TYPE_HARD:
            raise _bad(path, f"has a link to elsewhere: {name!r}")
        item = h5py.h5o.open(group, name)
        if isinstance(item, h5py.h5g.GroupID):
            _check(item, path, size)
        elif isinstance(item, h5py.h5d.DatasetID):
            plan = item.get_create_plist()
            stored = item.get_storage_size()
            if plan.get_external_count() or plan.get_layout() == h5py.h5d.VIRTUAL:
                raise _bad(path, f"takes the values of {name!r} from elsewhere")
            most = max(SMALL, stored * (MOST_COMPRESSED if plan.get_nfilters() else 1))
            if stored > size or item.get_space().get_simple_extent_npoints() * item.get_type().get_size() > most:
                raise _bad(path, f"declares more values of {name!r} than it can hold")
        else:
            raise _bad(path, f"has something odd: {name!r}")


def _bad(path: Path, what: str, hint: str = _HINT) -> InputError:
    return InputError(Issue((), what, hint, file=str(path)))
