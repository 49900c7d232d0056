"""Shears of storeys and the energy in them, from their drifts, branches and memories: what histories and the energy
ledger ask of the laws."""

from __future__ import annotations

import numpy as np

from pounding_cli.laws.program import MEMORIES
from pounding_cli.solve.arrays import Arrays


def shear_and_stored(
    arrays: Arrays, drift: np.ndarray, branch: np.ndarray, memory: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(shear of every slot [N], shape (t, slots); energy in all of them [J], shape (t,)).

    Parameters
    ----------
    drift : [m], shape (t, slots)
    branch : places in the tables, shape (t, slots)
    memory : what the laws remember, shape (t, MEMORIES slots)
    """
    shear = arrays.slots.stiffness * drift
    stored = 0.5 * shear * drift
    remembered = memory.reshape(len(drift), MEMORIES, -1)
    for i in np.flatnonzero(arrays.slots.branch):
        law, first = arrays.laws[i], arrays.slots.branch[i]
        assert law is not None
        for b in np.unique(branch[:, i]):
            here = branch[:, i] == b
            given = drift[here, i], *remembered[here, :, i].T
            shear[here, i] = law.shear(b - first, *given)
            stored[here, i] = law.stored(b - first, *given)
    return shear, stored.sum(axis=1)
