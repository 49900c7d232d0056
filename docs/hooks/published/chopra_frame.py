"""Five storeys under El Centro beside a textbook's."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
from comparison import CHOPRA_ELCENTRO, PEER_ELCENTRO, Entry, Row, compare
from scipy.constants import g as GRAVITY
from scipy.signal import lsim, lti


def find_modal_peaks(motion: Path) -> dict[str, float]:
    """Return base shear [N], shear of the top storey [N] and displacement of the roof [m] of the frame with 5 % in all
    modes, by superposition of these."""
    samples = GRAVITY * np.loadtxt(motion, delimiter=",", skiprows=1)[:, 1]
    stiffness, mass, step = 5.482e6, 45e3, 0.02
    chain = stiffness * (np.diag([2.0, 2, 2, 2, 1]) - np.eye(5, k=1) - np.eye(5, k=-1))
    squares, shapes = np.linalg.eigh(chain / mass)
    times = np.arange(0.0, step * (len(samples) - 1), step / 10)
    ground = np.interp(times, step * np.arange(len(samples)), samples)
    floors = np.zeros((len(times), 5))
    for square, shape in zip(squares, shapes.T, strict=True):
        _, response, _ = lsim(lti([-1], [1, 2 * 0.05 * sqrt(square), square]), ground, times)
        floors += np.outer(response, shape.sum() * shape)
    drifts = np.abs(np.diff(floors, axis=1, prepend=0.0)).max(axis=0)
    return {"base": stiffness * drifts[0], "top": stiffness * drifts[4], "roof": np.abs(floors[:, 4]).max()}


def compare_chopra_frame(solved: Any) -> Iterator[Row]:
    """Yield base shear, top shear and roof displacement, and the latter under another digitisation."""
    shears = solved.table("storey").query("building == 'frame'").set_index(["record", "storey"])["V"] / 1e3
    floors = solved.table("floor").query("building == 'frame' and floor == 5")
    roofs = 100 * floors.set_index("record")["displacement"]
    modal = find_modal_peaks(solved.file.with_name(Path(CHOPRA_ELCENTRO).name))
    why = "the book damps every mode by 5 %, Rayleigh damping the first two; superposed modes give {:.3f}"
    book = "El Centro"
    base, top, roof = shears[book, 1], shears[book, 5], roofs[book]
    yield compare("base shear [kN]", 323.062, base, ".3f", why.format(modal["base"] / 1e3))
    yield compare("shear of the top storey [kN]", 155.308, top, ".3f", why.format(modal["top"] / 1e3))
    yield compare("displacement of the roof [cm]", 17.383, roof, ".3f", why.format(100 * modal["roof"]))
    other = "the same instrument, digitised and filtered by PEER: no study is repeated without the motion it used"
    yield compare("the same under another El Centro [cm]", 17.383, roofs["PEER"], ".3f", other)


ENTRY = Entry(compare_chopra_frame, motions=(CHOPRA_ELCENTRO, PEER_ELCENTRO))
