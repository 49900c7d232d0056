"""`bracket:`: an unknown value, low, in the middle and high. It becomes an axis of the sweep."""

from __future__ import annotations

from typing import Any

from pydantic_core import PydanticCustomError

from pounding_cli.study.case_schema import Impact
from pounding_cli.study.problems import Problems, keys_at
from pounding_cli.study.rules import StiffnessRule, read_stiffness
from pounding_cli.study.schema import StudyModel
from pounding_cli.study.source import Node

UNKNOWN = "impact.stiffness"
"""The key that can be bracketed by its name alone: no test gives the stiffness of floors that strike."""

SHARES = (0.25, 1.0, 5.0)
"""Its bracket then, times the study's own value: 5, 20 and 100 x stiffest storey of the default."""


def with_brackets(root: Node, problems: Problems) -> Node:
    """The study's tree with its brackets carried out: axes added to `sweep`, their middle values put where the keys
    stand, `bracket` the list of its keys."""
    given = root.get("bracket")
    if given is None or given.value is None:
        return root
    node = _of_word(given, root, problems) if isinstance(given.value, str) else given
    if node is None:
        return root
    if not node.is_mapping:
        problems.add(node.mark, "'bracket' is neither a key nor a mapping", f"write `bracket: {UNKNOWN}`")
        return root
    for key, values in node.value.items():
        mark = (node.keys or {})[key]
        if not values.is_list or len(values.value) < 3 or len(values.value) % 2 == 0:
            hint = f"write low, middle and high, e.g. `{key}: [low, middle, high]`"
            problems.add(values.mark, f"the bracket of '{key}' takes an odd number of values, three at least", hint)
            continue
        values = Node([_plain(value) for value in values.value], values.mark, values.text)
        middle = values.value[len(values.value) // 2]
        own = root.get(*key.split("."))
        if own is not None and _plain(own).text != middle.text and own.plain() != middle.plain():
            problems.add(
                own.mark,
                f"'{key}' is {own.text} here and {middle.text} in the middle of its bracket",
                "leave it to the bracket, or write it in the middle",
            )
            continue
        axes = root.get("sweep")
        if axes is None or axes.value is None:
            axes = Node({}, mark, keys={})
        if axes.is_list:
            added = Node([*axes.value, Node({key: values}, mark, keys={key: mark})], axes.mark)
        elif axes.is_mapping and key not in axes.value:
            added = Node({**axes.value, key: values}, axes.mark, keys={**(axes.keys or {}), key: mark})
        else:
            problems.add(mark, f"'{key}' is swept and bracketed", "remove one of the two")
            continue
        root = root.replaced(("sweep",), added)
        path = tuple(key.split("."))
        if path[-1] in keys_at(StudyModel, path[:-1], root):  # else the axis says what is wrong with the key
            root = root.replaced(path, middle)
    names = Node([Node(key, mark, key) for key, mark in (node.keys or {}).items()], node.mark)
    return root.replaced(("bracket",), names)


def _of_word(word: Node, root: Node, problems: Problems) -> Node | None:
    """The mapping that a key alone stands for."""
    if word.value != UNKNOWN:
        example = f"`bracket: {{{word.value}: [low, middle, high]}}`"
        problems.add(word.mark, f"'{word.value}' alone says no values", f"write {UNKNOWN}, or {example}")
        return None
    own = root.get(*UNKNOWN.split("."))
    try:
        value = Impact().stiffness if own is None else read_stiffness(own.plain())
        if isinstance(value, str):
            value = read_stiffness(value)
    except PydanticCustomError:
        return None  # said where the stiffness is read
    values = [Node(each, word.mark, str(each)) for each in (_times(value, share) for share in SHARES)]
    if own is not None:
        values[1] = Node(own.value, word.mark, own.text)
    return Node({UNKNOWN: Node(values, word.mark)}, word.mark, keys={UNKNOWN: word.mark})


def _times(value: float | StiffnessRule, share: float) -> float | str:
    if isinstance(value, StiffnessRule):
        return str(StiffnessRule(value.factor * share, value.which, value.building))
    return value * share


def _plain(node: Node) -> Node:
    """A value with rules of stiffness spelt in one way, so that the middle one is known again."""
    if not isinstance(node.value, str):
        return node
    try:
        rule: Any = read_stiffness(node.value)
    except PydanticCustomError:
        return node
    return Node(str(rule), node.mark, str(rule)) if isinstance(rule, StiffnessRule) else node
