"""Superposition of modes that all have one damping ratio, as textbooks damp buildings."""

from __future__ import annotations

from math import sqrt
from pathlib import Path

import numpy as np
from comparison import CHOPRA_ELCENTRO
from scipy.constants import g as GRAVITY
from scipy.linalg import eigh
from scipy.signal import lsim, lti

Array = np.ndarray
STEP = 0.02
"""Of the motion of the textbook [s]."""


def read_elcentro(folder: Path) -> Array:
    """Return the samples of the textbook's El Centro, every 0.02 s, from a folder [m/s2]."""
    return GRAVITY * np.loadtxt(folder / Path(CHOPRA_ELCENTRO).name, delimiter=",", skiprows=1)[:, 1]


def superpose_modes(stiffness: Array, mass: Array, direction: Array, damping: float, samples: Array) -> Array:
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


def stack_storeys(stiffnesses: Array) -> Array:
    """Return the stiffness matrix of storeys on top of each other, from the ground up."""
    above = np.append(stiffnesses[1:], 0.0)
    return np.diag(stiffnesses + above) - np.diag(stiffnesses[1:], 1) - np.diag(stiffnesses[1:], -1)
