"""Storeys that lose strength against OpenSees' IMKPeakOriented and IMKPinching, driven through cycles of drift.

Both give the same forces but for what OpenSees does otherwise: it reloads towards the last peak where that is stiffer,
sets the force to zero for good once an energy is spent, has no limit to the loss of unloading stiffness, and lets
reloading be stiffer than unloading. Its energies are sums over steps, ours are exact: they come nearer as its step
shrinks."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.laws.imk import PeakOrientedImk, PinchingImk
from tests.reference.drawn import cycles, shears

ops = pytest.importorskip("openseespy.opensees", reason="openseespy is not installed (pip install -e .[peers])")

K, VY = 2e7, 3e5
DY = VY / K
CAPPED = {"capping_ductility": 4.0, "post_capping_slope": 0.1, "residual_strength": 0.2}
LOST = {f"{mode}_capacity": 150.0 for mode in ("strength", "capping", "unloading", "reloading")}
MODES = [{}, *({name: value} for name, value in LOST.items() if name != "reloading_capacity")]
MODES += [{name: value for mode in MODES for name, value in mode.items()}]


def opensees(law, path: np.ndarray) -> np.ndarray:
    """Force of OpenSees' material at every drift of a path."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    pinched = law.name == "imk-pinching"
    plastic = (law.capping_ductility - 1) * DY
    top = 1 + law.hardening * (law.capping_ductility - 1)
    side = plastic, top * VY / (law.post_capping_slope * K), 1e3, VY, top, law.residual_strength
    energies = [min(getattr(law, name), 1e9) * DY for name in ("strength_capacity", "capping_capacity",
                "reloading_capacity", "unloading_capacity")]  # fmt: skip
    more = (law.pinching_force, law.pinching_drift) if pinched else ()
    name = "IMKPinching" if pinched else "IMKPeakOriented"
    ops.uniaxialMaterial(name, 1, K, *side, *side, *energies, *[law.deterioration_exponent] * 4, 1.0, 1.0, *more)
    ops.testUniaxialMaterial(1)
    found = []
    for drift in path.tolist():
        ops.setStrain(drift)
        found.append(ops.getStress())
    ops.wipe()
    return np.array(found)


@pytest.mark.parametrize("lost", MODES, ids=lambda lost: "all" if len(lost) > 1 else "".join(lost) or "none")
@pytest.mark.parametrize("law", [PeakOrientedImk, PinchingImk], ids=lambda law: law.name)
def test_growing_cycles(law, lost):
    """Two cycles to each amplitude, beyond the cap. Fails if a mode deteriorates otherwise, or pinching breaks
    elsewhere."""
    pinched = {"pinching_force": 0.4, "pinching_drift": 0.5} if law is PinchingImk else {}
    own = law(K, VY, 0.05, **CAPPED, **pinched, **lost)
    amplitudes = DY * np.repeat([0.7, 1.5, 2.5, 3.5, 5.0, 7.0], 2)
    off = []
    for step in (1e-2 * DY, 1e-3 * DY):
        path = cycles(amplitudes, step)
        off.append(np.abs(opensees(own, path) - shears(own, path)).max() / VY)
    assert off[1] < 4e-3
    if not (law is PinchingImk and "unloading_capacity" in lost):  # reloading stiffer than unloading
        assert off[1] < max(0.3 * off[0], 1e-6)


def test_reloading():
    """With a target that moves out OpenSees goes on reloading towards the last peak, the stiffer line: the two differ
    from the first reloading on."""
    own = PeakOrientedImk(K, VY, 0.05, **CAPPED, reloading_capacity=150.0)
    path = cycles(DY * np.array([1.5, 1.5, 2.5, 2.5]), 1e-3 * DY)
    theirs, ours = opensees(own, path), shears(own, path)
    assert 5e-3 < np.abs(theirs - ours).max() / VY < 0.05
    first = slice(0, 2500)
    assert np.abs(theirs[first] - ours[first]).max() < 1e-6 * VY
