"""Islands: which buildings of a row have to be solved together in one segment of the ground motion.

Buildings that touch are one island; everything else goes its own way, two by two. Whether two neighbours stay
apart is shown afterwards, by what their floors stay between: where that does not show it, their islands are restored
to the segment's start and solved as one."""

from __future__ import annotations

from numba import njit, types

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, at_link, at_link_integer, of_storey, record_parts, set_range
from pounding_cli.kernels.clock import EVENTS, SEGMENT_LENGTH
from pounding_cli.kernels.frame import DOUBLES, INTEGERS, Frame, filler
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import closed_lanes, side_values
from pounding_cli.kernels.recurrence import update_stencils
from pounding_cli.kernels.simd import further, fused, greater, load, maximum, minimum, no_inline, store
from pounding_cli.kernels.transitions import enter_storey_branch

# What is known of a building, in integers: whether it is taken to touch its right neighbour in this segment; is solved;
# may have something pinned at an event now, and at the segment's end; events in this segment of the island that begins
# with it; whether something happened between it and its right neighbour in the segment before.
JOINED, SOLVED, PINNED, PINNED_AT_END, ISLAND_EVENTS, TOUCHED_BEFORE = range(6)
NOTE_COUNT = 6

APART, TOUCH, FOUND = 0, 1, 2
"""Neighbours in a segment: apart, touching, found to touch after they were solved."""


_POINTERS = {"first_slot": INTEGERS, "first_link": INTEGERS, "slot_places": INTEGERS, "link_places": INTEGERS}
ROW = Frame(
    "row",
    dict.fromkeys(("number", "slots", "links"), types.int64)
    | _POINTERS
    | {"notes": INTEGERS, "checkpoint": DOUBLES, "checkpoint_integers": INTEGERS},
)
"""The fields of `layout.Row`; notes: what is known of every building; checkpoint, checkpoint_integers: doubles and
integers of the islands at the segment's start."""

row_frame = filler(ROW)


@njit(**PART)
def select_island(run, row, left, right):
    """Run the buildings from `left` to `right` alone."""
    set_range(run, (row.first_slot[left], row.first_slot[right + 1], row.first_link[left], row.first_link[right]))


@njit(**PART)
def touches_now(run, row, b):
    """Whether a link between building b and its right neighbour is closed, or is not likely to be shown to stay open
    (`may_touch`): at their present speeds the floors reach as far as it would be asked about."""
    found = 0
    h = run.clock[SEGMENT_LENGTH]
    for e in range(row.first_link[b], row.first_link[b + 1], 8):
        left = side_values(run, run.W, -run.padded, e, c.LEFT_SLOT)
        right = side_values(run, run.W, -run.padded, e, c.RIGHT_SLOT)
        left_ahead = fused(side_values(run, run.W, 0, e, c.LEFT_SLOT), h, left)
        right_ahead = fused(side_values(run, run.W, 0, e, c.RIGHT_SLOT), h, right)
        reach = maximum(left, left_ahead) - minimum(right, right_ahead)
        found |= closed_lanes(run, e) | _closes(run, e, reach)
    return found != 0


@njit(**PART)
def _closes(run, e, reach):
    """Lanes whose open link may close, or come closer than ever before, where the closing is `reach` at most."""
    open_ = greater(load(run.links, at_link(e, c.HIGH)), reach - load(run.links, at_link(e, c.LINK_OFFSET)))
    return (~open_ & 255) | greater(reach, load(run.links, at_link(e, c.PEAK_CLOSING)))


@njit(**PART)
def may_touch(run, row, b):
    """Whether a link between building b and its right neighbour, all of them open, may close in this segment, or come
    closer than ever before."""
    found = 0
    for e in range(row.first_link[b], row.first_link[b + 1], 8):
        rise = side_values(run, run.ends, 2 * run.padded, e, c.LEFT_SLOT)
        found |= _closes(run, e, rise - side_values(run, run.ends, 3 * run.padded, e, c.RIGHT_SLOT))
    return found != 0


@njit(**PART)
def last_of(notes, left):
    """The last building of the island that begins with `left`."""
    right = left
    while notes[right * NOTE_COUNT + JOINED] == TOUCH:
        right += 1
    return right


@njit(**PART)
def first_of(notes, b):
    """The first building of b's island."""
    while b > 0 and notes[(b - 1) * NOTE_COUNT + JOINED] == TOUCH:
        b -= 1
    return b


@njit(**PART)
def _checkpoint_places(run, saved):
    """Where a checkpoint has the records of links, and the rows of displacements and velocities."""
    by_slot, by_link, _ = record_parts(run.padded, run.padded_links, 0)
    links = further(saved, by_slot)
    return links, further(links, by_link)


@njit(**CALLED)
def save_checkpoint(run, row):
    """Save what a step leaves to the next of the buildings that are solved now."""
    no_inline()
    saved = row.checkpoint
    integers = row.checkpoint_integers
    links, rows = _checkpoint_places(run, saved)
    for b in range(run.slot_start, run.slot_stop, 8):
        for place in range(at(b, c.SLOT_CHECKPOINT), at(b, c.SLOT_CHECKPOINT_END), 8):
            store(saved, place, load(run.slots, place))
        store(rows, b, load(run.W, b - run.padded))
        store(rows, run.padded + b, load(run.W, b))
    first = c.STOREY_INTEGER_CHECKPOINT * run.padded
    for b in range(run.link_start, run.link_stop, 8):
        for place in range(at_link(b, c.LINK_CHECKPOINT), at_link(b, c.LINK_CHECKPOINT_END), 8):
            store(links, place, load(run.links, place))
        for place in range(
            at_link_integer(b, c.LINK_INTEGER_CHECKPOINT), at_link_integer(b, c.LINK_INTEGER_CHECKPOINT_END)
        ):
            integers[first + place] = run.link_integers[place]
    for field in range(c.STOREY_INTEGER_CHECKPOINT):
        for i in range(run.slot_start, run.slot_stop):
            integers[of_storey(run, i, field)] = run.storeys[of_storey(run, i, field)]


@njit(**CALLED)
def restore(run, row, building):
    """Restore the island of a building to its checkpoint; it is not solved any more."""
    no_inline()
    left = first_of(row.notes, building)
    right = last_of(row.notes, left)
    select_island(run, row, left, right)
    saved = row.checkpoint
    integers = row.checkpoint_integers
    links, rows = _checkpoint_places(run, saved)
    for b in range(run.slot_start, run.slot_stop, 8):
        for place in range(at(b, c.SLOT_CHECKPOINT), at(b, c.SLOT_CHECKPOINT_END), 8):
            store(run.slots, place, load(saved, place))
        store(run.W, b - run.padded, load(rows, b))
        store(run.W, b, load(rows, run.padded + b))
    first = c.STOREY_INTEGER_CHECKPOINT * run.padded
    for b in range(run.link_start, run.link_stop, 8):
        for place in range(at_link(b, c.LINK_CHECKPOINT), at_link(b, c.LINK_CHECKPOINT_END), 8):
            store(run.links, place, load(links, place))
        for place in range(
            at_link_integer(b, c.LINK_INTEGER_CHECKPOINT), at_link_integer(b, c.LINK_INTEGER_CHECKPOINT_END)
        ):
            run.link_integers[place] = integers[first + place]
    for field in range(c.STOREY_INTEGER_CHECKPOINT):
        for i in range(run.slot_start, run.slot_stop):
            run.storeys[of_storey(run, i, field)] = integers[of_storey(run, i, field)]
    for i in range(run.slot_start, run.slot_stop):
        enter_storey_branch(run, i)
    for i in range(run.slot_start, run.slot_stop):
        update_stencils(run, i)
    run.tally[EVENTS] -= row.notes[left * NOTE_COUNT + ISLAND_EVENTS]
    for b in range(left, right + 1):
        row.notes[b * NOTE_COUNT + SOLVED] = 0


@njit(**CALLED)
def guess_islands(run, row, use_islands):
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


@njit(**CALLED)
def join_touching(run, row):
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
def end_segment(row):
    """End a segment. Neighbours between whom something happened are taken to touch in the next one."""
    notes = row.notes
    for b in range(row.number):
        mine = b * NOTE_COUNT
        together = notes[mine + JOINED] == TOUCH
        notes[mine + TOUCHED_BEFORE] = notes[first_of(notes, b) * NOTE_COUNT + ISLAND_EVENTS] if together else 0
        notes[mine + PINNED] = notes[mine + PINNED_AT_END]
