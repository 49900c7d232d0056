"""A wall beside a building: the wall of a moat, the rigid wall of a neighbour, the line of a property."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from pounding_cli.model.building import Building

MIN_HEIGHT = 1e-3
"""Height of a wall that ends at the ground [m]."""

UNLIMITED_HEIGHT = 1e6
"""Height of a wall that has none of its own [m]."""


@dataclass(frozen=True, eq=False, repr=False)
class Wall(Building):
    """One mass in front of the soil, which every floor and every moving base of a neighbour meets up to its height.

    moves : on the spring `stiffness` and dashpot beta x stiffness of the soil behind it; False: it moves as the ground
        does, and its mass and stiffness have no effect
    """

    moves: bool = True

    meeting_fields: ClassVar[tuple[str, ...]] = (*Building.meeting_fields, "height")

    @classmethod
    def build(
        cls,
        name: str,
        height: float = UNLIMITED_HEIGHT,
        mass: float = 0.0,
        stiffness: float = np.inf,
        damping: float = 0.0,
    ) -> Wall:
        """Return a wall with the soil behind it.

        Parameters
        ----------
        height : above the ground [m]; UNLIMITED_HEIGHT: as high as its neighbours (`raise_to`)
        mass : with the soil that moves along [kg], > 0 unless it moves as the ground does
        stiffness : of the soil [N/m], > 0; inf for a wall that moves as the ground does
        damping : dashpot of the soil [N s/m], >= 0

        Raises
        ------
        ValueError : a value is outside its range
        """
        moves = bool(np.isfinite(stiffness))
        return cls(
            name,
            mass=np.array([mass if moves else 1.0]),
            height=np.array([max(height, MIN_HEIGHT)]),
            stiffness=np.array([stiffness if moves else 1.0]),
            yield_shear=np.array([np.inf]),
            hardening=np.zeros(1),
            alpha=0.0,
            beta=damping / stiffness if moves else 0.0,
            moves=moves,
        )

    def raise_to(self, roof: float) -> Wall:
        """Return the wall up to the highest roof [m] beside it, where it has no height of its own."""
        if self.height[0] != UNLIMITED_HEIGHT:
            return self
        return replace(self, height=np.array([roof]))

    @cached_property
    def periods(self) -> np.ndarray:
        """The period of the wall on the soil [s], shape (1,); NaN where it moves as the ground does."""
        return super().periods if self.moves else np.full(1, np.nan)

    def storey_property(self, name: str) -> np.ndarray:
        """Return a property of its one storey, shape (1,); NaN for a mass or stiffness without effect."""
        if self.moves or name in ("height", "yield_shear"):
            return getattr(self, name)
        return np.full(1, np.nan)

    def has_floor(self, floor: int) -> bool:
        """Return whether a link may end there: at any floor of its neighbour."""
        return floor >= 0
