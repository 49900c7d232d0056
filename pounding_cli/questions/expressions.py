"""Expressions over the tables of a study: checked, and evaluated at every point."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.questions.question import StudyQuestion
from pounding_cli.records import load_catalogue
from pounding_cli.solver.response import DONE
from pounding_cli.study.construct.group import unique_names
from pounding_cli.study.expressions.comparison import Compared, Comparison
from pounding_cli.study.expressions.expression import (
    ABSENT,
    FACTS,
    FLOOR,
    LINE,
    LINK,
    LINK_FACTS,
    OF_MOTIONS,
    SAME_PERIOD,
    SHEAR_DEMAND,
    SOFTER,
    STOREY,
    TWISTING,
    Expression,
    Scope,
    TableQuantity,
    Value,
)
from pounding_cli.study.expressions.limits import TWIST
from pounding_cli.variables import LINE_RATIO_VARIABLES, NO_DIFFERENCE, RATIO_VARIABLES, SCENE_DIMS, VARIABLES

if TYPE_CHECKING:
    from pounding_cli.results.arrays import ResultArrays
    from pounding_cli.study import Study

FindAtInstant = Callable[[TableQuantity], np.ndarray]
"""find(quantity at an instant) -> its values, shape (..., motions)."""

Values = Mapping[str, np.ndarray]
"""Variables of a results file by name, shape (..., motions, building, storey), of lines (..., motions, building,
storey, line), of links (..., motions, links), of scenes and buildings without their last axes; lengths of 1 where they
do not change. Where expressions name points, cases or analyses, the first axes are those of the sweep and these two."""

EVERY = "each"
"""Of the motions, where each has a value of its own."""

NEEDED = ("status", "drift", "mu", "acceleration", "max_closing", "peak_force", "period")
"""Variables that tell which storeys, floors and links there are, and which building is the stiffest."""

NO_PEAKS = ("impacts", "impulse", "contact_time")
"""Numbers of links that are no peaks, of which the sensitivity of a time history says nothing."""


def collect_values(arrays: ResultArrays, axes: Sequence[str], names: Iterable[str]) -> dict[str, np.ndarray]:
    """Return variables with those that `evaluate_expression` needs besides, over the axes of a sweep, case, analysis,
    motions and their own dimensions.

    axes : first keys of the axes of the sweep
    """
    first = (*axes, *SCENE_DIMS)
    values = {}
    for name in (*names, *NEEDED):
        if name not in arrays:  # no case has a link
            continue
        array = arrays[name]
        own = [dim for dim in array.dims if dim not in first]
        lengths = dict(zip(array.dims, array.values.shape, strict=True))
        order = [array.dims.index(dim) for dim in (*first, *own) if dim in lengths]
        shape = [lengths.get(dim, 1) for dim in (*first, *own)]
        values[name] = array.values.transpose(order).reshape(shape)
    return values


def name_variables(quantities: Iterable[TableQuantity]) -> set[str]:
    """Return the variables of a results file that quantities are read from, with those of their errors."""
    names = {_name_variable(each.name) for each in quantities if each.instant is None}
    ratios = [name for name in (*RATIO_VARIABLES, *LINE_RATIO_VARIABLES) if names & {name, VARIABLES[name].ratio[-1]}]
    of_means = {f"{name}_mean{end}" for name in ratios for end in ("", "_error", "_sensitivity")}
    return names | of_means | {"error_estimate", "sensitivity"}


def _name_variable(name: str) -> str:
    return f"record_{name}" if name in OF_MOTIONS else name


def evaluate_expression(
    expression: Expression, values: Values, over_motions: str, instants: FindAtInstant | None = None
) -> np.ndarray:
    """Return the values of an expression; NaN where a run that they rest on failed, or the quantity is undefined.

    Shape (...), and behind that (motions,) for each of these; lengths of 1 where every quantity names its place.

    values : of all variables that the expression names, and of NEEDED
    over_motions : `mean`, `largest` or `smallest` of the motions, storey by storey before storeys are compared; EVERY
    instants : quantity at an instant -> its values, shape (..., motions)
    """
    results = expression(lambda quantity: _evaluate_quantity(quantity, values, over_motions, instants))
    return np.where(np.isfinite(results), results, np.nan)


def compare_values(
    comparison: Comparison, values: Values, over_motions: str, instants: FindAtInstant | None = None
) -> Compared:  # fmt: skip
    """Return what becomes of a comparison; arguments and shapes as those of `evaluate_expression`."""
    return comparison.compare(lambda quantity: _evaluate_quantity(quantity, values, over_motions, instants))


def find_failed(quantities: Sequence[TableQuantity], values: Values, over_motions: str) -> np.ndarray:
    """Return whether a time history that some quantities rest on has not run to its end, in the shape of their
    values."""
    failed = np.zeros((), bool)
    for part in quantities:
        if part.name in FACTS or part.name in OF_MOTIONS:
            continue
        of_motions = choose_scenes(values["status"] != DONE, part, 1)
        failed = failed | (of_motions if over_motions == EVERY else of_motions.any(axis=-1))
    return failed


def evaluate_error(expression: Expression, values: Values, over_motions: str) -> np.ndarray:
    """Return the largest numerical error of an expression; NaN where no run was solved more finely.

    It is the sum of the changes of the expression where each of its quantities moves by its own error.  Shape (...).

    values : as in `evaluate_expression`, and `error_estimate` and the means of ratios with their errors
    """
    return find_spread(expression.quantities, expression, values, over_motions, "error")


def find_spread(
    quantities: Sequence[TableQuantity],
    work: Callable[[Value], np.ndarray],
    values: Values,
    over_motions: str,
    kind: str,
    instants: FindAtInstant | None = None,
) -> np.ndarray:
    """Return by how much a number moves with the numerical error of its quantities, or with a small change of the
    motion; NaN where that is not known.

    work : of the number, from the values of the quantities
    kind : `error` or `sensitivity`
    """

    def evaluate_with(part: TableQuantity, error: np.ndarray) -> np.ndarray:
        """Return the number where one of its quantities is off by an error."""
        return work(
            lambda each: _evaluate_quantity(each, values, over_motions, instants, error if each is part else 0.0)
        )

    total = np.zeros(())
    for part in quantities:
        if part.instant is None and part.name in (*FACTS, *OF_MOTIONS):
            continue
        if part.instant is None and kind == "error" and is_count(part.name):
            continue
        if part.instant is not None or (kind == "sensitivity" and part.name in NO_PEAKS):
            total = total * np.nan
            continue
        error = _find_error(part.name, values, kind)
        total = total + np.abs(evaluate_with(part, error) - evaluate_with(part, -error)) / 2
    return total


def is_count(name: str) -> bool:
    """Return whether a variable counts something, contacts or events: it has no numerical error by shares."""
    variable = VARIABLES[_name_variable(name)]
    return variable.kind == "i" or variable.difference_scale == NO_DIFFERENCE


def _find_values(name: str, values: Values) -> np.ndarray:
    """Return the values of a variable; where no case has a link, those of links are empty.

    The shear demand is that of columns which a link loads, and 0 of every other link.
    """
    name = _name_variable(name)
    if name in (*LINK, *LINK_FACTS) and "max_closing" not in values:
        return np.zeros((*values["status"].shape, 0))
    if name != SHEAR_DEMAND:
        return values[name] if name in values else np.full(values["status"].shape, np.nan)
    if name not in values:
        return np.zeros_like(values["max_closing"])
    return np.where(values["peak_force"] > 0, np.nan_to_num(values[name]), 0.0)


def _find_error(name: str, values: Values, kind: str = "error") -> np.ndarray:
    """Return the error of a variable, all motions alike where few were solved more finely; NaN where none was.

    kind : `error`, or `sensitivity` to a small change of the motion
    """
    numbers = _find_values(name, values)
    alone = name.replace("drift0", "mu0")  # a ductility is a drift over the yield drift
    for ratio in (*RATIO_VARIABLES, *LINE_RATIO_VARIABLES):
        if name == ratio or alone == VARIABLES[ratio].ratio[-1]:  # it has the error of the ratio to the building alone
            with np.errstate(all="ignore"):
                share = values[f"{ratio}_mean_{kind}"] / (np.abs(values[f"{ratio}_mean"]) if kind == "error" else 1.0)
            is_spread = share.ndim == numbers.ndim
            return np.abs(numbers) * (share if is_spread else np.expand_dims(share, -4 if name in LINE else -3))
    known = values["error_estimate" if kind == "error" else "sensitivity"]
    is_known = np.isfinite(known)
    mean = _reduce("mean", known, is_known, (-1,))[..., None]
    share = np.where(is_known, known, np.where(is_known.any(axis=-1, keepdims=True), mean, np.nan))
    return np.abs(numbers) * share.reshape(*share.shape, *(1,) * (numbers.ndim - share.ndim))


def _evaluate_quantity(
    quantity: TableQuantity,
    values: Values,
    over_motions: str,
    instants: FindAtInstant | None = None,
    error: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Return one quantity, off by an error [SI].

    A storey that a building does not have counts for nothing, nor does a wall that is not named; one whose number is
    missing makes the result NaN: what failed must not drop out of a mean.
    """
    name = quantity.name
    if quantity.motion == ABSENT or (quantity.instant is not None and instants is None):
        return np.full((1,) * (values["status"].ndim - (over_motions != EVERY)), np.nan)
    if quantity.instant is not None:
        assert instants is not None
        of_motions = choose_scenes(instants(quantity), quantity, 1)
        exists = np.ones(of_motions.shape, bool)
        return of_motions if over_motions == EVERY else _reduce(over_motions, of_motions, exists, (-1,))
    numbers = _find_values(name, values) + error
    count = _count_own_axes(quantity)
    if name in LINE:  # every storey has all lines of its building
        numbers = numbers[..., quantity.line - 1]
    numbers = choose_scenes(numbers, quantity, count + 1)
    exists = choose_scenes(_find_existing(quantity, values, numbers), quantity, count + 1)
    has_buildings = name in STOREY or name in FLOOR or name in LINE
    if has_buildings and quantity.building is None:
        # else the buildings that a collapse ended would count for nothing beside the others
        is_done = choose_scenes(values["status"] == DONE, quantity, 1)
        numbers = np.where(is_done.reshape(*is_done.shape, *(1,) * count), numbers, np.nan)
    if quantity.building is not None and count:
        numbers, exists = (each.take([quantity.building], axis=-count) for each in (numbers, exists))
    if quantity.role and count:
        is_meant = choose_scenes(_find_role(quantity.role, values), quantity, 2)
        exists = exists & is_meant.reshape(*is_meant.shape, *(1,) * (count - 1))
    if quantity.law:
        exists = exists & choose_scenes(values["kind"] == quantity.law, quantity, 2)
    if quantity.level:
        numbers = numbers[..., quantity.level - 1 : quantity.level]
        exists = exists[..., quantity.level - 1 : quantity.level]
    numbers, exists = np.broadcast_arrays(numbers, exists)
    own = tuple(range(-count, 0))
    if over_motions == EVERY:
        return _reduce_places(quantity, numbers, exists, own)
    motions = -count - 1
    numbers = np.where(exists.all(axis=motions), _reduce(over_motions, numbers, exists, (motions,)), np.nan)
    exists = np.asarray(exists.any(axis=motions))
    return _reduce_places(quantity, numbers, exists, own)


def _count_own_axes(quantity: TableQuantity) -> int:
    """Return the number of axes of a variable behind that of the motions, without that of frame lines."""
    dims = VARIABLES[_name_variable(quantity.name)].dims
    return len([dim for dim in dims if dim not in (*SCENE_DIMS, "line")])


def _find_existing(quantity: TableQuantity, values: Values, numbers: np.ndarray) -> np.ndarray:
    """Return which storeys, floors or links there are; none of a run that failed."""
    name = quantity.name
    if name in LINK:
        known = "max_closing"
    elif name.startswith(TWIST):  # which buildings without a plan do not have
        known = name
    elif name in FLOOR:
        known = "mu" if quantity.building is None else "acceleration"  # walls have no ductility
    elif name in STOREY or name in LINE:
        known = "mu" if quantity.building is None else "drift"
    else:
        return np.asarray(~np.isnan(_find_values(name, values)))
    return np.asarray(~np.isnan(_find_values(known, values)))


def _find_role(role: str, values: Values) -> np.ndarray:
    """Return which buildings have a role: the one with the shortest period, of several the first, or all with a longer
    one.  Shape (..., motions, buildings)."""
    periods = np.where(np.isfinite(values["period"]), values["period"], np.inf)
    shortest = periods.min(axis=-1, keepdims=True)
    if role == SOFTER:
        return np.isfinite(periods) & (periods > SAME_PERIOD * shortest)
    return np.asarray(np.arange(periods.shape[-1]) == periods.argmin(axis=-1)[..., None])


def choose_scenes(array: np.ndarray, quantity: TableQuantity, behind: int) -> np.ndarray:
    """Return the values at the point, in the case and analysis and under the motion that a quantity names; their axes
    stay, with a length of 1.

    behind : number of axes from that of the motions on
    """
    motions = array.ndim - behind
    wanted = {motions: quantity.motion, motions - 1: quantity.analysis, motions - 2: quantity.case}
    wanted |= dict(quantity.point)
    for axis, place in wanted.items():
        if place is not None and array.shape[axis] > 1:
            array = array.take([place], axis=axis)
    return array


def _reduce_places(
    quantity: TableQuantity, numbers: np.ndarray, exists: np.ndarray, axes: tuple[int, ...]
) -> np.ndarray:  # fmt: skip
    """Return numbers reduced over storeys, floors or links, and over buildings."""
    if quantity.over_buildings:
        levels = axes[1:]
        numbers = np.where(exists.any(axis=levels), _reduce(quantity.reduction, numbers, exists, levels), np.nan)
        exists = np.asarray(exists.any(axis=levels))
        return np.where(exists.any(axis=-1), _reduce(quantity.over_buildings, numbers, exists, (-1,)), np.nan)
    if not axes:
        return np.where(exists, numbers, np.nan)
    return np.where(exists.any(axis=axes), _reduce(quantity.reduction, numbers, exists, axes), np.nan)


def _reduce(reduction: str, numbers: np.ndarray, exists: np.ndarray, axes: tuple[int, ...]) -> np.ndarray:
    """Return the mean, largest or smallest of the numbers that exist; NaN where one of these is."""
    if reduction == "mean":
        return np.where(exists, numbers, 0.0).sum(axis=axes) / np.maximum(exists.sum(axis=axes), 1)
    if reduction == "largest":
        return np.where(exists, numbers, -np.inf).max(axis=axes, initial=-np.inf)
    return np.where(exists, numbers, np.inf).min(axis=axes, initial=np.inf)


Parsed = TypeVar("Parsed", Expression, Comparison)


def find_scope(study: Study, whole: bool = False) -> Scope:
    """Return what expressions of a study may name: its buildings, or all of it.

    whole : also cases, analyses, motions, laws of links and points of the sweep
    """
    buildings = unique_names(study.spec.group)
    if not whole:
        return Scope(buildings)
    motions = tuple(study.motion_uses(study.first_point))
    laws = {place.law.name for case in study.spec.cases for place in study.links(study.first_point, case)}
    return Scope(
        buildings,
        tuple(study.spec.cases),
        tuple(study.spec.analyses),
        motions,
        tuple(sorted(laws)),
        study.axes,
        absent=tuple(name for name in load_catalogue() if name not in motions),
    )


def parse_all(
    parse: Callable[[str, Scope], Parsed], question: StudyQuestion, key: str, texts: Sequence[str]
) -> tuple[Parsed, ...]:
    """Return the expressions or comparisons under a key of a question.  Note what is wrong with them.

    parse : `parse_expression` or `parse_comparison`
    """
    parsed: dict[str, Parsed] = {}
    scope = find_scope(question.study)
    for number, text in enumerate(texts):
        try:
            one = parse(text, scope)
        except InputError as error:
            question.add_issues(error.below(key, number).issues)
            continue
        if one.text in parsed:
            question.add_problem((key, number), f"'{one}' occurs twice", "remove one of the two")
        for message, hint in find_missing_places(one, question):
            question.add_problem((key, number), message, hint)
        parsed[one.text] = one
    return tuple(parsed.values())


def find_missing_places(one: Expression | Comparison, question: StudyQuestion) -> Iterator[tuple[str, str]]:
    """Yield what an expression names that its buildings do not have, and what to write."""
    study = question.study
    names = unique_names(study.spec.group)
    buildings_of_study = [study.building((0,) * len(study.axes), place) for place in range(len(names))]
    storeys = [building.storeys for building in buildings_of_study]
    lines = [building.lines for building in buildings_of_study]
    for part in one.quantities:
        most = max(storeys) if part.building is None else storeys[part.building]
        if part.building is not None and part.instant is None and question.lacks(part.building, part.name):
            buildings = [name for place, name in enumerate(names) if not question.is_wall(place)]
            message = f"'{one}': {names[part.building]} is a wall, which has no {part.name}"
            yield message, f"name one of the buildings: {', '.join(buildings)}"
        elif part.name in TWISTING and (problem := find_twist_problem(part, lines, names)):
            message, hint = problem
            yield f"'{one}': {message}", hint
        elif part.level > most:
            yield f"'{one}': the highest is {most}", f"write a number from 1 to {most}"


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
