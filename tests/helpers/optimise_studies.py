"""A small study to optimise, and a solver whose residual drifts are a known function of its keys."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response
from pounding_cli.store.codec import failed

STUDY = """\
title: Bowl
records: {use: [g*.txt], scale: 1}
buildings:
  A: {storeys: 1, period: 0.3 s, mass: 150 t, height: 3 m}
  B: {storeys: 1, period: 0.5 s, height: 3 m}
group: [A, B]
cases: {near: {link: pounding, gap: 12 mm}}
analyses: [inelastic]
estimate: none
optimise:
  least: residual_drift in A
  over:
    buildings.A.mass: {from: 100 t, to: 200 t}
    cases.near.gap: {from: 10 mm, to: 20 mm}
  slice_points: 5
  map_points: 5
"""

MASS, GAP = 130e3, 0.017
"""Where the bowl is lowest [kg], [m]."""

KEYS = ["buildings.A.mass", "cases.near.gap"]


def write_study(folder: Path, text: str = STUDY, motions: int = 1) -> Path:
    """The study with its motions; the n-th one has a peak of n m/s2."""
    for number in range(1, motions + 1):
        (folder / f"g{number}.txt").write_text(f"# unit m/s2\n0.00 0\n0.02 {number}\n0.04 0\n")
    path = folder / "bowl.yaml"
    path.write_text(text)
    return path


def bowl(mass: float, gap: float) -> float:
    """1 at the bottom, 1.01 a tenth of a range away."""
    return 1 + ((mass - MASS) / 1e5) ** 2 + ((gap - GAP) / 0.01) ** 2


def known(scene: Scene, accuracy: float = 1e-6, method: str = "taylor", **_) -> Response:
    """The bowl times the peak of the motion, as residual drift of building A."""
    gap = scene.links[0].gap if scene.links else GAP
    value = bowl(scene.buildings[0].mass[0], gap) * scene.motion.pga
    one = np.ones(1)
    parts = tuple(BuildingResponse(one, one, one, one, one, -one, value * one) for _ in scene.buildings)
    zero = np.zeros(len(scene.links))
    links = LinkResponse(zero, zero, zero, zero, zero)
    return Response(parts, links, "done", "", "taylor", accuracy, 1, 0, 1e-6)


def fails_near_the_bottom(scene: Scene, accuracy: float = 1e-6, **_) -> Response:
    """As `known`; linked scenes of a gap above 16 mm give nothing."""
    if scene.links and scene.links[0].gap > 0.016:
        return failed([1, 1], len(scene.links), "event bound reached", "write more", "taylor", accuracy, np.nan)
    return known(scene, accuracy)
