"""What one step's series say about the whole step: its end, and bounds that exclude events and new peaks cheaply.

A function on [0, 1] strays from the straight line between its ends by at most max |p''| / 8, and |p''| is at most
sum k (k - 1) |c_k|: that sum, an eighth of it, is the *stray* of drift, displacement and acceleration.
"""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.simd import load, magnitude, splat, store

Ends = namedtuple(
    "Ends", "u v drift u_stray drift_stray first_acceleration last_acceleration acceleration_stray"
)
"""Per slot, shape (padded,): displacement, dv/ds and drift at s = 1; the strays; h^2 times the total acceleration at s = 0 and 1."""


@njit(**INLINE)
def summarise(state, work, ends, padded, order, ground, ground_slope):
    """Fill `ends`; `ground` and `ground_slope` are h^2 a_g at s = 0 and its change over the step."""
    for b in range(0, padded, 8):
        before = load(work.W, b)
        u = load(state.u, b) + before
        v = before
        drift = load(work.D, b)
        u_stray = splat(0.0)
        drift_stray = splat(0.0)
        rate = load(work.W, padded + b)
        first = rate + ground
        last = rate + (ground + ground_slope)
        acceleration_stray = splat(0.0)
        drift = drift + load(work.D, padded + b)
        v = v + rate
        before = rate
        for k in range(2, order + 1):
            row = k * padded + b
            curve = work.curve[k]
            term = before * work.reciprocal[k]
            u = u + term
            u_stray = u_stray + magnitude(term) * curve
            term = load(work.D, row)
            drift = drift + term
            drift_stray = drift_stray + magnitude(term) * curve
            rate = load(work.W, row)
            v = v + rate
            term = rate * (1.0 * k)
            last = last + term
            acceleration_stray = acceleration_stray + magnitude(term) * work.curve[k - 1]
            before = rate
        store(ends.u, b, u)
        store(ends.v, b, v)
        store(ends.drift, b, drift)
        store(ends.u_stray, b, u_stray)
        store(ends.drift_stray, b, drift_stray)
        store(ends.first_acceleration, b, first)
        store(ends.last_acceleration, b, last)
        store(ends.acceleration_stray, b, acceleration_stray)


@njit(**INLINE)
def stop_at(state, work, ends, padded, order, s):
    """Replace the end state by the one at s < 1, where an event was found."""
    for b in range(0, padded, 8):
        u = splat(0.0)
        v = load(work.W, order * padded + b)
        for k in range(order - 1, -1, -1):
            before = load(work.W, k * padded + b)
            u = (
                (u + before * work.reciprocal[k + 1]) * s
                if k < order - 1
                else before * (work.reciprocal[k + 1] * s)
            )
            v = v * s + before
        store(ends.u, b, u + load(state.u, b))
        store(ends.v, b, v)
