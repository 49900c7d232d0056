"""Floors that strike with a spring that yields and so takes energy (bilinear; Muthukumar & DesRoches)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

from pounding_cli.laws.hertz import DAMPING_FORMULA, LEAST_RESTITUTION
from pounding_cli.laws.law import (
    ROUNDING,
    Branch,
    Guard,
    LinkLaw,
    Quantity,
    falls_below,
    opening,
    parameter,
    remembering,
    rises_above,
)
from pounding_cli.laws.program import CLOSING, MEMORY


class BilinearDamping(StrEnum):
    """Where the energy lost in a blow comes from: the coefficient of restitution that comes out, or a formula."""

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

    name: ClassVar[str] = "bilinear"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (("muthukumar2006", "the bilinear contact"),)
    subtracts_gap: ClassVar[bool] = True

    hertz_stiffness: float = parameter("stiffness k_h of the contact", "N/m^1.5", open_low=True)
    penetration: float = parameter("closing d_m of the blow for which the contact is designed", "m", open_low=True)
    restitution: float = parameter("coefficient of restitution e", low=LEAST_RESTITUTION, high=1.0, open_high=False)
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
    def yield_closing(self) -> float:
        """a d_m [m]."""
        return self.yield_share * self.penetration

    @property
    def stiffnesses(self) -> tuple[float, float]:
        """K1 and K2 [N/m]."""
        effective, share = self.hertz_stiffness * self.penetration**0.5, self.damping_formula.share(self.restitution)
        return effective * (1.0 + share / self.yield_share), effective * (1.0 - share / (1.0 - self.yield_share))

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """Open; elastic, yielding, unloading and returning; unloading remembers the closing where it would yield."""
        k1, k2 = self.stiffnesses
        limit, opens = self.yield_closing, falls_below(0.0, "open")
        if k1 == k2:
            return opening(Branch("elastic", k1, guards=(opens,)))
        apart = ROUNDING * limit
        turns_back = Guard(Quantity.RATE, 0.0, 1.0, "unloading", once=True, sets=remembering(CLOSING + apart))
        again = CLOSING + (limit - apart)
        turns_up = Guard(Quantity.RATE, 0.0, -1.0, "unloading", once=True, sets=remembering(again))
        yields = Guard(Quantity.CLOSING, 0.0, -1.0, "yielding", of_memory=1.0)
        returns = Guard(Quantity.CLOSING, -limit, 1.0, "returning", of_memory=1.0)
        unloading = k1 * CLOSING - (k1 - k2) * MEMORY + (k1 - k2) * limit
        return opening(
            Branch("elastic", k1, guards=(opens, rises_above(limit, "yielding"))),
            Branch("yielding", k2, offset=(k1 - k2) * limit, guards=(opens, turns_back)),
            Branch("unloading", force=unloading, guards=(opens, yields, returns)),
            Branch("returning", k2, guards=(opens, turns_up)),
        )

    def stored(self, closing: float) -> float:
        """What the contact gives back from a closing reached by pressing from the gap [J]."""
        (k1, k2), v, limit = self.stiffnesses, max(closing - self.offset, 0.0), self.yield_closing
        if v <= limit:
            return 0.5 * k1 * v**2
        beyond = v - limit
        return 0.5 * k1 * limit**2 + k2 * beyond * limit + 0.5 * k2 * beyond**2
