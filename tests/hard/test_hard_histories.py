"""Histories of hard scenes: stopped two hundred times on its way, the run comes to the same peaks and closes."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.solve import solve
from pounding_cli.solve.histories import history

from .catalogue import studies
from .verdict import scenes_of

STOPS = 200


@pytest.mark.parametrize("study", studies(), ids=lambda s: s.name)
def test_history(study):
    """The first linked scene of each study. Fails if a stopped run forgets a branch, or an event met at the stop."""
    scene = next(scene for _, scene, _ in scenes_of(study.path) if scene.links)
    response = solve(scene, 1e-9)
    found = history(scene, 1e-9, scene.motion.duration / STOPS)
    allowed = max(1e-7, study.expect.sensitive)
    for place, building in enumerate(response.buildings):
        n = building.shear.size
        for values, peaks in (
            (found.shear, building.shear),
            (found.total_acceleration, building.acceleration),
            (found.displacement, np.maximum(building.displacement_max, -building.displacement_min)),
        ):
            assert (np.abs(values[:, place, :n]).max(axis=0) <= peaks * (1 + allowed)).all()
        end, size = found.displacement[-1, place, :n], np.maximum(building.displacement_max, -building.displacement_min)
        np.testing.assert_allclose(end, response.final[place][0], rtol=0, atol=max(allowed, 1e-6) * size.max())
    off = 2 * found.energy["input"] - sum(found.energy.values())
    assert np.abs(off).max() <= study.expect.residual * max(np.abs(values).max() for values in found.energy.values())
