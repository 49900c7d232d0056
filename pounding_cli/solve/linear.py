"""The matrices of a scene from its arrays: what implicit and exact stepping, and stability limits, are made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.elements import elements_of, term_matrix
from pounding_cli.solve.law_tables import stiffest


@dataclass(frozen=True, eq=False)
class Matrices:
    """Linear scene in the displacements q of its N degrees of freedom; links are left out.

    slots : of the degrees of freedom, shape (N,)
    mass : diagonal of M [kg], shape (N,)
    damping, stiffness : C [N s/m] and initial K [N/m], symmetric, shape (N, N)
    drift : rows that give what the springs of these slots act on from q [-], shape (N, N)
    closing : rows that give the closings of the links from q, gap not subtracted [-], shape (links, N)
    loaded : what the ground acceleration multiplies, M q'' + C q' + K q = -a_g loaded, shape (N,)
    """

    slots: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    drift: np.ndarray
    closing: np.ndarray
    loaded: np.ndarray


def matrices(arrays: Arrays) -> Matrices:
    """M, C and K with every storey at its initial stiffness (paper, eqs 1-4)."""
    elements = elements_of(arrays)
    kept = np.flatnonzero(elements.unknown >= 0)
    rows = term_matrix(elements)[:, kept]
    springs, closing = rows[: elements.springs], rows[elements.springs :]
    stiffness = springs.T @ (elements.stiffness[:, None] * springs)
    damping = springs.T @ (elements.dashpot[:, None] * springs)
    damping[np.diag_indices(len(kept))] += elements.drag[kept]
    mass = arrays.slots.mass[kept]
    return Matrices(kept, mass, damping, stiffness, springs[kept], closing, mass * elements.loaded[kept])


def with_links(arrays: Arrays, system: Matrices) -> tuple[np.ndarray, np.ndarray]:
    """(C, K) with every link closed, each where its law is stiffest."""
    slope, dashpot = stiffest(arrays.links)
    rows = system.closing
    return (
        system.damping + rows.T @ (dashpot[:, None] * rows),
        system.stiffness + rows.T @ (slope[:, None] * rows),
    )


def modes_at_stiffest(arrays: Arrays) -> tuple[np.ndarray, np.ndarray]:
    """(circular frequencies [rad/s], damping ratios [-]) of the undamped modes of the scene at its stiffest; modal
    coupling by damping is left out."""
    system = matrices(arrays)
    damping, stiffness = with_links(arrays, system)
    root = np.sqrt(system.mass)
    squares, shapes = np.linalg.eigh(stiffness / np.outer(root, root))
    shapes /= root[:, None]
    omega = np.sqrt(np.maximum(squares, 0.0))
    moving = omega > 1e-9
    ratio = np.einsum("ij,ik,kj->j", shapes, damping, shapes)[moving] / (2 * omega[moving])
    return omega[moving], ratio


def runge_kutta_limit(arrays: Arrays) -> float:
    """Largest time step [s] at which classical Runge-Kutta is stable: |R(h lambda)| <= 1 in every mode."""
    omega, ratio = modes_at_stiffest(arrays)
    eigenvalues = omega * (-ratio + np.sqrt(ratio.astype(complex) ** 2 - 1))
    eigenvalues = np.concatenate((eigenvalues, omega * (-ratio - np.sqrt(ratio.astype(complex) ** 2 - 1))))

    def stable(h: float) -> bool:
        z = h * eigenvalues
        return bool(np.all(np.abs(1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)))) <= 1 + 1e-12))

    low, high = 0.0, 3.0 / float(omega.max())
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def central_difference_limit(arrays: Arrays) -> float:
    """Largest stable time step [s] of central difference with extrapolated damping forces.

    2 (sqrt(1 + 4 xi^2) - 2 xi) / omega in every mode; 2 / omega without damping. With u_n and the half-step velocity
    alternating in sign (amplification -1) the scheme gives (h omega)^2 + 8 xi h omega = 4.
    """
    omega, ratio = modes_at_stiffest(arrays)
    return float(np.min(2 * (np.sqrt(1 + 4 * ratio**2) - 2 * ratio) / omega))
