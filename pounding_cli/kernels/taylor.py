"""The event-located Taylor integrator: steps end at a record sample or exactly at an event, whichever is first.

Between two events the motion is analytic, so its Taylor series gives the step, its error and a polynomial in which
events are located to rounding and peaks are found between samples (the recurrence: `recurrence.py`). After an event
the branch changes and the series starts anew, so the order is never lost. Method: Jorba & Zou (2005), Experimental
Mathematics 14(1).

A segment of the ground motion is solved island by island (`islands.py`), each in steps of its own.

One kernel serves all scenes: elastic or not, on any foundations, whatever their links. Compiling is what a first
run waits for, and an effect that a scene does not have costs a branch that is never taken."""

from __future__ import annotations

import functools

import numpy as np
from numba import njit, types

from pounding_cli.kernels.cells import EVENTS_AT_INSTANT as LINK_EVENTS
from pounding_cli.kernels.cells import (
    LINK_INTEGERS,
    SCALE,
    STOREY_INTEGERS,
    V1,
    at,
    give_links,
    give_slots,
    of,
    of_link,
    record_parts,
    record_sizes,
    run_frame,
    take_links,
    take_slots,
)
from pounding_cli.kernels.clock import (
    CLOCK_SIZE,
    COLLAPSE_TIME,
    COLLAPSED,
    ELAPSED,
    END,
    EVENTS,
    EVENTS_AT_INSTANT,
    GROUND,
    GROUND_CHANGE,
    GROUND_SLOPE,
    INVERSE_H,
    LEAST_SCALE,
    LONGEST_STEP,
    ORDER,
    ORDERS,
    SEGMENT,
    SEGMENT_GROUND,
    SEGMENT_LENGTH,
    STEPS,
    TALLY_SIZE,
    H,
)
from pounding_cli.kernels.collapse import first_collapse, take_limits
from pounding_cli.kernels.column_shears import track as track_column_shears
from pounding_cli.kernels.crossings import first_link_event, first_storey_event
from pounding_cli.kernels.frame import DOUBLES, Frame, filler
from pounding_cli.kernels.from_rest import start_in_touch
from pounding_cli.kernels.history import enter, history_pointers
from pounding_cli.kernels.islands import (
    APART,
    FOUND,
    ISLAND_EVENTS,
    JOINED,
    NOTE_COUNT,
    PINNED,
    PINNED_AT_END,
    SOLVED,
    TOUCH,
    TOUCHED_BEFORE,
    first_of,
    last_of,
    may_touch,
    restore,
    row_frame,
    save_checkpoint,
    select_island,
    touches_now,
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
    link_pointers,
    peak_pointers,
    point_pointers,
    row_pointers,
    slot_pointers,
    spring_pointers,
    state_pointers,
)
from pounding_cli.kernels.layout import COLLAPSED as COLLAPSE
from pounding_cli.kernels.ledger import RULE_SIZE, account, ledger_pointers
from pounding_cli.kernels.link_series import start_closings
from pounding_cli.kernels.peaks import sample, track, widen_ranges
from pounding_cli.kernels.polynomial import NEVER
from pounding_cli.kernels.program_series import programs_frame, room_for_programs
from pounding_cli.kernels.program_step import PLAIN_STEP, no_program_step, program_step
from pounding_cli.kernels.recurrence import expand, is_finite, renew_scale, rescale, shrink
from pounding_cli.kernels.simd import further, load, no_inline, pointer, splat, store
from pounding_cli.kernels.source import source_digest
from pounding_cli.kernels.summary import end_at_event, summarise
from pounding_cli.kernels.terms import rescale_springs, room_for_terms, start_points, terms_frame
from pounding_cli.kernels.transitions import initialise_branches, link_event, storey_events, unpin

MAX_ORDER = 30
"""No series is longer."""

_ROWS = MAX_ORDER + 2

SHORTEST = 1e-14
"""Part of a step, and of a segment, [-] below which shortening a step would not let time go on."""

MOST_TRIES = 6
"""Times that a step whose series leaves the range of doubles is made shorter, by `MUCH_SHORTER` each: what has next to
no mass may be so fast that the powers of its frequency overflow."""

MUCH_SHORTER = 1e-4

FEW_PIECES = 0.1
"""Part of a step [-] above which what is left of it is gone through in equal pieces: of a few, one less than might be
saves nothing, where there are many each is as long as can be."""

SETTINGS = Frame(
    "settings",
    dict.fromkeys(
        (
            "inelastic",
            "has_terms",
            "use_islands",
            "watched",
            "max_order",
            "max_steps",
            "max_events",
            "max_events_at_instant",
        ),
        types.int64,
    )
    | {"tolerance": types.float64, "nodes": DOUBLES, "weights": DOUBLES},
)
"""What `_integrate` says of its arguments of these names; inelastic, has_terms, use_islands: whether storeys can yield,
there are points or springs (`terms`), islands and collapse (`watched`) are looked for (1 or 0)."""

_settings_frame = filler(SETTINGS)

FRAMES = 64
"""Most integers of a frame."""


def memory_needed(
    padded: int, links: int, links_per_side: int, buildings: int, registers: int, springs: int
) -> tuple[int, int]:
    """Doubles and integers of scratch that `integrate` needs; the first of the integers are the tally. `registers`: of
    a force written as operations; 0 where there is none."""
    doubles, integers = record_sizes(padded, links, _ROWS)
    rows = _ROWS + 1 + 5
    small = 2 * _ROWS + CLOCK_SIZE + RULE_SIZE + 64
    saved, link_integers = record_sizes(padded, links, 0)
    tables = 2 * max(links_per_side, 1) * padded + NOTE_COUNT * buildings + 5 * FRAMES
    written, resting = room_for_programs(padded, links, registers, _ROWS) if registers else (0, 0)
    return (
        doubles + rows * padded + links + small + saved + 2 * padded + written + room_for_terms.py_func(springs, _ROWS),
        TALLY_SIZE + integers + link_integers + tables + resting,
    )


@njit(**PART)
def _lay_out_scratch(links, row, memory, integers):
    """The scratch of a run as records and rows, whole vectors first; returns (run, row, where three more frames and
    whole numbers go, where doubles go)."""
    padded, padded_links = row.first_slot[row.number], row.first_link[row.number - 1]
    by_slot, by_link, by_term = record_parts(padded, padded_links, _ROWS)
    ends = further(memory, (_ROWS + 1) * padded)
    records = further(ends, 5 * padded)
    link_records = further(records, by_slot)
    series = further(link_records, by_link)
    link_forces = further(series, by_term)
    clock = further(link_forces, padded_links + 8)
    rule = further(clock, CLOCK_SIZE)
    checkpoint = further(rule, RULE_SIZE)
    reciprocal = further(checkpoint, by_slot + by_link + 2 * padded)
    scratch = further(reciprocal, _ROWS)
    link_integers = further(integers, TALLY_SIZE)
    storeys = further(link_integers, LINK_INTEGERS * padded_links)
    left_links = further(storeys, STOREY_INTEGERS * padded)
    right_links = further(left_links, max(row.links_per_side, 1) * padded)
    checkpoint_integers = further(right_links, max(row.links_per_side, 1) * padded)
    notes = further(checkpoint_integers, STOREY_INTEGERS * padded + LINK_INTEGERS * padded_links)
    reciprocal[0] = 0.0
    for k in range(1, _ROWS):
        reciprocal[k] = 1.0 / k
    run = run_frame(further(notes, NOTE_COUNT * row.number), (
        0, padded, 0, padded_links, padded, padded_links, row.links_per_side,
        further(memory, padded), ends, records, storeys, link_records, link_integers, links.branches, links.guards,
        links.operations, left_links, right_links, link_forces, series, rule, reciprocal, clock, integers, scratch,
    ))  # fmt: skip
    frames = further(notes, NOTE_COUNT * row.number + FRAMES)
    row_places = row_frame(frames, (
        row.number, row.slots, row.links, row.first_slot, row.first_link, row.slot_places, row.link_places, notes,
        checkpoint, checkpoint_integers,
    ))  # fmt: skip
    return run, row_places, further(frames, FRAMES), further(scratch, _ROWS)


@njit(**PART)
def _begin_step(run):
    """The step that is tried next: to the end of the segment, or as far as the last one that had to be shortened."""
    elapsed = run.clock[ELAPSED]
    h = run.clock[SEGMENT_LENGTH] - elapsed
    whole = h <= run.clock[LONGEST_STEP]
    if not whole:
        h /= np.ceil(h / run.clock[LONGEST_STEP] - 1e-9)
    run.clock[H] = h
    run.clock[INVERSE_H] = 1.0 / h
    run.clock[GROUND] = run.clock[SEGMENT_GROUND] + run.clock[GROUND_SLOPE] * elapsed
    run.clock[GROUND_CHANGE] = run.clock[GROUND_SLOPE] * h
    run.clock[END] = NEVER
    return whole  # fault: step-is-whole


@njit(**PART)
def _scale_step(run, ratio):
    """Make the step `ratio` times as long."""
    run.clock[H] *= ratio
    run.clock[INVERSE_H] /= ratio
    run.clock[GROUND_CHANGE] *= ratio


@njit(**PART)
def _shorten(run, terms, any_closed, cut, order, has_terms):
    """Shorten a step whose series did not become small enough; returns the part of it that is left [-]."""
    ratio = shrink(run, cut)
    if ratio > SHORTEST and ratio < 1.0:
        paced = ratio > FEW_PIECES
        if paced:
            ratio = 1.0 / np.ceil(1.0 / ratio)
        rescale(run, ratio, any_closed, order)
        if has_terms:
            rescale_springs(run, terms, order, ratio)
        _scale_step(run, ratio)
        if paced:
            run.clock[LONGEST_STEP] = run.clock[H]
    return ratio


@njit(**PART)
def _count_step(run, finished, happened, settings):
    """Count a step and move time, to -1 at the segment's end; returns an outcome, or -1 while the run goes on."""
    clock = run.clock
    tally = run.tally
    tally[STEPS] += 1
    tally[ORDERS] += tally[ORDER]
    if clock[END] > 0.0:
        tally[EVENTS_AT_INSTANT] = 0
    clock[ELAPSED] += clock[H] * clock[END]
    if finished or clock[ELAPSED] >= clock[SEGMENT_LENGTH]:
        clock[ELAPSED] = -1.0
    if not np.isfinite(run.ends[run.slot_start] + run.slots[of(run.slot_start, V1)]):
        return NOT_FINITE
    if happened:
        tally[EVENTS] += 1
        tally[EVENTS_AT_INSTANT] += 1
        if tally[EVENTS] > settings.max_events:
            return EVENT_BOUND
        if tally[EVENTS_AT_INSTANT] > settings.max_events_at_instant:
            return STALLED
    return STEP_BOUND if tally[STEPS] > settings.max_steps else -1


@njit(**PART)
def _plain_step(run, terms, settings, pinned_at_event):
    """A step by time series; as `program_step`."""
    inelastic = settings.inelastic > 0
    has_terms = settings.has_terms > 0
    linked = run.link_stop > run.link_start
    clock = run.clock
    whole = _begin_step(run)
    shortened = False
    for _ in range(MOST_TRIES):
        any_closed = 0
        curved = 0
        cut = 0
        if linked:
            any_closed, curved, cut = start_closings(run, pinned_at_event)
        order, close = expand(
            run, terms, any_closed, curved, cut, pinned_at_event, settings.tolerance, settings.max_order, has_terms
        )
        run.tally[ORDER] = order
        ratio = 1.0 if close and is_finite(run, order) else _shorten(run, terms, any_closed, cut, order, has_terms)
        shortened = shortened or not ratio >= 1.0
        if np.isfinite(ratio):
            break
        _scale_step(run, MUCH_SHORTER)
        clock[LONGEST_STEP] = clock[H]
    if not ratio > SHORTEST or (shortened and not clock[H] > SHORTEST * clock[SEGMENT_LENGTH]):
        return STEP_BOUND if np.isfinite(ratio) else NOT_FINITE, False, False, False
    summarise(run, terms, order)
    storeys = inelastic and first_storey_event(run)
    link = linked and first_link_event(run)
    if settings.watched > 0 and first_collapse(run):  # fault: collapse-in-time
        storeys, link = False, False
    if clock[END] < 1.0:
        end_at_event(run, terms, order)
    else:
        clock[END] = 1.0
    account(run, terms, settings.nodes, settings.weights, order, any_closed, curved, inelastic, has_terms)
    track(run, order, any_closed, inelastic)
    if terms.shears > 0:
        track_column_shears(run, terms)
    if settings.use_islands > 0:
        widen_ranges(run)
    return -1, storeys, link, whole and not shortened and clock[END] == 1.0


@njit(**PART)
def _march(other_step, run, terms, programs, settings, pinned_at_event):
    """Take an island through the segment by series; returns (outcome, or -1; whether something is exactly zero).

    `other_step`: what takes the steps that plain ones cannot. `pinned_at_event`: something may be exactly zero:
    touching floors at the start, or what an event just met."""
    clock = run.clock
    clock[ELAPSED] = 0.0
    clock[LONGEST_STEP] = clock[SEGMENT_LENGTH]
    status = -1
    while status < 0 and clock[ELAPSED] >= 0.0:
        status, storeys, link, finished = other_step(run, terms, programs, settings)
        if status == PLAIN_STEP:
            status, storeys, link, finished = _plain_step(run, terms, settings, pinned_at_event)
        if status >= 0:
            break
        renew_scale(run)
        if pinned_at_event and clock[END] > 0.0:
            unpin(run)
            pinned_at_event = np.bool_(False)
        if link:
            link_event(run)
        elif storeys:
            storey_events(run)
        if link or storeys:
            pinned_at_event = True
            clock[LONGEST_STEP] = clock[SEGMENT_LENGTH]
        collapsed = settings.watched > 0 and run.tally[COLLAPSED] > 0
        if collapsed:
            clock[COLLAPSE_TIME] = clock[ELAPSED] + clock[H] * clock[END]
        status = _count_step(run, finished, link or storeys, settings)
        for b in range(run.slot_start, run.slot_stop, 8):
            store(run.W, b - run.padded, load(run.ends, b))
            store(run.W, b, load(run.slots, at(b, V1)))
        if collapsed and status < 0:
            status = COLLAPSE
    return status, pinned_at_event


@njit(**CALLED)
def _solve_island(run, terms, programs, settings, pinned_at_event):
    """`_march` by plain steps alone. A function that is passed to one that is called, not copied, could not be kept
    on disk, so there are two of these."""
    no_inline()
    return _march(no_program_step, run, terms, programs, settings, pinned_at_event)


@njit(**CALLED)
def _solve_island_with_programs(run, terms, programs, settings, pinned_at_event):
    """`_march` with program steps."""
    no_inline()
    return _march(program_step, run, terms, programs, settings, pinned_at_event)


@njit(**CALLED)
def _guess_islands(run, row, use_islands):
    """Begin a segment: who touches whom, as far as one can tell. A link that is closed or has just opened counts, so
    that none outside an island has anything left that it pushes with.

    Two neighbours that are alone are taken together: a step of both costs little more than a step of one."""
    no_inline()
    notes = row.notes
    alone = False
    for b in range(row.number):
        mine = b * NOTE_COUNT
        notes[mine + SOLVED] = 0
        joined = APART
        if b + 1 < row.number:
            held = notes[mine + TOUCHED_BEFORE] + notes[mine + PINNED] + notes[mine + NOTE_COUNT + PINNED] > 0
            joined = TOUCH if held or not use_islands or touches_now(run, row, b) else APART
        notes[mine + JOINED] = joined
        before = b > 0 and notes[mine - NOTE_COUNT + JOINED] == TOUCH
        if joined == TOUCH or before:
            alone = False
        elif alone:
            notes[mine - NOTE_COUNT + JOINED] = TOUCH
            alone = False
        else:
            alone = True


@njit(**PART)
def _solve_islands(solve_island, run, row, terms, programs, settings):
    """Solve every island that is not solved yet; returns an outcome, or -1."""
    notes = row.notes
    left = np.int64(0)  # with a plain 0 numba would compile what is given the number twice
    while left < row.number:
        right = last_of(notes, left)
        if notes[left * NOTE_COUNT + SOLVED] == 0:
            select_island(run, row, left, right)
            if left > 0 or right + 1 < row.number:
                save_checkpoint(run, row)
            pinned_at_event = np.bool_(False)  # likewise
            for b in range(left, right + 1):
                pinned_at_event = pinned_at_event or notes[b * NOTE_COUNT + PINNED] > 0
            for b in range(run.slot_start, run.slot_stop, 8):
                store(run.ends, 2 * run.padded + b, splat(-1e300))
                store(run.ends, 3 * run.padded + b, splat(1e300))
            before = run.tally[EVENTS]
            status, pinned_at_event = solve_island(run, terms, programs, settings, pinned_at_event)
            if status >= 0:
                return status
            notes[left * NOTE_COUNT + ISLAND_EVENTS] = run.tally[EVENTS] - before
            for b in range(left, right + 1):
                notes[b * NOTE_COUNT + SOLVED] = 1
                notes[b * NOTE_COUNT + PINNED_AT_END] = 1 if pinned_at_event else 0
        left = right + 1
    return -1


@njit(**CALLED)
def _join_touching(run, row):
    """Join solved neighbours that may touch after all, and put them back; returns whether there are any."""
    no_inline()
    notes = row.notes
    found = False
    for b in range(row.number - 1):
        solved = notes[b * NOTE_COUNT + SOLVED] > 0 and notes[(b + 1) * NOTE_COUNT + SOLVED] > 0
        if notes[b * NOTE_COUNT + JOINED] == APART and solved and may_touch(run, row, b):
            notes[b * NOTE_COUNT + JOINED] = FOUND
            found = True
            for side in (b, b + 1):
                restore(run, row, side)
    for b in range(row.number - 1):
        if notes[b * NOTE_COUNT + JOINED] == FOUND:
            notes[b * NOTE_COUNT + JOINED] = TOUCH
    return found


@njit(**PART)
def _end_segment(row):
    """End a segment. Neighbours between whom something happened are taken to touch in the next one."""
    notes = row.notes
    for b in range(row.number):
        mine = b * NOTE_COUNT
        together = notes[mine + JOINED] == TOUCH
        notes[mine + TOUCHED_BEFORE] = notes[first_of(notes, b) * NOTE_COUNT + ISLAND_EVENTS] if together else 0
        notes[mine + PINNED] = notes[mine + PINNED_AT_END]


@njit(**PART)
def _integrate(
    solve_island, slot_arrays, point_arrays, spring_arrays, link_arrays, row_arrays, state_arrays, peak_arrays,
    ledger_arrays, history_arrays, nodes, weights, memory, integers, starts, slopes, length, inelastic, use_islands,
    watched, tolerance, least_scale, max_order, max_steps, max_events, max_events_at_instant,
):  # fmt: skip
    """Run over all segments of the ground motion, a_g = starts[j] + slopes[j] t within segment j of `length` [s].

    `memory` and `integers` are scratch (`memory_needed`), zeroed, `memory` at a cache line. `nodes` and `weights` are
    Gauss-Legendre rules on [0, 1] (`ledger.MAX_POINTS`). `inelastic`: storeys can yield. `use_islands`: islands are
    looked for; without it the row is one. `watched`: whether a storey collapses, which takes a row that is one.
    `least_scale`: the least acceleration that errors are measured by [m/s2].
    With a history every segment has a length of its own and is begun anew. Fills state, peaks, ledger and history in
    place; returns (status, steps, events, orders computed, time reached [s]).
    """
    slots, links = slot_pointers(slot_arrays), link_pointers(link_arrays)
    state, peaks = state_pointers(state_arrays), peak_pointers(peak_arrays)
    ledger, history = ledger_pointers(ledger_arrays), history_pointers(history_arrays)
    accelerations, rates = pointer(starts), pointer(slopes)
    run, row, frames, rest = _lay_out_scratch(links, row_pointers(row_arrays), pointer(memory), pointer(integers))
    springs = spring_pointers(spring_arrays)
    terms = terms_frame(frames, point_pointers(point_arrays), springs, rest)
    settings = _settings_frame(further(frames, FRAMES), (
        1 if inelastic else 0, 1 if terms.points + terms.springs > 0 else 0, 1 if use_islands else 0,
        1 if watched else 0, max_order, max_steps, max_events, max_events_at_instant, tolerance, pointer(nodes),
        pointer(weights),
    ))  # fmt: skip
    programs = programs_frame(
        further(frames, 2 * FRAMES), run, links.registers, _ROWS, further(rest, room_for_terms(springs.size, _ROWS)),
        further(frames, 3 * FRAMES),
    )  # fmt: skip
    take_slots(run, row, slots, state, peaks, ledger)
    take_links(run, row, links, state, peaks, ledger)
    take_limits(run, row, slots.collapse)
    start_points(run, terms)
    _start(run, row)
    start_in_touch(run)
    run.clock[SEGMENT_LENGTH] = length
    run.clock[LEAST_SCALE] = least_scale
    status = -1
    segment = np.int64(0)  # likewise
    begun = 0.0
    while segment < starts.size:
        run.tally[SEGMENT] = segment
        if history.segments > 0:
            run.clock[SEGMENT_LENGTH] = history.lengths[segment]
            if segment > 0:
                _start(run, row)
        run.clock[SEGMENT_GROUND] = accelerations[segment]
        run.clock[GROUND_SLOPE] = rates[segment]
        _guess_islands(run, row, use_islands)
        unsettled = True
        while unsettled:
            status = _solve_islands(solve_island, run, row, terms, programs, settings)
            unsettled = status < 0 and _join_touching(run, row)
        if status >= 0:
            break
        _end_segment(row)
        if peaks.watched != 0:
            sample(run, row, slots.size, peaks.samples)
        if history.segments > 0:
            enter(run, row, history, segment, slots.size, links.size)
            begun += run.clock[SEGMENT_LENGTH]
        segment += 1
    give_slots(run, row, slots.size, state, peaks, ledger)
    give_links(run, row, state, peaks, ledger)
    time = begun if history.segments > 0 else segment * length
    if segment < starts.size:
        time += run.clock[COLLAPSE_TIME] if status == COLLAPSE else max(run.clock[ELAPSED], 0.0)
    return max(status, DONE), run.tally[STEPS], run.tally[EVENTS], run.tally[ORDERS], time


@njit(**CALLED)
def _start(run, row):
    """Begin with the state as it is: branches anew, nothing known of accelerations, all may be pinned at an event."""
    no_inline()
    initialise_branches(run)
    for i in range(run.padded):
        run.slots[of(i, SCALE)] = 0.0
    for e in range(run.padded_links):
        run.links[of_link(e, LINK_EVENTS)] = 0.0
    for b in range(row.number):
        row.notes[b * NOTE_COUNT + PINNED] = 1
        row.notes[b * NOTE_COUNT + TOUCHED_BEFORE] = 0
    run.tally[EVENTS_AT_INSTANT] = 0


@functools.cache
def build(programs: bool):
    """The integrator, compiled on first use; what a scene does not need costs it a few untaken branches.

    programs : with the steps that forces written as operations need
    """

    source = source_digest()
    if programs:

        @njit(**PLAIN)
        def integrate_programs(
            slots, points, springs, links, row, state, peaks, ledger, history, nodes, weights, memory, integers,
            starts, slopes, length, inelastic, use_islands, watched, tolerance, least_scale, max_order, max_steps,
            max_events, max_events_at_instant,
        ):  # fmt: skip
            _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
            return _integrate(
                _solve_island_with_programs, slots, points, springs, links, row, state, peaks, ledger, history, nodes,
                weights, memory, integers, starts, slopes, length, inelastic, use_islands, watched, tolerance,
                least_scale, max_order, max_steps, max_events, max_events_at_instant,
            )  # fmt: skip

        return integrate_programs

    @njit(**PLAIN)
    def integrate(
        slots, points, springs, links, row, state, peaks, ledger, history, nodes, weights, memory, integers, starts,
        slopes, length, inelastic, use_islands, watched, tolerance, least_scale, max_order, max_steps, max_events,
        max_events_at_instant,
    ):  # fmt: skip
        _ = source
        return _integrate(
            _solve_island, slots, points, springs, links, row, state, peaks, ledger, history, nodes, weights, memory,
            integers, starts, slopes, length, inelastic, use_islands, watched, tolerance, least_scale, max_order,
            max_steps, max_events, max_events_at_instant,
        )  # fmt: skip

    return integrate
