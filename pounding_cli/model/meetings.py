"""Places where two neighbours can strike each other: slabs that meet, and slabs that strike columns."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
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
        """Storey whose columns are struck, from 1."""
        return (self.left_floor, self.right_floor)[self.side]

    @property
    def slab(self) -> int:
        """The floor of the slab, from 1."""
        return (self.right_floor, self.left_floor)[self.side]

    @property
    def height(self) -> float:
        """Height of the blow in the storey over the storey height [-]."""
        return (self.left_at, self.right_at)[self.side]


def find_meetings(left: Building, right: Building) -> tuple[tuple[tuple[int, int], ...], tuple[Strike, ...]]:
    """Return the pairs of floors (from 1) whose slabs meet, and the slabs that strike columns, from the ground up.

    A slab reaches half its thickness up and down from the elevation of its floor. Slabs above the neighbour's roof have
    nothing beside them.
    """
    for wall, building in ((left, right), (right, left)):
        if isinstance(wall, Wall):
            return _find_floors_at_wall(wall, building), ()
    return _find_slab_meetings((left.elevation.tobytes(), left.slab), (right.elevation.tobytes(), right.slab))


def _find_floors_at_wall(wall: Wall, building: Building) -> tuple[tuple[int, int], ...]:
    """Return the floors that a wall meets: every floor up to its height, and a base that moves (0)."""
    if isinstance(building, Wall):
        return ()
    reach = float(wall.height[0]) + 0.5 * building.slab + FLOOR_TOLERANCE
    floors = filter(building.has_floor, range(building.storeys + 1))
    return tuple((floor, floor) for floor in floors if building.level(floor) <= reach)


@functools.lru_cache(maxsize=256)
def _find_slab_meetings(
    left: tuple[bytes, float], right: tuple[bytes, float]
) -> tuple[tuple[tuple[int, int], ...], tuple[Strike, ...]]:
    """Return the same from elevations [m] as bytes and slab thickness [m] of both buildings."""
    elevations = [np.frombuffer(levels) for levels, _ in (left, right)]
    reach = reach_of_slabs(left[1], right[1])
    distance = np.abs(elevations[0][:, None] - elevations[1])
    meet: np.ndarray = distance <= reach
    nearest = [
        (i, j) for i, j in np.argwhere(meet).tolist() if distance[i, j] == distance[i].min() == distance[:, j].min()
    ]
    strikes = []
    for side in (0, 1):
        levels = np.concatenate(([0.0], elevations[side]))
        for slab, level in enumerate(elevations[1 - side].tolist()):
            if np.any(meet, axis=side)[slab] or level >= levels[-1]:
                continue
            storey = int(np.searchsorted(levels, level))
            storey_height = levels[storey] - levels[storey - 1]
            height = float((level - levels[storey - 1]) / storey_height)
            on_right = Strike(slab + 1, storey, 1.0, height)
            on_left = Strike(storey, slab + 1, height, 1.0)
            strikes.append((level, on_right if side == 1 else on_left))
    ordered = tuple(strike for _, strike in sorted(strikes, key=lambda pair: pair[0]))
    return tuple((i + 1, j + 1) for i, j in nearest), ordered


def find_end_level(levels: Sequence[float], floor: int, at: float) -> float:
    """Return the elevation of a link's end [m].

    Parameters
    ----------
    levels : elevations of the base and the floors of its building [m]
    floor, at : as of `Link`
    """
    if floor == 0:
        return levels[0]
    return at * levels[floor] + (1.0 - at) * levels[floor - 1]


def face_each_other(link: Link, left: Building, right: Building) -> bool:
    """Return whether the ends of a link are as high as each other, within the slabs of both buildings."""
    if isinstance(left, Wall) or isinstance(right, Wall):
        return True
    left_level = find_end_level((0.0, *left.elevation.tolist()), link.left_floor, link.left_at)
    right_level = find_end_level((0.0, *right.elevation.tolist()), link.right_floor, link.right_at)
    return abs(right_level - left_level) <= reach_of_slabs(left.slab, right.slab)


def reach_of_slabs(left_slab: float, right_slab: float) -> float:
    """Return how far apart in height the middles of two slabs may be that meet [m]; thicknesses [m]."""
    return 0.5 * (left_slab + right_slab) + FLOOR_TOLERANCE


def deflection_of_columns(height: float) -> float:
    """Return the deflection of columns under a force, clamped in the floors above and below, times 12 E I / L^3 [-].

    The deflection per force is a^3 b^3 / (3 E I L^3) at a = height L above one end and b above the other.

    Parameters
    ----------
    height : of the force in the storey over the storey height L [-]
    """
    return 4.0 * (height * (1.0 - height)) ** 3
