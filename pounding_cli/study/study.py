"""A validated study: its buildings, links and motions at any point of the sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from pounding_cli import records
from pounding_cli.errors import InputError, Issue
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.numbers import Unit
from pounding_cli.reading import shorten_path
from pounding_cli.records.motion import Motion
from pounding_cli.study.construct.buildings import find_separation
from pounding_cli.study.construct.group import Group, unique_names
from pounding_cli.study.construct.motions import MotionReader, MotionUse, Suite, read_suite
from pounding_cli.study.construct.resolve import StudyParts, changes_part, tree_at
from pounding_cli.study.construct.swept import Point, Swept, sweep_map
from pounding_cli.study.construct.validate import validate_tree
from pounding_cli.study.display import describe_study, find_unit
from pounding_cli.study.schema.records import SpectrumSpec
from pounding_cli.study.schema.study import StudySpec, find_section_names
from pounding_cli.study.text.file import Map, Problems
from pounding_cli.study.vary.axes import Axis, read_axes, with_middles
from pounding_cli.study.vary.both_sides import with_both_sides
from pounding_cli.study.vary.changes import Change

RESIDUAL_DRIFT = "residual_drift"
"""The key and the quantity of the drifts at rest."""


@dataclass(frozen=True, eq=False)
class Study:
    """A validated study: its buildings, links and motions at any point of the sweep.

    path : the file
    text : the file as written
    title : its title or its name
    tree : what the file holds, with the middle of every unknown value where its key stands
    axes : the axes of the sweep
    spec : the study as written, validated
    parts : its parts at the points of the sweep
    units_from : the file at the first point of the sweep, whose units people read
    warnings : what is allowed but should be known
    from_data : whether it is Python data; no file holds it
    reader : of its motions
    changes : values that it has in place of those of the file
    """

    path: Path
    text: str
    title: str
    tree: Map
    axes: tuple[Axis, ...]
    spec: StudySpec
    parts: StudyParts
    units_from: Map
    warnings: tuple[Issue, ...]
    from_data: bool
    reader: MotionReader
    changes: tuple[Change, ...] = ()

    @property
    def file(self) -> str:
        """The name of the file in messages."""
        return shorten_path(self.path)

    def section(self, name: str) -> Any:
        """Return the validated section of a question by its name."""
        return getattr(self.spec, name)

    @property
    def first_point(self) -> Point:
        """The first point of the sweep."""
        return (0,) * len(self.axes)

    @property
    def wants_residual_drift(self) -> bool:
        """True if the drifts at rest are asked for, by their key or by a question that names them."""
        return bool(self.spec.residual_drift) or any(
            _names_residual_drift(self.tree.get(name)) for name in find_section_names(type(self.spec))
        )

    @property
    def has_plans(self) -> bool:
        """True if a building of the group has a plan at some point of the sweep."""
        return any(
            spec.plan is not None
            for name in self.spec.group
            for _, spec in self.parts.building_specs[name].iter_values()
        )

    def with_axes(self, axes: Sequence[Axis], tree: Map | None = None) -> Study:
        """Return the study with other axes; title, units and warnings stay.

        tree : in place of what the file holds

        Raises
        ------
        InputError : the study is not sound at a point of them
        """
        tree = self.tree if tree is None else tree
        spec, parts = validate_tree(tree, tuple(axes), self.reader, self.file, type(self.spec))
        return replace(self, tree=tree, axes=tuple(axes), spec=spec, parts=parts)

    def with_tree(self, tree: Map) -> Study:
        """Return the study that another file in its place would hold; title, text, units and warnings stay.

        tree : what that file holds

        Raises
        ------
        InputError : it is not sound
        """
        problems = Problems(self.file)
        tree = with_middles(with_both_sides(tree, problems), problems)
        axes = read_axes(tree, problems)
        problems.check()
        return self.with_axes(axes, tree)

    def tree_at(self, point: Point) -> Map:
        """Return the file at a point of the sweep."""
        return tree_at(self.tree, self.axes, point)

    def group(self, point: Point) -> Group:
        """Return the buildings in their places at a point of the sweep."""
        return self.parts.group.value_at(point)

    def building(self, point: Point, place: int) -> Building:
        """Return the building type at a place of the group, from 0, at a point of the sweep."""
        return self.parts.types[self.spec.group[place]].value_at(point)

    def links(self, point: Point, case: str) -> tuple[Link, ...]:
        """Return the links of a case at a point of the sweep."""
        return self.parts.links[case].value_at(point)

    def motion_uses(self, point: Point) -> Mapping[str, MotionUse]:
        """Return the motions by name as they are used at a point of the sweep, without their samples."""
        return self.parts.suite.value_at(point).uses

    @cached_property
    def written_suite(self) -> Suite:
        """The motions with the values that the study writes for swept keys; where these are no sound choice, those of
        the first point."""
        if self.axes_changing("records"):
            try:
                return read_suite(self.spec.records, self.reader)
            except InputError:
                pass
        return self.parts.suite.value_at(self.first_point)

    def list_taken_files(self) -> list[tuple[str, ...]]:
        """Return, of every plain file of motions, the lines that say what was taken of it."""
        return list(dict.fromkeys(lines for _, suite in self.parts.suite.iter_values() for lines in suite.taken))

    def motion(self, point: Point, name: str) -> Motion:
        """Return a motion as it is used at a point of the sweep, cut and scaled."""
        return self.reader.used_motion(self.motion_uses(point)[name])

    def motions(self, point: Point) -> dict[str, Motion]:
        """Return all motions by name as they are used at a point of the sweep."""
        return {name: self.reader.used_motion(use) for name, use in self.motion_uses(point).items()}

    def axes_changing(self, *path: str) -> tuple[int, ...]:
        """Return the numbers of the axes that change a section of the file, or an entry of one."""
        return tuple(
            number
            for number, axis in enumerate(self.axes)
            if any(changes_part(key, path, self.tree) for key in axis.names)
        )

    def assumed_heights(self) -> tuple[str, ...]:
        """Return the buildings of the group, by place, whose storey heights the study leaves to their default."""
        specs = [self.parts.building_specs[name].value_at(self.first_point) for name in self.spec.group]
        return tuple(
            place
            for place, spec in zip(unique_names(self.spec.group), specs, strict=True)
            if not spec.wall and "height" not in spec.model_fields_set
        )

    def unit(self, quantity: str) -> Unit:
        """Return the unit the study writes a quantity in, to show it to people; one of DISPLAY_UNITS, e.g. gap."""
        return find_unit(self.units_from, quantity)

    def to_plain_data(self) -> dict[str, Any]:
        """Return the study as plain data: every default filled in, SI numbers, the sweep set aside."""
        return describe_study(self.spec, self.title, self.axes)

    def spectrum_match(self) -> records.SpectrumMatch | None:
        """Return the motions against the target spectrum that the study writes; None without one."""
        suite = self.written_suite
        scale = self.spec.records.scale
        if suite.target is None or not isinstance(scale, SpectrumSpec):
            return None
        motions = {name: self.reader.used_motion(use) for name, use in suite.uses.items()}
        return records.SpectrumMatch.of(motions, suite.target, scale.spectrum == "each", scale.at_least)

    def separations(self) -> Swept[np.ndarray]:
        """Return the code's separation of every building from the next one to the right [m], shape (buildings,).

        NaN for the last, and where the yield shears of a neighbour were not set by a code.
        """
        displacements = [self.parts.displacements(name) for name in self.spec.group]

        def separate(*allowed: Mapping[str, np.ndarray]) -> np.ndarray:
            return np.array([*(find_separation(left, right) for left, right in pairwise(allowed)), np.nan])

        return sweep_map(separate, *displacements)


def _names_residual_drift(node: Any) -> bool:
    """Return whether a text anywhere in a part of a file names residual drifts."""
    if isinstance(node, Mapping):
        return any(map(_names_residual_drift, (*node.keys(), *node.values())))
    if isinstance(node, list):
        return any(map(_names_residual_drift, node))
    return isinstance(node, str) and RESIDUAL_DRIFT in node
