"""`expand`: every point of the sweep, case, analysis and record as a row, its scene and baselines by number."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from itertools import product
from operator import add
from typing import Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.links import APART, Link, link_places
from pounding_cli.model.scene import Analysis, Digests, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.study.build import places
from pounding_cli.study.keep import kept_rows
from pounding_cli.study.plan import Axis, Links, Plan
from pounding_cli.study.study import AROUND, BETWEEN, Point, Study, keep

MOST_PROBLEMS = 20
"""After so many problems in combinations of sweep values the rest is not looked at."""

DIGEST = 32
"""Bytes of a SHA-256 digest."""

LinksOf = Callable[[Point, str], tuple[Link, ...] | None]
"""links(point, case) -> what stands between the buildings of the group."""

Asks = Callable[[Point, str, Analysis, str], bool]
"""asks(point, case, analysis, record) -> whether the scenes of a row are wanted."""


def expand(study: Study, links_of: LinksOf | None = None, asks: Asks | None = None) -> Plan:
    """The plan of a study.  Raises `InputError` where a combination of sweep values is not sound.

    What an axis does not touch is worked out once for all its values: every case by itself, every building alone.

    links_of : what stands between the buildings in place of what the study says
    asks : which rows have scenes; all unless given
    """
    return _Expansion(study, links_of or study.links).plan(asks)


class _Expansion:
    """One study being expanded; it stays with the plan, to build scenes when they are asked for."""

    def __init__(self, study: Study, links_of: LinksOf) -> None:
        self.study, self.links_of = study, links_of
        self.cases, self.records = tuple(study.model.cases), tuple(study.motions(study.base))
        self.analyses = tuple(map(Analysis, study.model.analyses))
        self.sizes = tuple(len(axis.values) for axis in study.axes)
        self._around = study.touches(*AROUND)
        self._content = bytearray()  # digests as they are found, one behind the other
        self._problems: dict[Problem, None] = {}
        self._endings: dict[Point, list[bytes]] = {}
        self._links: dict[tuple[str, Point], tuple[Link, ...]] = {}
        self._begun: dict[int, tuple[Scene, list[Motion]]] = {}

    def plan(self, asks: Asks | None) -> Plan:
        """The plan.  Raises `InputError`."""
        study, model = self.study, self.study.model
        study.met.clear()
        links: list[list[Any]] = [[] for _ in self.cases]
        rows = (*self.sizes, len(self.cases), len(self.analyses), len(self.records))
        numbers = np.empty((*rows, 1 + len(model.group)), np.int32)
        for place, case in enumerate(self.cases):
            numbers[..., place, :, :, 0] = self._case(case, links[place])
        self._refuse()
        for place in range(len(model.group)):
            numbers[..., 1 + place] = self._alone(place)[..., None, :, :]
        if asks is not None:
            points = product(*map(range, self.sizes))
            wanted = (asks(*row) for row in product(points, self.cases, self.analyses, self.records))
            numbers[~np.fromiter(wanted, bool, int(np.prod(rows))).reshape(rows)] = -1
        digests, numbers = _numbered(np.frombuffer(self._content, np.uint8).reshape(-1, DIGEST), numbers)
        self._content = bytearray()
        plan = Plan(
            study=study,
            axes=study.axes,
            cases=self.cases,
            analyses=tuple(map(str, self.analyses)),
            records=self.records,
            buildings=places(model.group),
            digests=digests,
            numbers=numbers,
            links=_table(links, self.sizes, [study.touches(*BETWEEN, ("cases", case)) for case in self.cases]),
            build=self.scene,
            accuracy=model.accuracy,
            method=model.method,
            time_step=model.time_step,
            estimate=model.estimate,
        )
        return kept_rows(plan) if model.keep is not None else plan

    def scene(self, row: int) -> Scene:
        """The scene of a row by its flat number; scenes of one point and case share buildings, links and motions."""
        number, rest = divmod(row, len(self.analyses) * len(self.records))
        analysis, record = divmod(rest, len(self.records))
        if number not in self._begun:
            *point, case = map(int, np.unravel_index(number, (*self.sizes, len(self.cases))))
            at, study = tuple(point), self.study
            group, used = study.group(at), study.motions(at)
            assert group is not None  # the study was validated at every point
            motions = [used[name].motion for name in self.records]
            links = self._links_at(at, self.cases[case])
            first = Scene(tuple(group.buildings), links, motions[0], self.analyses[0], study.section(at, "tail"))
            keep(self._begun, number, (first, motions))
        first, motions = self._begun[number]
        return first.under(motions[record], self.analyses[analysis])

    def _case(self, case: str, table: list[Any]) -> np.ndarray:
        """The scenes of a case, see `_grid`; what tables say of its links is added to `table`."""

        def begin(point: Point) -> Digests | None:
            self.study.links(point, case)  # what is wrong with them, and with what they stand between
            group = self.study.group(point)
            if self._met() or group is None:
                return None
            links = self._links_at(point, case)
            table.append(_in_columns(links))
            return Digests(group.buildings, links)

        return self._grid(self.study.touches(*BETWEEN, ("cases", case)), begin)

    def _alone(self, place: int) -> np.ndarray:
        """The scenes of a building alone, see `_grid`."""
        own = self.study.touching("buildings", place)
        return self._grid(own, lambda point: Digests((self.study.building(point, place),), ()))

    def _grid(self, own: tuple[bool, ...], begin: Callable[[Point], Digests | None]) -> np.ndarray:
        """Numbers in `_content` of the scenes of what the axes `own` touch, on every motion, in every analysis; shape:
        values of every axis (1 where it touches neither that nor the motions), analyses, motions."""
        rest = tuple(around and not mine for around, mine in zip(self._around, own, strict=True))
        first = len(self._content) // DIGEST
        for point in self._points(own):
            begun = begin(point)
            for other in self._points(rest):
                endings = self._endings_at(tuple(map(add, point, other)))
                if begun is None or self._met():
                    if len(self._problems) >= MOST_PROBLEMS:
                        self._refuse()
                    continue
                for ending in endings:
                    self._content += begun.ended(ending)
        if self._problems:
            return np.zeros((1,) * (len(self.sizes) + 2), np.int32)
        numbers = np.arange(first, len(self._content) // DIGEST, dtype=np.int32)
        each = len(self.analyses), len(self.records)
        count = len(self.sizes)
        both = [size for sizes in zip(self._kept(own), self._kept(rest), strict=True) for size in sizes]
        # points of the own axes came slowest, then those of the rest: side by side, axis by axis
        apart = numbers.reshape(*both[::2], *both[1::2], *each)
        order = [axis for place in range(count) for axis in (place, count + place)]
        whole = [own_size * rest_size for own_size, rest_size in zip(both[::2], both[1::2], strict=True)]
        return apart.transpose(*order, -2, -1).reshape(*whole, *each)

    def _points(self, touched: tuple[bool, ...]) -> Iterator[Point]:
        """Every combination of the values of some axes, the others at their first."""
        return product(*map(range, self._kept(touched)))

    def _kept(self, touched: tuple[bool, ...]) -> tuple[int, ...]:
        return tuple(size if mine else 1 for size, mine in zip(self.sizes, touched, strict=True))

    def _endings_at(self, point: Point) -> list[bytes]:
        """How the digests of all analyses and motions at a point end; empty where something is wrong."""
        key = self.study.key(point, AROUND)
        if key not in self._endings:
            motions, tail = self.study.motions(point), self.study.section(point, "tail")
            asked = product(self.analyses, self.records if motions else ())
            keep(self._endings, key, [Digests.ending(motions[name].motion, analysis, tail) for analysis, name in asked])
        return self._endings[key]

    def _links_at(self, point: Point, case: str) -> tuple[Link, ...]:
        """The links of a case at a point."""
        key = case, self.study.key(point, (*BETWEEN, ("cases", case)))
        if key not in self._links:
            found = self.links_of(point, case)
            assert found is not None  # the study was validated there
            keep(self._links, key, found)
        return self._links[key]

    def _met(self) -> bool:
        """Take over what is wrong at the points asked so far; whether anything is."""
        for problem, point in self.study.met.items():
            self._problems.setdefault(_at_point(problem, self.study.axes, point))
        self.study.met.clear()
        return bool(self._problems)

    def _refuse(self) -> None:
        """Raises `InputError` where something is wrong."""
        if self._problems:
            raise InputError(sorted(self._problems, key=lambda p: (p.line, p.column, p.message)))


@functools.lru_cache(maxsize=1024)  # the cases of a study and many of its points share links
def _in_columns(links: tuple[Link, ...]) -> tuple[tuple[Any, ...], ...]:
    """Of links in their order: places, kinds, gaps [m], heights of their left and right ends."""
    gaps = tuple(np.nan if link.kind == APART else float(link.gap) for link in links)
    ends = tuple(link.left_at for link in links), tuple(link.right_at for link in links)
    return link_places(links), tuple(str(link.kind) for link in links), gaps, *ends


def _table(cases: list[list[Any]], sizes: tuple[int, ...], touched: list[tuple[bool, ...]]) -> Links:
    """What the tables say of the links of all cases.

    cases : of every case its links `_in_columns`, at all points where they may differ
    touched : of every case, which axes its links depend on
    """
    columns = tuple(sorted({place for points in cases for places, *_ in points for place in places}))
    number = {place: column for column, place in enumerate(columns)}
    absent = np.int16(-1), "", np.nan, np.nan, np.nan
    kinds = np.int16, object, float, float, float
    whole = [np.full((*sizes, len(cases), len(columns)), each, kind) for each, kind in zip(absent, kinds, strict=True)]
    for case, points in enumerate(cases):
        small = tuple(size if mine else 1 for size, mine in zip(sizes, touched[case], strict=True))
        rows = np.array([point for point, (places, *_) in enumerate(points) for _ in places], int)
        at = rows, np.array([number[place] for places, *_ in points for place in places], int)
        found = [(range(len(places)), *rest) for places, *rest in points]
        for column, array in enumerate(whole):
            own = np.full((len(points), len(columns)), absent[column], array.dtype)
            own[at] = [value for point in found for value in point[column]]
            array[..., case, :] = own.reshape(*small, -1)
    return Links(columns, *whole)


def _numbered(digests: np.ndarray, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Different digests alone, in the order in which `numbers` has them first, and `numbers` among these."""
    _, first, same = np.unique(digests.view("V32").ravel(), return_index=True, return_inverse=True)
    numbers = np.where(numbers < 0, -1, same[numbers])
    used, begins = np.unique(numbers, return_index=True)
    used, begins = used[used >= 0], begins[used >= 0]
    used = used[np.argsort(begins)]
    place = np.full(len(first) + 1, -1, np.int32)  # the last one stands for -1
    place[used] = np.arange(len(used))
    return digests[first[used]], place[numbers]


def _at_point(problem: Problem, axes: tuple[Axis, ...], point: Point) -> Problem:
    """The problem with the swept values that it stands at."""
    place = ", ".join(
        f"{name} = {value}"
        for axis, index in zip(axes, point, strict=True)
        if index >= 0
        for name, value in zip(axis.names, axis.shown(index), strict=True)
    )
    return Problem(f"{problem.message} (where {place})", problem.hint, problem.file, problem.line, problem.column)
