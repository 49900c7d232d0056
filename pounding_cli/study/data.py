"""A study as Python data: the words and units of the file, in a dict."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from pounding_cli.errors import InputError, Problem
from pounding_cli.study.load import Study, validated
from pounding_cli.study.source import Mark, Node
from pounding_cli.study.yaml_file import parse
from pounding_cli.texts import file_name


def study_of(data: Mapping[str, Any]) -> Study:
    """A validated study from a dict with the keys of a study file; numbers are SI, texts carry units ("5 cm").

    Its path is the title, or `study`, as a file in the current folder: record files are sought there, and results are
    named after it. Its text is the same study as YAML.

    Raises
    ------
    InputError : with every problem found, each at its key (`cases.gap.gap`)
    """
    plain = _plain(data, "")
    title = str(plain.get("title") or "study")
    path = Path(file_name(title).replace(" ", "-").lower() + ".yaml")
    text = _yaml(plain)
    root = parse(text, path)
    with at_keys(root, path):
        return dataclasses.replace(validated(path, text, root), from_data=True)


def tree_of(data: Mapping[str, Any], path: Path) -> Node:
    """The tree of a dict as if it had been written to a file `path`."""
    return parse(_yaml(_plain(data, "")), path)


@contextmanager
def at_keys(root: Node, path: Path) -> Iterator[None]:
    """Problems of the text that `root` was read from are told at their keys."""
    try:
        yield
    except InputError as refused:
        places = dict(_places(root))
        raise InputError([_at_key(problem, path, places) for problem in refused.problems]) from None


def _yaml(plain: Any) -> str:
    return yaml.safe_dump(plain, sort_keys=False, allow_unicode=True, width=100)


def _plain(value: Any, place: str) -> Any:
    """The value in the types of YAML."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item, f"{place}.{key}".lstrip(".")) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist(), place)
    if isinstance(value, list | tuple):
        return [_plain(item, f"{place}.{number}") for number, item in enumerate(value)]
    if isinstance(value, Path):
        return str(value)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    hint = "write numbers (SI), texts such as '5 cm', lists and dicts"
    raise InputError(Problem(f"{type(value).__name__} is not a value of a study", hint, place))


def _places(node: Node, path: str = "") -> Iterator[tuple[Mark, str]]:
    """Marks and the keys that stand there; where two begin at one mark, the innermost comes last."""
    yield node.mark, path
    if node.is_mapping:
        for key, child in node.value.items():
            inner = f"{path}.{key}".lstrip(".")
            yield (node.keys or {}).get(key, child.mark), inner
            yield from _places(child, inner)
    elif node.is_list:
        for number, child in enumerate(node.value):
            yield from _places(child, f"{path}.{number}")


def _at_key(problem: Problem, path: Path, places: Mapping[Mark, str]) -> Problem:
    """A problem of the YAML text as one of the dict; those of record files keep their own place."""
    if problem.file != str(path):
        return problem
    return dataclasses.replace(problem, file=places.get((problem.line, problem.column), ""), line=0, column=0)
