"""A small study with uncertain keys, and a solver whose residual drifts are Ishigami's function of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response
from pounding_cli.store.codec import failed

STUDY = """\
title: Ishigami
records: {use: [g*.txt], scale: 1}
buildings:
  A: {storeys: 1, period: 0.3 s, mass: 100 t, height: 3 m}
  B: {storeys: 1, period: 0.5 s, height: 3 m}
group: [A, B]
cases: {near: {link: pounding, gap: 15 mm}}
analyses: [inelastic]
estimate: none
uncertain:
  buildings.A.mass: {uniform: {from: 100 t, to: 200 t}}
  cases.near.gap: {uniform: {from: 10 mm, to: 20 mm}}
  buildings.A.hardening: {uniform: {from: 0, to: 0.5}}
sensitivity:
  outputs: [residual_drift in A]
  samples: 64
"""

FIRST, TOTAL = (0.3139, 0.4424, 0.0), (0.5576, 0.4424, 0.2437)
"""Indices of Ishigami's function with a = 7, b = 0.1 (Sobol and Levitan 1999), closed form."""


def write_study(folder: Path, text: str = STUDY, motions: int = 1) -> Path:
    """The study with its motions; the n-th one has a peak of n m/s2."""
    for number in range(1, motions + 1):
        (folder / f"g{number}.txt").write_text(f"# unit m/s2\n0.00 0\n0.02 {number}\n0.04 0\n")
    path = folder / "ishigami.yaml"
    path.write_text(text)
    return path


def x_of(scene: Scene) -> np.ndarray:
    """The three numbers of Ishigami, from -pi to pi, that building A and the gap stand for."""
    a, gap = scene.buildings[0], scene.links[0].gap if scene.links else 0.01
    u = np.array([(a.mass[0] - 1e5) / 1e5, (gap - 0.01) / 0.01, 2.0 * a.hardening[0]])
    return np.pi * (2 * u - 1)


def ishigami(x: np.ndarray) -> float:
    return float(np.sin(x[0]) + 7 * np.sin(x[1]) ** 2 + 0.1 * x[2] ** 4 * np.sin(x[0]))


def known(scene: Scene, accuracy: float = 1e-6, method: str = "taylor", **_) -> Response:
    """Ishigami's function times the peak of the motion, as residual drift of building A."""
    value = ishigami(x_of(scene)) * scene.motion.pga if scene.buildings[0].name == "A" else 0.0
    one = np.ones(1)
    parts = tuple(BuildingResponse(one, one, one, one, one, -one, value * one) for _ in scene.buildings)
    zero = np.zeros(len(scene.links))
    links = LinkResponse(zero, zero, zero, zero, zero)
    return Response(parts, links, "done", "", "taylor", accuracy, 1, 0, 1e-6)


def fails_in_a_corner(scene: Scene, accuracy: float = 1e-6, **_) -> Response:
    """As `known`; linked scenes with x1 and x2 above 1.5 give nothing, those with x3 above -2 only at the accuracy
    asked."""
    x = x_of(scene) if scene.links else np.zeros(3)
    if min(x[0], x[1]) > 1.5 and (x[2] < -2 or accuracy > 1e-7):
        return failed([1, 1], len(scene.links), "event bound reached", "write more", "taylor", accuracy, np.nan)
    return known(scene, accuracy)
