"""A study at one point of its sweep: sections validated; buildings, links, motions built, each only once."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from pounding_cli.errors import Problem
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.numbers import counted
from pounding_cli.study import buildings as building_room
from pounding_cli.study import facing, plausible
from pounding_cli.study.formulas import OwnLaws, own_laws
from pounding_cli.study.inherit import inherited, refuse_alternatives
from pounding_cli.study.link_laws import Group
from pounding_cli.study.links import links_of
from pounding_cli.study.motions import MotionReader, Used, motions_of
from pounding_cli.study.problems import Problems, Tree, nearest
from pounding_cli.study.rules import StiffnessRule
from pounding_cli.study.schema import BuildingSpec, Impact, StudyModel
from pounding_cli.study.source import Node
from pounding_cli.study.sweep import SweepAxis
from pounding_cli.study.units import Measured

Point = tuple[int, ...]
"""Index on every axis; -1 where the file's own value stands."""

Subject = str | tuple[str, str]
"""What an axis can touch: a section of the file, or one entry of a section."""

FEWEST, MOST = 2, 20
"""Buildings in a group."""

MOST_KEPT = 10_000
"""Answers kept at a time: many points share one answer, but not the memory of all of them."""

FEW_KEPT = 1000
"""Answers kept where the fastest axis is so long that those at one of its points are gone before the next turn comes to
it; two points in a row share some."""

ANSWERS = 5
"""Answers that a point of an axis has for itself, at least."""


class Resolver:
    """Answers what a study is at a point of its sweep; what axes do not touch is worked out once.

    Answers asked for lately are kept, older ones are worked out again: a sweep takes time, not memory.

    Every answer keeps the problems met on the way; `problems` tells them; answers are whole where none are.
    """

    def __init__(self, root: Node, axes: tuple[SweepAxis, ...], file: str, reader: MotionReader) -> None:
        self.root, self.axes, self.file = root, axes, file
        self.warnings = Problems(file)
        self.reader = reader
        self.base: Point = (-1,) * len(axes)
        self._touched = [touched_by(axis, root) for axis in axes]
        self._found: OrderedDict[tuple[Any, ...], tuple[Any, tuple[Problem, ...]]] = OrderedDict()
        self._kept: dict[tuple[Subject, ...], tuple[bool, ...]] = {}
        buildings = root.get("buildings")
        self._defined = list(buildings.value) if buildings is not None and buildings.is_mapping else []
        self._met: dict[Problem, None] = {}
        self._last: tuple[Point, Group] | None = None
        comes_back = not axes or ANSWERS * len(axes[-1]) <= MOST_KEPT
        self.most_kept = MOST_KEPT if comes_back else FEW_KEPT

    def touching(self, *subjects: Subject) -> tuple[bool, ...]:
        """For every axis, whether it touches one of `subjects`."""
        kept = self._kept.get(subjects)
        if kept is None:
            kept = tuple(not touched.isdisjoint(subjects) for touched in self._touched)
            self._kept[subjects] = kept
        return kept

    def key(self, point: Point, subjects: tuple[Subject, ...]) -> Point:
        """`point` with the axes that touch none of `subjects` set aside."""
        if not point:
            return point
        kept = self.touching(*subjects)
        return tuple([place if keep else -1 for place, keep in zip(point, kept, strict=True)])

    def _once(self, name: Any, point: Point, subjects: tuple[Subject, ...], work: Callable[[Problems], Any]) -> Any:
        key = (name, self.key(point, subjects))
        found = self._found.get(key)
        if found is None:
            collected = Problems(self.file)
            found = (work(collected), tuple(collected.found))
            self._found[key] = found
            if len(self._found) > self.most_kept:
                self._found.popitem(last=False)
        else:
            self._found.move_to_end(key)
        answer, problems = found
        if problems:
            self._met.update(dict.fromkeys(problems))
        return answer

    @property
    def met(self) -> tuple[Problem, ...]:
        """Everything wrong with what was asked so far."""
        return tuple(self._met)

    def problems(self, point: Point) -> tuple[Problem, ...]:
        """Everything wrong with the study at this point."""
        self._met.clear()
        self._last = None
        if point == self.base:
            self.model()
        self.section(point, "tail")
        self.motions(point)
        for case in self._entries(point, "cases"):
            self.links(point, case)
        return self.met

    def _entries(self, point: Point, section: str) -> tuple[str, ...]:
        """The names of the sound entries of `buildings` or `cases`."""
        node = self.tree(self.base, section)
        if node is None or not node.is_mapping:  # said what is wrong with it, or where the sweep makes it
            return tuple(self.section(point, section) or ())
        return tuple(name for name in node.value if self.entry(point, section, name) is not None)

    def entry(self, point: Point, section: str, name: str) -> Any:
        """One validated entry of `buildings` or `cases`, or None; looked at once for all axes that leave it alone."""
        return (self.section(self.key(point, ((section, name),)), section) or {}).get(name)

    # The file's tree and the models of its sections

    def tree(self, point: Point, section: str) -> Node | None:
        """One section of the file at this point, buildings with their inheritance carried out."""
        return self._once(
            ("tree", section),
            point,
            (section,),
            lambda problems: self._tree(self.key(point, (section,)), section, problems),
        )

    def _tree(self, point: Point, section: str, problems: Problems) -> Node | None:
        root = Node({}, self.root.mark, keys={})
        own = self.root.get(section)
        if own is not None:
            root = Node({section: own}, self.root.mark, keys={section: (self.root.keys or {})[section]})
        for place, axis in zip(point, self.axes, strict=True):
            if place < 0:
                continue
            for path, node in zip(axis.paths, axis.nodes[place], strict=True):
                if path[0] == section:
                    root = root.replaced(path, node)
        found = root.get(section)
        return inherited(found, problems) if section == "buildings" and found is not None else found

    def root_at(self, point: Point) -> Tree:
        """The whole tree at this point, to place problems in: made on demand, as most points have none."""
        return Tree(lambda: self._root_at(point))

    def _root_at(self, point: Point) -> Node:
        values = {name: self.tree(point, name) or node for name, node in self.root.value.items()}
        for touched in self._touched:
            for name in touched:
                found = self.tree(point, name) if isinstance(name, str) and name not in values else None
                if found is not None:
                    values[str(name)] = found
        keys = {name: (self.root.keys or {}).get(name, node.mark) for name, node in values.items()}
        return Node(values, self.root.mark, keys=keys)

    def model(self) -> StudyModel | None:
        """The validated study as written."""
        return self._once("model", self.base, (), self._whole)

    def _whole(self, problems: Problems) -> StudyModel | None:
        root = self.root_at(self.base)
        _refuse_twofold(root, problems)
        try:
            return StudyModel.model_validate(root.node.plain())
        except ValidationError as error:
            problems.validation(root, error, StudyModel)
            return None

    def section(self, point: Point, name: str) -> Any:
        """One validated section, or its default.

        Of a section with problems, what remains without the faulty entries: the rest is looked at too.
        """
        return self._once(("section", name), point, (name,), lambda problems: self._section(point, name, problems))

    def _section(self, point: Point, name: str, problems: Problems) -> Any:
        node = self.tree(point, name)
        if node is None:
            field = StudyModel.model_fields[name]
            return None if field.is_required() else field.get_default()
        root = Node({name: node}, self.root.mark, keys={name: node.mark})
        _refuse_twofold(root, problems)
        value = node.plain()
        try:
            return _validated(name, value)
        except ValidationError as error:
            problems.validation(root, error, StudyModel)
            if not isinstance(value, dict):
                return None
            faulty = {str(item["loc"][1]) for item in error.errors() if len(item["loc"]) > 1}
        try:
            return _validated(name, {k: v for k, v in value.items() if k not in faulty} | _harmless(name, faulty))
        except ValidationError:
            return None

    # What the sections describe

    def types(self, point: Point) -> Mapping[str, Building] | None:
        """Every building type by name."""
        if self.section(self.base, "buildings") is None:
            return None
        built: dict[str, Building] = {}
        for name in self._entries(point, "buildings"):
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

        return self._once(("type", name), point, (("buildings", name),), work)

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
        return self._once(
            ("design", name),
            point,
            (("buildings", name),),
            lambda problems: building_room.design_displacements(spec, building),
        )

    def group(self, point: Point) -> Group | None:
        """The buildings by place, their common floors, and the impact element."""
        if self._last is not None and self._last[0] == point:
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

        group = self._once("group", point, ("buildings", "group", "impact", "laws"), work)
        self._last = None if group is None else (point, group)
        return group

    def laws(self, point: Point) -> OwnLaws:
        """The laws of the study's own by name."""

        def work(problems: Problems) -> OwnLaws:
            return own_laws(self.section(point, "laws") or {}, self.root_at(point), problems)

        return self._once("laws", point, ("laws",), work)

    def links(self, point: Point, case: str) -> tuple[Link, ...] | None:
        """The links of one case."""
        group, spec = self.group(point), self.entry(point, "cases", case)

        def work(problems: Problems) -> tuple[Link, ...]:
            root = self.root_at(point)
            around = group or self._empty_group(point)
            return links_of(spec, around, root, ("cases", case), problems)

        return self._once(("links", case), point, ("buildings", "group", "impact", "laws", ("cases", case)), work)

    def doubt(self, point: Point) -> None:
        """Note in `warnings` what is sound at this point, but unlikely or less than it seems."""
        for name in self._entries(point, "buildings"):
            if (building := self.type(point, name)) is not None:
                spec = self.entry(point, "buildings", name)
                work = partial(plausible.doubt_building, spec, building, self.root_at(point), ("buildings", name))
                self._noted(("building", name), point, (("buildings", name),), work)
        group = self.group(point)
        if group is not None:
            work = partial(facing.tell, group.buildings, group.common, self.root_at(point), ("group",))
            self._noted("group", point, ("buildings", "group"), work)
            for case in self._entries(point, "cases"):
                work = partial(
                    plausible.doubt_links,
                    self.links(point, case) or (),
                    group.buildings,
                    self.root_at(point),
                    ("cases", case),
                )
                self._noted(("case", case), point, ("buildings", "group", "impact", "laws", ("cases", case)), work)
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

        self._once(("doubt", name), point, subjects, take)

    def _empty_group(self, point: Point) -> Group:
        impact = self.section(point, "impact") or Impact()
        return Group((), self.types(point) or {}, (), impact, self._defined, self.laws(point))

    def motions(self, point: Point) -> dict[str, Used] | None:
        """The motions by name, cut and scaled."""
        spec = self.section(point, "records")
        if spec is None:
            return None
        return self._once(
            "motions",
            point,
            ("records",),
            lambda problems: motions_of(spec, self.reader, self.root_at(point), problems, self.warnings),
        )


def touched_by(axis: SweepAxis, root: Node) -> frozenset[Subject]:
    """What an axis touches: sections, the cases it names, the buildings it names and those that inherit its key."""
    found: set[Subject] = set()
    buildings = root.get("buildings")
    for section, *below in axis.paths:
        found.add(section)
        if section == "cases" and below:
            found.add((section, below[0]))
        elif section == "buildings" and below and buildings is not None and buildings.is_mapping:
            found |= {(section, name) for name in buildings.value if _inherits(name, tuple(below), buildings)}
    return frozenset(found)


def _inherits(name: str, path: tuple[str, ...], buildings: Node) -> bool:
    """Whether building `name` takes the key at `path` (building, key, ...) from there, itself or through `like:`."""
    seen: set[str] = set()
    while name != path[0]:
        if name in seen or buildings.get(name, *path[1:]) is not None:
            return False
        seen.add(name)
        like = buildings.get(name, "like")
        if like is None or not isinstance(like.value, str):
            return False
        name = like.value
    return True


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


_holder = StudyModel.model_construct()


def _validated(section: str, value: Any) -> Any:
    # One empty study serves all: assignment validates the one field and replaces what stood there.
    setattr(_holder, section, value)
    return getattr(_holder, section)


def _harmless(section: str, faulty: set[str]) -> dict[str, Any]:
    """Values in place of faulty ones that bring out no further problem, where the default could."""
    values = {"duration": "whole", "scale": 1.0} if section == "records" else {}
    return {key: value for key, value in values.items() if key in faulty}


def _refuse_twofold(root: Node | Tree, problems: Problems) -> None:
    """Restitution and damping ratio in one mapping, under `impact` and in every link of every case."""
    impact = root.get("impact")
    if impact is not None:
        refuse_alternatives(impact, "link", problems)
    stack = [root.get("cases")]
    while stack:
        node = stack.pop()
        if node is not None and node.is_mapping:
            refuse_alternatives(node, "link", problems)
            stack += node.value.values()
        elif node is not None and node.is_list:
            stack += node.value


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
