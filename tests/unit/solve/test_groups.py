"""What a row that falls apart costs: groups of several buildings are booked once, with the row they were solved for."""

from __future__ import annotations

import dataclasses
from collections import Counter

import pytest

from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve import solve
from pounding_cli.solve.groups import GroupSolver
from tests.helpers.five_storeys import motion, pair, pounding


def row(far: float) -> Scene:
    """Three buildings, the first two touching, the third `far` away [m]."""
    stiff, soft = pair()
    near = pounding((stiff, soft, stiff), 0.0)
    joined = [
        dataclasses.replace(link, law=dataclasses.replace(link.law, gap=far)) if link.left else link for link in near
    ]
    return Scene((stiff, soft, stiff), tuple(joined), motion(), Analysis.INELASTIC)


@pytest.mark.parametrize(("far", "whole"), [(1.0, 0), (0.001, 1)])
def test_groups_on_the_way_are_paid_for_once(far, whole):
    """A row that falls apart, and one that is solved whole after its groups showed that they meet.

    Fails if the two that touch, or the run that shows how far the third keeps from them, cost nothing or cost the next
    row again; if a building alone is booked twice; or if a gap that the samples show to close is looked into."""
    solved: Counter[int | str] = Counter()

    def respond(scene, watch):
        solved[len(scene.buildings)] += 1
        return dataclasses.replace(solve(scene, 1e-6, watch=watch), seconds=10.0 ** len(scene.buildings))

    def free(scene, accuracy):
        solved[f"free {len(scene.buildings)}"] += 1
        return dataclasses.replace(solve(scene, accuracy), seconds=0.5)

    solver = GroupSolver(respond, free, 1e-6)
    first, second = solver(row(far)), solver(row(far + 1e-6))
    assert solved == Counter({1: 1, 2: 1, 3: 2 * whole, "free 3": 1 - whole})
    assert first.seconds == 100.0 + (1000.0 if whole else 0.5)
    assert second.seconds == 1000.0 * whole


@pytest.mark.parametrize(("estimated", "runs"), [("bounded", 1), ("", 2)])
def test_a_run_that_tells_the_error_of_closings_needs_no_finer_one(estimated, runs):
    """Fails if the bound is left out of the row's error, or if a finer run follows all the same."""
    asked = []

    def free(scene, accuracy):
        asked.append(accuracy)
        return dataclasses.replace(solve(scene, accuracy), error_estimate=7e-7, estimated=estimated)

    def respond(scene, watch):
        return dataclasses.replace(solve(scene, 1e-6, watch=watch), error_estimate=1e-9)

    solver = GroupSolver(respond, free, 1e-6, lambda scene: True)
    found = solver(Scene(pair(), pounding(pair(), 1.0), motion(), Analysis.INELASTIC))
    assert (found.error_estimate == 7e-7) is (runs == 1)
    assert found.error_estimate <= 1e-6
    assert len(asked) == runs
