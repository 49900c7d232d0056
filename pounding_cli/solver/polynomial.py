"""Polynomials p[0] + p[1] s + ... + p[n] s^n on [0, end]: the first sign change and the largest value, with proof."""

from __future__ import annotations

import math

from numba import njit

from pounding_cli.solver.options import CALLED, PART

NEVER = 2.0
"""Returned when there is no crossing: later than any step."""


@njit(**PART)
def value(p, n, s):
    """The polynomial at s (Horner)."""
    total = p[n]
    for k in range(n - 1, -1, -1):
        total = total * s + p[k]
    return total


@njit(**PART)
def value_and_slope(p, n, s):
    """The polynomial and its derivative at s."""
    total, slope = p[n], 0.0
    for k in range(n - 1, -1, -1):
        slope = slope * s + total
        total = total * s + p[k]
    return total, slope


@njit(**PART)
def slope_and_bend(p, n, s):
    """First and second derivative at s."""
    slope, bend = n * p[n], 0.0
    for k in range(n - 1, 0, -1):
        bend = bend * s + slope
        slope = slope * s + k * p[k]
    return slope, bend


@njit(**CALLED)
def first_crossing(r, n, end):
    """First s in [0, end] where the polynomial in r.p stops being positive, or NEVER.

    Leading coefficients that are exactly zero mean "zero at the start": the sign of the first one that is not decides,
    so a start from rest on the boundary is settled by the first derivative that does not vanish.
    """
    p, first = r.p, 0
    while first <= n and p[first] == 0.0:
        first += 1
    if first > n:
        return NEVER
    if p[first] < 0.0:
        return 0.0
    start, start_slope = p[first], (p[first + 1] if first < n else 0.0)
    last, last_slope, bound, bend, size, power, j = start, 0.0, 0.0, 0.0, start, 1.0, 0.0
    for k in range(first + 1, n + 1):  # p / s^first: values and slopes at `end`, bounds of the next two derivatives
        j += 1.0
        sloped = j * p[k] * power
        last += p[k] * power * end
        size += abs(p[k] * power)
        last_slope += sloped
        bound += (j - 1.0) * abs(sloped)
        bend += (j - 1.0) * max(j - 2.0, 0.0) * abs(sloped)
        power *= end
    if last > 0.0 and min(start, last) > 0.125 * bound * end:
        return NEVER
    if start_slope * last_slope > 0.0 and min(abs(start_slope), abs(last_slope)) > 0.125 * bend:
        return NEVER if last > 0.0 else _bracketed(r, first, n, 0.0, end, start, last)
    return _march(r, first, n, end, bound / end if end > 0.0 else 0.0, 1e-17 * size, last)


@njit(**CALLED)
def _bracketed(r, first, n, low, high, start, last):
    """A root between `low`, where the polynomial is `start` > 0, and `high`, where it is `last` <= 0: Newton kept
    inside the bracket."""
    p, s = r.p, low + (high - low) * start / (start - last)
    for _ in range(100):
        total, slope = p[n], 0.0
        for k in range(n - 1, first - 1, -1):
            slope = slope * s + total
            total = total * s + p[k]
        if total > 0.0:
            low = s
        else:
            high = s
        new = s - total / slope if slope != 0.0 else low
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - s) <= 3e-16 * s:
            return new
        s = new
    return s


@njit(**CALLED)
def _march(r, first, n, end, bound, floor, last):
    """The first root by steps that never pass one, with |p''| <= bound; the sign at `end` decides if they get short."""
    p, s, total = r.p, 0.0, floor
    for _ in range(400):
        total, slope = p[n], 0.0
        for k in range(n - 1, first - 1, -1):
            slope = slope * s + total
            total = total * s + p[k]
        if total <= floor:
            return s
        root = math.sqrt(slope * slope + 2.0 * bound * total)
        if slope < 0.0:
            step = 2.0 * total / (root - slope)
        else:
            step = (slope + root) / bound if bound > 0.0 else 2.0 * end + 1.0
        if s + step > end:
            return NEVER if last > 0.0 else end
        if step <= 2e-16 * s:
            return s
        s += step
    return _bracketed(r, first, n, s, end, total, last) if last <= 0.0 else s


@njit(**CALLED)
def _turn(r, n, low, high, slope_low, slope_high):
    """The polynomial where its slope, which changes sign between low and high, is zero: Newton in a bracket."""
    p, s = r.p, low + (high - low) * slope_low / (slope_low - slope_high)
    rising = slope_low > 0.0
    for _ in range(60):
        slope, bend = slope_and_bend(p, n, s)
        if (slope > 0.0) == rising:
            low = s
        else:
            high = s
        new = s - slope / bend if bend != 0.0 else low - 1.0
        if not low <= new <= high:
            new = 0.5 * (low + high)
        moved, s = abs(new - s), new
        if moved < 1e-6:  # the next step would move it by 1e-12, the value by its square
            break
    return value(p, n, s)


PIECES = 8
"""Parts of the interval that are looked at where the slope may change its sign more than once."""


@njit(**CALLED)
def highest(r, n, end, best, absolute):
    """The larger of `best` and the largest p (|p| if `absolute`) in [0, end].

    Nothing is searched that a bound excludes: all of p below `best`, a slope that keeps its sign, a slope that is
    monotone (then it has one zero at most).
    """
    p = r.p
    bound, last, slope, bent, bend, power = 0.0, p[0], 0.0, 0.0, 0.0, 1.0
    for k in range(1, n + 1):
        sloped = k * p[k] * power
        bound += abs(p[k])
        last += p[k] * power * end
        slope += sloped
        size = (k - 1.0) * abs(sloped)
        bent += size
        bend += max(k - 2.0, 0.0) * size
        power *= end
    if not abs(p[0]) + bound > best:
        return best
    best = max(best, p[0], last)
    if absolute:
        best = max(best, -p[0], -last)
    if n < 2 or end <= 0.0:
        return best
    first = p[1]
    if first * slope > 0.0 and min(abs(first), abs(slope)) > 0.125 * bend:
        return best
    if 2.0 * abs(p[2]) * end > bend:  # p'' keeps its sign: |p''(s) - p''(0)| < |p''(0)|
        if first * slope < 0.0:
            found = _turn(r, n, 0.0, end, first, slope)
            best = max(best, abs(found) if absolute else found)
        return best
    return _search_pieces(r, n, end, best, absolute, bent * end / (8.0 * PIECES * PIECES))


@njit(**CALLED)
def _search_pieces(r, n, end, best, absolute, rise):
    """`highest` piece by piece; p rises above the chord of a piece by at most `rise`."""
    p = r.p
    low, left, slope_low = 0.0, p[0], p[1]
    for piece in range(1, PIECES + 1):
        high = end * piece / PIECES
        right, slope_high = value_and_slope(p, n, high)
        reach = max(left, right)
        if absolute:
            reach = max(reach, -left, -right)
        if reach > best:
            best = reach
        if slope_low == 0.0:  # look behind the turn that the piece begins with
            slope_low = value_and_slope(p, n, low + 1e-6 * end)[1]
        if slope_low * slope_high < 0.0 and reach + rise > best:
            found = _turn(r, n, low, high, slope_low, slope_high)
            best = max(best, abs(found) if absolute else found)
        low, left, slope_low = high, right, slope_high
    return best
