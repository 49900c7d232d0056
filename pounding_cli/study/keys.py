"""Every key of a study file as tables for reading: what it takes, its default, what it is; from the schema alone."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Iterator
from typing import Any, get_args, get_origin

from pydantic import BaseModel, create_model

from pounding_cli.study.laws import Link, link_keys
from pounding_cli.study.models import Case
from pounding_cli.study.quantity import Read
from pounding_cli.study.schema import Study
from pounding_cli.study.words import fields_of, leaves

_LINK_KEYS: Any = link_keys()
_AllLinks = create_model("_AllLinks", __base__=Link, **_LINK_KEYS)
_WORDS = {str: "text", int: "whole number", bool: "`true`, `false`", float: "number", Any: "mapping or list"}


def key_tables() -> str:
    """All tables under their headings, as Markdown."""
    parts = []
    for path, model in sections():
        heading = f"`{path}`" if path else "The file"
        parts += [f"## {heading}", inspect.getdoc(model) or "", "\n".join(table(model))]
    return "\n\n".join(parts)


def sections() -> Iterator[tuple[str, type[BaseModel]]]:
    """Every mapping a study can hold, once, with the dotted path it is first met at; "" for the file."""
    seen: set[Any] = set()
    stack: list[tuple[str, type[BaseModel]]] = [("", Study)]
    while stack:
        path, model = stack.pop(0)
        if model in seen or model.__name__.endswith("Link") or model.__name__.startswith("Link_"):
            continue
        seen.add(model)
        yield path, model
        below = [
            (f"{path}.{name}".lstrip("."), leaf)
            for name, (hint, _) in fields_of(model).items()
            for leaf in leaves(hint)
        ]
        stack = [*_models(below), *stack]


def _models(below: list[tuple[str, Any]]) -> Iterator[tuple[str, type[BaseModel]]]:
    """The mappings among some types; names that are free are written NAME."""
    for path, kind in below:
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            yield path, kind
        elif get_origin(kind) in (tuple, dict):
            inner, free = (get_args(kind)[0], "") if get_origin(kind) is tuple else (get_args(kind)[1], ".NAME")
            yield from _models([(path + free, leaf) for leaf in leaves(inner)])


def table(model: type[BaseModel]) -> list[str]:
    """One mapping's keys as the lines of a Markdown table; of a case, those of all its links too."""
    lines = ["| key | value | default | meaning |", "|---|---|---|---|"]
    found = dict(fields_of(model))
    if model is Case:
        found = {**fields_of(_AllLinks), **found}
    return [*lines, *(row(name, hint, info) for name, (hint, info) in found.items())]


def row(name: str, hint: Any, info: Any) -> str:
    """One key as a line of such a table."""
    forms = "; ".join(dict.fromkeys(_forms(hint))) or "mapping or list"
    return f"| `{name}` | {forms} | {default(info)} | {info.description or ''} |"


def _forms(hint: Any) -> Iterator[str]:
    """The values a key takes, in a few words."""
    for kind in leaves(hint):
        if isinstance(kind, Read):
            yield from kind.form.split("; ")
        elif get_origin(kind) is typing.Literal:
            yield from (f"`{word}`" for word in get_args(kind))
        elif get_origin(kind) is tuple:
            yield f"list of {' / '.join(dict.fromkeys(_forms(get_args(kind)[0])))}"
        else:
            yield _WORDS.get(kind, "mapping")


def default(field: Any) -> str:
    """The default as a user would write it; "" where the key may be left out without one."""
    value = field.default
    if field.is_required():
        return "required"
    if value is None or value in ("", {}, ()):
        return ""
    if isinstance(value, BaseModel):
        return "see below"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, tuple):
        return f"`[{', '.join(map(str, value))}]`"
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"
