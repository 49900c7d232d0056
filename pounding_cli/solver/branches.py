"""The branches of elements: entered at rest, changed at events, and what follows from them for a step."""

from __future__ import annotations

from numba import njit

from pounding_cli.laws.guards import (
    COLLAPSE_LOW,
    FASTER,
    HIGH,
    LEVELS,
    LOW,
    SLIPS_LEFT,
    SLIPS_RIGHT,
    SLOWER,
    START,
)
from pounding_cli.solver.dispatch import next_branch
from pounding_cli.solver.events import INSTANT
from pounding_cli.solver.options import CALLED, PART
from pounding_cli.solver.polynomial import NEVER
from pounding_cli.solver.records import COLLAPSED, ITS_FORCE, RATE, RATE_AND_SLOPE, VALUE
from pounding_cli.solver.stick import hold_or_release

TOUCH = 1e-11
"""Of floors in touch at rest, the parting [m] before which they are in contact since the motion began where they press,
and the closing before which they are not in contact where they part: what is less hangs on rounding."""


@njit(**CALLED)
def enter_first_branches(elements, run, series):
    """Put all elements on their branches at rest."""
    for e in range(run.m):
        elements[e].guard = START
        next_branch(elements[e], elements[e].guard)
    list_active(elements, run, series)


@njit(**CALLED)
def change_branches(dofs, elements, terms, run, series):
    """Change all elements that leave their branch at the end of this step, so that equal buildings stay equal."""
    for e in range(run.m):
        el = elements[e]
        if el.at == run.end and el.at < NEVER:
            if el.guard >= COLLAPSE_LOW:
                run.status = COLLAPSED
                continue
            _pin(el, run.end)
            was_open = el.closed == 0
            if el.smooth and el.guard == LOW:
                run.across = run.h
            next_branch(el, el.guard)
            if el.slides:
                hold_or_release(dofs[e], el)
            has_touched = el.least > -TOUCH
            if was_open and el.closed:
                el.hits = 1 if has_touched else el.hits + 1
                if has_touched:
                    el.time = run.time - run.begun
                if el.smooth:
                    run.next = max(run.onset, 0.0)
                    run.onset = -1.0
            elif not el.closed and has_touched and el.peak_v < TOUCH:
                el.time = 0.0
                el.hits = 0
            el.stuck += 1
            run.events += 1
    if run.lines:
        gather_lines(elements, run)
    list_active(elements, run, series)


@njit(**PART)
def _pin(el, end):
    """Keep what is exactly known of an element that meets its guard at s = `end`.

    A force that passes zero inside a step is zero there. One that has the wrong sign as the step begins has jumped to
    its value at the event before, as an infill's does at its thickness: it is what it is, and not zero.
    """
    guard = el.guard
    if guard == LOW or guard == HIGH:
        el.exact = el.low if guard == LOW else el.high
        el.v0 = el.v1 = el.exact
        el.pinned = VALUE
    elif guard == SLOWER or guard == FASTER:
        el.r0 = el.r1 = el.slow if guard == SLOWER else el.fast
        el.pinned = RATE
    elif guard == LEVELS:
        el.pinned = RATE_AND_SLOPE if end > INSTANT else RATE
    elif guard == SLIPS_RIGHT or guard == SLIPS_LEFT:  # from rest, with forces that balance unless they jumped
        el.r0 = el.r1 = 0.0
        el.pinned = RATE_AND_SLOPE if end > INSTANT else RATE
    elif end > 0.0:
        el.pinned = ITS_FORCE


@njit(**CALLED)
def unpin(elements, run):
    """Forget what was exactly known of elements: time goes on."""
    for e in range(run.m):
        elements[e].pinned = elements[e].stuck = 0


@njit(**CALLED)
def list_active(elements, run, series):
    """List the links whose force is not zero, and note whether a step has to be taken by DOP853."""
    run.active = 0
    run.smooth = run.always_smooth
    for e in range(run.m):
        el = elements[e]
        if el.smooth:
            run.smooth = 1
        if e >= run.n and (el.smooth if el.drifts else el.closed):
            el.row = run.active
            series[run.active].element = e
            run.active += 1


@njit(**CALLED)
def gather_lines(elements, run):
    """Add stiffnesses, dashpots and offsets of the frame lines on their present branches up in their storeys.

    Lines whose force is smooth act by themselves.
    """
    for i in range(run.n):
        el = elements[i]
        if el.twists:
            el.k = el.p[0]
            el.c = el.p[1]
            el.f0 = el.coupled_k = el.coupled_c = 0.0
    for e in range(run.n + run.drags, run.n + run.drags + run.lines):
        el = elements[e]
        if el.smooth:
            continue
        storey = elements[el.storey]
        mate = elements[el.mate]
        lever = el.lever
        if el.along != 0.0:
            storey.k += el.k
            storey.c += el.c
            storey.f0 += el.f0
            storey.coupled_k += lever * el.k
            storey.coupled_c += lever * el.c
            mate.coupled_k += lever * el.k
            mate.coupled_c += lever * el.c
        mate.k += lever * lever * el.k
        mate.c += lever * lever * el.c
        mate.f0 += lever * el.f0
    for i in range(run.n):
        el = elements[i]
        if el.twists:
            el.stiffness = el.k - el.load
