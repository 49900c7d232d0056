"""The energies of a step, by quadrature of its polynomials."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.solver.options import CALLED, PART
from pounding_cli.solver.records import PLACES_INSIDE

_ROOTS, _WEIGHTS = np.polynomial.legendre.leggauss(PLACES_INSIDE)

PLACES = 0.5 + 0.5 * _ROOTS
"""Gauss-Legendre places in [0, 1]."""

WEIGHTS = 0.5 * _WEIGHTS
"""Their weights."""


@njit(**CALLED)
def add_energy(dofs, elements, run, series):
    """Add the energies of the step up to s = run.end [J]."""
    for i in range(run.n):
        dof = dofs[i]
        for g in range(0, PLACES_INSIDE, 4):
            dof.inside[g], dof.inside[g + 1], dof.inside[g + 2], dof.inside[g + 3] = _evaluate_at_four(
                dof.w, run.order, run.end, g
            )
    _add_work_on_storeys(dofs, elements, run)
    for a in range(run.active):
        el = elements[series[a].element]
        if el.drifts:
            _add_work_on_line(el, run, series[a])
        else:
            _add_work_on_series(el, run, series[a])
    for e in range(run.n + run.drags, run.n + run.drags + run.lines):
        el = elements[e]
        if el.yields and not el.smooth:  # the force is straight in the drift
            el.work += (0.5 * el.k * (el.v0 + el.v1) + el.f0) * (el.v1 - el.v0)
    for i in range(run.n):
        el = elements[i]
        if el.smooth:
            _add_work_on_series(el, run, series[el.row])
        elif el.yields:  # the force is straight in the drift
            el.work += (0.5 * el.k * (el.v0 + el.v1) + el.f0) * (el.v1 - el.v0)


@njit(**PART)
def _evaluate_at_four(p, n, end, g):
    """Return the polynomial p of degree n at four places of the quadrature, side by side (Horner).

    g : number of the first of these places
    end : of the step, from 0 to 1
    """
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
def _add_work_on_storeys(dofs, elements, run):
    """Add the work of the ground, and what dashpots of storeys and mass-proportional damping take [J]."""
    duration = run.h * run.end
    g1 = run.g1 * run.end
    drag = dashpots = pushed = 0.0
    has_lines = run.lines > 0
    for i in range(run.n):
        el = elements[i]
        dof = dofs[i]
        below = dofs[el.right].inside
        foot = dofs[dof.foot].inside
        push = square = rates = 0.0
        for g in range(PLACES_INSIDE):
            v = dof.inside[g]
            rate = v - el.hold * below[g] + dof.lean * foot[g]
            push += WEIGHTS[g] * (run.g0 + g1 * PLACES[g]) * v
            square += WEIGHTS[g] * v * v
            rates += WEIGHTS[g] * rate * rate
        if has_lines and el.twists and el.mate > i:
            dashpots += 2.0 * el.coupled_c * _average_rate_product(dofs, elements, i)
        pushed += dof.mass * dof.loaded * push
        drag += dof.mass * dof.drag * square
        dashpots += el.c * rates
    run.input -= pushed * duration
    run.drag += drag * duration
    run.dashpots += dashpots * duration


@njit(**PART)
def _average_rate_product(dofs, elements, i):
    """Return the mean over the step of the rate of drift times that of twist of the storey i, whose floors twist."""
    dof = dofs[i]
    el = elements[i]
    below = dofs[el.right].inside
    foot = dofs[dof.foot].inside
    turn = dofs[el.mate]
    mate = elements[el.mate]
    turn_below = dofs[mate.right].inside
    product = 0.0
    for g in range(PLACES_INSIDE):
        rate = dof.inside[g] - el.hold * below[g] + dof.lean * foot[g]
        product += WEIGHTS[g] * rate * (turn.inside[g] - mate.hold * turn_below[g])
    return product


@njit(**PART)
def _add_work_on_series(el, run, row):
    """Add the work done in the step on an element whose force has a series [J]."""
    if not el.acts:
        return
    n = run.order - 1
    power = 0.0
    for g in range(0, PLACES_INSIDE, 4):
        f0, f1, f2, f3 = _evaluate_at_four(row.f, n, run.end, g)
        v0, v1, v2, v3 = _evaluate_at_four(row.rate, n, run.end, g)
        power += WEIGHTS[g] * f0 * v0 + WEIGHTS[g + 1] * f1 * v1 + WEIGHTS[g + 2] * f2 * v2 + WEIGHTS[g + 3] * f3 * v3
    el.work += run.h * run.end * power


@njit(**PART)
def _add_work_on_line(el, run, row):
    """Add the work done in the step on a frame line whose force is smooth, and what its dashpot takes [J]."""
    squares = 0.0
    for g in range(0, PLACES_INSIDE, 4):
        v0, v1, v2, v3 = _evaluate_at_four(row.rate, run.order - 1, run.end, g)
        squares += WEIGHTS[g] * v0 * v0 + WEIGHTS[g + 1] * v1 * v1 + WEIGHTS[g + 2] * v2 * v2 + WEIGHTS[g + 3] * v3 * v3
    run.dashpots += el.c * squares * run.h * run.end
    _add_work_on_series(el, run, row)
