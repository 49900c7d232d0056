"""The digest by which a scene's results are found again."""

from __future__ import annotations

import dataclasses
import math

import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.laws.dashpot import DashpotLaw
from pounding_cli.laws.infill import Infill, InfillLaw
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.links import Link

LAWS = (Pounding(0.05, 1e8, 0.2), Infill(0.05, 1e8, 1e9, 0.2), Connector(0.05, 1e8, 0.2))
OTHER = {
    "gap": math.nextafter(0.05, 1), "stiffness": math.nextafter(1e8, 0), "impact_stiffness": 2e9, "damping_ratio": 0.1,
    "tension_cut": True, "law": InfillLaw.PRINTED, "dashpot": DashpotLaw.PRINTED,
}  # fmt: skip
LINK = Link(0, 2, 3, LAWS[1])
STRUCK = Link(0, 2, 3, LAWS[0], right_at=0.3, columns=0.2)
LAW = dataclasses.replace(LAWS[0], gap=0.06)
ENDS = {"left": 1, "left_floor": 4, "right_floor": 4, "law": LAW, "right_at": 0.5, "columns": 0.5}


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(Link)])
def test_every_field_of_a_link_counts(field):
    """Fails if a field is forgotten: a changed study would take over results that are wrong."""
    if field == "left_at":  # columns on both sides have no one share
        assert dataclasses.replace(LINK, left_at=0.5).words != LINK.words
    else:
        assert dataclasses.replace(STRUCK, **{field: ENDS[field]}).words != STRUCK.words


@pytest.mark.parametrize(("law", "field"), [(law, each.name) for law in LAWS for each in dataclasses.fields(law)])
def test_every_parameter_of_a_law_counts(law, field):
    """To its last digit. Fails if a parameter is forgotten, likewise."""
    assert dataclasses.replace(law, **{field: OTHER[field]}).words != law.words


def test_the_words_of_a_link_stay_what_they_were():
    """Fails if results that are on disk would not be found again."""
    assert LINK.words == "0 2 3 infill 0.05 100000000.0 1000000000.0 0.2 False continuous reduced-mass"
