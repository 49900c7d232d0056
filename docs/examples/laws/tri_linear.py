"""Floors that strike an elastic contact of three stiffnesses."""

import math
from dataclasses import dataclass

from pounding_cli.laws.guards import HIGH, START
from pounding_cli.laws.law import Behaviour, LinkLaw, parameter, set_line, set_open

K1, K2, K3, V2, V3 = range(5)  # parameters: stiffnesses [N/m], closings where it stiffens [m]
OPEN, FIRST, SECOND, THIRD = range(4)


def next_branch(e, guard):
    """Open, and three lines that meet."""
    k1, k2, k3, v2, v3 = e.p[K1], e.p[K2], e.p[K3], e.p[V2], e.p[V3]
    e.branch += 1 if guard == HIGH else -1
    if guard == START or e.branch == OPEN:
        set_open(e)
    elif e.branch == FIRST:
        set_line(e, k1, 0.0, 0.0, 0.0, v2)
    elif e.branch == SECOND:
        set_line(e, k2, 0.0, (k1 - k2) * v2, v2, v3)
    else:
        set_line(e, k3, 0.0, (k1 - k2) * v2 + (k2 - k3) * v3, v3, math.inf)


@dataclass(frozen=True)
class TriLinear(LinkLaw):
    """k1 v, from v2 on with the slope k2, from v3 on with k3."""

    name = "tri-linear"
    subtracts_gap = True
    scaled_parameters = ("stiffness", "second_stiffness", "third_stiffness")
    behaviour = Behaviour(next_branch)

    stiffness: float = parameter("first stiffness k1", "N/m", open_low=True)
    second_stiffness: float = parameter("stiffness k2 from v2 on", "N/m", open_low=True)
    third_stiffness: float = parameter("stiffness k3 from v3 on", "N/m", open_low=True)
    second_closing: float = parameter("closing v2 where it first stiffens", "m", open_low=True)
    third_closing: float = parameter("closing v3 where it stiffens again", "m", open_low=True)

    def __post_init__(self):
        super().__post_init__()
        if self.second_closing >= self.third_closing:
            raise ValueError("link: third_closing must be above second_closing")

    def element_parameters(self, left_mass, right_mass):
        """k1, k2, k3 [N/m], v2, v3 [m]."""
        return self.stiffness, self.second_stiffness, self.third_stiffness, self.second_closing, self.third_closing

    @property
    def max_slopes(self):
        """The stiffest of the three, without a dashpot."""
        return max(self.element_parameters(1.0, 1.0)[:3]), 0.0

    def stored_energy(self, closing, force):
        """The area under the three lines [J]."""
        k1, k2, k3, v2, v3 = self.element_parameters(1.0, 1.0)
        v, more, most = (max(closing - self.offset - each, 0.0) for each in (0.0, v2, v3))
        return 0.5 * (k1 * v**2 + (k2 - k1) * more**2 + (k3 - k2) * most**2)
