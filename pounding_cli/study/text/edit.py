"""The text of a study with other values of some keys; everything else, comments too, stays as it is written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import yaml

from pounding_cli.errors import InputError
from pounding_cli.study.text.file import canonical, dump_yaml, parse, with_value

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def with_values(
    text: str, values: Mapping[tuple[str, ...], Any], file: str, written: Mapping[tuple[str, ...], str] | None = None
) -> str:
    """Return the text of a study with new values at some paths.

    A key that the study lacks is added to the mapping that it belongs in. Where an anchor (&) or alias (*) makes a
    value part of something else, the whole study is written anew, without comments.

    text : a sound YAML study
    file : name of the study in errors
    written : how a user wrote a value, which stands in the text where it means the same there
    """
    tree = parse(text, file)
    for path, value in values.items():
        tree = with_value(tree, path, value, tree.mark)
        forms = [dump_yaml(value)]
        if written is not None and path in written:
            forms.insert(0, written[path])
        root = yaml.compose(text, Loader=_LOADER)
        texts = [_replace_value(text, root, list(path), form) for form in forms]
        sound = [each for each in texts if _holds(each, tree, file)]
        text = sound[0] if sound else dump_yaml(tree, flow=False) + "\n"
    return text


def _holds(text: str, tree: Any, file: str) -> bool:
    """Return whether a text is the study of a tree."""
    try:
        return parse(text, file) == tree
    except InputError:
        return False


def _replace_value(text: str, here: Any, steps: list[str], form: str) -> str:
    """Return the text with one value changed, or added where a step is missing.

    here : node at which the steps begin
    form : the value as YAML on one line
    """
    for place, step in enumerate(steps):
        if isinstance(here, yaml.MappingNode):
            below = next((node for key, node in here.value if canonical(key.value) == step), None)
            if below is None and here.value:
                return _add_key(text, here, steps[place:], form)
            here = below or here
        elif isinstance(here, yaml.SequenceNode) and step.isdigit() and int(step) < len(here.value):
            here = here.value[int(step)]
    begin = here.start_mark.index
    end = _find_end(here)
    if isinstance(here, yaml.CollectionNode) and not here.flow_style:  # a block begins on a line of its own
        begin = text.rindex(":", 0, begin) + 1
    blank = " " if text[begin - 1 : begin] == ":" else ""
    return text[:begin] + blank + form + text[end:]


def _add_key(text: str, mapping: yaml.MappingNode, steps: Sequence[str], form: str) -> str:
    """Return the text with a key before the first one of a mapping."""
    first, *below = [dump_yaml(step) for step in steps]
    for step in reversed(below):
        form = f"{{{step}: {form}}}"
    mark = mapping.value[0][0].start_mark
    between = ", " if mapping.flow_style else "\n" + " " * mark.column
    return f"{text[: mark.index]}{first}: {form}{between}{text[mark.index :]}"


def _find_end(node: yaml.Node) -> int:
    """Return the index at which a value ends; that of its last value where it is a block."""
    if isinstance(node, yaml.CollectionNode) and not node.flow_style and node.value:
        last = node.value[-1]
        return _find_end(last[1] if isinstance(last, tuple) else last)
    return int(node.end_mark.index)
