"""heyoka, another Taylor integrator with another event location, has to agree to ten digits."""

from __future__ import annotations

import pytest

from tests.adapter import Scene, solve
from tests.peers.scenes import IMPACT, building, pair
from tests.physics.cases import shake

heyoka_scene = pytest.importorskip("heyoka_scene", reason="heyoka is not installed (pip install -e .[peers])")


def agree(scene: Scene) -> None:
    found, expected = solve(scene, 1e-12), heyoka_scene.ElasticScene(scene.built).run()
    assert expected.contacts.sum() > 3
    assert found.impacts.tolist() == expected.contacts.tolist()
    assert found.shear == pytest.approx(expected.shear, rel=1e-10)
    assert found.drift == pytest.approx(expected.drift, rel=1e-10)
    for end, of in ((found.end, expected.displacement), (found.end_velocity, expected.velocity)):
        assert end == pytest.approx(of, abs=1e-10 * abs(of).max())


@pytest.mark.parametrize("gap", [0.0, 0.004])
def test_elastic_pair(gap: float) -> None:
    """Touching or 4 mm apart, 2 s. Fails if a contact is missed, or the dashpot is 1e-9 off."""
    agree(pair({"link": "pounding", "gap": gap}))


def test_row_of_three() -> None:
    """Three buildings of unequal height. Fails if the middle building feels one neighbour only."""
    row = building(0.6, 4), building(0.36, 3), building(0.5, 5)
    agree(Scene(row, shake(1.5), 0.02, {"link": "pounding", "gap": 0.001}, more=IMPACT))
