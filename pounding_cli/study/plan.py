"""What a study comes to: scenes, each once, and the table rows that point at them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from pounding_cli.model.links import LinkPlace
from pounding_cli.model.scene import Scene
from pounding_cli.numbers import Unit

if TYPE_CHECKING:
    from pounding_cli.study.motions import MotionUse
    from pounding_cli.study.scenes import Rows
    from pounding_cli.study.study import Study


@dataclass(frozen=True)
class Axis:
    """One dimension of the sweep.

    names : dotted keys as in the file, more than one when they move together
    values : one tuple per point, as long as names: SI numbers, or the file's text for what is no number
    units : the unit each key is written in; SI where none are given
    """

    names: tuple[str, ...]
    values: tuple[tuple[float | str, ...], ...]
    units: tuple[Unit, ...] = ()

    def unit(self, column: int) -> Unit:
        """The unit of a key, by its place in `names`."""
        return self.units[column] if self.units else Unit()

    def shown(self, place: int) -> tuple[str, ...]:
        """The values at a point in the units of the study, e.g. ("0.7 g",)."""
        return tuple(self.unit(column).text(value) for column, value in enumerate(self.values[place]))


class LinkSeen(NamedTuple):
    """A link as the tables know it: left building from 0, floors from 1, name among those of the same floors
    (`model.links.link_places`), law, gap [m], heights of its ends in the storeys below its floors [-]."""

    left: int
    left_floor: int
    right_floor: int
    name: str
    kind: str
    gap: float
    left_at: float = 1.0
    right_at: float = 1.0

    @property
    def place(self) -> LinkPlace:
        """Its place in tables."""
        return self[:4]

    @property
    def columns(self) -> tuple[int, int] | None:
        """Building from 0 and storey from 1 whose columns it strikes; None between two floors."""
        if self.left_at == self.right_at:
            return None
        return (self.left, self.left_floor) if self.left_at < 1.0 else (self.left + 1, self.right_floor)


class Row(NamedTuple):
    """One place in the tables: its index on every axis, keys of Plan.scenes for scene and baselines, its links."""

    point: tuple[int, ...]
    case: str
    analysis: str
    record: str
    scene: str
    baselines: tuple[str, ...]
    links: tuple[LinkSeen, ...]


@dataclass(frozen=True, eq=False)
class Plan:
    """Everything to run.

    scenes : by digest, linked scenes and baselines, each once; built when asked for
    rows : swept axes slowest, then case, analysis, record
    buildings : names by place, left to right (soft-1, soft-2 where a type occurs twice)
    motions : one per record; where the sweep changes them, those of its first point
    accuracy : relative error wanted [-]
    time_step : of a method that takes one [s]
    estimate : which scenes are assessed, for error and sensitivity: none, sample or all
    all_effects : whether to simulate what cannot matter too
    kept : rows whose scenes are kept over time, every `every` seconds
    workflow : what is asked of the scenes, a key of WORKFLOWS
    harder : whether a scene that fails is solved once more, more finely
    rough : whether the scenes of this round only lead to those of later rounds: of `estimate: all` only buildings
        alone, which later rounds share, are then assessed
    state : what a workflow in rounds keeps from one to the next
    ahead : scenes that rounds to come ask for at most, about, as far as the workflow knows
    first : the plan of the first round, where it decides what all rounds ask for; None in that round itself, and where
        rows say it
    """

    study: Study
    axes: tuple[Axis, ...]
    cases: tuple[str, ...]
    analyses: tuple[str, ...]
    records: tuple[str, ...]
    buildings: tuple[str, ...]
    scenes: Mapping[str, Scene]
    rows: Rows
    motions: tuple[MotionUse, ...]
    accuracy: float
    method: str
    estimate: str = "none"
    all_effects: bool = False
    kept: tuple[Row, ...] = ()
    every: float = 0.002
    time_step: float | None = None
    workflow: str = "run"
    harder: bool = False
    rough: bool = False
    state: Any = None
    ahead: int = 0
    first: Plan | None = None

    def shown(self, row: Row) -> dict[str, str]:
        """The swept values of a row, by key, in the units of the study."""
        return {
            name: text
            for axis, place in zip(self.axes, row.point, strict=True)
            for name, text in zip(axis.names, axis.shown(place), strict=True)
        }
