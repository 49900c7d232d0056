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

from pounding_cli.kernels.cells import (
    BRANCH,
    RUN,
    SCALE,
    V1,
    at,
    give_links,
    give_slots,
    of,
    of_link,
    of_link_integer,
    take_links,
    take_slots,
)
from pounding_cli.kernels.cells import EVENTS_AT_INSTANT as LINK_EVENTS
from pounding_cli.kernels.clock import (
    COLLAPSE_TIME,
    COLLAPSED,
    ELAPSED,
    END,
    EVENT_LINK,
    EVENTS,
    EVENTS_AT_INSTANT,
    GROUND_SLOPE,
    LEAST_SCALE,
    LONGEST_STEP,
    ORDER,
    ORDERS,
    SEGMENT,
    SEGMENT_GROUND,
    SEGMENT_LENGTH,
    STEPS,
    H,
)
from pounding_cli.kernels.collapse import first_collapse, take_limits
from pounding_cli.kernels.column_shears import no_shears, track
from pounding_cli.kernels.crossings import first_link_event, first_storey_event
from pounding_cli.kernels.frame import DOUBLES
from pounding_cli.kernels.from_rest import start_in_touch
from pounding_cli.kernels.history import enter, history_pointers
from pounding_cli.kernels.islands import (
    ISLAND_EVENTS,
    NOTE_COUNT,
    PINNED,
    PINNED_AT_END,
    ROW,
    SOLVED,
    TOUCHED_BEFORE,
    end_segment,
    guess_islands,
    join_touching,
    last_of,
    save_checkpoint,
    select_island,
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
from pounding_cli.kernels.ledger import account, ledger_pointers
from pounding_cli.kernels.peaks import sample
from pounding_cli.kernels.peaks import track as track_peaks
from pounding_cli.kernels.pipelines import in_two
from pounding_cli.kernels.plain_step import plain_step
from pounding_cli.kernels.program_frame import programs_frame
from pounding_cli.kernels.program_step import PLAIN_STEP, no_program_step, program_step
from pounding_cli.kernels.recurrence import renew_scale
from pounding_cli.kernels.scratch import FRAMES, ROWS, lay_out_scratch, settings_frame
from pounding_cli.kernels.simd import further, load, no_inline, pointer, splat, store
from pounding_cli.kernels.source import source_digest
from pounding_cli.kernels.summary import end_at_event, summarise
from pounding_cli.kernels.tangent import (
    begin_segment,
    begin_tangent,
    carry,
    cross_link_event,
    cross_storey_events,
    give_tangent,
    tangent_frame,
)
from pounding_cli.kernels.terms import TERMS, room_for_terms, start_points, terms_frame
from pounding_cli.kernels.transitions import initialise_branches, link_event, storey_events, unpin

INSTANT = 1e-15
"""Part of a step [-] in which time does not go on: velocities that are rounding turn round so soon."""


@njit(**PART)
def _count_step(run, finished, happened, settings):
    """Count a step and move time, to -1 at the segment's end; returns an outcome, or -1 while the run goes on."""
    clock = run.clock
    tally = run.tally
    tally[STEPS] += 1
    tally[ORDERS] += tally[ORDER]
    if clock[END] > INSTANT:
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
def _march(other_step, track_shears, run, tangent, terms, programs, settings, pinned_at_event):
    """Take an island through the segment by series; returns (outcome, or -1; whether something is exactly zero).

    `other_step`: what takes the steps that plain ones cannot. `track_shears`: what a plain step adds to the shears of
    struck columns. `pinned_at_event`: something may be exactly zero:
    touching floors at the start, or what an event just met. `tangent`: that of the run, where one is carried."""
    clock = run.clock
    clock[ELAPSED] = 0.0
    clock[LONGEST_STEP] = clock[SEGMENT_LENGTH]
    status = -1
    while status < 0 and clock[ELAPSED] >= 0.0:
        status, storeys, link, finished = other_step(run, terms, programs, settings)
        if status == PLAIN_STEP:
            status, storeys, link, finished = plain_step(run, terms, settings, pinned_at_event)
            if status < 0:
                track_shears(run, terms)
                if settings.carried > 0:
                    carry(run, tangent, terms, settings.max_order, settings.has_terms > 0)
        if status >= 0:
            break
        renew_scale(run)
        if pinned_at_event and clock[END] > INSTANT:
            unpin(run)
            pinned_at_event = np.bool_(False)
        if link:
            ended = run.link_integers[of_link_integer(run.tally[EVENT_LINK], BRANCH)]
            link_event(run)
            if settings.carried > 0:
                cross_link_event(run, tangent, terms, ended)
        elif storeys:
            storey_events(run)
            if settings.carried > 0:
                cross_storey_events(run, tangent)
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
def _solve_island(run, tangent, terms, programs, settings, pinned_at_event):
    """`_march` by plain steps alone. A function that is passed to one that is called, not copied, could not be kept
    on disk, so there are two of these."""
    no_inline()
    return _march(no_program_step, no_shears, run, tangent, terms, programs, settings, pinned_at_event)


@njit(**CALLED)
def _solve_island_with_programs(run, tangent, terms, programs, settings, pinned_at_event):
    """`_march` with program steps and the shears of struck columns."""
    no_inline()
    return _march(program_step, track, run, tangent, terms, programs, settings, pinned_at_event)


@njit(**PART)
def _solve_islands(solve_island, run, tangent, row, terms, programs, settings):
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
            status, pinned_at_event = solve_island(run, tangent, terms, programs, settings, pinned_at_event)
            if status >= 0:
                return status
            notes[left * NOTE_COUNT + ISLAND_EVENTS] = run.tally[EVENTS] - before
            for b in range(left, right + 1):
                notes[b * NOTE_COUNT + SOLVED] = 1
                notes[b * NOTE_COUNT + PINNED_AT_END] = 1 if pinned_at_event else 0
        left = right + 1
    return -1


@njit(**PART)
def _integrate(
    solve_island, slot_arrays, point_arrays, spring_arrays, link_arrays, row_arrays, state_arrays, peak_arrays,
    ledger_arrays, history_arrays, nodes, weights, memory, integers, starts, slopes, length, inelastic, use_islands,
    watched, booked, growth, tolerance, least_scale, max_order, max_steps, max_events, max_events_at_instant,
):  # fmt: skip
    """Run over all segments of the ground motion, a_g = starts[j] + slopes[j] t within segment j of `length` [s].

    `memory` and `integers` are scratch (`memory_needed`), zeroed, `memory` at a cache line. `nodes` and `weights` are
    Gauss-Legendre rules on [0, 1] (`ledger.MAX_POINTS`). `inelastic`: storeys can yield. `use_islands`: islands are
    looked for; without it the row is one. `watched`: whether a storey collapses, which takes a row that is one.
    `booked`: plain steps book their energies. `growth`: a tangent is carried, of a change of the motion that grows by
    so much a segment [-]; 0: none is.
    `least_scale`: the least acceleration that errors are measured by [m/s2].
    With a history every segment has a length of its own and is begun anew. Fills state, peaks, ledger and history in
    place; returns (status, steps, events, orders computed, time reached [s]).
    """
    slots, links = slot_pointers(slot_arrays), link_pointers(link_arrays)
    state, peaks = state_pointers(state_arrays), peak_pointers(peak_arrays)
    ledger, history = ledger_pointers(ledger_arrays), history_pointers(history_arrays)
    accelerations, rates = pointer(starts), pointer(slopes)
    run, row, frames, rest = lay_out_scratch(links, row_pointers(row_arrays), pointer(memory), pointer(integers))
    springs = spring_pointers(spring_arrays)
    terms = terms_frame(frames, point_pointers(point_arrays), springs, rest)
    settings = settings_frame(further(frames, FRAMES), (
        1 if inelastic else 0, 1 if terms.points + terms.springs > 0 else 0, 1 if use_islands else 0,
        1 if watched else 0, 1 if booked else 0, 1 if growth > 0.0 else 0, max_order, max_steps, max_events,
        max_events_at_instant, tolerance, pointer(nodes), pointer(weights),
    ))  # fmt: skip
    programs = programs_frame(
        further(frames, 2 * FRAMES), run, links.registers, ROWS, further(rest, room_for_terms(springs.size, ROWS)),
        further(frames, 3 * FRAMES),
    )  # fmt: skip
    take_slots(run, row, slots, state, peaks, ledger)
    take_links(run, row, links, state, peaks, ledger)
    take_limits(run, row, slots.collapse)
    start_points(run, terms)
    _start(run, row)
    start_in_touch(run)
    tangent = run
    if growth > 0.0:
        tangent = tangent_frame(
            run, further(frames, 3 * FRAMES), further(rest, room_for_terms(springs.size, ROWS)), ROWS
        )
        begin_tangent(run, tangent)
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
        if growth > 0.0:
            begin_segment(tangent, accelerations[segment], rates[segment], length, growth, segment)
        guess_islands(run, row, use_islands)
        unsettled = True
        while unsettled:
            status = _solve_islands(solve_island, run, tangent, row, terms, programs, settings)
            unsettled = status < 0 and join_touching(run, row)
        if status >= 0:
            break
        end_segment(row)
        if peaks.watched != 0:
            sample(run, row, slots.size, peaks.samples)
        if history.segments > 0:
            enter(run, row, history, segment, slots, links.size)
            begun += run.clock[SEGMENT_LENGTH]
        segment += 1
    give_slots(run, row, slots, state, peaks, ledger)
    give_links(run, row, state, peaks, ledger)
    if growth > 0.0:
        give_tangent(tangent, row, slots.size, links.size, peaks.tangent)
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
def _options() -> dict:
    """How the integrators are compiled: half of the work by another process, those pieces that take it the longest
    and are told in few words."""
    count, whether = types.int64, types.boolean
    pieces = {
        track_peaks: types.void(RUN, count, count, whether),
        account: types.void(RUN, TERMS, DOUBLES, DOUBLES, count, count, count, whether, whether),
        summarise: types.void(RUN, TERMS, count),
        end_at_event: types.void(RUN, TERMS, count),
        first_storey_event: whether(RUN),
        first_link_event: whether(RUN),
        first_collapse: whether(RUN),
        link_event: types.void(RUN),
        storey_events: types.void(RUN),
        join_touching: whether(RUN, ROW),
        guess_islands: types.void(RUN, ROW, whether),
        save_checkpoint: types.void(RUN, ROW),
        _start: types.void(RUN, ROW),
        start_in_touch: types.void(RUN),
        start_points: types.void(RUN, TERMS),
        begin_tangent: types.void(RUN, RUN),
        cross_link_event: types.void(RUN, RUN, TERMS, count),
        cross_storey_events: types.void(RUN, RUN),
        give_tangent: types.void(RUN, ROW, count, count, DOUBLES),
    }
    return {**PLAIN, **in_two(f"pound.{source_digest()}", pieces)}


@functools.cache
def build(programs: bool):
    """The integrator, compiled on first use; what a scene does not need costs it a few untaken branches.

    programs : with the steps that forces written as operations need, and the shears of struck columns
    """

    source = source_digest()
    if programs:

        @njit(**_options())
        def integrate_programs(
            slots, points, springs, links, row, state, peaks, ledger, history, nodes, weights, memory, integers,
            starts, slopes, length, inelastic, use_islands, watched, booked, growth, tolerance, least_scale, max_order,
            max_steps, max_events, max_events_at_instant,
        ):  # fmt: skip
            _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
            return _integrate(
                _solve_island_with_programs, slots, points, springs, links, row, state, peaks, ledger, history, nodes,
                weights, memory, integers, starts, slopes, length, inelastic, use_islands, watched, booked, growth,
                tolerance, least_scale, max_order, max_steps, max_events, max_events_at_instant,
            )  # fmt: skip

        return integrate_programs

    @njit(**_options())
    def integrate(
        slots, points, springs, links, row, state, peaks, ledger, history, nodes, weights, memory, integers, starts,
        slopes, length, inelastic, use_islands, watched, booked, growth, tolerance, least_scale, max_order, max_steps,
        max_events, max_events_at_instant,
    ):  # fmt: skip
        _ = source
        return _integrate(
            _solve_island, slots, points, springs, links, row, state, peaks, ledger, history, nodes, weights, memory,
            integers, starts, slopes, length, inelastic, use_islands, watched, booked, growth, tolerance, least_scale,
            max_order, max_steps, max_events, max_events_at_instant,
        )  # fmt: skip

    return integrate
