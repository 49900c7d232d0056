"""Where the energy of a step goes: quadrature of its polynomials."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.solver.options import CALLED, PART
from pounding_cli.solver.records import MOST_POINTS


def _gauss_rules() -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre places in [0, 1] and their weights of all rules, that of q places in row q and zeros behind it."""
    places, weights = np.zeros((2, MOST_POINTS + 1, MOST_POINTS))
    for q in range(1, MOST_POINTS + 1):
        x, weight = np.polynomial.legendre.leggauss(q)
        places[q, :q], weights[q, :q] = 0.5 + 0.5 * x, 0.5 * weight
    return places, weights


PLACES, WEIGHTS = _gauss_rules()


@njit(**CALLED)
def add_energy(dofs, elements, r, series):
    """Add the energies of the step up to s = run.end [J]."""
    _look_inside(dofs, r)
    _powers_of_storeys(dofs, elements, r)
    for a in range(r.active):
        _work_on(elements[series[a].element], r, series[a])
    for i in range(r.n):
        el = elements[i]
        if el.smooth:
            _work_on(el, r, series[el.row])
        elif el.yields:  # the force is straight in the drift
            el.work += (0.5 * el.k * (el.v0 + el.v1) + el.f0) * (el.v1 - el.v0)


@njit(**PART)
def _look_inside(dofs, r):
    """Velocities of all degrees of freedom at the places of the rule."""
    count, points = r.order + 1, r.points
    for g in range(points):
        s, power = PLACES[points, g] * r.end, 1.0
        for k in range(count):
            r.powers[g, k] = power
            power *= s
    for i in range(r.n):
        d = dofs[i]
        for g in range(points):
            v = 0.0
            for k in range(count):
                v += d.w[k] * r.powers[g, k]
            d.inside[g] = v


@njit(**PART)
def _powers_of_storeys(dofs, elements, r):
    """Energy that the ground puts in, and what dashpots of storeys and mass-proportional damping take [J]."""
    q, duration, g1 = r.points, r.h * r.end, r.g1 * r.end
    drag = dashpots = pushed = 0.0
    for i in range(r.n):
        el, d = elements[i], dofs[i]
        below, foot = dofs[el.right].inside, dofs[d.foot].inside
        push = square = rates = 0.0
        for g in range(q):
            v = d.inside[g]
            rate = v - el.hold * below[g] + d.lean * foot[g]
            push += WEIGHTS[q, g] * (r.g0 + g1 * PLACES[q, g]) * v
            square += WEIGHTS[q, g] * v * v
            rates += WEIGHTS[q, g] * rate * rate
        pushed += d.mass * d.loaded * push
        drag += d.mass * d.drag * square
        dashpots += el.c * rates
    r.input -= pushed * duration
    r.drag += drag * duration
    r.dashpots += dashpots * duration


@njit(**PART)
def _work_on(el, r, s):
    """Work done on an element in the step [J]."""
    if not el.acts:
        return
    q, power = r.points, 0.0
    for g in range(q):
        f = rate = 0.0
        for k in range(r.order):
            f += s.f[k] * r.powers[g, k]
            rate += s.rate[k] * r.powers[g, k]
        power += WEIGHTS[q, g] * f * rate
    el.work += r.h * r.end * power
