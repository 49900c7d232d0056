"""A study at one point of its sweep: buildings, links and motions built, each only once."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from pydantic import BaseModel

from pounding_cli.errors import Problem
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.numbers import counted
from pounding_cli.study import buildings as building_room
from pounding_cli.study import facing, plausible
from pounding_cli.study.building_schema import BuildingSpec
from pounding_cli.study.case_schema import Impact
from pounding_cli.study.formulas import OwnLaws, own_laws
from pounding_cli.study.link_laws import Group
from pounding_cli.study.links import Links
from pounding_cli.study.motions import Used, motions_of
from pounding_cli.study.problems import Problems, Tree, nearest
from pounding_cli.study.rules import StiffnessRule
from pounding_cli.study.sections import Point, Sections, Subject
from pounding_cli.study.units import Measured

FEWEST, MOST = 2, 20
"""Buildings in a group."""

AROUND: tuple[Subject, ...] = ("records", "tail")
"""What scenes depend on besides buildings and links."""


BETWEEN: tuple[Subject, ...] = ("buildings", "group", "impact", "laws")
"""What all links depend on: between which buildings they stand, and how these strike."""


@functools.cache
def links_depend_on(case: str) -> tuple[Subject, ...]:
    """What the links of a case depend on."""
    return *BETWEEN, ("cases", case)


class Resolver(Sections):
    """Answers what a study is at a point of its sweep: what its sections (`sections`) describe.

    Every answer keeps the problems met on the way; `problems` tells them; answers are whole where none are.
    """

    _last: tuple[Point, Group] | None = None

    @functools.cached_property
    def _links(self) -> Links:
        return Links(several=True in self.touching("buildings"))

    def problems(self, point: Point) -> tuple[Problem, ...]:
        """Everything wrong with the study at this point."""
        self.met.clear()
        self._last = None
        if point == self.base:
            self.model()
        self.section(point, "tail")
        self.motions(point)
        for case in self.entries(point, "cases"):
            self.links(point, case)
        return tuple(self.met)

    def types(self, point: Point) -> Mapping[str, Building] | None:
        """Every building type by name."""
        if self.section(self.base, "buildings") is None:
            return None
        built: dict[str, Building] = {}
        for name in self.entries(point, "buildings"):
            building = self.type(point, name)
            if building is not None:
                built[name] = building
        return built

    def type(self, point: Point, name: str) -> Building | None:
        """One building type."""
        spec: BuildingSpec | None = self.entry(point, "buildings", name)
        if spec is None:
            return None

        def work(problems: Problems) -> Building | None:
            root, own = self.root_at(point), Problems(self.file)
            building = building_room.build(name, spec, root, ("buildings", name), own)
            if own.found:
                # What the whole of a building lacks is told of the one it is like, where that lacks it too.
                inherits = spec.like is not None and not self._stands(point, spec.like, root)
                whole = root.locate(("buildings", name)) if inherits else None
                problems.extend(p for p in own.found if (p.line, p.column) != whole)
            return building

        return self.once(("type", name), point, (("buildings", name),), work)

    def _stands(self, point: Point, name: str, root: Tree) -> bool:
        """Whether a building type is whole."""
        spec: BuildingSpec | None = self.entry(point, "buildings", name)
        if spec is None:
            return False
        return building_room.build(name, spec, root, ("buildings", name), Problems(self.file)) is not None

    def design_displacements(self, point: Point, name: str) -> np.ndarray | None:
        """Displacements a building type is designed for [m], shape (n,), from the ground up; None without a code."""
        spec, building = self.entry(point, "buildings", name), self.type(point, name)
        assert building is not None
        return self.once(
            ("design", name),
            point,
            (("buildings", name),),
            lambda problems: building_room.design_displacements(spec, building),
        )

    def code_displacements(self, point: Point, name: str) -> Mapping[str, np.ndarray]:
        """Displacements of a building type that codes expect, by rule (`buildings.code_displacements`) [m]."""
        spec, building = self.entry(point, "buildings", name), self.type(point, name)
        assert building is not None
        return self.once(
            ("codes", name),
            point,
            (("buildings", name),),
            lambda problems: building_room.code_displacements(spec, building),
        )

    def group(self, point: Point) -> Group | None:
        """The buildings by place, their common floors, and the impact element."""
        key = self.key(point, BETWEEN)
        if self._last is not None and self._last[0] == key:
            return self._last[1]
        types, names, impact, laws = (
            self.types(point), self.section(point, "group"), self.section(point, "impact"), self.laws(point)
        )  # fmt: skip
        if names is None:
            return None

        def work(problems: Problems) -> Group | None:
            root = self.root_at(point)
            known = self._defined
            # Names are compared with what the file calls its buildings, however faulty those are.
            sound = _group_is_sound(names, known, root, problems) if known else False
            if not sound or types is None or impact is None or any(name not in types for name in names):
                return None
            placed = [_named(types[name], label) for name, label in zip(names, places(names), strict=True)]
            found = [facing.facing(one, other) for one, other in pairwise(placed)]
            for place, (floors, strikes) in enumerate(found):
                if not floors and not strikes:
                    one, other = placed[place], placed[place + 1]
                    slips = (
                        plausible.slip_of_height(types[name], root, ("buildings", name))
                        for name in names[place : place + 2]
                    )
                    slip = next(filter(None, slips), "let the storey heights agree somewhere")
                    problems.at(
                        root,
                        ("group", place + 1),
                        f"{one.name} and {other.name} have no floor at one elevation: "
                        f"{_metres(one)} against {_metres(other)} m",
                        f"{slip}; {facing.COLUMNS}",
                    )
            if not all(floors or strikes for floors, strikes in found):
                return None
            common, struck = zip(*found, strict=True)
            return Group(placed, types, common, impact, known, laws, struck)

        group = self.once("group", point, BETWEEN, work)
        self._last = None if group is None else (key, group)
        return group

    def laws(self, point: Point) -> OwnLaws:
        """The laws of the study's own by name."""

        def work(problems: Problems) -> OwnLaws:
            return own_laws(self.section(point, "laws") or {}, self.root_at(point), problems)

        return self.once("laws", point, ("laws",), work)

    def links(self, point: Point, case: str) -> tuple[Link, ...] | None:
        """The links of one case."""
        group, spec = self.group(point), self.entry(point, "cases", case)

        def work(problems: Problems) -> tuple[Link, ...]:
            root = self.root_at(point)
            around = group or self._empty_group(point)
            return self._links.of(spec, around, root, ("cases", case), problems)

        return self.once(("links", case), point, links_depend_on(case), work)

    def doubt(self, point: Point) -> None:
        """Note in `warnings` what is sound at this point, but unlikely or less than it seems."""
        for name in self.entries(point, "buildings"):
            if (building := self.type(point, name)) is not None:
                spec = self.entry(point, "buildings", name)
                work = partial(plausible.doubt_building, spec, building, self.root_at(point), ("buildings", name))
                self._noted(("building", name), point, (("buildings", name),), work)
        group = self.group(point)
        if group is not None:
            work = partial(facing.tell, group.buildings, group.common, self.root_at(point), ("group",))
            self._noted("group", point, ("buildings", "group"), work)
            for case in self.entries(point, "cases"):
                work = partial(
                    plausible.doubt_links,
                    self.links(point, case) or (),
                    group.buildings,
                    self.root_at(point),
                    ("cases", case),
                )
                self._noted(("case", case), point, links_depend_on(case), work)
        work = partial(plausible.doubt_motions, self.motions(point) or {}, self.root_at(point))
        self._noted("motions", point, ("records",), work)

    def _noted(self, name: Any, point: Point, subjects: tuple[Subject, ...], work: Callable[[Problems], None]) -> None:
        """Take over what `work` notes; where several swept values make it together, they are named."""

        def take(_: Problems) -> None:
            own = Problems(self.file)
            work(own)
            swept = [
                (axis, at) for axis, at, mine in zip(self.axes, point, self.touching(*subjects), strict=True) if mine
            ]
            told = [pair for axis, at in swept for pair in zip(axis.names, axis.nodes[at], strict=True)]
            where = ", ".join(f"{key} = {node.text or node.plain()}" for key, node in told)
            jointly = sum(at > 0 for _, at in swept) > 1
            for problem in own.found:
                if jointly and not self.warnings.knows(problem):
                    problem = replace(problem, message=f"{problem.message} (where {where})")
                self.warnings.extend([problem])

        self.once(("doubt", name), point, subjects, take)

    def _empty_group(self, point: Point) -> Group:
        impact = self.section(point, "impact") or Impact()
        return Group((), self.types(point) or {}, (), impact, self._defined, self.laws(point))

    def motions(self, point: Point) -> dict[str, Used] | None:
        """The motions by name, cut and scaled."""
        spec = self.section(point, "records")
        if spec is None:
            return None
        return self.once(
            "motions",
            point,
            ("records",),
            lambda problems: motions_of(spec, self.reader, self.root_at(point), problems, self.warnings),
        )


def places(names: tuple[str, ...]) -> tuple[str, ...]:
    """Names by place: a type that stands more than once is told apart by a number (soft-1, soft-2)."""
    count: dict[str, int] = {}
    labels = []
    for name in names:
        count[name] = count.get(name, 0) + 1
        labels.append(f"{name}-{count[name]}" if names.count(name) > 1 else name)
    return tuple(labels)


def _named(building: Building, label: str) -> Building:
    return building if building.name == label else replace(building, name=label)


def _metres(building: Building) -> str:
    shown = [f"{elevation:g}" for elevation in building.elevation[:6]]
    return ", ".join(shown) + (", ..." if building.storeys > 6 else "")


def _group_is_sound(names: tuple[str, ...], types: Sequence[str], root: Tree, problems: Problems) -> bool:
    before = len(problems.found)
    if len(names) > MOST:
        problems.at(root, ("group",), f"the group has {len(names)} buildings", f"name at most {MOST}")
        return False
    for place, name in enumerate(names):
        if name not in types:
            problems.at(root, ("group", place), f"no building '{name}' is defined", nearest(name, types))
    if len(names) < FEWEST:
        problems.at(
            root,
            ("group",),
            f"the group has {counted(len(names), 'building')}: pounding takes two",
            "name at least two, e.g. `group: [stiff, soft]`; each alone is computed as a baseline anyway",
        )
    labels = places(names)
    for place, label in enumerate(labels):
        if labels.index(label) != place:
            problems.at(
                root,
                ("group", place),
                f"two places of the group are called '{label}'",
                "give the building another name",
            )
    return len(problems.found) == before


def shown(value: Any) -> Any:
    """A value of a validated model as plain data: SI numbers, rules as text."""
    if isinstance(value, StiffnessRule):
        return str(value)
    if isinstance(value, Measured):
        return value.text
    if isinstance(value, BaseModel):
        return {info.alias or name: shown(getattr(value, name)) for name, info in type(value).model_fields.items()}
    if isinstance(value, dict):
        return {str(key): shown(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [shown(item) for item in value]
    return value
