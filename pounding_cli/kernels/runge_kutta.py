"""The classical Runge-Kutta method of fourth order at a fixed step, with and without event location.

With location, every storey and link is held on its branch, the first end of a branch within the step is found on the
quintic through the step's ends, the step is taken again up to there, and the branch changes: fourth order is kept.
Without it, every stage takes storeys and contacts on the branches where they stand at that instant, and the order falls
to first where a step passes over a change. Source: Kutta (1901), Zeitschrift fuer Mathematik und Physik 46; event
location: Shampine & Thompson (2000), Computers & Mathematics with Applications 39(5-6)."""

from __future__ import annotations

import functools

from numba import njit

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.branches import (
    link_branch_end,
    storey_branch_end,
    switch_link,
    switch_storey,
)
from pounding_cli.kernels.forces import closing, deformation
from pounding_cli.kernels.layout import INLINE, OPTIONS
from pounding_cli.kernels.polynomial import NEVER
from pounding_cli.kernels.simd import further
from pounding_cli.kernels.source import source_digest
from pounding_cli.kernels.stepping import (
    EVENTS,
    STEP_CUT,
    STEP_DONE,
    begin_storeys,
    fill_forces,
    march,
    no_event,
    point,
    point_size,
)

# The method's own scratch: storey and link whose branch ends with the step (-1: none), the guard it meets, and whether
# any does; the scratch of polynomials; the points of three stages.
_STOREY, _LINK, _GUARD, _ENDS, _SCRATCH, _STAGES = 0, 1, 2, 3, 4, 20


def memory_needed(slots, elements) -> int:
    """Doubles of the method's own scratch."""
    return _STAGES + 3 * point_size.py_func(slots, elements)


@njit(**INLINE)
def _stage(scene, p, q, r, share, ground, inelastic, located):
    """The point q at p + share * (rates of r), and what it causes."""
    for i in range(scene.elements.freedoms):
        q.u[i] = p.u[i] + share * r.v[i]
        q.v[i] = p.v[i] + share * r.a[i]
    if not located:
        begin_storeys(scene.slots, p, q, inelastic)
    fill_forces(scene, q, ground, inelastic, located)


@njit(**INLINE)
def _step(scene, p, out, own, h, ground, slope, inelastic, located):
    """From p over h to `out`, with what the end causes on the same branches."""
    slots, elements = scene.slots, scene.elements
    each = point_size(slots, elements)
    stages = further(own, _STAGES)
    q2, q3 = point(stages, slots, elements), point(further(stages, each), slots, elements)
    q4 = point(further(stages, 2 * each), slots, elements)
    middle = ground + 0.5 * h * slope
    last = ground + h * slope
    _stage(scene, p, q2, p, 0.5 * h, middle, inelastic, located)
    _stage(scene, p, q3, q2, 0.5 * h, middle, inelastic, located)
    _stage(scene, p, q4, q3, h, last, inelastic, located)
    for i in range(elements.freedoms):
        out.u[i] = p.u[i] + h * p.v[i] + h * h / 6.0 * (p.a[i] + q2.a[i] + q3.a[i])
        out.v[i] = p.v[i] + h / 6.0 * (p.a[i] + 2.0 * (q2.a[i] + q3.a[i]) + q4.a[i])
    if not located:
        begin_storeys(slots, p, out, inelastic)
    fill_forces(scene, out, last, inelastic, located)


@njit(**INLINE)
def _advance(scene, p, out, own, tally, h, ground, slope, inelastic):
    _step(scene, p, out, own, h, ground, slope, inelastic, False)
    return h, STEP_DONE


@njit(**INLINE)
def _first_event(scene, p, out, h, own, inelastic):
    """Where in the step the first branch ends [-]; notes which."""
    slots, elements, links, state = scene.slots, scene.elements, scene.links, scene.state
    scratch = further(own, _SCRATCH)
    earliest = NEVER
    own[_STOREY] = own[_LINK] = -1.0
    if inelastic:
        for i in range(slots.size):
            if slots.branch[i] == t.NO_BRANCH:
                continue
            s, guard = storey_branch_end(
                slots, state, i, h, p.drift[i], deformation(elements, i, p.v), deformation(elements, i, p.a),
                out.drift[i], deformation(elements, i, out.v), deformation(elements, i, out.a), scratch,
            )  # fmt: skip
            if s < earliest:
                earliest = s
                own[_STOREY] = i
                own[_GUARD] = guard
    for e in range(links.number):
        element = elements.springs + e
        s, guard = link_branch_end(
            links, state, e, h,
            closing(elements, links, e, p.u), deformation(elements, element, p.v), deformation(elements, element, p.a),
            closing(elements, links, e, out.u), deformation(elements, element, out.v),
            deformation(elements, element, out.a), scratch,
        )  # fmt: skip
        if s < earliest:
            earliest = s
            own[_STOREY] = -1.0
            own[_LINK] = e
            own[_GUARD] = guard
    return earliest


@njit(**INLINE)
def _advance_to_event(scene, p, out, own, tally, h, ground, slope, inelastic):
    _step(scene, p, out, own, h, ground, slope, inelastic, True)
    s = _first_event(scene, p, out, h, own, inelastic)
    own[_ENDS] = 1.0 if s <= 1.0 else 0.0
    if s > 1.0:
        return h, STEP_DONE
    _step(scene, p, out, own, h * s, ground, slope, inelastic, True)
    tally[EVENTS] += 1
    return h * s, STEP_CUT


@njit(**INLINE)
def _change_branch(scene, p, own, moved, ground, inelastic):
    """What follows a step: the branch that ended changes."""
    state = scene.state
    if moved:
        for e in range(scene.links.number):
            state.pinned_link[e] = t.NOTHING
        for i in range(scene.slots.size):
            state.pinned_storey[i] = 0
    if own[_ENDS] == 0.0:
        return False
    if own[_STOREY] >= 0.0:
        storey = int(own[_STOREY])
        rate = deformation(scene.elements, storey, p.v)
        switch_storey(scene.slots, state, storey, int(own[_GUARD]), p.drift[storey], rate)
    else:
        switch_link(scene.links, state, scene.peaks, int(own[_LINK]), int(own[_GUARD]))
    return True


@functools.cache
def build(inelastic: bool, located: bool):
    """The method for elastic or inelastic storeys, with or without event location, compiled on first use; arguments as
    `stepping.march`."""
    source = source_digest()
    if located:

        @njit(**OPTIONS)
        def integrate_to_events(
            slots, elements, links, state, peaks, memory, tally, starts, slopes, dt, parts, max_events
        ):
            _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
            return march(
                _advance_to_event, _change_branch, True, True, inelastic, slots, elements, links, state, peaks,
                memory, tally, starts, slopes, dt, parts, max_events,
            )  # fmt: skip

        return integrate_to_events

    @njit(**OPTIONS)
    def integrate(slots, elements, links, state, peaks, memory, tally, starts, slopes, dt, parts, max_events):
        _ = source
        return march(
            _advance, no_event, True, False, inelastic, slots, elements, links, state, peaks, memory, tally, starts,
            slopes, dt, parts, max_events,
        )  # fmt: skip

    return integrate
