"""A slab that strikes columns, and an inclined link to columns, against OpenSees: a node in the column, beam elements
below and above it.

The column stands clamped in the floors; the rest of the storey's stiffness is a column of its own."""

from __future__ import annotations

import numpy as np
import pytest

from tests.adapter import Scene, solve
from tests.physics.test_closed_forms import still, storey

ops = pytest.importorskip("openseespy.opensees", reason="openseespy is not installed (pip install -e .[peers])")

HEIGHT, DURATION, SPEED = 3.0, 1.0, 0.5
"""Of the storey [m], of the run [s], of the slab as it strikes [m/s]."""

MASSES, STIFFNESSES, CONTACT, SHARE = (2e5, 3e5), (3e7, 6e7), 1e8, 0.4
"""[kg], [N/m], [N/m], the struck columns' part of the second storey's stiffness."""

STEPS = (4e-4, 2e-4, 1e-4, 5e-5)

RISE, DISTANCE = 1.5, 2.0
"""Of the floor above the other end of an inclined link, and between both along the row [m]."""


def march(at: float, dt: float, inclined: bool = False) -> np.ndarray:
    """Largest |displacement| of the slab and of the struck building's floor [m], largest |shear| in the struck column
    below and above the blow [N], at the steps of Newmark's method.

    inclined : whether a truss as stiff as the contact joins both, from a floor that is higher, in place of a contact
    """
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for node, level in ((1, 0.0), (2, at * HEIGHT), (3, HEIGHT)):
        ops.node(node, 0.0, level)
    slab = (-DISTANCE, at * HEIGHT + RISE) if inclined else (0.0, at * HEIGHT)
    for node in (4, 5):  # the slab, and where its spring is held
        ops.node(node, *slab)
    for node, held in ((1, (1, 1, 1)), (3, (0, 1, 1)), (4, (0, 1, 1)), (5, (1, 1, 1))):
        ops.fix(node, *held)
    ops.mass(3, MASSES[1], 0.0, 0.0)
    ops.mass(4, MASSES[0], 0.0, 0.0)
    ops.geomTransf("Linear", 1)
    bending = HEIGHT**3 / 12  # E I over 12 E I / L^3
    for tag, ends, share in ((1, (1, 2), SHARE), (2, (2, 3), SHARE), (3, (1, 3), 1.0 - SHARE)):
        ops.element("elasticBeamColumn", tag, *ends, 1e14, 1.0, share * STIFFNESSES[1] * bending, 1)
    ops.uniaxialMaterial("Elastic", 1, STIFFNESSES[0])
    ops.element("zeroLength", 4, 5, 4, "-mat", 1, "-dir", 1)
    if inclined:
        ops.uniaxialMaterial("Elastic", 2, CONTACT)
        ops.element("Truss", 5, 4, 2, float(np.hypot(RISE, DISTANCE)), 2)  # E A / L is the stiffness of the contact
    else:
        ops.uniaxialMaterial("ENT", 2, CONTACT)
        ops.element("zeroLength", 5, 4, 2, "-mat", 2, "-dir", 1)
    ops.setNodeVel(4, 1, SPEED, "-commit")
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormDispIncr", 1e-14, 50)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    found = np.zeros(4)
    for _ in range(round(DURATION / dt)):
        assert ops.analyze(1, dt) == 0
        now = ops.nodeDisp(4, 1), ops.nodeDisp(3, 1), ops.eleForce(1)[0], ops.eleForce(2)[0]
        found = np.maximum(found, np.abs(now))
    return found


@pytest.mark.parametrize("at", [0.35, 0.8])
def test_an_inclined_link_to_a_column(at):
    """Displacements and shears, whose errors fall with OpenSees' step. Fails if the link has another angle, takes it
    once, or bends the column by its whole force."""
    left = storey(MASSES[0], STIFFNESSES[0], height=at * HEIGHT + RISE)
    right = storey(MASSES[1], STIFFNESSES[1], height=HEIGHT, columns=SHARE)
    case = {"link": "connector", "gap": 0.5, "stiffness": CONTACT, "damping_ratio": 0.0, "distance": DISTANCE}
    case["floors"] = [[1, f"0 + {100 * at:g} %"]]
    start = [[0.0], [0.0]], [[SPEED], [0.0]]
    run = solve(Scene((left, right), case=case, start=start, **still(DURATION)), 1e-11)
    displacements = np.maximum(run.displacement_max, -run.displacement_min)
    expected = np.array([*displacements, run.shear_below[0], run.shear_above[0]])
    assert march(at, STEPS[0], inclined=True) == pytest.approx(expected, rel=2e-5)
    assert march(at, STEPS[-1], inclined=True) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("at", [0.1, 0.35, 0.8])
def test_a_blow_on_a_column(at):
    """Second order in OpenSees' step, in displacements and shears. Fails if the struck point moves by other weights, if
    its columns bend otherwise, or if the ends of a column take each other's shear."""
    left = storey(MASSES[0], STIFFNESSES[0], height=at * HEIGHT, slab=1e-3)
    right = storey(MASSES[1], STIFFNESSES[1], height=HEIGHT, slab=1e-3, columns=SHARE)
    case = {"link": "pounding", "gap": 0.0}
    more = {"impact": {"stiffness": CONTACT, "restitution": 1.0}}
    start = [[0.0], [0.0]], [[SPEED], [0.0]]
    run = solve(Scene((left, right), case=case, more=more, start=start, **still(DURATION)), 1e-11)
    displacements = np.maximum(run.displacement_max, -run.displacement_min)
    expected = np.array([*displacements, run.shear_below[0], run.shear_above[0]])
    errors = np.array([np.abs(march(at, dt) / expected - 1) for dt in STEPS])
    assert run.impacts[0] > 0
    assert (errors[-1] < 1e-6).all()
    assert np.polyfit(np.log(STEPS), np.log(np.linalg.norm(errors, axis=1)), 1)[0] > 1.7
