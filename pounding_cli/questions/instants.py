"""Numbers at an instant of a kept history: where a floor is when it meets its neighbour, and when that is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.study.expressions.expression import Instant, TableQuantity

if TYPE_CHECKING:
    from pounding_cli.results.arrays import ResultArrays

_TIME, _VELOCITY = "time", "velocity"


class Instants:
    """The kept histories of a plan, asked for numbers at instants.

    shape : of the rows of the plan: sweep, cases, analyses, motions
    histories : index of a row, and its history
    gaps : of the links, shape (sweep, cases, links) [m]
    """

    def __init__(
        self,
        shape: Sequence[int],
        histories: Iterable[tuple[tuple[int, ...], ResultArrays]],
        gaps: np.ndarray | None,
    ) -> None:
        self.shape = tuple(shape)
        self.histories = list(histories)
        self.gaps = gaps

    def __call__(self, quantity: TableQuantity) -> np.ndarray:
        """Return a quantity at its instant in every row; NaN of rows that are not kept, or that lack the instant."""
        found = np.full(self.shape, np.nan)
        for index, history in self.histories:
            gaps = None if self.gaps is None else self.gaps[index[:-2]]
            found[index] = find_at_instant(history, quantity, gaps)
        return found


def find_at_instant(history: ResultArrays, quantity: TableQuantity, gaps: np.ndarray | None) -> float:
    """Return a quantity of a history at an instant, between its samples; NaN where there is no such instant [SI].

    gaps : of the links [m]
    """
    assert quantity.instant is not None
    times = history["time"].values.astype(float)
    instant = find_instant(history, quantity, quantity.instant, times, gaps)
    if not times[0] <= instant <= times[-1]:
        return np.nan
    if quantity.name == _TIME:
        return instant
    return float(np.interp(instant, times, read_series(history, quantity.name, quantity, times)))


def find_instant(
    history: ResultArrays, quantity: TableQuantity, instant: Instant, times: np.ndarray, gaps: np.ndarray | None
) -> float:
    """Return when an instant is [s]; NaN where it never comes.

    quantity : whose building, storey or floor is meant
    """
    if instant.kind == _TIME:
        return instant.delay
    if instant.kind in ("largest", "smallest"):
        series = read_series(history, instant.quantity, quantity, times)
        if np.isnan(series).any():  # the case has no such quantity
            return np.nan
        if instant.end is not None:
            end = find_instant(history, quantity, instant.end, times, gaps)
            part = times >= end if instant.side == "after" else times <= end
            if not part.any():
                return np.nan
            series, times = series[part], times[part]
        most = series.argmax() if instant.kind == "largest" else series.argmin()
        return float(times[most]) + instant.delay
    crossings = find_crossings(history, instant, times, gaps)
    place = instant.number - 1 if instant.number > 0 else instant.number
    if not -len(crossings) <= place < len(crossings):
        return np.nan
    return float(crossings[place]) + instant.delay


def find_crossings(
    history: ResultArrays, instant: Instant, times: np.ndarray, gaps: np.ndarray | None
) -> np.ndarray:  # fmt: skip
    """Return the times at which the first two floors of the row meet, or the last ones part [s]."""
    if gaps is None or not gaps.size:
        return np.array([])
    depths = history["closing"].values.astype(float) - gaps  # NaN of links that the case does not have
    is_contact = instant.kind == "contact"
    is_closed = depths >= 0 if is_contact else depths > 0
    is_any = is_closed.any(axis=1)
    before = np.flatnonzero(~is_any[:-1] & is_any[1:] if is_contact else is_any[:-1] & ~is_any[1:])
    crosses = is_closed[before + 1] if is_contact else is_closed[before]
    left, change = depths[before], depths[before + 1] - depths[before]
    part = np.divide(-left, change, out=np.full(left.shape, np.nan), where=crosses)
    part = np.nanmin(part, axis=1) if is_contact else np.nanmax(part, axis=1)
    return np.asarray(times[before] + part * np.diff(times)[before])


def read_series(history: ResultArrays, name: str, quantity: TableQuantity, times: np.ndarray) -> np.ndarray:
    """Return a quantity over time, shape (times,): of the building, the storey or the floor that is named; of several
    that are not told apart the one with the largest value."""
    array = history["displacement" if name == _VELOCITY else name]
    values = array.values.astype(float)
    if "building" in array.dims:
        if quantity.building is not None:
            values = values[:, [quantity.building]]
        if quantity.level:
            values = values[..., [quantity.level - 1]]
    series = values.reshape(len(times), -1)
    series = series[:, np.isfinite(series).all(axis=0)]
    if not series.shape[1]:
        return np.full(len(times), np.nan)
    chosen = series[:, np.abs(series).max(axis=0).argmax()]
    return np.gradient(chosen, times) if name == _VELOCITY else chosen
