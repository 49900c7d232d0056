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


def memory_needed(slots, elements) -> int:
    """Doubles of the method's own scratch: whether a half step has been, and its velocities."""
    return 1 + elements.freedoms


@njit(**INLINE)
def _advance(scene, p, out, own, tally, h, ground, slope, inelastic):
    kick = h if own[0] != 0.0 else 0.5 * h
    own[0] = 1.0
    half = further(own, 1)
    for i in range(scene.elements.freedoms):
        before = half[i] if kick == h else p.v[i]
        half[i] = before + kick * p.a[i]
        out.u[i] = p.u[i] + h * half[i]
        out.v[i] = 1.5 * half[i] - 0.5 * before
    begin_storeys(scene.slots, p, out, inelastic)
    fill_forces(scene, out, ground + h * slope, inelastic, False)
    return h, STEP_DONE


@functools.cache
def build(inelastic: bool):
    """The method for elastic or inelastic storeys, compiled on first use; arguments as `stepping.march`."""
    source = source_digest()

    @njit(**OPTIONS)
    def integrate(slots, elements, links, state, peaks, memory, tally, starts, slopes, dt, parts, max_events):
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        return march(
            _advance, no_event, False, False, inelastic, slots, elements, links, state, peaks, memory, tally, starts,
            slopes, dt, parts, max_events,
        )  # fmt: skip

    return integrate
