"""The closed form of Fig. 4 against the time-history solver under a long sine, grown slowly."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.connector.oscillators import Oscillators, response_ratios
from pounding_cli.laws.connector import Connector
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import solve

XI = 0.15


def building(name: str, mass: float, stiffness: float, zeta: float) -> Building:
    damping = 2 * zeta * math.sqrt(stiffness * mass)
    one = np.ones(1)
    return Building(
        name,
        mass=mass * one,
        height=3 * one,
        stiffness=stiffness * one,
        yield_shear=np.inf * one,
        hardening=0.05 * one,
        alpha=0.5 * damping / mass,
        beta=0.5 * damping / stiffness,
    )


def sine(omega: float) -> Motion:
    """400 cycles of growth without a kink, 20 of steady sine; 40 samples a cycle."""
    cycles = np.arange(0, 420, 1 / 40)
    growth = np.where(cycles < 400, 0.5 - 0.5 * np.cos(np.pi * cycles / 400), 1.0)
    return Motion("sine", 2 * math.pi / omega / 40, growth * np.sin(2 * math.pi * cycles))


@pytest.mark.parametrize("xi", [0.0, XI])
@pytest.mark.parametrize("ratio", [0.4, 0.70, 0.9, 1.14, 1.5])
def test_steady_state(ratio, xi):
    k1 = 200e3 * (2 * math.pi / 0.5) ** 2
    m2 = 300e3
    k2, k = 0.36 * k1 * 1.5, 0.2 * k1
    dashpot = 2 * xi * math.sqrt(k * 200e3 * m2 / (200e3 + m2))
    pair = Oscillators(200e3, m2, k1, k2, 0.05, 0.08, k, dashpot)
    link = Link(0, 1, 1, Connector(gap=10.0, stiffness=k, damping_ratio=xi))
    buildings = (building("first", 200e3, k1, 0.05), building("second", m2, k2, 0.08))
    scene = Scene(buildings, (link,), sine(ratio * pair.omega10), Analysis.ELASTIC)
    joined = solve(scene, accuracy=1e-9)
    expected = response_ratios(pair, np.array([ratio * pair.omega10]))
    for place in (0, 1):
        alone = solve(scene.alone(place), accuracy=1e-9).buildings[0]
        found = joined.buildings[place].displacement_max[0] / alone.displacement_max[0]
        assert found == pytest.approx(abs(expected[place][0]), rel=1e-3)
