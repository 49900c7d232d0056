"""The march of an exact linear propagator through all samples, and the peaks on its way.

Between two places of a uniform grid no mode turns by more than 1.5 radians, so a largest value between places shows at
one of them: there the value lies above both its neighbours, and the second difference says how much higher the peak
can be. Only where that exceeds the peak so far are the power series beside the place looked at."""

from __future__ import annotations

import functools

from numba import njit

from pounding_cli.kernels.layout import OPTIONS
from pounding_cli.kernels.polynomial import highest
from pounding_cli.kernels.simd import further, greater, load, lowest, magnitude, maximum, minimum, pointer, splat, store
from pounding_cli.kernels.source import source_digest

MARGIN = 0.25
"""How far, in the second difference at its place, a peak can lie above the grid's value: an eighth for a
parabola, 0.2 for a wave that turns by 1.5 radians a step. A parabola whose ends differ by more than that much has its
peak on the side of the higher one."""


def room_needed(width: int, wide: int) -> int:
    """Doubles of scratch that `march` needs for states of `width` and `wide` tracked quantities, padded."""
    return 3 * (width + 8) + 4 * wide + 64


@functools.cache
def build():
    """The march, compiled on first use."""
    source = source_digest()

    @njit(**OPTIONS)
    def look_closely(powers, m, orders, total, z, c, side, best):
        """The larger of `best` and the largest value of quantity m, times `side`, within the step from the state z."""
        for k in range(orders):
            term = further(powers, (m * orders + k) * total)
            size = 0.0
            for j in range(total):
                size += term[j] * z[j]
            c[k] = side * size
        return highest(c, orders - 1, 1.0, best, False)

    @njit(**OPTIONS)
    def march(
        step, rows, powers, forms, starts, slopes, length, parts, ends, room, peaks, sums, visited, kinked,
        first_watched, top, bottom,
    ):  # fmt: skip
        """Step through all segments of the ground motion from the state in `ends[0]` to that in `ends[1]`.

        step : exp(A length) transposed without its last two columns, shape (n + 2, width), padded with zeros
        rows : what is tracked from z = (q, q', a_g, a_g'), transposed, shape (n + 2, wide), padded with zeros
        powers : rows (A length)^j / j!, shape (M, orders, n + 2)
        starts, slopes : the ground in every segment [m/s2], [m/s3]
        length : of one step [s]; `parts` of them make a segment
        forms : symmetric W, shape (F, n + 2, padded n + 2)
        ends : q and q' at the start and at the end, shape (2, n)
        room : scratch (`room_needed`)
        peaks : largest and smallest value of everything tracked, shape (2, wide)
        sums : z' W z of every form summed over the segments' starts, shape (F, 8), to be summed over the last
        visited : z summed over the segments' starts, shape (n + 2,)
        kinked : quantities from here on have slopes that jump at the samples
        top, bottom : bounds in every segment of what is tracked from `first_watched` on, shape (segments, watched)
        """
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        total, width = step.shape
        n = total - 2
        wide = rows.shape[1]
        count, orders = powers.shape[:2]
        watched = top.shape[1]
        broad = forms.shape[2]
        matrix, look, terms, quadratic = pointer(step), pointer(rows), pointer(powers), pointer(forms)
        stride = width + 8
        z = pointer(room)
        y = further(z, 3 * stride)
        bends = further(y, 3 * wide)
        c = further(bends, wide)
        high = pointer(peaks)
        low = further(high, wide)
        totals = pointer(sums)
        for i in range(n):
            z[i] = ends[0, i]
        places = starts.size * parts
        segment = 0
        part = 0
        for r in range(places + 1):
            here = further(z, (r % 3) * stride)
            if r < places:
                here[n] = starts[segment] + slopes[segment] * length * part
                here[n + 1] = slopes[segment]
            else:
                here[n] = starts[segment - 1] + slopes[segment - 1] * length * parts
                here[n + 1] = 0.0
            if part == 0 and r < places:
                for j in range(total):
                    visited[j] += here[j]
                for f in range(forms.shape[0]):
                    added = load(totals, f * 8)
                    for b in range(0, broad, 8):
                        value = splat(0.0)
                        for j in range(total):
                            value = value + load(quadratic, (f * total + j) * broad + b) * here[j]
                        added = added + value * load(here, b)
                    store(totals, f * 8, added)
            back_one, back_two = further(z, ((r + 2) % 3) * stride), further(z, ((r + 1) % 3) * stride)
            now = further(y, (r % 3) * wide)
            middle = further(y, ((r + 2) % 3) * wide)
            before = further(y, ((r + 1) % 3) * wide)
            for b in range(0, wide, 8):
                value = splat(0.0)
                for j in range(total):
                    value = value + load(look, j * wide + b) * here[j]
                store(now, b, value)
                if r == 0:
                    store(high, b, value)
                    store(low, b, value)
                    continue
                up = maximum(load(high, b), value)
                down = minimum(load(low, b), value)
                store(high, b, up)
                store(low, b, down)
                if r == 1:
                    continue
                last = load(middle, b)
                first = load(before, b)
                bend = magnitude(value - last * 2.0 + first)
                store(bends, b, maximum(load(bends, b), bend))
                reach = bend * MARGIN
                above = ~(greater(first, last) | greater(value, last)) & greater(last + reach, up)
                below = ~(greater(last, first) | greater(last, value)) & greater(down, last - reach)
                left = greater(reach, value - first)
                right = greater(reach, first - value)
                while above != 0:
                    m = b + lowest(above)
                    bit = above & -above
                    above ^= bit
                    if m >= kinked or (left & bit) != 0:
                        high[m] = look_closely(terms, m, orders, total, back_two, c, 1.0, high[m])
                    if m >= kinked or (right & bit) != 0:
                        high[m] = look_closely(terms, m, orders, total, back_one, c, 1.0, high[m])
                while below != 0:
                    m = b + lowest(below)
                    bit = below & -below
                    below ^= bit
                    if m >= kinked or (right & bit) != 0:
                        low[m] = -look_closely(terms, m, orders, total, back_two, c, -1.0, -low[m])
                    if m >= kinked or (left & bit) != 0:
                        low[m] = -look_closely(terms, m, orders, total, back_one, c, -1.0, -low[m])
            if r == 1 or r == places:  # no neighbour on the other side tells whether these steps hide a peak
                for m in range(count):
                    high[m] = look_closely(terms, m, orders, total, back_one, c, 1.0, high[m])
                    low[m] = -look_closely(terms, m, orders, total, back_one, c, -1.0, -low[m])
            for i in range(watched):
                value_here = now[first_watched + i]
                if r < places:
                    top[segment, i] = max(top[segment, i], value_here)
                    bottom[segment, i] = min(bottom[segment, i], value_here)
                if part == 0 and r > 0:
                    top[segment - 1, i] = max(top[segment - 1, i], value_here)
                    bottom[segment - 1, i] = min(bottom[segment - 1, i], value_here)
            if r == places:
                for i in range(n):
                    ends[1, i] = here[i]
                break
            there = further(z, ((r + 1) % 3) * stride)
            for b in range(0, width, 8):
                value = splat(0.0)
                for j in range(total):
                    value = value + load(matrix, j * width + b) * here[j]
                store(there, b, value)
            part += 1
            if part == parts:
                part = 0
                segment += 1
        for i in range(watched):
            stray = MARGIN * bends[first_watched + i]
            for k in range(starts.size):
                top[k, i] += stray
                bottom[k, i] -= stray

    return march
