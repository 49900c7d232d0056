"""The functions of the laws, compiled: those of an element are chosen by its kind, its place in `laws.BEHAVIOURS`."""

from __future__ import annotations

import functools
import math
import types
from collections.abc import Callable, Sequence
from typing import Any

from numba import njit

from pounding_cli.laws import BEHAVIOURS
from pounding_cli.laws.formula import WRITTEN_BEHAVIOUR, Operation
from pounding_cli.solver.options import CALLED, PART

WRITTEN = BEHAVIOURS.index(WRITTEN_BEHAVIOUR)
"""Kind of the elements whose force is a formula of the study."""

PLUS, TIMES, POWER = int(Operation.PLUS), int(Operation.TIMES), int(Operation.POWER)


@functools.cache
def compiled(function: Callable) -> Any:
    """A function of a law, and those of the laws that it calls, compiled."""
    known = dict(function.__globals__)
    for name in function.__code__.co_names:
        called = known.get(name)
        if isinstance(called, types.FunctionType) and called.__module__.startswith("pounding_cli.laws"):
            known[name] = compiled(called)
    copy = types.FunctionType(function.__code__, known, function.__name__, function.__defaults__)
    return njit(**PART)(copy)


def _by_kind(functions: Sequence[tuple[int, Callable]]) -> Any:
    """One compiled function of (element, a, b) that calls the one of the element's kind, found by halves."""
    if len(functions) == 1:
        return functions[0][1]
    middle = len(functions) // 2
    at = functions[middle][0]
    left, right = _by_kind(functions[:middle]), _by_kind(functions[middle:])

    @njit(**PART)
    def choose(e, a, b):
        if e.kind < at:
            return left(e, a, b)
        return right(e, a, b)

    return choose


def _next_branch(behaviour: Any) -> Any:
    """With the three arguments of `_by_kind`."""
    function = compiled(behaviour.next_branch)

    @njit(**PART)
    def choose(e, guard, unused):
        function(e, guard)

    return choose


_branches = _by_kind([(kind, _next_branch(each)) for kind, each in enumerate(BEHAVIOURS)])
_forces = _by_kind([(kind, compiled(each.force)) for kind, each in enumerate(BEHAVIOURS) if each.force is not None])
_rates = _by_kind(
    [(kind, compiled(each.history_rate)) for kind, each in enumerate(BEHAVIOURS) if each.history_rate is not None]
)


@njit(**CALLED)
def next_branch(e, guard):
    """Element e meets a guard; what its storey carries of P-Delta goes with the stiffness of the branch."""
    _branches(e, guard, guard)
    e.stiffness = e.k - e.load


@njit(**PART)
def history_rate(e, r, h):
    """Rate of the history variable h of a smooth storey [1/s] at the rate r [m/s] of its drift."""
    return _rates(e, r, h)


@njit(**PART)
def line_force(e, v, r):
    """Force [N] of the line, cubic or relaxing force of a branch, at the deformation v [m] and the rate r [m/s]."""
    if e.relaxation > 0.0:
        return e.h[0]
    f = e.k * v + e.c * r + e.f0
    if e.cubic != 0.0:
        f += e.cubic * v**3 + e.root * math.sqrt(e.k + 3.0 * e.cubic * v * v) * r
    return f


@njit(**PART)
def force(e, v, r, formula):
    """Force [N] of an element with a smooth force too. It is called inside loops and takes records alone: the
    references to an array would be counted at every call."""
    f = line_force(e, v, r)
    return f + smooth_force(e, v, r, formula) if e.smooth else f


@njit(**PART)
def smooth_force(e, v, r, formula):
    """Force [N] of a law without a Taylor series, beside that of its line, at v [m] and v' [m/s]."""
    if e.kind == WRITTEN:
        return _written_force(formula, v, r)
    return _forces(e, v, r)


@njit(**PART)
def _written_force(formula, v, r):
    """The force [N] of a formula, operation by operation (`laws.formula.Operation`)."""
    operations, registers = formula.operations, formula.registers
    registers[0], registers[1] = v, r
    to = 2
    for i in range(formula.count):
        code, x, y, a = operations[i, 0], operations[i, 1], operations[i, 2], operations[i, 3]
        if code == PLUS:
            registers[to] = registers[int(x)] + registers[int(y)]
        elif code == TIMES:
            registers[to] = registers[int(x)] * registers[int(y)]
        elif code == POWER:
            base = registers[int(x)]
            registers[to] = 0.0 if base < 0.0 and a != int(a) else base**a
        else:
            registers[to] = a
        to += 1
    return registers[to - 1]
