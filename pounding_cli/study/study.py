"""A study read, validated at every value of every axis, and asked at any point of its sweep."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, TypeAdapter, ValidationError

from pounding_cli import records
from pounding_cli.errors import Problem
from pounding_cli.laws import link_laws
from pounding_cli.model.building import Building, UnstableError
from pounding_cli.model.links import Link
from pounding_cli.model.separation import UBC
from pounding_cli.numbers import Unit
from pounding_cli.reading import shortened
from pounding_cli.study import build, plausible, schema
from pounding_cli.study.axes import UNWRITTEN, Axis, read_axes, unit_of, with_middles
from pounding_cli.study.file import MOST_TOLD, Map, Problems, get, locate, nearest, put, read_study, refuse_other_kinds
from pounding_cli.study.laws import LOSSES
from pounding_cli.study.links import (
    OwnLaw,
    check_contact,
    check_link_names,
    check_places,
    content,
    find_losses,
    own_laws,
)
from pounding_cli.study.links import links_of as scene_links
from pounding_cli.study.models import Building as BuildingSpec
from pounding_cli.study.models import Case
from pounding_cli.study.motions import MotionReader, Used, motions_of
from pounding_cli.study.plan import check_keep
from pounding_cli.study.quantity import MeasuredValue, Quantity, StoreyMultiple, written_unit
from pounding_cli.study.spell import inherited, like_of, links_of, refuse_old
from pounding_cli.units import GRAVITY

Point = tuple[int, ...]
"""Index on every axis; -1 where the file's own value stands."""

Subject = str | tuple[str, str]
"""What an axis can touch: a section of the file, or one entry of a section."""

QUESTIONS = ("sensitivity", "optimise")
"""Sections that may name any quantity of the tables."""

RESIDUAL_DRIFT = "residual_drift"
"""The key and the quantity of the drifts at rest."""

MOST_KEPT = 200_000
"""Answers kept at a time: many points share one answer, but not the memory of all of them."""

AROUND: tuple[Subject, ...] = ("records", "tail")
"""What scenes depend on besides buildings and links."""

BETWEEN: tuple[Subject, ...] = ("buildings", "group", "impact", "laws")
"""What all links depend on: between which buildings they stand, and how these strike."""

_adapter = functools.cache(TypeAdapter)
T = TypeVar("T")


def answer(subjects: Callable[..., tuple[Subject, ...]]) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """Decorates a method that answers at a point: it is worked out once for all points that do not differ in what it
    depends on, where the other axes are set aside. What is wrong there is noted in `Study.problems` each time.

    subjects : of the names that the method takes, what it depends on
    """

    def decorated(work: Callable[..., T]) -> Callable[..., T]:
        @functools.wraps(work)
        def asked(self: Study, point: Point, *names: str) -> T:
            place = self.key(point, subjects(*names))
            key = work, names, place
            kept = self._kept.get(key)
            if kept is None:
                outer, self.problems = self.problems, Problems(self.file)
                try:
                    found = work(self, place, *names)
                    kept = found, {problem: at or place for problem, at in self.problems.found.items()}
                finally:
                    self.problems = outer
                if len(self._kept) >= MOST_KEPT:
                    self._kept.clear()
                self._kept[key] = kept
            for problem, at in kept[1].items():
                self.problems.found.setdefault(problem, at)
            return kept[0]

        return asked

    return decorated


class Study:
    """A validated study.

    Attributes
    ----------
    path : the file
    text : the file as written
    title : its title or its name
    axes : the axes of the sweep
    warnings : what is allowed but should be known
    model : the study as written, validated
    root : its tree, with the middle of every unknown value where its key stands
    from_data : it is Python data; no file holds it
    written : the study it was made from, whose units people read; None unless it was made from one
    problems : what is wrong at the points asked so far, each with the point where the axes are set aside that it does
        not depend on
    """

    def __init__(
        self,
        path: Path,
        text: str,
        root: Map,
        axes: Sequence[Axis] | None = None,
        reader: MotionReader | None = None,
        written: Study | None = None,
    ) -> None:
        """axes : in place of those that the file has."""
        self.path, self.text, self.file, self.written = path, text, shortened(path), written
        self.from_data: bool = isinstance(root.mark[0], str) if written is None else written.from_data
        refuse_other_kinds(root, self.file)
        self.problems, self.notes = Problems(self.file), Problems(self.file)
        refuse_old(root, self.problems)
        self.problems.check()
        self.root = with_middles(root, self.problems)
        self.reader = reader or MotionReader(path.resolve().parent)
        self.axes = read_axes(self.root, self.problems) if axes is None else tuple(axes)
        self.base: Point = (-1,) * len(self.axes)
        self._touched = [touched_by(axis.names, self.root) for axis in self.axes]
        self._masks: dict[tuple[Subject, ...], tuple[bool, ...]] = {}
        self._kept: dict[Any, tuple[Any, dict[Problem, Point]]] = {}
        self._alike: dict[Any, tuple[Link, ...]] = {}  # links by what they follow from
        self.model: Any = self._checked()
        self.title = self.model.title or shortened(path.stem)
        self.warnings: tuple[Problem, ...] = ()
        self.warnings = written.warnings if written is not None else plausible.find_warnings(self)

    # What stands at a point

    def touches(self, *subjects: Subject) -> tuple[bool, ...]:
        """For every axis of the sweep, whether it can change one of some sections of the file or of their entries:
        `buildings`, `records`, ("buildings", "soft"), ..."""
        mask = self._masks.get(subjects)
        if mask is None:
            mask = self._masks[subjects] = tuple(not touched.isdisjoint(subjects) for touched in self._touched)
        return mask

    def key(self, point: Point, subjects: tuple[Subject, ...]) -> Point:
        """A point with the axes set aside that touch none of some subjects."""
        mask = self._masks.get(subjects) or self.touches(*subjects)
        return tuple([place if mine else -1 for place, mine in zip(point, mask, strict=True)])

    def _patched(self, point: Point, *sections: str) -> Map:
        """The tree with the swept values of some sections, all unless given, at a point."""
        root = self.root
        for place, axis in zip(point, self.axes, strict=True):
            if place < 0:
                continue
            for path, value, mark in zip(axis.paths, axis.written_values[place], axis.marks[place], strict=True):
                if (not sections or path[0] in sections) and value is not UNWRITTEN:
                    root = put(root, path, value, mark)
        return root

    def at(self, point: Point) -> Callable[[], Map]:
        """The whole tree at a point, `like:` and links as the schema takes them, to place problems; made when it is
        first asked for: most points have none."""

        @functools.cache
        def tree() -> Map:
            root = self._patched(point)
            found = Map(root, root.mark, root.marks)
            if "buildings" in found:
                found["buildings"] = inherited(root["buildings"], Problems(""))
            if isinstance(cases := root.get("cases"), Map):
                impact, laws = root.get("impact"), root.get("laws")
                found["cases"] = Map({n: links_of(c, impact, laws) for n, c in cases.items()}, cases.mark, cases.marks)
            return found

        return tree

    @functools.cached_property
    def asks_residual_drift(self) -> bool:
        """Whether the drifts at rest are asked for, by their key or by a question that names them."""
        return bool(self.model.residual_drift) or any(_names_residual_drift(self.root.get(name)) for name in QUESTIONS)

    def _valid(self, kind: Any, value: Any, path: tuple[str, ...], point: Point) -> Any:
        """A part of the file validated; None where it is faulty."""
        try:
            return _adapter(kind).validate_python(value)
        except ValidationError as error:
            root = self._patched(point, path[0])
            self.problems.validation(put(root, path, value, locate(root, path)), error, path, schema.Study)
            return None

    @answer(lambda name: (name,))
    def section(self, point: Point, name: str) -> Any:
        """A validated section other than buildings and cases, or its default; None where it is faulty."""
        field, value = schema.Study.model_fields[name], self._patched(point, name).get(name)
        if value is None:
            return None if field.is_required() else field.get_default()
        return self._valid(field.rebuild_annotation(), value, (name,), point)

    @answer(lambda: ("buildings",))
    def _buildings(self, point: Point) -> Map:
        """The section `buildings` with every `like:` carried out; empty where it is no mapping."""
        found = inherited(self._patched(point, "buildings").get("buildings"), self.problems)
        return found if isinstance(found, Map) else Map()

    @answer(lambda name: (("buildings", name),))
    def building_spec(self, point: Point, name: str) -> BuildingSpec | None:
        """The validated keys of a building type; None where they are faulty."""
        return self._valid(BuildingSpec, self._buildings(point)[name], ("buildings", name), point)

    @answer(lambda name: (("buildings", name),))
    def type(self, point: Point, name: str) -> Building | None:
        """A building type; None where it is not sound."""
        spec, path = self.building_spec(point, name), ("buildings", name)
        try:
            return None if spec is None else build.building(name, spec)
        except (ValueError, ArithmeticError) as error:
            at = (*path, "p_delta") if isinstance(error, UnstableError) else path
            self.problems.at(self.at(point), at, str(error), "check its masses, heights, period, stiffness and P-Delta")
        return None

    def types(self, point: Point) -> dict[str, Building]:
        """The building types by name, those that are sound."""
        found = ((name, self.type(point, name)) for name in self._buildings(self.base))
        return {name: built for name, built in found if built is not None}

    @answer(lambda: ("buildings", "group"))
    def group(self, point: Point) -> build.Group | None:
        """The buildings by place and what meets between them; None where it is not sound."""
        names, types, defined = self.section(point, "group"), self.types(point), get(self.root, "buildings")
        if names is None or not defined or not build.check_group(names, list(defined), self.root, self.problems):
            return None
        if any(name not in types for name in defined):
            return None
        group = build.Group.of(names, types)
        return group if build.check_meetings(group, self.root, self.problems) else None

    @answer(lambda: ("laws",))
    def laws(self, point: Point) -> dict[str, OwnLaw] | None:
        """The laws of the study's own by name; None where they are faulty."""
        specs = self.section(point, "laws")
        return None if specs is None else own_laws(specs, self.at(point), self.problems)

    @answer(lambda: ("impact", "laws"))
    def impact(self, point: Point) -> Any:
        """The validated impact element; None where it is faulty."""
        impact, laws = self.section(point, "impact"), self.laws(point)
        if impact is None or laws is None:
            return None
        return impact if check_contact(impact.law, laws, self.at(point), self.problems) else None

    @answer(lambda name: ("impact", ("cases", name)))
    def case(self, point: Point, name: str) -> Case | None:
        """A validated case; None where it is faulty."""
        root = self._patched(point, "cases", "impact")
        case = links_of(root["cases"][name], root.get("impact"), self.root.get("laws"))
        return self._valid(Case, case, ("cases", name), point)

    @answer(lambda name: (*BETWEEN, ("cases", name)))
    def links(self, point: Point, name: str) -> tuple[Link, ...] | None:
        """The links of a case; None where something is wrong with them."""
        case, group, impact, laws = self.case(point, name), self.group(point), self.impact(point), self.laws(point)
        if case is not None and group is not None and (impact is None or laws is None):
            check_places(case, group, ("cases", name), self.at(point), self.problems)
        if case is None or impact is None or laws is None or group is None:
            return None
        root, key = self.at(point), content(case, group, impact, laws)
        if key is not None and key in self._alike:
            return self._alike[key]
        found = scene_links(case, group, impact, laws, ("cases", name), root, self.problems)
        if key is not None and found is not None and len(self._alike) < MOST_KEPT:
            self._alike[key] = found
        return found

    @answer(lambda: ("records",))
    def motions(self, point: Point) -> Mapping[str, Used]:
        """The motions by name at a point of the sweep (one index an axis), cut and scaled."""
        spec = self.section(point, "records")
        return {} if spec is None else motions_of(spec, self.reader, self.at(point), self.problems, self.notes)

    def buildings_changed_by(self, key: str) -> set[str]:
        """Return the names of the building types that take a dotted key, themselves or through `like:`."""
        return {subject[1] for subject in touched_by([key], self.root) if subject[0] == "buildings" and subject[1:]}

    # What people and tables ask

    def building(self, point: Point, place: int) -> Building:
        """The building at a place of the group, from 0, at a point of the sweep (one index an axis)."""
        building = self.type(point, self.model.group[place])
        assert building is not None  # the study was validated at every point
        return building

    def assumed_heights(self) -> tuple[str, ...]:
        """The buildings of the group, by place, whose storey heights the study leaves to their default."""
        specs = [self.building_spec((0,) * len(self.axes), name) for name in self.model.group]
        places = zip(build.places(self.model.group), specs, strict=True)
        return tuple(
            place for place, spec in places if spec and not spec.wall and "height" not in spec.model_fields_set
        )

    def unit(self, quantity: str) -> Unit:
        """The unit the study writes a quantity in, to show it to people: one of PLACES, e.g. gap."""
        source = self.written or self
        return unit_in(source._patched((0,) * len(source.axes)), quantity)

    def spectrum_match(self) -> records.SpectrumMatch | None:
        """The motions against the target spectrum they are scaled to, at the first point of the sweep; None without."""
        first = (0,) * len(self.axes)
        used = self.motions(first)
        target = next(iter(used.values())).target
        if target is None:
            return None
        scale = self.section(first, "records").scale
        motions = {name: each.motion for name, each in used.items()}
        return records.SpectrumMatch.of(motions, target, scale.spectrum == "each", scale.at_least)

    @answer(lambda name: (("buildings", name),))
    def code_displacements(self, point: Point, name: str) -> Mapping[str, np.ndarray]:
        """Displacements of a building type that codes expect, by rule (`build.code_displacements`) [m]."""
        building: Any = self.type(point, name)
        return build.code_displacements(self.building_spec(point, name), building)

    def separations(self, point: Point) -> np.ndarray:
        """The code's separation of every building from the next one to the right [m], shape (buildings,).

        NaN for the last, and where the yield shears of a neighbour were not set by a code.
        """
        allowed = [self.code_displacements(point, name).get(UBC) for name in self.model.group]
        return np.array([*(build.separation(left, right) for left, right in pairwise(allowed)), None], dtype=float)

    def resolved(self) -> dict[str, Any]:
        """The study as plain data: every default filled in, SI numbers, the sweep set aside.

        Buildings also carry what was derived (`derived`: mass, height, stiffness, yield_shear, alpha, beta,
        period); the places of the group are under `places`, and `separation` holds the code separation [m] of
        each pair of neighbours, None where no code set the yield shears.
        """
        plain: dict[str, Any] = shown(self.model)
        for name, case in self.model.cases.items():
            for link, keys in zip(case.links, plain["cases"][name]["links"], strict=True):
                law = link_laws().get(link.kind)
                if law is not None:
                    losses = find_losses(link, law)
                    keys |= {key: losses[key] for key in LOSSES if key in type(link).model_fields}
        plain["title"] = self.title
        plain["sweep"] = [{"names": list(axis.names), "values": [list(v) for v in axis.values]} for axis in self.axes]
        for name, building in self.types(self.base).items():
            plain["buildings"][name]["derived"] = {
                **{key: getattr(building, key).tolist() for key in ("mass", "height", "stiffness")},
                "yield_shear": [None if value == float("inf") else value for value in building.yield_shear.tolist()],
                "alpha": building.alpha,
                "beta": building.beta,
                "period": float(building.periods[0]),
                **({} if building.gravity_load is None else {"theta": building.stability_coefficient.tolist()}),
            }
        plain["places"] = list(build.places(self.model.group))
        gaps = self.separations(self.base)[:-1].tolist()
        plain["separation"] = [None if gap != gap else gap for gap in gaps]
        return plain

    # Checks

    def _checked(self) -> Any:
        """The study as written, validated there and at every value of every axis.  Raises `InputError`."""
        root, problems = self.at(self.base)(), self.problems
        model = None
        try:
            model = schema.Study.model_validate(root)
        except ValidationError as error:
            problems.validation(root, error, (), schema.Study, told=("buildings", "cases"))
        self._ask(self.base)
        if self.written is None:  # else they were looked at there
            check_link_names(self.root, problems)
            self._check_orphans()
            self._check_names(root)
        if self.root.get("uncertain") is not None:
            from pounding_cli.study.vary import read_uncertain  # here: few studies have distributions

            read_uncertain(self.root, problems)
        as_written = dict(problems.found)
        for number, axis in enumerate(self.axes):
            for place in range(len(axis)):
                self.problems = Problems(self.file)
                self._ask((*self.base[:number], place, *self.base[number + 1 :]))
                for problem in self.problems.found:
                    if problem in as_written:
                        continue
                    is_here = {problem.line, problem.file} & {mark[0] for mark in axis.marks[place]}
                    if is_here or not as_written:
                        message = (
                            problem.message if is_here else f"{problem.message} (where {axis.format_point(place)})"
                        )
                        problems.found[replace(problem, message=message)] = None
                if len(problems.found) > MOST_TOLD:
                    problems.check()
        self.problems = problems
        problems.check()
        return model

    def _ask(self, point: Point) -> None:
        """Ask for all that scenes take at a point, to learn what is wrong."""
        self.motions(point)
        self.section(point, "tail")
        self._buildings(point)
        self.group(point)
        self.impact(point)
        cases = self.root.get("cases")
        for name in cases if isinstance(cases, Map) else ():
            self.links(point, name)
            if len(self.problems.found) > MOST_TOLD:
                break

    def _check_orphans(self) -> None:
        """Note what is wrong with the keys of buildings whose `like:` leads nowhere, as far as it does not rest on what
        they would inherit."""
        sound, written = self._buildings(self.base), self.root.get("buildings")
        for name, spec in written.items() if isinstance(written, Map) else ():
            if name in sound or not isinstance(spec, Map):
                continue
            orphan = Map({key: value for key, value in spec.items() if key != "like"}, spec.mark, spec.marks)
            outer, self.problems = self.problems, Problems(self.file)
            self._valid(BuildingSpec, orphan, ("buildings", name), self.base)
            found, self.problems = self.problems.found, outer
            self.problems.extend(each for each in found if (each.line, each.column) != spec.mark and each.line)

    def _check_names(self, root: Map) -> None:
        """Note the cases and buildings under `report` and `keep` that the study does not have."""
        problems, cases = self.problems, root.get("cases")
        report, group = self.section(self.base, "report"), self.section(self.base, "group")
        for place, case in enumerate((report and report.plot) or ()):
            if isinstance(cases, Map) and case not in cases:
                problems.at(root, ("report", "plot", place), f"plot: no case '{case}'", nearest(case, cases))
        if report is not None and report.building is not None and group is not None:
            known, name = dict.fromkeys((*build.places(group), *group)), report.building
            if name not in known:
                problems.at(root, ("report", "building"), f"no building '{name}' in the group", nearest(name, known))
        keep, method = self.section(self.base, "keep"), self.section(self.base, "method")
        analyses = self.section(self.base, "analyses") or ()
        if isinstance(cases, Map):
            kept = SimpleNamespace(keep=keep, method=method or "taylor", cases=cases, analyses=analyses)
            check_keep(self, kept, problems)


def load_study(path: str | Path) -> Study:
    """Read and validate a study file.

    Raises `InputError` with every problem found in it, each with file, line, column, message and hint. The
    study as written is checked, and every value of every axis on its own; `expand` checks their combinations.
    """
    path = Path(path)
    return Study(path, *read_study(path))


def _names_residual_drift(node: Any) -> bool:
    """Return whether a text anywhere in a part of a file names residual drifts."""
    if isinstance(node, Mapping):
        return any(map(_names_residual_drift, (*node.keys(), *node.values())))
    if isinstance(node, list):
        return any(map(_names_residual_drift, node))
    return isinstance(node, str) and RESIDUAL_DRIFT in node


def touched_by(names: Sequence[str], root: Map) -> frozenset[Subject]:
    """What swept keys touch: sections, the cases they name, the buildings they name and those that inherit them."""
    found: set[Subject] = set()
    buildings = root.get("buildings")
    for section, *below in (name.split(".") for name in names):
        found.add(section)
        if section == "cases" and below:
            found.add((section, below[0]))
        elif section == "buildings" and below and isinstance(buildings, Map):
            found |= {(section, name) for name in buildings if _inherits(name, below, buildings)}
    return frozenset(found)


def _inherits(name: str, path: Sequence[str], buildings: Map) -> bool:
    """Whether building `name` takes the key at `path` (building, key, ...) from there, itself or through `like:`."""
    seen: set[str] = set()
    while name != path[0]:
        like = like_of(buildings.get(name))
        if name in seen or like is None or get(buildings, name, *path[1:]) is not None:
            return False
        seen.add(name)
        name = like
    return True


def shown(value: Any) -> Any:
    """A value of a validated model as plain data: SI numbers, multiples of stiffnesses as text."""
    if isinstance(value, StoreyMultiple):
        return str(value)
    if isinstance(value, MeasuredValue):
        return value.text
    if isinstance(value, BaseModel):
        found = {info.alias or name: shown(getattr(value, name)) for name, info in type(value).model_fields.items()}
        # What one law alone takes is left out where it stands at its default.
        return {key: each for key, each in found.items() if each is not None} if isinstance(value, Case) else found
    if isinstance(value, dict):
        return {str(key): shown(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [shown(item) for item in value]
    return value


PLACES: dict[str, tuple[tuple[tuple[str, ...], ...], tuple[str, ...], Unit]] = {
    "gap": ((("cases",),), ("gap",), Unit("cm", 0.01, "m")),
    "link stiffness": ((("cases",), ("impact",)), ("stiffness",), Unit("MN/m", 1e6, "N/m")),
    "acceleration": ((("records", "scale"),), ("pga", "sa", "target"), Unit("g", GRAVITY, "m/s2")),
    "time step": ((("time_step",),), (), Unit("s", 1.0, "s")),
}
"""The quantities that screens and tables show in the unit of the study: the sections at or below which it writes them,
the keys there (none: any), and the unit where it does not write them."""


def unit_in(root: Any, quantity: str) -> Unit:
    """The unit a study writes a quantity of PLACES in: the first one found, SI where there are bare numbers only."""
    sections, keys, usual = PLACES[quantity]
    found = [value for section in sections for value in _scalars(get(root, *section), keys, not keys)]
    unit = unit_of(found, Quantity(quantity, usual.si, ""))
    is_written = any(written_unit(value) == unit.name or isinstance(value, int | float) for value in found)
    return unit if is_written else usual


def _scalars(node: Any, keys: Sequence[str], inside: bool) -> Iterator[Any]:
    """The scalars at or below `node` that stand under one of `keys`; all of them where `inside`."""
    if isinstance(node, dict):
        for key, below in node.items():
            yield from _scalars(below, keys, inside or key in keys)
    elif isinstance(node, list):
        for below in node:
            yield from _scalars(below, keys, inside)
    elif inside and node is not None:
        yield node
