"""Central difference with half-step velocities: explicit, second order, stable for dt below 2 / largest circular
frequency.

u' at t + dt/2 comes from u'' at t; the damping forces at t use the velocity extrapolated from the two half steps
before, so nothing is solved for. Contacts and yielding are seen only at the samples, where the method falls to first
order. Source: Newmark (1959) with beta = 0; Bathe, Finite Element Procedures (1996), section 9.2.1."""

from __future__ import annotations

import functools

import numpy as np
from numba import njit

from pounding_cli.kernels.forces import accelerations
from pounding_cli.kernels.layout import (
    DONE,
    NOT_FINITE,
    OPTIONS,
    foot_pointers,
    link_pointers,
    peak_pointers,
    slot_pointers,
    state_pointers,
)
from pounding_cli.kernels.sampling import sample
from pounding_cli.kernels.simd import pointer
from pounding_cli.kernels.source import source_digest


@functools.cache
def build(inelastic: bool):
    """The method for elastic or inelastic storeys, compiled on first use."""
    source = source_digest()

    @njit(**OPTIONS)
    def integrate(
        slot_arrays,
        foot_arrays,
        link_arrays,
        state_arrays,
        peak_arrays,
        room,
        touching,
        starts,
        slopes,
        dt,
        parts,
    ):
        """March through all segments, each cut into `parts` steps; `room` holds 8 rows of slots, feet and links.

        Fills state and peaks in place; returns (status, steps, 0, 0, time reached [s]).
        """
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        slots, feet, links = (
            slot_pointers(slot_arrays),
            foot_pointers(foot_arrays),
            link_pointers(link_arrays),
        )
        state, peaks = state_pointers(state_arrays), peak_pointers(peak_arrays)
        size = slots.size
        count = feet.number
        acceleration, drift, shear, force = (
            pointer(room[0]),
            pointer(room[1]),
            pointer(room[2]),
            pointer(room[3]),
        )
        half, before, turn, turn_half = pointer(room[4]), pointer(room[5]), pointer(room[6]), pointer(room[7])
        turn_before = pointer(room[8])
        h = dt / parts
        for i in range(size):
            half[i] = state.v[i]
            before[i] = state.v[i]
        for f in range(count):
            turn_half[f] = state.phi_v[f]
            turn_before[f] = state.phi_v[f]
        steps = starts.size * parts
        for step in range(steps + 1):  # the last one only looks at where the others have led
            segment = min(step // parts, starts.size - 1)
            ground = starts[segment] + slopes[segment] * (step - segment * parts) * h
            accelerations(
                slots, feet, links, state.plastic, state.u, state.v, state.phi, state.phi_v, ground, inelastic,
                acceleration, turn, drift, shear, force,
            )  # fmt: skip
            sample(
                slots, feet, links, peaks, touching, state.u, state.phi, ground, acceleration, drift, shear, force,
                h if step < steps else 0.0,
            )  # fmt: skip
            if not np.isfinite(state.u[0]) or abs(state.u[0]) > 1e6:
                return NOT_FINITE, step, 0, 0, step * h
            if step == steps:
                break
            kick = h if step > 0 else 0.5 * h
            for i in range(size):
                before[i] = half[i]
                half[i] += kick * acceleration[i]
                state.u[i] += h * half[i]
                state.v[i] = 1.5 * half[i] - 0.5 * before[i]  # fault: central-difference-velocity
            for f in range(count):
                turn_before[f] = turn_half[f]
                turn_half[f] += kick * turn[f]
                state.phi[f] += h * turn_half[f]
                state.phi_v[f] = 1.5 * turn_half[f] - 0.5 * turn_before[f]
        return DONE, steps, 0, 0, starts.size * dt

    return integrate
