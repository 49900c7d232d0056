"""The section `gap:` of a study."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pounding_cli.model.separation import GB_SHARE, GB_STEP
from pounding_cli.questions.specs import HAZARD_DESCRIPTION, RATE, Hazards, percents
from pounding_cli.study.base import Model, SpecIssue, spec_field
from pounding_cli.study.quantity import WholeNumber


class Gb50011Spec(Model):
    """Settings of the joint of GB 50011-2010, clause 6.1.4."""

    intensity: Annotated[int, WholeNumber(min(GB_STEP), max(GB_STEP))] = spec_field(
        ..., "seismic fortification intensity, 6 to 9", 8
    )
    structure: Literal[tuple(GB_SHARE)] = spec_field("frame", "system of the building that needs the wider joint")  # type: ignore[valid-type]


class GapSpec(Model):
    """Settings of `pound gap`."""

    percentiles: percents("percentile", "84 %") = spec_field(("84 %",), "percentiles over the motions, one or a list")  # type: ignore[valid-type]
    contact: percents("probability of contact", "10 %") = spec_field(  # type: ignore[valid-type]
        ("10 %",), "probabilities of contact, one or a list: the gap for each"
    )
    gb50011: Gb50011Spec | None = spec_field(None, "intensity and system for the joint of GB 50011-2010")
    hazard: Hazards | None = spec_field(None, f"{HAZARD_DESCRIPTION}; for `rate`", {"0.1 g": 0.02, "0.4 g": "1/475"})
    rate: Annotated[float, RATE] | None = spec_field(None, "annual rate of contact: the gap for it", "1/2475")

    def issues(self) -> Iterator[SpecIssue]:
        if self.rate is not None and self.hazard is None:
            yield ("rate",), "'rate' needs a hazard curve", "write `hazard: {0.1 g: 0.02, 0.4 g: 1/475}` beside it"
