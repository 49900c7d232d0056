"""Where a program step begins: order 0 of its series, the link in whose q it is taken, and its length at first."""

from __future__ import annotations

import math

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import of, of_link, of_link_integer
from pounding_cli.kernels.clock import ELAPSED, GROUND, GROUND_SLOPE, LEAST_SCALE, SEGMENT_GROUND, SEGMENT_LENGTH
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import difference
from pounding_cli.kernels.program import CLOSING, MEMORY, RATE, ROOT, carry_out
from pounding_cli.kernels.program_frame import (
    ALLOWED,
    B_ROOT,
    CHOSEN,
    CLOSINGS,
    FLOWING,
    RATES,
    SCALE,
    SIZES,
    branch_of,
    is_closed,
    register,
    sides_of,
)
from pounding_cli.kernels.program_storeys import some_flow, start_storeys
from pounding_cli.kernels.simd import further, load, no_inline, splat, store

ROUNDED = 1e-14
"""Part of a floor's displacement [-] below which a closing is rounding. Two links that close at one instant do not both
get a step in q of their own; the other is left without force up to there, or its series would allow no step."""


@njit(**CALLED)
def _start_link(run, p, e):
    """Order 0 of closing, rate and memory of link e, what is known exactly put in."""
    no_inline()
    left, right = sides_of(run, e)
    links = run.links
    one, other = run.W[left - run.padded], run.W[right - run.padded]
    v = difference(one - links[of_link(e, c.LINK_OFFSET)], other, 0.0)
    rate = difference(run.W[left], run.W[right], 0.0)
    pinned = run.link_integers[of_link_integer(e, c.PINNED_AT_EVENT)]
    if pinned == t.CLOSING:
        v = links[of_link(e, c.PINNED_CLOSING)]
    if pinned == t.RATE:
        rate = links[of_link(e, c.PINNED_CLOSING)]
    register(p, e, CLOSING)[0] = v
    register(p, e, RATE)[0] = rate
    links[of_link(e, c.CLOSING)] = v
    if is_closed(run, e):
        p.closed[0] += 1
        p.closed[p.closed[0]] = e
        memory = register(p, e, MEMORY)
        for k in range(0, p.rows, 8):
            store(memory, k, splat(0.0))
        memory[0] = links[of_link(e, c.MEMORY)]
        register(p, e, ROOT)[0] = 0.0
        sizes = further(p.sizes, SIZES * e)
        sizes[CLOSINGS] = max(abs(one), abs(other))
        sizes[RATES] = max(abs(run.W[left]), abs(run.W[right]))
        sizes[ALLOWED] = _allowed_force(run, e)


@njit(**PART)
def _allowed_force(run, e):
    """What may be left out of the force of link e [N]: what moves neither floor by more than is resolved."""
    left, right = sides_of(run, e)
    slots = run.slots
    return min(
        slots[of(left, c.TERM_TOLERANCE)] * slots[of(left, c.MASS)],
        slots[of(right, c.TERM_TOLERANCE)] * slots[of(right, c.MASS)],
    )


@njit(**CALLED)
def least_closing(run, p, e):
    """A closing [m] below which the force of link e is not resolved, however it got there from where it is."""
    no_inline()
    v = 1e-3
    while v > 1e-60 and _is_resolved(run, p, e, v):
        v *= 0.125
    return max(v, rounded(run, p, e))


@njit(**PART)
def rounded(run, p, e):
    """A closing [m] of link e that is rounding of its floors' displacements."""
    left, right = sides_of(run, e)
    return ROUNDED * max(abs(p.U[left]), abs(p.U[right]))


@njit(**CALLED)
def _is_resolved(run, p, e, v):
    """Whether the force of link e at a closing v [m] is more than may be left out, at its rate or, if that is more, the
    one that it has when it gets there from rest."""
    no_inline()
    b = branch_of(run, e)
    first, last = int(t.branch(run, b, t.FIRST_STEP)), int(t.branch(run, b, t.LAST_STEP))
    closing, rate = register(p, e, CLOSING), register(p, e, RATE)
    v0, r0 = closing[0], rate[0]
    closing[0], rate[0] = v, max(abs(r0), math.sqrt(2.0 * _largest_acceleration(run, e) * v))
    force = carry_out(run.operations, first, last, register(p, e, 0), p.rows, 0)
    closing[0], rate[0] = v0, r0
    return abs(force) > p.sizes[SIZES * e + ALLOWED]


@njit(**PART)
def _largest_acceleration(run, e):
    """Largest recent acceleration of the floors of link e [m/s2]."""
    left, right = sides_of(run, e)
    return max(run.slots[of(left, c.SCALE)], run.slots[of(right, c.SCALE)], run.clock[LEAST_SCALE])


@njit(**CALLED)
def start(run, p):
    """Order 0 of the step: displacements, links, the link whose q it is taken in, and its length to begin with."""
    no_inline()
    clock = run.clock
    clock[GROUND] = clock[SEGMENT_GROUND] + clock[GROUND_SLOPE] * clock[ELAPSED]
    p.numbers[FLOWING] = some_flow(run)
    if p.numbers[FLOWING] > 0.0:
        start_storeys(run, p)
    for b in range(run.slot_start, run.slot_stop, 8):
        store(p.U, b, load(run.W, b - run.padded))
    nearest = math.inf
    p.numbers[CHOSEN], p.numbers[B_ROOT] = -1.0, 1.0
    p.closed[0] = 0
    for e in range(run.link_start, run.link_stop):
        run.link_forces[e] = 0.0
        p.resting[e] = 0
        if branch_of(run, e) != t.NO_BRANCH:
            _start_link(run, p, e)
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        if t.branch(run, branch_of(run, e), t.REGULAR) <= 1.0:
            continue
        v, rate = register(p, e, CLOSING)[0], register(p, e, RATE)[0]
        if not (v > rounded(run, p, e) and _is_resolved(run, p, e, v)):
            least = least_closing(run, p, e)
            p.resting[e] = 1 if v < least else 0
            # from rest q would stand still
            if v < least and not rate > math.sqrt(2.0 * _largest_acceleration(run, e) * least):
                continue
        if max(v, 0.0) / max(abs(rate), 1e-300) < nearest:
            nearest = max(v, 0.0) / max(abs(rate), 1e-300)
            p.numbers[CHOSEN], p.numbers[B_ROOT] = e, t.branch(run, branch_of(run, e), t.REGULAR)
    left_over = clock[SEGMENT_LENGTH] - clock[ELAPSED]
    h = left_over
    if p.numbers[CHOSEN] >= 0.0:
        e, root = int(p.numbers[CHOSEN]), p.numbers[B_ROOT]
        p.resting[e] = 0
        q = max(register(p, e, CLOSING)[0], 0.0) ** (1.0 / root)
        register(p, e, ROOT)[0] = q
        speed = abs(register(p, e, RATE)[0]) / root
        by_place = left_over / q ** (root - 1.0) if q > 0.0 else math.inf
        by_speed = (left_over * root / speed ** (root - 1.0)) ** (1.0 / root) if speed > 0.0 else math.inf
        h = min(by_place, by_speed)
    p.numbers[SCALE] = h
