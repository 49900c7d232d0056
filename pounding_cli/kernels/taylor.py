"""The event-located Taylor integrator: steps end at a record sample or exactly at an event, whichever is first.

Between two events the motion is analytic, so its Taylor series gives the step, its error and a polynomial in which
events are located to rounding and peaks are found between samples (the recurrence: `recurrence.py`). After an event
the branch changes and the series starts anew, so the order is never lost. Method: Jorba & Zou (2005), Experimental
Mathematics 14(1).

A segment of the ground motion is solved island by island (`islands.py`), each in steps of its own.

One kernel serves all scenes: elastic or not, with foundations or not, whatever their links. Compiling is what a first
run waits for, and an effect that a scene does not have costs a branch that is never taken."""

from __future__ import annotations

import functools

import numpy as np
from numba import njit, types

from pounding_cli.kernels.branching import link_event, settle, storey_events, unsnap
from pounding_cli.kernels.cells import (
    TIE,
    V_END,
    at,
    give_links,
    give_slots,
    of,
    parts_of,
    room_for,
    run_frame,
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
    PACE,
    PER_H,
    QUIET,
    SEGMENT,
    SINCE,
    SLOPE,
    STANDING,
    START,
    STEPS,
    TALLY,
    H,
)
from pounding_cli.kernels.crossings import first_link_event, first_storey_event
from pounding_cli.kernels.foundations import footing_of, move_feet, start_feet
from pounding_cli.kernels.frame import DOUBLES, Frame, filler
from pounding_cli.kernels.islands import (
    APART,
    FOUND,
    FRESH,
    HAPPENED,
    HELD,
    JOINED,
    NEXT,
    NOTES,
    SOLVED,
    TOUCH,
    first_of,
    last_of,
    may_touch,
    put_back,
    row_frame,
    set_apart,
    shelve,
    touch,
)
from pounding_cli.kernels.layout import (
    CALLED,
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
    row_pointers,
    slot_pointers,
    state_pointers,
)
from pounding_cli.kernels.ledger import RULE_ROOM, account, ledger_pointers
from pounding_cli.kernels.link_series import closings
from pounding_cli.kernels.peaks import sample, track, widen
from pounding_cli.kernels.polynomial import NEVER
from pounding_cli.kernels.program_series import programs_frame, room_for_programs
from pounding_cli.kernels.program_step import PLAIN_STEP, no_program_step, program_step
from pounding_cli.kernels.recurrence import expand, renew_scale, rescale, shrink
from pounding_cli.kernels.simd import further, load, pointer, splat, stand_alone, store
from pounding_cli.kernels.source import source_digest
from pounding_cli.kernels.summary import stop_at, summarise

LARGEST_ORDER = 30
"""No series is longer."""

_ROWS = LARGEST_ORDER + 2

SHORTEST = 1e-14
"""Part of a step [-] below which shortening it would not let time go on."""

FEW_PIECES = 0.1
"""Part of a step [-] above which what is left of it is gone through in equal pieces: of a few, one less than might be
saves nothing, where there are many each is as long as can be."""

SETTINGS = Frame(
    "settings",
    dict.fromkeys(
        ("inelastic", "founded", "apart", "most_order", "most_steps", "most_events", "most_standing"), types.int64
    )
    | {"tolerance": types.float64, "nodes": DOUBLES, "weights": DOUBLES},
)
"""What `build` says of its arguments of these names; inelastic, founded, apart: whether storeys can yield, there are
foundations, islands are looked for (1 or 0)."""

_settings_frame = filler(SETTINGS)

FRAMES = 64
"""Integers that each frame has room for."""


def room_needed(
    padded: int, feet: int, links: int, rounds: int, buildings: int, registers: int
) -> tuple[int, int]:
    """Doubles and integers of scratch that `integrate` needs; the first of the integers are the tally. `registers`: of
    a force written as operations; 0 where there is none."""
    doubles, integers = room_for(padded, links, _ROWS)
    rows = (_ROWS + 1) * (2 if feet else 1) + 4
    small = 2 * _ROWS + CLOCK + RULE_ROOM + 2 * (_ROWS + 1) * feet + 64
    shelf, ties = room_for(padded, links, 0)
    tables = 2 * max(rounds, 1) * padded + NOTES * buildings + 5 * FRAMES
    written, resting = room_for_programs(padded, links, registers, feet, _ROWS) if registers else (0, 0)
    return (
        doubles + rows * padded + links + small + shelf + 2 * padded + written,
        TALLY + integers + ties + tables + resting,
    )


@njit(**PART)
def _carve(feet, links, row, room, integers):
    """The scratch of a run as records and rows, whole vectors first; returns (run, row, room for two
    more frames, the room left for foundations)."""
    padded, linked = row.first[row.number], row.joints[row.number - 1]
    by_slot, by_link, by_term = parts_of(padded, linked, _ROWS)
    ends = further(room, (_ROWS + 1) * padded)
    records = further(ends, 4 * padded)
    link_records = further(records, by_slot)
    series = further(link_records, by_link)
    pushed = further(series, by_term)
    clock = further(pushed, linked + 8)
    rule = further(clock, CLOCK)
    shelf = further(rule, RULE_ROOM)
    reciprocal = further(shelf, by_slot + by_link + 2 * padded)
    scratch = further(reciprocal, _ROWS)
    tilt = further(scratch, _ROWS)
    ties = further(integers, TALLY)
    snapped = further(ties, TIE * linked)
    gains = further(snapped, padded)
    losses = further(gains, max(row.rounds, 1) * padded)
    shelved = further(losses, max(row.rounds, 1) * padded)
    notes = further(shelved, padded + TIE * linked)
    reciprocal[0] = 0.0
    for k in range(1, _ROWS):
        reciprocal[k] = 1.0 / k
    run = run_frame(further(notes, NOTES * row.number), (
        0, padded, 0, linked, padded, linked, row.rounds, feet.number, further(room, padded), ends, records, snapped,
        link_records, ties, links.branches, links.guards, links.operations, gains, losses, pushed, series,
        rule, reciprocal, clock, integers, scratch, tilt,
    ))  # fmt: skip
    frames = further(notes, NOTES * row.number + FRAMES)
    lined_up = row_frame(frames, (
        row.number, row.slots, row.links, row.first, row.joints, row.spots, row.seats, notes, shelf, shelved,
    ))  # fmt: skip
    return run, lined_up, further(frames, FRAMES), further(tilt, (_ROWS + 1) * padded if feet.number > 0 else 0)


@njit(**PART)
def _set_out(run):
    """The step that is tried next: to the end of the segment, or as far as the last one that had to be shortened."""
    since = run.clock[SINCE]
    h = run.clock[LENGTH] - since
    whole = h <= run.clock[PACE]
    if not whole:
        h /= np.ceil(h / run.clock[PACE] - 1e-9)
    run.clock[H] = h
    run.clock[PER_H] = 1.0 / h
    run.clock[GROUND] = run.clock[START] + run.clock[SLOPE] * since
    run.clock[CHANGE] = run.clock[SLOPE] * h
    run.clock[END] = NEVER
    return whole  # fault: step-is-whole


@njit(**PART)
def _shorten(run, feet, busy, cut, order, tolerance, founded):
    """Shorten a step whose series did not become small enough; returns the part of it that is left [-]."""
    ratio = shrink(run, feet, cut, tolerance)
    if ratio > SHORTEST and ratio < 1.0:
        paced = ratio > FEW_PIECES
        if paced:
            ratio = 1.0 / np.ceil(1.0 / ratio)
        rescale(run, feet, ratio, busy, order, founded)
        run.clock[H] *= ratio
        run.clock[PER_H] /= ratio
        run.clock[CHANGE] *= ratio
        if paced:
            run.clock[PACE] = run.clock[H]
    return ratio


@njit(**PART)
def _go_on(run, moved, finished, happened, settings):
    """Count a step and move time by so much [s], to -1 at the segment's end; returns an outcome, or -1 while the run
    goes on."""
    clock = run.clock
    tally = run.tally
    tally[STEPS] += 1
    tally[ORDERS] += tally[ORDER]
    if clock[END] > 0.0:
        tally[STANDING] = 0
    clock[SINCE] += moved
    if finished or clock[SINCE] >= clock[LENGTH]:
        clock[SINCE] = -1.0
    if not np.isfinite(run.ends[run.low] + run.slots[of(run.low, V_END)]):
        return NOT_FINITE
    if happened:
        tally[EVENTS] += 1
        tally[STANDING] += 1
        if tally[EVENTS] > settings.most_events:
            return EVENT_BOUND
        if tally[STANDING] > settings.most_standing:
            return STALLED
    return STEP_BOUND if tally[STEPS] > settings.most_steps else -1


@njit(**PART)
def _plain_step(run, feet, settings, snapped):
    """A step by time series; as `program_step`."""
    inelastic = settings.inelastic > 0
    founded = settings.founded > 0
    tolerance = settings.tolerance
    linked = run.last > run.first
    clock = run.clock
    whole = _set_out(run)
    if founded:
        start_feet(run, feet)
    busy = 0
    curved = 0
    cut = 0
    if linked:
        busy, curved, cut = closings(run, snapped)
    order, close = expand(run, feet, busy, curved, cut, snapped, tolerance, settings.most_order, founded)
    run.tally[ORDER] = order
    if not close:
        ratio = _shorten(run, feet, busy, cut, order, tolerance, founded)
        if not ratio > SHORTEST:
            return STEP_BOUND if np.isfinite(ratio) else NOT_FINITE, False, False, False
        whole = whole and ratio >= 1.0
    summarise(run, feet, order, founded)
    storeys = inelastic and first_storey_event(run, founded)
    link = linked and first_link_event(run)
    if clock[END] < 1.0:
        stop_at(run, feet, order, founded)
    else:
        clock[END] = 1.0
    account(run, feet, settings.nodes, settings.weights, order, busy, curved, inelastic, founded)
    track(run, feet, order, busy, inelastic, founded)
    if settings.apart > 0:
        widen(run)
    return -1, storeys, link, whole and clock[END] == 1.0


@njit(**PART)
def _through(other_step, run, feet, programs, settings, snapped):
    """Take an island through the segment by series; returns (outcome, or -1; whether something is exactly zero).

    `other_step`: what takes the steps that plain ones cannot. `snapped`: something may be exactly zero: touching floors
    at the start, or what an event just met."""
    founded = settings.founded > 0
    clock = run.clock
    clock[SINCE] = 0.0
    clock[PACE] = clock[LENGTH]
    status = -1
    while status < 0 and clock[SINCE] >= 0.0:
        status, storeys, link, finished = other_step(run, feet, programs, settings)
        moved = clock[H]
        if status == PLAIN_STEP:
            status, storeys, link, finished = _plain_step(run, feet, settings, snapped)
            moved = clock[H] * clock[END]
        if status >= 0:
            break
        renew_scale(run)
        if snapped and clock[END] > 0.0:
            unsnap(run)
            snapped = False
        if link:
            link_event(run)
        elif storeys:
            storey_events(run)
        if link or storeys:
            snapped = True
            clock[PACE] = clock[LENGTH]
        status = _go_on(run, moved, finished, link or storeys, settings)
        for b in range(run.low, run.high, 8):
            store(run.W, b - run.padded, load(run.ends, b))
            store(run.W, b, load(run.slots, at(b, V_END)))
        if founded:
            move_feet(run, feet)
    return status, snapped


@njit(**CALLED)
def _cross(run, feet, programs, settings, snapped):
    """`_through` by plain steps alone. A function that is passed to one that is called, not copied, could not be kept
    on disk, so there are two of these."""
    stand_alone()
    return _through(no_program_step, run, feet, programs, settings, snapped)


@njit(**CALLED)
def _cross_with_programs(run, feet, programs, settings, snapped):
    """`_through` with program steps."""
    stand_alone()
    return _through(program_step, run, feet, programs, settings, snapped)


@njit(**CALLED)
def _part(run, row, apart):
    """Begin a segment: who touches whom, as far as one can tell. A link that is closed or has just opened counts, so
    that none outside an island has anything left that it pushes with.

    Two neighbours that are alone are taken together: a step of both costs little more than a step of one."""
    stand_alone()
    notes = row.notes
    alone = False
    for b in range(row.number):
        mine = b * NOTES
        notes[mine + SOLVED] = 0
        joined = APART
        if b + 1 < row.number:
            held = notes[mine + HELD] + notes[mine + FRESH] + notes[mine + NOTES + FRESH] > 0
            joined = TOUCH if held or not apart or touch(run, row, b) else APART
        notes[mine + JOINED] = joined
        before = b > 0 and notes[mine - NOTES + JOINED] == TOUCH
        if joined == TOUCH or before:
            alone = False
        elif alone:
            notes[mine - NOTES + JOINED] = TOUCH
            alone = False
        else:
            alone = True


@njit(**PART)
def _solve(cross, run, row, feet, programs, settings):
    """Solve every island that is not solved yet; returns an outcome, or -1."""
    notes = row.notes
    left = 0
    while left < row.number:
        right = last_of(notes, left)
        if notes[left * NOTES + SOLVED] == 0:
            set_apart(run, row, left, right)
            if left > 0 or right + 1 < row.number:
                shelve(run, row)
            snapped = False
            for b in range(left, right + 1):
                snapped = snapped or notes[b * NOTES + FRESH] > 0
            for b in range(run.low, run.high, 8):
                store(run.ends, 2 * run.padded + b, splat(-1e300))
                store(run.ends, 3 * run.padded + b, splat(1e300))
            before = run.tally[EVENTS]
            status, snapped = cross(run, feet, programs, settings, snapped)
            if status >= 0:
                return status
            notes[left * NOTES + HAPPENED] = run.tally[EVENTS] - before
            for b in range(left, right + 1):
                notes[b * NOTES + SOLVED] = 1
                notes[b * NOTES + NEXT] = 1 if snapped else 0
        left = right + 1
    return -1


@njit(**CALLED)
def _join(run, row):
    """Join solved neighbours that may touch after all, and put them back; returns whether there are any."""
    stand_alone()
    notes = row.notes
    found = False
    for b in range(row.number - 1):
        solved = notes[b * NOTES + SOLVED] > 0 and notes[(b + 1) * NOTES + SOLVED] > 0
        if notes[b * NOTES + JOINED] == APART and solved and may_touch(run, row, b):
            notes[b * NOTES + JOINED] = FOUND
            found = True
            for side in (b, b + 1):
                put_back(run, row, side)
    for b in range(row.number - 1):
        if notes[b * NOTES + JOINED] == FOUND:
            notes[b * NOTES + JOINED] = TOUCH
    return found


@njit(**PART)
def _go_ashore(row):
    """End a segment. Neighbours between whom something happened are taken to touch in the next one."""
    notes = row.notes
    for b in range(row.number):
        mine = b * NOTES
        together = notes[mine + JOINED] == TOUCH
        notes[mine + HELD] = notes[first_of(notes, b) * NOTES + HAPPENED] if together else 0
        notes[mine + FRESH] = notes[mine + NEXT]


@njit(**PART)
def _integrate(
    cross, slot_arrays, foot_arrays, link_arrays, row_arrays, state_arrays, peak_arrays, ledger_arrays, nodes,
    weights, room, integers, starts, slopes, length, inelastic, apart, tolerance, quiet, most_order, most_steps,
    most_events, most_standing,
):  # fmt: skip
    """Run over all segments of the ground motion, a_g = starts[j] + slopes[j] t within segment j of `length` [s].

    `room` and `integers` are scratch (`room_needed`), zeroed, `room` at a cache line. `nodes` and `weights` are
    Gauss-Legendre rules on [0, 1] (`ledger.MOST_POINTS`). `inelastic`: storeys can yield. `apart`: islands are
    looked for; without it the row is one. `quiet`: the acceleration below which nothing is resolved [m/s2]. Fills
    state, peaks and ledger in place; returns (status, steps, events, orders computed, time reached [s]).
    """
    slots, given_feet, links = slot_pointers(slot_arrays), foot_pointers(foot_arrays), link_pointers(link_arrays)
    state, peaks = state_pointers(state_arrays), peak_pointers(peak_arrays)
    ledger = ledger_pointers(ledger_arrays)
    accelerations, rates = pointer(starts), pointer(slopes)
    run, row, frames, rest = _carve(given_feet, links, row_pointers(row_arrays), pointer(room), pointer(integers))
    feet = footing_of(frames, given_feet, state, peaks, ledger, run.feet, _ROWS, rest)
    founded = 1 if run.feet > 0 else 0
    settings = _settings_frame(further(frames, FRAMES), (
        1 if inelastic else 0, founded, 1 if apart else 0, most_order, most_steps, most_events, most_standing,
        tolerance, pointer(nodes), pointer(weights),
    ))  # fmt: skip
    programs = programs_frame(
        further(frames, 2 * FRAMES), run, links.registers, _ROWS, further(rest, 2 * (_ROWS + 1) * run.feet),
        further(frames, 3 * FRAMES),
    )  # fmt: skip
    take_slots(run, row, slots, state, peaks, ledger)
    take_links(run, row, links, state, peaks, ledger)
    settle(run)
    run.clock[LENGTH] = length
    run.clock[QUIET] = quiet
    for b in range(row.number):
        row.notes[b * NOTES + FRESH] = 1
    status = -1
    segment = 0
    while segment < starts.size:
        run.tally[SEGMENT] = segment
        run.clock[START] = accelerations[segment]
        run.clock[SLOPE] = rates[segment]
        _part(run, row, apart)
        unsettled = True
        while unsettled:
            status = _solve(cross, run, row, feet, programs, settings)
            unsettled = status < 0 and _join(run, row)
        if status >= 0:
            break
        _go_ashore(row)
        if peaks.watched != 0:
            sample(run, row, slots.size, peaks.samples)
        segment += 1
    give_slots(run, row, state, peaks, ledger)
    give_links(run, row, state, peaks, ledger)
    time = segment * length + (max(run.clock[SINCE], 0.0) if segment < starts.size else 0.0)
    return max(status, DONE), run.tally[STEPS], run.tally[EVENTS], run.tally[ORDERS], time


@functools.cache
def build(programs: bool):
    """The integrator, compiled on first use; what a scene does not need costs it a few untaken branches.

    programs : with the steps that forces written as operations need
    """

    source = source_digest()
    if programs:

        @njit(**PLAIN)
        def integrate_programs(
            slots, feet, links, row, state, peaks, ledger, nodes, weights, room, integers, starts, slopes, length,
            inelastic, apart, tolerance, quiet, most_order, most_steps, most_events, most_standing,
        ):  # fmt: skip
            _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
            return _integrate(
                _cross_with_programs, slots, feet, links, row, state, peaks, ledger, nodes, weights, room, integers, starts,
                slopes, length, inelastic, apart, tolerance, quiet, most_order, most_steps, most_events, most_standing,
            )  # fmt: skip

        return integrate_programs

    @njit(**PLAIN)
    def integrate(
        slots, feet, links, row, state, peaks, ledger, nodes, weights, room, integers, starts, slopes, length,
        inelastic, apart, tolerance, quiet, most_order, most_steps, most_events, most_standing,
    ):  # fmt: skip
        _ = source
        return _integrate(
            _cross, slots, feet, links, row, state, peaks, ledger, nodes, weights, room, integers, starts,
            slopes, length, inelastic, apart, tolerance, quiet, most_order, most_steps, most_events, most_standing,
        )  # fmt: skip

    return integrate
