"""Bouc-Wen storeys against OpenSees' `BoucWen`, whose z is taken through a step by Euler's implicit rule: order 1."""

from __future__ import annotations

import numpy as np
import pytest

from tests.adapter import Scene, solve
from tests.peers.scenes import building
from tests.physics.cases import shake

pytest.importorskip("openseespy.opensees", reason="openseespy is not installed (pip install -e .[peers])")


@pytest.mark.parametrize(("n", "gamma"), [(1, 0.5), (2, 0.5), (3, -0.5), (2, 0.9)])
def test_three_storeys(n, gamma):
    """Drifts and shears come nearer as the step, and what two steps say of the limit is ours. Fails if gamma and beta
    change places, or n is another."""
    from opensees import march

    storeys = building(0.4, storey_law="bouc-wen", wen_exponent=n, wen_gamma=gamma)
    scene = Scene([storeys], shake(6.0, 3.0), 0.02, analysis="inelastic")
    own = solve(scene, 1e-11)
    assert own.ductility.max() > 10
    coarse, fine = (march(scene.built, dt) for dt in (5e-4, 2.5e-4))
    for name in ("drift", "shear"):
        exact, one, two = getattr(own, name), getattr(coarse, name), getattr(fine, name)
        off = [np.abs(found / exact - 1).max() for found in (one, two)]
        assert off[1] < 4e-3
        assert 0.4 < off[1] / off[0] < 0.6
        assert np.abs((2 * two - one) / exact - 1).max() < 1e-4
