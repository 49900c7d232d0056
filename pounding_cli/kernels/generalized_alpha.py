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
from pounding_cli.kernels.forces import accelerations
from pounding_cli.kernels.layout import (
    DONE,
    INLINE,
    NOT_FINITE,
    OPTIONS,
    foot_pointers,
    link_pointers,
    peak_pointers,
    slot_pointers,
    state_pointers,
)
from pounding_cli.kernels.link_force import branch_at, closing_of, stiffness_and_dashpot
from pounding_cli.kernels.sampling import sample
from pounding_cli.kernels.simd import further, pointer
from pounding_cli.kernels.source import source_digest

NO_ROOT = 10
"""Outcome: a step had no root however short it was made."""

MOST_ITERATIONS = 25
CONVERGED = 1e-12
"""Largest change of a displacement in the last iteration, over the largest displacement."""


def room_needed(size: int, feet: int, links: int, unknowns: int) -> int:
    """Doubles of scratch that `integrate` needs."""
    return 14 * size + 12 * feet + 5 * links + 2 * unknowns * unknowns + 2 * unknowns


@njit(**INLINE)
def _tangents(slots, links, plastic, drift, u, inelastic, tangent, dashpot):
    """Slopes of storeys and links [N/m] into `tangent`, dashpots of links [N s/m]; True if any differs from before.

    The slope of a dashpot constant is left out: it would cost the matrix its definiteness and gains
    nothing.
    """
    changed = False
    size = slots.size
    for i in range(size):
        slope = slots.stiffness[i]
        if inelastic and abs(drift[i] - plastic[i]) >= slots.yield_drift[i] * (1.0 - 1e-12):
            slope *= slots.hardening[i]
        changed = changed or slope != tangent[i]
        tangent[i] = slope
    for e in range(links.number):
        v = closing_of(links, e, u)
        b = branch_at(links, e, v)
        slope = 0.0
        damping = 0.0
        if b >= 0:
            slope, damping = stiffness_and_dashpot(links, b, v)
        changed = changed or slope != tangent[size + e]
        tangent[size + e] = slope
        dashpot[e] = damping
    return changed


@njit(**INLINE)
def _add_tangents(slots, feet, links, matrix, n, unknowns, tangent, dashpot, share, rate_share):
    """Add storeys and links to the matrix of a Newton iteration."""
    size = slots.size
    for i in range(n):
        stiff = share * tangent[i]
        matrix[i * unknowns + i] += stiff
        if slots.couple[i] != 0.0:
            matrix[(i - 1) * unknowns + i - 1] += stiff
            matrix[i * unknowns + i - 1] -= stiff
        if slots.rise[i] != 0.0:
            for f in range(feet.number):
                if feet.first[f] <= i < feet.stop[f]:
                    row = (n + f) * unknowns
                    lean = stiff * slots.rise[i]
                    matrix[row + n + f] += lean * slots.rise[i]
                    matrix[row + i] -= lean
                    if slots.couple[i] != 0.0:
                        matrix[row + i - 1] += lean
    for e in range(links.number):
        stiff = share * tangent[size + e] + rate_share * dashpot[e]
        left = links.left[e]
        right = links.right[e]
        matrix[left * unknowns + left] += stiff
        matrix[right * unknowns + right] += stiff
        matrix[max(left, right) * unknowns + min(left, right)] -= stiff


@functools.cache
def build(inelastic: bool):
    """The family for elastic or inelastic storeys, compiled on first use."""
    source = source_digest()

    @njit(**OPTIONS)
    def integrate(
        slot_arrays, foot_arrays, link_arrays, state_arrays, peak_arrays, room, touching, mass, damping, starts, slopes,
        dt, parts, beta, gamma, alpha_m, alpha_f, most_cuts,
    ):  # fmt: skip
        """March through all segments, each cut into `parts` steps.

        `mass` (N,) and `damping` (N N, row by row) are the scene's without links; `room` is scratch
        (`room_needed`). Fills state and peaks in place; returns (status, steps, cuts, Newton iterations, time reached
        [s]).
        """
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        slots, feet, links = slot_pointers(slot_arrays), foot_pointers(foot_arrays), link_pointers(link_arrays)
        state, peaks = state_pointers(state_arrays), peak_pointers(peak_arrays)
        size = slots.size
        count = feet.number
        unknowns = mass.size
        n = unknowns - count
        place = pointer(room)
        drift, shear, force = place, further(place, size), further(place, 2 * size)
        place = further(force, size + links.size)
        u, v, a, pushed, pushed0, plastic = (
            place, further(place, size), further(place, 2 * size), further(place, 3 * size), further(place, 4 * size),
            further(place, 5 * size),
        )  # fmt: skip
        place = further(place, 6 * size)
        tangent, dashpot = place, further(place, size + links.size)
        place = further(dashpot, links.size)
        phi, phi_v, turn, turned, turned0, turn0 = (
            place, further(place, count), further(place, 2 * count), further(place, 3 * count),
            further(place, 4 * count), further(place, 5 * count),
        )  # fmt: skip
        a0 = further(place, 6 * count)
        matrix = further(a0, size)
        right_side = further(matrix, unknowns * unknowns)
        whole = dt / parts
        steps = 0
        cuts = 0
        iterations = 0
        accelerations(
            slots, feet, links, state.plastic, state.u, state.v, state.phi, state.phi_v, starts[0], inelastic, a0,
            turn0, drift, shear, force,
        )  # fmt: skip
        sample(slots, feet, links, peaks, touching, state.u, state.phi, starts[0], a0, drift, shear, force, 0.0)
        for i in range(size):
            pushed0[i] = a0[i]
        for f in range(count):
            turned0[f] = turn0[f]
        factored = -1
        for segment in range(starts.size):
            if segment > 0 and starts[segment] != starts[segment - 1] + dt * slopes[segment - 1]:
                # The ground jumps where a tail begins, and with it the accelerations.
                jump = starts[segment] - (starts[segment - 1] + dt * slopes[segment - 1])
                for i in range(size):
                    a0[i] -= jump * slots.real[i]
                    pushed0[i] -= jump * slots.real[i]
            for part in range(parts):
                level = 0
                reached = 0.0  # of this step, in exact binary fractions
                while reached < 1.0:
                    fraction = 0.5**level
                    h = whole * fraction
                    ground = starts[segment] + slopes[segment] * whole * (part + reached + fraction)
                    mass_share = (1.0 - alpha_m) / (beta * h * h)
                    rate_share = (1.0 - alpha_f) * gamma / (beta * h)
                    share = 1.0 - alpha_f
                    for i in range(size):
                        u[i] = state.u[i] + h * state.v[i] + 0.5 * h * h * a0[i]
                    for f in range(count):
                        phi[f] = state.phi[f] + h * state.phi_v[f] + 0.5 * h * h * turn0[f]
                    converged = False
                    for _iteration in range(MOST_ITERATIONS):
                        iterations += 1
                        for i in range(size):
                            gone = u[i] - state.u[i] - h * state.v[i] - h * h * (0.5 - beta) * a0[i]
                            a[i] = gone / (beta * h * h)
                            v[i] = state.v[i] + h * ((1.0 - gamma) * a0[i] + gamma * a[i])
                            plastic[i] = state.plastic[i]
                        for f in range(count):
                            gone = phi[f] - state.phi[f] - h * state.phi_v[f] - h * h * (0.5 - beta) * turn0[f]
                            turn[f] = gone / (beta * h * h)
                            phi_v[f] = state.phi_v[f] + h * ((1.0 - gamma) * turn0[f] + gamma * turn[f])
                        accelerations(
                            slots, feet, links, plastic, u, v, phi, phi_v, ground, inelastic, pushed, turned, drift,
                            shear, force,
                        )  # fmt: skip
                        changed = _tangents(slots, links, plastic, drift, u, inelastic, tangent, dashpot)
                        if changed or factored != level:
                            for k in range(unknowns * unknowns):
                                matrix[k] = rate_share * damping[k]
                            for i in range(unknowns):
                                matrix[i * unknowns + i] += mass_share * mass[i]
                            for f in range(count):
                                matrix[(n + f) * (unknowns + 1)] += share * feet.stiffness[f]
                            _add_tangents(
                                slots, feet, links, matrix, n, unknowns, tangent, dashpot, share, rate_share
                            )  # fmt: skip
                            factored = level
                            if not factorise(matrix, unknowns):
                                return NOT_FINITE, steps, cuts, iterations, segment * dt
                        for i in range(n):
                            lack = (1.0 - alpha_m) * a[i] + alpha_m * a0[i] - share * pushed[i] - alpha_f * pushed0[i]
                            right_side[i] = -mass[i] * lack
                        for f in range(count):
                            lack = (1.0 - alpha_m) * turn[f] + alpha_m * turn0[f]
                            lack -= share * turned[f] + alpha_f * turned0[f]
                            right_side[n + f] = -mass[n + f] * lack
                        solve(matrix, unknowns, right_side)
                        largest = 0.0
                        moved = 0.0
                        for i in range(n):
                            largest = max(largest, abs(u[i]), abs(h * v[i]))
                            moved = max(moved, abs(right_side[i]))
                        if moved <= CONVERGED * largest:
                            converged = True
                            break
                        for i in range(n):
                            u[i] += right_side[i]
                        for f in range(count):
                            phi[f] += right_side[n + f]
                    if not converged:
                        if not np.isfinite(u[0]) or abs(u[0]) > 1e6:
                            return NOT_FINITE, steps, cuts, iterations, segment * dt
                        cuts += 1
                        level += 1
                        if level > most_cuts:
                            return NO_ROOT, steps, cuts, iterations, segment * dt + part * whole
                        continue
                    steps += 1
                    for i in range(size):
                        state.u[i] = u[i]
                        state.v[i] = v[i]
                        state.plastic[i] = plastic[i]
                        a0[i] = a[i]
                        pushed0[i] = pushed[i]
                    for f in range(count):
                        state.phi[f] = phi[f]
                        state.phi_v[f] = phi_v[f]
                        turn0[f] = turn[f]
                        turned0[f] = turned[f]
                    sample(slots, feet, links, peaks, touching, u, phi, ground, pushed, drift, shear, force, h)
                    reached += fraction
                    while level > 0 and reached * 0.5 ** (1 - level) == np.floor(reached * 0.5 ** (1 - level)):
                        level -= 1
        return DONE, steps, cuts, iterations, starts.size * dt

    return integrate
