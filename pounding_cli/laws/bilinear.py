"""A storey that is elastic up to its yield shear and then hardens kinematically (bilinear; paper, section 2)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pounding_cli.laws.guards import HIGH, INSIDE, START
from pounding_cli.laws.law import Behaviour, set_line
from pounding_cli.laws.storey import StoreyLaw, energy_in_two_springs

_K, _LIMIT, _A = range(3)
"""Parameters: stiffness [N/m], yield drift [m], post-yield over initial stiffness [-]."""

_PLASTIC = 0
"""History variable: plastic drift of the last unloading [m]."""

_LOWER = -1
"""Branch of the lower yield line."""

_ELASTIC = 0
"""Branch between the yield lines."""

_UPPER = 1
"""Branch of the upper yield line."""


def next_bilinear_branch(e: Any, guard: int) -> None:
    """From the elastic line to a yield line, and back where the drift turns."""
    k = e.p[_K]
    limit = e.p[_LIMIT]
    a = e.p[_A]
    if e.branch == _ELASTIC and guard != START:
        e.branch = _UPPER if guard == HIGH else _LOWER
        set_line(e, a * k, e.c, e.branch * (1.0 - a) * k * limit, -math.inf, math.inf, e.branch)
        return
    if guard != START:  # the drift turns
        e.h[_PLASTIC] = e.v1 - e.branch * (limit - INSIDE * (limit + abs(e.v1)))
    e.branch = _ELASTIC
    set_line(e, k, e.c, -(1.0 - a) * k * e.h[_PLASTIC], e.h[_PLASTIC] - limit, e.h[_PLASTIC] + limit)


BILINEAR = Behaviour(next_bilinear_branch)


@dataclass(frozen=True)
class Bilinear(StoreyLaw):
    """F = k D - (1 - a) k Dp between the yield lines, a k D +- (1 - a) Vy on them, with the plastic drift Dp.

    This is a spring a k beside a spring (1 - a) k that slides at its yield force: kinematic hardening.
    """

    name = "bilinear"
    example = "{storeys: 5, period: 0.6 s, hardening: 0.05}"
    citation = (("spiliopoulos1996", "bilinear storeys, section 2"),)
    behaviour = BILINEAR

    def stored_energy(self, drift: Any, shear: Any) -> Any:
        """In two springs, one of which yields."""
        return energy_in_two_springs(self, drift, shear)
