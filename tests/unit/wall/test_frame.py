"""Frame elements against beam theory."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.wall.frame import edge_stress_rows, local_stiffness, rotation
from pounding_cli.wall.model import Section

E = 30e9
SECTION = Section(0.25, 0.60)


def test_cantilever():
    k = local_stiffness(E, SECTION, 4.0)[3:, 3:]
    u, v, theta = np.linalg.solve(k, [5e4, 1e4, 0.0])
    assert u == pytest.approx(5e4 * 4 / (E * 0.15))
    assert v == pytest.approx(1e4 * 4**3 / (3 * E * 0.25 * 0.6**3 / 12))
    assert theta == pytest.approx(1e4 * 4**2 / (2 * E * 0.25 * 0.6**3 / 12))


def test_edge_stress_of_a_cantilever():
    """Pulled by N, pushed by Q and bent by M at its free end: the fixed end carries M + Q L."""
    rows = edge_stress_rows(E, SECTION, 4.0)
    tip = np.linalg.solve(local_stiffness(E, SECTION, 4.0)[3:, 3:], [3e4, 1e4, 7e3])
    axial, fixed, free = 3e4 / 0.15, (7e3 + 1e4 * 4) / 0.015, 7e3 / 0.015
    expected = [axial + fixed, axial - fixed, axial + free, axial - free]
    assert sorted(rows @ np.concatenate([np.zeros(3), tip])) == pytest.approx(sorted(expected))


@pytest.mark.parametrize("end", [(3.0, 4.0), (0.0, 5.0), (-2.0, 1.0)])
def test_rigid_motions_need_no_force(end):
    turn, length = rotation(np.zeros(2), np.array(end))
    assert length == pytest.approx(np.hypot(*end))
    k = turn.T @ local_stiffness(E, SECTION, length) @ turn
    for motion in ([1, 0, 0, 1, 0, 0], [0, 1, 0, 0, 1, 0], [0, 0, 1, -end[1], end[0], 1]):
        assert np.abs(k @ np.array(motion, dtype=float)).max() < 1e-9 * np.abs(k).max()
