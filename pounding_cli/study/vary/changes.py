"""Values of a study that are changed where it is used: by arguments of a command, `cases.gap.gap='5 cm'`, or in Python.

A changed value is checked as if it stood in the file; messages name the argument in place of line and column.
"""

from __future__ import annotations

import hashlib
import re
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from pounding_cli.errors import InputError, Issue
from pounding_cli.study.schema import study as schema
from pounding_cli.study.schema.lookup import keys_at
from pounding_cli.study.schema.quantity import quote
from pounding_cli.study.text.edit import with_values
from pounding_cli.study.text.file import Items, Map, Mark, Problems, canonical, get, nearest, parse_value, with_value
from pounding_cli.study.vary.axes import sweep_maps
from pounding_cli.study.vary.dotted_keys import describe_missing_entry, describe_wrong_step, find_whole_key
from pounding_cli.texts import escape_controls

KeySteps = tuple[str, ...]

MAX_LABEL = 80
"""Characters of an argument in messages."""

MAX_NAME = 80
"""Characters of the changes in the name of a file."""

_DOTTED_SECTIONS = (("sweep",), ("uncertain",), ("optimise", "over"), ("keep", "histories", "where"))
"""Mappings whose keys are themselves dotted keys of the study."""

_EXAMPLE = "cases.near.gap='5 cm'"
_NUMBER_IN_NAME = re.compile(r"[-+]?[0-9][0-9.]*([eE][-+]?[0-9]+)?( [A-Za-z0-9]+)?\Z")
_WORD_IN_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_.+-]*\Z")
_KEY_IN_NAME = re.compile(r"[A-Za-z0-9_.+-]+\Z")


@dataclass(frozen=True, eq=False)
class Change:
    """A new value of a key of a study.

    key : dotted, as a sweep has it
    value : as the tree of a file holds it; each part of it has a mark that names its source
    written : the value as YAML on one line
    mark : the source in messages, such as the argument of a command
    """

    key: str
    value: Any
    written: str
    mark: Mark


def parse_changes(arguments: Sequence[str]) -> tuple[Change, ...]:
    """Return the changes that arguments of a command make.

    Raises
    ------
    InputError : an argument is not KEY=VALUE, or its value is not YAML
    """
    changes: list[Change] = []
    for argument in arguments:
        key, equals, written = argument.partition("=")
        if not (key.strip() and equals):
            raise InputError(_refuse_form(argument, changes))
        key = key.strip()
        written = written.strip()
        label = _format_label(key, written)
        if not written:
            hint = f"write the value behind the =, e.g. `{_EXAMPLE}`; `null` stands for no value"
            raise InputError(Issue((), "has no value", hint, file=label))
        value = parse_value(written, label)
        changes.append(Change(key, _mark_parts(value, label), written, (label, 0)))
    return tuple(changes)


def _format_label(key: str, written: str) -> str:
    """Return an argument in messages, as a shell takes it."""
    label = f"argument {key}={shlex.quote(written) if written else ''}"
    label = escape_controls(" ".join(label.split()))
    return label if len(label) <= MAX_LABEL else f"{label[: MAX_LABEL - 3]}..."


def _refuse_form(argument: str, before: Sequence[Change]) -> Issue:
    """Return what is wrong with an argument that is not KEY=VALUE.

    before : changes by the arguments before it
    """
    label = f"argument {escape_controls(argument)[:MAX_LABEL]}"
    if argument.endswith((".yaml", ".yml")):
        return Issue((), "is a second study", "give one study, and behind it KEY=VALUE", file=label)
    if before and "=" not in argument:
        last = before[-1]
        whole = shlex.quote(f"{last.written} {argument}")
        hint = f"put quotes around a value with blanks: `{last.key}={whole}`"
    else:
        hint = f"write the key, =, and the value in quotes, without blanks around the =, e.g. `{_EXAMPLE}`"
    return Issue((), "is not KEY=VALUE", hint, file=label)


def _mark_parts(value: Any, label: str) -> Any:
    """Return the tree of a value in which every part has a mark of its own that names the source."""
    count = 0

    def next_mark() -> Mark:
        nonlocal count
        count += 1
        return label, count

    def mark_node(node: Any) -> Any:
        if isinstance(node, Map):
            marks = {key: (next_mark(), next_mark()) for key in node}
            return Map({key: mark_node(item) for key, item in node.items()}, next_mark(), marks)
        if isinstance(node, Items):
            return Items(map(mark_node, node), next_mark(), [next_mark() for _ in node])
        return node

    return mark_node(value)


def apply_changes(
    text: str, tree: Map, changes: Sequence[Change], file: str, model: type[BaseModel]
) -> tuple[str, Map]:
    """Return the text and the tree of a study with the changes in them; the text keeps its comments.

    text, tree : of the study as it is written
    model : of the study

    Raises
    ------
    InputError : a key that leads nowhere, two changes of one value, a change of a key that the sweep sets
    """
    problems = Problems(file)
    paths: dict[KeySteps, Change] = {}
    for change in changes:
        path = find_path(tree, change.key)
        wrong = _find_wrong_step(path, tree, model)
        first = _find_overlap(path, paths)
        if wrong is not None:
            problems.add(change.mark, *wrong)
        elif first is not None:
            message = f"changes what {first.mark[0]} changes too"
            problems.add(change.mark, message, "write one of the two")
        else:
            paths[path] = change
    problems.check()
    for path, change in paths.items():
        tree = with_value(tree, path, change.value, change.mark)
    for path, change in paths.items():
        for key in _iter_sweeps_of(path, tree):
            message = f"the sweep gives '{key}' its values, so that this one has no effect"
            value = shlex.quote(f"[{change.written}]")
            problems.add(change.mark, message, f"for this value alone write `sweep.{key}={value}`")
    problems.check()
    values = {path: change.value for path, change in paths.items()}
    written = {path: change.written for path, change in paths.items()}
    return with_values(text, values, file, written), tree


def find_path(tree: Map, key: str) -> KeySteps:
    """Return the steps from the top of a study to the value of a dotted key, which need not stand there.

    Keys below `sweep` and its like are dotted themselves: `sweep.cases.near.gap` has two steps. In a list of such
    mappings the number of the entry may be left out where one of them has the key.
    """
    steps = [canonical(step) for step in key.split(".")]
    path: list[str] = []
    while steps:
        node = get(tree, *path)
        if isinstance(node, Items) and tuple(path) in _DOTTED_SECTIONS and not steps[0].isdigit():
            entry = next((number for number, each in enumerate(node) if _count_steps(each, steps)), None)
            if entry is not None:
                path.append(str(entry))
                node = node[entry]
        count = _count_steps(node, steps)
        if not count:
            is_dotted = _is_dotted(path) and not isinstance(node, Items)
            count = len(steps) if is_dotted else 1
        path.append(".".join(steps[:count]))
        del steps[:count]
    return tuple(path)


def _count_steps(node: Any, steps: Sequence[str]) -> int:
    """Return how many of some steps make the longest key that a mapping has; 0 where it has none."""
    counts = range(len(steps), 0, -1)
    return next((count for count in counts if isinstance(node, Map) and ".".join(steps[:count]) in node), 0)


def _is_dotted(path: Sequence[str]) -> bool:
    """Return whether the keys below a path are dotted themselves."""
    section = tuple(path[:-1] if path and path[-1].isdigit() else path)
    return section in _DOTTED_SECTIONS


def _find_wrong_step(path: KeySteps, tree: Map, model: type[BaseModel]) -> tuple[str, str] | None:
    """Return message and hint of a path that leads nowhere; None where a value may stand.

    A last step that nobody knows is left to the validation of the study.
    """
    is_study = issubclass(model, schema.StudySpec)
    base = schema.StudySpec if is_study else model
    for place, step in enumerate(path):
        above = get(tree, *path[:place])
        if isinstance(above, Items):
            if step not in map(str, range(len(above))):
                message, hint = describe_missing_entry(path, place, above)
                return message, f"{hint}; or write the whole list"
            continue
        if isinstance(above, Map) and step in above:
            continue
        known = keys_at(model, path[:place], tree)
        is_mapping = above is None or isinstance(above, Map)
        is_last = place == len(path) - 1
        if is_mapping and (is_last or step in known or _is_dotted(path[:place])):
            whole_key = find_whole_key(path, tree) if is_study and place == 0 and step not in known else ""
            if whole_key:
                return f"no key '{step}'", f"write the whole key, `{whole_key}`"
            continue
        if is_mapping and place:
            section = ".".join(path[:place])
            message = f"no key '{step}' under '{section}'"
            if step.isdigit() and not known:
                return message, f"a list is written whole where the file has none: `{section}='[...]'`"
            return message, f"{nearest(step, known)}; a new one is written whole: `{section}.{step}='{{...}}'`"
        if step in known:
            section = ".".join(path[:place])
            whole = " ".join(f"{{{each}:" for each in path[place:]) + " ..." + "}" * len(path[place:])
            return f"'{section}' is {quote(above)}, which has no keys", f"write it whole: `{section}='{whole}'`"
        return describe_wrong_step(path, place, above, known, tree, base)
    return None


def _find_overlap(path: KeySteps, paths: dict[KeySteps, Change]) -> Change | None:
    """Return the change, among those before, of a value of which this one is a part, or the other way round."""
    for other, change in paths.items():
        shared = min(len(path), len(other))
        if path[:shared] == other[:shared]:
            return change
    return None


def _iter_sweeps_of(path: KeySteps, tree: Map) -> Iterator[str]:
    """Yield the keys of the sweep that set the value at a path, or one that it is a part of."""
    key = ".".join(path)
    for holder in sweep_maps(tree):
        yield from (swept for swept in holder if key == swept or key.startswith(f"{swept}."))


def name_changes(changes: Sequence[Change]) -> str:
    """Return changes as a part of a file's name; "" of none.

    The same for every order of them, and different for different values: where the name is long, or a value has
    other characters than a number with its unit or a word, it ends in a part of their SHA-256.
    """
    pairs = sorted((change.key, " ".join(change.written.split())) for change in changes)
    is_plain = all(
        _KEY_IN_NAME.match(key) and (_NUMBER_IN_NAME.match(value) or _WORD_IN_NAME.match(value)) for key, value in pairs
    )
    texts = [re.sub(r"[^A-Za-z0-9_.+=-]+", "-", f"{key}={value}").strip("-") for key, value in pairs]
    name = ",".join(texts)
    if is_plain and len(name) <= MAX_NAME:
        return name
    digest = hashlib.sha256(repr(pairs).encode()).hexdigest()[:8]
    return f"{name[: MAX_NAME - 9].rstrip('.,=-')}-{digest}"
