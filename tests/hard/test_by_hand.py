"""Hard scenes whose matrices, dashpots and gaps are written by hand (`by_hand.py`), against the program."""

from __future__ import annotations

import numpy as np
import pytest

import pounding_cli as pound
from tests.adapter import difference, scenes, solve
from tests.reference.assembly import coordinates
from tests.reference.events import integrate

from . import by_hand
from .catalogue import SCENES

PEAKS = "shear", "drift", "acceleration", "displacement_max", "displacement_min", "peak_force", "max_closing", "impulse"
NAMES = pytest.mark.parametrize("name", by_hand.SCENES)
BY_RULE = "foundation-light; touching, inelastic"
"""Its floors touch at rest: how often and how long they do so is defined by a rule (docs/accuracy.md), not compared."""


def find_scene(name: str) -> tuple[pound.Scene, float]:
    """Return the scene that the program makes of a study, and the accuracy asked."""
    study, _, where = name.partition("; ")
    found = [each for each in scenes(SCENES / f"{study}.yaml") if each[1].links and each[0].startswith(where)]
    return found[0][1:]


@NAMES
def test_the_program_reads_the_same_numbers(name: str) -> None:
    """Masses, springs, dashpots, strengths, gaps and samples of the motion. Fails if a unit, a default, a rule of the
    code, a place of a link or the two modes of the damping differ. Isolators are not in the matrices of the built
    scene; the peaks have them."""
    scene, written = find_scene(name)[0], by_hand.SCENES[name]()
    built, hand = coordinates(scene), written.coordinates
    fields = ["mass", "damping", "springs", "loaded", "closing", "travel", "edges"]
    fields += [] if name.startswith("isolated") else ["drift", "stiffness", "yield_drift", "hardening", "storey"]
    for each in fields:
        one, other = getattr(hand, each), getattr(built, each)
        size = np.abs(one[np.isfinite(one)]).max(initial=0.0)
        np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-14 * size, err_msg=each)
    for each in ("gap", "stiffness", "damping_ratio"):
        values = [[getattr(link.law, each) for link in links] for links in (scene.links, written.links)]
        assert values[0] == pytest.approx(values[1], rel=1e-12), each
    assert str(scene.analysis) == written.analysis
    assert scene.motion.dt == written.motion.dt
    np.testing.assert_allclose(scene.motion.acceleration, written.motion.acceleration, rtol=1e-12)


@NAMES
def test_the_integrator_finds_the_same_peaks(name: str) -> None:
    """Within the accuracy asked, between 1e-6 and 1e-8, and within 1e-8 at 1e-12; as many contacts. Fails if the
    assembly or a law of the program is wrong. (Light floors beside heavy ones turn rounding into 2e-9 of the peaks:
    with steps of 0.25, 0.1 and 0.05 radians the integrator itself differs by as much.)"""
    scene, accuracy = find_scene(name)
    written = by_hand.SCENES[name]()
    twists = any(turns.size for turns in written.coordinates.turns)
    expected = integrate(written, per_radian=0.1 if twists else 0.25)
    assert expected.impacts.sum() > 0
    for asked, allowed in ((accuracy, min(max(accuracy, 1e-8), 1e-6)), (1e-12, 1e-8)):
        run = solve(scene, asked)
        assert difference(run, expected, PEAKS) <= allowed
        if name != BY_RULE:
            assert difference(run, expected, ("contact_time",)) <= allowed
            assert run.impacts.tolist() == expected.impacts.tolist()
