"""Bases that a slider holds: the force that would move them, and their degrees of freedom while they are held.

A held base moves as the ground does: its velocity is zero and so is its inverse mass, which keeps every order of its
motion zero. The slider takes the force of all that acts on the base, which is known once the series of a step are."""

from __future__ import annotations

from numba import njit

from pounding_cli.solver.options import CALLED, INVERSE, PART
from pounding_cli.solver.polynomial import evaluate


@njit(**PART)
def hold_or_release(dof, el):
    """Hold the degree of freedom above a slider that sticks, and release it where it slides."""
    if el.holds:
        dof.w[0] = 0.0
        dof.inv_mass = 0.0
    elif el.slides:
        dof.inv_mass = 1.0 / dof.mass


@njit(**CALLED)
def find_drive(dofs, elements, terms, run, series, i):
    """Find the polynomial of the force that would move the held degree of freedom i [N], positive to the right.

    It is without the friction below, and goes to the forces of its row of `series`.
    """
    dof = dofs[i]
    el = elements[i]
    f = series[el.row].f
    count = run.order
    for k in range(count):
        f[k] = 0.0
    f[0] = -dof.mass * dof.loaded * run.g0 - el.k * el.v0
    f[1] = -dof.mass * dof.loaded * run.g1
    for a in range(run.active):
        row = series[a]
        link = elements[row.element]
        weight = (1.0 if link.left == i else 0.0) - (1.0 if link.right == i else 0.0)
        for x in range(link.first, link.last):
            if terms[x].dof == i:
                weight += terms[x].weight
        if link.acts and weight != 0.0:
            dashpot = link.c if link.drifts else 0.0  # forces of lines are kept without
            for k in range(count):
                f[k] -= weight * (row.f[k] + dashpot * row.rate[k])
    if i + 1 < run.n and dofs[i + 1].below != 0.0:
        _add_storey_above(dofs, elements, terms, run, series, i + 1, f)


@njit(**PART)
def _add_storey_above(dofs, elements, terms, run, series, j, f):
    """Add the pull of the storey j that stands on a held base, which does not move, to the polynomial f."""
    dof = dofs[j]
    el = elements[j]
    w = dof.w
    foot = dofs[dof.foot].w
    smooth = series[el.row].f
    f[0] += (0.0 if el.smooth else el.k * el.v0 + el.f0) - el.load * (dof.u0 - dofs[j - 1].u0)
    mate = dofs[el.mate]
    mate_below = dofs[elements[el.mate].right]
    if el.twists:
        f[0] += el.coupled_k * elements[el.mate].v0
    for k in range(run.order):
        rate = w[k] + dof.lean * foot[k]
        f[k] += el.c * rate
        if el.twists:
            f[k] += el.coupled_c * (mate.w[k] - mate.below * mate_below.w[k])
            if k > 0:
                turned = mate.w[k - 1] - mate.below * mate_below.w[k - 1]
                f[k] += run.h * INVERSE[k] * el.coupled_k * turned
        if el.smooth:
            f[k] += smooth[k]
        if k > 0:
            moved = w[k - 1]
            leaned = dof.lean * foot[k - 1]
            f[k] += run.h * INVERSE[k] * ((0.0 if el.smooth else el.k) * (moved + leaned) - el.load * moved)


@njit(**CALLED)
def keep_held_forces(elements, run, series):
    """Keep the forces of sliders that stick at the end of the step, without that of their surface."""
    for i in range(run.n):
        el = elements[i]
        if el.holds:
            el.f1 = evaluate(series[el.row].f, run.order - 1, run.end)
