"""From laws to the tables of the kernels."""

from __future__ import annotations

import dataclasses

import pytest

from pounding_cli.laws import storey_laws
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve.arrays import pack
from tests.helpers.five_storeys import motion, pair

GIVEN = {"capping_ductility": 4.0, "post_capping_slope": 0.1, "pinching_force": 0.3, "pinching_drift": 0.5}
"""Parameters without a default."""


@pytest.mark.parametrize("name", storey_laws())
def test_laws_of_storeys_make_tables_of_the_same_types(name):
    """A kernel is compiled for the types that it is given: fails if some law makes numbers of another type, so that its
    first scene takes ten seconds more."""
    law = storey_laws()[name]
    given = {key: value for key, value in GIVEN.items() if key in law.parameters()}
    building = pair()[0]
    kept = dataclasses.replace(building, storey_law=law, law_parameters=tuple(given.items()))
    plain, own = (pack(Scene((each,), (), motion(), Analysis.INELASTIC)) for each in (building, kept))
    for table in ("slots", "links", "points", "springs"):
        of_plain, of_own = getattr(plain, table), getattr(own, table)
        assert [type(value) for value in of_own] == [type(value) for value in of_plain]
        dtypes = [[getattr(value, "dtype", None) for value in each] for each in (of_plain, of_own)]
        assert dtypes[0] == dtypes[1]
