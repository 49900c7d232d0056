"""The axes of a sweep as people read them: values in the unit the study wrote them in, names for ticks."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from pounding_cli.numbers import Unit
from pounding_cli.report.evidence import Tables, axis_keys
from pounding_cli.report.key_words import key_words, name_axis


@dataclass(frozen=True)
class SweptAxis:
    """One axis of a sweep.

    keys : the swept keys; more than one where they move together
    points : one tuple a point, as long as `keys`: SI numbers or texts, as in the tables
    units : per key the unit the study wrote it in
    resolved : the study with every default filled in, which says what the keys are
    """

    keys: tuple[str, ...]
    points: tuple[tuple[Any, ...], ...]
    units: tuple[Unit, ...]
    resolved: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def __len__(self) -> int:
        return len(self.points)

    @property
    def numeric(self) -> bool:
        """Whether the points stand on a scale: the first key's values are numbers."""
        return not any(isinstance(point[0], str) for point in self.points)

    @property
    def label(self) -> str:
        """The keys with their units, for an axis title: "cases.gap.gap [cm]"."""
        return ", ".join(unit.label(key) for key, unit in zip(self.keys, self.units, strict=True))

    def name(self, ax: Axes, which: str) -> None:
        """Entitle an axis of a figure, "x" or "y"."""
        name_axis(ax, which, self.keys, self.units, self.resolved)

    @property
    def words(self) -> str:
        """What the keys are, with their units, and the keys in brackets."""
        named = zip(self.keys, self.units, strict=True)
        return ", ".join(f"{unit.label(key_words(key, self.resolved))} ({key})" for key, unit in named)

    @cached_property
    def coordinates(self) -> np.ndarray:
        """Where the points stand: the first key's numbers in its unit; 1, 2, ... for texts."""
        if not self.numeric:
            return np.arange(1.0, len(self) + 1)
        return np.array([self.units[0].number(float(point[0])) for point in self.points])

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The points as ticks, without units: "5"; of keys that move together all values."""
        bare = [Unit("", unit.factor) for unit in self.units]
        return tuple(", ".join(unit.text(v) for unit, v in zip(bare, point, strict=True)) for point in self.points)

    def at(self, place: int) -> str:
        """A point in words: "cases.gap.gap = 5 cm"."""
        parts = zip(self.keys, self.points[place], self.units, strict=True)
        return ", ".join(f"{key} = {unit.text(value)}" for key, value, unit in parts)

    def place(self, point: Mapping[str, Any]) -> int:
        """The number of a point, given the values of its keys."""
        return self.points.index(tuple(point[key] for key in self.keys))


LARGE_RANGE = 20.0
"""Largest over smallest value of an axis above which it is logarithmic."""
MOST_TICKS = 12
"""Points of an axis up to which each has its own tick."""


@dataclass(frozen=True)
class Placed:
    """Where the points of an axis stand in a figure.

    order : numbers of the points, as they stand from the left (or upwards)
    positions : where they stand, in that order
    ticks : their names, in that order; None where the axis is a scale with ticks of its own
    log : whether that scale is logarithmic
    key : what numbered ticks stand for, as a sentence; "" where the ticks are names
    """

    order: np.ndarray
    positions: np.ndarray
    ticks: tuple[str, ...] | None
    log: bool
    key: str

    def apply(self, ax: Axes, side: Literal["x", "y"]) -> None:
        """Set scale and ticks of one side of a panel."""
        if self.log:
            ax.set(**{f"{side}scale": "log"})
        if self.ticks is not None:
            step = -(-len(self.ticks) // MOST_TICKS)
            ax.set(**{f"{side}ticks": self.positions[::step], f"{side}ticklabels": self.ticks[::step]})


def placed(axis: SweptAxis, characters: int, *, cells: bool = False) -> Placed:
    """Places and ticks of an axis.

    characters : that fit beside each other along the axis
    cells : few points stand as cells of one size, whatever their distances
    """
    order = np.argsort(axis.coordinates, kind="stable")
    coordinates = axis.coordinates[order]
    if axis.numeric and not (cells and len(axis) <= MOST_TICKS):
        wide = coordinates[0] > 0 and coordinates[-1] > LARGE_RANGE * coordinates[0]
        return Placed(order, coordinates, None, bool(wide), "")
    names = [axis.names[place] for place in order]
    ticks, key = short_names(names, characters)
    return Placed(order, np.arange(1.0, len(axis) + 1), tuple(ticks), False, f" {axis.label}: {key}." if key else "")


def short_names(names: Sequence[str], characters: int) -> tuple[list[str], str]:
    """Ticks that fit beside each other in so many characters: names in lines, else numbers with a key."""
    width = max(characters // len(names), 1)
    wrapped = [textwrap.fill(name, width, break_long_words=False) for name in names]
    longest = max(len(line) for name in wrapped for line in name.split("\n"))
    if longest <= width and len("".join(names)) < 3 * characters:
        return wrapped, ""
    numbers = [str(number) for number in range(1, len(names) + 1)]
    return numbers, "; ".join(f"({n}) {name}" for n, name in zip(numbers, names, strict=True))


def swept_axes(results: Tables) -> tuple[SweptAxis, ...]:
    """The axes of a results file in the order of the study; none where nothing is swept."""
    frame = results.scene()
    groups = json.loads(results.attrs.get("swept", "null"))
    groups = groups if groups is not None else [[key] for key in axis_keys(frame)]
    return tuple(
        SweptAxis(
            tuple(keys),
            _points(frame, keys),
            tuple(results.units.get(key, Unit()) for key in keys),
            results.resolved,
        )
        for keys in groups
    )


def _points(frame: pd.DataFrame, keys: Sequence[str]) -> tuple[tuple[Any, ...], ...]:
    return tuple(frame[list(keys)].drop_duplicates().itertuples(index=False, name=None))
