"""Polynomials on [0, 1]: the first sign change and the largest magnitude, both with proof.

A polynomial is `c[0] + c[1] s + ... + c[n] s^n`, its coefficients in the first n + 1 places of an array.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from pounding_cli.kernels.layout import CALLED
from pounding_cli.kernels.simd import (
    from_left,
    fused,
    greater,
    lowest,
    maximum,
    minimum,
    no_inline,
    ramp,
    splat,
)

FLAT = 1e-6
"""How far from a place with no slope [-] the slope is looked at: its values differ by the square of it."""

NEVER = 2.0
"""Returned when there is no crossing: later than any step."""


@njit(**CALLED)
def value(c, n, s):
    """The polynomial at s (Horner)."""
    total = c[n]
    for k in range(n - 1, -1, -1):
        total = fused(total, s, c[k])
    return total


@njit(**CALLED)
def slope(c, n, s):
    """The derivative at s."""
    total = n * c[n]
    for k in range(n - 1, 0, -1):
        total = fused(total, s, k * c[k])
    return total


@njit(**CALLED)
def first_crossing(c, n, end):
    """First s in [0, end] where the polynomial stops being positive, or NEVER.

    Leading coefficients that are exactly zero mean "zero at the start": the sign of the first one that is not
    decides, so a start from rest on the boundary is settled by the first derivative that does not vanish; if that
    is negative the answer is 0. From there the search marches: with |p''| <= M on the interval,
    p(s + x) >= p + p' x - M x^2 / 2, whose first zero is never beyond the root and closes in on it quadratically.
    """
    no_inline()
    first = 0
    while first <= n and c[first] == 0.0:
        first += 1
    if first > n:
        return NEVER
    if c[first] < 0.0:
        return 0.0
    # Ends, and how far value and slope can deviate from the chords between theirs: this decides most cases.
    start = c[first]
    start_slope = c[first + 1] if first < n else 0.0
    size = start
    last = start
    last_slope = 0.0
    bound = 0.0
    bend = 0.0
    power = 1.0  # end^(j - 1)
    j = 0.0
    for k in range(first + 1, n + 1):
        j += 1.0
        term = c[k] * power
        sloped = j * term
        last += term * end
        last_slope += sloped
        size += abs(term)
        bent = (j - 1) * abs(sloped)  # |p''| end
        bound += bent
        bend += (j - 2) * bent if j > 2 else 0.0
        power *= end
    if last > 0.0 and min(start, last) > 0.125 * bound * end:
        return NEVER
    if start_slope * last_slope > 0.0 and min(abs(start_slope), abs(last_slope)) > 0.125 * bend:
        if last > 0.0:
            return NEVER
        return _bracketed(c, first, n, 0.0, end, start, last)
    return _march(c, first, n, end, bound / end if end > 0.0 else 0.0, 1e-17 * size, last)


@njit(**CALLED)
def _bracketed(c, first, n, low, high, start, last):
    """A root between `low`, where the polynomial is `start` > 0, and `high`, where it is `last` and not positive, by
    Newton kept inside a bracket. Of a monotone polynomial it is the only one."""
    no_inline()
    s = low + (high - low) * start / (start - last)
    for _ in range(100):
        p = c[n]
        d = 0.0
        for k in range(n - 1, first - 1, -1):
            d = fused(d, s, p)
            p = fused(p, s, c[k])
        if p > 0.0:
            low = s
        else:
            high = s
        new = s - p / d if d != 0.0 else low
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - s) <= 3e-16 * s:
            return new
        s = new
    return s


@njit(**CALLED)
def _march(c, first, n, end, bound, floor, last):
    """The first root by steps that never pass one; |p''| <= bound.

    The steps become too short where several roots meet. Then the sign at `end` decides, where the polynomial is `last`:
    "never" is said only if it is positive there.
    """
    no_inline()
    s = 0.0
    p = floor
    for _ in range(400):
        p = c[n]
        d = 0.0
        for k in range(n - 1, first - 1, -1):
            d = fused(d, s, p)
            p = fused(p, s, c[k])
        if p <= floor:
            return s
        root = math.sqrt(d * d + 2.0 * bound * p)
        step = 2.0 * p / (root - d) if d < 0.0 else ((d + root) / bound if bound > 0.0 else 2.0 * end + 1.0)
        if s + step > end:
            return NEVER if last > 0.0 else end
        if step <= 2e-16 * s:
            return s
        s += step
    return _bracketed(c, first, n, s, end, p, last) if last <= 0.0 else s


@njit(**CALLED)
def _turn(c, n, low, high, slope_low, slope_high):
    """The polynomial where its derivative, which changes sign between low and high, is zero: Newton in a bracket."""
    no_inline()
    s = low + (high - low) * slope_low / (slope_low - slope_high)
    rising = slope_low > 0.0
    for _ in range(60):
        d = n * c[n]
        dd = 0.0
        for k in range(n - 1, 0, -1):
            dd = fused(dd, s, d)
            d = fused(d, s, k * c[k])
        if (d > 0.0) == rising:
            low = s
        else:
            high = s
        new = s - d / dd if dd != 0.0 else low - 1.0
        if not low <= new <= high:
            new = 0.5 * (low + high)
        moved = abs(new - s)
        s = new
        if moved < 1e-6:  # the next step would move by about 1e-12, the value by its square
            break
    return value(c, n, s)


SIGNED, ABSOLUTE = np.bool_(False), np.bool_(True)
"""Whether the largest p is looked for, or the largest |p|. A plain False or True numba would compile one by one."""


@njit(**CALLED)
def highest(c, n, end, best, absolute):
    """The larger of `best` and the largest p, or |p| if `absolute`, inside [0, end]; the ends are in `best` already.

    A slope that provably keeps its sign has no peak. Otherwise the interval is looked at in eight pieces: a piece holds
    a peak worth finding if the slope changes its sign there and the values at its ends, with what p can rise above
    the straight line between them, exceed `best`.
    """
    no_inline()
    if n < 2 or end <= 0.0:
        return best
    first = c[1]
    last = first
    bent = 0.0  # largest |p''| end
    bend = 0.0  # largest deviation of p' from its chord, eight times
    power = 1.0
    number = 2.0
    for k in range(2, n + 1):
        sloped = number * (c[k] * power)
        size = (number - 1.0) * abs(sloped)
        last = fused(sloped, end, last)
        bent += size
        bend = fused(number - 2.0, size, bend)
        power *= end
        number += 1.0
    if first * last > 0.0 and min(abs(first), abs(last)) > 0.125 * bend * end:
        return best
    s = (ramp() + 1.0) * (end / 8.0)
    p = splat(c[n])
    d = splat(0.0)
    for k in range(n - 1, -1, -1):
        d = fused(d, s, p)
        p = fused(p, s, splat(c[k]))
    p_before = from_left(splat(c[0]), p)
    d_before = from_left(splat(first), d)
    reach = maximum(p_before, p)
    if absolute:
        reach = maximum(reach, splat(0.0) - minimum(p_before, p))
    rise = splat(bent * end / 512.0)  # an eighth of the piece's length squared
    pieces = ~greater(d_before * d, splat(0.0)) & greater(reach + rise, splat(best))
    while pieces != 0:
        piece = lowest(pieces)
        pieces &= pieces - 1
        low = end * piece / 8.0
        high = end * (piece + 1) / 8.0
        slope_low = slope(c, n, low)
        slope_high = slope(c, n, high)
        if slope_low == 0.0:  # the turn is not the one that the piece begins with: look behind it
            low += FLAT * end
            slope_low = slope(c, n, low)
        found = value(c, n, high)
        if slope_low * slope_high < 0.0:
            found = _turn(c, n, low, high, slope_low, slope_high)
        elif slope_high != 0.0:
            continue
        best = max(best, abs(found) if absolute else found)
    return best
