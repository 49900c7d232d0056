"""Stresses of the wall: element means, cells of a stated side, and the resultants of its cross-sections."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from pounding_cli.wall.assembly import System, plane_stress
from pounding_cli.wall.mesh import WallMesh
from pounding_cli.wall.model import WallModel


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Von Mises stress in plane stress [N/m2] from (s_x, s_y, t_xy): shape (..., 3) to (...)."""
    sx, sy, t = stress[..., 0], stress[..., 1], stress[..., 2]
    return np.sqrt(sx**2 - sx * sy + sy**2 + 3 * t**2)


@dataclass(frozen=True, eq=False)
class StressOperators:
    """Sparse operators from the free freedoms; rows of each are grouped by three.

    elements : mean (s_x, s_y, t_xy) of every element [N/m3], rows 3 e
    cells : the same over square cells at the struck face, of side `averaging_length`, rows 3 c
    cell_height : height of each cell's centre [m], shape (c,)
    resultants : normal force, shear, moment of every row of elements, mean over its height, rows 3 r
    row_height : height of each row's middle [m], shape (r,)
    area : of every element [m2], shape (e,)
    """

    elements: sp.csr_matrix
    cells: sp.csr_matrix
    cell_height: np.ndarray
    resultants: sp.csr_matrix
    row_height: np.ndarray
    area: np.ndarray


def stress_operators(model: WallModel, wall: WallMesh, system: System) -> StressOperators:
    """Build every operator once; a time step then costs a few sparse products.

    The mean of an element's stress, not a corner's extrapolation, is what is reported: for four nodes it is
    the stress at the centre, which NASTRAN's CQUAD4 prints.
    """
    b, weight = wall.gradients(wall.basis)
    points = weight.size
    elements = wall.mesh.t.shape[1]
    stress = sp.kron(sp.eye_array(points), plane_stress(model.concrete), format="csr") @ b @ system.spread
    owner = np.repeat(np.arange(elements), points // elements)
    area = np.bincount(owner, weight)
    mean = sp.csr_matrix((weight / area[owner], (owner, np.arange(points))), shape=(elements, points))
    element_stress = (sp.kron(mean, sp.eye_array(3)) @ stress).tocsr()

    height = _cell_heights(model)
    cells = sp.kron(_overlaps(model, wall, height), sp.eye_array(3)) @ element_stress

    x, y = wall.basis.global_coordinates().reshape(2, -1)
    row = np.searchsorted(wall.y_lines, y) - 1
    per_height = weight * wall.thickness / np.diff(wall.y_lines)[row]
    arm = model.length / 2 - x
    at = np.arange(points)
    # Tension, shear that pushes the part above away from the striker, moment that compresses the inner edge.
    entries = [(3 * row, 3 * at + 1, per_height), (3 * row + 1, 3 * at + 2, per_height)]
    entries += [(3 * row + 2, 3 * at + 1, per_height * arm)]
    lines, columns, values = (np.concatenate(part) for part in zip(*entries, strict=True))
    gather = sp.csr_matrix((values, (lines, columns)), shape=(3 * (wall.y_lines.size - 1), 3 * points))
    middle = 0.5 * (wall.y_lines[1:] + wall.y_lines[:-1])
    return StressOperators(element_stress, cells.tocsr(), height, (gather @ stress).tocsr(), middle, area)


def _cell_heights(model: WallModel) -> np.ndarray:
    """Cells every quarter side up the face, one of them centred on the contact where there is room."""
    side, top = model.averaging_length, model.frame.height
    low, high = model.patch
    centre = np.clip(0.5 * (low + high), side / 2, top - side / 2)
    below = np.arange(centre, side / 2 - 1e-9, -side / 4)[::-1]
    above = np.arange(centre, top - side / 2 + 1e-9, side / 4)[1:]
    return np.concatenate([below, above])


def _overlaps(model: WallModel, wall: WallMesh, height: np.ndarray) -> sp.csr_matrix:
    """Share of each cell's area that lies in each element [-], shape (cells, elements)."""
    side = model.averaging_length
    corners = wall.mesh.p[:, wall.mesh.t]
    (x0, y0), (x1, y1) = corners.min(axis=1), corners.max(axis=1)
    wide = np.clip(np.minimum(x1, side) - x0, 0, None)
    tall = np.minimum(y1, (height + side / 2)[:, None]) - np.maximum(y0, (height - side / 2)[:, None])
    share = wide * np.clip(tall, 0, None)
    return sp.csr_matrix(share / share.sum(axis=1, keepdims=True))
