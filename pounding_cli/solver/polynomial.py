"""Polynomials p[0] + p[1] s + ... + p[n] s^n on [0, end]: the first sign change and the largest value, with proof."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from pounding_cli.solver.options import CALLED, PART
from pounding_cli.solver.records import ORDERS

NEVER = 2.0
"""Returned when there is no crossing: later than any step."""

SLOPE = ORDERS + 8
"""Place in run.p of the derivative's coefficients."""

CROSSING_ACCURACY = 3e-16
"""Part by which the root of a crossing is found: to the last digit."""

TURN_ACCURACY = 1e-7
"""Part by which the root of a turn is found: the value there moves by the square of it."""


@njit(**PART)
def evaluate(p, n, s, first=0):
    """Return the polynomial of degree n whose coefficients begin at p[first], at s (Horner)."""
    total = p[first + n]
    for k in range(first + n - 1, first - 1, -1):
        total = total * s + p[k]
    return total


@njit(**CALLED)
def find_first_crossing(run, n, end):
    """Return the first s in [0, end] where the polynomial in run.p stops being positive, or NEVER.

    Leading coefficients that are exactly zero mean "zero at the start": the sign of the first one that is not decides,
    so a start from rest on the boundary is settled by the first derivative that does not vanish.
    """
    p = run.p
    first = 0
    while first <= n and p[first] == 0.0:
        first += 1
    if first > n:
        return NEVER
    if p[first] < 0.0:
        return 0.0
    start = p[first]
    start_slope = p[first + 1] if first < n else 0.0
    last = start
    last_slope = 0.0
    bound = 0.0
    bend = 0.0
    size = start
    power = 1.0
    j = 0.0
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
        return NEVER if last > 0.0 else _find_root(run, first, n, 0.0, end, start, last, CROSSING_ACCURACY)
    return _march_to_root(run, first, n, end, bound / end if end > 0.0 else 0.0, 1e-17 * size, last)


@njit(**CALLED)
def _find_root(run, first, last, low, high, at_low, at_high, near):
    """Return a root of the polynomial run.p[first] to run.p[last] between `low` and `high`, by Newton in this bracket.

    Parameters
    ----------
    at_low, at_high : values at the ends of the bracket, of other signs or 0 at `high`
    near : part of the root by which the last change may move it [-]
    """
    p = run.p
    s = low + (high - low) * at_low / (at_low - at_high)
    rising = at_low < 0.0
    for _ in range(100):
        total = p[last]
        slope = 0.0
        for k in range(last - 1, first - 1, -1):
            slope = slope * s + total
            total = total * s + p[k]
        if (total > 0.0) != rising:
            low = s
        else:
            high = s
        new = s - total / slope if slope != 0.0 else low
        if not low <= new <= high:
            new = 0.5 * (low + high)
        moved = abs(new - s)
        s = new
        if moved <= near * s:
            break
    return s


@njit(**CALLED)
def _march_to_root(run, first, n, end, bound, floor, last):
    """Return the first root by steps that never pass one, or NEVER.

    Parameters
    ----------
    bound : of |p''|
    floor : value below which the polynomial is zero
    last : value at `end`, whose sign decides if the steps get short
    """
    p = run.p
    s = 0.0
    total = floor
    for _ in range(400):
        total = p[n]
        slope = 0.0
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
        if step <= CROSSING_ACCURACY * s:
            return s
        s += step
    return _find_root(run, first, n, s, end, total, last, CROSSING_ACCURACY) if last <= 0.0 else s


PIECES = 8
"""Parts of the interval that are looked at where the slope may change its sign more than once."""


@njit(**CALLED)
def find_largest(run, n, end, best, absolute):
    """Return the larger of `best` and the largest p (|p| if `absolute`) in [0, end].

    Nothing is searched that a bound excludes: all of p below `best`, a slope that keeps its sign, a slope that is
    monotone (then it has one zero at most).

    absolute : given as `run.h > 0.0` or `run.h < 0.0`: for the constants True and False all would be compiled twice
    """
    p = run.p
    q = np.int64(SLOPE)
    bound = 0.0
    last = p[0]
    slope = 0.0
    bent = 0.0
    bend = 0.0
    power = 1.0
    for k in range(1, n + 1):
        sloped = k * p[k]
        p[q + k - 1] = sloped
        sloped *= power
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
    pieces = 1 if 2.0 * abs(p[2]) * end > bend else PIECES  # p'' keeps its sign: |p''(s) - p''(0)| < |p''(0)|
    rise = bent * end / (8.0 * pieces * pieces)  # of p above the chord of a piece, at most
    low = 0.0
    left = p[0]
    for piece in range(1, pieces + 1):
        high = end * piece / pieces
        right = evaluate(p, n, high)
        after = evaluate(p, n - 1, high, q)
        reach = max(abs(left), abs(right)) if absolute else max(left, right)
        best = max(best, reach)
        if first == 0.0:  # look behind the turn that the piece begins with
            first = evaluate(p, n - 1, low + 1e-6 * end, q)
        if first * after < 0.0 and reach + rise > best:
            turn = evaluate(p, n, _find_root(run, q, q + n - 1, low, high, first, after, TURN_ACCURACY))
            best = max(best, abs(turn) if absolute else turn)
        low = high
        left = right
        first = after
    return best
