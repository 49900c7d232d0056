"""A study as Python data: the words and units of the file, in a dict."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from pounding_cli.errors import InputError, Problem
from pounding_cli.study.file import Items, Map, Mark, canonical
from pounding_cli.study.study import Study
from pounding_cli.texts import file_name


def study_of(data: Mapping[str, Any]) -> Study:
    """A validated study from a dict with the keys of a study file; numbers are SI, texts carry units ("5 cm").

    Its path is the title, or `study`, as a file in the current folder: record files are sought there, and results are
    named after it. Its text is the same study as YAML.

    Raises
    ------
    InputError : with every problem found, each at its key (`cases.gap.gap`)
    """
    root = tree_of(data)
    title = str(root.get("title") or "study")
    path = Path(file_name(title).replace(" ", "-").lower() + ".yaml")
    return Study(path, yaml.safe_dump(_bare(root), sort_keys=False, allow_unicode=True, width=100), root)


def tree_of(data: Mapping[str, Any]) -> Map:
    """The tree of a dict; places in it are its keys.  Raises InputError for what is no value of a study."""
    found = _node(data, "")
    assert isinstance(found, Map)
    return found


def _node(value: Any, place: str) -> Any:
    mark: Mark = (place, 0)
    if isinstance(value, Mapping):
        keys = {canonical(str(key)): f"{place}.{key}".lstrip(".") for key in value}
        below = {name: _node(item, keys[name]) for name, item in zip(keys, value.values(), strict=True)}
        return Map(below, mark, {name: ((at, 0), (at, 0)) for name, at in keys.items()})
    if isinstance(value, np.ndarray | np.generic):
        return _node(value.tolist(), place)
    if isinstance(value, list | tuple):
        places = [f"{place}.{number}" for number in range(len(value))]
        items = [_node(item, at) for item, at in zip(value, places, strict=True)]
        return Items(items, mark, [(at, 0) for at in places])
    if isinstance(value, Path):
        return str(value)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    hint = "write numbers (SI), texts such as '5 cm', lists and dicts"
    raise InputError(Problem(f"{type(value).__name__} is not a value of a study", hint, place))


def _bare(node: Any) -> Any:
    """A tree in the types of YAML."""
    if isinstance(node, dict):
        return {key: _bare(item) for key, item in node.items()}
    return [_bare(item) for item in node] if isinstance(node, list) else node
