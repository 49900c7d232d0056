"""Storeys in a program step: the series of drift and shear, and memories that flow, with what they push and lose.

The shear of a storey whose first memory flows is straight in the drift and in that memory z, whose rate is written as
operations (`laws.storey.StoreyBranch.flow`). Order 0 of z is in the branch's offset, which is set anew at every step's
start; the orders from 1 on push the two slots of the storey here."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import of, of_storey
from pounding_cli.kernels.clock import END, ORDER
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.ledger import SHARES
from pounding_cli.kernels.link_series import difference
from pounding_cli.kernels.polynomial import slope, value
from pounding_cli.kernels.program import CLOSING, MEMORY, RATE, ROOT, carry_out, product_term
from pounding_cli.kernels.recurrence import update_stencils
from pounding_cli.kernels.simd import further, no_inline, short_array
from pounding_cli.kernels.storey_law import energy_held
from pounding_cli.kernels.transitions import enter_storey_branch
from pounding_cli.laws.program import MEMORIES

MOST_CUTS = 40
"""Times that a step is made shorter for a memory whose series does not follow its law."""


@njit(**PART)
def storey_branch(run, i):
    """The branch that storey i is on."""
    return run.storeys[of_storey(run, i, c.STOREY_BRANCH)]


@njit(**PART)
def flows_on(run, i):
    """Whether the first memory of storey i changes with time while its branch holds."""
    return t.branch(run, storey_branch(run, i), t.FLOW) != 0.0


@njit(**CALLED)
def some_flow(run):
    """How many storeys of the island are on such a branch."""
    no_inline()
    count = 0
    for i in range(run.slot_start, run.slot_stop):
        if flows_on(run, i):
            count += 1
    return count


@njit(**PART)
def storey_register(p, i, which):
    """The series of a register of storey i."""
    return further(p.storeys, i * p.each + which * p.rows)


@njit(**PART)
def _per_memory(run, i):
    """What the shear of storey i grows by with its first memory [N]."""
    return t.branch(run, storey_branch(run, i), t.OFFSET_FACTOR)


@njit(**CALLED)
def drift_terms(run, p, i, order, factor):
    """`factor` times the coefficients of storey i's drift, into `scratch`."""
    no_inline()
    coupled = run.slots[of(i, c.COUPLE)] != 0.0
    for k in range(order + 1):
        row = k * run.padded + i
        term = p.U[row] - p.U[row - 1] if coupled else p.U[row]
        run.scratch[k] = factor * term


@njit(**CALLED)
def shear_terms(run, p, i, factor):
    """`factor` times the coefficients of storey i's shear, into `scratch`."""
    no_inline()
    order = run.tally[ORDER]
    drift_terms(run, p, i, order, factor * run.slots[of(i, c.TANGENT)])
    run.scratch[0] += factor * run.slots[of(i, c.OFFSET)]
    if flows_on(run, i):
        series, per_memory = storey_register(p, i, MEMORY), factor * _per_memory(run, i)
        for k in range(1, order + 1):
            run.scratch[k] += per_memory * series[k]


@njit(**CALLED)
def start_storeys(run, p):
    """Order 0 of what such storeys remember, and the branch's offset with it."""
    no_inline()
    for i in range(run.slot_start, run.slot_stop):
        if flows_on(run, i):
            enter_storey_branch(run, i)
            update_stencils(run, i)
            if i >= 1:
                update_stencils(run, i - 1)
            largest = storey_register(p, i, ROOT)
            largest[0], largest[1] = 0.0, 0.0
            for m in range(MEMORIES):
                series = storey_register(p, i, MEMORY + m)
                series[0] = run.slots[of(i, c.STOREY_MEMORY) + 8 * m]
                for k in range(1, p.rows):
                    series[k] = 0.0


@njit(**PART)
def _memory_term(run, p, i, k):
    """Order k, from 1, of the first memory of storey i: B times its rate, integrated by s."""
    rate = storey_register(p, i, int(t.branch(run, storey_branch(run, i), t.FLOW)))
    storey_register(p, i, MEMORY)[k] = product_term(p.B, rate, k - 1) * run.reciprocal[k]


@njit(**CALLED)
def _term(run, p, i, values, k, which):
    """Order k of drift (0) or rate (1) of storey i; exactly 0 where both floors move alike, for the sign of a rate
    decides the branch. The register of q, which storeys have no use for, holds the largest term before."""
    no_inline()
    row = k * run.padded + i
    if run.slots[of(i, c.COUPLE)] == 0.0:
        return values[row]
    largest = storey_register(p, i, ROOT)
    found = difference(values[row], values[row - 1], largest[which])
    largest[which] = max(largest[which], abs(values[row]), abs(values[row - 1]))
    return found


@njit(**CALLED)
def expand_storeys(run, p, k):
    """Order k of drift, rate, first memory and its rate of such storeys."""
    no_inline()
    for i in range(run.slot_start, run.slot_stop):
        if flows_on(run, i):
            b = storey_branch(run, i)
            storey_register(p, i, CLOSING)[k] = _term(run, p, i, p.U, k, np.int64(0))
            storey_register(p, i, RATE)[k] = _term(run, p, i, run.W, k, np.int64(1))
            if k > 0:
                _memory_term(run, p, i, k)
            first, last = int(t.branch(run, b, t.FIRST_STEP)), int(t.branch(run, b, t.LAST_STEP))
            carry_out(run.operations, first, last, storey_register(p, i, 0), p.rows, k)


@njit(**CALLED)
def end_series(run, p, order):
    """The last order of what such storeys remember."""
    no_inline()
    for i in range(run.slot_start, run.slot_stop):
        if flows_on(run, i):
            _memory_term(run, p, i, order)


@njit(**CALLED)
def push_slots(run, p, k):
    """Add what order k, from 1, of the first memories does to the accelerations."""
    no_inline()
    slots = run.slots
    row = k * run.padded
    for i in range(run.slot_start, run.slot_stop):
        if flows_on(run, i):
            shear = _per_memory(run, i) * storey_register(p, i, MEMORY)[k]
            p.A[row + i] -= shear * slots[of(i, c.INVERSE_MASS)]
            if slots[of(i, c.COUPLE)] != 0.0:
                p.A[row + i - 1] += shear * slots[of(i - 1, c.INVERSE_MASS)]


@njit(**CALLED)
def largest_memory_term(run, p, k):
    """The largest order k of a memory that flows; these are of order one."""
    no_inline()
    largest = 0.0
    for i in range(run.slot_start, run.slot_stop):
        if flows_on(run, i):
            largest = max(largest, abs(storey_register(p, i, MEMORY)[k]))
    return largest


@njit(**CALLED)
def _allowed_memory(run, i, tolerance):
    """What may be left out of the first memory of storey i: a part of one, or what moves its floors by less than is
    resolved."""
    slots = run.slots
    pushed = slots[of(i, c.TERM_TOLERANCE)] * slots[of(i, c.MASS)]
    if slots[of(i, c.COUPLE)] != 0.0:
        pushed = min(pushed, slots[of(i - 1, c.TERM_TOLERANCE)] * slots[of(i - 1, c.MASS)])
    return min(tolerance, pushed / max(abs(_per_memory(run, i)), 1e-300))


@njit(**CALLED)
def _defect(run, p, i, s):
    """The rate of the first memory of storey i by its law less that of its series, at s of the step."""
    no_inline()
    order = run.tally[ORDER]
    b = storey_branch(run, i)
    registers = short_array()
    for m in range(2 + MEMORIES):
        registers[m] = value(storey_register(p, i, m), order - 1, s)
    series = storey_register(p, i, MEMORY)
    registers[MEMORY] = value(series, order, s)
    first, last = int(t.branch(run, b, t.FIRST_STEP)), int(t.branch(run, b, t.LAST_STEP))
    rate = carry_out(run.operations, first, last, registers, np.int64(1), np.int64(0))
    return rate * value(p.B, order - 1, s) - slope(series, order, s)


@njit(**CALLED)
def part_followed(run, p, tolerance, ratio):
    """The part of the step, at most `ratio`, at whose end every memory flows as its law says [-]. Of z^n with a small z
    the series is empty up to order n and again behind it, so the last orders alone do not tell how good it is."""
    no_inline()
    order = run.tally[ORDER]
    for i in range(run.slot_start, run.slot_stop):
        if flows_on(run, i):
            allowed = order * _allowed_memory(run, i, tolerance)
            for _ in range(MOST_CUTS):
                defect = abs(_defect(run, p, i, ratio)) * ratio
                if defect <= allowed:
                    break
                ratio *= max(0.9 * (allowed / defect) ** (1.0 / order), 0.25)
    return ratio


@njit(**CALLED)
def end_memories(run, p):
    """What such storeys remember at the step's end."""
    no_inline()
    order = run.tally[ORDER]
    for i in range(run.slot_start, run.slot_stop):
        if flows_on(run, i):
            run.slots[of(i, c.STOREY_MEMORY)] = value(storey_register(p, i, MEMORY), order, run.clock[END])


@njit(**CALLED)
def account_storeys(run, p, points):
    """Add what such storeys lose: the work done on them less what they hold more at the end of the step."""
    no_inline()
    slots = run.slots
    order = run.tally[ORDER]
    for i in range(run.slot_start, run.slot_stop):
        if flows_on(run, i):
            shear_terms(run, p, i, 1.0)
            rate = storey_register(p, i, RATE)
            work = 0.0
            for g in range(0, 8 * points, 8):
                s, share = run.rule[g], run.rule[SHARES + g]
                work += value(run.scratch, order, s) * value(rate, order - 1, s) * share
            b = storey_branch(run, i)
            begin = storey_register(p, i, MEMORY)
            held = energy_held(run, b, slots[of(i, c.DRIFT0)], begin, np.int64(MEMORIES), np.int64(0), p.rows)
            place = of(i, c.STOREY_MEMORY)
            ends = energy_held(run, b, slots[of(i, c.DRIFT1)], slots, np.int64(MEMORIES), place, np.int64(8))
            slots[of(i, c.HYSTERESIS_ENERGY)] += work - (ends - held)
