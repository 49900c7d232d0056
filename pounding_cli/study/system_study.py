"""Studies of systems that are no row of buildings (the closed form, the wall): one reader for all of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from pydantic import BaseModel, ValidationError

from pounding_cli.errors import Problem
from pounding_cli.study.kinds import refuse_other_kinds
from pounding_cli.study.plausible import few
from pounding_cli.study.points import PointAxis, point_label, points_of, read_point_axes
from pounding_cli.study.problems import Problems
from pounding_cli.study.source import Node
from pounding_cli.study.yaml_file import read_source

M = TypeVar("M")


@dataclass(frozen=True)
class Point(Generic[M]):
    """One point of the sweep: its indices, what each swept key is there (SI), the same in words, and the model."""

    index: tuple[int, ...]
    values: dict[str, float | str]
    label: str
    model: M


@dataclass(frozen=True)
class SystemStudy(Generic[M]):
    """A validated study.

    axes, points : of the sweep, the last axis fastest
    spec : its keys at the first point, as validated; resolved : the same as plain data
    """

    path: Path
    text: str
    title: str
    axes: tuple[PointAxis, ...]
    points: tuple[Point[M], ...]
    spec: Any
    resolved: dict[str, Any]
    warnings: tuple[Problem, ...] = ()


def load_system(
    path: Path,
    kind: str,
    model: type[BaseModel],
    build: Callable[[Any, Node, str, Problems], M | None],
    doubt: Callable[[Any, M, Node, Problems], None],
    fixed: tuple[str, ...] = (),
) -> SystemStudy[M]:
    """Read and validate a study.

    Parameters
    ----------
    kind : its command
    model : of its file
    build : (validated keys, their tree, the point in words, problems) -> its model; None where problems tell why not
    doubt : (validated keys, model, tree, notes) notes what is unlikely
    fixed : sections that no axis may touch

    Raises
    ------
    InputError : every problem with its place
    """
    text, root = read_source(path)
    refuse_other_kinds(root, str(path), kind)
    problems, notes = Problems(str(path)), Problems(str(path))
    axes = read_point_axes(root, model, problems)
    for name in (name for axis in axes for name in axis.names if name.split(".")[0] in fixed):
        hint = "give one range for the study"
        problems.at(root, ("sweep", name), f"'{name}' cannot be an axis", hint, key=True)
    problems.refuse()
    points: list[Point[M]] = []
    first: Any = None
    for index, tree in points_of(root, axes):
        try:
            spec = model.model_validate(tree.plain())
        except ValidationError as error:
            problems.validation(tree, error, model)
            continue
        first = first or spec
        values = {name: _value(spec, name, tree) for axis in axes for name in axis.names}
        label = point_label(axes, values)
        own = Problems(str(path))
        built = build(spec, tree, f" ({label})" if label else "", own)
        problems.extend(own.found)
        if built is not None:
            points.append(Point(index, values, label, built))
            doubt(spec, built, tree, notes)
    problems.refuse()
    return SystemStudy(
        path, text, first.title, axes, tuple(points), first, first.model_dump(mode="json"), tuple(few(notes.found))
    )


def _value(spec: Any, name: str, tree: Node) -> float | str:
    """A swept key at a point: a number (SI), or as it is written."""
    value = spec
    for step in name.split("."):
        value = getattr(value, step)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    node = tree.get(*name.split("."))
    return node.text if node is not None and node.text else str(value)
