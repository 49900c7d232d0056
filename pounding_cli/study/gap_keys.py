"""The section `gap:` of a study: which statistics of the required separation are wanted, and which rules beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator, Field, Tag, WithJsonSchema

from pounding_cli.model.separation import GB_SHARE, GB_STEP
from pounding_cli.study.base import EITHER, Model, optional
from pounding_cli.study.shares import percent
from pounding_cli.study.units import whole_number

_MOST = 20


_FORM = WithJsonSchema({"type": "string", "pattern": r"^\s*[0-9.eE+-]+\s*%\s*$", "examples": ["84 %"]})
Percentile = Annotated[float, percent("percentile", "84 %"), _FORM]
Probability = Annotated[float, percent("probability of contact", "10 %"), _FORM]
_SOME = Field(min_length=1, max_length=_MOST)
_ONE = AfterValidator(lambda share: (share,))

if TYPE_CHECKING:
    Percentiles = tuple[float, ...]
    Probabilities = tuple[float, ...]
else:
    Percentiles = Annotated[
        Annotated[tuple[Percentile, ...], _SOME, Tag("list")] | Annotated[Percentile, _ONE, Tag("one")], EITHER
    ]
    Probabilities = Annotated[
        Annotated[tuple[Probability, ...], _SOME, Tag("list")] | Annotated[Probability, _ONE, Tag("one")], EITHER
    ]


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
        ("10 %",), description="probabilities of contact, one or a list: the gap for each"
    )
    gb50011: Gb50011Spec | None = optional(None, description="intensity and system for the joint of GB 50011-2010")
