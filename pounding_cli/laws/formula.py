"""A force as a formula, `k*v + k3*v**3 + c*r`: parsed by Python's parser, never run as Python, its units checked."""

from __future__ import annotations

import ast
import math
from collections.abc import Mapping
from dataclasses import dataclass

from pounding_cli.laws.program import CLOSING, RATE, Expression, Operation

LONGEST = 500
"""Characters of a formula."""

MOST_POWER = 8
"""Largest whole power."""

Dimension = tuple[float, float, float]
"""Powers of kg, m and s."""

PLAIN: Dimension = (0.0, 0.0, 0.0)
FORCE: Dimension = (1.0, 1.0, -2.0)

GIVEN: Mapping[str, tuple[Dimension, str]] = {
    "v": ((0.0, 1.0, 0.0), "closing [m]"),
    "r": ((0.0, 1.0, -1.0), "its rate [m/s]"),
    "m": ((1.0, 0.0, 0.0), "reduced mass of the two floors [kg]"),
    "d": ((0.0, 1.0, 0.0), "gap [m]"),
}
"""What a formula may use besides its parameters."""

_SAYS = f"a formula is made of numbers, {', '.join(GIVEN)}, parameters, + - * / **, brackets and sqrt()"


class FormulaError(ValueError):
    """What is wrong with a formula, what to write instead, and at which line and character of it, both from 0."""

    def __init__(self, message: str, hint: str, line: int = 0, column: int = 0) -> None:
        super().__init__(message)
        self.message, self.hint, self.line, self.column = message, hint, line, column


@dataclass(frozen=True)
class Term:
    """A part of a formula: a number, or what it makes of v and r, with its dimension."""

    value: Expression | float
    dimension: Dimension = PLAIN


def read(text: str, known: Mapping[str, Term], lows: tuple[float, ...]) -> Expression:
    """The force [N] that a formula says.

    Parameters
    ----------
    known : parameters, m and d by name
    lows : closings [m] at which what stands under a root has to be above zero, at any rate

    Raises
    ------
    FormulaError : it is not a formula, or its unit is not N
    """
    reader = _Reader(text, {"v": Term(CLOSING, GIVEN["v"][0]), "r": Term(RATE, GIVEN["r"][0]), **known}, lows)
    term = reader.term(reader.tree())
    if term.dimension != FORCE:
        raise FormulaError(f"the formula gives {in_units(term.dimension)}, not N", "correct it or a parameter's unit")
    return term.value if isinstance(term.value, Expression) else 0.0 * CLOSING + term.value


def in_units(dimension: Dimension) -> str:
    """A dimension in SI units, such as `kg m/s^2`."""
    parts = [
        unit if power == 1 else f"{unit}^{power:g}" for unit, power in zip(("kg", "m", "s"), dimension, strict=True)
        if power
    ]  # fmt: skip
    return "N" if dimension == FORCE else " ".join(parts) or "a plain number"


def powers_of_closing(force: Expression) -> set[float]:
    """The powers of v in a force that are no whole numbers."""
    found = set().union(*(powers_of_closing(part) for part in force.parts))
    if force.operation is Operation.POWER and force.parts[0] == CLOSING:
        found.add(force.numbers[1])
    return found


def is_straight(force: Expression) -> bool:
    """Whether a force is straight in v and r."""
    return force.operation in (None, Operation.LINEAR) and all(map(is_straight, force.parts))


class _Reader:
    def __init__(self, text: str, known: Mapping[str, Term], lows: tuple[float, ...]) -> None:
        self.text, self.known, self.lows = text, known, lows

    def tree(self) -> ast.expr:
        if len(self.text) > LONGEST:
            raise FormulaError(f"the formula has {len(self.text)} characters", f"write at most {LONGEST}")
        try:
            return ast.parse(self.text.strip(), mode="eval").body
        except SyntaxError as error:
            line, column = (error.lineno or 1) - 1, max((error.offset or 1) - 1, 0)
            raise FormulaError(f"'{self.text.strip()}' is not a formula", _SAYS, line, column) from None
        except (ValueError, RecursionError, MemoryError):
            raise FormulaError("this is not a formula", _SAYS) from None

    def wrong(self, node: ast.expr, message: str, hint: str = _SAYS) -> FormulaError:
        return FormulaError(message, hint, node.lineno - 1, node.col_offset)

    def says(self, node: ast.expr) -> str:
        return f"'{ast.get_source_segment(self.text.strip(), node)}'"

    def term(self, node: ast.expr) -> Term:
        """What a node says; only what is named here is taken."""
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
            return self.number(node, float(node.value))
        if isinstance(node, ast.Name):
            if node.id not in self.known:
                names = ", ".join(dict.fromkeys((*GIVEN, *self.known)))
                raise self.wrong(node, f"'{node.id}' is not known", f"give it under `parameters`; known: {names}")
            return self.known[node.id]
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
            term = self.term(node.operand)
            return Term(-term.value, term.dimension) if isinstance(node.op, ast.USub) else term
        if isinstance(node, ast.BinOp):
            return self.pair(node)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "sqrt":
            if len(node.args) == 1 and not node.keywords:
                return self.power(node, node.args[0], 0.5)
            raise self.wrong(node, "sqrt() takes one value", "write sqrt(...)")
        raise self.wrong(node, f"{self.says(node)} is not allowed in a formula")

    def number(self, node: ast.expr, value: float, dimension: Dimension = PLAIN) -> Term:
        if not math.isfinite(value):
            raise self.wrong(node, f"{self.says(node)} is not a finite number", "write a finite one")
        return Term(value, dimension)

    def pair(self, node: ast.BinOp) -> Term:
        if isinstance(node.op, ast.Pow):
            exponent = self.term(node.right)
            if isinstance(exponent.value, Expression) or exponent.dimension != PLAIN:
                raise self.wrong(
                    node.right, f"the power {self.says(node.right)} is not a plain number", "write a number"
                )
            return self.power(node, node.left, exponent.value)
        one, other = self.term(node.left), self.term(node.right)
        if isinstance(node.op, ast.Add | ast.Sub):
            if one.dimension != other.dimension:
                message = f"{self.says(node.left)} is in {in_units(one.dimension)}, {self.says(node.right)} in "
                raise self.wrong(node, message + in_units(other.dimension), "add what has one unit")
            sum_ = one.value + other.value if isinstance(node.op, ast.Add) else one.value - other.value
            return self.made(node, sum_, one.dimension)
        if isinstance(node.op, ast.Mult):
            return self.made(node, one.value * other.value, _sum(one.dimension, other.dimension))
        if isinstance(node.op, ast.Div):
            inverse = self.power(node, node.right, -1.0)
            return self.made(node, one.value * inverse.value, _sum(one.dimension, inverse.dimension))
        raise self.wrong(node, f"{self.says(node)} is not allowed in a formula")

    def made(self, node: ast.expr, value: Expression | float, dimension: Dimension) -> Term:
        return Term(value, dimension) if isinstance(value, Expression) else self.number(node, value, dimension)

    def power(self, node: ast.expr, base: ast.expr, exponent: float) -> Term:
        term = self.term(base)
        dimension = _sum(PLAIN, term.dimension, exponent)
        if not isinstance(term.value, Expression):
            try:
                value = term.value**exponent
            except (ZeroDivisionError, OverflowError):
                value = math.inf
            if isinstance(value, complex):
                raise self.wrong(base, f"{self.says(base)} is below zero", "a root needs a value above zero")
            return self.number(node, float(value), dimension)
        if exponent == 0.0:
            return Term(1.0)
        if exponent > 0.0 and float(exponent).is_integer():
            if exponent > MOST_POWER:
                raise self.wrong(node, f"the power {exponent:g} is above {MOST_POWER}", f"write at most {MOST_POWER}")
            return Term(term.value**exponent, dimension)
        if term.value == CLOSING and exponent > 0.0 and min(self.lows) >= 0.0:
            return Term(term.value**exponent, dimension)
        self.stays_positive(base, term.value)
        return Term(term.value**exponent, dimension)

    def stays_positive(self, node: ast.expr, value: Expression) -> None:
        """Refuse what a root or a division cannot take."""
        for v in self.lows:
            for r in (-3.0, -0.1, 0.0, 0.1, 3.0):
                if not float(value.at(v, r)) > 0.0:
                    message = f"{self.says(node)} is not above zero at v = {v:g} m, r = {r:g} m/s"
                    hint = "divisors and arguments of roots and fractional powers must stay above zero"
                    raise self.wrong(node, message, f"{hint}; of v itself write v**1.5")


def _sum(one: Dimension, other: Dimension, times: float = 1.0) -> Dimension:
    a, b, c = (round(x + times * y, 9) + 0.0 for x, y in zip(one, other, strict=True))
    return a, b, c
