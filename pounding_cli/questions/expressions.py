"""Expressions over the tables of a study: checked, and evaluated at every point."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

import numpy as np

from pounding_cli.questions.question import StudyQuestion
from pounding_cli.solver.response import DONE
from pounding_cli.study.expression import (
    FLOOR,
    LINE,
    LINK,
    SHEAR_DEMAND,
    TWIST,
    TWISTING,
    Expression,
    ExpressionError,
    Statement,
    TableQuantity,
)
from pounding_cli.study.group import unique_names
from pounding_cli.variables import LINE_RATIO_VARIABLES, RATIO_VARIABLES, VARIABLES

Values = Mapping[str, np.ndarray]
"""Variables of a results file by name, shape (..., motions, building, storey), of lines (..., motions, building,
storey, line), of links (..., motions, links)."""


def evaluate_expression(expression: Expression, values: Values, over_motions: str) -> np.ndarray:
    """Return the values of an expression; NaN where a run that they rest on failed, or the quantity is undefined.

    Shape (...).

    values : of all variables that the expression names, of `status`, and of those that tell which storeys there are:
        drift, mu, acceleration, max_closing, peak_force
    over_motions : `mean`, `largest` or `smallest` of the motions, storey by storey before storeys are compared
    """
    results = expression(lambda quantity: _evaluate_quantity(quantity, values, over_motions))
    return np.where(np.isfinite(results), results, np.nan)


def evaluate_error(expression: Expression, values: Values, over_motions: str) -> np.ndarray:
    """Return the largest numerical error of an expression; NaN where no run was solved more finely.

    It is the sum of the changes of the expression where each of its quantities moves by its own error.  Shape (...).

    values : as in `evaluate_expression`, and `error_estimate` and the means of ratios with their errors
    """

    def evaluate_with(part: TableQuantity, error: np.ndarray) -> np.ndarray:
        """Return the expression where one of its quantities is off by an error."""
        return expression(lambda each: _evaluate_quantity(each, values, over_motions, error if each is part else 0.0))

    total = np.zeros(())
    for part in expression.quantities:
        error = _find_error(part.name, values)
        total = total + np.abs(evaluate_with(part, error) - evaluate_with(part, -error)) / 2
    return total


def _find_values(name: str, values: Values) -> np.ndarray:
    """Return the values of a variable; where no case has a link, those of links are empty.

    The shear demand is that of columns which a link loads, and 0 of every other link.
    """
    if name in LINK and "max_closing" not in values:
        return np.zeros((*values["status"].shape, 0))
    if name != SHEAR_DEMAND:
        return values[name]
    if name not in values:
        return np.zeros_like(values["max_closing"])
    return np.where(values["peak_force"] > 0, np.nan_to_num(values[name]), 0.0)


def _find_error(name: str, values: Values) -> np.ndarray:
    """Return the error of a variable, all motions alike where few were solved more finely; NaN where none was."""
    numbers = _find_values(name, values)
    alone = name.replace("drift0", "mu0")  # a ductility is a drift over the yield drift
    for ratio in (*RATIO_VARIABLES, *LINE_RATIO_VARIABLES):
        if name == ratio or alone == VARIABLES[ratio].ratio[-1]:  # it has the error of the ratio to the building alone
            with np.errstate(all="ignore"):
                share = values[f"{ratio}_mean_error"] / np.abs(values[f"{ratio}_mean"])
            return np.abs(numbers) * np.expand_dims(share, -4 if name in LINE else -3)
    known = values["error_estimate"]
    is_known = np.isfinite(known)
    mean = _reduce("mean", known, is_known, (-1,))[..., None]
    share = np.where(is_known, known, np.where(is_known.any(axis=-1, keepdims=True), mean, np.nan))
    return np.abs(numbers) * share.reshape(*share.shape, *(1,) * (numbers.ndim - share.ndim))


def _evaluate_quantity(
    quantity: TableQuantity, values: Values, over_motions: str, error: np.ndarray | float = 0.0
) -> np.ndarray:
    """Return one quantity, off by an error.

    A storey that a building does not have counts for nothing, nor does a wall that is not named; one whose number is
    missing makes the result NaN: what failed must not drop out of a mean.
    """
    name = quantity.name
    numbers = _find_values(name, values) + error
    if name in LINE:  # every storey has all lines of its building
        numbers = numbers[..., quantity.line - 1]
    # which storeys, floors or links there are; none of a run that failed
    if name in LINK:
        known = "max_closing"
    elif name.startswith(TWIST):  # which buildings without a plan do not have
        known = name
    elif quantity.building is None:
        known = "mu"  # which walls do not have
    else:
        known = "acceleration" if name in FLOOR else "drift"
    exists = ~np.isnan(_find_values(known, values))
    axes: tuple[int, ...] = (-1,) if name in LINK else (-2, -1)
    if quantity.building is None:  # else the buildings that a collapse ended would count for nothing beside the others
        is_done = values["status"] == DONE
        numbers = np.where(np.expand_dims(is_done, axes), numbers, np.nan)
    if quantity.building is not None:
        numbers = numbers[..., [quantity.building], :]
        exists = exists[..., [quantity.building], :]
    if quantity.level:
        numbers = numbers[..., quantity.level - 1 : quantity.level]
        exists = exists[..., quantity.level - 1 : quantity.level]
    motions = axes[0] - 1
    numbers = np.where(exists.all(axis=motions), _reduce(over_motions, numbers, exists, (motions,)), np.nan)
    exists = np.asarray(exists.any(axis=motions))
    return np.where(exists.any(axis=axes), _reduce(quantity.reduction, numbers, exists, axes), np.nan)


def _reduce(reduction: str, numbers: np.ndarray, exists: np.ndarray, axes: tuple[int, ...]) -> np.ndarray:
    """Return the mean, largest or smallest of the numbers that exist; NaN where one of these is."""
    if reduction == "mean":
        return np.where(exists, numbers, 0.0).sum(axis=axes) / np.maximum(exists.sum(axis=axes), 1)
    if reduction == "largest":
        return np.where(exists, numbers, -np.inf).max(axis=axes, initial=-np.inf)
    return np.where(exists, numbers, np.inf).min(axis=axes, initial=np.inf)


Parsed = TypeVar("Parsed", Expression, Statement)


def parse_all(
    parse: Callable[[str, Sequence[str]], Parsed], question: StudyQuestion, key: str, texts: Sequence[str]
) -> tuple[Parsed, ...]:
    """Return the expressions or statements under a key of a question.  Note what is wrong with them.

    parse : `parse_expression` or `parse_statement`
    """
    study = question.study
    parsed: dict[str, Parsed] = {}
    names = unique_names(study.spec.group)
    buildings_of_study = [study.building((0,) * len(study.axes), place) for place in range(len(names))]
    storeys = [building.storeys for building in buildings_of_study]
    lines = [building.lines for building in buildings_of_study]
    for number, text in enumerate(texts):
        try:
            one = parse(text, names)
        except ExpressionError as error:
            question.add_problem((key, number), *error.args)
            continue
        if one.text in parsed:
            question.add_problem((key, number), f"'{one}' occurs twice", "remove one of the two")
        for part in one.quantities:
            most = max(storeys) if part.building is None else storeys[part.building]
            if part.building is not None and question.lacks(part.building, part.name):
                buildings = [name for place, name in enumerate(names) if not question.is_wall(place)]
                message = f"'{one}': {names[part.building]} is a wall, which has no {part.name}"
                question.add_problem((key, number), message, f"name one of the buildings: {', '.join(buildings)}")
            elif part.name in TWISTING and (problem := find_twist_problem(part, lines, names)):
                message, hint = problem
                question.add_problem((key, number), f"'{one}': {message}", hint)
            elif part.level > most:
                question.add_problem(
                    (key, number), f"'{one}': the highest is {most}", f"write a number from 1 to {most}"
                )
        parsed[one.text] = one
    return tuple(parsed.values())


def find_twist_problem(part: TableQuantity, lines: Sequence[int], names: Sequence[str]) -> tuple[str, str] | None:
    """Return what is wrong with a quantity of floors that twist, and what to write; None where nothing is.

    lines : number of frame lines of every building, 0 of those without a plan
    names : of the group by place
    """
    has_plan = [name for name, count in zip(names, lines, strict=True) if count]
    needs_plan = part.name in LINE or part.name.startswith(TWIST)
    if not has_plan:
        return "no building of the study has a plan, so floors do not twist", "write `plan:` of a building that twists"
    if part.building is None:
        return None
    name = names[part.building]
    count = lines[part.building]
    if needs_plan and not count:
        return f"{name} has no plan", f"name a building with one: {', '.join(has_plan)}"
    if part.line > count:
        known = "one line" if count == 1 else f"lines 1 to {count}"
        return f"{name} has {known}", f"write `line 1 of {name}`, as its plan lists them; those across the row are last"
    return None
