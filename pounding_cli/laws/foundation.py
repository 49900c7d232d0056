"""Springs and dashpots under a base that sways or rocks (paper, Fig. 1)."""

from __future__ import annotations

from dataclasses import dataclass, fields

from pounding_cli.laws.law import Law, parameter


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

    @property
    def numbers(self) -> tuple[float, float, float]:
        """(inert mass, stiffness, dashpot), in SI."""
        inert, stiffness, dashpot = (float(getattr(self, each.name)) for each in fields(self))
        return inert, stiffness, dashpot


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
