"""A storey that softens as it is cycled: after an unloading it reloads towards the largest drift so far on the other
side (Clough; stiffness-degrading or peak-oriented)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from pounding_cli.laws.guards import HIGH, LOW, START
from pounding_cli.laws.law import Behaviour, line
from pounding_cli.laws.storey import StoreyLaw

K, LIMIT, A = range(3)
"""Parameters: stiffness [N/m], yield drift [m], post-yield over initial stiffness [-]."""

LARGEST, SMALLEST, SLOPE, OFFSET, TURNED, UNLOADING = range(6)
"""History variables: largest and smallest drift so far [m], the yield drifts at first; stiffness [N/m] and offset [N]
of the present reloading line; drift at which it last turned back [m]; offset of the present unloading line [N]."""

ELASTIC, BACKBONE, RELOADING, FROM_BACKBONE, FROM_RELOADING = range(5)
"""Branches; up is positive, down negative."""


def next_branch(e: Any, guard: int) -> None:
    """Elastic; then on either side the backbone, unloading from it, reloading, and unloading from that."""
    k, limit = e.p[K], e.p[LIMIT]
    if guard == START:
        e.h[LARGEST], e.h[SMALLEST] = limit, -limit
        e.branch = ELASTIC
        line(e, k, e.c, 0.0, -limit, limit)
        return
    side = 1 if e.branch > 0 or (e.branch == ELASTIC and guard == HIGH) else -1
    was = abs(e.branch)
    outward = guard == (HIGH if side > 0 else LOW)
    if was == ELASTIC or (outward and (was == RELOADING or was == FROM_BACKBONE)):
        _load(e, side * BACKBONE)
    elif outward:  # back on the reloading line
        _load(e, side * RELOADING)
    elif was == BACKBONE or was == RELOADING:
        _turn_back(e, side, was)
    else:  # the shear has come to zero: reload on the other side
        _aim(e, -side)
        _load(e, -side * RELOADING)


def _load(e: Any, branch: int) -> None:
    """On the backbone or on a reloading line, until the drift turns back or reaches the largest so far."""
    k, limit, a = e.p[K], e.p[LIMIT], e.p[A]
    side = 1 if branch > 0 else -1
    e.branch = branch
    if abs(branch) == BACKBONE:
        line(e, a * k, e.c, side * (1.0 - a) * k * limit, -math.inf, math.inf)
    elif side > 0:
        line(e, e.h[SLOPE], e.c, e.h[OFFSET], -math.inf, e.h[LARGEST])
    else:
        line(e, e.h[SLOPE], e.c, e.h[OFFSET], e.h[SMALLEST], math.inf)
    if side > 0:
        e.slow = 0.0
    else:
        e.fast = 0.0


def _turn_back(e: Any, side: int, was: int) -> None:
    """Unload with the initial stiffness, until the shear is zero or the drift is back where it turned."""
    k = e.p[K]
    e.h[UNLOADING] = (e.k - k) * e.v1 + e.f0
    e.h[TURNED] = e.v1
    if was == BACKBONE and side > 0:
        e.h[LARGEST] = e.v1
    elif was == BACKBONE:
        e.h[SMALLEST] = e.v1
    e.branch = side * (FROM_BACKBONE if was == BACKBONE else FROM_RELOADING)
    zero = -e.h[UNLOADING] / k
    if side > 0:
        line(e, k, e.c, e.h[UNLOADING], zero, e.h[TURNED])
    else:
        line(e, k, e.c, e.h[UNLOADING], e.h[TURNED], zero)


def _aim(e: Any, side: int) -> None:
    """The straight line from zero shear here to the backbone at the largest drift so far on a side."""
    k, limit, a = e.p[K], e.p[LIMIT], e.p[A]
    target = e.h[LARGEST] if side > 0 else -e.h[SMALLEST]
    e.h[SLOPE] = (a * k * target + (1.0 - a) * k * limit) / (target - side * e.v1)
    e.h[OFFSET] = -e.h[SLOPE] * e.v1


@dataclass(frozen=True)
class PeakOriented(StoreyLaw):
    """Bilinear backbone, unloading with the initial stiffness to zero shear, reloading in a straight line towards the
    largest drift so far on that side."""

    name: ClassVar[str] = "peak-oriented"
    example: ClassVar[str] = "{storeys: 5, period: 0.6 s, storey_law: peak-oriented}"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("clough1966", "stiffness that degrades with the largest drift"),
        ("ibarra2005", "peak-oriented reloading"),
    )
    behaviour: ClassVar[Behaviour] = Behaviour(next_branch)
