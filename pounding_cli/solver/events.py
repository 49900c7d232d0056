"""The end of a step, bounds that exclude events at little cost, and the first event where they do not.

A function on [0, 1] deviates from the chord between its ends by at most max |p''| / 8 <= sum of k (k - 1) |p_k| / 8,
its *chord deviation*. Nothing is searched where the chord, widened by it, stays inside the branch.
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
    START,
)
from pounding_cli.solver.dispatch import next_branch
from pounding_cli.solver.options import CALLED, FLOAT, INVERSE, PART
from pounding_cli.solver.polynomial import NEVER, evaluate, find_first_crossing
from pounding_cli.solver.records import COLLAPSED
from pounding_cli.solver.series import LAST_DIGITS, LAST_OF_FIT, zero_if_rounding
from pounding_cli.solver.stick import find_drive, hold_or_release

VALUE = 1
ITS_FORCE = 2
RATE = 3
RATE_AND_SLOPE = 4
"""What is exactly known of an element after an event, `pinned`: its deformation is that of the guard; its force is
zero; its rate is that of the guard; and its rate neither grows nor falls."""

MOST_AT_INSTANT = 4
"""Events of an element at one instant after which it leaves a branch only if that is left at the step's end too."""

INSTANT = 1e-12
"""Part of a step [-] within which an event counts as one at its start."""

TOUCH = 1e-11
"""Of floors in touch at rest, the parting [m] before which they are in contact since the motion began where they press,
and the closing before which they are not in contact where they part: what is less hangs on rounding."""

FROM_REST = 1e-3
"""Part of the first step of a run from rest at which floors in touch close at the earliest, where DOP853 steps their
contact: only a series tells the sign of what begins by a high power of time."""


NEAR_ZERO = 1e-9
"""Deformation [m] and rate [m/s] beyond which nothing is rounding: floors move by less than 10 km, and 10 km/s."""


@njit(**PART)
def evaluate_end(dofs, elements, terms, run):
    """Displacement, velocity and total acceleration of every degree of freedom at s = 1, with chord deviations."""
    h = run.h
    count = run.order + 1
    for i in range(run.n):
        dof = dofs[i]
        u = v = a = bend = twist = 0.0
        for k in range(count):  # LLVM makes vectors of these sums
            w = dof.w[k]
            slope = w * FLOAT[k]
            u += w * INVERSE[k + 1]
            v += w
            a += slope
            bent = abs(slope) * (FLOAT[k] - 1.0)
            bend += bent
            twist += bent * (FLOAT[k] - 2.0)
        dof.u1 = dof.u0 + h * u
        dof.v1 = v
        dof.a1 = a / h + dof.felt * run.g0 + dof.felt * run.g1
        # k < k (k - 1) from the third order on
        dof.du = 0.125 * h * (abs(dof.w[1]) + bend)
        dof.dv = 0.125 * bend
        dof.da = 0.125 * twist / h
    deform_elements(dofs, elements, terms, run)
    first_line = run.n + run.drags
    end_of_lines = run.n + run.drags + run.lines
    for e in range(run.m):
        el = elements[e]
        if first_line <= e < end_of_lines:
            storey = elements[el.storey]
            mate = elements[el.mate]
            lever = abs(el.lever)
            el.dv = el.along * storey.dv + lever * mate.dv
            el.dr = el.along * storey.dr + lever * mate.dr
            continue
        left = dofs[el.left]
        right = dofs[el.right]
        el.dv = left.du + el.hold * right.du
        el.dr = left.dv + el.hold * right.dv
        for x in range(el.first, el.last):
            size = abs(terms[x].weight)
            el.dv += size * dofs[terms[x].dof].du
            el.dr += size * dofs[terms[x].dof].dv


@njit(**PART)
def _deform_line(elements, el):
    """Deformation and rate of a frame line at the step's end, from those of its storey, which come before it."""
    storey = elements[el.storey]
    mate = elements[el.mate]
    lever = abs(el.lever)
    v = el.along * storey.v1 + el.lever * mate.v1
    rate = el.along * storey.r1 + el.lever * mate.r1
    el.v1 = zero_if_rounding(v, el.along * storey.size_v + lever * mate.size_v, LAST_DIGITS)
    el.r1 = zero_if_rounding(rate, el.along * storey.size_r + lever * mate.size_r, LAST_DIGITS)


@njit(**PART)
def _find_reach(dofs, terms, el):
    """Return the largest displacement [m] and speed [m/s] that the degrees of freedom of an element have had: of the
    larger of its two ends, and of its further terms."""
    left = dofs[el.left]
    right = dofs[el.right]
    reach, fastest = _find_reach_of_terms(dofs, terms, el)
    reach += max(max(left.u_max, -left.u_min), max(right.u_max, -right.u_min))
    fastest += max(left.fastest, right.fastest)
    return reach, fastest


@njit(**PART)
def _find_reach_of_terms(dofs, terms, el):
    """Return the largest displacement [m] and speed [m/s] of the further terms of an element."""
    reach = fastest = 0.0
    for x in range(el.first, el.last):
        dof = dofs[terms[x].dof]
        size = abs(terms[x].weight)
        reach += size * max(dof.u_max, -dof.u_min)
        fastest += size * dof.fastest
    return reach, fastest


@njit(**PART)
def deform_elements(dofs, elements, terms, run):
    """Deformation and rate of every element at the step's end, exactly zero where floors differ by rounding."""
    first_line = run.n + run.drags
    end_of_lines = run.n + run.drags + run.lines
    has_lines = run.lines > 0
    for e in range(run.m):
        el = elements[e]
        if first_line <= e < end_of_lines:
            _deform_line(elements, el)
            continue
        left = dofs[el.left]
        right = dofs[el.right]
        v = left.u1 - el.offset - el.hold * right.u1
        of_v = abs(left.u1 - el.offset) + abs(el.hold * right.u1)
        rate = left.v1 - el.hold * right.v1
        of_rate = abs(left.v1) + abs(el.hold * right.v1)
        for x in range(el.first, el.last):
            u = terms[x].weight * dofs[terms[x].dof].u1
            w = terms[x].weight * dofs[terms[x].dof].v1
            v = v + u
            of_v = of_v + abs(u)
            rate = rate + w
            of_rate = of_rate + abs(w)
        if el.drifts == 0 and (
            abs(v) < NEAR_ZERO or abs(rate) < NEAR_ZERO
        ):  # what floors have come to stays in their sums
            reach, fastest = _find_reach_of_terms(dofs, terms, el)
            of_v = max(of_v, max(left.u_max, -left.u_min) + reach)
            of_rate = max(of_rate, left.fastest + fastest)
        el.v1 = zero_if_rounding(v, of_v, LAST_DIGITS)
        el.r1 = zero_if_rounding(rate, of_rate, LAST_DIGITS)
        if has_lines and el.twists:
            el.size_v = of_v
            el.size_r = of_rate


@njit(**CALLED)
def end_at_event(dofs, elements, terms, run):
    """Replace the values at s = 1 by those at run.end, where an event was found."""
    h = run.h
    s = run.end
    count = run.order + 1
    p = run.p
    p[0] = 1.0
    for k in range(1, count):
        p[k] = p[k - 1] * s
    for i in range(run.n):
        dof = dofs[i]
        u = v = a = 0.0
        for k in range(count):
            w = dof.w[k] * p[k]
            u += w * INVERSE[k + 1]
            v += w
            a += w * FLOAT[k]
        dof.u1 = dof.u0 + h * s * u
        dof.v1 = v
        dof.a1 = dof.a0
        if s > 0.0:
            dof.a1 = a / (h * s) + dof.felt * run.g0 + dof.felt * run.g1 * s
    deform_elements(dofs, elements, terms, run)


@njit(**CALLED)
def build_rate(dofs, elements, terms, run, e):
    """Coefficients of the rate of element e, into r.p."""
    el = elements[e]
    count = run.order + 1
    left = dofs[el.left].w
    right = dofs[el.right].w
    p = run.p
    rounding = LAST_OF_FIT if run.smooth else LAST_DIGITS
    for k in range(count):
        total = left[k] - el.hold * right[k]
        size = abs(left[k]) + abs(el.hold * right[k])
        for x in range(el.first, el.last):
            part = terms[x].weight * dofs[terms[x].dof].w[k]
            total = total + part
            size = size + abs(part)
        p[k] = zero_if_rounding(total, size, rounding)
    if el.pinned >= RATE or el.r0 == 0.0:
        p[0] = el.r0
    if el.pinned == RATE_AND_SLOPE:
        p[1] = 0.0


@njit(**PART)
def integrate_rate(run, side, first):
    """`side` times the integral of r.p over the time of the step, with the value `first` at the start; its degree."""
    p = run.p
    n = run.order + 1
    for k in range(n, 0, -1):
        p[k] = side * p[k - 1] * run.h * INVERSE[k]
    p[0] = first
    return n


@njit(**PART)
def _build_guard(el, run, row, guard):
    """From the rate of an element in r.p what is positive until it meets the guard; returns its degree."""
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


@njit(**CALLED)
def _find_meeting(el, run, row, guard, end):
    """Where in [0, end] an element, whose rate stands in r.p, first meets a guard."""
    n = _build_guard(el, run, row, guard)
    at = find_first_crossing(run, n, end)
    often = el.stuck >= MOST_AT_INSTANT
    if often and at < INSTANT and (el.stuck > 3 * MOST_AT_INSTANT or evaluate(run.p, n, 1.0) > 0.0):
        return NEVER
    return at


@njit(**PART)
def _cannot_leave(el):
    """Whether bounds show that an element stays on its branch during the step."""
    is_inside = min(el.v0, el.v1) - el.dv > el.low and max(el.v0, el.v1) + el.dv < el.high
    keeps_way = min(el.r0, el.r1) - el.dr > el.slow and max(el.r0, el.r1) + el.dr < el.fast
    stands = max(abs(el.v0), abs(el.v1)) + el.dv <= el.collapse
    return is_inside and keeps_way and stands and not (el.levels or el.cuts or el.crosses or el.holds)


@njit(**PART)
def _can_meet(el, guard, is_link):
    """Whether an element has this guard, and bounds do not show that it stays away from it."""
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
    """Whether a link, whose rate stands in r.p, moves in this step by no more than the last digits of its floors: such
    floors would strike each other without end."""
    reach, fastest = _find_reach(dofs, terms, el)
    least_v = LAST_DIGITS * reach
    least_rate = LAST_DIGITS * fastest
    if abs(el.v0) > least_v or abs(el.r0) > least_rate:
        return False
    if run.smooth:  # the polynomials of a step by DOP853 multiply rounding on their way
        return abs(el.v1) <= least_v and abs(el.r1) <= least_rate
    size = 0.0
    for k in range(run.order + 1):
        size += abs(run.p[k])
    return size <= least_rate and abs(el.v0) + run.h * size <= least_v


@njit(**PART)
def _is_at_rest_but_for_rounding(dofs, terms, el, run):
    """Whether the drift of a storey, whose rate stands in r.p, changes in this step by no more than the last digits of
    its floors: a building that has come to rest would turn back without end."""
    reach, fastest = _find_reach(dofs, terms, el)
    size = 0.0
    for k in range(run.order + 1):
        size += abs(run.p[k])
    return size <= LAST_DIGITS * fastest and run.h * size <= LAST_DIGITS * reach


@njit(**CALLED)
def find_first_event(dofs, elements, terms, run, series):
    """Whether an element leaves its branch in [0, 1]; where the first does goes to r.end."""
    found = False
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
                at = _find_meeting(el, run, series[el.row], guard, min(1.0, el.at))
                if el.eased and run.still:
                    at = max(at, FROM_REST)
                if at < el.at:
                    el.at = at
                    el.guard = guard
        if el.at < run.end:
            run.end = el.at
            found = True
    return found


@njit(**CALLED)
def change_branches(dofs, elements, terms, run, series):
    """Change all elements that leave their branch at the end of this step, so that equal buildings stay equal."""
    for e in range(run.m):
        el = elements[e]
        if el.at == run.end and el.at < NEVER:
            if el.guard >= COLLAPSE_LOW:
                run.status = COLLAPSED
                continue
            _pin(el, run.end)
            was_open = el.closed == 0
            if el.smooth and el.guard == LOW:
                run.across = run.h
            next_branch(el, el.guard)
            if el.slides:
                hold_or_release(dofs[e], el)
            if was_open and el.closed:
                el.hits = 1 if el.least > -TOUCH else el.hits + 1
                if el.smooth:
                    run.next = max(run.onset, 0.0)
                    run.onset = -1.0
            if el.least > -TOUCH and was_open and el.closed:
                el.time = run.time - run.begun
            elif not el.closed and el.least > -TOUCH and el.peak_v < TOUCH:
                el.time = 0.0
                el.hits = 0
            el.stuck += 1
            run.events += 1
    if run.lines:
        gather_lines(elements, run)
    list_active(elements, run, series)


@njit(**PART)
def _pin(el, end):
    """Keep what is exactly known of an element that meets its guard at s = `end`.

    A force that passes zero inside a step is zero there. One that has the wrong sign as the step begins has jumped to
    its value at the event before, as an infill's does at its thickness: it is what it is, and not zero.
    """
    guard = el.guard
    if guard == LOW or guard == HIGH:
        el.exact = el.low if guard == LOW else el.high
        el.v0 = el.v1 = el.exact
        el.pinned = VALUE
    elif guard == SLOWER or guard == FASTER:
        el.r0 = el.r1 = el.slow if guard == SLOWER else el.fast
        el.pinned = RATE
    elif guard == LEVELS:
        el.pinned = RATE_AND_SLOPE if end > INSTANT else RATE
    elif guard == SLIPS_RIGHT or guard == SLIPS_LEFT:  # from rest, with forces that balance unless they jumped
        el.r0 = el.r1 = 0.0
        el.pinned = RATE_AND_SLOPE if end > INSTANT else RATE
    elif end > 0.0:
        el.pinned = ITS_FORCE


@njit(**CALLED)
def list_active(elements, run, series):
    """List the links whose force is not zero, and see whether a step has to be taken by DOP853."""
    run.active = 0
    run.smooth = run.always_smooth
    for e in range(run.m):
        el = elements[e]
        if el.smooth:
            run.smooth = 1
        if e >= run.n and (el.smooth if el.drifts else el.closed):
            el.row = run.active
            series[run.active].element = e
            run.active += 1


@njit(**CALLED)
def gather_lines(elements, run):
    """Add the stiffnesses, dashpots and offsets of the frame lines on their present branches up in their storeys; lines
    whose force is smooth act by themselves."""
    for i in range(run.n):
        el = elements[i]
        if el.twists:
            el.k = el.p[0]
            el.c = el.p[1]
            el.f0 = el.coupled_k = el.coupled_c = 0.0
    for e in range(run.n + run.drags, run.n + run.drags + run.lines):
        el = elements[e]
        if el.smooth:
            continue
        storey = elements[el.storey]
        mate = elements[el.mate]
        lever = el.lever
        if el.along != 0.0:
            storey.k += el.k
            storey.c += el.c
            storey.f0 += el.f0
            storey.coupled_k += lever * el.k
            storey.coupled_c += lever * el.c
            mate.coupled_k += lever * el.k
            mate.coupled_c += lever * el.c
        mate.k += lever * lever * el.k
        mate.c += lever * lever * el.c
        mate.f0 += lever * el.f0
    for i in range(run.n):
        el = elements[i]
        if el.twists:
            el.stiffness = el.k - el.load


@njit(**CALLED)
def unpin(elements, run):
    """Time goes on: nothing is exactly known any more."""
    for e in range(run.m):
        elements[e].pinned = elements[e].stuck = 0


@njit(**CALLED)
def enter_first_branches(elements, run, series):
    """The branches of all elements at rest."""
    for e in range(run.m):
        elements[e].guard = START
        next_branch(elements[e], elements[e].guard)
    list_active(elements, run, series)
