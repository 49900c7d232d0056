"""A study read, validated at every value of every axis, and asked at any point of its sweep."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from pounding_cli import records
from pounding_cli.errors import Problem
from pounding_cli.model.building import Building, UnstableError
from pounding_cli.model.links import Link
from pounding_cli.numbers import Unit
from pounding_cli.reading import shortened
from pounding_cli.study import build, plausible, schema
from pounding_cli.study.axes import UNWRITTEN, SweepAxis, read_axes, with_middles
from pounding_cli.study.file import Map, Problems, get, locate, nearest, put, read_study, refuse_other_kinds
from pounding_cli.study.keep import check_keep
from pounding_cli.study.laws import link_models
from pounding_cli.study.links import OwnLaw, check_contact, content, own_laws
from pounding_cli.study.links import links_of as scene_links
from pounding_cli.study.models import Building as BuildingSpec
from pounding_cli.study.models import Case
from pounding_cli.study.motions import MotionReader, Used, motions_of
from pounding_cli.study.old_links import refuse_old
from pounding_cli.study.plain import shown
from pounding_cli.study.plan import Axis
from pounding_cli.study.spell import inherited, like_of, links_of
from pounding_cli.study.words import fields_of, value_at

Point = tuple[int, ...]
"""Index on every axis; -1 where the file's own value stands."""

Subject = str | tuple[str, str]
"""What an axis can touch: a section of the file, or one entry of a section."""

MOST_KEPT = 10_000
"""Answers kept at a time: many points share one answer, but not the memory of all of them."""

AROUND: tuple[Subject, ...] = ("records", "tail")
"""What scenes depend on besides buildings and links."""

BETWEEN: tuple[Subject, ...] = ("buildings", "group", "impact", "laws")
"""What all links depend on: between which buildings they stand, and how these strike."""

_adapter = functools.cache(TypeAdapter)


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
    """

    def __init__(
        self,
        path: Path,
        text: str,
        root: Map,
        sampled: SweepAxis | None = None,
        reader: MotionReader | None = None,
        written: Study | None = None,
    ) -> None:
        self.model: Any
        self.from_data: bool
        self.path, self.text, self.file, self.written = path, text, shortened(path), written
        self.from_data = written.from_data if written is not None else isinstance(root.mark[0], str)
        refuse_other_kinds(root, self.file)
        problems, self.notes = Problems(self.file), Problems(self.file)
        _refuse_unnamed(root, problems)
        self.old_cases = refuse_old(root, problems)
        root = Map({key: node for key, node in root.items() if key != "bracket"}, root.mark, root.marks)
        self.root, self.middles = with_middles(root, problems)
        self.reader = reader or MotionReader(path.resolve().parent)
        self._over((*read_axes(self.root, problems), *((sampled,) if sampled is not None else ())))
        self._check(problems)
        self.title = self.model.title or shortened(path.stem)
        self._say_axes()
        _refuse_twins(self.axes, self.swept[: len(self.swept) - (sampled is not None)], problems)
        problems.check()
        self.warnings: tuple[Problem, ...] = written.warnings if written is not None else plausible.warnings(self)

    def _over(self, axes: Sequence[SweepAxis]) -> None:
        """Take the axes, and forget what was known of others."""
        self.swept = tuple(axes)
        self.base: Point = (-1,) * len(self.swept)
        self.met: dict[Problem, Point] = {}
        self._touched = [touched_by(axis.names, self.root) for axis in self.swept]
        self._masks: dict[tuple[Subject, ...], tuple[bool, ...]] = {}
        self._kept: dict[Any, tuple[Any, tuple[Problem, ...]]] = {}
        self._alike: dict[Any, tuple[Link, ...]] = {}  # links by what they follow from
        self._latest: tuple[Point, Map] | None = None  # the tree that was asked for last
        self._last: tuple[Point, build.Group] | None = None  # the group that was asked for last, if it is sound

    def _say_axes(self) -> None:
        self.axes = tuple(Axis(axis.names, tuple(_values(axis)), axis.units) for axis in self.swept)

    def narrow(self, axes: Sequence[SweepAxis]) -> None:
        """Keep some of the points of the sweep."""
        self._over(axes)
        self._say_axes()

    # What stands at a point

    def touching(self, section: str, place: int | None = None) -> tuple[bool, ...]:
        """For every axis of the sweep, whether it can change a section of the file (`buildings`, `records`, ...).

        place : of a building in the group; then whether it can change that one
        """
        return self.touches(section if place is None else (section, self.model.group[place]))

    def touches(self, *subjects: Subject) -> tuple[bool, ...]:
        """For every axis, whether it touches one of `subjects`."""
        mask = self._masks.get(subjects)
        if mask is None:
            mask = self._masks[subjects] = tuple(not touched.isdisjoint(subjects) for touched in self._touched)
        return mask

    def key(self, point: Point, subjects: tuple[Subject, ...]) -> Point:
        """A point with the axes set aside that touch none of some subjects."""
        mask = self._masks.get(subjects) or self.touches(*subjects)
        if True not in mask:
            return self.base
        if False not in mask:
            return point
        return tuple([place if mine else -1 for place, mine in zip(point, mask, strict=True)])

    def once(
        self, name: Any, point: Point, subjects: tuple[Subject, ...], work: Callable[[Point, Problems], Any]
    ) -> Any:
        """An answer at a point, worked out once for all points that do not differ in what it depends on; what is wrong
        is in `met`, with the point where the other axes are set aside."""
        place = self.key(point, subjects)
        found = self._kept.get((name, place))
        if found is None:
            own = Problems(self.file)
            found = work(place, own), tuple(own.found)
            keep(self._kept, (name, place), found)
        if found[1]:
            self.met |= dict.fromkeys(found[1], place)
        return found[0]

    def _patched(self, point: Point, *sections: str) -> Map:
        """The tree with the swept values of some sections, all unless given, at a point."""
        root = self.root
        for place, axis in zip(point, self.swept, strict=True):
            if place < 0:
                continue
            for path, value, mark in zip(axis.paths, axis.given[place], axis.marks[place], strict=True):
                if (not sections or path[0] in sections) and value is not UNWRITTEN:
                    root = put(root, path, value, mark)
        return root

    def tree(self, point: Point) -> Map:
        """The whole tree at a point, `like:` and links as the schema takes them; made to place problems."""
        if self._latest is not None and self._latest[0] == point:
            return self._latest[1]
        root = self._patched(point)
        found = Map(root, root.mark, root.marks)
        if "buildings" in found:
            found["buildings"] = inherited(root["buildings"], Problems(""))
        if isinstance(cases := root.get("cases"), Map):
            impact, laws = root.get("impact"), root.get("laws") or ()
            found["cases"] = Map({n: links_of(c, impact, laws) for n, c in cases.items()}, cases.mark, cases.marks)
        self._latest = point, found
        return found

    def at(self, point: Point) -> Callable[[], Map]:
        """As `tree`, made when it is first asked for: most points have no problems."""
        return functools.cache(lambda: self.tree(point))

    def _valid(self, kind: Any, value: Any, path: tuple[str, ...], point: Point, problems: Problems) -> Any:
        try:
            return _adapter(kind).validate_python(value)
        except ValidationError as error:
            problems.validation(self.tree(point), error, path, schema.Study)
            return None

    def section(self, point: Point, name: str) -> Any:
        """A validated section other than buildings and cases, or its default; None where it is faulty."""
        return self.once(("section", name), point, (name,), lambda at, problems: self._section(at, name, problems))

    def _section(self, at: Point, name: str, problems: Problems) -> Any:
        field, root = schema.Study.model_fields[name], self._patched(at, name)
        if root.get(name) is None:
            return None if field.is_required() else field.get_default()
        kind, value = field.rebuild_annotation(), root[name]
        found = self._valid(kind, value, (name,), at, problems)
        if found is not None or not isinstance(value, Map):
            return found
        # What remains without the faulty entries: the rest is looked at too.
        try:
            _adapter(kind).validate_python(value)
        except ValidationError as error:
            faulty = {str(item["loc"][0]) for item in error.errors() if item["loc"]}
            harmless = {"duration": "whole", "scale": 1.0} if name == "records" else {}
            kept = {key: each for key, each in value.items() if key not in faulty}
            return self._valid(
                kind, {**{key: harmless[key] for key in faulty & harmless.keys()}, **kept}, (), at, Problems("")
            )

    def types(self, point: Point) -> dict[str, Building]:
        """The building types by name, those that are sound."""
        buildings = self.root.get("buildings")
        found = ((name, self.type(point, name)) for name in (buildings if isinstance(buildings, Map) else ()))
        return {name: built for name, built in found if built is not None}

    def _buildings(self, point: Point) -> Any:
        """The section `buildings` with every `like:` carried out."""

        def work(at: Point, problems: Problems) -> Any:
            return inherited(self._patched(at, "buildings").get("buildings"), problems)

        return self.once("buildings", point, ("buildings",), work)

    def building_spec(self, point: Point, name: str) -> BuildingSpec | None:
        """The validated keys of a building type."""
        tree = self._buildings(self.key(point, (("buildings", name),)))

        def work(at: Point, problems: Problems) -> Any:
            own = Problems(self.file)
            spec = self._valid(BuildingSpec, tree[name], ("buildings", name), at, own)
            like = like_of(get(self.root, "buildings", name))
            if own.found and like is not None and not _is_valid(BuildingSpec, tree.get(like)):
                whole = locate(tree, (name,))  # what the whole lacks is told of the one it is like
                own.found = {each: None for each in own.found if (each.line, each.column) != whole}
            problems.extend(own.found)
            return spec

        if not isinstance(tree, Map) or name not in tree:
            return None
        return self.once(("spec", name), point, (("buildings", name),), work)

    def type(self, point: Point, name: str) -> Building | None:
        """A building type."""
        spec = self.building_spec(point, name)

        def work(at: Point, problems: Problems) -> Building | None:
            path = ("buildings", name)
            try:
                return build.building(name, spec)
            except UnstableError as error:
                hint = "make it, or its foundation, stiffer or lighter, or write `p_delta: false`"
                problems.at(self.at(at), (*path, "p_delta"), str(error), hint)
            except (ValueError, FloatingPointError) as error:
                hint = "check the building's masses, heights, period and stiffness"
                problems.at(self.at(at), path, str(error), hint)
            return None

        return None if spec is None else self.once(("type", name), point, (("buildings", name),), work)

    def group(self, point: Point) -> build.Group | None:
        """The buildings by place and what meets between them; None where it is not sound."""
        place = self.key(point, ("buildings", "group"))
        if self._last is not None and self._last[0] == place:
            return self._last[1]
        types, names = self.types(point), self.section(point, "group")

        def work(at: Point, problems: Problems) -> build.Group | None:
            defined = list(self.root["buildings"]) if isinstance(self.root.get("buildings"), Map) else []
            if not defined or not build.check_group(names, defined, self.root, problems):
                return None
            if any(name not in types for name in names):
                return None
            group = build.Group.of(names, types, defined)
            slips = {
                building.name: plausible.slip_of_height(building, self.at(at), ("buildings", name))
                for name, building in zip(names, group.buildings, strict=True)
                if not all(common or strikes for common, strikes in zip(group.common, group.strikes, strict=True))
            }
            return group if build.check_meetings(group, slips, self.at(at), problems) else None

        group = None if names is None else self.once("group", point, ("buildings", "group"), work)
        self._last = None if group is None else (place, group)
        return group

    def laws(self, point: Point) -> dict[str, OwnLaw]:
        """The laws of the study's own by name."""
        specs = self.section(point, "laws") or {}
        return self.once("laws", point, ("laws",), lambda at, problems: own_laws(specs, self.at(at), problems))

    def case(self, point: Point, name: str) -> Case | None:
        """A validated case."""

        def work(at: Point, problems: Problems) -> Case | None:
            root = self._patched(at, "cases", "impact")
            case = links_of(root["cases"][name], root.get("impact"), self.root.get("laws") or ())
            return self._valid(Case, case, ("cases", name), at, problems)

        return None if name in self.old_cases else self.once(("case", name), point, (("cases", name), "impact"), work)

    def links(self, point: Point, name: str) -> tuple[Link, ...] | None:
        """The links of a case; None where something is wrong."""
        subjects = (*BETWEEN, ("cases", name))
        kept = self._kept.get((("links", name), self.key(point, subjects)))
        if kept is not None and kept[0] is not None:  # sound, and so is all that it follows from
            return kept[0]
        case, group, laws, impact = (
            self.case(point, name),
            self.group(point),
            self.laws(point),
            self.section(point, "impact"),
        )
        if case is None or impact is None or not check_contact(impact.law, laws, self.root, Problems("")):
            return None
        if group is None:
            defined = list(self.root["buildings"]) if isinstance(self.root.get("buildings"), Map) else []
            group = build.Group((), self.types(point), (), (), defined)

        def work(at: Point, problems: Problems) -> tuple[Link, ...] | None:
            def note(path: tuple[str | int, ...], message: str, hint: str) -> None:
                problems.at(self.at(at), path, message, hint)

            key = content(case, group, impact, laws)
            found = self._alike.get(key) or scene_links(case, group, impact, laws, ("cases", name), note)
            if key is not None and found is not None:
                keep(self._alike, key, found)
            return found

        return self.once(("links", name), point, subjects, work)

    def motions(self, point: Point) -> Mapping[str, Used]:
        """The motions by name at a point of the sweep (one index an axis), cut and scaled."""
        spec = self.section(point, "records")

        def work(at: Point, problems: Problems) -> dict[str, Used]:
            return motions_of(spec, self.reader, self.at(at), problems, self.notes)

        return {} if spec is None else self.once("motions", point, ("records",), work)

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
        """The unit the study writes a quantity in, to show it to people: one of `plain.PLACES`, e.g. gap."""
        from pounding_cli.study.plain import unit_in

        source = self.written or self
        return unit_in(source._patched((0,) * len(source.swept)), quantity)

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

    def design_displacements(self, point: Point, name: str) -> np.ndarray | None:
        """Displacements a building type is designed for [m], shape (n,), from the ground up; None without a code."""
        spec: Any = self.building_spec(point, name)
        building: Any = self.type(point, name)
        work = lambda at, problems: build.design_displacements(spec, building)  # noqa: E731
        return self.once(("design", name), point, (("buildings", name),), work)

    def code_displacements(self, point: Point, name: str) -> Mapping[str, np.ndarray]:
        """Displacements of a building type that codes expect, by rule (`build.code_displacements`) [m]."""
        spec: Any = self.building_spec(point, name)
        building: Any = self.type(point, name)
        work = lambda at, problems: build.code_displacements(spec, building)  # noqa: E731
        return self.once(("codes", name), point, (("buildings", name),), work)

    def separations(self, point: Point) -> np.ndarray:
        """The code's separation of every building from the next one to the right [m], shape (buildings,).

        NaN for the last, and where the yield shears of a neighbour were not set by a code.
        """
        allowed = [self.design_displacements(point, name) for name in self.model.group]
        return np.array([*(build.separation(left, right) for left, right in pairwise(allowed)), None], dtype=float)

    def resolved(self) -> dict[str, Any]:
        """The study as plain data: every default filled in, SI numbers, the sweep set aside.

        Buildings also carry what was derived (`derived`: mass, height, stiffness, yield_shear, alpha, beta,
        period); the places of the group are under `places`, and `separation` holds the code separation [m] of
        each pair of neighbours, None where no code set the yield shears.
        """
        plain: dict[str, Any] = shown(self.model)
        plain["title"], plain["bracket"] = self.title, list(self.middles)
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

    def _check(self, problems: Problems) -> None:
        """Look at the study as written and at every value of every axis.  Raises `InputError`."""
        root = self.tree(self.base)
        model = None
        try:
            model = schema.Study.model_validate(root)
        except ValidationError as error:
            problems.validation(root, error, (), schema.Study, told=("buildings", "cases"))
        problems.extend(self._problems(self.base))
        if self.root.get("uncertain") is not None:
            from pounding_cli.study.vary import read_uncertain  # here: few studies have distributions

            read_uncertain(self.root, problems)
        faulty = bool(problems.found)
        for number, axis in enumerate(self.swept):
            for place in range(len(axis)):
                point = (*self.base[:number], place, *self.base[number + 1 :])
                problems.extend(_at_value(self._problems(point, self._touched[number]), axis, place, faulty))
        if model is not None:
            self.model = model
            self._check_names(root, problems)
            check_keep(self, problems)
        problems.check()

    def _problems(self, point: Point, touched: frozenset[Subject] | None = None) -> tuple[Problem, ...]:
        """Everything wrong at a point with what some subjects may change, all unless given."""
        self.met.clear()

        def changes(*subjects: Subject) -> bool:
            return touched is None or not touched.isdisjoint(subjects)

        if changes("records"):
            self.motions(point)
        if changes("tail"):
            self.section(point, "tail")
        if changes("buildings", "group"):
            self._buildings(point)
            self.group(point)
        if changes("impact", "laws") and (impact := self.section(point, "impact")) is not None:
            laws = self.laws(point)
            check = lambda at, problems: check_contact(impact.law, laws, self.at(at), problems)  # noqa: E731
            self.once("contact", point, ("impact", "laws"), check)
        cases = self.root.get("cases")
        for name in cases if isinstance(cases, Map) else ():
            if changes(*BETWEEN, ("cases", name)):
                self.links(point, name)
        return tuple(self.met)

    def _check_names(self, root: Map, problems: Problems) -> None:
        """Names that the whole study must know."""
        spec = self.model
        for place, case in enumerate(spec.report.plot or ()):
            if case not in spec.cases:
                problems.at(root, ("report", "plot", place), f"plot: no case '{case}'", nearest(case, spec.cases))
        known, wanted = dict.fromkeys((*build.places(spec.group), *spec.group)), spec.report.building
        if wanted is not None and wanted not in known:
            problems.at(root, ("report", "building"), f"no building '{wanted}' in the group", nearest(wanted, known))


def load_study(path: str | Path) -> Study:
    """Read and validate a study file.

    Raises `InputError` with every problem found in it, each with file, line, column, message and hint. The
    study as written is checked, and every value of every axis on its own; `expand` checks their combinations.
    """
    path = Path(path)
    return Study(path, *read_study(path))


def keep(answers: dict[Any, Any], key: Any, answer: Any) -> None:
    """Keep an answer, and the latest ones before it."""
    if len(answers) >= MOST_KEPT:
        del answers[next(iter(answers))]
    answers[key] = answer


def _is_valid(kind: Any, value: Any) -> bool:
    try:
        _adapter(kind).validate_python(value)
    except ValidationError:
        return False
    return True


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
        if name in seen or get(buildings, name, *path[1:]) is not None:
            return False
        seen.add(name)
        like = like_of(buildings.get(name))
        if like is None:
            return False
        name = like
    return True


def _refuse_unnamed(root: Map, problems: Problems) -> None:
    """Raise `InputError` where the keys of one case, or of one building, stand where names belong."""
    varied = [key.split(".") for key in plausible.swept_keys(root)]
    links = {"links", *(key for link in link_models().values() for key in fields_of(link))}
    buildings = {info.alias or key for key, info in BuildingSpec.model_fields.items()}
    for section, known, needed, what, name in (
        ("cases", links, "link", "case", "pair"),
        ("buildings", buildings, "storeys", "building", "A"),
    ):
        node = root.get(section)
        if (
            not isinstance(node, Map)
            or needed not in node
            or not known.issuperset(node)
            or isinstance(node[needed], Map)
        ):
            continue
        name = next((path[1] for path in varied if path[0] == section and len(path) > 2), name)
        whole = f"{{{', '.join(f'{key}: {value}' for key, value in node.items())}}}"[:200]
        hint = f"write e.g. `{section}: {{{name}: {whole}}}`; '{name}' names the {what}"
        problems.add(root.marks[section][1], f"the {what} under `{section}:` has no name", hint)
    problems.check()


def _at_value(problems: Sequence[Problem], axis: SweepAxis, index: int, faulty: bool) -> list[Problem]:
    """Problems at one value of an axis; those that stand elsewhere in the file name that value."""
    lines, here = {mark[0] for mark in axis.marks[index]}, []
    for problem in problems:
        if problem.line in lines or problem.file in lines:
            here.append(problem)
        elif not faulty:
            here.append(replace(problem, message=f"{problem.message} (where {axis.told(index)})"))
    return here


def _values(axis: SweepAxis) -> Iterator[tuple[float | str, ...]]:
    """SI numbers where the values are quantities, the file's words where they are not."""
    paths = [tuple(path) for path in axis.paths]
    for row in axis.given:
        yield tuple(value_at(schema.Study, path, value) for path, value in zip(paths, row, strict=True))


def _refuse_twins(said: Sequence[Axis], axes: Sequence[SweepAxis], problems: Problems) -> None:
    """Note points of an axis that are one and the same: 0.5 and 1/2."""
    for axis, written in zip(said, axes, strict=False):
        first: dict[tuple[float | str, ...], int] = {}
        for place, values in enumerate(axis.values):
            if values in first:
                one, other = (", ".join(map(str, written.given[number])) for number in (first[values], place))
                what = f"{one} occurs twice" if one == other else f"{one} and {other} are the same and stand"
                where = ", ".join(axis.names)
                problems.add(written.marks[place][0], f"{what} on the axis '{where}'", "remove one of the two")
            first.setdefault(values, place)
