"""A quantity over the sweep: its mean over the motions with the spread, at one place or the worst of several.

Maps and curves of the static figures and of the page draw what `over_sweep` returns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from pounding_cli.errors import InputError, Problem
from pounding_cli.report.axes import SweptAxis, swept_axes
from pounding_cli.report.columns import shown
from pounding_cli.report.evidence import Tables, names
from pounding_cli.store.flagged import flagged_scenes
from pounding_cli.variables import OF_COLUMNS, RESPONSES, VARIABLES

LEVELS = {
    "storey": ("case", "analysis", "building", "storey"),
    "floor": ("case", "analysis", "building", "floor"),
    "link": ("case", "analysis", "link", "floor"),
    "scene": ("case", "analysis"),
}
"""Tables that hold quantities, and the columns that, beside point and motion, say where a value stands."""

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
    meaningless : number of motions whose scene carries a flag that takes the meaning from its numbers
    reasons : those flags
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
    meaningless: np.ndarray
    reasons: tuple[str, ...]

    @property
    def is_ratio(self) -> bool:
        """Whether 1 stands for the building alone."""
        return self.choice.quantity.endswith("_ratio")

    @property
    def title(self) -> str:
        """The quantity with its unit."""
        return f"{self.label} [{self.unit}]" if self.unit not in ("", "–") else self.label


@dataclass(frozen=True, eq=False)
class Panels:
    """What stands side by side in a figure: a heading, and one quantity by case."""

    heading: str
    by_case: dict[str, OverSweep]


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
    return (*(variable.name for variable in RESPONSES if variable.dims[-1] in LEVELS), *_OF_SCENES)


def over_sweep(
    results: Tables,
    choice: Choice,
    axes: Sequence[SweptAxis] | None = None,
    at: Mapping[str, Any] | None = None,
) -> OverSweep:
    """A quantity over the sweep: per place the mean over the motions, at every point the place where it is largest.

    axes : in the order wanted, all axes of the sweep unless given
    at : value (SI, as in the tables) of every key of the axes left out

    Raises
    ------
    InputError : a quantity, case, analysis, building, storey, floor, link or motion that is not there
    """
    axes = tuple(axes) if axes is not None else swept_axes(results)
    shape = tuple(len(axis) for axis in axes)
    frame = getattr(results, choice.table)()
    if choice.quantity not in frame.columns and choice.quantity in OF_COLUMNS:
        hint = "choose another quantity, or write `columns:` in the buildings whose columns are struck"
        raise InputError(Problem(f"no {choice.quantity} in these results: no slab strikes columns", hint))
    rows = _chosen(_cut(frame, at or {}), choice)
    scenes = ["point", "case", "analysis", "record"]
    level = list(LEVELS[choice.table])
    point = point_numbers(rows, axes)
    numbers = rows[[*level, "record"]].assign(value=rows[choice.quantity].to_numpy(float), point=point)
    voids = _meaningless(_cut(results.scene(), at or {}), axes)
    numbers["void"] = pd.MultiIndex.from_frame(numbers[scenes]).isin(pd.MultiIndex.from_frame(voids[scenes]))
    found = over_motions(numbers, "value", level)
    void_of = numbers.groupby(["point", *level], sort=False)["void"].sum()
    found["void"] = void_of.reindex(pd.MultiIndex.from_frame(found[["point", *level]])).to_numpy()
    worst = largest(found, ["point"])
    look = shown(choice.quantity, results.units)

    def spread(values: np.ndarray, empty: object, kind: object = float) -> np.ndarray:
        whole = np.full(int(np.prod(shape)), empty, dtype=kind)  # type: ignore[call-overload]
        whole[worst["point"].to_numpy(int)] = values
        return whole.reshape(shape)

    mean, std, low, high = (
        spread(look.factor * worst[name].to_numpy(float), np.nan) for name in ("mean", "std", "min", "max")
    )
    motions, void = (spread(worst[name].to_numpy(int), 0, int) for name in ("count", "void"))
    place = spread(_places(worst, choice), "", object)
    drawn = pd.MultiIndex.from_frame(numbers.loc[numbers["void"], scenes])
    reasons = names(voids.loc[pd.MultiIndex.from_frame(voids[scenes]).isin(drawn), "flag"])
    return OverSweep(choice, axes, look.label, look.unit, mean, std, low, high, motions, place, void, tuple(reasons))


def over_motions(frame: pd.DataFrame, quantity: str, place: Sequence[str]) -> pd.DataFrame:
    """Mean, std, min, max and count of a quantity over the motions, by `point` and place; no row where nothing is."""
    found = frame.groupby(["point", *place], sort=False)[quantity].agg(["mean", "std", "min", "max", "count"])
    return found[found["count"] > 0].reset_index()


def largest(found: pd.DataFrame, by: Sequence[str]) -> pd.DataFrame:
    """Of what `over_motions` found the row with the largest mean, positive or negative, in every group."""
    if found.empty:
        return found
    return found.loc[found["mean"].abs().groupby([found[name] for name in by], sort=False).idxmax()]


def _cut(frame: pd.DataFrame, at: Mapping[str, Any]) -> pd.DataFrame:
    """The rows at some values of swept keys."""
    for key, value in at.items():
        frame = frame[frame[key] == value]
    return frame


def _meaningless(scene: pd.DataFrame, axes: Sequence[SweptAxis]) -> pd.DataFrame:
    """Flags that take the meaning from a scene's numbers, with its point's number, case, analysis and record."""
    flagged = flagged_scenes(scene[scene["flags"].astype(bool)])
    flagged = flagged[flagged["meaningless"]]
    return flagged.assign(point=point_numbers(flagged, axes))


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
    for name in LEVELS[choice.table]:
        if getattr(choice, name) is not None or (choice.table == "link" and name == "floor"):
            continue
        prefix = f"{name} " if name in ("storey", "floor") else ""
        words.append([f"{prefix}{value}" for value in worst[name]])
    return np.array([", ".join(parts) for parts in zip(*words, strict=True)] if words else [""] * len(worst), object)
