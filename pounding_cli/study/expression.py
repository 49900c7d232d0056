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
from pounding_cli.study.quantity import ACCELERATION, LENGTH, refuse, written_unit
from pounding_cli.study.quantity import Quantity as Measure

STOREY, FLOOR, LINK = (
    {
        v.name: v.unit.removeprefix("1")
        for v in variables.RESPONSES
        if v.dims == dims and v.name not in variables.OF_COLUMNS
    }
    for dims in (variables.STOREY, variables.FLOOR, variables.LINK)
)
QUANTITIES = STOREY | FLOOR | LINK
"""What an expression may name, as the tables do, and the SI unit of each."""

REDUCTIONS = ("largest", "smallest", "mean")
"""What is taken of several storeys, floors or links; `largest` unless written."""

FORM = "write e.g. `mu`, `mean V_ratio in stiff`, `drift in soft storey 1` or `max(V_ratio in stiff, V_ratio in soft)`"
_LONGEST = 500
_FUNCTIONS: Mapping[str, Callable[..., np.ndarray]] = {
    "max": np.maximum, "min": np.minimum, "abs": np.abs, "sqrt": np.sqrt, "log": np.log, "exp": np.exp,
}  # fmt: skip
_SEVERAL = ("max", "min")
_SUMS: Mapping[type[ast.operator], Callable[..., np.ndarray]] = {ast.Add: np.add, ast.Sub: np.subtract}
_PRODUCTS: Mapping[type[ast.operator], Callable[..., np.ndarray]] = {ast.Mult: np.multiply, ast.Div: np.divide}
_WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
_NEXT = re.compile(r"\s+([A-Za-z_]\w*)")
_IN = re.compile(r"\s*in\b\s*")
_LEVEL = re.compile(r"\s*(?P<kind>storey|floor)\s+(?P<number>[0-9]{1,3})(?!\w)")


@dataclass(frozen=True)
class Quantity:
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


Value = Callable[[Quantity], np.ndarray]
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
    quantities: tuple[Quantity, ...]
    _work: Work

    def __call__(self, value: Value) -> np.ndarray:
        """The expression from the values of its quantities; not finite where it has none (a root of -1)."""
        with np.errstate(all="ignore"):
            return self._work(value)

    def __str__(self) -> str:
        return self.text


class NotUnderstood(ValueError):
    """What is wrong with an expression; the second argument says what to write."""


def read_expression(text: str, buildings: Sequence[str]) -> Expression:
    """An expression over the tables of a study.

    buildings : names of the group by place, left to right

    Raises
    ------
    NotUnderstood : what is wrong, and what to write
    """
    if len(text) > _LONGEST:
        raise NotUnderstood(f"{len(text)} characters are not an expression", FORM)
    return _Reader(" ".join(text.split()), buildings).expression()


class _Reader:
    """Reads one expression: `said` has a name, `_0`, `_1`, in place of every quantity."""

    def __init__(self, text: str, buildings: Sequence[str]) -> None:
        self.text, self.buildings, self.said = text, buildings, ""
        self.quantities: list[Quantity] = []
        self.phrases: list[str] = []

    def refuse(self, what: str, hint: str = FORM) -> NotUnderstood:
        return NotUnderstood(f"'{self.text}': {what}", hint)

    def expression(self) -> Expression:
        place = 0
        while (found := _WORD.search(self.text, place)) is not None:
            self.said += self.text[place : found.start()]
            place = found.end()
            if found[0] in _FUNCTIONS:
                self.said += found[0]
                continue
            place = self._quantity(found[0], place)
            self.said += f"_{len(self.phrases)}"
            self.phrases.append(self.text[found.start() : place])
        self.said += self.text[place:]
        unit, work = self._part(self._parsed())
        if not self.quantities:
            raise self.refuse("it takes nothing from the tables")
        return Expression(self.text, unit, tuple(self.quantities), work)

    def _parsed(self) -> ast.expr:
        if bare := re.search(r"\b(max|min|abs|sqrt|log|exp)\b(?!\s*\()", self.said):
            raise self.refuse(f"{bare[1]} lacks its bracket", f"write e.g. `{bare[1]}(mu)`")
        if "#" in self.said:
            raise self.refuse("'#' is not understood")
        try:
            return ast.parse(self.said.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            if self.said.count("(") > self.said.count(")"):
                raise self.refuse("a bracket is not closed", "close it with )") from None
            column = getattr(error, "offset", None) or 1
            ends = column > len(self.said.strip()) or re.search(r"[-+*/(,]\s*\Z", self.said)
            rest = "" if ends else self._as_written(self.said.strip()[column - 1 :])
            raise self.refuse(f"'{rest[:40]}' is not understood" if rest else "it ends too early") from None

    def _as_written(self, said: str) -> str:
        return re.sub(r"_(\d+)", lambda found: self.phrases[int(found[1])], said)

    def _part(self, node: ast.expr) -> tuple[str, Work]:
        """Unit and work of a part."""
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return "", lambda value: np.asarray(float(number))
            case ast.Name(id=name):
                quantity = self.quantities[int(name[1:])]
                return QUANTITIES[quantity.name], lambda value: value(quantity)
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                unit, work = self._part(inner)
                return unit, lambda value: -work(value)
            case ast.BinOp(op=sign, left=left, right=right) if type(sign) in (*_SUMS, *_PRODUCTS):
                parts = [self._part(left), self._part(right)]
                units = {unit for unit, _ in parts} if type(sign) in _SUMS else {""}
                return _shared(units), _joined({**_SUMS, **_PRODUCTS}[type(sign)], parts)
            case ast.Call(func=ast.Name(id=name), args=inner, keywords=[]) if name in _FUNCTIONS:
                if (len(inner) > 1) != (name in _SEVERAL):
                    wanted = "two values or more" if name in _SEVERAL else "one value"
                    example = f"write e.g. `{name}({'mu, mu0' if name in _SEVERAL else 'mu'})`"
                    raise self.refuse(f"{name} takes {wanted}", example)
                parts = [self._part(one) for one in inner]
                units = {unit for unit, _ in parts} if name in (*_SEVERAL, "abs") else {""}
                return _shared(units), _joined(_FUNCTIONS[name], parts)
        raise self.refuse(f"'{self._as_written(ast.unparse(node))[:40]}' is not understood")

    def _quantity(self, word: str, place: int) -> int:
        """Note the quantity that begins with a word; returns where it ends."""
        reduction = word if word in REDUCTIONS else REDUCTIONS[0]
        if word in REDUCTIONS:
            found = _NEXT.match(self.text, place)
            if found is None:
                raise self.refuse(f"{word} of what?", f"write e.g. `{word} mu`")
            word, place = found[1], found.end()
        if word not in QUANTITIES:
            raise self.refuse(f"no quantity '{word}' is known", nearest(word, (*QUANTITIES, *_FUNCTIONS)))
        building, level = None, 0
        if (found := _IN.match(self.text, place)) is not None:
            if word in LINK:
                raise self.refuse(f"{word} belongs to links, not to a building", f"write `{word}`: of all links")
            building, level, place = self._place(word, found.end())
        self.quantities.append(Quantity(word, reduction, building, level))
        return place

    def _place(self, word: str, place: int) -> tuple[int | None, int, int]:
        """Building and level of what follows `in`, and where that ends."""
        known = [each for each in self.buildings if re.compile(rf"{re.escape(each)}(?!\w)").match(self.text, place)]
        name = max(known, key=len, default="")
        place += len(name)
        found = _LEVEL.match(self.text, place)
        if found is None and not name:
            wrong = re.split(r"[-+*/(),]", self.text[place:])[0].strip()[:40]
            raise self.refuse(f"no building '{wrong}' in the group", nearest(wrong, self.buildings))
        building = self.buildings.index(name) if name else None
        if found is None:
            return building, 0, place
        try:
            return building, _level(found, word in FLOOR, word), found.end()
        except NotUnderstood as error:
            raise self.refuse(*error.args) from None


def _level(found: re.Match[str], of_floors: bool, what: str) -> int:
    """The number of a storey or floor.  Raises NotUnderstood: it is the other of the two, or 0."""
    own = "floor" if of_floors else "storey"
    if found["kind"] != own:
        raise NotUnderstood(f"{what} belongs to a {own}", f"write `{own} {found['number']}`")
    if int(found["number"]) < 1:
        raise NotUnderstood(f"there is no {own} 0", f"the lowest is `{own} 1`")
    return int(found["number"])


def _shared(units: set[str]) -> str:
    return units.pop() if len(units) == 1 else ""


def _joined(work: Callable[..., np.ndarray], parts: Sequence[tuple[str, Work]]) -> Work:
    """Work over parts, two at a time where it takes several."""

    def joined(value: Value) -> np.ndarray:
        first, *others = (part(value) for _, part in parts)
        if not others:
            return work(first)
        for other in others:
            first = work(first, other)
        return first

    return joined


# Statements


STATEMENT_FORM = "write e.g. `mu > 4`, `drift in soft > 2 cm` or `mean V_ratio in stiff < 1.1`"
_STATEMENT = re.compile(r"(?P<expression>[^<>=]+)(?P<sign>[<>=]+)(?P<value>[^<>=]*)\Z")
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
    def quantities(self) -> tuple[Quantity, ...]:
        """What it takes from the tables."""
        return self.expression.quantities

    def holds(self, values: np.ndarray) -> np.ndarray:
        """1 where it holds of a value of its expression, 0 where it does not, NaN where there is no value."""
        holds = values > self.value if self.is_above else values < self.value
        return np.where(np.isnan(values), np.nan, holds)

    def __str__(self) -> str:
        return self.text


def read_statement(text: str, buildings: Sequence[str]) -> Statement:
    """A statement over the tables of a study; arguments and errors as those of `read_expression`."""
    text = " ".join(text[: _LONGEST + 1].split())
    found = _STATEMENT.match(text)
    if found is None:
        if text in (CONTACT, COLLAPSE):
            hint = "write `impacts > 0`" if text == CONTACT else "`pound fragility` knows the limit `collapse`"
            raise NotUnderstood(f"'{text}' is not compared with a value", hint)
        raise NotUnderstood(f"'{text}' is not compared with a value", STATEMENT_FORM)
    if found["sign"] not in ("<", ">"):
        raise NotUnderstood(f"'{text}' has {found['sign']} where < or > belongs", STATEMENT_FORM)
    expression, written = read_expression(found["expression"], buildings), found["value"].strip()
    unit, example = expression.unit, f"{expression} {found['sign']} {_VALUES[expression.unit]}"
    if {each.name for each in expression.quantities} == {"drift"} and written.endswith("%"):
        ratio = text.replace("drift", DRIFT_RATIO)
        raise NotUnderstood(f"'{text}': a drift is a length", f"write `{ratio}`, of the storey height")
    if unit and not written_unit(written):
        raise NotUnderstood(f"'{text}': the value has no unit", f"write e.g. `{example}`")
    try:
        value = float(Measure("value", unit, _VALUES[unit]).read(written))
    except PydanticCustomError as error:
        context: dict[str, Any] = error.context or {}
        raise NotUnderstood(f"'{text}': {context['message']}", f"write e.g. `{example}`") from None
    return Statement(text, expression, found["sign"] == ">", value)


# Limits


CONTACT, COLLAPSE, SHEAR_DEMAND, DRIFT_RATIO = "contact", "collapse", "shear_demand", "drift_ratio"
LIMITS = ("mu", "drift", DRIFT_RATIO, "acceleration", SHEAR_DEMAND, CONTACT, COLLAPSE)
"""What may be limited."""

TAKES_NEIGHBOUR = (CONTACT, SHEAR_DEMAND)
"""Limits that a building alone cannot pass."""

LIMIT_FORM = "write e.g. `mu > 4`, `drift > 2 %`, `acceleration > 1 g`, `shear_demand > 1`, `contact` or `collapse`"
_MEASURES = {
    "mu": Measure("ductility", "", "mu > 4", 0.0, 1e6, open_low=True),
    SHEAR_DEMAND: Measure("shear demand", "", "shear_demand > 1", 0.0, 1e6, open_low=True),
    "acceleration": ACCELERATION.but(example="acceleration > 1 g"),
    "drift": LENGTH.but(name="drift", example="drift > 6 cm"),
    DRIFT_RATIO: Measure("drift ratio", "", "drift_ratio > 2 %", 0.0, 1.0, open_low=True, open_high=True),
}
_MEANT = {
    "ductility": "mu", "idr": DRIFT_RATIO, "drift ratio": DRIFT_RATIO, "acc": "acceleration", "pfa": "acceleration",
    "impact": CONTACT, "impacts": CONTACT, "pounding": CONTACT, "collapsed": COLLAPSE,
    "shear": SHEAR_DEMAND, "shear demand": SHEAR_DEMAND,
}  # fmt: skip
_WHERE = re.compile(r"(?P<what>.*)\s+in\s+(?P<where>\S.*)\Z")  # the last `in`: one before it may be inches
_LIMIT = re.compile(r"(?P<quantity>[^<>=]*?)\s*(?:(?P<sign>[<>=]+)\s*(?P<value>.*?))?\s*\Z")


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


def read_limit(value: Any) -> Limit:
    """A limit as the file says it.  Raises PydanticCustomError saying what to write."""
    if not isinstance(value, str):
        raise refuse("this is not a limit", LIMIT_FORM)
    text = " ".join(value.split())
    parted = _WHERE.match(text[:200])
    what, where = (parted["what"], parted["where"]) if parted else (text[:200], "")
    found = _LIMIT.match(what)
    if len(text) > 200 or found is None or not found["quantity"]:
        raise refuse(f"'{text[:60]}' is not a limit", LIMIT_FORM)
    quantity, sign = found["quantity"], found["sign"]
    if quantity not in LIMITS:
        meant = _MEANT.get(quantity.lower())
        known = f"did you mean '{meant}'? known: {', '.join(LIMITS)}" if meant else nearest(quantity, LIMITS)
        raise refuse(f"'{text}': no limit of '{quantity}' is known", known)
    building, level = _concerned(where, quantity, text)
    if quantity in (CONTACT, COLLAPSE):
        concerns, hint = "concerns the gap between two buildings, not one of them", "a gap that closes passes it"
        hint = f"write `contact`: {hint}"
        if quantity == COLLAPSE:
            concerns = "concerns a building, not one of its storeys"
            hint = "write `collapse`, or `collapse in BUILDING`; `collapse: 10 %` of a building sets the drift"
        if sign or level or (where and quantity == CONTACT):
            raise refuse(f"'{text}': {quantity} {'takes no value' if sign else concerns}", hint)
        return Limit(text, quantity, building=building)
    if sign != ">":
        said = f"has {sign} where > belongs" if sign else "lacks its value"
        raise refuse(f"'{text}' {said}", f"write e.g. `{_MEASURES[quantity].example}`")
    return _compared(text, quantity, found["value"], building, level)


def _compared(text: str, quantity: str, written: str, building: str, level: int) -> Limit:
    """A limit with its value."""
    unit = written_unit(written)
    of_height = quantity == DRIFT_RATIO or (quantity == "drift" and unit in ("%", "percent", "pct"))
    example = f"`{_MEASURES[quantity].example}`"
    if quantity in ("drift", "acceleration") and not unit:
        both = "`drift > 2 %` (of the storey height) or `drift > 6 cm`"
        raise refuse(f"'{text}': the limit has no unit", f"write e.g. {both if quantity == 'drift' else example}")
    try:
        value = float(_MEASURES[DRIFT_RATIO if of_height else quantity].read(written))
    except PydanticCustomError as error:
        context: dict[str, Any] = error.context or {}
        raise refuse(f"'{text}': {context['message']}", f"write e.g. {example}") from None
    return Limit(text, "drift" if of_height else quantity, value, of_height, building, level)


def _concerned(where: str, quantity: str, text: str) -> tuple[str, int]:
    """Building and level of what follows `in`."""
    found = re.fullmatch(rf"(?P<building>.*?){_LEVEL.pattern}", where)
    if found is None:
        return where, 0
    try:
        return found["building"].strip(), _level(found, quantity == "acceleration", quantity)
    except NotUnderstood as error:
        raise refuse(f"'{text}': {error.args[0]}", error.args[1]) from None
