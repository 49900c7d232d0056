"""Largest values over a step: nothing is looked at closely unless its bound exceeds the peak so far."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import INLINE, LINKS_NONE, OPEN
from pounding_cli.kernels.polynomial import highest
from pounding_cli.kernels.recurrence import LARGEST_ORDER
from pounding_cli.kernels.simd import any_greater, load, magnitude, maximum, splat


@njit(**INLINE)
def _drift_peaks(work, ends, peaks, padded, order, end, scratch):
    for b in range(0, padded, 8):
        bound = maximum(magnitude(load(work.D, b)), magnitude(load(ends.drift, b))) + load(
            ends.drift_stray, b
        )
        if any_greater(bound, load(peaks.drift, b)):
            for i in range(b, b + 8):
                if max(abs(work.D[i]), abs(ends.drift[i])) + ends.drift_stray[i] > peaks.drift[i]:
                    for k in range(order + 1):
                        scratch[k] = work.D[k * padded + i]
                    peaks.drift[i] = highest(scratch, order, end, peaks.drift[i], True)


@njit(**INLINE)
def _shear_peaks(work, ends, peaks, padded, order, end, scratch):
    for b in range(0, padded, 8):
        tangent = load(work.tangent, b)
        offset = load(work.offset, b)
        first = magnitude(tangent * load(work.D, b) + offset)
        last = magnitude(tangent * load(ends.drift, b) + offset)
        if any_greater(maximum(first, last) + tangent * load(ends.drift_stray, b), load(peaks.shear, b)):
            for i in range(b, b + 8):
                tangent_i = work.tangent[i]
                first_i = abs(tangent_i * work.D[i] + work.offset[i])
                last_i = abs(tangent_i * ends.drift[i] + work.offset[i])
                if max(first_i, last_i) + tangent_i * ends.drift_stray[i] > peaks.shear[i]:
                    for k in range(order + 1):
                        scratch[k] = tangent_i * work.D[k * padded + i]
                    scratch[0] += work.offset[i]
                    peaks.shear[i] = highest(scratch, order, end, peaks.shear[i], True)


@njit(**INLINE)
def _displacement_peaks(state, work, ends, peaks, padded, order, end, scratch):
    for b in range(0, padded, 8):
        first = load(state.u, b)
        last = load(ends.u, b)
        stray = load(ends.u_stray, b)
        above = any_greater(maximum(first, last) + stray, load(peaks.displacement_max, b))
        minus = splat(-1.0)
        below = any_greater(
            maximum(minus * first, minus * last) + stray, minus * load(peaks.displacement_min, b)
        )
        if above or below:
            for i in range(b, b + 8):
                top = max(state.u[i], ends.u[i]) + ends.u_stray[i] > peaks.displacement_max[i]
                bottom = min(state.u[i], ends.u[i]) - ends.u_stray[i] < peaks.displacement_min[i]
                if top or bottom:
                    scratch[0] = state.u[i]
                    for k in range(1, order + 1):
                        scratch[k] = work.U[k * padded + i]
                    if top:
                        peaks.displacement_max[i] = highest(
                            scratch, order, end, peaks.displacement_max[i], False
                        )
                    if bottom:
                        for k in range(order + 1):
                            scratch[k] = -scratch[k]
                        peaks.displacement_min[i] = -highest(
                            scratch, order, end, -peaks.displacement_min[i], False
                        )


@njit(**INLINE)
def _acceleration_peaks(work, ends, peaks, padded, order, end, scratch, h, ground, ground_slope):
    scale = 1.0 / (h * h)
    for b in range(0, padded, 8):
        first = magnitude(load(ends.first_acceleration, b))
        bound = maximum(first, magnitude(load(ends.last_acceleration, b))) + load(ends.acceleration_stray, b)
        if any_greater(bound * scale, load(peaks.acceleration, b)):
            for i in range(b, b + 8):
                reach = max(abs(ends.first_acceleration[i]), abs(ends.last_acceleration[i]))
                if (reach + ends.acceleration_stray[i]) * scale > peaks.acceleration[i]:
                    for k in range(order):
                        scratch[k] = (k + 1) * work.W[(k + 1) * padded + i] * scale
                    scratch[0] += ground * scale
                    scratch[1] += ground_slope * scale
                    peaks.acceleration[i] = highest(scratch, order - 1, end, peaks.acceleration[i], True)


@njit(**INLINE)
def _rocking_peaks(feet, work, peaks, order, end, scratch):
    count = feet.first.size
    for f in range(count):
        for k in range(order + 1):
            scratch[k] = work.phi_D[k * count + f]
        peaks.rocking[f] = highest(scratch, order, end, peaks.rocking[f], True)


@njit(**INLINE)
def _link_peaks(links, state, work, ends, peaks, active, count, padded, order, end, scratch, h):
    for e in range(links.left.size):
        left = links.left[e]
        right = links.right[e]
        first = state.u[left] - state.u[right]
        last = ends.u[left] - ends.u[right]
        if max(first, last) + ends.u_stray[left] + ends.u_stray[right] > peaks.closing[e]:
            scratch[0] = first
            for k in range(1, order + 1):
                scratch[k] = work.U[k * padded + left] - work.U[k * padded + right]
            peaks.closing[e] = highest(scratch, order, end, peaks.closing[e], False)
    scale = 1.0 / (h * h)
    for a in range(count):
        e = active[a]
        if state.link_branch[e] == OPEN or state.link_cut[e] == 1:
            continue
        base = e * LARGEST_ORDER
        power = end
        impulse = 0.0
        reach = 0.0
        for k in range(order):
            force = work.F[base + k] * scale
            scratch[k] = force
            impulse += force * power * work.reciprocal[k + 1]
            power *= end
            reach += abs(force)
        peaks.impulse[e] += impulse * h
        peaks.contact_time[e] += end * h
        if reach > peaks.force[e]:
            peaks.force[e] = highest(scratch, order - 1, end, peaks.force[e], True)


@njit(**INLINE)
def track(
    feet, links, state, work, ends, peaks, active, count, padded, order, end, scratch, h, ground, ground_slope,
    inelastic, founded, kinds,
):  # fmt: skip
    """Raise every peak that this step, up to s = `end`, exceeds; `ground` and `ground_slope` as in `summarise`."""
    _drift_peaks(work, ends, peaks, padded, order, end, scratch)
    if inelastic:
        _shear_peaks(work, ends, peaks, padded, order, end, scratch)
    _displacement_peaks(state, work, ends, peaks, padded, order, end, scratch)
    _acceleration_peaks(work, ends, peaks, padded, order, end, scratch, h, ground, ground_slope)
    if founded:
        _rocking_peaks(feet, work, peaks, order, end, scratch)
    if kinds != LINKS_NONE:
        _link_peaks(links, state, work, ends, peaks, active, count, padded, order, end, scratch, h)
