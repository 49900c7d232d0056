"""Look up schema fields by dotted key; describe validation errors."""

from __future__ import annotations

import functools
import re
import types
import typing
from collections.abc import Iterator, Sequence
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import PydanticCustomError

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.laws import KELVIN_VOIGT, contact_laws, link_laws
from pounding_cli.study.schema.links import (
    NO_LINK,
    POUNDING,
    SeveralLinks,
    link_keys,
    link_models,
    refuse_beside_links,
    refuse_key,
    union_tag,
)
from pounding_cli.study.schema.quantity import SEVERAL_VALUES, Quantity, ValueParser, quote
from pounding_cli.study.schema.records import CODE_TARGETS
from pounding_cli.study.schema.study import ONCE, StudySpec, find_section_names
from pounding_cli.study.text.file import dump_yaml, get, nearest


@functools.cache
def fields_of(model: type[BaseModel]) -> dict[str, tuple[Any, Any]]:
    """Return type and field of every key of a mapping, as the file calls it."""
    return {info.alias or name: (info.rebuild_annotation(), info) for name, info in model.model_fields.items()}


def leaf_types(kind: Any) -> Iterator[Any]:
    """Yield what a type comes to: models, tuples, dicts, literals and parsers of values."""
    origin = get_origin(kind)
    parts = get_args(kind)
    if origin is typing.Annotated:
        read = next((part for part in parts[1:] if isinstance(part, ValueParser)), None)
        yield from [read] if read is not None else leaf_types(parts[0])
    elif origin in (typing.Union, types.UnionType):
        for part in parts:
            yield from leaf_types(part)
    elif kind is not type(None):
        yield kind


def _is_model(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def types_at(model: type[BaseModel], path: Sequence[Any]) -> tuple[list[Any], Any]:
    """Return the types that may stand at a path, and the field there; tags of unions narrow the types."""
    level: list[Any] = [model]
    field = None
    tags: dict[str, Any] = {union_tag(name): link for name, link in link_models().items()} | {"(links)": SeveralLinks}
    tags |= {union_tag(name): target for name, target in CODE_TARGETS.items()}
    for step in path:
        below: list[Any] = []
        free: list[Any] = []  # values of mappings whose keys are free: no key of a model beside them
        for kind in level:
            if _is_model(kind) and str(step) in fields_of(kind):
                hint, field = fields_of(kind)[str(step)]
                below += leaf_types(hint)
            elif get_origin(kind) is tuple and str(step).isdigit():
                below += leaf_types(get_args(kind)[0])
            elif get_origin(kind) is dict and str(step) not in tags:
                free += leaf_types(get_args(kind)[1])
        below = below or free
        if not below and str(step) in tags:
            below = [tags[str(step)]]
        level = below or level
    return level, field


def keys_at(model: type[BaseModel], path: Sequence[Any], tree: Any) -> list[str]:
    """Return the keys that the schema knows at `path`; of a free mapping those the file has."""
    found: dict[str, None] = {}
    for kind in types_at(model, path)[0]:
        if _is_model(kind):
            found |= dict.fromkeys(fields_of(kind))
        elif get_origin(kind) is dict and isinstance(node := get(tree, *path), dict):
            found |= dict.fromkeys(node)
    return list(found)


def names_in(tree: Any, section: str) -> list[str]:
    """Return the names that a section of the file gives; none where it is no mapping."""
    node = get(tree, section)
    return list(node) if isinstance(node, dict) else []


@functools.lru_cache(maxsize=1000)
def _parsers_at(model: type[BaseModel], path: tuple[str, ...]) -> list[ValueParser]:
    """Return what may parse the value of a key."""
    return [kind for kind in types_at(model, path)[0] if isinstance(kind, ValueParser)]


def quantity_at(model: type[BaseModel], path: tuple[str, ...]) -> Quantity | None:
    """Return the quantity that may stand at a key, or None."""
    read = (kind if isinstance(kind, Quantity) else kind.quantity for kind in _parsers_at(model, path))
    return next((each for each in read if each is not None), None)


def value_at(model: type[BaseModel], path: tuple[str, ...], given: Any) -> float | str:
    """Return a value of a key as tables have it: an SI number, or the word that the file writes."""
    found = given
    for reader in _parsers_at(model, path):
        try:
            found = reader.read(given)
            if reader.quantity is not None and not isinstance(found, int | float | str):
                found = reader.quantity.read(given)  # of which the reader makes more than a number
            break
        except PydanticCustomError:
            continue
    if isinstance(found, int | float) and not isinstance(found, bool):
        return float(found)
    return {True: "true", False: "false"}.get(given, str(given)) if isinstance(given, bool) else str(given)


Described = tuple[str, str, bool]
"""Message, hint, whether it stands at the key."""

_OTHER_FORMS: dict[Any, str] = {"(one)": ", or a list: [first, second, ...]", "(word)": ", or a mapping: {key: value}"}
"""What else may stand in place of a word that is not known, by the last tag of its path (`base.tagged_union`)."""

MAX_DESCRIBED = 100
"""Errors of one section that are described one by one."""

MAX_WORDS = 12
"""Words of which a key takes one that are named, all of them; of more the nearest comes first."""

_MESSAGES: dict[str, Described] = {
    "literal_error": ("{owner}{value} is not known", "write {expected}", False),
    "tuple_type": ("{owner}{value} is not a list", "write [first, second, ...]", False),
    "too_long": ("{owner}{actual_length} entries", "write at most {max_length}", False),
    "string_pattern_mismatch": ("{value} cannot be a name", "use letters, digits, blanks, _, - and +", True),
    "string_too_long": ("{value} is too long a name", "use at most {max_length} characters", True),
    "bool_parsing": ("{owner}{value} is neither true nor false", "write true or false", False),
    "string_type": ("{owner}{value} is not a text", "write a word, in quotes if it looks like something else", False),
}
_MESSAGES |= {
    "enum": _MESSAGES["literal_error"],
    "list_type": _MESSAGES["tuple_type"],
    "bool_type": _MESSAGES["bool_parsing"],
}


def describe_errors(error: ValidationError, path: KeyPath, model: type[BaseModel], tree: Any) -> list[Issue]:
    """Return the errors of a validation as issues.

    path : of what was validated
    model : of the whole file
    tree : the file, which names are taken from
    """
    issues = []
    errors = error.errors(include_url=False)
    for number, item in enumerate(errors):
        at = (*path, *item["loc"])
        if number >= MAX_DESCRIBED:
            issues.append(Issue(at[:1], f"and {len(errors) - number} more problems like these", at_key=True))
            break
        message, hint, at_key = describe_error(dict(item), at, model, tree)
        if message:
            issues.append(Issue(at, message, hint, at_key=at_key))
    return issues


def describe_error(item: dict[str, Any], path: KeyPath, model: type[BaseModel], tree: Any) -> Described:
    """Return an error of pydantic in words; "" for what is told elsewhere."""
    kind = item["type"]
    context = item.get("ctx", {})
    value = item.get("input")
    owner = _walk(tree, path)[1]
    name = _last_key(path)
    if kind == "string_type" and name == "link" and isinstance(value, list) and "links" not in path:
        example = "links: [pounding, {link: infill, floors: [3, 5]}]"
        return "a list of links stands under `links:`", f"write it so: `{example}`", True
    if kind in _MESSAGES:
        message, hint, at_key = _MESSAGES[kind]
        fields = context | {"owner": owner, "value": quote(value)}
        if kind == "string_pattern_mismatch":
            hint += _explain_dots(str(value), str(context["pattern"]))
            at_key = name != "name"  # keys that are names themselves
        if kind == "literal_error" and len(words := re.findall(r"'([^']*)'", context["expected"])) > MAX_WORDS:
            hint = nearest(value, words)
        if kind == "too_long":  # pydantic does not always count
            fields["actual_length"] = len(value or ())
        other_form = _OTHER_FORMS.get(path[-1], "") if at_key is False else ""
        if kind in ("literal_error", "enum") and isinstance(value, list | dict):
            message = "{owner}{value} stands where one word belongs"
            other_form = other_form or f"; {SEVERAL_VALUES}"
        if kind in ("tuple_type", "list_type"):
            other_form += _example_of_list(model, path)
        return message.format_map(fields), hint.format_map(fields) + other_form, at_key
    match kind:
        case "refused":
            message = f"{'' if context.get('whole') else owner}{context['message']}"
            hint = (
                context["hint"] if _can_be_swept(path, model) else context["hint"].removesuffix(f"; {SEVERAL_VALUES}")
            )
            other_form = _OTHER_FORMS["(one)"] if path[-1] == "(one)" and isinstance(value, dict) else ""
            return message, f"{hint}{other_form}", context["key"]
        case "extra_forbidden":
            return _describe_unknown(str(path[-1])[:60], path, model, tree)
        case "missing":
            return _describe_missing(name, path, model, tree)
        case "model_type" | "model_attributes_type" | "dict_type":
            return f"{owner}{quote(value)} is not a mapping", _mapping_hint(path, model, tree), False
        case "too_short":
            # Pydantic counts sound entries only: what is wrong with the others is told.
            is_empty = context.get("actual_length") == len(value or ())
            return f"'{name}' is empty" * is_empty, _example(model, path, tree) or "write at least one value", False
    return f"{owner}{item['msg']}", _example(model, path, tree), False


def _can_be_swept(path: KeyPath, model: type[BaseModel]) -> bool:
    """Return whether a key may have several values under `sweep:`; not one of a section of the whole study."""
    return not issubclass(model, StudySpec) or path[0] not in {*ONCE, *find_section_names(model)}


def _last_key(path: KeyPath) -> str:
    """Return the innermost key of a path; tags of unions are none."""
    words = [step for step in path if isinstance(step, str) and not step.startswith("(")]
    return (words[-1] if words else "the study")[:60]


def _walk(tree: Any, path: KeyPath) -> tuple[Any, str]:
    """Return what the file has at a path, and the innermost key there, `key: `; steps that it lacks are passed over."""
    node = tree
    owner = ""
    for step in path:
        owner = f"{step}: " if isinstance(node, dict) and step in node else owner
        below = get(node, step)
        node = node if below is None else below
    return node, owner


def _mapping_hint(path: KeyPath, model: type[BaseModel], tree: Any) -> str:
    """Return what to write where a mapping belongs."""
    keys = keys_at(model, path, tree)
    field = types_at(model, path)[1]
    is_case = path[:1] == ("cases",) and len(path) > 1
    if not keys or is_case or (len(path) == 1 and field is not None and field.examples):
        return _example(model, path[:1] if is_case else path, tree)
    return f"write {{key: value}} with the keys {', '.join(keys)}"


def _describe_unknown(name: str, path: KeyPath, model: type[BaseModel], tree: Any) -> Described:
    """Describe a key that does not belong where it stands."""
    keys = keys_at(model, path[:-1], tree)
    all_link_keys = dict.fromkeys(key for link in link_models().values() for key in fields_of(link))
    if "link" in keys:
        word = get(_walk(tree, path[:-1])[0], "link")
        is_known = str(word) in (*link_laws(), NO_LINK, *names_in(tree, "laws"))
        if name in all_link_keys:
            # That `link` is missing, or its law unknown, is told elsewhere.
            return (
                (*refuse_key(name, str(word), _keys_taken(str(word), keys, tree)), True) if is_known else ("", "", True)
            )
        keys = keys if is_known else [*all_link_keys]
    elif "links" in keys and (name in all_link_keys):
        return (*refuse_beside_links(name), True)
    if name in keys:
        return f"'{name}' does not go with the other keys here", "remove it, or them", True
    if (several := _describe_listed_value(name, path, model, tree)) is not None:
        return several
    return f"unknown key '{name}'", nearest(name, dict.fromkeys(keys)), True


def _describe_listed_value(name: str, path: KeyPath, model: type[BaseModel], tree: Any) -> Described | None:
    """Describe the second value of a key, `floors: 1, 2` in braces, which YAML reads as a key; None for other keys."""
    owner = _walk(tree, path[:-1])[0]
    is_value = re.match(r"[-+±/. ]*[0-9]", name) is not None
    if not is_value or not isinstance(owner, dict) or owner.get(name, name) is not None:
        return None
    names = [str(key) for key in owner]
    before = names[names.index(name) - 1]
    if before == name or isinstance(owner[before], dict | list | None):
        return None
    hint = f"'{before}' takes one value; {SEVERAL_VALUES}"
    if any(get_origin(kind) is tuple for kind in types_at(model, (*path[:-1], before))[0]):
        hint = f"write a list in brackets, `{before}: [{owner[before]}, {name}]`"
    return f"'{name}' stands where a key belongs", hint, True


def _explain_dots(name: str, pattern: str) -> str:
    """Return why a name has no dot, or that it may have some; "" where neither is asked.

    pattern : of the names that are allowed
    """
    if "." in pattern:
        return "; dots behind the first one"
    return "; a dot stands between the keys of a dotted name, `cases.near.gap`" if "." in name else ""


def _example_of_list(model: type[BaseModel], path: KeyPath) -> str:
    """Return the example of a key that takes a list, `, e.g. lines: [...]`; "" where the schema has none."""
    field = types_at(model, path)[1]
    examples = field.examples if field is not None else None
    if not examples or not isinstance(examples[0], list | tuple):
        return ""
    return f", e.g. `{_last_key(path)}: {dump_yaml(examples[0])}`"


def _keys_taken(word: str, keys: list[str], tree: Any) -> list[str]:
    """Return those keys of a link as written that its law takes: none of no link, of pounding those of its contact.

    word : the law as written
    """
    if word == NO_LINK:
        return []
    law = contact_laws().get(str(get(tree, "impact", "law") or KELVIN_VOIGT))
    return [key for key in keys if key in link_keys(law)] if word == POUNDING and law is not None else keys


def _describe_missing(name: str, path: KeyPath, model: type[BaseModel], tree: Any) -> Described:
    if name == "link":
        return "'link' is missing", f"write `link: pounding`, {', '.join([*link_laws()][1:])} or none", False
    return f"'{name}' is missing", _example(model, path, tree), False


def _example(model: type[BaseModel], path: KeyPath, tree: Any) -> str:
    """Return what the schema says about the field at `path`, with its example, in names of the study."""
    field = types_at(model, path)[1]
    if field is None or not field.description:
        return ""
    words = [str(step) for step in path if not str(step).startswith("(")]
    example = field.examples[0] if field.examples else None
    names = names_in(tree, "buildings")
    if words[-1:] == ["group"] and names:
        example = (names * 2)[:2]
    flow = "" if example is None else dump_yaml(example)
    description = field.description
    if isinstance(cases := get(tree, "cases"), dict) and cases:
        description = description.replace("cases: {near:", f"cases: {{{next(iter(cases))}:")
    return f"write {description}" + (f", e.g. `{words[-1]}: {flow}`" if flow else "")
