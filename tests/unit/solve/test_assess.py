"""What `assess` says of a response: error against a finer run, amplification of a small change of the motion."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scenes import motion, pair, pounding

from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve import assess, solve
from pounding_cli.solve.assess import change

ACCURACY = 1e-6


def assessed(scene: Scene):
    return assess(scene, solve(scene, ACCURACY), ACCURACY)


def test_a_linear_scene_has_a_sensitivity_of_one_at_most():
    """A peak at the time t changes by t / T of the nudge, give or take the memory of the building."""
    alone = Scene((pair()[0],), (), motion(), Analysis.ELASTIC)
    assert 0.3 < assessed(alone).sensitivity < 1.1


def test_touching_elastic_buildings_are_judged_by_more_than_their_scale():
    """Without a gap the laws are homogeneous of degree one: a factor on the motion changes nothing but the size."""
    buildings = pair()
    scene = Scene(buildings, pounding(buildings, gap=0.0), motion(), Analysis.ELASTIC)
    stronger = dataclasses.replace(scene, motion=scene.motion.scaled(1 + 1e-6))
    assert change(solve(scene, 1e-9), solve(stronger, 1e-9)) == pytest.approx(1e-6, rel=1e-2)
    assert assessed(scene).sensitivity != pytest.approx(1.0, rel=1e-3)


def test_the_error_is_that_of_the_response_and_not_of_the_finer_run():
    buildings = pair()
    scene = Scene(buildings, pounding(buildings, gap=0.01), motion(), Analysis.INELASTIC)
    coarse = solve(scene, 1e-2)
    found = assess(scene, coarse, 1e-2).error_estimate
    assert found == pytest.approx(change(coarse, solve(scene, 1e-12)), rel=0.1)
    assert found > 10 * assess(scene, solve(scene, 1e-6), 1e-6).error_estimate


@pytest.mark.parametrize(("amplification", "flagged"), [(90.0, False), (110.0, True)])
def test_a_scene_that_hangs_on_a_hair_is_flagged(amplification, flagged):
    """A solver whose shears follow the motion's amplitude more than one to one; the number is found and judged."""
    scene = Scene((pair()[0],), (), motion(), Analysis.ELASTIC)
    first = solve(scene)

    def touchy(nudged: Scene, accuracy: float, method: str):
        stronger = nudged.motion.acceleration[-2] / scene.motion.acceleration[-2] - 1
        building = first.buildings[0]
        shear = building.shear * (1 + amplification * stronger)
        return dataclasses.replace(first, buildings=(dataclasses.replace(building, shear=shear),))

    found = assess(scene, first, ACCURACY, touchy)
    assert found.sensitivity == pytest.approx(amplification, rel=1e-2)
    assert found.error_estimate == 0.0
    assert flagged == any("ill-conditioned" in flag for flag in found.flags)


def test_change_takes_the_worst_storey_and_leaves_out_what_rests():
    scene = Scene((pair()[0],), (), motion(), Analysis.ELASTIC)
    first = solve(scene)
    shear = first.buildings[0].shear * np.array([1.0, 1.02, 1.0, 1.0, 1.0])
    second = dataclasses.replace(first, buildings=(dataclasses.replace(first.buildings[0], shear=shear),))
    assert change(first, second) == pytest.approx(0.02 / 1.02)
    still = Scene((pair()[0],), (), motion().scaled(0.0), Analysis.ELASTIC)
    assert change(solve(still), solve(still)) == 0.0
