"""A friction damper that joins two floors for good: a spring until it slips."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.law import (
    ROUNDING,
    Branch,
    Guard,
    LinkLaw,
    Quantity,
    falls_below,
    parameter,
    remembering,
    rises_above,
)
from pounding_cli.laws.program import CLOSING, MEMORY


@dataclass(frozen=True)
class Friction(LinkLaw):
    """F = k (v - slip) up to the slip force Fs, and +-Fs while the damper slips; v is the closing u_left - u_right.

    As a connector it takes the place of the impact unless another link lets its floors strike.
    """

    name: ClassVar[str] = "friction"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("pall1982", "friction dampers"),
        ("bhaskararao2006", "friction dampers between buildings"),
    )
    drawn: ClassVar[str] = "bar"
    stiffness_default: ClassVar[str] = "1 x mean storey"
    beyond_gap: ClassVar[str] = "friction damper closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True

    stiffness: float = parameter("spring k of the damper and its brace before it slips", "N/m", open_low=True)
    slip_force: float = parameter("force Fs at which it slips", "N", open_low=True)

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """Sticking, where it remembers its slip; slipping as the floors close or part, until they turn back."""
        k, force = self.stiffness, self.slip_force
        limit = force / k
        inside = limit * (1.0 - ROUNDING)  # a turning point lies within the elastic range, whatever rounding says
        yields = (
            rises_above(limit, "closing", of_memory=1.0),
            falls_below(-limit, "parting", of_memory=1.0),
        )
        turns_back = Guard(Quantity.RATE, 0.0, 1.0, "sticking", once=True, sets=remembering(CLOSING - inside))
        turns_up = Guard(Quantity.RATE, 0.0, -1.0, "sticking", once=True, sets=remembering(CLOSING + inside))
        held = 0.5 * force**2 / k
        shear = k * (CLOSING - MEMORY)
        return (
            Branch("sticking", force=shear, guards=yields, holds=(0.5 / k) * shear**2),
            Branch("closing", offset=force, guards=(turns_back,), holds=held),
            Branch("parting", offset=-force, guards=(turns_up,), holds=held),
        )
