"""A spring and a dashpot that join two floors for good (paper, eq. 10)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.dashpot import DASHPOT, DashpotLaw, dashpot_constant
from pounding_cli.laws.law import Branch, LinkLaw, parameter


@dataclass(frozen=True)
class Connector(LinkLaw):
    """F = s_con v + c v' at all times; v is the closing u_left - u_right.

    It takes the place of the impact: a scene in which its floors would have struck leaves out the very thing it is
    about, so all numbers of that scene lose their meaning (paper, after eq. 10).
    """

    name: ClassVar[str] = "connector"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("spiliopoulos1996", "permanent connectors, eq. (10)"),
        DASHPOT,
        ("westermo1989", "connecting buildings"),
    )
    drawn: ClassVar[str] = "bar"
    stiffness_default: ClassVar[str] = "0.2 x mean storey"
    beyond_gap: ClassVar[str] = "connector closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True

    stiffness: float = parameter("spring s_con", "N/m", open_low=True)
    damping_ratio: float = parameter("damping ratio xi of the dashpot", high=1.0)
    dashpot: DashpotLaw = parameter("mass in eq. (7)", default=DashpotLaw.REDUCED_MASS)

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """One without end."""
        mass = self.dashpot.mass(left_mass, right_mass)
        return (Branch("joined", self.stiffness, dashpot=dashpot_constant(self.damping_ratio, self.stiffness, mass)),)
