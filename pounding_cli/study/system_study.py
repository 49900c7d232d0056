"""Studies of systems that are no row of buildings (the closed form, the wall): one reader for all of them, and their
sweep as a plan of points."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any, ClassVar, cast

import numpy as np
from pydantic import ValidationError

from pounding_cli.digests import DigestTable, packed
from pounding_cli.errors import Problem
from pounding_cli.study.axes import SweepAxis, read_axes
from pounding_cli.study.base import Model
from pounding_cli.study.file import Map, Problems, get, put, read_study
from pounding_cli.study.kinds import refuse_other_kinds
from pounding_cli.study.plan import Axis, Plan
from pounding_cli.study.plausible import few
from pounding_cli.study.scenes import Expanded, Frame, LinkSets, Rows
from pounding_cli.workflows import WORKFLOWS


class SystemModel(Model):
    """The keys of a study of a system: what a workflow with a model of its own names as its `schema`.

    fixed : sections that no axis may touch
    """

    fixed: ClassVar[tuple[str, ...]] = ()

    def system(self, tree: Map, where: str, problems: Problems) -> Any:
        """The model at a point of the sweep: frozen, its `repr` tells it from others; None where `problems` tell why
        not.

        tree : the keys with their places; where : the point in words, to end messages with
        """
        raise NotImplementedError

    def doubt(self, model: Any, tree: Map, notes: Problems) -> None:
        """Note what is unlikely at a point of the sweep."""
        raise NotImplementedError


@dataclass(frozen=True)
class Point:
    """One point of the sweep: its indices, what each swept key is there (SI), and the model."""

    index: tuple[int, ...]
    values: dict[str, float | str]
    model: Any


@dataclass(frozen=True)
class SystemStudy:
    """A validated study.

    kind : its workflow
    axes, points : of the sweep, the last axis fastest
    spec : its keys at the first point, as validated
    """

    path: Path
    text: str
    kind: str
    axes: tuple[SweepAxis, ...]
    points: tuple[Point, ...]
    spec: Any
    warnings: tuple[Problem, ...] = ()

    @property
    def title(self) -> str:
        """Its title."""
        return self.spec.title

    def resolved(self) -> dict[str, Any]:
        """Its keys at the first point as plain data, every default filled in (SI)."""
        return self.spec.model_dump(mode="json")


def load_system(path: Path, kind: str) -> SystemStudy:
    """Read and validate a study of the workflow `kind`.

    Raises
    ------
    InputError : every problem with its place
    """
    model: type[SystemModel] = WORKFLOWS[kind].part("schema")
    text, root = read_study(path)
    refuse_other_kinds(root, str(path), kind)
    problems, notes = Problems(str(path)), Problems(str(path))
    axes = read_axes(root, problems, model)
    for name in (name for axis in axes for name in axis.names if name.split(".")[0] in model.fixed):
        hint = "give one range for the study"
        problems.at(root, ("sweep", name), f"'{name}' cannot be an axis", hint, key=True)
    problems.check()
    points: list[Point] = []
    first: Any = None
    for index, tree in _points(root, axes):
        try:
            spec = model.model_validate(tree)
        except ValidationError as error:
            problems.validation(tree, error, (), model)
            continue
        first = first or spec
        values = {name: _value(spec, name, tree) for axis in axes for name in axis.names}
        label = _label(axes, values)
        own = Problems(str(path))
        built = spec.system(tree, f" ({label})" if label else "", own)
        problems.extend(own.found)
        if built is not None:
            points.append(Point(index, values, built))
            spec.doubt(built, tree, notes)
    problems.check()
    return SystemStudy(path, text, kind, axes, tuple(points), first, tuple(few(notes.found)))


def expand_system(study: SystemStudy) -> Plan:
    """The points of a study as a plan: a scene each, equal models being one."""
    digests = [hashlib.sha256(repr(point.model).encode()).hexdigest() for point in study.points]
    scenes = dict(zip(digests, (point.model for point in study.points), strict=True))
    number, sets = {digest: place for place, digest in enumerate(scenes)}, LinkSets()
    frame = Frame((*(len(axis) for axis in study.axes), 1, 1, 1), ("points",), ("",), ("",))
    places = np.array([[number[digest]] for digest in digests], np.int32)
    table, first = DigestTable(packed(list(scenes))), np.unique(places, return_index=True)[1]
    rows = Rows(frame, Expanded(table, places, first, np.full(len(digests), sets.number(())), sets))
    axes = []
    for place, axis in enumerate(study.axes):
        along = {point.index[place]: point.values for point in study.points}
        values = tuple(tuple(along[number][name] for name in axis.names) for number in sorted(along))
        axes.append(Axis(axis.names, values, axis.units))
    names = frame.cases, frame.analyses, frame.records
    return Plan(cast(Any, study), tuple(axes), *names, (), scenes, rows, (), math.nan, "", workflow=study.kind)


def _points(root: Map, axes: tuple[SweepAxis, ...]) -> Iterator[tuple[tuple[int, ...], Map]]:
    """Every point's indices and the study's tree with its values put in, the last axis fastest."""
    for index in product(*(range(len(axis)) for axis in axes)):
        tree = root
        for axis, place in zip(axes, index, strict=True):
            for path, value, mark in zip(axis.paths, axis.given[place], axis.marks[place], strict=True):
                tree = put(tree, path, value, mark)
        yield index, tree


def _label(axes: tuple[SweepAxis, ...], values: Mapping[str, float | str]) -> str:
    """The swept values of a point in the units of the study: "mesh.size = 5 cm"; empty where nothing is swept."""
    units = {name: unit for axis in axes for name, unit in zip(axis.names, axis.units, strict=True)}
    return ", ".join(f"{name} = {units[name].text(value)}" for name, value in values.items())


def _value(spec: Any, name: str, tree: Map) -> float | str:
    """A swept key at a point: a number (SI), or as it is written."""
    value = spec
    for step in name.split("."):
        value = getattr(value, step)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    written = get(tree, *name.split("."))
    return str(value if written is None else written)
