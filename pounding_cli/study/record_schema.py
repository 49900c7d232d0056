"""The `records` of a study file as pydantic models: which motions, how files are read, how all are scaled."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag
from pydantic_core import PydanticCustomError

from pounding_cli.records.units import UNITS, acceleration_unit
from pounding_cli.study import units
from pounding_cli.study.base import Model, Name, optional, word_or_mapping
from pounding_cli.study.units import Quantity, limited, refuse, whole_number


def _unit(text: str) -> str:
    if acceleration_unit(text) is None:
        raise refuse(
            f"'{text}' is not a unit of acceleration", f"write one of {', '.join(UNITS)}, or a multiple: 0.01 g"
        )
    return text


Window = Annotated[
    float | str, limited(units.TIME, name="window", example="10 s", words=("duration", "table1", "whole"))
]
Duration = Annotated[
    float | str, limited(units.TIME, name="duration", example="10 s", words=("auto", "table1", "whole"))
]
Unit = Annotated[str, AfterValidator(_unit)]
Acceleration = Annotated[float, units.ACCELERATION]
Velocity = Annotated[float, Quantity("velocity", "m/s", "40 cm/s", 0.0, open_low=True)]
_PERIOD = limited(units.TIME, name="period", example="0.5 s", low=0.01, open_low=False, high=60)
SpectrumPeriod = Annotated[float, _PERIOD]
SpectrumDamping = Annotated[float, Quantity("damping ratio", "", "5 %", 0.0, 1.0, open_high=True)]
Part = Annotated[float, Quantity("part of the target", "", "90 %", 0.0, 10.0, open_low=True)]
Number = Annotated[int, Field(ge=1, le=1000), whole_number(1, 1000)]


class RecordFile(Model):
    """A motion in a file of one's own, or several in a folder."""

    file: str = Field(
        description="a file, a folder, or a pattern such as motions/*.AT2, relative to the study file",
        examples=["motions/x.AT2"],
    )
    name: Name | None = optional(None, description="name of the motion in tables; default: the file's stem")
    unit: Unit | None = optional(
        None, description="unit of the acceleration, any spelling; only where the file states none (g in plain columns)"
    )
    dt: Annotated[float, limited(units.TIME, name="time step", example="0.01 s")] | None = optional(
        None, description="time step [s]; needed for one column of values"
    )
    format: Literal["at2", "cosmos", "csmip", "smc", "knet", "esm", "two-column", "column", "table"] | None = optional(
        None, description="default: detected"
    )
    channel: Number | None = optional(None, description="channel of a file with several channels, from 1")
    column: Number | None = optional(None, description="column of a table with the acceleration, from 1")


class AriasScale(Model):
    """Every record is scaled to the Arias intensity of one of them."""

    arias: str = Field(description="record with the reference Arias intensity", examples=["elcentro"])
    window: Window = optional(
        "duration",
        description="part of each record that is measured [s]; `duration`: the analysed part",
    )


class PgaScale(Model):
    """Every record is scaled to one peak ground acceleration."""

    pga: Acceleration = Field(description="peak ground acceleration [m/s2]", examples=["0.35 g"])


class PgvScale(Model):
    """Every record is scaled to one peak ground velocity."""

    pgv: Velocity = Field(description="peak ground velocity [m/s], without baseline correction", examples=["40 cm/s"])


class SaScale(Model):
    """Every record is scaled to one ordinate of its response spectrum."""

    sa: Acceleration = Field(description="pseudo-acceleration [m/s2]", examples=["0.8 g"])
    period: SpectrumPeriod = Field(description="at this period [s]", examples=["0.5 s"])
    damping: SpectrumDamping = optional(0.05, description="and this damping ratio [-]")


def _once_each(points: Any) -> Any:
    """The points of a target, refused where two spellings of a period are one: the later would be lost."""
    first: dict[float, str] = {}
    for word in points if isinstance(points, dict) else ():
        try:
            period = _PERIOD.read(word)
        except PydanticCustomError:
            continue  # said at its place
        if period in first:
            raise refuse(f"'{first[period]}' and '{word}' are one period", "remove one of the two")
        first[period] = word
    return points


class SpectrumScale(Model):
    """The suite is scaled to a target spectrum over a range of periods."""

    spectrum: Literal["mean", "each"] = Field(
        description="`mean`: one factor for all, their mean spectrum meets the target; `each`: one for every record",
        examples=["mean"],
    )
    target: Annotated[
        Annotated[str, Tag("word")]
        | Annotated[dict[SpectrumPeriod, Acceleration], BeforeValidator(_once_each), Tag("mapping")],
        Discriminator(word_or_mapping),
    ] = Field(
        description="{period: pseudo-acceleration, ...}, or the record whose spectrum is taken",
        examples=[{"0.1 s": "0.8 g", "0.5 s": "0.8 g", "2 s": "0.2 g"}],
    )
    low: SpectrumPeriod = Field(alias="from", description="shortest period of the range [s]", examples=["0.2 s"])
    high: SpectrumPeriod = Field(alias="to", description="longest period of the range [s]", examples=["1.2 s"])
    damping: SpectrumDamping = optional(0.05, description="damping ratio of the spectra [-]")
    at_least: Part | None = optional(
        None, description="another factor for all, so that the mean spectrum is nowhere below this part of the target"
    )


_SCALES: dict[str, type[Model]] = {
    "arias": AriasScale, "pga": PgaScale, "pgv": PgvScale, "sa": SaScale, "spectrum": SpectrumScale,
}  # fmt: skip


def _scale_kind(value: Any) -> str:
    # The tags are no keys of the file, so that a problem is not looked for below the key of that name.
    if isinstance(value, dict):
        return f"by {next((key for key in _SCALES if key in value), 'arias')}"
    return next((f"by {key}" for key, model in _SCALES.items() if isinstance(value, model)), "factor")


_FACTOR = Quantity("scale factor", "", "1.5", 0.0, 1e6, open_low=True, words=("table1",))
Scale = Annotated[
    Annotated[float | str, _FACTOR, Tag("factor")]
    | Annotated[AriasScale, Tag("by arias")]
    | Annotated[PgaScale, Tag("by pga")]
    | Annotated[PgvScale, Tag("by pgv")]
    | Annotated[SaScale, Tag("by sa")]
    | Annotated[SpectrumScale, Tag("by spectrum")],
    Discriminator(_scale_kind),
]
Record = Annotated[Annotated[str, Tag("word")] | Annotated[RecordFile, Tag("mapping")], Discriminator(word_or_mapping)]


class Records(Model):
    """The ground motions, the part of each that is used, and its scale."""

    use: tuple[Record, ...] = Field(
        description="catalogue names, files, folders, patterns, {file: PATH, ...}",
        min_length=1,
        max_length=5000,
        examples=[["elcentro", {"file": "motions/x.AT2"}]],
    )
    duration: Duration = optional(
        "auto",
        description="how much of each record is used [s]; `table1`: the paper's durations; "
        "`auto`: those, and `whole` for motions that Table 1 does not hold",
    )
    scale: Scale = optional(
        1.0, description="a factor, `table1`, {arias: RECORD}, {pga: 0.35 g}, {pgv: ...}, {sa: ...} or {spectrum: ...}"
    )
