"""The event-located Taylor integrator: steps end at a record sample or exactly at an event, whichever is first.

Between two events the motion is analytic, so its Taylor series gives the step, its error and a polynomial in which events
are located to rounding and peaks are found between samples (the recurrence: `recurrence.py`). After an event the branch
changes and the series starts anew, so the order is never lost. Method: Jorba & Zou (2005), Experimental Mathematics 14(1).
"""

from __future__ import annotations

import functools

import numpy as np
from numba import njit

from pounding_cli.kernels.crossings import (
    CLOSES,
    OPENS,
    PULLS,
    PUSHES,
    SOFTENS,
    STIFFENS,
    first_link_event,
    first_storey_event,
)
from pounding_cli.kernels.layout import (
    AT_GAP,
    AT_ZERO,
    CUBIC,
    DONE,
    ELASTIC,
    EVENT_BOUND,
    INFILL,
    INLINE,
    LINEAR,
    LINKS_NONE,
    NO_FORCE,
    NOT_FINITE,
    NOTHING,
    OPEN,
    OPTIONS,
    STALLED,
    STEP_BOUND,
)
from pounding_cli.kernels.peaks import track
from pounding_cli.kernels.recurrence import LARGEST_ORDER, Work, expand, rescale, restencil, shrink
from pounding_cli.kernels.simd import load, store
from pounding_cli.kernels.summary import Ends, stop_at, summarise


@njit(**INLINE)
def _workspace(padded, feet_count, link_count):
    rows = LARGEST_ORDER
    reciprocal = np.zeros(rows + 1)
    curve = np.zeros(rows + 1)
    for k in range(1, rows + 1):
        reciprocal[k] = 1.0 / k
        curve[k] = k * (k - 1) / 8.0
    by_link = link_count * rows
    return Work(
        np.zeros(rows * padded), np.zeros(rows * padded), np.zeros(rows * padded),
        np.zeros(by_link), np.zeros(by_link), np.zeros(by_link), np.zeros(by_link), np.zeros(by_link),
        np.zeros(rows * feet_count), np.zeros(rows * feet_count),
        np.zeros(padded), np.zeros(padded), np.zeros(6 * padded), np.zeros(6 * padded),
        np.zeros(padded), np.zeros(padded), np.zeros(rows * padded),
        reciprocal, curve,
    )  # fmt: skip


@njit(**INLINE)
def _start(feet, links, state, work, active, padded, h, founded, kinds):
    """Order 0 of the series from the state; returns the number of active links."""
    for b in range(0, padded, 8):
        store(work.U, b, load(state.u, b))
        store(work.W, b, load(state.v, b) * h)
    if founded:
        for f in range(feet.first.size):
            work.phi_D[f] = state.phi[f]
            work.phi_W[f] = h * state.phi_v[f]
    count = 0
    if kinds != LINKS_NONE:
        for e in range(links.left.size):
            if state.link_branch[e] != OPEN:
                active[count] = e
                count += 1
                v = state.u[links.left[e]] - state.u[links.right[e]]
                if links.kind[e] == 0:
                    v -= links.gap[e]
                if state.snapped_link[e] == AT_ZERO:
                    v = 0.0
                elif state.snapped_link[e] == AT_GAP:
                    v = links.gap[e]
                work.V[e * LARGEST_ORDER] = v
    return count


@njit(**INLINE)
def _storey_event(slots, state, work, padded, order, s, i):
    """Change the branch of storey i, which leaves its own at s."""
    drift = 0.0
    for k in range(order, -1, -1):
        drift = drift * s + work.D[k * padded + i]
    k0 = slots.stiffness[i]
    a = slots.hardening[i]
    limit = slots.yield_drift[i]
    if state.branch[i] == ELASTIC:
        line = 1.0 if drift > state.plastic[i] else -1.0
        state.branch[i] = int(line)
        state.plastic[i] = np.inf  # no elastic range is watched while the storey is on a yield line
        state.snapped_storey[i] = 0
        work.tangent[i] = a * k0
        work.offset[i] = line * (1.0 - a) * k0 * limit
    else:
        line = state.branch[i]
        state.branch[i] = ELASTIC
        state.plastic[i] = drift - line * limit
        state.snapped_storey[i] = line
        work.tangent[i] = k0
        work.offset[i] = -(1.0 - a) * k0 * state.plastic[i]
    restencil(slots, work, i)
    if i > 0:
        restencil(slots, work, i - 1)


@njit(**INLINE)
def _link_event(links, state, peaks, e, event):
    """Change the branch of link e."""
    infill = links.kind[e] == INFILL
    if event == CLOSES:
        state.link_branch[e] = CUBIC if infill else LINEAR
        state.snapped_link[e] = AT_ZERO
        peaks.impacts[e] += 1
    elif event == OPENS:
        state.link_branch[e] = OPEN
        state.link_cut[e] = 0
        state.snapped_link[e] = AT_ZERO
    elif event == STIFFENS:
        state.link_branch[e] = LINEAR
        state.snapped_link[e] = AT_GAP
    elif event == SOFTENS:
        state.link_branch[e] = CUBIC
        state.snapped_link[e] = AT_GAP
    elif event == PULLS:
        state.link_cut[e] = 1
        state.snapped_link[e] = NO_FORCE
    elif event == PUSHES:
        state.link_cut[e] = 0
        state.snapped_link[e] = NO_FORCE


@functools.cache
def build(inelastic: bool, founded: bool, kinds: int):
    """The integrator with only the effects asked for, compiled on first use.

    Parameters
    ----------
    inelastic : storeys can yield
    founded : at least one building sways or rocks on its foundation
    kinds : LINKS_NONE, LINKS_LINEAR (pounding, connectors) or LINKS_CUBIC (infill too)
    """

    @njit(**OPTIONS)
    def integrate(
        slots, feet, links, state, peaks, starts, slopes, dt, tolerance, quiet, most_order, most_steps, most_events
    ):  # fmt: skip
        """Run over all segments of the ground motion, a_g = starts[j] + slopes[j] t within segment j of length dt.

        Fills `state` and `peaks` in place; returns (status, steps, events, orders computed, time reached [s]).
        """
        padded = slots.couple.size
        link_count = links.left.size
        work = _workspace(padded, feet.first.size, link_count)
        ends = Ends(
            np.zeros(padded), np.zeros(padded), np.zeros(padded), np.zeros(padded),
            np.zeros(padded), np.zeros(padded), np.zeros(padded), np.zeros(padded),
        )  # fmt: skip
        scratch = np.zeros(LARGEST_ORDER)
        active = np.zeros(link_count, np.int64)
        for i in range(padded):
            work.tangent[i] = slots.stiffness[i]
        for i in range(padded):
            restencil(slots, work, i)
        steps = 0
        events = 0
        orders = 0
        standing = 0  # events in a row without time going on
        guess = 8
        snapped = True  # something may be exactly zero: touching floors at the start, or what an event just met
        segment = 0
        offset = 0.0  # time since the segment's start
        while segment < starts.size:
            remaining = dt - offset
            h = remaining
            ag = starts[segment] + slopes[segment] * offset
            count = _start(feet, links, state, work, active, padded, h, founded, kinds)
            order, close = expand(
                slots, feet, links, state, work, peaks, active, count, padded, h, ag, slopes[segment], tolerance,
                quiet, guess, most_order, founded, kinds,
            )  # fmt: skip
            steps += 1
            orders += order
            whole = True
            if close:
                guess = max(order - 2, 2)
            else:
                guess = most_order - 1
                ratio = shrink(work, peaks, padded, h, tolerance, quiet, order)
                if not ratio > 1e-14:
                    return NOT_FINITE, steps, events, orders, segment * dt + offset
                if ratio < 1.0:
                    ratio = 1.0 / np.ceil(1.0 / ratio) if ratio > 0.01 else ratio
                    rescale(feet, work, active, count, padded, order, ratio, founded, kinds)
                    h *= ratio
                    whole = False
            ground = h * h * ag
            ground_slope = h * h * h * slopes[segment]
            summarise(slots, work, ends, padded, order, ground, ground_slope, founded)
            end = 1.0
            storey = -1
            link = -1
            event = 0
            if inelastic:
                s, storey = first_storey_event(slots, state, work, ends, padded, order, end, scratch)
                if storey >= 0:
                    end = s
            if kinds != LINKS_NONE:
                s, link, event = first_link_event(
                    links, state, work, ends, padded, order, end, scratch, kinds
                )
                if link >= 0:
                    if storey >= 0 and s >= end:
                        link = -1
                    else:
                        end = s
                        storey = -1
            track(
                feet, links, state, work, ends, peaks, active, count, padded, order, end, scratch, h, ground,
                ground_slope, inelastic, founded, kinds,
            )  # fmt: skip
            happened = storey >= 0 or link >= 0
            if end < 1.0:
                stop_at(work, ends, padded, order, end)
            if end > 0.0:
                standing = 0
                if snapped:
                    state.snapped_link[:] = NOTHING
                    state.snapped_storey[:] = 0
                    snapped = False
            if storey >= 0:
                _storey_event(slots, state, work, padded, order, end, storey)
            if link >= 0:
                _link_event(links, state, peaks, link, event)
            if end > 0.0:
                rate = 1.0 / h
                for b in range(0, padded, 8):
                    store(state.u, b, load(ends.u, b))
                    store(state.v, b, load(ends.v, b) * rate)
                if founded:
                    feet_count = feet.first.size
                    for f in range(feet_count):
                        phi = 0.0
                        phi_v = 0.0
                        for k in range(order, -1, -1):
                            phi = phi * end + work.phi_D[k * feet_count + f]
                            phi_v = phi_v * end + work.phi_W[k * feet_count + f]
                        state.phi[f] = phi
                        state.phi_v[f] = phi_v * rate
            if happened:
                events += 1
                standing += 1
                snapped = True
                if events > most_events:
                    return EVENT_BOUND, steps, events, orders, segment * dt + offset
                if standing > 20 + 4 * (padded + link_count):
                    return STALLED, steps, events, orders, segment * dt + offset
            if steps > most_steps:
                return STEP_BOUND, steps, events, orders, segment * dt + offset
            if whole and end == 1.0:
                segment += 1
                offset = 0.0
            else:
                offset += h * end
                if offset >= dt:
                    segment += 1
                    offset = 0.0
            if not np.isfinite(state.u[0] + state.v[0]):
                return NOT_FINITE, steps, events, orders, segment * dt + offset
        return DONE, steps, events, orders, segment * dt

    return integrate
