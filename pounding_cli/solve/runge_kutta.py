"""Classical Runge-Kutta of fourth order at a fixed time step, with and without event location
(`kernels.runge_kutta`)."""

from __future__ import annotations

import functools

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.linear import runge_kutta_limit
from pounding_cli.solve.method import Integrator
from pounding_cli.solve.stepping import is_inelastic, march, sizes


def _integrate(located: bool, scene: Scene, arrays: Arrays, state, peaks, ledger, time_step: float, bounds):
    """Run at the largest step not above `time_step` [s] that divides the motion's, with event location or without."""
    from pounding_cli.kernels import runge_kutta as kernels

    own = np.zeros(kernels.memory_needed(*sizes(arrays)))
    return march(kernels.build(is_inelastic(scene), located), own, scene, arrays, state, peaks, time_step, bounds)


RUNGE_KUTTA = Integrator(functools.partial(_integrate, False), runge_kutta_limit)
RUNGE_KUTTA_EVENTS = Integrator(functools.partial(_integrate, True), runge_kutta_limit)
