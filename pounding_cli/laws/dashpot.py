"""The dashpot of a link from its coefficient of restitution (paper, eqs 6 and 7)."""

from __future__ import annotations

import math
from enum import StrEnum


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


DASHPOT = ("anagnostopoulos1988", "the dashpot from the coefficient of restitution, eq. (7)")
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


def restitution_of(ratio: float) -> float:
    """Coefficient of restitution [-] of a damping ratio, 0 <= xi < 1: the inverse of `damping_ratio`."""
    return math.exp(-math.pi * ratio / math.sqrt(1.0 - ratio**2))


def dashpot_constant(ratio: float, stiffness: float, mass: float) -> float:
    """2 xi sqrt(s m') [N s/m] (eq. 7)."""
    return 2 * ratio * math.sqrt(stiffness * mass)
