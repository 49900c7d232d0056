"""Peaks between the ends of a smooth step, on the polynomials through both ends (`hermite`)."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.branches import held_shear
from pounding_cli.kernels.forces import deformation
from pounding_cli.kernels.hermite import cubic, quintic
from pounding_cli.kernels.law_table import branch
from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.link_force import branch_at, held_force_rate
from pounding_cli.kernels.polynomial import ABSOLUTE, SIGNED, highest
from pounding_cli.kernels.simd import short_array
from pounding_cli.kernels.storey_law import follow, shear_on
from pounding_cli.laws.program import MEMORIES

SHORTEST = 1e-7
"""Steps shorter than this [s], between events that coincide, have no mean acceleration: it is a difference of
velocities over nothing. Their ends say it all."""


@njit(**INLINE)
def restoring(slots, state, storeys, i, drift, located):
    """Shear of storey i [N] at `drift`: on its branch where branches are located, else on the branches that the sample
    had and as far as the drift leaves them."""
    if located:
        return held_shear(slots, state, i, drift)
    b = int(storeys.branch[i])
    if b == t.NO_BRANCH:
        return slots.stiffness[i] * drift
    memory = short_array()
    for m in range(MEMORIES):
        memory[m] = storeys.memory[m * slots.size + i]
    b = follow(slots, b, storeys.before[i], drift, memory, MEMORIES, 0, 1)
    return shear_on(slots, b, drift, memory, 0, 1)


@njit(**INLINE)
def raise_displacements(slots, peaks, scratch, h, u0, v0, a0, u1, v1, a1):
    """Displacements that turn inside the step."""
    for i in range(slots.size):
        if v0[i] * v1[i] < 0.0:
            quintic(scratch, h, u0[i], v0[i], a0[i], u1[i], v1[i], a1[i])
            if v0[i] > 0.0:
                peaks.displacement_max[i] = highest(scratch, 5, 1.0, peaks.displacement_max[i], SIGNED)
            else:
                for k in range(6):
                    scratch[k] = -scratch[k]
                peaks.displacement_min[i] = -highest(scratch, 5, 1.0, -peaks.displacement_min[i], SIGNED)


@njit(**INLINE)
def raise_accelerations(slots, peaks, h, ground0, ground1, v0, a0, v1, a1):
    """Total accelerations that turn inside the step: the parabola through both ends with the right mean, which is known
    from the velocities; error O(h^3)."""
    if h < SHORTEST:
        return
    for i in range(slots.size):
        ground = (ground1 - ground0) * slots.loaded[i]
        change = a1[i] - a0[i]
        bend = 3.0 * change - 6.0 * ((v1[i] - v0[i]) / h - a0[i])
        first = a0[i] + ground0 * slots.loaded[i]
        slope = change + ground - bend
        if slope * (slope + 2.0 * bend) < 0.0:
            top = first - 0.25 * slope * slope / bend
            peaks.acceleration[i] = max(peaks.acceleration[i], abs(top))


@njit(**INLINE)
def raise_drift(slots, peaks, i, h, d0, r0, q0, d1, r1, q1, state, storeys, located, scratch):
    """Drift and shear of storey i that turn inside the step."""
    if r0 * r1 >= 0.0:
        return
    quintic(scratch, h, d0, r0, q0, d1, r1, q1)
    side = 1.0 if r0 > 0.0 else -1.0
    for k in range(6):
        scratch[k] *= side
    top = side * highest(scratch, 5, 1.0, max(side * d0, side * d1), SIGNED)
    peaks.drift[i] = max(peaks.drift[i], abs(top))
    peaks.shear[i] = max(peaks.shear[i], abs(restoring(slots, state, storeys, i, top, located)))


@njit(**INLINE)
def raise_links(elements, links, state, peaks, scratch, h, u0, v0, a0, u1, v1, a1, force0, force1, located):
    """Closings, forces, impulses and contact times of a step; forces are the links' at both ends."""
    for e in range(links.number):
        element = elements.springs + e
        d0, r0, q0 = (deformation(elements, element, u0), deformation(elements, element, v0),
                      deformation(elements, element, a0))  # fmt: skip
        d1, r1, q1 = (deformation(elements, element, u1), deformation(elements, element, v1),
                      deformation(elements, element, a1))  # fmt: skip
        if r0 > 0.0 and r1 < 0.0:
            quintic(scratch, h, d0, r0, q0, d1, r1, q1)
            peaks.closing[e] = highest(scratch, 5, 1.0, peaks.closing[e], SIGNED)
        c0 = d0 - links.offset[e]
        c1 = d1 - links.offset[e]
        if located:
            b = state.link_branch[e]
            smooth = branch(links, b, t.ACTS) != 0.0
            acting = 1.0 if smooth else 0.0
        else:
            b = branch_at(links, e, c1)
            acts = (1 if force0[e] != 0.0 else 0) + (1 if force1[e] != 0.0 else 0)
            smooth = b >= 0 and b == branch_at(links, e, c0) and (acts == 2 or branch(links, b, t.CUTS) == 0.0)
            acting = 1.0 if smooth else 0.5 * acts
        peaks.contact_time[e] += acting * h
        if not smooth:
            if not located:
                peaks.impulse[e] += 0.5 * h * (force0[e] + force1[e])
            continue
        g0 = held_force_rate(links, b, c0, r0, q0)
        g1 = held_force_rate(links, b, c1, r1, q1)
        peaks.impulse[e] += 0.5 * h * (force0[e] + force1[e]) + h * h / 12.0 * (g0 - g1)
        if max(abs(force0[e]), abs(force1[e])) + h * (abs(g0) + abs(g1)) > peaks.force[e]:
            cubic(scratch, h, force0[e], g0, force1[e], g1)
            peaks.force[e] = highest(scratch, 3, 1.0, peaks.force[e], ABSOLUTE)
