"""The study file as pydantic models: every key, its unit, its default and what it means."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, WithJsonSchema, create_model

from pounding_cli.methods import ACCURACY, METHODS, TIME_STEP
from pounding_cli.study import units
from pounding_cli.study.base import Model, Name, optional, word_or_mapping
from pounding_cli.study.building_schema import BuildingSpec
from pounding_cli.study.case_schema import CaseSpec, Impact
from pounding_cli.study.formulas import LawSpec
from pounding_cli.study.record_schema import Records
from pounding_cli.study.units import Quantity, limited
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    Method = str
else:
    Method = Literal[tuple(METHODS)]
AnalysisKind = Literal["elastic", "inelastic"]

_ACCURACY_FORM = Quantity(ACCURACY.title, ACCURACY.unit, ACCURACY.example, ACCURACY.low, ACCURACY.high)
_FILLED = Field(min_length=1, max_length=10_000)


class ReportSpec(Model):
    """What the report shows first."""

    plot: tuple[str, ...] | None = optional(None, description="cases in the main figure; default: all")
    building: str | None = optional(None, description="building of the main figure; default: the stiffest")


class HistoriesSpec(Model):
    """Scenes whose histories are kept."""

    cases: Annotated[tuple[str, ...], _FILLED] | None = optional(None, description="cases; default: all")
    analyses: Annotated[tuple[AnalysisKind, ...], _FILLED] | None = optional(None, description="analyses; default: all")
    records: Annotated[tuple[str, ...], _FILLED] | None = optional(None, description="motions; default: all")
    where: dict[str, Any] = optional(
        {}, description="swept keys with the value or the list of values to keep; default: all"
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

    title: str = optional("", description="title of figures and tables; default: the file's name")
    records: Records = Field(description="ground motions")
    buildings: dict[Name, BuildingSpec] = Field(description="building types by name", min_length=1, max_length=1000)
    group: tuple[str, ...] = Field(
        max_length=100, description="buildings from left to right", examples=[["stiff", "soft"]]
    )
    impact: Impact = optional(Impact(), description="impact element")
    laws: dict[Name, LawSpec] = optional({}, description="the study's own laws of links, by name")
    cases: dict[Name, CaseSpec] = Field(description="cases by name", min_length=1, max_length=20_000)
    analyses: Annotated[tuple[AnalysisKind, ...], Field(min_length=1)] = optional(
        ("elastic", "inelastic"), description="whether storeys may yield"
    )
    accuracy: Annotated[float, _ACCURACY_FORM] = optional(
        ACCURACY.default, description="relative error of the peaks [-]"
    )
    method: Method = optional("taylor", description="how the equations of motion are solved")
    time_step: Annotated[float, limited(units.TIME, name=TIME_STEP.title, example=TIME_STEP.example)] | None = optional(
        None, description="time step of a fixed-step method [s]"
    )
    estimate: Literal["none", "sample", "all"] = optional(
        "all", description="scenes whose numerical error and sensitivity are estimated"
    )
    tail: Annotated[float, Quantity("tail", "s", "5 s", 0.0, 1000.0)] = optional(
        0.0, description="free vibration after the motion [s]"
    )
    claims: Literal["fig6", "fig7"] | None = optional(
        None, description="figure of the paper that this study reproduces"
    )
    report: ReportSpec = optional(ReportSpec(), description="first figure of the report")
    keep: Keep | None = optional(None, description="histories to keep; `histories`: of all scenes")
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
        description="keys with unknown values, each with an odd number of values: the middle one comes first in tables "
        "and figures; `impact.stiffness`: a quarter of, once and five times the study's own",
    )


def _sections() -> dict[str, tuple[Any, Any]]:
    """The sections that workflows add to a study, as `pydantic.create_model` takes them."""
    found: dict[str, tuple[Any, Any]] = {}
    for name, workflow in WORKFLOWS.items():
        if workflow.is_section:
            section = workflow.part("schema")
            found[name] = section, optional(section(), description=f"settings of `pound {name}`")
    return found


if TYPE_CHECKING:
    StudyModel = _StudyModel
else:
    StudyModel = create_model("StudyModel", __base__=_StudyModel, __doc__=_StudyModel.__doc__, **_sections())


def json_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of a study file, for editors."""
    schema = StudyModel.model_json_schema(by_alias=True)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
