"""The digest by which a scene's results are found again."""

from __future__ import annotations

import dataclasses
import math

import pytest

from pounding_cli.model.links import DashpotLaw, InfillLaw, Kind, Link

LINK = Link(0, 2, 3, Kind.INFILL, 0.05, 1e8, 1e9, 0.2)
OTHER = {
    "left": 1, "left_floor": 4, "right_floor": 4, "kind": Kind.POUNDING, "gap": math.nextafter(0.05, 1),
    "stiffness": math.nextafter(1e8, 0), "impact_stiffness": 2e9, "damping_ratio": 0.1, "tension_cut": True,
    "infill_law": InfillLaw.PRINTED, "dashpot_law": DashpotLaw.PRINTED,
}  # fmt: skip


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(Link)])
def test_every_field_of_a_link_counts(field):
    """To its last digit. Fails if a field is forgotten: a changed study would take over results that are wrong."""
    assert dataclasses.replace(LINK, **{field: OTHER[field]}).words != LINK.words


def test_the_words_of_a_link_stay_what_they_were():
    """Fails if results that are on disk would not be found again."""
    assert LINK.words == "0 2 3 infill 0.05 100000000.0 1000000000.0 0.2 False continuous reduced-mass"
