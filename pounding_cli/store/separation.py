"""The code's separation between neighbours, at a point of the sweep."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pounding_cli.study import Study


def code_separations(study: Study, point: tuple[int, ...]) -> np.ndarray:
    """Separation of every building from the next one to the right [m], shape (buildings,).

    NaN for the last, and where the yield shears of a neighbour were not set by a code.
    """
    from pounding_cli.study.buildings import (
        design_displacements,
        separation,
    )  # reading a file needs no schema

    specs, group = study.resolver.section(point, "buildings"), study.resolver.section(point, "group")
    types = study.resolver.types(point)
    assert types is not None  # the study was validated at every point
    allowed = {name: design_displacements(specs[name], types[name]) for name in group}
    found = [separation(allowed[left], allowed[right]) for left, right in pairwise(group)]
    return np.array([*found, None], dtype=float)
