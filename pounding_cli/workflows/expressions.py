"""Expressions of a study over its tables: checked, and their values at every point, case and analysis."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import xarray as xr

from pounding_cli.study.build import places
from pounding_cli.study.expression import (
    FLOOR,
    LINK,
    Expression,
    NotUnderstood,
    Quantity,
    Statement,
    read_expression,
    read_statement,
)
from pounding_cli.study.file import Problems, get
from pounding_cli.study.plan import Plan
from pounding_cli.study.study import Study
from pounding_cli.variables import RATIOS, VARIABLES

Get = Callable[[str], np.ndarray]
"""get(variable of `variables`) -> its values, shape (..., motions, building, storey) or (..., motions, links)."""


def getter(plan: Plan, data: xr.Dataset) -> Get:
    """The variables of a Dataset; where no case has a link, those of links are empty."""

    def get(name: str) -> np.ndarray:
        if name in LINK and name not in data:
            return np.zeros((*plan.shape, 0))
        return data[name].values

    return get


def values_of(expression: Expression, get: Get, over_motions: str | None = None) -> np.ndarray:
    """The values of an expression; NaN where a scene that they rest on failed, or has no such number.

    over_motions : `mean` or `largest` of the motions, storey by storey before storeys are compared: shape (...); None:
        of each motion, shape (..., motions)
    """
    found = expression(lambda quantity: _value(quantity, get, over_motions))
    return np.where(np.isfinite(found), found, np.nan)


def error_of(expression: Expression, get: Get, over_motions: str) -> np.ndarray:
    """The numerical error of an expression, at most: what it changes where each of its quantities moves by its own
    error, all added up; NaN where no scene was solved more finely.  Shape (...), as `values_of`."""
    total = np.zeros(())
    for part in expression.quantities:
        low, high = (expression(_Shifted(part, sign, get, over_motions)) for sign in (-1, 1))
        total = total + np.abs(high - low) / 2
    return total


@dataclass(frozen=True)
class _Shifted:
    """The quantities of an expression, one of them moved by its error."""

    part: Quantity
    sign: int
    get: Get
    over_motions: str

    def __call__(self, quantity: Quantity) -> np.ndarray:
        return _value(quantity, self._moved if quantity is self.part else self.get, self.over_motions)

    def _moved(self, name: str) -> np.ndarray:
        values = self.get(name)
        return values + self.sign * _error(name, self.get) if name == self.part.name else values


def _ratio_of(name: str) -> str:
    """The ratio to the building alone whose error a variable has; "" where it is none."""
    alone = "mu0" if name == "drift0" else name  # a ductility is a drift over the yield drift
    return next((ratio for ratio in RATIOS if name == ratio or alone == VARIABLES[ratio].ratio[-1]), "")


def _error(name: str, get: Get) -> np.ndarray:
    """The error of a variable, all motions alike where few were solved more finely; NaN where none was."""
    values = get(name)
    if ratio := _ratio_of(name):
        with np.errstate(all="ignore"):
            share = np.expand_dims(get(f"{ratio}_mean_error") / np.abs(get(f"{ratio}_mean")), -3)
        return np.abs(values) * share
    known = get("error_estimate")
    mean = _reduced("mean", known, np.isfinite(known), (-1,))[..., None]
    mean = np.where(np.isfinite(known).any(axis=-1, keepdims=True), mean, np.nan)
    share = np.where(np.isfinite(known), known, mean)
    return np.abs(values) * share.reshape(*share.shape, *(1,) * (values.ndim - share.ndim))


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


def expressions(
    study: Study, section: str, key: str, texts: Sequence[str], problems: Problems, example: str = "[largest mu]"
) -> tuple[Expression, ...]:
    """The expressions of a section, over the tables of this study; one at least."""
    if not texts:
        hint = f"write e.g. `{section}: {{{key}: {example}}}`"
        problems.at(study.root, (section,), f"`{section}:` lacks '{key}'", hint, key=True)
    return _read(read_expression, study, section, key, texts, problems)


def statements(study: Study, section: str, key: str, texts: Sequence[str], problems: Problems) -> tuple[Statement, ...]:
    """The statements of a section, over the tables of this study."""
    return _read(read_statement, study, section, key, texts, problems)


Said = TypeVar("Said", Expression, Statement)


def _read(
    read: Callable[[str, Sequence[str]], Said],
    study: Study, section: str, key: str, texts: Sequence[str], problems: Problems,
) -> tuple[Said, ...]:  # fmt: skip
    """What the texts of a section say; what is wrong with them is noted."""
    root, found = study.root, dict[str, Said]()
    is_list = isinstance(get(root, section, key), list)
    names = places(study.model.group)
    for number, text in enumerate(texts):
        path = (section, key, number) if is_list else (section, key)
        try:
            said = read(text, names)
        except NotUnderstood as error:
            problems.at(root, path, *error.args)
            continue
        if said.text in found:
            problems.at(root, path, f"'{said}' occurs twice", "remove one of the two")
        for part in said.quantities:
            tall = [
                study.building((0,) * len(study.axes), place).storeys
                for place in (range(len(names)) if part.building is None else [part.building])
            ]
            if part.level > max(tall):
                what = f"'{said}': the highest is {max(tall)}"
                problems.at(root, path, what, f"write a number from 1 to {max(tall)}")
        found[said.text] = said
    return tuple(found.values())
