"""The coefficients of DOP853 (Hairer, Norsett & Wanner 1993, II.10), as SciPy has them (tools/dop853.py)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

_TABLES = {
    name: np.array(values)
    for name, values in json.loads(Path(__file__).with_suffix(".json").read_text(encoding="ascii")).items()
}

STAGES = len(_TABLES["A"])
"""Stages of a step."""

ALL = STAGES + 1 + len(_TABLES["A_EXTRA"])
"""Derivatives of a step: at its stages, at its end, and those of the dense output."""

A = np.zeros((ALL, ALL))
"""Weights of the derivatives in the state at which the next of them is taken, a row each."""

A[:STAGES, :STAGES] = _TABLES["A"]
A[STAGES, :STAGES] = _TABLES["B"]
A[STAGES + 1 :, :] = _TABLES["A_EXTRA"]

C = np.concatenate((_TABLES["C"], [1.0], _TABLES["C_EXTRA"]))
"""Part of the step at which each derivative is taken [-]."""

E3 = _TABLES["E3"]
"""Weights of the derivatives in the error estimate of order 3."""

E5 = _TABLES["E5"]
"""Weights of the derivatives in the error estimate of order 5."""

ORDER = 7
"""Degree of the polynomials of velocities."""


def _build_dense_output() -> np.ndarray:
    """Return coefficients 1 to 7 of the polynomials of the states, over the step's length, from all derivatives.

    A polynomial is a sum of s, s (1 - s), s^2 (1 - s) and so on. Shape (orders, derivatives).
    """
    step = A[STAGES]
    first = np.eye(ALL)[0]
    last = np.eye(ALL)[STAGES]
    parts = [step, first - step, 2.0 * step - first - last, *_TABLES["D"]]
    rows = np.zeros((ORDER, ALL))
    base = np.polynomial.Polynomial([0.0, 1.0])
    for number, part in enumerate(parts):
        rows[: base.degree()] += np.outer(base.coef[1:], part)
        base = base * np.polynomial.Polynomial([0.0, 1.0] if number % 2 else [1.0, -1.0])
    return rows


DENSE = _build_dense_output()
"""Weights of the derivatives in the coefficients of the dense output."""
