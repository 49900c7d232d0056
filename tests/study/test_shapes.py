"""A mapping, a list or a truth value in place of what a key takes, at every key of every section."""

from __future__ import annotations

import functools
import typing
from collections.abc import Callable, Iterator
from typing import Any, get_args, get_origin

import pytest
from pydantic import BaseModel

from pounding_cli.questions import study_model
from pounding_cli.study.construct.validate import place_issues
from pounding_cli.study.construct.written import read_specs
from pounding_cli.study.schema.links import link_models
from pounding_cli.study.schema.lookup import fields_of, leaf_types
from pounding_cli.study.schema.records import CODE_TARGETS
from pounding_cli.study.text.file import Items, Map, Problems, dump_yaml, locate, parse
from pounding_cli.study.text.issues import Issues

SHAPES: dict[str, tuple[Any, tuple[str, ...]]] = {
    "mapping": ({"nonsense": ["1 %", "2 %"]}, ("nonsense",)),
    "list": ([["1 %", ["2 %"]]], ("the list [", "a list of links", "'1 %'")),
    "truth": (True, ("true",)),
}
"""What is written, and how a message may name it."""

ELSEWHERE = {"sweep", "uncertain", "optimise.over", "keep.histories.where"}
"""Keys that are looked at with the rest of the study: rows of `refusals.yaml` have them."""

OTHER_WORDS = {"records.scale.target.code"}
"""Keys that their refusal names in other words."""

BASE = {
    "records": {"use": ["elcentro"]},
    "buildings": {"stiff": {"storeys": 2, "period": "0.4 s"}, "soft": {"like": "stiff", "period": "0.6 s"}},
    "group": ["stiff", "soft"],
    "cases": {"near": {"link": "pounding", "gap": "5 cm"}},
}
Write = Callable[[Any], Any]
"""Makes what stands under the top of a study, from the value of one key."""

TELLING = {model: {"link": name} for name, model in link_models().items()}
TELLING |= {model: {"code": name} for name, model in CODE_TARGETS.items()}
"""Keys that tell a mapping from the others of its place."""


def iter_keys(kind: Any, write: Write, path: tuple[Any, ...] = (), above: tuple[Any, ...] = ()) -> Iterator[Any]:
    """Yield of every key below a type the path, its mapping, what writes a study with a value there, and whether it may
    be true or false."""
    if isinstance(kind, type) and issubclass(kind, BaseModel) and kind not in above:
        fields = fields_of(kind)
        required = {name: find_example(hint, info) for name, (hint, info) in fields.items() if info.is_required()}
        beside = (required if above else {}) | TELLING.get(kind, {})
        for name, (hint, _) in fields.items():
            below = lambda value, name=name, beside=beside: write({**beside, name: value})  # noqa: E731
            is_truth = any(leaf is bool for leaf in leaf_types(hint))
            yield (*path, name), kind, below, is_truth
            for leaf in leaf_types(hint):
                yield from iter_keys(leaf, below, (*path, name), (*above, kind))
    elif get_origin(kind) is tuple:
        for leaf in leaf_types(get_args(kind)[0]):
            yield from iter_keys(leaf, lambda value: write([value]), (*path, 0), above)
    elif get_origin(kind) is dict:
        for leaf in leaf_types(get_args(kind)[1]):
            yield from iter_keys(leaf, lambda value: write({"one": value}), (*path, "one"), above)


def find_example(hint: Any, info: Any) -> Any:
    """Return a sound value of a key."""
    leaf = next(iter(leaf_types(hint)))
    if info.examples:
        return info.examples[0]
    if get_origin(leaf) is typing.Literal:
        return get_args(leaf)[0]
    examples = (getattr(leaf, "example", None), *getattr(leaf, "examples", ()))
    return next((each for each in examples if each), 2)


ALL_KEYS = [*iter_keys(study_model(), lambda value: value)]
KEYS = {(kind, path[-1]): (path, write, is_truth) for path, kind, write, is_truth in reversed(ALL_KEYS)}
SECTIONS = sorted({path[0] for path, _, _ in KEYS.values()})


def list_marks(node: Any) -> Iterator[Any]:
    """Yield where the keys and values of a part of a study begin."""
    if isinstance(node, Map):
        for key, marks in node.marks.items():
            yield from (*marks, *list_marks(node[key]))
    elif isinstance(node, Items):
        for mark, item in zip(node.marks, node, strict=True):
            yield from (mark, *list_marks(item))


def find_fault(path: tuple[Any, ...], write: Write, shape: str) -> str:
    """Return what is wrong with the answer to a shape at a key; "" where nothing is."""
    value, words = SHAPES[shape]
    section = path[0]
    written = write(value)[section]
    is_entry = section in ("buildings", "cases") and len(path) > 1
    tree = parse(dump_yaml({**BASE, section: {**BASE[section], **written} if is_entry else written}, flow=False), "")
    problems = Problems("")
    issues = Issues()
    read_specs(tree, issues, study_model())
    place_issues(issues, tree, (), problems)
    node = functools.reduce(lambda above, step: above[step], path, tree)
    places = {locate(tree, path), locate(tree, path, key=True), *list_marks(node)}
    here = [each for each in problems.found if (each.line, each.column) in places]
    said = " | ".join(each.message for each in here)
    names = (*[str(step) for step in path if step not in (0, "one")][-2:], "nonsense")
    if not here:
        return f"is taken, or refused elsewhere: {[each.message for each in problems.found]}"
    if not all(each.hint for each in here):
        return f"has no advice: {said}"
    if not any(word in said for word in words):
        return f"does not tell what stands there: {said}"
    is_named = any(name in said for name in names) or _name(path) in OTHER_WORDS
    return "" if is_named else f"names no key: {said}"


def _name(path: tuple[Any, ...]) -> str:
    return ".".join(str(step) for step in path if step not in (0, "one"))


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("section", SECTIONS)
def test_what_stands_there_and_what_belongs_there_is_told(section, shape):
    """Fails if a key takes another shape in silence, or its refusal has no place, no name, no value or no advice."""
    faults = []
    for path, write, is_truth in KEYS.values():
        is_taken = _name(path) in ELSEWHERE or (shape == "truth" and is_truth)
        if path[0] == section and not is_taken:
            fault = find_fault(path, write, shape)
            faults += [f"{_name(path)} {fault}"] if fault else []
    assert faults == []
