"""The section `fragility:` of a study: which limits, how the intensity is varied, and how sure the answer has to be."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field, Tag

from pounding_cli.study import units
from pounding_cli.study.base import EITHER, Model, optional
from pounding_cli.study.limits import Limit, read_limit
from pounding_cli.study.problems import nearest
from pounding_cli.study.shares import CONFIDENCE
from pounding_cli.study.units import TextForm, limited, refuse, whole_number

MEASURES = ("pga", "pgv", "sa", "factor")
"""Intensity measures, as `records.scale` has them; `factor` is the scale factor itself."""

_PERIOD = limited(units.TIME, name="period", example="0.5 s", low=0.01, open_low=False, high=60.0)
_MEASURE = re.compile(r"(?P<name>[A-Za-z]+)\s*(?:\(\s*(?P<period>[^()]*?)\s*\))?\Z")


@dataclass(frozen=True)
class Measure:
    """An intensity measure of a motion; `period` [s] of `sa` only, 0 where it is the swept one."""

    name: str
    period: float = 0.0

    def __str__(self) -> str:
        return f"sa({self.period:g} s)" if self.period else self.name


def read_measure(value: Any) -> Measure:
    """`pga`, `pgv`, `factor`, `sa` or `sa(0.5 s)`.  Raises PydanticCustomError saying what to write."""
    hint = "write pga, pgv, factor or the pseudo-acceleration at a period, sa(0.5 s)"
    found = _MEASURE.match(value.strip()) if isinstance(value, str) and len(value) < 60 else None
    if found is None:
        raise refuse(f"'{str(value)[:60]}' is not an intensity measure", hint)
    if found["name"] not in MEASURES:
        raise refuse(f"no intensity measure '{found['name']}' is known", nearest(found["name"], MEASURES))
    if found["period"] is None:
        return Measure(found["name"])
    if found["name"] != "sa":
        raise refuse(f"'{value}': only sa has a period", f"write `{found['name']}`")
    if not units.written_unit(found["period"]):
        raise refuse(f"'{value}': the period has no unit", "write e.g. `sa(0.5 s)`")
    return Measure("sa", _PERIOD.read(found["period"]))


OneLimit = Annotated[Limit, TextForm(read_limit, "limit in words", ("mu > 4", "drift > 2 %", "contact"))]
_SeveralLimits = Annotated[tuple[OneLimit, ...], Field(max_length=20), Tag("list")]
_OnlyLimit = Annotated[OneLimit, AfterValidator(lambda limit: (limit,)), Tag("one")]
if TYPE_CHECKING:
    Limits = tuple[Limit, ...]
else:
    Limits = Annotated[_SeveralLimits | _OnlyLimit, EITHER]


class FragilitySpec(Model):
    """What `pound fragility` is asked."""

    limits: Limits = optional(
        (),
        description="limits in words, one or a list: `mu > 4`, `drift > 2 %` (of the storey height) or `drift > 6 cm`, "
        "`acceleration > 1 g`, `shear_demand > 1` (of columns that slabs strike), `contact`, `collapse`; of each "
        "building, or with `in BUILDING`, `in BUILDING storey N` of one",
    )
    method: Literal["ida", "stripes", "cloud"] = optional(
        "ida",
        description="`ida`: each motion is scaled through the swept intensities until it passes, few of them solved; "
        "`stripes`: every motion at every swept intensity; `cloud`: motions as they are, and a line through them",
    )
    intensity: Annotated[Measure, TextForm(read_measure, "intensity measure", (*MEASURES, "sa(0.5 s)"))] | None = (
        optional(None, description="intensity measure of the curves; default: the swept one; for a cloud, pga")
    )
    fill: Annotated[int, whole_number(0, 1000)] = optional(
        4,
        description="intensities solved below the one at which a motion passes, and among those that a collapse leaves "
        "undecided (`ida`), in case it passes there too",
    )
    confidence: Annotated[float, CONFIDENCE] = optional("90 %", description="confidence of all intervals")
    draws: Annotated[int, whole_number(100, 100_000)] = optional(
        1000, description="draws of the bootstrap over the motions"
    )
