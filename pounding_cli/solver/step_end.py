"""The end of a step: displacements, velocities and accelerations there, and the deformations of all elements.

A function on [0, 1] deviates from the chord between its ends by at most max |p''| / 8 <= sum of k (k - 1) |p_k| / 8,
its *chord deviation*. It is found with the end, and `events` and `peaks` look at nothing that it excludes.
"""

from __future__ import annotations

from numba import njit

from pounding_cli.solver.options import CALLED, FLOAT, INVERSE, PART
from pounding_cli.solver.records import RATE, RATE_AND_SLOPE
from pounding_cli.solver.series import LAST_DIGITS, LAST_OF_FIT, zero_if_rounding

NEAR_ZERO = 1e-9
"""Deformation [m] and rate [m/s] beyond which nothing is rounding: floors move by less than 10 km, and 10 km/s."""


@njit(**PART)
def evaluate_end(dofs, elements, terms, run):
    """Evaluate the motion of every degree of freedom at s = 1, and how far it may deviate from its chord on the way."""
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
        # u'' is the sum of k |w_k| times h, and k <= k (k - 1) from the second order on
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


@njit(**CALLED)
def end_at_event(dofs, elements, terms, run):
    """Replace the values at s = 1 by those at s = run.end, where an event was found."""
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


@njit(**PART)
def deform_elements(dofs, elements, terms, run):
    """Find deformation and rate of every element at the step's end, exactly zero where floors differ by rounding."""
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
        size_v = abs(left.u1 - el.offset) + abs(el.hold * right.u1)
        rate = left.v1 - el.hold * right.v1
        size_rate = abs(left.v1) + abs(el.hold * right.v1)
        for x in range(el.first, el.last):
            u = terms[x].weight * dofs[terms[x].dof].u1
            w = terms[x].weight * dofs[terms[x].dof].v1
            v += u
            size_v += abs(u)
            rate += w
            size_rate += abs(w)
        if el.drifts == 0 and (abs(v) < NEAR_ZERO or abs(rate) < NEAR_ZERO):
            # the largest displacements and speeds so far have left their rounding in these sums
            reach, fastest = find_reach_of_terms(dofs, terms, el)
            size_v = max(size_v, max(left.u_max, -left.u_min) + reach)
            size_rate = max(size_rate, left.fastest + fastest)
        el.v1 = zero_if_rounding(v, size_v, LAST_DIGITS)
        el.r1 = zero_if_rounding(rate, size_rate, LAST_DIGITS)
        if has_lines and el.twists:
            el.size_v = size_v
            el.size_r = size_rate


@njit(**PART)
def _deform_line(elements, el):
    """Deform a frame line at the step's end by drift and twist of its storey, which are known before."""
    storey = elements[el.storey]
    mate = elements[el.mate]
    lever = abs(el.lever)
    v = el.along * storey.v1 + el.lever * mate.v1
    rate = el.along * storey.r1 + el.lever * mate.r1
    el.v1 = zero_if_rounding(v, el.along * storey.size_v + lever * mate.size_v, LAST_DIGITS)
    el.r1 = zero_if_rounding(rate, el.along * storey.size_r + lever * mate.size_r, LAST_DIGITS)


@njit(**PART)
def find_reach_of_terms(dofs, terms, el):
    """Return the largest displacement [m] and speed [m/s] of the further terms of an element so far."""
    reach = fastest = 0.0
    for x in range(el.first, el.last):
        dof = dofs[terms[x].dof]
        size = abs(terms[x].weight)
        reach += size * max(dof.u_max, -dof.u_min)
        fastest += size * dof.fastest
    return reach, fastest


@njit(**CALLED)
def build_rate(dofs, elements, terms, run, e):
    """Put the coefficients of the rate of element e into run.p."""
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
            total += part
            size += abs(part)
        p[k] = zero_if_rounding(total, size, rounding)
    if el.pinned >= RATE or el.r0 == 0.0:
        p[0] = el.r0
    if el.pinned == RATE_AND_SLOPE:
        p[1] = 0.0


@njit(**PART)
def integrate_rate(run, side, first):
    """Turn the rate in run.p into `first` plus `side` times its integral over the step's time; return the degree."""
    p = run.p
    n = run.order + 1
    for k in range(n, 0, -1):
        p[k] = side * p[k - 1] * run.h * INVERSE[k]
    p[0] = first
    return n
