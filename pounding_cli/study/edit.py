"""The text of a study with other values of some keys; everything else, comments too, stays as it is written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml

from pounding_cli.errors import InputError
from pounding_cli.study.file import canonical, dump_yaml, parse, with_value

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def with_values(text: str, values: Mapping[str, Any], file: str) -> str:
    """The text of a study with new values of dotted keys. A key that it lacks is added to the mapping that it belongs
    in. Where an anchor (&) or alias (*) makes a value part of something else, the whole study is written anew, without
    comments.

    text : a sound YAML study; file : what errors call it
    """
    wanted, new = parse(text, file), text
    for key, value in values.items():
        steps = key.split(".")
        wanted = with_value(wanted, steps, value, wanted.mark)
        new = _edited(new, yaml.compose(new, Loader=_LOADER), steps, value)
        try:
            is_sound = parse(new, file) == wanted
        except InputError:
            is_sound = False
        if not is_sound:
            new = dump_yaml(wanted, flow=False) + "\n"
    return new


def _edited(text: str, here: Any, steps: list[str], value: Any) -> str:
    """The text with one value changed, or added where a step is missing; here : the node that the steps begin at."""
    for place, step in enumerate(steps):
        if isinstance(here, yaml.MappingNode):
            found = next((below for key, below in here.value if canonical(key.value) == step), None)
            if found is None and here.value:
                return _added(text, here, steps[place:], value)
            here = found or here
        elif isinstance(here, yaml.SequenceNode) and step.isdigit() and int(step) < len(here.value):
            here = here.value[int(step)]
    begin, end = here.start_mark.index, _end(here)
    if isinstance(here, yaml.CollectionNode) and not here.flow_style:  # a block begins on a line of its own
        begin = text.rindex(":", 0, begin) + 1
    blank = " " if text[begin - 1 : begin] == ":" else ""
    return text[:begin] + blank + dump_yaml(value) + text[end:]


def _added(text: str, mapping: yaml.MappingNode, steps: list[str], value: Any) -> str:
    """The text with a key before the first one of a mapping."""
    for step in reversed(steps):
        value = {step: value}
    mark = mapping.value[0][0].start_mark
    between = ", " if mapping.flow_style else "\n" + " " * mark.column
    return text[: mark.index] + dump_yaml(value).removeprefix("{").removesuffix("}") + between + text[mark.index :]


def _end(node: yaml.Node) -> int:
    """Where a value ends; of a block, where its last value does."""
    if isinstance(node, yaml.CollectionNode) and not node.flow_style and node.value:
        last = node.value[-1]
        return _end(last[1] if isinstance(last, tuple) else last)
    return int(node.end_mark.index)
