"""The text of a study with other values of some keys; everything else, comments too, stays as it is written."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import yaml

from pounding_cli.errors import InputError, Problem
from pounding_cli.study.file import Quoted, Real, canonical, locate, parse, put

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_PLAIN = re.compile(r"[\w.+/-][\w .+/%*-]*\Z")
"""What a study writes without quotes in every place."""


def with_values(text: str, values: Mapping[str, Any], file: str) -> str:
    """The text of a study with new values of dotted keys. A key that it lacks is added to the mapping that it belongs
    in.

    text : a sound YAML study; file : what errors call it

    Raises
    ------
    InputError : a value cannot be put into the text, because an anchor (&) or alias (*) stands there
    """
    for key, value in values.items():
        steps = key.split(".")
        before = parse(text, file)
        wanted = put(before, steps, value, before.mark)
        try:
            text = _edited(text, steps, value)
            is_sound = parse(text, file) == wanted
        except (InputError, _Unclear):
            is_sound = False
        if not is_sound:
            line, column = locate(before, steps)
            hint = f"write the value of '{key}' there as plain text, without & and *"
            raise InputError(Problem(f"'{key}' cannot be changed in this text", hint, file, line, column))
    return text


class _Unclear(Exception):
    """The text has no place for the value."""


def _edited(text: str, steps: list[str], value: Any) -> str:
    """The text with one value changed, or added where a step is missing."""
    here: Any = yaml.compose(text, Loader=_LOADER)
    begin = 0
    for place, step in enumerate(steps):
        if isinstance(here, yaml.MappingNode):
            found = next(((k, v) for k, v in here.value if canonical(k.value) == step), None)
            if found is None:
                return _added(text, here, steps[place:], value)
            begin, here = found[0].end_mark.index, found[1]
        elif isinstance(here, yaml.SequenceNode) and step.isdigit() and int(step) < len(here.value):
            begin, here = here.start_mark.index, here.value[int(step)]
        else:
            rest = _below(steps[place:], value)
            return text[: here.start_mark.index] + f" {rest}" + text[here.end_mark.index :]
        if here.start_mark.index < begin:  # an alias: what it stands for is written above
            raise _Unclear
    start, end = here.start_mark.index, _end(here)
    if text[start : start + 1] in ("&", "*", "!"):
        raise _Unclear
    blank = "" if end > start else " "
    if isinstance(here, yaml.CollectionNode) and not here.flow_style:  # a block begins on a line of its own
        start, blank = text.index(":", begin) + 1, " "
    return text[:start] + blank + _scalar(value) + text[end:]


def _added(text: str, mapping: yaml.MappingNode, steps: list[str], value: Any) -> str:
    """The text with a key added to a mapping."""
    said = f"{steps[0]}: {_below(steps[1:], value)}"
    if mapping.flow_style:
        if not mapping.value:
            place = text.index("{", mapping.start_mark.index) + 1
            return text[:place] + said + text[place:]
        last = mapping.value[-1][1]
        place = max(mapping.value[-1][0].end_mark.index, _end(last))
        return f"{text[:place]}, {said}{text[place:]}"
    newline = "\r\n" if "\r\n" in text else "\n"
    first = mapping.value[0][0]
    place = first.start_mark.index
    if first.start_mark.column == 0:  # a new section: before the cases, which every study has, and their comment
        place = next((key.start_mark.index for key, _ in mapping.value if key.value == "cases"), place)
        while (above := text.rfind("\n", 0, max(place - 1, 0)) + 1) < place and text.startswith("#", above):
            place = above
    return f"{text[:place]}{said}{newline}{' ' * first.start_mark.column}{text[place:]}"


def _end(node: yaml.Node) -> int:
    """Where a value ends; of a block, where its last value does."""
    if isinstance(node, yaml.CollectionNode) and not node.flow_style and node.value:
        last = node.value[-1]
        return _end(last[1] if isinstance(last, tuple) else last)
    return int(node.end_mark.index)


def _below(steps: list[str], value: Any) -> str:
    """A value below further keys, in braces."""
    return _scalar(value) if not steps else f"{{{steps[0]}: {_below(steps[1:], value)}}}"


def _scalar(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, str) and not isinstance(value, Quoted) and _PLAIN.match(value):
        return str(value)
    if isinstance(value, Real):
        return str(value)
    found: str = yaml.safe_dump(_bare(value), default_flow_style=True, allow_unicode=True, width=float("inf"))
    return found.removesuffix("\n").removesuffix("\n...")


def _bare(value: Any) -> Any:
    """A value in the types of YAML."""
    if isinstance(value, dict):
        return {key: _bare(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_bare(item) for item in value]
    return str(value) if isinstance(value, str) else float(value) if isinstance(value, float) else value
