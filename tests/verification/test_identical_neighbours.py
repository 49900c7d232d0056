"""Two identical buildings in touch never press: V / V0 is exactly 1, simulated and by proof."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.solve.groups import GroupSolver
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, links, shake, shear_building


def by_kernel(scene):
    return solve(scene, 1e-9, all_effects=True)


def by_proof(scene):
    return GroupSolver(lambda part, watch: solve(part, 1e-9, watch=watch), solve, 1e-9)(scene)


@pytest.mark.parametrize("solved", [by_kernel, by_proof])
@pytest.mark.parametrize("foundation", [None, FOUNDATION])
@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize(("kind", "gap"), [("pounding", 0.0), ("infill", 0.05)])
def test_identical_buildings_never_press(kind, gap, analysis, foundation, solved):
    """Equal to the last bit, not nearly. Fails if a touching pair is taken for pressing."""
    building = shear_building(0.36, 5, foundation)
    scene = Scene((building, building), links(kind, gap, (1, 2, 3, 4, 5)), shake(1.5), analysis)
    linked, alone = solved(scene), solved(scene.alone(0))
    for place in (0, 1):
        assert np.array_equal(linked.buildings[place].shear, alone.buildings[0].shear)
        assert np.array_equal(linked.buildings[place].ductility, alone.buildings[0].ductility)
    assert alone.buildings[0].shear.min() > 0
    assert linked.links.peak_force.tolist() == [0.0] * 5
    assert linked.links.impulse.tolist() == [0.0] * 5
