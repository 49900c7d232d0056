"""The law of a storey: elastic up to its yield shear, then kinematic hardening (bilinear; paper, section 2).

On a yield line the shear is a k D + side (1 - a) Vy; between the lines it is k D - (1 - a) k Dp with the plastic drift
Dp of the last unloading. The functions are plain arithmetic: kernels compile them (`kernels.storey_law`), the rest
calls them as they are, on numbers or, where it says so, on arrays."""

from __future__ import annotations

import math

import numpy as np

ELASTIC, UPPER, LOWER = 0.0, 1.0, -1.0
"""Branches: between the yield lines, on the upper one, on the lower one."""


def coefficients(stiffness, hardening, plateau, line, plastic):
    """(stiffness [N/m], offset [N]) of a branch: the shear is stiffness * drift + offset.

    stiffness k [N/m], hardening a [-], plateau (1 - a) Vy [N], line: the branch, plastic drift [m]
    """
    if line == ELASTIC:
        return stiffness, -(1.0 - hardening) * stiffness * plastic  # fault: storey-elastic-tangent
    return hardening * stiffness, line * plateau


def transition(line, plastic, yield_drift, drift):
    """(branch, plastic drift [m], side of the line that the storey is exactly on and at rest) after it has left its
    branch at `drift` [m]: onto a yield line, or off it."""
    if line == ELASTIC:  # the plastic drift means nothing on a line
        return (UPPER if drift > plastic else LOWER), math.inf, 0
    return ELASTIC, drift - line * yield_drift, int(line)


def return_mapping(stiffness, hardening, yield_drift, plastic, drift):
    """(shear [N], plastic drift [m]) at a drift [m] where branches are not followed: the elastic part of the drift is
    cut back to the yield drift (return mapping)."""
    elastic = drift - plastic
    if elastic > yield_drift:
        elastic = yield_drift
        plastic = drift - yield_drift
    elif elastic < -yield_drift:
        elastic = -yield_drift
        plastic = drift + yield_drift
    return stiffness * (hardening * drift + (1.0 - hardening) * elastic), plastic


def yields(yield_drift, plastic, drift):
    """Whether a storey is on a yield line after `return_mapping`, but for the last digits."""
    return abs(drift - plastic) >= yield_drift * (1.0 - 1e-12)


def elastic_drift(line: np.ndarray, plastic: np.ndarray, yield_drift: np.ndarray, drift: np.ndarray) -> np.ndarray:
    """The elastic part of drifts [m]; arrays of one shape, `yield_drift` by storey alone."""
    limit = np.where(np.isfinite(yield_drift), yield_drift, 0.0)
    between = line == ELASTIC
    return np.where(between, drift - np.where(between, plastic, 0.0), line * limit)  # fault: history-yield-line


def stored(stiffness: np.ndarray, hardening: np.ndarray, drift: np.ndarray, elastic: np.ndarray) -> np.ndarray:
    """Energy in the springs of storeys [J]; the last axis of `drift` and of its elastic part is summed."""
    return 0.5 * ((hardening * drift**2 + (1 - hardening) * elastic**2) @ stiffness)
