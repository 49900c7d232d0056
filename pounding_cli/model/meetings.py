"""Places where two neighbours can strike each other: slabs that meet, and slabs that strike columns."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from pounding_cli.model.building import Building
from pounding_cli.model.wall import Wall

FLOOR_TOLERANCE = 1e-3
"""Slabs of two buildings that are no further apart than this in height meet [m]."""


@dataclass(frozen=True)
class Strike:
    """A slab that meets no slab and strikes the columns of the storey beside it.

    left_floor, right_floor : on the slab's side its floor, on the other the storey whose columns it strikes, from 1
    left_at, right_at : on the other side the height of the blow above the floor below, over the storey height [-];
        1 on the slab's side
    """

    left_floor: int
    right_floor: int
    left_at: float
    right_at: float

    @property
    def side(self) -> int:
        """Side of the columns: 0 where those of the left building are struck, 1 for the right one."""
        return 0 if self.right_at == 1.0 else 1

    @property
    def storey(self) -> int:
        """Whose columns are struck, from 1."""
        return (self.left_floor, self.right_floor)[self.side]

    @property
    def slab(self) -> int:
        """The floor of the slab, from 1."""
        return (self.right_floor, self.left_floor)[self.side]

    @property
    def at(self) -> float:
        """Height of the blow in the storey over the storey height [-]."""
        return (self.left_at, self.right_at)[self.side]


def find_meetings(left: Building, right: Building) -> tuple[tuple[tuple[int, int], ...], tuple[Strike, ...]]:
    """(floors of `left` and `right`, from 1, whose slabs meet; slabs that strike columns), from the ground up.

    A slab reaches half its thickness up and down from the elevation of its floor. Slabs above the neighbour's roof have
    nothing beside them.
    """
    for wall, building in ((left, right), (right, left)):
        if isinstance(wall, Wall):
            return _at_wall(wall, building), ()
    both = tuple((b.elevation.tobytes(), b.slab) for b in (left, right))
    return _meetings(*both)


def _at_wall(wall: Wall, building: Building) -> tuple[tuple[int, int], ...]:
    """A wall meets every floor up to its height, and a base that moves (floor 0)."""
    if isinstance(building, Wall):
        return ()
    reach = float(wall.height[0]) + 0.5 * building.slab + FLOOR_TOLERANCE
    met = [j for j in range(building.storeys + 1) if building.has_floor(j) and building.level(j) <= reach]
    return tuple((j, j) for j in met)


@functools.lru_cache(maxsize=256)
def _meetings(*both: tuple[bytes, float]) -> tuple[tuple[tuple[int, int], ...], tuple[Strike, ...]]:
    """The same from (elevations [m] as bytes, slab thickness [m]) of both buildings."""
    elevations = [np.frombuffer(levels) for levels, _ in both]
    reach = 0.5 * sum(slab for _, slab in both) + FLOOR_TOLERANCE
    apart = np.abs(elevations[0][:, None] - elevations[1])
    meet: np.ndarray = apart <= reach
    pairs = [(i, j) for i, j in zip(*(each.tolist() for each in np.nonzero(meet)), strict=True)]
    nearest = [(i, j) for i, j in pairs if apart[i, j] == apart[i].min() == apart[:, j].min()]
    strikes = []
    for side in (0, 1):
        levels = np.concatenate(([0.0], elevations[side]))
        for slab, level in enumerate(elevations[1 - side].tolist()):
            if np.any(meet, axis=side)[slab] or level >= levels[-1]:
                continue
            storey = int(np.searchsorted(levels, level))
            at = float((level - levels[storey - 1]) / (levels[storey] - levels[storey - 1]))
            strike = (slab + 1, storey, 1.0, at) if side == 1 else (storey, slab + 1, at, 1.0)
            strikes.append((level, Strike(*strike)))
    ordered = tuple(strike for _, strike in sorted(strikes, key=lambda pair: pair[0]))
    return tuple((i + 1, j + 1) for i, j in nearest), ordered


def column_flexibility(building: Building, storey: int, at: float) -> float:
    """Deflection of struck columns, clamped in the floors above and below, per force at `at` of their height [m/N].

    a^3 b^3 / (3 E I L^3) at a = at L above one end and b above the other, where 12 E I / L^3 is `building.columns` of
    the storey's stiffness.
    """
    assert building.columns is not None
    stiffness = building.columns * float(building.stiffness[storey - 1])
    return 4.0 * (at * (1.0 - at)) ** 3 / stiffness
