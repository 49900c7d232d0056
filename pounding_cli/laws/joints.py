"""Links that join two floors for good: a connector, and dampers of four kinds (paper, eq. 10)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from pounding_cli.laws.bilinear import BILINEAR
from pounding_cli.laws.law import JOINED, Behaviour, LinkLaw, in_series, parameter, set_line
from pounding_cli.laws.pounding import DASHPOT_CITATION, DashpotLaw, dashpot_constant


@dataclass(frozen=True)
class Joint(LinkLaw):
    """A force at all closings u_left - u_right.

    It takes the place of the impact unless another link lets its floors strike: a scene in which they would have struck
    leaves out the very thing it is about, so all numbers of that scene lose their meaning (paper, after eq. 10).
    """

    symbol = "bar"
    joins = True
    behaviour = JOINED


@dataclass(frozen=True)
class Connector(Joint):
    """F = s_con v + c v'."""

    name = "connector"
    example = "{link: connector, gap: 5 cm, floors: [3, 5], stiffness: 1/5 mean storey}"
    citation = (
        ("spiliopoulos1996", "permanent connectors, eq. (10)"),
        DASHPOT_CITATION,
        ("westermo1989", "connecting buildings"),
    )
    stiffness_default = "0.2 x mean storey"
    beyond_gap = "struck"
    scaled_parameters = ("stiffness",)

    stiffness: float = parameter("spring s_con", "N/m", open_low=True)
    damping_ratio: float = parameter("damping ratio xi of the dashpot", high=1.0)
    dashpot: DashpotLaw = parameter("mass in eq. (7)", default=DashpotLaw.REDUCED_MASS)

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k [N/m], c [N s/m]."""
        mass = self.dashpot.mass(left_mass, right_mass)
        return self.stiffness, dashpot_constant(self.damping_ratio, self.stiffness, mass)

    def soften(self, flexibility: float) -> Connector:
        """Return the law with its spring in series with another."""
        return replace(self, stiffness=in_series(self.stiffness, flexibility))

    def stored_energy(self, closing: float, force: float) -> float:
        """k v^2 / 2 [J]."""
        return 0.5 * self.stiffness * closing**2


@dataclass(frozen=True)
class Damper(Joint):
    """F = c v'."""

    name = "damper"
    example = "{link: damper, gap: 5 cm, damping_coefficient: 2 MN s/m}"
    beyond_gap = "struck"
    takes_energy = True
    scaled_parameters = ("damping_coefficient",)

    damping_coefficient: float = parameter("dashpot c", "N s/m", open_low=True)

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """No spring, c [N s/m]."""
        return 0.0, self.damping_coefficient

    def soften(self, flexibility: float) -> Damper:
        """Return the law itself: it has no spring, and usually moves by far more than columns bend under it."""
        return self


MAX_STABLE_STEP_AT_REST = 10.0
"""Step of DOP853 with a viscous damper near rest, over mass and slope there [-]."""


def begin_viscous_flow(e: Any, guard: int) -> None:
    """The one branch of a fluid viscous damper, whose force is straight where the power is 1. Parameters: force at
    1 m/s [N], power of the rate [-], rate below which the force is straight, to the power 4."""
    straight = e.p[1] == 1.0
    set_line(e, 0.0, e.p[0] if straight else 0.0, 0.0, -math.inf, math.inf)
    e.smooth = 0 if straight else 1


def viscous_force(e: Any, v: float, r: float) -> float:
    """c v' (v'^4 + w^4)^((a - 1) / 4) [N]."""
    square = r * r
    return e.p[0] * r * (square * square + e.p[2]) ** (0.25 * (e.p[1] - 1.0))


@dataclass(frozen=True)
class Viscous(Joint):
    """F = c |v'|^a sgn v'.

    The power has no derivative at rest, so F = c v' (v'^4 + w^4)^((a - 1) / 4): straight in v' below the rate w, and
    within (1 - a) / 4 (w / v')^4 of the power above it.
    """

    name = "viscous"
    example = "{link: viscous, gap: 5 cm, force_at_1_m_s: 500 kN, exponent: 0.3}"
    citation = (("lin2002", "viscous dampers with an exponent"),)
    beyond_gap = "struck"
    takes_energy = True
    behaviour = Behaviour(begin_viscous_flow, viscous_force)
    scaled_parameters = ("force_at_1_m_s",)

    force_at_1_m_s: float = parameter("force c at a rate of 1 m/s", "N", open_low=True)
    exponent: float = parameter("power a of the rate", low=0.1, high=1.0, open_high=False)
    straight_below: float = parameter("rate w below which the force is straight", "m/s", low=1e-9, default=1e-6)

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """c [N], a [-], w^4."""
        return self.force_at_1_m_s, self.exponent, self.straight_below**4

    def soften(self, flexibility: float) -> Viscous:
        """Return the law itself: it has no spring, and usually moves by far more than columns bend under it."""
        return self

    @property
    def max_slopes(self) -> tuple[float, float]:
        """The slope at rest."""
        return 0.0, self.force_at_1_m_s * self.straight_below ** (self.exponent - 1.0)


def begin_relaxation(e: Any, guard: int) -> None:
    """The one branch of a Maxwell damper, whose force relaxes. Parameters: spring k [N/m] and dashpot c [N s/m]; the
    history variable is the force [N]."""
    set_line(e, e.p[0], 0.0, 0.0, -math.inf, math.inf)
    e.relaxation = e.p[0] / e.p[1]


@dataclass(frozen=True)
class Maxwell(Joint):
    """F' = k (v' - F / c): the spring and the dashpot carry one force F, and their rates add up to v'."""

    name = "maxwell"
    example = "{link: maxwell, gap: 5 cm, damping_coefficient: 2 MN s/m, stiffness: 100 kN/mm}"
    citation = (("zhang2000", "Maxwell dampers between buildings"),)
    stiffness_default = "1 x mean storey"
    beyond_gap = "struck"
    path_dependent = True
    takes_energy = True
    behaviour = Behaviour(begin_relaxation)
    scaled_parameters = ("stiffness", "damping_coefficient")

    stiffness: float = parameter("spring k of the damper and its brace", "N/m", open_low=True)
    damping_coefficient: float = parameter("dashpot c", "N s/m", open_low=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.damping_coefficient < 1e-6 * self.stiffness:  # steps are a few times as long as c / k
            raise ValueError("link: c / k of a Maxwell damper is below 1e-6 s: write `link: damper`, without a spring")

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k [N/m], c [N s/m]."""
        return self.stiffness, self.damping_coefficient

    def soften(self, flexibility: float) -> Maxwell:
        """Return the law with its spring in series with another."""
        return replace(self, stiffness=in_series(self.stiffness, flexibility))

    def stored_energy(self, closing: float, force: float) -> float:
        """F^2 / 2 k in the spring [J]."""
        return 0.5 * force**2 / self.stiffness


@dataclass(frozen=True)
class Friction(Joint):
    """F = k (v - slip) up to the slip force Fs, and +-Fs while the damper slips: bilinear without hardening."""

    name = "friction"
    example = "{link: friction, gap: 5 cm, slip_force: 200 kN}"
    citation = (("pall1982", "friction dampers"), ("bhaskararao2006", "friction dampers between buildings"))
    stiffness_default = "1 x mean storey"
    beyond_gap = "struck"
    path_dependent = True
    behaviour = BILINEAR
    scaled_parameters = ("stiffness", "slip_force")

    stiffness: float = parameter("spring k of the damper and its brace before it slips", "N/m", open_low=True)
    slip_force: float = parameter("force Fs at which it slips", "N", open_low=True)

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k [N/m], Fs / k [m], no hardening."""
        return self.stiffness, self.slip_force / self.stiffness, 0.0

    def soften(self, flexibility: float) -> Friction:
        """Return the law with its spring in series with another."""
        return replace(self, stiffness=in_series(self.stiffness, flexibility))

    def stored_energy(self, closing: float, force: float) -> float:
        """F^2 / 2 k [J]."""
        return 0.5 * force**2 / self.stiffness
