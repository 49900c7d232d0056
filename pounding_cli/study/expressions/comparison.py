"""Comparisons of expressions over the tables, `drift in soft > 2 %` or `0 < mu in A / mu in B - 1 < 15 %`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError
from pounding_cli.study.expressions.expression import (
    HISTORY,
    LINE,
    MAX_LENGTH,
    QUANTITIES,
    Expression,
    Scope,
    TableQuantity,
    Value,
    has_ratio,
    parse_expression,
)
from pounding_cli.study.schema.quantity import Quantity, written_unit


def comparison_hint(buildings: Sequence[str]) -> str:
    """Return how a comparison is written, with the buildings of the study."""
    return f"write e.g. `mu > 4`, `drift in {buildings[-1]} > 2 cm` or `mean V_ratio in {buildings[0]} < 1.1`"


SIGN = re.compile(r"\s*(<=|>=|<|>)\s*")
ROUNDING = 4 * float(np.finfo(float).eps)
"""Numbers that differ by this share of the larger one are the same [-]."""

_BEHIND = re.compile(r"(?P<value>.*\S)\s+in\s+(?P<place>\S.*)")
"""A value with a place behind it, as limits have it."""
_NAMES = re.compile(r"[^\W\d]\w*")
_VALUES = {"": "4", "m": "2 cm", "m/s2": "1 g", "N": "500 kN", "s": "0.1 s", "N s": "20 kN s", "rad": "0.01 rad"}


class Compared(NamedTuple):
    """What becomes of a comparison.

    parts : values of its parts [SI]
    margin : by how much it is met, below 0 where it is missed; NaN where a part has no value [SI]
    held : 1 where it holds, 0 where it does not, NaN where that is not known
    """

    parts: list[np.ndarray]
    margin: np.ndarray
    held: np.ndarray


@dataclass(frozen=True)
class Comparison:
    """A comparison that expressions and values lie above or below one another: `mu > 4`, `0 < a / b - 1 < 15 %`.

    text : as people read it
    parts : expressions and values [SI], left to right
    signs : between them: <, >, <= or >=
    written_unit : of its values; "" where they have none
    """

    text: str
    parts: tuple[Expression | float, ...]
    signs: tuple[str, ...]
    written_unit: str = ""

    @property
    def expressions(self) -> tuple[Expression, ...]:
        """The expressions among its parts."""
        return tuple(part for part in self.parts if isinstance(part, Expression))

    @property
    def quantities(self) -> tuple[TableQuantity, ...]:
        """The numbers of the tables that it rests on."""
        return tuple(quantity for part in self.expressions for quantity in part.quantities)

    @property
    def first(self) -> Expression:
        """The first expression."""
        return self.expressions[0]

    @property
    def scale(self) -> float:
        """The size of its values, by which it is missed or met [SI]; 1 where they are 0 or where there are none."""
        return max((abs(part) for part in self.parts if isinstance(part, float)), default=0.0) or 1.0

    @property
    def bounds_below(self) -> bool:
        """Whether it holds the better, the larger its first expression is."""
        place = self.parts.index(self.first)
        return (self.signs[place] if place < len(self.signs) else {"<": ">", ">": "<"}[self.signs[-1][0]])[0] == ">"

    def find_parts(self, value: Value) -> list[np.ndarray]:
        """Return the values of its parts from those of its quantities [SI]; NaN where an expression has none."""
        parts = [part(value) if isinstance(part, Expression) else np.asarray(part) for part in self.parts]
        return [np.where(np.isfinite(part), part, np.nan) for part in parts]

    def find_steps(self, parts: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return by how much every comparison of two neighbouring parts is met, below 0 where it is missed; 0 where
        they differ by no more than rounding [SI]."""
        steps = []
        for left, sign, right in zip(parts[:-1], self.signs, parts[1:], strict=True):
            step = right - left if sign.startswith("<") else left - right
            is_rounding = np.abs(step) <= ROUNDING * np.maximum(np.abs(left), np.abs(right))
            steps.append(np.where(is_rounding, 0.0, step))
        return steps

    def compare(self, value: Value) -> Compared:
        """Return what becomes of the comparison with the values of its quantities."""
        parts = self.find_parts(value)
        steps = self.find_steps(parts)
        margin = steps[0]
        is_met: np.ndarray | bool = True
        for sign, step in zip(self.signs, steps, strict=True):
            margin = np.minimum(margin, step)  # NaN stays NaN
            is_met = is_met & (step >= 0 if sign.endswith("=") else step > 0)
        return Compared(parts, np.asarray(margin), np.where(np.isnan(margin), np.nan, is_met))

    def margin(self, value: Value) -> np.ndarray:
        """Return by how much it is met with the values of its quantities [SI]; see `Compared`."""
        return self.compare(value).margin

    def __str__(self) -> str:
        return self.text


def parse_comparison(text: str, scope: Scope) -> Comparison:
    """Return a comparison over the tables of a study; arguments and errors as those of `parse_expression`."""
    if len(text) > MAX_LENGTH:
        raise InputError(f"{len(text)} characters are not a comparison", comparison_hint(scope.buildings))
    text = " ".join(text.split())
    outside = re.sub(r"\[[^\[\]]*\]", lambda match: "_" * len(match[0]), text)  # a point of the sweep has signs too
    marks = list(SIGN.finditer(outside))
    ends = [0, *(end for mark in marks for end in mark.span()), len(text)]
    sides = [text[begin:end].strip() for begin, end in zip(ends[::2], ends[1::2], strict=True)]
    signs = tuple(mark[1] for mark in marks)
    if not signs or "" in sides[:1] or "=" in SIGN.sub(" ", outside):
        raise InputError(f"'{text}' is not compared with a value by < or >", comparison_hint(scope.buildings))
    if len(sides) > 3 or len({sign[0] for sign in signs}) > 1:
        hint = comparison_hint(scope.buildings)
        raise InputError(f"'{text}' compares more than one number with its lower and upper end", hint)
    known = {*QUANTITIES, *HISTORY, *(name.removeprefix("line_") for name in LINE)}
    names = [set(_NAMES.findall(side)) & known for side in sides]
    if not any(names):
        parse_expression(sides[0], scope)  # says what is wrong with it
        raise InputError(f"'{text}': it takes nothing from the tables", comparison_hint(scope.buildings))
    in_percent = any(written_unit(side) == "%" for side in sides)
    parsed = [
        parse_expression(side, scope, in_percent) if found else None for side, found in zip(sides, names, strict=True)
    ]
    first = next(each for each in parsed if each is not None)
    parts: list[Expression | float] = []
    for side, expression in zip(sides, parsed, strict=True):
        parts.append(_parse_value(text, side, first, sides, signs) if expression is None else expression)
    units = {part.unit for part in parts if isinstance(part, Expression)}
    if len(units) > 1:
        found = " and ".join(f"[{unit or '-'}]" for unit in sorted(units))
        raise InputError(f"'{text}' compares numbers in {found}", "compare numbers of one unit")
    written = next((written_unit(side) for side, each in zip(sides, parsed, strict=True) if each is None), "")
    return Comparison(text, tuple(parts), signs, written)


def _parse_value(
    text: str, written: str, expression: Expression, sides: Sequence[str], signs: Sequence[str]
) -> float:  # fmt: skip
    """Return a value of a comparison [SI].  Raises InputError.

    written : the value
    expression : that it is compared with
    """
    behind = _BEHIND.fullmatch(written)
    if behind is not None and len(sides) == 2:
        ordered = _put_place_before(behind, written, sides, signs)
        raise InputError(f"'{text}': the place stands behind the value", f"write `{ordered}`")
    unit = expression.unit
    shown = _VALUES.get(unit, f"1 {unit}")
    hint = f"write e.g. `{expression} {signs[0]} {shown}`"
    if unit == "m" and all(map(has_ratio, expression.quantities)):
        hint += f" or `{expression} {signs[0]} 2 %`"
    measure = Quantity("value", unit, shown)
    try:
        number = float(measure.read(written))
    except PydanticCustomError as error:
        raise InputError(f"'{text}': {(error.context or {})['message']}", hint) from None
    if unit and not written_unit(written):
        raise InputError(f"'{text}': the value has no unit", hint)
    return number


def _put_place_before(behind: re.Match[str], written: str, sides: Sequence[str], signs: Sequence[str]) -> str:
    """Return a comparison whose place stands behind its value, `mu > 4 in soft`, as it is written: `mu in soft > 4`.

    behind : match of the value with its place
    """
    other = sides[1] if written == sides[0] else sides[0]
    joint = " " if re.search(r"\sin\s", other) else " in "  # it names a place already
    ordered = f"{other}{joint}{behind['place']}"
    value = behind["value"]
    return f"{value} {signs[0]} {ordered}" if written == sides[0] else f"{ordered} {signs[0]} {value}"
