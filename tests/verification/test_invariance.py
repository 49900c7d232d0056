"""The ratios do not depend on the unit of mass; elastic and touching, nor on the size of the motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, changed, gather, pair, shake


@pytest.mark.parametrize(
    ("kind", "gap", "law"),
    [
        ("pounding", 0.004, {}),
        ("infill", 0.01, {}),
        ("infill", 0.01, {"tension_cut": True}),
        ("connector", 0.05, {}),
    ],
)
@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
def test_masses_stiffnesses_and_forces_times_a_thousand(kind, gap, law, analysis):
    """Same drifts, forces x 1000. Fails if a dashpot goes as s sqrt(m') or a tolerance is in newtons."""
    scene = pair(kind, gap, shake(0.8), analysis, FOUNDATION, **law)
    heavy = {name: getattr(FOUNDATION, name) * 1000 for name in (
        "mass", "sway_stiffness", "sway_damping", "inertia", "rocking_stiffness", "rocking_damping",
    )}  # fmt: skip
    buildings = tuple(
        replace(b, mass=b.mass * 1000, stiffness=b.stiffness * 1000, yield_shear=b.yield_shear * 1000,
                foundation=replace(FOUNDATION, **heavy))
        for b in scene.buildings
    )  # fmt: skip
    bridges = tuple(
        changed(e, **{name: 1000 * getattr(e.law, name) for name in e.law.parameters() if name.endswith("stiffness")})
        for e in scene.links
    )
    light = solve(scene, 1e-12)
    massive = solve(replace(scene, buildings=buildings, links=bridges), 1e-12)
    assert gather(massive, "shear") == pytest.approx(1000 * gather(light, "shear"), rel=1e-9)
    for name in ("ductility", "acceleration", "displacement_max"):
        assert gather(massive, name) == pytest.approx(gather(light, name), rel=1e-9), name
    assert massive.links.peak_force == pytest.approx(1000 * light.links.peak_force, rel=1e-8)
    assert massive.links.contact_time == pytest.approx(light.links.contact_time, rel=1e-9)


@pytest.mark.parametrize(("kind", "gap"), [("connector", 0.05), ("pounding", 0.0)])
def test_elastic_touching_group_is_linear_in_the_motion(kind, gap):
    """Elastic and touching, the law is the same at every size: twice the motion, twice the response.

    Fails if contact needs more than v > 0.
    """
    scene = pair(kind, gap, shake(0.8))
    one = solve(scene, 1e-12)
    two = solve(replace(scene, motion=scene.motion.scaled(2.0)), 1e-12)
    for name in ("shear", "acceleration"):
        assert gather(two, name) == pytest.approx(2 * gather(one, name), rel=1e-9), name
    assert two.links.impacts.tolist() == one.links.impacts.tolist()
    assert np.all(one.links.peak_force > 0)
