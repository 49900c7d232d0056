"""The mirror image of a group under the reversed motion has the mirrored response."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, links, shake, shear_building


@pytest.mark.parametrize(
    ("kind", "gap", "law"),
    [
        ("pounding", 0.0, {}), ("pounding", 0.005, {"tension_cut": True}), ("infill", 0.01, {}), ("connector",
        0.05, {}),
    ],
)  # fmt: skip
@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
def test_mirrored_group(kind, gap, law, analysis):
    """Buildings of 4, 3 and 5 storeys, one founded, to 1e-10. Fails if a link's sides differ."""
    group = shear_building(0.6, 4), shear_building(0.36, 3, FOUNDATION), shear_building(0.5, 5)
    bridges = (*links(kind, gap, (2, 3), **law), *links(kind, gap, (1, 3), left=1, **law))
    scene = Scene(group, bridges, shake(0.8), analysis)
    turned = tuple(replace(e, left=1 - e.left) for e in reversed(bridges))
    mirror = Scene(group[::-1], turned, scene.motion.scaled(-1.0), analysis)
    one, other = solve(scene, 1e-12), solve(mirror, 1e-12)
    for here, there in zip(one.buildings, other.buildings[::-1], strict=True):
        for name in ("shear", "drift", "acceleration"):
            assert getattr(here, name) == pytest.approx(getattr(there, name), rel=1e-10), name
        assert here.displacement_max == pytest.approx(-there.displacement_min, rel=1e-10)
        assert here.residual_drift == pytest.approx(-there.residual_drift, rel=1e-8, abs=1e-12)
    for name in ("impacts", "peak_force", "max_closing", "impulse", "contact_time"):
        assert getattr(one.links, name) == pytest.approx(np.flip(getattr(other.links, name)), rel=1e-9), name
