"""`expand`: every point of the sweep, case, analysis and record as a row, its scene and baselines as digests."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from sys import intern

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Digests, Scene
from pounding_cli.study.digits import cheap_accuracy
from pounding_cli.study.keep import kept_rows
from pounding_cli.study.load import Study
from pounding_cli.study.motions import Used
from pounding_cli.study.plan import Axis, Plan
from pounding_cli.study.resolve import Resolver, places
from pounding_cli.study.scenes import Frame, Rows, Scenes, seen
from pounding_cli.study.schema import StudyModel
from pounding_cli.study.sections import Point

MOST_PROBLEMS = 20
"""After so many problems in combinations of sweep values the rest is not looked at."""


MOST_AROUND = 256
"""Buildings with motions that are kept at a time: motions are long."""


Links = Callable[[Point, str], tuple[Link, ...] | None]
"""links(point, case) -> what stands between the buildings of the group, which depends on these, `impact` and the case
alone."""


Asks = Callable[[Point, str, Analysis, str], bool]
"""asks(point, case, analysis, record) -> whether the scenes of a row are wanted."""


def expand(study: Study, links_of: Links | None = None, asks: Asks | None = None) -> Plan:
    """The plan of a study.  Raises `InputError` where a combination of sweep values is not sound.

    links_of : what stands between the buildings in place of what the study says
    asks : which rows have scenes; all unless given
    """
    model, resolver = study.model, study.resolver
    cases, analyses = tuple(model.cases), tuple(Analysis(word) for word in model.analyses)
    records = tuple(study.motions(resolver.base))
    frame = Frame(
        (*(len(axis.values) for axis in study.axes), len(cases), len(analyses), len(records)),
        cases,
        tuple(str(analysis) for analysis in analyses),
        records,
    )
    builder = _Builder(resolver, links_of or resolver.links, cases, analyses, records)
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
        around = builder.around(point)
        buildings, motions, tail = around.buildings, around.motions, around.tail
        for case in cases:
            links = builder.links(point, case)
            shown, linked = seen(links), Digests(buildings, links)
            for (analysis, record), baselines in around.alone.items():
                if asks is not None and not asks(point, case, analysis, record):
                    rows.add("", ("",) * len(baselines), shown)
                    continue
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
class _Around:
    """What is around the links at a point: buildings, motions, tail [s]; and what analyses and motions are asked."""

    buildings: tuple[Building, ...]
    motions: Mapping[str, Used]
    tail: float
    asked: tuple[tuple[Analysis, str], ...]

    @cached_property
    def alone(self) -> dict[tuple[Analysis, str], tuple[str, ...]]:
        """Digests of the buildings alone by analysis and motion. Who builds scenes needs none."""
        free = [Digests((building,), ()) for building in self.buildings]
        return {  # many points share a building: its digest is held once
            (analysis, record): tuple(
                intern(each.of(self.motions[record].motion, analysis, self.tail)) for each in free
            )
            for analysis, record in self.asked
        }


class _Builder:
    """Builds the scene at a place of the tables; the study was validated there. Scenes share buildings, links and
    motions that are the same."""

    def __init__(
        self,
        resolver: Resolver,
        links_of: Links,
        cases: tuple[str, ...],
        analyses: tuple[Analysis, ...],
        records: tuple[str, ...],
    ) -> None:
        self._resolver, self._links_of = resolver, links_of
        self._cases, self._analyses, self._records = cases, analyses, records
        self._asked = tuple(product(analyses, records))
        self._around: dict[Point, _Around] = {}
        self._links: dict[tuple[str, Point], tuple[Link, ...]] = {}

    def around(self, point: Point) -> _Around:
        """What is around the links at a point."""
        key = self._resolver.key(point, ("buildings", "group", "records", "tail"))
        found = self._around.get(key)
        if found is None:
            found = self._around_anew(point)
            _keep(self._around, key, found, MOST_AROUND)
        return found

    def _around_anew(self, point: Point) -> _Around:
        group, motions = self._resolver.group(point), self._resolver.motions(point)
        assert group is not None
        assert motions is not None
        tail = self._resolver.section(point, "tail")
        return _Around(tuple(group.buildings), motions, tail, self._asked)

    def links(self, point: Point, case: str) -> tuple[Link, ...]:
        """The links of a case at a point."""
        key = case, self._resolver.key(point, ("buildings", "group", "impact", "laws", ("cases", case)))
        found = self._links.get(key)
        if found is None:
            found = self._links_of(point, case)
            assert found is not None
            _keep(self._links, key, found, self._resolver.most_kept)
        return found

    def __call__(self, point: Point, case: int, analysis: int, record: int) -> Scene:
        around, links = self.around(point), self.links(point, self._cases[case])
        motion = around.motions[self._records[record]].motion
        return Scene(around.buildings, links, motion, self._analyses[analysis], around.tail)


def _keep(answers: dict, key: object, answer: object, most: int) -> None:
    """Keep an answer, and the latest ones before it."""
    if len(answers) >= most:
        del answers[next(iter(answers))]
    answers[key] = answer


def _at_point(problem: Problem, axes: tuple[Axis, ...], point: tuple[int, ...]) -> Problem:
    place = ", ".join(
        f"{name} = {value}"
        for axis, index in zip(axes, point, strict=True)
        for name, value in zip(axis.names, axis.shown(index), strict=True)
    )
    return Problem(f"{problem.message} (where {place})", problem.hint, problem.file, problem.line, problem.column)
