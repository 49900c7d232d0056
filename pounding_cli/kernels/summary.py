"""What one step's series say about the whole step: its end, and bounds that exclude events and new peaks cheaply.

A function on [0, 1] strays from the straight line between its ends by at most max |p''| / 8, and |p''| is at most
sum k (k - 1) |c_k|: that sum, an eighth of it, is the *stray* of a quantity. A quantity whose rate has one sign at
both ends, and there exceeds the rate's stray, is monotone: its largest value stands at an end."""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.simd import from_left, load, magnitude, splat, store

Ends = namedtuple(
    "Ends",
    "u v drift rate0 rate acceleration0 acceleration jerk "
    "u_stray v_stray drift_stray rate_stray acceleration_stray jerk_stray",
)
"""Per slot, shape (padded,), in units of s: displacement, velocity, drift, drift rate, total acceleration and jerk
at the step's end (with 0: at its start), and strays."""


@njit(**INLINE)
def summarise(slots, work, ends, padded, order, ground, ground_slope, founded):
    """Fill `ends` and the drift's coefficients; `ground` and `ground_slope` are h^2 a_g at s = 0 and its change."""
    for b in range(0, padded, 8):
        couple = load(slots.couple, b)
        u = splat(0.0)
        v = splat(0.0)
        drift = splat(0.0)
        acceleration = splat(ground + ground_slope)
        jerk = splat(ground_slope)
        u_stray = splat(0.0)
        v_stray = splat(0.0)
        drift_stray = splat(0.0)
        rate_stray = splat(0.0)
        acceleration_stray = splat(0.0)
        jerk_stray = splat(0.0)
        for k in range(order + 1):
            row = k * padded + b
            curve = work.curve[k]
            twist = work.twist[k]
            term = load(work.U, row)
            size = magnitude(term)
            below = load(work.U, row - 8) if b > 0 else splat(0.0)
            u = u + term
            u_stray = u_stray + size * curve
            v_stray = v_stray + size * twist
            term = term - couple * from_left(below, term)
            if founded:
                term = term - load(work.tilt, row)
            store(work.D, row, term)
            size = magnitude(term)
            drift = drift + term
            drift_stray = drift_stray + size * curve
            rate_stray = rate_stray + size * twist
            term = load(work.W, row)
            v = v + term
            if k > 0:
                term = term * (1.0 * k)
                size = magnitude(term)
                acceleration = acceleration + term
                jerk = jerk + term * (k - 1.0)
                acceleration_stray = acceleration_stray + size * work.curve[k - 1]
                jerk_stray = jerk_stray + size * work.twist[k - 1]
        store(ends.u, b, u)
        store(ends.v, b, v)
        store(ends.drift, b, drift)
        store(ends.acceleration0, b, load(work.W, padded + b) + ground)
        store(ends.acceleration, b, acceleration)
        store(ends.jerk, b, jerk)
        store(ends.u_stray, b, u_stray)
        store(ends.v_stray, b, v_stray)
        store(ends.drift_stray, b, drift_stray)
        store(ends.rate_stray, b, rate_stray)
        store(ends.acceleration_stray, b, acceleration_stray)
        store(ends.jerk_stray, b, jerk_stray)
    _drift_rates(slots, work, ends, padded, order, founded)


@njit(**INLINE)
def _drift_rates(slots, work, ends, padded, order, founded):
    """Drift rates at both ends; with a rocking foundation they are left unknown, so that nothing is excluded by
    them."""
    v_left = splat(0.0)
    w_left = splat(0.0)
    for b in range(0, padded, 8):
        couple = load(slots.couple, b)
        v = load(ends.v, b)
        w = load(work.W, b)
        store(ends.rate, b, v - couple * from_left(v_left, v))
        store(ends.rate0, b, w - couple * from_left(w_left, w))
        v_left = v
        w_left = w
        if founded:
            store(ends.rate_stray, b, splat(1e300))


@njit(**INLINE)
def stop_at(slots, work, ends, padded, order, s, ground, ground_slope, founded):
    """Replace what stands in `ends` for s = 1 by the values at s < 1, where an event was found; the strays stay
    bounds."""
    for b in range(0, padded, 8):
        u = splat(0.0)
        v = splat(0.0)
        drift = splat(0.0)
        acceleration = splat(0.0)
        jerk = splat(0.0)
        for k in range(order, -1, -1):
            u = u * s + load(work.U, k * padded + b)
            term = load(work.W, k * padded + b)
            v = v * s + term
            drift = drift * s + load(work.D, k * padded + b)
            if k > 0:
                acceleration = acceleration * s + term * (1.0 * k)
            if k > 1:
                jerk = jerk * s + term * (k * (k - 1.0))
        store(ends.u, b, u)
        store(ends.v, b, v)
        store(ends.drift, b, drift)
        store(ends.acceleration, b, acceleration + (ground + ground_slope * s))
        store(ends.jerk, b, jerk + ground_slope)
    _drift_rates(slots, work, ends, padded, order, founded)
