"""Four storeys with a light appendage under El Centro beside a textbook's."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from comparison import CHOPRA_ELCENTRO, Entry, Row, compare
from superposition import STEP, read_elcentro, stack_storeys, superpose_modes

DURATION = 15.0
"""Of the book's figure, and of the study [s]."""


def find_modal_shears(samples: np.ndarray) -> np.ndarray:
    """Return the largest shears of all storeys with 5 % in every mode, by superposition of the modes [N]."""
    stiffness = 3.9431e6 * np.array([1, 1, 1, 1, 0.0012])
    mass = 45e3 * np.diag([1, 1, 1, 1, 0.01])
    floors = superpose_modes(stack_storeys(stiffness), mass, np.ones(5), 0.05, samples)
    return stiffness * np.abs(np.diff(floors, axis=1, prepend=0.0)).max(axis=0)


def compare_chopra_appendage(solved: Any) -> Iterator[Row]:
    """Yield the shear of the appendage and that of the base."""
    shears = solved.table("storey").query("building == 'frame'").set_index("storey")["V"] / 1e3
    modal = find_modal_shears(read_elcentro(solved.file.parent)[: round(DURATION / STEP) + 1]) / 1e3
    why = "the book damps every mode by 5 %, Rayleigh damping the two close ones; superposed modes give {:.3f}"
    yield compare("shear of the appendage [kN]", 4.390, shears[5], ".3f", why.format(modal[4]))
    yield compare("base shear [kN]", 248.791, shears[1], ".3f", why.format(modal[0]))


ENTRY = Entry(compare_chopra_appendage, motions=(CHOPRA_ELCENTRO,))
