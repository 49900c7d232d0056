"""Link stiffnesses as multiples of a storey's: `20 x stiffest storey`, `1/5 mean storey of stiff`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from pounding_cli.study.units import LONGEST, NUMBER, STIFFNESS, TextForm, refuse

_RULE = re.compile(
    rf"\s*(?:(?P<top>{NUMBER})\s*(?:/\s*(?P<bottom>{NUMBER}))?\s*(?P<percent>%)?\s*(?:x|X|×|\*|times)?\s*)?"
    r"(?:the\s+)?(?P<which>stiffest|mean|average)\s+store?y(?:\s+of\s+(?:the\s+)?(?P<building>\S.*?))?\s*\Z"
)
_HINT = "write an SI or unit value such as 200 kN/mm, or `20 x stiffest storey`, or `1/5 mean storey of NAME`"


@dataclass(frozen=True)
class StiffnessRule:
    """`factor` times the stiffest or the mean storey of a building, or of all buildings of the group.

    The mean storey of the group is that of the building whose mean storey is stiffest.
    """

    factor: float
    which: str
    building: str | None = None

    def __str__(self) -> str:
        of = f" of {self.building}" if self.building else ""
        return f"{self.factor:.12g} x {self.which} storey{of}"


def read_stiffness(value: Any) -> float | StiffnessRule:
    """A stiffness [N/m] or a rule.  Raises PydanticCustomError saying what to write."""
    if not isinstance(value, str) or "stor" not in value:
        return STIFFNESS.read(value)
    found = _RULE.match(value) if len(value) <= LONGEST else None
    if not found:
        raise refuse(f"'{value[:LONGEST]}' is not a stiffness", _HINT)
    factor = float(found["top"] or 1.0)
    if found["bottom"] is not None:
        if float(found["bottom"]) == 0:
            raise refuse(f"'{value}' divides by zero", _HINT)
        factor /= float(found["bottom"])
    if found["percent"]:
        factor /= 100.0
    if not 0 < factor < 1e12:
        raise refuse(f"the factor in '{value}' is {factor:g}; it must be above 0", _HINT)
    return StiffnessRule(factor, "mean" if found["which"] == "average" else found["which"], found["building"])


STIFFNESS_FORM = TextForm(
    read_stiffness,
    "N/m, or a multiple of a storey's",
    ("20 x stiffest storey", "1/5 mean storey of stiff", "1e10 N/m"),
    STIFFNESS,
)
