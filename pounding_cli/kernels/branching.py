"""The branches of storeys and links: what an event changes."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import link_table as t
from pounding_cli.kernels.cells import of, of_link, of_tie
from pounding_cli.kernels.clock import END, GUARD, LINK
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import difference, set_law
from pounding_cli.kernels.recurrence import restencil
from pounding_cli.kernels.simd import stand_alone
from pounding_cli.kernels.storey_law import coefficients, transit


@njit(**PART)
def _storey_branch(run, i):
    """Stiffness and offset of the branch storey i is on."""
    slots = run.slots
    slots[of(i, c.TANGENT)], slots[of(i, c.OFFSET)] = coefficients(
        slots[of(i, c.STIFFNESS)], slots[of(i, c.HARDENING)], slots[of(i, c.PLATEAU)], slots[of(i, c.LINE)],
        slots[of(i, c.PLASTIC)],
    )  # fmt: skip


@njit(**CALLED)
def settle(run):
    """Laws and stencils of the branches the state is on."""
    stand_alone()
    for i in range(run.padded):
        _storey_branch(run, i)  # fault: run-goes-on
    for i in range(run.padded):
        restencil(run, i)
    for e in range(run.linked):
        set_law(run, e)


@njit(**PART)
def _storey_event(run, i, drift):
    """Change the branch of storey i, which leaves its own at `drift` [m]."""
    slots = run.slots
    slots[of(i, c.LINE)], slots[of(i, c.PLASTIC)], run.snapped[i] = transit(
        slots[of(i, c.LINE)], slots[of(i, c.PLASTIC)], slots[of(i, c.YIELD_DRIFT)], drift
    )
    _storey_branch(run, i)  # fault: storey-unloads
    restencil(run, i)
    if i >= 1:
        restencil(run, i - 1)


@njit(**CALLED)
def storey_events(run):
    """Change all storeys that leave their branch at the time of the first, so that twins stay twins."""
    stand_alone()
    end = run.clock[END]
    for i in range(run.low, run.high):
        if run.slots[of(i, c.ROOT)] == end:
            _storey_event(run, i, run.slots[of(i, c.DRIFT)])


@njit(**PART)
def _event_value(run, e, quantity):
    """Closing [m] or rate [m/s] of link e at the step's end."""
    left, right = run.ties[of_tie(e, c.LEFT_SLOT)], run.ties[of_tie(e, c.RIGHT_SLOT)]
    if quantity == t.CLOSING:
        return run.ends[left] - run.ends[right] - run.links[of_link(e, c.LEAVES_OUT)]
    return difference(run.slots[of(left, c.V_END)], run.slots[of(right, c.V_END)], 0.0)


@njit(**CALLED)
def link_event(run):
    """Change the branch of the link whose event comes first."""
    stand_alone()
    e = run.tally[LINK]
    g = run.tally[GUARD]
    run.ties[of_tie(e, c.BRANCH)] = int(t.guard(run, g, t.NEXT))
    run.ties[of_tie(e, c.SNAPPED)] = int(t.guard(run, g, t.QUANTITY))
    memory = run.links[of_link(e, c.MEMORY)]
    run.links[of_link(e, c.EXACTLY)] = t.guard(run, g, t.AT) + t.guard(run, g, t.OF_MEMORY) * memory
    if t.guard(run, g, t.REMEMBERS) != t.NOTHING:
        run.links[of_link(e, c.MEMORY)] = _event_value(run, e, t.guard(run, g, t.REMEMBERS))
    run.ties[of_tie(e, c.IMPACTS)] += int(t.guard(run, g, t.IMPACT))
    run.links[of_link(e, c.TURNS)] += 1.0
    set_law(run, e)


@njit(**CALLED)
def unsnap(run):
    """Time goes on: nothing is exactly zero any more."""
    stand_alone()
    for e in range(run.first, run.last):
        run.ties[of_tie(e, c.SNAPPED)] = t.NOTHING
        run.links[of_link(e, c.TURNS)] = 0.0
    for i in range(run.low, run.high):
        run.snapped[i] = 0
