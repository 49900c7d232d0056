"""What a results file may be made of: what would read another file or fill the memory is refused before it is read.

Refusals are about an open file; `store/files.py` adds which one it is.
"""

from __future__ import annotations

import json
import math
from typing import Any

import h5py
import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.store.layout import BUILDINGS, LINKS, PLACE, RECORDS, RESPONSES, SCENES, STATISTICS
from pounding_cli.texts import plain, plain_all

ANALYSES = ("elastic", "inelastic")

_UNPACKED = 1100
"""Deflate makes at most 1032 bytes of one."""

_SMALL = 1 << 20
"""Arrays up to this size [bytes] need no storage of their own: what was never written reads as fill values."""

_LAZY = ("histories", "former")
"""Groups of groups, each of which is checked when it is read."""


def check_links(group: h5py.Group) -> None:
    """Refuse whatever leads out of the file, declares more than the file can hold, or is of a type we do not write.

    Goes through all of `group` but the scenes kept over time, which are checked one by one as they are read.

    Raises
    ------
    InputError : what it is and where
    """
    texts(group.attrs)
    links = group.id.links
    for name in _names(group):
        kind = links.get_info(name).type
        if kind != h5py.h5l.TYPE_HARD:
            raise refused(group, name, "leads to another place or another file")
        item = group[name]
        if isinstance(item, h5py.Dataset):
            _check_dataset(item)
        elif isinstance(item, h5py.Group):
            if _path(group, name) not in _LAZY:
                check_links(item)
        else:
            raise refused(group, name, "is neither a dataset nor a group")


def check_study(file: h5py.File) -> None:
    """Refuse a file of `pound run` whose parts do not fit together.

    Raises
    ------
    InputError : what does not, and where
    """
    check_links(file)
    swept = json.loads(file.attrs["swept"])
    axes = tuple(names[0] for names in swept)
    if not all(isinstance(name, str) for names in swept for name in names):
        raise refused(file, "swept", "is no list of names")
    sizes = {dim: _size(file, dim) for dim in (*axes, *PLACE, "building", "storey", "floor")}
    for names in swept:
        for name in names[1:]:
            expect(file, name, (sizes[names[0]],), "")
    for names in (*PLACE, "building"):
        expect(file, names, (sizes[names],), "s")
    if not set(file["analysis"].asstr()[:]) <= set(ANALYSES):
        raise refused(file, "analysis", f"is not one of {', '.join(ANALYSES)}")
    linked = "link" in file
    if linked:
        sizes["link"] = _size(file, "link")
    for variable in (*RESPONSES, *SCENES, *STATISTICS, *LINKS):
        if linked or "link" not in variable.dims:
            expect(file, variable.name, tuple(sizes[dim] for dim in (*axes, *variable.dims)), variable.kind)
    for first, *rest in (BUILDINGS, RECORDS):
        own = [scale[0].name.lstrip("/") for scale in file[first.name].dims][: -len(first.dims)]
        if not set(own) <= set(axes):
            raise refused(file, first.name, "has dimensions that are no swept keys")
        for variable in (first, *rest):
            expect(file, variable.name, tuple(sizes[dim] for dim in (*own, *variable.dims)), variable.kind)
    for name in ("study/text", "study/resolved"):
        expect(file, name, (), "s")
    _check_names(file)
    for name in ("scenes", "scenes_failed", "solver_seconds", "accuracy"):
        number(file.attrs, name)
    text(file.attrs, "title")


def _check_names(file: h5py.File) -> None:
    """Refuse names that stand twice or are not those of the study."""
    resolved = json.loads(file["study/resolved"].asstr()[()])
    is_swept = {name.split(".")[0] for names in json.loads(file.attrs["swept"]) for name in names}
    for dim, key in (("building", "places"), ("case", "cases"), ("record", "")):
        names = file[dim].asstr()[:].tolist()
        if len(set(names)) != len(names):
            raise refused(file, dim, "names one twice")
        if key in resolved and "group" not in is_swept and set(names) != set(resolved[key]):
            raise refused(file, dim, "is not that of its study")


def number(attrs: h5py.AttributeManager, name: str) -> float:
    """A number among attributes.  Raises InputError: it is missing, an array, text or not finite."""
    value = attrs.get(name)
    if not isinstance(value, int | float | np.integer | np.floating) or not math.isfinite(value):
        raise InputError(Problem(f"its {name.replace('_', ' ')} is no number", "give a file that pound run wrote"))
    return float(value)


def text(attrs: h5py.AttributeManager, name: str) -> str:
    """A text among attributes.  Raises InputError: it is missing or something else."""
    value = attrs.get(name)
    if not isinstance(value, str):
        raise InputError(Problem(f"its {name.replace('_', ' ')} is no text", "give a file that pound run wrote"))
    return value


def strings(dataset: h5py.Dataset) -> Any:
    """The texts of a dataset, an array or one, without control characters (`plain`).  Raises where it is no UTF-8."""
    values = dataset.asstr()[()]
    if isinstance(values, str):
        return plain(values)
    return np.array(plain_all(values.flat), dtype=object).reshape(values.shape)


def texts(attrs: h5py.AttributeManager) -> None:
    """Refuse attributes that are no UTF-8.  Raises InputError."""
    for name, value in attrs.items():
        try:
            for each in (name, *([value] if isinstance(value, str) else [])):
                each.encode()
        except UnicodeEncodeError:
            raise InputError(Problem("an attribute is no UTF-8", "give a file that pound run wrote")) from None


def _names(group: h5py.Group) -> list[bytes]:
    names: list[bytes] = []
    group.id.links.iterate(names.append)
    return names


def _check_dataset(dataset: h5py.Dataset) -> None:
    plist = dataset.id.get_create_plist()
    if plist.get_external_count() or plist.get_layout() == h5py.h5d.VIRTUAL:
        raise refused(dataset.parent, dataset.name, "takes its values from another file")
    if dataset.dtype.kind not in "fiuS" and h5py.check_string_dtype(dataset.dtype) is None:
        raise refused(dataset.parent, dataset.name, f"holds neither numbers nor texts ({dataset.dtype})")
    stored = dataset.id.get_storage_size()
    most = max(_SMALL, stored * (_UNPACKED if plist.get_nfilters() else 1))
    if dataset.nbytes > most or stored > dataset.file.id.get_filesize():
        raise refused(dataset.parent, dataset.name, f"declares {dataset.size} values, more than the file can hold")


def _size(file: h5py.File, dim: str) -> int:
    if len(file[dim].shape) != 1:
        raise refused(file, dim, "is no list")
    return int(file[dim].size)


def expect(file: h5py.Group, name: str, shape: tuple[int, ...], kind: str) -> None:
    """Refuse a dataset of another shape, or that holds texts (`kind` "s") where there should be none or none at all."""
    dataset = file[name]
    is_text = h5py.check_string_dtype(dataset.dtype) is not None
    if dataset.shape != shape:
        raise refused(file, name, f"has the shape {dataset.shape}, not {shape}")
    if kind and is_text != (kind == "s"):
        raise refused(file, name, f"holds {'texts' if is_text else 'numbers'}")


def _path(group: h5py.Group, name: Any) -> str:
    own = name.decode(errors="replace") if isinstance(name, bytes) else str(name)
    return f"{group.name.rstrip('/')}/{own.rsplit('/', 1)[-1]}".lstrip("/")


def refused(group: h5py.Group, name: Any, what: str) -> InputError:
    """The refusal of one thing in a file."""
    return InputError(Problem(f"its {_path(group, name)} {what}", "give a file that pound run wrote"))
