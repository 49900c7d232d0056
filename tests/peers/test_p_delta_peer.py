"""Bilinear storeys under P-Delta against OpenSees: `twoNodeLink` with `-pDelta`, whose columns stand in two dimensions
under the weight of the floors, `Steel01` in shear.

There the weight pushes with the axial force that the columns carry at that instant; here with P / h at all times."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli import Building, Motion
from tests.adapter import Scene, solve
from tests.peers.scenes import building
from tests.physics.cases import shake

ops = pytest.importorskip("openseespy.opensees", reason="openseespy is not installed (pip install -e .[peers])")

AXIAL = 1e13
"""Stiffness of the columns along themselves [N/m]."""


def drifts(building: Building, motion: Motion, dt: float) -> np.ndarray:
    """Largest |drift| of every storey at the steps of Newmark's method [m], shape (n,)."""
    n = building.storeys
    own = building.gravity_load - np.append(building.gravity_load[1:], 0.0)
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    elevation = np.append(0.0, building.elevation)
    for j, height in enumerate(elevation.tolist()):
        ops.node(j, 0.0, height)
        ops.fix(j, int(j == 0), int(j == 0), 1)
    for j in range(n):
        ops.mass(j + 1, float(building.mass[j]), 0.0, 0.0)
        ops.uniaxialMaterial("Elastic", 2 * j + 1, AXIAL)
        shear = float(building.yield_shear[j]), float(building.stiffness[j]), float(building.hardening[j])
        ops.uniaxialMaterial("Steel01", 2 * j + 2, *shear)
        ops.element(
            "twoNodeLink", j + 1, j, j + 1, "-mat", 2 * j + 1, 2 * j + 2, "-dir", 1, 2,
            "-orient", 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, "-pDelta", 0.0, 0.0, "-doRayleigh",
        )  # fmt: skip
    ops.region(1, "-node", *range(1, n + 1), "-rayleigh", building.alpha, 0.0, building.beta, 0.0)
    ops.region(2, "-ele", *range(1, n + 1), "-rayleigh", building.alpha, 0.0, building.beta, 0.0)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for j in range(n):
        ops.load(j + 1, 0.0, -float(own[j]), 0.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormDispIncr", 1e-13, 50, 0)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    ops.loadConst("-time", 0.0)
    ops.wipeAnalysis()
    ops.timeSeries("Path", 2, "-dt", motion.dt, "-values", *motion.acceleration.tolist(), "-useLast")
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormDispIncr", 1e-12, 50, 0)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    largest = np.zeros(n)
    for _ in range(round(motion.duration / dt)):
        assert ops.analyze(1, dt) == 0
        u = np.array([ops.nodeDisp(j, 1) for j in range(n + 1)])
        largest = np.maximum(largest, np.abs(np.diff(u)))
    ops.wipe()
    return largest


@pytest.mark.parametrize("theta", [0.0, 0.1])
def test_leaning_storeys(theta):
    """Second order in OpenSees' step. Fails if the weight acts on another arm, or ends at the yield."""
    plain = building(0.6, collapse="never", **{"yield": {"overstrength": 0.6}})
    scene = Scene([plain], shake(2.0, 5.0), 0.02, analysis="inelastic")
    stiffness = scene.built.buildings[0].stiffness
    loaded = Scene([plain | {"p_delta": (theta * 3.0 * stiffness).tolist()}], scene.ground, 0.02, analysis="inelastic")
    exact = solve(loaded, 1e-10)
    assert exact.ductility.max() > 2
    if theta:
        without = solve(scene, 1e-9).drift
        assert np.abs(without / exact.drift - 1).max() > 0.02
    built = loaded.built
    off = [np.abs(drifts(built.buildings[0], built.motion, dt) / exact.drift - 1).max() for dt in (2e-3, 5e-4)]
    assert off[1] < 2e-5
    assert off[1] < 0.2 * off[0]
