"""A viscous damper that joins two floors for good: a dashpot without a spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.joined import JOINED
from pounding_cli.laws.law import Behaviour, LinkLaw, parameter


@dataclass(frozen=True)
class Damper(LinkLaw):
    """F = c v' at all times; v' is the rate of the closing u_left - u_right.

    As a connector it takes the place of the impact unless another link lets its floors strike.
    """

    name: ClassVar[str] = "damper"
    example: ClassVar[str] = "{link: damper, gap: 5 cm, damping_coefficient: 2 MN s/m}"
    drawn: ClassVar[str] = "bar"
    beyond_gap: ClassVar[str] = "damper closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True
    joins: ClassVar[bool] = True
    behaviour: ClassVar[Behaviour] = JOINED

    damping_coefficient: float = parameter("dashpot c", "N s/m", open_low=True)

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """No spring, c [N s/m]."""
        return 0.0, self.damping_coefficient

    @property
    def damped(self) -> bool:
        """Always."""
        return True

    @property
    def is_linear(self) -> bool:
        """Always."""
        return True

    @property
    def steepest(self) -> tuple[float, float]:
        """No spring, c."""
        return 0.0, self.damping_coefficient
