"""The classical Runge-Kutta method of fourth order at a fixed step, with and without event location.

With location, every storey and link is held on its branch, the first end of a branch within the step is found on the
quintic through the step's ends, the step is taken again up to there, and the branch changes: fourth order is kept.
Without it, every stage sees the return mapping and the contacts as they are, and the order falls to first where a step
passes over a change. Peaks are sought between the ends too. Source: Kutta (1901), Zeitschrift fuer Mathematik und
Physik 46; event location: Shampine & Thompson (2000), Computers & Mathematics with Applications 39(5-6)."""

from __future__ import annotations

import functools
from collections import namedtuple

import numpy as np
from numba import njit

from pounding_cli.kernels.between import raise_accelerations, raise_displacements, raise_drift, raise_links
from pounding_cli.kernels.branches import (
    held_accelerations,
    link_branch_end,
    storey_branch_end,
    switch_link,
    switch_storey,
)
from pounding_cli.kernels.forces import accelerations
from pounding_cli.kernels.layout import (
    CONNECTOR,
    DONE,
    EVENT_BOUND,
    INFILL,
    INLINE,
    NOT_FINITE,
    NOTHING,
    OPTIONS,
    POUNDING,
    STALLED,
    foot_pointers,
    link_pointers,
    peak_pointers,
    slot_pointers,
    state_pointers,
)
from pounding_cli.kernels.polynomial import NEVER
from pounding_cli.kernels.simd import further, pointer
from pounding_cli.kernels.source import source_digest

Point = namedtuple("Point", "u v phi phi_v a turn drift shear force")
"""A state and what it causes: per slot u, v, a [m, m/s, m/s2], drift [m], shear [N]; per foundation phi, phi_v, turn;
`force` has the dashpot forces of the slots, then the links' forces [N]."""


def room_needed(size: int, feet: int, links: int) -> int:
    """Doubles of scratch that `integrate` needs."""
    return 6 * (6 * size + 3 * feet + links) + 3 * size + 16


@njit(**INLINE)
def _point(place, size, feet):
    at = further(place, 5 * size)
    return Point(
        place, further(place, size), at, further(at, feet), further(place, 2 * size), further(at, 2 * feet),
        further(place, 3 * size), further(place, 4 * size), further(at, 3 * feet),
    )  # fmt: skip


@njit(**INLINE)
def _rates(slots, feet, i, v, phi_v):
    """Rate of the drift of slot i, from rates `v` of the slots and `phi_v` of the foundations."""
    rate = v[i] - (v[i - 1] if slots.couple[i] != 0.0 else 0.0)
    if slots.rise[i] != 0.0:
        for f in range(feet.number):
            if feet.first[f] <= i < feet.stop[f]:
                rate -= slots.rise[i] * phi_v[f]
    return rate


@njit(**INLINE)
def _causes(slots, feet, links, state, plastic, p, ground, inelastic, located):
    """Fill accelerations, drifts, shears and link forces of a point."""
    if located:
        held_accelerations(
            slots, feet, links, state, p.u, p.v, p.phi, p.phi_v, ground, inelastic, p.a, p.turn, p.drift, p.shear,
            p.force,
        )  # fmt: skip
    else:
        accelerations(
            slots, feet, links, plastic, p.u, p.v, p.phi, p.phi_v, ground, inelastic, p.a, p.turn, p.drift,
            p.shear, p.force,
        )  # fmt: skip


@njit(**INLINE)
def _stage(slots, feet, links, state, plastic, p, q, r, share, ground, inelastic, located):
    """The point q at p + share * (rates of r), and what it causes; `plastic` is a copy that may move."""
    for i in range(slots.size):
        q.u[i] = p.u[i] + share * r.v[i]
        q.v[i] = p.v[i] + share * r.a[i]
        plastic[i] = state.plastic[i]
    for f in range(feet.number):
        q.phi[f] = p.phi[f] + share * r.phi_v[f]
        q.phi_v[f] = p.phi_v[f] + share * r.turn[f]
    _causes(slots, feet, links, state, plastic, q, ground, inelastic, located)


@njit(**INLINE)
def _step(slots, feet, links, state, plastic, p, q2, q3, q4, out, h, ground, ground_slope, inelastic, located):
    """From p over h to `out`, with what the end causes on the same branches."""
    middle = ground + 0.5 * h * ground_slope
    last = ground + h * ground_slope
    _stage(slots, feet, links, state, plastic, p, q2, p, 0.5 * h, middle, inelastic, located)
    _stage(slots, feet, links, state, plastic, p, q3, q2, 0.5 * h, middle, inelastic, located)
    _stage(slots, feet, links, state, plastic, p, q4, q3, h, last, inelastic, located)
    for i in range(slots.size):
        out.u[i] = p.u[i] + h * p.v[i] + h * h / 6.0 * (p.a[i] + q2.a[i] + q3.a[i])
        out.v[i] = p.v[i] + h / 6.0 * (p.a[i] + 2.0 * (q2.a[i] + q3.a[i]) + q4.a[i])  # fault: runge-kutta-stages
        plastic[i] = state.plastic[i]
    for f in range(feet.number):
        out.phi[f] = p.phi[f] + h * p.phi_v[f] + h * h / 6.0 * (p.turn[f] + q2.turn[f] + q3.turn[f])
        out.phi_v[f] = p.phi_v[f] + h / 6.0 * (p.turn[f] + 2.0 * (q2.turn[f] + q3.turn[f]) + q4.turn[f])
    _causes(slots, feet, links, state, plastic, out, last, inelastic, located)


@njit(**INLINE)
def _first_event(slots, feet, links, state, p, out, h, scratch, inelastic):
    """(s, storey, link, event) of the first end of a branch within the step."""
    earliest = NEVER
    storey = -1
    link = -1
    event = 0
    if inelastic:
        for i in range(slots.size):
            if slots.yield_drift[i] == np.inf:
                continue
            s = storey_branch_end(
                slots, state, i, h,
                p.drift[i], _rates(slots, feet, i, p.v, p.phi_v), _rates(slots, feet, i, p.a, p.turn),
                out.drift[i], _rates(slots, feet, i, out.v, out.phi_v), _rates(slots, feet, i, out.a, out.turn),
                scratch,
            )  # fmt: skip
            if s < earliest:
                earliest = s
                storey = i
    for e in range(links.number):
        left = links.left[e]
        right = links.right[e]
        gap = links.gap[e] if links.kind[e] == POUNDING else 0.0
        s, kind = link_branch_end(
            links, state, e, h,
            p.u[left] - p.u[right] - gap, p.v[left] - p.v[right], p.a[left] - p.a[right],
            out.u[left] - out.u[right] - gap, out.v[left] - out.v[right], out.a[left] - out.a[right],
            scratch,
        )  # fmt: skip
        if s < earliest:
            earliest = s
            storey = -1
            link = e
            event = kind
    return earliest, storey, link, event


@njit(**INLINE)
def _raise_ends(slots, feet, links, peaks, p, ground):
    """Peaks at a point."""
    size = slots.size
    for i in range(size):
        peaks.drift[i] = max(peaks.drift[i], abs(p.drift[i]))
        peaks.shear[i] = max(peaks.shear[i], abs(p.shear[i]))
        peaks.acceleration[i] = max(peaks.acceleration[i], abs(p.a[i] + ground * slots.real[i]))
        peaks.displacement_max[i] = max(peaks.displacement_max[i], p.u[i])
        peaks.displacement_min[i] = min(peaks.displacement_min[i], p.u[i])
    for f in range(feet.number):
        peaks.rocking[f] = max(peaks.rocking[f], abs(p.phi[f]))
    for e in range(links.number):
        peaks.closing[e] = max(peaks.closing[e], p.u[links.left[e]] - p.u[links.right[e]])
        peaks.force[e] = max(peaks.force[e], abs(p.force[size + e]))


@njit(**INLINE)
def _passes_over_contact(links, peaks, p, out):
    """Whether a link opens, closes or changes its law within the step; counts those that close as impacts."""
    passed = False
    for e in range(links.number):
        if links.kind[e] == CONNECTOR:
            continue
        gap = links.gap[e] if links.kind[e] == POUNDING else 0.0
        before = p.u[links.left[e]] - p.u[links.right[e]] - gap
        after = out.u[links.left[e]] - out.u[links.right[e]] - gap
        if before <= 0.0 and after > 0.0:
            peaks.impacts[e] += 1
        passed = passed or (before > 0.0) != (after > 0.0)
        if links.kind[e] == INFILL:
            passed = passed or (before > links.gap[e]) != (after > links.gap[e])
    return passed


@njit(**INLINE)
def _raise_inside(slots, feet, links, state, peaks, scratch, p, out, h, ground, ground_slope, located):
    """Peaks between two points; `state` still has the branches and plastic drifts of the step."""
    size = slots.size
    raise_displacements(slots, peaks, scratch, h, p.u, p.v, p.a, out.u, out.v, out.a)
    # Accelerations jump with the contact forces: a parabola over a jump would show peaks that are not there.
    if located or not _passes_over_contact(links, peaks, p, out):
        raise_accelerations(slots, peaks, h, ground, ground + h * ground_slope, p.v, p.a, out.v, out.a)
    for i in range(size):
        raise_drift(
            slots, peaks, i, h,
            p.drift[i], _rates(slots, feet, i, p.v, p.phi_v), _rates(slots, feet, i, p.a, p.turn),
            out.drift[i], _rates(slots, feet, i, out.v, out.phi_v), _rates(slots, feet, i, out.a, out.turn),
            state.line[i], state.plastic[i], located, scratch,
        )  # fmt: skip
    raise_links(
        links, state, peaks, scratch, h, p.u, p.v, p.a, out.u, out.v, out.a, further(p.force, size),
        further(out.force, size), located,
    )  # fmt: skip


@functools.cache
def build(inelastic: bool, located: bool):
    """The method for elastic or inelastic storeys, with or without event location, compiled on first use."""
    source = source_digest()

    @njit(**OPTIONS)
    def integrate(
        slot_arrays, foot_arrays, link_arrays, state_arrays, peak_arrays, room, starts, slopes, dt, parts, most_events
    ):  # fmt: skip
        """March through all segments, each cut into `parts` steps and these at events; `room` as in `room_needed`.

        Fills state and peaks in place; returns (status, steps, events, 0, time reached [s]).
        """
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        slots, feet, links = slot_pointers(slot_arrays), foot_pointers(foot_arrays), link_pointers(link_arrays)
        state, peaks = state_pointers(state_arrays), peak_pointers(peak_arrays)
        size = slots.size
        place = pointer(room)
        each = 6 * size + 3 * feet.number + links.size
        p = _point(place, size, feet.number)
        out = _point(further(place, each), size, feet.number)
        q2 = _point(further(place, 2 * each), size, feet.number)
        q3 = _point(further(place, 3 * each), size, feet.number)
        q4 = _point(further(place, 4 * each), size, feet.number)
        plastic = further(place, 6 * each)
        scratch = further(plastic, size)
        steps = 0
        events = 0
        standing = 0
        for i in range(size):
            p.u[i] = state.u[i]
            p.v[i] = state.v[i]
        for f in range(feet.number):
            p.phi[f] = state.phi[f]
            p.phi_v[f] = state.phi_v[f]
        _causes(slots, feet, links, state, state.plastic, p, starts[0], inelastic, located)
        _raise_ends(slots, feet, links, peaks, p, starts[0])
        for segment in range(starts.size):
            slope = slopes[segment]
            # The ground jumps where a tail begins.
            jumps = segment > 0 and starts[segment] != starts[segment - 1] + dt * slopes[segment - 1]
            part = 0
            offset = 0.0
            while part < parts:
                end = dt * (part + 1) / parts
                h = end - offset
                ground = starts[segment] + slope * offset
                if jumps:
                    _causes(slots, feet, links, state, state.plastic, p, ground, inelastic, located)
                    _raise_ends(slots, feet, links, peaks, p, ground)
                    jumps = False
                _step(slots, feet, links, state, plastic, p, q2, q3, q4, out, h, ground, slope, inelastic, located)
                steps += 1
                storey = -1
                link = -1
                event = 0
                whole = True
                if located:
                    s, storey, link, event = _first_event(slots, feet, links, state, p, out, h, scratch, inelastic)
                    if s <= 1.0:
                        whole = False
                        h *= s
                        _step(
                            slots, feet, links, state, plastic, p, q2, q3, q4, out, h, ground, slope, inelastic, located
                        )
                    else:
                        storey = -1
                        link = -1
                if h > 0.0:
                    standing = 0
                    _raise_inside(slots, feet, links, state, peaks, scratch, p, out, h, ground, slope, located)
                    if located:
                        for e in range(links.number):
                            state.snapped_link[e] = NOTHING
                        for i in range(size):
                            state.snapped_storey[i] = 0
                last = ground + h * slope
                _raise_ends(slots, feet, links, peaks, out, last)
                if not located:
                    for i in range(size):
                        state.plastic[i] = plastic[i]
                p, out = out, p
                if whole:
                    part += 1
                    offset = dt * part / parts
                    continue
                if storey >= 0:
                    switch_storey(slots, state, storey, p.drift[storey])
                else:
                    switch_link(links, state, peaks, link, event)
                offset += h
                events += 1
                standing += 1
                if events > most_events:
                    return EVENT_BOUND, steps, events, 0, segment * dt
                if standing > 20 + 4 * (size + links.size):
                    return STALLED, steps, events, 0, segment * dt
                _causes(slots, feet, links, state, state.plastic, p, last, inelastic, located)
                _raise_ends(slots, feet, links, peaks, p, last)
            if not np.isfinite(p.u[0] + p.v[0]) or abs(p.u[0]) > 1e6:
                return NOT_FINITE, steps, events, 0, segment * dt
        for i in range(size):
            state.u[i] = p.u[i]
            state.v[i] = p.v[i]
        for f in range(feet.number):
            state.phi[f] = p.phi[f]
            state.phi_v[f] = p.phi_v[f]
        return DONE, steps, events, 0, starts.size * dt

    return integrate
