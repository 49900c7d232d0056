"""The first event of a step: a storey yields or unloads, a link opens, closes, changes its law or starts to pull."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import (
    AT_GAP,
    AT_ZERO,
    CONNECTOR,
    CUBIC,
    INFILL,
    INLINE,
    LINKS_CUBIC,
    NO_FORCE,
    OPEN,
    POUNDING,
)
from pounding_cli.kernels.link_series import difference
from pounding_cli.kernels.polynomial import NEVER, first_crossing
from pounding_cli.kernels.simd import greater, load, lowest, magnitude, maximum, minimum, splat, store

STOREY, CLOSES, OPENS, STIFFENS, SOFTENS, PULLS, PUSHES = 0, 1, 2, 3, 4, 5, 6
"""Kinds of event."""

MOST_TURNS = 2
"""Events of a link at one instant after which it stays open, or its force as it is, until time goes on: one that undoes
itself at once is rounding (floors that part from rest at a high order of their motion, say)."""


@njit(**INLINE)
def _storey_crossing(slots, state, work, ends, padded, order, i, end, scratch):
    """First s in [0, end] where storey i leaves its branch."""
    branch = state.line[i]
    if branch != 0.0:  # the drift turns back
        for k in range(order):
            scratch[k] = branch * (k + 1) * work.D[(k + 1) * padded + i]
        return first_crossing(scratch, order - 1, end)
    earliest = NEVER
    first = work.D[i] - state.plastic[i]
    last = ends.drift[i] - state.plastic[i]
    limit = slots.yield_drift[i]
    for line in (1.0, -1.0):  # the elastic part of the drift reaches a yield line
        if max(line * first, line * last) + ends.drift_stray[i] <= limit:
            continue
        for k in range(1, order + 1):
            scratch[k] = -line * work.D[k * padded + i]
        scratch[0] = limit - line * first
        if state.snapped_storey[i] == line:  # just unloaded: exactly on the line and at rest
            scratch[0] = 0.0
            scratch[1] = 0.0
        s = first_crossing(scratch, order, min(end, earliest))
        earliest = min(earliest, s)
    return earliest


@njit(**INLINE)
def first_storey_event(slots, state, work, ends, padded, order, scratch):
    """(s, slot) of the first storey event in [0, 1], or (NEVER, -1); `work.roots` tells every storey's own."""
    earliest = NEVER
    which = -1
    zero = splat(0.0)
    never = splat(NEVER)
    for b in range(0, padded, 8):
        store(work.roots, b, never)
        plastic = load(state.plastic, b)
        reach = maximum(magnitude(load(work.D, b) - plastic), magnitude(load(ends.drift, b) - plastic))
        suspects = greater(reach + load(ends.drift_stray, b), load(slots.yield_drift, b))
        if suspects == 0:
            continue
        # On a yield line (where `plastic` is infinite, so always suspect) all is well while the drift goes on outward.
        line = load(state.line, b)
        rate0 = load(ends.rate0, b) * line
        rate = load(ends.rate, b) * line
        suspects &= ~(greater(minimum(rate0, rate), load(ends.rate_stray, b)) & greater(line * line, zero))
        while suspects != 0:
            i = b + lowest(suspects)
            suspects &= suspects - 1
            s = _storey_crossing(slots, state, work, ends, padded, order, i, 1.0, scratch)
            work.roots[i] = s
            if s < earliest and s <= 1.0:
                earliest = s
                which = i
    return earliest, which


@njit(**INLINE)
def _open_link_crossing(links, state, work, padded, order, e, closing, end, scratch):
    """First s where an open link closes; `closing` is v at s = 0."""
    left = links.left[e]
    right = links.right[e]
    scratch[0] = 0.0 if state.snapped_link[e] == AT_ZERO else -closing
    size = max(abs(state.u[left]), abs(state.u[right]))
    for k in range(1, order + 1):
        a = work.U[k * padded + right]
        b = work.U[k * padded + left]
        scratch[k] = difference(a, b, size)
        size = max(size, abs(a), abs(b))
    return first_crossing(scratch, order, end)


@njit(**INLINE)
def _closed_link_crossing(links, state, work, order, e, end, scratch, kinds):
    """(s, event) of the first change of a closed link."""
    count = links.size
    earliest = NEVER
    event = OPENS
    infill = kinds == LINKS_CUBIC and links.kind[e] == INFILL
    cubic = infill and state.link_branch[e] == CUBIC
    snapped = state.snapped_link[e]
    if cubic or not infill:  # v falls back to zero
        for k in range(order + 1):
            scratch[k] = work.V[k * count + e]
        earliest = first_crossing(scratch, order, end)
    if infill:  # v passes the infill's thickness, one way or the other
        sign = -1.0 if cubic else 1.0
        for k in range(order + 1):
            scratch[k] = sign * work.V[k * count + e]
        scratch[0] = 0.0 if snapped == AT_GAP else scratch[0] - sign * links.gap[e]
        s = first_crossing(scratch, order, min(end, earliest))
        if s < earliest:
            earliest = s
            event = STIFFENS if cubic else SOFTENS
    if links.tension_cut[e] == 1 and work.turns[e] < MOST_TURNS:  # the force changes sign
        cut = state.link_cut[e] == 1
        sign = -1.0 if cut else 1.0
        for k in range(order):
            scratch[k] = sign * work.F[k * count + e]
        if snapped == NO_FORCE:
            scratch[0] = 0.0
        s = first_crossing(scratch, order - 1, min(end, earliest))
        if s < earliest:
            earliest = s
            event = PUSHES if cut else PULLS
    return earliest, event


@njit(**INLINE)
def first_link_event(links, state, work, ends, padded, order, end, scratch, kinds):
    """(s, link, event) of the first link event in [0, end], or (NEVER, -1, 0)."""
    earliest = NEVER
    which = -1
    kind = 0
    for e in range(links.number):
        if links.kind[e] == CONNECTOR:
            continue
        left = links.left[e]
        right = links.right[e]
        if state.link_branch[e] == OPEN:
            thickness = links.gap[e] if links.kind[e] == POUNDING else 0.0
            closing = difference(state.u[left] - thickness, state.u[right], 0.0)
            last = ends.u[left] - ends.u[right] - thickness
            if max(closing, last) + ends.u_stray[left] + ends.u_stray[right] < 0.0:
                continue
            if work.turns[e] >= MOST_TURNS:
                continue
            s = _open_link_crossing(links, state, work, padded, order, e, closing, min(end, earliest), scratch)
            event = CLOSES
        else:
            s, event = _closed_link_crossing(links, state, work, order, e, min(end, earliest), scratch, kinds)
        if s < earliest and s <= end:
            earliest = s
            which = e
            kind = event
    return earliest, which, kind
