"""Accelerations of a scene in a given state, element by element (eqs (1)-(10)): what fixed-step methods call.

It shares nothing with the series of the Taylor integrator but the arrays and tables, so that the two can check each
other. Storeys change their branches at samples (`storey_law.follow`)."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.link_force import link_force
from pounding_cli.kernels.storey_law import follow, shear_on, stays
from pounding_cli.laws.program import MEMORIES


@njit(**INLINE)
def deformation(elements, e, u):
    """What element e acts on [m], from displacements; its rate from velocities."""
    v = elements.weight_one[e] * u[elements.one[e]] + elements.weight_other[e] * u[elements.other[e]]
    if elements.more != 0:
        for k in range(elements.first[e], elements.first[e + 1]):
            v += elements.weight[k] * u[elements.freedom[k]]
    return v


@njit(**INLINE)
def apply(elements, e, force, out):
    """Add what a force of element e does to its degrees of freedom."""
    out[elements.one[e]] -= elements.weight_one[e] * force
    out[elements.other[e]] -= elements.weight_other[e] * force
    if elements.more != 0:
        for k in range(elements.first[e], elements.first[e + 1]):
            out[elements.freedom[k]] -= elements.weight[k] * force


@njit(**INLINE)
def closing(elements, links, e, u):
    """Closing v of link e as its law takes it [m]."""
    return deformation(elements, elements.springs + e, u) - links.offset[e]


@njit(**INLINE)
def spring_force(slots, elements, storeys, e, d, rate, inelastic, drift, shear):
    """Force of element e before the links [N]; of a storey its drift and its shear without the dashpot are noted."""
    if e >= slots.size:
        return elements.stiffness[e] * d + elements.dashpot[e] * rate
    restoring = elements.stiffness[e] * d
    if inelastic and slots.branch[e] != t.NO_BRANCH:
        b, before = int(storeys.branch[e]), storeys.before[e]
        if not stays(slots, b, before, d, storeys.memory, e, slots.size):
            b = follow(slots, b, before, d, storeys.memory, MEMORIES, e, slots.size)
            storeys.branch[e] = b
        restoring = shear_on(slots, b, d, storeys.memory, e, slots.size)
    drift[e] = d
    shear[e] = restoring
    return restoring + elements.dashpot[e] * rate


@njit(**INLINE)
def accelerations(slots, elements, links, storeys, u, v, ground, inelastic, out, drift, shear, force):
    """Fill `out` with u'' [m/s2, rad/s2] by freedom, `drift` and `shear` (restoring force) by slot, and `force` by
    element [N].

    Changes the branches of `storeys` where they end: call it once a step with the states of that step, in order.
    """
    for i in range(elements.freedoms):
        out[i] = -elements.drag[i] * v[i]
    for e in range(elements.number):
        d, rate = deformation(elements, e, u), deformation(elements, e, v)
        if e < elements.springs:
            force[e] = spring_force(slots, elements, storeys, e, d, rate, inelastic, drift, shear)
        else:
            link = e - elements.springs
            force[e] = link_force(links, link, d - links.offset[link], rate)
        apply(elements, e, force[e], out)
    for i in range(elements.freedoms):
        out[i] = out[i] * elements.inverse_mass[i] - ground * elements.loaded[i]
