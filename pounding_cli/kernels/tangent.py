"""The tangent of a run: how far a small change of the motion moves it, to first order.

A motion a_g (1 + e t / T) moves every displacement by e times its tangent. The tangent obeys the equations of motion on
the branches of the run, so it takes the run's own steps, each by a short series. Where the run passes an event, the
tangent of the event's time is that of what the guard asks, over its rate; where a force jumps there, so do the
tangent's velocities (saltation: Leine & Nijmeijer, 2004, Dynamics and Bifurcations of Non-Smooth Mechanical Systems).

`solve.tangent` tells of which scenes this is known."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import (
    at,
    at_link,
    at_term,
    of,
    of_link,
    of_link_integer,
    of_storey,
    record_parts,
    record_sizes,
    run_frame,
)
from pounding_cli.kernels.clock import (
    CLOCK_SIZE,
    ELAPSED,
    END,
    EVENT_GUARD,
    EVENT_LINK,
    GROUND,
    GROUND_CHANGE,
    GROUND_SLOPE,
    INVERSE_H,
    LEAST_SCALE,
    SEGMENT_GROUND,
    H,
)
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import closed_lanes, left_minus_right
from pounding_cli.kernels.recurrence import expand, no_orders, update_stencils
from pounding_cli.kernels.simd import (
    choose,
    from_left,
    further,
    fused,
    greater,
    load,
    lowest,
    magnitude,
    maximum,
    no_inline,
    splat,
    store,
)
from pounding_cli.kernels.terms import follow_points

TOLERANCE = 1e-2
"""What its series may leave out, relative to its recent acceleration [-]: a sensitivity needs no more."""

LEAST_SLOPE = 1e-200
"""Slope of a curved law [N/m] below which it is flat."""

LEAST_MOVED = 0.25
"""Part of the largest tangent of a link's closing so far, or of its force, that counts at least at its events [-]: a
numerical error moves floors in other directions than the motion does, and a contact that hardly begins or ends changes
its duration most."""

FADE = 0.9
"""What is left of its acceleration as a scale after one step, as in `recurrence`."""

AT_PEAK, SEEN = c.PEAK_SHEAR, c.MIN_DISPLACEMENT
"""Fields of a slot's record that mean something else here: the tangent of the drift in the step of the largest drift so
far, and that drift [m]."""

_ZEROED = (c.OFFSET, c.SCALE, c.PEAK_DRIFT, c.MAX_DISPLACEMENT, c.PEAK_ACCELERATION, c.DRIFT1, AT_PEAK, SEEN)

MOST = 1e100
"""Largest number that is told of a tangent."""


def room_for_tangent(padded: int, links: int, rows: int) -> int:
    """Doubles of scratch."""
    return (rows + 1) * padded + record_sizes(padded, links, rows)[0] + links + 8 + CLOCK_SIZE


@njit(**PART)
def tangent_frame(run, place, memory, rows):
    """A run of the tangent: records and series of its own in `memory`, the laws and places of the run."""
    by_slot, by_link, by_term = record_parts(run.padded, run.padded_links, rows)
    slots = further(memory, (rows + 1) * run.padded)
    links = further(slots, by_slot)
    series = further(links, by_link)
    forces = further(series, by_term)
    return run_frame(place, (
        0, run.padded, 0, run.padded_links, run.padded, run.padded_links, run.links_per_side,
        further(memory, run.padded), run.ends, slots, run.storeys, links, run.link_integers, run.branches, run.guards,
        run.operations, run.left_links, run.right_links, forces, series, run.rule, run.reciprocal,
        further(forces, run.padded_links + 8), run.tally, run.scratch,
    ))  # fmt: skip


@njit(**CALLED)
def begin_tangent(run, tangent):
    """Nothing is moved yet; stencils and laws are those of the run, without their offsets."""
    no_inline()
    by_slot, by_link, _ = record_parts(run.padded, run.padded_links, 0)
    for place in range(0, by_slot, 8):
        store(tangent.slots, place, load(run.slots, place))
    for place in range(0, by_link, 8):
        store(tangent.links, place, load(run.links, place))
    zero = splat(0.0)
    for b in range(0, run.padded, 8):
        for field in _ZEROED:
            store(tangent.slots, at(b, field), zero)
    for b in range(0, run.padded_links, 8):
        for field in (c.LAW_OFFSET, c.PEAK_FORCE, c.PEAK_CLOSING, c.IMPULSE, c.CONTACT_TIME):
            store(tangent.links, at_link(b, field), zero)
    for i in range(run.padded):
        update_stencils(tangent, i)
    tangent.clock[LEAST_SCALE] = run.clock[LEAST_SCALE]


@njit(**PART)
def begin_segment(tangent, ground, slope, length, growth, segment):
    """The change of the motion in a segment: `growth` [-] more of it at each sample."""
    begin = growth * segment
    first = ground * begin
    tangent.clock[SEGMENT_GROUND] = first
    tangent.clock[GROUND_SLOPE] = ((ground + slope * length) * (begin + growth) - first) / length


@njit(**PART)
def _start_closings(tangent):
    """Order 0 of the closings; returns the lanes with some link that is closed."""
    any_closed = 0
    zero = splat(0.0)
    for b in range(tangent.link_start, tangent.link_stop, 8):
        v = left_minus_right(tangent, tangent.W, -tangent.padded, b)
        closed = closed_lanes(tangent, b)
        any_closed |= closed
        store(tangent.series, at_term(tangent, 0, b, c.CLOSING_TERM), choose(closed, v, zero))
        store(tangent.link_forces, b, zero)
    return any_closed


@njit(**PART)
def _raise(records, place, value):
    store(records, place, maximum(load(records, place), magnitude(value)))


@njit(**PART)
def _end_floors(run, tangent, order, end):
    """Displacements and velocities at the step's end, and what is largest so far."""
    padded, slots = tangent.padded, tangent.slots
    s = splat(end)
    h = splat(end * tangent.clock[H])
    per_h = splat(tangent.clock[INVERSE_H])
    u_left = splat(0.0)
    for b in range(tangent.slot_start, tangent.slot_stop, 8):
        travel = splat(0.0)
        v = splat(0.0)
        for k in range(order, -1, -1):
            w = load(tangent.W, k * padded + b)
            travel = fused(travel, s, w * tangent.reciprocal[k + 1])
            v = fused(v, s, w)
        acceleration = magnitude(load(tangent.W, padded + b) * per_h)
        u = fused(travel, h, load(tangent.W, b - padded))
        store(tangent.W, b - padded, u)
        store(tangent.W, b, v)
        store(slots, at(b, c.SCALE), maximum(load(slots, at(b, c.SCALE)) * FADE, acceleration))
        _raise(slots, at(b, c.PEAK_ACCELERATION), acceleration)
        _raise(slots, at(b, c.MAX_DISPLACEMENT), u)
        drift = magnitude(u - load(slots, at(b, c.COUPLE)) * from_left(u_left, u))
        _raise(slots, at(b, c.PEAK_DRIFT), drift)
        peak = load(run.slots, at(b, c.PEAK_DRIFT))
        rises = greater(peak, load(slots, at(b, SEEN)))
        if rises != 0:
            either = maximum(drift, load(slots, at(b, c.DRIFT1)))
            store(slots, at(b, AT_PEAK), choose(rises, either, load(slots, at(b, AT_PEAK))))
            store(slots, at(b, SEEN), peak)
        store(slots, at(b, c.DRIFT1), drift)
        u_left = u


@njit(**PART)
def _end_links(tangent, order, end):
    """What is largest so far of closings and forces, and impulses."""
    links = tangent.links
    s = splat(end)
    length = splat(end * tangent.clock[H])
    for b in range(tangent.link_start, tangent.link_stop, 8):
        v = left_minus_right(tangent, tangent.W, -tangent.padded, b)
        _raise(links, at_link(b, c.PEAK_CLOSING), v)
        if closed_lanes(tangent, b) != 0:
            rate = left_minus_right(tangent, tangent.W, 0, b)
            acts = load(links, at_link(b, c.ACTS))
            force = fused(load(links, at_link(b, c.LAW_DASHPOT)), rate, load(links, at_link(b, c.LAW_LINEAR)) * v)
            _raise(links, at_link(b, c.PEAK_FORCE), force * acts)
            total = splat(0.0)
            for k in range(order - 1, -1, -1):
                term = load(tangent.series, at_term(tangent, k, b, c.FORCE_TERM))
                total = fused(total, s, term * tangent.reciprocal[k + 1])
            impulse = at_link(b, c.IMPULSE)
            store(links, impulse, fused(total * acts, length, load(links, impulse)))


@njit(**PART)
def _sides(run, e):
    """Places of the floors of link e."""
    return run.link_integers[of_link_integer(e, c.LEFT_SLOT)], run.link_integers[of_link_integer(e, c.RIGHT_SLOT)]


@njit(**PART)
def _closing_and_rate(run, e):
    """Closing [m] and rate [m/s] of link e at the end of the run's step."""
    left, right = _sides(run, e)
    v = run.ends[left] - run.ends[right] - run.links[of_link(e, c.LINK_OFFSET)]
    return v, run.slots[of(left, c.V1)] - run.slots[of(right, c.V1)]


@njit(**PART)
def _slopes(run, b, v, rate):
    """(stiffness [N/m], dashpot [N s/m]) of a link on branch b for small changes of closing and rate."""
    stiffness, dashpot = t.branch(run, b, t.LINEAR), t.branch(run, b, t.DASHPOT)
    cubic, root = t.branch(run, b, t.CUBIC), t.branch(run, b, t.ROOT)
    if cubic != 0.0 or root != 0.0:
        stiffness += 3.0 * cubic * v * v
        wave = np.sqrt(max(stiffness, LEAST_SLOPE))
        dashpot += root * wave
        stiffness += 3.0 * root * cubic * v / wave * rate
    return stiffness, dashpot


@njit(**CALLED)
def _follow_curved(run, tangent):
    """Give links on curved branches the mean slopes of this step: they change little in one."""
    no_inline()
    for first_of_eight in range(run.link_start, run.link_stop, 8):
        steep = load(run.links, at_link(first_of_eight, c.LAW_ROOT))
        curved = greater(steep + magnitude(load(run.links, at_link(first_of_eight, c.LAW_CUBIC))), splat(0.0))
        while curved != 0:
            e = first_of_eight + lowest(curved)
            curved &= curved - 1
            b = run.link_integers[of_link_integer(e, c.BRANCH)]
            left, right = _sides(run, e)
            gap = run.links[of_link(e, c.LINK_OFFSET)]
            first = run.W[left - run.padded] - run.W[right - run.padded] - gap
            stiffness, dashpot = _slopes(run, b, first, run.W[left] - run.W[right])
            last, rate = _closing_and_rate(run, e)
            stiffness_end, dashpot_end = _slopes(run, b, last, rate)
            tangent.links[of_link(e, c.LAW_LINEAR)] = 0.5 * (stiffness + stiffness_end)
            tangent.links[of_link(e, c.LAW_DASHPOT)] = 0.5 * (dashpot + dashpot_end)


@njit(**CALLED)
def carry(run, tangent, terms, max_order, has_terms):
    """Take the tangent through the step that the run has just taken, on the branches it had in it."""
    no_inline()
    clock, own = run.clock, tangent.clock
    own[H], own[INVERSE_H] = clock[H], clock[INVERSE_H]
    own[GROUND] = own[SEGMENT_GROUND] + own[GROUND_SLOPE] * clock[ELAPSED]
    own[GROUND_CHANGE] = own[GROUND_SLOPE] * clock[H]
    linked = tangent.link_stop > tangent.link_start
    any_closed = 0
    if linked:
        any_closed = _start_closings(tangent)
        _follow_curved(run, tangent)
    none, _ = no_orders()
    order, _ = expand(tangent, terms, any_closed, none, none, np.bool_(False), TOLERANCE, max_order, has_terms)
    _end_floors(run, tangent, order, clock[END])
    if linked:
        _end_links(tangent, order, clock[END])


@njit(**PART)
def _force(run, b, v, rate):
    """Force of a link on branch b [N]."""
    linear, cubic = t.branch(run, b, t.LINEAR), t.branch(run, b, t.CUBIC)
    wave = np.sqrt(max(linear + 3.0 * cubic * v * v, 0.0))
    dashpot = t.branch(run, b, t.DASHPOT) + t.branch(run, b, t.ROOT) * wave
    return t.branch(run, b, t.ACTS) * ((linear + cubic * v * v) * v + t.branch(run, b, t.OFFSET) + dashpot * rate)


@njit(**CALLED)
def cross_link_event(run, tangent, terms, before):
    """Take the tangent over the link event that the run has just passed, which ended branch `before`."""
    no_inline()
    e, g = run.tally[EVENT_LINK], run.tally[EVENT_GUARD]
    left, right = _sides(run, e)
    v, rate = _closing_and_rate(run, e)
    largest = tangent.links[of_link(e, c.PEAK_CLOSING)]
    moved, slope = tangent.W[left - run.padded] - tangent.W[right - run.padded], rate
    if t.guard(run, g, t.QUANTITY) == t.FORCE:
        stiffness, dashpot = _slopes(run, before, v, rate)
        largest = tangent.links[of_link(e, c.PEAK_FORCE)]
        moved = stiffness * moved + dashpot * (tangent.W[left] - tangent.W[right])
        slope = stiffness * rate + dashpot * (
            run.slots[of(left, c.TOTAL_ACCELERATION1)] - run.slots[of(right, c.TOTAL_ACCELERATION1)]
        )
    shift = -moved / slope if abs(moved) < MOST * abs(slope) else (MOST if moved != 0.0 else 0.0)
    after = run.link_integers[of_link_integer(e, c.BRANCH)]
    jump = (_force(run, after, v, rate) - _force(run, before, v, rate)) * shift
    tangent.links[of_link(e, c.IMPULSE)] -= jump
    tangent.W[left] += run.slots[of(left, c.INVERSE_MASS)] * jump
    tangent.W[right] -= run.slots[of(right, c.INVERSE_MASS)] * jump
    if terms.points > 0:
        follow_points(tangent, terms, tangent.W, np.int64(0))
    least = LEAST_MOVED * largest / max(abs(slope), LEAST_SLOPE)
    tangent.links[of_link(e, c.CONTACT_TIME)] += max(abs(shift), least)
    for field in (c.LAW_LINEAR, c.LAW_DASHPOT, c.ACTS, c.CLOSED):
        tangent.links[of_link(e, field)] = run.links[of_link(e, field)]


@njit(**CALLED)
def cross_storey_events(run, tangent):
    """Take the tangent over the storey events that the run has just passed.

    As a drift turns back its rate is zero, so the tangent of the shear does not change. On the line that a storey
    reaches at a drift the shear is that of the drift alone."""
    no_inline()
    slots = tangent.slots
    for i in range(run.slot_start, run.slot_stop):
        if run.slots[of(i, c.EVENT_ROOT)] == run.clock[END]:
            g = run.storeys[of_storey(run, i, c.STOREY_GUARD)]
            former, stiffness = slots[of(i, c.TANGENT)], run.slots[of(i, c.TANGENT)]
            offset = 0.0
            if t.guard(run, g, t.QUANTITY) == t.RATE:
                drift = tangent.W[i - run.padded]
                if slots[of(i, c.COUPLE)] != 0.0:
                    drift -= tangent.W[i - 1 - run.padded]
                offset = slots[of(i, c.OFFSET)] + (former - stiffness) * drift
            slots[of(i, c.TANGENT)], slots[of(i, c.OFFSET)] = stiffness, offset
            update_stencils(tangent, i)
            if i >= 1:
                update_stencils(tangent, i - 1)


@njit(**PART)
def _told(value):
    """The number, or MOST where it is larger or none."""
    return value if value < MOST else MOST


@njit(**CALLED)
def give_tangent(tangent, row, slots, links, numbers):
    """The largest tangents by slot (drift where that is largest, drift, displacement, acceleration) and by link
    (closing, force, time in contact) and their impulses, one row after the other, each per change of the motion."""
    no_inline()
    for slot in range(row.slots):
        i = row.slot_places[slot]
        numbers[slot] = _told(tangent.slots[of(i, AT_PEAK)])
        numbers[slots + slot] = _told(tangent.slots[of(i, c.PEAK_DRIFT)])
        numbers[2 * slots + slot] = _told(tangent.slots[of(i, c.MAX_DISPLACEMENT)])
        numbers[3 * slots + slot] = _told(tangent.slots[of(i, c.PEAK_ACCELERATION)])
    for link in range(row.links):
        e = row.link_places[link]
        place = 4 * slots + link
        numbers[place] = _told(tangent.links[of_link(e, c.PEAK_CLOSING)])
        numbers[links + place] = _told(tangent.links[of_link(e, c.PEAK_FORCE)])
        numbers[2 * links + place] = _told(tangent.links[of_link(e, c.CONTACT_TIME)])
        numbers[3 * links + place] = _told(abs(tangent.links[of_link(e, c.IMPULSE)]))
