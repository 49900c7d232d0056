"""Stress operators against uniform fields and the statics of the wall."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from pounding_cli.wall.assembly import assemble
from pounding_cli.wall.mesh import build_mesh
from pounding_cli.wall.model import Frame, Mesh, Section, Shape, Striker, WallModel
from pounding_cli.wall.stress import stress_operators, von_mises


def test_von_mises():
    states = np.array([[-7.0, 0, 0], [0, 0, 3.0], [4.0, 4.0, 0], [1.0, 2.0, 3.0]])
    assert von_mises(states) == pytest.approx([7.0, 3 * np.sqrt(3), 4.0, np.sqrt(3 + 27)])


@pytest.mark.parametrize("shape", list(Shape))
def test_resultants_are_those_of_statics(shape):
    thin = Section(1e-4, 1e-4)
    model = WallModel(frame=Frame(beam=thin, column=thin), striker=Striker(height=10.5), mesh=Mesh(0.25, 0.0, shape))
    wall = build_mesh(model)
    system = assemble(model, wall)
    operators = stress_operators(model, wall, system)
    u = spsolve(system.K, 1e6 * system.p)
    normal, shear, moment = (operators.resultants @ u).reshape(-1, 3).T
    below = operators.row_height < 10.4
    above = operators.row_height > 10.6
    assert shear[below] == pytest.approx(1e6, rel=1e-4)
    assert np.abs(shear[above]).max() < 200
    # Pushed away from the striker: tension at the struck edge. Four-node elements lock a little in bending.
    rel = 2e-3 if shape is Shape.QUADRATIC else 2e-2
    assert moment[below] == pytest.approx(1e6 * (10.5 - operators.row_height[below]), rel=rel, abs=1e4)
    assert np.abs(normal).max() < 200


@pytest.mark.parametrize("shape", list(Shape))
def test_means_over_elements_and_cells_of_a_linear_stress(shape):
    """s_y = E x / 2 and nothing else: the cell at the face of side 0.5 m has the mean at x = 0.25 m."""
    model = WallModel(mesh=Mesh(0.3, 0.0, shape))
    wall = build_mesh(model)
    system = assemble(model, wall)
    operators = stress_operators(model, wall, system)
    x, y = wall.nodes
    e, nu = 30e9, 0.2
    if shape is Shape.QUADRATIC:
        sx, sy = -(nu * x**2 / 2 + y**2 / 2) / 2, x * y / 2
        slope, level = e / 2, 0.0
    else:
        sx, sy = -nu * x / 2, y / 2
        slope, level = 0.0, e / 2
    field = np.column_stack([sx, sy]).ravel()
    # The operators act on the free freedoms; the base line is fixed, so elements there are left out.
    u = system.spread.T @ field
    elements = (operators.elements @ u).reshape(-1, 3)
    corners = wall.mesh.p[:, wall.mesh.t]
    centre = corners.mean(axis=1)
    inside = corners[1].min(axis=0) > 0.01
    assert elements[inside, 1] == pytest.approx(level + slope * centre[0, inside], rel=1e-9)
    assert np.abs(elements[inside][:, [0, 2]]).max() < 1e-6 * e
    cells = (operators.cells @ u).reshape(-1, 3)
    high = operators.cell_height > 1.0
    if shape is Shape.LINEAR:
        assert cells[high, 1] == pytest.approx(e / 2, rel=1e-9)
    else:
        # Elements cut by the cell's edge lend it their mean: within a few per cent on this coarse mesh.
        assert cells[high, 1] == pytest.approx(e * 0.25 / 2, rel=0.1)


def test_cells_have_one_at_the_contact():
    model = WallModel(mesh=Mesh(0.5), striker=Striker(height=13.1))
    wall = build_mesh(model)
    heights = stress_operators(model, wall, assemble(model, wall)).cell_height
    assert np.abs(heights - 13.1).min() < 1e-12
    assert heights.min() >= 0.25
    assert heights.max() <= 14.75
