"""Superposition of modes that all have one damping ratio, as textbooks damp buildings; shares no code with the package.

Each mode is an oscillator under the ground motion, followed by `scipy.signal.lsim`."""

from __future__ import annotations

from math import sqrt

import numpy as np
from scipy.linalg import eigh
from scipy.signal import lsim, lti

STEP = 0.02
"""Of the ground motion [s]."""


def superpose_modes(
    stiffness: np.ndarray, mass: np.ndarray, direction: np.ndarray, damping: float, samples: np.ndarray
) -> np.ndarray:  # fmt: skip
    """Return the displacements over time, a row every 2 ms, by superposition of the modes, relative to the ground.

    stiffness, mass : matrices
    direction : of the ground motion, a value for every degree of freedom
    damping : ratio of every mode [-]
    samples : acceleration of the ground every 0.02 s [m/s2]
    """
    squares, shapes = eigh(stiffness, mass)
    times = np.arange(0.0, STEP * (len(samples) - 1), STEP / 10)
    ground = np.interp(times, STEP * np.arange(len(samples)), samples)
    displacements = np.zeros((len(times), len(mass)))
    for square, shape in zip(squares, shapes.T, strict=True):
        _, response, _ = lsim(lti([-1], [1, 2 * damping * sqrt(square), square]), ground, times)
        displacements += np.outer(response, (shape @ mass @ direction) * shape)
    return displacements


def stack_storeys(stiffnesses: np.ndarray) -> np.ndarray:
    """Return the stiffness matrix of storeys on top of each other, from the ground up."""
    above = np.append(stiffnesses[1:], 0.0)
    return np.diag(stiffnesses + above) - np.diag(stiffnesses[1:], 1) - np.diag(stiffnesses[1:], -1)


def find_storey_shears(stiffnesses: np.ndarray, mass: np.ndarray, damping: float, samples: np.ndarray) -> np.ndarray:
    """Return the largest shears of storeys on top of each other [N]; arguments as those of `superpose_modes`."""
    floors = superpose_modes(stack_storeys(stiffnesses), mass, np.ones(len(mass)), damping, samples)
    return stiffnesses * np.abs(np.diff(floors, axis=1, prepend=0.0)).max(axis=0)
