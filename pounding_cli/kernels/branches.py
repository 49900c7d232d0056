"""Storeys and links held on their branches, where each branch ends, and what follows: event location for one-step
methods.

A branch is a smooth law that is followed beyond its end until the end has been located; the laws themselves are
those of `forces`, corrected where the branch differs from them."""

from __future__ import annotations

import math

from numba import njit

from pounding_cli.kernels.crossings import CLOSES, OPENS, PULLS, PUSHES, SOFTENS, STIFFENS
from pounding_cli.kernels.forces import accelerations, link_force
from pounding_cli.kernels.hermite import cubic, quintic
from pounding_cli.kernels.layout import (
    AT_GAP,
    AT_ZERO,
    CONNECTOR,
    CUBIC,
    INFILL,
    INLINE,
    LINEAR,
    NO_FORCE,
    OPEN,
    POUNDING,
)
from pounding_cli.kernels.polynomial import NEVER, first_crossing


@njit(**INLINE)
def held_force(links, e, branch, v, rate):
    """Force of link e [N] on its branch, whatever v [m]; a tension cut-off is not applied."""
    if branch == OPEN:
        return 0.0
    if branch == CUBIC:
        slope = max(links.stiffness[e] + 3.0 * links.cubic[e] * v * v, 0.0)
        return links.cubic[e] * v**3 + links.stiffness[e] * v + links.root_dashpot[e] * math.sqrt(slope) * rate
    if links.kind[e] == INFILL:
        return links.beyond[e] * v + links.beyond_force[e] + links.beyond_dashpot[e] * rate
    return links.stiffness[e] * v + links.dashpot[e] * rate


@njit(**INLINE)
def held_force_rate(links, e, branch, v, rate, acceleration):
    """Time derivative of `held_force` [N/s]."""
    if branch == OPEN:
        return 0.0
    if branch == CUBIC:
        slope = links.stiffness[e] + 3.0 * links.cubic[e] * v * v
        root = math.sqrt(slope)
        dashpot = links.root_dashpot[e] * root
        dashpot_rate = links.root_dashpot[e] * 3.0 * links.cubic[e] * v * rate / root
        return slope * rate + dashpot_rate * rate + dashpot * acceleration
    if links.kind[e] == INFILL:
        return links.beyond[e] * rate + links.beyond_dashpot[e] * acceleration
    return links.stiffness[e] * rate + links.dashpot[e] * acceleration


@njit(**INLINE)
def held_shear(slots, state, i, drift):
    """Restoring force of storey i [N] on its branch."""
    k = slots.stiffness[i]
    a = slots.hardening[i]
    if state.line[i] != 0.0:
        return a * k * drift + state.line[i] * slots.plateau[i]
    return k * (drift - (1.0 - a) * state.plastic[i])


@njit(**INLINE)
def closing_of(links, e, u):
    """Closing of link e as its law takes it [m]: the gap is subtracted for pounding."""
    v = u[links.left[e]] - u[links.right[e]]
    return v - links.gap[e] if links.kind[e] == POUNDING else v


@njit(**INLINE)
def held_accelerations(
    slots, feet, links, state, u, v, phi, phi_v, ground, inelastic, out, out_phi, drift, shear, force
):  # fmt: skip
    """`forces.accelerations` with every storey and link on the branch that `state` gives it."""
    accelerations(slots, feet, links, state.plastic, u, v, phi, phi_v, ground, False, out, out_phi, drift, shear, force)
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
                for f in range(feet.number):
                    if feet.first[f] <= i < feet.stop[f]:
                        out_phi[f] += excess * slots.rise[i] / feet.inertia[f]
    for e in range(links.number):
        left = links.left[e]
        right = links.right[e]
        closing = closing_of(links, e, u)
        rate = v[left] - v[right]
        held = 0.0 if state.link_cut[e] == 1 else held_force(links, e, state.link_branch[e], closing, rate)
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
        room0 = limit - side * (d0 - state.plastic[i])
        room1 = limit - side * (d1 - state.plastic[i])
        if min(room0, room1) > swing:
            continue
        quintic(scratch, h, room0, -side * r0, -side * q0, room1, -side * r1, -side * q1)
        if state.snapped_storey[i] == side:  # just unloaded: on the line and at rest
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
    """(s, event) of the first change of link e in a step h; closing, its rate and acceleration at both ends."""
    if links.kind[e] == CONNECTOR:
        return NEVER, CLOSES
    branch = state.link_branch[e]
    snapped = state.snapped_link[e]
    swing = 0.5 * h * (abs(r0) + abs(r1))
    from_rest = snapped == AT_ZERO and r0 == 0.0 and q0 == 0.0
    if branch == OPEN:
        if max(v0, v1) < -swing:
            return NEVER, CLOSES
        quintic(scratch, h, -v0, -r0, -q0, -v1, -r1, -q1)
        if snapped == AT_ZERO:
            scratch[0] = 0.0
        return _leaves_zero(scratch, from_rest), CLOSES
    earliest = NEVER
    event = OPENS
    infill = links.kind[e] == INFILL
    if branch == CUBIC or not infill:
        quintic(scratch, h, v0, r0, q0, v1, r1, q1)
        if snapped == AT_ZERO:
            scratch[0] = 0.0
        earliest = _leaves_zero(scratch, from_rest)
    if infill:
        sign = -1.0 if branch == CUBIC else 1.0
        gap = links.gap[e]
        quintic(scratch, h, sign * (v0 - gap), sign * r0, sign * q0, sign * (v1 - gap), sign * r1, sign * q1)
        if snapped == AT_GAP:
            scratch[0] = 0.0
        s = first_crossing(scratch, 5, 1.0)
        if s < earliest:
            earliest = s
            event = STIFFENS if branch == CUBIC else SOFTENS
    if links.tension_cut[e] == 1:
        cut = state.link_cut[e] == 1
        sign = -1.0 if cut else 1.0
        f0 = held_force(links, e, branch, v0, r0)
        f1 = held_force(links, e, branch, v1, r1)
        g0 = held_force_rate(links, e, branch, v0, r0, q0)
        g1 = held_force_rate(links, e, branch, v1, r1, q1)
        cubic(scratch, h, sign * f0, sign * g0, sign * f1, sign * g1)
        if snapped == NO_FORCE:
            scratch[0] = 0.0
        s = first_crossing(scratch, 3, 1.0)
        if s < earliest:
            earliest = s
            event = PUSHES if cut else PULLS
    return earliest, event


@njit(**INLINE)
def switch_storey(slots, state, i, drift):
    """Storey i leaves its branch at `drift` [m]: onto a yield line, or off it."""
    if state.line[i] == 0.0:
        state.line[i] = 1.0 if drift > state.plastic[i] else -1.0
        state.snapped_storey[i] = 0
    else:
        side = state.line[i]
        state.line[i] = 0.0
        state.plastic[i] = drift - side * slots.yield_drift[i]
        state.snapped_storey[i] = int(side)


@njit(**INLINE)
def switch_link(links, state, peaks, e, event):
    """Link e changes its branch; a closing counts as an impact."""
    if event == CLOSES:
        state.link_branch[e] = CUBIC if links.kind[e] == INFILL else LINEAR
        state.snapped_link[e] = AT_ZERO
        peaks.impacts[e] += 1
    elif event == OPENS:
        state.link_branch[e] = OPEN
        state.link_cut[e] = 0
        state.snapped_link[e] = AT_ZERO
    elif event in (STIFFENS, SOFTENS):
        state.link_branch[e] = LINEAR if event == STIFFENS else CUBIC
        state.snapped_link[e] = AT_GAP
    else:
        state.link_cut[e] = 1 if event == PULLS else 0
        state.snapped_link[e] = NO_FORCE
