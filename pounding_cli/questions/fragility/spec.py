"""The section `fragility:` of a study."""

from __future__ import annotations

from typing import Annotated, Literal

from pounding_cli.questions.specs import (
    CONFIDENCE_QUANTITY,
    HAZARD_DESCRIPTION,
    INTENSITY_MEASURES,
    LIMIT,
    Hazards,
    Measure,
    parse_measure,
)
from pounding_cli.study.schema.base import Model, one_or_many, spec_field
from pounding_cli.study.schema.quantity import ParsedText, WholeNumber


class FragilitySpec(Model):
    """Settings of `pound fragility`."""

    limits: one_or_many(LIMIT, 0, 20, True) = spec_field(  # type: ignore[valid-type]
        (),
        "limits in words, one or a list: `mu > 4`, `drift > 2 %` (of the storey height) or `drift > 6 cm`, "
        "`acceleration > 1 g`, `shear_demand > 1` (of columns that links load), `contact`, `collapse`; of each "
        "building, or of one: `mu in BUILDING > 4`, `mu in BUILDING storey N > 4`, `collapse in BUILDING`; where "
        "floors twist `edge_drift > 2 %`, `twist > 0.01 rad`, `mu in line 1 of BUILDING > 4`, too; of buildings that "
        "are only seen `slight damage`, `moderate damage`, `extensive damage` and `complete damage`, too",
    )
    method: Literal["ida", "stripes", "cloud"] = spec_field(
        "ida",
        "`ida`: each motion is scaled through the swept intensities until it passes, few of them solved; "
        "`stripes`: every motion at every swept intensity; `cloud`: motions as they are, and a line through them",
    )
    intensity: (
        Annotated[Measure, ParsedText(parse_measure, "intensity measure", (*INTENSITY_MEASURES, "sa(0.5 s)"))] | None
    ) = spec_field(None, "intensity measure of the curves; default: the swept one; for a cloud, pga")
    fill: Annotated[int, WholeNumber(0, 1000)] = spec_field(
        4,
        "intensities solved below the one at which a motion passes (`ida`), in case it passes there too",
    )
    hazard: Hazards | None = spec_field(
        None, f"{HAZARD_DESCRIPTION}: adds the annual rate of every limit", {"k0": 1e-4, "k": 2.5}
    )
    confidence: Annotated[float, CONFIDENCE_QUANTITY] = spec_field("90 %", "confidence of all intervals")
    draws: Annotated[int, WholeNumber(100, 100_000)] = spec_field(1000, "draws of the bootstrap over the motions")
