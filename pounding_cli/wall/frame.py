"""The plane Euler-Bernoulli frame element."""

from __future__ import annotations

import numpy as np

from pounding_cli.wall.model import Section


def rotation(start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, float]:
    """Rotation of the end displacements (u, v, theta) into member axes, shape (6, 6); its length [m]."""
    along = np.asarray(end, dtype=float) - np.asarray(start, dtype=float)
    length = float(np.hypot(*along))
    c, s = along / length
    block = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.kron(np.eye(2), block), length


def local_stiffness(young: float, section: Section, length: float) -> np.ndarray:
    """Stiffness in member axes [N/m, N, N m], shape (6, 6): axial force, bending without shear strain."""
    axial = young * section.area / length
    a, b, c, d = (young * section.inertia / length**n * f for n, f in ((3, 12), (2, 6), (1, 4), (1, 2)))
    return np.array(
        [
            [axial, 0, 0, -axial, 0, 0],
            [0, a, b, 0, -a, b],
            [0, b, c, 0, -b, d],
            [-axial, 0, 0, axial, 0, 0],
            [0, -a, -b, 0, a, -b],
            [0, b, d, 0, -b, c],
        ]
    )


def edge_stress_rows(young: float, section: Section, length: float) -> np.ndarray:
    """Rows from local end displacements to the edge stresses N/A +- M/W at both ends [N/m3], shape (4, 6).

    The moment of a member loaded at its ends alone is linear: its largest stress stands at an end.
    """
    forces = local_stiffness(young, section, length)
    axial, start, end = forces[3] / section.area, forces[2] / section.modulus, forces[5] / section.modulus
    return np.array([axial + start, axial - start, axial + end, axial - end])
