"""The longest time step at which a method of fixed steps is stable."""

from __future__ import annotations

import numpy as np

from pounding_cli.solver.assemble import Layout


def term_matrix(layout: Layout) -> np.ndarray:
    """Rows that give the deformation of every element from the displacements, shape (elements, degrees of freedom)."""
    matrix = np.zeros((layout.elements.size, layout.number))
    for row, element in zip(matrix, layout.elements, strict=True):
        row[element["left"]] += 1.0
        row[element["right"]] -= element["hold"]
        for x in range(element["first"], element["last"]):
            row[layout.terms["dof"][x]] += layout.terms["weight"][x]
    return matrix


def modes_at_stiffest(layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """(circular frequencies [rad/s], damping ratios [-]) of the undamped modes of a scene with every link closed, each
    where its law is stiffest; modal coupling by damping is left out."""
    rows, mass, n = term_matrix(layout), layout.dofs["mass"], layout.number
    k, c = np.zeros(len(rows)), np.zeros(len(rows))
    k[:n], c[:n] = layout.elements["p"][:n, 0], layout.elements["c"][:n]
    drags = slice(n, layout.of_links.start)
    c[drags] = layout.elements["p"][drags, 1]
    for place, link in enumerate(layout.links, layout.of_links.start):
        if link.law.can_close:
            k[place], c[place] = link.law.steepest
            c[place] = max(c[place], layout.elements["p"][place, 1] if link.law.joins else 0.0)
    stiffness, damping = rows.T @ (k[:, None] * rows), rows.T @ (c[:, None] * rows)
    damping[np.diag_indices(n)] += layout.dofs["drag"] * mass
    inverse = np.sqrt(layout.dofs["inv_mass"])
    squares, shapes = np.linalg.eigh(stiffness * np.outer(inverse, inverse))
    shapes *= inverse[:, None]
    omega = np.sqrt(np.maximum(squares, 0.0))
    moving = omega > 1e-9
    ratio = np.einsum("ij,ik,kj->j", shapes, damping, shapes)[moving] / (2 * omega[moving])
    return omega[moving], ratio


def central_difference_limit(layout: Layout) -> float:
    """Largest stable time step [s] of central difference with extrapolated damping forces.

    2 (sqrt(1 + 4 xi^2) - 2 xi) / omega in every mode; 2 / omega without damping. With u_n and the half-step velocity
    alternating in sign (amplification -1) the scheme gives (h omega)^2 + 8 xi h omega = 4.
    """
    omega, ratio = modes_at_stiffest(layout)
    return float(np.min(2 * (np.sqrt(1 + 4 * ratio**2) - 2 * ratio) / omega))
