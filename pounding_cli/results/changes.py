"""Keys in which the study of a results file differs from another."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py

from pounding_cli.errors import InputError
from pounding_cli.results.file import read_attributes


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


def read_resolved(path: Path) -> dict[str, Any] | None:
    """Return the study of a results file with every default filled in; None where it cannot be read."""
    try:
        read_attributes(path)
        with h5py.File(path) as file:
            return dict(json.loads(file["study_resolved"][()]))
    except (InputError, OSError, KeyError, ValueError, TypeError):
        return None
