"""A Maxwell damper that joins two floors for good: a dashpot in series with a spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.law import Branch, LinkLaw, parameter
from pounding_cli.laws.program import MEMORY, RATE

SHORTEST_RELAXATION = 1e-6
"""Least c / k [s]: steps are a few times as long."""


@dataclass(frozen=True)
class Maxwell(LinkLaw):
    """F' = k (v' - F / c): the spring and the dashpot carry one force F, and their rates add up to v', that of the
    closing u_left - u_right.

    As a connector it takes the place of the impact unless another link lets its floors strike.
    """

    name: ClassVar[str] = "maxwell"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (("zhang2000", "Maxwell dampers between buildings"),)
    drawn: ClassVar[str] = "bar"
    stiffness_default: ClassVar[str] = "1 x mean storey"
    beyond_gap: ClassVar[str] = "Maxwell damper closes more than the gap, so the floors would have struck"
    meaningless: ClassVar[bool] = True

    stiffness: float = parameter("spring k of the damper and its brace", "N/m", open_low=True)
    damping_coefficient: float = parameter("dashpot c", "N s/m", open_low=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.damping_coefficient < SHORTEST_RELAXATION * self.stiffness:
            raise ValueError(
                f"link: the force of this Maxwell damper relaxes in {self.damping_coefficient / self.stiffness:.3g} s "
                f"(c / k), less than {SHORTEST_RELAXATION:g} s: write `link: damper`, which has no spring"
            )

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """One without end; what it remembers is its force."""
        k, c = self.stiffness, self.damping_coefficient
        flow = k * RATE - (k / c) * MEMORY
        return (Branch("joined", force=1.0 * MEMORY, flow=flow, holds=(0.5 / k) * MEMORY**2),)
