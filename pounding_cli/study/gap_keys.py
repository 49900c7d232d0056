"""The section `gap:` of a study: which statistics of the required separation are wanted, and which rules beside it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag, WithJsonSchema

from pounding_cli.model.separation import GB_SHARE, GB_STEP
from pounding_cli.study.base import Model, optional
from pounding_cli.study.units import NUMBER, Quantity, TextForm, refuse, whole_number

_PERCENT = re.compile(rf"\s*({NUMBER})\s*%\s*\Z")
_MOST = 20


def _percent(what: str, example: str) -> TextForm:
    """A share above 0 % and below 100 %, written with its %."""

    def read(value: Any) -> float:
        hint = f"write a {what} above 0 % and below 100 %, e.g. {example}"
        if isinstance(value, bool | list | dict) or value is None:
            raise refuse(f"this is not a {what}", hint)
        found = _PERCENT.match(value) if isinstance(value, str) and len(value) < 60 else None
        if found is None:
            said = str(value).strip()[:60]
            raise refuse(f"'{said}' is not a {what}: it lacks its %", hint)
        share = float(found[1]) / 100
        if not 0 < share < 1:
            raise refuse(f"the {what} is {value.strip()}; it must be above 0 % and below 100 %", hint)
        return share

    return TextForm(read, f"{what} in %", (example,))


def _list_or_one(value: Any) -> str:
    return "list" if isinstance(value, list | tuple) else "one"


_FORM = WithJsonSchema({"type": "string", "pattern": r"^\s*[0-9.eE+-]+\s*%\s*$", "examples": ["84 %"]})
Percentile = Annotated[float, _percent("percentile", "84 %"), _FORM]
Probability = Annotated[float, _percent("probability of contact", "10 %"), _FORM]
_SOME = Field(min_length=1, max_length=_MOST)
_EITHER = Discriminator(_list_or_one)
_ONE = AfterValidator(lambda share: (share,))

if TYPE_CHECKING:
    Percentiles = tuple[float, ...]
    Probabilities = tuple[float, ...]
else:
    Percentiles = Annotated[
        Annotated[tuple[Percentile, ...], _SOME, Tag("list")] | Annotated[Percentile, _ONE, Tag("one")], _EITHER
    ]
    Probabilities = Annotated[
        Annotated[tuple[Probability, ...], _SOME, Tag("list")] | Annotated[Probability, _ONE, Tag("one")], _EITHER
    ]


class Asce7Spec(Model):
    """ASCE/SEI 7-10, section 12.12.3: what it takes from the user."""

    Cd: Annotated[float, Quantity("deflection amplification factor", "", "5.5", 1.0, 10.0)] = Field(
        description="deflection amplification factor Cd of the structural system [-]", examples=[5.5]
    )
    R: Annotated[float, Quantity("response modification factor", "", "8", 1.0, 10.0)] = Field(
        description="response modification factor R of the structural system [-]", examples=[8]
    )


class Gb50011Spec(Model):
    """GB 50011-2010, clause 6.1.4: what it takes from the user."""

    intensity: Annotated[int, whole_number(min(GB_STEP), max(GB_STEP))] = Field(
        description="seismic fortification intensity, 6 to 9", examples=[8]
    )
    structure: Literal[tuple(GB_SHARE)] = optional(  # type: ignore[valid-type]
        "frame", description="system of the building that needs the wider joint"
    )


class GapSpec(Model):
    """What `pound gap` is asked."""

    percentiles: Percentiles = optional(("84 %",), description="percentiles over the motions, one or a list")
    contact: Probabilities = optional(
        ("10 %",), description="wanted probabilities of contact, one or a list: the gap for each"
    )
    asce7: Asce7Spec | None = optional(None, description="factors for the separation of ASCE/SEI 7-10")
    gb50011: Gb50011Spec | None = optional(None, description="intensity and system for the joint of GB 50011-2010")
