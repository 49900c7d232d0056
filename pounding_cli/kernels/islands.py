"""Islands: which buildings of a row have to be solved together in one segment of the ground motion.

Buildings that touch are one island; everything else goes its own way, two by two. Whether two neighbours stay
apart is shown afterwards, by what their floors stay between: where that does not show it, their islands are put back
to the segment's start and solved as one."""

from __future__ import annotations

from numba import njit, types

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, at_link, at_tie, focus, parts_of
from pounding_cli.kernels.clock import EVENTS, LENGTH
from pounding_cli.kernels.frame import DOUBLES, INTEGERS, Frame, filler
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import beside, closed_at
from pounding_cli.kernels.recurrence import restencil
from pounding_cli.kernels.simd import further, fused, greater, load, maximum, minimum, stand_alone, store

# What is known of a building, in integers: whether it is taken to touch its right neighbour in this segment; is solved;
# may have something exactly zero now, and at the segment's end; events in this segment of the island that begins with
# it; whether something happened between it and its right neighbour in the segment before.
JOINED, SOLVED, FRESH, NEXT, HAPPENED, HELD = range(6)
NOTES = 6

APART, TOUCH, FOUND = 0, 1, 2
"""Neighbours in a segment: apart, touching, found to touch after they were solved."""


_POINTERS = {"first": INTEGERS, "joints": INTEGERS, "spots": INTEGERS, "seats": INTEGERS}
ROW = Frame(
    "row",
    dict.fromkeys(("number", "slots", "links"), types.int64)
    | _POINTERS
    | {"notes": INTEGERS, "shelf": DOUBLES, "shelved": INTEGERS},
)
"""The fields of `layout.Row`; notes: what is known of every building; shelf and shelved: doubles and integers of what
islands were at the segment's start."""

row_frame = filler(ROW)


@njit(**PART)
def set_apart(run, row, left, right):
    """Run the buildings from `left` to `right` alone."""
    focus(run, (row.first[left], row.first[right + 1], row.joints[left], row.joints[right]))


@njit(**PART)
def touch(run, row, b):
    """Whether a link between building b and its right neighbour is closed, or is not likely to be shown to stay open
    (`may_touch`): at their present speeds the floors reach as far as it would be asked about."""
    found = 0
    h = run.clock[LENGTH]
    for e in range(row.joints[b], row.joints[b + 1], 8):
        left = beside(run, run.W, -run.padded, e, c.LEFT_SLOT)
        right = beside(run, run.W, -run.padded, e, c.RIGHT_SLOT)
        left_ahead = fused(beside(run, run.W, 0, e, c.LEFT_SLOT), h, left)
        right_ahead = fused(beside(run, run.W, 0, e, c.RIGHT_SLOT), h, right)
        reach = maximum(left, left_ahead) - minimum(right, right_ahead)
        found |= closed_at(run, e) | _closes(run, e, reach)
    return found != 0


@njit(**PART)
def _closes(run, e, reach):
    """Lanes whose open link may close, or come closer than ever before, where the closing is `reach` at most."""
    open_ = greater(load(run.links, at_link(e, c.HIGH)), reach - load(run.links, at_link(e, c.LEAVES_OUT)))
    return (~open_ & 255) | greater(reach, load(run.links, at_link(e, c.MOST_CLOSING)))


@njit(**PART)
def may_touch(run, row, b):
    """Whether a link between building b and its right neighbour, all of them open, may close in this segment, or come
    closer than ever before."""
    found = 0
    for e in range(row.joints[b], row.joints[b + 1], 8):
        rise = beside(run, run.ends, 2 * run.padded, e, c.LEFT_SLOT)
        # fault: neighbours-may-meet
        found |= _closes(run, e, rise - beside(run, run.ends, 3 * run.padded, e, c.RIGHT_SLOT))
    return found != 0


@njit(**PART)
def last_of(notes, left):
    """The last building of the island that begins with `left`."""
    right = left
    while notes[right * NOTES + JOINED] == TOUCH:
        right += 1
    return right


@njit(**PART)
def first_of(notes, b):
    """The first building of b's island."""
    while b > 0 and notes[(b - 1) * NOTES + JOINED] == TOUCH:
        b -= 1
    return b


@njit(**PART)
def _shelves(run, shelf):
    """Where records of slots and links, and rows of displacements and velocities, are kept."""
    by_slot, by_link, _ = parts_of(run.padded, run.linked, 0)
    links = further(shelf, by_slot)
    return links, further(links, by_link)


@njit(**CALLED)
def shelve(run, row):
    """Keep what a step leaves to the next one of the buildings that are run."""
    stand_alone()
    shelf = row.shelf
    ties = row.shelved
    links, rows = _shelves(run, shelf)
    for b in range(run.low, run.high, 8):
        for place in range(at(b, c.SLOT_LEFT), at(b, c.SLOT_LEFT_END), 8):
            store(shelf, place, load(run.slots, place))
        store(rows, b, load(run.W, b - run.padded))
        store(rows, run.padded + b, load(run.W, b))
    for b in range(run.first, run.last, 8):
        for place in range(at_link(b, c.LINK_LEFT), at_link(b, c.LINK_LEFT_END), 8):
            store(links, place, load(run.links, place))
        for place in range(at_tie(b, c.TIE_LEFT), at_tie(b, c.TIE_LEFT_END)):
            ties[run.padded + place] = run.ties[place]
    for i in range(run.low, run.high):
        ties[i] = run.snapped[i]


@njit(**CALLED)
def put_back(run, row, building):
    """The island of a building as it was kept; it is not solved any more."""
    stand_alone()
    left = first_of(row.notes, building)
    right = last_of(row.notes, left)
    set_apart(run, row, left, right)
    shelf = row.shelf
    ties = row.shelved
    links, rows = _shelves(run, shelf)
    for b in range(run.low, run.high, 8):
        for place in range(at(b, c.SLOT_LEFT), at(b, c.SLOT_LEFT_END), 8):
            store(run.slots, place, load(shelf, place))
        store(run.W, b - run.padded, load(rows, b))
        store(run.W, b, load(rows, run.padded + b))  # fault: island-velocities-put-back
    for b in range(run.first, run.last, 8):
        for place in range(at_link(b, c.LINK_LEFT), at_link(b, c.LINK_LEFT_END), 8):
            store(run.links, place, load(links, place))
        for place in range(at_tie(b, c.TIE_LEFT), at_tie(b, c.TIE_LEFT_END)):
            run.ties[place] = ties[run.padded + place]
    for i in range(run.low, run.high):
        run.snapped[i] = ties[i]
        restencil(run, i)  # fault: island-stencils-put-back
    run.tally[EVENTS] -= row.notes[left * NOTES + HAPPENED]
    for b in range(left, right + 1):
        row.notes[b * NOTES + SOLVED] = 0
