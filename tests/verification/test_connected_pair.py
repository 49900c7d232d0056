"""Permanent connectors (eq. 10): linear, so exact stepping tells every digit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, FOUNDATION, links, oscillator, shake, shear_building, still
from tests.reference.exponential import march

pytestmark = pytest.mark.usefixtures("exact_steps_and_series")


@pytest.mark.parametrize("foundation", [None, FOUNDATION])
def test_connected_group_against_exact_stepping(foundation):
    """Three buildings, connected at two floors a pair. Fails if a connector opens in tension."""
    group = [shear_building(t, n, foundation) for t, n in ((0.6, 4), (0.36, 3), (0.5, 3))]
    bridges = (*links("connector", 0.05, (2, 3)), *links("connector", 0.05, (1, 3), left=1))
    scene = Scene(tuple(group), bridges, shake(1.5), ELASTIC)
    _, u, v = march(scene)
    found, place = solve(scene, 1e-12), 0
    for building, (end, rate) in zip(group, found.final, strict=True):
        span = slice(place, place + building.storeys)
        assert end == pytest.approx(u[-1, span], abs=1e-9 * np.abs(u).max())
        assert rate == pytest.approx(v[-1, span], abs=1e-9 * np.abs(v).max())
        place += building.storeys + (2 if foundation else 0)
    assert found.links.impacts.tolist() == [0, 0, 0, 0]
    assert found.links.contact_time == pytest.approx(np.full(4, 1.5), rel=1e-12)


def test_two_free_masses_on_a_connector():
    """Undamped, w = sqrt(s / m'): force amplitude v0 sqrt(s m'), back at rest relative speed after half a
    period.

    Fails if the connector acts beyond its gap only.
    """
    m1, m2, s, v0 = 2e5, 3e5, 1e8, 0.3
    reduced = m1 * m2 / (m1 + m2)
    half = math.pi * math.sqrt(reduced / s)
    link = Link(0, 1, 1, Connector(0.05, s, 0.0))
    scene = Scene((oscillator(m1, 1e-3), oscillator(m2, 1e-3)), (link,), still(half, half / 16), ELASTIC)
    found = solve(scene, 1e-12, initial=([[0.0], [0.0]], [[v0], [0.0]]))
    assert found.final[1][1][0] - found.final[0][1][0] == pytest.approx(v0, rel=1e-9)
    assert found.links.peak_force[0] == pytest.approx(v0 * math.sqrt(s * reduced), rel=1e-9)
    assert found.links.impulse[0] == pytest.approx(2 * reduced * v0, rel=1e-9)
