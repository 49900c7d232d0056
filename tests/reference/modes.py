"""Matrices and undamped modes of one linear building, with its foundation where it has one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli.model.building import Building


@dataclass(frozen=True, eq=False)
class Matrices:
    """Linear building in total displacements q = (u_1 .. u_n, u_b, phi_b), relative to the ground; shapes (N,
    N), (N,).

    N = n, one more where the base sways, one more where it rocks (then the entries stand in this order).

    mass, damping, stiffness : M [kg, kg m2], C [N s/m, N m s/rad], K [N/m, N m/rad]; all symmetric
    loaded : what the ground acceleration multiplies, M q'' + C q' + K q = -a_g loaded; zero for phi_b
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    loaded: np.ndarray


@dataclass(frozen=True, eq=False)
class Modes:
    """Undamped modes: periods [s], longest first, shape (N,); shapes [-], M-normal columns, (N, N)."""

    periods: np.ndarray
    shapes: np.ndarray


def matrices(building: Building) -> Matrices:
    """Matrices of a building with its initial stiffnesses (paper, eqs 1, 2 and 4).

    Structural stiffness and damping act on the structural deformation d = T q, d_j = u_j - u_b - h_j phi_b
    (eq. 1), so they are T^T K0 T and T^T (alpha M + beta K0) T: symmetric, and the damping can only
    dissipate.
    """
    n, foundation = building.storeys, building.foundation
    masses, own_stiffness, own_damping = list(building.mass), [0.0] * n, [0.0] * n
    deformation = [np.eye(n)]
    if foundation is not None and foundation.sways:
        masses.append(foundation.mass)
        own_stiffness.append(foundation.sway_stiffness)
        own_damping.append(foundation.sway_damping)
        deformation.append(-np.ones((n, 1)))
    loaded = list(masses)
    if foundation is not None and foundation.rocks:
        masses.append(foundation.inertia)
        loaded.append(0.0)
        own_stiffness.append(foundation.rocking_stiffness)
        own_damping.append(foundation.rocking_damping)
        deformation.append(-building.elevation[:, None])
    t = np.hstack(deformation)
    structural = building.alpha * np.diag(building.mass) + building.beta * building.stiffness_matrix
    return Matrices(
        mass=np.diag(masses),
        damping=t.T @ structural @ t + np.diag(own_damping),
        stiffness=t.T @ building.stiffness_matrix @ t + np.diag(own_stiffness),
        loaded=np.array(loaded),
    )


def modes(building: Building) -> Modes:
    """Undamped modes of the building on its foundation, K x = w^2 M x."""
    system = matrices(building)
    root = np.sqrt(np.diag(system.mass))
    squares, shapes = np.linalg.eigh(system.stiffness / np.outer(root, root))
    shapes /= root[:, None]
    return Modes(2 * np.pi / np.sqrt(squares), shapes)
