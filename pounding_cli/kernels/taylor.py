"""The event-located Taylor integrator: steps end at a record sample or exactly at an event, whichever is first.

Between two events the motion is analytic, so its Taylor series gives the step, its error and a polynomial in which
events are located to rounding and peaks are found between samples (the recurrence: `recurrence.py`). After an event
the branch changes and the series starts anew, so the order is never lost. Method: Jorba & Zou (2005), Experimental
Mathematics 14(1)."""

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
    foot_pointers,
    link_pointers,
    peak_pointers,
    slot_pointers,
    state_pointers,
)
from pounding_cli.kernels.ledger import account, ledger_pointers
from pounding_cli.kernels.link_series import closings, set_law
from pounding_cli.kernels.peaks import track, watch
from pounding_cli.kernels.recurrence import LARGEST_ORDER, Work, expand, renew_scale, rescale, restencil, shrink
from pounding_cli.kernels.simd import further, load, pointer, store
from pounding_cli.kernels.source import source_digest
from pounding_cli.kernels.summary import Ends, stop_at, summarise


def room_needed(padded: int, feet: int, links: int) -> int:
    """Doubles of scratch that `integrate` needs."""
    rows = LARGEST_ORDER + 1
    return rows * (4 * padded + 2 * feet + 5 * links + 4) + 40 * padded + 11 * links + 64


@njit(**INLINE)
def _workspace(room, padded, feet_count, link_count):
    """Carve the scratch of a run out of `room`, whole vectors first; returns (work, ends, scratch)."""
    rows = LARGEST_ORDER
    by_slot = rows * padded
    by_link = rows * link_count
    at = further(room, 4 * by_slot)
    at_link = further(at, 32 * padded)
    at_rest = further(at_link, 5 * by_link + 10 * link_count)
    reciprocal = further(at_rest, 2 * rows * feet_count)
    curve = further(reciprocal, rows + 1)
    twist = further(curve, rows + 1)
    scratch = further(twist, rows + 1)
    reciprocal[0] = 0.0
    curve[0] = 0.0
    twist[0] = 0.0
    for k in range(1, rows + 1):
        reciprocal[k] = 1.0 / k
        curve[k] = k * (k - 1) / 8.0
        twist[k] = (k - 2) * curve[k]
    work = Work(
        room, further(room, by_slot), further(room, 2 * by_slot),
        at_link, further(at_link, by_link), further(at_link, 2 * by_link), further(at_link, 3 * by_link),
        further(at_link, 4 * by_link), further(at_link, 5 * by_link), further(at_link, 5 * by_link + link_count),
        further(at_link, 5 * by_link + 2 * link_count), further(at_link, 5 * by_link + 3 * link_count),
        at_rest, further(at_rest, rows * feet_count),
        at, further(at, padded), further(at, 2 * padded), further(at, 8 * padded),
        further(at, 14 * padded), further(at, 15 * padded), further(room, 3 * by_slot), further(at, 30 * padded),
        further(at, 31 * padded),
        reciprocal, curve, twist,
    )  # fmt: skip
    ends = Ends(
        further(at, 16 * padded), further(at, 17 * padded), further(at, 18 * padded), further(at, 19 * padded),
        further(at, 20 * padded), further(at, 21 * padded), further(at, 22 * padded), further(at, 23 * padded),
        further(at, 24 * padded), further(at, 25 * padded), further(at, 26 * padded), further(at, 27 * padded),
        further(at, 28 * padded), further(at, 29 * padded),
    )  # fmt: skip
    return work, ends, scratch


@njit(**INLINE)
def _start(slots, feet, state, work, padded, h, founded):
    """Order 0 of the series from the state."""
    for b in range(0, padded, 8):
        store(work.U, b, load(state.u, b))
        store(work.W, b, load(state.v, b) * h)
    if founded:
        for f in range(feet.number):
            work.phi_D[f] = state.phi[f]
            work.phi_W[f] = h * state.phi_v[f]
            for i in range(feet.first[f], feet.stop[f]):
                work.tilt[i] = slots.rise[i] * state.phi[f]


@njit(**INLINE)
def _storey_branch(slots, state, work, i):
    """Stiffness and offset of the branch storey i is on."""
    k0 = slots.stiffness[i]
    a = slots.hardening[i]
    if state.line[i] == 0.0:
        work.tangent[i] = k0
        work.offset[i] = -(1.0 - a) * k0 * state.plastic[i]
    else:
        work.tangent[i] = a * k0
        work.offset[i] = state.line[i] * slots.plateau[i]


@njit(**INLINE)
def _storey_event(slots, state, work, i, drift):
    """Change the branch of storey i, which leaves its own at `drift` [m]."""
    if state.line[i] == 0.0:
        line = 1.0 if drift > state.plastic[i] else -1.0
        state.line[i] = line
        state.plastic[i] = np.inf  # no elastic range is watched while the storey is on a yield line
        state.snapped_storey[i] = 0
    else:
        line = state.line[i]
        state.line[i] = 0.0
        state.plastic[i] = drift - line * slots.yield_drift[i]
        state.snapped_storey[i] = int(line)
    _storey_branch(slots, state, work, i)
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

    source = source_digest()

    @njit(**OPTIONS)
    def integrate(
        slot_arrays, foot_arrays, link_arrays, state_arrays, peak_arrays, ledger_arrays, nodes, weights, room, starts,
        slopes, dt, tolerance, quiet, most_order, most_steps, most_events,
    ):  # fmt: skip
        """Run over all segments of the ground motion, a_g = starts[j] + slopes[j] t within segment j of length dt.

        `room` is scratch (`room_needed`), zeroed and at a cache line. `nodes` and `weights` are Gauss-Legendre
        rules on [0, 1] (`ledger.MOST_POINTS`). Fills state, peaks and ledger in place; returns (status, steps, events,
        orders computed, time reached [s]).
        """
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        slots, feet, links = (
            slot_pointers(slot_arrays),
            foot_pointers(foot_arrays),
            link_pointers(link_arrays),
        )
        state, peaks = state_pointers(state_arrays), peak_pointers(peak_arrays)
        ledger = ledger_pointers(ledger_arrays)
        points, shares = pointer(nodes), pointer(weights)
        padded = slots.size
        link_count = links.size
        work, ends, scratch = _workspace(pointer(room), padded, feet.number, link_count)
        for i in range(padded):
            _storey_branch(slots, state, work, i)
        for i in range(padded):
            restencil(slots, work, i)
        for e in range(links.number):
            set_law(links, state, work.law, e)
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
            fraction = remaining / dt  # what is left of a segment after an event needs fewer orders
            ag = starts[segment] + slopes[segment] * offset
            _start(slots, feet, state, work, padded, h, founded)
            busy = closings(links, state, work) if kinds != LINKS_NONE else 0
            order, close = expand(
                slots, feet, links, state, work, busy, padded, h, ag, slopes[segment], tolerance,
                quiet, max(2, int(guess * (0.4 + 0.6 * fraction))), most_order, founded, kinds,
            )  # fmt: skip
            steps += 1
            orders += order
            whole = True
            if close:
                if fraction > 0.5:
                    guess = order - 2
            else:
                guess = most_order - 2
                ratio = shrink(slots, feet, work, padded, h, tolerance, quiet, order)
                if not ratio > 1e-14:
                    return NOT_FINITE, steps, events, orders, segment * dt + offset
                if ratio < 1.0:
                    ratio = 1.0 / np.ceil(1.0 / ratio) if ratio > 0.01 else ratio
                    rescale(feet, links, work, busy, padded, order, ratio, founded, kinds)
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
                s, storey = first_storey_event(slots, state, work, ends, padded, order, scratch)
                if storey >= 0:
                    end = s
            if kinds != LINKS_NONE:
                s, link, event = first_link_event(links, state, work, ends, padded, order, end, scratch, kinds)
                if link >= 0:
                    if storey >= 0 and s >= end:
                        link = -1
                    else:
                        end = s
                        storey = -1
            if end < 1.0:
                stop_at(slots, work, ends, padded, order, end, ground, ground_slope, founded)
            account(
                slots, feet, links, state, work, ends, ledger, points, shares, order, end, h, ag, slopes[segment], busy,
                inelastic, founded, kinds,
            )  # fmt: skip
            track(
                feet, links, state, work, ends, peaks, padded, order, end, scratch, h, ground,
                ground_slope, inelastic, founded, kinds,
            )  # fmt: skip
            if peaks.watched != 0:
                watch(work, ends, peaks, padded, segment)
            renew_scale(work, ends, padded, h)
            happened = storey >= 0 or link >= 0
            if end > 0.0:
                standing = 0
                if snapped:
                    for e in range(links.number):
                        state.snapped_link[e] = NOTHING
                        work.turns[e] = 0.0
                    for i in range(padded):
                        state.snapped_storey[i] = 0
                    snapped = False
            if storey >= 0:
                for i in range(
                    storey, padded
                ):  # all that leave their branch at the same time, so that twins stay twins
                    if work.roots[i] == end:
                        _storey_event(slots, state, work, i, ends.drift[i] if end > 0.0 else work.D[i])
            if link >= 0:
                _link_event(links, state, peaks, link, event)
                set_law(links, state, work.law, link)
                work.turns[link] += 1.0
            if end > 0.0:
                rate = 1.0 / h
                for b in range(0, padded, 8):
                    store(state.u, b, load(ends.u, b))
                    store(state.v, b, load(ends.v, b) * rate)
                if founded:
                    feet_count = feet.number
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
