"""Small fragility studies, and a solver whose demands are known: they grow with the peak of the ground motion."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response
from pounding_cli.store.codec import failed

MOTIONS = 8

STUDY = """\
title: Known demands
records: {use: [m/*.txt], scale: {pga: 0.1 g}}
buildings:
  A: {storeys: 3, period: 0.3 s}
  B: {like: A, storeys: 2, period: 0.5 s}
group: [A, B]
cases: {near: {link: pounding, gap: 15 mm}}
analyses: [inelastic]
estimate: none
sweep:
  records.scale.pga: {from: 0.02 g, to: 1 g, step: 0.02 g}
fragility:
  limits: [mu > 4, contact]
"""


def write_study(folder: Path, text: str = STUDY) -> Path:
    """The study with its motions: the n-th one has samples of a form of its own and a peak of 1 m/s2."""
    (folder / "m").mkdir(exist_ok=True)
    for number in range(MOTIONS):
        samples = [0.0, 1.0, -0.05 * (number + 1), 0.02 * number, 0.0]
        lines = [f"{0.02 * step:.2f} {value:.17g}" for step, value in enumerate(samples)]
        (folder / "m" / f"g{number}.txt").write_text("# unit m/s2\n" + "\n".join(lines) + "\n")
    path = folder / "known.yaml"
    path.write_text(text)
    return path


def number_of(scene: Scene) -> int:
    """Which of the motions a scene has."""
    samples = scene.motion.acceleration
    return round(float(-samples[2] / samples[1]) / 0.05) - 1


def ductility(scene: Scene, building: int, scale: float = 1.0) -> float:
    """A capacity of 0.2 to 0.5 g at ductility 4, a tenth less with links; B is stronger than A by a half."""
    strength = (0.2 + 0.3 * number_of(scene) / (MOTIONS - 1)) * (1.0 if scene.buildings[building].name == "A" else 1.5)
    return scale * 4.0 * scene.motion.pga / 9.80665 / strength * (1.0 / 0.9 if scene.links else 1.0)


def known(scene: Scene, accuracy: float = 1e-6, method: str = "taylor", **_) -> Response:
    """Ductilities as above in the lowest storey; the gap closes as the peak passes 0.1 g and a little more."""
    found = []
    for place, b in enumerate(scene.buildings):
        mu = ductility(scene, place) * np.linspace(1.0, 0.5, b.storeys)
        one = np.ones(b.storeys)
        found.append(BuildingResponse(one, mu * b.yield_drift, mu, scene.motion.pga * one, one, -one, 0 * one))
    closing = (
        np.array([each.gap for each in scene.links]) * scene.motion.pga / 9.80665 / (0.1 + 0.01 * number_of(scene))
    )
    zero = 0 * closing
    links = LinkResponse(zero, zero, closing, zero, zero)
    return Response(tuple(found), links, "done", "", "taylor", accuracy, 1, 0, 1e-6)


def fails_between(scene: Scene, accuracy: float = 1e-6, method: str = "taylor", **_) -> Response:
    """As `known`, but the linked scenes of motion 0 give nothing from 0.15 to 0.25 g."""
    if scene.links and number_of(scene) == 0 and 0.149 < scene.motion.pga / 9.80665 < 0.251:
        storeys = [b.storeys for b in scene.buildings]
        return failed(storeys, len(scene.links), "event bound reached", "write more", "taylor", accuracy, np.nan)
    return known(scene)
