"""Central difference with half-step velocities: explicit, second order, stable for dt below 2 / largest circular
frequency.

u' at t + dt/2 comes from u'' at t; the damping forces at t use the velocity extrapolated from the two half steps
before, so nothing is solved for. Contacts and yielding are seen only at the samples, where the method falls to first
order. Source: Newmark (1959) with beta = 0; Bathe, Finite Element Procedures (1996), section 9.2.1."""

from __future__ import annotations

import functools

from numba import njit

from pounding_cli.kernels.layout import INLINE, OPTIONS
from pounding_cli.kernels.simd import further
from pounding_cli.kernels.source import source_digest
from pounding_cli.kernels.stepping import STEP_DONE, begin_storeys, fill_forces, march, no_event


def memory_needed(size: int, foundations: int, links: int) -> int:
    """Doubles of the method's own scratch: whether a half step has been, and its velocities."""
    return 1 + size + foundations


@njit(**INLINE)
def _kick(count, half, h, kick, u, v, a, out_u, out_v):
    """Half-step velocities, displacements and extrapolated velocities of a step."""
    for i in range(count):
        before = half[i] if kick == h else v[i]
        half[i] = before + kick * a[i]
        out_u[i] = u[i] + h * half[i]
        out_v[i] = 1.5 * half[i] - 0.5 * before  # fault: central-difference-velocity


@njit(**INLINE)
def _advance(scene, p, out, own, tally, h, ground, slope, inelastic):
    size, count = scene.slots.size, scene.foundations.number
    kick = h if own[0] != 0.0 else 0.5 * h
    own[0] = 1.0
    half = further(own, 1)
    _kick(size, half, h, kick, p.u, p.v, p.a, out.u, out.v)
    _kick(count, further(half, size), h, kick, p.phi, p.phi_v, p.phi_a, out.phi, out.phi_v)
    begin_storeys(scene.slots, p, out, inelastic)
    fill_forces(scene, out, ground + h * slope, inelastic, False)
    return h, STEP_DONE


@functools.cache
def build(inelastic: bool):
    """The method for elastic or inelastic storeys, compiled on first use; arguments as `stepping.march`."""
    source = source_digest()

    @njit(**OPTIONS)
    def integrate(slots, foundations, links, state, peaks, memory, tally, starts, slopes, dt, parts, max_events):
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        return march(
            _advance, no_event, False, False, inelastic, slots, foundations, links, state, peaks, memory, tally, starts,
            slopes, dt, parts, max_events,
        )  # fmt: skip

    return integrate
