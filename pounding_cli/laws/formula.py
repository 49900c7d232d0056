"""A force as a formula, `k*v + k3*v**3 + c*r`: parsed by Python's parser, never run as Python, its units checked; and
the laws of links that a study writes so.

What is read becomes a short table of operations on numbers, which the solver carries out: no formula is compiled."""

from __future__ import annotations

import ast
import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, ClassVar

import numpy as np

from pounding_cli.laws import pounding
from pounding_cli.laws.dashpot import reduced_mass
from pounding_cli.laws.law import PRESSED, Behaviour, LinkLaw

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


class Operation(IntEnum):
    """What an operation makes of the registers x and y and the number a. Registers 0 and 1 hold v [m] and v' [m/s],
    each operation fills the next one, and the last one is the force [N]."""

    NUMBER = 0  # a
    PLUS = 1  # x + y
    TIMES = 2  # x y
    POWER = 3  # x^a; 0 where a is no whole number and x is below zero


MOST_OPERATIONS = 300
"""A formula of `LONGEST` characters has no more."""

Row = tuple[float, float, float, float]
"""An operation: (code, x, y, a)."""


@dataclass(frozen=True)
class Formula:
    """A force [N] of v and r as operations; whether it is straight in both."""

    rows: tuple[Row, ...]
    is_straight: bool

    def at(self, v: Any, r: Any) -> Any:
        """Its value at closings [m] and rates [m/s]; numbers or arrays of one shape."""
        return _carried_out(self.rows, v, r)[-1]


def _carried_out(rows: tuple[Row, ...] | list[Row], v: Any, r: Any) -> list[Any]:
    """All registers after these operations."""
    registers = [np.asarray(v, float), np.asarray(r, float)]
    for code, x, y, a in rows:
        one, other = registers[int(x)], registers[int(y)]
        if code == Operation.NUMBER:
            registers.append(np.full_like(registers[0], a))
        elif code == Operation.POWER:
            with np.errstate(divide="ignore"):
                registers.append((one if a.is_integer() else np.maximum(one, 0.0)) ** a)
        else:
            registers.append(one + other if code == Operation.PLUS else one * other)
    return registers


@dataclass(frozen=True)
class Term:
    """A part of a formula with its dimension.

    number : its value, where it does not depend on v and r; NaN otherwise
    at : the register that holds it otherwise
    degree : in v and r: 0, 1 where it is straight in them, 2 where it is not
    """

    number: float = math.nan
    dimension: Dimension = PLAIN
    at: int = -1
    degree: int = 0


def read(text: str, known: Mapping[str, Term], lows: tuple[float, ...]) -> Formula:
    """The force [N] that a formula says.

    Parameters
    ----------
    known : parameters, m and d by name
    lows : closings [m] at which what stands under a root has to be above zero, at any rate

    Raises
    ------
    FormulaError : it is not a formula, or its unit is not N
    """
    own = {"v": Term(dimension=GIVEN["v"][0], at=0, degree=1), "r": Term(dimension=GIVEN["r"][0], at=1, degree=1)}
    reader = _Reader(text.strip(), {**own, **known}, lows)
    term = reader.term(_parsed(text))
    if term.dimension != FORCE:
        raise FormulaError(f"the formula gives {in_units(term.dimension)}, not N", "correct it or a parameter's unit")
    if reader.register(term) != 1 + len(reader.rows):  # the last operation makes the force
        reader.operate(Operation.TIMES, term.at, reader.register(Term(1.0)))
    return Formula(tuple(reader.rows), term.degree < 2)


def in_units(dimension: Dimension) -> str:
    """A dimension in SI units, such as `kg m/s^2`."""
    powers = zip(("kg", "m", "s"), dimension, strict=True)
    parts = [unit if power == 1 else f"{unit}^{power:g}" for unit, power in powers if power]
    return "N" if dimension == FORCE else " ".join(parts) or "a plain number"


def _parsed(text: str) -> ast.expr:
    if len(text) > LONGEST:
        raise FormulaError(f"the formula has {len(text)} characters", f"write at most {LONGEST}")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except SyntaxError as error:
        line, column = (error.lineno or 1) - 1, max((error.offset or 1) - 1, 0)
        raise FormulaError(f"'{text.strip()}' is not a formula", _SAYS, line, column) from None
    except (ValueError, RecursionError, MemoryError):
        raise FormulaError("this is not a formula", _SAYS) from None


class _Reader:
    """Reads one formula; `rows` are the operations so far, each once."""

    def __init__(self, text: str, known: Mapping[str, Term], lows: tuple[float, ...]) -> None:
        self.text, self.known, self.lows, self.rows = text, known, lows, list[Row]()

    def wrong(self, node: ast.expr, message: str, hint: str = _SAYS) -> FormulaError:
        return FormulaError(message, hint, node.lineno - 1, node.col_offset)

    def says(self, node: ast.expr) -> str:
        return f"'{ast.get_source_segment(self.text, node)}'"

    def operate(self, code: Operation, x: int = 0, y: int = 0, a: float = 0.0) -> int:
        """The register that an operation fills."""
        row = float(code), float(x), float(y), a
        if row not in self.rows:
            self.rows.append(row)
        return 2 + self.rows.index(row)

    def register(self, term: Term) -> int:
        """The register that holds a term."""
        return term.at if term.degree else self.operate(Operation.NUMBER, a=term.number)

    def term(self, node: ast.expr) -> Term:
        """What a node says; only what is named here is taken."""
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return self.number(node, float(number))
            case ast.Name(id=name) if name in self.known:
                return self.known[name]
            case ast.Name(id=name):
                names = ", ".join(dict.fromkeys((*GIVEN, *self.known)))
                raise self.wrong(node, f"'{name}' is not known", f"give it under `parameters`; known: {names}")
            case ast.UnaryOp(op=ast.UAdd(), operand=inner):
                return self.term(inner)
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return self.times(node, self.term(inner), Term(-1.0))
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                return self.plus(node, self.term(node.left), self.term(node.right))
            case ast.BinOp(op=ast.Mult()):
                return self.times(node, self.term(node.left), self.term(node.right))
            case ast.BinOp(op=ast.Div()):
                return self.times(node, self.term(node.left), self.power(node, node.right, -1.0))
            case ast.BinOp(op=ast.Pow(), right=right):
                exponent = self.term(right)
                if exponent.degree or exponent.dimension != PLAIN:
                    raise self.wrong(right, f"the power {self.says(right)} is not a plain number", "write a number")
                return self.power(node, node.left, exponent.number)
            case ast.Call(func=ast.Name(id="sqrt"), args=[inner], keywords=[]):
                return self.power(node, inner, 0.5)
            case ast.Call(func=ast.Name(id="sqrt")):
                raise self.wrong(node, "sqrt() takes one value", "write sqrt(...)")
        raise self.wrong(node, f"{self.says(node)} is not allowed in a formula")

    def number(self, node: ast.expr, value: float, dimension: Dimension = PLAIN) -> Term:
        if not math.isfinite(value):
            raise self.wrong(node, f"{self.says(node)} is not a finite number", "write a finite one")
        return Term(value, dimension)

    def plus(self, node: ast.BinOp, one: Term, other: Term) -> Term:
        if one.dimension != other.dimension:
            message = f"{self.says(node.left)} is in {in_units(one.dimension)}, {self.says(node.right)} in "
            raise self.wrong(node, message + in_units(other.dimension), "add what has one unit")
        if isinstance(node.op, ast.Sub):
            other = self.times(node, other, Term(-1.0))
        degree = max(one.degree, other.degree)
        if not degree:
            return self.number(node, one.number + other.number, one.dimension)
        at = self.operate(Operation.PLUS, self.register(one), self.register(other))
        return Term(dimension=one.dimension, at=at, degree=degree)

    def times(self, node: ast.expr, one: Term, other: Term) -> Term:
        dimension = _sum(one.dimension, other.dimension)
        degree = 2 if one.degree and other.degree else one.degree + other.degree
        if not degree:
            return self.number(node, one.number * other.number, dimension)
        at = self.operate(Operation.TIMES, self.register(one), self.register(other))
        return Term(dimension=dimension, at=at, degree=degree)

    def power(self, node: ast.expr, base: ast.expr, exponent: float) -> Term:
        term = self.term(base)
        dimension = _sum(PLAIN, term.dimension, exponent)
        if not term.degree:
            try:
                value = term.number**exponent
            except (ZeroDivisionError, OverflowError):
                value = math.inf
            if isinstance(value, complex):
                raise self.wrong(base, f"{self.says(base)} is below zero", "a root needs a value above zero")
            return self.number(node, float(value), dimension)
        if exponent == 0.0:
            return Term(1.0)
        is_whole = exponent > 0.0 and exponent.is_integer()
        if is_whole and exponent > MOST_POWER:
            raise self.wrong(node, f"the power {exponent:g} is above {MOST_POWER}", f"write at most {MOST_POWER}")
        is_pressed = term.at == 0 and exponent > 0.0 and min(self.lows) >= 0.0
        if not (is_whole or is_pressed):
            self.stays_positive(base, term.at)
        return Term(dimension=dimension, at=self.operate(Operation.POWER, term.at, a=exponent), degree=2)

    def stays_positive(self, node: ast.expr, at: int) -> None:
        """Refuse what a root or a division cannot take."""
        for v in self.lows:
            for r in (-3.0, -0.1, 0.0, 0.1, 3.0):
                if not _carried_out(self.rows, v, r)[at] > 0.0:
                    message = f"{self.says(node)} is not above zero at v = {v:g} m, r = {r:g} m/s"
                    hint = "divisors and arguments of roots and fractional powers must stay above zero"
                    raise self.wrong(node, message, f"{hint}; of v itself write v**1.5")


def _sum(one: Dimension, other: Dimension, times: float = 1.0) -> Dimension:
    a, b, c = (round(x + times * y, 9) + 0.0 for x, y in zip(one, other, strict=True))
    return a, b, c


_PRESSED = (0.0, 1e-6, 1e-3, 0.01, 0.1)
_BOTH_WAYS = (*(-v for v in _PRESSED[1:]), *_PRESSED)


def force(e: Any, v: float, r: float) -> float:
    """Nothing: the solver carries out the operations (`solver.dispatch`)."""
    return 0.0


WRITTEN_BEHAVIOUR = Behaviour(pounding.next_branch, force)


@dataclass(frozen=True)
class WrittenLaw(LinkLaw):
    """F = the formula, once the gap has closed; v is the closing less the gap.

    called : its name
    formula : its force [N] of v, r, m, d and its constants
    constants : (name, SI value, dimension), ...
    tension_cut : no force that pulls the floors together

    Raises
    ------
    FormulaError : what the formula says cannot be solved
    """

    closings: ClassVar[tuple[float, ...]] = _PRESSED
    subtracts_gap = True
    behaviour = WRITTEN_BEHAVIOUR

    called: str = ""
    formula: str = ""
    constants: tuple[tuple[str, float, Dimension], ...] = ()
    tension_cut: bool = False

    @property
    def name(self) -> str:  # type: ignore[override]  # of the study, not of the class
        """As the study calls it."""
        return self.called

    def __post_init__(self) -> None:
        super().__post_init__()
        self.force(1.0)

    def force(self, mass: float) -> Formula:
        """Its force where the reduced mass of the floors is `mass` [kg]."""
        return _read(self.formula, self.constants, mass, self.gap, self.closings)

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """Parameters of `laws.pounding`: of a straight force its line."""
        force = self.force(reduced_mass(left_mass, right_mass))
        k = c = f0 = 0.0
        if force.is_straight:
            f0 = float(force.at(0.0, 0.0))
            k, c = float(force.at(1.0, 0.0)) - f0, float(force.at(0.0, 1.0)) - f0
        return k, c, float(self.tension_cut), f0, float(not force.is_straight), float(self.joins)

    @property
    def damped(self) -> bool:
        """Where its force depends on the rate."""
        force = self.force(1.0)
        return any(float(force.at(v, 1.0)) != float(force.at(v, 0.0)) for v in self.closings)

    @property
    def cut(self) -> bool:
        """As it says."""
        return self.tension_cut

    @property
    def is_linear(self) -> bool:
        """Of a joint, where the formula is straight."""
        return super().is_linear or (self.joins and self.force(1.0).is_straight)

    @property
    def steepest(self) -> tuple[float, float]:
        """At a closing of `PRESSED`; its dashpot at rest, or up to 1 m/s where that is more."""
        closings, rates = np.array([1.0, 0.999, 1.0, 1.0]) * PRESSED, np.array([0.0, 0.0, 1.0, 1e-6])
        here, before, moving, still = self.force(1.0).at(closings, rates).tolist()
        return (here - before) / (0.001 * PRESSED), max(moving - here, (still - here) * 1e6, 0.0)

    def stored(self, closing: float, force: float) -> float:
        """The work of its force, pressed slowly from where it begins to act [J]. With v = x^4 powers of v by quarters
        are polynomials in x, which the rule integrates exactly."""
        v = closing - self.offset
        if v <= 0.0 and not self.joins:
            return 0.0
        x, weight = np.polynomial.legendre.leggauss(24)
        x = 0.5 * abs(v) ** 0.25 * (x + 1.0)
        pressed = self.force(1.0).at(math.copysign(1.0, v) * x**4, np.zeros_like(x))
        return float(0.5 * abs(v) ** 0.25 * math.copysign(1.0, v) * np.sum(weight * 4.0 * x**3 * pressed))


@dataclass(frozen=True)
class WrittenFilling(WrittenLaw):
    """F = the formula while the material that fills the gap is pressed; v is the closing."""

    drawn = "filling"
    subtracts_gap = False
    beyond_gap = "material of a law of the study compressed beyond its thickness"


@dataclass(frozen=True)
class WrittenJoint(WrittenLaw):
    """F = the formula at all times; v is the closing, of either sign."""

    closings = _BOTH_WAYS
    drawn = "bar"
    subtracts_gap = False
    beyond_gap = "joint of a law of the study closes more than the gap, so the floors would have struck"
    meaningless = True
    joins = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.tension_cut:
            raise FormulaError("a law that acts always may pull", "leave `tension_cut` out")
        still = float(self.force(1.0).at(0.0, 0.0))
        if still != 0.0:
            raise FormulaError(f"the force at rest, v = r = 0, is {still:g} N", "let it be zero there")


WRITTEN: Mapping[str, type[WrittenLaw]] = {
    "beyond gap": WrittenLaw,
    "compression": WrittenFilling,
    "always": WrittenJoint,
}
"""By when they act."""


@functools.lru_cache(maxsize=4096)
def _read(
    formula: str,
    constants: tuple[tuple[str, float, Dimension], ...],
    mass: float,
    gap: float,
    closings: tuple[float, ...],
) -> Formula:
    known = {name: Term(value, dimension) for name, value, dimension in constants}
    return read(formula, {**known, "m": Term(mass, GIVEN["m"][0]), "d": Term(gap, GIVEN["d"][0])}, closings)
