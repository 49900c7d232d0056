"""The run: steps that end at a sample of the ground motion, at an output time, or exactly at an event.

Whichever of these is first ends a step.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.solver.branches import change_branches, enter_first_branches, gather_lines, unpin
from pounding_cli.solver.dispatch import compute_line_force
from pounding_cli.solver.energy import add_energy
from pounding_cli.solver.events import find_first_event
from pounding_cli.solver.options import CALLED, KERNEL, PART, borrow_records
from pounding_cli.solver.peaks import raise_peaks
from pounding_cli.solver.records import DONE, EVENT_BOUND, NOT_FINITE, RATE, STALLED, STEP_BOUND, VALUE, Room
from pounding_cli.solver.series import expand, find_converged_part, shorten, start_series
from pounding_cli.solver.smooth import end_smooth_step, take_smooth_step
from pounding_cli.solver.step_end import deform_elements, end_at_event, evaluate_end
from pounding_cli.solver.stick import hold_or_release, keep_held_forces

FORGET = 0.9
"""What is left of an acceleration as a scale after one step."""

STANDSTILL = 1e-15
"""Part of a step [-] in which time does not go on."""

MIN_RATIO = 1e-25
"""Part of a step to which series are never shortened: their numbers are not finite."""

HASTE = 1e-2
"""Part of a step [-] within which an event comes in haste. The motion is one polynomial over the whole step, so that it
explains few such events in a row: between two blows there is a step of the contact, as long as its period asks for."""

MAX_IN_HASTE_AN_ELEMENT = 1000
"""Events in haste, in a row, an element, after which a run has stalled: fifty is the most that was seen."""

MAX_AT_INSTANT = 20
"""Events at one instant after which a run has stalled: so many, and those an element that it has."""

MAX_AT_INSTANT_AN_ELEMENT = 4
"""Events an element that may happen at one instant besides."""

SAME_TIME = 1e-9
"""Part of a sample of the motion [-] within which two times are one."""


@njit(**PART)
def begin_step(run, elapsed, length, g, slope, output):
    """Set the length of the next step, and the ground in it; return whether it reaches the end of a segment.

    Parameters
    ----------
    elapsed, length : of the segment [s]
    g, slope : acceleration of the ground at the start of the segment [m/s2], and its slope [m/s3]
    output : time to the next output [s]
    """
    h = length - elapsed
    reaches_end = h <= run.longest * (1.0 + 1e-9)
    if not reaches_end:
        h /= np.ceil(h / run.longest - 1e-9)
    if output < h - SAME_TIME * run.dt:
        h = output
        reaches_end = False
    run.h = h
    run.end = 2.0
    run.g0 = g + slope * elapsed
    run.g1 = slope * h
    return reaches_end


@njit(**PART)
def _take_step(dofs, elements, terms, run, series, rooms, scene):
    """Take a step, by DOP853 while a smooth force acts and by series else; return whether it is shorter than planned.

    scene : its place among the rooms
    """
    if not run.smooth:
        return _take_series_step(dofs, elements, terms, run, series)
    planned = run.h
    if rooms is not None:
        take_smooth_step(dofs, elements, terms, run, series, Room(rooms.states[scene], rooms.formulas[scene]))
    return run.h < planned


@njit(**PART)
def _take_series_step(dofs, elements, terms, run, series):
    """Take a step by series; return whether it was shortened until they converge."""
    start_series(dofs, elements, terms, run, series)
    if expand(dofs, elements, terms, run, series):
        return False
    ratio = find_converged_part(dofs, elements, run, series)
    if not ratio > MIN_RATIO:
        run.status = NOT_FINITE
    return shorten(dofs, run, series, ratio)


@njit(**PART)
def advance(dofs, elements, run):
    """Make the end of this step the start of the next."""
    if run.still:
        run.begun = run.time
    for i in range(run.n):
        dof = dofs[i]
        dof.scale = max(FORGET * dof.scale, abs(dof.a0), abs(dof.a1))
        dof.u0 = dof.u1
        dof.w[0] = dof.v1
        dof.fastest = max(dof.fastest, abs(dof.v1))
        if dof.u0 != 0.0 or dof.w[0] != 0.0:
            run.still = 0
    for e in range(run.m):
        el = elements[e]
        el.v0 = el.exact if el.pinned == VALUE else el.v1
        if el.pinned < RATE:
            el.r0 = el.r1


@njit(**PART)
def count_step(run, has_event):
    """Count a step and set the status of a run that may not go on."""
    run.steps += 1
    run.orders += run.order
    if run.end > STANDSTILL:
        run.instant = 0
    if run.end > HASTE:
        run.hasty = 0
    if has_event:
        run.instant += 1
        run.hasty += 1
        if run.instant > MAX_AT_INSTANT + MAX_AT_INSTANT_AN_ELEMENT * run.m:
            run.status = STALLED
        if run.hasty > MAX_IN_HASTE_AN_ELEMENT * run.m:
            run.status = STALLED
    if run.steps > run.most_steps:
        run.status = STEP_BOUND
    if run.events > run.most_events:
        run.status = EVENT_BOUND


@njit(**CALLED)
def begin_run(dofs, elements, terms, run, series):
    """Put all elements on their first branches, deformed by the displacements and velocities of the start."""
    run.status = DONE
    run.still = 1
    for i in range(run.n):
        dof = dofs[i]
        if dof.u0 != 0.0 or dof.w[0] != 0.0:
            run.still = 0
        dof.u1 = dof.u0
        dof.v1 = dof.w[0]
        dof.u_max = dof.u_min = dof.u0
    deform_elements(dofs, elements, terms, run)
    enter_first_branches(elements, run, series)
    for i in range(run.n):
        hold_or_release(dofs[i], elements[i])
    for e in range(run.m):
        el = elements[e]
        el.v0 = el.v1
        el.r0 = el.r1
        el.peak_v = abs(el.v0) if el.drifts else el.v0
        el.least = el.v0


@njit(**CALLED)
def keep_state(dofs, elements, run, watch):
    """Keep the state at the end of the step as that of the next output time."""
    t = run.output
    run.output += 1
    on_links = on_drags = 0.0
    for i in range(run.n):
        dof = dofs[i]
        watch.dofs[t, i, 0] = dof.u1
        watch.dofs[t, i, 1] = dof.v1
        watch.dofs[t, i, 2] = dof.a1
        watch.storeys[t, i] = elements[i].work
    for e in range(run.m):
        el = elements[e]
        f = el.acts * (el.f1 if el.smooth else compute_line_force(el, el.v1, el.r1))
        if el.twists:
            f += el.coupled_k * elements[el.mate].v1
        if el.drifts:
            f -= 0.0 if el.smooth else el.c * el.r1
            f += el.f1 if el.holds else 0.0
            if e >= run.n:  # what its storey has beside its own work and force
                watch.storeys[t, el.mate] += el.work
                watch.elements[t, el.storey, 1] += el.along * f if el.smooth else 0.0
        elif e < run.n + run.drags:
            on_drags += el.work
        else:
            on_links += el.work
        watch.elements[t, e, 0] = el.v1
        watch.elements[t, e, 1] = f
    watch.energy[t, 0] = run.input
    watch.energy[t, 1] = run.drag + run.dashpots + on_drags
    watch.energy[t, 2] = on_links


@njit(**KERNEL)
def integrate(all_dofs, all_elements, terms, runs, all_series, all_columns, rooms, watch, ground, slopes, ends, stop):
    """Run scenes of one layout, a row each, through their whole motions; how each ends is its run.status.

    The loop stands here whole: parts of it in functions of their own would round otherwise in the last digit.

    Parameters
    ----------
    ground, slopes : acceleration at the start of every segment of run.dt [m/s2], and its slope [m/s3], of the scenes
        one after the other
    ends : place in `ground` where the segments of each scene end
    stop : flag (`stopping`); where it is raised, the kernel returns and no scene is done
    rooms : for steps by DOP853; without it (None) a kernel is compiled that has series alone
    """
    terms = borrow_records(terms)
    first = 0
    for scene in range(runs.size):
        run = runs[scene]
        dofs = borrow_records(all_dofs[scene])
        elements = borrow_records(all_elements[scene])
        series = borrow_records(all_series[scene])
        columns = borrow_records(all_columns[scene])
        is_pinned = run.resumes != 0  # by what was known exactly at the end of the run before
        if not is_pinned:
            begin_run(dofs, elements, terms, run, series)
            if run.lines:
                gather_lines(elements, run)
        if watch.times.size > 0:
            keep_state(dofs, elements, run, watch)
        for segment in range(ends[scene] - first):
            elapsed = 0.0
            run.longest = run.most_h
            run.follows = 0
            length = run.rest if first + segment + 1 == ends[scene] else run.dt
            while run.status == DONE and elapsed < length:
                if stop[0]:
                    return
                output = np.inf
                if run.output < watch.times.size:
                    output = watch.times[run.output] - (segment * run.dt + elapsed)
                reaches_end = begin_step(run, elapsed, length, ground[first + segment], slopes[first + segment], output)
                is_smooth = run.smooth
                is_shortened = _take_step(dofs, elements, terms, run, series, rooms, scene)
                if run.status != DONE:
                    break
                evaluate_end(dofs, elements, terms, run)
                has_event = find_first_event(dofs, elements, terms, run, series)
                if run.end < 1.0:
                    end_at_event(dofs, elements, terms, run)
                else:
                    run.end = 1.0
                if rooms is not None:
                    if is_smooth:
                        end_smooth_step(elements, run, Room(rooms.states[scene], rooms.formulas[scene]))
                if run.has_sliders:
                    keep_held_forces(elements, run, series)
                add_energy(dofs, elements, run, series)
                raise_peaks(dofs, elements, terms, run, series, columns)
                if is_pinned and run.end > STANDSTILL:
                    unpin(elements, run)
                    is_pinned = False
                advance(dofs, elements, run)
                count_step(run, has_event)
                run.follows = is_smooth and not has_event
                elapsed += run.h * run.end
                run.time = segment * run.dt + elapsed
                if output <= run.h * run.end + SAME_TIME * run.dt:
                    keep_state(dofs, elements, run, watch)
                if has_event:
                    change_branches(dofs, elements, terms, run, series)
                    is_pinned = True
                    run.longest = run.most_h
                if reaches_end and not is_shortened and run.end == 1.0:
                    break
            if run.status != DONE:
                break
        first = ends[scene]
