"""Central difference at a fixed time step, an independent check of the Taylor integrator."""

from __future__ import annotations

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.linear import central_difference_limit
from pounding_cli.solve.method import Integrator
from pounding_cli.solve.stepping import is_inelastic, march, sizes


def integrate(scene: Scene, arrays: Arrays, state, peaks, ledger, time_step: float, bounds):
    """Run at the largest step not above `time_step` [s] that divides the motion's; keeps no ledger."""
    from pounding_cli.kernels import central_difference as kernels

    own = np.zeros(kernels.memory_needed(*sizes(arrays)))
    return march(kernels.build(is_inelastic(scene)), own, scene, arrays, state, peaks, time_step, bounds)


CENTRAL_DIFFERENCE = Integrator(integrate, central_difference_limit)
