"""Rows of ten buildings, solved island by island and as a whole."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import INELASTIC, gather, links, shake, shear_building

PEAKS = ("shear", "drift", "acceleration", "displacement_max", "displacement_min")


def struck(left: int) -> Sequence[Link]:
    """Pounding across 4 mm at every floor between a building and the next."""
    return links("pounding", 0.004, (1, 2, 3, 4), left, stiffness=2e9)


def weaker(building: Building) -> Building:
    """With four fifths of its strength."""
    return dataclasses.replace(building, yield_shear=0.8 * building.yield_shear)


def row_of_ten(
    joints: Callable[[int], Sequence[Link]] = struck, changed: Callable[[Building], Building] = lambda b: b
) -> Scene:
    """Ten buildings of four storeys, each `changed`, with `joints` between each and the next. With fewer storeys, or
    with samples farther apart, hardly any would take steps of its own and be put back."""
    buildings = tuple(changed(shear_building(period, 4)) for period in (0.36, 0.60, 0.30, 0.60, 0.45) * 2)
    joined = tuple(link for left in range(9) for link in joints(left))
    return Scene(buildings, joined, shake(1.0, 6.0, dt=0.01), INELASTIC)


def islands_equal_the_whole(scene: Scene) -> None:
    """The row in islands has the peaks, blows and energies of the row as a whole. Fails if an island that is put back
    forgets some of what its storeys or links remember, or waits without its neighbour."""
    apart, whole = solve(scene, 1e-10), solve(scene, 1e-12, all_effects=True)
    assert apart.status == whole.status == "done"
    assert any(sentence.startswith("the rest of the row") for sentence in apart.dropped)
    assert apart.links.impacts.tolist() == whole.links.impacts.tolist()
    assert whole.links.impacts.sum() > 5
    for name in PEAKS:
        assert gather(apart, name) == pytest.approx(gather(whole, name), rel=1e-7), name
    force = whole.links.peak_force
    assert apart.links.peak_force == pytest.approx(force, rel=1e-7, abs=1e-8 * np.abs(force).max())
    for joule in ("input", "damping", "hysteresis", "links"):
        assert apart.energy[joule] == pytest.approx(whole.energy[joule], abs=1e-8 * whole.energy["input"]), joule
    assert abs(apart.energy["residual"]) < 1e-9
