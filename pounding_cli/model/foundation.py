"""The foundation of a building: mass and rotary inertia on springs and dashpots (paper, Fig. 1)."""

from __future__ import annotations

import math
from dataclasses import dataclass


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

    def __post_init__(self) -> None:
        sway = ("mass", "sway_stiffness", "sway_damping")
        rock = ("inertia", "rocking_stiffness", "rocking_damping")
        for exists, names, switch in ((self.sways, sway, "sways"), (self.rocks, rock, "rocks")):
            if not exists:
                continue
            for name in names:
                value = getattr(self, name)
                if not math.isfinite(value) or value < 0:
                    raise ValueError(f"foundation: {name} is {value:g}; it must be finite and not negative")
                if value == 0 and not name.endswith("damping"):
                    raise ValueError(f"foundation: {name} is 0; give a value above zero, or set {switch} to False")
