"""Two floors with nothing between them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from pounding_cli.laws.law import JOINED, LinkLaw


@dataclass(frozen=True)
class Apart(LinkLaw):
    """No force whatever the floors do: a run only records the largest closing of the two.

    It has no gap (NaN), and floors with nothing between them cannot collide.
    """

    name = "apart"
    can_act = False
    behaviour = JOINED

    gap: float = field(default=math.nan, init=False, repr=False, compare=False)

    @property
    def identity(self) -> str:
        """The text of floors that a gap without end keeps from striking, which move alike.

        Digests of scenes are made of it, so another text would lose all that caches hold.
        """
        return "pounding inf 1.0 0.0 False reduced-mass"

    @property
    def free_below(self) -> float:
        """The closing below which no force acts: any [m]."""
        return math.inf

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """Return no spring [N/m] and no dashpot [N s/m]."""
        return 0.0, 0.0
