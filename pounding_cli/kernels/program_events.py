"""The end of a program step: the first event, the end of the segment, or the end of what its series describe."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import of, of_link, of_link_integer, of_storey
from pounding_cli.kernels.clock import (
    ELAPSED,
    END,
    EVENT_GUARD,
    EVENT_LINK,
    GROUND,
    GROUND_SLOPE,
    INVERSE_H,
    ORDER,
    SEGMENT_LENGTH,
    H,
)
from pounding_cli.kernels.crossings import MAX_EVENTS_AT_INSTANT, MAX_STOREY_EVENTS_AT_INSTANT, storey_crossing
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import difference
from pounding_cli.kernels.polynomial import NEVER, first_crossing, value
from pounding_cli.kernels.program import CLOSING, MEMORY, RATE, ROOT
from pounding_cli.kernels.program_frame import CHOSEN, FLOWING, branch_of, flows, force_register, is_closed, register
from pounding_cli.kernels.program_start import least_closing
from pounding_cli.kernels.program_storeys import drift_terms, end_memories, flows_on, storey_register
from pounding_cli.kernels.simd import no_inline
from pounding_cli.kernels.storey_law import guarded_drift
from pounding_cli.kernels.summary import drifts, rate_term
from pounding_cli.kernels.terms import end_points

UNEVEN = 1e-14
"""Part of a segment [-] by which a step may miss its end."""

SOONEST, LATER = 1e-9, 1e3
"""Part of a step [-] in which a closing that is resolved is looked for first, and how much longer each next part is."""


@njit(**PART)
def _copy(run, series, order, side):
    for k in range(order + 1):
        run.scratch[k] = side * series[k]


@njit(**CALLED)
def _storey_end(run, p, i):
    """(s, guard) of the first guard of its branch that storey i meets in [0, 1]; NEVER if there is none."""
    no_inline()
    order = run.tally[ORDER]
    earliest = NEVER
    first = 0
    b = run.storeys[of_storey(run, i, c.STOREY_BRANCH)]
    for g in range(int(t.branch(run, b, t.FIRST_GUARD)), int(t.branch(run, b, t.LAST_GUARD))):
        side, shift, at = guarded_drift(run, b, g, run.slots, of(i, c.STOREY_MEMORY), 8)
        if t.guard(run, g, t.QUANTITY) == t.RATE:
            if flows_on(run, i):
                _copy(run, storey_register(p, i, RATE), order - 1, side)
                run.scratch[order] = 0.0
            else:
                for k in range(order + 1):
                    run.scratch[k] = side * rate_term(run, k, i)
            if run.storeys[of_storey(run, i, c.STOREY_PINNED)] == g:
                run.scratch[0] = 0.0
        elif t.guard(run, g, t.QUANTITY) == t.FLOWING:
            _copy(run, storey_register(p, i, MEMORY), order, side)
            run.scratch[0] -= side * at
        else:
            drift_terms(run, p, i, order, side)
            run.scratch[0] -= side * (shift + at)
            if run.storeys[of_storey(run, i, c.STOREY_PINNED)] == g:
                run.scratch[0] = 0.0
                run.scratch[1] = 0.0
        s = storey_crossing(run, order, min(1.0, earliest), run.storeys[of_storey(run, i, c.STOREY_EVENTS)])
        if s < earliest:
            earliest = s
            first = g
    return earliest, first


@njit(**CALLED)
def _first_storey(run, p):
    """Whether there is a storey event; its place goes to END, every storey's own to EVENT_ROOT."""
    no_inline()
    found = False
    for i in range(run.slot_start, run.slot_stop):
        run.slots[of(i, c.EVENT_ROOT)] = NEVER
        events = run.storeys[of_storey(run, i, c.STOREY_EVENTS)]
        if run.storeys[of_storey(run, i, c.STOREY_BRANCH)] != t.NO_BRANCH and events < 2 * MAX_STOREY_EVENTS_AT_INSTANT:
            s, guard = _storey_end(run, p, i)
            run.slots[of(i, c.EVENT_ROOT)] = s
            run.storeys[of_storey(run, i, c.STOREY_GUARD)] = guard
            if s < run.clock[END] and s <= 1.0:
                run.clock[END] = s
                found = True
    return found


@njit(**CALLED)
def _guarded(run, p, e, g):
    """The series that guard g of link e asks to stay positive, into `scratch`; returns its order."""
    no_inline()
    order = run.tally[ORDER]
    side = t.guard(run, g, t.SIDE)
    at = t.guard(run, g, t.AT) + t.guard(run, g, t.FACTOR) * run.links[of_link(e, c.MEMORY)]
    quantity = t.guard(run, g, t.QUANTITY)
    left, right = (
        run.link_integers[of_link_integer(e, c.LEFT_SLOT)],
        run.link_integers[of_link_integer(e, c.RIGHT_SLOT)],
    )
    pinned = run.link_integers[of_link_integer(e, c.PINNED_AT_EVENT)]
    if quantity == t.CLOSING and e == int(p.numbers[CHOSEN]) and at == 0.0:
        _copy(run, register(p, e, ROOT), order, side)
        return order
    if quantity == t.CLOSING:
        closing = register(p, e, CLOSING)
        size = max(abs(p.U[left]), abs(p.U[right]))
        for k in range(1, order + 1):
            one, other = p.U[k * run.padded + left], p.U[k * run.padded + right]
            run.scratch[k] = side * difference(one, other, size)
            size = max(size, abs(one), abs(other))
        run.scratch[0] = side * (closing[0] - at)
        return order
    if quantity == t.FORCE:
        _copy(run, force_register(run, p, e), order - 1, side)
        if pinned == quantity:
            run.scratch[0] = 0.0
        return order - 1
    if quantity == t.RATE:
        _copy(run, register(p, e, RATE), order - 1, side)
        run.scratch[0] = side * (register(p, e, RATE)[0] - at)
        if pinned == t.ACCELERATION and run.scratch[0] == 0.0:  # the rate that is remembered is a turning point
            run.scratch[1] = 0.0
        return order - 1
    size = 0.0
    for k in range(order):
        one, other = p.A[k * run.padded + left], p.A[k * run.padded + right]
        run.scratch[k] = side * difference(one, other, size)
        size = max(size, abs(one), abs(other))
    return order - 1


@njit(**CALLED)
def _link_end(run, p, e, end):
    """(s, guard) of the first guard that link e meets in [0, end]; NEVER if there is none."""
    no_inline()
    earliest = NEVER
    first = -1
    b = branch_of(run, e)
    for g in range(int(t.branch(run, b, t.FIRST_GUARD)), int(t.branch(run, b, t.LAST_GUARD))):
        if t.guard(run, g, t.ONCE) != 0.0 and run.links[of_link(e, c.EVENTS_AT_INSTANT)] >= MAX_EVENTS_AT_INSTANT:
            continue
        if p.resting[e] != 0 and t.guard(run, g, t.QUANTITY) == t.FORCE:
            continue  # nothing is known of a force that is not resolved
        order = _guarded(run, p, e, g)
        s = first_crossing(run.scratch, order, min(end, earliest))
        if s < earliest:
            earliest = s
            first = g
    return earliest, first


@njit(**CALLED)
def _first_link(run, p):
    """Whether a link event comes before END: its place goes there, link and guard into the tally."""
    no_inline()
    found = False
    for e in range(run.link_start, run.link_stop):
        s, guard = _link_end(run, p, e, min(run.clock[END], 1.0))
        if s < run.clock[END] and s <= 1.0:
            run.clock[END] = s
            run.tally[EVENT_LINK] = e
            run.tally[EVENT_GUARD] = guard
            found = True
    return found


@njit(**PART)
def _first_of_all(run, order, end):
    """`first_crossing` of the polynomial in `scratch`, in ever longer intervals: it may be by a closing far below the
    last digit of what the whole step brings."""
    within = SOONEST * end
    s = first_crossing(run.scratch, order, within)
    while s == NEVER and within < end:
        within = min(LATER * within, end)
        s = first_crossing(run.scratch, order, within)
    return s


@njit(**CALLED)
def _presses(run, p):
    """Whether the step ends where a force begins to be resolved; its place goes to END."""
    no_inline()
    order = run.tally[ORDER]
    found = False
    for e in range(run.link_start, run.link_stop):
        if is_closed(run, e) and p.resting[e] != 0:
            least = least_closing(run, p, e)
            left, right = (
                run.link_integers[of_link_integer(e, c.LEFT_SLOT)],
                run.link_integers[of_link_integer(e, c.RIGHT_SLOT)],
            )
            for k in range(1, order + 1):
                row = k * run.padded
                run.scratch[k] = p.U[row + right] - p.U[row + left]
            run.scratch[0] = 2.0 * least - register(p, e, CLOSING)[0]
            s = _first_of_all(run, order, min(1.0, run.clock[END]))
            if s < run.clock[END] and s <= 1.0:
                run.clock[END] = s
                found = True
    return found


@njit(**CALLED)
def find_end(run, p, inelastic):
    """(whether a storey event ends the step, whether a link's does, whether it ends the segment); where it ends goes to
    END."""
    no_inline()
    order = run.tally[ORDER]
    left_over = run.clock[SEGMENT_LENGTH] - run.clock[ELAPSED]
    run.clock[END] = 1.0
    finished = False
    total = value(p.T, order, 1.0)
    if total >= left_over * (1.0 - UNEVEN):
        finished = True
        for k in range(1, order + 1):
            run.scratch[k] = -p.T[k]
        run.scratch[0] = left_over
        run.clock[END] = min(first_crossing(run.scratch, order, 1.0), 1.0)
    pressed = _presses(run, p)
    finished = finished and not pressed
    storeys = inelastic and _first_storey(run, p)
    link = _first_link(run, p)
    return storeys and not link, link, finished and not (storeys or link)


@njit(**CALLED)
def reach_end(run, terms, p):
    """Displacements, velocities, drifts, total accelerations and memories at the step's end; the time that it took
    goes to H, where the ground then is to GROUND_CHANGE. Returns that time [s]."""
    no_inline()
    order = run.tally[ORDER]
    end = run.clock[END]
    slots = run.slots
    duration = value(p.T, order, end)
    ground = run.clock[GROUND] + run.clock[GROUND_SLOPE] * duration
    for i in range(run.slot_start, run.slot_stop):
        u, v, a = 0.0, 0.0, 0.0
        for k in range(order, -1, -1):
            row = k * run.padded + i
            u = u * end + p.U[row]
            v = v * end + run.W[row]
            if k < order:
                a = a * end + p.A[row]
        run.ends[i] = u
        slots[of(i, c.V1)] = v
        slots[of(i, c.TOTAL_ACCELERATION0)] = p.A[i] + run.clock[GROUND]
        slots[of(i, c.TOTAL_ACCELERATION1)] = a + ground
    for e in range(run.link_start, run.link_stop):
        if flows(run, e):
            run.links[of_link(e, c.MEMORY)] = value(register(p, e, MEMORY), order, end)
    if p.numbers[FLOWING] > 0.0:
        end_memories(run, p)
    end_points(run, terms)
    drifts(run)
    run.clock[H] = duration / end if end > 0.0 else 0.0
    run.clock[INVERSE_H] = 1.0 / run.clock[H] if duration > 0.0 else 0.0
