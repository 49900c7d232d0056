"""The scenes and table rows of a plan, kept as numbers and digests: each is built when it is asked for."""

from __future__ import annotations

import json
import threading
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import overload

import numpy as np

from pounding_cli.digests import DIGEST, DigestList, DigestTable, heads, runs
from pounding_cli.model.links import Link, link_places
from pounding_cli.model.placed import Placed
from pounding_cli.model.scene import Scene
from pounding_cli.study.plan import LinkSeen, Row

Build = Callable[[int], Scene]
"""build(row) -> the scene of the group, by the number of a row."""

_ROWS = 1 << 16
"""Rows looked at together."""

_MOST_ALIKE = 4096
"""Sets of links that are known again."""


_SET_ARRAYS = "layout", "begin", "gaps"
_ARRAYS = "scenes", "first", "links"


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
        *sizes, cases, analyses, records = self.shape
        number, record = divmod(number, records)
        number, analysis = divmod(number, analyses)
        number, case = divmod(number, cases)
        point = []
        for size in reversed(sizes):
            number, place = divmod(number, size)
            point.append(place)
        return tuple(reversed(point)), case, analysis, record


class LinkSets:
    """What tables say of links, by number: where links stand is kept once, of every set its gaps."""

    def __init__(self) -> None:
        self._layouts: list[tuple[LinkSeen, ...]] = []
        self._layout, self._begin, self._gaps = array("i"), array("q"), array("d")
        self._numbers: dict[tuple[LinkSeen, ...], int] = {}  # of all layouts
        self._alike: dict[tuple[int, tuple[float, ...]], int] = {}  # of the latest sets

    def number(self, links: tuple[LinkSeen, ...]) -> int:
        """The number of a set: that of an equal one, if that was met lately."""
        gaps = tuple([link.gap for link in links])
        if len(set(gaps)) == 1:  # told by a set of one gap
            gaps = gaps[:1]
        bare = tuple([link._replace(gap=0.0) for link in links])
        layout = self._numbers.get(bare)
        if layout is None:
            layout = self._numbers[bare] = len(self._layouts)
            self._layouts.append(bare)
        found = self._alike.get((layout, gaps))
        if found is None:
            found = len(self._layout)
            self._layout.append(layout)
            self._begin.append(len(self._gaps))
            self._gaps.extend(gaps)
            if len(self._alike) >= _MOST_ALIKE:
                del self._alike[next(iter(self._alike))]
            self._alike[layout, gaps] = found
        return found

    @property
    def layouts(self) -> Sequence[tuple[LinkSeen, ...]]:
        """The links of all sets, gaps of 0: those that differ in their gaps only once."""
        return self._layouts

    def __getitem__(self, number: int) -> tuple[LinkSeen, ...]:
        layout, begin = self._layouts[self._layout[number]], self._begin[number]
        end = self._begin[number + 1] if number + 1 < len(self._begin) else len(self._gaps)
        gaps = self._gaps[begin:end]
        if len(gaps) < len(layout):
            gaps *= len(layout)
        return tuple([link._replace(gap=gap) for link, gap in zip(layout, gaps, strict=True)])

    def alike(self, numbers: np.ndarray) -> Iterator[tuple[tuple[LinkSeen, ...], np.ndarray, np.ndarray]]:
        """Sets whose links differ in their gaps only: the links with gaps of 0, the places of these sets in `numbers`,
        and their gaps [m], shape (sets, links)."""
        begins, gaps = np.asarray(self._begin), np.asarray(self._gaps)
        begin, last = begins[numbers], numbers + 1 == len(begins)
        end = np.where(last, gaps.size, begins[np.where(last, 0, numbers + 1)])
        for which in runs(np.asarray(self._layout)[numbers]):
            links = self._layouts[self._layout[numbers[which[0]]]]
            each = np.arange(len(links)) * (end - begin > 1)[which, None]  # a set of one gap has it once
            yield links, which, gaps[begin[which, None] + each]

    def arrays(self) -> dict[str, np.ndarray]:
        """All of it, to be written down."""
        layouts = np.frombuffer(json.dumps(self._layouts).encode(), np.uint8)
        return {"layouts": layouts, **{name: np.array(getattr(self, f"_{name}")) for name in _SET_ARRAYS}}

    @classmethod
    def of(cls, arrays: Mapping[str, np.ndarray]) -> LinkSets:
        """What `arrays` were made of."""
        found = cls()
        found._layouts = [
            tuple(LinkSeen(*link) for link in layout) for layout in json.loads(arrays["layouts"].tobytes())
        ]
        for name in _SET_ARRAYS:
            getattr(found, f"_{name}").frombytes(arrays[name].tobytes())
        return found


@dataclass(frozen=True, eq=False)
class Expanded:
    """What a study comes to.

    table : the digests of all scenes, in the order of the rows that need them first
    scenes : of every row the number of its scene and of those of the buildings alone, -1 for one that nobody asks for,
        shape (rows, 1 + buildings)
    first : of every scene the place in `scenes` (flat) where it stands first, shape (scenes,)
    links : of every point and case the number of its links in `sets`, shape (points * cases,)
    """

    table: DigestTable
    scenes: np.ndarray
    first: np.ndarray
    links: np.ndarray
    sets: LinkSets

    def arrays(self) -> dict[str, np.ndarray]:
        """All of it, to be written down."""
        return {"digests": self.table.digests, **{name: getattr(self, name) for name in _ARRAYS}, **self.sets.arrays()}

    @classmethod
    def of(cls, arrays: Mapping[str, np.ndarray]) -> Expanded:
        """What `arrays` were made of.  Raises `ValueError` or `KeyError` where they do not fit together."""
        scenes, first, links = (arrays[name] for name in _ARRAYS)
        found = cls(DigestTable(arrays["digests"]), scenes, first, links, LinkSets.of(arrays))
        if found.first.shape != found.table.digests.shape[:1] or found.table.digests.shape[1:] != (DIGEST,):
            raise ValueError("as many digests as scenes")
        return found


class Rows(Sequence[Row]):
    """The rows of the tables, made when they are looked at; two are equal when all their rows are.

    Parameters
    ----------
    frame : their names
    expanded : what they rest on
    """

    def __init__(self, frame: Frame, expanded: Expanded) -> None:
        self.frame, self.expanded = frame, expanded
        self.table, self.scenes = expanded.table, expanded.scenes
        self.links, self.sets = expanded.links, expanded.sets

    def __len__(self) -> int:
        return len(self.scenes)

    @overload
    def __getitem__(self, number: int) -> Row: ...

    @overload
    def __getitem__(self, number: slice) -> list[Row]: ...

    def __getitem__(self, number: int | slice) -> Row | list[Row]:
        if isinstance(number, slice):
            return [self[place] for place in range(*number.indices(len(self)))]
        number = range(len(self))[number]
        point, case, analysis, record = self.frame.place(number)
        scene, *baselines = DigestList(self.table.digests, self.scenes[number])
        links = self.sets[self.links[number // (len(self.frame.analyses) * len(self.frame.records))]]
        names = self.frame.cases[case], self.frame.analyses[analysis], self.frame.records[record]
        return Row(point, *names, scene, tuple(baselines), links)

    def __iter__(self) -> Iterator[Row]:
        frame, links = self.frame, map(self.sets.__getitem__, self.links.tolist())
        columns = (DigestList(self.table.digests, self.scenes[:, place]) for place in range(self.scenes.shape[1]))
        scenes = zip(*columns, strict=True)
        for point in product(*map(range, frame.shape[:-3])):
            for case, seen_there in zip(frame.cases, links, strict=False):
                for analysis, record in product(frame.analyses, frame.records):
                    scene, *baselines = next(scenes)
                    yield Row(point, case, analysis, record, scene, tuple(baselines), seen_there)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Rows):
            return NotImplemented
        return self.frame == other.frame and all(one == two for one, two in zip(self, other, strict=True))

    __hash__ = None  # type: ignore[assignment]  # a list in all but name


class Scenes(Placed):
    """The scenes by digest, each once, in the order of the rows that need them first; built when asked for.

    Asking costs about as much as it took to expand the point; scenes of one point asked for together share that.

    Parameters
    ----------
    expanded : what they are
    build : builds the scene of a row
    """

    def __init__(self, expanded: Expanded, build: Build) -> None:
        self.table, self.first = expanded.table, expanded.first
        self._each, self._build = expanded.scenes.shape[1], build
        self._lock = threading.Lock()  # what builds scenes keeps what it found

    def place(self, digest: str) -> int:
        """Number of its row, and whether it is one of the baselines."""
        number = self.table.numbers([digest])[0]
        if number < 0:
            raise KeyError(digest)
        return int(self.first[number])

    def at(self, place: int) -> Scene:
        """The scene at a place."""
        row, which = divmod(place, self._each)
        with self._lock:
            scene = self._build(row)
        return scene.alone(which - 1) if which else scene

    def __contains__(self, digest: object) -> bool:
        return isinstance(digest, str) and bool(self.has([digest])[0])

    def has(self, digests: Sequence[str]) -> np.ndarray:
        """Whether each scene is there, shape (digests,)."""
        return self.table.numbers(digests) >= 0

    @property
    def digests(self) -> DigestList:
        """Those of all scenes."""
        return DigestList(self.table.digests)

    def places(self, digests: Sequence[str]) -> list[int]:
        """Where scenes stand, as `place` says.  Raises `KeyError`."""
        numbers = self.table.numbers(digests)
        if (numbers < 0).any():
            raise KeyError(digests[int(np.argmin(numbers))])
        return self.first[numbers].tolist()

    def __iter__(self) -> Iterator[str]:
        return iter(self.digests)

    def __len__(self) -> int:
        return len(self.table)


def in_order(digests: np.ndarray, scenes: np.ndarray) -> tuple[DigestTable, np.ndarray, np.ndarray]:
    """`table`, `scenes` and `first` of `Expanded`.

    digests : `packed`, in any order, some of them alike; scenes : as in `Expanded`, numbers of these digests
    """
    alike = _first_alike(digests)
    if alike is not None:
        scenes = np.append(alike, np.int32(-1))[scenes]
    used, first = first_of(scenes, np.append(np.ones(len(digests), bool), False))
    number = np.full(len(digests) + 1, -1, np.int32)
    number[used] = np.arange(len(used), dtype=np.int32)
    return DigestTable(digests[used]), number[scenes], first


def first_of(scenes: np.ndarray, wanted: np.ndarray, turned: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """The different numbers that are wanted, in the order in which they come first, and the places (flat) of that.

    scenes : shape (rows, columns); wanted : of every number, and last of -1, whether it is
    turned : every row begins with its column of this number
    """
    rows, columns = scenes.shape
    first = np.full(len(wanted) - 1, -1, np.int64)
    for begin in reversed(range(0, rows, _ROWS)):  # the first place is written last, and stays
        some = np.roll(scenes[begin : begin + _ROWS], -turned, axis=1).ravel()
        at = np.flatnonzero(wanted[some])[::-1]
        first[some[at]] = begin * columns + at
    found = np.flatnonzero(first >= 0).astype(np.int32)
    found = found[np.argsort(first[found])]
    return found, first[found]


def _first_alike(digests: np.ndarray) -> np.ndarray | None:
    """Of every digest the number of the first that is the same, shape (digests,); None where all differ."""
    begins = heads(digests)
    order = np.argsort(begins, kind="stable").astype(np.int32)
    begins = begins[order]
    again = np.flatnonzero(begins[1:] == begins[:-1]) + 1
    if not again.size:
        return None
    found = np.arange(len(digests), dtype=np.int32)
    first: dict[bytes, int] = {}
    for place in np.union1d(again - 1, again).tolist():  # those that begin alike, the first ones first
        number = int(order[place])
        found[number] = first.setdefault(digests[number].tobytes(), number)
    return found


def seen(links: Sequence[Link]) -> tuple[LinkSeen, ...]:
    """What the tables say of links."""
    return tuple(
        LinkSeen(*place, str(link.kind), float(link.gap), link.left_at, link.right_at)
        for place, link in zip(link_places(links), links, strict=True)
    )
