"""Guards: the ends of a branch of a law. The fields of an element say which of them its branch asks for."""

from __future__ import annotations

(
    START,
    LOW,
    HIGH,
    SLOWER,
    FASTER,
    LEVELS,
    SIGN_CHANGE,
    CROSSES,
    SLIPS_RIGHT,
    SLIPS_LEFT,
    COLLAPSE_LOW,
    COLLAPSE_HIGH,
) = range(-1, 11)
"""START : no guard: the element is at rest before the motion begins
LOW, HIGH : the deformation v falls to `low`, rises to `high`
SLOWER, FASTER : the rate v' falls to `slow`, rises to `fast`
LEVELS : the rate stops growing, v'' = 0; asked for where `levels` is 1
SIGN_CHANGE : the force turns from pushing to pulling where it acts, back where it is cut off; asked for where `cuts`
    is 1
CROSSES : the history variable passes zero; where `crosses` is not 0
SLIPS_RIGHT, SLIPS_LEFT : what pulls at a slider that sticks overcomes its friction; asked for where `holds` is 1
COLLAPSE_LOW, COLLAPSE_HIGH : the drift exceeds the collapse drift: the run ends"""

INSIDE = 1e-14
"""Part of the elastic range and of the deformation by which a turning point is moved into the elastic range: in numbers
with rounding it would lie beyond it half of the time."""
