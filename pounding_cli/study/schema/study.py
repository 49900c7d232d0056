"""The study file as one pydantic model, and its JSON Schema for editors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal, NamedTuple, TypeVar

from pydantic import ConfigDict, Field, StringConstraints, WithJsonSchema, create_model
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from pounding_cli.errors import Issue
from pounding_cli.laws import link_laws
from pounding_cli.methods import ACCURACY, METHODS, TIME_STEP
from pounding_cli.notes import NOTES
from pounding_cli.study.schema.base import (
    LabelText,
    Model,
    Name,
    list_or,
    mapping_schema,
    one_or_many,
    spec_field,
    word_or,
)
from pounding_cli.study.schema.building import BuildingSpec
from pounding_cli.study.schema.links import NO_LINK, OWN_LAW, CaseSpec, ImpactSpec, OwnLawSpec, link_models
from pounding_cli.study.schema.quantity import TIME, Quantity
from pounding_cli.study.schema.records import RecordsSpec

AnalysisName = Literal["elastic", "inelastic"]
_NoteCode: Any = Literal[tuple(NOTES)]
_Kind = TypeVar("_Kind")
_Buildings = Annotated[dict[Name, _Kind], Field(min_length=1, max_length=1000)]
_Cases = Annotated[dict[Name, _Kind], Field(min_length=1, max_length=20_000)]
_Laws = dict[Name, _Kind]

ENTRIES: dict[str, tuple[Any, Any]] = {
    "buildings": (_Buildings[Any], BuildingSpec),
    "cases": (_Cases[Any], CaseSpec),
    "laws": (_Laws[Any], OwnLawSpec),
}
"""Sections of entries by name: the type of the section, whatever its entries are, and the type of an entry."""

_FILLED = Field(min_length=1, max_length=10_000)


class ReportSpec(Model):
    """The choice of what the report shows first."""

    plot: tuple[str, ...] | None = spec_field(None, "cases in the main figure; default: all")
    building: str | None = spec_field(None, "building of the main figure; default: the stiffest")


class HistoriesSpec(Model):
    """Scenes whose histories are kept."""

    cases: Annotated[tuple[str, ...], _FILLED] | None = spec_field(None, "cases; default: all")
    analyses: Annotated[tuple[AnalysisName, ...], _FILLED] | None = spec_field(None, "analyses; default: all")
    records: Annotated[tuple[str, ...], _FILLED] | None = spec_field(None, "motions; default: all")
    where: dict[str, Any] = spec_field({}, "swept keys with the value or the list of values to keep; default: all")
    every: Annotated[float, TIME.replace(name="output step", example="2 ms", low=1e-6, high=1.0, open_low=False)] = (
        spec_field(0.002, "output step [s]")
    )


_Histories: Any = word_or(Literal["all"], HistoriesSpec)


class KeepSpec(Model):
    """The choice of what is kept besides peaks."""

    histories: _Histories = spec_field(..., "scenes kept over time, or `all`", {"cases": ["touching"]})


_Keep: Any = word_or(Literal["histories"], KeepSpec)


_VALUE = {"type": ["number", "string"]}
_SPACING = {"enum": ["linear", "log"]}
_STEPS = {"count": {"type": "integer", "minimum": 2}, "step": _VALUE, "spacing": _SPACING}
_RANGE = mapping_schema("from", "to", **{"from": _VALUE, "to": _VALUE}, **_STEPS)
_BRACKET = mapping_schema("values", "middle", values={"type": "array", "minItems": 3}, middle=_VALUE)
_AXES = {"type": "object", "additionalProperties": {"anyOf": [{"type": "array", "minItems": 1}, _RANGE, _BRACKET]}}
_SWEEP_FORM = {
    "anyOf": [_AXES, {"type": "array", "items": _AXES}],
    "title": "Sweep",
    "examples": [{"impact.restitution": [0.4, 0.5, 0.65]}],
}
_DRAWN = {"anyOf": [{"enum": ["any", "bootstrap"]}, {"type": "object", "minProperties": 1, "maxProperties": 1}]}
_UNCERTAIN_KEYS = {"type": "object", "additionalProperties": _DRAWN}
_UNCERTAIN_FORM = {
    "anyOf": [_UNCERTAIN_KEYS, {"type": "array", "items": _UNCERTAIN_KEYS}],
    "title": "Uncertain",
    "examples": [{"impact.restitution": {"uniform": {"from": 0.4, "to": 0.65}}, "motion": "any"}],
}


_TEXT = Annotated[str, StringConstraints(min_length=1, max_length=500)]
_WRITTEN_VALUE = Annotated[_TEXT, WithJsonSchema(_VALUE)]


class StatementSpec(Model):
    """One statement on the results: comparisons that hold, or a number and what it should be."""

    says: Annotated[str, StringConstraints(min_length=1, max_length=500)] = spec_field(
        ..., "the statement, in the words of its source", "the infill lowers the response"
    )
    source: Annotated[str, StringConstraints(max_length=200)] = spec_field("", "where it stands", "table 3")
    name: LabelText | None = spec_field(None, "short name in tables; default: its number", "infill")
    reading: Annotated[str, StringConstraints(max_length=200)] = spec_field(
        "", "how its words are read, where they may be read otherwise", "mean over the storeys"
    )
    holds: one_or_many(_TEXT, 0, 100, True) = spec_field(  # type: ignore[valid-type]
        (),
        "comparisons of columns of the tables with each other or with values, one or a list: `mean V_ratio in infill < "
        "mean V_ratio in touching`, `0 < mu in soft / mu in stiff - 1 < 15 %`; places behind `in` are buildings, "
        "`storey N`, cases, analyses, motions, `pounding links`, `stiffest building`, `softer buildings`; in brackets "
        "a point of the sweep, `mu [cases.near.gap = 2 cm]`, or an instant of a kept history, "
        "`displacement in soft floor 1 [1.1 s]`, `time [contact 2]`, `time [largest link_force after contact 2]`",
    )
    number: _TEXT | None = spec_field(None, "the number that `is` tells", "largest displacement in left floor 3")
    is_: _WRITTEN_VALUE | None = spec_field(None, "what the number should be, with its unit", "32.9 cm", alias="is")
    within: _WRITTEN_VALUE | None = spec_field(
        None, "by how much it may differ: a share, or a value with its unit", "1 %"
    )
    at: dict[str, _WRITTEN_VALUE] = spec_field(
        {},
        "swept keys with the value at which all of it is tested; default: every point",
        {"impact.restitution": "0.5"},
    )
    over_motions: Literal["mean", "largest", "smallest", "each"] = spec_field(
        "mean", "value over the motions, storey by storey; `each`: it must hold under each of them"
    )

    def issues(self) -> Iterator[Issue]:
        numbers = {"number": self.number, "is": self.is_, "within": self.within}
        given = [key for key, value in numbers.items() if value is not None]
        hint = "write `holds: mu < 4`, or `number: mu, is: 3.2, within: 1 %`"
        if bool(self.holds) == bool(given):
            yield Issue(("says",), "a statement takes `holds`, or `number`, `is` and `within`", hint, at_key=True)
        elif given and len(given) < len(numbers):
            lacking = ", ".join(f"`{key}`" for key in numbers if key not in given)
            yield Issue((given[0],), f"a number lacks {lacking}", hint, at_key=True)


_Statements: Any = list_or(Annotated[tuple[StatementSpec, ...], Field(max_length=200)], _TEXT)


class StudySpec(Model):
    """A study of earthquake pounding between adjacent buildings; `add_sections` adds those of questions."""

    model_config = ConfigDict(title="pound study")

    title: str = spec_field("", "title of figures and tables; default: the file's name")
    records: RecordsSpec = spec_field(..., "ground motions", {"use": ["elcentro", "taft"]})
    buildings: _Buildings[BuildingSpec] = spec_field(
        ..., "building types by name", {"stiff": {"storeys": 5, "period": "0.36 s"}}
    )
    group: Annotated[tuple[str, ...], Field(max_length=100)] = spec_field(
        ..., "buildings from left to right", ["stiff", "soft"]
    )
    impact: ImpactSpec = spec_field(ImpactSpec(), "impact element")
    laws: _Laws[OwnLawSpec] = spec_field({}, "the study's own laws of links, by name")
    cases: _Cases[CaseSpec] = spec_field(..., "cases by name", {"near": {"link": "pounding", "gap": "5 cm"}})
    analyses: Annotated[tuple[AnalysisName, ...], Field(min_length=1)] = spec_field(
        ("elastic", "inelastic"), "whether storeys may yield"
    )
    accuracy: Annotated[float, Quantity("accuracy", "", ACCURACY.example, 1e-14, 0.1)] = spec_field(
        1e-6, "relative error of the peaks [-]"
    )
    method: Literal[tuple(METHODS)] = spec_field("taylor", "how the equations of motion are solved")  # type: ignore[valid-type]
    time_step: Annotated[float, TIME.replace(name=TIME_STEP.title, example=TIME_STEP.example)] | None = spec_field(
        None, "time step of a fixed-step method [s]"
    )
    estimate: Literal["none", "sample", "all"] = spec_field(
        "all", "scenes whose numerical error and sensitivity are estimated"
    )
    tail: Annotated[float, Quantity("tail", "s", "5 s", 0.0, 1000.0)] = spec_field(
        0.0, "free vibration after the motion [s]"
    )
    residual_drift: Annotated[bool, Field(strict=True)] = spec_field(
        False,
        "whether the drifts at rest, long after the motion, are found; they are wherever `sensitivity` or "
        "`optimise` names `residual_drift`",
        True,
    )
    statements: _Statements = spec_field(
        (),
        "what should hold of the results, each tested by `pound run`: a list, or a study file that has them",
        [{"says": "the infill lowers the response", "holds": "mean V_ratio in infill < mean V_ratio in touching"}],
    )
    accept: Annotated[tuple[_NoteCode, ...], Field(max_length=100)] = spec_field(
        (),
        "codes of warnings and notes that are known and not told any more; the page says which they are. "
        "`pound explain CODE` tells what one means",
        ["stiffness"],
    )
    report: ReportSpec = spec_field(ReportSpec(), "first figure of the report")
    keep: _Keep | None = spec_field(None, "histories to keep; `histories`: of all scenes")
    sweep: Annotated[Any, WithJsonSchema(_SWEEP_FORM)] = spec_field(
        None,
        "axes: dotted keys with the values they take, a list, a range `{from: 1 cm, to: 5 cm, count: 5}`, or low, "
        "middle and high of an unknown value, `{values: [2 cm, 5 cm, 9 cm], middle: 5 cm}`: figures and the answer "
        "show the middle one; the keys of one list entry move together",
    )
    uncertain: Annotated[Any, WithJsonSchema(_UNCERTAIN_FORM)] = spec_field(
        None,
        "dotted keys with the distribution of each: `uniform`, `normal`, `lognormal`, `triangular` or `choice`; "
        "`motion: any` chooses one of the motions, `motion: bootstrap` draws as many anew; the keys of one list entry "
        "move together",
    )

    def issues(self) -> Iterator[Issue]:
        method = self.method
        takes_step = METHODS[method].takes_step
        if takes_step and self.time_step is None:
            yield Issue(
                ("method",), f"method: {method} needs 'time_step'", f"write e.g. `time_step: {TIME_STEP.example}`"
            )
        if not takes_step and self.time_step is not None:
            message = f"'time_step' does not apply to method: {method}"
            yield Issue(("time_step",), message, "remove it; `accuracy:` controls the cost", at_key=True)
        for place, code in enumerate(self.accept or ()):  # None where it is faulty
            if not NOTES[code].can_be_accepted:
                message = f"'{code}' cannot be accepted: it takes the meaning from the numbers that it marks"
                yield Issue(("accept", place), message, f"remove it; `pound explain {code}` tells what to do about it")
        for place, analysis in enumerate(self.analyses):
            if analysis in self.analyses[:place]:
                yield Issue(("analyses", place), f"'{analysis}' occurs twice", "remove one")


class StudySection(NamedTuple):
    """The section of a study that says what a question asks.

    name : of the section and of the question
    spec : its model; every key has a default
    description : in the JSON Schema and the reference of study files
    example : a value of it; none in the schema unless given
    """

    name: str
    spec: type[Model]
    description: str
    example: Any = None


def add_sections(sections: tuple[StudySection, ...]) -> type[StudySpec]:
    """Return the model of a study with the sections of questions."""
    fields: dict[str, Any] = {
        section.name: (section.spec, spec_field(section.spec(), section.description, section.example))
        for section in sections
    }
    return create_model("StudySpec", __base__=StudySpec, __doc__=StudySpec.__doc__, **fields)


def find_section_names(model: type[StudySpec]) -> list[str]:
    """Return the names of the sections of questions that a model has."""
    return [name for name in model.model_fields if name not in StudySpec.model_fields]


ONCE = {*StudySpec.model_fields} - {"records", "buildings", "impact", "laws", "cases", "tail"}
"""Sections that are the same for the whole study, besides those of questions."""


class _SchemaGenerator(GenerateJsonSchema):
    """Generates a JSON Schema in which a value may fit several kinds of a tagged union.

    A function tells these kinds apart, which JSON Schema cannot: the list [3, 5] fits that of two floors and that of
    both ends of a link.
    """

    def tagged_union_schema(self, schema: core_schema.TaggedUnionSchema) -> JsonSchemaValue:
        found = super().tagged_union_schema(schema)
        if "oneOf" in found:
            found["anyOf"] = found.pop("oneOf")
        return found


def json_schema(model: type[StudySpec]) -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of a study file, for editors."""
    schema = model.model_json_schema(by_alias=True, schema_generator=_SchemaGenerator)
    for name, link_model in link_models().items():
        own_name = {"type": "string", "not": {"enum": [*link_laws(), NO_LINK]}}
        word = own_name if name == OWN_LAW else {"const": name}
        link = schema["$defs"][link_model.__name__]
        link["properties"]["link"] = {**word, "description": link["properties"]["link"]["description"]}
    listed = schema["$defs"]["Case_links"]["properties"]["links"]
    listed["items"] = {"anyOf": [{"type": "string"}, listed["items"]]}  # a word stands for a link without further keys
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
