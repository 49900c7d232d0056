"""Buildings as a study writes them: pydantic models, and what may be wrong with their keys together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, create_model

from pounding_cli.errors import Issue
from pounding_cli.laws import storey_laws
from pounding_cli.laws.foundation import Bearings, FrictionPendulum, Rocking, Rubber, Sway
from pounding_cli.numbers import pluralize
from pounding_cli.study.schema.archetype import ArchetypeSpec
from pounding_cli.study.schema.base import Model, list_or, one_or_many, spec_field, tagged_union, word_or
from pounding_cli.study.schema.floor_plan import PlanSpec
from pounding_cli.study.schema.links import RATIO, key_parameters, law_fields
from pounding_cli.study.schema.quantity import (
    FORCE,
    LENGTH,
    MASS,
    PLAUSIBLE_RANGES,
    STIFFNESS,
    TIME,
    WEIGHT_FACTORS,
    ParsedText,
    Quantity,
    WholeNumber,
    quote,
    refuse,
)

# Buildings


Zone = Annotated[float, Quantity("zone factor Z", "", "0.4", 0.0, 1.0, open_low=True)]
Soil = Annotated[float, Quantity("soil factor S", "", "1.2", 1.0, 2.0)]
DesignImportance = Annotated[float, Quantity("importance factor I", "", "1", 0.5, 2.0)]
SystemRw = Annotated[float, Quantity("system factor Rw", "", "12", 1.0, 20.0)]
SystemK = Annotated[float, Quantity("system factor K", "", "0.67", 0.0, 4.0, open_low=True)]
Overstrength = Annotated[float, Quantity("overstrength", "", "2", 0.1, 20.0)]


class CodeSpec(Model):
    """Yield shears equal to the storey shears of the Uniform Building Code."""

    code: Literal["UBC-1985", "UBC-1988", "UBC-1991", "UBC-1994"] = spec_field("UBC-1991", "edition")
    zone: Zone = spec_field(0.4, "zone factor Z [-]; in UBC-1985 zone 4 has Z = 1 and the key must be given")
    soil: Soil = spec_field(1.2, "soil factor S [-]")
    importance: DesignImportance = spec_field(1.0, "importance factor I [-]")
    rw: SystemRw | None = spec_field(None, "system factor of UBC 1988 to 1994 [-]; default: 12", alias="Rw")
    k: SystemK | None = spec_field(None, "system factor of UBC 1985 [-]; must be given there", alias="K")
    overstrength: Overstrength = spec_field(1.0, "factor on the yield shears [-]; the separation is unchanged")

    def issues(self) -> Iterator[Issue]:
        old = self.code == "UBC-1985"
        wrong, right = ("Rw", "`K: 0.67`") if old else ("K", "`Rw: 12`")
        if (self.rw if old else self.k) is not None:
            yield Issue((wrong,), f"{self.code} has no {wrong}", f"write {right} in its place", at_key=True)
        elif old and self.k is None:
            yield Issue((), "'K' is missing: UBC-1985 needs it", "write K, e.g. `K: 0.67` for a ductile frame")
        elif old and "zone" not in self.model_fields_set:
            yield Issue((), "'zone' is missing: UBC-1985 needs it", "write Z, e.g. `zone: 1` for zone 4")


_SHEAR = replace(PLAUSIBLE_RANGES["base yield shear over weight"], name="base shear", units=WEIGHT_FACTORS)
_COEFFICIENT = Quantity("base shear over weight V/W", "", "0.10 W", 1e-4, 10.0, usual=_SHEAR)


def _read_base_shear(value: Any) -> float:
    return _COEFFICIENT.read(value.strip().removesuffix("W") if isinstance(value, str) else value)


Coefficient = Annotated[float, ParsedText(_read_base_shear, "part of the weight W", ("0.10 W", 0.1), _COEFFICIENT)]
DeflectionAmplification = Annotated[float, Quantity("deflection amplification factor Cd", "", "5.5", 1.0, 10.0)]
ImportanceIe = Annotated[float, Quantity("importance factor Ie", "", "1", 1.0, 2.0)]
DisplacementBehaviourFactor = Annotated[float, Quantity("displacement behaviour factor q_d", "", "3.9", 1.0, 20.0)]
DisplacementDuctility = Annotated[float, Quantity("displacement ductility factor mu_d", "", "3.9", 1.0, 50.0)]
ReductionR = Annotated[float, Quantity("reduction factor R", "", "5", 1.0, 20.0)]


class BaseShearSpec(Model):
    """Yield shears from a base-shear coefficient and a distribution of the forces over the height."""

    base_shear: Coefficient = spec_field(..., "base shear over weight V/W [-]", "0.10 W")
    distribution: Literal["triangular", "uniform", "parabolic", "asce7", "ubc"] = spec_field(
        "triangular", "forces over the height: by w h, w, w h^2, w h^k of ASCE 7, or the UBC's with a force at the top"
    )
    overstrength: Overstrength = spec_field(1.0, "factor on the yield shears [-]")
    cd: DeflectionAmplification | None = spec_field(
        None, "amplification factor Cd of ASCE 7 [-], for `pound gap`", alias="Cd"
    )
    ie: ImportanceIe | None = spec_field(
        None, "importance factor Ie of ASCE 7, I of TBDY 2018 [-], for `pound gap`", alias="Ie"
    )
    qd: DisplacementBehaviourFactor | None = spec_field(
        None, "displacement behaviour factor q_d of EN 1998-1 [-], for `pound gap`"
    )
    mu_d: DisplacementDuctility | None = spec_field(
        None,
        "displacement ductility factor of NTC 2018, 7.3.3.3 [-], for `pound gap`; without it the displacement is "
        "estimated from the height",
    )
    r: ReductionR | None = spec_field(None, "reduction factor R of TBDY 2018 and E.030 [-], for `pound gap`", alias="R")
    irregular: bool = spec_field(False, "whether the structure is irregular by E.030, for `pound gap`")


BASE_SHEAR = frozenset({"base_shear", "distribution", "Cd", "Ie", "qd", "mu_d", "R", "irregular"})
"""Keys of a yield that speak of a base shear."""


def _yield_kind(value: Any) -> str:
    given = isinstance(value, dict) and not value.keys().isdisjoint(BASE_SHEAR)
    return "shear" if given or isinstance(value, BaseShearSpec) else "code"


class RayleighSpec(Model):
    """Structural damping C = alpha M + beta K0 of the fixed-base building."""

    alpha: Annotated[float, Quantity("alpha", "1/s", "0.5", 0.0)] = spec_field(..., "mass factor [1/s]")
    beta: Annotated[float, Quantity("beta", "s", "0.001 s", 0.0)] = spec_field(..., "stiffness factor [s]")


def _build_quantity(law: Any, name: str, example: str, absent: bool = False) -> Quantity:
    """The quantity of a parameter that a law declares; `absent`: 0 stands for what is not there."""
    declared = law.parameters()[name].metadata["parameter"]
    ends = declared.low, declared.high, declared.open_low and not absent, declared.open_high
    unit = "" if declared.unit == "-" else declared.unit.removesuffix("/rad")
    usual = PLAUSIBLE_RANGES["floor mass"] if unit == "kg" else None
    return Quantity(name.replace("_", " "), unit, example, *ends, usual=usual)


def _describe(law: Any, name: str) -> str:
    """Its meaning, with its unit."""
    return str(law.parameters()[name].metadata["parameter"].description)


class _IsolatorsSpec(Model):
    """Isolators under the base."""

    kind: ClassVar[Any]

    @property
    def law(self) -> FrictionPendulum | Bearings | Rubber:
        """Their effect, in words."""
        given: Any = {name: value for name, value in vars(self).items() if value is not None}
        return type(self).kind(**given)


def _isolators_model(law: Any, **examples: str) -> Any:
    """Return the model of the keys of isolators, from the parameters that their law declares."""
    fields: dict[str, Any] = {}
    for name, example in examples.items():
        kind = Annotated[float, _build_quantity(law, name, example)]
        is_needed = law.parameters()[name].default is MISSING
        fields[name] = (
            kind if is_needed else kind | None,
            spec_field(... if is_needed else None, _describe(law, name), example),
        )
    model = create_model(law.__name__, __base__=_IsolatorsSpec, __doc__=law.__doc__, **fields)
    model.kind = law
    return model


_PENDULUM = _isolators_model(
    FrictionPendulum, radius="3.1 m", friction="6 %", yield_displacement="1 cm", capacity="35 cm"
)
_BEARINGS = _isolators_model(
    Bearings, strength="800 kN", stiffness="5 kN/mm", yield_displacement="1 cm", capacity="35 cm"
)
_RUBBER = _isolators_model(Rubber, stiffness="5 kN/mm", damping_ratio="12 %", capacity="35 cm")


def _isolation_kind(value: Any) -> str:
    given = value if isinstance(value, dict) else ()
    if isinstance(value, _PENDULUM) or "radius" in given or "friction" in given:
        return "pendulum"
    return "rubber" if isinstance(value, _RUBBER) or "damping_ratio" in given else "bearings"


IsolationSpec: Any = tagged_union(_isolation_kind, pendulum=_PENDULUM, bearings=_BEARINGS, rubber=_RUBBER)


class FoundationSpec(Model):
    """Sway and rocking of the base; a motion whose stiffness is absent does not take place."""

    mass: Annotated[float, _build_quantity(Sway, "mass", "100 t", absent=True)] = spec_field(
        0.0, _describe(Sway, "mass")
    )
    sway_stiffness: Annotated[float, _build_quantity(Sway, "sway_stiffness", "200 kN/mm")] | None = spec_field(
        None, f"{_describe(Sway, 'sway_stiffness')}; absent: no sway"
    )
    isolation: IsolationSpec | None = spec_field(
        None, "isolators under the base, instead of sway_stiffness; its displacement is the `sway` of the results"
    )
    sway_damping: Annotated[float, _build_quantity(Sway, "sway_damping", "1e6 N s/m")] = spec_field(
        0.0, _describe(Sway, "sway_damping")
    )
    inertia: Annotated[float, _build_quantity(Rocking, "inertia", "1000 t m2", absent=True)] = spec_field(
        0.0, _describe(Rocking, "inertia")
    )
    rocking_stiffness: Annotated[float, _build_quantity(Rocking, "rocking_stiffness", "5e9 N m")] | None = spec_field(
        None, f"{_describe(Rocking, 'rocking_stiffness')}; absent: no rocking"
    )
    rocking_damping: Annotated[float, _build_quantity(Rocking, "rocking_damping", "1e7 N m s")] = spec_field(
        0.0, _describe(Rocking, "rocking_damping")
    )

    @property
    def sways(self) -> bool:
        """True if it translates."""
        return self.sway_stiffness is not None or self.isolation is not None

    def issues(self) -> Iterator[Issue]:
        if self.sway_stiffness is not None and self.isolation is not None:
            hint = "remove one of the two: isolators stand in place of the spring"
            yield Issue(("sway_stiffness",), "'sway_stiffness' and 'isolation' both stand here", hint, at_key=True)
        if self.isolation is not None and self.mass == 0:
            yield Issue((), "'mass' is missing: 'isolation' needs it", "write the mass of the base, e.g. `mass: 200 t`")
            return
        for stiffness, inert, dashpot in (
            ("sway_stiffness", "mass", "sway_damping"),
            ("rocking_stiffness", "inertia", "rocking_damping"),
        ):
            moves = self.sways if inert == "mass" else self.rocking_stiffness is not None
            if moves and getattr(self, inert) == 0:
                hint = f"write {type(self).model_fields[inert].description}, above 0"
                yield Issue((), f"'{inert}' is missing: '{stiffness}' needs it", hint)
            for name in (inert, dashpot):
                if not moves and getattr(self, name) > 0:
                    message = f"'{name}' has no effect without '{stiffness}'"
                    yield Issue((name,), message, f"give '{stiffness}' too, or remove it")
        if not self.sways and self.rocking_stiffness is None:
            hint = "give 'sway_stiffness' or 'rocking_stiffness', or write `foundation: fixed`"
            yield Issue((), "this foundation cannot move", hint)


def _one_or_each(quantity: Quantity) -> Any:
    return one_or_many(Annotated[float, quantity])


def _list_or(quantity: Quantity, one: Any) -> Any:
    return list_or(Annotated[tuple[Annotated[float, quantity], ...], Field(min_length=1, max_length=100)], one)


def _check_never(value: Any) -> Any:
    """Return the word for storeys that stay elastic.  Raises PydanticCustomError."""
    if value != "never":
        hint = "write the yield shears of all storeys from the ground up, e.g. `[900 kN, 700 kN]`, or `never`"
        share = "; a share of the weight stands in `yield: {base_shear: 10 %}` instead"
        raise refuse(f"{quote(value)} is not a list of yield shears", hint + share)
    return value


PERIOD_OF_BUILDING = Annotated[float, TIME.replace(name="period", high=60.0)]
Masses = _one_or_each(MASS)


Heights: Any = _one_or_each(LENGTH.replace(usual=PLAUSIBLE_RANGES["storey height"]))


class StiffnessAtSpec(Model):
    """Storey stiffnesses that give a period with certain masses; they stay when the masses of the building change."""

    period: PERIOD_OF_BUILDING = spec_field(
        ..., "fundamental period of the fixed-base building with these masses [s]", "0.42 s"
    )
    mass: Masses = spec_field(..., "floor masses at which the building has this period [kg], one or a list", "300 t")  # type: ignore[valid-type]


Stiffnesses: Any = tagged_union(
    lambda value: "mapping" if isinstance(value, dict | StiffnessAtSpec) else "list",
    list=Annotated[tuple[Annotated[float, STIFFNESS], ...], Field(min_length=1, max_length=100)],
    mapping=StiffnessAtSpec,
)


class WallSpec(Model):
    """A wall beside a building: the wall of a moat, a rigid neighbour, the line of a property."""

    height: Annotated[float, LENGTH.replace(name="height of the wall", example="2 m", open_low=False)] | None = (
        spec_field(
            None,
            "height above the ground [m]: floors of a neighbour up to it can strike the wall, and its base if it "
            "moves; `0 m` for a wall that meets the base alone; default: all floors",
        )
    )
    stiffness: Annotated[float, STIFFNESS] | None = spec_field(
        None, "spring of the soil behind it [N/m]; absent: it moves as the ground does"
    )
    mass: Annotated[float, MASS] | None = spec_field(
        None, "mass of the wall and of the soil that moves with it [kg]", "50 t"
    )
    damping: Annotated[float, Quantity("dashpot", "N s/m", "1e6 N s/m", 0.0)] = spec_field(
        0.0, "dashpot of the soil [N s/m]"
    )

    def issues(self) -> Iterator[Issue]:
        if self.stiffness is not None and self.mass is None:
            yield Issue(
                (), "'mass' is missing: 'stiffness' needs it", "write what moves on the soil, e.g. `mass: 50 t`"
            )
        for name in ("mass", "damping"):
            if self.stiffness is None and getattr(self, name):
                hint = "give 'stiffness' too, or remove it: without it the wall moves as the ground does"
                yield Issue((name,), f"'{name}' has no effect without 'stiffness'", hint)


class _BuildingSpec(Model):
    """One building type; lists run from the ground up."""

    like: str | None = spec_field(None, "another building whose keys apply unless given here")
    archetype: ArchetypeSpec | None = spec_field(
        None,
        "a building that is only seen: the keys that are not given here follow from its type, its age and its storeys",
        {"type": "C1M", "design": "pre-code", "storeys": 5},
    )
    storeys: Annotated[int, WholeNumber(1, 100)] | None = spec_field(
        None, "number of storeys; default: the length of a list", 5
    )
    period: PERIOD_OF_BUILDING | None = spec_field(None, "fundamental period of the fixed-base building [s]", "0.36 s")
    mass: Masses = spec_field("200 t", "floor mass [kg], one or a list")  # type: ignore[valid-type]
    height: Heights = spec_field("3 m", "storey height [m], one or a list")
    taper: Annotated[float, Quantity("taper", "", "1/3", 0.0, 10.0, open_low=True)] = spec_field(
        "1/3", "top over bottom storey stiffness [-], linear in between"
    )
    stiffness: Stiffnesses | None = spec_field(
        None,
        "storey stiffnesses [N/m], instead of period and taper; or {period: 0.42 s, mass: 300 t}: those of a building "
        "with this period and these masses, which stay when the mass is varied",
    )
    damping: Annotated[float, RATIO.replace(usual=PLAUSIBLE_RANGES["damping ratio"])] = spec_field(
        "5 %", "damping ratio of the first two modes [-]"
    )
    rayleigh: RayleighSpec | None = spec_field(None, "Rayleigh factors, instead of damping")
    hardening: _one_or_each(Quantity("hardening ratio", "", "0.05", 0.0, 1.0, open_high=True)) = spec_field(  # type: ignore[valid-type]
        0.05, "post-yield over initial stiffness [-], one or a list"
    )
    yield_: tagged_union(_yield_kind, code=CodeSpec, shear=BaseShearSpec) = spec_field(  # type: ignore[valid-type]
        CodeSpec(), "code or base-shear coefficient that sets the yield shears", alias="yield"
    )
    yield_shear: _list_or(FORCE, Annotated[Literal["never"], BeforeValidator(_check_never)]) | None = spec_field(  # type: ignore[valid-type]
        None, "storey yield shears [N], instead of yield; `never`: the storeys stay elastic"
    )
    storey_law: Literal[tuple(storey_laws())] = spec_field("bilinear", "how storeys yield and unload")  # type: ignore[valid-type]
    p_delta: _list_or(FORCE.replace(name="weight on a storey", example="9000 kN", open_low=False), bool) = spec_field(  # type: ignore[valid-type]
        False,
        "P-Delta, the push of the weight on a storey that drifts: `true` for the weight of the floors above, or the "
        "weight on every storey [N], a list",
    )
    collapse: (
        Annotated[
            float | str, Quantity("drift ratio of collapse", "", "10 %", 0.0, 1.0, open_low=True, words=("never",))
        ]
        | None
    ) = spec_field(
        None,
        "drift over storey height at which a storey counts as collapsed and the run ends [-]; default: 10 % if a "
        "storey may lose all resistance; `never`: not checked",
    )
    foundation: word_or(Literal["fixed"], FoundationSpec) = spec_field("fixed", "springs under the base; `fixed`: none")  # type: ignore[valid-type]
    slab: Annotated[float, LENGTH.replace(name="slab thickness", example="25 cm", open_low=False)] = spec_field(
        "0 cm", "thickness of the floor slabs [m]; slabs whose heights overlap meet"
    )
    columns: Annotated[float | str, Quantity("share of the columns", "", "20 %", 0.0, 1.0, words=("none",))] | None = (
        spec_field(
            None,
            "part of a storey's stiffness and yield shear in the columns that a neighbour's slab strikes, or that a "
            "link ends on [-]; `none`: its storeys have walls, and no columns to strike; without it such blows are "
            "left out, with a warning",
        )
    )
    plan: PlanSpec | None = spec_field(
        None,
        "plan of the floors: their size and the places of frames and walls, for floors that twist; without it they do "
        "not",
    )
    wall: word_or(Literal["fixed"], WallSpec) | None = spec_field(  # type: ignore[valid-type]
        None,
        "a wall in place of a building, without further keys; `fixed`: as high as its neighbours, moving as the ground "
        "does",
        "fixed",
    )

    @property
    def lengths(self) -> dict[str, int]:
        """Lengths of the keys that are given as lists; a new key that may be a list must be named here."""
        names = "mass", "height", "hardening", "stiffness", "yield_shear", "p_delta"
        values = {name: getattr(self, name) for name in names}
        found = {name: len(value) for name, value in values.items() if isinstance(value, tuple)}
        if isinstance(self.stiffness, StiffnessAtSpec) and isinstance(self.stiffness.mass, tuple):
            found["stiffness.mass"] = len(self.stiffness.mass)
        if self.plan is not None:
            found |= {f"plan.{name}": length for name, length in self.plan.list_lengths().items()}
        return found

    @property
    def count(self) -> int | None:
        """Number of storeys; None where nothing tells it."""
        if self.wall is not None:
            return 1
        return self.storeys if self.storeys is not None else next(iter(self.lengths.values()), None)

    @property
    def gives_stiffness_in_plan(self) -> bool:
        """True where the lines of its plan give the stiffness of its storeys."""
        return self.plan is not None and self.plan.gives_stiffness

    def _find_plan_issues(self) -> Iterator[Issue]:
        """Yield what is said both in the plan and beside it."""
        if self.plan is None:
            return
        doubled = ("period", "taper", "stiffness") if self.plan.gives_stiffness else ()
        if self.plan.gives_yield_shear:
            doubled = (*doubled, "yield_", "yield_shear")
        for name in doubled:
            if name in self.model_fields_set:
                message = f"'{name.strip('_')}' and the lines of 'plan' both give the same"
                hint = "remove it: the lines add up to it; or write shares in the lines"
                yield Issue((name.strip("_"),), message, hint, at_key=True)

    def issues(self) -> Iterator[Issue]:
        if self.wall is not None:
            for name in sorted(self.model_fields_set - {"wall", "like"}):
                shown = type(self).model_fields[name].alias or name
                yield Issue((shown,), f"'{shown}' does not apply to a wall", "remove it, or `wall`", at_key=True)
            return
        if self.archetype is not None and self.storeys != self.archetype.storeys:
            message = f"'storeys' is {self.storeys} here, but {self.archetype.storeys} in 'archetype'"
            yield Issue(("storeys",), message, "write the number of storeys in `archetype` alone", at_key=True)
        tapered = () if isinstance(self.stiffness, StiffnessAtSpec) else (("stiffness", "taper"),)
        for one, other in (("stiffness", "period"), *tapered, ("yield_shear", "yield_"), ("rayleigh", "damping")):
            if {one, other} <= self.model_fields_set:
                message = f"'{one}' and '{other.strip('_')}' cannot both be given"
                yield Issue((one,), message, f"remove one: '{one}' stands in place of the other", at_key=True)
        if self.count is None:
            yield Issue((), "'storeys' is missing", "write the number of storeys, e.g. `storeys: 5`")
        for name, length in self.lengths.items():
            if self.count is not None and length != self.count:
                message = f"{name} has {pluralize(length, 'value')} for {pluralize(self.count, 'storey')}"
                hint = f"write {pluralize(self.count, 'value')} from the ground up"
                yield Issue(tuple(int(key) if key.isdigit() else key for key in name.split(".")), message, hint)
        yield from self._find_plan_issues()
        if self.period is None and self.stiffness is None and not self.gives_stiffness_in_plan:
            yield Issue((), "this building has neither 'period' nor 'stiffness'", "write e.g. `period: 0.36 s`")
        thinnest = min(self.height) if isinstance(self.height, tuple) else self.height
        if self.slab >= thinnest:
            message = f"a slab of {self.slab:g} m is not thinner than a storey of {thinnest:g} m"
            yield Issue(("slab",), message, "write the thickness of the floor slab, e.g. `slab: 25 cm`")
        law = storey_laws()[self.storey_law]
        for owner in storey_laws().values():
            for name in key_parameters(owner).keys() - key_parameters(law).keys():
                if getattr(self, name) is not None:
                    message = f"'{name}' does not apply to storey_law: {law.name}"
                    yield Issue((name,), message, f"remove it; it belongs to {owner.name}", at_key=True)
        for name, declared in key_parameters(law).items():
            if getattr(self, name) is None and not isinstance(law.parameters()[name].default, str | float | int):
                yield Issue((), f"'{name}' is missing", f"storey_law: {law.name} needs it: {declared.description}")


if TYPE_CHECKING:
    BuildingSpec = _BuildingSpec
else:
    BuildingSpec = create_model(
        "BuildingSpec", __base__=_BuildingSpec, __doc__=_BuildingSpec.__doc__, **law_fields(storey_laws())
    )
