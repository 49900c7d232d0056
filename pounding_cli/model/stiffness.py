"""Storey stiffnesses from a fundamental period, Rayleigh factors from a damping ratio."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def frequencies(mass: ArrayLike, stiffness: ArrayLike) -> np.ndarray:
    """Circular frequencies [rad/s] of a fixed-base shear building, lowest first, shape (n,).

    Parameters
    ----------
    mass : floor masses [kg], from the ground up, shape (n,), > 0
    stiffness : storey stiffnesses [N/m], from the ground up, shape (n,), > 0

    Raises
    ------
    ValueError : shapes differ, or a value is not finite and positive
    """
    m, k = positive("mass", mass), positive("stiffness", stiffness)
    if m.shape != k.shape:
        raise ValueError(f"{m.size} masses and {k.size} stiffnesses: give one of each per storey")
    if m.size == 1:
        return np.sqrt(k / m)
    # M^-1/2 K M^-1/2 is tridiagonal and symmetric.
    diagonal = (k + np.append(k[1:], 0.0)) / m
    beside = -k[1:] / np.sqrt(m[:-1] * m[1:])
    return np.sqrt(np.linalg.eigvalsh(np.diag(diagonal) + np.diag(beside, -1)))  # reads the lower triangle


def stiffness_for_period(mass: ArrayLike, period: float, taper: float = 1.0) -> np.ndarray:
    """Storey stiffnesses [N/m] of the building whose fixed-base fundamental period is `period`, shape (n,).

    The stiffness varies linearly with the storey's number from the ground up ("varies linearly with height",
    paper, parametric studies).

    Parameters
    ----------
    mass : floor masses [kg], from the ground up, shape (n,), > 0
    period : fundamental period [s], > 0
    taper : stiffness of the top storey over that of the bottom storey [-], > 0; of no effect with one storey

    Raises
    ------
    ValueError : a value is not finite and positive
    """
    m = positive("mass", mass)
    (wanted,), (ratio,) = positive("period", [period]), positive("taper", [taper])
    shape = np.linspace(1.0, ratio, m.size)
    return shape * (2 * np.pi / wanted / frequencies(m, shape)[0]) ** 2


def rayleigh_factors(mass: ArrayLike, stiffness: ArrayLike, damping: float) -> tuple[float, float]:
    """Rayleigh factors (alpha [1/s], beta [s]) that give `damping` in the first two fixed-base modes.

    alpha = 2 xi w1 w2 / (w1 + w2), beta = 2 xi / (w1 + w2) (paper, assumptions; Clough & Penzien, Dynamics of
    Structures, sec. 12-5). A one-storey building takes half of its damping from each.

    Parameters
    ----------
    mass, stiffness : floor masses [kg] and storey stiffnesses [N/m], from the ground up, shape (n,), > 0
    damping : damping ratio xi [-], 0 <= xi < 1

    Raises
    ------
    ValueError : shapes differ, or a value is outside its range
    """
    if not 0 <= damping < 1:
        raise ValueError(f"damping is {damping:g}: give a ratio of critical from 0 up to, not including, 1")
    w = frequencies(mass, stiffness)

    first, second = w[0], w[min(1, w.size - 1)]  # one storey: both are its only mode, which halves the shares
    return float(2 * damping * first * second / (first + second)), float(2 * damping / (first + second))


def positive(name: str, values: ArrayLike) -> np.ndarray:
    """One value for every storey, shape (n,).  Raises ValueError where there is none, or one is not above zero."""
    array = np.array(values, dtype=float)
    if array.ndim != 1 or array.size == 0:
        raise ValueError(f"{name} has shape {array.shape}: give one value per storey")
    if not (np.isfinite(array).all() and (array > 0).all()):
        raise ValueError(f"{name} is {array.tolist()}: every value must be finite and above zero")
    return array
