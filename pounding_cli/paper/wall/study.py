"""The study file of `pound wall`: keys, units and defaults of the wall, the frame behind it, the striker; what cannot
be."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Annotated, Any, Literal

import numpy as np

from pounding_cli.errors import Issue
from pounding_cli.study.schema.base import Model, spec_field
from pounding_cli.study.schema.quantity import LENGTH, MASS, PLAUSIBLE_RANGES, TIME, ParsedText, Quantity, WholeNumber

_PLACE = re.compile(r"\s{0,9}(mid-storey|floor)\s{1,9}([0-9]{1,9})\s{0,9}\Z")
_HEIGHT = LENGTH.replace(name="height", example="13.5 m, `mid-storey 5` or `floor 4`", open_low=False)


def _read_height(value: Any) -> float | str:
    place = _PLACE.match(value) if isinstance(value, str) else None
    return f"{place[1]} {int(place[2])}" if place else _HEIGHT.read(value)


Height = Annotated[float | str, ParsedText(_read_height, "height of the impact", ("13.5 m", "mid-storey 5", "floor 4"))]
Length = Annotated[float, LENGTH]
Size = Annotated[float, LENGTH.replace(low=1e-3, open_low=False)]
Modulus = Annotated[float, Quantity("modulus", "N/m2", "30 GPa", 0.0, open_low=True, usual=PLAUSIBLE_RANGES["modulus"])]
Density = Annotated[float, Quantity("density", "kg/m3", "2500 kg/m3", 0.0, usual=PLAUSIBLE_RANGES["density"])]
Speed = Annotated[
    float, Quantity("speed", "m/s", "0.5 m/s", 0.0, open_low=True, usual=PLAUSIBLE_RANGES["speed of a blow"])
]
Poisson = Annotated[float, Quantity("Poisson's ratio", "", "0.2", 0.0, 0.5, open_high=True)]
Share = Annotated[float, Quantity("number", "", "0.2", 0.0, 1.0)]
Step = Annotated[float | str, TIME.replace(name="time step", example="0.1 ms", words=("auto",))]


class BumperWallSpec(Model):
    """The bumper wall."""

    length: Length = spec_field(2.0, "length of the wall, at right angles to the gap", "2 m")
    thickness: Length = spec_field(0.25, "thickness of the wall", "25 cm")


class SectionSpec(Model):
    """A rectangular cross-section."""

    width: Length = spec_field(..., "width, out of the frame's plane", "25 cm")
    depth: Length = spec_field(..., "depth, in the frame's plane", "60 cm")


class FrameSpec(Model):
    """The building behind the wall; the mass of a floor is shared over its length, the wall's part over its width."""

    storeys: Annotated[int, WholeNumber(1, 100)] = spec_field(5, "number of storeys", 5)
    storey_height: Length = spec_field(3.0, "storey height", "3 m")
    bays: tuple[Length, ...] = spec_field(
        (5.0, 5.0, 5.0), "spans from the wall's inner edge", ["5 m"], min_length=1, max_length=50
    )
    beam: SectionSpec = spec_field(SectionSpec(width=0.25, depth=0.60), "section of the beams")
    column: SectionSpec = spec_field(SectionSpec(width=0.60, depth=0.60), "section of the columns")
    floor_mass: Annotated[float, MASS] = spec_field(200e3, "mass of every floor", "200 t")

    @property
    def height(self) -> float:
        """Height of the building [m]."""
        return self.storeys * self.storey_height

    @property
    def floors(self) -> np.ndarray:
        """Floor elevations [m], shape (storeys,)."""
        return self.storey_height * np.arange(1, self.storeys + 1)


class ConcreteSpec(Model):
    """Linear elastic concrete."""

    young: Modulus = spec_field(30e9, "Young's modulus", "30 GPa")
    poisson: Poisson = spec_field(0.2, "Poisson's ratio", 0.2)
    density: Density = spec_field(0.0, "density of the wall beyond the floor masses", "2500 kg/m3")


class StrikerSpec(Model):
    """The floor that strikes, a rigid mass."""

    mass: Annotated[float, MASS] = spec_field(200e3, "mass of the striker", "200 t")
    speed: Speed = spec_field(0.5, "speed of the striker", "0.5 m/s")
    height: Height = spec_field("mid-storey 5", "where it strikes", "mid-storey 5")


class ContactSpec(Model):
    """The contact: its area and its bond. Under one node stress grows without bound as the mesh is refined."""

    over: Literal["patch", "node"] = spec_field("patch", "patch of uniform pressure, or node", "patch")
    bond: Literal["unilateral", "glued"] = spec_field("unilateral", "unilateral or glued", "unilateral")
    patch: Length = spec_field(0.20, "height of the patch: the striking slab's thickness", "20 cm")


class MeshSpec(Model):
    """The mesh of the wall: four-node (linear) or nine-node (quadratic) quadrilaterals."""

    size: Size = spec_field(0.05, "element size at the contact", "0.05 m")
    growth: Share = spec_field(0.2, "growth of the size per metre from the contact", 0.2)
    element: Literal["linear", "quadratic"] = spec_field("quadratic", "linear or quadratic", "quadratic")


class IntegrationSpec(Model):
    """The integration in time."""

    end: Annotated[float, TIME] = spec_field(0.060, "end of the analysis", "60 ms")
    step: Step = spec_field("auto", "time step, or auto", "0.1 ms")
    rho: Share = spec_field(0.9, "spectral radius at infinite frequency; 1: no damping", 0.9)


class WallStudySpec(Model):
    """A study of the bumper wall (paper, Fig. 8); everything not said is the paper's."""

    title: str = spec_field(..., "one line that says what is studied", "The bumper wall of Fig. 8")
    wall: BumperWallSpec = BumperWallSpec()
    frame: FrameSpec = FrameSpec()
    concrete: ConcreteSpec = ConcreteSpec()
    striker: StrikerSpec = StrikerSpec()
    contact: ContactSpec = ContactSpec()
    mesh: MeshSpec = MeshSpec()
    time: IntegrationSpec = IntegrationSpec()
    averaging_length: Size = spec_field(0.5, "side of the cell over which stress is averaged", "0.5 m")
    sweep: Any = spec_field(None, "keys and the values they take", {"wall.length": ["1 m", "2 m"]})

    @property
    def height(self) -> float:
        """Height at which the striker hits, above the base [m]."""
        if not isinstance(self.striker.height, str):
            return self.striker.height
        word, number = self.striker.height.split()
        return (int(number) - (0.5 if word == "mid-storey" else 0.0)) * self.frame.storey_height

    @property
    def patch(self) -> tuple[float, float]:
        """Lower and upper edge of the contact on the face [m]; cut where the wall ends; equal for a node."""
        half = self.contact.patch / 2 if self.contact.over == "patch" else 0.0
        return max(self.height - half, 0.0), min(self.height + half, self.frame.height)

    def issues(self) -> Iterator[Issue]:
        """Yield what cannot be in a study: its place, a message and what to write."""
        top = self.frame.height
        height = self.height
        if not 0 <= height <= top:
            where = f"{height:g} m" if isinstance(self.striker.height, float) else self.striker.height
            message = f"the striker hits at {where}, beside the wall (0 to {top:g} m)"
            yield Issue(("striker",), message, "give a height on the wall's face")
            return
        if self.contact.over == "node" and height == 0:
            message = "the striker hits the fixed node at the base, which cannot move: the force is unbounded"
            yield Issue(("striker",), message, "use `over: patch`, or a height above the base")
        if self.averaging_length > min(self.wall.length, top):
            message = f"the averaging length ({self.averaging_length:g} m) exceeds the wall"
            yield Issue(("averaging_length",), message, f"write at most {min(self.wall.length, top):g} m")
