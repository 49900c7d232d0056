"""What a study comes to: different scenes, the table rows that point at them, and those kept over time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pounding_cli.model.links import LinkPlace
from pounding_cli.model.scene import Scene
from pounding_cli.study import schema
from pounding_cli.study.file import Problems, get, nearest
from pounding_cli.study.schema import Histories, Keep
from pounding_cli.study.words import value_at

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
            for name, text in zip(axis.names, axis.display_values(place), strict=True)
        }


# `keep: histories`


MOST_BYTES = 2_000_000_000
"""Histories of a study may take so much [bytes] before compression."""


def wanted(model: Any) -> Histories | None:
    """What is to be kept; None where nothing is."""
    if model.keep is None:
        return None
    spec = model.keep.histories if isinstance(model.keep, Keep) else Histories()
    return spec if isinstance(spec, Histories) else Histories()


def check_keep(study: Study, model: Any, problems: Problems) -> None:
    """Note every name under `keep` that the study does not have, and a method that keeps no histories."""
    spec = wanted(model)
    if spec is None:
        return
    if model.method != "taylor":
        message = f"method: {model.method} keeps no histories, only taylor does"
        problems.at(study.root, ("keep",), message, "write `method: taylor`, or remove `keep`", key=True)
    _chosen(study, model, spec, problems)


def _chosen(study: Study, model: Any, spec: Histories, problems: Problems) -> list[list[int]]:
    """The places that are kept on every axis, among the cases, analyses and motions; unknown names are noted."""
    root, path = study.root, ("keep", "histories")
    chosen = [list(range(len(axis))) for axis in study.axes]
    swept = {name: (number, column) for number, axis in enumerate(study.axes) for column, name in enumerate(axis.names)}
    for key in spec.where:
        if key not in swept:
            message, hint = f"keep: '{key}' is not an axis of the sweep", nearest(key, swept)
            problems.at(root, (*path, "where", key), message, hint, key=True)
            continue
        number, column = swept[key]
        known, kept = [row[column] for row in study.axes[number].values], set[int]()
        words = get(root, *path, "where", key)
        for place, word in enumerate(words if isinstance(words, list) else [words]):
            value = value_at(schema.Study, tuple(key.split(".")), word)
            mine = [n for n, each in enumerate(known) if _is_same(value, each)]
            kept.update(mine)
            if not mine:
                at: Any = (*path, "where", key, *([place] if isinstance(words, list) else []))
                told = ", ".join(dict.fromkeys(study.axes[number].display_values(n)[column] for n in range(len(known))))
                problems.at(root, at, f"keep: the axis '{key}' has no value {word}", f"known: {told}")
        chosen[number] = [place for place in chosen[number] if place in kept]
    named = {"cases": model.cases, "analyses": model.analyses, "records": study.motions(study.base)}
    for name, of_study in named.items():
        names, there = getattr(spec, name), list(map(str, of_study))
        for place, word in enumerate(names or ()):
            if there and word not in there:
                problems.at(root, (*path, name, place), f"keep: '{word}' is none of the {name}", nearest(word, there))
        chosen.append([place for place, each in enumerate(there) if names is None or each in names])
    return chosen


def _is_same(one: float | str, other: float | str) -> bool:
    """Whether two values are one, in whatever units they are written."""
    if isinstance(one, str) or isinstance(other, str):
        return one == other
    return math.isclose(one, other, rel_tol=1e-9)


def kept_rows(plan: Plan) -> Plan:
    """The plan with the rows whose scenes are kept, and their output step [s].  Raises InputError where they would take
    more than MOST_BYTES, if all of a motion are as large as its first."""
    study, spec = plan.study, wanted(plan.study.model)
    if spec is None:
        return plan
    mask = np.zeros(plan.shape, bool)
    mask[np.ix_(*_chosen(study, study.model, spec, Problems("")))] = True
    rows = np.flatnonzero(mask).tolist()
    firsts = {row % len(plan.records): row for row in reversed(rows)}  # the motion runs fastest
    size = sum(_bytes_of(plan.build(row), spec.every) for row in firsts.values()) * len(rows) / max(len(firsts), 1)
    if size > MOST_BYTES:
        taken = f"about {size / 1e9:.3g} GB; the most is {MOST_BYTES / 1e9:g} GB"
        message = f"histories of {len(rows)} rows every {1000 * spec.every:g} ms take {taken}"
        hint = "keep fewer, `keep: {histories: {cases: [..], records: [..], where: {..}}}`, or write a longer `every:`"
        problems = Problems(study.file)
        problems.at(study.root, ("keep",), message, hint, key=True)
        problems.check()
    return replace(plan, kept=tuple(map(plan.row, rows)), every=spec.every)


def _bytes_of(scene: Scene, every: float) -> float:
    """Bytes of the histories of a scene: at every output time four a value, eight for the time itself."""
    storeys = max(building.storeys for building in scene.buildings)
    series = 8 + len(scene.buildings) * (4 * storeys + 2) + len(scene.links)
    return (4.0 * series + 8.0) * (scene.motion.duration + scene.tail) / every
