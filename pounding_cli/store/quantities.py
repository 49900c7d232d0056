"""The values of an expression over the tables: of every point, case and analysis, over the motions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pounding_cli.study.expression import FLOOR, LINK, Expression, Quantity

Get = Callable[[str], np.ndarray]
"""get(variable of `store.layout`) -> its values, shape (..., motions, building, storey) or (..., motions, links)."""


def values_of(expression: Expression, get: Get, over_motions: str | None = None) -> np.ndarray:
    """The values of an expression; NaN where a scene that they rest on failed, or has no such number.

    over_motions : `mean` or `largest` of the motions, storey by storey before storeys are compared: shape (...); None:
        of each motion, shape (..., motions)
    """
    found = expression(lambda quantity: _value(quantity, get, over_motions))
    return np.where(np.isfinite(found), found, np.nan)


def _value(quantity: Quantity, get: Get, over_motions: str | None) -> np.ndarray:
    """One quantity. A storey that a building does not have counts for nothing; one whose number is missing makes the
    result NaN: what failed must not drop out of a mean."""
    numbers: np.ndarray = get(quantity.name)
    there = np.asarray(_there(quantity.name, get))
    axes: tuple[int, ...] = (-1,) if quantity.name in LINK else (-2, -1)
    if quantity.building is not None:
        numbers, there = (each[..., [quantity.building], :] for each in (numbers, there))
    if quantity.level:
        place = slice(quantity.level - 1, quantity.level)
        numbers, there = numbers[..., place], there[..., place]
    if over_motions is not None:
        axis = axes[0] - 1
        reduced = _reduced(over_motions, numbers, there, (axis,))
        numbers = np.where(there.all(axis=axis), reduced, np.nan)
        there = np.asarray(there.any(axis=axis))
    found = _reduced(quantity.reduction, numbers, there, axes)
    return np.where(there.any(axis=axes), found, np.nan)


def _there(name: str, get: Get) -> np.ndarray:
    """Which storeys, floors or links there are; none of a scene that failed."""
    return ~np.isnan(get("max_closing" if name in LINK else "acceleration" if name in FLOOR else "drift"))


def _reduced(how: str, numbers: np.ndarray, there: np.ndarray, axes: tuple[int, ...]) -> np.ndarray:
    """The mean, largest or smallest of what is there; NaN where one of these is."""
    if how == "mean":
        return np.where(there, numbers, 0.0).sum(axis=axes) / np.maximum(there.sum(axis=axes), 1)
    if how == "largest":
        return np.where(there, numbers, -np.inf).max(axis=axes, initial=-np.inf)
    return np.where(there, numbers, np.inf).min(axis=axes, initial=np.inf)
