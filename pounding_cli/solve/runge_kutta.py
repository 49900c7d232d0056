"""Classical Runge-Kutta of fourth order at a fixed time step, with and without event location
(`kernels.runge_kutta`)."""

from __future__ import annotations

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.ground import segments
from pounding_cli.solve.linear import runge_kutta_limit
from pounding_cli.solve.method import Integrator, steps_a_sample


def _integrate(scene: Scene, arrays: Arrays, state, peaks, time_step: float, bounds, located: bool):
    from pounding_cli.kernels import runge_kutta

    starts, slopes, dt = segments(scene)
    parts = steps_a_sample(scene, time_step)
    room = np.zeros(runge_kutta.room_needed(arrays.padded, arrays.feet.number, arrays.links.size))
    kernel = runge_kutta.build(scene.analysis == "inelastic", located)
    return kernel(
        arrays.slots, arrays.feet, arrays.links, state, peaks, room, starts, slopes, dt, parts, bounds[1]
    )  # fmt: skip


def integrate_with_events(scene: Scene, arrays: Arrays, state, peaks, ledger, time_step: float, bounds):
    """Run with event location, at the largest step not above `time_step` [s] that divides the motion's."""
    return _integrate(scene, arrays, state, peaks, time_step, bounds, True)


def integrate(scene: Scene, arrays: Arrays, state, peaks, ledger, time_step: float, bounds):
    """Run without event location, at the largest step not above `time_step` [s] that divides the motion's."""
    return _integrate(scene, arrays, state, peaks, time_step, bounds, False)


RUNGE_KUTTA = Integrator(integrate, runge_kutta_limit)
RUNGE_KUTTA_EVENTS = Integrator(integrate_with_events, runge_kutta_limit)
