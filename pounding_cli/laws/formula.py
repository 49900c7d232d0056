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

from pounding_cli.laws.dashpot import reduced_mass
from pounding_cli.laws.guards import FORCE as FORCE_GUARD
from pounding_cli.laws.guards import LOW, START
from pounding_cli.laws.law import PRESSED, Behaviour, LinkLaw, line, opened

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


MOST_OPERATIONS = 250
"""A formula of `LONGEST` characters has no more."""


@dataclass(frozen=True)
class Expression:
    """What a formula makes of v and r.

    operation : how it is made of its parts; None of v (number 0) and r (number 1) themselves
    """

    operation: Operation | None
    parts: tuple[Expression, ...] = ()
    number: float = 0.0

    def __add__(self, other: Expression | float) -> Expression:
        return Expression(Operation.PLUS, (self, _expression(other)))

    __radd__ = __add__

    def __mul__(self, other: Expression | float) -> Expression:
        return Expression(Operation.TIMES, (self, _expression(other)))

    __rmul__ = __mul__

    def __neg__(self) -> Expression:
        return self * -1.0

    def __sub__(self, other: Expression | float) -> Expression:
        return self + -1.0 * other

    def __rsub__(self, other: float) -> Expression:
        return -self + other

    def __pow__(self, exponent: float) -> Expression:
        return Expression(Operation.POWER, (self,), float(exponent))

    def at(self, v: Any, r: Any) -> Any:
        """Its value at closings [m] and rates [m/s]; numbers or arrays of one shape."""
        if self.operation is None:
            return r if self.number else v
        parts = [part.at(v, r) for part in self.parts]
        if self.operation is Operation.NUMBER:
            return self.number
        if self.operation is Operation.PLUS:
            return parts[0] + parts[1]
        if self.operation is Operation.TIMES:
            return parts[0] * parts[1]
        return power_of(parts[0], self.number)

    @property
    def is_straight(self) -> bool:
        """Whether it is straight in v and r."""
        if self.operation is Operation.TIMES:
            return any(part.operation is Operation.NUMBER for part in self.parts) and self._has_straight_parts
        return self.operation is not Operation.POWER and self._has_straight_parts

    @property
    def _has_straight_parts(self) -> bool:
        return all(part.is_straight for part in self.parts)


CLOSING, RATE = Expression(None, number=0.0), Expression(None, number=1.0)
"""v [m] and r = v' [m/s]."""


def _expression(value: Expression | float) -> Expression:
    return value if isinstance(value, Expression) else Expression(Operation.NUMBER, number=float(value))


def power_of(x: Any, exponent: float) -> Any:
    """x^exponent; 0 where x is below zero and the exponent is no whole number."""
    if float(exponent).is_integer():
        return np.float64(x) ** exponent
    with np.errstate(divide="ignore"):
        return np.maximum(x, 0.0) ** exponent


def operations(force: Expression) -> list[tuple[float, float, float, float]]:
    """The operations (code, x, y, a) of a force, whose last one is the force; what is used twice is made once."""
    done: list[tuple[float, float, float, float]] = []
    places: dict[Expression, int] = {CLOSING: 0, RATE: 1}

    def place(part: Expression) -> int:
        if part not in places:
            x, y = (*(place(each) for each in part.parts), 0, 0)[:2]
            assert part.operation is not None
            done.append((float(part.operation), float(x), float(y), part.number))
            places[part] = 1 + len(done)
        return places[part]

    if place(force) < 2:
        place(force * 1.0)
    return done


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
    return _expression(term.value)


def in_units(dimension: Dimension) -> str:
    """A dimension in SI units, such as `kg m/s^2`."""
    parts = [
        unit if power == 1 else f"{unit}^{power:g}" for unit, power in zip(("kg", "m", "s"), dimension, strict=True)
        if power
    ]  # fmt: skip
    return "N" if dimension == FORCE else " ".join(parts) or "a plain number"


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


_PRESSED = (0.0, 1e-6, 1e-3, 0.01, 0.1)
_BOTH_WAYS = (*(-v for v in _PRESSED[1:]), *_PRESSED)

K, C, F0, SMOOTH, JOINS, CUTS, FIRST, LAST = range(8)
"""Parameters: of a straight force its line [N/m, N s/m, N]; 1 where the formula is carried out; 1 where it acts at all
closings; 1 where no force pulls; its first operation in the table of the scene and the one after its last."""

OPEN, CLOSED, PULLING = range(3)
"""Branches; PULLING is closed without a force."""


def next_branch(e: Any, guard: int) -> None:
    """Open and in contact, or one branch without end."""
    joins = e.p[JOINS] > 0.0
    if not joins and (guard == START or guard == LOW):
        opened(e)
        return
    e.branch = PULLING if guard == FORCE_GUARD and e.branch == CLOSED else CLOSED
    line(e, e.p[K], e.p[C], e.p[F0], -math.inf if joins else 0.0, math.inf)
    e.smooth = 1 if e.p[SMOOTH] > 0.0 else 0
    e.cuts = 1 if e.p[CUTS] > 0.0 else 0
    e.acts = 1 if e.branch == CLOSED else 0


def force(e: Any, v: float, r: float) -> float:
    """Nothing: the solver carries out the operations (`solver.dispatch`)."""
    return 0.0


WRITTEN_BEHAVIOUR = Behaviour(next_branch, force)


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
    subtracts_gap: ClassVar[bool] = True
    behaviour: ClassVar[Behaviour] = WRITTEN_BEHAVIOUR

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

    def force(self, mass: float) -> Expression:
        """Its force [N] where the reduced mass of the floors is `mass` [kg]."""
        return _read(self.formula, self.constants, mass, self.gap, self.closings)

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """As the parameters above."""
        force = self.force(reduced_mass(left_mass, right_mass))
        k = c = f0 = 0.0
        if force.is_straight:
            f0 = float(force.at(0.0, 0.0))
            k, c = float(force.at(1.0, 0.0)) - f0, float(force.at(0.0, 1.0)) - f0
        return k, c, f0, float(not force.is_straight), float(self.joins), float(self.tension_cut)

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
        force = self.force(1.0)
        here, before, moving, still = (
            float(force.at(*at)) for at in ((PRESSED, 0.0), (0.999 * PRESSED, 0.0), (PRESSED, 1.0), (PRESSED, 1e-6))
        )
        return (here - before) / (0.001 * PRESSED), max(moving - here, (still - here) * 1e6, 0.0)

    def stored(self, closing: float, force: float) -> float:
        """The work of its force, pressed slowly from where it begins to act [J]. With v = x^4 powers of v by quarters
        are polynomials in x, which the rule integrates exactly."""
        v = closing - self.offset
        if v <= 0.0 and not self.joins:
            return 0.0
        x, weight = np.polynomial.legendre.leggauss(24)
        x = 0.5 * abs(v) ** 0.25 * (x + 1.0)
        pressed = np.broadcast_to(self.force(1.0).at(math.copysign(1.0, v) * x**4, np.zeros_like(x)), x.shape)
        return float(0.5 * abs(v) ** 0.25 * math.copysign(1.0, v) * np.sum(weight * 4.0 * x**3 * pressed))


@dataclass(frozen=True)
class WrittenFilling(WrittenLaw):
    """F = the formula while the material that fills the gap is pressed; v is the closing."""

    drawn: ClassVar[str] = "filling"
    subtracts_gap: ClassVar[bool] = False
    beyond_gap: ClassVar[str] = "material of a law of the study compressed beyond its thickness"


@dataclass(frozen=True)
class WrittenJoint(WrittenLaw):
    """F = the formula at all times; v is the closing, of either sign."""

    closings: ClassVar[tuple[float, ...]] = _BOTH_WAYS
    drawn: ClassVar[str] = "bar"
    subtracts_gap: ClassVar[bool] = False
    beyond_gap: ClassVar[str] = "joint of a law of the study closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True
    joins: ClassVar[bool] = True

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
) -> Expression:
    known = {name: Term(value, dimension) for name, value, dimension in constants}
    return read(formula, {**known, "m": Term(mass, GIVEN["m"][0]), "d": Term(gap, GIVEN["d"][0])}, closings)
