"""The branches of storeys and links: what an event changes."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import link_table as t
from pounding_cli.kernels.cells import of, of_link, of_link_integer
from pounding_cli.kernels.clock import END, EVENT_GUARD, EVENT_LINK
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import difference, set_law
from pounding_cli.kernels.recurrence import update_stencils
from pounding_cli.kernels.simd import no_inline
from pounding_cli.kernels.storey_law import coefficients, transition


@njit(**PART)
def _storey_branch(run, i):
    """Stiffness and offset of the branch storey i is on."""
    slots = run.slots
    slots[of(i, c.TANGENT)], slots[of(i, c.OFFSET)] = coefficients(
        slots[of(i, c.STIFFNESS)], slots[of(i, c.HARDENING)], slots[of(i, c.PLATEAU)], slots[of(i, c.LINE)],
        slots[of(i, c.PLASTIC)],
    )  # fmt: skip


@njit(**CALLED)
def initialise_branches(run):
    """Laws and stencils of the branches the state is on."""
    no_inline()
    for i in range(run.padded):
        _storey_branch(run, i)  # fault: run-goes-on
    for i in range(run.padded):
        update_stencils(run, i)
    for e in range(run.padded_links):
        set_law(run, e)


@njit(**PART)
def _storey_event(run, i, drift):
    """Change the branch of storey i, which leaves its own at `drift` [m]."""
    slots = run.slots
    slots[of(i, c.LINE)], slots[of(i, c.PLASTIC)], run.pinned[i] = transition(
        slots[of(i, c.LINE)], slots[of(i, c.PLASTIC)], slots[of(i, c.YIELD_DRIFT)], drift
    )
    _storey_branch(run, i)  # fault: storey-unloads
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
            _storey_event(run, i, run.slots[of(i, c.DRIFT1)])


@njit(**PART)
def _event_value(run, e, quantity):
    """Closing [m] or rate [m/s] of link e at the step's end."""
    left, right = (
        run.link_integers[of_link_integer(e, c.LEFT_SLOT)],
        run.link_integers[of_link_integer(e, c.RIGHT_SLOT)],
    )
    if quantity == t.CLOSING:
        return run.ends[left] - run.ends[right] - run.links[of_link(e, c.LINK_OFFSET)]
    return difference(run.slots[of(left, c.V1)], run.slots[of(right, c.V1)], 0.0)


@njit(**CALLED)
def link_event(run):
    """Change the branch of the link whose event comes first."""
    no_inline()
    e = run.tally[EVENT_LINK]
    g = run.tally[EVENT_GUARD]
    run.link_integers[of_link_integer(e, c.BRANCH)] = int(t.guard(run, g, t.NEXT))
    run.link_integers[of_link_integer(e, c.PINNED_AT_EVENT)] = int(t.guard(run, g, t.QUANTITY))
    memory = run.links[of_link(e, c.MEMORY)]
    run.links[of_link(e, c.PINNED_CLOSING)] = t.guard(run, g, t.AT) + t.guard(run, g, t.OF_MEMORY) * memory
    if t.guard(run, g, t.REMEMBERS) != t.NOTHING:
        run.links[of_link(e, c.MEMORY)] = _event_value(run, e, t.guard(run, g, t.REMEMBERS))
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
        run.pinned[i] = 0
