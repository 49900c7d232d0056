"""Floors that strike with a spring that yields and so takes energy (bilinear; Muthukumar & DesRoches)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from pounding_cli.laws.guards import FASTER, HIGH, INSIDE, LOW, SLOWER, START
from pounding_cli.laws.hertz import DAMPING_FORMULA, MIN_RESTITUTION
from pounding_cli.laws.law import Behaviour, LinkLaw, parameter, set_line, set_open

_K1, _K2, _LIMIT = range(3)
"""Parameters: stiffness up to the yield and on unloading, stiffness beyond it [N/m], yield closing [m]."""

_YIELDS = 0
"""History variable: the closing at which an unloading would yield again [m]."""

_OPEN, _ELASTIC, _YIELDING, _UNLOADING, _RETURNING = range(5)
"""Branches."""


def next_bilinear_contact_branch(e: Any, guard: int) -> None:
    """Elastic up to the yield; unloading along K1 over the same closing, then returning along K2."""
    k1 = e.p[_K1]
    k2 = e.p[_K2]
    limit = e.p[_LIMIT]
    if guard == START or (guard == LOW and e.low == 0.0):
        set_open(e)
    elif guard == SLOWER or guard == FASTER:
        margin = INSIDE * (limit + abs(e.v1))
        e.h[_YIELDS] = e.v1 + margin if guard == SLOWER else e.v1 + limit - margin
        e.branch = _UNLOADING
        set_line(e, k1, 0.0, -(k1 - k2) * (e.h[_YIELDS] - limit), max(e.h[_YIELDS] - limit, 0.0), e.h[_YIELDS])
    elif e.branch == _OPEN:
        e.branch = _ELASTIC
        set_line(e, k1, 0.0, 0.0, 0.0, limit if k1 != k2 else math.inf)
    elif guard == HIGH:
        e.branch = _YIELDING
        set_line(e, k2, 0.0, (k1 - k2) * limit, 0.0, math.inf, 1)
    else:
        e.branch = _RETURNING
        set_line(e, k2, 0.0, 0.0, 0.0, math.inf, -1)


class BilinearDamping(StrEnum):
    """Source of the energy lost in a blow: the coefficient of restitution that comes out, or a formula."""

    EXACT = "exact"
    MUTHUKUMAR = "muthukumar"

    def share(self, restitution: float) -> float:
        """E / (k_eff d_m^2) [-]: the energy E lost in a blow that reaches d_m, over that of the spring k_eff twice.

        exact : (1 - e^2) / (1 + e^2), so that e comes out
        muthukumar : (1 - e^2) / 2.5 (Muthukumar & DesRoches 2006)
        """
        lost = 1.0 - restitution**2
        return lost / 2.5 if self is BilinearDamping.MUTHUKUMAR else lost / (1.0 + restitution**2)


@dataclass(frozen=True)
class BilinearContact(LinkLaw):
    """K1 v up to the yield closing a d_m, then K2; back along K1 over the same closing, then along K2 to v = 0.

    With k_eff = k_h sqrt(d_m) and the energy E lost in a blow that reaches d_m, K1 = k_eff + E / (a d_m^2) and
    K2 = k_eff - E / ((1 - a) d_m^2): the force at d_m is that of the Hertz spring, and the loop encloses E. A weaker
    blow than that of d_m loses less, one within the yield closing nothing.
    """

    name = "bilinear"
    example = "{link: bilinear, gap: 2 cm, hertz_stiffness: 2e9 N/m^1.5, penetration: 5 mm, restitution: 0.6}"
    citation = (("muthukumar2006", "the bilinear contact"),)
    subtracts_gap = True
    path_dependent = True
    behaviour = Behaviour(next_bilinear_contact_branch)

    hertz_stiffness: float = parameter("stiffness k_h of the contact", "N/m^1.5", open_low=True)
    penetration: float = parameter("closing d_m of the blow for which the contact is designed", "m", open_low=True)
    restitution: float = parameter("coefficient of restitution e", low=MIN_RESTITUTION, high=1.0, open_high=False)
    yield_share: float = parameter("closing at which it yields over d_m, a", open_low=True, high=0.5, default=0.1)
    damping_formula: BilinearDamping = parameter(DAMPING_FORMULA, default=BilinearDamping.EXACT)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.stiffnesses[1] <= 0.0:
            most = 1.0 - self.damping_formula.share(self.restitution)
            raise ValueError(
                f"link: the contact would soften to a negative stiffness beyond its yield; "
                f"with restitution {self.restitution:g} yield_share must be below {most:.3g}"
            )

    @property
    def stiffnesses(self) -> tuple[float, float]:
        """K1 and K2 [N/m]."""
        effective = self.hertz_stiffness * self.penetration**0.5
        share = self.damping_formula.share(self.restitution)
        return effective * (1.0 + share / self.yield_share), effective * (1.0 - share / (1.0 - self.yield_share))

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """K1, K2 [N/m], yield closing [m]."""
        return *self.stiffnesses, self.yield_share * self.penetration

    def stored_energy(self, closing: float, force: float) -> float:
        """Return the energy given back from a closing reached by pressing from the gap [J]."""
        k1, k2, limit = self.element_parameters(1.0, 1.0)
        v = max(closing - self.offset, 0.0)
        if v <= limit:
            return 0.5 * k1 * v**2
        beyond = v - limit
        return 0.5 * k1 * limit**2 + k2 * beyond * limit + 0.5 * k2 * beyond**2
