"""Dotted keys of a study: whether they lead to a value that may vary, and what is wrong with those that do not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel

from pounding_cli.study.schema import study as schema
from pounding_cli.study.schema.lookup import keys_at, names_in
from pounding_cli.study.schema.quantity import written_unit
from pounding_cli.study.text.file import Map, Mark, Problems, get, nearest


def can_vary(
    name: str,
    mark: Mark,
    root: Map,
    problems: Problems,
    what: str = "sweep axis",
    model: type[BaseModel] = schema.StudySpec,
) -> bool:
    """Return whether a dotted key can differ from point to point; note why it cannot.

    what : the key in words
    """
    path = name.split(".")
    if _is_fixed(path, root, model):
        _refuse_fixed(name, mark, root, problems, what, model)
        return False
    for place, step in enumerate(path):
        above = get(root, *path[:place])
        known = keys_at(model, path[:place], root)
        is_item = isinstance(above, list) and step.isdigit() and int(step) < len(above)
        is_key = step in known and (above is None or isinstance(above, dict))
        if not is_item and not is_key:
            message, hint = describe_wrong_step(path, place, above, known, root, model)
            problems.add(mark, f"{what} '{name}': {message}", hint)
            return False
    if _is_section(path, root, model):
        example = _value_in_section(path, root, model)
        problems.add(mark, f"{what} '{name}' is a whole section", f"name one value in it, e.g. `{example}`")
        return False
    return True


def _is_fixed(path: Sequence[str], root: Map, model: type[BaseModel]) -> bool:
    """Return whether a key has one value for all points."""
    if model is not schema.StudySpec:
        return path[0] in {"title", "sweep"}
    is_of_question = path[0] in root and path[0] not in schema.StudySpec.model_fields
    return is_of_question or path[0] in schema.ONCE or path[:2] == ["records", "use"] or path[-1] == "like"


def _refuse_fixed(name: str, mark: Mark, root: Map, problems: Problems, what: str, model: type[BaseModel]) -> None:
    """Note a key that has one value for all points, with the key that is meant instead where there is one."""
    path = name.split(".")
    may_be_short = model is schema.StudySpec and path[-1] != "like" and "sweep" not in path
    whole_key = find_whole_key(path, root) if may_be_short else ""
    hint = f"write the whole key, `{whole_key}`" if whole_key else "run one study for each value"
    problems.add(mark, f"{what} '{name}' cannot vary: it is one for the whole study", hint)


def _is_section(path: Sequence[str], root: Map, model: type[BaseModel]) -> bool:
    """Return whether a path leads to a section that no single value can stand for."""
    if model is schema.StudySpec:
        least_depth = {"buildings": 3, "cases": 3, "laws": 3, "tail": 1}.get(path[0], 2)
        return len(path) < least_depth
    return bool(keys_at(model, path, root))


def describe_wrong_step(
    path: Sequence[str], place: int, above: Any, known: list[str], root: Map, model: type[BaseModel]
) -> tuple[str, str]:
    """Return what is wrong with a dotted key whose step at `place` leads nowhere, and what to write.

    above : what stands in the file above that step
    known : keys that may stand there
    """
    step = path[place]
    before = ".".join(path[:place])

    def find_allowed(*keys: str) -> list[str]:
        return [key for key in keys if can_vary(key, root.mark, root, Problems(""), model=model)]

    if isinstance(above, list):
        return describe_missing_entry(path, place, above)
    message = f"no key '{step}'{f' under {before!r}' if before else ''}"
    if place == 0:
        whole_key = find_whole_key(path, root) if model is schema.StudySpec else ""
        return message, f"write the whole key, `{whole_key}`" if whole_key else nearest(step, known)
    if step in known:
        return message, f"give '{before}' as a mapping with '{step}' in it"
    if path[0] == "cases" and path[2:3] == ["links"] and above is None:
        of_one_link = ".".join((*path[:2], *path[4:]))
        if find_allowed(of_one_link):
            return message, f"this case has one link: write `{of_one_link}`"
    if above is None or isinstance(above, dict):
        return message, nearest(step, known)
    owner = ""
    if place > 2 and path[0] in ("buildings", "cases"):
        owner = f" of {path[0].removesuffix('s')} '{path[1]}'"
    kind = "a number" if isinstance(above, int | float) or written_unit(above) else "a word"
    message = f"'{path[place - 1]}'{owner} is {kind}, {above}"
    without_step_above = ".".join((*path[: place - 1], *path[place:]))
    allowed = find_allowed(without_step_above, before)
    return message, f"write {' or '.join(f'`{key}`' for key in allowed)}" if allowed else nearest(step, known)


def describe_missing_entry(path: Sequence[str], place: int, entries: Sequence[Any]) -> tuple[str, str]:
    """Return what is wrong with a dotted key whose step at `place` is no entry of a list, and what to write."""
    message = f"no entry '{path[place]}' in the list '{'.'.join(path[:place])}'"
    return message, f"{nearest(path[place], map(str, range(len(entries))))} (entries count from 0)"


def find_whole_key(path: Sequence[str], root: Map) -> str:
    """Return the dotted key of the study that the end of one stands for, `buildings.B.period` for `B.period`; "" where
    there is none."""
    sections: list[tuple[str, ...]] = [("buildings",), ("cases",), ("laws",)]
    sections += [("buildings", name) for name in names_in(root, "buildings")]
    sections.append(("impact",))
    sections += [("cases", name) for name in names_in(root, "cases")]
    sections += [("records",), ("records", "scale")]
    sections += [("laws", name, "parameters") for name in names_in(root, "laws")]
    paths = [[*section, *path] for section in sections]
    keys = [".".join(whole) for whole in paths if _is_known(whole, root)]
    for key in keys:
        if can_vary(key, root.mark, root, Problems("")):
            return key
    return keys[0] if keys else ""


def _is_known(path: list[str], root: Map) -> bool:
    """Return whether the schema knows a value at a path, whatever the file has there."""
    if _is_section(path, root, schema.StudySpec):
        return False
    for place, step in enumerate(path):
        above = get(root, *path[:place])
        is_item = isinstance(above, list) and step.isdigit() and int(step) < len(above)
        if not is_item and step not in keys_at(schema.StudySpec, path[:place], root):
            return False
    return True


_LIKELY = ("period", "gap", "stiffness", "scale", "restitution", "force")
"""Keys that a sweep is likely to be of."""


def _value_in_section(path: Sequence[str], root: Map, model: type[BaseModel]) -> str:
    """Return the dotted key of a value below a section, one that is likely to vary."""
    steps = [*path]
    while _is_section(steps, root, model):
        below = keys_at(model, steps, root)
        if not below:
            return ".".join((*steps, "KEY"))
        above = get(root, *steps)
        written = [key for key in below if isinstance(above, dict) and key in above]
        steps.append(next((key for key in _LIKELY if key in below), (written or below)[0]))
    return ".".join(steps)
