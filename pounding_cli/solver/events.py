"""The first event of a step: bounds that exclude events at little cost, and the search where they do not.

Nothing is searched where the chord of a function between its ends, widened by its chord deviation (`step_end`), stays
inside the branch.
"""

from __future__ import annotations

from numba import njit

from pounding_cli.laws.guards import (
    COLLAPSE_HIGH,
    COLLAPSE_LOW,
    CROSSES,
    FASTER,
    HIGH,
    LEVELS,
    LOW,
    SIGN_CHANGE,
    SLIPS_LEFT,
    SLIPS_RIGHT,
    SLOWER,
)
from pounding_cli.solver.options import CALLED, PART
from pounding_cli.solver.polynomial import NEVER, evaluate, find_first_crossing
from pounding_cli.solver.records import ITS_FORCE, MIN_STATE, VALUE
from pounding_cli.solver.series import LAST_DIGITS
from pounding_cli.solver.step_end import build_rate, find_reach_of_terms, integrate_rate
from pounding_cli.solver.stick import find_drive

MAX_AT_INSTANT = 4
"""Events of an element at one instant after which it leaves a branch only if that is left at the step's end too."""

INSTANT = 1e-12
"""Part of a step [-] within which an event counts as one at its start."""


@njit(**CALLED)
def find_first_event(dofs, elements, terms, run, series):
    """Return whether an element leaves its branch in [0, 1]; the place where the first does goes to run.end."""
    has_event = False
    for e in range(run.m):
        el = elements[e]
        el.at = NEVER
        if _cannot_leave(el):
            continue
        if el.holds:
            find_drive(dofs, elements, terms, run, series, e)
        for guard in range(COLLAPSE_HIGH + 1):
            if _can_meet(el, guard, el.drifts == 0):
                build_rate(dofs, elements, terms, run, e)
                if el.drifts == 0 and _is_moved_by_rounding(dofs, terms, el, run):
                    break
                if el.drifts and not el.slides and _is_at_rest_but_for_rounding(dofs, terms, el, run):
                    break
                at = _find_meeting(dofs, terms, el, run, series[el.row], guard, min(1.0, el.at))
                if at < el.at:
                    el.at = at
                    el.guard = guard
        if el.at < run.end:
            run.end = el.at
            has_event = True
    return has_event


@njit(**PART)
def _cannot_leave(el):
    """Return whether bounds show that an element stays on its branch during the step."""
    is_inside = min(el.v0, el.v1) - el.dv > el.low and max(el.v0, el.v1) + el.dv < el.high
    keeps_way = min(el.r0, el.r1) - el.dr > el.slow and max(el.r0, el.r1) + el.dr < el.fast
    stands = max(abs(el.v0), abs(el.v1)) + el.dv <= el.collapse
    return is_inside and keeps_way and stands and not (el.levels or el.cuts or el.crosses or el.holds)


@njit(**PART)
def _can_meet(el, guard, is_link):
    """Return whether an element has this guard, and bounds do not show that it stays away from it."""
    if guard == LOW or guard == HIGH:
        at, side = (el.low, 1.0) if guard == LOW else (el.high, -1.0)
        first = side * (el.v0 - at)
        last = side * (el.v1 - at)
        if is_link and el.stuck >= 2 and el.pinned == VALUE and el.exact == at:
            return False
        is_monotone = abs(last - first) > 4.0 * el.dv  # then it may begin where the branch begins
        return not (min(first, last) > el.dv or (is_monotone and first >= 0.0 and last > 0.0))
    if guard == SLOWER:
        return not min(el.r0, el.r1) - el.slow > el.dr
    if guard == FASTER:
        return not el.fast - max(el.r0, el.r1) > el.dr
    if guard == LEVELS:
        return el.levels != 0
    if guard >= COLLAPSE_LOW:
        return max(abs(el.v0), abs(el.v1)) + el.dv > el.collapse
    if guard == SLIPS_RIGHT or guard == SLIPS_LEFT:
        return el.holds != 0
    return el.cuts != 0 if guard == SIGN_CHANGE else el.crosses != 0


@njit(**PART)
def _is_moved_by_rounding(dofs, terms, el, run):
    """Return whether a link, whose rate stands in run.p, moves in this step by the last digits of its floors alone.

    Such floors would strike each other without end.
    """
    reach, fastest = _find_reach(dofs, terms, el)
    least_v = LAST_DIGITS * reach
    least_rate = LAST_DIGITS * fastest
    if abs(el.v0) > least_v or abs(el.r0) > least_rate:
        return False
    size = 0.0
    for k in range(run.order + 1):
        size += abs(run.p[k])
    return size <= least_rate and abs(el.v0) + run.h * size <= least_v


@njit(**PART)
def _is_at_rest_but_for_rounding(dofs, terms, el, run):
    """Return whether a storey, whose rate of drift stands in run.p, moves by the last digits of its floors alone.

    A building that has come to rest would turn back without end.
    """
    reach, fastest = _find_reach(dofs, terms, el)
    size = 0.0
    for k in range(run.order + 1):
        size += abs(run.p[k])
    return size <= LAST_DIGITS * fastest and run.h * size <= LAST_DIGITS * reach


@njit(**PART)
def _find_reach(dofs, terms, el):
    """Return the largest displacement [m] and speed [m/s] that the degrees of freedom of an element have had.

    They are those of the larger of its two ends, and of its further terms.
    """
    left = dofs[el.left]
    right = dofs[el.right]
    reach, fastest = find_reach_of_terms(dofs, terms, el)
    reach += max(max(left.u_max, -left.u_min), max(right.u_max, -right.u_min))
    fastest += max(left.fastest, right.fastest)
    return reach, fastest


@njit(**CALLED)
def _find_meeting(dofs, terms, el, run, row, guard, end):
    """Return where in [0, end] an element, whose rate stands in run.p, first meets a guard; NEVER where it does not.

    A guard that up to there only changed by what DOP853 does not resolve has a sign by chance: it is met where it is
    passed by so much. Floors that rest on each other would else strike, or their force be cut off, and storeys that
    come to rest turn back, without end.
    """
    n = _build_guard(el, run, row, guard)
    at = find_first_crossing(run, n, end)
    if run.smooth and at < NEVER:
        doubt = _find_doubt(dofs, terms, el, run, row, guard)
        size = 0.0
        for k in range(n, -1, -1):
            size = size * at + abs(run.p[k])
        if size < doubt:
            run.p[0] += doubt
            at = find_first_crossing(run, n, end)
    often = el.stuck >= MAX_AT_INSTANT
    if often and at < INSTANT and (el.stuck > 3 * MAX_AT_INSTANT or evaluate(run.p, n, 1.0) > 0.0):
        return NEVER
    return at


@njit(**PART)
def _find_doubt(dofs, terms, el, run, row, guard):
    """Return how large a guard may be by what a step by DOP853 does not resolve; 0 of one of a history.

    That of a force is the part of it that deformation and rate may be of their largest in the step.
    """
    reach, fastest = _find_reach(dofs, terms, el)
    least = run.smooth_tolerance * MIN_STATE
    least_v = least + LAST_DIGITS * reach
    least_rate = least + LAST_DIGITS * fastest
    if guard == LOW or guard == HIGH:
        return least_v
    if guard == SLOWER or guard == FASTER:
        return least_rate
    if guard != SIGN_CHANGE:
        return 0.0
    part_of_v = least_v / (max(abs(el.v0), abs(el.v1)) + el.dv)
    part_of_rate = least_rate / (max(abs(el.r0), abs(el.r1)) + el.dr)
    size = 0.0
    for k in range(run.order):
        size += abs(row.f[k])
    return size * min(1.0, max(part_of_v, part_of_rate))


@njit(**PART)
def _build_guard(el, run, row, guard):
    """Turn the rate of an element in run.p into what is positive until it meets the guard; return the degree."""
    p = run.p
    n = run.order
    if guard == LOW:
        return integrate_rate(run, 1.0, el.v0 - el.low)
    if guard == HIGH:
        return integrate_rate(run, -1.0, el.high - el.v0)
    if guard >= COLLAPSE_LOW:
        side = 1.0 if guard == COLLAPSE_LOW else -1.0
        return integrate_rate(run, side, el.collapse + side * el.v0)
    if guard == SLOWER or guard == FASTER:
        side, at = (1.0, el.slow) if guard == SLOWER else (-1.0, el.fast)
        for k in range(n + 1):
            p[k] *= side
        p[0] -= side * at
        return n
    if guard == LEVELS:
        for k in range(n):
            p[k] = (k + 1.0) * p[k + 1]
        return n - 1
    if guard == CROSSES:  # the series of a smooth storey's force holds that of its line too
        side = 1.0 * el.crosses
        degree = integrate_rate(run, -side * el.k, -side * el.k * el.v0)
        for k in range(n):
            p[k] += side * row.f[k]
        if el.pinned == ITS_FORCE:
            p[0] = 0.0
        return degree
    if guard == SLIPS_RIGHT or guard == SLIPS_LEFT:
        side = 1.0 if guard == SLIPS_RIGHT else -1.0
        for k in range(n):
            p[k] = -side * row.f[k]
        p[0] += el.p[1]
        return n - 1
    side = 1.0 if el.acts else -1.0
    for k in range(n):
        p[k] = side * row.f[k]
    if el.pinned == ITS_FORCE:
        p[0] = 0.0
    return n - 1
