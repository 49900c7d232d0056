"""Floors that twist against OpenSees: `rigidDiaphragm` ties nodes of frame lines and contacts to the centre of mass.

Lines are `zeroLength` elements with `Steel01`, contacts those with `ViscoelasticGap` without its dashpot, marched by
Newmark's average acceleration; peaks are those at the steps. Diaphragms hold by `Penalty`: with `Transformation` the
drifts are some forty times too small under `UniformExcitation` (3.7.1), and OpenSees reports success."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest

from pounding_cli import Building, Motion, Scene
from tests.adapter import Link, solve
from tests.physics.twisting import SHIFT, pair_of_three

ops = pytest.importorskip("openseespy.opensees", reason="openseespy is not installed (pip install -e .[peers])")
diaphragms = pytest.importorskip("diaphragms", reason="openseespy is not installed")

STEPS = 1e-3, 5e-4, 2.5e-4
"""Steps of OpenSees [s]."""


def add_building(made: diaphragms.Diaphragms, building: Building, region: int) -> list[int]:
    """Make a building; return the nodes of its floors. Its lines are watched line by line, storey by storey."""
    plan = building.plan
    floors = [made.floor(*each) for each in zip(building.mass.tolist(), plan.inertia.tolist(), strict=True)]
    elements = []
    for line in plan.lines:
        below = made.ground(line.arm)
        for j, floor in enumerate(floors):
            above = made.place(floor, line.arm)
            shear = line.yield_shear[j], line.stiffness[j], building.hardening[j]
            ops.uniaxialMaterial("Steel01", made.next(), *map(float, shear))
            elements.append(made.join(below, above, 1, rayleigh=True))
            made.watched.append(elements[-1])
            below = above
    below = made.ground(0.0)
    for j, floor in enumerate(floors):
        ops.uniaxialMaterial("Elastic", made.next(), float(plan.torsional_stiffness[j]))
        elements.append(made.join(below, floor, 6, rayleigh=True))
        below = floor
    factors = "-rayleigh", building.alpha, 0.0, building.beta, 0.0
    ops.region(region, "-node", *floors, *factors)
    ops.region(region + 1, "-ele", *elements, *factors)
    return floors


def add_contact(made: diaphragms.Diaphragms, link: Link, left: int, right: int) -> None:
    """Make the contact of two floors at its place; the right building is the one that was made last."""
    right_end = made.place(right, link.right_arm)
    made.centre, shift = 0.0, made.centre
    assert link.left_arm == link.right_arm + shift
    ends = made.place(left, link.left_arm), right_end
    made.centre = shift
    ops.uniaxialMaterial("ViscoelasticGap", made.next(), link.law.stiffness, 0.0, -link.gap)
    made.watched.append(made.join(*ends, 1, rayleigh=False))


def march(scene: Scene, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest |shear| and |drift| of all lines, then of all contacts, at the steps of Newmark's method."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    made = diaphragms.Diaphragms()
    floors = []
    for number, building in enumerate(scene.buildings):
        made.centre = SHIFT * number
        floors.append(add_building(made, building, 1 + 2 * number))
    for link in scene.links:
        add_contact(made, link, floors[link.left][link.left_floor - 1], floors[link.left + 1][link.right_floor - 1])
    motion: Motion = scene.motion
    ops.timeSeries("Path", 1, "-dt", motion.dt, "-values", *motion.acceleration.tolist(), "-useLast")
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    with tempfile.TemporaryDirectory() as folder:
        for quantity in ("stress", "strain"):
            output = "-file", str(Path(folder) / quantity), "-precision", 16
            ops.recorder("EnvelopeElement", *output, "-ele", *made.watched, "material", 1, quantity)
        ops.constraints("Penalty", diaphragms.PENALTY, diaphragms.PENALTY)
        ops.numberer("RCM")
        ops.system("BandGeneral")
        ops.test("NormDispIncr", 1e-11, 50, 0)
        ops.algorithm("Newton")
        ops.integrator("Newmark", 0.5, 0.25)
        ops.analysis("Transient")
        assert ops.analyze(round(motion.duration / dt), dt) == 0
        ops.remove("recorders")
        stress, strain = (np.loadtxt(Path(folder) / name)[2] for name in ("stress", "strain"))
    ops.wipe()
    return stress, strain


@pytest.mark.parametrize("contacts", [False, True], ids=["alone", "in contact"])
def test_eccentric_frames(contacts: bool) -> None:
    """Three storeys with two yielding lines each; the difference falls with the step of OpenSees. Fails if a line or a
    contact has another lever, or the twist another damping."""
    scene = pair_of_three(contacts)
    run = solve(scene, 1e-10)
    assert run.line_ductility.max() > 2
    assert not contacts or (run.impacts > 0).all()
    counts = np.cumsum([each.storeys * len(each.plan.lines) for each in scene.buildings])
    drifts = [part.reshape(3, -1).T.ravel() for part in np.split(run.line_drift, counts[:-1])]
    shears = [part.reshape(3, -1).T.ravel() for part in np.split(run.line_shear, counts[:-1])]
    off = []
    for dt in STEPS:
        stress, strain = march(scene, dt)
        found = [strain[: counts[-1]] / np.concatenate(drifts) - 1, stress[: counts[-1]] / np.concatenate(shears) - 1]
        if contacts:
            found.append((stress[counts[-1] :] - run.peak_force) / run.peak_force.max())
        off.append([float(np.sqrt(np.mean(each**2))) for each in found])
    order = np.polyfit(np.log(STEPS), np.log(np.array(off)), 1)[0]
    assert (order > 1.2).all()
    assert (np.array(off[-1]) < [6e-5, 5e-6, 7e-4][: len(off[-1])]).all()
