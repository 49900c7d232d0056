"""Histories against Dormand-Prince 8(5,3) with located events: the reference is run to chosen times and no further."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.solve.histories import history
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, pair, shake
from tests.reference import events

EVERY = 0.004
SCENES = {
    "touching": pair("pounding", 0.0, shake(0.6), INELASTIC),
    "gap and foundation": pair("pounding", 0.004, shake(0.6), INELASTIC, FOUNDATION),
    "infill": pair("infill", 0.01, shake(0.6), ELASTIC),
    "connected": pair("connector", 0.05, shake(0.6), INELASTIC),
}
SAMPLES = (17, 30)
"""The reference ends at these samples of the motion, 20 ms apart."""


@pytest.mark.parametrize("name", SCENES)
def test_states_are_those_of_the_reference(name):
    """Displacements, drifts and energies to 1e-8. Fails if a run goes on without its plastic drifts."""
    scene = SCENES[name]
    found = history(scene, 1e-12, EVERY)
    size = np.nanmax(np.abs(found.displacement))
    for sample in SAMPLES:
        cut = dataclasses.replace(scene.motion, acceleration=scene.motion.acceleration[: sample + 1])
        expected = events.integrate(dataclasses.replace(scene, motion=cut))
        at = round(sample * scene.motion.dt / EVERY)
        assert found.time[at] == pytest.approx(cut.duration)
        displacement = found.displacement[at].ravel()
        np.testing.assert_allclose(displacement, expected.displacement, rtol=0, atol=1e-8 * size)
        np.testing.assert_allclose(found.drift[at].ravel(), expected.residual_drift, rtol=0, atol=1e-8 * size)
        work = expected.energy
        for ours, theirs in (("input", "input"), ("kinetic", "kinetic"), ("damping", "damping"), ("links", "links")):
            assert found.energy[ours][at] == pytest.approx(work[theirs], rel=1e-7, abs=1e-8 * work["input"])


@pytest.mark.parametrize("name", SCENES)
def test_forces_and_accelerations_reach_the_peaks_of_the_reference(name):
    """Sampled five times a millisecond. Fails if a link's dashpot or the mass's drag is left out."""
    scene = SCENES[name]
    cut = dataclasses.replace(scene.motion, acceleration=scene.motion.acceleration[:18])
    scene = dataclasses.replace(scene, motion=cut)
    expected, found = events.integrate(scene), history(scene, 1e-12, 2e-4)
    for values, peak, reach in (
        (found.shear, expected.shear, 1e-4),
        (found.total_acceleration, expected.acceleration, 0.02),
        (found.link_force, expected.peak_force, 0.02),
    ):
        share = np.abs(values).max(axis=0).ravel() / np.where(peak > 0, peak, 1)
        assert (share < 1 + 1e-8).all()
        assert (share > np.where(peak > 0, 1 - reach, -1)).all()
    assert expected.peak_force.max() > 0
