"""Floors that strike: a spring and a dashpot act once the gap has closed (Kelvin-Voigt; paper, eqs 5 to 7)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.dashpot import DASHPOT, DashpotLaw, dashpot_constant
from pounding_cli.laws.law import Branch, LinkLaw, falls_below, opening, parameter


@dataclass(frozen=True)
class Pounding(LinkLaw):
    """F = s_imp v + c v' for v > 0; v is the closing less the gap.

    A gap of inf stands for floors that never meet: a run finds their largest closing all the same.
    """

    name: ClassVar[str] = "pounding"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("spiliopoulos1996", "pounding, eqs (5) to (7)"),
        ("anagnostopoulos1992", "the viscoelastic impact element"),
        DASHPOT,
    )
    subtracts_gap: ClassVar[bool] = True

    stiffness: float = parameter("impact spring s_imp", "N/m", open_low=True)
    damping_ratio: float = parameter("damping ratio xi of the dashpot", high=1.0)
    tension_cut: bool = parameter("no force that pulls the floors together", default=False)
    dashpot: DashpotLaw = parameter("mass in eq. (7)", default=DashpotLaw.REDUCED_MASS)

    def may_be_endless(self, name: str) -> bool:
        """The gap may."""
        return name == "gap"

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """Open and in contact."""
        stiffness = self.stiffness if self.can_close else 0.0
        c = dashpot_constant(self.damping_ratio, stiffness, self.dashpot.mass(left_mass, right_mass))
        contact = Branch("contact", stiffness, dashpot=c, guards=(falls_below(0.0, "open"),))
        return opening(contact, tension_cut=self.tension_cut and self.damping_ratio > 0)
