"""Five storeys under El Centro beside a textbook's."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from comparison import CHOPRA_ELCENTRO, PEER_ELCENTRO, Entry, Row, compare
from superposition import read_elcentro, stack_storeys, superpose_modes


def find_modal_peaks(folder: Path) -> dict[str, float]:
    """Return base shear [N], shear of the top storey [N] and displacement of the roof [m] of the frame with 5 % in all
    modes, by superposition of these, under the motion in a folder."""
    stiffness = np.full(5, 5.482e6)
    mass = 45e3 * np.eye(5)
    floors = superpose_modes(stack_storeys(stiffness), mass, np.ones(5), 0.05, read_elcentro(folder))
    shears = stiffness * np.abs(np.diff(floors, axis=1, prepend=0.0)).max(axis=0)
    return {"base": shears[0], "top": shears[4], "roof": np.abs(floors[:, 4]).max()}


def compare_chopra_frame(solved: Any) -> Iterator[Row]:
    """Yield base shear, top shear and roof displacement, and the latter under another digitisation."""
    shears = solved.table("storey").query("building == 'frame'").set_index(["record", "storey"])["V"] / 1e3
    floors = solved.table("floor").query("building == 'frame' and floor == 5")
    roofs = 100 * floors.set_index("record")["displacement"]
    modal = find_modal_peaks(solved.file.parent)
    why = "the book damps every mode by 5 %, Rayleigh damping the first two; superposed modes give {:.3f}"
    book = "El Centro"
    base, top, roof = shears[book, 1], shears[book, 5], roofs[book]
    yield compare("base shear [kN]", 323.062, base, ".3f", why.format(modal["base"] / 1e3))
    yield compare("shear of the top storey [kN]", 155.308, top, ".3f", why.format(modal["top"] / 1e3))
    yield compare("displacement of the roof [cm]", 17.383, roof, ".3f", why.format(100 * modal["roof"]))
    other = "the same instrument, digitised and filtered by PEER: no study is repeated without the motion it used"
    yield compare("the same under another El Centro [cm]", 17.383, roofs["PEER"], ".3f", other)


ENTRY = Entry(compare_chopra_frame, motions=(CHOPRA_ELCENTRO, PEER_ELCENTRO))
