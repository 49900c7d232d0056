"""The quadrilateral mesh of the wall and the gradient operator of its displacement field."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementQuad1, ElementQuad2, FacetBasis, LinearForm, MeshQuad
from skfem.quadrature import get_quadrature

from pounding_cli.wall.model import Over, Shape, WallModel


def grid_lines(breaks: list[float], size: float, growth: float, centre: tuple[float, float]) -> np.ndarray:
    """Positions of mesh lines [m]: every break is one; between two, intervals of at most the wished size.

    The wished size at a distance r from the interval `centre` is size + growth * r [m].
    """
    lines = [breaks[0]]
    for low, high in pairwise(breaks):
        fine = np.linspace(low, high, 400)
        distance = np.maximum(np.maximum(centre[0] - fine, fine - centre[1]), 0.0)
        density = 1.0 / (size + growth * distance)
        count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))])
        pieces = max(1, int(np.ceil(count[-1] - 1e-9)))
        lines.extend(np.interp(np.linspace(0, count[-1], pieces + 1)[1:-1], count, fine))
        lines.append(high)
    return np.array(lines)


@dataclass(frozen=True, eq=False)
class WallMesh:
    """The wall's mesh and its scalar element space; node i carries displacements 2i (x) and 2i + 1 (y).

    mesh : x from the struck face, y from the base [m]
    basis : scikit-fem basis with the quadrature of the stiffness
    nodes : coordinates of the degrees of freedom of the scalar space [m], shape (2, n)
    x_lines, y_lines : mesh lines [m]
    """

    mesh: MeshQuad
    basis: Basis
    nodes: np.ndarray
    x_lines: np.ndarray
    y_lines: np.ndarray
    thickness: float

    def on_line(self, y: float) -> tuple[np.ndarray, np.ndarray]:
        """Nodes on the mesh line at `y` [m], from the face inwards; their shares of its length [-]."""
        found = np.flatnonzero(np.abs(self.nodes[1] - y) < 1e-9)
        found = found[np.argsort(self.nodes[0, found])]
        x = self.nodes[0, found]
        share = np.zeros(x.size)
        if isinstance(self.basis.elem, ElementQuad1):
            share[:-1] += np.diff(x) / 2
            share[1:] += np.diff(x) / 2
        else:  # Simpson: the integrals of the quadratic shape functions along an edge
            width = x[2::2] - x[:-2:2]
            share[:-2:2] += width / 6
            share[1::2] += width * 4 / 6
            share[2::2] += width / 6
        return found, share / share.sum()

    def gradients(self, basis: Basis) -> tuple[sp.csr_matrix, np.ndarray]:
        """Operator from nodal displacements to (e_x, e_y, gamma_xy) at the basis' points; the points' areas.

        Returns
        -------
        B : shape (3 q, 2 n), rows grouped by point, points by element
        area : weights of the points [m2], shape (q,)
        """
        elements, points = basis.dx.shape
        row = 3 * np.arange(elements * points).reshape(elements, points)
        rows, columns, values = [], [], []
        for i in range(basis.Nbfun):
            gx, gy = basis.basis[i][0].grad
            node = np.broadcast_to(2 * basis.element_dofs[i][:, None], gx.shape)
            for line, column, value in (
                (row, node, gx),
                (row + 1, node + 1, gy),
                (row + 2, node, gy),
                (row + 2, node + 1, gx),
            ):
                rows.append(line.ravel())
                columns.append(column.ravel())
                values.append(value.ravel())
        shape = (3 * elements * points, 2 * basis.N)
        entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
        return sp.csr_matrix(entries, shape=shape), basis.dx.ravel()

    def pressure(self, low: float, high: float) -> np.ndarray:
        """Nodal shares of a uniform pressure on the face between two mesh lines [-], shape (n,), sum 1."""
        middle = self.mesh.p[:, self.mesh.facets].mean(axis=1)
        struck = np.flatnonzero((np.abs(middle[0]) < 1e-9) & (middle[1] > low) & (middle[1] < high))
        shares = LinearForm(lambda v, _: v).assemble(FacetBasis(self.mesh, self.basis.elem, facets=struck))
        return shares / (high - low)

    def volume(self) -> np.ndarray:
        """Volume that each node stands for [m3], shape (n,): row sums of the consistent mass matrix."""
        return self.thickness * LinearForm(lambda v, _: v).assemble(self.basis)


def build_mesh(model: WallModel) -> WallMesh:
    """Mesh the wall; the floors, the contact and its edges are mesh lines."""
    low, high = model.patch
    marks = {0.0, *model.frame.floors, low, high, model.striker.height}
    if model.contact.over is Over.PATCH:
        marks.discard(model.striker.height)
        marks |= {low, high}
    breaks = sorted(marks)
    breaks = [b for i, b in enumerate(breaks) if i == 0 or b - breaks[i - 1] > 1e-9]
    x = grid_lines([0.0, model.length], model.mesh.size, model.mesh.growth, (0.0, 0.0))
    y = grid_lines(breaks, model.mesh.size, model.mesh.growth, (low, high))
    mesh = MeshQuad.init_tensor(x, y)
    linear = model.mesh.shape is Shape.LINEAR
    element = ElementQuad1() if linear else ElementQuad2()
    basis = Basis(mesh, element, quadrature=get_quadrature(element.refdom, 2 if linear else 4))
    return WallMesh(mesh, basis, basis.doflocs, x, y, model.thickness)
