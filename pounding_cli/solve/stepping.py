"""Fixed-step methods on a scene: arrays and scratch for the driver of `kernels.stepping`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pounding_cli.kernels.layout import Elements, Slots
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.elements import elements_of
from pounding_cli.solve.ground import segments
from pounding_cli.solve.method import Integrator, any_step, steps_a_sample


def march(
    kernel: Callable[..., tuple[int, int, int, int, float]],
    own: np.ndarray,
    scene: Scene,
    arrays: Arrays,
    state,
    peaks,
    time_step: float,
    bounds: tuple[int, int],
) -> tuple[int, int, int, int, float]:
    """Run a kernel made of `kernels.stepping.march` with the largest step not above `time_step` [s] that divides the
    motion's.

    Parameters
    ----------
    kernel : for the scene's analysis
    own : the method's own scratch as it begins

    Returns
    -------
    (status, steps, events, iterations, time reached [s]), with state and peaks filled; there is no ledger
    """
    from pounding_cli.kernels.stepping import POLYNOMIAL_SIZE, point_size

    starts, slopes, dt = segments(scene)
    parts = steps_a_sample(scene, time_step)
    elements = elements_of(arrays)
    points = 2 * point_size.py_func(arrays.slots, elements) + POLYNOMIAL_SIZE
    memory, tally = np.concatenate((np.zeros(points), own)), np.zeros(2, np.int64)
    return kernel(
        arrays.slots, elements, arrays.links, state, peaks, memory, tally, starts, slopes, dt, parts,
        bounds[1],
    )  # fmt: skip


def sizes(arrays: Arrays) -> tuple[Slots, Elements]:
    """What the scratch of kernels is counted by."""
    return arrays.slots, elements_of(arrays)


def is_inelastic(scene: Scene) -> bool:
    """Whether storeys may yield."""
    return scene.analysis == Analysis.INELASTIC


def fixed_steps(
    advance: Callable[..., tuple[float, int]],
    own: Callable[[Arrays], int] = lambda arrays: 0,
    largest_step: Callable[[Arrays], float] = any_step,
) -> Integrator:
    """The code of a method of one's own (docs/extending.md).

    Parameters
    ----------
    advance : its step, a function compiled with `kernels.layout.INLINE`; arguments as `kernels.stepping` says
    own : doubles of scratch that it needs for a scene
    largest_step : its stability limit [s]
    """

    def integrate(scene: Scene, arrays: Arrays, state, peaks, ledger, time_step: float, bounds):
        from pounding_cli.kernels.stepping import build

        kernel = build(advance, is_inelastic(scene))
        return march(kernel, np.zeros(own(arrays)), scene, arrays, state, peaks, time_step, bounds)

    return Integrator(integrate, largest_step)
