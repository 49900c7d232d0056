"""What `method: auto` and `accuracy: auto` rest on, measured again on the paper's scenes."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve import solve
from pounding_cli.study import expand, load_study
from pounding_cli.study.digits import COSTS, WORTH, cheap_accuracy
from tests.helpers.scenes import shear_building

CONFIGS = Path(__file__).parents[2] / "configs"


def test_costs_of_digits_are_those_of_the_figures():
    """Taylor orders over those at 1e-3, within 5 %: counts, not times. Fails if a digit more asked brings less or more
    than a digit's orders."""
    orders = dict.fromkeys((1e-3, 1e-6, 1e-9, 1e-12), 0)
    for figure in ("fig6", "fig7"):
        plan = expand(load_study(CONFIGS / f"{figure}.yaml"))
        for row in plan.rows:
            if row.record in ("elcentro", "taft"):
                scene = plan.scenes[row.scene]
                for accuracy in orders:
                    orders[accuracy] += solve(scene, accuracy, method="taylor").orders
    for accuracy, counted in orders.items():
        assert counted / orders[1e-3] == pytest.approx(COSTS[accuracy], rel=0.05), accuracy
    assert cheap_accuracy() == 1e-6
    assert COSTS[1e-7] > WORTH


def test_exact_steps_are_taken_where_they_pay_and_only_there():
    """A building alone, as long as nothing yields; a connected pair and a tall building are cheaper by series. Fails if
    the size of a scene, or of its time step against its periods, is left out of the choice."""
    plan = expand(load_study(CONFIGS / "fig6.yaml"))
    baselines = {digest for row in plan.rows for digest in row.baselines}
    methods = {
        (digest in baselines and scene.analysis is Analysis.ELASTIC, solve(scene).method)
        for digest, scene in plan.scenes.items()
    }
    assert methods == {(True, "exponential"), (False, "taylor")}
    motion = next(iter(plan.scenes.values())).motion
    for storeys, dt, taken in (
        (2, 0.01, "exponential"),
        (2, 0.1, "exponential"),
        (2, 0.2, "taylor"),
        (5, 0.01, "exponential"),
        (6, 0.01, "taylor"),
    ):
        slower = dataclasses.replace(motion, dt=dt)
        alone = Scene((shear_building(0.1 * storeys, storeys),), (), slower, Analysis.ELASTIC)
        assert solve(alone).method == taken, (storeys, dt)
