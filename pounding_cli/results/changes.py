"""The study of a results file as it was written, and the keys in which it differs from another."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py

from pounding_cli.errors import InputError
from pounding_cli.results.file import read_attributes
from pounding_cli.study.schema.lookup import quantity_at, types_at
from pounding_cli.study.schema.study import StudySpec
from pounding_cli.study.text.file import Items, Map, parse

ABSENT: Any = None
"""Value of a key that a study does not write."""


@dataclass(frozen=True, eq=False)
class EarlierStudy:
    """The study of a results file.

    path : the file
    tree : the study as it was written
    motions : SHA-256 of every motion as it was used, by name
    """

    path: Path
    tree: Map
    motions: Mapping[str, str]


@dataclass(frozen=True)
class KeyChange:
    """A key that two studies write differently.

    path : steps from the top of the study
    before, after : values as they are written; None where the key is not there
    """

    path: tuple[str, ...]
    before: Any
    after: Any

    def __str__(self) -> str:
        key = ".".join(self.path)
        if self.before is ABSENT and isinstance(self.after, Map):
            return f"{key} (new)"
        if self.after is ABSENT and isinstance(self.before, Map):
            return f"{key} (removed)"
        return f"{key} {self._format(self.before)} -> {self._format(self.after)}"

    def _format(self, value: Any) -> str:
        """Return a value as it is written; where it is not, the default if that is a word or a pure number."""
        if value is not ABSENT:
            return _shorten(value)
        field = types_at(StudySpec, self.path)[1]
        default = None if field is None or field.is_required() else field.default
        if isinstance(default, str | int) and default != "":
            return str(default).lower() if isinstance(default, bool) else str(default)
        quantity = quantity_at(StudySpec, self.path)
        if isinstance(default, float) and quantity is not None and not quantity.si:
            return f"{default:g}".replace("e-0", "e-")
        return "unset"


MAX_VALUE = 40
"""Characters of a value in messages."""


def _shorten(value: Any) -> str:
    text = " ".join(str(value).split())
    return text if len(text) <= MAX_VALUE else f"{text[: MAX_VALUE - 3]}..."


def read_earlier_study(path: Path) -> EarlierStudy | None:
    """Return the study of a results file; None where it cannot be read."""
    try:
        read_attributes(path)
        with h5py.File(path) as file:
            text = file["study_text"][()].decode()
            names = [name.decode() for name in file["record"][()]]
            digests = [digest.decode() for digest in file["record_digest"][()]]
        return EarlierStudy(path, parse(text, str(path)), dict(zip(names, digests, strict=True)))
    except (InputError, OSError, KeyError, ValueError, TypeError, AttributeError):
        return None


def iter_key_changes(before: Any, after: Any, path: tuple[str, ...] = ()) -> Iterator[KeyChange]:
    """Yield the keys that two trees of studies write differently.

    Mappings are compared key by key; lists of equal length with mappings in them entry by entry, others whole.
    """
    if isinstance(before, Map) and isinstance(after, Map):
        for key in dict.fromkeys((*before, *after)):
            yield from iter_key_changes(before.get(key, ABSENT), after.get(key, ABSENT), (*path, key))
    elif _are_entries(before, after):
        for number, (old, new) in enumerate(zip(before, after, strict=True)):
            yield from iter_key_changes(old, new, (*path, str(number)))
    elif before != after:
        yield KeyChange(path, before, after)


def _are_entries(before: Any, after: Any) -> bool:
    """Return whether two values are lists whose entries correspond."""
    are_lists = isinstance(before, Items) and isinstance(after, Items)
    return are_lists and len(before) == len(after) and any(isinstance(each, Map) for each in (*before, *after))


def changed_keys(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[tuple[str, Any, Any]]:
    """Return the dotted keys that differ between two studies with every default filled in: key, before, after."""
    old = dict(_iter_leaves(before))
    new = dict(_iter_leaves(after))
    return [(key, old.get(key), new.get(key)) for key in old | new if old.get(key) != new.get(key)]


def _iter_leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield dotted keys with their values; what is derived from them is left out."""
    if not isinstance(value, Mapping):
        yield path, value
        return
    for key, item in value.items():
        if not (key == "derived" or (not path and key in ("places", "separation"))):
            yield from _iter_leaves(item, f"{path}.{key}" if path else key)
