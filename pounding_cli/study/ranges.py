"""The values of a swept key: a list, or a range `{from: 0.2 s, to: 1.5 s, count: 15}`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel
from pydantic_core import PydanticCustomError

from pounding_cli.study.problems import Problems, nearest
from pounding_cli.study.source import Mark, Node
from pounding_cli.study.units import Quantity, written_unit
from pounding_cli.study.written import quantity_of, unit_of

MOST_VALUES = 10_000
"""Values of one key."""

FORM = "{from: 0.2 s, to: 1.5 s, count: 14}"
_KEYS = ("from", "to", "count", "step", "spacing")
_SPACINGS = ("linear", "log")


def axis_values(name: str, node: Node, model: type[BaseModel], problems: Problems) -> list[Node] | None:
    """The values of a swept key, one node each; None where something is wrong, noted in `problems`.

    name : the key, dotted; model : the schema of the study
    """
    if node.is_mapping and not set(node.value).isdisjoint(_KEYS):
        return _range(name, node, model, problems)
    if not node.is_list:
        hint = f"write `{name}: [first, second]`, or a range: `{name}: {FORM}`"
        problems.at(node, (), f"the values of '{name}' are not a list", hint)
    elif not node.value:
        problems.at(node, (), f"the axis '{name}' has no values", "give at least one")
    elif len(node.value) > MOST_VALUES:
        problems.at(node, (), f"the axis '{name}' has {len(node.value)} values", f"give at most {MOST_VALUES}")
    else:
        return list(node.value)
    return None


def _range(name: str, node: Node, model: type[BaseModel], problems: Problems) -> list[Node] | None:
    before = len(problems.found)
    for key in node.value:
        if key not in _KEYS:
            problems.at(node, (key,), f"unknown key '{key}' in a range", nearest(key, _KEYS), key=True)
    missing = [key for key in ("from", "to") if key not in node.value]
    if missing:
        problems.at(node, (), f"the range lacks '{missing[0]}'", f"write e.g. `{name}: {FORM}`")
    counted, stepped = node.get("count"), node.get("step")
    if (counted is None) == (stepped is None):
        what = "has both 'count' and 'step'" if counted else "has neither 'count' nor 'step'"
        problems.at(
            node, (), f"the range {what}", "write one of them: how many values, or the step from one to the next"
        )
    log = _is_log(node, stepped, problems)
    if len(problems.found) > before:
        return None
    quantity = quantity_of(model, name.split(".")) or Quantity("number", "", "5")
    ends = [node.value["from"], node.value["to"], *([stepped] if stepped else [])]
    numbers = _numbers(ends, node, quantity, problems)
    if numbers is None:
        return None
    first, last = numbers[:2]
    if log and not first * last > 0:
        problems.at(node, ("spacing",), "a logarithmic range cannot reach zero", "begin above zero, e.g. `from: 0.1 s`")
        return None
    places = _steps(first, last, numbers[2], node, problems) if stepped else _count(node, problems)
    if places is None:
        return None
    unit = unit_of(model, name.split("."), ends)
    shares = [place / (places - 1) for place in range(places)]
    values = [first * (last / first) ** share if log else first + (last - first) * share for share in shares]
    return [number_node(unit.number(value), unit.name, node.mark) for value in (*values[:-1], last)]


def _is_log(node: Node, stepped: Node | None, problems: Problems) -> bool:
    spacing = node.get("spacing")
    if spacing is None:
        return False
    if spacing.value not in _SPACINGS:
        problems.at(node, ("spacing",), f"spacing: '{spacing.text}' is not known", "write linear or log")
    elif spacing.value == "log" and stepped is not None:
        problems.at(node, ("step",), "a logarithmic range has no step", "write `count:` in its place", key=True)
    return spacing.value == "log"


def _numbers(ends: Sequence[Node], node: Node, quantity: Quantity, problems: Problems) -> list[float] | None:
    """`from`, `to` and, where it is given, `step` in SI."""
    step = Quantity(f"step of a {quantity.name}", quantity.si, quantity.example)
    found = []
    for end, kind in zip(ends, (quantity, quantity, step), strict=False):
        try:
            value = kind.read(end.plain())
            if isinstance(value, str):
                problems.add(end.mark, f"'{value}' is not a number: a range runs between numbers", quantity.wanted)
                continue
            found.append(value)
        except PydanticCustomError as error:
            context: dict[str, Any] = error.context or {}
            problems.add(end.mark, str(context.get("message", error)), str(context.get("hint", "")))
    if len(found) < len(ends):
        return None
    units = {bool(written_unit(end.text)) for end, value in zip(ends, found, strict=True) if value != 0}
    if len(units) > 1:
        bare = next(end for end, value in zip(ends, found, strict=True) if value and not written_unit(end.text))
        message = f"{bare.text} has no unit, but the other end of the range has one"
        problems.add(
            bare.mark, message, f"write its unit too; without one it is {bare.text} {quantity.si or ''}".rstrip()
        )
        return None
    if found[0] == found[1]:
        problems.at(
            node, ("to",), "the range ends where it begins", "write `to:` apart from `from:`, or a single value"
        )
        return None
    return found


def _count(node: Node, problems: Problems) -> int | None:
    count = node.value["count"]
    if isinstance(count.value, bool) or not isinstance(count.value, int):
        problems.at(node, ("count",), f"count: '{count.text}' is not a whole number", "write how many values, e.g. 15")
    elif not 2 <= count.value <= MOST_VALUES:
        hint = "write a list of one value" if count.value == 1 else "write a smaller count"
        message = f"count: {count.value}; a range has 2 to {MOST_VALUES} values"
        problems.at(node, ("count",), message, hint if count.value > 0 else "write how many values, e.g. 15")
    else:
        return count.value
    return None


def _steps(first: float, last: float, step: float, node: Node, problems: Problems) -> int | None:
    written = node.value["step"]
    if step == 0 or (last - first) / step < 0:
        message = "a step of zero leads nowhere" if step == 0 else f"a step of {written.text} leads away from 'to'"
        problems.at(node, ("step",), message, "give the step from `from:` towards `to:`, e.g. 0.1 s")
        return None
    steps = (last - first) / step
    whole = round(steps)
    if steps > MOST_VALUES:
        message = f"steps of {written.text} make {steps:.3g} values"
        problems.at(node, ("step",), message, f"an axis has at most {MOST_VALUES}: write a larger step")
    elif whole == 0 or not math.isclose(steps, whole, rel_tol=1e-9):
        ends = f"from {node.value['from'].text} to {node.value['to'].text}"
        message = f"steps of {written.text} do not lead {ends}: that is {steps:.4g} steps"
        fits = max(math.floor(steps + 1e-9), 1) + 1
        problems.at(node, ("step",), message, f"change an end or the step, or write `count: {max(fits, 2)}`")
    else:
        return whole + 1
    return None


def number_node(number: float, unit: str, mark: Mark) -> Node:
    """A number in a unit, as a study writes it."""
    whole = number.is_integer() and abs(number) < 1e15
    plain: int | float = int(number) if whole else number
    if not unit:
        return Node(plain, mark, str(plain))
    text = f"{plain} {unit}"
    return Node(text, mark, text)
