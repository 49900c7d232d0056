"""`expand`: every point of the sweep, case, analysis and record as a row, its scene and baselines as digests."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product, starmap
from operator import add

import numpy as np

from pounding_cli.digests import DIGEST
from pounding_cli.errors import InputError, Problem
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Digests, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.study.build import places
from pounding_cli.study.keep import kept_rows
from pounding_cli.study.motions import Used
from pounding_cli.study.plan import Axis, Plan
from pounding_cli.study.scenes import Expanded, Frame, LinkSets, Rows, Scenes, in_order, seen
from pounding_cli.study.study import AROUND, BETWEEN, Point, Study

MOST_PROBLEMS = 20
"""After so many problems in combinations of sweep values the rest is not looked at."""


MOST_AROUND = 256
"""Buildings with motions that are kept at a time: motions are long."""

MOST_LINKS = 4096
"""Points and cases whose links are kept at a time."""

MOST_ALIKE = 256
"""Sets of links that are known again at other points."""


Links = Callable[[Point, str], tuple[Link, ...] | None]
"""links(point, case) -> what stands between the buildings of the group, which depends on these, `impact` and the case
alone."""


Asks = Callable[[Point, str, Analysis, str], bool]
"""asks(point, case, analysis, record) -> whether the scenes of a row are wanted."""


def expand(
    study: Study, links_of: Links | None = None, asks: Asks | None = None, known: Expanded | None = None
) -> Plan:
    """The plan of a study.  Raises `InputError` where a combination of sweep values is not sound.

    What an axis does not touch is worked out once for all its values: every case by itself, every building alone.

    links_of : what stands between the buildings in place of what the study says
    asks : which rows have scenes; all unless given
    known : what this very study came to before

    Raises `ValueError` where that is of another study.
    """
    model = study.model
    cases, analyses = tuple(model.cases), tuple(Analysis(word) for word in model.analyses)
    records = tuple(study.motions(study.base))
    frame = Frame(
        (*(len(axis.values) for axis in study.axes), len(cases), len(analyses), len(records)),
        cases,
        tuple(str(analysis) for analysis in analyses),
        records,
    )
    builder = _Builder(study, links_of or study.links, frame)
    found = known or _Digests(study, frame, builder).expanded(asks)
    if found.scenes.shape != (math.prod(frame.shape), 1 + len(model.group)):
        raise ValueError("another study")
    rows, scenes = Rows(frame, found), Scenes(found, builder)
    kept, every = kept_rows(study, rows, scenes)
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
        accuracy=model.accuracy,
        time_step=model.time_step,
        method=model.method,
        estimate=model.estimate,
        kept=kept,
        every=every,
    )


@dataclass(frozen=True)
class _Around:
    """What is around the links at a point: buildings, motions, tail [s]."""

    buildings: tuple[Building, ...]
    motions: Mapping[str, Used]
    tail: float


class _Digests:
    """Gathers the digests of all scenes and what tables say of their links."""

    def __init__(self, study: Study, frame: Frame, builder: _Builder) -> None:
        self._study, self._frame, self._builder = study, frame, builder
        self._sizes = frame.shape[:-3]
        self._around = study.touches(*AROUND)
        self._content = bytearray()
        self._scenes = np.empty((*frame.shape, 1 + len(study.model.group)), np.int32)
        self._problems: dict[Problem, None] = {}
        study.met.clear()
        self._links = np.empty((*self._sizes, len(frame.cases)), np.int32)
        self._sets = LinkSets()

    def expanded(self, asks: Asks | None) -> Expanded:
        """All of it.  Raises `InputError`."""
        for place, _ in enumerate(self._frame.cases):
            self._add_case(place)
        self._refuse()
        for place, _ in enumerate(self._study.model.group):
            self._add_building(place)
        scenes = self._scenes.reshape(-1, self._scenes.shape[-1])
        if asks is not None:
            frame, points = self._frame, product(*map(range, self._sizes))
            names = product(points, frame.cases, map(Analysis, frame.analyses), frame.records)
            scenes[~np.fromiter(starmap(asks, names), bool, len(scenes))] = -1
        digests = np.frombuffer(self._content, np.uint8).reshape(-1, DIGEST)
        return Expanded(*in_order(digests, scenes), self._links.ravel(), self._sets)

    def _add_case(self, place: int) -> None:
        """The scenes of a case."""
        case, builder, numbers = self._frame.cases[place], self._builder, array("i")
        met: dict[tuple[Link, ...], tuple[int, list[str]]] = {}  # numbers and words of the latest ones

        def begin(point: Point) -> Digests | None:
            self._study.links(point, case)  # what is wrong with them, and with what they stand between
            if self._met():
                return None
            links = builder.links(point, case)
            found = met.get(links)
            if found is None:
                found = self._sets.number(seen(links)), [link.words for link in links]
                _keep(met, links, found, MOST_ALIKE)
            numbers.append(found[0])
            return Digests(builder.buildings(point), links, found[1])

        own = self._study.touches(*BETWEEN, ("cases", case))
        self._scenes[..., place, :, :, 0] = self._grid(own, begin)
        if not self._problems:
            self._links[..., place] = np.array(numbers, np.int32).reshape(_kept(self._sizes, own))

    def _add_building(self, place: int) -> None:
        """The scenes of a building alone."""

        def begin(point: Point) -> Digests:
            return Digests((self._study.building(point, place),), ())

        own = self._study.touching("buildings", place)
        self._scenes[..., 1 + place] = self._grid(own, begin)[..., None, :, :]

    def _grid(self, own: tuple[bool, ...], begin: Callable[[Point], Digests | None]) -> np.ndarray:
        """Numbers of the digests of what the axes `own` touch, on every motion, in every analysis; shape: values of
        every axis (1 where it touches neither), analyses, motions."""
        rest = tuple(around and not mine for around, mine in zip(self._around, own, strict=True))
        first = len(self._content) // DIGEST
        for point in _points(self._sizes, own):
            begun = begin(point)
            for other in _points(self._sizes, rest):
                endings = self._builder.endings(tuple(map(add, point, other)))
                if begun is None or self._met():
                    if len(self._problems) >= MOST_PROBLEMS:
                        self._refuse()
                    continue
                for ending in endings:
                    self._content += begun.ended(ending)
        *_, analyses, records = self._frame.shape
        shape = _kept(self._sizes, own), _kept(self._sizes, rest), (analyses, records)
        numbers = np.arange(first, len(self._content) // DIGEST, dtype=np.int32)
        if self._problems:
            return np.zeros((1,) * (len(self._sizes) + 2), np.int32)
        axes = [axis for place in range(len(self._sizes)) for axis in (place, len(self._sizes) + place)]
        both = tuple(map(max, *shape[:2])) if self._sizes else ()
        return numbers.reshape(sum(shape, ())).transpose(*axes, -2, -1).reshape(*both, analyses, records)

    def _met(self) -> bool:
        """Take over what is wrong at the points asked so far; whether anything is."""
        for problem, point in self._study.met.items():
            self._problems.setdefault(_at_point(problem, self._study.axes, point))
        self._study.met.clear()
        return bool(self._problems)

    def _refuse(self) -> None:
        """Raises `InputError` where something is wrong."""
        if self._problems:
            raise InputError(sorted(self._problems, key=lambda p: (p.line, p.column, p.message)))


def _points(sizes: tuple[int, ...], touched: tuple[bool, ...]) -> Iterator[Point]:
    """Every combination of the values of some axes, the others at their first."""
    return product(*(range(size if mine else 1) for size, mine in zip(sizes, touched, strict=True)))


def _kept(sizes: tuple[int, ...], touched: tuple[bool, ...]) -> tuple[int, ...]:
    return tuple(size if mine else 1 for size, mine in zip(sizes, touched, strict=True))


class _Builder:
    """Builds the scene of a row of the tables; the study was validated there. Scenes share buildings, links and motions
    that are the same."""

    def __init__(self, study: Study, links_of: Links, frame: Frame) -> None:
        self._study, self._links_of, self._frame = study, links_of, frame
        self._cases, self._records = frame.cases, frame.records
        self._analyses = tuple(map(Analysis, frame.analyses))
        self._around: dict[Point, _Around] = {}
        self._endings: dict[Point, list[bytes]] = {}
        self._links: dict[tuple[str, Point], tuple[Link, ...]] = {}
        self._alike: dict[tuple[Link, ...], tuple[Link, ...]] = {}
        self._begun: dict[int, tuple[Scene, list[Motion]]] = {}  # of points and cases, by number

    def around(self, point: Point) -> _Around:
        """What is around the links at a point."""
        key = self._study.key(point, ("buildings", "group", *AROUND))
        found = self._around.get(key)
        if found is None:
            found = self._around_anew(point)
            _keep(self._around, key, found, MOST_AROUND)
        return found

    def _around_anew(self, point: Point) -> _Around:
        return _Around(self.buildings(point), self._study.motions(point), self._study.section(point, "tail"))

    def buildings(self, point: Point) -> tuple[Building, ...]:
        """The buildings of the group at a point."""
        group = self._study.group(point)
        assert group is not None
        return tuple(group.buildings)

    def endings(self, point: Point) -> list[bytes]:
        """How the digests of all analyses and motions at a point end; empty where something is wrong."""
        key = self._study.key(point, AROUND)
        found = self._endings.get(key)
        if found is None:
            motions, tail = self._study.motions(point), self._study.section(point, "tail")
            asked = product(self._analyses, self._records if motions else ())
            found = [Digests.ending(motions[name].motion, analysis, tail) for analysis, name in asked]
            _keep(self._endings, key, found, MOST_AROUND)
        return found

    def links(self, point: Point, case: str) -> tuple[Link, ...]:
        """The links of a case at a point."""
        place = case, self._study.key(point, (*BETWEEN, ("cases", case)))
        found = self._links.get(place)
        if found is None:
            found = self._links_of(point, case)
            assert found is not None
            if found in self._alike:  # what is known of them is found again sooner
                found = self._alike[found]
            else:
                _keep(self._alike, found, found, MOST_ALIKE)
            _keep(self._links, place, found, MOST_LINKS)
        return found

    def __call__(self, row: int) -> Scene:
        number, rest = divmod(row, len(self._analyses) * len(self._records))
        analysis, record = divmod(rest, len(self._records))
        found = self._begun.get(number)
        if found is None:
            point, case, *_ = self._frame.place(row)
            around, links = self.around(point), self.links(point, self._cases[case])
            motions = [around.motions[name].motion for name in self._records]
            found = Scene(around.buildings, links, motions[record], self._analyses[analysis], around.tail), motions
            _keep(self._begun, number, found, MOST_ALIKE)
        scene, motions = found
        return scene.under(motions[record], self._analyses[analysis])


def _keep(answers: dict, key: object, answer: object, most: int) -> None:
    """Keep an answer, and the latest ones before it."""
    if len(answers) >= most:
        del answers[next(iter(answers))]
    answers[key] = answer


def _at_point(problem: Problem, axes: tuple[Axis, ...], point: Point) -> Problem:
    """The problem with the swept values that it stands at."""
    place = ", ".join(
        f"{name} = {value}"
        for axis, index in zip(axes, point, strict=True)
        if index >= 0
        for name, value in zip(axis.names, axis.shown(index), strict=True)
    )
    return Problem(f"{problem.message} (where {place})", problem.hint, problem.file, problem.line, problem.column)
