"""Implicit stepping with Newton iterations: the generalized-alpha family, of which Newmark and HHT-alpha are members.

In every step (1 - am) a1 + am a0 = (1 - af) f1 + af f0 with Newmark's u1 and v1, f the accelerations that the forces
cause. A dashpot makes the contact force jump when a link closes, so this equation need not have a root: Newton then
goes back and forth between open and closed. Such a step is cut in half, again and again; each cut is counted, and
after too many in a row the run ends. Source: Newmark (1959), J. Eng. Mech. Div. 85(3); Hilber, Hughes & Taylor
(1977), Earthquake Eng. Struct. Dyn. 5; Chung & Hulbert (1993), J. Appl. Mech. 60."""

from __future__ import annotations

import functools

import numpy as np
from numba import njit

from pounding_cli.kernels.cholesky import factorise, solve
from pounding_cli.kernels.forces import closing
from pounding_cli.kernels.law_table import LINEAR, NO_BRANCH
from pounding_cli.kernels.layout import INLINE, NOT_FINITE, OPTIONS
from pounding_cli.kernels.link_force import branch_at, stiffness_and_dashpot
from pounding_cli.kernels.simd import further
from pounding_cli.kernels.source import source_digest
from pounding_cli.kernels.stepping import (
    DIVERGED,
    EVENTS,
    ITERATIONS,
    STEP_CUT,
    STEP_DONE,
    begin_storeys,
    fill_forces,
    march,
    no_event,
)
from pounding_cli.kernels.storey_law import coefficient

NO_ROOT = 10
"""Outcome: a step had no root however short it was made."""

MAX_ITERATIONS = 25
CONVERGED = 1e-12
"""Largest change of a displacement in the last iteration, over the largest displacement."""


# The method's own scratch begins with its parameters beta, gamma, alpha_m, alpha_f, the most cuts in a row, the number
# of unknowns and the length of a whole step [s], which whoever calls fills in; then come the part of the step that is
# done and how often it is cut in half, both exact, and one more than the cuts the matrix was factored for. The rest is
# as in `_scratch`.
_BETA, _GAMMA, _ALPHA_M, _ALPHA_F, _MOST_CUTS, _UNKNOWNS, _STEP, _DONE, _LEVEL, _FACTORED = range(10)
PARAMETERS = _DONE


def memory_needed(slots, elements, unknowns: int) -> int:
    """Doubles of the method's own scratch."""
    return matrices_at(elements) + 2 * unknowns * unknowns + 2 * unknowns


def matrices_at(elements) -> int:
    """Where in it mass (N,) and damping (N N, row by row) stand, without links; whoever calls fills them in."""
    return 10 + 2 * elements.freedoms + 2 * elements.number


@njit(**INLINE)
def _tangents(scene, p, inelastic, tangent, dashpot):
    """Slopes [N/m] of all elements into `tangent`, dashpots of links [N s/m]; True if any differs from before.

    The slope of a dashpot constant is left out: it would cost the matrix its definiteness and gains
    nothing.
    """
    slots, elements, links = scene.slots, scene.elements, scene.links
    changed = False
    for e in range(elements.number):
        slope, damping = 0.0, 0.0
        if e < slots.size and inelastic and slots.branch[e] != NO_BRANCH:
            slope = coefficient(slots, int(p.storeys.branch[e]), LINEAR, p.storeys.memory, e, slots.size)
        elif e < elements.springs:
            slope = elements.stiffness[e]
        else:
            v = closing(elements, links, e - elements.springs, p.u)
            b = branch_at(links, e - elements.springs, v)
            if b >= 0:
                slope, damping = stiffness_and_dashpot(links, b, v)
        changed = changed or slope != tangent[e]
        tangent[e], dashpot[e] = slope, damping
    return changed


@njit(**INLINE)
def _term(elements, e, k):
    """(freedom, weight) of the k-th term of element e."""
    if k == 0:
        return elements.one[e], elements.weight_one[e]
    if k == 1:
        return elements.other[e], elements.weight_other[e]
    at = elements.first[e] + k - 2
    return elements.freedom[at], elements.weight[at]


@njit(**INLINE)
def _add_tangents(elements, matrix, unknowns, tangent, dashpot, share, rate_share):
    """Add elements to the lower half of the matrix of a Newton iteration."""
    for e in range(elements.number):
        stiff = share * tangent[e] + rate_share * dashpot[e]
        if stiff == 0.0:
            continue
        count = 2 + elements.first[e + 1] - elements.first[e]
        for k in range(count):
            one, weight_one = _term(elements, e, k)
            row = elements.unknown[one]
            for m in range(count):
                other, weight_other = _term(elements, e, m)
                column = elements.unknown[other]
                if column <= row:
                    matrix[row * unknowns + column] += stiff * weight_one * weight_other


@njit(**INLINE)
def _rates(scene, p, out, own, h, a0, a):
    """Accelerations and velocities of the point `out` from its displacements, by Newmark's formulas."""
    beta, gamma = own[_BETA], own[_GAMMA]
    for i in range(scene.elements.freedoms):
        last = p.a[i] + a0[i]
        a[i] = (out.u[i] - p.u[i] - h * p.v[i] - h * h * (0.5 - beta) * last) / (beta * h * h)
        out.v[i] = p.v[i] + h * ((1.0 - gamma) * last + gamma * a[i])


@njit(**INLINE)
def _lack(scene, p, out, own, a0, a, mass, right_side):
    """What lacks in the method's equation, as forces and moments with the sign of the correction."""
    alpha_m, alpha_f = own[_ALPHA_M], own[_ALPHA_F]
    share = 1.0 - alpha_f
    for i in range(scene.elements.freedoms):
        place = scene.elements.unknown[i]
        if place < 0:
            continue
        lack = (1.0 - alpha_m) * a[i] + alpha_m * (p.a[i] + a0[i]) - share * out.a[i] - alpha_f * p.a[i]
        right_side[place] = -mass[place] * lack


@njit(**INLINE)
def _try(scene, p, out, own, tally, h, ground, inelastic):
    """Newton's iterations towards the point h after p, whose ground acceleration is `ground`: 1 when they converge, 0
    when they do not, -1 when the matrix is not positive."""
    slots, elements = scene.slots, scene.elements
    unknowns, freedoms = int(own[_UNKNOWNS]), elements.freedoms
    beta, alpha_f = own[_BETA], own[_ALPHA_F]
    a0, a, tangent, dashpot, mass, damping, matrix, right_side = _scratch(own, elements)
    mass_share = (1.0 - own[_ALPHA_M]) / (beta * h * h)
    rate_share = (1.0 - alpha_f) * own[_GAMMA] / (beta * h)
    share = 1.0 - alpha_f
    for i in range(freedoms):
        out.u[i] = p.u[i] + h * p.v[i] + 0.5 * h * h * (p.a[i] + a0[i])
    for _iteration in range(MAX_ITERATIONS):
        tally[ITERATIONS] += 1
        _rates(scene, p, out, own, h, a0, a)
        begin_storeys(slots, p, out, inelastic)
        fill_forces(scene, out, ground, inelastic, False)
        changed = _tangents(scene, out, inelastic, tangent, dashpot)
        if changed or own[_FACTORED] != own[_LEVEL] + 1.0:
            for k in range(unknowns * unknowns):
                matrix[k] = rate_share * damping[k]
            for i in range(unknowns):
                matrix[i * unknowns + i] += mass_share * mass[i]
            _add_tangents(elements, matrix, unknowns, tangent, dashpot, share, rate_share)
            own[_FACTORED] = own[_LEVEL] + 1.0
            if not factorise(matrix, unknowns):
                return -1
        _lack(scene, p, out, own, a0, a, mass, right_side)
        solve(matrix, unknowns, right_side)
        largest = 0.0
        moved = 0.0
        for i in range(freedoms):
            largest = max(largest, abs(out.u[i]), abs(h * out.v[i]))
        for i in range(unknowns):
            moved = max(moved, abs(right_side[i]))
        if moved <= CONVERGED * largest:
            return 1
        for i in range(freedoms):
            if elements.unknown[i] >= 0:
                out.u[i] += right_side[elements.unknown[i]]
    return 0


@njit(**INLINE)
def _scratch(own, elements):
    """Places in the method's scratch: what the last step's accelerations have beyond the forces', this one's, tangents,
    the scene's matrices."""
    unknowns = int(own[_UNKNOWNS])
    a0 = further(own, 10)
    a = further(a0, elements.freedoms)
    tangent = further(a, elements.freedoms)
    dashpot = further(tangent, elements.number)
    mass = further(dashpot, elements.number)
    damping = further(mass, unknowns)
    matrix = further(damping, unknowns * unknowns)
    return a0, a, tangent, dashpot, mass, damping, matrix, further(matrix, unknowns * unknowns)


@njit(**INLINE)
def _advance(scene, p, out, own, tally, h, ground, slope, inelastic):
    a0, a, _, _, _, _, _, _ = _scratch(own, scene.elements)
    while True:
        fraction = 0.5 ** own[_LEVEL]
        taken = own[_STEP] * fraction
        found = _try(scene, p, out, own, tally, taken, ground + slope * taken, inelastic)
        if found == 1:
            break
        if found == -1 or not np.isfinite(out.u[0]) or abs(out.u[0]) > DIVERGED:
            return 0.0, NOT_FINITE
        tally[EVENTS] += 1
        own[_LEVEL] += 1.0
        if own[_LEVEL] > own[_MOST_CUTS]:
            return 0.0, NO_ROOT
    for i in range(scene.elements.freedoms):
        a0[i] = a[i] - out.a[i]
    own[_DONE] += fraction
    while own[_LEVEL] > 0.0 and own[_DONE] * 0.5 ** (1.0 - own[_LEVEL]) == np.floor(
        own[_DONE] * 0.5 ** (1.0 - own[_LEVEL])
    ):
        own[_LEVEL] -= 1.0
    if own[_DONE] < 1.0:
        return taken, STEP_CUT
    own[_DONE] = 0.0
    return taken, STEP_DONE


@functools.cache
def build(inelastic: bool):
    """The family for elastic or inelastic storeys, compiled on first use; arguments as `stepping.march`."""
    source = source_digest()

    @njit(**OPTIONS)
    def integrate(slots, elements, links, state, peaks, memory, tally, starts, slopes, dt, parts, max_events):
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        return march(
            _advance, no_event, False, False, inelastic, slots, elements, links, state, peaks, memory, tally, starts,
            slopes, dt, parts, max_events,
        )  # fmt: skip

    return integrate
