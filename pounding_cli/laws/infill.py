"""Material that fills the gap: soft at first, as stiff as an impact where it is pressed to nothing (paper, eqs 8 and
9)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

from pounding_cli.laws.dashpot import DASHPOT, DashpotLaw
from pounding_cli.laws.law import Branch, LinkLaw, falls_below, opening, parameter, rises_above

THINNEST = 1e-6
"""Least thickness in a study [m]: the cubic (s_imp - s_mat) / (3 d^2) grows without bound."""


class InfillLaw(StrEnum):
    """How an infill goes on beyond its thickness: F(d) + s_imp (v - d), or s_imp v as eq. (9) is printed."""

    CONTINUOUS = "continuous"
    PRINTED = "printed"


@dataclass(frozen=True)
class Infill(LinkLaw):
    """F = p v^3 + s_mat v + c_cur v' for 0 < v <= d with p = (s_imp - s_mat) / (3 d^2) and c_cur = 2 xi sqrt(s_cur m'),
    s_cur = s_mat + 3 p v^2; beyond d as stiff as an impact (paper, after eq. 9).
    """

    name: ClassVar[str] = "infill"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("spiliopoulos1996", "infill material, eqs (8) and (9)"),
        ("anagnostopoulos1992", "the viscoelastic impact element"),
        DASHPOT,
    )
    drawn: ClassVar[str] = "filling"
    stiffness_default: ClassVar[str] = "0.2 x mean storey"
    beyond_gap: ClassVar[str] = "infill compressed beyond its thickness"

    stiffness: float = parameter("spring of the material s_mat where it is not pressed", "N/m", open_low=True)
    impact_stiffness: float = parameter("what it stiffens to at v = d, s_imp", "N/m", open_low=True)
    damping_ratio: float = parameter("damping ratio xi of the dashpot", high=1.0)
    tension_cut: bool = parameter("no force that pulls the floors together", default=False)
    law: InfillLaw = parameter(
        "beyond its thickness: continuous, or eq. (9) as printed, which jumps", default=InfillLaw.CONTINUOUS
    )
    dashpot: DashpotLaw = parameter("mass in eq. (7)", default=DashpotLaw.REDUCED_MASS)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gap == 0:
            raise ValueError("link: an infill needs a gap above zero to fill; write pounding for a gap of zero")

    @classmethod
    def conflict(cls, **values: float) -> tuple[str, str, str] | None:
        """Too thin, or softer when it is pressed."""
        gap, stiffness, impact = (values.get(name, math.nan) for name in ("gap", "stiffness", "impact_stiffness"))
        if gap < THINNEST:
            wrong = f"an infill {gap:g} m thick is thinner than {THINNEST:g} m: no material is that thin"
            hint = f"write `link: pounding` for buildings in touch, or a gap of {THINNEST:g} m or more"
            return "gap", "an infill in a gap of zero has no thickness" if gap == 0 else wrong, hint
        if stiffness > impact:
            wrong = f"the infill's stiffness {stiffness:.3g} N/m is above the impact stiffness {impact:.3g} N/m"
            hint = "an infill stiffens to impact.stiffness (paper, Fig. 3): lower the one or raise the other"
            return "stiffness", wrong, hint
        return None

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """Open, inside its thickness and beyond it."""
        mass, d = self.dashpot.mass(left_mass, right_mass), self.gap
        cubic = (self.impact_stiffness - self.stiffness) / (3 * d**2)
        root = 2 * self.damping_ratio * math.sqrt(mass)
        offset = 0.0
        if self.law is InfillLaw.CONTINUOUS:  # F(d) + s_imp (v - d)
            offset = cubic * d**3 + self.stiffness * d - self.impact_stiffness * d
        stiffens = rises_above(d, "beyond")
        inside = Branch("inside", self.stiffness, cubic, root=root, guards=(falls_below(0.0, "open"), stiffens))
        c = root * math.sqrt(self.impact_stiffness)
        beyond = Branch("beyond", self.impact_stiffness, offset=offset, dashpot=c, guards=(falls_below(d, "inside"),))
        return opening(inside, beyond, tension_cut=self.tension_cut and self.damping_ratio > 0)
