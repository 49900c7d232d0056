"""`expand`: every point of the sweep, case, analysis and record as a row, its scene and baselines by number."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import product
from operator import or_
from typing import Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.links import APART, Link, link_places
from pounding_cli.model.scene import Analysis, Digests, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.study.build import places
from pounding_cli.study.plan import Links, Plan, kept_rows
from pounding_cli.study.study import AROUND, BETWEEN, MOST_KEPT, Point, Study

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
        self._first = functools.lru_cache(MOST_KEPT)(self._first_of)
        self._endings = functools.lru_cache(MOST_KEPT)(self._endings_of)

    def plan(self, asks: Asks | None) -> Plan:
        """The plan.  Raises `InputError`."""
        study, model = self.study, self.study.model
        touched = [study.touches(*BETWEEN, ("cases", case)) for case in self.cases]
        rows = (*self.sizes, len(self.cases), len(self.analyses), len(self.records))
        numbers, links = np.empty((*rows, 1 + len(model.group)), np.int32), [list[Any]() for _ in self.cases]
        for place, case in enumerate(self.cases):
            numbers[..., place, :, :, 0] = self._grid(touched[place], partial(self._begin, case, links[place]))
        self._refuse()
        for place in range(len(model.group)):
            alone = self._grid(study.touches(("buildings", model.group[place])), partial(self._begin_alone, place))
            numbers[..., 1 + place] = alone[..., None, :, :]
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
            links=_table(links, self.sizes, touched),
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
        first, motions = self._first(number)
        return replace(first, motion=motions[record], analysis=self.analyses[analysis])

    def _first_of(self, number: int) -> tuple[Scene, list[Motion]]:
        """The first scene of a point and case by their flat number, and all motions there."""
        *point, case = map(int, np.unravel_index(number, (*self.sizes, len(self.cases))))
        at, study = tuple(point), self.study
        group, used, links = study.group(at), study.motions(at), self.links_of(at, self.cases[case])
        assert group is not None  # the study was validated at every point
        assert links is not None
        motions = [used[name].motion for name in self.records]
        tail, asked = study.section(at, "tail"), study.asks_residual_drift
        return Scene(tuple(group.buildings), links, motions[0], self.analyses[0], tail, asked), motions

    def _begin(self, case: str, table: list[Any], point: Point) -> Digests | None:
        """What the digests of a case at a point begin with, None where something is wrong there; what tables say of its
        links is added to `table`."""
        group, sound = self.study.group(point), self.study.links(point, case)
        if sound is None or group is None or self.study.problems.found:
            return None
        links = sound if self.links_of == self.study.links else self.links_of(point, case)
        assert links is not None
        table.append(links)
        return Digests(group.buildings, links)

    def _begin_alone(self, place: int, point: Point) -> Digests:
        return Digests((self.study.building(point, place),), ())

    def _grid(self, own: tuple[bool, ...], begin: Callable[[Point], Digests | None]) -> np.ndarray:
        """Numbers in `_content` of the scenes of what the axes `own` touch, on every motion, in every analysis; shape:
        values of every axis (1 where it touches neither that nor the motions), analyses, motions."""
        shape = _sizes(self.sizes, tuple(map(or_, own, self._around)))
        begun, first = dict[Point, Digests | None](), len(self._content) // DIGEST
        for point in product(*map(range, shape)):
            place = tuple([at if mine else 0 for at, mine in zip(point, own, strict=True)])
            if place not in begun:
                begun[place] = begin(place)
            digests, endings = begun[place], self._endings(self.study.key(point, AROUND))
            if digests is None or not endings:
                self._note()
            else:
                for ending in endings:
                    self._content += digests.ended(ending)
        if self._problems:
            return np.zeros((1,) * (len(shape) + 2), np.int32)
        numbers = np.arange(first, len(self._content) // DIGEST, dtype=np.int32)
        return numbers.reshape(*shape, len(self.analyses), len(self.records))

    def _endings_of(self, point: Point) -> list[bytes]:
        """How the digests of all analyses and motions at a point end; empty where something is wrong."""
        motions, tail = self.study.motions(point), self.study.section(point, "tail")
        to_rest = self.study.asks_residual_drift
        asked = product(self.analyses, self.records if motions else ())
        return [Digests.ending(motions[name].motion, analysis, tail, to_rest) for analysis, name in asked]

    def _note(self) -> None:
        """Take over what is wrong at the points asked so far.  Raises `InputError` where that is much."""
        for problem, point in self.study.problems.found.items():
            axes = zip(self.study.axes, point, strict=True)
            told = ", ".join(axis.format_point(index) for axis, index in axes if index >= 0)
            self._problems.setdefault(replace(problem, message=f"{problem.message} (where {told})"))
        self.study.problems.found.clear()
        if len(self._problems) >= MOST_PROBLEMS:
            self._refuse()

    def _refuse(self) -> None:
        """Raises `InputError` where something is wrong."""
        if self._problems:
            raise InputError(sorted(self._problems, key=lambda p: (p.line, p.column, p.message)))


def _sizes(sizes: tuple[int, ...], touched: tuple[bool, ...]) -> tuple[int, ...]:
    """Sizes of the axes that touch something; 1 of the others."""
    return tuple(size if mine else 1 for size, mine in zip(sizes, touched, strict=True))


_places = functools.lru_cache(maxsize=1024)(link_places)  # the cases of a study and many of its points share links


def _table(cases: list[list[tuple[Link, ...]]], sizes: tuple[int, ...], touched: list[tuple[bool, ...]]) -> Links:
    """What the tables say of the links of all cases.

    cases : of every case its links at all points where they may differ
    touched : of every case, which axes its links depend on
    """
    columns = tuple(sorted({place for points in cases for links in points for place in _places(links)}))
    number = {place: column for column, place in enumerate(columns)}
    absent = {"order": np.int16(-1), "kind": np.array("", object), "gap": np.nan, "left_at": np.nan, "right_at": np.nan}
    whole = {name: np.full((*sizes, len(cases), len(columns)), value) for name, value in absent.items()}
    for case, points in enumerate(cases):
        rows = [point for point, links in enumerate(points) for _ in links]
        at = rows, [number[place] for links in points for place in _places(links)]
        values: dict[str, list[Any]] = {"order": [n for links in points for n in range(len(links))]}
        values["gap"] = [np.nan if link.kind == APART else link.gap for links in points for link in links]
        for name, array in whole.items():
            own = np.full((len(points), len(columns)), absent[name])
            own[at] = values.get(name) or [getattr(link, name) for links in points for link in links]
            array[..., case, :] = own.reshape(*_sizes(sizes, touched[case]), -1)
    return Links(columns, **whole)


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
