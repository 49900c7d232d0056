"""Records, buildings, laws and cases of a study file as pydantic models, and what is wrong with their keys."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, create_model
from pydantic_core import PydanticCustomError

from pounding_cli.laws import storey_laws
from pounding_cli.laws.foundation import Bearings, FrictionPendulum, Rocking, Rubber, Sway
from pounding_cli.numbers import counted
from pounding_cli.records.units import UNITS, acceleration_unit
from pounding_cli.study.base import Model, Name, Wrong, key, list_or, one_or_many, tagged, word_or
from pounding_cli.study.laws import RATIO, AnyLink, law_keys, own
from pounding_cli.study.quantity import (
    ACCELERATION,
    FORCE,
    LENGTH,
    MASS,
    RANGES,
    STIFFNESS,
    TIME,
    WEIGHTS,
    Measured,
    Quantity,
    Text,
    Whole,
    measured,
    refuse,
    written_unit,
)
from pounding_cli.units import factor as unit_factor

# Records


def _unit(text: str) -> str:
    if acceleration_unit(text) is None:
        raise refuse(
            f"'{text}' is not a unit of acceleration", f"write one of {', '.join(UNITS)}, or a multiple: 0.01 g"
        )
    return text


PERIOD = TIME.but(name="period", example="0.5 s", low=0.01, open_low=False, high=60)
Period = Annotated[float, PERIOD]
Acceleration = Annotated[float, ACCELERATION]
Number = Annotated[int, Whole(1, 1000)]


class RecordFile(Model):
    """A motion in a file of one's own, or several in a folder."""

    file: str = key(
        ..., "a file, a folder, or a pattern such as motions/*.AT2, relative to the study file", "motions/x.AT2"
    )
    name: Name | None = key(None, "name of the motion in tables; default: the file's stem")
    unit: Annotated[str, AfterValidator(_unit)] | None = key(
        None, "unit of the acceleration, any spelling; only where the file states none (g in plain columns)"
    )
    dt: Annotated[float, TIME.but(name="time step", example="0.01 s")] | None = key(
        None, "time step [s]; needed for one column of values"
    )
    format: Literal["at2", "cosmos", "csmip", "smc", "knet", "esm", "two-column", "column", "table"] | None = key(
        None, "default: detected"
    )
    channel: Number | None = key(None, "channel of a file with several channels, from 1")
    column: Number | None = key(None, "column of a table with the acceleration, from 1")


class Arias(Model):
    """Every record is scaled to the Arias intensity of one of them."""

    arias: str = key(..., "record with the reference Arias intensity", "elcentro")
    window: Annotated[float | str, TIME.but(name="window", example="10 s", words=("duration", "table1", "whole"))] = (
        key("duration", "part of each record that is measured [s]; `duration`: the analysed part")
    )


class Pga(Model):
    """Every record is scaled to one peak ground acceleration."""

    pga: Acceleration = key(..., "peak ground acceleration [m/s2]", "0.35 g")


class Pgv(Model):
    """Every record is scaled to one peak ground velocity."""

    pgv: Annotated[float, Quantity("velocity", "m/s", "40 cm/s", 0.0, open_low=True)] = key(
        ..., "peak ground velocity [m/s], without baseline correction", "40 cm/s"
    )


class Sa(Model):
    """Every record is scaled to one ordinate of its response spectrum."""

    sa: Acceleration = key(..., "pseudo-acceleration [m/s2]", "0.8 g")
    period: Period = key(..., "at this period [s]", "0.5 s")
    damping: Annotated[float, RATIO] = key(0.05, "and this damping ratio [-]")


def _once_each(points: Any) -> Any:
    first: dict[float, str] = {}
    for word in points if isinstance(points, dict) else ():
        try:
            period = PERIOD.read(word)
        except PydanticCustomError:
            continue  # said at its place
        if period in first:
            raise refuse(f"'{first[period]}' and '{word}' are one period", "remove one of the two")
        first[period] = word
    return points


class Spectrum(Model):
    """The suite is scaled to a target spectrum over a range of periods."""

    spectrum: Literal["mean", "each"] = key(
        ..., "`mean`: one factor for all, their mean spectrum meets the target; `each`: one for every record", "mean"
    )
    target: word_or(str, Annotated[dict[Period, Acceleration], BeforeValidator(_once_each)]) = key(  # type: ignore[valid-type]
        ...,
        "{period: pseudo-acceleration, ...}, or the record whose spectrum is taken",
        {"0.1 s": "0.8 g", "2 s": "0.2 g"},
    )
    low: Period = key(..., "shortest period of the range [s]", "0.2 s", alias="from")
    high: Period = key(..., "longest period of the range [s]", "1.2 s", alias="to")
    damping: Annotated[float, RATIO] = key(0.05, "damping ratio of the spectra [-]")
    at_least: Annotated[float, Quantity("part of the target", "", "90 %", 0.0, 10.0, open_low=True)] | None = key(
        None, "another factor for all, so that the mean spectrum is nowhere below this part of the target"
    )

    def wrong(self) -> Iterator[Wrong]:
        ends = f"from {self.low:g} s to {self.high:g} s"
        if not self.low < self.high:
            hint = "write `to:` above `from:`, e.g. `from: 0.2 s, to: 1.2 s`"
            yield ("to",), f"the range of periods runs {ends}", hint
        elif isinstance(self.target, dict):
            first, last = min(self.target, default=0.0), max(self.target, default=0.0)
            if not first < last or not first <= self.low or not self.high <= last:
                what = f"the target is given from {first:g} to {last:g} s, not over the whole range"
                yield ("target",), what, f"give two points at least, {ends} and beyond"


_SCALES: dict[str, Any] = {"arias": Arias, "pga": Pga, "pgv": Pgv, "sa": Sa, "spectrum": Spectrum}


def _scale(value: Any) -> str:
    if isinstance(value, dict):
        return next((name for name in _SCALES if name in value), "arias")
    return next((name for name, model in _SCALES.items() if isinstance(value, model)), "factor")


FACTOR = Quantity("scale factor", "", "1.5", 0.0, 1e6, open_low=True, words=("table1",))
Scale: Any = tagged(_scale, factor=Annotated[float | str, FACTOR], **_SCALES)


class Records(Model):
    """The ground motions, the part of each that is used, and its scale."""

    use: Annotated[tuple[word_or(str, RecordFile), ...], Field(min_length=1, max_length=5000)] = key(  # type: ignore[valid-type]
        ..., "catalogue names, files, folders, patterns, {file: PATH, ...}", ["elcentro", {"file": "motions/x.AT2"}]
    )
    duration: Annotated[float | str, TIME.but(name="duration", example="10 s", words=("auto", "table1", "whole"))] = (
        key(
            "auto",
            "how much of each record is used [s]; `table1`: the paper's durations; `auto`: those, and `whole` for "
            "motions that Table 1 does not hold",
        )
    )
    scale: Scale = key(
        1.0, "a factor, `table1`, {arias: RECORD}, {pga: 0.35 g}, {pgv: ...}, {sa: ...} or {spectrum: ...}"
    )


# Buildings


class Code(Model):
    """Yield shears equal to the storey shears of the Uniform Building Code."""

    code: Literal["UBC-1985", "UBC-1988", "UBC-1991", "UBC-1994"] = key("UBC-1991", "edition")
    zone: Annotated[float, Quantity("zone factor Z", "", "0.4", 0.0, 1.0, open_low=True)] = key(
        0.4, "zone factor Z [-]; in UBC-1985 zone 4 has Z = 1 and the key must be given"
    )
    soil: Annotated[float, Quantity("soil factor S", "", "1.2", 1.0, 2.0)] = key(1.2, "soil factor S [-]")
    importance: Annotated[float, Quantity("importance factor I", "", "1", 0.5, 2.0)] = key(
        1.0, "importance factor I [-]"
    )
    rw: Annotated[float, Quantity("system factor Rw", "", "12", 1.0, 20.0)] | None = key(
        None, "system factor of UBC 1988 to 1994 [-]; default: 12", alias="Rw"
    )
    k: Annotated[float, Quantity("system factor K", "", "0.67", 0.0, 4.0, open_low=True)] | None = key(
        None, "system factor of UBC 1985 [-]; must be given there", alias="K"
    )
    overstrength: Annotated[float, Quantity("overstrength", "", "2", 0.1, 20.0)] = key(
        1.0, "factor on the yield shears [-]; the separation is unchanged"
    )

    def wrong(self) -> Iterator[Wrong]:
        old = self.code == "UBC-1985"
        wrong, right = ("Rw", "`K: 0.67`") if old else ("K", "`Rw: 12`")
        if (self.rw if old else self.k) is not None:
            yield (wrong,), f"{self.code} has no {wrong}", f"write {right} in its place", True
        elif old and self.k is None:
            yield (), "'K' is missing: UBC-1985 needs it", "write K, e.g. `K: 0.67` for a ductile frame"
        elif old and "zone" not in self.model_fields_set:
            yield (), "'zone' is missing: UBC-1985 needs it", "write Z, e.g. `zone: 1` for zone 4"


_SHEAR = replace(RANGES["base yield shear over weight"], name="base shear", units=WEIGHTS)
_COEFFICIENT = Quantity("base shear over weight V/W", "", "0.10 W", 1e-4, 10.0, usual=_SHEAR)


def _base_shear(value: Any) -> float:
    if isinstance(value, str):
        value = value.strip().removesuffix("W").strip()
        unit = written_unit(value)
        if unit and unit != "%" and unit_factor(unit, "N") is not None:
            raise refuse(
                f"'{value}' is a force: the base shear is given as a part of the weight W",
                "write e.g. `base_shear: 0.10 W`; storey by storey in N, `yield_shear: [...]` stands beside `yield`",
            )
    return _COEFFICIENT.read(value)


class BaseShear(Model):
    """Yield shears from a base-shear coefficient and a distribution of the forces over the height."""

    base_shear: Annotated[float, Text(_base_shear, "part of the weight W", ("0.10 W", 0.1), _COEFFICIENT)] = key(
        ..., "base shear over weight V/W [-]", "0.10 W"
    )
    distribution: Literal["triangular", "uniform", "parabolic", "asce7", "ubc"] = key(
        "triangular", "forces over the height: by w h, w, w h^2, w h^k of ASCE 7, or the UBC's with a force at the top"
    )
    overstrength: Annotated[float, Quantity("overstrength", "", "2", 0.1, 20.0)] = key(
        1.0, "factor on the yield shears [-]"
    )
    cd: Annotated[float, Quantity("deflection amplification factor Cd", "", "5.5", 1.0, 10.0)] | None = key(
        None, "deflection amplification factor Cd of ASCE 7 [-], for `pound gap`", alias="Cd"
    )
    ie: Annotated[float, Quantity("importance factor Ie", "", "1", 1.0, 2.0)] | None = key(
        None, "importance factor Ie of ASCE 7 [-], for `pound gap`", alias="Ie"
    )
    qd: Annotated[float, Quantity("displacement behaviour factor q_d", "", "3.9", 1.0, 20.0)] | None = key(
        None, "displacement behaviour factor q_d of EN 1998-1 [-], for `pound gap`"
    )


BASE_SHEAR = frozenset({"base_shear", "distribution", "Cd", "Ie", "qd"})
"""Keys of a yield that speak of a base shear."""


def _yield_kind(value: Any) -> str:
    given = isinstance(value, dict) and not value.keys().isdisjoint(BASE_SHEAR)
    return "shear" if given or isinstance(value, BaseShear) else "code"


class Rayleigh(Model):
    """Structural damping C = alpha M + beta K0 of the fixed-base building."""

    alpha: Annotated[float, Quantity("alpha", "1/s", "0.5", 0.0)] = key(..., "mass factor [1/s]")
    beta: Annotated[float, Quantity("beta", "s", "0.001 s", 0.0)] = key(..., "stiffness factor [s]")


def _of(law: Any, name: str, example: str, absent: bool = False) -> Quantity:
    """How a study writes a parameter that a law declares; `absent`: 0 stands for what is not there."""
    declared = law.parameters()[name].metadata["parameter"]
    ends = declared.low, declared.high, declared.open_low and not absent, declared.open_high
    return Quantity(name.replace("_", " "), declared.unit.removesuffix("/rad"), example, *ends)


def _about(law: Any, name: str) -> str:
    """What it means, with its unit."""
    return str(law.parameters()[name].metadata["parameter"].words)


class Isolation(Model):
    """Isolators under the base: those of a friction pendulum have `radius` and `friction`, lead-rubber and other
    bearings `strength`, `stiffness` and `yield_displacement`, high-damping rubber by equivalent values `stiffness` and
    `damping_ratio`."""

    radius: Annotated[float, _of(FrictionPendulum, "radius", "3.1 m")] | None = key(
        None, _about(FrictionPendulum, "radius")
    )
    friction: Annotated[float, Quantity("friction coefficient", "", "6 %", 0.0, 1.0, open_low=True)] | None = key(
        None, _about(FrictionPendulum, "friction")
    )
    strength: Annotated[float, _of(Bearings, "strength", "800 kN")] | None = key(None, _about(Bearings, "strength"))
    stiffness: Annotated[float, _of(Bearings, "stiffness", "5 kN/mm")] | None = key(None, _about(Bearings, "stiffness"))
    yield_displacement: Annotated[float, _of(Bearings, "yield_displacement", "1 cm")] | None = key(
        None, "displacement at which they slide or yield [m]; default of a friction pendulum: 0.01 mm"
    )

    damping_ratio: Annotated[float, RATIO] | None = key(None, _about(Rubber, "damping_ratio"))
    capacity: Annotated[float, LENGTH.but(name="capacity", example="35 cm")] | None = key(
        None, "displacement that they can take [m]; scenes in which the base moves further are flagged"
    )

    @property
    def law(self) -> FrictionPendulum | Bearings | Rubber:
        """What they do."""
        if self.damping_ratio is not None and self.stiffness is not None:
            capacity = {} if self.capacity is None else {"capacity": self.capacity}
            return Rubber(self.stiffness, self.damping_ratio, **capacity)
        given = {"yield_displacement": self.yield_displacement, "capacity": self.capacity}
        more = {name: value for name, value in given.items() if value is not None}
        if self.radius is not None and self.friction is not None:
            return FrictionPendulum(radius=self.radius, friction=self.friction, **more)
        assert self.strength is not None  # `wrong` has refused what is not complete
        assert self.stiffness is not None
        return Bearings(strength=self.strength, stiffness=self.stiffness, **more)

    def wrong(self) -> Iterator[Wrong]:
        given = [name for name in self.model_fields_set if name != "capacity" and getattr(self, name) is not None]
        fitting = [needs for needs, may in _ISOLATORS.values() if {*given} <= needs | may]
        form = (
            "write {radius: 3.1 m, friction: 6 %}, {strength: 800 kN, stiffness: 5 kN/mm, yield_displacement: 1 cm} or "
            "{stiffness: 5 kN/mm, damping_ratio: 12 %}"
        )
        if not fitting:
            kind = max(_ISOLATORS, key=lambda name: len(_ISOLATORS[name][0] & {*given}))
            extra = next(name for name in given if name not in _ISOLATORS[kind][0] | _ISOLATORS[kind][1])
            yield (extra,), f"'{extra}' is no key of {kind}", form, True
        elif not any(needs <= {*given} for needs in fitting):
            yield (), "these isolators are not complete", form


_ISOLATORS: dict[str, tuple[set[str], set[str]]] = {
    "a friction pendulum": ({"radius", "friction"}, {"yield_displacement"}),
    "lead-rubber bearings": ({"strength", "stiffness", "yield_displacement"}, set()),
    "high-damping rubber": ({"stiffness", "damping_ratio"}, set()),
}
"""Of each kind of isolators the keys that it needs, and that it may have."""


class Foundation(Model):
    """Sway and rocking of the base; a motion whose stiffness is absent does not take place."""

    mass: Annotated[float, _of(Sway, "mass", "100 t", absent=True)] = key(0.0, _about(Sway, "mass"))
    sway_stiffness: Annotated[float, _of(Sway, "sway_stiffness", "200 kN/mm")] | None = key(
        None, f"{_about(Sway, 'sway_stiffness')}; absent: no sway"
    )
    isolation: Isolation | None = key(
        None, "isolators under the base, instead of sway_stiffness; its displacement is the `sway` of the results"
    )
    sway_damping: Annotated[float, _of(Sway, "sway_damping", "1e6 N s/m")] = key(0.0, _about(Sway, "sway_damping"))
    inertia: Annotated[float, _of(Rocking, "inertia", "1000 t m2", absent=True)] = key(0.0, _about(Rocking, "inertia"))
    rocking_stiffness: Annotated[float, _of(Rocking, "rocking_stiffness", "5e9 N m")] | None = key(
        None, f"{_about(Rocking, 'rocking_stiffness')}; absent: no rocking"
    )
    rocking_damping: Annotated[float, _of(Rocking, "rocking_damping", "1e7 N m s")] = key(
        0.0, _about(Rocking, "rocking_damping")
    )

    @property
    def sways(self) -> bool:
        """Whether it translates."""
        return self.sway_stiffness is not None or self.isolation is not None

    def wrong(self) -> Iterator[Wrong]:
        if self.sway_stiffness is not None and self.isolation is not None:
            hint = "remove one of the two: isolators stand in place of the spring"
            yield ("sway_stiffness",), "'sway_stiffness' and 'isolation' both stand here", hint, True
        if self.isolation is not None and self.mass == 0:
            yield (), "'mass' is missing: 'isolation' needs it", "write the mass of the base, e.g. `mass: 200 t`"
            return
        for stiffness, inert, dashpot in (
            ("sway_stiffness", "mass", "sway_damping"),
            ("rocking_stiffness", "inertia", "rocking_damping"),
        ):
            moves = self.sways if inert == "mass" else self.rocking_stiffness is not None
            if moves and getattr(self, inert) == 0:
                hint = f"write {type(self).model_fields[inert].description}, above 0"
                yield (), f"'{inert}' is missing: '{stiffness}' needs it", hint
            for name in (inert, dashpot):
                if not moves and getattr(self, name) > 0:
                    what = f"'{name}' has no effect without '{stiffness}'"
                    yield (name,), what, f"give '{stiffness}' too, or remove it"
        if not self.sways and self.rocking_stiffness is None:
            hint = "give 'sway_stiffness' or 'rocking_stiffness', or write `foundation: fixed`"
            yield (), "this foundation cannot move", hint


def _each(quantity: Quantity) -> Any:
    return one_or_many(Annotated[float, quantity])


def _list_or(quantity: Quantity, one: Any) -> Any:
    return list_or(Annotated[tuple[Annotated[float, quantity], ...], Field(min_length=1, max_length=100)], one)


PERIOD_OF_BUILDING = Annotated[float, TIME.but(name="period", high=60.0)]
Masses = _each(MASS)


class StiffnessAt(Model):
    """Storey stiffnesses that give a period with certain masses; they stay when the masses of the building change."""

    period: PERIOD_OF_BUILDING = key(
        ..., "fundamental period of the fixed-base building with these masses [s]", "0.42 s"
    )
    mass: Masses = key(..., "floor masses at which the building has this period [kg], one or a list", "300 t")  # type: ignore[valid-type]


Stiffnesses: Any = tagged(
    lambda value: "mapping" if isinstance(value, dict | StiffnessAt) else "list",
    list=Annotated[tuple[Annotated[float, STIFFNESS], ...], Field(min_length=1, max_length=100)],
    mapping=StiffnessAt,
)


class WallSpec(Model):
    """A wall beside a building: the wall of a moat, a rigid neighbour, the line of a property."""

    height: Annotated[float, LENGTH.but(name="height of the wall", example="2 m", open_low=False)] | None = key(
        None,
        "height above the ground [m]: floors of a neighbour up to it can strike the wall, and its base if it moves; "
        "`0 m` for a wall that meets the base alone; default: all floors",
    )
    stiffness: Annotated[float, STIFFNESS] | None = key(
        None, "spring of the soil behind it [N/m]; absent: it moves as the ground does"
    )
    mass: Annotated[float, MASS] | None = key(None, "mass of the wall and of the soil that moves with it [kg]", "50 t")
    damping: Annotated[float, Quantity("dashpot", "N s/m", "1e6 N s/m", 0.0)] = key(0.0, "dashpot of the soil [N s/m]")

    def wrong(self) -> Iterator[Wrong]:
        if self.stiffness is not None and self.mass is None:
            yield (), "'mass' is missing: 'stiffness' needs it", "write what moves on the soil, e.g. `mass: 50 t`"
        for name in ("mass", "damping"):
            if self.stiffness is None and getattr(self, name):
                hint = "give 'stiffness' too, or remove it: without it the wall moves as the ground does"
                yield (name,), f"'{name}' has no effect without 'stiffness'", hint


class _Building(Model):
    """One building type; lists run from the ground up."""

    like: str | None = key(None, "another building whose keys apply unless given here")
    storeys: Annotated[int, Whole(1, 100)] | None = key(None, "number of storeys; default: the length of a list", 5)
    period: PERIOD_OF_BUILDING | None = key(None, "fundamental period of the fixed-base building [s]", "0.36 s")
    mass: Masses = key("200 t", "floor mass [kg], one or a list")  # type: ignore[valid-type]
    height: _each(LENGTH.but(usual=RANGES["storey height"])) = key("3 m", "storey height [m], one or a list")  # type: ignore[valid-type]
    taper: Annotated[float, Quantity("taper", "", "1/3", 0.0, 10.0, open_low=True)] = key(
        "1/3", "top over bottom storey stiffness [-], linear in between"
    )
    stiffness: Stiffnesses | None = key(
        None,
        "storey stiffnesses [N/m], instead of period and taper; or {period: 0.42 s, mass: 300 t}: those of a building "
        "with this period and these masses, which stay when the mass is varied",
    )
    damping: Annotated[float, RATIO.but(usual=RANGES["damping ratio"])] = key(
        "5 %", "damping ratio of the first two modes [-]"
    )
    rayleigh: Rayleigh | None = key(None, "Rayleigh factors, instead of damping")
    hardening: _each(Quantity("hardening ratio", "", "0.05", 0.0, 1.0, open_high=True)) = key(  # type: ignore[valid-type]
        0.05, "post-yield over initial stiffness [-], one or a list"
    )
    yield_: tagged(_yield_kind, code=Code, shear=BaseShear) = key(  # type: ignore[valid-type]
        Code(), "code or base-shear coefficient that sets the yield shears", alias="yield"
    )
    yield_shear: _list_or(FORCE, Literal["never"]) | None = key(  # type: ignore[valid-type]
        None, "storey yield shears [N], instead of yield; `never`: the storeys stay elastic"
    )
    storey_law: Literal[tuple(storey_laws())] = key("bilinear", "how storeys yield and unload")  # type: ignore[valid-type]
    p_delta: _list_or(FORCE.but(name="weight on a storey", example="9000 kN", open_low=False), bool) = key(  # type: ignore[valid-type]
        False,
        "P-Delta, the push of the weight on a storey that drifts: `true` for the weight of the floors above, or the "
        "weight on every storey [N], a list",
    )
    collapse: (
        Annotated[
            float | str, Quantity("drift ratio of collapse", "", "10 %", 0.0, 1.0, open_low=True, words=("never",))
        ]
        | None
    ) = key(
        None,
        "drift over storey height at which a storey counts as collapsed and the run ends [-]; default: 10 % if a "
        "storey may lose all resistance; `never`: not checked",
    )
    foundation: word_or(Literal["fixed"], Foundation) = key("fixed", "springs under the base; `fixed`: none")  # type: ignore[valid-type]
    slab: Annotated[float, LENGTH.but(name="slab thickness", example="25 cm", open_low=False)] = key(
        "0 cm", "thickness of the floor slabs [m]; slabs whose heights overlap meet"
    )
    columns: Annotated[float, Quantity("share of the columns", "", "20 %", 0.0, 1.0, open_low=True)] | None = key(
        None,
        "part of a storey's stiffness and yield shear in the columns that a neighbour's slab strikes [-]; without it "
        "such blows are left out",
    )
    wall: word_or(Literal["fixed"], WallSpec) | None = key(  # type: ignore[valid-type]
        None,
        "a wall in place of a building, without further keys; `fixed`: as high as its neighbours, moving as the ground "
        "does",
        "fixed",
    )

    @property
    def lengths(self) -> dict[str, int]:
        names = "mass", "height", "hardening", "stiffness", "yield_shear", "p_delta"
        found = {name: len(value) for name in names if isinstance(value := getattr(self, name), tuple)}
        if isinstance(self.stiffness, StiffnessAt) and isinstance(self.stiffness.mass, tuple):
            found["stiffness.mass"] = len(self.stiffness.mass)
        return found

    @property
    def count(self) -> int | None:
        if self.wall is not None:
            return 1
        return self.storeys if self.storeys is not None else next(iter(self.lengths.values()), None)

    def wrong(self) -> Iterator[Wrong]:
        if self.wall is not None:
            for name in sorted(self.model_fields_set - {"wall", "like"}):
                shown = type(self).model_fields[name].alias or name
                yield (shown,), f"'{shown}' does not apply to a wall", "remove it, or `wall`", True
            return
        if self.count is None:
            yield (), "'storeys' is missing", "write the number of storeys, e.g. `storeys: 5`"
        for name, length in self.lengths.items():
            if self.count is not None and length != self.count:
                what = f"{name} has {counted(length, 'value')} for {counted(self.count, 'storey')}"
                hint = f"write {counted(self.count, 'value')} from the ground up"
                yield tuple(name.split(".")), what, hint
        if self.period is None and self.stiffness is None:
            yield (), "this building has neither 'period' nor 'stiffness'", "write e.g. `period: 0.36 s`"
        thinnest = min(self.height) if isinstance(self.height, tuple) else self.height
        if self.slab >= thinnest:
            what = f"a slab of {self.slab:g} m is not thinner than a storey of {thinnest:g} m"
            yield ("slab",), what, "write the thickness of the floor slab, e.g. `slab: 25 cm`"
        law = storey_laws()[self.storey_law]
        for owner in storey_laws().values():
            for name in own(owner).keys() - own(law).keys():
                if getattr(self, name) is not None:
                    what = f"'{name}' does not apply to storey_law: {law.name}"
                    yield (name,), what, f"remove it; it belongs to {owner.name}", True
        for name, declared in own(law).items():
            if getattr(self, name) is None and not isinstance(law.parameters()[name].default, str | float | int):
                yield (), f"'{name}' is missing", f"storey_law: {law.name} needs it: {declared.words}"


if TYPE_CHECKING:
    Building = _Building
else:
    Building = create_model("Building", __base__=_Building, __doc__=_Building.__doc__, **law_keys(storey_laws()))

# Links


class OwnLaw(Model):
    """A law of links of the study's own."""

    force: str = key(
        ...,
        "its force [N]: a formula of v closing [m], r its rate [m/s], m reduced mass of the floors [kg], d gap [m] "
        "and the parameters; + - * / **, brackets and sqrt()",
        "k*v + c*r",
    )
    parameters: dict[
        Name, Annotated[Measured, Text(measured, "number with any unit, or a plain number", ("20 kN/mm", 0.2))]
    ] = key({}, "constants of the formula by name", {"k": "20 kN/mm"})
    acts: Literal["beyond gap", "compression", "always"] = key(
        "beyond gap",
        "`beyond gap`: once the gap has closed, with v = closing - gap; `compression`: while the closing v is above "
        "zero, as for material that fills the gap; `always`: as for a damper",
    )
    tension_cut: bool = key(False, "no force that pulls the floors together")


class Case(Model):
    """What stands between the buildings of the group: links, which take the keys of the case that their law has."""

    links: Annotated[tuple[AnyLink, ...], Field(min_length=1, max_length=500)] = key(
        ..., "links between the floors; one may stand in the case itself"
    )
