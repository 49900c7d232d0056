"""Largest values over a step: nothing is looked at closely unless its bound exceeds the peak so far."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import INLINE, LINKS_NONE, OPEN
from pounding_cli.kernels.polynomial import highest, value
from pounding_cli.kernels.simd import greater, load, lowest, magnitude, maximum, minimum, splat, store


@njit(**INLINE)
def _turns(rate0, rate, stray):
    """Lanes whose quantity may have a largest value inside the step."""
    same = greater(rate0 * rate, splat(0.0)) & greater(minimum(magnitude(rate0), magnitude(rate)), stray)
    return ~same


@njit(**INLINE)
def _drift_peaks(work, ends, peaks, padded, order, end, scratch):
    for b in range(0, padded, 8):
        peak = load(peaks.drift, b)
        reach = maximum(magnitude(load(work.D, b)), magnitude(load(ends.drift, b)))
        suspects = greater(reach + load(ends.drift_stray, b), peak)
        if suspects != 0:
            store(peaks.drift, b, maximum(peak, reach))
            suspects &= _turns(load(ends.rate0, b), load(ends.rate, b), load(ends.rate_stray, b))
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                for k in range(order + 1):
                    scratch[k] = work.D[k * padded + i]
                peaks.drift[i] = highest(scratch, order, end, peaks.drift[i], True)


@njit(**INLINE)
def _shear_peaks(work, ends, peaks, padded, order, end, scratch):
    for b in range(0, padded, 8):
        peak = load(peaks.shear, b)
        tangent = load(work.tangent, b)
        offset = load(work.offset, b)
        first = magnitude(tangent * load(work.D, b) + offset)
        reach = maximum(first, magnitude(tangent * load(ends.drift, b) + offset))
        suspects = greater(reach + tangent * load(ends.drift_stray, b), peak)
        if suspects != 0:
            store(peaks.shear, b, maximum(peak, reach))
            suspects &= _turns(load(ends.rate0, b), load(ends.rate, b), load(ends.rate_stray, b))
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                for k in range(order + 1):
                    scratch[k] = work.tangent[i] * work.D[k * padded + i]
                scratch[0] += work.offset[i]
                peaks.shear[i] = highest(scratch, order, end, peaks.shear[i], True)


@njit(**INLINE)
def _displacement_peaks(work, ends, peaks, padded, order, end, scratch):
    minus = splat(-1.0)
    for b in range(0, padded, 8):
        first = load(work.U, b)
        last = load(ends.u, b)
        stray = load(ends.u_stray, b)
        top = load(peaks.displacement_max, b)
        bottom = load(peaks.displacement_min, b)
        above = greater(maximum(first, last) + stray, top)
        below = greater(minus * minimum(first, last) + stray, minus * bottom)
        if above | below != 0:
            store(peaks.displacement_max, b, maximum(top, maximum(first, last)))
            store(peaks.displacement_min, b, minimum(bottom, minimum(first, last)))
            turns = _turns(load(work.W, b), load(ends.v, b), load(ends.v_stray, b))
            suspects = (above | below) & turns
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                for k in range(order + 1):
                    scratch[k] = work.U[k * padded + i]
                peaks.displacement_max[i] = highest(scratch, order, end, peaks.displacement_max[i], False)
                for k in range(order + 1):
                    scratch[k] = -scratch[k]
                peaks.displacement_min[i] = -highest(scratch, order, end, -peaks.displacement_min[i], False)


@njit(**INLINE)
def _acceleration_peaks(work, ends, peaks, padded, order, end, scratch, h, ground, ground_slope):
    scale = 1.0 / (h * h)
    for b in range(0, padded, 8):
        peak = load(peaks.acceleration, b)
        reach = maximum(magnitude(load(ends.acceleration0, b)), magnitude(load(ends.acceleration, b))) * scale
        suspects = greater(reach + load(ends.acceleration_stray, b) * scale, peak)
        if suspects != 0:
            store(peaks.acceleration, b, maximum(peak, reach))
            jerk0 = load(work.W, 2 * padded + b) * 2.0 + ground_slope
            suspects &= _turns(jerk0, load(ends.jerk, b), load(ends.jerk_stray, b))
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                for k in range(order):
                    scratch[k] = (k + 1) * work.W[(k + 1) * padded + i] * scale
                scratch[0] += ground * scale
                scratch[1] += ground_slope * scale
                peaks.acceleration[i] = highest(scratch, order - 1, end, peaks.acceleration[i], True)


@njit(**INLINE)
def watch(work, ends, peaks, padded, segment):
    """Widen the bounds of the displacements in a segment by what this step may reach."""
    for b in range(0, padded, 8):
        row = segment * padded + b
        first = load(work.U, b)
        last = load(ends.u, b)
        stray = load(ends.u_stray, b)
        store(peaks.top, row, maximum(load(peaks.top, row), maximum(first, last) + stray))
        store(peaks.bottom, row, minimum(load(peaks.bottom, row), minimum(first, last) - stray))


@njit(**INLINE)
def _rocking_peaks(feet, work, peaks, order, end, scratch):
    count = feet.number
    for f in range(count):
        for k in range(order + 1):
            scratch[k] = work.phi_D[k * count + f]
        peaks.rocking[f] = max(peaks.rocking[f], abs(scratch[0]), abs(value(scratch, order, end)))
        peaks.rocking[f] = highest(scratch, order, end, peaks.rocking[f], True)


@njit(**INLINE)
def _link_peaks(links, state, work, ends, peaks, padded, order, end, scratch, h):
    scale = 1.0 / (h * h)
    count = links.size
    for e in range(links.number):
        left = links.left[e]
        right = links.right[e]
        reach = max(work.U[left] - work.U[right], ends.u[left] - ends.u[right])
        if reach + ends.u_stray[left] + ends.u_stray[right] > peaks.closing[e]:
            for k in range(order + 1):
                scratch[k] = work.U[k * padded + left] - work.U[k * padded + right]
            peaks.closing[e] = highest(scratch, order, end, max(peaks.closing[e], reach), False)
        if state.link_branch[e] == OPEN or state.link_cut[e] == 1:
            continue
        power = end
        impulse = 0.0
        reach = 0.0
        for k in range(order):
            force = work.F[k * count + e] * scale
            scratch[k] = force
            impulse += force * power * work.reciprocal[k + 1]
            power *= end
            reach += abs(force)
        peaks.impulse[e] += impulse * h
        peaks.contact_time[e] += end * h
        if reach > peaks.force[e]:
            reach = max(abs(scratch[0]), abs(value(scratch, order - 1, end)))
            peaks.force[e] = highest(scratch, order - 1, end, max(peaks.force[e], reach), True)


@njit(**INLINE)
def track(
    feet, links, state, work, ends, peaks, padded, order, end, scratch, h, ground, ground_slope,
    inelastic, founded, kinds,
):  # fmt: skip
    """Raise every peak that this step, up to s = `end`, exceeds; `ground` and `ground_slope` as in `summarise`."""
    _drift_peaks(work, ends, peaks, padded, order, end, scratch)
    if inelastic:
        _shear_peaks(work, ends, peaks, padded, order, end, scratch)
    _displacement_peaks(work, ends, peaks, padded, order, end, scratch)
    _acceleration_peaks(work, ends, peaks, padded, order, end, scratch, h, ground, ground_slope)
    if founded:
        _rocking_peaks(feet, work, peaks, order, end, scratch)
    if kinds != LINKS_NONE:
        _link_peaks(links, state, work, ends, peaks, padded, order, end, scratch, h)
