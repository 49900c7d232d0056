"""Storey stiffnesses from a fundamental period, Rayleigh factors from a damping ratio.

Masses [kg] and stiffnesses [N/m] are those of a fixed-base shear building from the ground up, shape (n,), > 0."""

from __future__ import annotations

import numpy as np


def frequencies(mass: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Return the circular frequencies [rad/s], lowest first, shape (n,).

    Raises
    ------
    ValueError : shapes differ
    LinAlgError : numbers are so large or small that there are no frequencies
    """
    if mass.shape != stiffness.shape or mass.size == 0:
        raise ValueError(f"{mass.size} masses and {stiffness.size} stiffnesses: give one of each per storey")
    if mass.size == 1:
        return np.sqrt(stiffness / mass)
    # M^-1/2 K M^-1/2 is tridiagonal and symmetric.
    diagonal = (stiffness + np.append(stiffness[1:], 0.0)) / mass
    beside = -stiffness[1:] / np.sqrt(mass[:-1] * mass[1:])
    return np.sqrt(np.linalg.eigvalsh(np.diag(diagonal) + np.diag(beside, -1)))  # reads the lower triangle


def stiffness_for_period(mass: np.ndarray, period: float, taper: float = 1.0) -> np.ndarray:
    """Return the storey stiffnesses [N/m] of the building whose fixed-base fundamental period is `period`, shape (n,).

    The stiffness varies linearly with the storey's number from the ground up ("varies linearly with height",
    paper, parametric studies).

    Parameters
    ----------
    period : fundamental period [s], > 0
    taper : stiffness of the top storey over that of the bottom storey [-], > 0; of no effect with one storey
    """
    shape = np.linspace(1.0, taper, mass.size)
    return shape * (2 * np.pi / period / frequencies(mass, shape)[0]) ** 2


def rayleigh_factors(mass: np.ndarray, stiffness: np.ndarray, damping: float) -> tuple[float, float]:
    """Return the Rayleigh factors (alpha [1/s], beta [s]) that give `damping` in the first two fixed-base modes.

    alpha = 2 xi w1 w2 / (w1 + w2), beta = 2 xi / (w1 + w2) (paper, assumptions; Clough & Penzien, Dynamics of
    Structures, sec. 12-5). A one-storey building takes half of its damping from each.

    Parameters
    ----------
    damping : damping ratio xi [-], 0 <= xi < 1
    """
    w = frequencies(mass, stiffness)
    first = w[0]
    second = w[min(1, w.size - 1)]  # one storey: both are its only mode, which halves the shares
    alpha = float(2 * damping * first * second / (first + second))
    beta = float(2 * damping / (first + second))
    return alpha, beta
