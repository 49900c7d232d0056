"""The scenes and table rows of a plan, kept as digests: each scene is built when it is asked for."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import overload

from pounding_cli.model.links import Link, link_places
from pounding_cli.model.placed import Placed
from pounding_cli.model.scene import Scene
from pounding_cli.study.plan import LinkSeen, Row

Build = Callable[[tuple[int, ...], int, int, int], Scene]
"""build(point, case, analysis, record) -> the scene of the group; cases, analyses, records by number from 0."""


@dataclass(frozen=True)
class Frame:
    """The names along the rows: every point of the sweep, case, analysis and record, the last fastest.

    shape : points on every axis, then the numbers of cases, analyses and records
    """

    shape: tuple[int, ...]
    cases: tuple[str, ...]
    analyses: tuple[str, ...]
    records: tuple[str, ...]

    def place(self, number: int) -> tuple[tuple[int, ...], int, int, int]:
        """Point, case, analysis and record of a row."""
        places = []
        for size in reversed(self.shape):
            number, place = divmod(number, size)
            places.append(place)
        record, analysis, case, *point = places
        return tuple(reversed(point)), case, analysis, record


class Rows(Sequence[Row]):
    """The rows of the tables, made when they are looked at; two are equal when all their rows are."""

    def __init__(self, frame: Frame) -> None:
        self.frame = frame
        self._scenes: list[str] = []
        self._baselines: list[tuple[str, ...]] = []
        self._links: list[tuple[LinkSeen, ...]] = []
        self._seen: dict[tuple[LinkSeen, ...], tuple[LinkSeen, ...]] = {}

    def add(self, scene: str, baselines: tuple[str, ...], links: tuple[LinkSeen, ...]) -> None:
        """The next row."""
        self._scenes.append(scene)
        self._baselines.append(baselines)
        self._links.append(self._seen.setdefault(links, links))

    def __len__(self) -> int:
        return len(self._scenes)

    @overload
    def __getitem__(self, number: int) -> Row: ...

    @overload
    def __getitem__(self, number: slice) -> list[Row]: ...

    def __getitem__(self, number: int | slice) -> Row | list[Row]:
        if isinstance(number, slice):
            return [self[place] for place in range(*number.indices(len(self)))]
        number = range(len(self))[number]
        frame = self.frame
        point, case, analysis, record = frame.place(number)
        return Row(
            point,
            frame.cases[case],
            frame.analyses[analysis],
            frame.records[record],
            self._scenes[number],
            self._baselines[number],
            self._links[number],
        )

    def __iter__(self) -> Iterator[Row]:
        frame, columns = self.frame, zip(self._scenes, self._baselines, self._links, strict=True)
        names = list(product(frame.cases, frame.analyses, frame.records))
        for point in product(*map(range, frame.shape[:-3])):
            for name, column in zip(names, columns, strict=False):
                yield Row(point, *name, *column)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Rows):
            return NotImplemented
        return (self.frame, self._scenes, self._baselines, self._links) == (
            other.frame,
            other._scenes,
            other._baselines,
            other._links,
        )

    __hash__ = None  # type: ignore[assignment]  # a list in all but name


class Scenes(Placed):
    """The scenes by digest, each once, in the order of the rows that need them first; built when asked for.

    Asking costs about as much as it took to expand the point; scenes of one point asked for together share that.
    """

    def __init__(self, frame: Frame, buildings: int, build: Build) -> None:
        self._frame, self._places, self._build = frame, buildings + 1, build
        self._where: dict[str, int] = {}
        self._lock = threading.Lock()  # what builds scenes keeps what it found

    def note(self, digest: str, row: int, alone: int | None = None) -> None:
        """The scene of the row numbered `row`, or its baseline at place `alone`, has this digest."""
        self._where.setdefault(digest, row * self._places + (0 if alone is None else alone + 1))

    def place(self, digest: str) -> int:
        """Number of its row, and whether it is one of the baselines."""
        return self._where[digest]

    def at(self, place: int) -> Scene:
        """The scene at a place."""
        row, which = divmod(place, self._places)
        with self._lock:
            scene = self._build(*self._frame.place(row))
        return scene.alone(which - 1) if which else scene

    def __contains__(self, digest: object) -> bool:
        return digest in self._where

    def __iter__(self) -> Iterator[str]:
        return iter(self._where)

    def __len__(self) -> int:
        return len(self._where)


def seen(links: Sequence[Link]) -> tuple[LinkSeen, ...]:
    """What the tables say of links."""
    return tuple(
        LinkSeen(*place, str(link.kind), float(link.gap), link.left_at, link.right_at)
        for place, link in zip(link_places(links), links, strict=True)
    )
