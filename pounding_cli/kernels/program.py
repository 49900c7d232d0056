"""The operations of a force (`laws.program`), carried out order by order on truncated series.

A register is a series: closing, rate, memory, q, then what each operation makes of those before it. Registers follow
one another in memory, `rows` places apart."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import further, fused, no_inline, short_array
from pounding_cli.laws.program import GIVEN, Operation

CLOSING, RATE, MEMORY, ROOT = 0, 1, 2, GIVEN - 1
"""The registers that are given."""

_LINEAR, _PRODUCT = int(Operation.LINEAR), int(Operation.PRODUCT)


@njit(**PART)
def product_term(x, y, k):
    """Order k of the product of two series. Four sums at a time do not wait for one another."""
    one, two, three, four = 0.0, 0.0, 0.0, 0.0
    y = further(y, k)
    i = 0
    while i + 3 <= k:
        one = fused(x[i], y[-i], one)
        two = fused(x[i + 1], y[-i - 1], two)
        three = fused(x[i + 2], y[-i - 2], three)
        four = fused(x[i + 3], y[-i - 3], four)
        i += 4
    while i <= k:
        one = fused(x[i], y[-i], one)
        i += 1
    return (one + two) + (three + four)


@njit(**PART)
def _power_term(x, y, exponent, k):
    """Order k of y = x^exponent from the orders before it; x is above zero at order 0. Of x = 0 it is zero."""
    if k == 0:
        return x[0] ** exponent if x[0] > 0.0 else 0.0
    if not x[0] > 0.0:
        return 0.0
    one, two = 0.0, 0.0
    x = further(x, k)
    weight, less = exponent * k, exponent + 1.0
    i = 0
    while i + 2 <= k:
        one = fused(weight * x[-i], y[i], one)
        two = fused((weight - less) * x[-i - 1], y[i + 1], two)
        weight -= 2.0 * less
        i += 2
    if i < k:
        one = fused(weight * x[-i], y[i], one)
    return (one + two) / (k * x[-k])


@njit(**CALLED)
def carry_out(operations, first, last, registers, rows, k):
    """Order k of what operations `first` to before `last` make; returns that of the last one, the force [N]."""
    no_inline()
    value = 0.0
    for n in range(first, last):
        row = n * t.OPERATION_ROW
        x = further(registers, int(operations[row + t.X]) * rows)
        y = further(registers, int(operations[row + t.Y]) * rows)
        out = further(registers, (GIVEN + n - first) * rows)
        code, a = int(operations[row + t.CODE]), operations[row + t.A]
        if code == _LINEAR:
            value = a * x[k] + operations[row + t.B] * y[k]
            if k == 0:
                value += operations[row + t.C]
        elif code == _PRODUCT:
            value = a * product_term(x, y, k)
        else:
            value = a * _power_term(x, out, operations[row + t.B], k)
        out[k] = value
    return value


@njit(**CALLED)
def force_and_slope(links, b, v, v_slope, rate, rate_slope):
    """(force [N], its derivative) of branch b, written as operations, at a closing [m] and a rate [m/s] with these
    derivatives: the operations at orders 0 and 1. Powers of what is not above zero are zero."""
    no_inline()
    first = int(links.branches[b * t.BRANCH_ROW + t.FIRST_STEP])
    last = int(links.branches[b * t.BRANCH_ROW + t.LAST_STEP])
    registers = short_array()
    registers[2 * MEMORY], registers[2 * MEMORY + 1] = 0.0, 0.0
    registers[2 * ROOT], registers[2 * ROOT + 1] = 0.0, 0.0
    registers[2 * CLOSING], registers[2 * CLOSING + 1] = v, v_slope
    registers[2 * RATE], registers[2 * RATE + 1] = rate, rate_slope
    force = carry_out(links.operations, first, last, registers, 2, 0)
    return force, carry_out(links.operations, first, last, registers, 2, 1)
