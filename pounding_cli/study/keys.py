"""Every key of a study file as tables for reading: what it takes, its default, what it is; from the schema alone."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Iterator

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pounding_cli.study.rules import StiffnessRule
from pounding_cli.study.schema import StudyModel
from pounding_cli.study.units import Quantity, TextForm

_WORDS = {"str": "text", "int": "whole number", "bool": "`true`, `false`", "float": "number"}


def key_tables() -> str:
    """All tables under their headings, as Markdown."""
    parts = []
    for path, model in sections():
        about = inspect.getdoc(model) or ""
        parts += [f"## {f'`{path}`' if path else 'The file'}", about, "\n".join(table(model))]
    return "\n\n".join(parts)


def sections() -> Iterator[tuple[str, type[BaseModel]]]:
    """Every mapping a study can hold, once, with the dotted path it is first met at; "" for the file."""
    seen: set[type[BaseModel]] = set()
    stack: list[tuple[str, type[BaseModel]]] = [("", StudyModel)]
    while stack:
        path, model = stack.pop(0)
        if model in seen:
            continue
        seen.add(model)
        yield path, model
        below = []
        for name, field in model.model_fields.items():
            inner = f"{path}.{field.alias or name}".lstrip(".")
            below += [(inner + suffix, found) for suffix, found in _models(field.annotation)]
        stack = below + stack


def _models(annotation: typing.Any, suffix: str = "") -> Iterator[tuple[str, type[BaseModel]]]:
    """The mappings a type can hold; names that are free are written NAME."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield suffix, annotation
    free = typing.get_origin(annotation) is dict
    for part in typing.get_args(annotation):
        yield from _models(part, f"{suffix}.NAME" if free else suffix)


def table(model: type[BaseModel]) -> list[str]:
    """One mapping's keys as the lines of a Markdown table."""
    lines = ["| key | value | default | meaning |", "|---|---|---|---|"]
    hints = typing.get_type_hints(model, include_extras=True)
    for name, field in model.model_fields.items():
        cells = (f"`{field.alias or name}`", forms(hints[name]), default(field), field.description or "")
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def forms(annotation: typing.Any) -> str:
    """The values a key takes, in a few words."""
    return "; ".join(dict.fromkeys(_forms(annotation))) or "mapping or list"


def _forms(kind: typing.Any) -> list[str]:
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Annotated:
        for extra in parts[1:]:
            if isinstance(extra, Quantity):
                words = [f"`{word}`" for word in extra.words]
                return [", ".join(part for part in (extra.si or "-", extra.range, *words) if part)]
            if isinstance(extra, TextForm):
                return extra.form.split("; ")
        return _forms(parts[0])
    if origin is typing.Literal:
        return [f"`{word}`" for word in parts]
    if origin is tuple:
        return [f"list of {' / '.join(_forms(parts[0]))}"]
    if origin is dict:
        return ["mapping"]
    if parts:
        return [form for part in parts for form in _forms(part)]
    if isinstance(kind, type) and kind not in (type(None), StiffnessRule):
        return [_WORDS.get(kind.__name__, "mapping")]
    return []


def default(field: FieldInfo) -> str:
    """The default as a user would write it; "" where the key may be left out without one."""
    if field.is_required():
        return "required"
    value = field.default
    if value is None or value in ("", {}):
        return ""
    if isinstance(value, BaseModel):
        return "see below"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, tuple):
        return f"`[{', '.join(map(str, value))}]`"
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"
