"""Where a branch of a law ends. A branch says by the fields of its element which of these it asks for."""

START = -1
"""No guard: the element is at rest before the motion begins."""

LOW = 0
"""The deformation v falls to `low`."""

HIGH = 1
"""The deformation v rises to `high`."""

SLOWER = 2
"""The rate v' falls to `slow`."""

FASTER = 3
"""The rate v' rises to `fast`."""

LEVELS = 4
"""The rate stops growing, v'' = 0; asked for where `levels` is 1."""

FORCE = 5
"""The force changes its sign: from pushing to pulling where it acts, back where it is cut off; where `cuts` is 1."""

CROSSES = 6
"""The history variable passes zero; where `crosses` is 1."""

COLLAPSE_LOW, COLLAPSE_HIGH = 7, 8
"""The drift passes what the building stands: the run ends."""

INSIDE = 1e-14
"""Part of the elastic range and of the deformation by which a turning point is moved into the elastic range: in numbers
with rounding it would lie beyond it half of the time."""
