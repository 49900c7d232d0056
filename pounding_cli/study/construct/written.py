"""Validate a study as it is written, section by section, so that what is wrong in several of them is told at once."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from typing import Any

from pydantic import TypeAdapter, ValidationError

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.study.schema.archetypes import fill_archetype
from pounding_cli.study.schema.building import BuildingSpec
from pounding_cli.study.schema.like import resolve_like
from pounding_cli.study.schema.lookup import MAX_DESCRIBED, describe_error, describe_errors
from pounding_cli.study.schema.study import ENTRIES, StudySpec
from pounding_cli.study.text.file import Map
from pounding_cli.study.text.issues import Issues

_adapter = functools.cache(TypeAdapter)  # building one takes longer than a validation


def read_specs(tree: Map, issues: Issues, model: type[StudySpec] = StudySpec) -> dict[KeyPath, Any]:
    """Return the validated sections of a study by path; None for those that are faulty.

    Buildings, cases and laws stand there one by one, `("buildings", "soft")`, other sections whole, `("impact",)`.
    What is wrong is noted.

    model : of the study, with the sections of questions
    """
    specs: dict[KeyPath, Any] = {}
    for name, field in model.model_fields.items():
        if name in ENTRIES:
            specs |= _read_entries(tree, name, field, issues)
        elif name in tree:
            specs[name,] = _read_noted(tree, (name,), field.rebuild_annotation(), issues, model)
        elif field.is_required():
            _note_missing(tree, name, issues)
            specs[name,] = None
        else:
            specs[name,] = field.get_default()
    unknown = [key for key in tree if key not in model.model_fields]
    for key in unknown[:MAX_DESCRIBED]:
        error = {"type": "extra_forbidden", "input": tree[key]}
        message, hint, at_key = describe_error(error, (key,), model, tree)
        issues.add_written([Issue((key,), message, hint, at_key=at_key)])
    if len(unknown) > MAX_DESCRIBED:
        message = f"and {len(unknown) - MAX_DESCRIBED} more problems like these"
        issues.add_written([Issue((unknown[MAX_DESCRIBED],), message, at_key=True)])
    return specs


def _read_entries(tree: Map, name: str, field: Any, issues: Issues) -> dict[KeyPath, Any]:
    """Return the validated entries of a section of entries by name."""
    if name not in tree:
        if field.is_required():
            _note_missing(tree, name, issues)
        return {}
    section_type, _ = ENTRIES[name]
    try:
        _adapter(section_type).validate_python(tree[name])
    except ValidationError as error:
        issues.add_written(describe_errors(error, (name,), StudySpec, tree))
        if any(each["type"] == "too_long" for each in error.errors(include_url=False)):
            return {}
    if not isinstance(tree[name], Map):
        return {}
    specs: dict[KeyPath, Any] = dict.fromkeys((name, entry) for entry in tree[name])
    parents: dict[str, Any] = {}
    for entry in tree[name]:
        path = (name, entry)
        try:
            specs[path] = read_spec(tree, path, parents)
        except InputError as refused:
            issues.add_written(refused.issues)
            if name == "buildings":
                issues.add_written(_find_orphan_issues(tree, entry, refused))
    return specs


def _note_missing(tree: Map, name: str, issues: Issues) -> None:
    message, hint, at_key = describe_error({"type": "missing"}, (name,), StudySpec, tree)
    issues.add_written([Issue((name,), message, hint, at_key=at_key)])


def _read_noted(tree: Map, path: KeyPath, kind: Any, issues: Issues, model: type[StudySpec]) -> Any:
    """Return a validated part of a study; None where it is faulty, which is noted."""
    try:
        return _validate(tree, path, kind, tree[str(path[0])], model)
    except InputError as refused:
        issues.add_written(refused.issues)
        return None


def read_spec(tree: Map, path: tuple[str, ...], parents: dict[str, Any] | None = None) -> Any:
    """Return a validated section, or an entry of one; `like:` and `archetype:` of a building are resolved.

    (`place_issues` resolves it again, to find lines.)

    parents : buildings that were resolved before, by name; those resolved now are added

    Raises
    ------
    InputError : it is faulty
    """
    if len(path) == 1:
        field = StudySpec.model_fields[path[0]]
        if path[0] not in tree:
            return field.get_default()
        return _validate(tree, path, field.rebuild_annotation(), tree[path[0]])
    section, name = path
    value = tree[section][name]
    if section == "buildings":
        value = fill_archetype(resolve_like(tree[section], name, parents), name)
    return _validate(tree, path, ENTRIES[section][1], value)


def _validate(tree: Map, path: KeyPath, kind: Any, value: Any, model: type[StudySpec] = StudySpec) -> Any:
    try:
        return _adapter(kind).validate_python(value)
    except ValidationError as error:
        raise InputError(describe_errors(error, path, model, _with_merged_building(tree, path, value))) from None


def _with_merged_building(tree: Map, path: KeyPath, value: Any) -> Map:
    """Return the tree with a building as it is validated, which messages look at."""
    if path[0] != "buildings" or len(path) < 2:
        return tree
    buildings = tree["buildings"]
    found = Map({**buildings, str(path[1]): value}, buildings.mark, buildings.marks)
    return Map({**tree, "buildings": found}, tree.mark, tree.marks)


def _find_orphan_issues(tree: Map, name: str, refused: InputError) -> list[Issue]:
    """Return what is wrong with the own keys of a building whose `like:` leads nowhere.

    What the building may inherit is not missed.
    """
    building = tree["buildings"][name]
    if not isinstance(building, Map) or not any(issue.path[-1:] == ("like",) for issue in iter_issues(refused)):
        return []
    orphan = Map({key: value for key, value in building.items() if key != "like"}, building.mark, building.marks)
    try:
        _validate(tree, ("buildings", name), BuildingSpec, orphan)
    except InputError as found:
        return [issue for issue in iter_issues(found) if any(not str(s).startswith("(") for s in issue.path[2:])]
    return []


def iter_issues(refused: InputError) -> Iterator[Issue]:
    """Yield the issues that stand in the study."""
    yield from (issue for issue in refused.issues if not issue.is_placed)


def build_study_spec(specs: dict[KeyPath, Any], issues: Issues, model: type[StudySpec]) -> StudySpec | None:
    """Return the study as written, validated; None where a section is faulty. What is wrong between keys is noted."""
    if any(specs.get((name,)) is None for name in ("method", "analyses")):
        return None
    sections: dict[str, Any] = {str(path[0]): spec for path, spec in specs.items() if len(path) == 1}
    for name in ENTRIES:
        sections[name] = {path[1]: spec for path, spec in specs.items() if path[0] == name}
    spec = model.model_construct(**sections)
    issues.add_written(spec.issues())
    return spec
