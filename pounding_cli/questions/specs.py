"""Keys that sections of several questions share: hazard curves, intensity measures, expressions, shares."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from pounding_cli.errors import Issue
from pounding_cli.records.hazard import HazardColumns
from pounding_cli.study.schema.base import Model, one_or_many, spec_field, tagged_union
from pounding_cli.study.schema.quantity import TIME, ParsedText, Quantity, WholeNumber, quote, refuse, written_unit

SEED = Annotated[int, WholeNumber(1, 2**31 - 1)]
EXPRESSION_COLUMNS = (
    "a column of the tables, `largest`, `smallest` or `mean` over its storeys (default: `largest`), `in BUILDING`, "
    "`storey N`; arithmetic, `max`, `min`"
)


def build_share_quantity(name: str, example: str) -> Quantity:
    """Return a share above 0 % and below 100 %, written with its %; it is read as a number from 0 to 1."""
    return Quantity(name, "", example, 0.0, 1.0, open_low=True, open_high=True, percent=True)


CONFIDENCE_QUANTITY = build_share_quantity("confidence", "90 %")


def percents(name: str, example: str) -> Any:
    """Return the type of one share or a list of them."""
    return one_or_many(Annotated[float, build_share_quantity(name, example)], most=20, as_list=True)


ANNUAL_RATE = Quantity("annual rate", "", "1/475", 0.0, 1e3, open_low=True)


class PowerHazard(Model):
    """A hazard curve k0 x^-k."""

    k0: Annotated[float, Quantity("annual rate at the intensity 1", "", "1e-4", 0.0, open_low=True)] = spec_field(
        ..., "annual rate at which the intensity 1 (in `unit`) is exceeded", 1e-4
    )
    k: Annotated[float, Quantity("exponent", "", "2.5", 0.0, 20.0, open_low=True)] = spec_field(
        ..., "exponent [-]", 2.5
    )
    unit: str | None = spec_field(None, "unit of the intensity; default: g, and m/s of velocities", "g")


_Column = Annotated[int, WholeNumber(1, 1000)]


class HazardFile(Model):
    """A hazard curve in a file: an export of OpenQuake, or columns that are declared."""

    file: str = spec_field(
        ..., "a file relative to the study: an export of OpenQuake, or rows of intensity and rate", "hazard.csv"
    )
    intensity: _Column | None = spec_field(None, "column of the intensities, from 1", 1)
    unit: str | None = spec_field(None, "unit of the intensities", "g")
    rate: _Column | None = spec_field(None, "column of the annual rates at which they are exceeded", 2)
    probability: _Column | None = spec_field(None, "column of the probabilities in `years`, in place of `rate`", 2)
    years: Annotated[float, Quantity("years", "", "50", 0.0, 1e5, open_low=True)] | None = spec_field(
        None, "in which the probabilities are those of being exceeded", 50
    )
    skip: Annotated[int, WholeNumber(0, 1_000_000)] | None = spec_field(
        None, "lines above the numbers; default: those that hold words"
    )
    rows: Annotated[int, WholeNumber(0, 1_000_000)] | None = spec_field(
        None, "rows of numbers that are read; default: all"
    )
    separator: Literal[",", ";", "tab", "blank"] | None = spec_field(
        None, "what parts the cells; default: as the first row of numbers shows"
    )
    decimal: Literal[".", ","] | None = spec_field(None, "decimal sign; default: a point")
    thousands: Literal[",", ".", "'", " "] | None = spec_field(None, "sign between thousands; default: none")

    def issues(self) -> Iterator[Issue]:
        given = [key for key in ("rate", "probability") if getattr(self, key) is not None]
        if len(given) == 2:
            yield Issue(
                ("probability",),
                "a hazard curve has rates or probabilities",
                "remove `rate` or `probability`",
                at_key=True,
            )
        elif self.intensity is not None and not given:
            hint = "write e.g. `rate: 2`, or `probability: 2, years: 50`"
            yield Issue(("intensity",), "nothing says which column holds the annual rates", hint, at_key=True)
        elif given and self.intensity is None:
            yield Issue(
                (given[0],), "nothing says which column holds the intensities", "write e.g. `intensity: 1`", at_key=True
            )
        elif given and getattr(self, given[0]) == self.intensity:
            yield Issue((given[0],), f"column {self.intensity} holds the intensities", "write another column")
        if self.probability is not None and self.years is None:
            yield Issue(
                ("probability",), "probabilities are those of some years", "write e.g. `years: 50`", at_key=True
            )
        if self.years is not None and self.probability is None:
            yield Issue(
                ("years",), "`years` belongs to `probability`", "write `probability:` in place of `rate:`", at_key=True
            )

    def declare(self) -> HazardColumns:
        """Return what is declared of the file."""
        return HazardColumns(**self.model_dump(exclude={"file"}))


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
    table=Annotated[dict[str, Annotated[float, ANNUAL_RATE]], Field(max_length=1000)],
)
"""Annual rates at which intensities are exceeded: a table {0.1 g: 0.02, 0.4 g: 1/475}, a power law, or a file."""

HAZARD_DESCRIPTION = (
    "annual rates at which intensities are exceeded: {0.1 g: 0.02, 0.4 g: 1/475}, {k0: 1e-4, k: 2.5}, or a file"
)


INTENSITY_MEASURES = ("pga", "pgv", "sa", "ag", "factor")
"""Intensity measures, as `records.scale` has them; `ag` is that of the target spectrum, `factor` the scale factor."""

_PERIOD = TIME.replace(name="period", example="0.5 s", low=0.01, open_low=False, high=60.0)
_MEASURE = re.compile(r"(?P<name>[A-Za-z]+)\s*(?:\(\s*(?P<period>[^()]*?)\s*\))?\Z")


@dataclass(frozen=True)
class Measure:
    """An intensity measure of a motion.

    name : one of INTENSITY_MEASURES
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
    if name not in INTENSITY_MEASURES or (period is not None and (name != "sa" or not written_unit(period))):
        hint = "write pga, pgv, factor, ag of a target spectrum, or the pseudo-acceleration at a period, sa(0.5 s)"
        raise refuse(f"{quote(value)} is not an intensity measure", hint)
    return Measure(name, 0.0 if period is None else _PERIOD.read(period))


def _text(form: str, kind: str, *examples: str) -> ParsedText:
    """Return the parser of a text that its question reads.

    form : what stands there, in words
    kind : what it is not where it is no text
    """

    def read(value: Any) -> str:
        if not isinstance(value, str):
            raise refuse(f"{quote(value)} is not {kind}", f"write e.g. `{examples[0]}`")
        return value

    return ParsedText(read, form, examples)


EXPRESSION = Annotated[
    str, _text("expression over the tables", "an expression", "mu", "largest V_ratio in stiff", "max(mu, mu0)")
]

STATEMENT = Annotated[
    str, _text("expression compared with a value", "a statement", "mu > 4", "drift in soft > 2 cm", "impacts > 0")
]

LIMIT = Annotated[str, _text("limit in words", "a limit", "mu > 4", "drift > 2 %", "contact")]
