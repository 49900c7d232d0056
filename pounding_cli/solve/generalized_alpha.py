"""Newmark, HHT-alpha and generalized-alpha: implicit, with numerical damping of what no step resolves
(`kernels.generalized_alpha`)."""

from __future__ import annotations

import functools

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.elements import elements_of
from pounding_cli.solve.linear import matrices
from pounding_cli.solve.method import NO_ROOT, Integrator, steps_a_sample
from pounding_cli.solve.stepping import is_inelastic, march, sizes

ALPHA = 0.1
"""Share of the old forces in HHT-alpha [-]; 0 is Newmark's average acceleration, 1/3 the most."""

RADIUS = 0.9
"""Spectral radius of generalized-alpha at infinite frequency [-]; 1 dissipates nothing."""

MAX_CUTS = 14
"""Times in a row that a step without a root is cut in half before the run ends."""


def family(alpha_m: float, alpha_f: float) -> tuple[float, float, float, float]:
    """(beta, gamma, alpha_m, alpha_f) of second order with the most dissipation at high frequencies (Chung & Hulbert
    1993, eqs 17 and 20)."""
    gamma = 0.5 - alpha_m + alpha_f
    return 0.25 * (1 - alpha_m + alpha_f) ** 2, gamma, alpha_m, alpha_f


def _integrate(parameters, scene: Scene, arrays: Arrays, state, peaks, ledger, time_step: float, bounds):
    """Run a member of the family at the largest step not above `time_step` [s] that divides the motion's."""
    from pounding_cli.kernels import generalized_alpha as kernels

    system = matrices(arrays)
    unknowns = system.mass.size
    own = np.zeros(kernels.memory_needed(*sizes(arrays), unknowns))
    step = scene.motion.dt / steps_a_sample(scene, time_step)
    own[: kernels.PARAMETERS] = *parameters, MAX_CUTS, unknowns, step
    own[kernels.matrices_at(elements_of(arrays)) :][: unknowns + unknowns**2] = *system.mass, *system.damping.ravel()
    kernel = kernels.build(is_inelastic(scene))
    status, *counts = march(kernel, own, scene, arrays, state, peaks, time_step, bounds)
    return (NO_ROOT if status == kernels.NO_ROOT else status, *counts)


def without_root(steps: int, cuts: int) -> str:
    """What the user should know about steps that Newton could not take whole."""
    if not cuts:
        return ""
    return f"Newton found no root in {cuts} of {steps} steps, because a contact force jumps; these were cut in half"


NEWMARK = Integrator(functools.partial(_integrate, family(0.0, 0.0)), note=without_root)
HHT_ALPHA = Integrator(functools.partial(_integrate, family(0.0, ALPHA)), note=without_root)
GENERALIZED_ALPHA = Integrator(
    functools.partial(_integrate, family((2 * RADIUS - 1) / (RADIUS + 1), RADIUS / (RADIUS + 1))), note=without_root
)
