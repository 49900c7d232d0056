"""Modes of founded buildings, against closed forms and the energies they must reproduce."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.model.building import Building
from pounding_cli.model.foundation import Foundation
from tests.reference.modes import matrices, modes


def building(foundation, n=3):
    return Building(
        "b", np.full(n, 2e5), np.linspace(3, 4, n), np.linspace(2e8, 1e8, n), np.full(n, 1e6),
        np.full(n, 0.05), 0.7, 2e-3, foundation,
    )  # fmt: skip


FOUNDATION = Foundation(1e5, 8e8, 3e6, 4e6, 3e10, 5e7)


def test_fixed_base_has_the_building_s_own_periods():
    """Fails if the base's column is kept on a fixed base."""
    assert modes(building(None)).periods == pytest.approx(building(None).periods, rel=1e-12)


def test_one_storey_on_sway_and_rocking_springs():
    """A floor on three springs in series, massless base nearly: 1/K = 1/k + 1/kh + h^2/kr.

    Fails if the rocking lever is taken as the storey's number.
    """
    light = Foundation(1e-3, 3e8, 0.0, 1e-3, 5e9, 0.0)
    h = building(light, 1).height[0]
    flexibility = 1 / 2e8 + 1 / 3e8 + h**2 / 5e9
    assert modes(building(light, 1)).periods[0] == pytest.approx(2 * math.pi * math.sqrt(2e5 * flexibility), rel=1e-8)


def test_energies_of_a_random_motion():
    """q^T K q / 2 and q'^T C q' storey by storey. Fails if C acts on u and not on the deformation."""
    b = building(FOUNDATION)
    system = matrices(b)
    q = np.random.default_rng(3).normal(size=5)
    deformation = q[:3] - q[3] - b.elevation * q[4]
    drift = np.diff(deformation, prepend=0.0)
    stored = b.stiffness @ drift**2 + 8e8 * q[3] ** 2 + 3e10 * q[4] ** 2
    lost = 0.7 * b.mass @ deformation**2 + 2e-3 * b.stiffness @ drift**2 + 3e6 * q[3] ** 2 + 5e7 * q[4] ** 2
    assert q @ system.stiffness @ q == pytest.approx(stored, rel=1e-12)
    assert q @ system.damping @ q == pytest.approx(lost, rel=1e-12)
    assert np.linalg.eigvalsh(system.damping).min() > 0
    assert system.loaded.tolist() == [2e5, 2e5, 2e5, 1e5, 0.0]


def test_only_the_motions_that_exist_have_coordinates():
    """Fails if a rigid direction keeps its coordinate."""
    sway, rock = (
        Foundation(1e5, 8e8, rocks=False),
        Foundation(inertia=4e6, rocking_stiffness=3e10, sways=False),
    )
    assert matrices(building(sway)).loaded.tolist() == [2e5, 2e5, 2e5, 1e5]
    assert matrices(building(rock)).loaded.tolist() == [2e5, 2e5, 2e5, 0.0]
