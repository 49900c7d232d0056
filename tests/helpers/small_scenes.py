"""Small scenes of every effect: two and three storeys side by side for one second."""

from __future__ import annotations

import numpy as np

from pounding_cli.laws import link_laws
from pounding_cli.model.building import Building
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion


def small(kind: str, analysis: Analysis = Analysis.ELASTIC, foundation: Foundation | None = None, **law) -> Scene:
    """A stiff building of three storeys left of a soft one of two, linked at both common floors."""
    t = 0.02 * np.arange(51)
    shaking = 5.0 * np.sin(2 * np.pi * 2.3 * t) * np.sin(np.pi * t) + 2.0 * np.sin(2 * np.pi * 7.1 * t)
    buildings = []
    for name, storeys, stiffness in (("stiff", 3, 2.5e8), ("soft", 2, 5e7)):
        ones = np.ones(storeys)
        yields = (1.0 / 400 if name == "stiff" else 1.0 / 100) * stiffness * ones
        buildings.append(
            Building(name, 2e5 * ones, 3 * ones, stiffness * ones, yields, 0.05 * ones, 0.4, 0.002, foundation)
        )
    links = ()
    if kind != "none":
        stiffness = 5e9 if kind == "pounding" else 5e7
        gap = 0.0 if kind == "pounding" else 0.01
        if kind == "infill":
            law["impact_stiffness"] = 5e9
        same = link_laws()[kind](gap=gap, stiffness=stiffness, damping_ratio=0.2, **law)
        links = tuple(Link(0, floor, floor, same) for floor in (1, 2))
    return Scene(tuple(buildings), links, Motion("sines", 0.02, shaking), analysis)


FOUNDATION = Foundation(2e5, 1e9, 1e7, 1e7, 1e10, 1e8)

SCENES = {
    "elastic": small("pounding"),
    "yielding": small("pounding", Analysis.INELASTIC),
    "cut": small("pounding", Analysis.INELASTIC, tension_cut=True),
    "infill": small("infill", Analysis.INELASTIC),
    "connected": small("connector", Analysis.INELASTIC),
    "founded": small("pounding", Analysis.INELASTIC, FOUNDATION),
    "alone": small("none"),
}
