"""The driver of the fixed-step methods: it marches through the motion, keeps peaks, impacts and impulses, and ends a
run that leaves its range. A method says its step alone.

A method is two compiled functions. `advance(scene, p, out, own, tally, h, ground, slope, inelastic)` goes from the
point p towards h later: it fills the point `out`, causes included, and returns (time gone [s], verdict). `after(scene,
p, own, moved, ground, inelastic)` changes the branch that has ended where p was reached, if the method locates events,
and returns whether one has. `own` is the method's scratch, zeros at first; `tally` counts its events and iterations."""

from __future__ import annotations

import functools
from collections import namedtuple

import numpy as np
from numba import njit

from pounding_cli.kernels.between import raise_accelerations, raise_displacements, raise_drift, raise_links
from pounding_cli.kernels.branches import held_accelerations
from pounding_cli.kernels.column_shears import raise_at
from pounding_cli.kernels.forces import accelerations, closing, deformation
from pounding_cli.kernels.law_table import NO_BRANCH
from pounding_cli.kernels.layout import (
    COLLAPSED,
    DONE,
    EVENT_BOUND,
    INLINE,
    NOT_FINITE,
    OPTIONS,
    STALLED,
    element_pointers,
    link_pointers,
    peak_pointers,
    slot_pointers,
    state_pointers,
)
from pounding_cli.kernels.link_force import branch_at
from pounding_cli.kernels.simd import further, pointer
from pounding_cli.kernels.storey_law import Storeys
from pounding_cli.laws.program import MEMORIES

STEP_DONE, STEP_CUT = -1, -2
"""Verdicts of `advance`: the step is done, or it ended before its time and the rest is still to be taken. Any other is
the outcome the run ends with."""

EVENTS, ITERATIONS = 0, 1
"""Places in `tally`."""

DIVERGED = 1e6
"""Displacement at which a run counts as not finite [m]."""

POLYNOMIAL_SIZE = 16
"""Doubles of scratch for a polynomial."""

Scene = namedtuple("Scene", "slots elements links state peaks")
"""The arrays of a scene as pointers (`layout`)."""

Point = namedtuple("Point", "u v a drift shear storeys force")
"""A state and what it causes: by slot u, v, a [m, m/s, m/s2]; by slot drift and shear
[m, N] and the storeys' branches (`storey_law.Storeys`); by element its force with its dashpot's [N]."""

_BY_FREEDOM, _BY_SLOT = 3, 4 + MEMORIES
"""Doubles of a point by freedom and by slot."""


@njit(**INLINE)
def point_size(slots, elements):
    """Doubles of a point; of anything with the sizes of `layout.Slots` and `layout.Elements`."""
    return _BY_FREEDOM * elements.freedoms + _BY_SLOT * slots.size + elements.number


@njit(**INLINE)
def point(place, slots, elements):
    """A point at a place in the scratch."""
    size, freedoms = slots.size, elements.freedoms
    drift = further(place, _BY_FREEDOM * freedoms)
    storeys = Storeys(further(drift, 2 * size), further(drift, 3 * size), further(drift, (3 + MEMORIES) * size))
    return Point(
        place, further(place, freedoms), further(place, 2 * freedoms), drift, further(drift, size), storeys,
        further(drift, _BY_SLOT * size),
    )  # fmt: skip


@njit(**INLINE)
def begin_storeys(slots, p, q, inelastic):
    """The storeys of the point q begin on the branches, and at the drifts, of p."""
    if inelastic:
        for i in range(slots.size):
            if slots.branch[i] != NO_BRANCH:
                q.storeys.branch[i], q.storeys.before[i] = p.storeys.branch[i], p.drift[i]
                for m in range(i, slots.memories * slots.size, slots.size):
                    q.storeys.memory[m] = p.storeys.memory[m]


@njit(**INLINE)
def fill_forces(scene, p, ground, inelastic, located):
    """Fill accelerations, drifts, shears and forces of a point; where nothing is located its storeys may change their
    branches."""
    if located:
        held_accelerations(
            scene.slots, scene.elements, scene.links, scene.state, p.u, p.v, ground, inelastic, p.a, p.drift, p.shear,
            p.force,
        )  # fmt: skip
    else:
        accelerations(
            scene.slots, scene.elements, scene.links, p.storeys, p.u, p.v, ground, inelastic, p.a, p.drift, p.shear,
            p.force,
        )  # fmt: skip


@njit(**INLINE)
def no_event(scene, p, own, moved, ground, inelastic):
    """The `after` of a method that locates nothing."""
    return False


@njit(**INLINE)
def _raise_ends(scene, p, ground):
    """Peaks at a point."""
    slots, elements, links, peaks = scene.slots, scene.elements, scene.links, scene.peaks
    size = slots.size
    for i in range(size):
        peaks.drift[i] = max(peaks.drift[i], abs(p.drift[i]))
        peaks.shear[i] = max(peaks.shear[i], abs(p.shear[i]))
        peaks.acceleration[i] = max(peaks.acceleration[i], abs(p.a[i] + ground * slots.loaded[i]))
        peaks.displacement_max[i] = max(peaks.displacement_max[i], p.u[i])
        peaks.displacement_min[i] = min(peaks.displacement_min[i], p.u[i])
    for e in range(links.number):
        peaks.closing[e] = max(peaks.closing[e], deformation(elements, elements.springs + e, p.u))
        peaks.force[e] = max(peaks.force[e], abs(p.force[elements.springs + e]))
    raise_at(peaks, elements, p.shear, p.force)


@njit(**INLINE)
def _passes_over_contact(elements, links, peaks, p, out):
    """Whether a link opens, closes or changes its law within the step; counts those that close as impacts."""
    passed = False
    for e in range(links.number):
        before = branch_at(links, e, closing(elements, links, e, p.u))
        after = branch_at(links, e, closing(elements, links, e, out.u))
        if before < 0 <= after:
            peaks.impacts[e] += 1
        passed = passed or before != after
    return passed


@njit(**INLINE)
def _hold_links(scene, p, out, h):
    """Impulses and contact times of a step by the trapezoid."""
    links, peaks, first = scene.links, scene.peaks, scene.elements.springs
    for e in range(links.number):
        before, after = p.force[first + e], out.force[first + e]
        peaks.impulse[e] += 0.5 * h * (before + after)
        peaks.contact_time[e] += 0.5 * h * ((1.0 if before != 0.0 else 0.0) + (1.0 if after != 0.0 else 0.0))


@njit(**INLINE)
def _raise_inside(scene, scratch, p, out, h, ground, change, located, smooth):
    """Peaks between two points; the state still has the branches of the step, p those of its start."""
    slots, elements, links, state, peaks = scene.slots, scene.elements, scene.links, scene.state, scene.peaks
    raise_displacements(slots, peaks, scratch, h, p.u, p.v, p.a, out.u, out.v, out.a)
    if smooth:
        raise_accelerations(slots, peaks, h, ground, ground + change, p.v, p.a, out.v, out.a)
    for i in range(slots.size):
        raise_drift(
            slots, peaks, i, h, p.drift[i], deformation(elements, i, p.v), deformation(elements, i, p.a),
            out.drift[i], deformation(elements, i, out.v), deformation(elements, i, out.a),
            state, p.storeys, located, scratch,
        )  # fmt: skip
    raise_links(
        elements, links, state, peaks, scratch, h, p.u, p.v, p.a, out.u, out.v, out.a,
        further(p.force, elements.springs), further(out.force, elements.springs), located,
    )  # fmt: skip


@njit(**INLINE)
def _collapse(scene, p, out):
    """Where between two points a storey passed the drift at which it counts as collapsed, if it did: part of the step,
    by a straight line; 2 where none did."""
    slots, peaks = scene.slots, scene.peaks
    earliest = 2.0
    for i in range(slots.size):
        limit = slots.collapse[i]
        if peaks.drift[i] > limit:
            before, after = abs(p.drift[i]), abs(out.drift[i])
            share = (limit - before) / (after - before) if after > limit else 1.0
            earliest = min(earliest, max(share, 0.0))
    return earliest


@njit(**INLINE)
def _begin(scene, p):
    """The point p at the state that the run starts from."""
    state, size = scene.state, scene.slots.size
    for i in range(size):
        p.u[i], p.v[i] = state.u[i], state.v[i]
        p.storeys.branch[i] = state.storey_branch[i]
    for m in range(MEMORIES * size):
        p.storeys.memory[m] = state.storey_memory[m]
    for i in range(size):
        p.drift[i] = deformation(scene.elements, i, p.u)


@njit(**INLINE)
def _end(scene, p, located):
    """The state at the point p, where the run ends."""
    state, size = scene.state, scene.slots.size
    for i in range(size):
        state.u[i], state.v[i] = p.u[i], p.v[i]
        if not located:
            state.storey_branch[i] = int(p.storeys.branch[i])
            for m in range(i, MEMORIES * size, size):
                state.storey_memory[m] = p.storeys.memory[m]


@njit(**INLINE)
def _observe(scene, scratch, p, out, h, ground, last, slope, between, located):
    """What a step from p to `out` adds to peaks, impulses, contact times and impacts."""
    if h > 0.0:
        # Accelerations jump with the contact forces: a parabola over a jump has peaks that are not there.
        smooth = located or not _passes_over_contact(scene.elements, scene.links, scene.peaks, p, out)
        if between:
            _raise_inside(scene, scratch, p, out, h, ground, h * slope, located, smooth)
        else:
            _hold_links(scene, p, out, h)
    _raise_ends(scene, out, last)


@njit(**INLINE)
def march(
    advance, after, between, located, inelastic, slot_arrays, element_arrays, link_arrays, state_arrays,
    peak_arrays, memory, tally, starts, slopes, dt, parts, max_events,
):  # fmt: skip
    """March through all segments, each cut into `parts` steps.

    between : whether peaks are sought between the ends of steps too
    located : whether storeys and links are held on their branches (`branches`) until the method changes them

    Fills state and peaks in place; returns (status, steps, events, iterations, time reached [s]).
    """
    slots, elements, links = slot_pointers(slot_arrays), element_pointers(element_arrays), link_pointers(link_arrays)
    scene = Scene(slots, elements, links, state_pointers(state_arrays), peak_pointers(peak_arrays))
    place = pointer(memory)
    each = point_size(slots, elements)
    p, out = point(place, slots, elements), point(further(place, each), slots, elements)
    scratch = further(place, 2 * each)
    own = further(scratch, POLYNOMIAL_SIZE)
    _begin(scene, p)
    whole = dt / parts
    steps = 0
    events_at_instant = 0
    reached = starts[0]
    for segment in range(starts.size):
        slope = slopes[segment]
        jumps = segment == 0 or starts[segment] != reached  # the ground jumps where a tail begins
        reached = starts[segment] + dt * slope
        if jumps:
            begin_storeys(slots, p, p, inelastic)
            fill_forces(scene, p, starts[segment], inelastic, located)
            _raise_ends(scene, p, starts[segment])
        for part in range(parts):
            gone = 0.0
            verdict = STEP_CUT
            while verdict == STEP_CUT:
                ground = starts[segment] + slope * (part * whole + gone)
                h, verdict = advance(scene, p, out, own, tally, whole - gone, ground, slope, inelastic)
                if verdict >= 0:
                    return verdict, steps, tally[EVENTS], tally[ITERATIONS], segment * dt + part * whole
                steps += 1
                last = ground + h * slope
                events_at_instant = 0 if h > 0.0 else events_at_instant
                _observe(scene, scratch, p, out, h, ground, last, slope, between, located)
                share = _collapse(scene, p, out)
                p, out = out, p
                if share <= 1.0:
                    _end(scene, p, located)
                    time = segment * dt + part * whole + gone + share * h
                    return COLLAPSED, steps, tally[EVENTS], tally[ITERATIONS], time
                gone += h
                if after(scene, p, own, h > 0.0, last, inelastic):
                    fill_forces(scene, p, last, inelastic, located)
                    _raise_ends(scene, p, last)
                    events_at_instant += 1
                    if events_at_instant > 20 + 4 * (slots.size + links.size):
                        return STALLED, steps, tally[EVENTS], tally[ITERATIONS], segment * dt
                if tally[EVENTS] > max_events:
                    return EVENT_BOUND, steps, tally[EVENTS], tally[ITERATIONS], segment * dt
            if not np.isfinite(p.u[0] + p.v[0]) or abs(p.u[0]) > DIVERGED:
                return NOT_FINITE, steps, tally[EVENTS], tally[ITERATIONS], segment * dt
    _end(scene, p, located)
    return DONE, steps, tally[EVENTS], tally[ITERATIONS], starts.size * dt


@functools.cache
def build(advance, inelastic: bool):
    """A kernel of a method of one's own that locates nothing. It is compiled in every process; this program's methods
    have kernels in their own files, which are kept on disk."""

    @njit(**{**OPTIONS, "cache": False})
    def integrate(slots, elements, links, state, peaks, memory, tally, starts, slopes, dt, parts, max_events):
        return march(
            advance, no_event, False, False, inelastic, slots, elements, links, state, peaks, memory, tally, starts,
            slopes, dt, parts, max_events,
        )  # fmt: skip

    return integrate
