"""Expressions over the tables of a study, checked, and their values at every point; a study at chosen points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.numbers import Unit
from pounding_cli.questions.question import StudyQuestion
from pounding_cli.study.axes import UNWRITTEN, Axis
from pounding_cli.study.expression import (
    FLOOR,
    LINK,
    Expression,
    ExpressionError,
    Statement,
    TableQuantity,
)
from pounding_cli.study.file import get
from pounding_cli.study.group import unique_names
from pounding_cli.study.study import Study
from pounding_cli.study.vary import UncertainInput
from pounding_cli.variables import RATIO_VARIABLES, VARIABLES


def evaluate_expression(expression: Expression, data: xr.Dataset, over_motions: str) -> np.ndarray:
    """Return the values of an expression; NaN where a scene that they rest on failed, or has no such number.

    Shape (...).

    data : variables of a results file, shape (..., motions, building, storey) or (..., motions, links)
    over_motions : `mean` or `largest` of the motions, storey by storey before storeys are compared
    """
    values = expression(lambda quantity: _evaluate_quantity(quantity, data, over_motions))
    return np.where(np.isfinite(values), values, np.nan)


def evaluate_error(expression: Expression, data: xr.Dataset, over_motions: str) -> np.ndarray:
    """Return the largest numerical error of an expression: its changes where each of its quantities moves by its own
    error, all added up; NaN where no scene was solved more finely.  Shape (...), as `evaluate_expression`."""

    def evaluate_with(part: TableQuantity, error: np.ndarray) -> np.ndarray:
        """Return the expression where one of its quantities is off by an error."""
        return expression(lambda each: _evaluate_quantity(each, data, over_motions, error if each is part else 0.0))

    total = np.zeros(())
    for part in expression.quantities:
        error = _find_error(part.name, data)
        total = total + np.abs(evaluate_with(part, error) - evaluate_with(part, -error)) / 2
    return total


def _numbers(name: str, data: xr.Dataset) -> np.ndarray:
    """Return a variable; where no case has a link, those of links are empty."""
    if name in LINK and name not in data:
        return np.zeros((*data["status"].shape, 0))
    return data[name].values


def _find_error(name: str, data: xr.Dataset) -> np.ndarray:
    """Return the error of a variable, all motions alike where few were solved more finely; NaN where none was."""
    values = _numbers(name, data)
    alone = "mu0" if name == "drift0" else name  # a ductility is a drift over the yield drift
    for ratio in RATIO_VARIABLES:
        if name == ratio or alone == VARIABLES[ratio].ratio[-1]:  # it has the error of the ratio to the building alone
            with np.errstate(all="ignore"):
                share = data[f"{ratio}_mean_error"].values / np.abs(data[f"{ratio}_mean"].values)
            return np.abs(values) * np.expand_dims(share, -3)
    known = data["error_estimate"].values
    is_known = np.isfinite(known)
    mean = _reduce("mean", known, is_known, (-1,))[..., None]
    share = np.where(is_known, known, np.where(is_known.any(axis=-1, keepdims=True), mean, np.nan))
    return np.abs(values) * share.reshape(*share.shape, *(1,) * (values.ndim - share.ndim))


def _evaluate_quantity(
    quantity: TableQuantity, data: xr.Dataset, over_motions: str, error: np.ndarray | float = 0.0
) -> np.ndarray:
    """Return one quantity, off by an error.

    A storey that a building does not have counts for nothing, nor does a wall that is not named; one whose number is
    missing makes the result NaN: what failed must not drop out of a mean.
    """
    name = quantity.name
    numbers = _numbers(name, data) + error
    # which storeys, floors or links there are; none of a scene that failed
    if name in LINK:
        known = "max_closing"
    elif quantity.building is None:
        known = "mu"  # which walls do not have
    else:
        known = "acceleration" if name in FLOOR else "drift"
    there = ~np.isnan(_numbers(known, data))
    axes: tuple[int, ...] = (-1,) if name in LINK else (-2, -1)
    if quantity.building is not None:
        numbers = numbers[..., [quantity.building], :]
        there = there[..., [quantity.building], :]
    if quantity.level:
        numbers = numbers[..., quantity.level - 1 : quantity.level]
        there = there[..., quantity.level - 1 : quantity.level]
    motions = axes[0] - 1
    numbers = np.where(there.all(axis=motions), _reduce(over_motions, numbers, there, (motions,)), np.nan)
    there = np.asarray(there.any(axis=motions))
    return np.where(there.any(axis=axes), _reduce(quantity.reduction, numbers, there, axes), np.nan)


def _reduce(how: str, numbers: np.ndarray, there: np.ndarray, axes: tuple[int, ...]) -> np.ndarray:
    """Return the mean, largest or smallest of the numbers that are there; NaN where one of these is."""
    if how == "mean":
        return np.where(there, numbers, 0.0).sum(axis=axes) / np.maximum(there.sum(axis=axes), 1)
    if how == "largest":
        return np.where(there, numbers, -np.inf).max(axis=axes, initial=-np.inf)
    return np.where(there, numbers, np.inf).min(axis=axes, initial=np.inf)


Meanings = dict[str, tuple[str, str]]
"""Unit and meaning of columns."""

Said = TypeVar("Said", Expression, Statement)


def parse_all(
    read: Callable[[str, Sequence[str]], Said], asked: StudyQuestion, key: str, texts: Sequence[str]
) -> tuple[Said, ...]:
    """Return the expressions or statements under a key of a question.  Note what is wrong with them.

    read : `parse_expression` or `parse_statement`
    """
    study = asked.study
    parsed: dict[str, Said] = {}
    names = unique_names(study.spec.group)
    storeys = [study.building((0,) * len(study.axes), place).storeys for place in range(len(names))]
    for number, text in enumerate(texts):
        try:
            said = read(text, names)
        except ExpressionError as error:
            asked.add_problem((key, number), *error.args)
            continue
        if said.text in parsed:
            asked.add_problem((key, number), f"'{said}' occurs twice", "remove one of the two")
        for part in said.quantities:
            most = max(storeys) if part.building is None else storeys[part.building]
            if part.building is not None and asked.lacks(part.building, part.name):
                buildings = [name for place, name in enumerate(names) if not asked.is_wall(place)]
                message = f"'{said}': {names[part.building]} is a wall, which has no {part.name}"
                asked.add_problem((key, number), message, f"name one of the buildings: {', '.join(buildings)}")
            elif part.level > most:
                asked.add_problem((key, number), f"'{said}': the highest is {most}", f"write a number from 1 to {most}")
        parsed[said.text] = said
    return tuple(parsed.values())


# A study at chosen points: one more axis, on which all keys that vary move together


def study_at_points(
    study: Study, inputs: Sequence[UncertainInput], points: np.ndarray, and_written: bool = False
) -> Study:
    """Return the study with one more axis, its last, of some points.

    inputs : what varies
    points : u of every input, between 0 and 1, shape (points, inputs); no two come to the same values
    and_written : one more point, the last, stands for the study as it is written

    Raises
    ------
    InputError : the study is not sound at one of them
    """
    members = [member for each in inputs for member in each.members]
    rows = key_values_at(inputs, points)
    if and_written:
        values_of_study = [get(study.tree, *member.key.split(".")) for member in members]
        rows.append(tuple(UNWRITTEN if value is None else value for value in values_of_study))
    names = tuple(member.key for member in members)
    marks = tuple(member.mark for member in members)
    units = tuple(member.unit for member in members)
    axis = Axis(names, rows, [marks] * len(rows), units)
    return study.with_axes((*study.axes, axis))


def key_values_at(inputs: Sequence[UncertainInput], points: np.ndarray) -> list[tuple[object, ...]]:
    """Return the values at points as the study writes them, one for every key; points as in `study_at_points`."""
    columns = [member.values(u) for each, u in zip(inputs, points.T, strict=True) for member in each.members]
    return list(zip(*columns, strict=True)) or [()] * len(points)


def key_columns(inputs: Sequence[UncertainInput], points: np.ndarray) -> tuple[pd.DataFrame, Meanings, dict[str, Unit]]:
    """Return a column of every key at points, with unit and meaning of each, and the unit that people read numbers in;
    points as in `study_at_points`."""
    columns: dict[str, Any] = {}
    meanings: Meanings = {}
    units: dict[str, Unit] = {}
    for each, u in zip(inputs, points.T, strict=True):
        for member in each.members:
            columns[member.key] = member.to_column(u)
            meanings[member.key] = member.column_unit, f"varies: {member.key}"
            if member.column_unit:
                units[member.key] = member.unit
    return pd.DataFrame(columns), meanings, units


def find_distinct_points(inputs: Sequence[UncertainInput], points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points that differ in the values of keys, in the order in which they come first, shape (n, inputs);
    and of every point its place among them, shape (points,)."""
    first: dict[str, int] = {}
    places = np.array([first.setdefault(repr(values), len(first)) for values in key_values_at(inputs, points)])
    _, first_points = np.unique(places, return_index=True)
    return points[first_points], places
