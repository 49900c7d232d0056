"""One storey with a frame off its centre under El Centro beside a textbook's."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from comparison import CHOPRA_ELCENTRO, Entry, Row, compare
from scipy.constants import lbf, pound
from superposition import read_elcentro, superpose_modes

FOOT = 0.3048
KIP = 1000 * lbf
WIDTH, DEPTH, ECCENTRICITY = 30 * FOOT, 20 * FOOT, 1.5 * FOOT
FRAME_A, FRAME_B = 75 * KIP / FOOT, 40 * KIP / FOOT
"""Stiffness along the motion, and of each of both frames across it [N/m]."""
TORSIONAL = 2 * FRAME_B * (DEPTH / 2) ** 2
"""Stiffness against the twist of the frames across the motion [N m]."""


def find_forces(displacement: np.ndarray, twist: np.ndarray) -> dict[str, float]:
    """Return the largest values of every quantity of the book's table, in its units, from the motion of the centre of
    the roof [m] and its rotation [rad] over time."""
    shear = FRAME_A * (displacement - ECCENTRICITY * twist)
    torque = TORSIONAL * twist - ECCENTRICITY * shear
    quantities = {
        "displacement of the centre [in]": displacement / (FOOT / 12),
        "displacement of the edge by the twist [in]": WIDTH / 2 * twist / (FOOT / 12),
        "base shear, all in frame A [kip]": shear / KIP,
        "base torque [kip ft]": torque / (KIP * FOOT),
        "shear of frame B [kip]": FRAME_B * DEPTH / 2 * twist / KIP,
    }
    return {name: float(np.abs(values).max()) for name, values in quantities.items()}


def find_modal_forces(folder: Path) -> dict[str, float]:
    """Return the largest values with 5 % in both modes, by superposition of these, under the motion in a folder."""
    mass = 60000 * pound
    inertia = mass * (WIDTH**2 + DEPTH**2) / 12
    coupling = -ECCENTRICITY * FRAME_A
    stiffness = np.array([[FRAME_A, coupling], [coupling, TORSIONAL + ECCENTRICITY**2 * FRAME_A]])
    along = np.array([1.0, 0.0])
    motions = superpose_modes(stiffness, np.diag([mass, inertia]), along, 0.05, read_elcentro(folder))
    return find_forces(*motions.T)


PUBLISHED = (3.349, 3.724, 20.63, 174.3, 8.275)
"""In the order of `find_forces`, from the row RHA of the book's table E13.12b."""


def compare_chopra_plan(solved: Any) -> Iterator[Row]:
    """Yield all quantities of the book's table."""
    history = solved.results.history().dataset.sel(building="storey", floor=1)
    displacement, twist = (history[name].to_numpy().astype(float) for name in ("displacement", "twist"))
    ours = find_forces(displacement, twist)
    modal = find_modal_forces(solved.file.parent)
    for (name, value), published in zip(ours.items(), PUBLISHED, strict=True):
        digits = f".{len(str(published).partition('.')[2])}f"
        why = f"superposed modes give {modal[name]:{digits}}; see above for the modes of the book"
        yield compare(name, published, value, digits, why)


ENTRY = Entry(compare_chopra_plan, motions=(CHOPRA_ELCENTRO,))
