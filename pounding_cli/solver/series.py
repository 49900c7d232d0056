"""The Taylor series of a step: every order from the one before by the equations of motion (Jorba & Zou 2005).

Time runs as s = (t - t0) / h from 0 to 1. `w[k]` of a degree of freedom is coefficient k of its velocity; that of the
displacement is h / k w[k - 1]. Each order is one walk over the links that act and one over the storeys, from the ground
up.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from pounding_cli.solver.dispatch import compute_line_force
from pounding_cli.solver.options import CALLED, INVERSE, PART

MIN_ORDER = 4
"""No series is shorter."""

DIVERGED = 1e100
"""Size of a term over what may be left out [-] from which no more are added: they would exceed the range of doubles."""

ORDER_FROM_REST = 30
"""Of the first series of a run from rest: floors n storeys up that touch begin to close by t^(2 n + 2)."""

LAST_DIGITS = 1e-13
"""Part of its terms [-] below which a sum is rounding: floors that move alike."""

LAST_OF_FIT = 1e-10
"""The same of coefficients of a polynomial that was fitted (`smooth`), which multiplies rounding."""


@njit(**PART)
def zero_if_rounding(total, magnitude, tolerance):
    """Return `total`, or exactly 0 where it is only rounding error.

    magnitude : sum of the absolute values of the terms of `total`
    tolerance : relative size below which a sum counts as rounding error [-]
    """
    return total if abs(total) > tolerance * magnitude else 0.0


@njit(**PART)
def _compute_link_rate(dofs, terms, k, el):
    """Return order k of the rate of a link."""
    rate = dofs[el.left].w[k] - dofs[el.right].w[k]
    for x in range(el.first, el.last):
        rate += terms[x].weight * dofs[terms[x].dof].w[k]
    return rate


@njit(**PART)
def push(dofs, terms, el, f):
    """Let the force f of a link act on its degrees of freedom."""
    dofs[el.left].push += f
    dofs[el.right].push -= f
    for x in range(el.first, el.last):
        dofs[terms[x].dof].push += terms[x].weight * f


@njit(**PART)
def push_by_storey(dofs, el, i, f, has_lean):
    """Let the force f of storey i act on its floor and on what it stands on.

    The weight on it (P-Delta) acts on the floors alone, by their displacements u1, which at a step's start are u0.
    """
    dof = dofs[i]
    if has_lean:
        dofs[dof.foot].push += dof.lean * f
    if el.load != 0.0:
        f -= el.load * (dof.u1 - dof.below * dofs[i - 1].u1)
    dof.push += f
    if dof.below != 0.0:
        dofs[i - 1].push -= f


@njit(**PART)
def compute_coupled_force(elements, el):
    """Return what the lines of a storey whose floors twist add to its force at the start of a step by its mate [N]."""
    mate = elements[el.mate]
    return el.coupled_k * mate.v0 + el.coupled_c * mate.r0


@njit(**PART)
def start_series(dofs, elements, terms, run, series):
    """Begin the series of a step: forces of all elements at its start, and accelerations, which go to order 1 of w."""
    for i in range(run.n):
        dofs[i].push = dofs[i].mass * dofs[i].loaded * run.g0
    for a in range(run.active):
        row = series[a]
        el = elements[row.element]
        f = compute_line_force(el, el.v0, el.r0)
        row.v[0] = el.v0
        row.rate[0] = el.r0
        row.f[0] = f
        el.previous = el.r0
        if el.cubic != 0.0:
            row.square[0] = el.v0 * el.v0
            row.cubic_root[0] = math.sqrt(el.k + 3.0 * el.cubic * row.square[0])
        if el.acts:
            push(dofs, terms, el, f)
    has_lines = run.lines > 0
    for i in range(run.n):
        el = elements[i]
        f = compute_line_force(el, el.v0, el.r0)
        if has_lines and el.twists:
            f += compute_coupled_force(elements, el)
        push_by_storey(dofs, el, i, f, run.has_lean)
    for i in range(run.n):
        dof = dofs[i]
        a = -dof.inv_mass * dof.push - dof.drag * dof.w[0]
        dof.push = dof.mass * dof.loaded * run.g1
        dof.a0 = a + dof.felt * run.g0
        dof.w[1] = a * run.h
        dof.allowed = 1.0 / (run.tolerance * max(dof.scale, run.least * dof.unit))


@njit(**PART)
def _compute_cubic_term(el, row, k, v, rate):
    """Return order k of the force k v + p v^3 + root sqrt(k + 3 p v^2) v' [N]."""
    row.v[k] = v
    row.rate[k] = rate
    square = cube = root = dash = 0.0
    for j in range(k + 1):
        square += row.v[j] * row.v[k - j]
    row.square[k] = square
    for j in range(1, k):
        root += row.cubic_root[j] * row.cubic_root[k - j]
    row.cubic_root[k] = (3.0 * el.cubic * square - root) / (2.0 * row.cubic_root[0])
    for j in range(k + 1):
        cube += row.square[j] * row.v[k - j]
        dash += row.cubic_root[j] * row.rate[k - j]
    return el.k * v + el.cubic * cube + el.root * dash


@njit(**PART)
def _push_links(dofs, elements, terms, series, count, k, part):
    """Add order k of the forces of the links that act; return the largest term of a force that is cut off.

    A force that is cut off moves no floor, but its sign is asked for; its term is over what may be left out [-].

    part : h / k
    """
    largest = 0.0
    for a in range(count):
        row = series[a]
        el = elements[row.element]
        rate = _compute_link_rate(dofs, terms, k, el)
        v = part * el.previous
        el.previous = rate
        if el.relaxation > 0.0:  # F' = k v' - F / relaxation time
            f = el.k * v - el.relaxation * part * row.f[k - 1]
        elif el.cubic != 0.0:
            f = _compute_cubic_term(el, row, k, v, rate)
        else:
            f = el.k * v + el.c * rate
        row.v[k] = v
        row.rate[k] = rate
        row.f[k] = f
        if el.acts:
            push(dofs, terms, el, f)
        else:
            one = dofs[el.left]
            other = dofs[el.right]
            largest = max(largest, abs(f) * max(one.inv_mass * one.allowed, other.inv_mass * other.allowed))
    return largest


@njit(**PART)
def _advance_velocity(dof, k, w, f, after):
    """Set order k + 1 of a velocity; return the size of the acceleration, over what may be left out [-].

    Parameters
    ----------
    w : order k of the velocity
    f : sum of the forces of the storeys at the degree of freedom
    after : h / (k + 1)
    """
    a = -dof.inv_mass * (f + dof.push) - dof.drag * w
    dof.push = 0.0
    dof.w[k + 1] = a * after
    return abs(a) * dof.allowed


@njit(**PART)
def _walk_up(dofs, elements, n, k, part, after, has_lean):
    """Take all storeys from order k to the next, from the ground up; return the largest size of an acceleration.

    A floor is done when the force of the storey above it is. Bases that rock come after their floors, whose forces they
    feel; the weight on a storey acts on the floors alone.

    part, after : h / k and h / (k + 1)
    """
    size = w_below = earlier_below = f_below = 0.0
    for i in range(n):  # from 0 on by the same sums, so that equal buildings move alike to the last digit
        dof = dofs[i]
        el = elements[i]
        w = dof.w[k]
        earlier = dof.w[k - 1]
        moved = part * (earlier - dof.below * earlier_below)
        rate = w - dof.below * w_below
        f = el.stiffness * moved + el.c * rate
        if has_lean:
            foot = dofs[dof.foot]
            leaned = dof.lean * (el.k * part * foot.w[k - 1] + el.c * foot.w[k])
            foot.push += dof.lean * (f + el.load * moved + leaned)
            f += leaned
        if i > 0:
            size = max(size, _advance_velocity(dofs[i - 1], k, w_below, f_below - dof.below * f, after))
        w_below = w
        earlier_below = earlier
        f_below = f
    return max(size, _advance_velocity(dofs[n - 1], k, w_below, f_below, after))


@njit(**PART)
def _walk_up_twisting(dofs, elements, n, k, part, after, has_lean):
    """Do as `_walk_up` where floors twist: a storey has a drift and a twist, with the forces of all its lines."""
    size = w_below = earlier_below = f_below = w_turn_below = earlier_turn_below = f_turn_below = 0.0
    floor_below = -1
    for i in range(n):
        dof = dofs[i]
        el = elements[i]
        if el.twists and el.mate < np.uint64(i):  # a twist, which comes with its drift
            continue
        w = dof.w[k]
        earlier = dof.w[k - 1]
        moved = part * (earlier - dof.below * earlier_below)
        rate = w - dof.below * w_below
        f = el.stiffness * moved + el.c * rate
        leaned = leaned_rate = 0.0
        if has_lean:
            foot = dofs[dof.foot]
            leaned = dof.lean * part * foot.w[k - 1]
            leaned_rate = dof.lean * foot.w[k]
        if el.twists:
            turn = dofs[el.mate]
            mate = elements[el.mate]
            w_turn = turn.w[k]
            earlier_turn = turn.w[k - 1]
            turned = part * (earlier_turn - turn.below * earlier_turn_below)
            turned_rate = w_turn - turn.below * w_turn_below
            f += el.coupled_k * turned + el.coupled_c * turned_rate
            f_turn = mate.stiffness * turned + mate.c * turned_rate
            f_turn += el.coupled_k * (moved + leaned) + el.coupled_c * (rate + leaned_rate)
            if turn.below != 0.0:
                turning = dofs[el.mate - np.uint64(1)]
                size = max(size, _advance_velocity(turning, k, w_turn_below, f_turn_below - f_turn, after))
            w_turn_below = w_turn
            earlier_turn_below = earlier_turn
            f_turn_below = f_turn
            if el.twists > 1:
                size = max(size, _advance_velocity(turn, k, w_turn_below, f_turn_below, after))
        if has_lean:
            lean_force = el.k * leaned + el.c * leaned_rate
            foot.push += dof.lean * (f + el.load * moved + lean_force)
            f += lean_force
        if floor_below >= 0:
            size = max(size, _advance_velocity(dofs[floor_below], k, w_below, f_below - dof.below * f, after))
        w_below = w
        earlier_below = earlier
        f_below = f
        floor_below = i
    return max(size, _advance_velocity(dofs[floor_below], k, w_below, f_below, after))


@njit(**PART)
def expand(dofs, elements, terms, run, series):
    """Expand the velocities of a step as series; return whether they converge.

    They end at the order at which two terms of all accelerations in a row are small enough, or at the highest one; the
    order goes to run.order.
    """
    n = run.n
    h = run.h
    count = run.active
    has_lean = run.has_lean
    has_lines = run.lines > 0
    least = ORDER_FROM_REST if run.still else MIN_ORDER
    most = max(run.max_order, least)
    # for the constant 1 all that takes k would be compiled once more
    small = 0
    k = np.int64(1)
    size = 0.0
    while (small < 2 or k <= least) and k < most and size < DIVERGED:
        part = h * INVERSE[k]
        after = h * INVERSE[k + 1]
        size = _push_links(dofs, elements, terms, series, count, k, part) if count else 0.0
        if has_lines:
            if has_lean:
                size = max(size, _walk_up_twisting(dofs, elements, n, k, part, after, True))
            else:
                size = max(size, _walk_up_twisting(dofs, elements, n, k, part, after, False))
        elif has_lean:  # as constants, so that each is compiled by itself
            size = max(size, _walk_up(dofs, elements, n, k, part, after, True))
        else:
            size = max(size, _walk_up(dofs, elements, n, k, part, after, False))
        small = small + 1 if size < 1.0 else 0
        k += 1
    run.order = k
    return small > 1


@njit(**PART)
def find_converged_part(dofs, elements, run, series):
    """Return the part of the step in which the last two terms are small enough [-]; NaN beyond the range of doubles."""
    worst = 0.0
    for k in (run.order - 1, run.order):
        size = 0.0
        for i in range(run.n):
            size = max(size, abs(dofs[i].w[k]) * k / run.h * dofs[i].allowed)
        for a in range(run.active):
            el = elements[series[a].element]
            if not el.acts:
                one = dofs[el.left]
                other = dofs[el.right]
                most = max(one.inv_mass * one.allowed, other.inv_mass * other.allowed)
                size = max(size, abs(series[a].f[k - 1]) * most)
        if not size < 1e300:
            return np.nan
        if size > 0.0:
            worst = max(worst, size ** (1.0 / (k - 1)))
    return 0.9 / worst if worst > 0.9 else 1.0


@njit(**CALLED)
def shorten(dofs, run, series, ratio):
    """Shorten a step whose series do not converge to about `ratio` of it; return whether it was.

    The motion is the same; s is measured anew.
    """
    if not ratio < 1.0:
        return False
    if ratio > 0.1:
        ratio = 1.0 / np.ceil(1.0 / ratio)
        run.longest = run.h * ratio
    power = 1.0
    for k in range(run.order + 1):
        for i in range(run.n):
            dofs[i].w[k] *= power
        for a in range(run.active):
            row = series[a]
            row.v[k] *= power
            row.rate[k] *= power
            row.f[k] *= power
        power *= ratio
    run.h *= ratio
    run.g1 *= ratio
    return True
