"""Slabs against columns where that is hardest: next to a floor, on next to no columns, in chains of ten."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.meetings import column_flexibility
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import solve


def building(number: int, storeys: int = 3, columns: float = 0.2) -> Building:
    """A row of these has periods of its own each."""
    ones = np.ones(storeys)
    stiffness = 3e8 * (1 + 0.3 * np.sin(7.0 * number)) * np.linspace(1.0, 0.5, storeys)
    return Building(
        f"b{number}", 2e5 * ones, 3 * ones, stiffness, 0.01 * stiffness, 0.05 * ones, 0.5, 1e-3, columns=columns
    )


def shake(duration: float) -> Motion:
    noise = np.convolve(np.random.default_rng(4).normal(size=round(duration / 0.02) + 8), np.hanning(9)[1:-1], "valid")
    noise[0] = 0.0
    return Motion("noise", 0.02, 5.0 * noise / np.abs(noise).max())


def row(count: int, at: float, gap: float, columns: float = 0.2, duration: float = 2.0) -> Scene:
    """Slabs of every building strike columns of the next one at `at` of their height, and the other way about."""
    buildings = tuple(building(n, columns=columns) for n in range(count))
    links = []
    for left in range(count - 1):
        for storey in (2, 3):
            struck = left + (storey == 2)
            s = 1 / (1 / 6e9 + column_flexibility(buildings[struck], storey, at))
            ends = (1.0, at) if storey == 2 else (at, 1.0)
            floors = (storey - 1, storey) if storey == 2 else (storey, storey - 1)
            links.append(Link(left, *floors, Pounding(gap, s, 0.2), *ends, columns))
    return Scene(buildings, tuple(links), shake(duration), Analysis.INELASTIC)


def judged(scene: Scene) -> None:
    """Fails if a run does not end, loses energy, or finer steps tell another shear."""
    fine, coarse = solve(scene, 1e-11), solve(scene, 1e-6)
    for found in (fine, coarse):
        assert found.status == "done"
        assert abs(found.energy["residual"]) < 1e-8
    assert fine.links.impacts.sum() > 0
    for name in ("shear_below", "shear_above"):
        assert getattr(coarse.columns, name) == pytest.approx(getattr(fine.columns, name), rel=1e-6)


@pytest.mark.parametrize("gap", [0.0, 0.005])
@pytest.mark.parametrize("at", [0.001, 0.5, 0.999])
def test_next_to_a_floor(at, gap):
    """At 0.1 % of a first storey on the ground the struck point is heavier than the building by eleven orders."""
    judged(row(2, at, gap))
    scene = row(2, at, gap)
    ground = replace(scene.links[0], left_floor=1, right_floor=1)
    judged(replace(scene, links=(ground,)))


@pytest.mark.parametrize("columns", [1e-6, 1.0])
def test_next_to_no_columns_and_all_of_them(columns):
    judged(row(2, 0.4, 0.002, columns))


@pytest.mark.parametrize("gap", [0.0, 0.004])
def test_chains_of_ten(gap):
    judged(row(10, 0.3, gap, duration=1.0))
