"""Scale factors that bring a motion to a wanted intensity."""

from __future__ import annotations

import math

from pounding_cli.errors import InputError, Problem
from pounding_cli.records.intensity import arias
from pounding_cli.records.motion import Motion


def arias_factor(motion: Motion, target: Motion | float) -> float:
    """Factor [-] after which `motion` has the Arias intensity of `target` (a motion, or a value in m/s).

    Both are taken as they are: cut them to their windows first.  I_A grows with the factor squared.  The rule
    behind the last column of the paper's Table 1.  Raises InputError for a motion at rest or a target <= 0.
    """
    wanted = arias(target) if isinstance(target, Motion) else float(target)
    return math.sqrt(_positive(wanted, "Arias intensity to reach", "m/s") / _measured(motion, arias(motion)))


def pga_factor(motion: Motion, pga: float) -> float:
    """Factor [-] after which the peak ground acceleration is `pga` [m/s2].

    Raises InputError for a motion at rest or a peak that is not positive.
    """
    return _positive(pga, "peak ground acceleration to reach", "m/s2") / _measured(motion, motion.pga)


def _positive(value: float, what: str, unit: str) -> float:
    if not (math.isfinite(value) and value > 0):
        raise InputError(Problem(f"the {what} is {value:g} {unit}", "give a value above 0"))
    return value


def _measured(motion: Motion, value: float) -> float:
    if value <= 0:
        raise InputError(
            Problem(
                f"motion '{motion.name}' is at rest: every sample in its window is zero",
                "lengthen the window",
            )
        )
    return value
