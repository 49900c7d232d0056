"""A YAML file as a tree of nodes, each knowing its line and column; scalars are read by YAML 1.2 rules."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from pounding_cli.errors import InputError, Problem

Mark = tuple[int, int]
"""Line and column, both from 1."""

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_INTEGER = re.compile(r"[-+]?[0-9]+\Z")
# YAML 1.1, as PyYAML reads it, takes 1e10 for text, `no` for false, 0:36 for 36. Here numbers look like it.
_NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_WORDS: dict[str, Any] = {"": None, "~": None, "null": None, "true": True, "false": False}
_DEEPEST = 30
_MOST_VALUES = 500_000


@dataclass(frozen=True, eq=False)
class Node:
    """One value of the file.

    value : None, bool, int, float or str; a list of nodes; or a dict of nodes by key, in the file's order
    mark : where the value begins
    text : what the file says, for a scalar or a short list or mapping
    keys : where each key of a mapping begins
    """

    value: Any
    mark: Mark
    text: str = ""
    keys: dict[str, Mark] | None = None

    @property
    def is_mapping(self) -> bool:
        return isinstance(self.value, dict)

    @property
    def is_list(self) -> bool:
        return isinstance(self.value, list)

    def plain(self) -> Any:
        """The value as plain dicts, lists and scalars."""
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value

    def get(self, *path: str | int) -> Node | None:
        """The node at a path of keys and list places from 0, or None."""
        node = self
        for step in path:
            if node.is_mapping and str(step) in node.value:
                node = node.value[str(step)]
            elif node.is_list and isinstance(step, int) and 0 <= step < len(node.value):
                node = node.value[step]
            else:
                return None
        return node

    def locate(self, path: Sequence[str | int], key: bool = False) -> Mark:
        """Where the value at `path` begins (its key where `key`); steps the file lacks are passed over."""
        node, mark = self, self.mark
        for place, step in enumerate(path):
            child = node.get(step)
            if child is None:
                continue
            last = not any(child.get(later) for later in path[place + 1 : place + 2])
            mark = node.keys[str(step)] if key and last and node.keys else child.mark
            node = child
        return mark

    def replaced(self, path: Sequence[str | int], new: Node) -> Node:
        """The same tree with `new` at `path`; mappings on the way are made where they are missing.

        Raises KeyError when the path runs through a scalar or off a list.
        """
        if not path:
            return new
        step, rest = path[0], path[1:]
        if self.is_mapping or self.value is None:
            children = dict(self.value or {})
            below = children.get(str(step), Node({}, new.mark, keys={}))
            children[str(step)] = below.replaced(rest, new)
            return Node(children, self.mark, self.text, {**{str(step): new.mark}, **(self.keys or {})})
        if self.is_list and str(step).isdigit() and int(step) < len(self.value):
            items = list(self.value)
            items[int(step)] = items[int(step)].replaced(rest, new)
            return Node(items, self.mark, self.text)
        raise KeyError(step)


def read_source(path: Path) -> tuple[str, Node]:
    """The text of a YAML file and its tree; raises `InputError` at its place for what is no YAML mapping."""
    text = _read_text(path)
    return text, parse(text, path)


def parse(text: str, path: Path) -> Node:
    """The tree of a YAML text; `path` is what errors call it, which are those of `read_source`."""
    try:
        composed = yaml.compose(text, Loader=_LOADER)
    except yaml.MarkedYAMLError as error:
        raise InputError(_syntax(path, error, text)) from None
    except yaml.YAMLError as error:
        raise InputError(
            Problem(
                f"this is not YAML: {error}",
                "remove control characters; save the file as UTF-8 text",
                str(path),
                1,
                1,
            )
        ) from None
    except RecursionError:
        raise InputError(_too_deep(path)) from None
    if composed is None:
        raise InputError(
            Problem(
                "the file is empty",
                "see configs/quickstart.yaml for the smallest useful study",
                str(path),
                1,
                1,
            )
        )
    reader = _Reader(path, text)
    root = reader.node(composed, 0)
    if not root.is_mapping:
        reader.problems.append(
            Problem("a study is a mapping of keys to values", "begin with `title: ...`", str(path), *root.mark)
        )
    if reader.problems:
        raise InputError(reader.problems)
    return root


def _read_text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        near = _nearby(path)
        raise InputError(
            Problem("no such file", f"did you mean {near}?" if near else "`pound init NAME` writes one", str(path))
        ) from None
    except IsADirectoryError:
        raise InputError(Problem(f"{path} is a folder", "name the study file in it", str(path))) from None
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise InputError(Problem("the file is not UTF-8 text", "save it as UTF-8", str(path), line, 1)) from None
    except (OSError, ValueError) as error:
        raise InputError(
            Problem(f"cannot read {path}: {error}", "check the path and its permissions", str(path))
        ) from None


def _nearby(path: Path) -> str:
    import difflib

    try:
        names = [p.name for p in path.parent.iterdir() if p.suffix in (".yaml", ".yml")]
    except OSError:
        return ""
    near = difflib.get_close_matches(path.name, names, 1)
    return str(path.parent / near[0]) if near else ""


def _too_deep(path: Path, mark: Mark = (1, 1)) -> Problem:
    return Problem("the file is nested too deeply", f"a study needs at most {_DEEPEST} levels", str(path), *mark)


def _syntax(path: Path, error: yaml.MarkedYAMLError, text: str) -> Problem:
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    what = error.problem or "unreadable"
    if error.context and error.context_mark and error.context_mark.line + 1 != line:
        what += f" ({error.context} that begins in line {error.context_mark.line + 1})"
    shown = text.splitlines()[line - 1 : line]
    indent = shown[0][: len(shown[0]) - len(shown[0].lstrip())] if shown else ""
    if "\t" in indent or "\\t" in what:
        hint = "indent with spaces: YAML does not allow tabs"
    elif "mapping values are not allowed" in what:
        hint = "put quotes around a value that holds ': '"
    elif "expected a single document" in what:
        hint = "one file holds one study: remove the line `---`"
    elif "undefined alias" in what:
        hint = "put quotes around a value that begins with * or &"
    else:
        hint = "check brackets, quotes, commas and the indentation around this place"
    return Problem(f"this is not YAML: {what}", hint, str(path), line, column)


class _Reader:
    """Turns composed YAML nodes into `Node`s and collects what is wrong on the way."""

    def __init__(self, path: Path, text: str) -> None:
        self.path, self.text, self.count = path, text, 0
        self.problems: list[Problem] = []

    def refuse(self, mark: Mark, message: str, hint: str) -> None:
        self.problems.append(Problem(message, hint, str(self.path), *mark))

    def node(self, composed: yaml.Node, depth: int) -> Node:
        mark = (composed.start_mark.line + 1, composed.start_mark.column + 1)
        self.count += 1
        if depth > _DEEPEST:
            raise InputError(_too_deep(self.path, mark))
        if self.count > _MOST_VALUES:
            # Aliases can unfold a small file into billions of values.
            raise InputError(
                Problem(
                    f"more than {_MOST_VALUES} values",
                    "write fewer aliases (*name) or values",
                    str(self.path),
                    *mark,
                )
            )
        if isinstance(composed, yaml.ScalarNode):
            return Node(self._scalar(composed, mark), mark, composed.value)
        shown = self._shown(composed)
        if isinstance(composed, yaml.SequenceNode):
            return Node([self.node(item, depth + 1) for item in composed.value], mark, shown)
        children: dict[str, Node] = {}
        keys: dict[str, Mark] = {}
        for key, value in composed.value:
            at = (key.start_mark.line + 1, key.start_mark.column + 1)
            if not isinstance(key, yaml.ScalarNode):
                self.refuse(at, "a key must be a word", "write `key: value`")
            elif key.value == "<<":
                self.refuse(at, "merge keys (<<) are not used here", "write `like: NAME` to build on another building")
            elif key.value in children:
                self.refuse(
                    at,
                    f"'{key.value}' stands twice; first in line {keys[key.value][0]}",
                    "remove one of the two",
                )
            else:
                children[key.value], keys[key.value] = self.node(value, depth + 1), at
        return Node(children, mark, shown, keys)

    def _shown(self, composed: yaml.Node) -> str:
        begin, end = composed.start_mark, composed.end_mark
        # libyaml counts characters as we do; the pure Python loader too.
        return self.text[begin.index : end.index] if begin.line == end.line and end.index - begin.index < 200 else ""

    def _scalar(self, composed: yaml.ScalarNode, mark: Mark) -> Any:
        word = composed.value
        if composed.tag not in _PLAIN_TAGS:
            self.refuse(mark, f"the tag {composed.tag} is not used here", "write the plain value")
            return word
        if composed.style in ('"', "'", "|", ">"):
            return word
        if word.lower() in _WORDS:
            return _WORDS[word.lower()]
        if _INTEGER.match(word) and len(word) < 19:
            return int(word)
        if _NUMBER.match(word):
            number = float(word)
            if math.isinf(number):
                self.refuse(mark, f"{word} is too large a number", "write a number below 1e308")
            return number
        return word


_PLAIN_TAGS = {
    f"tag:yaml.org,2002:{kind}" for kind in ("str", "int", "float", "bool", "null", "timestamp", "value", "merge")
}


def walk(node: Node, path: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], Node]]:
    """Every node below and including `node` with its path."""
    yield path, node
    if isinstance(node.value, dict):
        for key, child in node.value.items():
            yield from walk(child, (*path, key))
    elif isinstance(node.value, list):
        for place, child in enumerate(node.value):
            yield from walk(child, (*path, place))
