"""`expand`: every point of the sweep, case, analysis and record as a scene, equal scenes only once."""

from __future__ import annotations

from itertools import product

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.building import Building
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records import Motion
from pounding_cli.study.load import Study
from pounding_cli.study.motions import Used
from pounding_cli.study.plan import Axis, Plan, Row
from pounding_cli.study.resolve import places

MOST_PROBLEMS = 20
"""After so many problems in combinations of sweep values the rest is not looked at."""


def expand(study: Study) -> Plan:
    """The plan of a study.  Raises `InputError` where a combination of sweep values is not sound."""
    model, resolver = study.model, study.resolver
    cases, analyses = tuple(model.cases), tuple(Analysis(word) for word in model.analyses)
    maker = _Maker()
    problems: dict[Problem, None] = {}
    rows: list[Row] = []
    shown: dict[str, Used] = {}
    records: tuple[str, ...] = ()
    for point in product(*(range(len(axis.values)) for axis in study.axes)):
        found = resolver.problems(point) if len(study.axes) > 1 else ()
        if found:
            problems |= dict.fromkeys(_at_point(problem, study.axes, point) for problem in found)
            if len(problems) >= MOST_PROBLEMS:
                break
            continue
        street, motions, tail = (
            resolver.group(point),
            resolver.motions(point),
            resolver.section(point, "tail"),
        )
        assert street is not None
        assert motions is not None
        shown, records = shown or motions, records or tuple(motions)
        buildings = tuple(street.group)
        for case in cases:
            links = resolver.links(point, case)
            assert links is not None
            for analysis in analyses:
                for record, used in motions.items():
                    scene = maker.keep(Scene(buildings, links, used.motion, analysis, tail))
                    baselines = tuple(maker.alone(building, used.motion, analysis, tail) for building in buildings)
                    rows.append(Row(point, case, str(analysis), record, scene, baselines))
    if problems:
        raise InputError(sorted(problems, key=lambda p: (p.line, p.column, p.message)))
    fixed_step = model.time_step
    return Plan(
        study=study,
        axes=study.axes,
        cases=cases,
        analyses=tuple(str(analysis) for analysis in analyses),
        records=records,
        buildings=places(model.group),
        scenes=maker.scenes,
        rows=tuple(rows),
        motions=tuple(used.use for used in shown.values()),
        accuracy=model.accuracy if fixed_step is None else fixed_step,
        method=model.method,
        estimate=model.estimate,
    )


class _Maker:
    """Keeps every scene once, by digest."""

    def __init__(self) -> None:
        self.scenes: dict[str, Scene] = {}
        self._alone: dict[tuple[str, str, Analysis, float], str] = {}

    def keep(self, scene: Scene) -> str:
        self.scenes.setdefault(scene.digest, scene)
        return scene.digest

    def alone(self, building: Building, motion: Motion, analysis: Analysis, tail: float) -> str:
        key = (building.digest, motion.digest, analysis, tail)
        if key not in self._alone:
            self._alone[key] = self.keep(Scene((building,), (), motion, analysis, tail))
        return self._alone[key]


def _at_point(problem: Problem, axes: tuple[Axis, ...], point: tuple[int, ...]) -> Problem:
    place = ", ".join(
        f"{name} = {value}"
        for axis, index in zip(axes, point, strict=True)
        for name, value in zip(axis.names, axis.values[index], strict=True)
    )
    return Problem(f"{problem.message} (where {place})", problem.hint, problem.file, problem.line, problem.column)
