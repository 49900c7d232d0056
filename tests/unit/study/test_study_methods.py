"""The methods a study may name are those the solver has."""

from __future__ import annotations

import typing

from pounding_cli.methods import AUTO, METHODS
from pounding_cli.study import schema


def test_methods_are_the_solver_s():
    assert set(typing.get_args(schema.Method)) == {AUTO, *METHODS}
