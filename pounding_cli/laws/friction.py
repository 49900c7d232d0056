"""A friction damper that joins two floors for good: a spring until it slips."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from pounding_cli.laws.guards import HIGH, INSIDE, START
from pounding_cli.laws.law import Behaviour, LinkLaw, line, parameter

K, LIMIT = range(2)
"""Parameters: spring [N/m], closing at which it slips [m]."""

SLIP = 0
"""History variable: how far it has slipped [m]."""

PARTING, STICKING, CLOSING = -1, 0, 1
"""Branches."""


def next_branch(e: Any, guard: int) -> None:
    """From sticking to slipping, and back where the floors turn."""
    k, limit = e.p[K], e.p[LIMIT]
    if e.branch == STICKING and guard != START:
        e.branch = CLOSING if guard == HIGH else PARTING
        line(e, 0.0, 0.0, e.branch * k * limit, -math.inf, math.inf)
        if e.branch == CLOSING:
            e.slow = 0.0
        else:
            e.fast = 0.0
        return
    if guard != START:
        e.h[SLIP] = e.v1 - e.branch * (limit - INSIDE * (limit + abs(e.v1)))
    e.branch = STICKING
    line(e, k, 0.0, -k * e.h[SLIP], e.h[SLIP] - limit, e.h[SLIP] + limit)


@dataclass(frozen=True)
class Friction(LinkLaw):
    """F = k (v - slip) up to the slip force Fs, and +-Fs while the damper slips; v is the closing u_left - u_right.

    As a connector it takes the place of the impact unless another link lets its floors strike.
    """

    name: ClassVar[str] = "friction"
    example: ClassVar[str] = "{link: friction, gap: 5 cm, slip_force: 200 kN}"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("pall1982", "friction dampers"),
        ("bhaskararao2006", "friction dampers between buildings"),
    )
    drawn: ClassVar[str] = "bar"
    stiffness_default: ClassVar[str] = "1 x mean storey"
    beyond_gap: ClassVar[str] = "friction damper closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True
    joins: ClassVar[bool] = True
    remembers: ClassVar[bool] = True
    behaviour: ClassVar[Behaviour] = Behaviour(next_branch)

    stiffness: float = parameter("spring k of the damper and its brace before it slips", "N/m", open_low=True)
    slip_force: float = parameter("force Fs at which it slips", "N", open_low=True)

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k [N/m], Fs / k [m]."""
        return self.stiffness, self.slip_force / self.stiffness

    @property
    def steepest(self) -> tuple[float, float]:
        """Before it slips."""
        return self.stiffness, 0.0

    def stored(self, closing: float, force: float) -> float:
        """F^2 / 2 k [J]."""
        return 0.5 * force**2 / self.stiffness
