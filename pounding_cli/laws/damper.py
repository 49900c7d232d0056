"""A viscous damper that joins two floors for good: a dashpot without a spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.law import Branch, LinkLaw, parameter


@dataclass(frozen=True)
class Damper(LinkLaw):
    """F = c v' at all times; v' is the rate of the closing u_left - u_right.

    As a connector it takes the place of the impact unless another link lets its floors strike.
    """

    name: ClassVar[str] = "damper"
    drawn: ClassVar[str] = "bar"
    beyond_gap: ClassVar[str] = "damper closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True

    damping_coefficient: float = parameter("dashpot c", "N s/m", open_low=True)

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """One without end."""
        return (Branch("joined", dashpot=self.damping_coefficient),)
