"""heyoka, another Taylor integrator with another event location, has to agree to ten digits."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import gather, links, pair, shake, shear_building

heyoka_scene = pytest.importorskip("heyoka_scene", reason="heyoka is not installed (pip install -e .[peers])")


def agree(scene: Scene) -> None:
    found, expected = solve(scene, 1e-12), heyoka_scene.ElasticScene(scene).run()
    assert expected.contacts.sum() > 3
    assert found.links.impacts.tolist() == expected.contacts.tolist()
    assert gather(found, "shear") == pytest.approx(expected.shear, rel=1e-10)
    assert gather(found, "drift") == pytest.approx(expected.drift, rel=1e-10)
    for place, of in ((0, expected.displacement), (1, expected.velocity)):
        end = np.concatenate([pair[place] for pair in found.final])
        assert end == pytest.approx(of, abs=1e-10 * np.abs(of).max())


@pytest.mark.parametrize("gap", [0.0, 0.004])
def test_elastic_pair(gap):
    """Touching or 4 mm apart, 2 s. Fails if a contact is missed, or the dashpot is 1e-9 off."""
    agree(pair("pounding", gap, shake(2.0)))


def test_row_of_three():
    """Three buildings of unequal height. Fails if the middle building feels one neighbour only."""
    group = shear_building(0.6, 4), shear_building(0.36, 3), shear_building(0.5, 5)
    bridges = (*links("pounding", 0.0, (1, 2, 3)), *links("pounding", 0.002, (2, 3), left=1))
    agree(Scene(group, bridges, shake(1.5), Analysis.ELASTIC))
