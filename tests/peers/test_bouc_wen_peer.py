"""Bouc-Wen storeys against OpenSees' `BoucWen`, whose z is taken through a step by Euler's implicit rule: order 1."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.laws.bouc_wen import BoucWen
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import INELASTIC, shake, shear_building

pytest.importorskip("openseespy.opensees", reason="openseespy is not installed (pip install -e .[peers])")


@pytest.mark.parametrize(("n", "gamma"), [(1, 0.5), (2, 0.5), (3, -0.5), (2, 0.9)])
def test_three_storeys(n, gamma):
    """Drifts and shears come nearer as the step, and what two steps say of the limit is ours. Fails if gamma and beta
    change places, or n is another."""
    from opensees import march

    parameters = ("wen_exponent", n), ("wen_gamma", gamma)
    building = dataclasses.replace(shear_building(0.4, 3), storey_law=BoucWen, law_parameters=parameters)
    scene = Scene((building,), (), shake(6.0, 3.0), INELASTIC)
    own = solve(scene, 1e-11).buildings[0]
    assert own.ductility.max() > 10
    coarse, fine = (march(scene, dt) for dt in (5e-4, 2.5e-4))
    for name in ("drift", "shear"):
        exact, one, two = getattr(own, name), getattr(coarse, name), getattr(fine, name)
        off = [np.abs(found / exact - 1).max() for found in (one, two)]
        assert off[1] < 4e-3
        assert 0.4 < off[1] / off[0] < 0.6
        assert np.abs((2 * two - one) / exact - 1).max() < 1e-4
