"""The keys of a study as tables for reading, from the schema alone: what each takes, its default, what it is."""

from __future__ import annotations

import typing
from collections.abc import Iterator
from typing import Any, get_args, get_origin

from pounding_cli.study.laws import SHARED_KEYS, Link, law_keys
from pounding_cli.study.models import Case
from pydantic import BaseModel, create_model

from pounding_cli.laws import link_laws
from pounding_cli.study.quantity import ValueParser
from pounding_cli.study.words import fields_of, leaves

_LINK_KEYS: Any = {**SHARED_KEYS, **law_keys(link_laws())}
_AllLinks = create_model("_AllLinks", __base__=Link, **_LINK_KEYS)
_WORDS = {str: "text", int: "whole number", bool: "`true`, `false`", float: "number", Any: "mapping or list"}


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
        if isinstance(kind, ValueParser):
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
