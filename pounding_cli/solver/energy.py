"""Where the energy of a step goes: quadrature of its polynomials."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.solver.options import CALLED, PART
from pounding_cli.solver.records import PLACES_INSIDE

_ROOTS, _WEIGHTS = np.polynomial.legendre.leggauss(PLACES_INSIDE)

PLACES = 0.5 + 0.5 * _ROOTS
WEIGHTS = 0.5 * _WEIGHTS
"""Gauss-Legendre places in [0, 1] and their weights."""


@njit(**CALLED)
def add_energy(dofs, elements, r, series):
    """Add the energies of the step up to s = run.end [J]."""
    for i in range(r.n):
        d = dofs[i]
        for g in range(0, PLACES_INSIDE, 4):
            d.inside[g], d.inside[g + 1], d.inside[g + 2], d.inside[g + 3] = _at_four(d.w, r.order, r.end, g)
    _work_on_storeys(dofs, elements, r)
    for a in range(r.active):
        el = elements[series[a].element]
        if el.drifts:
            _work_on_line(el, r, series[a])
        else:
            _work_on_series(el, r, series[a])
    for e in range(r.n + r.drags, r.n + r.drags + r.lines):
        el = elements[e]
        if el.yields and not el.smooth:  # the force is straight in the drift
            el.work += (0.5 * el.k * (el.v0 + el.v1) + el.f0) * (el.v1 - el.v0)
    for i in range(r.n):
        el = elements[i]
        if el.smooth:
            _work_on_series(el, r, series[el.row])
        elif el.yields:  # the force is straight in the drift
            el.work += (0.5 * el.k * (el.v0 + el.v1) + el.f0) * (el.v1 - el.v0)


@njit(**PART)
def _at_four(p, n, end, g):
    """The polynomial p of degree n at four places from number g on, side by side (Horner)."""
    s0 = PLACES[g] * end
    s1 = PLACES[g + 1] * end
    s2 = PLACES[g + 2] * end
    s3 = PLACES[g + 3] * end
    v0 = v1 = v2 = v3 = p[n]
    for k in range(n - 1, -1, -1):
        v0 = v0 * s0 + p[k]
        v1 = v1 * s1 + p[k]
        v2 = v2 * s2 + p[k]
        v3 = v3 * s3 + p[k]
    return v0, v1, v2, v3


@njit(**PART)
def _work_on_storeys(dofs, elements, r):
    """Energy that the ground puts in, and what dashpots of storeys and mass-proportional damping take [J]."""
    duration = r.h * r.end
    g1 = r.g1 * r.end
    drag = dashpots = pushed = 0.0
    has_lines = r.lines > 0
    for i in range(r.n):
        el = elements[i]
        d = dofs[i]
        below = dofs[el.right].inside
        foot = dofs[d.foot].inside
        push = square = rates = 0.0
        for g in range(PLACES_INSIDE):
            v = d.inside[g]
            rate = v - el.hold * below[g] + d.lean * foot[g]
            push += WEIGHTS[g] * (r.g0 + g1 * PLACES[g]) * v
            square += WEIGHTS[g] * v * v
            rates += WEIGHTS[g] * rate * rate
        if has_lines and el.twists and el.mate > i:
            dashpots += 2.0 * el.coupled_c * _common_rates(dofs, elements, i)
        pushed += d.mass * d.loaded * push
        drag += d.mass * d.drag * square
        dashpots += el.c * rates
    r.input -= pushed * duration
    r.drag += drag * duration
    r.dashpots += dashpots * duration


@njit(**PART)
def _common_rates(dofs, elements, i):
    """Return the mean over the step of the rate of drift times that of twist of the storey i, whose floors twist."""
    d = dofs[i]
    el = elements[i]
    below = dofs[el.right].inside
    foot = dofs[d.foot].inside
    turn = dofs[el.mate]
    mate = elements[el.mate]
    turn_below = dofs[mate.right].inside
    product = 0.0
    for g in range(PLACES_INSIDE):
        rate = d.inside[g] - el.hold * below[g] + d.lean * foot[g]
        product += WEIGHTS[g] * rate * (turn.inside[g] - mate.hold * turn_below[g])
    return product


@njit(**PART)
def _work_on_series(el, r, s):
    """Work done in the step on an element whose force has a series [J]."""
    if not el.acts:
        return
    n = r.order - 1
    power = 0.0
    for g in range(0, PLACES_INSIDE, 4):
        f0, f1, f2, f3 = _at_four(s.f, n, r.end, g)
        v0, v1, v2, v3 = _at_four(s.rate, n, r.end, g)
        power += WEIGHTS[g] * f0 * v0 + WEIGHTS[g + 1] * f1 * v1 + WEIGHTS[g + 2] * f2 * v2 + WEIGHTS[g + 3] * f3 * v3
    el.work += r.h * r.end * power


@njit(**PART)
def _work_on_line(el, r, s):
    """Work done in the step on a frame line whose force is smooth, and what its dashpot takes [J]."""
    squares = 0.0
    for g in range(0, PLACES_INSIDE, 4):
        v0, v1, v2, v3 = _at_four(s.rate, r.order - 1, r.end, g)
        squares += WEIGHTS[g] * v0 * v0 + WEIGHTS[g + 1] * v1 * v1 + WEIGHTS[g + 2] * v2 * v2 + WEIGHTS[g + 3] * v3 * v3
    r.dashpots += el.c * squares * r.h * r.end
    _work_on_series(el, r, s)
