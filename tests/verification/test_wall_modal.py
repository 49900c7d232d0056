"""The transient against a second method: condensed to its masses and solved in its modes."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.wall.analysis import strike
from pounding_cli.wall.assembly import assemble
from pounding_cli.wall.mesh import build_mesh
from pounding_cli.wall.model import Bond, Contact, Mesh, Shape, Time, WallModel


@pytest.mark.parametrize("shape", list(Shape))
def test_glued_force_against_modes(shape):
    model = WallModel(mesh=Mesh(0.5, 0.0, shape), contact=Contact(bond=Bond.GLUED), time=Time(0.06, 2e-5, 1.0))
    found = strike(model)
    system = assemble(model, build_mesh(model))
    k = system.K.toarray()
    # The striker as one more freedom on a stiff spring would be a third model; here the contact is exact:
    # u = A F p for massless freedoms, so eliminate them with the constraint p.u = x by Lagrange's multiplier.
    n = k.shape[0]
    kkt = np.zeros((n + 2, n + 2))
    kkt[:n, :n] = k
    kkt[:n, n + 1] = -system.p
    kkt[n + 1, :n] = -system.p
    kkt[n, n + 1] = kkt[n + 1, n] = 1.0
    mass = np.concatenate([system.M, [model.striker.mass], [0.0]])
    heavy, light = np.flatnonzero(mass > 0), np.flatnonzero(mass == 0)
    inner = np.linalg.solve(kkt[np.ix_(light, light)], kkt[np.ix_(light, heavy)])
    condensed = kkt[np.ix_(heavy, heavy)] - kkt[np.ix_(heavy, light)] @ inner
    root = np.sqrt(mass[heavy])
    squares, shapes = np.linalg.eigh(condensed / np.outer(root, root))
    w = np.sqrt(np.clip(squares, 1e-12, None))
    start = np.zeros(heavy.size)
    start[heavy == n] = model.striker.speed
    amplitude = shapes.T @ (root * start) / w
    motion = (shapes / root[:, None]) @ (amplitude[:, None] * np.sin(np.outer(w, found.transient.time)))
    multiplier = -(inner @ motion)[light == n + 1][0]
    assert found.transient.force == pytest.approx(-multiplier, abs=2e-4 * found.peak_force) or (
        found.transient.force == pytest.approx(multiplier, abs=2e-4 * found.peak_force)
    )
