"""The first event of a step: a storey yields or unloads, a link meets a guard of its branch.

Bounds settle most places eight at a time; what they do not exclude is looked at one by one."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import at, at_link, of, of_link, of_link_integer, of_storey, of_term
from pounding_cli.kernels.clock import END, EVENT_GUARD, EVENT_LINK, INVERSE_H, ORDER, H
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import closing_at_end, difference
from pounding_cli.kernels.polynomial import NEVER, first_crossing, value
from pounding_cli.kernels.simd import (
    greater,
    load,
    lowest,
    maximum,
    minimum,
    no_inline,
    splat,
    store,
)
from pounding_cli.kernels.storey_law import guarded_drift
from pounding_cli.kernels.summary import drift_series, may_turn_by_ends, rate_term

MAX_STOREY_EVENTS_AT_INSTANT = 6
"""Events of a storey at one instant after which it leaves a branch only if that is left at the end of the step too: at
rest and without shear, rounding errors would select the branches of a storey without end.
After twice as many its guards are not evaluated until time advances."""

AT_ONCE = 1e-12
"""Part of a step [-] in which a storey that leaves its branch leaves it at the start."""

MAX_EVENTS_AT_INSTANT = 2
"""Events of a link at one instant after which some guards are asked no more until time goes on: an event that undoes
itself at once is rounding (floors that part from rest at a high order of their motion, say)."""


@njit(**PART)
def storey_crossing(run, order, end, events):
    """`first_crossing` of the polynomial in `scratch` for a storey with so many events at this instant."""
    s = first_crossing(run.scratch, order, end)
    if events >= MAX_STOREY_EVENTS_AT_INSTANT and s < AT_ONCE and value(run.scratch, order, 1.0) > 0.0:
        return NEVER
    return s


@njit(**PART)
def _storey_guard(run, i, b, g):
    """Whether storey i may meet guard g of its branch b in this step; if so, the series that is to stay positive is put
    into `scratch`."""
    slots = run.slots
    side, shift, at_drift = guarded_drift(run, b, g, slots, of(i, c.STOREY_MEMORY), 8)
    order = run.tally[ORDER]
    if t.guard(run, g, t.QUANTITY) == t.RATE:
        for k in range(order + 1):
            run.scratch[k] = side * rate_term(run, k, i)
        if run.storeys[of_storey(run, i, c.STOREY_PINNED)] == g:
            run.scratch[0] = 0.0
        return True
    first = side * ((slots[of(i, c.DRIFT0)] - shift) - at_drift)
    last = side * ((slots[of(i, c.DRIFT1)] - shift) - at_drift)
    if min(first, last) >= slots[of(i, c.DRIFT_CHORD_DEVIATION)]:
        return False
    drift_series(run, run.clock[H], i, order, side)
    run.scratch[0] = first
    if run.storeys[of_storey(run, i, c.STOREY_PINNED)] == g:
        run.scratch[0] = 0.0
        run.scratch[1] = 0.0
    return True


@njit(**CALLED)
def _storey_crossing(run, i):
    """(s, guard) of the first guard of its branch that storey i meets in [0, 1]; NEVER if there is none."""
    no_inline()
    earliest = NEVER
    first = 0
    b = run.storeys[of_storey(run, i, c.STOREY_BRANCH)]
    events = run.storeys[of_storey(run, i, c.STOREY_EVENTS)]
    if events >= 2 * MAX_STOREY_EVENTS_AT_INSTANT:
        return earliest, first
    for g in range(int(t.branch(run, b, t.FIRST_GUARD)), int(t.branch(run, b, t.LAST_GUARD))):
        if _storey_guard(run, i, b, g):
            s = storey_crossing(run, run.tally[ORDER], min(1.0, earliest), events)
            if s < earliest:
                earliest = s
                first = g
    return earliest, first


@njit(**PART)
def _storeys_that_may_leave(run, b):
    """Lanes whose storey may leave its branch: its drift may pass a guard, or may turn where that is one."""
    slots = run.slots
    first = load(slots, at(b, c.DRIFT0))
    last = load(slots, at(b, c.DRIFT1))
    deviation = load(slots, at(b, c.DRIFT_CHORD_DEVIATION))
    turns = load(slots, at(b, c.TURNS))
    stays = greater(minimum(first, last) - deviation, load(slots, at(b, c.DRIFT_LOW)))
    stays &= greater(load(slots, at(b, c.DRIFT_HIGH)), maximum(first, last) + deviation)
    turning = greater(turns * turns, splat(0.0))
    if turning != 0:
        rate = minimum(load(slots, at(b, c.DRIFT_RATE0)) * turns, load(slots, at(b, c.DRIFT_RATE1)) * turns)
        stays &= ~turning | greater(rate, load(slots, at(b, c.DRIFT_RATE_CHORD_DEVIATION)))
    return ~stays & 255


@njit(**CALLED)
def first_storey_event(run):
    """Whether there is a storey event in [0, 1], the first one's place in END; EVENT_ROOT tells every storey's own."""
    no_inline()
    found = False
    for b in range(run.slot_start, run.slot_stop, 8):
        store(run.slots, at(b, c.EVENT_ROOT), splat(NEVER))
        suspects = _storeys_that_may_leave(run, b)
        while suspects != 0:
            i = b + lowest(suspects)
            suspects &= suspects - 1
            s, guard = _storey_crossing(run, i)
            run.slots[of(i, c.EVENT_ROOT)] = s
            run.storeys[of_storey(run, i, c.STOREY_GUARD)] = guard
            if s < run.clock[END] and s <= 1.0:
                run.clock[END] = s
                found = True
    return found


@njit(**PART)
def _closing_series(run, e, first, factor):
    """`factor` times the coefficients of link e's closing, `first` at order 0, into `scratch`; exactly zero where both
    floors move alike."""
    h = factor * run.clock[H]
    left = run.link_integers[of_link_integer(e, c.LEFT_SLOT)]
    right = run.link_integers[of_link_integer(e, c.RIGHT_SLOT)]
    size = max(abs(run.W[left - run.padded]), abs(run.W[right - run.padded])) * run.clock[INVERSE_H]
    run.scratch[0] = factor * first
    for k in range(1, run.tally[ORDER] + 1):
        a = run.W[(k - 1) * run.padded + left]
        b = run.W[(k - 1) * run.padded + right]
        run.scratch[k] = h * run.reciprocal[k] * difference(a, b, size)
        size = max(size, abs(a), abs(b))


@njit(**CALLED)
def _link_crossing(run, e, end):
    """(s, guard) of the first guard of its branch that link e meets in [0, end]; NEVER if there is none."""
    no_inline()
    scratch = run.scratch
    order = run.tally[ORDER]
    earliest = NEVER
    first = -1
    b = run.link_integers[of_link_integer(e, c.BRANCH)]
    closing = run.links[of_link(e, c.CLOSING)]
    for g in range(int(t.branch(run, b, t.FIRST_GUARD)), int(t.branch(run, b, t.LAST_GUARD))):
        if t.guard(run, g, t.ONCE) != 0.0 and run.links[of_link(e, c.EVENTS_AT_INSTANT)] >= MAX_EVENTS_AT_INSTANT:
            continue
        side = t.guard(run, g, t.SIDE)
        n = order
        if t.guard(run, g, t.QUANTITY) == t.CLOSING:
            _closing_series(run, e, closing - t.guard(run, g, t.AT), side)
        else:
            n = order - 1
            for k in range(order):
                scratch[k] = side * run.series[of_term(run, k, e, c.FORCE_TERM)]
            if run.link_integers[of_link_integer(e, c.PINNED_AT_EVENT)] == t.FORCE:
                scratch[0] = 0.0
        s = first_crossing(scratch, n, min(end, earliest))
        if s < earliest:
            earliest = s
            first = g
    return earliest, first


@njit(**PART)
def _may_leave(run, b, first, last, deviation):
    """Lanes whose link may leave its branch, by its closing at both ends of the step and the chord deviation."""
    low = load(run.links, at_link(b, c.LOW))
    high = load(run.links, at_link(b, c.HIGH))
    least = minimum(first, last)
    largest = maximum(first, last)
    stays = greater(least - deviation, low) & greater(high, largest + deviation)
    # Monotone, it may begin where the branch ends: it has just come from there.
    began = ~(greater(low, first) | greater(first, high))
    inside = greater(last, low) & greater(high, last)
    stays |= ~may_turn_by_ends(first, last, deviation) & began & inside
    return ~stays & 255


@njit(**CALLED)
def first_link_event(run):
    """Whether a link event comes before what stands in END: its place goes there, link and guard into the tally."""
    no_inline()
    found = False
    for b in range(run.link_start, run.link_stop, 8):
        first = load(run.links, at_link(b, c.CLOSING))
        last, deviation = closing_at_end(run, b)
        last = last - load(run.links, at_link(b, c.LINK_OFFSET))
        suspects = _may_leave(run, b, first, last, deviation)
        while suspects != 0:
            e = b + lowest(suspects)
            suspects &= suspects - 1
            end = min(run.clock[END], 1.0)
            s, guard = _link_crossing(run, e, end)
            if s < run.clock[END] and s <= 1.0:
                run.clock[END] = s
                run.tally[EVENT_LINK] = e
                run.tally[EVENT_GUARD] = guard
                found = True
    return found
