"""What one step's series say about the whole step: its end, and bounds that exclude events and new peaks cheaply.

A function on [0, 1] strays from the straight line between its ends by at most max |p''| / 8, and |p''| is at most
sum k (k - 1) |c_k|: that sum, an eighth of it, is the *stray* of drift, displacement and acceleration.
"""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.simd import from_left, load, magnitude, splat, store

Ends = namedtuple(
    "Ends", "u v drift u_stray drift_stray first_acceleration last_acceleration acceleration_stray"
)
"""Per slot, shape (padded,): displacement, dv/ds and drift at s = 1; the strays; h^2 times the total acceleration at s = 0 and 1."""


@njit(**INLINE)
def summarise(slots, work, ends, padded, order, ground, ground_slope, founded):
    """Fill `ends` and the drift's coefficients; `ground` and `ground_slope` are h^2 a_g at s = 0 and its change."""
    for b in range(0, padded, 8):
        couple = load(slots.couple, b)
        u = splat(0.0)
        v = splat(0.0)
        drift = splat(0.0)
        u_stray = splat(0.0)
        drift_stray = splat(0.0)
        last = splat(ground + ground_slope)
        acceleration_stray = splat(0.0)
        for k in range(order + 1):
            row = k * padded + b
            curve = work.curve[k]
            term = load(work.U, row)
            below = load(work.U, row - 8) if b > 0 else splat(0.0)
            u = u + term
            u_stray = u_stray + magnitude(term) * curve
            term = term - couple * from_left(below, term)
            if founded:
                term = term - load(work.tilt, row)
            store(work.D, row, term)
            drift = drift + term
            drift_stray = drift_stray + magnitude(term) * curve
            term = load(work.W, row)
            v = v + term
            term = term * (1.0 * k)
            last = last + term
            if k > 0:
                acceleration_stray = acceleration_stray + magnitude(term) * work.curve[k - 1]
        store(ends.u, b, u)
        store(ends.v, b, v)
        store(ends.drift, b, drift)
        store(ends.u_stray, b, u_stray)
        store(ends.drift_stray, b, drift_stray)
        store(ends.first_acceleration, b, load(work.W, padded + b) + ground)
        store(ends.last_acceleration, b, last)
        store(ends.acceleration_stray, b, acceleration_stray)


@njit(**INLINE)
def stop_at(work, ends, padded, order, s):
    """Replace the end state by the one at s < 1, where an event was found."""
    for b in range(0, padded, 8):
        u = load(work.U, order * padded + b)
        v = load(work.W, order * padded + b)
        for k in range(order - 1, -1, -1):
            u = u * s + load(work.U, k * padded + b)
            v = v * s + load(work.W, k * padded + b)
        store(ends.u, b, u)
        store(ends.v, b, v)
