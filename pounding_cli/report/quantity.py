"""A quantity over the sweep: its mean over the motions with the spread, at one place or the worst of several.

Maps and curves of the static figures and of the page draw what `over_sweep` returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from pounding_cli.errors import InputError, Problem
from pounding_cli.report.axes import SweptAxis, swept_axes
from pounding_cli.report.columns import shown
from pounding_cli.report.evidence import Tables, names
from pounding_cli.store.layout import RESPONSES, VARIABLES

_LEVELS = {"storey": ("building", "storey"), "floor": ("building", "floor"), "link": ("link", "floor"), "scene": ()}
"""Tables that hold quantities, and the columns that say where in a scene a value stands."""

_OF_SCENES = ("error_estimate", "sensitivity", "energy_residual", "steps", "events", "seconds")


@dataclass(frozen=True)
class Choice:
    """Which values of a quantity are looked at; None takes the worst of all there are.

    quantity : a column of the tables storey, floor, link or scene
    record : one motion; None takes the mean over all of them
    """

    quantity: str
    case: str | None = None
    analysis: str | None = None
    building: str | None = None
    storey: int | None = None
    floor: int | None = None
    link: str | None = None
    record: str | None = None

    @property
    def table(self) -> str:
        """The table that holds the quantity."""
        return table_of(self.quantity)


@dataclass(frozen=True, eq=False)
class OverSweep:
    """A quantity at every point of a sweep; arrays have one dimension an axis.

    label, unit : of the numbers, as people read them; "" where there is no unit
    mean, std, low, high : over the motions, at the place whose mean is largest at that point; NaN where nothing is
    motions : number of motions in the mean
    place : that place in words ("stiff, storey 5"); "" where nothing is
    """

    choice: Choice
    axes: tuple[SweptAxis, ...]
    label: str
    unit: str
    mean: np.ndarray
    std: np.ndarray
    low: np.ndarray
    high: np.ndarray
    motions: np.ndarray
    place: np.ndarray

    def at(self, places: Sequence[int | slice]) -> OverSweep:
        """The part at given places of the axes: a number takes an axis away, a slice keeps it."""
        cut = tuple(places)
        kept = tuple(axis for axis, place in zip(self.axes, cut, strict=True) if isinstance(place, slice))
        parts = {name: getattr(self, name)[cut] for name in ("mean", "std", "low", "high", "motions", "place")}
        return replace(self, axes=kept, **parts)

    @property
    def title(self) -> str:
        """The quantity with its unit."""
        return f"{self.label} [{self.unit}]" if self.unit not in ("", "–") else self.label


def table_of(quantity: str) -> str:
    """The table that holds a quantity.

    Raises
    ------
    InputError : there is no such quantity
    """
    if quantity in _OF_SCENES:
        return "scene"
    if quantity not in quantities():
        raise InputError(Problem(f"there is no quantity {quantity!r}", f"write one of: {', '.join(quantities())}"))
    return VARIABLES[quantity].dims[-1]


def quantities() -> tuple[str, ...]:
    """The quantities that can be drawn over a sweep, by their names in the tables."""
    return (*(variable.name for variable in RESPONSES if variable.dims[-1] in _LEVELS), *_OF_SCENES)


def over_sweep(results: Tables, choice: Choice, axes: Sequence[SweptAxis] | None = None) -> OverSweep:
    """A quantity over the sweep: per place the mean over the motions, at every point the place where it is largest.

    Raises
    ------
    InputError : a quantity, case, analysis, building, storey, floor, link or motion that is not there
    """
    axes = tuple(axes) if axes is not None else swept_axes(results)
    rows = _chosen(getattr(results, choice.table)(), choice)
    keys = [key for axis in axes for key in axis.keys]
    level = [column for column in ("case", "analysis", *_LEVELS[choice.table]) if column in rows.columns]
    numbers = rows[[*keys, *level, "record", choice.quantity]]
    numbers = numbers.assign(value=numbers[choice.quantity].to_numpy(float), point=point_numbers(rows, axes))
    found = numbers.groupby(["point", *level], sort=False)["value"].agg(["mean", "std", "min", "max", "count"])
    found = found[found["count"] > 0].reset_index()
    worst = found.loc[found["mean"].abs().groupby(found["point"], sort=False).idxmax()] if len(found) else found
    shape = tuple(len(axis) for axis in axes)
    look = shown(choice.quantity)
    at = worst["point"].to_numpy(int)

    def spread(values: np.ndarray, empty: object, kind: object = float) -> np.ndarray:
        whole = np.full(int(np.prod(shape)), empty, dtype=kind)  # type: ignore[call-overload]
        whole[at] = values
        return whole.reshape(shape)

    mean, std, low, high = (
        spread(look.factor * worst[name].to_numpy(float), np.nan) for name in ("mean", "std", "min", "max")
    )
    motions = spread(worst["count"].to_numpy(int), 0, int)
    place = spread(_places(worst, choice), "", object)
    return OverSweep(choice, axes, look.label, look.unit, mean, std, low, high, motions, place)


def _chosen(frame: pd.DataFrame, choice: Choice) -> pd.DataFrame:
    """The rows of the choice; a name that is not there is refused with those that are."""
    problems = []
    for name in ("case", "analysis", "building", "storey", "floor", "link", "record"):
        value = getattr(choice, name)
        if value is None:
            continue
        if name not in frame.columns:
            problems.append(Problem(f"{choice.quantity} has no {name}", "leave it out, or choose another quantity"))
            continue
        rows = frame[frame[name] == value]
        if rows.empty:
            there = ", ".join(names(frame[name].sort_values() if name in ("storey", "floor") else frame[name]))
            hint = f"write one of: {there}" if there else f"there is no {name} in this file"
            problems.append(Problem(f"there is no {name} {value!r} for {choice.quantity}", hint))
            continue
        frame = rows
    if problems:
        raise InputError(problems)
    return frame


def point_numbers(rows: pd.DataFrame, axes: Sequence[SweptAxis]) -> np.ndarray:
    """The number of every row's point, the last axis fastest; -1 where the axes do not have it."""
    number = np.zeros(len(rows), int)
    for axis in axes:
        places = pd.MultiIndex.from_tuples(axis.points)
        place = places.get_indexer(pd.MultiIndex.from_frame(rows[list(axis.keys)]))
        number = np.where((number < 0) | (place < 0), -1, number * len(axis) + place)
    return number


def _places(worst: pd.DataFrame, choice: Choice) -> np.ndarray:
    """Where the numbers stand in words, without what was chosen."""
    words = []
    for name in ("case", "analysis", *_LEVELS[choice.table]):
        if getattr(choice, name) is not None or (choice.table == "link" and name == "floor"):
            continue
        prefix = f"{name} " if name in ("storey", "floor") else ""
        words.append([f"{prefix}{value}" for value in worst[name]])
    return np.array([", ".join(parts) for parts in zip(*words, strict=True)] if words else [""] * len(worst), object)
