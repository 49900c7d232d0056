"""A fluid viscous damper that joins two floors for good: a force that grows as a power of the rate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.law import Branch, LinkLaw, parameter
from pounding_cli.laws.program import RATE


@dataclass(frozen=True)
class Viscous(LinkLaw):
    """F = c |v'|^a sgn v'; v' is the rate of the closing u_left - u_right.

    The power has no derivative at rest, so F = c v' (v'^4 + w^4)^((a - 1) / 4): straight in v' below the rate w, and
    within (1 - a) / 4 (w / v')^4 of the power above it. As a connector it takes the place of the impact unless another
    link lets its floors strike.
    """

    name: ClassVar[str] = "viscous"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (("lin2002", "viscous dampers with an exponent"),)
    drawn: ClassVar[str] = "bar"
    beyond_gap: ClassVar[str] = "viscous damper closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True

    force_at_1_m_s: float = parameter("force c at a rate of 1 m/s", "N", open_low=True)
    exponent: float = parameter("power a of the rate", low=0.1, high=1.0, open_high=False)
    straight_below: float = parameter("rate w below which the force is straight", "m/s", low=1e-9, default=1e-6)

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """One without end."""
        c, a, w = self.force_at_1_m_s, self.exponent, self.straight_below
        if a == 1.0:
            return (Branch("joined", dashpot=c),)
        square = RATE * RATE
        force = c * (RATE * (square * square + w**4) ** (0.25 * (a - 1.0)))
        return (Branch("joined", force=force),)
