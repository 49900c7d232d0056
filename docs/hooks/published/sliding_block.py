"""A block that slides against a spring and back beside an example of OpenSees."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt
from typing import Any

from comparison import Entry, Row, compare
from scipy.constants import g as GRAVITY

MASS, STIFFNESS, FRICTION = 8e3, 2e5, 0.25
SPEED, WAY = 5.0, 2.0
"""Of the block when it is let go [m/s], and from there to the spring [m]."""


def find_travel() -> tuple[float, float]:
    """Return by how much the block compresses the spring, and how far from the spring it comes to rest [m].

    The kinetic energy, less the friction on the way, is in the spring at the turn; that of the spring goes into the
    friction on the way back.
    """
    slip_force = FRICTION * MASS * GRAVITY
    energy = MASS * SPEED**2 / 2 - slip_force * WAY
    compression = (sqrt(slip_force**2 + 2 * STIFFNESS * energy) - slip_force) / STIFFNESS
    return compression, STIFFNESS * compression**2 / 2 / slip_force - compression


def compare_sliding_block(solved: Any) -> Iterator[Row]:
    """Yield the compression of the spring and the way back."""
    sway = solved.results.history().dataset["sway"].sel(building="block")
    compression = solved.table("link")["peak_force"].iloc[0] / STIFFNESS
    rest = float(sway[-1] - sway.min()) - compression
    exact_compression, exact_rest = find_travel()
    why = "by hand, and rounded: energy gives {:.4f}"
    yield compare("compression of the spring [m]", 0.688, compression, ".3f", why.format(exact_compression))
    yield compare("way back from the spring [m]", 1.73, rest, ".2f", why.format(exact_rest))


ENTRY = Entry(compare_sliding_block)
