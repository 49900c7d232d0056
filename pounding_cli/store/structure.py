"""What a results file may be made of: what would read another file or fill the memory is refused before it is read.

Refusals are about an open file; `store/files.py` adds which one it is.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import h5py
import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.texts import plain, plain_all
from pounding_cli.variables import BUILDINGS, FORMERLY, LINKS, PLACE, RECORDS, RESPONSES, SCENES, STATISTICS

_UNPACKED = 1100
"""Deflate makes at most 1032 bytes of one."""

_SMALL = 1 << 20
"""Arrays up to this size [bytes] need no storage of their own: what was never written reads as fill values."""

_TYPES = (h5py.h5t.INTEGER, h5py.h5t.FLOAT, h5py.h5t.STRING)
"""What we write."""

_LAZY = ("histories", "former")
"""Groups of groups, each of which is checked when it is read."""


_OF_LINK = {"link": "s", "link_left": "s", "link_right": "s", "link_floor": "i", "link_right_floor": "i"}
"""Coordinates of a link, and whether they are texts."""


class Form(NamedTuple):
    """Shape of a dataset, None where it holds no value at all, and whether it holds texts."""

    shape: tuple[int, ...] | None
    is_text: bool


def check_links(group: h5py.Group) -> dict[str, Form]:
    """Refuse whatever leads out of the file, declares more than the file can hold, or is of a type we do not write.

    Goes through all of `group` but the scenes kept over time, which are checked one by one as they are read.
    It uses HDF5's own handles: h5py's objects would take several times as long.

    Returns
    -------
    dict : the datasets found, by path

    Raises
    ------
    InputError : what it is and where
    """
    return dict(_forms(group, group.name.strip("/"), group.file.id.get_filesize()))


def check_structure(file: h5py.File) -> list[list[str]]:
    """Refuse a file of `pound run` whose parts have not the shapes and types that fit together.

    Returns
    -------
    list : the swept keys of every axis

    Raises
    ------
    InputError : what does not, and where
    """
    forms = check_links(file)
    swept, sizes = _swept(file, forms)
    axes = tuple(sizes)
    sizes |= {dim: _size(forms, dim) for dim in (*PLACE, "building", "storey", "floor")}
    for name in (*PLACE, "building"):
        expect(forms, name, (sizes[name],), "s")
    for name in ("storey", "floor"):
        expect(forms, name, (sizes[name],), "i")
    linked = "link" in file
    if linked:
        sizes["link"] = _size(forms, "link")
        for name, kind in _OF_LINK.items():
            expect(forms, name, (sizes["link"],), kind)
    for variable in (*RESPONSES, *SCENES, *STATISTICS, *LINKS):
        if not variable.always and variable.name not in forms:
            continue
        if linked or "link" not in variable.dims:
            name = variable.name if variable.name in forms else FORMERLY.get(variable.name, variable.name)
            expect(forms, name, tuple(sizes[dim] for dim in (*axes, *variable.dims)), variable.kind)
    for first, *rest in (BUILDINGS, RECORDS):
        own = [scale[0].name.lstrip("/") for scale in file[first.name].dims][: -len(first.dims)]
        if not set(own) <= set(axes):
            raise refused(first.name, "has dimensions that are not swept keys")
        for variable in (first, *rest):
            if not variable.always and variable.name not in forms:
                continue
            expect(forms, variable.name, tuple(sizes[dim] for dim in (*own, *variable.dims)), variable.kind)
    number(file.attrs, "accuracy")
    _check_facts(file, forms)
    return swept


def _swept(file: h5py.File, forms: dict[str, Form]) -> tuple[list[list[str]], dict[str, int]]:
    """The swept keys of every axis, and the size of each by its first key."""
    swept = json.loads(file.attrs["swept"])
    if not all(isinstance(name, str) for names in swept for name in names):
        raise refused("swept", "is not a list of names")
    sizes = {names[0]: _size(forms, names[0]) for names in swept}
    for names in swept:
        for name in names[1:]:
            expect(forms, name, (sizes[names[0]],), "")
    return swept, sizes


def _check_facts(file: h5py.File, forms: dict[str, Form]) -> None:
    """Refuse a file that does not say its study, or how many scenes it has."""
    for name in ("study/text", "study/resolved"):
        expect(forms, name, (), "s")
    for name in ("scenes", "scenes_failed", "solver_seconds"):
        number(file.attrs, name)
    text(file.attrs, "title")


def number(attrs: h5py.AttributeManager, name: str) -> float:
    """A number among attributes.  Raises InputError: it is missing, an array, text or not finite."""
    value = attrs.get(name)
    if not isinstance(value, int | float | np.integer | np.floating) or not math.isfinite(value):
        raise InputError(Problem(f"its {name.replace('_', ' ')} is not a number", "give a file that pound run wrote"))
    return float(value)


def text(attrs: h5py.AttributeManager, name: str) -> str:
    """A text among attributes.  Raises InputError: it is missing or something else."""
    value = attrs.get(name)
    if not isinstance(value, str):
        raise InputError(Problem(f"its {name.replace('_', ' ')} is not a text", "give a file that pound run wrote"))
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
            raise InputError(Problem("an attribute is not UTF-8", "give a file that pound run wrote")) from None


def _forms(group: h5py.Group, place: str, file_size: int) -> Iterator[tuple[str, Form]]:
    """The datasets of a group and of the groups in it, each checked; `place` is the path of the group."""
    texts(group.attrs)
    for name, path in _members(group, place):
        item = h5py.h5o.open(group.id, name)
        if isinstance(item, h5py.h5d.DatasetID):
            yield path, _form(path, item, file_size)
        elif isinstance(item, h5py.h5g.GroupID):
            if path in _LAZY:
                _members(h5py.Group(item), path)
            else:
                yield from _forms(h5py.Group(item), path, file_size)
        else:
            raise refused(path, "is neither a dataset nor a group")


def _members(group: h5py.Group, place: str) -> list[tuple[bytes, str]]:
    """(name, path) of everything in a group; nothing of it is opened.  Raises InputError: a link to elsewhere."""
    names: list[bytes] = []
    links = group.id.links
    links.iterate(names.append)
    found = [(name, f"{place}/{name.decode(errors='replace')}".lstrip("/")) for name in names]
    for name, path in found:
        if links.get_info(name).type != h5py.h5l.TYPE_HARD:
            raise refused(path, "leads to another place or another file")
    return found


def _form(path: str, dataset: h5py.h5d.DatasetID, file_size: int) -> Form:
    plist, kind, space = dataset.get_create_plist(), dataset.get_type(), dataset.get_space()
    if plist.get_external_count() or plist.get_layout() == h5py.h5d.VIRTUAL:
        raise refused(path, "takes its values from another file")
    if kind.get_class() not in _TYPES:
        raise refused(path, f"holds neither numbers nor texts ({dataset.dtype})")
    stored, size = dataset.get_storage_size(), space.get_simple_extent_npoints()
    most = max(_SMALL, stored * (_UNPACKED if plist.get_nfilters() else 1))
    if size * kind.get_size() > most or stored > file_size:
        raise refused(path, f"declares {size} values, more than the file can hold")
    shape = None if space.get_simple_extent_type() == h5py.h5s.NULL else space.get_simple_extent_dims()
    return Form(shape, kind.get_class() == h5py.h5t.STRING)


def _size(forms: dict[str, Form], dim: str) -> int:
    shape = _of(forms, dim).shape
    if shape is None or len(shape) != 1:
        raise refused(dim, "is not a list")
    return shape[0]


def expect(forms: dict[str, Form], name: str, shape: tuple[int, ...], kind: str) -> None:
    """Refuse a dataset of another shape, or one that holds texts where `kind` is not "s" (any where it is "")."""
    form = _of(forms, name)
    if form.shape != shape:
        raise refused(name, f"has the shape {form.shape}, not {shape}")
    if kind and form.is_text != (kind == "s"):
        raise refused(name, f"holds {'texts' if form.is_text else 'numbers'}")


def _of(forms: dict[str, Form], name: str) -> Form:
    if name not in forms:
        raise refused(name, "is missing")
    return forms[name]


def refused(path: str, what: str) -> InputError:
    """The refusal of one thing in a file."""
    return InputError(Problem(f"its {path} {what}", "give a file that pound run wrote"))
