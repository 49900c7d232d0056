"""The YAML study of `pound connector`: its keys, units and defaults, and the pairs of its sweep."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

from pydantic import Field

from pounding_cli.connector.findings import Question
from pounding_cli.connector.oscillators import Oscillators, eq7_dashpot
from pounding_cli.study.base import Model
from pounding_cli.study.file import Map, Problems
from pounding_cli.study.plausible import doubt_values
from pounding_cli.study.quantity import LONGEST, MASS, NUMBER, STIFFNESS, TIME, Quantity, Text, Whole
from pounding_cli.study.system_study import SystemModel
from pounding_cli.study.usual import FREQUENCY_RATIO, RANGES

_TIMES_K1 = re.compile(rf"\s*(?P<top>{NUMBER})(?:\s*/\s*(?P<bottom>{NUMBER}))?\s*k1\s*\Z")
_PERIOD = replace(RANGES["period"], units={"s": 1.0})
Mass = Annotated[float, MASS]
Period = Annotated[float, TIME.but(name="period", high=60.0, usual=_PERIOD)]
_STIFFNESS = STIFFNESS.but(example="0.2 k1", open_low=False)


@dataclass(frozen=True)
class TimesK1:
    """A connector's stiffness as a multiple of k1 [-]."""

    factor: float

    def __str__(self) -> str:
        return f"{self.factor:g} k1"


def _read_stiffness(value: Any) -> float | TimesK1:
    found = _TIMES_K1.match(value) if isinstance(value, str) and len(value) <= LONGEST else None
    if found is None:
        return _STIFFNESS.read(value)
    bottom = float(found["bottom"] or 1)
    return TimesK1(_STIFFNESS.read(float(found["top"]) / bottom if bottom else math.nan))


ConnectorStiffness = Annotated[
    float | TimesK1, Text(_read_stiffness, "stiffness of the connector", ("0.2 k1", "20 kN/mm"))
]
Stiffness = Annotated[float, STIFFNESS]
Damping = Annotated[float, Quantity("damping ratio", "", "5 %", 0.0, 1.0, usual=RANGES["damping ratio"])]
Ratio = Annotated[float, Quantity("frequency ratio", "", "0.6", 0.0, 100.0, open_low=True, usual=FREQUENCY_RATIO)]
Dashpot = Annotated[float, Quantity("dashpot", "N s/m", "100 kN s/m", 0.0)]


class FirstSpec(Model):
    """System 1."""

    mass: Mass = Field(default=200e3, description="mass m1", examples=["200 t"])
    period: Period | None = Field(
        default=None, description="period alone; 0.5 s unless stiffness is given", examples=["0.5 s"]
    )
    stiffness: Stiffness | None = Field(default=None, description="stiffness k1, in place of the period")
    damping: Damping | None = Field(
        default=None, description="damping ratio; the study's unless given", examples=["5 %"]
    )


class SecondSpec(FirstSpec):
    """System 2."""

    mass: Mass = Field(default=200e3, description="mass m2", examples=["200 t"])
    frequency_ratio: Ratio | None = Field(
        default=None, description="p = omega20 / omega10, in place of the period", examples=[0.6]
    )


class LinkSpec(Model):
    """What joins the two."""

    stiffness: ConnectorStiffness = Field(
        default="0.2 k1",
        validate_default=True,
        description="K, as a multiple of k1 or in N/m",
        examples=["0.2 k1"],
    )
    damping_ratio: Damping | None = Field(default=None, description="xi of its dashpot (eq. 7)", examples=[0.1])
    dashpot: Dashpot | None = Field(
        default=None, description="its dashpot, in place of damping_ratio", examples=["100 kN s/m"]
    )


class RangeSpec(Model):
    """Where the ratios are computed, in Omega / omega10."""

    low: Ratio = Field(default=0.2, description="lowest Omega / omega10", examples=[0.2])
    high: Ratio = Field(default=1.6, description="highest Omega / omega10", examples=[1.6])
    points: Annotated[int, Whole(11, 1_000_000)] = Field(
        default=1401, ge=11, le=1_000_000, description="number of frequencies", examples=[1401]
    )


class ConnectorStudyModel(SystemModel):
    """A study of two connected oscillators (paper, Figs 4 and 5)."""

    fixed: ClassVar[tuple[str, ...]] = ("frequencies",)

    title: str = Field(description="one line that says what is studied", examples=["Two connected oscillators"])
    first: FirstSpec = FirstSpec()
    second: SecondSpec = SecondSpec(frequency_ratio=0.6)
    connector: LinkSpec = LinkSpec()
    damping: Damping = Field(default=0.05, description="damping ratio of both systems", examples=["5 %"])
    frequencies: RangeSpec = RangeSpec()
    sweep: Any = Field(
        default=None, description="keys and the values they take", examples=[{"damping": ["5 %", "10 %"]}]
    )

    def system(self, tree: Map, where: str, problems: Problems) -> Question | None:
        """The two oscillators and the frequencies asked for."""
        _alternatives(self, tree, problems)
        asked = self.frequencies
        return None if problems.found else Question(_pair(self), asked.low, asked.high, asked.points)

    def doubt(self, model: Question, tree: Map, notes: Problems) -> None:
        """Note what is unlikely at a point of the sweep."""
        doubt_values(self, tree, (), notes)
        pair = model.pair
        for who, given, mass, stiffness in (
            ("first", self.first.stiffness, pair.m1, pair.k1),
            ("second", self.second.stiffness, pair.m2, pair.k2),
        ):
            period = 2 * math.pi * math.sqrt(mass / stiffness)
            if given is not None and not _PERIOD.holds(period):
                message = f"mass and stiffness give the {who} system a period of {period:.3g} s: {_PERIOD.reason}"
                hint = "check the units of both; otherwise leave it, the study runs as it is"
                notes.at(tree, (who, "stiffness"), message, hint)


def _alternatives(spec: ConnectorStudyModel, tree: Map, problems: Problems) -> None:
    """Note keys that say one thing in two ways, and a range without extent."""
    for name, part, keys in (
        ("first", spec.first, ("period", "stiffness")),
        ("second", spec.second, ("period", "stiffness", "frequency_ratio")),
        ("connector", spec.connector, ("damping_ratio", "dashpot")),
    ):
        given = [key for key in keys if getattr(part, key) is not None]
        if len(given) > 1:
            problems.at(
                tree,
                (name, given[1]),
                f"'{given[0]}' and '{given[1]}' cannot both be given",
                "remove one",
                key=True,
            )
        if name == "second" and not given:
            problems.at(tree, (name,), "the second system has no frequency", "add `frequency_ratio: 0.6`, or a period")
    if spec.frequencies.low >= spec.frequencies.high:
        problems.at(tree, ("frequencies",), "'low' is not below 'high'", "write e.g. {low: 0.2, high: 1.6}")


def _pair(spec: ConnectorStudyModel) -> Oscillators:
    m1, m2 = spec.first.mass, spec.second.mass
    k1 = spec.first.stiffness or m1 * (2 * math.pi / (spec.first.period or 0.5)) ** 2
    if spec.second.frequency_ratio is not None:
        k2 = m2 * spec.second.frequency_ratio**2 * k1 / m1
    elif spec.second.stiffness is not None:
        k2 = spec.second.stiffness
    else:
        assert spec.second.period is not None  # one of the three is given
        k2 = m2 * (2 * math.pi / spec.second.period) ** 2
    stiffness = spec.connector.stiffness
    k = stiffness.factor * k1 if isinstance(stiffness, TimesK1) else stiffness
    c = spec.connector.dashpot
    if c is None:
        c = eq7_dashpot(k, spec.connector.damping_ratio or 0.0, m1, m2)
    zeta1 = spec.damping if spec.first.damping is None else spec.first.damping
    zeta2 = spec.damping if spec.second.damping is None else spec.second.damping
    return Oscillators(m1, m2, k1, k2, zeta1, zeta2, k, c)
