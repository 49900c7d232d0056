"""The section `records` as a study writes it: pydantic models of motions, their windows and scales."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, WrapValidator, model_validator

from pounding_cli.errors import Issue
from pounding_cli.records.code_spectra import (
    ASCE7,
    CODES,
    EN1998,
    EN1998_GROUND,
    GB50011,
    NTC2018,
    NTC_PERIOD,
    NTC_TOPOGRAPHY,
    CodeSpectrum,
)
from pounding_cli.records.declaration import BASELINES, Declaration
from pounding_cli.records.reading import MAX_PEAK, MOTION_FORMATS, PLAIN
from pounding_cli.records.sines import MAX_CYCLES, Sine
from pounding_cli.records.units import ACCELERATION_UNITS, find_acceleration_unit
from pounding_cli.study.schema.base import LabelText, Model, errors, spec_field, tagged_union
from pounding_cli.study.schema.links import Ratio
from pounding_cli.study.schema.quantity import (
    ACCELERATION,
    PLAUSIBLE_RANGES,
    TIME,
    Quantity,
    WholeNumber,
    quote,
    refuse,
)
from pounding_cli.study.text.file import nearest


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
Frequency = Annotated[float, Quantity("frequency", "Hz", "1.25 Hz", 0.01, 100.0)]
Amplitude = Annotated[float, ACCELERATION.replace(name="amplitude", example="0.3 m/s2", high=MAX_PEAK)]
Cycles = Annotated[float, Quantity("number of cycles", "", "40", 0.5, 10000.0)]
Ramp = Annotated[float, Quantity("number of cycles", "", "20", 0.0, 10000.0)]
TimeStep = Annotated[float, TIME.replace(name="time step", example="0.01 s")]
Window = Annotated[float | str, TIME.replace(name="window", example="10 s", words=("duration", "table1", "whole"))]
Duration = Annotated[float | str, TIME.replace(name="duration", example="10 s", words=("auto", "table1", "whole"))]
TargetPart = Annotated[float, Quantity("part of the target", "", "90 %", 0.0, 2.0, open_low=True)]


def _check_format(text: str) -> str:
    if text not in (*MOTION_FORMATS, PLAIN) and not Declaration(format=text).is_fortran():
        hint = f"write one of {', '.join(MOTION_FORMATS)}, {PLAIN}, or the Fortran format of the rows, e.g. 8F9.6"
        raise refuse(f"'{text}' is not a format", hint)
    return text


Lines = Annotated[int, WholeNumber(0, 10_000_000)]


class RecordFileSpec(Model):
    """A motion in a file of one's own, or several in a folder."""

    file: str = spec_field(
        ..., "a file, a folder, or a pattern motions/*.AT2, relative to the study file", "motions/x.AT2"
    )
    name: LabelText | None = spec_field(None, "name of the motion in tables; default: the file's stem")
    unit: Annotated[str, AfterValidator(_check_unit)] | None = spec_field(
        None, "unit of the acceleration, g, cm/s2 or 0.01 m/s2; a plain file needs it", "cm/s2"
    )
    time: Number | None = spec_field(None, "column of the times [s], from 1; a plain file needs it or `dt`")
    dt: TimeStep | None = spec_field(None, "time step [s] of a plain file without times", "0.01 s")
    column: Number | None = spec_field(None, "column of the acceleration, from 1; default: every value, row by row")
    skip: Lines | None = spec_field(None, "lines above the numbers; default: those that hold words")
    rows: Lines | None = spec_field(None, "rows of numbers that are read; default: all")
    separator: Literal[",", ";", "tab", "blank"] | None = spec_field(
        None, "what parts the cells; default: as the first row of numbers shows"
    )
    decimal: Literal[".", ","] | None = spec_field(None, "decimal sign; default: a point")
    thousands: Literal[",", ".", "'", " "] | None = spec_field(None, "sign between thousands; default: none")
    format: Annotated[str, AfterValidator(_check_format)] | None = spec_field(
        None, f"{', '.join(MOTION_FORMATS)}; default: detected; the Fortran format of the rows, 8F9.6; or plain"
    )
    channel: Number | None = spec_field(None, "channel of an instrument's file with several, from 1")
    baseline: Literal[BASELINES] | None = spec_field(  # type: ignore[valid-type]
        None, "`mean`: their mean is taken away from the samples; `kept`: the ground is meant to drift or to be pushed"
    )

    def declare(self) -> Declaration:
        """Return what is declared of the file."""
        return Declaration(**self.model_dump(exclude={"file", "name"}))


class FrequencyRangeSpec(Model):
    """Frequencies of sinusoidal motions, equally apart."""

    first: Frequency = spec_field(..., "the lowest [Hz]", "0.5 Hz", alias="from")
    last: Frequency = spec_field(..., "the highest [Hz]", "2.5 Hz", alias="to")
    count: Number | None = spec_field(None, "how many; or write `step`", 21)
    step: Frequency | None = spec_field(None, "how far apart [Hz]; or write `count`", "0.1 Hz")

    def issues(self) -> Iterator[Issue]:
        ends = f"from {self.first:g} to {self.last:g} Hz"
        if not self.first < self.last:
            yield Issue(("to",), f"the frequencies run {ends}", "write `to:` above `from:`")
        elif (self.count is None) == (self.step is None):
            hint = "write e.g. `{from: 0.5 Hz, to: 2.5 Hz, count: 21}`, or `step: 0.1 Hz` instead of `count:`"
            yield Issue((), "a range of frequencies has either `count` or `step`", hint)
        elif self.count == 1:
            yield Issue(("count",), "a range has two frequencies at least", "write `sine: 1 Hz` for a single one")
        elif self.step is not None and not self._has_whole_steps():
            message = f"steps of {self.step:g} Hz do not lead {ends}: that is {self._count_steps():.4g} steps"
            yield Issue(("step",), message, "change an end or the step, at most 1000 frequencies, or write `count:`")

    def _count_steps(self) -> float:
        """Return how many steps lead from the first frequency to the last; 0 where `count` is given instead."""
        return (self.last - self.first) / self.step if self.step is not None else 0.0

    def _has_whole_steps(self) -> bool:
        """Return whether a whole number of steps leads from the first frequency to the last."""
        steps = self._count_steps()
        return 0.5 < steps < 1000 and math.isclose(steps, round(steps), rel_tol=1e-9)

    def list_frequencies(self) -> tuple[float, ...]:
        """Return the frequencies [Hz]."""
        count = self.count or round(self._count_steps()) + 1
        return tuple(float(number) for number in np.linspace(self.first, self.last, count))


def _find_frequencies_kind(value: Any) -> str:
    """Return how frequencies are written: as a list, as a range, or as one."""
    if isinstance(value, list | tuple):
        return "list"
    return "range" if isinstance(value, dict | FrequencyRangeSpec) else "one"


_Frequencies: Any = tagged_union(
    _find_frequencies_kind,
    list=Annotated[tuple[Frequency, ...], Field(min_length=1, max_length=1000)],
    range=FrequencyRangeSpec,
    one=Frequency,
)


class SineSpec(Model):
    """A sinusoidal motion, or one of each of several frequencies."""

    sine: _Frequencies = spec_field(
        ..., "frequency [Hz], several in a list, or {from: 0.5 Hz, to: 2.5 Hz, count: 21}", "1.25 Hz"
    )
    amplitude: Amplitude = spec_field(..., "peak ground acceleration [m/s2]", "0.3 m/s2")
    cycles: Cycles = spec_field(..., "number of cycles [-]", 40)
    ramp: Ramp = spec_field(0.0, "number of the first cycles, in which it grows evenly to its amplitude [-]", 20)

    def issues(self) -> Iterator[Issue]:
        if self.ramp > self.cycles:
            message = f"the motion grows over {self.ramp:g} cycles and has {self.cycles:g}"
            yield Issue(("ramp",), message, "write a smaller `ramp:`, or more `cycles:`")
        count = len(self.list_frequencies())
        if count * self.cycles > MAX_CYCLES:
            message = f"{count} frequencies of {self.cycles:g} cycles are more than {MAX_CYCLES} cycles"
            yield Issue(("cycles",), message, f"write at most {MAX_CYCLES // count} cycles, or fewer frequencies")

    def list_frequencies(self) -> tuple[float, ...]:
        """Return the frequencies [Hz]."""
        if isinstance(self.sine, FrequencyRangeSpec):
            return self.sine.list_frequencies()
        return self.sine if isinstance(self.sine, tuple) else (self.sine,)

    def list_sines(self) -> tuple[Sine, ...]:
        """Return the motions."""
        return tuple(Sine(each, self.amplitude, self.cycles, self.ramp) for each in self.list_frequencies())


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


_ORDINATE = PLAUSIBLE_RANGES["acceleration of a code's spectrum"]
CodeAcceleration = Annotated[float, ACCELERATION.replace(name="acceleration of a code's spectrum", usual=_ORDINATE)]
SpectrumImportance = Annotated[float, Quantity("importance factor", "", "1.2", 0.5, 2.0)]
SpectrumAmplification = Annotated[float, Quantity("amplification F0", "", "2.5", 2.2, 5.0)]
"""NTC 2018, 3.2: F0 is at least 2.2."""
CornerPeriod = Annotated[float, TIME.replace(name="corner period", example="0.35 s", low=0.05, open_low=False, high=1)]
LongPeriod = Annotated[float, TIME.replace(name="transition period", example="8 s", low=1, open_low=False, high=20)]
InfluenceCoefficient = Annotated[float, Quantity("seismic influence coefficient", "", "0.16", 0.04, 1.4)]
"""GB 50011-2010, table 5.1.4-1, has 0.04 to 1.40."""
CharacteristicPeriod = Annotated[
    float, TIME.replace(name="characteristic period", example="0.40 s", low=0.2, open_low=False, high=0.95)
]
"""GB 50011-2010, table 5.1.4-2, has 0.20 s to 0.90 s, and 0.05 s more for rare earthquakes."""


class CodeTargetSpec(Model):
    """A target spectrum by the equations of a code."""

    name: ClassVar[str]
    damping: Ratio | None = spec_field(None, "damping ratio [-]; default: `damping` of the scale")

    def issues(self) -> Iterator[Issue]:
        only = CODES[self.name].damping
        if only is not None and self.damping not in (None, only):
            yield Issue(("damping",), *_refuse_damping(self.name))

    def build(self, damping: float) -> CodeSpectrum:
        """Return the spectrum of a damping ratio [-]."""
        return CODES[self.name].build(**self.model_dump(exclude={"code", "damping"}), damping=damping)


def _refuse_damping(code: str) -> tuple[str, str]:
    """Return message and hint for a damping ratio that the spectrum of a code does not have."""
    only = CODES[code].damping or 0.0
    message = f"the spectrum of {code}, {CODES[code].clause}, is one of {100 * only:g} % damping"
    return message, f"leave `damping` out, or write `damping: {100 * only:g} %`"


class En1998Spec(CodeTargetSpec):
    """The elastic response spectrum of EN 1998-1, 3.2.2.2."""

    name = EN1998
    code: Literal["EN 1998-1"] = spec_field(..., "EN 1998-1:2004, 3.2.2.2", EN1998)
    type: Annotated[int, WholeNumber(1, 2)] = spec_field(
        ..., "1; 2 where magnitudes up to 5.5 contribute most (3.2.2.2(2))", 1
    )
    soil: Literal[tuple(dict.fromkeys(soil for _, soil in EN1998_GROUND))] = spec_field(..., "ground type", "C")  # type: ignore[valid-type]
    ag: CodeAcceleration = spec_field(..., "reference peak ground acceleration on ground type A [m/s2]", "0.25 g")
    importance: SpectrumImportance = spec_field(1.0, "importance factor gamma_I, by which `ag` is multiplied [-]")


class Asce7Spec(CodeTargetSpec):
    """The design response spectrum of ASCE 7-16, 11.4.6, or the MCE_R spectrum of 11.4.7."""

    name = ASCE7
    code: Literal["ASCE 7-16"] = spec_field(..., "ASCE/SEI 7-16, 11.4.6", ASCE7)
    sds: CodeAcceleration = spec_field(..., "design spectral acceleration at short periods SDS [m/s2]", "1.0 g")
    sd1: CodeAcceleration = spec_field(..., "design spectral acceleration at 1 s SD1 [m/s2]", "0.6 g")
    tl: LongPeriod = spec_field(..., "long-period transition period TL [s]", "8 s")
    level: Literal["design", "mcer"] = spec_field("design", "`mcer`: 1.5 times the design spectrum (11.4.7)")

    def issues(self) -> Iterator[Issue]:
        yield from super().issues()
        if self.sd1 > self.sds * self.tl:
            corner = f"SD1 / SDS, where the plateau ends, is {self.sd1 / self.sds:.4g} s and above TL, {self.tl:g} s"
            yield Issue(("sd1",), corner, "check `sds` and `sd1`: the first is that of short periods")


class Ntc2018Spec(CodeTargetSpec):
    """The elastic response spectrum of NTC 2018, 3.2.3.2.1."""

    name = NTC2018
    code: Literal["NTC 2018"] = spec_field(..., "NTC 2018, 3.2.3.2.1", NTC2018)
    ag: CodeAcceleration = spec_field(..., "peak ground acceleration on rigid ground at the site [m/s2]", "0.25 g")
    f0: SpectrumAmplification = spec_field(..., "largest amplification of the spectrum F0 [-]", 2.5)
    tc_star: CornerPeriod = spec_field(..., "period TC* at which the branch of constant velocity begins [s]", "0.35 s")
    soil: Literal[tuple(NTC_PERIOD)] = spec_field(..., "soil category", "C")  # type: ignore[valid-type]
    topography: Literal[tuple(NTC_TOPOGRAPHY)] = spec_field("T1", "topographic category")  # type: ignore[valid-type]


class Gb50011TargetSpec(CodeTargetSpec):
    """The spectrum of GB 50011-2010, 5.1.5."""

    name = GB50011
    code: Literal["GB 50011-2010"] = spec_field(..., "GB 50011-2010, 5.1.5", GB50011)
    alpha_max: InfluenceCoefficient = spec_field(..., "largest seismic influence coefficient at 5 % damping [-]", 0.16)
    tg: CharacteristicPeriod = spec_field(..., "characteristic period of the site Tg [s]", "0.40 s")


CODE_TARGETS: dict[str, type[CodeTargetSpec]] = {
    each.name: each for each in (En1998Spec, Asce7Spec, Ntc2018Spec, Gb50011TargetSpec)
}
"""The mapping of a target by the name of its code."""

_CODE_KEYS = frozenset(key for each in CODE_TARGETS.values() for key in each.model_fields)


def _find_target_kind(value: Any) -> str:
    """Return the kind of a target: a word, points, or the name of a code."""
    if isinstance(value, CodeTargetSpec):
        return value.name
    if isinstance(value, dict) and str(value.get("code")) in CODE_TARGETS:
        return str(value["code"])
    return "word" if isinstance(value, str | int | float | None) else "points"


def _check_code(value: Any) -> Any:
    """Return a target as it is written.  Raises ValidationError: it names no code that is known, or nothing else."""
    if isinstance(value, str) and value in CODE_TARGETS:
        required = (key for key, field in CODE_TARGETS[value].model_fields.items() if field.is_required())
        keys = ", ".join(f"{key}: {value if key == 'code' else '...'}" for key in required)
        raise refuse(f"'{value}' is a code, not a record", f"write its parameters: `target: {{{keys}}}`")
    if not isinstance(value, dict) or _CODE_KEYS.isdisjoint(value) or str(value.get("code")) in CODE_TARGETS:
        return value
    points = "of another code write the points of its spectrum, {0.1 s: 0.8 g, 2 s: 0.2 g}"
    if "code" not in value:
        raise refuse("the target names no code", f"write `code: {EN1998}`, {', '.join([*CODE_TARGETS][1:])}; {points}")
    message = f"the program does not know the spectrum of {quote(value['code'])}"
    raise errors(value, [Issue(("code",), message, f"{nearest(value['code'], CODE_TARGETS)}; {points}")])


_POINTS = Annotated[
    dict[Period, Acceleration],
    WrapValidator(_read_once_each),
    Field(json_schema_extra={"propertyNames": {"pattern": r"^[-+.0-9]"}}),  # else that of a code would be one too
]
TargetSpectrumType: Any = Annotated[
    tagged_union(_find_target_kind, word=str, points=_POINTS, **CODE_TARGETS), BeforeValidator(_check_code)
]


class SpectrumSpec(Model):
    """The suite is scaled to a target spectrum over a range of periods."""

    spectrum: Literal["mean", "each"] = spec_field(
        ..., "`mean`: one factor for all, their mean spectrum meets the target; `each`: one for every record", "mean"
    )
    target: TargetSpectrumType = spec_field(
        ...,
        "{period: pseudo-acceleration, ...}, the spectrum of a code, {code: EN 1998-1, type: 1, soil: C, ag: 0.25 g}, "
        "or the record whose spectrum is taken",
        {"0.1 s": "0.8 g", "2 s": "0.2 g"},
    )
    low: Period = spec_field(..., "shortest period of the range [s]", "0.2 s", alias="from")
    high: Period = spec_field(..., "longest period of the range [s]", "1.2 s", alias="to")
    damping: Ratio = spec_field(0.05, "damping ratio of the spectra [-]; default: that of the target, or 5 %")
    at_least: TargetPart | None = spec_field(
        None, "another factor for all, so that the mean spectrum is nowhere below this part of the target"
    )

    def issues(self) -> Iterator[Issue]:
        ends = f"from {self.low:g} s to {self.high:g} s"
        if not self.low < self.high:
            hint = "write `to:` above `from:`, e.g. `from: 0.2 s, to: 1.2 s`"
            yield Issue(("to",), f"the range of periods runs {ends}", hint)
        elif isinstance(self.target, CodeTargetSpec):
            yield from self._find_code_issues(self.target)
        elif isinstance(self.target, dict):
            first = min(self.target, default=0.0)
            last = max(self.target, default=0.0)
            if not first < last or not first <= self.low or not self.high <= last:
                message = f"the target is given from {first:g} to {last:g} s, not over the whole range"
                yield Issue(("target",), message, f"give two points at least, {ends} and beyond")

    def _find_code_issues(self, target: CodeTargetSpec) -> Iterator[Issue]:
        """Yield what is wrong with the range and the damping ratio of the spectrum of a code."""
        rules = CODES[target.name]
        if self.high > rules.max_period:
            end = f"{rules.max_period:g} s"
            message = f"{target.name}, {rules.clause}, gives its spectrum up to {end}, not to {self.high:g} s"
            yield Issue(("to",), message, f"write `to: {end}` at most")
        if "damping" not in self.model_fields_set:
            return
        if target.damping is not None and target.damping != self.damping:
            ratios = f"{100 * target.damping:g} % in the target and {100 * self.damping:g} % beside it"
            yield Issue(("damping",), f"the damping ratio of the spectra is {ratios}", "write one of the two")
        elif rules.damping not in (None, self.damping):
            yield Issue(("damping",), *_refuse_damping(target.name))

    @model_validator(mode="after")
    def _share_damping(self) -> Any:
        """Return the scale with one damping ratio of the target and of the spectra of the motions."""
        if not isinstance(self.target, CodeTargetSpec):
            return self
        is_of_scale = "damping" in self.model_fields_set or self.target.damping is None
        damping = self.damping if is_of_scale else self.target.damping
        target = self.target.model_copy(update={"damping": damping})
        return self.model_copy(update={"damping": damping, "target": target})


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


def _find_motion_kind(value: Any) -> str:
    """Return the kind of an entry of `use`: a word, a file or a sine."""
    if isinstance(value, str | int | float | None):
        return "word"
    return "sine" if isinstance(value, SineSpec) or (isinstance(value, dict) and "sine" in value) else "file"


MotionSpec = str | RecordFileSpec | SineSpec
"""An entry of `use`."""

_MotionSpecType: Any = tagged_union(_find_motion_kind, word=str, file=RecordFileSpec, sine=SineSpec)


class RecordsSpec(Model):
    """The ground motions, the part of each that is used, and its scale."""

    use: Annotated[tuple[_MotionSpecType, ...], Field(min_length=1, max_length=5000)] = spec_field(
        ...,
        "catalogue names, sets of recorded motions (far-field), files, folders, patterns, {file: PATH, ...}, "
        "{sine: 1.25 Hz, ...}",
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
    "records.scale.target.ag": "ag",
}  # fmt: skip
"""Keys whose sweep varies the intensity, and the measure that each is."""


def scales_in_proportion(key: str, code: str | None) -> bool:
    """Return whether motions are scaled in proportion to the value of one of INTENSITY_KEYS.

    Those that are scaled to the spectrum of NTC 2018 are not: its factor of the soil and a corner depend on ag.

    code : of the target spectrum, None without one
    """
    return key != "records.scale.target.ag" or code == EN1998
