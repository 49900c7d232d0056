"""Forces of links that a study writes as formulas, such as `k*v + k3*v**3 + c*r`.

Python's parser reads a formula, but it is never run as Python; its units are checked. It becomes a short table of
operations on numbers, which the solver carries out: no formula is compiled.
"""

from __future__ import annotations

import ast
import functools
import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.laws.law import REFERENCE_CLOSING, Behaviour, LinkLaw
from pounding_cli.laws.pounding import next_pounding_branch, reduced_mass
from pounding_cli.units import Dimension

MAX_FORMULA_LENGTH = 500
"""Characters of a formula."""

MAX_OPERATIONS = 200
"""Operations of a formula."""

DIMENSIONLESS: Dimension = (0.0, 0.0, 0.0)
FORCE_DIMENSION: Dimension = (1.0, 1.0, -2.0)

FORMULA_VARIABLES: Mapping[str, Dimension] = {
    "v": (0.0, 1.0, 0.0), "r": (0.0, 1.0, -1.0), "m": (1.0, 0.0, 0.0), "d": (0.0, 1.0, 0.0),
}  # fmt: skip
"""Dimensions of the variables of every formula: closing, its rate, reduced mass of the floors, gap."""

_ALLOWED = f"a formula is made of numbers, {', '.join(FORMULA_VARIABLES)}, parameters, + - * / **, brackets and sqrt()"

Constants = tuple[tuple[str, float, Dimension], ...]
"""Parameters of a formula: name, SI value, dimension."""


_NUMBER, _PLUS, _TIMES, _POWER = range(4)
"""Codes of operations on registers x and y and the number a, which give a; x + y; x y; x^a.

x^a is 0 where a is no whole number and x is below zero. Registers 0 and 1 hold v [m] and v' [m/s], and each operation
fills the next one.
"""

Operation = tuple[float, float, float, float]
"""An operation: (code, x, y, a)."""


def evaluate_operations(formula: Any, v: float, r: float) -> float:
    """Return the result of `count` operations at a closing [m] and its rate [m/s]."""
    operations = formula.operations
    registers = formula.registers
    registers[0] = v
    registers[1] = r
    for i in range(formula.count):
        code = operations[i, 0]
        x = registers[int(operations[i, 1])]
        y = registers[int(operations[i, 2])]
        a = operations[i, 3]
        if code == _PLUS:
            a = x + y
        elif code == _TIMES:
            a = x * y
        elif code == _POWER:
            a = 0.0 if x < 0.0 and a != int(a) else x**a
        registers[i + 2] = a
    return registers[formula.result]


@dataclass(frozen=True)
class Formula:
    """Operations of a formula.

    rows : the operations, in order
    result : register that holds the result in the end
    is_straight : True where the result is straight in v and r
    """

    rows: tuple[Operation, ...]
    result: int
    is_straight: bool = False

    def evaluate(self, v: float, r: float) -> float:
        """Return the result at a closing [m] and its rate [m/s]."""
        room = SimpleNamespace(count=len(self.rows), result=self.result)
        room.operations = np.reshape(self.rows, (-1, 4))
        room.registers = np.zeros(2 + len(self.rows))
        with np.errstate(all="ignore"):
            return float(evaluate_operations(room, v, r))


@dataclass(frozen=True)
class Term:
    """A part of a formula.

    register : register that holds its value
    dimension : its dimension
    degree : degree in v and r: 0, 1, or 2 where it is not straight in them
    """

    register: int
    dimension: Dimension
    degree: int = 0


@functools.lru_cache(maxsize=4096)
def parse_formula(text: str, constants: Constants, mass: float, gap: float, closings: tuple[float, ...]) -> Formula:
    """Return the operations of a formula that gives a force [N].

    Parameters
    ----------
    text : the formula as written
    constants : its parameters
    mass, gap : m [kg] and d [m]
    closings : [m] at which what stands under a root has to be above zero, at any rate

    Raises
    ------
    InputError : it is not a formula, or its unit is not N
    """
    text = text.strip()
    if len(text) > MAX_FORMULA_LENGTH:
        raise InputError(f"the formula has {len(text)} characters", f"write at most {MAX_FORMULA_LENGTH}")
    try:
        tree = ast.parse(text, mode="eval").body
    except SyntaxError as error:
        offset = max((error.offset or 1) - 1, 0) if error.lineno in (None, 1) else 0
        raise InputError(Issue((), f"'{text}' is not a formula", _ALLOWED, offset=offset)) from None
    except (ValueError, RecursionError, MemoryError):
        raise InputError("this is not a formula", _ALLOWED) from None
    quantities = {name: (value, dimension) for name, value, dimension in constants}
    quantities["m"] = (mass, FORMULA_VARIABLES["m"])
    quantities["d"] = (gap, FORMULA_VARIABLES["d"])
    parser = _FormulaParser(text, quantities, closings)
    term = parser.parse_node(tree)
    if term.dimension != FORCE_DIMENSION:
        message = f"the formula gives {format_dimension(term.dimension)}, not N"
        raise InputError(message, "correct it or a parameter's unit")
    return Formula(tuple(parser.rows), term.register, term.degree < 2)


def format_dimension(dimension: Dimension) -> str:
    """Return a dimension in SI units, such as `kg m s^-2`."""
    powers = zip(("kg", "m", "s"), dimension, strict=True)
    parts = [unit if power == 1 else f"{unit}^{power:g}" for unit, power in powers if power]
    return "N" if dimension == FORCE_DIMENSION else " ".join(parts) or "a plain number"


class _FormulaParser:
    """Parser of one formula.

    text : the formula
    quantities : name -> value [SI] and dimension of what it may use besides v and r
    closings : as in `parse_formula`
    rows : the operations so far
    """

    def __init__(
        self,
        text: str,
        quantities: Mapping[str, tuple[float, Dimension]],
        closings: tuple[float, ...],
    ) -> None:
        self.text = text
        self.quantities = quantities
        self.closings = closings
        self.rows = list[Operation]()

    def quote(self, node: ast.expr) -> str:
        """Return the text of a node, in quotes."""
        return f"'{ast.get_source_segment(self.text, node)}'"

    def error_at(self, node: ast.expr, message: str, hint: str = _ALLOWED) -> InputError:
        """Return the error of a node; the message goes on behind its text."""
        offset = node.col_offset if node.lineno == 1 else 0
        return InputError(Issue((), f"{self.quote(node)} {message}", hint, offset=offset))

    def parse_node(self, node: ast.expr) -> Term:
        """Return the term of a node; any node not named here is refused."""
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return self.add_operation(node, DIMENSIONLESS, 0, _NUMBER, a=float(number))
            case ast.Name(id="v" | "r" as name):
                return Term(0 if name == "v" else 1, FORMULA_VARIABLES[name], 1)
            case ast.Name(id=name) if name in self.quantities:
                value, dimension = self.quantities[name]
                return self.add_operation(node, dimension, 0, _NUMBER, a=value)
            case ast.Name():
                names = ", ".join(dict.fromkeys((*FORMULA_VARIABLES, *self.quantities)))
                hint = f"give it under `parameters`; known: {names}"
                raise self.error_at(node, "is not known", hint)
            case ast.UnaryOp(op=ast.UAdd(), operand=inner):
                return self.parse_node(inner)
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return self.multiply(node, self.parse_node(inner), -1.0)
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                return self.parse_sum(node)
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                return self.multiply(node, self.parse_node(left), self.parse_node(right))
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                return self.multiply(node, self.parse_node(left), self.raise_to_power(right, -1.0))
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                exponent = self.parse_node(right)
                if exponent.degree or exponent.dimension != DIMENSIONLESS:
                    raise self.error_at(right, "is a power but not a plain number", "write a number")
                return self.raise_to_power(left, self.rows[exponent.register - 2][3])
            case ast.Call(func=ast.Name(id="sqrt"), args=[inner], keywords=[]):
                return self.raise_to_power(inner, 0.5)
        raise self.error_at(node, "is not allowed in a formula")

    def parse_sum(self, node: ast.BinOp) -> Term:
        """Return the term of a sum or a difference.

        Raises
        ------
        InputError : its parts have different units
        """
        left = self.parse_node(node.left)
        right = self.parse_node(node.right)
        if left.dimension != right.dimension:
            left_unit = format_dimension(left.dimension)
            right_unit = format_dimension(right.dimension)
            message = f"is in {left_unit}, {self.quote(node.right)} in {right_unit}"
            raise self.error_at(node.left, message, "add what has one unit")
        if isinstance(node.op, ast.Sub):
            right = self.multiply(node, right, -1.0)
        degree = max(left.degree, right.degree)
        return self.add_operation(node, left.dimension, degree, _PLUS, x=left.register, y=right.register)

    def add_operation(
        self,
        node: ast.expr,
        dimension: Dimension,
        degree: int,
        code: int,
        x: int = 0,
        y: int = 0,
        a: float = 0.0,
    ) -> Term:
        """Add an operation on registers x and y and return its term.

        An operation on constants becomes a constant; equal operations are added once.
        """
        row: Operation = (float(code), float(x), float(y), a)
        if not degree:
            number = Formula((*self.rows, row), 2 + len(self.rows)).evaluate(0.0, 0.0)
            if not math.isfinite(number):
                raise self.error_at(node, "does not give a finite number", "correct it")
            row = (float(_NUMBER), 0.0, 0.0, number)
        if row not in self.rows:
            self.rows.append(row)
        if len(self.rows) > MAX_OPERATIONS:
            message = f"the formula has more than {MAX_OPERATIONS} operations"
            raise InputError(message, "write a shorter one")
        return Term(2 + self.rows.index(row), dimension, degree)

    def multiply(self, node: ast.expr, one: Term, other: Term | float) -> Term:
        """Return the product of two terms, or of a term and a number."""
        if isinstance(other, float):
            other = self.add_operation(node, DIMENSIONLESS, 0, _NUMBER, a=other)
        dimension = _add_powers(one.dimension, other.dimension)
        degree = min(one.degree + other.degree, 2)
        return self.add_operation(node, dimension, degree, _TIMES, one.register, other.register)

    def raise_to_power(self, node: ast.expr, exponent: float) -> Term:
        """Return a node to a power.

        Arguments of roots, and divisors that vary, have to be above zero; for v itself it is enough that the law acts
        in compression alone.
        """
        base = self.parse_node(node)
        is_pressed_closing = base.register == 0 and exponent > 0.0 and min(self.closings) >= 0.0
        needs_positive_base = not exponent.is_integer() or (base.degree > 0 and exponent < 0.0)
        if needs_positive_base and not is_pressed_closing:
            formula = Formula(tuple(self.rows), base.register)
            for v, r in itertools.product(self.closings, (-3.0, -0.1, 0.0, 0.1, 3.0)):
                if not formula.evaluate(v, r) > 0.0:
                    message = f"is not above zero at v = {v:g} m, r = {r:g} m/s"
                    hint = "divisors and arguments of roots and fractional powers must stay above zero"
                    raise self.error_at(node, message, f"{hint}; of v itself write v**1.5")
        dimension = _add_powers(DIMENSIONLESS, base.dimension, exponent)
        degree = 2 if base.degree else 0
        return self.add_operation(node, dimension, degree, _POWER, base.register, a=exponent)


def _add_powers(one: Dimension, other: Dimension, times: float = 1.0) -> Dimension:
    """Return the powers of `one` plus `times` those of `other`."""
    mass, length, time = (round(x + times * y, 9) + 0.0 for x, y in zip(one, other, strict=True))
    return mass, length, time


_PRESSED = (0.0, 1e-6, 1e-3, 0.01, 0.1)
_BOTH_WAYS = (*(-v for v in _PRESSED[1:]), *_PRESSED)


def zero_force(e: Any, v: float, r: float) -> float:
    """Return no force: the solver carries out the operations (`solver.dispatch`)."""
    return 0.0


WRITTEN_BEHAVIOUR = Behaviour(next_pounding_branch, zero_force)


@dataclass(frozen=True)
class WrittenLaw(LinkLaw):
    """F = the formula, once the gap has closed; v is the closing less the gap.

    called : its name
    formula : its force [N] of v, r, m, d and its constants
    tension_cut : no force that pulls the floors together

    Raises
    ------
    InputError : what the formula says cannot be solved
    """

    closings: ClassVar[tuple[float, ...]] = _PRESSED
    subtracts_gap = True
    behaviour = WRITTEN_BEHAVIOUR

    called: str = ""
    formula: str = ""
    constants: Constants = ()
    tension_cut: bool = False

    @property
    def name(self) -> str:  # type: ignore[override]  # of the study, not of the class
        """Name that the study gives it."""
        return self.called

    def __post_init__(self) -> None:
        super().__post_init__()
        self.force(1.0)

    def force(self, mass: float) -> Formula:
        """Return its force where the reduced mass of the floors is `mass` [kg]."""
        return parse_formula(self.formula, self.constants, mass, self.gap, self.closings)

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """Return the parameters of `laws.pounding`: for a straight force those of its line."""
        force = self.force(reduced_mass(left_mass, right_mass))
        k = 0.0
        c = 0.0
        f0 = 0.0
        if force.is_straight:
            f0 = force.evaluate(0.0, 0.0)
            k = force.evaluate(1.0, 0.0) - f0
            c = force.evaluate(0.0, 1.0) - f0
        is_smooth = not force.is_straight
        return k, c, float(self.tension_cut), f0, float(is_smooth), float(self.joins)

    def scale(self, share: float) -> WrittenLaw:
        """Return the law with so much of its force."""
        return replace(self, formula=f"{share!r}*({self.formula})")

    @functools.cached_property
    def is_damped(self) -> bool:
        """True where its force depends on the rate."""
        force = self.force(1.0)
        return any(force.evaluate(v, 1.0) != force.evaluate(v, 0.0) for v in self.closings)

    @property
    def cuts_tension(self) -> bool:
        """True where the study cuts its tension."""
        return self.tension_cut

    @property
    def max_slopes(self) -> tuple[float, float]:
        """Stiffness and dashpot at a closing of `REFERENCE_CLOSING`.

        The dashpot is that at rest, or the mean up to 1 m/s where that is more.
        """
        force = self.force(1.0)
        force_here = force.evaluate(REFERENCE_CLOSING, 0.0)
        force_before = force.evaluate(0.999 * REFERENCE_CLOSING, 0.0)
        stiffness = (force_here - force_before) / (0.001 * REFERENCE_CLOSING)
        dashpot_moving = force.evaluate(REFERENCE_CLOSING, 1.0) - force_here
        dashpot_at_rest = (force.evaluate(REFERENCE_CLOSING, 1e-6) - force_here) * 1e6
        return stiffness, max(dashpot_moving, dashpot_at_rest, 0.0)

    def stored_energy(self, closing: float, force: float) -> float:
        """Return the work of its force, pressed slowly from where it begins to act [J].

        With v = x^4 powers of v by quarters are polynomials in x, which Gauss's rule integrates exactly.
        """
        v = closing - self.offset
        if v <= 0.0 and not self.joins:
            return 0.0
        half = 0.5 * abs(v) ** 0.25
        way = math.copysign(1.0, v)
        x, weight = np.polynomial.legendre.leggauss(24)
        law_force = self.force(1.0)
        forces = [law_force.evaluate(way * (half * (each + 1.0)) ** 4, 0.0) for each in x]
        return float(half * way * np.sum(weight * 4.0 * (half * (x + 1.0)) ** 3 * forces))


@dataclass(frozen=True)
class WrittenFilling(WrittenLaw):
    """F = the formula while the material that fills the gap is pressed; v is the closing."""

    symbol = "filling"
    subtracts_gap = False
    beyond_gap = "crushed"


@dataclass(frozen=True)
class WrittenJoint(WrittenLaw):
    """F = the formula at all times; v is the closing, of either sign."""

    closings = _BOTH_WAYS
    symbol = "bar"
    subtracts_gap = False
    beyond_gap = "struck"
    joins = True

    def soften(self, flexibility: float) -> WrittenJoint:
        """Return the law itself: what of its formula is a spring is not known."""
        return self

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.tension_cut:
            raise InputError("a law that acts always may pull", "leave `tension_cut` out")
        force_at_rest = self.force(1.0).evaluate(0.0, 0.0)
        if force_at_rest != 0.0:
            message = f"the force at rest, v = r = 0, is {force_at_rest:g} N"
            raise InputError(message, "let it be zero there")


WRITTEN_LAWS: Mapping[str, type[WrittenLaw]] = {
    "beyond gap": WrittenLaw,
    "compression": WrittenFilling,
    "always": WrittenJoint,
}
"""`acts` of a law of a study -> its type."""
