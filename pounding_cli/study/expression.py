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
from pounding_cli.model.archetypes import DAMAGE_STATES
from pounding_cli.study.file import nearest
from pounding_cli.study.quantity import ACCELERATION, LENGTH, Quantity, refuse, written_unit

SHEAR_DEMAND = "shear_demand"


def _find_units(dims: tuple[str, ...]) -> dict[str, str]:
    """Return the SI unit of every response over some dimensions, by name; of loaded columns their shear demand only."""
    left_out = {*variables.COLUMN_VARIABLES} - {SHEAR_DEMAND}
    return {
        variable.name: variable.unit.removeprefix("1")
        for variable in variables.RESPONSE_VARIABLES
        if variable.dims == dims and variable.name not in left_out
    }


STOREY = _find_units(variables.STOREY_DIMS)
FLOOR = _find_units(variables.FLOOR_DIMS)
LINK = _find_units(variables.LINK_DIMS)
LINE = _find_units(variables.LINE_DIMS)
"""Quantities of frame lines by the names of their variables, `line_mu`; people write `mu in line 1 of NAME`."""

QUANTITIES = STOREY | FLOOR | LINK
"""SI unit of every quantity that an expression may name, by its name in the tables."""

CONTACT_QUANTITIES = ("acceleration", "acceleration_ratio", "peak_force", "contact_time")
"""Quantities that depend on the contact stiffness where floors strike."""

TWISTING = {variable.name for variable in variables.TWIST_VARIABLES}
"""Variables that studies without plans do not have."""

REDUCTIONS = ("largest", "smallest", "mean")
"""Reductions of several storeys, floors or links; `largest` unless written."""


def expression_hint(buildings: Sequence[str]) -> str:
    """Return how an expression is written, with the buildings of the study."""
    first = buildings[0]
    last = buildings[-1]
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
    r"(?P<in>\s+in\b(?:\s+line\s+(?P<line>[0-9]{{1,3}})\s+of\b)?(?:\s+(?P<building>{buildings})(?!\w))?"
    r"(?:\s+(?P<kind>storey|floor)\s+(?P<level>[0-9]{{1,3}}))?)?"
)


@dataclass(frozen=True)
class TableQuantity:
    """One number of the tables.

    name : of QUANTITIES, or of LINE
    reduction : of REDUCTIONS, over storeys, floors or links and, where none is named, over buildings
    building : its place in the group from 0; None for all
    level : storey or floor from 1; 0 for all
    line : frame line of the building, from 1, of a quantity of LINE; 0 of others
    """

    name: str
    reduction: str = "largest"
    building: int | None = None
    level: int = 0
    line: int = 0


Value = Callable[[TableQuantity], np.ndarray]
Work = Callable[[Value], np.ndarray]


@dataclass(frozen=True)
class Expression:
    """An expression.

    text : as people read it
    unit : SI unit; "" of a pure number, and where the parts have different ones
    quantities : the numbers of the tables that it rests on
    """

    text: str
    unit: str
    quantities: tuple[TableQuantity, ...]
    _work: Work

    def __call__(self, value: Value) -> np.ndarray:
        """Return the expression from the values of its quantities; not finite where it has none (a root of -1)."""
        with np.errstate(all="ignore"):
            return self._work(value)

    def __str__(self) -> str:
        return self.text


class ExpressionError(ValueError):
    """A fault in an expression; the second argument says what to write."""


def parse_expression(text: str, buildings: Sequence[str]) -> Expression:
    """Return an expression over the tables of a study.

    buildings : names of the group by place, left to right

    Raises
    ------
    ExpressionError : what is wrong, and what to write
    """
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"{len(text)} characters are not an expression", expression_hint(buildings))
    text = " ".join(text.split())
    quantities: list[TableQuantity] = []
    names = "|".join(map(re.escape, sorted(buildings, key=len, reverse=True)))

    def replace_phrase(match: re.Match[str]) -> str:
        """Return a name, `_0`, `_1`, in place of a quantity."""
        if match["name"] in _FUNCTIONS and match["how"] is None:
            return match[0]
        try:
            quantities.append(_parse_quantity(match, buildings))
        except ExpressionError as error:
            raise ExpressionError(f"'{text}': {error.args[0]}", error.args[1]) from None
        return f"_{len(quantities) - 1}"

    arithmetic = re.sub(_PHRASE.format(buildings=names), replace_phrase, text)
    try:
        unit, work = _compile_node(ast.parse(arithmetic.strip(), mode="eval").body, quantities)
    except ExpressionError as error:
        raise ExpressionError(f"'{text}': {error}", expression_hint(buildings)) from None
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        message = "this is not arithmetic with the numbers of the tables"
        if arithmetic.count("(") > arithmetic.count(")"):
            message = "a bracket is not closed"
        raise ExpressionError(f"'{text}': {message}", expression_hint(buildings)) from None
    if not quantities or "#" in arithmetic:
        raise ExpressionError(f"'{text}': it takes nothing from the tables", expression_hint(buildings))
    return Expression(text, unit, tuple(quantities), work)


def _parse_quantity(match: re.Match[str], buildings: Sequence[str]) -> TableQuantity:
    """Return the quantity of a phrase such as `mean mu in soft storey 2`.  Raises ExpressionError."""
    name = match["name"]
    building = match["building"]
    level = 0
    if name == "line":
        raise ExpressionError("a frame line stands before its building", f"write e.g. `mu in line 1 of {buildings[0]}`")
    if name in LINE:
        of_storey = name.removeprefix("line_")
        raise ExpressionError(f"{name} belongs to a frame line", f"write `{of_storey} in line 1 of {buildings[0]}`")
    if name not in QUANTITIES:
        raise ExpressionError(f"no quantity '{name}' is known", nearest(name, (*QUANTITIES, *_FUNCTIONS)))
    if match["in"] is not None:
        if name in LINK:
            raise ExpressionError(f"{name} belongs to links, not to a building", f"write `{name}`: of all links")
        if building is None and (match["kind"] is None or match["line"] is not None):
            unknown = re.split(r"[-+*/(),]", match.string[match.end() :])[0].strip()[:40]
            if re.match(r"line\s+[0-9]", unknown):
                raise ExpressionError(f"{unknown} of which building?", _hint_of_line(name, match, buildings))
            raise ExpressionError(f"no building '{unknown}' in the group", nearest(unknown, buildings))
        level = _parse_level(match, name in FLOOR, name)
    place = None if building is None else buildings.index(building)
    line = _parse_line(match, name, [each.removeprefix("line_") for each in LINE])
    return TableQuantity(f"line_{name}" if line else name, match["how"] or REDUCTIONS[0], place, level, line)


def _parse_line(match: re.Match[str], name: str, of_lines: Sequence[str]) -> int:
    """Return the number of the frame line of a quantity or limit, from 1; 0 where it names none.  Raises
    ExpressionError: lines do not have the quantity, or there is no line 0.

    of_lines : quantities that lines have
    """
    if match["line"] is None:
        return 0
    if name not in of_lines:
        hint = f"write one of {', '.join(of_lines)}, or leave the line out"
        raise ExpressionError(f"frame lines have no {name}", hint)
    if int(match["line"]) < 1:
        raise ExpressionError("there is no line 0", "the first is `line 1`, as the plan lists them")
    return int(match["line"])


def _hint_of_line(name: str, match: re.Match[str], buildings: Sequence[str]) -> str:
    """Return how a quantity of a frame line is written."""
    number = re.search("[0-9]+", match.string[match.end() :])
    return f"write `{name} in line {number[0] if number else 1} of {buildings[0]}`"


def _parse_level(match: re.Match[str], is_of_floors: bool, owner: str) -> int:
    """Return the number of a storey or floor; 0 for all.  Raises ExpressionError: it is the other of the two, or 0.

    owner : quantity of the storey or floor, in words
    """
    if match["kind"] is None:
        return 0
    kind = "floor" if is_of_floors else "storey"
    if match["kind"] != kind:
        raise ExpressionError(f"{owner} belongs to a {kind}", f"write `{kind} {match['level']}`")
    if int(match["level"]) < 1:
        raise ExpressionError(f"there is no {kind} 0", f"the lowest is `{kind} 1`")
    return int(match["level"])


def _compile_node(node: ast.expr, quantities: Sequence[TableQuantity]) -> tuple[str, Work]:
    """Return the unit of a part of an expression, and the function that computes it.  Raises ExpressionError."""
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return "", lambda value: np.asarray(float(number))
        case ast.Name(id=name) if name not in _FUNCTIONS:
            quantity = quantities[int(name[1:])]
            return {**QUANTITIES, **LINE}[quantity.name], lambda value: value(quantity)
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
    """Return the unit of parts that are joined, two at a time where there are several, and the function that computes
    them."""
    parts = [_compile_node(node, quantities) for node in nodes]
    units = {unit for unit, _ in parts}

    def operate(value: Value) -> np.ndarray:
        first, *others = (part(value) for _, part in parts)
        if not others:
            return work(first)
        for other in others:
            first = work(first, other)
        return first

    unit = units.pop() if keeps_unit and len(units) == 1 else ""
    return unit, operate


# Statements


def statement_hint(buildings: Sequence[str]) -> str:
    """Return how a statement is written, with the buildings of the study."""
    return f"write e.g. `mu > 4`, `drift in {buildings[-1]} > 2 cm` or `mean V_ratio in {buildings[0]} < 1.1`"


_STATEMENT = re.compile(r"(?P<expression>[^<>=]+)(?P<sign>[<>])(?P<value>[^<>=]*)\Z")
_BEHIND = re.compile(r"(?P<value>.*\S)\s+in\s+(?P<place>\S.*)")
"""A value with a place behind it, as limits have it."""
_VALUES = {"": "4", "m": "2 cm", "m/s2": "1 g", "N": "500 kN", "s": "0.1 s", "N s": "20 kN s", "rad": "0.01 rad"}


@dataclass(frozen=True)
class Statement:
    """A statement that an expression lies above or below a value.

    text : as people read it
    is_above : above; below otherwise
    value : in the unit of the expression, SI
    """

    text: str
    expression: Expression
    is_above: bool
    value: float

    @property
    def quantities(self) -> tuple[TableQuantity, ...]:
        """The numbers of the tables that it rests on."""
        return self.expression.quantities

    def holds(self, values: np.ndarray) -> np.ndarray:
        """Return 1 where it holds of a value of its expression, 0 where it does not, NaN where there is no value."""
        holds = values > self.value if self.is_above else values < self.value
        return np.where(np.isnan(values), np.nan, holds)

    def __str__(self) -> str:
        return self.text


def parse_statement(text: str, buildings: Sequence[str]) -> Statement:
    """Return a statement over the tables of a study; arguments and errors as those of `parse_expression`."""
    text = " ".join(text[: MAX_LENGTH + 1].split())
    match = _STATEMENT.match(text)
    if match is None:
        raise ExpressionError(f"'{text}' is not compared with a value by < or >", statement_hint(buildings))
    expression = parse_expression(match["expression"], buildings)
    written = match["value"].strip()
    behind = _BEHIND.fullmatch(written)
    if behind is not None:
        ordered = f"{match['expression'].strip()} in {behind['place']} {match['sign']} {behind['value']}"
        raise ExpressionError(f"'{text}': the place stands behind the value", f"write `{ordered}`")
    unit = expression.unit
    example = f"{expression} {match['sign']} {_VALUES[unit]}"
    if unit == "m" and written.endswith("%"):
        example = re.sub(r"\b(edge_)?drift\b", rf"\1{DRIFT_RATIO}", text)  # of the storey height
    value = _parse_number(text, Quantity("value", unit, _VALUES[unit]), written, f"write e.g. `{example}`")
    return Statement(text, expression, match["sign"] == ">", value)


def _parse_number(text: str, measure: Quantity, written: str, hint: str) -> float:
    """Return a value with its unit in SI.  Raises ExpressionError."""
    try:
        number = float(measure.read(written))
    except PydanticCustomError as error:
        raise ExpressionError(f"'{text}': {(error.context or {})['message']}", hint) from None
    if measure.si and not written_unit(written):
        raise ExpressionError(f"'{text}': the value has no unit", hint)
    return number


# Limits


CONTACT = "contact"
COLLAPSE = "collapse"
DRIFT_RATIO = "drift_ratio"
DAMAGE_LIMITS = {f"{state} damage": state for state in DAMAGE_STATES}
"""Limits of buildings that are only seen: the drift at which a damage state of their type begins."""

EDGE_DRIFT = "edge_drift"
EDGE_DRIFT_RATIO = "edge_drift_ratio"
TWIST = "twist"
LIMITS = (
    *("mu", "drift", DRIFT_RATIO, EDGE_DRIFT, EDGE_DRIFT_RATIO, TWIST, "acceleration", SHEAR_DEMAND, CONTACT, COLLAPSE),
    *DAMAGE_LIMITS,
)
"""Quantities that may be limited."""

OF_HEIGHT = {DRIFT_RATIO: "drift", EDGE_DRIFT_RATIO: EDGE_DRIFT}
"""Quantity that is a part of the storey's height -> the same as a length."""

LIMITS_OF_LINES = ("mu", "drift")
"""Limits that may concern one frame line."""

LIMITS_OF_PAIRS = (CONTACT, SHEAR_DEMAND)
"""Limits that a building alone cannot pass."""

LIMIT_FORM = (
    "write e.g. `mu > 4`, `mu > 4 in line 1 of NAME`, `drift > 2 %`, `edge_drift > 2 %`, `acceleration > 1 g`, "
    "`shear_demand > 1`, `contact` or `collapse`"
)
_MEASURES = {
    "mu": Quantity("ductility", "", "mu > 4", 0.0, 1e6, open_low=True),
    SHEAR_DEMAND: Quantity("shear demand", "", "shear_demand > 1", 0.0, 1e6, open_low=True),
    "acceleration": ACCELERATION.replace(example="acceleration > 1 g"),
    "drift": LENGTH.replace(name="drift", example="drift > 6 cm"),
    DRIFT_RATIO: Quantity("drift ratio", "", "drift_ratio > 2 %", 0.0, 1.0, open_low=True, open_high=True),
    EDGE_DRIFT: LENGTH.replace(name="edge drift", example="edge_drift > 6 cm"),
    EDGE_DRIFT_RATIO: Quantity(
        "edge drift ratio", "", "edge_drift_ratio > 2 %", 0.0, 1.0, open_low=True, open_high=True
    ),
    TWIST: Quantity("twist", "rad", "twist > 0.01 rad", 0.0, 1.0, open_low=True),
}
_WHERE = re.compile(r"(?P<comparison>.*)\s+in\s+(?P<where>\S.*)\Z")  # the last `in`: one before it may be inches
_PLACE = re.compile(
    r"(?:line\s+(?P<line>[0-9]{1,3})\b\s*(?P<of>of\b)?\s*)?"
    r"(?P<building>.*?)\s*(?:\b(?P<kind>storey|floor)\s+(?P<level>[0-9]{1,3}))?\Z"
)


@dataclass(frozen=True)
class Limit:
    """One limit.

    text : as people read it
    quantity : one of LIMITS
    value : [-], [m] or [m/s2]; 0 of contact, where a gap that closes passes the limit, and of collapse
    of_height : the value is a part of the storey's height
    building : the only one it concerns, "" for each of them
    level : its only storey or floor, from 1 at the ground; 0 for any of them
    line : the only frame line of that building it concerns, from 1; 0 for the storeys
    """

    text: str
    quantity: str
    value: float = 0.0
    of_height: bool = False
    building: str = ""
    level: int = 0
    line: int = 0

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Target:
    """The limit of a curve, and the building that it concerns.

    building : its place in the group; of contact that of the left one of a pair
    """

    limit: Limit
    building: int

    def label(self, names: tuple[str, ...]) -> str:
        """Return the name of the building, or of the pair."""
        if self.limit.quantity == CONTACT:
            return f"{names[self.building]}|{names[self.building + 1]}"
        return names[self.building]


def parse_limit(value: Any) -> Limit:
    """Return a limit as the file writes it.  Raises PydanticCustomError saying what to write."""
    text = " ".join(str(value).split())[:200]
    match = _WHERE.match(text)
    comparison = match["comparison"] if match else text
    where = match["where"] if match else ""
    quantity, sign, written = (part.strip() for part in comparison.partition(">"))
    if quantity not in LIMITS:
        raise refuse(f"'{text[:60]}' is not a limit", f"{nearest(quantity, LIMITS)}; {LIMIT_FORM}")
    has_value = quantity in _MEASURES
    if bool(sign) != has_value:
        usage = f"{quantity} takes {'`>` and a value' if has_value else 'no value'}"
        hint = LIMIT_FORM
        if has_value and ">" in where:
            usage = "its value stands behind the place"
            named, _, level_written = (part.strip() for part in where.partition(">"))
            hint = f"write `{quantity} > {level_written} in {named}`"
        raise refuse(f"'{text[:60]}' is not a limit: {usage}", hint)
    place = _PLACE.match(where)
    assert place is not None  # it matches everything
    building = place["building"].strip()
    if written_unit(written) in ("%", "percent", "pct") and quantity in OF_HEIGHT.values():
        quantity = next(ratio for ratio, length in OF_HEIGHT.items() if length == quantity)
    of_height = quantity in OF_HEIGHT
    measure = _MEASURES.get(quantity)
    quantity = OF_HEIGHT.get(quantity, quantity)
    try:
        line = _parse_line(place, quantity, LIMITS_OF_LINES)
        if line and not (place["of"] and building):
            raise ExpressionError(
                f"'{text}': line {line} of which building?", f"write `{comparison} in line {line} of NAME`"
            )
        level = _parse_level(place, quantity in FLOOR, f"'{text}': {quantity}")
        number = 0.0 if measure is None else _parse_number(text, measure, written, LIMIT_FORM)
    except ExpressionError as error:
        raise refuse(*error.args) from None
    if measure is None and (level or (where and quantity == CONTACT)):
        concerns = "two buildings, not one of them" if quantity == CONTACT else "a building, not one of its storeys"
        raise refuse(f"'{text}': {quantity} concerns {concerns}", f"write `{quantity}`")
    return Limit(text, quantity, number, of_height, building, level, line)
