"""Supports of a base: springs and dashpots where it sways or rocks (paper, Fig. 1), or isolators.

Friction pendulums stick and slide (`laws.slider`), lead-rubber bearings are bilinear in the displacement of the base
(`laws.bilinear`), high-damping rubber is a spring and a dashpot of equivalent values."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass

from pounding_cli.laws.bilinear import Bilinear
from pounding_cli.laws.law import Law, parameter
from pounding_cli.laws.slider import Slider
from pounding_cli.units import GRAVITY


@dataclass(frozen=True)
class FoundationSpring(Law):
    """F = K d + C d' on the displacement or rotation d of a base; its parameters are, in this order, what is inert
    (mass or rotary inertia), K and C.

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    acts_on = "foundation"
    citation = (("spiliopoulos1996", "foundation springs, Fig. 1"),)


@dataclass(frozen=True)
class Sway(FoundationSpring):
    """Translation of the base."""

    name = "sway"

    mass: float = parameter("mass of the base", "kg", open_low=True)
    sway_stiffness: float = parameter("translational spring", "N/m", open_low=True)
    sway_damping: float = parameter("translational dashpot", "N s/m", default=0.0)


@dataclass(frozen=True)
class Rocking(FoundationSpring):
    """Rotation of the base."""

    name = "rocking"

    inertia: float = parameter("rotary inertia of the base", "kg m2", open_low=True)
    rocking_stiffness: float = parameter("rotational spring", "N m/rad", open_low=True)
    rocking_damping: float = parameter("rotational dashpot", "N m s/rad", default=0.0)


@dataclass(frozen=True)
class Isolation(Law):
    """All isolators of a building together.

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    acts_on = "isolation"

    @abstractmethod
    def law_under(self, weight: float) -> Bilinear | Slider | None:
        """Return their law under a weight [N], which stays the same; None where they are linear."""

    def effective(self, weight: float, displacement: float) -> tuple[float, float]:
        """Period [s] and damping ratio [-] that a linear oscillator has with the secant stiffness, and the energy lost
        in a cycle, of an amplitude D [m] under a weight [N]."""
        law = self.law_under(weight)
        assert isinstance(law, Bilinear)
        beyond = max(displacement - law.yield_drift, 0.0)
        force = law.stiffness * (min(displacement, law.yield_drift) + law.hardening * beyond)
        lost = 4 * (1 - law.hardening) * law.yield_shear * beyond
        period = 2 * math.pi * math.sqrt(weight / GRAVITY * displacement / force)
        return period, lost / (2 * math.pi * force * displacement)


@dataclass(frozen=True)
class FrictionPendulum(Isolation):
    """F = W u / R + mu W sgn(u'): the slider sticks while less than mu W holds it. With a yield displacement a spring
    up to there takes the place of sticking, and a cycle of amplitude D loses less by the share yield displacement / D
    (Zayas, V. A., Low, S. S. and Mahin, S. A. (1990). A simple pendulum technique for achieving seismic isolation.
    Earthquake Spectra 6(2), 317-333)."""

    name = "friction-pendulum"
    citation = (("zayas1990", "friction pendulums"),)

    radius: float = parameter("radius R of the sliding surface of a friction pendulum", "m", open_low=True)
    friction: float = parameter("its friction coefficient mu", "-", high=1.0, open_low=True)
    yield_displacement: float = parameter(
        "displacement at which it slides, of a spring in place of a slider that sticks; 0: it sticks", "m", default=0.0
    )
    capacity: float = parameter(
        "displacement that it can take", "m", default=math.inf, open_low=True, can_be_infinite=True
    )

    def law_under(self, weight: float) -> Bilinear | Slider:
        """Strength mu W, stiffness W / R."""
        strength = self.friction * weight
        stiffness = weight / self.radius
        if self.yield_displacement == 0.0:
            return Slider(stiffness, strength)
        return _bilinear(strength, stiffness, self.yield_displacement)

    def effective(self, weight: float, displacement: float) -> tuple[float, float]:
        """2 pi / sqrt(g (1 / R + mu / D)) and 2 / pi mu / (mu + D / R) (1 - yield displacement / D)."""
        if displacement <= self.yield_displacement:
            return super().effective(weight, displacement)
        stiffness = 1.0 / self.radius + self.friction / displacement  # over the weight
        share = 1.0 - self.yield_displacement / displacement
        damping = 2 / math.pi * self.friction / (self.friction + displacement / self.radius)
        return 2 * math.pi / math.sqrt(GRAVITY * stiffness), share * damping


@dataclass(frozen=True)
class Bearings(Isolation):
    """Lead-rubber and high-damping rubber bearings: strength at no displacement, stiffness beyond the yield."""

    name = "bearings"

    strength: float = parameter("strength Qd of bearings at no displacement, all together", "N", open_low=True)
    stiffness: float = parameter("their stiffness k2 beyond the yield", "N/m", open_low=True)
    yield_displacement: float = parameter("displacement at which they yield", "m", open_low=True)
    capacity: float = parameter(
        "displacement that they can take", "m", default=math.inf, open_low=True, can_be_infinite=True
    )

    def law_under(self, weight: float) -> Bilinear:
        """Whatever the weight."""
        return _bilinear(self.strength, self.stiffness, self.yield_displacement)


@dataclass(frozen=True)
class Rubber(Isolation):
    """High-damping rubber bearings by equivalent values: F = k u + c u', c = 2 xi sqrt(k W / g)."""

    name = "rubber"

    stiffness: float = parameter("equivalent stiffness of rubber bearings, all together", "N/m", open_low=True)
    damping_ratio: float = parameter("their equivalent damping ratio xi", "-", high=1.0)
    capacity: float = parameter(
        "displacement that they can take", "m", default=math.inf, open_low=True, can_be_infinite=True
    )

    def law_under(self, weight: float) -> None:
        """They are linear."""

    def dashpot(self, weight: float) -> float:
        """c [N s/m] under a weight [N]."""
        return 2 * self.damping_ratio * math.sqrt(self.stiffness * weight / GRAVITY)

    def effective(self, weight: float, displacement: float) -> tuple[float, float]:
        """Return the same at any amplitude."""
        return 2 * math.pi * math.sqrt(weight / GRAVITY / self.stiffness), self.damping_ratio


def _bilinear(strength: float, stiffness: float, yield_displacement: float) -> Bilinear:
    initial = stiffness + strength / yield_displacement
    return Bilinear(initial, initial * yield_displacement, stiffness / initial)
