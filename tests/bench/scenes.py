"""The scenes that are timed: those of the paper's figures, and rows and motions of any size."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from pounding_cli.laws.dashpot import damping_ratio
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.code_design import UbcDesign
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.model.stiffness import rayleigh_factors, stiffness_for_period
from pounding_cli.records.motion import Motion
from pounding_cli.study import expand, load_study
from pounding_cli.study.plan import Plan

from .clock import ROOT


@functools.cache
def plan_of(study: str) -> Plan:
    """A study of `configs/`, expanded."""
    return expand(load_study(ROOT / "configs" / f"{study}.yaml"))


def touching(analysis: str, record: str = "elcentro", study: str = "fig6") -> Scene:
    """Two buildings of five storeys that touch at rest (Fig. 6)."""
    plan = plan_of(study)
    row = next(r for r in plan.rows if (r.case, r.analysis, r.record) == ("touching", analysis, record))
    return plan.scenes[row.scene]


def linked(study: str) -> list[Scene]:
    """All scenes of a study whose buildings have something between them."""
    return [scene for scene in plan_of(study).scenes.values() if scene.links]


def batch(scene: Scene, count: int) -> list[Scene]:
    """As many scenes, each under a motion a little stronger than the one before (from 0.8 to 1.2 times)."""
    motion = scene.motion
    factors = np.linspace(0.8, 1.2, count)
    return [dataclasses.replace(scene, motion=Motion(motion.name, motion.dt, motion.acceleration * f)) for f in factors]


def noise(duration: float, dt: float = 0.02, peak: float = 4.0, seed: int = 1) -> Motion:
    """Smoothed noise of one strength from end to end, a peak acceleration of about `peak` [m/s2]."""
    raw = np.random.default_rng(seed).normal(size=round(duration / dt) + 7)
    smooth = np.convolve(raw, np.hanning(9)[1:-1], "valid")
    smooth[0] = 0.0
    return Motion("noise", dt, smooth * peak / (3.5 * smooth.std()))


def row(
    buildings: int = 2,
    storeys: int = 5,
    duration: float = 10.0,
    stiffer: float = 1.0,
    analysis: str = "elastic",
    gap: float = 0.0,
) -> Scene:
    """Buildings of 0.072 s and 0.12 s a storey, turn and turn about, with links at every floor.

    `stiffer` : impact stiffness over 20 times the stiffest storey [-]
    `gap` : at rest [m]
    """
    group = [_building((0.072, 0.12)[place % 2] * storeys, storeys) for place in range(buildings)]
    stiffness = 20 * stiffer * max(float(b.stiffness.max()) for b in group)
    law = Pounding(gap, stiffness, damping_ratio(0.5))
    links = [Link(left, j, j, law) for left in range(buildings - 1) for j in range(1, storeys + 1)]
    return Scene(tuple(group), tuple(links), noise(duration), Analysis(analysis))


def _building(period: float, storeys: int) -> Building:
    mass, height = np.full(storeys, 2e5), np.full(storeys, 3.0)
    k = stiffness_for_period(mass, period, 1 / 3)
    shears = UbcDesign(1991, 0.4).yield_shears(mass, height, period)
    factors = rayleigh_factors(mass, k, 0.05)
    return Building(f"{period:g} s", mass, height, k, shears, np.full(storeys, 0.05), *factors)


def shears(response) -> np.ndarray:
    """Peak storey shears [N] of all buildings."""
    return np.concatenate([b.shear for b in response.buildings])


def error(found: np.ndarray, exact: np.ndarray) -> float:
    """Largest relative error of a storey's peak shear [-]."""
    return float(np.abs(found / exact - 1).max())
