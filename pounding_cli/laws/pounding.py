"""Floors that strike: a spring and a dashpot act once the gap has closed (Kelvin-Voigt; paper, eqs 5 to 7)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pounding_cli.laws.dashpot import DASHPOT, DashpotLaw, dashpot_constant
from pounding_cli.laws.guards import FORCE, LOW, START
from pounding_cli.laws.law import Behaviour, LinkLaw, line, opened, parameter

K, C, CUTS, F0, SMOOTH, JOINS = range(6)
"""Parameters: spring [N/m], dashpot [N s/m], 1 where no force pulls. The rest is of formulas of a study: force at rest
[N]; 1 where the formula is carried out; 1 where it acts at all closings."""

OPEN, PRESSED, PULLING = range(3)
"""Branches; PULLING is closed without a force."""


def next_branch(e: Any, guard: int) -> None:
    """Open, pressed, and, where the tension is cut, pulling."""
    joins = e.p[JOINS] > 0.0
    if (guard == START or guard == LOW) and not joins:
        opened(e)
        return
    e.branch = PULLING if guard == FORCE and e.branch == PRESSED else PRESSED
    line(e, e.p[K], e.p[C], e.p[F0], -math.inf if joins else 0.0, math.inf)
    e.smooth = 1 if e.p[SMOOTH] > 0.0 else 0
    e.cuts = 1 if e.p[CUTS] > 0.0 else 0
    e.acts = 1 if e.branch == PRESSED else 0


@dataclass(frozen=True)
class Pounding(LinkLaw):
    """F = s_imp v + c v' for v > 0; v is the closing less the gap.

    A gap of inf stands for floors that never meet: a run finds their largest closing all the same.
    """

    name = "pounding"
    example = "{link: pounding, gap: 2 cm, stiffness: 20 x stiffest storey, restitution: 0.5}"
    citation = (
        ("spiliopoulos1996", "pounding, eqs (5) to (7)"),
        ("anagnostopoulos1992", "the viscoelastic impact element"),
        DASHPOT,
    )
    subtracts_gap = True
    behaviour = Behaviour(next_branch)

    gap: float = parameter("initial distance d between the floors", "m", endless=True)
    stiffness: float = parameter("impact spring s_imp", "N/m", open_low=True)
    damping_ratio: float = parameter("damping ratio xi of the dashpot", high=1.0)
    tension_cut: bool = parameter("no force that pulls the floors together", default=False)
    dashpot: DashpotLaw = parameter("mass in eq. (7)", default=DashpotLaw.REDUCED_MASS)

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k [N/m], c [N s/m], whether the tension is cut."""
        k = self.stiffness if self.can_close else 0.0
        c = dashpot_constant(self.damping_ratio, k, self.dashpot.mass(left_mass, right_mass))
        return k, c, float(self.cut)

    def stored(self, closing: float, force: float) -> float:
        """k v^2 / 2 while the floors press [J]."""
        return 0.5 * self.stiffness * max(closing - self.gap, 0.0) ** 2 if self.can_close else 0.0
