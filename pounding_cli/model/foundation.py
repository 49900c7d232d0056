"""The foundation of a building: mass and rotary inertia on springs and dashpots (`laws.foundation`)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from pounding_cli.laws.foundation import Bearings, FrictionPendulum, Rocking, Rubber, Sway


@dataclass(frozen=True)
class Foundation:
    """Sway and rocking of the base; without `sways` it does not translate, without `rocks` it does not turn.

    Parameters
    ----------
    mass : [kg], > 0 where the base sways
    sway_stiffness : [N/m], > 0 where the base sways
    sway_damping : [N s/m], >= 0
    inertia : rotary inertia of the foundation alone [kg m2], > 0 where the base rocks
    rocking_stiffness : [N m/rad], > 0 where the base rocks
    rocking_damping : [N m s/rad], >= 0
    isolation : isolators under the base, in place of the spring of its sway; they act in elastic analyses too

    Raises
    ------
    ValueError : a value is outside its range
    """

    mass: float = 0.0
    sway_stiffness: float = 0.0
    sway_damping: float = 0.0
    inertia: float = 0.0
    rocking_stiffness: float = 0.0
    rocking_damping: float = 0.0
    sways: bool = True
    rocks: bool = True
    isolation: FrictionPendulum | Bearings | Rubber | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if self.isolation is not None and not (self.mass > 0 and self.sways):
            raise ValueError("foundation: a base on isolators sways, and its mass is above zero")
        for law, switch in (("sway", "sways"), ("rocking", "rocks")):
            try:
                getattr(self, law)
            except ValueError as error:
                raise ValueError(f"{error}, or set {switch} to False") from None

    @cached_property
    def sway(self) -> Sway | None:
        """The spring and dashpot of its translation; None where it does not sway, or on isolators."""
        is_spring = self.sways and self.isolation is None
        return Sway(self.mass, self.sway_stiffness, self.sway_damping) if is_spring else None

    @cached_property
    def rocking(self) -> Rocking | None:
        """Those of its rotation."""
        return Rocking(self.inertia, self.rocking_stiffness, self.rocking_damping) if self.rocks else None
