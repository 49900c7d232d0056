"""The mesh: its lines, its integrals, its gradients."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.wall.mesh import build_mesh, grid_lines
from pounding_cli.wall.model import Mesh, Shape, WallModel

SHAPES = pytest.mark.parametrize("shape", list(Shape))


def test_even_lines():
    assert grid_lines([0.0, 1.0, 1.7], 0.25, 0.0, (0, 0)) == pytest.approx(
        [0, 0.25, 0.5, 0.75, 1.0, 1 + 0.7 / 3, 1 + 1.4 / 3, 1.7]
    )


def test_growing_lines_follow_the_wished_size():
    lines = grid_lines([0.0, 10.0], 0.1, 0.2, (0.0, 0.0))
    middle = 0.5 * (lines[1:] + lines[:-1])
    # A whole number of intervals fits, so all are smaller than wished by one factor.
    factor = np.diff(lines) / (0.1 + 0.2 * middle)
    assert factor == pytest.approx(factor[0], rel=0.01)
    assert 0.9 < factor[0] <= 1.01


@SHAPES
def test_floors_and_patch_edges_are_lines(shape):
    wall = build_mesh(WallModel(mesh=Mesh(0.7, 0.1, shape)))
    for y in (0, 3, 6, 9, 12, 13.4, 13.6, 15):
        assert np.abs(wall.y_lines - y).min() < 1e-12
    assert np.diff(wall.y_lines).max() <= 0.7 + 0.1 * 15


@SHAPES
def test_shares_of_a_floor_line_integrate_a_parabola(shape):
    wall = build_mesh(WallModel(mesh=Mesh(0.5, 0.3, shape)))
    nodes, share = wall.on_line(12.0)
    x = wall.nodes[0, nodes]
    assert share.sum() == pytest.approx(1.0)
    assert share @ x == pytest.approx(1.0)
    if shape is Shape.QUADRATIC:
        assert share @ x**2 == pytest.approx(4 / 3)


@SHAPES
def test_pressure_acts_at_the_middle_of_the_patch(shape):
    wall = build_mesh(WallModel(mesh=Mesh(0.05, 0.3, shape)))
    shares = wall.pressure(13.4, 13.6)
    assert shares.sum() == pytest.approx(1.0)
    assert shares @ wall.nodes[1] == pytest.approx(13.5)
    assert wall.nodes[0, shares != 0] == pytest.approx(0.0)


@SHAPES
def test_gradients_of_a_field_the_elements_hold_exactly(shape):
    wall = build_mesh(WallModel(mesh=Mesh(0.6, 0.2, shape)))
    x, y = wall.nodes
    field = np.column_stack([2 * x - 3 * y, 0.5 * x + 4 * y]).ravel()
    b, area = wall.gradients(wall.basis)
    strains = (b @ field).reshape(-1, 3)
    assert strains == pytest.approx(np.broadcast_to([2.0, 4.0, -2.5], strains.shape))
    assert area.sum() == pytest.approx(30.0)
    if shape is Shape.QUADRATIC:
        bent = np.column_stack([x * y, -(x**2) / 2]).ravel()
        assert ((b @ bent).reshape(-1, 3)[:, 2]) == pytest.approx(0.0, abs=1e-10)


@SHAPES
def test_volume(shape):
    volumes = build_mesh(WallModel(mesh=Mesh(0.6, 0.0, shape))).volume()
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(2 * 15 * 0.25)
