"""Two identical buildings in touch never press: V / V0 is exactly 1."""

from __future__ import annotations

import numpy as np
import pytest
from reference.scenes import ELASTIC, FOUNDATION, INELASTIC, links, shake, shear_building

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve


@pytest.mark.parametrize("foundation", [None, FOUNDATION])
@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize(("kind", "gap"), [("pounding", 0.0), ("infill", 0.05)])
def test_identical_buildings_never_press(kind, gap, analysis, foundation):
    """Equal to the last bit, not nearly. Fails if a touching pair is taken for pressing."""
    building = shear_building(0.36, 5, foundation)
    scene = Scene((building, building), links(kind, gap, (1, 2, 3, 4, 5)), shake(1.5), analysis)
    linked, alone = solve(scene, 1e-9), solve(scene.alone(0), 1e-9)
    for place in (0, 1):
        assert np.array_equal(linked.buildings[place].shear, alone.buildings[0].shear)
        assert np.array_equal(linked.buildings[place].ductility, alone.buildings[0].ductility)
    assert alone.buildings[0].shear.min() > 0
    assert linked.links.peak_force.tolist() == [0.0] * 5
    assert linked.links.impulse.tolist() == [0.0] * 5
