"""From laws to the tables of the kernels."""

from __future__ import annotations

import dataclasses

import pytest

from pounding_cli.laws import storey_laws
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve.arrays import pack
from tests.helpers.five_storeys import motion, pair


@pytest.mark.parametrize("name", storey_laws())
def test_laws_of_storeys_make_tables_of_the_same_types(name):
    """A kernel is compiled for the types that it is given: fails if some law makes numbers of another type, so that its
    first scene takes ten seconds more."""
    law = storey_laws()[name]
    plain, own = (
        pack(Scene((dataclasses.replace(pair()[0], **given),), (), motion(), Analysis.INELASTIC))
        for given in ({}, {"storey_law": law})
    )
    for table in ("slots", "links", "points", "springs"):
        of_plain, of_own = getattr(plain, table), getattr(own, table)
        assert [type(value) for value in of_own] == [type(value) for value in of_plain]
        dtypes = [[getattr(value, "dtype", None) for value in each] for each in (of_plain, of_own)]
        assert dtypes[0] == dtypes[1]
