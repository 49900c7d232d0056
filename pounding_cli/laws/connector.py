"""A spring and a dashpot that join two floors for good (paper, eq. 10)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.dashpot import DASHPOT, DashpotLaw, dashpot_constant
from pounding_cli.laws.joined import JOINED
from pounding_cli.laws.law import Behaviour, LinkLaw, parameter


@dataclass(frozen=True)
class Connector(LinkLaw):
    """F = s_con v + c v' at all times; v is the closing u_left - u_right.

    It takes the place of the impact: a scene in which its floors would have struck leaves out the very thing it is
    about, so all numbers of that scene lose their meaning (paper, after eq. 10).
    """

    name: ClassVar[str] = "connector"
    example: ClassVar[str] = "{link: connector, gap: 5 cm, floors: [3, 5], stiffness: 1/5 mean storey}"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("spiliopoulos1996", "permanent connectors, eq. (10)"),
        DASHPOT,
        ("westermo1989", "connecting buildings"),
    )
    drawn: ClassVar[str] = "bar"
    stiffness_default: ClassVar[str] = "0.2 x mean storey"
    beyond_gap: ClassVar[str] = "connector closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True
    joins: ClassVar[bool] = True
    behaviour: ClassVar[Behaviour] = JOINED

    stiffness: float = parameter("spring s_con", "N/m", open_low=True)
    damping_ratio: float = parameter("damping ratio xi of the dashpot", high=1.0)
    dashpot: DashpotLaw = parameter("mass in eq. (7)", default=DashpotLaw.REDUCED_MASS)

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k [N/m], c [N s/m]."""
        mass = self.dashpot.mass(left_mass, right_mass)
        return self.stiffness, dashpot_constant(self.damping_ratio, self.stiffness, mass)

    @property
    def damped(self) -> bool:
        """With a dashpot."""
        return self.damping_ratio > 0

    @property
    def is_linear(self) -> bool:
        """Always."""
        return True

    @property
    def steepest(self) -> tuple[float, float]:
        """k and c."""
        k, c = self.numbers(1.0, 1.0)
        return k, c

    def stored(self, closing: float, force: float) -> float:
        """k v^2 / 2 [J]."""
        return 0.5 * self.stiffness * closing**2
