"""The foundation of a building: mass and rotary inertia on springs and dashpots (paper, Fig. 1)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Foundation:
    """Sway and rocking of the base; a motion that is None does not exist (that direction is rigid).

    mass [kg], sway_stiffness [N/m], sway_damping [N s/m]; inertia [kg m2], rocking_stiffness [N m/rad],
    rocking_damping [N m s/rad]. With `sways` False the base does not translate; with `rocks` False it does not turn.
    """

    mass: float = 0.0
    sway_stiffness: float = 0.0
    sway_damping: float = 0.0
    inertia: float = 0.0
    rocking_stiffness: float = 0.0
    rocking_damping: float = 0.0
    sways: bool = True
    rocks: bool = True
