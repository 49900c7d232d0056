"""Floors that strike: a spring and a dashpot act once the gap has closed (Kelvin-Voigt; paper, eqs 5 to 7), the dashpot
from the coefficient of restitution."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from pounding_cli.laws.guards import LOW, SIGN_CHANGE, START
from pounding_cli.laws.law import Behaviour, LinkLaw, in_series, parameter, set_line, set_open


def reduced_mass(left_mass: float, right_mass: float) -> float:
    """m' = m1 m2 / (m1 + m2) [kg]; one of them is inf beside a wall that does not move."""
    return 1.0 / (1.0 / left_mass + 1.0 / right_mass)


class DashpotLaw(StrEnum):
    """The mass in eq. (7): m' = m1 m2 / (m1 + m2), or its inverse as eq. (7) is printed (wrong units)."""

    REDUCED_MASS = "reduced-mass"
    PRINTED = "printed"

    def mass(self, left_mass: float, right_mass: float) -> float:
        """The mass under the root of eq. (7) [kg]; [1/kg] in the printed form."""
        reduced = reduced_mass(left_mass, right_mass)
        return reduced if self is DashpotLaw.REDUCED_MASS else 1.0 / reduced


DASHPOT_CITATION = ("anagnostopoulos1988", "the dashpot from the coefficient of restitution, eq. (7)")
"""What a law with this dashpot cites."""


def damping_ratio(restitution: float) -> float:
    """Damping ratio xi [-] of a dashpot that gives the coefficient of restitution e, 0 < e <= 1.

    xi = -ln e / sqrt(pi^2 + ln^2 e) (Anagnostopoulos 1988).

    Raises
    ------
    ValueError : e outside 0 < e <= 1
    """
    if not 0 < restitution <= 1:
        raise ValueError(f"coefficient of restitution is {restitution:g}; it must be above 0 and at most 1")
    log = math.log(restitution)
    return -log / math.hypot(math.pi, log)


def restitution_from_damping(ratio: float) -> float:
    """Coefficient of restitution [-] of a damping ratio, 0 <= xi < 1: the inverse of `damping_ratio`."""
    return math.exp(-math.pi * ratio / math.sqrt(1.0 - ratio**2))


def dashpot_constant(ratio: float, stiffness: float, mass: float) -> float:
    """2 xi sqrt(s m') [N s/m] (eq. 7)."""
    return 2 * ratio * math.sqrt(stiffness * mass)


_K, _C, _CUTS, _F0, _SMOOTH, _JOINS = range(6)
"""Parameters: spring [N/m], dashpot [N s/m], 1 where no force pulls. The rest is of formulas of a study: force at rest
[N]; 1 where the formula is carried out; 1 where it acts at all closings."""

_OPEN, _PRESSED, _PULLING = range(3)
"""Branches; PULLING is closed without a force."""


def next_pounding_branch(e: Any, guard: int) -> None:
    """Open, pressed, and, where the tension is cut, pulling."""
    joins = e.p[_JOINS] > 0.0
    if (guard == START or guard == LOW) and not joins:
        set_open(e)
        return
    e.branch = _PULLING if guard == SIGN_CHANGE and e.branch == _PRESSED else _PRESSED
    set_line(e, e.p[_K], e.p[_C], e.p[_F0], -math.inf if joins else 0.0, math.inf)
    e.smooth = 1 if e.p[_SMOOTH] > 0.0 else 0
    e.cuts = 1 if e.p[_CUTS] > 0.0 else 0
    e.acts = 1 if e.branch == _PRESSED else 0


@dataclass(frozen=True)
class Pounding(LinkLaw):
    """F = s_imp v + c v' for v > 0; v is the closing less the gap."""

    name = "pounding"
    example = "{link: pounding, gap: 2 cm, stiffness: 20 x stiffest storey, restitution: 0.5}"
    citation = (
        ("spiliopoulos1996", "pounding, eqs (5) to (7)"),
        ("anagnostopoulos1992", "the viscoelastic impact element"),
        DASHPOT_CITATION,
    )
    subtracts_gap = True
    behaviour = Behaviour(next_pounding_branch)
    scaled_parameters = ("stiffness",)

    stiffness: float = parameter("impact spring s_imp", "N/m", open_low=True)
    damping_ratio: float = parameter("damping ratio xi of the dashpot", high=1.0)
    tension_cut: bool = parameter("no force that pulls the floors together", default=False)
    dashpot: DashpotLaw = parameter("mass in eq. (7)", default=DashpotLaw.REDUCED_MASS)

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """Return k [N/m], c [N s/m], and 1 where the tension is cut."""
        mass = self.dashpot.mass(left_mass, right_mass)
        c = dashpot_constant(self.damping_ratio, self.stiffness, mass)
        return self.stiffness, c, float(self.cuts_tension)

    def soften(self, flexibility: float) -> Pounding:
        """Return the law with its spring in series with another; the damping ratio stays."""
        return replace(self, stiffness=in_series(self.stiffness, flexibility))

    def stored_energy(self, closing: float, force: float) -> float:
        """Return k v^2 / 2 while the floors press [J]."""
        return 0.5 * self.stiffness * max(closing - self.gap, 0.0) ** 2
