"""Floors that strike: a spring and a dashpot act once the gap has closed (Kelvin-Voigt; paper, eqs 5 to 7)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from pounding_cli.laws.dashpot import DASHPOT, DashpotLaw, dashpot_constant
from pounding_cli.laws.guards import FORCE, LOW, START
from pounding_cli.laws.law import Behaviour, LinkLaw, line, opened, parameter

K, C, CUTS = range(3)
"""Parameters: spring [N/m], dashpot [N s/m], 1 where no force pulls."""

OPEN, PRESSED, PULLING = range(3)
"""Branches; PULLING is closed without a force."""


def next_branch(e: Any, guard: int) -> None:
    """Open, pressed, and, where the tension is cut, pulling."""
    if guard == START or guard == LOW:
        opened(e)
        return
    e.branch = PULLING if guard == FORCE and e.branch == PRESSED else PRESSED
    line(e, e.p[K], e.p[C], 0.0, 0.0, math.inf)
    e.cuts = 1 if e.p[CUTS] > 0.0 else 0
    e.acts = 1 if e.branch == PRESSED else 0


@dataclass(frozen=True)
class Pounding(LinkLaw):
    """F = s_imp v + c v' for v > 0; v is the closing less the gap.

    A gap of inf stands for floors that never meet: a run finds their largest closing all the same.
    """

    name: ClassVar[str] = "pounding"
    example: ClassVar[str] = "{link: pounding, gap: 2 cm, stiffness: 20 x stiffest storey, restitution: 0.5}"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("spiliopoulos1996", "pounding, eqs (5) to (7)"),
        ("anagnostopoulos1992", "the viscoelastic impact element"),
        DASHPOT,
    )
    subtracts_gap: ClassVar[bool] = True
    behaviour: ClassVar[Behaviour] = Behaviour(next_branch)

    stiffness: float = parameter("impact spring s_imp", "N/m", open_low=True)
    damping_ratio: float = parameter("damping ratio xi of the dashpot", high=1.0)
    tension_cut: bool = parameter("no force that pulls the floors together", default=False)
    dashpot: DashpotLaw = parameter("mass in eq. (7)", default=DashpotLaw.REDUCED_MASS)

    def may_be_endless(self, name: str) -> bool:
        """The gap may."""
        return name == "gap"

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k [N/m], c [N s/m], whether the tension is cut."""
        k = self.stiffness if self.can_close else 0.0
        c = dashpot_constant(self.damping_ratio, k, self.dashpot.mass(left_mass, right_mass))
        return k, c, float(self.cut)

    @property
    def damped(self) -> bool:
        """With a dashpot."""
        return self.damping_ratio > 0

    @property
    def steepest(self) -> tuple[float, float]:
        """k and c."""
        k, c, _ = self.numbers(1.0, 1.0)
        return k, c

    def stored(self, closing: float, force: float) -> float:
        """k v^2 / 2 while the floors press [J]."""
        return 0.5 * self.stiffness * max(closing - self.gap, 0.0) ** 2 if self.can_close else 0.0
