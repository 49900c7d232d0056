"""Accelerations of a scene in a given state, evaluated directly from eqs (1)-(10): what fixed-step methods call.

It shares nothing with the series of the Taylor integrator but the arrays, so that the two can check each other.
Storeys change their branches at samples (`storey_law.follow`)."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.link_force import closing_of, link_force
from pounding_cli.kernels.storey_law import follow, shear_on
from pounding_cli.laws.program import MEMORIES


@njit(**INLINE)
def accelerations(
    slots, foundations, links, storeys, u, v, phi, phi_v, ground, inelastic, out, out_phi, drift, shear, force
):
    """Fill `out` with u'' [m/s2], `out_phi` with phi'' [rad/s2], `drift`, `shear` (restoring force) and link `force`.

    Changes the branches of `storeys` where they end: call it once a step with the states of that step, in order.
    """
    size = slots.size
    for i in range(size):
        out[i] = 0.0
        turned = 0.0
        turned_v = 0.0
        if slots.rise[i] != 0.0:
            for f in range(foundations.number):
                if foundations.first[f] <= i < foundations.stop[f]:
                    turned = slots.rise[i] * phi[f]
                    turned_v = slots.rise[i] * phi_v[f]
        below = u[i - 1] if slots.couple[i] != 0.0 else 0.0
        below_v = v[i - 1] if slots.couple[i] != 0.0 else 0.0
        d = u[i] - below - turned
        drift[i] = d
        restoring = slots.stiffness[i] * d
        if inelastic and slots.branch[i] != t.NO_BRANCH:
            b = follow(slots, int(storeys.branch[i]), storeys.before[i], d, storeys.memory, MEMORIES, i, size)
            storeys.branch[i] = b
            restoring = shear_on(slots, b, d, storeys.memory, i, size)
        shear[i] = restoring
        force[i] = restoring + slots.dashpot[i] * (v[i] - below_v - turned_v)
    for i in range(size):
        out[i] -= force[i]
        if slots.couple[i] != 0.0:
            out[i - 1] += force[i]
        out[i] -= slots.alpha[i] * slots.mass[i] * v[i]
    for f in range(foundations.number):
        base = foundations.base[f]
        sway = v[base] if base >= 0 else 0.0
        moment = -foundations.stiffness[f] * phi[f] - foundations.dashpot[f] * phi_v[f]
        for i in range(foundations.first[f], foundations.stop[f]):
            arm = slots.elevation[i]
            drag = foundations.alpha[f] * slots.mass[i] * (v[i] - sway - arm * phi_v[f])
            out[i] -= drag
            if base >= 0:
                out[base] += drag
            moment += drag * arm + force[i] * slots.rise[i]
        out_phi[f] = moment / foundations.inertia[f]
    for e in range(links.number):
        left = links.left[e]
        right = links.right[e]
        pushing = link_force(links, e, closing_of(links, e, u), v[left] - v[right])
        force[size + e] = pushing
        out[left] -= pushing
        out[right] += pushing
    for i in range(size):
        out[i] = out[i] * slots.inverse_mass[i] - ground * slots.real[i]
