"""The buildings of a study file: storeys, yield shears, damping, foundations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, create_model
from pydantic_core import PydanticCustomError

from pounding_cli.laws import storey_laws
from pounding_cli.laws.foundation import Rocking, Sway
from pounding_cli.study import units
from pounding_cli.study.base import EACH_STOREY, EITHER, DampingShare, Model, optional, word_or_mapping
from pounding_cli.study.law_keys import quantity_of, storey_keys, words_about
from pounding_cli.study.units import Quantity, TextForm, factor_of, limited, refuse, whole_number, written_unit

Edition = Literal["UBC-1985", "UBC-1988", "UBC-1991", "UBC-1994"]
Distribution = Literal["triangular", "uniform", "parabolic", "asce7", "ubc"]
if TYPE_CHECKING:
    StoreyKind = str
else:
    StoreyKind = Literal[tuple(storey_laws())]

Length = Annotated[float, units.LENGTH]
Slab = Annotated[float, limited(units.LENGTH, name="slab thickness", example="25 cm", open_low=False)]
ColumnShare = Annotated[float, Quantity("share of the columns", "", "20 %", 0.0, 1.0, open_low=True)]
Mass = Annotated[float, units.MASS]
Period = Annotated[float, limited(units.TIME, name="period", high=60.0)]
Force = Annotated[float, units.FORCE]
StoreyStiffness = Annotated[float, units.STIFFNESS]
Taper = Annotated[float, Quantity("taper", "", "1/3", 0.0, 10.0, open_low=True)]
Hardening = Annotated[float, Quantity("hardening ratio", "", "0.05", 0.0, 1.0, open_high=True)]
Masses = Annotated[Annotated[tuple[Mass, ...], EACH_STOREY, Tag("list")] | Annotated[Mass, Tag("one")], EITHER]
Heights = Annotated[Annotated[tuple[Length, ...], EACH_STOREY, Tag("list")] | Annotated[Length, Tag("one")], EITHER]
Hardenings = Annotated[
    Annotated[tuple[Hardening, ...], EACH_STOREY, Tag("list")] | Annotated[Hardening, Tag("one")], EITHER
]
YieldShears = Annotated[
    Annotated[tuple[Force, ...], EACH_STOREY, Tag("list")] | Annotated[Literal["never"], Tag("one")], EITHER
]

StoreyLoad = Annotated[float, limited(units.FORCE, name="weight on a storey", example="9000 kN", open_low=False)]
PDelta = Annotated[Annotated[tuple[StoreyLoad, ...], EACH_STOREY, Tag("list")] | Annotated[bool, Tag("one")], EITHER]

Collapse = Annotated[
    float | str, Quantity("drift ratio of collapse", "", "10 %", 0.0, 1.0, open_low=True, words=("never",))
]

Overstrength = Annotated[float, Quantity("overstrength", "", "2", 0.1, 20.0)]


class CodeDesign(Model):
    """Yield shears equal to the storey shears of the Uniform Building Code."""

    code: Edition = optional("UBC-1991", description="edition")
    zone: Annotated[float, Quantity("zone factor Z", "", "0.4", 0.0, 1.0, open_low=True)] = optional(
        0.4, description="zone factor Z [-]; in UBC-1985 zone 4 has Z = 1 and the key must be given"
    )
    soil: Annotated[float, Quantity("soil factor S", "", "1.2", 1.0, 2.0)] = optional(
        1.2, description="soil factor S [-]"
    )
    importance: Annotated[float, Quantity("importance factor I", "", "1", 0.5, 2.0)] = optional(
        1.0, description="importance factor I [-]"
    )
    rw: Annotated[float, Quantity("system factor Rw", "", "12", 1.0, 20.0)] | None = optional(
        None, alias="Rw", description="system factor of UBC 1988 to 1994 [-]; default: 12"
    )
    k: Annotated[float, Quantity("system factor K", "", "0.67", 0.0, 4.0, open_low=True)] | None = optional(
        None, alias="K", description="system factor of UBC 1985 [-]; must be given there"
    )
    overstrength: Overstrength = optional(
        1.0, description="factor on the yield shears [-]; the separation is unchanged"
    )


BASE_SHEAR = frozenset({"base_shear", "distribution", "Cd", "Ie", "qd"})
"""Keys of a yield that speak of a base shear."""

_COEFFICIENT = Quantity("base shear over weight V/W", "", "0.10 W", 1e-4, 10.0)


def _read_base_shear(value: Any) -> float:
    if isinstance(value, str) and value.strip().endswith("W"):
        return _COEFFICIENT.read(value.strip()[:-1])
    try:
        return _COEFFICIENT.read(value)
    except PydanticCustomError:
        if isinstance(value, str) and factor_of(written_unit(value), "N") is not None:
            raise refuse(
                f"'{value}' is a force: the base shear is given as a part of the weight W",
                "write e.g. `base_shear: 0.10 W`; storey by storey in N, `yield_shear: [...]` stands beside `yield`",
            ) from None
        raise


class BaseShear(Model):
    """Yield shears from a base-shear coefficient and a distribution of the forces over the height."""

    base_shear: Annotated[float, TextForm(_read_base_shear, "part of the weight W", ("0.10 W", 0.1), _COEFFICIENT)] = (
        Field(description="base shear over weight V/W [-]", examples=["0.10 W"])
    )
    distribution: Distribution = optional(
        "triangular",
        description="forces over the height: by w h, w, w h^2, w h^k of ASCE 7, or the UBC's with a force at the top",
    )
    overstrength: Overstrength = optional(1.0, description="factor on the yield shears [-]")
    cd: Annotated[float, Quantity("deflection amplification factor Cd", "", "5.5", 1.0, 10.0)] | None = optional(
        None, alias="Cd", description="deflection amplification factor Cd of ASCE 7 [-], for `pound gap`"
    )
    ie: Annotated[float, Quantity("importance factor Ie", "", "1", 1.0, 2.0)] | None = optional(
        None, alias="Ie", description="importance factor Ie of ASCE 7 [-], for `pound gap`"
    )
    qd: Annotated[float, Quantity("displacement behaviour factor q_d", "", "3.9", 1.0, 20.0)] | None = optional(
        None, description="displacement behaviour factor q_d of EN 1998-1 [-], for `pound gap`"
    )


def _yield_kind(value: Any) -> str:
    # The tags are no keys of the file, so that a problem is not looked for below the key of that name.
    given = isinstance(value, dict) and not value.keys().isdisjoint(BASE_SHEAR)
    return "by base shear" if given or isinstance(value, BaseShear) else "by code"


Yield = Annotated[
    Annotated[CodeDesign, Tag("by code")] | Annotated[BaseShear, Tag("by base shear")], Discriminator(_yield_kind)
]


class Rayleigh(Model):
    """Structural damping C = alpha M + beta K0 of the fixed-base building."""

    alpha: Annotated[float, Quantity("alpha", "1/s", "0.5", 0.0)] = Field(description="mass factor [1/s]")
    beta: Annotated[float, Quantity("beta", "s", "0.001 s", 0.0)] = Field(description="stiffness factor [s]")


class FoundationSpec(Model):
    """Sway and rocking of the base; a motion whose stiffness is absent does not take place."""

    mass: Annotated[float, quantity_of(Sway, "mass", "100 t", absent=True)] = optional(
        0.0, description=words_about(Sway, "mass")
    )
    sway_stiffness: Annotated[float, quantity_of(Sway, "sway_stiffness", "200 kN/mm")] | None = optional(
        None, description=f"{words_about(Sway, 'sway_stiffness')}; absent: no sway"
    )
    sway_damping: Annotated[float, quantity_of(Sway, "sway_damping", "1e6 N s/m")] = optional(
        0.0, description=words_about(Sway, "sway_damping")
    )
    inertia: Annotated[float, quantity_of(Rocking, "inertia", "1000 t m2", absent=True)] = optional(
        0.0, description=words_about(Rocking, "inertia")
    )
    rocking_stiffness: Annotated[float, quantity_of(Rocking, "rocking_stiffness", "5e9 N m")] | None = optional(
        None, description=f"{words_about(Rocking, 'rocking_stiffness')}; absent: no rocking"
    )
    rocking_damping: Annotated[float, quantity_of(Rocking, "rocking_damping", "1e7 N m s")] = optional(
        0.0, description=words_about(Rocking, "rocking_damping")
    )


Base = Annotated[
    Annotated[Literal["fixed"], Tag("word")] | Annotated[FoundationSpec, Tag("mapping")],
    Discriminator(word_or_mapping),
]


class StiffnessAt(Model):
    """Storey stiffnesses that give a period with certain masses; they stay when the masses of the building change."""

    period: Period = Field(
        description="fundamental period of the fixed-base building with these masses [s]", examples=["0.42 s"]
    )
    mass: Masses = Field(
        description="floor masses at which the building has this period [kg], one or a list", examples=["300 t"]
    )


def _list_or_mapping(value: Any) -> str:
    return "mapping" if isinstance(value, dict | StiffnessAt) else "list"


Stiffnesses = Annotated[
    Annotated[tuple[StoreyStiffness, ...], EACH_STOREY, Tag("list")] | Annotated[StiffnessAt, Tag("mapping")],
    Discriminator(_list_or_mapping),
]


class _BuildingSpec(Model):
    """One building type; lists run from the ground up."""

    like: str | None = optional(None, description="another building whose keys apply unless given here")
    storeys: Annotated[int, Field(ge=1, le=100), whole_number(1, 100)] | None = optional(
        None, description="number of storeys; default: the length of a list", examples=[5]
    )
    period: Period | None = optional(
        None, description="fundamental period of the fixed-base building [s]", examples=["0.36 s"]
    )
    mass: Masses = optional("200 t", description="floor mass [kg], one or a list")
    height: Heights = optional("3 m", description="storey height [m], one or a list")
    taper: Taper = optional("1/3", description="top over bottom storey stiffness [-], linear in between")
    stiffness: Stiffnesses | None = optional(
        None,
        description="storey stiffnesses [N/m], instead of period and taper; or {period: 0.42 s, mass: 300 t}: those of "
        "a building with this period and these masses, which stay when the mass is varied",
    )
    damping: DampingShare = optional("5 %", description="damping ratio of the first two modes [-]")
    rayleigh: Rayleigh | None = optional(None, description="Rayleigh factors, instead of damping")
    hardening: Hardenings = optional(0.05, description="post-yield over initial stiffness [-], one or a list")
    yield_: Yield = optional(
        CodeDesign(), alias="yield", description="code or base-shear coefficient that sets the yield shears"
    )
    yield_shear: YieldShears | None = optional(
        None, description="storey yield shears [N], instead of yield; `never`: the storeys stay elastic"
    )
    storey_law: StoreyKind = optional("bilinear", description="how storeys yield and unload")
    p_delta: PDelta = optional(
        False,
        description="P-Delta, the push of the weight on a storey that drifts: `true` for the weight of "
        "the floors above, or the weight on every storey [N], a list",
    )
    collapse: Collapse | None = optional(
        None,
        description="drift over storey height at which a storey counts as collapsed and the run ends [-]; default: "
        "10 % if a storey may lose all resistance; `never`: not checked",
    )
    foundation: Base = optional("fixed", description="springs under the base; `fixed`: none")
    slab: Slab = optional("0 cm", description="thickness of the floor slabs [m]; slabs whose heights overlap meet")
    columns: ColumnShare | None = optional(
        None,
        description="part of a storey's stiffness and yield shear in the columns that a neighbour's slab strikes [-]; "
        "without it such blows are left out",
    )


if TYPE_CHECKING:
    BuildingSpec = _BuildingSpec
else:
    BuildingSpec = create_model("BuildingSpec", __base__=_BuildingSpec, __doc__=_BuildingSpec.__doc__, **storey_keys())
