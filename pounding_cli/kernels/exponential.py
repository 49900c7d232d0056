"""The march of an exact linear propagator through all samples, and the peaks on its way.

Over one step no mode turns by more than 1.5 radians, so second derivatives at both ends bound those between. A quantity
whose ends differ by more than that allows is monotone over the step; one that could not reach its peak so far even in
between is left alone; of the rest the power series is looked at."""

from __future__ import annotations

import functools

from numba import njit

from pounding_cli.kernels.layout import INLINE, OPTIONS
from pounding_cli.kernels.polynomial import SIGNED, highest
from pounding_cli.kernels.simd import (
    further,
    fused,
    greater,
    load,
    lowest,
    magnitude,
    maximum,
    minimum,
    pointer,
    splat,
    store,
)
from pounding_cli.kernels.source import source_digest

BEND = 1.5
"""Largest second derivative within a step over the larger of those at its ends; 1 / cos 0.75 = 1.37 for a wave that
turns by 1.5 radians."""


def memory_needed(width: int, wide: int) -> int:
    """Doubles of scratch that `march` needs for states of `width` and `wide` tracked quantities, padded."""
    return 2 * (width + 8) + 3 * wide + 64


# Kept as part of the march: captured by it, it would be another one in every process, and never found again.
@njit(**{**INLINE, "forceinline": False})
def peak_within_step(powers, m, orders, total, z, c, side, best):
    """The larger of `best` and the largest value of quantity m, times `side`, within the step from the state z."""
    for k in range(orders):
        term = further(powers, (m * orders + k) * total)
        size = 0.0
        for j in range(total):
            size += term[j] * z[j]
        c[k] = side * size
    return highest(c, orders - 1, 1.0, best, SIGNED)


@njit(**INLINE)
def _add_forms(forms, count, total, broad, z, sums):
    """Add z' W z of every form to its sum."""
    for f in range(count):
        added = load(sums, f * 8)
        for b in range(0, broad, 8):
            value = splat(0.0)
            for j in range(total):
                value = fused(load(forms, (f * total + j) * broad + b), splat(z[j]), value)
            added = fused(value, load(z, b), added)
        store(sums, f * 8, added)


@njit(**INLINE)
def _look(rows, bends, leapt, turned, total, wide, b, z, values, bows):
    """Eight tracked quantities at z; returns (their values, those of the sample before, how far they can deviate from
    the chord between the two).

    leapt, turned : by how much the ground's acceleration and its slope have just changed
    """
    value = splat(0.0)
    bend = splat(0.0)
    for j in range(total):
        x = splat(z[j])
        value = fused(load(rows, j * wide + b), x, value)
        bend = fused(load(bends, j * wide + b), x, bend)
    last = load(values, b)
    before_turn = bend - load(bends, (total - 1) * wide + b) * turned
    just_before = before_turn - load(bends, (total - 2) * wide + b) * leapt
    deviation = maximum(magnitude(load(bows, b)), magnitude(just_before)) * BEND
    store(values, b, value)
    store(bows, b, bend)
    return value, last, deviation


@njit(**INLINE)
def _raise_peaks(powers, count, orders, total, b, value, last, deviation, before, c, high, low):
    """Largest and smallest values of eight quantities over a step that begins at z = `before`."""
    above = maximum(value, last)
    below = minimum(value, last)
    up = maximum(load(high, b), above)
    down = minimum(load(low, b), below)
    store(high, b, up)
    store(low, b, down)
    turns = greater(deviation * 4.0, above - below)
    may_exceed = turns & greater(above + deviation, up)
    may_undercut = turns & greater(down, below - deviation)
    while may_exceed != 0:
        m = b + lowest(may_exceed)
        may_exceed &= may_exceed - 1
        if m < count:
            high[m] = peak_within_step(powers, m, orders, total, before, c, 1.0, high[m])
    while may_undercut != 0:
        m = b + lowest(may_undercut)
        may_undercut &= may_undercut - 1
        if m < count:
            low[m] = -peak_within_step(powers, m, orders, total, before, c, -1.0, -low[m])


@njit(**INLINE)
def _next_state(step, total, width, z, after):
    """exp(A length) z but for the ground's two entries."""
    for b in range(0, width, 8):
        value = splat(0.0)
        for j in range(total):
            value = fused(load(step, j * width + b), splat(z[j]), value)
        store(after, b, value)


@njit(**INLINE)
def _look_at_all(rows, bends, powers, leapt, turned, first, here, before, values, bows, c, high, low):
    """Everything tracked at z = `here`: at the first state its peaks, later what a step from `before` raises."""
    total, wide = rows.shape
    count, orders = powers.shape[:2]
    for b in range(0, wide, 8):
        value, last, deviation = _look(pointer(rows), pointer(bends), leapt, turned, total, wide, b, here, values, bows)
        if first:
            store(high, b, value)
            store(low, b, value)
        else:
            _raise_peaks(pointer(powers), count, orders, total, b, value, last, deviation, before, c, high, low)


@functools.cache
def build():
    """The march, compiled on first use."""
    source = source_digest()

    @njit(**OPTIONS)
    def march(
        step, rows, bends, powers, forms, starts, slopes, length, parts, ends, memory, peaks, sums, visited,
        first_watched, samples,
    ):  # fmt: skip
        """Step through all segments of the ground motion from the state in `ends[0]` to that in `ends[1]`.

        step : exp(A length) transposed without its last two columns, shape (n + 2, width), padded with zeros
        rows : what is tracked from z = (q, q', a_g, a_g'), transposed, shape (n + 2, wide), padded with zeros
        bends : their second derivatives times the step's length squared over 8, likewise
        powers : rows (A length)^j / j!, shape (M, orders, n + 2)
        forms : symmetric W, shape (F, n + 2, padded n + 2)
        ends : q and q' at the start and at the end, shape (2, n)
        starts, slopes : the ground in every segment [m/s2], [m/s3]
        length : of one step [s]; `parts` of them make a segment
        room : scratch (`memory_needed`)
        peaks : largest and smallest value of everything tracked, shape (2, wide)
        sums : z' W z of every form summed over the segments' starts, shape (F, 8), to be summed over the last
        visited : z summed over the segments' starts, shape (n + 2,)
        samples : what is tracked from `first_watched` on at the end of every segment, shape (segments, watched)
        """
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        total, width = step.shape
        n = total - 2
        wide = rows.shape[1]
        high = pointer(peaks)
        low = further(high, wide)
        stride = width + 8
        z = pointer(memory)
        values = further(z, 2 * stride)
        bows = further(values, wide)
        c = further(bows, wide)
        for i in range(n):
            z[i] = ends[0, i]
        places = starts.size * parts
        segment = 0
        part = 0
        slope = slopes[0]
        for r in range(places + 1):
            here = further(z, (r % 2) * stride)
            before = further(z, ((r + 1) % 2) * stride)
            leapt, turned = 0.0, 0.0
            if r < places:
                if r > 0 and part == 0:
                    leapt = starts[segment] - (starts[segment - 1] + slope * length * parts)
                turned = slopes[segment] - slope
                slope = slopes[segment]
                here[n] = starts[segment] + slope * length * part
            else:
                here[n] = starts[segment - 1] + slope * length * parts
            here[n + 1] = slope
            if part == 0 and r < places:
                for j in range(total):
                    visited[j] += here[j]
                _add_forms(pointer(forms), forms.shape[0], total, forms.shape[2], here, pointer(sums))
            _look_at_all(rows, bends, powers, leapt, turned, r == 0, here, before, values, bows, c, high, low)
            if r > 0 and part == 0:
                for i in range(samples.shape[1]):
                    samples[segment - 1, i] = values[first_watched + i]
            if r < places:
                _next_state(pointer(step), total, width, here, before)
                part += 1
                if part == parts:
                    part = 0
                    segment += 1
            else:
                for i in range(n):
                    ends[1, i] = here[i]

    return march
