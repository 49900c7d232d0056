"""`load_study`: a study file read and validated to the last sweep value, every problem named at its line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from pounding_cli import records
from pounding_cli.errors import Problem
from pounding_cli.methods import TIME_STEP, setting_of
from pounding_cli.model.building import Building
from pounding_cli.numbers import Unit
from pounding_cli.reading import shortened
from pounding_cli.study import buildings as building_room
from pounding_cli.study.bracket import with_brackets
from pounding_cli.study.building_schema import BuildingSpec
from pounding_cli.study.case_schema import CaseSpec
from pounding_cli.study.held import tell_held
from pounding_cli.study.keep import check_keep
from pounding_cli.study.kinds import refuse_other_kinds
from pounding_cli.study.motion_reader import MotionReader
from pounding_cli.study.motions import Used
from pounding_cli.study.plan import Axis
from pounding_cli.study.plausible import doubt_accelerations, few, swept_keys
from pounding_cli.study.problems import Problems, nearest
from pounding_cli.study.resolve import Resolver, places, shown
from pounding_cli.study.schema import StudyModel
from pounding_cli.study.source import Node
from pounding_cli.study.sweep import SweepAxis, read_axes
from pounding_cli.study.written import unit_in, unit_of
from pounding_cli.study.yaml_file import read_source

MOST_CORNERS = 256
"""Combinations of swept values that are looked at for what is implausible together."""


@dataclass(frozen=True, eq=False)
class Study:
    """A validated study.

    Attributes
    ----------
    path : the file
    text : the file as written
    title : its title or its name
    axes : the axes of the sweep
    warnings : what is allowed but should be known
    model, resolver : the study as written, and what answers for every point of the sweep
    from_data : it is Python data; no file holds it
    written : the study it was made from, whose units people read; itself unless given
    """

    path: Path
    text: str
    title: str
    axes: tuple[Axis, ...]
    warnings: tuple[Problem, ...]
    model: StudyModel
    resolver: Resolver
    from_data: bool = False
    written: Study | None = None

    def building(self, point: tuple[int, ...], place: int) -> Building:
        """The building at a place of the group, from 0, at a point of the sweep (one index an axis)."""
        building = self.resolver.type(point, self.model.group[place])
        assert building is not None  # the study was validated at every point
        return building

    def assumed_heights(self) -> tuple[str, ...]:
        """The buildings of the group, by place, whose storey heights the study leaves to their default."""
        specs = self.resolver.section((0,) * len(self.axes), "buildings")
        given = (specs[name].model_fields_set for name in self.model.group)
        return tuple(place for place, keys in zip(places(self.model.group), given, strict=True) if "height" not in keys)

    def touching(self, section: str, place: int | None = None) -> tuple[bool, ...]:
        """For every axis of the sweep, whether it can change a section of the file (`buildings`, `records`, ...).

        place : of a building in the group; then whether it can change that one
        """
        return self.resolver.touching(section if place is None else (section, self.model.group[place]))

    def motions(self, point: tuple[int, ...]) -> Mapping[str, Used]:
        """The motions by name at a point of the sweep (one index an axis), cut and scaled."""
        found = self.resolver.motions(point)
        assert found is not None  # the study was validated at every point
        return found

    def unit(self, quantity: str) -> Unit:
        """The unit the study writes a quantity in, to show it to people: one of `written.PLACES`, e.g. gap."""
        source = self.written or self
        return unit_in(source.resolver.root_at((0,) * len(source.axes)), quantity)

    def spectrum_match(self) -> records.SpectrumMatch | None:
        """The motions against the target spectrum they are scaled to, at the first point of the sweep; None without."""
        first = (0,) * len(self.axes)
        used = self.motions(first)
        target = next(iter(used.values())).target
        if target is None:
            return None
        scale = self.resolver.section(first, "records").scale
        motions = {name: each.motion for name, each in used.items()}
        return records.spectrum_match(motions, target, scale.spectrum == "each", scale.at_least)

    def separations(self, point: tuple[int, ...]) -> np.ndarray:
        """The code's separation of every building from the next one to the right [m], shape (buildings,).

        NaN for the last, and where the yield shears of a neighbour were not set by a code.
        """
        group, resolver = self.resolver.section(point, "group"), self.resolver
        allowed = {name: resolver.design_displacements(point, name) for name in dict.fromkeys(group)}
        found = [building_room.separation(allowed[left], allowed[right]) for left, right in pairwise(group)]
        return np.array([*found, None], dtype=float)

    def resolved(self) -> dict[str, Any]:
        """The study as plain data: every default filled in, SI numbers, the sweep set aside.

        Buildings also carry what was derived (`derived`: mass, height, stiffness, yield_shear, alpha, beta,
        period); the places of the group are under `places`, and `separation` holds the code separation [m] of
        each pair of neighbours, None where no code set the yield shears.
        """
        base, resolver = self.resolver.base, self.resolver
        plain: dict[str, Any] = shown(self.model)
        plain["title"] = self.title
        plain["sweep"] = [{"names": list(axis.names), "values": [list(v) for v in axis.values]} for axis in self.axes]
        types, group = resolver.types(base), resolver.group(base)
        assert types is not None
        assert group is not None
        for name, building in types.items():
            plain["buildings"][name]["derived"] = {
                **{key: getattr(building, key).tolist() for key in ("mass", "height", "stiffness")},
                "yield_shear": [None if value == float("inf") else value for value in building.yield_shear.tolist()],
                "alpha": building.alpha,
                "beta": building.beta,
                "period": float(building.periods[0]),
                **({} if building.gravity_load is None else {"theta": building.stability_coefficient.tolist()}),
            }
        plain["places"] = list(places(self.model.group))
        gaps = self.separations(base)[:-1].tolist()
        plain["separation"] = [None if gap != gap else gap for gap in gaps]
        return plain


def load_study(path: str | Path) -> Study:
    """Read and validate a study file.

    Raises `InputError` with every problem found in it, each with file, line, column, message and hint. The
    study as written is checked, and every value of every axis on its own; `expand` checks their combinations.
    """
    path = Path(path)
    return validated(path, *read_source(path))


def validated(
    path: Path, text: str, root: Node, sampled: SweepAxis | None = None, reader: MotionReader | None = None
) -> Study:
    """The study of a tree; `text` is what it says, record files are sought beside `path`. Raises as `load_study`.

    sampled : one more axis, whose points nobody wrote: what is unlikely at them is not told
    reader : of the study's motions, where one has read them already
    """
    file = shortened(path)
    refuse_other_kinds(root, file)
    problems = Problems(file)
    _refuse_unnamed(root, problems)
    root = with_brackets(root, problems)
    axes = read_axes(root, problems)
    _check_uncertain(root, problems)
    axes = axes if sampled is None else (*axes, sampled)
    resolver = Resolver(root, axes, file, reader or MotionReader(path.resolve().parent))
    problems.extend(resolver.problems(resolver.base))
    faulty = bool(problems.found)
    for place, axis in enumerate(axes):
        for index in range(len(axis)):
            point = (*resolver.base[:place], index, *resolver.base[place + 1 :])
            problems.extend(_at_value(resolver.problems(point), axis, index, faulty))
    model = resolver.model()
    if model is not None:
        _whole_study(model, root, problems)
        check_keep(model, root, axes, resolver.motions(resolver.base), problems)
    problems.refuse()
    assert model is not None
    said = _said(axes, resolver)
    _refuse_twins(said, axes if sampled is None else axes[:-1], problems)
    problems.refuse()
    for point in (*_along_axes(axes), *_corners(said)) if sampled is None else ():
        resolver.doubt(point)
    return Study(
        path,
        text,
        model.title or shortened(path.stem),
        said,
        _warnings(model, root, resolver),
        model,
        resolver,
    )


def _refuse_unnamed(root: Node, problems: Problems) -> None:
    """Raise `InputError` where the keys of one case, or of one building, stand where names belong."""
    varied = [key.split(".") for key in swept_keys(root)]
    sections: tuple[tuple[str, type[BaseModel], str, str, str], ...] = (
        ("cases", CaseSpec, "link", "case", "pair"),
        ("buildings", BuildingSpec, "storeys", "building", "A"),
    )
    for section, kind, needed, what, name in sections:
        node = root.get(section)
        known = {info.alias or key for key, info in kind.model_fields.items()}
        if node is None or not node.is_mapping or needed not in node.value or not known.issuperset(node.value):
            continue
        if node.value[needed].is_mapping:
            continue
        name = next((path[1] for path in varied if path[0] == section and len(path) > 2), name)
        whole = f"{{{', '.join(f'{key}: {each.text or each.plain()}' for key, each in node.value.items())}}}"[:200]
        message = f"the {what} under `{section}:` has no name"
        problems.add(node.mark, message, f"write e.g. `{section}: {{{name}: {whole}}}`; '{name}' names the {what}")
    problems.refuse()


def _check_uncertain(root: Node, problems: Problems) -> None:
    node = root.get("uncertain")
    if node is not None and node.value is not None:
        from pounding_cli.study.varied import read_uncertain  # here: few studies have distributions

        read_uncertain(node, root, problems)


def _at_value(problems: tuple[Problem, ...], axis: SweepAxis, index: int, faulty: bool) -> list[Problem]:
    """Problems at one value of an axis; those that stand elsewhere in the file name that value."""
    marks = {node.mark[0] for node in axis.nodes[index]}
    here = []
    for problem in problems:
        if problem.line in marks:
            here.append(problem)
        elif not faulty:
            value = ", ".join(
                f"{name} = {_text(node)}" for name, node in zip(axis.names, axis.nodes[index], strict=True)
            )
            message = f"{problem.message} (where {value})"
            here.append(Problem(message, problem.hint, problem.file, problem.line, problem.column))
    return here


def _along_axes(axes: tuple[SweepAxis, ...]) -> Iterator[tuple[int, ...]]:
    """The first point of the sweep, and those that differ from it in one value."""
    first = (0,) * len(axes)
    yield first
    for place, axis in enumerate(axes):
        for index in range(1, len(axis)):
            yield (*first[:place], index, *first[place + 1 :])


def _corners(axes: tuple[Axis, ...]) -> Iterator[tuple[int, ...]]:
    """The points where every axis is at an end of its values, at most MOST_CORNERS.

    What is judged grows or falls with each value, so that the worst combinations stand there."""
    ends: list[tuple[int, ...]] = []
    for axis in axes:
        order = sorted(range(len(axis.values)), key=lambda place: _size(axis.values[place]))
        ends.append((order[0], order[-1]) if 2 ** len(ends) < MOST_CORNERS else (0,))
    yield from product(*ends)


def _size(values: tuple[float | str, ...]) -> float:
    return next((value for value in values if not isinstance(value, str)), 0.0)


def _text(node: Node) -> str:
    return node.text or str(node.plain())


def _said(axes: tuple[SweepAxis, ...], resolver: Resolver) -> tuple[Axis, ...]:
    """The axes with SI numbers where the values are quantities, the file's words where they are not."""
    said = []
    for place, axis in enumerate(axes):
        rows = []
        for index, nodes in enumerate(axis.nodes):
            point = (*resolver.base[:place], index, *resolver.base[place + 1 :])
            rows.append(
                tuple(_value(resolver, point, path, node) for path, node in zip(axis.paths, nodes, strict=True))
            )
        units = axis.units or tuple(
            unit_of(StudyModel, path, [nodes[column] for nodes in axis.nodes]) for column, path in enumerate(axis.paths)
        )
        said.append(Axis(axis.names, tuple(rows), units))
    return tuple(said)


def _refuse_twins(said: tuple[Axis, ...], axes: tuple[SweepAxis, ...], problems: Problems) -> None:
    """Note points of an axis that are one and the same: 0.5 and 1/2."""
    for axis, written in zip(said, axes, strict=False):
        first: dict[tuple[float | str, ...], int] = {}
        for place, values in enumerate(axis.values):
            if values in first:
                texts = [", ".join(map(_text, written.nodes[number])) for number in (first[values], place)]
                both = texts[0] if texts[0] == texts[1] else f"{texts[0]} and {texts[1]} are the same and"
                where = ", ".join(axis.names)
                problems.add(
                    written.nodes[place][0].mark,
                    f"{both} {'occurs twice' if texts[0] == texts[1] else 'stand'} on the axis '{where}'",
                    "remove one of the two",
                )
            first.setdefault(values, place)


def _value(resolver: Resolver, point: tuple[int, ...], path: tuple[str, ...], node: Node) -> float | str:
    found: Any = resolver.section(point, path[0])
    for step in path[1:]:
        if isinstance(found, dict):
            found = found.get(step, found.get(int(step)) if step.isdigit() else None)
        elif isinstance(found, tuple) and step.isdigit():
            found = found[int(step)]
        elif found is not None:
            names = {info.alias or name: name for name, info in type(found).model_fields.items()}
            found = getattr(found, names[step])
    if found == (node.value,):  # one value where a list may stand
        found = node.value
    if isinstance(found, int | float) and not isinstance(found, bool):
        return float(found)
    return _text(node)


def _whole_study(model: StudyModel, root: Node, problems: Problems) -> None:
    """What concerns no section alone."""
    setting = setting_of(model.method)
    if setting is TIME_STEP and model.time_step is None:
        hint = f"write e.g. `time_step: {TIME_STEP.example}`"
        problems.at(root, ("method",), f"method: {model.method} needs 'time_step'", hint)
    if setting is not TIME_STEP and model.time_step is not None:
        problems.at(
            root,
            ("time_step",),
            f"'time_step' does not apply to method: {model.method}",
            "remove it; `accuracy:` controls the cost",
            key=True,
        )
    for place, case in enumerate(model.report.plot or ()):
        if case not in model.cases:
            problems.at(root, ("report", "plot", place), f"plot: no case '{case}'", nearest(case, model.cases))
    known = dict.fromkeys((*places(model.group), *model.group))
    if model.report.building is not None and model.report.building not in known:
        problems.at(
            root,
            ("report", "building"),
            f"no building '{model.report.building}' in the group",
            nearest(model.report.building, known),
        )
    for place, analysis in enumerate(model.analyses):
        if analysis in model.analyses[:place]:
            problems.at(root, ("analyses", place), f"'{analysis}' occurs twice", "remove one")


def _warnings(model: StudyModel, root: Node, resolver: Resolver) -> tuple[Problem, ...]:
    notes = resolver.warnings
    doubt_accelerations(root, notes)
    tell_held(model, root, resolver, notes)
    if model.impact.dashpot == "printed":
        notes.at(
            root,
            ("impact", "dashpot"),
            "eq. (7) as printed has the unit 1/s, not kg/s: its dashpot depends on the unit of mass",
            "leave it out for the dashpot that gives the coefficient of restitution",
        )
    return tuple(few(sorted(notes.found, key=lambda note: (note.file, note.line, note.column))))
