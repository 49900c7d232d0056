"""Floors that twist in OpenSees: `rigidDiaphragm` ties the nodes of frame lines and contacts to the centre of mass."""

from __future__ import annotations

import openseespy.opensees as ops

PENALTY = 1e14
"""Stiffness that holds a diaphragm [N/m], [N m]."""


class Diaphragms:
    """The nodes, materials and elements of a scene in OpenSees, numbered as they are made.

    centre : y of the centres of mass along the street, of the building that is made [m]
    """

    def __init__(self) -> None:
        self.centre = 0.0
        self.node = 0
        self.element = 0
        self.watched: list[int] = []

    def floor(self, mass: float, inertia: float) -> int:
        """Make the centre of mass of a floor, which moves along the row and turns; return its node."""
        self.node += 1
        ops.node(self.node, 0.0, self.centre, 0.0)
        ops.mass(self.node, mass, 0.0, 0.0, 0.0, 0.0, inertia)
        ops.fix(self.node, 0, 1, 1, 1, 1, 0)
        return self.node

    def place(self, floor: int, y: float) -> int:
        """Make a place of a floor; return its node."""
        self.node += 1
        ops.node(self.node, 0.0, self.centre + y, 0.0)
        ops.fix(self.node, 0, 0, 1, 1, 1, 0)
        ops.rigidDiaphragm(3, floor, self.node)
        return self.node

    def ground(self, y: float) -> int:
        """Make a node that does not move; return it."""
        self.node += 1
        ops.node(self.node, 0.0, self.centre + y, 0.0)
        ops.fix(self.node, *[1] * 6)
        return self.node

    def join(self, below: int, above: int, direction: int, rayleigh: bool) -> int:
        """Join two nodes by the material that was made for it; return the element."""
        ops.element(
            "zeroLength", self.element, below, above, "-mat", self.element, "-dir", direction,
            "-doRayleigh", int(rayleigh),
        )  # fmt: skip
        return self.element

    def next(self) -> int:
        """Return the number of the next element and of its material."""
        self.element += 1
        return self.element
