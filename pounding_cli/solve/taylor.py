"""The default method: the event-located Taylor integrator of `kernels.taylor`."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np

from pounding_cli.kernels import layout
from pounding_cli.kernels.ledger import MOST_POINTS
from pounding_cli.model.effects import effects_of
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays, aligned, drift_of
from pounding_cli.solve.ground import segments

SAFETY = 0.2
"""Local tolerance (relative, of acceleration) over the accuracy asked. Ordinary scenes come out hundreds of times
better than asked; this is for the hard ones, where thousands of contacts hand errors on (tests/hard)."""


QUIET = 1e-3
"""Part of the ground's peak below which accelerations are not resolved: isolated floors may feel as little."""


COARSEST = 1e-4
"""No series is cut shorter than this, whatever is asked: events would be found where there are none, to save little."""


Variant = tuple[bool, bool, int]
EVERYTHING: Variant = (True, True, layout.LINKS_CUBIC)
"""The kernel with every effect there is."""


def variant(scene: Scene) -> Variant:
    """Which effects the compiled kernel must contain: (storeys yield, foundations, link laws)."""
    effects = effects_of(scene)
    laws = layout.LINKS_CUBIC if effects.infill else layout.LINKS_LINEAR if effects.contact else layout.LINKS_NONE
    return effects.yielding, effects.foundations, laws


@functools.cache
def gauss_rules(most: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on [0, 1] of all rules up to `most` points, one after the other."""
    rules = [np.polynomial.legendre.leggauss(n) for n in range(1, most + 1)]
    return np.concatenate([(x + 1) / 2 for x, _ in rules]), np.concatenate([w / 2 for _, w in rules])


def most_order(tolerance: float) -> int:
    """Highest order worth computing before the step is cut: near the optimum of Jorba & Zou, -ln(tol) / 2 + 1, and
    above it, because most steps end at a record sample."""
    return min(30, max(10, math.ceil(-0.75 * math.log(tolerance)) + 4))


def quiet_acceleration(scene: Scene, arrays: Arrays, state) -> float:
    """Acceleration [m/s2] below which nothing is resolved: a part of the ground's peak, or on still ground that of
    the start.

    The start's is the largest spring force per mass, or what would turn its largest velocity within a second.
    """
    if scene.motion.pga > 0:
        return QUIET * scene.motion.pga
    pulls = arrays.slots.stiffness * np.abs(drift_of(arrays, state)) * arrays.slots.inverse_mass
    return max(float(pulls.max()), float(np.abs(state.v).max()))


def prepare(
    scene: Scene, arrays: Arrays, state, accuracy: float, bounds: tuple[int, int], kernel_of: Variant | None = None
) -> Callable[..., tuple[int, int, int, int, float]]:
    """The kernel for a scene that starts from `state`: a function of (state, peaks, ledger, starts, slopes, dt), the
    last three as in `ground.segments`. Called again it goes on from the state it left; see `kernels.taylor.build`.
    The kernel contains what the scene needs, or what `kernel_of` says."""
    from pounding_cli.kernels import taylor

    tolerance = min(max(accuracy * SAFETY, 1e-16), COARSEST)
    room = aligned(taylor.room_needed(arrays.padded, arrays.feet.number, arrays.links.size))
    kernel, rules = taylor.build(*(kernel_of or variant(scene))), gauss_rules(MOST_POINTS)
    settings = tolerance, quiet_acceleration(scene, arrays, state), most_order(tolerance), *bounds

    def run(state, peaks, ledger, starts: np.ndarray, slopes: np.ndarray, dt: float):
        room.fill(0.0)
        return kernel(
            arrays.slots, arrays.feet, arrays.links, state, peaks, ledger, *rules, room, starts, slopes, dt, *settings
        )

    return run


def integrate(
    scene: Scene, arrays: Arrays, state, peaks, ledger, accuracy: float, bounds: tuple[int, int]
) -> tuple[int, int, int, int, float]:
    """Run the kernel over the whole motion and its tail."""
    return prepare(scene, arrays, state, accuracy, bounds)(state, peaks, ledger, *segments(scene))


def integrate_everything(
    scene: Scene, arrays: Arrays, state, peaks, ledger, accuracy: float, bounds: tuple[int, int]
) -> tuple[int, int, int, int, float]:
    """The same with the kernel that contains every effect, whether or not the scene calls for it."""
    return prepare(scene, arrays, state, accuracy, bounds, EVERYTHING)(state, peaks, ledger, *segments(scene))
