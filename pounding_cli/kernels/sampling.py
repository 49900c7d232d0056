"""Peaks as fixed-step methods see them: the largest value at the samples, nothing between."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.link_force import branch_at


@njit(**INLINE)
def sample(slots, feet, links, peaks, touching, u, phi, ground, acceleration, drift, shear, force, dt):
    """Raise the peaks by one sample of length dt; `touching` remembers which links were closed."""
    size = slots.size
    for i in range(size):
        peaks.drift[i] = max(peaks.drift[i], abs(drift[i]))
        peaks.shear[i] = max(peaks.shear[i], abs(shear[i]))
        peaks.acceleration[i] = max(peaks.acceleration[i], abs(acceleration[i] + ground * slots.real[i]))
        peaks.displacement_max[i] = max(peaks.displacement_max[i], u[i])
        peaks.displacement_min[i] = min(peaks.displacement_min[i], u[i])
    for f in range(feet.number):
        peaks.rocking[f] = max(peaks.rocking[f], abs(phi[f]))
    for e in range(links.number):
        closing = u[links.left[e]] - u[links.right[e]]
        peaks.closing[e] = max(peaks.closing[e], closing)
        pushing = force[size + e]
        peaks.force[e] = max(peaks.force[e], abs(pushing))
        peaks.impulse[e] += pushing * dt
        if pushing != 0.0:
            peaks.contact_time[e] += dt
        closed = 1 if branch_at(links, e, closing - links.offset[e]) >= 0 else 0
        peaks.impacts[e] += closed * (1 - touching[e])
        touching[e] = closed
