"""The sections of a study at a point of its sweep: trees with inheritance carried out, validated, each only once."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Sequence
from typing import Any

from pydantic import ValidationError

from pounding_cli.errors import Problem
from pounding_cli.study.inherit import inherited, like_of, refuse_alternatives
from pounding_cli.study.motions import MotionReader
from pounding_cli.study.problems import Problems, Tree
from pounding_cli.study.schema import StudyModel
from pounding_cli.study.source import UNWRITTEN, Node
from pounding_cli.study.sweep import SweepAxis

Point = tuple[int, ...]
"""Index on every axis; -1 where the file's own value stands."""

Subject = str | tuple[str, str]
"""What an axis can touch: a section of the file, or one entry of a section."""

MOST_KEPT = 10_000
"""Answers kept at a time: many points share one answer, but not the memory of all of them."""

FEW_KEPT = 1000
"""Answers kept of a sweep so long that those at its points are gone before the next turn comes to them; points in a row
share some."""

ANSWERS = 5
"""Answers that a point of an axis has for itself, at least."""


class Answers:
    """Answers by what was asked and at which point (`Sections.key`), the latest ones.

    Those that depend on every axis are asked for at one point alone: of a sweep with more points than answers are kept,
    few of them are.

    lengths : of the axes, the slowest first
    """

    def __init__(self, lengths: Sequence[int]) -> None:
        self._shared: OrderedDict[tuple[Any, Point], Any] = OrderedDict()
        self._of_points: OrderedDict[tuple[Any, Point], Any] = OrderedDict()
        self._most = _most_kept(lengths)
        all_kept = len(lengths) < 2 or math.prod(lengths) <= MOST_KEPT
        self._most_of_points = self._most if all_kept else min(MOST_KEPT, FEW_KEPT)

    def get(self, name: Any, place: Point) -> Any:
        """The answer; None where it is not kept."""
        kept = self._shared if -1 in place else self._of_points
        found = kept.get((name, place))
        if found is not None:
            kept.move_to_end((name, place))
        return found

    def keep(self, name: Any, place: Point, answer: Any) -> None:
        """Keep an answer."""
        shared = -1 in place
        kept = self._shared if shared else self._of_points
        kept[name, place] = answer
        if len(kept) > (self._most if shared else self._most_of_points):
            kept.popitem(last=False)


def _most_kept(lengths: Sequence[int]) -> int:
    """Answers worth keeping of axes of these lengths, the slowest first: those of every value of every axis, which are
    checked by themselves first, or else those that one value of the slowest axis asks for."""
    if ANSWERS * sum(lengths) <= MOST_KEPT:
        return MOST_KEPT
    turn = ANSWERS * math.prod(lengths[1:])
    return min(MOST_KEPT, max(FEW_KEPT, turn)) if turn <= MOST_KEPT else min(MOST_KEPT, FEW_KEPT)


class Sections:
    """Answers what stands in a section of a study at a point of its sweep; what axes do not touch is worked out once.

    Answers asked for lately are kept, older ones are worked out again: a sweep takes time, not memory.

    Every answer keeps the problems met on the way; answers are whole where none are.

    met : everything wrong with what was asked so far, and the point with the axes that do not matter set aside
    """

    def __init__(self, root: Node, axes: tuple[SweepAxis, ...], file: str, reader: MotionReader) -> None:
        self.root, self.axes, self.file = root, axes, file
        self.warnings = Problems(file)
        self.reader = reader
        self.base: Point = (-1,) * len(axes)
        self.touched = [touched_by(axis, root) for axis in axes]
        self._found = Answers([len(axis) for axis in axes])
        self._kept: dict[tuple[Subject, ...], tuple[bool, ...]] = {}
        buildings = root.get("buildings")
        self._defined = list(buildings.value) if buildings is not None and buildings.is_mapping else []
        self.met: dict[Problem, Point] = {}

    def touching(self, *subjects: Subject) -> tuple[bool, ...]:
        """For every axis, whether it touches one of `subjects`."""
        kept = self._kept.get(subjects)
        if kept is None:
            kept = tuple(not touched.isdisjoint(subjects) for touched in self.touched)
            self._kept[subjects] = kept
        return kept

    def key(self, point: Point, subjects: tuple[Subject, ...]) -> Point:
        """`point` with the axes that touch none of `subjects` set aside."""
        kept = self._kept.get(subjects)
        if kept is None:
            kept = self.touching(*subjects)
        if True not in kept:
            return self.base
        if False not in kept:
            return point
        return tuple([place if keep else -1 for place, keep in zip(point, kept, strict=True)])

    def once(self, name: Any, point: Point, subjects: tuple[Subject, ...], work: Callable[[Problems], Any]) -> Any:
        place = self.key(point, subjects)
        found: tuple[Any, tuple[Problem, ...]] | None = self._found.get(name, place)
        if found is None:
            collected = Problems(self.file)
            found = (work(collected), tuple(collected.found))
            self._found.keep(name, place, found)
        answer, problems = found
        if problems:
            self.met |= dict.fromkeys(problems, place)
        return answer

    def entries(self, point: Point, section: str) -> tuple[str, ...]:
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
        return self.once(
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
                if path[0] == section and node is not UNWRITTEN:
                    root = root.replaced(path, node)
        found = root.get(section)
        return inherited(found, problems) if section == "buildings" and found is not None else found

    def root_at(self, point: Point) -> Tree:
        """The whole tree at this point, to place problems in: made on demand, as most points have none."""
        return Tree(lambda: self._root_at(point))

    def _root_at(self, point: Point) -> Node:
        values = {name: self.tree(point, name) or node for name, node in self.root.value.items()}
        for touched in self.touched:
            for name in touched:
                found = self.tree(point, name) if isinstance(name, str) and name not in values else None
                if found is not None:
                    values[str(name)] = found
        keys = {name: (self.root.keys or {}).get(name, node.mark) for name, node in values.items()}
        return Node(values, self.root.mark, keys=keys)

    def model(self) -> StudyModel | None:
        """The validated study as written."""
        return self.once("model", self.base, (), self._whole)

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
        return self.once(("section", name), point, (name,), lambda problems: self._section(point, name, problems))

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
        building = buildings.get(name)
        like = None if building is None else like_of(building)
        if like is None:
            return False
        name = like
    return True


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
