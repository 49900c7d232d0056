"""Expressions over the tables, `largest mu in soft` or `max(V_ratio in stiff, mu0)`; statements, which compare one with
a value, `mean V_ratio in stiff > 1.1`; limits: `drift > 2 %`, `acceleration > 1 g in soft floor 5`, `contact`.

Quantities are read first, each with its place; what is left is arithmetic, which Python parses and nothing runs."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from pounding_cli import variables
from pounding_cli.study.file import nearest
from pounding_cli.study.quantity import ACCELERATION, LENGTH, Quantity, refuse, written_unit

STOREY, FLOOR, LINK = (
    {
        v.name: v.unit.removeprefix("1")
        for v in variables.RESPONSE_VARIABLES
        if v.dims == dims and v.name not in variables.COLUMN_VARIABLES
    }
    for dims in (variables.STOREY_DIMS, variables.FLOOR_DIMS, variables.LINK_DIMS)
)
QUANTITIES = STOREY | FLOOR | LINK
"""What an expression may name, as the tables do, and the SI unit of each."""

REDUCTIONS = ("largest", "smallest", "mean")
"""What is taken of several storeys, floors or links; `largest` unless written."""


def expression_hint(buildings: Sequence[str]) -> str:
    """Return how an expression is written, with the buildings of the study."""
    first, last = buildings[0], buildings[-1]
    return (
        f"write e.g. `mu`, `mean V_ratio in {first}`, `drift in {last} storey 1` or "
        f"`max(V_ratio in {first}, V_ratio in {last})`"
    )


MAX_LENGTH = 500
_FUNCTIONS: Mapping[str, Callable[..., np.ndarray]] = {
    "max": np.maximum, "min": np.minimum, "abs": np.abs, "sqrt": np.sqrt, "log": np.log, "exp": np.exp,
}  # fmt: skip
_SEVERAL = ("max", "min")
_SIGNS: Mapping[type[ast.operator], Callable[..., np.ndarray]] = {
    ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide,
}  # fmt: skip
_KEEP_UNIT = (ast.Add, ast.Sub, "max", "min", "abs")
_PHRASE = (
    r"(?<![\w.])(?:(?P<how>largest|smallest|mean)\s+)?(?P<name>[^\W\d]\w*)"
    r"(?P<in>\s+in\b(?:\s+(?P<building>{buildings})(?!\w))?(?:\s+(?P<kind>storey|floor)\s+(?P<level>[0-9]{{1,3}}))?)?"
)


@dataclass(frozen=True)
class TableQuantity:
    """One number of the tables.

    name : of QUANTITIES
    reduction : of REDUCTIONS, over storeys, floors or links and, where none is named, over buildings
    building : its place in the group from 0; None for all
    level : storey or floor from 1; 0 for all
    """

    name: str
    reduction: str = "largest"
    building: int | None = None
    level: int = 0


Value = Callable[[TableQuantity], np.ndarray]
Work = Callable[[Value], np.ndarray]


@dataclass(frozen=True)
class Expression:
    """An expression.

    text : as people read it
    unit : SI unit; "" of a pure number, and where the parts have different ones
    quantities : what it takes from the tables
    """

    text: str
    unit: str
    quantities: tuple[TableQuantity, ...]
    _work: Work

    def __call__(self, value: Value) -> np.ndarray:
        """The expression from the values of its quantities; not finite where it has none (a root of -1)."""
        with np.errstate(all="ignore"):
            return self._work(value)

    def __str__(self) -> str:
        return self.text


class ExpressionError(ValueError):
    """What is wrong with an expression; the second argument says what to write."""


def parse_expression(text: str, buildings: Sequence[str]) -> Expression:
    """An expression over the tables of a study.

    buildings : names of the group by place, left to right

    Raises
    ------
    ExpressionError : what is wrong, and what to write
    """
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"{len(text)} characters are not an expression", expression_hint(buildings))
    text, quantities = " ".join(text.split()), list[TableQuantity]()
    names = "|".join(map(re.escape, sorted(buildings, key=len, reverse=True)))

    def replace_phrase(found: re.Match[str]) -> str:
        """A name, `_0`, `_1`, in place of every quantity."""
        if found["name"] in _FUNCTIONS and found["how"] is None:
            return found[0]
        try:
            quantities.append(_parse_quantity(found, buildings))
        except ExpressionError as error:
            raise ExpressionError(f"'{text}': {error.args[0]}", error.args[1]) from None
        return f"_{len(quantities) - 1}"

    arithmetic = re.sub(_PHRASE.format(buildings=names), replace_phrase, text)
    try:
        unit, work = _compile_node(ast.parse(arithmetic.strip(), mode="eval").body, quantities)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        open_bracket = arithmetic.count("(") > arithmetic.count(")")
        what = "a bracket is not closed" if open_bracket else "this is not arithmetic with the numbers of the tables"
        raise ExpressionError(
            f"'{text}': {error if isinstance(error, ExpressionError) else what}", expression_hint(buildings)
        ) from None
    if not quantities or "#" in arithmetic:
        raise ExpressionError(f"'{text}': it takes nothing from the tables", expression_hint(buildings))
    return Expression(text, unit, tuple(quantities), work)


def _parse_quantity(found: re.Match[str], buildings: Sequence[str]) -> TableQuantity:
    """The quantity of a phrase: `mean mu in soft storey 2`.  Raises ExpressionError."""
    name, building, level = found["name"], found["building"], 0
    if name not in QUANTITIES:
        raise ExpressionError(f"no quantity '{name}' is known", nearest(name, (*QUANTITIES, *_FUNCTIONS)))
    if found["in"] is not None:
        if name in LINK:
            raise ExpressionError(f"{name} belongs to links, not to a building", f"write `{name}`: of all links")
        if building is None and found["kind"] is None:
            wrong = re.split(r"[-+*/(),]", found.string[found.end() :])[0].strip()[:40]
            raise ExpressionError(f"no building '{wrong}' in the group", nearest(wrong, buildings))
        level = _parse_level(found, name in FLOOR, name)
    return TableQuantity(
        name, found["how"] or REDUCTIONS[0], None if building is None else buildings.index(building), level
    )


def _parse_level(found: re.Match[str], of_floors: bool, what: str) -> int:
    """The number of a storey or floor; 0 for all.  Raises ExpressionError: it is the other of the two, or 0."""
    if found["kind"] is None:
        return 0
    own = "floor" if of_floors else "storey"
    if found["kind"] != own:
        raise ExpressionError(f"{what} belongs to a {own}", f"write `{own} {found['level']}`")
    if int(found["level"]) < 1:
        raise ExpressionError(f"there is no {own} 0", f"the lowest is `{own} 1`")
    return int(found["level"])


def _compile_node(node: ast.expr, quantities: Sequence[TableQuantity]) -> tuple[str, Work]:
    """Unit and work of a part.  Raises ExpressionError."""
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return "", lambda value: np.asarray(float(number))
        case ast.Name(id=name) if name not in _FUNCTIONS:
            quantity = quantities[int(name[1:])]
            return QUANTITIES[quantity.name], lambda value: value(quantity)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            unit, work = _compile_node(inner, quantities)
            return unit, lambda value: -work(value)
        case ast.BinOp(op=sign, left=left, right=right) if type(sign) in _SIGNS:
            return _compile_operation(_SIGNS[type(sign)], [left, right], quantities, type(sign) in _KEEP_UNIT)
        case ast.Call(func=ast.Name(id=name), args=inner, keywords=[]) if name in _FUNCTIONS:
            if (len(inner) > 1) != (name in _SEVERAL):
                raise ExpressionError(f"{name} takes {'two values or more' if name in _SEVERAL else 'one value'}")
            return _compile_operation(_FUNCTIONS[name], inner, quantities, name in _KEEP_UNIT)
    raise ExpressionError(
        "only numbers of the tables, + - * /, brackets, max, min, abs, sqrt, log and exp are understood"
    )


def _compile_operation(
    work: Callable[..., np.ndarray], nodes: Sequence[ast.expr], quantities: Sequence[TableQuantity], keeps_unit: bool
) -> tuple[str, Work]:
    """Unit and work of parts that are joined, two at a time where there are several."""
    parts = [_compile_node(node, quantities) for node in nodes]
    units = {unit for unit, _ in parts}

    def operate(value: Value) -> np.ndarray:
        first, *others = (part(value) for _, part in parts)
        if not others:
            return work(first)
        for other in others:
            first = work(first, other)
        return first

    return units.pop() if keeps_unit and len(units) == 1 else "", operate


# Statements


def statement_hint(buildings: Sequence[str]) -> str:
    """Return how a statement is written, with the buildings of the study."""
    return f"write e.g. `mu > 4`, `drift in {buildings[-1]} > 2 cm` or `mean V_ratio in {buildings[0]} < 1.1`"


_STATEMENT = re.compile(r"(?P<expression>[^<>=]+)(?P<sign>[<>])(?P<value>[^<>=]*)\Z")
_VALUES = {"": "4", "m": "2 cm", "m/s2": "1 g", "N": "500 kN", "s": "0.1 s", "N s": "20 kN s"}


@dataclass(frozen=True)
class Statement:
    """That an expression lies above or below a value.

    text : as people read it
    is_above : whether above; below otherwise
    value : in the unit of the expression, SI
    """

    text: str
    expression: Expression
    is_above: bool
    value: float

    @property
    def quantities(self) -> tuple[TableQuantity, ...]:
        """What it takes from the tables."""
        return self.expression.quantities

    def holds(self, values: np.ndarray) -> np.ndarray:
        """1 where it holds of a value of its expression, 0 where it does not, NaN where there is no value."""
        holds = values > self.value if self.is_above else values < self.value
        return np.where(np.isnan(values), np.nan, holds)

    def __str__(self) -> str:
        return self.text


def parse_statement(text: str, buildings: Sequence[str]) -> Statement:
    """A statement over the tables of a study; arguments and errors as those of `parse_expression`."""
    text = " ".join(text[: MAX_LENGTH + 1].split())
    found = _STATEMENT.match(text)
    if found is None:
        raise ExpressionError(f"'{text}' is not compared with a value by < or >", statement_hint(buildings))
    expression, written = parse_expression(found["expression"], buildings), found["value"].strip()
    unit, example = expression.unit, f"{expression} {found['sign']} {_VALUES[expression.unit]}"
    if unit == "m" and written.endswith("%"):
        example = text.replace("drift", DRIFT_RATIO)  # of the storey height
    value = _parse_number(text, Quantity("value", unit, _VALUES[unit]), written, f"write e.g. `{example}`")
    return Statement(text, expression, found["sign"] == ">", value)


def _parse_number(text: str, measure: Quantity, written: str, hint: str) -> float:
    """A value with its unit in SI.  Raises ExpressionError."""
    try:
        number = float(measure.read(written))
    except PydanticCustomError as error:
        raise ExpressionError(f"'{text}': {(error.context or {})['message']}", hint) from None
    if measure.si and not written_unit(written):
        raise ExpressionError(f"'{text}': the value has no unit", hint)
    return number


# Limits


CONTACT, COLLAPSE, SHEAR_DEMAND, DRIFT_RATIO = "contact", "collapse", "shear_demand", "drift_ratio"
LIMITS = ("mu", "drift", DRIFT_RATIO, "acceleration", SHEAR_DEMAND, CONTACT, COLLAPSE)
"""What may be limited."""

LIMITS_OF_PAIRS = (CONTACT, SHEAR_DEMAND)
"""Limits that a building alone cannot pass."""

LIMIT_FORM = "write e.g. `mu > 4`, `drift > 2 %`, `acceleration > 1 g`, `shear_demand > 1`, `contact` or `collapse`"
_MEASURES = {
    "mu": Quantity("ductility", "", "mu > 4", 0.0, 1e6, open_low=True),
    SHEAR_DEMAND: Quantity("shear demand", "", "shear_demand > 1", 0.0, 1e6, open_low=True),
    "acceleration": ACCELERATION.replace(example="acceleration > 1 g"),
    "drift": LENGTH.replace(name="drift", example="drift > 6 cm"),
    DRIFT_RATIO: Quantity("drift ratio", "", "drift_ratio > 2 %", 0.0, 1.0, open_low=True, open_high=True),
}
_WHERE = re.compile(r"(?P<what>.*)\s+in\s+(?P<where>\S.*)\Z")  # the last `in`: one before it may be inches
_PLACE = re.compile(r"(?P<building>.*?)\s*(?:\b(?P<kind>storey|floor)\s+(?P<level>[0-9]{1,3}))?\Z")


@dataclass(frozen=True)
class Limit:
    """One limit.

    text : as people read it
    quantity : one of LIMITS
    value : [-], [m] or [m/s2]; 0 of contact, where a gap that closes passes the limit, and of collapse
    of_height : the value is a part of the storey's height
    building : the only one it concerns, "" for each of them
    level : its only storey or floor, from 1 at the ground; 0 for any of them
    """

    text: str
    quantity: str
    value: float = 0.0
    of_height: bool = False
    building: str = ""
    level: int = 0

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Target:
    """What a curve is about: a limit and the building it concerns, by place, or the left one of a pair (contact)."""

    limit: Limit
    building: int

    def label(self, names: tuple[str, ...]) -> str:
        """The building, or the pair."""
        if self.limit.quantity == CONTACT:
            return f"{names[self.building]}|{names[self.building + 1]}"
        return names[self.building]


def parse_limit(value: Any) -> Limit:
    """A limit as the file says it.  Raises PydanticCustomError saying what to write."""
    text = " ".join(value.split())[:200] if isinstance(value, str) else ""
    parted = _WHERE.match(text)
    what, where = (parted["what"], parted["where"]) if parted else (text, "")
    quantity, sign, written = (part.strip() for part in what.partition(">"))
    if quantity not in LIMITS or bool(sign) != (quantity in _MEASURES):
        known = quantity in LIMITS
        takes = f"{quantity} takes {'`>` and a value' if quantity in _MEASURES else 'no value'}"
        hint = LIMIT_FORM if known else f"{nearest(quantity, LIMITS)}; {LIMIT_FORM}"
        raise refuse(f"'{text[:60]}' is not a limit{f': {takes}' * known}", hint)
    place = _PLACE.match(where)
    assert place is not None  # it matches everything
    building = place["building"].strip()
    of_height = quantity == DRIFT_RATIO or (quantity == "drift" and written_unit(written) in ("%", "percent", "pct"))
    measure = _MEASURES.get(DRIFT_RATIO if of_height else quantity)
    try:
        level = _parse_level(place, quantity == "acceleration", f"'{text}': {quantity}")
        number = 0.0 if measure is None else _parse_number(text, measure, written, LIMIT_FORM)
    except ExpressionError as error:
        raise refuse(*error.args) from None
    if measure is None and (level or (where and quantity == CONTACT)):
        concerns = "two buildings, not one of them" if quantity == CONTACT else "a building, not one of its storeys"
        raise refuse(f"'{text}': {quantity} concerns {concerns}", f"write `{quantity}`")
    return Limit(text, "drift" if of_height else quantity, number, of_height, building, level)
