"""The schema asked: what may stand at a dotted key, which quantity it is, and errors of pydantic in words."""

from __future__ import annotations

import functools
import types
import typing
from collections.abc import Iterator, Sequence
from typing import Any, get_args, get_origin, get_type_hints

from pydantic import BaseModel
from pydantic_core import PydanticCustomError

from pounding_cli.laws import link_laws
from pounding_cli.study.file import Steps, dumped, get, nearest
from pounding_cli.study.laws import Link, keys_of, kind_of, link_models, own, tag
from pounding_cli.study.quantity import ParsedText, Quantity, ValueParser, quote


@functools.cache
def fields_of(model: type[BaseModel]) -> dict[str, tuple[Any, Any]]:
    """Type and field of every key of a mapping, as the file calls it."""
    hints = get_type_hints(model, include_extras=True)
    return {info.alias or name: (hints[name], info) for name, info in model.model_fields.items()}


def leaves(kind: Any) -> Iterator[Any]:
    """What a type comes to: models, tuples, dicts, literals and what is read."""
    origin, parts = get_origin(kind), get_args(kind)
    if origin is typing.Annotated:
        read = next((part for part in parts[1:] if isinstance(part, ValueParser)), None)
        yield from [read] if read is not None else leaves(parts[0])
    elif origin in (typing.Union, types.UnionType):
        for part in parts:
            yield from leaves(part)
    elif kind is not type(None):
        yield kind


def _is_model(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def at(model: type[BaseModel], path: Sequence[Any]) -> tuple[list[Any], Any]:
    """What may stand at a path, and the field that it is; steps that no type knows, as tags of unions, narrow it."""
    level, field = [model], None
    tags = {tag(name): link for name, link in link_models().items()}
    for step in path:
        below: list[Any] = []
        for kind in level:
            if _is_model(kind) and str(step) in fields_of(kind):
                hint, field = fields_of(kind)[str(step)]
                below += leaves(hint)
            elif get_origin(kind) is tuple and str(step).isdigit():
                below += leaves(get_args(kind)[0])
            elif get_origin(kind) is dict:
                below += leaves(get_args(kind)[1])
        if not below and str(step) in tags:
            below = [tags[str(step)]]
        level = below or level
    return level, field


def keys_at(model: type[BaseModel], path: Sequence[Any], root: Any) -> list[str]:
    """The keys that the schema knows at `path`; of a free mapping those the file has."""
    found: dict[str, None] = {}
    for kind in at(model, path)[0]:
        if _is_model(kind):
            found |= dict.fromkeys(fields_of(kind))
        elif get_origin(kind) is dict and isinstance(node := get(root, *path), dict):
            found |= dict.fromkeys(node)
    return list(found)


@functools.lru_cache(maxsize=1000)
def _readers(model: type[BaseModel], path: tuple[str, ...]) -> list[ValueParser]:
    """What reads the value of a key; keys of links mean one thing wherever they stand."""
    kinds: list[Any] = at(model, path)[0]
    if path[0] == "cases" and len(path) > 2:
        hints = [fields_of(link)[path[-1]][0] for link in link_models().values() if path[-1] in fields_of(link)]
        kinds = [leaf for hint in hints for leaf in leaves(hint)]
    return [kind for kind in kinds if isinstance(kind, ValueParser)]


def quantity_at(model: type[BaseModel], path: tuple[str, ...]) -> Quantity | None:
    """The quantity that may stand at a key, or None."""
    read = (kind.quantity if isinstance(kind, ParsedText) else kind for kind in _readers(model, path))
    return next((each for each in read if isinstance(each, Quantity)), None)


def value_at(model: type[BaseModel], path: tuple[str, ...], given: Any) -> float | str:
    """A value of a key as tables have it: an SI number, or the word that the file writes."""
    found = given
    for reader in _readers(model, path):
        try:
            found = reader.read(given)
            break
        except PydanticCustomError:
            continue
    if isinstance(found, int | float) and not isinstance(found, bool):
        return float(found)
    return {True: "true", False: "false"}.get(given, str(given)) if isinstance(given, bool) else str(given)


Told = tuple[str, str, bool]
"""Message, hint, whether it stands at the key."""

_SAID: dict[str, Told] = {
    "literal_error": ("{owner}{shown} is not known", "write {expected}", False),
    "tuple_type": ("{owner}{shown} is not a list", "write [first, second, ...]", False),
    "too_long": ("{owner}{actual_length} entries", "write at most {max_length}", False),
    "string_pattern_mismatch": ("{shown} cannot be a name", "use letters, digits, blanks, _, - and +", True),
    "string_too_long": ("{shown} is too long a name", "use at most {max_length} characters", True),
    "bool_parsing": ("{owner}{shown} is neither true nor false", "write true or false", False),
    "string_type": ("{owner}{shown} is not a text", "write a word, in quotes if it looks like something else", False),
}
_SAID |= {"enum": _SAID["literal_error"], "list_type": _SAID["tuple_type"], "bool_type": _SAID["bool_parsing"]}


def in_words(item: dict[str, Any], path: Steps, model: type[BaseModel], root: Any) -> Told:
    """An error of pydantic in words; "" for what is told elsewhere."""
    kind, context, given, owner = item["type"], item.get("ctx", {}), item.get("input"), _walk(root, path)[1]
    words = [step for step in path if isinstance(step, str) and not step.startswith("(")]
    name = (words[-1] if words else "the study")[:60]
    if kind in _SAID:
        message, hint, at_key = _SAID[kind]
        told = context | {"owner": owner, "shown": quote(given)}
        if kind == "too_long":  # pydantic does not always count
            told["actual_length"] = len(given or ())
        return message.format_map(told), hint.format_map(told), at_key
    match kind:
        case "refused":
            return f"{'' if context.get('whole') else owner}{context['message']}", context["hint"], context["key"]
        case "extra_forbidden":
            return _unknown(str(path[-1])[:60], path, model, root)
        case "missing":
            return _missing(name, path, model, root)
        case "model_type" | "model_attributes_type" | "dict_type":
            keys, field = keys_at(model, path, root), at(model, path)[1]
            hint = f"write {{key: value}} with the keys {', '.join(keys)}"
            if not keys or keys == ["links"] or (len(path) == 1 and field is not None and field.examples):
                hint = _example(model, path[:1] if keys == ["links"] else path, root)
            return f"{owner}{quote(given)} is not a mapping", hint, False
        case "too_short":
            # Pydantic counts sound entries only: what is wrong with the others is told.
            is_so = context.get("actual_length") == len(given or ())
            return f"'{name}' is empty" * is_so, _example(model, path, root) or "write at least one value", False
    return f"{owner}{item['msg']}", _example(model, path, root), False


def _walk(root: Any, path: Steps) -> tuple[Any, str]:
    """What the file has at a path, where steps that it lacks are passed over, and the innermost key there, `key: `."""
    node, owner = get(root), ""
    for step in path:
        owner = f"{step}: " if isinstance(node, dict) and step in node else owner
        node = node if (below := get(node, step)) is None else below
    return node, owner


def _unknown(name: str, path: Steps, model: type[BaseModel], root: Any) -> Told:
    """A key that does not belong where it stands."""
    known, above = keys_at(model, path[:-1], root), _walk(root, path[:-1])[0]
    owners, link = [law.name for law in link_laws().values() if name in keys_of(law)], get(above, "link")
    if "link" in known and owners:
        if link is None:
            return "", "", True  # that it is missing is told
        takes = ", ".join(key for key in known if key not in Link.model_fields)
        hint = f"remove it: {link} takes {takes or 'none'}; it belongs to {', '.join(owners)}"
        return f"'{name}' does not apply to link: {link}", hint, True
    if known == ["links"] and (owners or name in Link.model_fields):
        hint = f"write it in the entry that it is of: `links: [{{link: ..., {name}: ...}}]`"
        return f"'{name}' beside `links:` does not apply to them, or does not say which it is of", hint, True
    known += [key for link in link_models().values() for key in fields_of(link)] if known == ["links"] else []
    if name in known:
        return f"'{name}' does not go with the other keys here", "remove it, or them", True
    return f"unknown key '{name}'", nearest(name, dict.fromkeys(known)), True


def _missing(name: str, path: Steps, model: type[BaseModel], root: Any) -> Told:
    known, above = keys_at(model, path[:-1], root), _walk(root, path[:-1])[0]
    law = link_laws().get(kind_of(str(get(above, "link"))))
    if name == "link":
        return "'link' is missing", f"write `link: pounding`, {', '.join([*link_laws()][1:])} or none", False
    if "link" in known and law is not None and name in own(law):
        contact = " here or under `impact`" if law.subtracts_gap else ""
        return f"'{name}' is missing", f"a {law.name} needs it{contact}: {own(law)[name].words}", False
    return f"'{name}' is missing", _example(model, path, root), False


def _example(model: type[BaseModel], path: Steps, root: Any) -> str:
    """Return what the schema says about the field at `path`, with its example, in names of the study."""
    field = at(model, path)[1]
    if field is None or not field.description:
        return ""
    words = [str(step) for step in path if not str(step).startswith("(")]
    example = field.examples[0] if field.examples else None
    names = [*(get(root, "buildings") or ())] if isinstance(get(root, "buildings"), dict) else []
    if words[-1:] == ["group"] and names:
        example = (names * 2)[:2]
    flow = "" if example is None else dumped(example)
    description = field.description
    if isinstance(cases := get(root, "cases"), dict) and cases:
        description = description.replace("cases: {near:", f"cases: {{{next(iter(cases))}:")
    return f"write {description}" + (f", e.g. `{words[-1]}: {flow}`" if flow else "")
