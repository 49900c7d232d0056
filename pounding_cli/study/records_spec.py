"""The section `records` as a study writes it: pydantic models of motions, their windows and scales."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, WrapValidator

from pounding_cli.records.units import ACCELERATION_UNITS, find_acceleration_unit
from pounding_cli.study.base import Model, Name, SpecIssue, spec_field, tagged_union, word_or
from pounding_cli.study.link_specs import RATIO
from pounding_cli.study.quantity import ACCELERATION, PLAUSIBLE_RANGES, TIME, Quantity, WholeNumber, refuse


def _check_unit(text: str) -> str:
    if find_acceleration_unit(text) is None:
        hint = f"write one of {', '.join(ACCELERATION_UNITS)}, or a multiple: 0.01 g"
        raise refuse(f"'{text}' is not a unit of acceleration", hint)
    return text


PERIOD = TIME.replace(name="period", example="0.5 s", low=0.01, open_low=False, high=60)
Period = Annotated[float, PERIOD]
Acceleration = Annotated[float, ACCELERATION]
PEAK_VELOCITY = PLAUSIBLE_RANGES["peak velocity asked for"]
Velocity = Annotated[float, Quantity("velocity", "m/s", "40 cm/s", 0.0, open_low=True, usual=PEAK_VELOCITY)]
Number = Annotated[int, WholeNumber(1, 1000)]
TimeStep = Annotated[float, TIME.replace(name="time step", example="0.01 s")]
Window = Annotated[float | str, TIME.replace(name="window", example="10 s", words=("duration", "table1", "whole"))]
Duration = Annotated[float | str, TIME.replace(name="duration", example="10 s", words=("auto", "table1", "whole"))]
Ratio = Annotated[float, RATIO]
Part = Annotated[float, Quantity("part of the target", "", "90 %", 0.0, 10.0, open_low=True)]


_Format = Literal["at2", "cosmos", "csmip", "smc", "knet", "esm", "geonet", "asa", "two-column", "column", "table"]


class RecordFileSpec(Model):
    """A motion in a file of one's own, or several in a folder."""

    file: str = spec_field(
        ..., "a file, a folder, or a pattern motions/*.AT2, relative to the study file", "motions/x.AT2"
    )
    name: Name | None = spec_field(None, "name of the motion in tables; default: the file's stem")
    unit: Annotated[str, AfterValidator(_check_unit)] | None = spec_field(
        None, "unit of the acceleration, any spelling; needed where the file does not state it"
    )
    dt: TimeStep | None = spec_field(None, "time step [s]; needed where the file does not state it")
    format: _Format | None = spec_field(None, "default: detected")
    channel: Number | None = spec_field(None, "channel of a file with several channels, from 1")
    column: Number | None = spec_field(None, "column of a table with the acceleration, from 1")


class AriasSpec(Model):
    """Every record is scaled to the Arias intensity of one of them."""

    arias: str = spec_field(..., "record with the reference Arias intensity", "elcentro")
    window: Window = spec_field("duration", "part of each record that is measured [s]; `duration`: the analysed part")


class PgaSpec(Model):
    """Every record is scaled to one peak ground acceleration."""

    pga: Acceleration = spec_field(..., "peak ground acceleration [m/s2]", "0.35 g")


class PgvSpec(Model):
    """Every record is scaled to one peak ground velocity."""

    pgv: Velocity = spec_field(..., "peak ground velocity [m/s], without baseline correction", "40 cm/s")


class SaSpec(Model):
    """Every record is scaled to one ordinate of its response spectrum."""

    sa: Acceleration = spec_field(..., "pseudo-acceleration [m/s2]", "0.8 g")
    period: Period = spec_field(..., "at this period [s]", "0.5 s")
    damping: Ratio = spec_field(0.05, "and this damping ratio [-]")


def _read_once_each(points: Any, read: Any) -> Any:
    found = read(points)
    if len(found) < len(points):
        raise refuse("two of the periods are one", "remove one of the two")
    return found


class SpectrumSpec(Model):
    """The suite is scaled to a target spectrum over a range of periods."""

    spectrum: Literal["mean", "each"] = spec_field(
        ..., "`mean`: one factor for all, their mean spectrum meets the target; `each`: one for every record", "mean"
    )
    target: word_or(str, Annotated[dict[Period, Acceleration], WrapValidator(_read_once_each)]) = spec_field(  # type: ignore[valid-type]
        ...,
        "{period: pseudo-acceleration, ...}, or the record whose spectrum is taken",
        {"0.1 s": "0.8 g", "2 s": "0.2 g"},
    )
    low: Period = spec_field(..., "shortest period of the range [s]", "0.2 s", alias="from")
    high: Period = spec_field(..., "longest period of the range [s]", "1.2 s", alias="to")
    damping: Ratio = spec_field(0.05, "damping ratio of the spectra [-]")
    at_least: Part | None = spec_field(
        None, "another factor for all, so that the mean spectrum is nowhere below this part of the target"
    )

    def issues(self) -> Iterator[SpecIssue]:
        ends = f"from {self.low:g} s to {self.high:g} s"
        if not self.low < self.high:
            hint = "write `to:` above `from:`, e.g. `from: 0.2 s, to: 1.2 s`"
            yield ("to",), f"the range of periods runs {ends}", hint
        elif isinstance(self.target, dict):
            first, last = min(self.target, default=0.0), max(self.target, default=0.0)
            if not first < last or not first <= self.low or not self.high <= last:
                what = f"the target is given from {first:g} to {last:g} s, not over the whole range"
                yield ("target",), what, f"give two points at least, {ends} and beyond"


_SCALES: dict[str, Any] = {
    "arias": AriasSpec,
    "pga": PgaSpec,
    "pgv": PgvSpec,
    "sa": SaSpec,
    "spectrum": SpectrumSpec,
}


def _find_scale_kind(value: Any) -> str:
    if isinstance(value, dict):
        return next((name for name in _SCALES if name in value), "arias")
    return next((name for name, model in _SCALES.items() if isinstance(value, model)), "factor")


FACTOR = Quantity("scale factor", "", "1.5", 0.0, 1e6, open_low=True, words=("table1",))
Scale: Any = tagged_union(_find_scale_kind, factor=Annotated[float | str, FACTOR], **_SCALES)


class RecordsSpec(Model):
    """The ground motions, the part of each that is used, and its scale."""

    use: Annotated[tuple[word_or(str, RecordFileSpec), ...], Field(min_length=1, max_length=5000)] = spec_field(  # type: ignore[valid-type]
        ...,
        "catalogue names, sets of recorded motions (far-field), files, folders, patterns, {file: PATH, ...}",
        ["elcentro", {"file": "motions/x.AT2"}],
    )
    duration: Duration = spec_field(
        "auto",
        "how much of each record is used [s]; `table1`: the paper's durations; `auto`: those, and `whole` for motions "
        "that Table 1 does not hold",
    )
    scale: Scale = spec_field(
        1.0, "a factor, `table1`, {arias: RECORD}, {pga: 0.35 g}, {pgv: ...}, {sa: ...} or {spectrum: ...}"
    )


INTENSITY_KEYS = {
    "records.scale": "factor", "records.scale.pga": "pga", "records.scale.pgv": "pgv", "records.scale.sa": "sa",
}  # fmt: skip
"""Keys whose sweep varies the intensity, and the measure that each is."""
