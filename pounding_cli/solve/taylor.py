"""The default method: the event-located Taylor integrator of `kernels.taylor`."""

from __future__ import annotations

import math

from pounding_cli.kernels import layout
from pounding_cli.model.effects import effects_of
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays, aligned
from pounding_cli.solve.ground import segments

SAFETY = 10.0
"""Local tolerance (relative, of acceleration) over the accuracy asked: errors come out two to three decades below the local tolerance
(tests/verification/test_accuracy.py)."""


def variant(scene: Scene) -> tuple[bool, bool, int]:
    """Which effects the compiled kernel must contain: (storeys yield, foundations, link laws)."""
    effects = effects_of(scene)
    laws = (
        layout.LINKS_CUBIC
        if effects.infill
        else layout.LINKS_LINEAR
        if effects.contact
        else layout.LINKS_NONE
    )
    return effects.yielding, effects.foundations, laws


def most_order(tolerance: float) -> int:
    """Highest order worth computing before the step is cut: near the optimum of Jorba & Zou, -ln(tol) / 2 + 1, and above it,
    because most steps end at a record sample."""
    return min(30, max(10, int(math.ceil(-0.75 * math.log(tolerance))) + 4))


def integrate(
    scene: Scene, arrays: Arrays, state, peaks, accuracy: float, bounds: tuple[int, int]
) -> tuple[int, int, int, int, float]:
    """Run the kernel; see `kernels.taylor.build`."""
    from pounding_cli.kernels import taylor

    starts, slopes, dt = segments(scene)
    tolerance = max(accuracy * SAFETY, 1e-16)
    room = aligned(taylor.room_needed(arrays.padded, arrays.feet.number, arrays.links.size))
    kernel = taylor.build(*variant(scene))
    return kernel(
        arrays.slots, arrays.feet, arrays.links, state, peaks, room, starts, slopes, dt, tolerance, scene.motion.pga,
        most_order(tolerance), *bounds,
    )  # fmt: skip
