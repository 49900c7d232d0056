"""Ranges of a quantity, and the numbers of other mappings, in the unit in which a study writes them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from pydantic_core import PydanticCustomError

from pounding_cli.numbers import Unit
from pounding_cli.study.schema.quantity import Quantity, lacks_unit, quote, written_unit
from pounding_cli.study.text.file import Map, Mark, Problems, nearest
from pounding_cli.units import find_unit_factor

MAX_AXIS_VALUES = 10_000
"""Largest number of values of an axis."""

RANGE_KEYS = ("from", "to", "count", "step", "spacing")


def example_values(quantity: Quantity | None, *shares: float) -> list[str]:
    """Return some parts of the example of a quantity, in its unit, e.g. `100 t` and `200 t`."""
    number = 5.0
    unit = ""
    if quantity is not None:
        unit = written_unit(quantity.example)
        try:
            number = float(quantity.example.removesuffix(unit))
        except ValueError:  # an example in words
            number = 1.0
            unit = quantity.si
    return [f"{share * number:g} {unit}".rstrip() for share in shares]


def range_example(quantity: Quantity | None, more: str = "") -> str:
    """Return how a range of a quantity is written."""
    low, high = example_values(quantity, 0.5, 1.0)
    return f"{{from: {low}, to: {high}{more}}}"


class WrittenValues(NamedTuple):
    """The values of a swept key.

    values : as the file writes them
    marks : where each stands
    unit : in which they are written
    """

    values: Sequence[Any]
    marks: Sequence[Mark]
    unit: Unit


def canonical_value(value: Any, quantity: Quantity | None) -> Any:
    """Return what all spellings of one value have in common, such as 0.5 and 1/2."""
    if quantity is None:
        return repr(value)
    try:
        return quantity.read(value)
    except PydanticCustomError:
        return repr(value)


def unit_of(values: Sequence[Any], quantity: Quantity | None) -> Unit:
    """Return the first unit written among some values; SI where all are bare numbers."""
    if quantity is None:
        return Unit()
    for value in values:
        name = written_unit(value)
        if not name:
            continue
        try:
            factor = find_unit_factor(name, quantity.si)
        except ValueError:
            continue
        if factor is not None:
            return Unit(name, factor, quantity.si)
    return Unit(quantity.si, 1.0, quantity.si)


def in_unit(number: float, unit: Unit) -> Any:
    """Return an SI number as a study writes it in a unit."""
    value = unit.number(number)
    is_whole = value.is_integer() and abs(value) < 1e15
    short = int(value) if is_whole else value
    return f"{short} {unit.name}" if unit.name else short


def refuse_unknown(node: Map, known: Sequence[str], owner: str, problems: Problems) -> None:
    """Note the keys that a mapping does not have."""
    for key in node.keys() - {*known}:
        problems.add(node.marks[key][0], f"unknown key '{key}' of {owner}", nearest(key, known))


def check_mapping(owner: str, value: Any, mark: Mark, hint: str, problems: Problems) -> bool:
    """Return whether a value is a mapping; note what stands there where it is none.

    owner : the key or its section
    """
    if not isinstance(value, Map):
        problems.add(mark, f"{owner}: {quote(value)} is not a mapping", hint)
    return isinstance(value, Map)


def read_numbers(
    node: Map, kinds: Mapping[str, Quantity], problems: Problems, needs_unit: bool = False
) -> dict[str, Any] | None:
    """Return the numbers of a mapping in SI, or as multiples of a storey's stiffness, all with a unit or none; None
    where something is wrong, which is noted.

    kinds : quantity at each key, which may be absent
    needs_unit : each of them must have its unit
    """
    count_before = len(problems.found)
    numbers: dict[str, Any] = {}
    for key, quantity in kinds.items():
        if key not in node:
            continue
        mark = node.marks[key][1]
        try:
            number = quantity.read(node[key])
        except PydanticCustomError as error:
            context: dict[str, Any] = error.context or {}
            problems.add(mark, f"{key}: {context['message']}", context["hint"])
            continue
        if isinstance(number, str):
            problems.add(mark, f"'{node[key]}' is not a number", quantity.usage)
        numbers[key] = number
    refuse_bare([(node[key], node.marks[key][1], kinds[key]) for key in numbers], problems, needs_unit)
    return None if len(problems.found) > count_before else numbers


def refuse_bare(written: Sequence[tuple[Any, Mark, Quantity]], problems: Problems, needs_unit: bool = True) -> None:
    """Note numbers without their unit, where others beside them have one (beside 20 % a number is no share: 0.5, or
    50 %?) or each needs it."""
    with_unit = {quantity.name for value, _, quantity in written if written_unit(value)}
    if not needs_unit and not with_unit:
        return
    for value, mark, quantity in written:
        is_bare_beside_others = isinstance(value, int | float) and value != 0 and quantity.name in with_unit
        if lacks_unit(value, quantity) or is_bare_beside_others:
            in_si = f"; without one it is in {quantity.si}" if quantity.si else ""
            problems.add(mark, f"{value} has no unit", f"write its unit too, e.g. {quantity.example}{in_si}")


def read_range(name: str, node: Map, quantity: Quantity, problems: Problems) -> WrittenValues | None:
    """Return the values of `{from, to, count | step, spacing}`; None where something is wrong, which is noted."""
    count_before = len(problems.found)
    _check_range_keys(name, node, quantity, problems)
    numbers = _read_range_numbers(node, quantity, problems)
    if numbers is None or len(problems.found) > count_before:
        return None
    is_log = node.get("spacing") == "log"
    first = numbers["from"]
    last = numbers["to"]
    count = node.get("count")
    if not _check_ends(node, first, last, is_log, problems):
        return None
    if count is None:
        count = _find_count(node, first, last, numbers["step"], problems)
        if count is None:
            return None
    written = [node[key] for key in numbers]
    unit = unit_of(written, quantity)
    has_unit = any(written_unit(value) for value in written)
    unit_to_write = unit if has_unit else Unit()  # without one the values have none either
    values = [in_unit(number, unit_to_write) for number in _space_numbers(first, last, count, is_log)]
    return WrittenValues(values, [node.mark] * count, unit)


def _check_range_keys(name: str, node: Map, quantity: Quantity, problems: Problems) -> None:
    """Note a range that lacks a key, has one too many, or an unknown spacing or count."""
    refuse_unknown(node, RANGE_KEYS, "a range", problems)
    spacing = node.get("spacing", "linear")
    count = node.get("count")
    if not {"from", "to"} <= node.keys() or ("count" in node) == ("step" in node):
        message = f"a range has `from`, `to` and either `count` or `step`, not {', '.join(node)}"
        problems.add(node.mark, message, f"write e.g. `{name}: {range_example(quantity, ', count: 5')}`")
    elif spacing not in ("linear", "log") or (spacing == "log" and "step" in node):
        message = f"spacing: {quote(spacing)} is not known here"
        problems.add(node.marks["spacing"][1], message, "write linear, or log beside `count:`")
    elif "count" in node and (type(count) is not int or not 2 <= count <= MAX_AXIS_VALUES):
        message = f"count: {quote(count)}; a range has 2 to {MAX_AXIS_VALUES} values"
        problems.add(node.marks["count"][1], message, "write how many values, e.g. 15")


def _read_range_numbers(node: Map, quantity: Quantity, problems: Problems) -> dict[str, float] | None:
    """Return the ends and the step of a range in SI; None where one is no number, which is noted."""
    step = quantity.replace(
        name=f"step of a {quantity.name}", low=-math.inf, high=math.inf, open_low=False, open_high=False
    )
    numbers = read_numbers(node, {"from": quantity, "to": quantity, "step": step}, problems)
    for key, number in (numbers or {}).items():
        if not isinstance(number, float):
            message = f"'{node[key]}' is not a number: a range runs between numbers"
            problems.add(node.marks[key][1], message, quantity.usage)
            return None
    return numbers


def _check_ends(node: Map, first: float, last: float, is_log: bool, problems: Problems) -> bool:
    """Return whether a range can run between two ends; note why it cannot."""
    if first == last:
        hint = "write `to:` apart from `from:`, or a single value"
        problems.add(node.marks["to"][1], "the range ends where it begins", hint)
        return False
    if is_log and not first * last > 0:
        hint = "begin above zero, e.g. `from: 0.1 s`"
        problems.add(node.marks["spacing"][1], "a logarithmic range cannot reach zero", hint)
        return False
    return True


def _find_count(node: Map, first: float, last: float, step: float, problems: Problems) -> int | None:
    """Return the number of values between two ends, a step apart; None where steps do not fit, which is noted."""
    steps = (last - first) / step if step else -1.0
    if 0.5 < steps < MAX_AXIS_VALUES and math.isclose(steps, round(steps), rel_tol=1e-9):
        return round(steps) + 1
    message = f"steps of {node['step']} do not lead from {node['from']} to {node['to']}: that is {steps:.4g} steps"
    hint = f"change an end or the step, at most {MAX_AXIS_VALUES} values, or write `count:`"
    problems.add(node.marks["step"][1], message, hint)
    return None


def _space_numbers(first: float, last: float, count: int, is_log: bool) -> list[float]:
    """Return numbers from the first to the last, equally apart or in equal ratios."""
    shares = [place / (count - 1) for place in range(count - 1)]
    if is_log:
        return [*(first * (last / first) ** share for share in shares), last]
    return [*(first + (last - first) * share for share in shares), last]
