"""The event-located Taylor integrator: steps end at a record sample or exactly at an event, whichever is first.

Between two events the motion is analytic, so its Taylor series gives the step, its error and a polynomial in which
events are located to rounding and peaks are found between samples (the recurrence: `recurrence.py`). After an event
the branch changes and the series starts anew, so the order is never lost. Method: Jorba & Zou (2005), Experimental
Mathematics 14(1).

One kernel serves all scenes: elastic or not, with foundations or not, whatever their links. Compiling is what a first
run waits for, and an effect that a scene does not have costs a branch that is never taken."""

from __future__ import annotations

import functools

import numpy as np
from numba import njit

from pounding_cli.kernels.branching import link_event, settle, storey_events, unsnap
from pounding_cli.kernels.cells import (
    V_END,
    Run,
    at,
    give_links,
    give_slots,
    parts_of,
    room_for,
    take_links,
    take_slots,
)
from pounding_cli.kernels.clock import (
    CHANGE,
    CLOCK,
    END,
    EVENTS,
    GROUND,
    LENGTH,
    ORDER,
    ORDERS,
    PER_H,
    QUIET,
    SEGMENT,
    SINCE,
    STANDING,
    STEPS,
    TALLY,
    H,
)
from pounding_cli.kernels.crossings import first_link_event, first_storey_event
from pounding_cli.kernels.foundations import footing_of, move_feet, start_feet
from pounding_cli.kernels.layout import (
    DONE,
    EVENT_BOUND,
    NOT_FINITE,
    PART,
    PLAIN,
    STALLED,
    STEP_BOUND,
    foot_pointers,
    link_pointers,
    peak_pointers,
    slot_pointers,
    state_pointers,
)
from pounding_cli.kernels.ledger import RULE_ROOM, account, ledger_pointers
from pounding_cli.kernels.link_series import closings
from pounding_cli.kernels.peaks import track, watch
from pounding_cli.kernels.polynomial import NEVER
from pounding_cli.kernels.recurrence import expand, renew_scale, rescale, shrink
from pounding_cli.kernels.simd import further, load, pointer, store
from pounding_cli.kernels.source import source_digest
from pounding_cli.kernels.summary import stop_at, summarise

LARGEST_ORDER = 30
"""No series is longer."""

_ROWS = LARGEST_ORDER + 2

SHORTEST = 1e-14
"""Part of a step [-] below which shortening it would not let time go on."""


def room_needed(padded: int, feet: int, links: int) -> tuple[int, int]:
    """Doubles and integers of scratch that `integrate` needs; the first of the integers are the tally."""
    doubles, integers = room_for(padded, links, _ROWS)
    rows = (_ROWS + 1) * (2 if feet else 1) + 2
    small = 2 * _ROWS + CLOCK + RULE_ROOM + 2 * (_ROWS + 1) * feet + 64
    return doubles + rows * padded + links + small, TALLY + integers


@njit(**PART)
def _carve(slots, feet, links, room, integers):
    """The scratch of a run as records and rows, whole vectors first; returns (run, the room left for foundations)."""
    padded, linked = slots.size, links.size
    by_slot, by_link, by_term = parts_of(padded, linked, _ROWS)
    ends = further(room, (_ROWS + 1) * padded)
    records = further(ends, 2 * padded)
    link_records = further(records, by_slot)
    series = further(link_records, by_link)
    pushed = further(series, by_term)
    clock = further(pushed, linked + 8)
    rule = further(clock, CLOCK)
    reciprocal = further(rule, RULE_ROOM)
    scratch = further(reciprocal, _ROWS)
    tilt = further(scratch, _ROWS)
    ties = further(integers, TALLY)
    reciprocal[0] = 0.0
    for k in range(1, _ROWS):
        reciprocal[k] = 1.0 / k
    run = Run(
        padded, links.number, linked, links.rounds, feet.number, further(room, padded), ends, records,
        further(ties, 8 * linked), link_records, ties, links.gains, links.losses, pushed, series, rule, reciprocal,
        clock, integers, scratch, tilt,
    )  # fmt: skip
    return run, further(tilt, (_ROWS + 1) * padded if feet.number > 0 else 0)


@njit(**PART)
def _set_out(run, starts, slopes):
    """The step that is tried next: to the end of the segment."""
    since = run.clock[SINCE]
    h = run.clock[LENGTH] - since
    segment = run.tally[SEGMENT]
    run.clock[H] = h
    run.clock[PER_H] = 1.0 / h
    run.clock[GROUND] = starts[segment] + slopes[segment] * since
    run.clock[CHANGE] = slopes[segment] * h
    run.clock[END] = NEVER


@njit(**PART)
def _shorten(run, feet, busy, order, tolerance, founded):
    """Shorten a step whose series did not become small enough; returns the part of it that is left [-]."""
    ratio = shrink(run, feet, tolerance)
    if ratio > SHORTEST and ratio < 1.0:
        ratio = 1.0 / np.ceil(1.0 / ratio) if ratio > 0.01 else ratio
        rescale(run, feet, ratio, busy, order, founded)
        run.clock[H] *= ratio
        run.clock[PER_H] /= ratio
        run.clock[CHANGE] *= ratio
    return ratio


@njit(**PART)
def _go_on(run, whole, happened, most_steps, most_events, most_standing):
    """Count a step and move time; returns an outcome, or -1 while the run goes on."""
    clock = run.clock
    tally = run.tally
    tally[STEPS] += 1
    tally[ORDERS] += tally[ORDER]
    if clock[END] > 0.0:
        tally[STANDING] = 0
    clock[SINCE] += clock[H] * clock[END]
    if (whole and clock[END] == 1.0) or clock[SINCE] >= clock[LENGTH]:
        tally[SEGMENT] += 1
        clock[SINCE] = 0.0
    if not np.isfinite(run.ends[0] + run.slots[at(0, V_END)]):
        return NOT_FINITE
    if happened:
        tally[EVENTS] += 1
        tally[STANDING] += 1
        if tally[EVENTS] > most_events:
            return EVENT_BOUND
        if tally[STANDING] > most_standing:
            return STALLED
    return STEP_BOUND if tally[STEPS] > most_steps else -1


@functools.cache
def build():
    """The integrator, compiled on first use; what a scene does not need costs it a few untaken branches."""

    source = source_digest()

    @njit(**PLAIN)
    def integrate(
        slot_arrays, foot_arrays, link_arrays, state_arrays, peak_arrays, ledger_arrays, nodes, weights, room, integers,
        starts, slopes, length, inelastic, tolerance, quiet, most_order, most_steps, most_events, most_standing,
    ):  # fmt: skip
        """Run over all segments of the ground motion, a_g = starts[j] + slopes[j] t within segment j of `length` [s].

        `room` and `integers` are scratch (`room_needed`), zeroed, `room` at a cache line. `nodes` and `weights` are
        Gauss-Legendre rules on [0, 1] (`ledger.MOST_POINTS`). `inelastic`: storeys can yield. `quiet`: the acceleration
        below which nothing is resolved [m/s2]. Fills state, peaks and ledger in place; returns (status, steps, events,
        orders computed, time reached [s]).
        """
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        slots, given_feet, links = slot_pointers(slot_arrays), foot_pointers(foot_arrays), link_pointers(link_arrays)
        state, peaks = state_pointers(state_arrays), peak_pointers(peak_arrays)
        ledger = ledger_pointers(ledger_arrays)
        points, shares = pointer(nodes), pointer(weights)
        accelerations, rates = pointer(starts), pointer(slopes)
        run, rest = _carve(slots, given_feet, links, pointer(room), pointer(integers))
        feet = footing_of(given_feet, state, peaks, ledger, run.feet, _ROWS, rest)
        founded = run.feet > 0
        padded = run.padded
        take_slots(run, slots, state, peaks, ledger)
        take_links(run, links, state, peaks, ledger)
        settle(run)
        run.clock[LENGTH] = length
        run.clock[QUIET] = quiet
        snapped = True  # something may be exactly zero: touching floors at the start, or what an event just met
        status = -1
        while status < 0 and run.tally[SEGMENT] < starts.size:
            _set_out(run, accelerations, rates)
            if founded:
                start_feet(run, feet)
            busy = 0
            curved = 0
            if run.number > 0:
                busy, curved = closings(run, snapped)
            order, close = expand(run, feet, busy, curved, snapped, tolerance, most_order, founded)
            run.tally[ORDER] = order
            whole = True
            if not close:
                ratio = _shorten(run, feet, busy, order, tolerance, founded)
                if not ratio > SHORTEST:
                    status = STEP_BOUND if np.isfinite(ratio) else NOT_FINITE
                    break
                whole = ratio >= 1.0
            summarise(run, feet, order, founded)
            storeys = inelastic and first_storey_event(run, founded)
            linked = run.number > 0 and first_link_event(run)
            if run.clock[END] < 1.0:
                stop_at(run, feet, order, founded)
            else:
                run.clock[END] = 1.0
            account(run, feet, points, shares, order, busy, inelastic, founded)
            track(run, feet, order, busy, inelastic, founded)
            if peaks.watched != 0:
                watch(run, peaks.top, peaks.bottom)
            renew_scale(run)
            if snapped and run.clock[END] > 0.0:
                unsnap(run)
                snapped = False
            if linked:
                link_event(run)
            elif storeys:
                storey_events(run)
            if linked or storeys:
                snapped = True
            status = _go_on(run, whole, linked or storeys, most_steps, most_events, most_standing)
            for b in range(0, padded, 8):
                store(run.W, b - padded, load(run.ends, b))
                store(run.W, b, load(run.slots, at(b, V_END)))
            if founded:
                move_feet(run, feet)
        give_slots(run, state, peaks, ledger)
        give_links(run, state, peaks, ledger)
        time = run.tally[SEGMENT] * length + run.clock[SINCE]
        return max(status, DONE), run.tally[STEPS], run.tally[EVENTS], run.tally[ORDERS], time

    return integrate
