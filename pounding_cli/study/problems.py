"""From what pydantic or a check found wrong to `Problem`s with file, line, column and a hint."""

from __future__ import annotations

import difflib
import types
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from itertools import islice
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from pounding_cli.errors import InputError, Problem
from pounding_cli.laws import instead
from pounding_cli.study.source import Mark, Node
from pounding_cli.study.yaml_file import MISSING_BLANK

Path = tuple[str | int, ...]

MOST_TOLD = 100
"""Problems of one section that are told one by one."""

MOST_COMPARED = 1000
"""Names among which the nearest is sought."""


class Tree:
    """A tree of nodes made when it is first asked: to place problems, of which there are mostly none."""

    def __init__(self, make: Callable[[], Node]) -> None:
        self._make = make

    @cached_property
    def node(self) -> Node:
        """The tree."""
        return self._make()

    def get(self, *path: str | int) -> Node | None:
        """As `Node.get`."""
        return self.node.get(*path)

    def locate(self, path: Sequence[str | int], key: bool = False) -> Mark:
        """As `Node.locate`."""
        return self.node.locate(path, key)


class Problems:
    """Collects problems of one file; two at one place with one message count once.

    found : those so far
    """

    def __init__(self, file: str) -> None:
        self.file = file
        self.found: list[Problem] = []
        self._seen: set[Problem] = set()

    def add(self, mark: Mark, message: str, hint: str = "") -> None:
        """Note a problem at a line and column."""
        problem = Problem(message, hint, self.file, *mark)
        if problem not in self._seen:
            self._seen.add(problem)
            self.found.append(problem)

    def knows(self, problem: Problem) -> bool:
        """Whether a problem is noted already."""
        return problem in self._seen

    def at(self, root: Node | Tree, path: Path, message: str, hint: str = "", key: bool = False) -> None:
        """Note a problem with the value (or the key) at `path`."""
        self.add(root.locate(path, key), message, hint)

    def validation(self, root: Node | Tree, error: ValidationError, model: type[BaseModel]) -> None:
        """Note every error of a pydantic validation of `root` against `model`."""
        items = error.errors(include_url=False)
        above = {tuple(item["loc"][:end]) for item in items[: 10 * MOST_TOLD] for end in range(len(item["loc"]))}
        for number, item in enumerate(items):
            path = tuple(item["loc"])
            if number >= MOST_TOLD:
                self.at(root, path[:1], f"and {len(items) - number} more problems like these", key=True)
                break
            if item["type"] == "too_short" and path in above:
                continue  # pydantic counts sound entries only: what is wrong with the others is told
            message, hint, key = _in_words(dict(item), path, model, root)
            self.at(root, path, message, hint, key)

    def extend(self, problems: Iterable[Problem]) -> None:
        """Note problems found elsewhere."""
        for problem in problems:
            if problem not in self._seen:
                self._seen.add(problem)
                self.found.append(problem)

    def refuse(self) -> None:
        """Raise `InputError` with everything noted, in the file's order, if anything was."""
        if self.found:
            ordered = sorted(self.found, key=lambda p: (p.file, p.line, p.column))
            if len(ordered) > 2 * MOST_TOLD:
                last = Problem(f"and {len(ordered) - 2 * MOST_TOLD} more problems", "correct these first", self.file)
                ordered = [*ordered[: 2 * MOST_TOLD], last]
            raise InputError(ordered)


def nearest(word: str, names: Iterable[str]) -> str:
    """A hint naming the nearest of `names`, and all of them."""
    known = [str(name)[:60] for name in islice(names, MOST_COMPARED)]
    near = difflib.get_close_matches(str(word)[:60], known, 1, 0.5)
    listed = ", ".join(known[:40]) + (", ..." if len(known) > 40 else "")
    return (f"did you mean '{near[0]}'? " if near else "") + (f"known: {listed}" if known else "none is defined")


def options(annotation: Any) -> tuple[dict[str, Any], list[Any], list[Any]]:
    """What may stand below a type: keys of models, types of list items, types of free mappings' values."""
    keys: dict[str, Any] = {}
    items: list[Any] = []
    values: list[Any] = []
    stack = [annotation]
    while stack:
        kind = stack.pop()
        origin = get_origin(kind)
        if origin is Annotated:
            stack.append(get_args(kind)[0])
        elif origin in (Union, types.UnionType):
            stack.extend(get_args(kind))
        elif origin is tuple:
            items.append(get_args(kind)[0])
        elif origin is dict:
            values.append(get_args(kind)[1])
        elif isinstance(kind, type) and issubclass(kind, BaseModel):
            keys.update({info.alias or name: info.annotation for name, info in kind.model_fields.items()})
    return keys, items, values


def keys_at(model: type[BaseModel], path: Sequence[str | int], root: Node | Tree) -> list[str]:
    """The keys the schema knows at `path`; for a free mapping those the file defines there."""
    level: list[Any] = [model]
    for step in path:
        below: list[Any] = []
        for kind in level:
            keys, items, values = options(kind)
            if str(step) in keys:
                below.append(keys[str(step)])
            elif str(step).isdigit() and items:
                below.extend(items)
            elif values:
                below.extend(values)
        # A step without a counterpart is the tag of a union, which the file does not hold.
        level = below or level
    found: dict[str, None] = {}
    for kind in level:
        keys, _, values = options(kind)
        found.update(dict.fromkeys(keys))
        node = root.get(*path)
        if values and node is not None and node.is_mapping:
            found.update(dict.fromkeys(node.value))
    return list(found)


def _in_words(item: dict[str, Any], path: Path, model: type[BaseModel], root: Node | Tree) -> tuple[str, str, bool]:
    kind, context, given = item["type"], item.get("ctx", {}), item.get("input")
    name = str(path[-1])[:60] if path else "the study"
    shown = _shown(given)
    if kind == "refused":
        return f"{_owner(path, root)}{context['message']}", context["hint"], False
    if kind == "extra_forbidden":
        return f"unknown key '{name}'", instead().get(name) or nearest(name, keys_at(model, path[:-1], root)), True
    if kind == "missing":
        return f"'{name}' is missing", _example(model, path), False
    if kind in ("literal_error", "enum"):
        return f"{_owner(path, root)}{shown} is not known", f"write {context['expected']}", False
    if kind in ("model_type", "model_attributes_type", "dict_type", "dict_attributes_type"):
        if isinstance(given, str) and (slip := MISSING_BLANK.match(given)):
            return f"'{given}' lacks a blank after its colon", f"write `{slip[1]}: {slip[2]}`", False
        keys = keys_at(model, path, root)
        hint = f"write {{key: value}} with the keys {', '.join(keys)}" if keys else "write {name: {...}}"
        return f"{_owner(path, root)}{shown} is not a mapping", hint, False
    if kind in ("tuple_type", "list_type"):
        return f"{_owner(path, root)}{shown} is not a list", "write [first, second, ...]", False
    if kind == "too_long":
        given, most = len(given) if given else context["actual_length"], context["max_length"]
        return f"{_owner(path, root) or f'{name}: '}{given} entries", f"write at most {most}", False
    if kind == "too_short":
        owner = _owner(path, root).removesuffix(": ") or name  # the path may end in the tag of a union
        return f"'{owner}' is empty", _example(model, path) or "write at least one value", False
    if kind == "string_pattern_mismatch":
        return f"{shown} cannot be a name", "use letters, digits, blanks, _, - and +", True
    if kind == "string_too_long":
        return f"{shown} is too long a name", f"use at most {context['max_length']} characters", True
    if kind in ("int_parsing", "int_type", "int_from_float"):
        return f"{_owner(path, root)}{shown} is not a whole number", "write a whole number, e.g. 5", False
    if kind in ("greater_than_equal", "less_than_equal"):
        bound = f"at least {context['ge']}" if "ge" in context else f"at most {context['le']}"
        return (
            f"{_owner(path, root)}{shown} is not allowed; it must be {bound}",
            f"write a number {bound}",
            False,
        )
    if kind in ("bool_parsing", "bool_type"):
        return f"{_owner(path, root)}{shown} is neither true nor false", "write true or false", False
    if kind == "string_type":
        return (
            f"{_owner(path, root)}{shown} is not a text",
            "write a word, in quotes if it looks like something else",
            False,
        )
    return f"{_owner(path, root)}{item['msg']}", _example(model, path), False


def _owner(path: Path, root: Node | Tree) -> str:
    """The innermost key on a path, as `key: `."""
    for end in range(len(path), 0, -1):
        node = root.get(*path[: end - 1])
        if node is not None and node.is_mapping and isinstance(path[end - 1], str) and path[end - 1] in node.value:
            return f"{path[end - 1]}: "
    return ""


def _shown(value: Any) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    text = str(value)
    if isinstance(value, dict | list | tuple):
        return "a mapping" if isinstance(value, dict) else "a list"
    return f"'{text[:60]}'"


def _example(model: type[BaseModel], path: Path) -> str:
    """What the schema says about the field at `path`, with its example."""
    level: Any = model
    info: FieldInfo | None = None
    for step in path:
        for kind in [level]:
            fields = _fields(kind)
            if str(step) in fields:
                info = fields[str(step)]
                level = info.annotation
            else:
                _, items, values = options(kind)
                below = (items if str(step).isdigit() else []) or values
                if below:
                    level, info = below[0], None
    if info is None:
        return ""
    example = f", e.g. `{path[-1]}: {_flow(info.examples[0])}`" if info.examples else ""
    return f"write {info.description}{example}" if info.description else ""


def _fields(annotation: Any) -> dict[str, FieldInfo]:
    stack, found = [annotation], {}
    while stack:
        kind = stack.pop()
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            found.update({info.alias or name: info for name, info in kind.model_fields.items()})
        elif get_origin(kind) in (Annotated, Union, types.UnionType):
            stack.extend(arg for arg in get_args(kind) if arg is not type(None))
    return found


def _flow(value: Any) -> str:
    import yaml

    return yaml.safe_dump(value, default_flow_style=True, width=10_000).removesuffix("\n").removesuffix("\n...").strip()
