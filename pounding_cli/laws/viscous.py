"""A fluid viscous damper that joins two floors for good: a force that grows as a power of the rate."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from pounding_cli.laws.law import Behaviour, LinkLaw, line, parameter

C, EXPONENT, STRAIGHT = range(3)
"""Parameters: force at 1 m/s [N], power of the rate [-], rate below which the force is straight, to the power 4."""


def next_branch(e: Any, guard: int) -> None:
    """One branch without end, straight where the power is 1."""
    straight = e.p[EXPONENT] == 1.0
    line(e, 0.0, e.p[C] if straight else 0.0, 0.0, -math.inf, math.inf)
    e.smooth = 0 if straight else 1


def force(e: Any, v: float, r: float) -> float:
    """c v' (v'^4 + w^4)^((a - 1) / 4) [N]."""
    square = r * r
    return e.p[C] * r * (square * square + e.p[STRAIGHT]) ** (0.25 * (e.p[EXPONENT] - 1.0))


@dataclass(frozen=True)
class Viscous(LinkLaw):
    """F = c |v'|^a sgn v'; v' is the rate of the closing u_left - u_right.

    The power has no derivative at rest, so F = c v' (v'^4 + w^4)^((a - 1) / 4): straight in v' below the rate w, and
    within (1 - a) / 4 (w / v')^4 of the power above it. As a connector it takes the place of the impact unless another
    link lets its floors strike.
    """

    name: ClassVar[str] = "viscous"
    example: ClassVar[str] = "{link: viscous, gap: 5 cm, force_at_1_m_s: 500 kN, exponent: 0.3}"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (("lin2002", "viscous dampers with an exponent"),)
    drawn: ClassVar[str] = "bar"
    beyond_gap: ClassVar[str] = "viscous damper closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True
    joins: ClassVar[bool] = True
    behaviour: ClassVar[Behaviour] = Behaviour(next_branch, force)

    force_at_1_m_s: float = parameter("force c at a rate of 1 m/s", "N", open_low=True)
    exponent: float = parameter("power a of the rate", low=0.1, high=1.0, open_high=False)
    straight_below: float = parameter("rate w below which the force is straight", "m/s", low=1e-9, default=1e-6)

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """c [N], a [-], w^4."""
        return self.force_at_1_m_s, self.exponent, self.straight_below**4

    @property
    def damped(self) -> bool:
        """Always."""
        return True

    @property
    def is_linear(self) -> bool:
        """Where the power is 1."""
        return self.exponent == 1.0 or super().is_linear

    @property
    def steepest(self) -> tuple[float, float]:
        """The slope at rest."""
        return 0.0, self.force_at_1_m_s * self.straight_below ** (self.exponent - 1.0)
