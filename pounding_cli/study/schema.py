"""The study file as pydantic models: every key, its unit, its default and what it means."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, Discriminator, Field, Tag, WithJsonSchema, create_model
from pydantic_core import PydanticCustomError

from pounding_cli.laws import KELVIN_VOIGT, contact_laws, link_laws, storey_laws
from pounding_cli.laws.foundation import Rocking, Sway
from pounding_cli.methods import ACCURACY, AUTO, METHODS, TIME_STEP
from pounding_cli.study import units
from pounding_cli.study.base import Model, Name, optional, word_or_mapping
from pounding_cli.study.formulas import LawSpec
from pounding_cli.study.law_keys import LawWord, contact_keys, link_keys, quantity_of, storey_keys, words_about
from pounding_cli.study.record_schema import Records
from pounding_cli.study.rules import STIFFNESS_FORM, StiffnessRule
from pounding_cli.study.units import Quantity, TextForm, factor_of, limited, refuse, whole_number, written_unit
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    Method = str
else:
    Method = Literal[(AUTO, *METHODS)]

Edition = Literal["UBC-1985", "UBC-1988", "UBC-1991", "UBC-1994"]
Distribution = Literal["triangular", "uniform", "parabolic", "asce7", "ubc"]
if TYPE_CHECKING:
    LinkKind = str
    LawName = str
    ContactKind = str
    StoreyKind = str
else:
    LinkKind = Annotated[str, LawWord((*link_laws(), "none"))]
    LawName = Annotated[str, LawWord(tuple(link_laws()))]
    ContactKind = Annotated[str, LawWord(tuple(contact_laws()))]
    StoreyKind = Literal[tuple(storey_laws())]
AnalysisKind = Literal["elastic", "inelastic"]

Length = Annotated[float, units.LENGTH]
Gap = Annotated[float, units.GAP]
Slab = Annotated[float, limited(units.LENGTH, name="slab thickness", example="25 cm", open_low=False)]
ColumnShare = Annotated[float, Quantity("share of the columns", "", "20 %", 0.0, 1.0, open_low=True)]
Mass = Annotated[float, units.MASS]
Period = Annotated[float, limited(units.TIME, name="period", high=60.0)]
Force = Annotated[float, units.FORCE]
StoreyStiffness = Annotated[float, units.STIFFNESS]
LinkStiffness = Annotated[float | StiffnessRule, STIFFNESS_FORM]
Taper = Annotated[float, Quantity("taper", "", "1/3", 0.0, 10.0, open_low=True)]
DampingShare = Annotated[float, Quantity("damping ratio", "", "5 %", 0.0, 1.0, open_high=True)]
Hardening = Annotated[float, Quantity("hardening ratio", "", "0.05", 0.0, 1.0, open_high=True)]
Restitution = Annotated[float, Quantity("coefficient of restitution", "", "0.5", 0.0, 1.0, open_low=True)]


def _list_or_one(value: Any) -> str:
    return "list" if isinstance(value, list | tuple) else "one"


_ACCURACY_FORM = Quantity(
    ACCURACY.title, ACCURACY.unit, ACCURACY.example, ACCURACY.low, ACCURACY.high, words=(AUTO,)
)  # fmt: skip
_FILLED = Field(min_length=1, max_length=10_000)
_STOREYS = Field(min_length=1, max_length=100)
_EITHER = Discriminator(_list_or_one)
Masses = Annotated[Annotated[tuple[Mass, ...], _STOREYS, Tag("list")] | Annotated[Mass, Tag("one")], _EITHER]
Heights = Annotated[Annotated[tuple[Length, ...], _STOREYS, Tag("list")] | Annotated[Length, Tag("one")], _EITHER]
Hardenings = Annotated[
    Annotated[tuple[Hardening, ...], _STOREYS, Tag("list")] | Annotated[Hardening, Tag("one")], _EITHER
]
YieldShears = Annotated[
    Annotated[tuple[Force, ...], _STOREYS, Tag("list")] | Annotated[Literal["never"], Tag("one")], _EITHER
]

StoreyLoad = Annotated[float, limited(units.FORCE, name="weight on a storey", example="9000 kN", open_low=False)]
PDelta = Annotated[Annotated[tuple[StoreyLoad, ...], _STOREYS, Tag("list")] | Annotated[bool, Tag("one")], _EITHER]

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
        None, alias="Rw", description="system factor of UBC 1988 to 1994 [-]; 12 unless given"
    )
    k: Annotated[float, Quantity("system factor K", "", "0.67", 0.0, 4.0, open_low=True)] | None = optional(
        None, alias="K", description="system factor of UBC 1985 [-]; must be given there"
    )
    overstrength: Overstrength = optional(
        1.0, description="factor on the yield shears [-]; the separation is unchanged"
    )


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


def _yield_kind(value: Any) -> str:
    # The tags are no keys of the file, so that a problem is not looked for below the key of that name.
    given = isinstance(value, dict) and not value.keys().isdisjoint(("base_shear", "distribution"))
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


class _BuildingSpec(Model):
    """One building type; lists run from the ground up."""

    like: str | None = optional(None, description="another building whose keys are taken unless given here")
    storeys: Annotated[int, Field(ge=1, le=100), whole_number(1, 100)] | None = optional(
        None, description="number of storeys; the length of a list unless given", examples=[5]
    )
    period: Period | None = optional(
        None, description="fundamental period of the fixed-base building [s]", examples=["0.36 s"]
    )
    mass: Masses = optional("200 t", description="floor mass [kg], one or a list")
    height: Heights = optional("3 m", description="storey height [m], one or a list")
    taper: Taper = optional("1/3", description="top over bottom storey stiffness [-], linear in between")
    stiffness: Annotated[tuple[StoreyStiffness, ...], _STOREYS] | None = optional(
        None, description="storey stiffnesses [N/m], instead of period and taper"
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
        description="drift over storey height at which a storey counts as collapsed and the run ends [-]; 10 % unless "
        "given where a storey may lose all resistance; `never`: not looked for",
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


class _Impact(Model):
    """The impact element of pounding, and what an infill stiffens to."""

    law: ContactKind = optional(
        KELVIN_VOIGT, description="law of contact of every `link: pounding`; it may be swept, so that laws are compared"
    )
    stiffness: LinkStiffness = optional("20 x stiffest storey", description="impact spring s_imp [N/m]")
    restitution: Restitution = optional(0.5, description="coefficient of restitution e [-]")
    damping_ratio: DampingShare | None = optional(
        None, description="damping ratio of the dashpot [-], instead of restitution"
    )
    tension_cut: bool = optional(False, description="no force that pulls the floors together at the end of a contact")
    dashpot: Literal["reduced-mass", "printed"] = optional(
        "reduced-mass", description="mass in eq. (7); `printed` is its form in the paper, whose unit is wrong"
    )


if TYPE_CHECKING:
    Impact = _Impact
else:
    Impact = create_model("Impact", __base__=_Impact, __doc__=_Impact.__doc__, **contact_keys())


class _LinkSpec(Model):
    """One link; what is not given is taken from the case around it and then from `impact`."""

    link: LinkKind | None = optional(None, description="what stands between the floors")
    gap: Gap | None = optional(None, description="initial distance d [m]", examples=["5 cm", "0 cm"])
    stiffness: LinkStiffness | None = optional(
        None,
        description="s_imp, s_mat, s_con or k [N/m]; unless given 1/5 mean storey of infill and connector, "
        "1 x mean storey of maxwell and friction",
    )
    restitution: Restitution | None = optional(None, description="coefficient of restitution e [-]")
    damping_ratio: DampingShare | None = optional(None, description="damping ratio [-], instead of restitution")
    tension_cut: bool | None = optional(None, description="no force that pulls the floors together")


Floor = Annotated[int, Field(ge=1, le=100), whole_number(1, 100)]


def _floors_kind(value: Any) -> str:
    if isinstance(value, int) and not isinstance(value, bool):
        return "single"
    return _list_or_one(value)


Floors = Annotated[
    Annotated[tuple[Floor, ...], _STOREYS, Tag("list")]
    | Annotated[Floor, AfterValidator(lambda floor: (floor,)), Tag("single")]
    | Annotated[Literal["all"], Tag("one")],
    Discriminator(_floors_kind),
]


class _ListedLink(_LinkSpec):
    """One of several links between the same floors."""

    link: LawName = Field(description="what stands between the floors, beside the others of the list")
    floors: Floors = optional("all", description="floors with this link, of those that the list stands on")


if TYPE_CHECKING:
    ListedLink = _ListedLink
else:
    ListedLink = create_model("ListedLink", __base__=_ListedLink, __doc__=_ListedLink.__doc__, **link_keys())

ListedOrWord = Annotated[
    Annotated[LawName, Tag("word")] | Annotated[ListedLink, Tag("mapping")], Discriminator(word_or_mapping)
]
WordOrList = Annotated[
    Annotated[LinkKind, Tag("word")]
    | Annotated[tuple[ListedOrWord, ...], Field(min_length=1, max_length=10), Tag("list")],
    Discriminator(lambda value: "list" if isinstance(value, list | tuple) else "word"),
]


class _AnyLinks(_LinkSpec):
    __doc__ = _LinkSpec.__doc__

    link: WordOrList | None = optional(  # type: ignore[assignment]
        None, description="what stands between the floors; a list where several join the same floors"
    )


if TYPE_CHECKING:
    LinkSpec = _AnyLinks
else:
    LinkSpec = create_model("LinkSpec", __base__=_AnyLinks, __doc__=_LinkSpec.__doc__, **link_keys())

LinkOrWord = Annotated[
    Annotated[LinkKind, Tag("word")] | Annotated[LinkSpec, Tag("mapping")], Discriminator(word_or_mapping)
]


class PairSpec(LinkSpec):
    """The links of one pair of neighbours."""

    floors: Floors = optional("all", description="floors with this link, numbered in the left building of the pair")
    elsewhere: LinkOrWord = optional("none", description="the link on the floors not listed")
    by_floor: dict[Floor, LinkOrWord] = optional({}, description="links of single floors; they come before `floors`")
    at_columns: LinkOrWord | None = optional(
        None,
        description="where a slab strikes columns: `pounding` or `none`; unless given as floors that are not listed",
    )


PairOrWord = Annotated[
    Annotated[LinkKind, Tag("word")] | Annotated[PairSpec, Tag("mapping")], Discriminator(word_or_mapping)
]


class CaseSpec(PairSpec):
    """A case: what stands between the buildings of the group."""

    pairs: Annotated[tuple[PairOrWord, ...], Field(min_length=1, max_length=100)] | None = optional(
        None, description="one entry for each pair of neighbours, left to right, where they differ"
    )


class ReportSpec(Model):
    """What the report shows first."""

    plot: tuple[str, ...] | None = optional(None, description="cases in the main figure; all unless given")
    building: str | None = optional(None, description="building of the main figure; the stiffest unless given")


class HistoriesSpec(Model):
    """Scenes whose histories are kept."""

    cases: Annotated[tuple[str, ...], _FILLED] | None = optional(None, description="cases; all unless given")
    analyses: Annotated[tuple[AnalysisKind, ...], _FILLED] | None = optional(
        None, description="analyses; all unless given"
    )
    records: Annotated[tuple[str, ...], _FILLED] | None = optional(None, description="motions; all unless given")
    where: dict[str, Any] = optional(
        {}, description="swept keys with the value or the list of values kept; all unless given"
    )
    every: Annotated[
        float, limited(units.TIME, name="output step", example="2 ms", low=1e-6, high=1.0, open_low=False)
    ] = optional(0.002, description="output step [s]")


class KeepSpec(Model):
    """What is kept besides peaks."""

    histories: Annotated[
        Annotated[Literal["all"], Tag("word")] | Annotated[HistoriesSpec, Tag("mapping")],
        Discriminator(word_or_mapping),
    ] = Field(description="scenes kept over time, or `all`", examples=[{"cases": ["touching"]}])


Keep = Annotated[
    Annotated[Literal["histories"], Tag("word")] | Annotated[KeepSpec, Tag("mapping")], Discriminator(word_or_mapping)
]

_RANGE = {
    "type": "object",
    "properties": {
        "from": {"type": ["number", "string"]},
        "to": {"type": ["number", "string"]},
        "count": {"type": "integer", "minimum": 2},
        "step": {"type": ["number", "string"]},
        "spacing": {"enum": ["linear", "log"]},
    },
    "required": ["from", "to"],
    "additionalProperties": False,
}
_AXIS = {"anyOf": [{"type": "array", "minItems": 1}, _RANGE]}
_SWEEP_FORM = {
    "anyOf": [
        {"type": "object", "additionalProperties": _AXIS},
        {"type": "array", "items": {"type": "object", "additionalProperties": _AXIS}},
    ],
    "title": "Sweep",
    "examples": [{"impact.restitution": [0.4, 0.5, 0.65]}],
}
_BRACKET_FORM = {
    "anyOf": [
        {"const": "impact.stiffness"},
        {"type": "object", "additionalProperties": {"type": "array", "minItems": 3}},
    ],
    "title": "Bracket",
    "examples": ["impact.stiffness"],
}
_UNCERTAIN_KEYS = {
    "type": "object",
    "additionalProperties": {
        "anyOf": [{"enum": ["any", "bootstrap"]}, {"type": "object", "minProperties": 1, "maxProperties": 1}]
    },
}
_UNCERTAIN_FORM = {
    "anyOf": [_UNCERTAIN_KEYS, {"type": "array", "items": _UNCERTAIN_KEYS}],
    "title": "Uncertain",
    "examples": [{"impact.restitution": {"uniform": {"from": 0.4, "to": 0.65}}, "motion": "any"}],
}


class _StudyModel(Model):
    """A study of earthquake pounding between adjacent buildings."""

    model_config = ConfigDict(frozen=False, validate_assignment=True, title="pound study")

    title: str = optional("", description="shown on every figure and table; the file's name unless given")
    records: Records = Field(description="ground motions")
    buildings: dict[Name, BuildingSpec] = Field(description="building types by name", min_length=1, max_length=1000)
    group: tuple[str, ...] = Field(
        max_length=100, description="buildings from left to right", examples=[["stiff", "soft"]]
    )
    impact: Impact = optional(Impact(), description="impact element")
    laws: dict[Name, LawSpec] = optional({}, description="laws of links of the study's own, by name")
    cases: dict[Name, CaseSpec] = Field(description="cases by name", min_length=1, max_length=20_000)
    analyses: Annotated[tuple[AnalysisKind, ...], Field(min_length=1)] = optional(
        ("elastic", "inelastic"), description="whether storeys may yield"
    )
    accuracy: Annotated[float | str, _ACCURACY_FORM] = optional(
        ACCURACY.default,
        description="relative error wanted of the peaks [-]; `auto`: every digit that costs next to nothing",
    )
    method: Method = optional(
        "auto", description="how the equations of motion are solved; `auto`: the cheapest that keeps the accuracy"
    )
    time_step: Annotated[float, limited(units.TIME, name=TIME_STEP.title, example=TIME_STEP.example)] | None = optional(
        None, description="time step of a fixed-step method [s]"
    )
    estimate: Literal["none", "sample", "all"] = optional(
        "all", description="scenes solved once more, for their numerical error and their sensitivity"
    )
    tail: Annotated[float, Quantity("tail", "s", "5 s", 0.0, 1000.0)] = optional(
        0.0, description="free vibration after the motion [s]"
    )
    claims: Literal["fig6", "fig7"] | None = optional(None, description="figure of the paper this study reproduces")
    report: ReportSpec = optional(ReportSpec(), description="what the report shows first")
    keep: Keep | None = optional(None, description="histories kept besides peaks; `histories`: of all scenes")
    sweep: Annotated[Any, WithJsonSchema(_SWEEP_FORM)] = optional(
        None,
        description="axes: dotted keys with the values they take; the keys of one list entry move together",
    )
    uncertain: Annotated[Any, WithJsonSchema(_UNCERTAIN_FORM)] = optional(
        None,
        description="dotted keys with the distribution of each: `uniform`, `normal`, `lognormal`, `triangular` or "
        "`choice`; `motion: any` chooses one of the motions, `motion: bootstrap` draws as many anew; the keys of one "
        "list entry move together",
    )
    bracket: Annotated[Any, WithJsonSchema(_BRACKET_FORM)] = optional(
        None,
        description="keys whose values nobody knows, with an odd number of them: the middle one leads in tables and "
        "figures; `impact.stiffness`: a quarter of, once and five times the study's own",
    )


def _sections() -> dict[str, tuple[Any, Any]]:
    """The sections that workflows add to a study, as `pydantic.create_model` takes them."""
    found: dict[str, tuple[Any, Any]] = {}
    for name, workflow in WORKFLOWS.items():
        if (section := workflow.part("schema")) is not None:
            found[name] = section, optional(section(), description=f"what `pound {name}` is asked")
    return found


if TYPE_CHECKING:
    StudyModel = _StudyModel
else:
    StudyModel = create_model("StudyModel", __base__=_StudyModel, __doc__=_StudyModel.__doc__, **_sections())


def json_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of a study file, for editors."""
    schema = StudyModel.model_json_schema(by_alias=True)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
