"""`expand`: every point of the sweep, case, analysis and record as a row, its scene and baselines as digests."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Digests, Scene
from pounding_cli.study.digits import cheap_accuracy
from pounding_cli.study.keep import kept_rows
from pounding_cli.study.load import Study
from pounding_cli.study.motions import Used
from pounding_cli.study.plan import Axis, Plan
from pounding_cli.study.resolve import Point, Resolver, places
from pounding_cli.study.scenes import Frame, Rows, Scenes, seen
from pounding_cli.study.schema import StudyModel

MOST_PROBLEMS = 20
"""After so many problems in combinations of sweep values the rest is not looked at."""


Links = Callable[[Point, str], tuple[Link, ...] | None]
"""links(point, case) -> what stands between the buildings of the group."""


def expand(study: Study, links_of: Links | None = None) -> Plan:
    """The plan of a study.  Raises `InputError` where a combination of sweep values is not sound.

    links_of : what stands between the buildings in place of what the study says
    """
    model, resolver = study.model, study.resolver
    links_of = links_of or resolver.links
    cases, analyses = tuple(model.cases), tuple(Analysis(word) for word in model.analyses)
    records = tuple(study.motions(resolver.base))
    frame = Frame(
        (*(len(axis.values) for axis in study.axes), len(cases), len(analyses), len(records)),
        cases,
        tuple(str(analysis) for analysis in analyses),
        records,
    )
    builder = _Builder(resolver, links_of, cases, analyses, records)
    rows = Rows(frame)
    scenes = Scenes(frame, len(model.group), builder)
    problems: dict[Problem, None] = {}
    for point in product(*(range(len(axis.values)) for axis in study.axes)):
        found = resolver.problems(point) if len(study.axes) > 1 else ()
        if found:
            problems |= dict.fromkeys(_at_point(problem, study.axes, point) for problem in found)
            if len(problems) >= MOST_PROBLEMS:
                break
        if problems:
            continue
        buildings, motions, tail = builder.around(point)
        free = [Digests((building,), ()) for building in buildings]
        alone = {
            (analysis, record): tuple(each.of(motions[record].motion, analysis, tail) for each in free)
            for analysis in analyses
            for record in records
        }
        for case in cases:
            links = links_of(point, case)
            assert links is not None
            shown, linked = seen(links), Digests(buildings, links)
            for (analysis, record), baselines in alone.items():
                scene = linked.of(motions[record].motion, analysis, tail)
                scenes.note(scene, len(rows))
                for place, baseline in enumerate(baselines):
                    scenes.note(baseline, len(rows), place)
                rows.add(scene, baselines, shown)
    if problems:
        raise InputError(sorted(problems, key=lambda p: (p.line, p.column, p.message)))
    kept, every = kept_rows(model, resolver.root, resolver.axes, rows, scenes, resolver.file)
    return Plan(
        study=study,
        axes=study.axes,
        cases=cases,
        analyses=tuple(str(analysis) for analysis in analyses),
        records=records,
        buildings=places(model.group),
        scenes=scenes,
        rows=rows,
        motions=tuple(used.use for used in study.motions((0,) * len(study.axes)).values()),
        accuracy=_accuracy(model),
        time_step=model.time_step,
        method=model.method,
        estimate=model.estimate,
        kept=kept,
        every=every,
    )


def _accuracy(model: StudyModel) -> float:
    """The relative error wanted [-]."""
    return cheap_accuracy() if isinstance(model.accuracy, str) else model.accuracy


@dataclass(frozen=True)
class _Builder:
    """Builds the scene at a place of the tables; the study was validated there."""

    resolver: Resolver
    links_of: Links
    cases: tuple[str, ...]
    analyses: tuple[Analysis, ...]
    records: tuple[str, ...]

    def around(self, point: Point) -> tuple[tuple[Building, ...], Mapping[str, Used], float]:
        """Buildings, motions and tail [s] at a point."""
        street, motions = self.resolver.group(point), self.resolver.motions(point)
        assert street is not None
        assert motions is not None
        return tuple(street.group), motions, self.resolver.section(point, "tail")

    def __call__(self, point: Point, case: int, analysis: int, record: int) -> Scene:
        buildings, motions, tail = self.around(point)
        links = self.links_of(point, self.cases[case])
        assert links is not None
        return Scene(buildings, links, motions[self.records[record]].motion, self.analyses[analysis], tail)


def _at_point(problem: Problem, axes: tuple[Axis, ...], point: tuple[int, ...]) -> Problem:
    place = ", ".join(
        f"{name} = {value}"
        for axis, index in zip(axes, point, strict=True)
        for name, value in zip(axis.names, axis.shown(index), strict=True)
    )
    return Problem(f"{problem.message} (where {place})", problem.hint, problem.file, problem.line, problem.column)
