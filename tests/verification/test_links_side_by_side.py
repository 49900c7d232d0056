"""Several links between the same two floors."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.laws.hertz import HertzDamp
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.links import Link
from pounding_cli.solve import solve
from pounding_cli.study import expand, load_study


@pytest.fixture(scope="module")
def pair():
    """Buildings of Fig. 6 a gap apart, elastic, without links; the gap [m] and the impact stiffness [N/m]."""
    plan = expand(load_study(Path("configs/fig6.yaml")))
    scene = next(s for s in plan.scenes.values() if s.links and s.links[0].kind == "pounding" and s.links[0].gap > 0)
    law = scene.links[0].law
    return dataclasses.replace(scene, links=()), law.gap, law.stiffness


def joined(scene, *laws):
    floors = range(1, min(building.storeys for building in scene.buildings) + 1)
    return dataclasses.replace(scene, links=tuple(Link(0, floor, floor, law) for law in laws for floor in floors))


def drifts(run):
    return np.concatenate([building.drift for building in run.buildings])


@pytest.mark.parametrize("method", ["taylor", "exponential", "rk4-events", "newmark"])
def test_springs_side_by_side_add_up(pair, method):
    """Two springs are as stiff as their sum. Fails if a floor keeps one of its links."""
    scene, _, _ = pair
    told = {"time_step": 5e-4} if method in ("rk4-events", "newmark") else {}
    one = solve(joined(scene, Connector(0.0, 3e7, 0.0)), 1e-9, method, **told)
    two = solve(joined(scene, Connector(0.0, 1e7, 0.0), Connector(0.0, 2e7, 0.0)), 1e-9, method, **told)
    assert drifts(two) == pytest.approx(drifts(one), rel=1e-11)
    half = len(two.links.peak_force) // 2
    assert two.links.peak_force[half:] == pytest.approx(2 * two.links.peak_force[:half], rel=1e-11)
    assert two.links.peak_force[:half] + two.links.peak_force[half:] == pytest.approx(one.links.peak_force, rel=1e-11)


def test_floors_strike_beside_a_connector(pair):
    """Two methods, which share no series; energy; nothing is left out, so nothing is flagged. Fails if a connector
    beside pounding is said to leave the blow out."""
    scene, gap, stiffness = pair
    both = joined(scene, Connector(0.0, 1e7, 0.1), Pounding(gap, stiffness, 0.2))
    taylor = solve(both, 1e-10, "taylor")
    other = solve(both, method="rk4-events", time_step=1e-4)
    assert taylor.links.impacts.sum() > 0
    assert abs(taylor.energy["residual"]) < 1e-10
    assert drifts(other) == pytest.approx(drifts(taylor), rel=1e-6)
    assert not taylor.flags
    assert solve(joined(scene, Connector(gap / 10, 1e7, 0.1)), 1e-6).flags


def test_a_written_force_beside_a_table(pair):
    scene, gap, _ = pair
    run, finer = (
        solve(joined(scene, Connector(0.0, 1e7, 0.1), HertzDamp(gap, 1e10, 0.5)), accuracy, "taylor")
        for accuracy in (1e-6, 1e-11)
    )
    assert run.links.impacts.sum() > 0
    assert drifts(run) == pytest.approx(drifts(finer), rel=1e-6)
    assert abs(run.energy["residual"]) < 1e-8


def test_two_alike_are_refused(pair):
    scene, gap, stiffness = pair
    with pytest.raises(ValueError, match="two pounding links alike between floors 1 and 1"):
        joined(scene, Pounding(gap, stiffness, 0.2), Pounding(gap, stiffness, 0.2))
