"""The bumper wall of Fig. 8 as frozen dataclasses: geometry, concrete, striker, contact, mesh and time."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from pounding_cli.errors import InputError, Problem


class Over(StrEnum):
    """What the striker pushes on: one node (stress grows without bound as the mesh is refined) or a patch."""

    NODE = "node"
    PATCH = "patch"


class Bond(StrEnum):
    """Whether the striker may separate from the wall, or is glued to it."""

    UNILATERAL = "unilateral"
    GLUED = "glued"


class Shape(StrEnum):
    """Four-node (bilinear) or nine-node (biquadratic) quadrilaterals."""

    LINEAR = "linear"
    QUADRATIC = "quadratic"


@dataclass(frozen=True)
class Section:
    """A rectangular cross-section: width out of the plane, depth in the plane of the frame [m]."""

    width: float
    depth: float

    @property
    def area(self) -> float:
        """[m2]"""
        return self.width * self.depth

    @property
    def inertia(self) -> float:
        """Second moment of area about the axis across the frame's plane [m4]."""
        return self.width * self.depth**3 / 12

    @property
    def modulus(self) -> float:
        """Elastic section modulus [m3]."""
        return self.width * self.depth**2 / 6


@dataclass(frozen=True)
class Frame:
    """The building behind the wall (paper, Fig. 8).

    storeys [-]; storey_height [m]; bays [m]: spans from the wall's inner edge, a column at the end of each;
    floor_mass [kg]: shared over the floor's length, the wall's part spread over its width.
    """

    storeys: int = 5
    storey_height: float = 3.0
    bays: tuple[float, ...] = (5.0, 5.0, 5.0)
    beam: Section = Section(0.25, 0.60)
    column: Section = Section(0.60, 0.60)
    floor_mass: float = 200e3

    @property
    def height(self) -> float:
        """Height of the building [m]."""
        return self.storeys * self.storey_height

    @property
    def floors(self) -> np.ndarray:
        """Floor elevations [m], shape (storeys,)."""
        return self.storey_height * np.arange(1, self.storeys + 1)

    @property
    def columns(self) -> np.ndarray:
        """Column positions from the wall's inner edge [m], shape (bays,)."""
        return np.cumsum(self.bays)


@dataclass(frozen=True)
class Concrete:
    """Young's modulus [N/m2], Poisson's ratio [-], density of the wall beyond the floor masses [kg/m3]."""

    young: float = 30e9
    poisson: float = 0.2
    density: float = 0.0


@dataclass(frozen=True)
class Striker:
    """A rigid mass [kg] with a speed [m/s] that strikes at a height above the base [m]."""

    mass: float = 200e3
    speed: float = 0.5
    height: float = 13.5


@dataclass(frozen=True)
class Contact:
    """Over what and how: a patch [m] of uniform pressure centred on the striker's height, or a node."""

    over: Over = Over.PATCH
    bond: Bond = Bond.UNILATERAL
    patch: float = 0.20


@dataclass(frozen=True)
class Mesh:
    """Element size at the contact [m], its growth per metre of distance from it [-], and the shape."""

    size: float = 0.125
    growth: float = 0.0
    shape: Shape = Shape.QUADRATIC

    def lines(self, distance: float) -> float:
        """About how many elements it takes from the contact to a distance [m] from it [-]."""
        if self.growth <= 0:
            return distance / self.size
        return math.log1p(self.growth * distance / self.size) / self.growth


@dataclass(frozen=True)
class Time:
    """End [s], step [s] (None: from the contact's own period) and the integrator's rho [-].

    rho is the spectral radius at infinite frequency: 1 has no numerical damping.
    """

    end: float = 0.060
    step: float | None = None
    rho: float = 0.9


@dataclass(frozen=True)
class WallModel:
    """Everything the transient of one impact needs, SI.

    Parameters
    ----------
    length, thickness : of the wall [m]
    averaging_length : side of the square cell over which stress is averaged [m]
    frame, concrete, striker, contact, mesh, time : as above

    Raises
    ------
    InputError : for a model without physical meaning, every problem named
    """

    length: float = 2.0
    thickness: float = 0.25
    averaging_length: float = 0.5
    frame: Frame = field(default_factory=Frame)
    concrete: Concrete = field(default_factory=Concrete)
    striker: Striker = field(default_factory=Striker)
    contact: Contact = field(default_factory=Contact)
    mesh: Mesh = field(default_factory=Mesh)
    time: Time = field(default_factory=Time)

    def __post_init__(self) -> None:
        problems = [Problem(message, hint) for bad, message, hint in self._rules() if bad]
        if problems:
            raise InputError(problems)

    @property
    def patch(self) -> tuple[float, float]:
        """Lower and upper edge of the contact on the face [m]; cut where the wall ends; equal for a node."""
        if self.contact.over is Over.NODE:
            return self.striker.height, self.striker.height
        half = self.contact.patch / 2
        low, high = self.striker.height - half, self.striker.height + half
        return max(low, 0.0), min(high, self.frame.height)

    @property
    def patch_is_cut(self) -> bool:
        """Whether part of the patch lies beyond the wall."""
        low, high = self.patch
        return self.contact.over is Over.PATCH and high - low < self.contact.patch * (1 - 1e-9)

    def _rules(self) -> list[tuple[bool, str, str]]:
        """(is broken, what is wrong, what to write) for every rule."""
        f, c, s, k, m, t = self.frame, self.concrete, self.striker, self.contact, self.mesh, self.time
        sizes = {
            "wall length": self.length,
            "wall thickness": self.thickness,
            "averaging length": self.averaging_length,
            "storey height": f.storey_height,
            "beam width": f.beam.width,
            "beam depth": f.beam.depth,
            "column width": f.column.width,
            "column depth": f.column.depth,
            "floor mass": f.floor_mass,
            "Young's modulus": c.young,
            "striker mass": s.mass,
            "striker speed": s.speed,
            "contact patch": k.patch,
            "mesh size": m.size,
            "time step": 1.0 if t.step is None else t.step,
            "end time": t.end,
        } | {f"bay {i}": bay for i, bay in enumerate(f.bays, 1)}
        rules = [
            (not (np.isfinite(value) and value > 0), f"the {name} is {value:g}", "write a positive number")
            for name, value in sizes.items()
        ]
        if any(bad for bad, _, _ in rules):
            return rules
        elements = self.mesh.lines(self.length) * (
            self.mesh.lines(s.height) + self.mesh.lines(f.height - s.height) if 0 <= s.height <= f.height else 0
        )
        rules += [
            (f.storeys < 1, f"the frame has {f.storeys} storeys", "write at least 1"),
            (not f.bays, "the frame has no bay", "give at least one bay length, e.g. bays: [5 m]"),
            (
                not 0 <= c.poisson < 0.5,
                f"Poisson's ratio is {c.poisson:g}",
                "write a number from 0 to less than 0.5, 0.2 for concrete",
            ),
            (
                not 0 <= c.density < np.inf,
                f"the density is {c.density:g}",
                "write 0 or more, e.g. 2500 kg/m3",
            ),
            (
                not 0 <= s.height <= f.height,
                f"the striker hits at {s.height:g} m, beside the wall (0 to {f.height:g} m)",
                "give a height on the wall's face",
            ),
            (
                k.over is Over.NODE and s.height == 0,
                "the striker hits the fixed node at the base, which cannot move: the force is unbounded",
                "use `over: patch`, or a height above the base",
            ),
            (
                k.over is Over.PATCH and k.patch > f.height,
                f"the patch ({k.patch:g} m) is longer than the wall is high ({f.height:g} m)",
                "give the thickness of the striking slab, e.g. 20 cm",
            ),
            (
                self.averaging_length > min(self.length, f.height),
                f"the averaging length ({self.averaging_length:g} m) exceeds the wall",
                f"write at most {min(self.length, f.height):g} m",
            ),
            (not 0 <= m.growth <= 1, f"the mesh growth is {m.growth:g}", "write 0 (even mesh) to 1"),
            (
                elements > 250_000,
                f"a mesh of {m.size:g} m with growth {m.growth:g} has {elements:.0f} elements",
                "write a larger mesh size, or `growth: 0.2` to let elements grow away from the contact",
            ),
            (not 0 <= t.rho <= 1, f"rho is {t.rho:g}", "write 0 (strong numerical damping) to 1 (none)"),
            (
                t.step is not None and t.step > t.end / 10,
                f"the time step {t.step or 0:g} s leaves fewer than 10 steps until {t.end:g} s",
                "write a smaller step, or a later end",
            ),
            (
                t.end / (t.step or 1e-4) > 200_000,
                f"{t.end / (t.step or 1e-4):.0f} time steps are too many",
                "write a larger step, or an earlier end",
            ),
        ]
        return rules
