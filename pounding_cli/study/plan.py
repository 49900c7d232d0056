"""What a study comes to: different scenes, and the table rows that point at them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pounding_cli.model.links import LinkPlace
from pounding_cli.model.scene import Scene

if TYPE_CHECKING:
    from pounding_cli.study.axes import Axis
    from pounding_cli.study.study import Study


@dataclass(frozen=True, eq=False)
class Links:
    """The links of every point and case in the columns of the tables; arrays have the shape (points of every axis...,
    cases, columns).

    places : of every column left building from 0, floors from 1, name among links of the same floors
    order : number of the link in its scene; -1 where the case has none here
    kind : law; "" where there is none
    gap : [m]; NaN where there is none
    left_at, right_at : heights of its ends in the storeys below its floors [-], 1 at a floor
    """

    places: tuple[LinkPlace, ...]
    order: np.ndarray
    kind: np.ndarray
    gap: np.ndarray
    left_at: np.ndarray
    right_at: np.ndarray


class Row(NamedTuple):
    """A row of the tables: its index on every axis, its names, the number of its scene."""

    point: tuple[int, ...]
    case: str
    analysis: str
    record: str
    scene: int


@dataclass(frozen=True, eq=False)
class Plan:
    """Everything to run.

    digests : SHA-256 of every different scene, in the order of the rows that need them first, shape (scenes, 32)
    numbers : number of the scene of a row, then of every building alone, -1 for one that nobody asks for, shape
        (points of every axis..., cases, analyses, records, 1 + buildings)
    links : what the tables say of links
    build : scene of a row by its flat number among all rows
    buildings : names by place, left to right (soft-1, soft-2 where a type occurs twice)
    accuracy : relative error wanted [-]
    time_step : of a method that takes one [s]
    estimate : which scenes are assessed, for error and sensitivity: none, sample or all
    harder : whether a scene that fails is solved once more, more finely
    kept : rows whose scenes are kept over time, every `every` seconds
    workflow : what is asked of the scenes
    """

    study: Study
    axes: tuple[Axis, ...]
    cases: tuple[str, ...]
    analyses: tuple[str, ...]
    records: tuple[str, ...]
    buildings: tuple[str, ...]
    digests: np.ndarray
    numbers: np.ndarray
    links: Links
    build: Callable[[int], Scene]
    accuracy: float
    method: str
    time_step: float | None = None
    estimate: str = "none"
    harder: bool = False
    kept: tuple[Row, ...] = ()
    every: float = 0.002
    workflow: str = "run"

    def __len__(self) -> int:
        """How many different scenes there are."""
        return len(self.digests)

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of the rows: points of every axis, cases, analyses, records."""
        return self.numbers.shape[:-1]

    @cached_property
    def first(self) -> tuple[np.ndarray, np.ndarray]:
        """Of every scene the flat number of the row where it stands first, and its column there: 0, or 1 + the building
        that stands alone; shapes (scenes,)."""
        flat = self.numbers.ravel()
        _, at = np.unique(flat[flat >= 0], return_index=True)
        return np.divmod(np.flatnonzero(flat >= 0)[at], self.numbers.shape[-1])

    def scenes(self, numbers: np.ndarray) -> Iterator[Scene]:
        """Some scenes by number, built one by one."""
        rows, columns = self.first
        for row, column in zip(rows[numbers].tolist(), columns[numbers].tolist(), strict=True):
            scene = self.build(row)
            yield scene.alone(column - 1) if column else scene

    def scene(self, number: int) -> Scene:
        """A scene by number."""
        return next(self.scenes(np.array([number])))

    def row(self, number: int) -> Row:
        """A row by its flat number."""
        *point, case, analysis, record = map(int, np.unravel_index(number, self.shape))
        scene = int(self.numbers[(*point, case, analysis, record, 0)])
        return Row(tuple(point), self.cases[case], self.analyses[analysis], self.records[record], scene)

    def shown(self, point: tuple[int, ...]) -> dict[str, str]:
        """The swept values at a point, by key, in the units of the study."""
        return {
            name: text
            for axis, place in zip(self.axes, point, strict=True)
            for name, text in zip(axis.names, axis.shown(place), strict=True)
        }
