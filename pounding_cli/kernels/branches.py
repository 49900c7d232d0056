"""Storeys and links held on their branches, where each branch ends, and what follows: event location for one-step
methods.

A branch is a smooth law that is followed beyond its end until the end has been located."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.forces import apply, deformation
from pounding_cli.kernels.hermite import cubic, quintic
from pounding_cli.kernels.law_table import branch, guard
from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.link_force import held_force, held_force_rate
from pounding_cli.kernels.polynomial import NEVER, first_crossing
from pounding_cli.kernels.storey_law import guarded_drift, remember, shear_on, turning_guard
from pounding_cli.laws.program import MEMORIES


@njit(**INLINE)
def held_shear(slots, state, i, drift):
    """Restoring force of storey i [N] on its branch."""
    b = state.storey_branch[i]
    if b == t.NO_BRANCH:
        return slots.stiffness[i] * drift
    return shear_on(slots, b, drift, state.storey_memory, i, slots.size)


@njit(**INLINE)
def held_accelerations(slots, elements, links, state, u, v, ground, inelastic, out, drift, shear, force):
    """`forces.accelerations` with every storey and link on the branch that `state` gives it."""
    for i in range(elements.freedoms):
        out[i] = -elements.drag[i] * v[i]
    for e in range(elements.number):
        d, rate = deformation(elements, e, u), deformation(elements, e, v)
        if e < slots.size:
            drift[e] = d
            shear[e] = held_shear(slots, state, e, d) if inelastic else elements.stiffness[e] * d
            force[e] = shear[e] + elements.dashpot[e] * rate
        elif e < elements.springs:
            force[e] = elements.stiffness[e] * d + elements.dashpot[e] * rate
        else:
            link = e - elements.springs
            b = state.link_branch[link]
            force[e] = held_force(links, b, d - links.offset[link], rate) * branch(links, b, t.ACTS)
        apply(elements, e, force[e], out)
    for i in range(elements.freedoms):
        out[i] = out[i] * elements.inverse_mass[i] - ground * elements.loaded[i]


@njit(**INLINE)
def storey_branch_end(slots, state, i, h, d0, r0, q0, d1, r1, q1, scratch):
    """(s, guard) of the first guard that storey i meets in a step h; drift, its rate and acceleration at both ends."""
    b = state.storey_branch[i]
    swing = 0.5 * h * (abs(r0) + abs(r1))
    earliest = NEVER
    first = 0
    for g in range(int(branch(slots, b, t.FIRST_GUARD)), int(branch(slots, b, t.LAST_GUARD))):
        side, shift, at = guarded_drift(slots, b, g, state.storey_memory, i, slots.size)
        if guard(slots, g, t.QUANTITY) == t.RATE:
            if side * r0 > 0.0 and side * r1 > 0.0 and abs(h * q0) + abs(h * q1) < abs(r0) + abs(r1):
                continue
            quintic(scratch, h, d0, r0, q0, d1, r1, q1)
            for k in range(5):
                scratch[k] = side * (k + 1) * scratch[k + 1]
            s = first_crossing(scratch, 4, 1.0)
        else:
            distance0 = side * ((d0 - shift) - at)
            distance1 = side * ((d1 - shift) - at)
            if min(distance0, distance1) > swing:
                continue
            quintic(scratch, h, distance0, side * r0, side * q0, distance1, side * r1, side * q1)
            if state.pinned_storey[i] == g:  # it has just turned back: at rest
                scratch[0] = 0.0
                scratch[1] = 0.0
            s = first_crossing(scratch, 5, 1.0)
        if s < earliest:
            earliest = s
            first = g
    return earliest, first


@njit(**INLINE)
def _leaves_zero(c, from_rest):
    """First s where the quintic stops being positive; from rest, where its first coefficients are rounding, its end
    decides."""
    if from_rest:
        return 0.0 if c[0] + c[1] + c[2] + c[3] + c[4] + c[5] < 0.0 else NEVER
    return first_crossing(c, 5, 1.0)


@njit(**INLINE)
def link_branch_end(links, state, e, h, v0, r0, q0, v1, r1, q1, scratch):
    """(s, guard) of the first guard that link e meets in a step h; closing, its rate and acceleration at both ends."""
    b = state.link_branch[e]
    swing = 0.5 * h * (abs(r0) + abs(r1))
    earliest = NEVER
    first = -1
    for g in range(int(branch(links, b, t.FIRST_GUARD)), int(branch(links, b, t.LAST_GUARD))):
        side = guard(links, g, t.SIDE)
        at = guard(links, g, t.AT)
        known = state.pinned_link[e] == guard(links, g, t.QUANTITY)
        if guard(links, g, t.QUANTITY) == t.CLOSING:
            distance0 = side * (v0 - at)
            distance1 = side * (v1 - at)
            known = known and state.pinned_closing[e] == at
            if not known and min(distance0, distance1) > swing:
                continue
            quintic(scratch, h, distance0, side * r0, side * q0, distance1, side * r1, side * q1)
            if known:
                scratch[0] = 0.0
            s = _leaves_zero(scratch, known and r0 == 0.0 and q0 == 0.0)
        else:
            f0 = held_force(links, b, v0, r0)
            f1 = held_force(links, b, v1, r1)
            g0 = held_force_rate(links, b, v0, r0, q0)
            g1 = held_force_rate(links, b, v1, r1, q1)
            cubic(scratch, h, side * f0, side * g0, side * f1, side * g1)
            if known:
                scratch[0] = 0.0
            s = first_crossing(scratch, 3, 1.0)
        if s < earliest:
            earliest = s
            first = g
    return earliest, first


@njit(**INLINE)
def switch_storey(slots, state, i, g, drift, rate):
    """Storey i has met guard g at `drift` [m]: what it remembers, and the branch that follows."""
    left = state.storey_branch[i]
    remember(slots, g, drift, rate, state.storey_memory, MEMORIES, i, slots.size)
    b = int(guard(slots, g, t.NEXT))
    state.storey_branch[i] = b
    state.pinned_storey[i] = turning_guard(slots, b, left, guard(slots, g, t.QUANTITY))


@njit(**INLINE)
def switch_link(links, state, peaks, e, g):
    """Link e has met guard g: the branch that follows, what is known exactly now, and whether that was a blow."""
    state.link_branch[e] = int(guard(links, g, t.NEXT))
    state.pinned_link[e] = int(guard(links, g, t.QUANTITY))
    state.pinned_closing[e] = guard(links, g, t.AT)
    peaks.impacts[e] += int(guard(links, g, t.IMPACT))
