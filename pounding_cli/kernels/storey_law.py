"""Storeys on the branches of their laws: coefficients, guards and what is remembered, from the tables (`law_table`).

The memories of a storey stand `stride` apart from `place` on, so that the Taylor integrator and one-step methods can
each keep them where they keep the rest."""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.program import CLOSING, MEMORY, RATE, ROOT, carry_out
from pounding_cli.kernels.simd import no_inline, short_array

Storeys = namedtuple("Storeys", "branch memory before")
"""The storeys of a sample, by slot: branch, memories (MEMORIES rows), drift at the sample before [m]."""

MOST_EVENTS = 8
"""Branches that a storey may leave between two samples, where events are not located."""


@njit(**PART)
def coefficient(laws, b, field, memory, place, stride):
    """LINEAR [N/m], OFFSET [N], LOW or HIGH [m] of branch b: a number and a multiple of a memory."""
    row = b * t.BRANCH_ROW + field
    return laws.branches[row] + laws.branches[row + 1] * memory[place + stride * int(laws.branches[row + 2])]


@njit(**PART)
def shear_on(laws, b, drift, memory, place, stride):
    """Shear of a storey on branch b [N], wherever its drift [m] is."""
    stiffness = coefficient(laws, b, t.LINEAR, memory, place, stride)
    return stiffness * drift + coefficient(laws, b, t.OFFSET, memory, place, stride)


@njit(**PART)
def guarded_drift(laws, b, g, memory, place, stride):
    """(side, shift, at): guard g of branch b asks side ((D - shift) - at) to stay positive, D being the drift [m]. A
    guard of the shear becomes one of the drift. Of a guard of the rate, side alone is given."""
    side = t.guard(laws, g, t.SIDE)
    if t.guard(laws, g, t.QUANTITY) == t.FORCE:
        tangent = coefficient(laws, b, t.LINEAR, memory, place, stride)
        if tangent == 0.0:
            return 0.0, 0.0, 0.0
        at = -coefficient(laws, b, t.OFFSET, memory, place, stride) / tangent
        return (side if tangent > 0.0 else -side), 0.0, at
    shift = t.guard(laws, g, t.FACTOR) * memory[place + stride * int(t.guard(laws, g, t.MEMORY))]
    return side, shift, t.guard(laws, g, t.AT)


@njit(**CALLED)
def remember(laws, g, v, rate, memory, count, place, stride):
    """What guard g keeps of its event, where the drift, or closing, is v [m]."""
    no_inline()
    first = int(t.guard(laws, g, t.FIRST_SET))
    kept = int(t.guard(laws, g, t.FIRST_KEPT))
    last = int(t.guard(laws, g, t.LAST_SET))
    if last == first:
        return
    registers = short_array()
    registers[CLOSING], registers[RATE], registers[ROOT] = v, rate, 0.0
    for m in range(count):
        registers[MEMORY + m] = memory[place + stride * m]
    carry_out(laws.operations, first, kept, registers, 1, 0)
    for n in range(kept, last):
        row = n * t.OPERATION_ROW
        memory[place + stride * int(laws.operations[row + t.Y])] = registers[int(laws.operations[row + t.X])]


@njit(**CALLED)
def energy_held(laws, b, drift, memory, count, place, stride):
    """Energy that a storey on branch b holds at its drift [J]."""
    no_inline()
    stiffness = t.branch(laws, b, t.GIVES_BACK)
    if stiffness > 0.0:
        shear = shear_on(laws, b, drift, memory, place, stride)
        return 0.5 * (shear * shear) / stiffness  # of a square numba makes a function to compile
    registers = short_array()
    registers[CLOSING], registers[RATE], registers[ROOT] = drift, 0.0, 0.0
    for m in range(count):
        registers[MEMORY + m] = memory[place + stride * m]
    first, last = int(t.branch(laws, b, t.FIRST_STORED)), int(t.branch(laws, b, t.LAST_STORED))
    return carry_out(laws.operations, first, last, registers, 1, 0)


@njit(**CALLED)
def guard_at_rest(laws, b, left, quantity, rests):
    """The guard of branch b at which a storey stands exactly, and at rest, that has just come from branch `left`; 0 if
    there is none. After it has turned back that is where it would take `left` up again, or would turn back to it; where
    it does so at the same instant, because it `rests`, it is the turn."""
    no_inline()
    wanted = t.CLOSING if quantity == t.RATE else t.RATE
    if quantity == t.RATE or (rests and quantity == t.CLOSING):
        for g in range(int(t.branch(laws, b, t.FIRST_GUARD)), int(t.branch(laws, b, t.LAST_GUARD))):
            asked = t.guard(laws, g, t.QUANTITY)
            if (asked == wanted or asked == t.RATE) and int(t.guard(laws, g, t.NEXT)) == left:
                return g
    return 0


@njit(**PART)
def stays(laws, b, before, drift, memory, place, stride):
    """Whether a storey that goes from the drift `before` to `drift` [m] on branch b surely meets no guard."""
    low = coefficient(laws, b, t.LOW, memory, place, stride)
    high = coefficient(laws, b, t.HIGH, memory, place, stride)
    return low <= drift <= high and t.branch(laws, b, t.TURNS) * (drift - before) >= 0.0


@njit(**CALLED)
def follow(laws, b, before, drift, memory, count, place, stride):
    """The branch on which a storey is at `drift` that was on branch b at the drift `before` [m], where events are seen
    at samples alone; what it passes on its way is remembered as if it had stopped there."""
    no_inline()
    for _ in range(MOST_EVENTS):
        met = 0
        for g in range(int(t.branch(laws, b, t.FIRST_GUARD)), int(t.branch(laws, b, t.LAST_GUARD))):
            if t.guard(laws, g, t.QUANTITY) == t.RATE:
                if t.guard(laws, g, t.SIDE) * (drift - before) < 0.0:  # it turned back where it was
                    met = g
                    break
                continue
            side, shift, at = guarded_drift(laws, b, g, memory, place, stride)
            if side * ((drift - shift) - at) < 0.0 and side != 0.0:
                met = g
        if met == 0:
            break
        if t.guard(laws, met, t.QUANTITY) != t.RATE:
            _, shift, at = guarded_drift(laws, b, met, memory, place, stride)
            before = at + shift
        remember(laws, met, before, drift - before, memory, count, place, stride)
        b = int(t.guard(laws, met, t.NEXT))
    return b
