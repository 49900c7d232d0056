"""The classical Runge-Kutta method of fourth order at a fixed step, with and without event location.

With location, every storey and link is held on its branch, the first end of a branch within the step is found on the
quintic through the step's ends, the step is taken again up to there, and the branch changes: fourth order is kept.
Without it, every stage sees the return mapping and the contacts as they are, and the order falls to first where a step
passes over a change. Source: Kutta (1901), Zeitschrift fuer Mathematik und Physik 46; event location: Shampine &
Thompson (2000), Computers & Mathematics with Applications 39(5-6)."""

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
from pounding_cli.kernels.layout import INLINE, OPTIONS
from pounding_cli.kernels.link_force import closing_of
from pounding_cli.kernels.polynomial import NEVER
from pounding_cli.kernels.simd import further
from pounding_cli.kernels.source import source_digest
from pounding_cli.kernels.stepping import (
    BY_SLOT,
    EVENTS,
    STEP_CUT,
    STEP_DONE,
    begin_storeys,
    drift_rate_of,
    fill_forces,
    march,
    no_event,
    point,
    point_size,
)

# The method's own scratch: storey and link whose branch ends with the step (-1: none), the guard it meets, and whether
# any does; the scratch of polynomials; the points of three stages.
_STOREY, _LINK, _GUARD, _ENDS, _SCRATCH, _STAGES = 0, 1, 2, 3, 4, 20


def memory_needed(size: int, foundations: int, links: int) -> int:
    """Doubles of the method's own scratch."""
    return _STAGES + 3 * point_size(size, foundations, links)


@njit(**INLINE)
def _stage(scene, p, q, r, share, ground, inelastic, located):
    """The point q at p + share * (rates of r), and what it causes."""
    for i in range(scene.slots.size):
        q.u[i] = p.u[i] + share * r.v[i]
        q.v[i] = p.v[i] + share * r.a[i]
    for f in range(scene.foundations.number):
        q.phi[f] = p.phi[f] + share * r.phi_v[f]
        q.phi_v[f] = p.phi_v[f] + share * r.phi_a[f]
    if not located:
        begin_storeys(scene.slots, p, q, inelastic)
    fill_forces(scene, q, ground, inelastic, located)


@njit(**INLINE)
def _step(scene, p, out, own, h, ground, slope, inelastic, located):
    """From p over h to `out`, with what the end causes on the same branches."""
    slots, foundations, links = scene.slots, scene.foundations, scene.links
    each = BY_SLOT * slots.size + 3 * foundations.number + links.size
    stages = further(own, _STAGES)
    q2, q3 = point(stages, slots, foundations, links), point(further(stages, each), slots, foundations, links)
    q4 = point(further(stages, 2 * each), slots, foundations, links)
    middle = ground + 0.5 * h * slope
    last = ground + h * slope
    _stage(scene, p, q2, p, 0.5 * h, middle, inelastic, located)
    _stage(scene, p, q3, q2, 0.5 * h, middle, inelastic, located)
    _stage(scene, p, q4, q3, h, last, inelastic, located)
    for i in range(slots.size):
        out.u[i] = p.u[i] + h * p.v[i] + h * h / 6.0 * (p.a[i] + q2.a[i] + q3.a[i])
        out.v[i] = p.v[i] + h / 6.0 * (p.a[i] + 2.0 * (q2.a[i] + q3.a[i]) + q4.a[i])  # fault: runge-kutta-stages
    for f in range(foundations.number):
        out.phi[f] = p.phi[f] + h * p.phi_v[f] + h * h / 6.0 * (p.phi_a[f] + q2.phi_a[f] + q3.phi_a[f])
        out.phi_v[f] = p.phi_v[f] + h / 6.0 * (p.phi_a[f] + 2.0 * (q2.phi_a[f] + q3.phi_a[f]) + q4.phi_a[f])
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
    slots, foundations, links, state = scene.slots, scene.foundations, scene.links, scene.state
    scratch = further(own, _SCRATCH)
    earliest = NEVER
    own[_STOREY] = own[_LINK] = -1.0
    if inelastic:
        for i in range(slots.size):
            if slots.branch[i] == t.NO_BRANCH:
                continue
            s, guard = storey_branch_end(
                slots, state, i, h,
                p.drift[i], drift_rate_of(slots, foundations, i, p.v, p.phi_v),
                drift_rate_of(slots, foundations, i, p.a, p.phi_a),
                out.drift[i], drift_rate_of(slots, foundations, i, out.v, out.phi_v),
                drift_rate_of(slots, foundations, i, out.a, out.phi_a),
                scratch,
            )  # fmt: skip
            if s < earliest:
                earliest = s
                own[_STOREY] = i
                own[_GUARD] = guard
    for e in range(links.number):
        left = links.left[e]
        right = links.right[e]
        s, guard = link_branch_end(
            links, state, e, h,
            closing_of(links, e, p.u), p.v[left] - p.v[right], p.a[left] - p.a[right],
            closing_of(links, e, out.u), out.v[left] - out.v[right], out.a[left] - out.a[right],
            scratch,
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
    _step(scene, p, out, own, h * s, ground, slope, inelastic, True)  # fault: event-ends-step
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
        rate = drift_rate_of(scene.slots, scene.foundations, storey, p.v, p.phi_v)
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
            slots, foundations, links, state, peaks, memory, tally, starts, slopes, dt, parts, max_events
        ):
            _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
            return march(
                _advance_to_event, _change_branch, True, True, inelastic, slots, foundations, links, state, peaks,
                memory, tally, starts, slopes, dt, parts, max_events,
            )  # fmt: skip

        return integrate_to_events

    @njit(**OPTIONS)
    def integrate(slots, foundations, links, state, peaks, memory, tally, starts, slopes, dt, parts, max_events):
        _ = source
        return march(
            _advance, no_event, True, False, inelastic, slots, foundations, links, state, peaks, memory, tally, starts,
            slopes, dt, parts, max_events,
        )  # fmt: skip

    return integrate
