"""The sections of a study that ask a question: gap, fragility, sensitivity, optimise."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema

from pounding_cli.model.separation import GB_SHARE, GB_STEP
from pounding_cli.study.base import Model, SpecIssue, mapping_schema, one_or_many, spec_field, tagged_union
from pounding_cli.study.expression import Limit, parse_limit
from pounding_cli.study.quantity import TIME, ParsedText, Quantity, WholeNumber, refuse, written_unit

ALL = "all"
"""Every claim about the figure of the study."""

SEED = Annotated[int, WholeNumber(1, 2**31 - 1)]
_COLUMN = (
    "a column of the tables, `largest`, `smallest` or `mean` over its storeys (default: `largest`), `in BUILDING`, "
    "`storey N`; arithmetic, `max`, `min`"
)


def _share(name: str, example: str) -> Quantity:
    """Return a share above 0 % and below 100 %, written with its %; it is read as a number from 0 to 1."""
    return Quantity(name, "", example, 0.0, 1.0, open_low=True, open_high=True, percent=True)


CONFIDENCE = _share("confidence", "90 %")


def _percents(name: str, example: str) -> Any:
    """Return the type of one share or a list of them."""
    return one_or_many(Annotated[float, _share(name, example)], most=20, as_list=True)


class Gb50011Spec(Model):
    """Settings of the joint of GB 50011-2010, clause 6.1.4."""

    intensity: Annotated[int, WholeNumber(min(GB_STEP), max(GB_STEP))] = spec_field(
        ..., "seismic fortification intensity, 6 to 9", 8
    )
    structure: Literal[tuple(GB_SHARE)] = spec_field("frame", "system of the building that needs the wider joint")  # type: ignore[valid-type]


RATE = Quantity("annual rate", "", "1/475", 0.0, 1e3, open_low=True)


class PowerHazard(Model):
    """A hazard curve k0 x^-k."""

    k0: Annotated[float, Quantity("annual rate at the intensity 1", "", "1e-4", 0.0, open_low=True)] = spec_field(
        ..., "annual rate at which the intensity 1 (in `unit`) is exceeded", 1e-4
    )
    k: Annotated[float, Quantity("exponent", "", "2.5", 0.0, 20.0, open_low=True)] = spec_field(
        ..., "exponent [-]", 2.5
    )
    unit: str | None = spec_field(None, "unit of the intensity; default: g, and m/s of velocities", "g")


class HazardFile(Model):
    """A hazard curve in a file."""

    file: str = spec_field(
        ...,
        "CSV file relative to the study: intensity and annual rate in two columns, or the row of a site as OpenQuake "
        "and others publish it",
        "hazard.csv",
    )
    unit: str | None = spec_field(None, "unit of the intensities, where the file does not say it", "g")


def _hazard_kind(value: Any) -> str:
    """Return the kind of a hazard curve: power, file or table."""
    keys = value.keys() if isinstance(value, dict) else ()
    if isinstance(value, PowerHazard) or "k0" in keys or "k" in keys:
        return "power"
    return "file" if isinstance(value, str | HazardFile) or "file" in keys else "table"


Hazards: Any = tagged_union(
    _hazard_kind,
    power=PowerHazard,
    file=Annotated[HazardFile, BeforeValidator(lambda v: {"file": v} if isinstance(v, str) else v)],
    table=Annotated[dict[str, Annotated[float, RATE]], Field(max_length=1000)],
)
"""Annual rates at which intensities are exceeded: a table {0.1 g: 0.02, 0.4 g: 1/475}, a power law, or a file."""

_HAZARD_KEY = (
    "annual rates at which intensities are exceeded: {0.1 g: 0.02, 0.4 g: 1/475}, {k0: 1e-4, k: 2.5}, or a file"
)


class GapSpec(Model):
    """Settings of `pound gap`."""

    percentiles: _percents("percentile", "84 %") = spec_field(("84 %",), "percentiles over the motions, one or a list")  # type: ignore[valid-type]
    contact: _percents("probability of contact", "10 %") = spec_field(  # type: ignore[valid-type]
        ("10 %",), "probabilities of contact, one or a list: the gap for each"
    )
    gb50011: Gb50011Spec | None = spec_field(None, "intensity and system for the joint of GB 50011-2010")
    hazard: Hazards | None = spec_field(None, f"{_HAZARD_KEY}; for `rate`", {"0.1 g": 0.02, "0.4 g": "1/475"})
    rate: Annotated[float, RATE] | None = spec_field(None, "annual rate of contact: the gap for it", "1/2475")

    def issues(self) -> Iterator[SpecIssue]:
        if self.rate is not None and self.hazard is None:
            yield ("rate",), "'rate' needs a hazard curve", "write `hazard: {0.1 g: 0.02, 0.4 g: 1/475}` beside it"


MEASURES = ("pga", "pgv", "sa", "factor")
"""Intensity measures, as `records.scale` has them; `factor` is the scale factor itself."""

_PERIOD = TIME.replace(name="period", example="0.5 s", low=0.01, open_low=False, high=60.0)
_MEASURE = re.compile(r"(?P<name>[A-Za-z]+)\s*(?:\(\s*(?P<period>[^()]*?)\s*\))?\Z")


@dataclass(frozen=True)
class Measure:
    """An intensity measure of a motion.

    name : one of MEASURES
    period : of `sa` only, 0 where it is the swept one [s]
    """

    name: str
    period: float = 0.0

    def __str__(self) -> str:
        return f"sa({self.period:g} s)" if self.period else self.name


def parse_measure(value: Any) -> Measure:
    """Return the measure in `pga`, `pgv`, `factor`, `sa` or `sa(0.5 s)`.  Raises PydanticCustomError."""
    match = _MEASURE.match(value.strip()) if isinstance(value, str) and len(value) < 60 else None
    name, period = match.groups() if match is not None else ("", None)
    if name not in MEASURES or (period is not None and (name != "sa" or not written_unit(period))):
        hint = "write pga, pgv, factor or the pseudo-acceleration at a period, sa(0.5 s)"
        raise refuse(f"'{str(value)[:60]}' is not an intensity measure", hint)
    return Measure(name, 0.0 if period is None else _PERIOD.read(period))


_LIMIT = Annotated[Limit, ParsedText(parse_limit, "limit in words", ("mu > 4", "drift > 2 %", "contact"))]


class FragilitySpec(Model):
    """Settings of `pound fragility`."""

    limits: one_or_many(_LIMIT, 0, 20, True) = spec_field(  # type: ignore[valid-type]
        (),
        "limits in words, one or a list: `mu > 4`, `drift > 2 %` (of the storey height) or `drift > 6 cm`, "
        "`acceleration > 1 g`, `shear_demand > 1` (of columns that slabs strike), `contact`, `collapse`; of each "
        "building, or with `in BUILDING`, `in BUILDING storey N` of one",
    )
    method: Literal["ida", "stripes", "cloud"] = spec_field(
        "ida",
        "`ida`: each motion is scaled through the swept intensities until it passes, few of them solved; "
        "`stripes`: every motion at every swept intensity; `cloud`: motions as they are, and a line through them",
    )
    intensity: Annotated[Measure, ParsedText(parse_measure, "intensity measure", (*MEASURES, "sa(0.5 s)"))] | None = (
        spec_field(None, "intensity measure of the curves; default: the swept one; for a cloud, pga")
    )
    fill: Annotated[int, WholeNumber(0, 1000)] = spec_field(
        4,
        "intensities solved below the one at which a motion passes (`ida`), in case it passes there too",
    )
    hazard: Hazards | None = spec_field(
        None, f"{_HAZARD_KEY}: adds the annual rate of every limit", {"k0": 1e-4, "k": 2.5}
    )
    confidence: Annotated[float, CONFIDENCE] = spec_field("90 %", "confidence of all intervals")
    draws: Annotated[int, WholeNumber(100, 100_000)] = spec_field(1000, "draws of the bootstrap over the motions")


def _read_text(value: Any) -> str:
    """Return a value that is a text.  Raises PydanticCustomError."""
    if not isinstance(value, str):
        raise refuse("this is not an expression", "write e.g. `largest mu`")
    return value


EXPRESSION = Annotated[
    str, ParsedText(_read_text, "expression over the tables", ("mu", "largest V_ratio in stiff", "max(mu, mu0)"))
]


STATEMENT = Annotated[
    str, ParsedText(_read_text, "expression compared with a value", ("mu > 4", "drift in soft > 2 cm", "impacts > 0"))
]


class SensitivitySpec(Model):
    """Settings of `pound sensitivity`."""

    outputs: one_or_many(EXPRESSION, 0, 50, True) = spec_field(  # type: ignore[valid-type]
        (), f"outputs, one or a list: {_COLUMN}"
    )
    probabilities: one_or_many(STATEMENT, 0, 50, True) = spec_field(  # type: ignore[valid-type]
        (),
        "statements whose probability is computed, one or a list: an output above (`>`) or below (`<`) a value, e.g. "
        "`largest mu in soft > 4`, `drift > 2 cm`, `impacts > 0`",
    )
    claims: Literal["all"] | None = spec_field(
        None,
        "`all`: also the probability of every statement of the paper about the figure that `claims:` of the "
        "study names",
    )
    method: Literal["sobol", "morris"] = spec_field(
        "sobol",
        "`sobol`: shares of the variance, and the distribution of each output; `morris`: a cheap screening "
        "by elementary effects",
    )
    samples: Annotated[int, WholeNumber(4, 2**17)] | None = spec_field(
        None,
        "base samples; `sobol` takes (keys + 2) points for each, a power of 2, default: 256; `morris` "
        "(keys + 1), default: 32",
    )
    confidence: Annotated[float, CONFIDENCE] = spec_field("95 %", "confidence of all intervals")
    draws: Annotated[int, WholeNumber(100, 100_000)] = spec_field(1000, "draws of the bootstrap")
    over_motions: Literal["mean", "largest"] = spec_field(
        "mean", "value over the motions, storey by storey, unless each sample has one motion"
    )
    seed: SEED = spec_field(1, "seed of samples and draws")

    def issues(self) -> Iterator[SpecIssue]:
        if self.method == "sobol" and self.samples is not None and self.samples & (self.samples - 1):
            low = 1 << (self.samples.bit_length() - 1)
            message = f"{self.samples} samples: Sobol's sequence is even only at powers of 2"
            yield ("samples",), message, f"write {low} or {2 * low}"


_END = {"type": ["number", "string"]}
_SEARCHED = mapping_schema("from", "to", **{"from": _END, "to": _END}, spacing={"enum": ["linear", "log"]})
_CHOSEN = mapping_schema("choice", choice={"type": "array", "minItems": 2})
_OVER_FORM = {
    "type": "object",
    "additionalProperties": {"anyOf": [_SEARCHED, _CHOSEN]},
    "title": "Over",
    "examples": [{"cases.near.gap": {"from": "1 cm", "to": "10 cm"}, "cases.near.floors": {"choice": [[5], [3, 5]]}}],
}


class OptimiseSpec(Model):
    """Settings of `pound optimise`."""

    least: EXPRESSION | None = spec_field(None, f"number to minimise: {_COLUMN}")
    most: EXPRESSION | None = spec_field(None, "number to maximise, instead of `least`")
    over: Annotated[Any, WithJsonSchema(_OVER_FORM)] = spec_field(
        None,
        "dotted keys with the range of each, `{from: 1 cm, to: 5 cm}` (`spacing: log` for stiffnesses), or "
        "with the values to choose from, `{choice: [[5], [3, 5]]}`",
    )
    case: str | None = spec_field(None, "case to optimise; required if the study has several")
    analysis: Literal["elastic", "inelastic"] | None = spec_field(
        None, "analysis to optimise; required if the study has both"
    )
    over_motions: Literal["mean", "largest"] = spec_field("mean", "value over the motions, storey by storey")
    over_sweep: Literal["worst", "mean"] = spec_field(
        "worst", "value over the points of a `sweep:`; `worst`: the largest for `least`, the smallest for `most`"
    )
    generations: Annotated[int, WholeNumber(1, 10_000)] = spec_field(
        100, "largest number of generations; the search ends when all points of one are nearly as good"
    )
    population: Annotated[int, WholeNumber(5, 10_000)] | None = spec_field(
        None, "points of a generation; default: 12 for each key, at least 20"
    )
    slice_points: Annotated[int, WholeNumber(5, 1001)] = spec_field(21, "points along each key through the optimum")
    seed: SEED = spec_field(1, "seed of the search")

    def issues(self) -> Iterator[SpecIssue]:
        if self.least is not None and self.most is not None:
            yield ("most",), "'least' and 'most' both stand here: give one of them", "remove one of the two", True
        points = self.generations * (self.population or 0)
        if points > 200_000:
            message = f"generations and population make {points} points"
            yield ("generations",), message, "keep it to 200000: write fewer"
