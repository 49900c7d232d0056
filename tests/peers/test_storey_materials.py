"""Storeys that lose strength against OpenSees' IMKPeakOriented and IMKPinching, driven through cycles of drift.

Here the law is the pen of tests/reference, with which the solver agrees (tests/physics). Both give the same forces but
for what OpenSees does otherwise: it reloads towards the last peak where that is stiffer, sets the force to zero for
good once an energy is spent, has no limit to the loss of unloading stiffness, and lets reloading be stiffer than
unloading. Its energies are sums over steps, ours are exact: they come nearer as its step shrinks."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from tests.reference.pens import ImkPen

ops = pytest.importorskip("openseespy.opensees", reason="openseespy is not installed (pip install -e .[peers])")

K, VY = 2e7, 3e5
DY = VY / K
CAPPED = {"capping_ductility": 4.0, "post_capping_slope": 0.1, "residual_strength": 0.2}
PINCHED, HARDENING = {"pinching_force": 0.4, "pinching_drift": 0.5}, 0.05
LOST = {f"{mode}_capacity": 150.0 for mode in ("strength", "capping", "unloading", "reloading")}
MODES = [{}, *({name: value} for name, value in LOST.items() if name != "reloading_capacity")]
MODES += [{name: value for mode in MODES for name, value in mode.items()}]


ORDER = "strength", "capping", "unloading", "reloading"


def pen(lost, pinched=False) -> ImkPen:
    capacities = tuple(lost.get(f"{mode}_capacity", np.inf) for mode in ORDER)
    kappa = (PINCHED["pinching_force"], PINCHED["pinching_drift"]) if pinched else None
    return ImkPen(
        K, VY, HARDENING, CAPPED["capping_ductility"], CAPPED["post_capping_slope"], CAPPED["residual_strength"],
        capacities, 1.0, kappa,
    )  # fmt: skip


def drawn(own: ImkPen, path: np.ndarray) -> np.ndarray:
    """Force of the pen at every drift of a path, straight in between."""
    found, before = [], 0.0
    for drift in path:
        way = 1.0 if drift > before else -1.0
        for _ in range(20):  # every end between the last drift and this one
            here = dict(own.ends(before, way))
            due = []
            for end, there in own.ends(drift, way):
                if end == "turn" and there > 0:
                    due.append((0.0, end))
                elif end != "turn" and there > 0 >= here[end]:
                    due.append((-here[end] / (there - here[end]), end))
            if not due:
                break
            share, end = min(due, key=lambda one: one[0])
            before += share * (drift - before)
            own.change(end, before)
        before = drift
        found.append(own.force(drift))
    return np.array(found)


def cycles(amplitudes, step: float) -> np.ndarray:
    """Drifts [m] of cycles to each amplitude and back, in steps."""
    corners = [0.0, *(sign * each for each in amplitudes for sign in (1.0, -1.0))]
    pieces = [np.linspace(a, b, max(2, round(abs(b - a) / step) + 1))[1:] for a, b in itertools.pairwise(corners)]
    return np.concatenate(pieces)


def opensees(lost, path: np.ndarray, pinched: bool = False) -> np.ndarray:
    """Force of OpenSees' material at every drift of a path."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    cap = CAPPED["capping_ductility"]
    top = 1 + HARDENING * (cap - 1)
    side = (cap - 1) * DY, top * VY / (CAPPED["post_capping_slope"] * K), 1e3, VY, top, CAPPED["residual_strength"]
    theirs = "strength", "capping", "reloading", "unloading"
    energies = [min(lost.get(f"{mode}_capacity", np.inf), 1e9) * DY for mode in theirs]
    more = (PINCHED["pinching_force"], PINCHED["pinching_drift"]) if pinched else ()
    name = "IMKPinching" if pinched else "IMKPeakOriented"
    ops.uniaxialMaterial(name, 1, K, *side, *side, *energies, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, *more)
    ops.testUniaxialMaterial(1)
    found = []
    for drift in path.tolist():
        ops.setStrain(drift)
        found.append(ops.getStress())
    ops.wipe()
    return np.array(found)


@pytest.mark.parametrize("lost", MODES, ids=lambda lost: "all" if len(lost) > 1 else "".join(lost) or "none")
@pytest.mark.parametrize("pinched", [False, True], ids=["peak-oriented", "pinching"])
def test_growing_cycles(pinched, lost):
    """Two cycles to each amplitude, beyond the cap. Fails if a mode deteriorates otherwise, or pinching breaks
    elsewhere."""
    amplitudes = DY * np.repeat([0.7, 1.5, 2.5, 3.5, 5.0, 7.0], 2)
    off = []
    for step in (1e-2 * DY, 1e-3 * DY):
        path = cycles(amplitudes, step)
        off.append(np.abs(opensees(lost, path, pinched) - drawn(pen(lost, pinched), path)).max() / VY)
    assert off[1] < 4e-3
    if not (pinched and "unloading_capacity" in lost):  # reloading stiffer than unloading
        assert off[1] < max(0.3 * off[0], 1e-6)


def test_reloading():
    """With a target that moves out OpenSees goes on reloading towards the last peak, the stiffer line: the two differ
    from the first reloading on."""
    lost = {"reloading_capacity": 150.0}
    path = cycles(DY * np.array([1.5, 1.5, 2.5, 2.5]), 1e-3 * DY)
    theirs, ours = opensees(lost, path), drawn(pen(lost), path)
    assert 5e-3 < np.abs(theirs - ours).max() / VY < 0.05
    first = slice(0, 2500)
    assert np.abs(theirs[first] - ours[first]).max() < 1e-6 * VY
