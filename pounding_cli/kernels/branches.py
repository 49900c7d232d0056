"""Storeys and links held on their branches, where each branch ends, and what follows: event location for one-step
methods.

A branch is a smooth law that is followed beyond its end until the end has been located; the laws themselves are
those of `forces`, corrected where the branch differs from them."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import link_table as t
from pounding_cli.kernels.forces import accelerations
from pounding_cli.kernels.hermite import cubic, quintic
from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.link_force import closing_of, held_force, held_force_rate, link_force
from pounding_cli.kernels.link_table import branch, guard
from pounding_cli.kernels.polynomial import NEVER, first_crossing
from pounding_cli.kernels.storey_law import fused_coefficients, fused_transition


@njit(**INLINE)
def held_shear(slots, state, i, drift):
    """Restoring force of storey i [N] on its branch."""
    tangent, offset = fused_coefficients(
        slots.stiffness[i], slots.hardening[i], slots.plateau[i], state.line[i], state.plastic[i]
    )
    return tangent * drift + offset


@njit(**INLINE)
def held_accelerations(
    slots, foundations, links, state, u, v, phi, phi_v, ground, inelastic, out, out_phi, drift, shear, force
):  # fmt: skip
    """`forces.accelerations` with every storey and link on the branch that `state` gives it."""
    accelerations(
        slots, foundations, links, state.plastic, u, v, phi, phi_v, ground, False, out, out_phi, drift, shear, force
    )
    size = slots.size
    if inelastic:
        for i in range(size):
            if state.line[i] == 0.0 and state.plastic[i] == 0.0:
                continue
            held = held_shear(slots, state, i, drift[i])
            excess = held - shear[i]
            shear[i] = held
            out[i] -= excess * slots.inverse_mass[i]
            if slots.couple[i] != 0.0:
                out[i - 1] += excess * slots.inverse_mass[i - 1]
            if slots.rise[i] != 0.0:
                for f in range(foundations.number):
                    if foundations.first[f] <= i < foundations.stop[f]:
                        out_phi[f] += excess * slots.rise[i] / foundations.inertia[f]
    for e in range(links.number):
        left = links.left[e]
        right = links.right[e]
        closing = closing_of(links, e, u)
        rate = v[left] - v[right]
        b = state.link_branch[e]
        held = held_force(links, b, closing, rate) * branch(links, b, t.ACTS)
        excess = held - link_force(links, e, closing, rate)
        force[size + e] = held
        out[left] -= excess * slots.inverse_mass[left]
        out[right] += excess * slots.inverse_mass[right]


@njit(**INLINE)
def storey_branch_end(slots, state, i, h, d0, r0, q0, d1, r1, q1, scratch):
    """First s in [0, 1] of a step h where storey i leaves its branch; drift, its rate and acceleration at both ends."""
    line = state.line[i]
    if line != 0.0:
        if line * r0 > 0.0 and line * r1 > 0.0 and abs(h * q0) + abs(h * q1) < abs(r0) + abs(r1):
            return NEVER
        quintic(scratch, h, d0, r0, q0, d1, r1, q1)
        for k in range(5):  # the drift turns back
            scratch[k] = line * (k + 1) * scratch[k + 1]
        return first_crossing(scratch, 4, 1.0)
    earliest = NEVER
    limit = slots.yield_drift[i]
    swing = 0.5 * h * (abs(r0) + abs(r1))
    for side in (1.0, -1.0):
        distance0 = limit - side * (d0 - state.plastic[i])
        distance1 = limit - side * (d1 - state.plastic[i])
        if min(distance0, distance1) > swing:
            continue
        quintic(scratch, h, distance0, -side * r0, -side * q0, distance1, -side * r1, -side * q1)
        if state.pinned_storey[i] == side:  # just unloaded: on the line and at rest
            scratch[0] = 0.0
            scratch[1] = 0.0
        earliest = min(earliest, first_crossing(scratch, 5, 1.0))
    return earliest


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
def switch_storey(slots, state, i, drift):
    """Storey i leaves its branch at `drift` [m]: onto a yield line, or off it."""
    state.line[i], state.plastic[i], state.pinned_storey[i] = fused_transition(
        state.line[i], state.plastic[i], slots.yield_drift[i], drift
    )


@njit(**INLINE)
def switch_link(links, state, peaks, e, g):
    """Link e has met guard g: the branch that follows, what is known exactly now, and whether that was a blow."""
    state.link_branch[e] = int(guard(links, g, t.NEXT))
    state.pinned_link[e] = int(guard(links, g, t.QUANTITY))
    state.pinned_closing[e] = guard(links, g, t.AT)
    peaks.impacts[e] += int(guard(links, g, t.IMPACT))
