"""The run: steps that end at a sample of the ground motion, at an output time, or exactly at an event, whichever is
first."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.solver.dispatch import line_force
from pounding_cli.solver.energy import add_energy
from pounding_cli.solver.events import (
    RATE,
    VALUE,
    commit,
    end_at,
    ends_of_elements,
    enter_all,
    first_event,
    gather_lines,
    summarise,
    unpin,
)
from pounding_cli.solver.options import CALLED, KERNEL, PART, bare
from pounding_cli.solver.peaks import raise_peaks
from pounding_cli.solver.records import DONE, EVENT_BOUND, NOT_FINITE, STALLED, STEP_BOUND, Room
from pounding_cli.solver.series import expand, shorten, shrink, start
from pounding_cli.solver.smooth import end_of_smooth, take_smooth
from pounding_cli.solver.stick import hold_or_release, keep_held_forces

FORGET = 0.9
"""What is left of an acceleration as a scale after one step."""

INSTANT = 1e-15
"""Part of a step [-] in which time does not go on."""

SHORTEST = 1e-25
"""Part of a step to which series are never shortened: their numbers are not finite."""

AT_INSTANT = 20, 4
"""Events at one instant after which a run has stalled: so many, and so many more an element."""

NEAR = 1e-9
"""Part of a sample of the motion [-] within which two times are one."""


@njit(**PART)
def begin_step(r, elapsed, length, g, slope, output):
    """Length of the next step, and the ground in it; whether it reaches the end of a segment of this length [s]."""
    h = length - elapsed
    whole = h <= r.longest * (1.0 + 1e-9)
    if not whole:
        h /= np.ceil(h / r.longest - 1e-9)
    if output < h - NEAR * r.dt:
        h = output
        whole = False
    r.h = h
    r.end = 2.0
    r.g0 = g + slope * elapsed
    r.g1 = slope * h
    return whole


@njit(**PART)
def advance(dofs, elements, r):
    """The end of this step is the start of the next."""
    if r.still:
        r.begun = r.time
    for i in range(r.n):
        d = dofs[i]
        d.scale = max(FORGET * d.scale, abs(d.a0), abs(d.a1))
        d.u0 = d.u1
        d.w[0] = d.v1
        d.fastest = max(d.fastest, abs(d.v1))
        if d.u0 != 0.0 or d.w[0] != 0.0:
            r.still = 0
    for e in range(r.m):
        el = elements[e]
        el.v0 = el.exact if el.pinned == VALUE else el.v1
        if el.pinned < RATE:
            el.r0 = el.r1


@njit(**PART)
def count(r, happened):
    """Count a step and see whether the run may go on."""
    r.steps += 1
    r.orders += r.order
    if r.end > INSTANT:
        r.instant = 0
    if happened:
        r.instant += 1
        if r.instant > AT_INSTANT[0] + AT_INSTANT[1] * r.m:
            r.status = STALLED
    if r.steps > r.most_steps:
        r.status = STEP_BOUND
    if r.events > r.most_events:
        r.status = EVENT_BOUND


@njit(**CALLED)
def begin(dofs, elements, terms, r, series):
    """The branches of all elements, and their deformations at the displacements and velocities of the start."""
    r.status = DONE
    r.still = 1
    for i in range(r.n):
        d = dofs[i]
        if d.u0 != 0.0 or d.w[0] != 0.0:
            r.still = 0
        d.u1 = d.u0
        d.v1 = d.w[0]
        d.u_max = d.u_min = d.u0
    ends_of_elements(dofs, elements, terms, r)
    enter_all(elements, r, series)
    for i in range(r.n):
        hold_or_release(dofs[i], elements[i])
    for e in range(r.m):
        el = elements[e]
        el.v0 = el.v1
        el.r0 = el.r1
        el.peak_v = abs(el.v0) if el.drifts else el.v0
        el.least = el.v0


@njit(**CALLED)
def keep(dofs, elements, r, watch):
    """Keep the state at the end of the step as that of the next output time."""
    t = r.output
    r.output += 1
    on_links = on_drags = 0.0
    for i in range(r.n):
        d = dofs[i]
        watch.dofs[t, i, 0] = d.u1
        watch.dofs[t, i, 1] = d.v1
        watch.dofs[t, i, 2] = d.a1
        watch.storeys[t, i] = elements[i].work
    for e in range(r.m):
        el = elements[e]
        f = el.acts * (el.f1 if el.smooth else line_force(el, el.v1, el.r1))
        if el.twists:
            f += el.coupled_k * elements[el.mate].v1
        if el.drifts:
            f -= 0.0 if el.smooth else el.c * el.r1
            f += el.f1 if el.holds else 0.0
            if e >= r.n:  # what its storey has beside its own work and force
                watch.storeys[t, el.mate] += el.work
                watch.elements[t, el.storey, 1] += el.along * f if el.smooth else 0.0
        elif e < r.n + r.drags:
            on_drags += el.work
        else:
            on_links += el.work
        watch.elements[t, e, 0] = el.v1
        watch.elements[t, e, 1] = f
    watch.energy[t, 0] = r.input
    watch.energy[t, 1] = r.drag + r.dashpots + on_drags
    watch.energy[t, 2] = on_links


@njit(**KERNEL)
def integrate(all_dofs, all_elements, terms, run, all_series, all_columns, rooms, watch, ground, slopes, ends):
    """Run scenes of one layout, a row each, through their whole motions. How each ends is run.status.

    ground, slopes : acceleration [m/s2] at the start of every segment of run.dt and its slope [m/s3], of the scenes one
        after the other, those of a scene up to its `ends`
    rooms : for steps by DOP853; without it (None) a kernel is compiled that has series alone
    """
    terms = bare(terms)
    first = 0
    for scene in range(run.size):
        r = run[scene]
        dofs = bare(all_dofs[scene])
        elements = bare(all_elements[scene])
        series = bare(all_series[scene])
        columns = bare(all_columns[scene])
        pinned = r.resumes != 0  # what was known exactly at the end of the run before
        if not pinned:
            begin(dofs, elements, terms, r, series)
            if r.lines:
                gather_lines(elements, r)
        if watch.times.size > 0:
            keep(dofs, elements, r, watch)
        for segment in range(ends[scene] - first):
            elapsed = 0.0
            r.longest = r.most_h
            r.follows = 0
            length = r.rest if first + segment + 1 == ends[scene] else r.dt
            while r.status == DONE and elapsed < length:
                output = np.inf
                if r.output < watch.times.size:
                    output = watch.times[r.output] - (segment * r.dt + elapsed)
                whole = begin_step(r, elapsed, length, ground[first + segment], slopes[first + segment], output)
                planned = r.h
                shortened = False
                smooth = r.smooth
                if smooth:
                    if rooms is not None:
                        take_smooth(dofs, elements, terms, r, series, Room(rooms.states[scene], rooms.formulas[scene]))
                        shortened = r.h < planned
                else:
                    start(dofs, elements, terms, r, series)
                    if not expand(dofs, elements, terms, r, series):
                        ratio = shrink(dofs, elements, r, series)
                        if not ratio > SHORTEST:
                            r.status = NOT_FINITE
                        shortened = shorten(dofs, r, series, ratio)
                if r.status != DONE:
                    break
                summarise(dofs, elements, terms, r)
                happened = first_event(dofs, elements, terms, r, series)
                if r.end < 1.0:
                    end_at(dofs, elements, terms, r)
                else:
                    r.end = 1.0
                if rooms is not None:
                    if smooth:
                        end_of_smooth(elements, r, Room(rooms.states[scene], rooms.formulas[scene]))
                if r.has_sliders:
                    keep_held_forces(elements, r, series)
                add_energy(dofs, elements, r, series)
                raise_peaks(dofs, elements, terms, r, series, columns)
                if pinned and r.end > INSTANT:
                    unpin(elements, r)
                    pinned = False
                advance(dofs, elements, r)
                count(r, happened)
                r.follows = smooth and not happened
                elapsed += r.h * r.end
                r.time = segment * r.dt + elapsed
                if output <= r.h * r.end + NEAR * r.dt:
                    keep(dofs, elements, r, watch)
                if happened:
                    commit(dofs, elements, terms, r, series)
                    pinned = True
                    r.longest = r.most_h
                if whole and not shortened and r.end == 1.0:
                    break
            if r.status != DONE:
                break
        first = ends[scene]
