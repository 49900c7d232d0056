"""Wall and frame together: against scikit-fem's own elasticity, beam theory and sums of masses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementVector
from skfem.models.elasticity import lame_parameters, linear_elasticity

from pounding_cli.wall.assembly import assemble, wall_end, wall_stiffness
from pounding_cli.wall.mesh import build_mesh
from pounding_cli.wall.model import Concrete, Contact, Frame, Mesh, Over, Section, Shape, Striker, WallModel

SHAPES = pytest.mark.parametrize("shape", list(Shape))


@SHAPES
def test_wall_stiffness_against_the_librarys_elasticity(shape):
    model = WallModel(mesh=Mesh(1.0, 0.0, shape))
    wall = build_mesh(model)
    basis = Basis(wall.mesh, ElementVector(wall.basis.elem), intorder=4)
    young, nu = model.concrete.young, model.concrete.poisson
    lam, mu = lame_parameters(young, nu)
    lam = 2 * lam * mu / (lam + 2 * mu)  # plane strain to plane stress
    theirs = model.thickness * linear_elasticity(lam, mu).assemble(basis)
    ours = wall_stiffness(wall, model.concrete)
    field = np.random.default_rng(1).normal(size=(2, wall.nodes.shape[1]))
    theirs_vector = basis.zeros()
    ours_vector = field.T.ravel()
    # The library numbers the two components its own way: match the freedoms by place and direction.
    for kind in ("nodal_dofs", "facet_dofs", "interior_dofs"):
        single, double = getattr(wall.basis, kind), getattr(basis, kind)
        for i in range(single.shape[0]):
            for axis in (0, 1):
                theirs_vector[double[2 * i + axis]] = field[axis, single[i]]
    assert ours_vector @ (ours @ ours_vector) == pytest.approx(theirs_vector @ (theirs @ theirs_vector), rel=1e-12)


def lonely_wall(shape: Shape = Shape.QUADRATIC, height: float = 14.9) -> WallModel:
    """The wall with a frame that weighs nothing in its stiffness."""
    thin = Section(1e-4, 1e-4)
    return WallModel(frame=Frame(beam=thin, column=thin), striker=Striker(height=height), mesh=Mesh(0.25, 0.0, shape))


def test_wall_alone_is_a_timoshenko_cantilever():
    model = lonely_wall()
    wall = build_mesh(model)
    system = assemble(model, wall)
    moved = spsolve(system.K, system.p * 1e6)
    a, e, g = 14.9, 30e9, 30e9 / 2.4
    inertia, area = 0.25 * 2**3 / 12, 0.5
    # At the inner edge, away from the local indentation under the patch.
    at = np.argmin(np.hypot(wall.nodes[0] - 2.0, wall.nodes[1] - 14.9))
    deflection = (system.spread @ moved)[2 * at]
    assert deflection == pytest.approx(1e6 * (a**3 / (3 * e * inertia) + a / (5 / 6 * g * area)), rel=3e-3)


def test_masses():
    model = WallModel(concrete=Concrete(density=2500.0), mesh=Mesh(0.5, 0.1))
    system = assemble(model, build_mesh(model))
    fixed_share = 2500 * 0.25 * 2 * model.frame.storey_height * 5
    assert system.M.min() >= 0
    # Both directions; the wall's fixed base line carries the mass that cannot move.
    assert 2 * 1e6 < system.M.sum() < 2 * (1e6 + fixed_share)
    no_density = assemble(replace(model, concrete=Concrete()), build_mesh(model))
    assert no_density.M.sum() == pytest.approx(2 * 1e6, rel=1e-12)


@pytest.mark.parametrize("over", list(Over))
def test_struck_freedoms_are_massless(over):
    model = WallModel(
        striker=Striker(height=12.0),
        contact=Contact(over=over),
        mesh=Mesh(0.25),
        concrete=Concrete(density=2500),
    )
    system = assemble(model, build_mesh(model))
    assert system.M[system.p != 0] == pytest.approx(0.0)
    assert system.p.sum() == pytest.approx(1.0)


def test_stiffness_is_symmetric_and_definite():
    model = WallModel(mesh=Mesh(1.0))
    k = assemble(model, build_mesh(model)).K.toarray()
    assert np.abs(k - k.T).max() < 1e-9 * np.abs(k).max()
    assert np.linalg.eigvalsh(k).min() > 0


def test_frame_alone_is_a_portal():
    """Behind a very stiff wall: a column fixed at its foot, held by the beam at its head."""
    section = Section(0.5, 0.5)
    frame = Frame(storeys=1, storey_height=4.0, bays=(6.0,), beam=section, column=section)
    model = WallModel(
        frame=frame,
        thickness=1e6,
        length=2.0,
        averaging_length=0.5,
        striker=Striker(height=2.0),
        mesh=Mesh(1.0),
    )
    system = assemble(model, build_mesh(model))
    e, a, i = 30e9, 0.25, 0.5**4 / 12
    head = np.array(
        [
            [e * a / 6 + 12 * e * i / 4**3, 0, 6 * e * i / 4**2],
            [0, e * a / 4 + 12 * e * i / 6**3, -6 * e * i / 6**2],
            [6 * e * i / 4**2, -6 * e * i / 6**2, 4 * e * i / 4 + 4 * e * i / 6],
        ]
    )
    load = np.array([1e4, -2e4, 3e4])
    force = np.zeros(system.M.size)
    force[-3:] = load
    assert spsolve(system.K, force)[-3:] == pytest.approx(np.linalg.solve(head, load), rel=1e-4)


@SHAPES
def test_a_beam_end_follows_rigid_motions_of_the_wall(shape):
    model = WallModel(mesh=Mesh(0.5, 0.0, shape))
    wall = build_mesh(model)
    x, y = wall.nodes
    end = wall_end(wall, 12.0, 2.0, 2 * x.size)
    turned = np.column_stack([0.3 - 0.01 * (y - 12.0), 0.2 + 0.01 * x]).ravel()
    assert end @ turned == pytest.approx([0.3, 0.2 + 0.01 * 2.0, 0.01])
