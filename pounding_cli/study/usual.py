"""What is plausible: one table of ranges, which quantities of the schema carry."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from pounding_cli.units import GRAVITY

LENGTHS = {"cm": 1e-2, "mm": 1e-3, "m": 1.0}
MASSES = {"t": 1e3, "kg": 1.0}
TIMES = {"s": 1.0, "ms": 1e-3}
FORCES = {"kN": 1e3, "MN": 1e6, "N": 1.0}
WEIGHTS = {"W": 1.0, "%": 0.01}
STIFFNESSES = {"kN/mm": 1e6, "kN/m": 1e3, "MN/mm": 1e9, "N/m": 1.0}
ACCELERATIONS = {"g": GRAVITY, "m/s2": 1.0}


@dataclass(frozen=True, eq=False)
class Plausible:
    """A range outside of which a value is more likely a slip than meant.

    low, high : the range, in SI
    reason : where it comes from
    units : units a person writes the value in with their factor to SI, the likeliest first
    name : of the quantity
    """

    low: float
    high: float
    reason: str
    units: Mapping[str, float]
    name: str = ""

    def holds(self, value: float) -> bool:
        """Whether a value is plausible; nothing at all (no gap, no damping) is."""
        return value == 0 or self.low <= value <= self.high


_RANGES = {
    "gap": Plausible(
        1e-4, 1.0, "gaps between neighbours are millimetres to decimetres; the largest a code asks for is near 1 m",
        LENGTHS,
    ),
    "floor mass": Plausible(
        5e3, 1e7, "a floor weighs about 0.5 to 1.5 t a square metre: 5 t is a shed, 10000 t a whole block", MASSES
    ),
    "storey height": Plausible(2.0, 12.0, "people stand in a storey; halls and lobbies reach 12 m", LENGTHS),
    "period": Plausible(0.02, 10.0, "the tallest buildings there are have about 10 s", TIMES),
    "period of a storey": Plausible(
        0.02, 0.5, "frames and walls have 0.05 to 0.2 s a storey", TIMES
    ),
    "damping ratio": Plausible(0.006, 0.3, "structures have 1 to 10 % of critical; dampers reach 30 %", {"%": 0.01}),
    "base yield shear over weight": Plausible(
        0.005, 3.0, "codes design for 2 to 30 % of the weight; overstrength brings that to 100 % at most", FORCES
    ),
    "impact stiffness over the stiffest storey's": Plausible(
        0.5, 1e4, "floors that meet are stiffer than the columns below; studies take 5 to 1000 times", STIFFNESSES
    ),
    "link stiffness over the stiffest storey's": Plausible(
        1e-5, 1e3, "below that the link does nothing, above it is an impact", STIFFNESSES
    ),
    "peak ground acceleration asked for": Plausible(
        0.04 * GRAVITY, 3 * GRAVITY, "damage begins near 0.05 g, recorded peaks reach 3 g", ACCELERATIONS
    ),
    "peak of a motion as read and as used": Plausible(
        0.0, 2 * GRAVITY, "few motions were ever recorded with more than 2 g; above, the unit is often wrong",
        ACCELERATIONS,
    ),
    "peak of a motion as used": Plausible(
        0.001 * GRAVITY, 5 * GRAVITY, "below 0.001 g a motion is not felt; above 5 g the unit is wrong", ACCELERATIONS
    ),
}  # fmt: skip

RANGES = {name: replace(fits, name=name) for name, fits in _RANGES.items()}
"""What is plausible, one row a quantity."""
