"""Central difference at a fixed time step: the stranger beside the Taylor integrator (`kernels.central_difference`)."""

from __future__ import annotations

import math

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.ground import segments
from pounding_cli.solve.linear import central_difference_limit
from pounding_cli.solve.method import Integrator


def integrate(
    scene: Scene, arrays: Arrays, state, peaks, ledger, time_step: float, bounds
) -> tuple[int, int, int, int, float]:
    """Run the kernel with the largest step not above `time_step` [s] that divides the motion's; keeps no ledger."""
    from pounding_cli.kernels import central_difference

    starts, slopes, dt = segments(scene)
    parts = max(1, math.ceil(dt / time_step - 1e-9))
    room = np.zeros((9, arrays.padded + arrays.links.size + arrays.feet.number))
    touching = np.zeros(arrays.links.size, np.int64)
    kernel = central_difference.build(scene.analysis == "inelastic")
    return kernel(arrays.slots, arrays.feet, arrays.links, state, peaks, room, touching, starts, slopes, dt, parts)


CENTRAL_DIFFERENCE = Integrator(integrate, central_difference_limit)
