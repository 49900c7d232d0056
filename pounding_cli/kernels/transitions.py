"""The branches of storeys and links: what an event changes."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import of, of_link, of_link_integer, of_storey
from pounding_cli.kernels.clock import END, EVENT_GUARD, EVENT_LINK
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import difference, set_law
from pounding_cli.kernels.recurrence import update_stencils
from pounding_cli.kernels.simd import no_inline
from pounding_cli.kernels.storey_law import coefficient, guard_at_rest, remember
from pounding_cli.laws.program import MEMORIES


@njit(**CALLED)
def enter_storey_branch(run, i):
    """Everything that follows from the branch storey i is on and from what it remembers."""
    no_inline()
    slots = run.slots
    b = run.storeys[of_storey(run, i, c.STOREY_BRANCH)]
    place = of(i, c.STOREY_MEMORY)
    tangent, offset = slots[of(i, c.STIFFNESS)], 0.0
    if b != t.NO_BRANCH:
        tangent = coefficient(run, b, t.LINEAR, slots, place, 8)
        offset = coefficient(run, b, t.OFFSET, slots, place, 8)
    lost, slope = t.branch(run, b, t.LOST), 0.0
    stiffness = t.branch(run, b, t.GIVES_BACK)
    if stiffness > 0.0:  # what an unloading gives back is shear^2 / (2 stiffness)
        part = 1.0 - tangent / stiffness
        lost, slope = part * offset, part * tangent
    slots[of(i, c.TANGENT)], slots[of(i, c.OFFSET)] = tangent, offset
    slots[of(i, c.LOST)], slots[of(i, c.LOST_SLOPE)] = lost, slope
    slots[of(i, c.DRIFT_LOW)] = coefficient(run, b, t.LOW, slots, place, 8)
    slots[of(i, c.DRIFT_HIGH)] = coefficient(run, b, t.HIGH, slots, place, 8)
    slots[of(i, c.TURNS)] = t.branch(run, b, t.TURNS)


@njit(**CALLED)
def initialise_branches(run):
    """Laws and stencils of the branches the state is on."""
    no_inline()
    for i in range(run.padded):
        enter_storey_branch(run, i)
    for i in range(run.padded):
        update_stencils(run, i)
    for e in range(run.padded_links):
        set_law(run, e)


@njit(**PART)
def _storey_event(run, i):
    """Change the branch of storey i, which leaves its own at the end of the step."""
    slots = run.slots
    left = run.storeys[of_storey(run, i, c.STOREY_BRANCH)]
    g = run.storeys[of_storey(run, i, c.STOREY_GUARD)]
    drift, rate = slots[of(i, c.DRIFT1)], slots[of(i, c.DRIFT_RATE1)]
    remember(run, g, drift, rate, slots, np.int64(MEMORIES), of(i, c.STOREY_MEMORY), 8)
    b = int(t.guard(run, g, t.NEXT))
    run.storeys[of_storey(run, i, c.STOREY_BRANCH)] = b
    rests = run.storeys[of_storey(run, i, c.STOREY_PINNED)] == g
    pinned = guard_at_rest(run, b, left, t.guard(run, g, t.QUANTITY), rests)
    run.storeys[of_storey(run, i, c.STOREY_PINNED)] = pinned
    run.storeys[of_storey(run, i, c.STOREY_EVENTS)] += 1
    enter_storey_branch(run, i)
    update_stencils(run, i)
    if i >= 1:
        update_stencils(run, i - 1)


@njit(**CALLED)
def storey_events(run):
    """Change all storeys that leave their branch at the time of the first, so that twins stay twins."""
    no_inline()
    end = run.clock[END]
    for i in range(run.slot_start, run.slot_stop):
        if run.slots[of(i, c.EVENT_ROOT)] == end:
            _storey_event(run, i)


@njit(**PART)
def _closing_and_rate(run, e):
    """Closing [m] and rate [m/s] of link e at the step's end."""
    left, right = (
        run.link_integers[of_link_integer(e, c.LEFT_SLOT)],
        run.link_integers[of_link_integer(e, c.RIGHT_SLOT)],
    )
    closing = run.ends[left] - run.ends[right] - run.links[of_link(e, c.LINK_OFFSET)]
    return closing, difference(run.slots[of(left, c.V1)], run.slots[of(right, c.V1)], 0.0)


@njit(**CALLED)
def link_event(run):
    """Change the branch of the link whose event comes first."""
    no_inline()
    e = run.tally[EVENT_LINK]
    g = run.tally[EVENT_GUARD]
    run.link_integers[of_link_integer(e, c.BRANCH)] = int(t.guard(run, g, t.NEXT))
    run.link_integers[of_link_integer(e, c.PINNED_AT_EVENT)] = int(t.guard(run, g, t.QUANTITY))
    memory = run.links[of_link(e, c.MEMORY)]
    run.links[of_link(e, c.PINNED_CLOSING)] = t.guard(run, g, t.AT) + t.guard(run, g, t.FACTOR) * memory
    closing, rate = _closing_and_rate(run, e)
    remember(run, g, closing, rate, run.links, np.int64(1), of_link(e, c.MEMORY), 8)
    run.link_integers[of_link_integer(e, c.IMPACTS)] += int(t.guard(run, g, t.IMPACT))
    run.links[of_link(e, c.EVENTS_AT_INSTANT)] += 1.0
    set_law(run, e)


@njit(**CALLED)
def unpin(run):
    """Time goes on: nothing is exactly zero any more."""
    no_inline()
    for e in range(run.link_start, run.link_stop):
        run.link_integers[of_link_integer(e, c.PINNED_AT_EVENT)] = t.NOTHING
        run.links[of_link(e, c.EVENTS_AT_INSTANT)] = 0.0
    for i in range(run.slot_start, run.slot_stop):
        run.storeys[of_storey(run, i, c.STOREY_PINNED)] = 0
        run.storeys[of_storey(run, i, c.STOREY_EVENTS)] = 0
