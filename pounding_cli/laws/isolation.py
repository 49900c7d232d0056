"""Isolators under a base: the force of each is bilinear in the displacement of the base (`laws.bilinear`)."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass

from pounding_cli.laws.bilinear import Bilinear
from pounding_cli.laws.law import Law, parameter


@dataclass(frozen=True)
class Isolation(Law):
    """All isolators of a building together.

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    acts_on = "isolation"

    @abstractmethod
    def bilinear(self, weight: float) -> Bilinear:
        """What they do under a weight [N], which stays the same."""


@dataclass(frozen=True)
class FrictionPendulum(Isolation):
    """F = W u / R + mu W sgn(u'), with a spring up to the yield displacement in place of a stuck slider: the energy of
    a cycle of amplitude D is less by the share yield displacement / D (Zayas, V. A., Low, S. S. and Mahin, S. A.
    (1990). A simple pendulum technique for achieving seismic isolation. Earthquake Spectra 6(2), 317-333)."""

    name = "friction-pendulum"

    radius: float = parameter("radius R of the sliding surface of a friction pendulum", "m", open_low=True)
    friction: float = parameter("its friction coefficient mu", "-", high=1.0, open_low=True)
    yield_displacement: float = parameter("displacement at which it slides", "m", default=1e-4, open_low=True)
    capacity: float = parameter("displacement that it can take", "m", default=math.inf, open_low=True, endless=True)

    def bilinear(self, weight: float) -> Bilinear:
        """Strength mu W, stiffness W / R."""
        return _bilinear(self.friction * weight, weight / self.radius, self.yield_displacement)


@dataclass(frozen=True)
class Bearings(Isolation):
    """Lead-rubber and high-damping rubber bearings: strength at no displacement, stiffness beyond the yield."""

    name = "bearings"

    strength: float = parameter("strength Qd of bearings at no displacement, all together", "N", open_low=True)
    stiffness: float = parameter("their stiffness k2 beyond the yield", "N/m", open_low=True)
    yield_displacement: float = parameter("displacement at which they yield", "m", open_low=True)
    capacity: float = parameter("displacement that they can take", "m", default=math.inf, open_low=True, endless=True)

    def bilinear(self, weight: float) -> Bilinear:
        """Whatever the weight."""
        return _bilinear(self.strength, self.stiffness, self.yield_displacement)


def _bilinear(strength: float, stiffness: float, yield_displacement: float) -> Bilinear:
    initial = stiffness + strength / yield_displacement
    return Bilinear(initial, initial * yield_displacement, stiffness / initial)
