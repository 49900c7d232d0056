"""The Taylor series of one step: every order from the one before by the equations of motion.

Time runs as s = (t - t0) / h from 0 to 1. Coefficient k of the velocity stands in row k of `W` [m/s]; the row before
the first holds the displacement at the step's start, since the displacement's coefficient k is h W_(k-1) / k. Between
two events every slot's acceleration is a fixed combination of its own displacement and velocity and of its two
neighbours' (its six *stencils*), so
    u''_k = sum of stencil x (U_k, W_k) + links - a_g,k,    W_(k+1) = h u''_k / (k + 1).
Only W_(k+1) waits for W_k, through two shuffles and three multiply-adds: that chain is what an order costs alone.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, of, of_link, of_link_integer, of_term
from pounding_cli.kernels.clock import GROUND, GROUND_CHANGE, INVERSE_H, LEAST_SCALE, ORDER, H
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import expand_links, link_force_terms, link_forces_on
from pounding_cli.kernels.simd import (
    from_left,
    from_right,
    fused,
    greater,
    load,
    magnitude,
    maximum,
    no_inline,
    splat,
    store,
)
from pounding_cli.kernels.terms import exceeding_lanes, hand_on, spring_forces

MIN_ORDER = 4
"""No series is shorter: the first terms of a start from rest are small and say nothing."""

LARGEST = 1e300
"""Order of a velocity [m/s] that is taken for overflow."""

FORGET = 0.9
"""What is left of an acceleration as a scale after one step."""


@njit(**PART)
def update_stencils(run, i):
    """Renew what depends on the branch of slot i: its own stencils (acceleration per displacement and per velocity of
    itself and its neighbours) and the push of the offsets [m/s2]. P-Delta acts on the difference of two displacements,
    so it is taken from the tangent here and nowhere else: shears are the law's."""
    slots = run.slots
    below = slots[of(i, c.TANGENT)] - slots[of(i, c.GEOMETRIC)]
    above = 0.0
    above_dashpot = 0.0
    above_offset = 0.0
    if i + 1 < run.padded:
        coupled = slots[of(i, c.COUPLE_RIGHT)]
        above = coupled * (slots[of(i + 1, c.TANGENT)] - slots[of(i + 1, c.GEOMETRIC)])
        above_dashpot = coupled * slots[of(i + 1, c.DASHPOT)]
        above_offset = coupled * slots[of(i + 1, c.OFFSET)]
    inverse = slots[of(i, c.INVERSE_MASS)]
    dashpot = slots[of(i, c.DASHPOT)]
    couple = slots[of(i, c.COUPLE)]
    slots[of(i, c.STENCIL_U)] = -(below + above) * inverse
    slots[of(i, c.STENCIL_U_BELOW)] = couple * below * inverse
    slots[of(i, c.STENCIL_U_ABOVE)] = above * inverse
    slots[of(i, c.STENCIL_V)] = -(dashpot + above_dashpot) * inverse - slots[of(i, c.ALPHA)]
    slots[of(i, c.STENCIL_V_BELOW)] = couple * dashpot * inverse
    slots[of(i, c.STENCIL_V_ABOVE)] = above_dashpot * inverse
    slots[of(i, c.OFFSET_ACCELERATION)] = (above_offset - slots[of(i, c.OFFSET)]) * inverse


@njit(**PART)
def _floor_accelerations(slots, b, k, before, ground, u_left, u, u_right, w_left, w, w_right):
    """Order k of the accelerations of eight slots by their own and their neighbours' displacements (times `before`,
    h / k) and velocities, by the ground in orders 0 and 1, and by the branches' offsets in order 0.

    What waits for the newest velocities comes last."""
    total = load(slots, at(b, c.STENCIL_U)) * u
    total = fused(load(slots, at(b, c.STENCIL_U_BELOW)), u_left, total)
    total = fused(load(slots, at(b, c.STENCIL_U_ABOVE)), u_right, total) * before
    if k < 2:
        total = total - load(slots, at(b, c.LOADED)) * ground
        total = total + load(slots, at(b, c.OFFSET_ACCELERATION)) if k == 0 else total
    total = fused(load(slots, at(b, c.STENCIL_V)), w, total)
    total = fused(load(slots, at(b, c.STENCIL_V_BELOW)), w_left, total)
    return fused(load(slots, at(b, c.STENCIL_V_ABOVE)), w_right, total)


@njit(**PART)
def set_allowed(run, tolerance):
    """What a term may leave out: `tolerance` times the slot's recent acceleration (`renew_scale`), or of what is not
    resolved."""
    slots = run.slots
    least_scale = splat(run.clock[LEAST_SCALE])
    for b in range(run.slot_start, run.slot_stop, 8):
        store(slots, at(b, c.TERM_TOLERANCE), maximum(load(slots, at(b, c.SCALE)), least_scale) * tolerance)


@njit(**CALLED)
def _largest_cut_term(run, k):
    """The largest order k of a force that is cut off, over what may be left out of the forces on its floors [-].

    It moves no floor, so the floors' series say nothing of its own, and that of an infill's dashpot (a square root)
    converges far more slowly; but its sign tells when the link presses again."""
    no_inline()
    largest = 0.0
    for e in range(run.link_start, run.link_stop):
        closed = run.links[of_link(e, c.CLOSED)] != 0.0
        if closed and run.links[of_link(e, c.ACTS)] == 0.0:
            allowed = np.inf
            for side in (c.LEFT_SLOT, c.RIGHT_SLOT):
                i = run.link_integers[of_link_integer(e, side)]
                allowed = min(allowed, run.slots[of(i, c.TERM_TOLERANCE)] * run.slots[of(i, c.MASS)])
            largest = max(largest, abs(run.series[of_term(run, k, e, c.FORCE_TERM)]) / allowed)
    return largest


@njit(**PART)
def expand(run, terms, any_closed, curved, cut, pinned_at_event, tolerance, max_order, has_terms):
    """Coefficients up to the order at which two acceleration terms in a row are below what may be left out, or up to

    Returns (order, whether that held).
    """
    set_allowed(run, tolerance)
    links = run.link_stop - run.link_start
    slots = run.slot_stop - run.slot_start
    if slots == 8 and links == 0 and not has_terms:
        return _expand_one(run, max_order)
    if slots == 16 and (links == 0 or (links == 8 and run.links_per_side == 0)) and not has_terms and cut == 0:
        return _expand_two(run, any_closed, curved, pinned_at_event, max_order)
    return _expand_all(run, terms, any_closed, curved, cut, pinned_at_event, max_order, has_terms)


@njit(**PART)
def _judged(small, exceeding, k):
    """(How many orders in a row are small, by those before and what exceeds in order k; whether the series may end)."""
    small = small + 1 if exceeding == 0 else 0
    return small, small > 1 and k >= MIN_ORDER


@njit(**PART)
def no_orders():
    """(0, 0) to count from: with a plain 0 numba would compile what is given the number twice."""
    return np.int64(0), np.int64(0)


@njit(**CALLED)
def _expand_all(run, terms, any_closed, curved, cut, pinned_at_event, max_order, has_terms):
    """The series of any number of slots."""
    no_inline()
    padded = run.padded
    slots = run.slots
    zero = splat(0.0)
    h = splat(run.clock[H])
    ground = splat(run.clock[GROUND])
    small, k = no_orders()
    before = splat(1.0)
    while True:
        after = h * run.reciprocal[k + 1]
        if any_closed != 0:
            expand_links(run, k, after, curved, pinned_at_event)
        row = k * padded
        if has_terms:
            spring_forces(run, terms, k, run.W, row - padded, run.clock[H] * run.reciprocal[k] if k > 0 else 1.0)
        exceeding = 0
        w_left = zero
        u_left = zero
        w = load(run.W, row + run.slot_start)
        u = load(run.W, row - padded + run.slot_start)
        for b in range(run.slot_start, run.slot_stop, 8):
            more = b + 8 < run.slot_stop
            w_right = load(run.W, row + b + 8) if more else zero
            u_right = load(run.W, row - padded + b + 8) if more else zero
            total = _floor_accelerations(
                slots, b, k, before, ground, from_left(u_left, u), u, from_right(u, u_right),
                from_left(w_left, w), w, from_right(w, w_right),
            )  # fmt: skip
            if has_terms:
                total = fused(load(slots, at(b, c.INVERSE_MASS)), load(slots, at(b, c.SPRING_FORCE)), total)
            if any_closed != 0:
                total = fused(load(slots, at(b, c.INVERSE_MASS)), link_forces_on(run, b), total)
            store(run.W, row + padded + b, total * after)
            exceeding |= greater(magnitude(total), load(slots, at(b, c.TERM_TOLERANCE)))
            w_left = w
            u_left = u
            w = w_right
            u = u_right
        if has_terms:
            hand_on(run, terms, run.W, row + padded)
            exceeding = exceeding_lanes(run, k, after)
        if cut != 0 and _largest_cut_term(run, k) > 1.0:
            exceeding |= 1
        k += 1
        small, close = _judged(small, exceeding, k)
        if close or k == max_order:
            return k, close
        before = h * run.reciprocal[k]
        ground = splat(run.clock[GROUND_CHANGE])


@njit(**CALLED)
def _expand_one(run, max_order):
    """The same of one building of eight storeys at most: what one order leaves for the next stays in registers, where
    the loop above would wait for the memory."""
    no_inline()
    slots = run.slots
    zero = splat(0.0)
    h = splat(run.clock[H])
    ground = splat(run.clock[GROUND])
    a = run.slot_start
    u = load(run.W, a - run.padded)
    u_left, u_right = from_left(zero, u), from_right(u, zero)
    w = load(run.W, a)
    small, k = no_orders()
    before = splat(1.0)
    while True:
        after = h * run.reciprocal[k + 1]
        w_left, w_right = from_left(zero, w), from_right(w, zero)
        total = _floor_accelerations(slots, a, k, before, ground, u_left, u, u_right, w_left, w, w_right)
        exceeding = greater(magnitude(total), load(slots, at(a, c.TERM_TOLERANCE)))
        u, u_left, u_right = w, w_left, w_right
        w = total * after
        k += 1
        store(run.W, k * run.padded + a, w)
        small, close = _judged(small, exceeding, k)
        if close or k == max_order:
            return k, close
        before = h * run.reciprocal[k]
        ground = splat(run.clock[GROUND_CHANGE])


@njit(**CALLED)
def _expand_two(run, any_closed, curved, pinned_at_event, max_order):
    """The same of two such buildings, and the links between them."""
    no_inline()
    slots = run.slots
    zero = splat(0.0)
    h = splat(run.clock[H])
    ground = splat(run.clock[GROUND])
    a = run.slot_start
    b = a + 8
    e = run.link_start
    # Displacement and velocity of the two halves, and of the left and right neighbours of their slots.
    u = load(run.W, a - run.padded)
    x = load(run.W, b - run.padded)
    u_left, u_right, x_left, x_right = from_left(zero, u), from_right(u, x), from_left(u, x), from_right(x, zero)
    w = load(run.W, a)
    y = load(run.W, b)
    v = zero
    if any_closed != 0:
        v = load(run.series, c.at_term(run, 0, e, c.CLOSING_TERM))
    small, k = no_orders()
    before = splat(1.0)
    while True:
        after = h * run.reciprocal[k + 1]
        w_left, w_right, y_left, y_right = from_left(zero, w), from_right(w, y), from_left(w, y), from_right(y, zero)
        total = _floor_accelerations(slots, a, k, before, ground, u_left, u, u_right, w_left, w, w_right)
        total_right = _floor_accelerations(slots, b, k, before, ground, x_left, x, x_right, y_left, y, y_right)
        if any_closed != 0:
            pushed, v = link_force_terms(run, k, e, v, w - y, after, curved, pinned_at_event)
            total = total - load(slots, at(a, c.INVERSE_MASS)) * pushed
            total_right = fused(load(slots, at(b, c.INVERSE_MASS)), pushed, total_right)
        exceeding = greater(magnitude(total), load(slots, at(a, c.TERM_TOLERANCE)))
        exceeding |= greater(magnitude(total_right), load(slots, at(b, c.TERM_TOLERANCE)))
        u, u_left, u_right = w, w_left, w_right
        x, x_left, x_right = y, y_left, y_right
        w = total * after
        y = total_right * after
        k += 1
        store(run.W, k * run.padded + a, w)
        store(run.W, k * run.padded + b, y)
        small, close = _judged(small, exceeding, k)
        if close or k == max_order:
            return k, close
        before = h * run.reciprocal[k]
        ground = splat(run.clock[GROUND_CHANGE])


@njit(**PART)
def renew_scale(run):
    """The largest recent acceleration. It decreases to a tenth in every step, so that the steps after a blow are not
    inaccurate."""
    slots = run.slots
    for b in range(run.slot_start, run.slot_stop, 8):
        now = maximum(
            magnitude(load(slots, at(b, c.TOTAL_ACCELERATION0))), magnitude(load(slots, at(b, c.TOTAL_ACCELERATION1)))
        )
        store(slots, at(b, c.SCALE), maximum(load(slots, at(b, c.SCALE)) * FORGET, now))


@njit(**PART)
def is_finite(run, order):
    """Whether the series is within the range of doubles: beyond it the last order is not a number, and not large."""
    total = splat(0.0)
    for b in range(run.slot_start, run.slot_stop, 8):
        total = total + magnitude(load(run.W, order * run.padded + b))
    return greater(splat(LARGEST), total) == 255


@njit(**CALLED)
def shrink(run, cut):
    """The fraction of a step that meets the tolerance at its highest order; NaN where the series leaves the range of
    doubles. Rescales nothing."""
    no_inline()
    order = run.tally[ORDER]
    worst = 0.0
    if not is_finite(run, order):
        return np.nan
    for k in (order - 1, order):
        number = k * run.clock[INVERSE_H]
        sizes = splat(0.0)  # in parts of what may be left out
        for b in range(run.slot_start, run.slot_stop, 8):
            term = magnitude(load(run.W, k * run.padded + b)) * number
            sizes = maximum(sizes, term / load(run.slots, at(b, c.TERM_TOLERANCE)))
        store(run.scratch, 0, sizes)
        size = 0.0
        for lane in range(8):
            size = max(size, run.scratch[lane])
        if cut != 0:
            size = max(size, _largest_cut_term(run, k - 1))
        if size > 0.0:
            worst = max(worst, size ** (1.0 / (k - 1)))
    return 0.9 / worst if worst > 0.9 else 1.0


@njit(**CALLED)
def rescale(run, ratio, any_closed, order):
    """Coefficients for a step `ratio` times as long: the motion is the same, only s is measured anew."""
    no_inline()
    power = splat(1.0)
    for k in range(order + 1):
        row = k * run.padded
        for b in range(run.slot_start, run.slot_stop, 8):
            store(run.W, row + b, load(run.W, row + b) * power)
        if any_closed != 0:
            for b in range(run.link_start, run.link_stop, 8):
                for field in (c.CLOSING_TERM, c.RATE_TERM, c.FORCE_TERM):
                    place = c.at_term(run, k, b, field)
                    store(run.series, place, load(run.series, place) * power)
        power = power * ratio
