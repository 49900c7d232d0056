"""Declaration of a law of storeys. A storey acts on its drift v; its force is the shear."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from pounding_cli.laws.law import Behaviour, Law, parameter


@dataclass(frozen=True)
class StoreyLaw(Law):
    """Law of a storey, which holds a floor to the floor below.

    behaviour : functions of its element where it can yield

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    acts_on = "storey"
    behaviour: ClassVar[Behaviour]

    stiffness: float = parameter("initial stiffness k", "N/m", open_low=True)
    yield_shear: float = parameter(
        "yield shear Vy; inf for a storey that cannot yield", "N", open_low=True, can_be_infinite=True
    )
    hardening: float = parameter("post-yield over initial stiffness a", high=1.0)

    @property
    def yield_drift(self) -> float:
        """Vy / k [m]."""
        return self.yield_shear / self.stiffness

    @property
    def can_yield(self) -> bool:
        """True where it may leave its first branch."""
        return math.isfinite(self.yield_shear)

    @property
    def min_slope_ratio(self) -> float:
        """The least slope of its shear beyond the yield, over k [-]."""
        return self.hardening

    def element_parameters(self) -> tuple[float, ...]:
        """Parameters p of its element, as `behaviour` reads them."""
        return self.stiffness, self.yield_drift, self.hardening

    def stored_energy(self, drift: Any, shear: Any) -> Any:
        """Energy that the storey holds [J] at drifts [m] with shears [N]: what an unloading with the initial stiffness
        would give back."""
        return 0.5 * shear**2 / self.stiffness


def energy_in_two_springs(law: StoreyLaw, drift: Any, shear: Any) -> Any:
    """Energy [J] in a spring a k under the drift and one of (1 - a) k that yields, side by side."""
    k = law.stiffness
    a = law.hardening
    return 0.5 * a * k * drift**2 + 0.5 * (shear - a * k * drift) ** 2 / ((1.0 - a) * k)
