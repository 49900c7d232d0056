"""The keys of a study as tables for reading, from the schema alone: what each takes, its default, what it is."""

from __future__ import annotations

import typing
from collections.abc import Iterator
from typing import Any, get_args, get_origin

from pydantic import BaseModel, Field, create_model

from pounding_cli.laws import link_laws
from pounding_cli.study.schema.links import SHARED_KEYS, LinkSpec, SeveralLinks, law_fields
from pounding_cli.study.schema.lookup import fields_of, leaf_types
from pounding_cli.study.schema.quantity import ValueParser

_LINK_KEYS: Any = {**SHARED_KEYS, **law_fields(link_laws())}
_AllLinks = create_model("_AllLinks", __base__=LinkSpec, **_LINK_KEYS)
_WORDS = {str: "text", int: "whole number", bool: "`true`, `false`", float: "number", Any: "mapping or list"}


def table(model: type[BaseModel]) -> list[str]:
    """One mapping's keys as the lines of a Markdown table; of a case, those of all its links too."""
    lines = ["| key | value | default | meaning |", "|---|---|---|---|"]
    fields = fields_of(model)
    if model is SeveralLinks:
        fields = {**fields_of(_AllLinks), "links": fields["links"]}
        hint, gap = fields["gap"]
        fields["gap"] = hint, require(gap)
    return [*lines, *(row(name, hint, info) for name, (hint, info) in fields.items())]


def require(info: Any) -> Any:
    """Return the field of a key as one that must be given.

    The model of a link takes it without the keys that its case may give in its place.
    """
    return Field(..., description=info.description)


def row(name: str, hint: Any, info: Any) -> str:
    """One key as a line of such a table."""
    forms = "; ".join(dict.fromkeys(_forms(hint))) or "mapping or list"
    return f"| `{name}` | {forms} | {default(info)} | {info.description or ''} |"


def _forms(hint: Any) -> Iterator[str]:
    """The values a key takes, in a few words."""
    for kind in leaf_types(hint):
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
