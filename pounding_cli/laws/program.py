"""A force as operations: what a law writes where a straight line and a cubic are not enough.

A law writes its force as arithmetic on `CLOSING`, `RATE` and `MEMORY`. The expression becomes a short list of
operations, which is data: kernels carry it out order by order on truncated series, so that a new force needs no new
compiled code, and this module carries it out on numbers.

Powers of the closing such as v^(3/2) have no Taylor series at v = 0. With q = v^(1/b) they are whole powers of q
(shared with `kernels.program`): a branch says b, and gets a second list of operations written in q."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np


class Operation(IntEnum):
    """What an operation makes of the registers x and y with the numbers a, b, c."""

    LINEAR = 0  # a x + b y + c
    PRODUCT = 1  # a x y
    POWER = 2  # a x^b, where x stays above zero
    KEEP = 3  # x goes to the memory of number y


MEMORIES = 14
"""Numbers that a law may remember of events."""

GIVEN = 3 + MEMORIES
"""Registers that are given: closing, rate, memories, and q where the closing is written so. Operation n fills register
GIVEN + n; the last one is the force."""

MOST_REGISTERS = 160
"""Registers that a force, or what is remembered of an event, may need."""

_CLOSING, _RATE, _MEMORY, _ROOT = 0, 1, 2, GIVEN - 1

Step = tuple[Operation, int, int, float, float, float]
"""An operation: code, registers x and y, numbers a, b, c."""


@dataclass(frozen=True)
class Expression:
    """A force, or a part of it. It takes +, -, *, / and powers with numbers and other expressions.

    Parameters
    ----------
    operation : how it is made; None of a given register
    register : the given register, where it is one
    parts : the expressions it is made of
    numbers : a, b, c of the operation
    """

    operation: Operation | None = None
    register: int = 0
    parts: tuple[Expression, ...] = ()
    numbers: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        """Of every part once: an expression may hold another many times over."""
        return hash((self.operation, self.register, self.parts, self.numbers))

    def __add__(self, other: Expression | float) -> Expression:
        if isinstance(other, Expression):
            return Expression(Operation.LINEAR, parts=(self, other), numbers=(1.0, 1.0, 0.0))
        return Expression(Operation.LINEAR, parts=(self, self), numbers=(1.0, 0.0, float(other)))

    __radd__ = __add__

    def __mul__(self, other: Expression | float) -> Expression:
        if isinstance(other, Expression):
            return Expression(Operation.PRODUCT, parts=(self, other), numbers=(1.0, 0.0, 0.0))
        return Expression(Operation.LINEAR, parts=(self, self), numbers=(float(other), 0.0, 0.0))

    __rmul__ = __mul__

    def __neg__(self) -> Expression:
        return self * -1.0

    def __sub__(self, other: Expression | float) -> Expression:
        return self + (-1.0 * other)

    def __rsub__(self, other: float) -> Expression:
        return -self + other

    def __pow__(self, exponent: float) -> Expression:
        if float(exponent).is_integer() and 1 <= exponent <= 8:
            product = self
            for _ in range(int(exponent) - 1):
                product = product * self
            return product
        return Expression(Operation.POWER, parts=(self,), numbers=(1.0, float(exponent), 0.0))

    def __truediv__(self, other: Expression | float) -> Expression:
        if isinstance(other, Expression):
            return self * Expression(Operation.POWER, parts=(other,), numbers=(1.0, -1.0, 0.0))
        return self * (1.0 / other)

    @cached_property
    def given(self) -> frozenset[int]:
        """The given registers that it is made of."""
        if self.operation is None:
            return frozenset((self.register,))
        return self.parts[0].given | self.parts[-1].given

    def at(self, closing: Any, rate: Any, *memory: Any) -> Any:
        """Its value at closings v [m], rates [m/s] and memories; numbers or arrays of one shape, memories not given are
        zero. What is multiplied by zero is zero, also where the other factor is infinite: v' / v0 of floors at rest."""
        if self.operation is None:
            given = (closing, rate, *memory)
            return given[self.register] if self.register < len(given) else 0.0
        x = self.parts[0].at(closing, rate, *memory)
        a, b, c = self.numbers
        if self.operation is Operation.POWER:
            with np.errstate(divide="ignore"):
                return a * np.maximum(x, 0.0) ** b if b else a * np.greater(x, 0.0)
        y = self.parts[-1].at(closing, rate, *memory)
        if self.operation is Operation.LINEAR:
            return a * x + b * y + c
        with np.errstate(invalid="ignore"):
            return np.where((x == 0.0) | (y == 0.0), 0.0, a * x * y)


CLOSING = Expression(register=_CLOSING)
"""The closing v of the floors [m], less the gap where the law says so."""

RATE = Expression(register=_RATE)
"""v' [m/s]."""


def memory(number: int) -> Expression:
    """What is remembered of events under a number from 0 to before `MEMORIES` (`law.Guard.sets`)."""
    if not 0 <= number < MEMORIES:
        raise ValueError(f"memory {number}: there are {MEMORIES}, from 0")
    return Expression(register=_MEMORY + number)


MEMORY = memory(0)
"""What a link remembers of an event: a closing [m], say, or a rate [m/s]."""

DRIFT = CLOSING
"""The drift of a storey [m], which its law acts on."""

_Q = Expression(register=_ROOT)


def square_root(of: Expression) -> Expression:
    """The square root of what stays above zero."""
    return of**0.5


def positive_part(of: Expression) -> Expression:
    """max(x, 0). It has a corner at zero: for what is remembered of an event, not for forces."""
    return Expression(Operation.POWER, parts=(of,), numbers=(1.0, 1.0, 0.0))


def above_zero(of: Expression) -> Expression:
    """1 where x > 0, else 0; likewise."""
    return Expression(Operation.POWER, parts=(of,), numbers=(1.0, 0.0, 0.0))


def larger(one: Expression, other: Expression | float) -> Expression:
    """The larger of two; likewise."""
    return positive_part(one - other) + other


def smaller(one: Expression, other: Expression | float) -> Expression:
    """The smaller of two; likewise."""
    return one - positive_part(one - other)


def operations(force: Expression, root: int = 1) -> tuple[Step, ...]:
    """The operations of a force, the last of which is the force.

    Parameters
    ----------
    root : b of q = v^(1/b): powers of the closing are written as whole powers of q; 1 leaves them as they are

    Raises
    ------
    ValueError : a power of the closing is not a whole power of q, or the force is too long
    """
    program = _Program(root)
    program.end_with(force)
    return program.steps()


def flowing(force: Expression, flow: Expression) -> tuple[tuple[Step, ...], int]:
    """(the operations of a force and of the rate at which its memory flows, the last of which is the force; the
    register of that rate)."""
    program = _Program()
    register = program.register(flow)
    program.end_with(force)
    return program.steps(), register


class _Program:
    """Operations as they are written: what several expressions share is made once."""

    def __init__(self, root: int = 1) -> None:
        self.root = root
        self.done: list[Step] = []
        self.places: dict[Step, int] = {}
        self.known: dict[int, tuple[int, Expression]] = {}
        """Register and expression by its id, which is quicker than its parts."""

    def register(self, part: Expression) -> int:
        """The register that holds an expression."""
        if id(part) in self.known:
            return self.known[id(part)][0]
        written = _in_root(part, self.root) if self.root > 1 else part
        if written.operation is None:
            return written.register
        x, y = self.register(written.parts[0]), self.register(written.parts[-1])
        step: Step = (written.operation, x, y, *written.numbers)
        if step not in self.places:
            self.done.append(step)
            self.places[step] = GIVEN + len(self.done) - 1
        self.known[id(part)] = self.places[step], part
        return self.places[step]

    def end_with(self, part: Expression) -> None:
        """Have an expression in the last register: what is given, or made before another, is copied there."""
        if self.register(part) != GIVEN + len(self.done) - 1:
            self.done.append((Operation.LINEAR, self.register(part), 0, 1.0, 0.0, 0.0))

    def steps(self) -> tuple[Step, ...]:
        """What is written.

        Raises
        ------
        ValueError : it is too long
        """
        if GIVEN + len(self.done) > MOST_REGISTERS:
            raise ValueError(f"{len(self.done)} operations are more than {MOST_REGISTERS - GIVEN}")
        return tuple(self.done)


def kept(sets: tuple[tuple[int, Expression], ...]) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """The operations that make what is remembered of an event, and those that then keep it: (number of the memory, what
    goes there), ... All are made of the memories as they were."""
    program = _Program()
    places = tuple((Operation.KEEP, program.register(what), number, 0.0, 0.0, 0.0) for number, what in sets)
    return program.steps(), places


def straight(value: Expression | float) -> tuple[float, float, int]:
    """(constant, factor, number of a memory) of what is a constant plus a multiple of one memory.

    Raises
    ------
    ValueError : it is anything else
    """
    if not isinstance(value, Expression):
        return float(value), 0.0, 0
    constant = float(value.at(0.0, 0.0))
    found = constant, 0.0, 0
    for number in sorted(register - _MEMORY for register in value.given - {_CLOSING, _RATE}):
        if found[1]:
            break
        one = [float(n == number) for n in range(MEMORIES)]
        found = constant, float(value.at(0.0, 0.0, *one)) - constant, number
    probe = [1.7 + n for n in range(MEMORIES)]
    expected = found[0] + found[1] * probe[found[2]]
    if value.given & {_CLOSING, _RATE} or abs(value.at(0.0, 0.0, *probe) - expected) > 1e-9 * abs(expected):
        raise ValueError(
            "a coefficient of a branch is a number plus a multiple of one memory; set a memory to the rest"
        )
    return found


def _in_root(part: Expression, root: int) -> Expression:
    """A power of the closing as a whole power of q; anything else as it is."""
    if part.operation is not Operation.POWER or part.parts[0] != CLOSING:
        return part
    a, exponent, _ = part.numbers
    whole = round(exponent * root)
    if whole < 1 or abs(exponent * root - whole) > 1e-9:
        raise ValueError(f"v^{exponent:g} is not a whole power of v^(1/{root})")
    power = whole_power(_Q, whole)
    return power if a == 1.0 else a * power


def whole_power(of: Expression, exponent: int) -> Expression:
    """A power from 1 on as products, so that it has a series at zero too."""
    made = {1: of}

    def power(n: int) -> Expression:
        """By squares, which are shared."""
        if n not in made:
            made[n] = power(n // 2) * power(n - n // 2)
        return made[n]

    return power(exponent)


def carried_out(steps: np.ndarray, closing: np.ndarray, rate: np.ndarray, memory: np.ndarray) -> np.ndarray:
    """What operations make of closings, rates and memories, arrays of one shape; powers of what is not above zero are
    zero.

    steps : an operation a row, as `operations` gives them
    """
    registers = [closing, rate, memory, *(np.zeros_like(closing) for _ in range(GIVEN - 3))]
    for code, x, y, a, b, c in steps:
        first, second = registers[int(x)], registers[int(y)]
        if code == Operation.LINEAR:
            registers.append(a * first + b * second + c)
        elif code == Operation.PRODUCT:
            registers.append(a * first * second)
        else:
            registers.append(a * np.where(first > 0.0, first, 1.0) ** b * (first > 0.0))
    return registers[-1]


def work(force: Callable[[np.ndarray], np.ndarray], begin: float, end: float) -> float:
    """Integral of a force over the closing [J]. With v = begin +- x^4 powers of v by quarters are polynomials in x,
    which the rule integrates exactly."""
    x, weight = np.polynomial.legendre.leggauss(24)
    side = 1.0 if end > begin else -1.0
    span = abs(end - begin) ** 0.25
    x = 0.5 * span * (x + 1.0)
    return float(0.5 * span * side * np.sum(weight * 4.0 * x**3 * force(begin + side * x**4)))
