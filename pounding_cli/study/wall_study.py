"""The YAML study of `pound wall`: its keys, units and defaults, and the models of its sweep."""

from __future__ import annotations

import re
from typing import Annotated, Any

from pydantic import Field

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted
from pounding_cli.study import usual
from pounding_cli.study.base import Model
from pounding_cli.study.file import Map, Problems, locate
from pounding_cli.study.plausible import doubt_values
from pounding_cli.study.quantity import LENGTH, MASS, TIME, Quantity, Text, Whole, refuse
from pounding_cli.study.system_study import SystemModel
from pounding_cli.wall import model as wall
from pounding_cli.wall.model import WallModel

_PLACE = re.compile(r"\s{0,9}(mid-storey|floor)\s{1,9}([0-9]{1,9})\s{0,9}\Z")
Length = Annotated[float, LENGTH]
Mass = Annotated[float, MASS]
Side = Annotated[float, LENGTH.but(usual=usual.SECTION)]
_HEIGHT = LENGTH.but(name="height", example="13.5 m", low=0.0, open_low=False)


def _read_height(value: Any) -> float | str:
    if isinstance(value, str) and (found := _PLACE.match(value)):
        return f"{found[1]} {int(found[2])}"
    if isinstance(value, str) and value.strip()[:3] in ("mid", "flo"):
        raise refuse(f"'{value}' is not a height", "write a height, e.g. 13.5 m, or `mid-storey 5`, or `floor 4`")
    return _HEIGHT.read(value)


Height = Annotated[float | str, Text(_read_height, "height of the impact", ("13.5 m", "mid-storey 5", "floor 4"))]
Modulus = Annotated[float, Quantity("modulus", "N/m2", "30 GPa", 0.0, open_low=True, usual=usual.MODULUS)]
Poisson = Annotated[float, Quantity("Poisson's ratio", "", "0.2", 0.0, 0.5, open_high=True)]
Density = Annotated[float, Quantity("density", "kg/m3", "2500 kg/m3", 0.0, usual=usual.DENSITY)]
Speed = Annotated[float, Quantity("speed", "m/s", "0.5 m/s", 0.0, open_low=True, usual=usual.SPEED)]
Share = Annotated[float, Quantity("number", "", "0.2", 0.0, 1.0)]
Step = Annotated[float | str, TIME.but(name="time step", example="0.1 ms", words=("auto",))]


class WallSpec(Model):
    """The bumper wall."""

    length: Annotated[float, LENGTH.but(usual=usual.WALL_LENGTH)] = Field(
        default=2.0, description="length of the wall, at right angles to the gap", examples=["2 m"]
    )
    thickness: Annotated[float, LENGTH.but(usual=usual.WALL_THICKNESS)] = Field(
        default=0.25, description="thickness of the wall", examples=["25 cm"]
    )


class SectionSpec(Model):
    """A rectangular cross-section."""

    width: Side = Field(description="width, out of the frame's plane", examples=["25 cm"])
    depth: Side = Field(description="depth, in the frame's plane", examples=["60 cm"])


class FrameSpec(Model):
    """The building behind the wall."""

    storeys: Annotated[int, Whole(1, 100)] = Field(
        default=5, ge=1, le=100, description="number of storeys", examples=[5]
    )
    storey_height: Annotated[float, LENGTH.but(usual=usual.RANGES["storey height"])] = Field(
        default=3.0, description="storey height", examples=["3 m"]
    )
    bays: tuple[Length, ...] = Field(
        default=(5.0, 5.0, 5.0),
        min_length=1,
        max_length=50,
        description="spans from the wall's inner edge",
        examples=[["5 m"]],
    )
    beam: SectionSpec = Field(default=SectionSpec(width=0.25, depth=0.60), description="section of the beams")
    column: SectionSpec = Field(default=SectionSpec(width=0.60, depth=0.60), description="section of the columns")
    floor_mass: Mass = Field(default=200e3, description="mass of every floor", examples=["200 t"])


class ConcreteSpec(Model):
    """Linear elastic concrete."""

    young: Modulus = Field(default=30e9, description="Young's modulus", examples=["30 GPa"])
    poisson: Poisson = Field(default=0.2, description="Poisson's ratio", examples=[0.2])
    density: Density = Field(
        default=0.0, description="density of the wall beyond the floor masses", examples=["2500 kg/m3"]
    )


class StrikerSpec(Model):
    """The floor that strikes."""

    mass: Mass = Field(default=200e3, description="mass of the striker", examples=["200 t"])
    speed: Speed = Field(default=0.5, description="speed of the striker", examples=["0.5 m/s"])
    height: Height = Field(default="mid-storey 5", description="where it strikes", examples=["mid-storey 5"])


class ContactSpec(Model):
    """What touches, and how."""

    over: wall.Over = Field(default=wall.Over.PATCH, description="patch or node", examples=["patch"])
    bond: wall.Bond = Field(default=wall.Bond.UNILATERAL, description="unilateral or glued", examples=["unilateral"])
    patch: Annotated[float, LENGTH.but(usual=usual.PATCH)] = Field(
        default=0.20, description="height of the patch: the striking slab's thickness", examples=["20 cm"]
    )


class MeshSpec(Model):
    """The mesh of the wall."""

    size: Length = Field(default=0.05, description="element size at the contact", examples=["0.05 m"])
    growth: Share = Field(default=0.2, description="growth of the size per metre from the contact", examples=[0.2])
    element: wall.Shape = Field(default=wall.Shape.QUADRATIC, description="linear or quadratic", examples=["quadratic"])


class TimeSpec(Model):
    """The integration in time."""

    end: Annotated[float, TIME.but(usual=usual.END)] = Field(
        default=0.060, description="end of the analysis", examples=["60 ms"]
    )
    step: Step = Field(default="auto", description="time step, or auto", examples=["0.1 ms"])
    rho: Share = Field(default=0.9, description="spectral radius at infinite frequency; 1: no damping", examples=[0.9])


class WallStudyModel(SystemModel):
    """A study of the bumper wall (paper, Fig. 8); everything not said is the paper's."""

    title: str = Field(description="one line that says what is studied", examples=["The bumper wall of Fig. 8"])
    wall: WallSpec = WallSpec()
    frame: FrameSpec = FrameSpec()
    concrete: ConcreteSpec = ConcreteSpec()
    striker: StrikerSpec = StrikerSpec()
    contact: ContactSpec = ContactSpec()
    mesh: MeshSpec = MeshSpec()
    time: TimeSpec = TimeSpec()
    averaging_length: Length = Field(default=0.5, description="side of the cell over which stress is averaged")
    sweep: Any = Field(
        default=None, description="keys and the values they take", examples=[{"wall.length": ["1 m", "2 m"]}]
    )

    def system(self, tree: Map, where: str, problems: Problems) -> WallModel | None:
        """The wall, the frame behind it and the striker."""
        try:
            return _model(self)
        except InputError as refused:
            for problem in refused.problems:
                problems.add(_mark(problem, tree), problem.message + where, problem.hint)
        return None

    def doubt(self, model: WallModel, tree: Map, notes: Problems) -> None:
        """Note what is unlikely at a point of the sweep."""
        doubt_values(self, tree, (), notes)


def _mark(problem: Problem, tree: Map) -> tuple[int, int]:
    """The section a problem of the model speaks of, as far as its words tell."""
    for word in ("striker", "patch", "mesh", "step", "bay", "averaging", "density", "Poisson"):
        if word in problem.message:
            path = {
                "striker": ("striker",),
                "patch": ("contact",),
                "mesh": ("mesh",),
                "step": ("time",),
                "bay": ("frame", "bays"),
                "averaging": ("averaging_length",),
            }.get(word, ("concrete",))
            return locate(tree, path)
    return tree.mark


def _model(spec: WallStudyModel) -> WallModel:
    frame = wall.Frame(
        spec.frame.storeys,
        spec.frame.storey_height,
        spec.frame.bays,
        wall.Section(spec.frame.beam.width, spec.frame.beam.depth),
        wall.Section(spec.frame.column.width, spec.frame.column.depth),
        spec.frame.floor_mass,
    )
    height = spec.striker.height
    if isinstance(height, str):
        word, number = height.split()
        if not 1 <= int(number) <= frame.storeys:
            raise InputError(
                Problem(
                    f"the striker hits at {height}, but the frame has {counted(frame.storeys, 'storey')}",
                    "name one that exists",
                )
            )
        height = (int(number) - (0.5 if word == "mid-storey" else 0.0)) * frame.storey_height
    step = None if isinstance(spec.time.step, str) else spec.time.step
    return WallModel(
        length=spec.wall.length,
        thickness=spec.wall.thickness,
        averaging_length=spec.averaging_length,
        frame=frame,
        concrete=wall.Concrete(spec.concrete.young, spec.concrete.poisson, spec.concrete.density),
        striker=wall.Striker(spec.striker.mass, spec.striker.speed, height),
        contact=wall.Contact(spec.contact.over, spec.contact.bond, spec.contact.patch),
        mesh=wall.Mesh(spec.mesh.size, spec.mesh.growth, spec.mesh.element),
        time=wall.Time(spec.time.end, step, spec.time.rho),
    )
