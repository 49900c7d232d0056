"""A Maxwell damper that joins two floors for good: a dashpot in series with a spring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from pounding_cli.laws.law import Behaviour, LinkLaw, line, parameter

SHORTEST_RELAXATION = 1e-6
"""Least c / k [s]: steps are a few times as long."""

K, C = range(2)
"""Parameters: spring [N/m] and dashpot [N s/m]. The history variable h[0] is the force [N]."""


def next_branch(e: Any, guard: int) -> None:
    """One branch without end, whose force relaxes."""
    line(e, e.p[K], 0.0, 0.0, -math.inf, math.inf)
    e.relaxation = e.p[K] / e.p[C]


@dataclass(frozen=True)
class Maxwell(LinkLaw):
    """F' = k (v' - F / c): the spring and the dashpot carry one force F, and their rates add up to v', that of the
    closing u_left - u_right.

    As a connector it takes the place of the impact unless another link lets its floors strike.
    """

    name: ClassVar[str] = "maxwell"
    example: ClassVar[str] = "{link: maxwell, gap: 5 cm, damping_coefficient: 2 MN s/m, stiffness: 100 kN/mm}"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (("zhang2000", "Maxwell dampers between buildings"),)
    drawn: ClassVar[str] = "bar"
    stiffness_default: ClassVar[str] = "1 x mean storey"
    beyond_gap: ClassVar[str] = "Maxwell damper closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True
    joins: ClassVar[bool] = True
    remembers: ClassVar[bool] = True
    behaviour: ClassVar[Behaviour] = Behaviour(next_branch)

    stiffness: float = parameter("spring k of the damper and its brace", "N/m", open_low=True)
    damping_coefficient: float = parameter("dashpot c", "N s/m", open_low=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.damping_coefficient < SHORTEST_RELAXATION * self.stiffness:
            raise ValueError(
                f"link: the force of this Maxwell damper relaxes in {self.damping_coefficient / self.stiffness:.3g} s "
                f"(c / k), less than {SHORTEST_RELAXATION:g} s: write `link: damper`, which has no spring"
            )

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k [N/m], c [N s/m]."""
        return self.stiffness, self.damping_coefficient

    @property
    def damped(self) -> bool:
        """Always."""
        return True

    @property
    def steepest(self) -> tuple[float, float]:
        """The spring alone, which a sudden motion feels."""
        return self.stiffness, 0.0

    def stored(self, closing: float, force: float) -> float:
        """F^2 / 2 k in the spring [J]."""
        return 0.5 * force**2 / self.stiffness
